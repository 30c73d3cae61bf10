#ifndef PROCESS_MODEL_STALE_H
#define PROCESS_MODEL_STALE_H
/* Which pieces of the model that is there are out of date: those with points of scans that are new, and those where a point is
 * dropped now that was not, or the other way round. The model tells by its manifest and by its section "dropped" what it was
 * made from, so this does not depend on what else was done since. */
#include "process/model-inputs.h"
#include "process/model-piece.h"
#include "process/model.h"

typedef struct model_stale model_stale;
struct model_stale {
	model *was;
	const struct model_piece *piece;
	uint64_t pieces;
	bool *is_stale; /* of each piece */
	unsigned block_shift;
};
/* parts: of the inputs, in this order. *ret NULL: all is out of date. PRODUCT_ERROR_DAMAGED when a part is. */
bool model_stale_find(const char *path, const model_inputs *inputs, model_part *const *part,
	unsigned level, model_stale **ret, GError **error);
void model_stale_free(model_stale *s); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(model_stale, model_stale_free)
uint64_t model_stale_end(const model_stale *s, uint64_t piece); /* chunk behind its last */

#endif
