#ifndef PROCESS_MODEL_WRITE_H
#define PROCESS_MODEL_WRITE_H
/* Writes points, which come along the curve, into the chunks of a model, and takes over pieces of another model. */
#include "process/model-piece.h"
#include "process/model.h"

typedef struct model_writer model_writer;
model_writer *model_writer_new(const char *path, unsigned level, GError **error);
/* In the order of part_point_compare. */
bool model_writer_add(model_writer *w, const struct part_point *p, uint16_t scan, GError **error);
/* A piece of a model on the same lattice, up to the next one's first chunk. *ret_taken: false when its points are damaged, and
 * nothing was written. What is added next begins a piece. */
bool model_writer_take(model_writer *w, const model *from, const struct model_piece *piece,
	uint64_t end_chunk, bool *ret_taken, GError **error);
/* Points as a chunk of their own, as they stand: of the box and leaf of another one, in an order of ranks. What is added next is not
 * in it. */
bool model_writer_put(model_writer *w, const struct model_chunk *like,
	const struct model_point *point, uint32_t count, GError **error);
uint64_t model_writer_count(const model_writer *w);
/* With the words of what each part lost to its neighbours, and where those of each part end. Takes the manifest. The writer
 * can only be freed then. */
bool model_writer_finish(model_writer *w, model_part *const *part, size_t parts,
	JsonObject *manifest, GError **error);
void model_writer_free(model_writer *w); /* NULL is fine; removes what was not finished */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(model_writer, model_writer_free)

#endif
