#ifndef RENDER_KIOSK_STEP_SLIDERS_H
#define RENDER_KIOSK_STEP_SLIDERS_H
/* Sliders, choices, switches and colours for the parameters of steps, as the step table (render/step.h) has them. Main thread. */
#include "render/kiosk/kit.h"
#include "render/style.h"
#include <json-glib/json-glib.h>

/* value is the callee's. */
typedef void (*step_slid)(
	const char *step_id, const struct step_parameter *p, JsonNode *value, gpointer user_data);
/* step_id: of a step, or the name of a section. steps: of struct step; nothing of it is kept. The mask is not shown. */
GtkWidget *step_sliders_new(const GArray *steps, step_slid slid, gpointer user_data);
/* Of the whole picture: paper, light, focus. */
GtkWidget *section_sliders_new(const struct style_whole *whole, step_slid slid, gpointer user_data);

#endif
