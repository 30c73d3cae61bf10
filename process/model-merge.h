#ifndef PROCESS_MODEL_MERGE_H
#define PROCESS_MODEL_MERGE_H
/* Merges the sorted parts of all scans into one stream along the curve, and that into the model. Of each run it holds a window of
 * the mapped file; what was read is given back. */
#include "process/build-progress.h"
#include "process/model-part.h"

/* Parts sorted by number of scan. Takes manifest. */
bool model_merge(const char *path, model_part *const *part, size_t parts, unsigned level,
	JsonObject *manifest_json, const struct build_progress *progress,
	struct build_result *result, GError **error);

#endif
