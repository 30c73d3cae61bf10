#ifndef PROCESS_SEGMENT_MODEL_H
#define PROCESS_SEGMENT_MODEL_H
/* What a person's semantic model (semantic-model.h) tells of the scans of a site: classes that go before those of the rules where
 * the model is sure. Scans without a grid, and those that lack a channel that the model wants, are left to the rules. */
#include "process/segmentation.h"

#define SEGMENT_MODEL_CONFIDENCE 0.6

typedef struct segment_model segment_model;
/* path: of MODEL.onnx. */
segment_model *segment_model_open(const char *path, double confidence, GError **error);
void segment_model_free(segment_model *m); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(segment_model, segment_model_free)
/* Over both files of the model; NULL and an error: cannot be read. Caller frees. */
char *segment_model_fingerprint(const char *path, GError **error);
/* As segmentation_options wants it. */
bool segment_model_label(gpointer m, const struct segmentation_scan *scan, const float *height_m,
	uint8_t *ret_label, GError **error);

#endif
