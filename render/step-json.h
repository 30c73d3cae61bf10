#ifndef RENDER_STEP_JSON_H
#define RENDER_STEP_JSON_H
/* Steps as style files have them. */
#include "render/step.h"
#include <json-glib/json-glib.h>

/* The value of one parameter, from the struct of its kind. Caller unrefs. */
JsonNode *step_parameter_to_json(const struct step_parameter *p, const void *from);
/* Kind, id, and what differs from the kind's defaults. Caller unrefs. */
JsonObject *step_to_json(const struct step *s);

#endif
