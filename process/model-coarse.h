#ifndef PROCESS_MODEL_COARSE_H
#define PROCESS_MODEL_COARSE_H
/* What a model says in short of all its points, for whoever does not read all of them (pleinair-model(5)): its sections "coarse",
 * "groups" and "tones". A group is up to MODEL_GROUP_CHUNKS chunks of one leaf that follow each other; of it "coarse" has one point in
 * so many, the first ones of each chunk, from all its chunks in turn: every prefix of them is a uniform subset of the group.
 *
 * One thread. Until it is written, the points wait in a file without a name beside the model's. */
#include "process/model.h"

#define MODEL_COARSE_ONE_IN 64u

/* In which turns points are taken from up to MODEL_GROUP_CHUNKS members that give so many each, at most MODEL_CHUNK_POINTS in all: of
 * each that comes the member, and its place among those. Returns how many. */
struct model_turn {
	uint16_t member, place;
};
uint32_t model_turns(const uint32_t *gives, uint32_t members, struct model_turn *ret);
/* What a chunk of so many points gives to a part of one in so many. */
static inline uint32_t model_gives(uint32_t all, uint32_t one_in)
{
	return (all + one_in - 1) / one_in;
}

typedef struct model_coarse model_coarse;
/* path: the model's. */
model_coarse *model_coarse_new(const char *path, GError **error);
/* The points of the chunk that comes next, c->points of them. */
bool model_coarse_add(model_coarse *m, const struct model_chunk *c, const struct model_point *point,
	GError **error);
/* All sections, for those chunks that were added, in this order. */
bool model_coarse_write(
	model_coarse *m, product_writer *file, const struct model_chunk *chunk, GError **error);
void model_coarse_free(model_coarse *m); /* NULL is fine */

#endif
