#ifndef PROCESS_MODEL_WRITE_H
#define PROCESS_MODEL_WRITE_H
/* Writes points, which come along the curve, into the chunks of a model. */
#include "process/model-part.h"
#include "process/model.h"

typedef struct model_writer model_writer;
model_writer *model_writer_new(const char *path, unsigned level, GError **error);
/* In the order of part_point_compare. */
bool model_writer_add(model_writer *w, const struct part_point *p, uint16_t scan, GError **error);
uint64_t model_writer_count(const model_writer *w);
/* Takes the manifest. The writer can only be freed then. */
bool model_writer_finish(model_writer *w, JsonObject *manifest, GError **error);
void model_writer_free(model_writer *w); /* NULL is fine; removes what was not finished */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(model_writer, model_writer_free)

#endif
