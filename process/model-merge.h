#ifndef PROCESS_MODEL_MERGE_H
#define PROCESS_MODEL_MERGE_H
/* Merges the sorted parts of all scans into one stream along the curve, and that into the model. Of each run it holds a window of
 * the mapped file; what was read is given back. Pieces of the model that was there before are taken over where nothing changed. */
#include "process/build-progress.h"
#include "process/model-stale.h"

/* Parts sorted by number of scan. stale: what to take over; NULL: nothing. Takes manifest. PRODUCT_ERROR_DAMAGED when a part is. */
bool model_merge(const char *path, model_part *const *part, size_t parts, unsigned level,
	const model_stale *stale, JsonObject *manifest_json, const struct build_progress *progress,
	struct build_result *result, GError **error);

#endif
