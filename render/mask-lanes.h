#ifndef RENDER_MASK_LANES_H
#define RENDER_MASK_LANES_H
/* How a mask is drawn (mask-lanes.c) and put together (mask-finish-lanes.c), eight pixels at a time. Internal to mask.c. */
#include "process/lanes.h"
#include "render/mask.h"

/* One thread's picture of keys. */
struct mask_target {
	int32_t *key; /* of pixel 0 0 */
	int32_t width, height;
	ptrdiff_t pitch;
};

/* What a thread needs for rows of tiles. */
struct mask_bench {
	int32_t *memory, *row[5], *below[2]; /* merged */
	vi *deepest;
};

/* Discs of a chunk's points. */
LANES_DECLARE(
	void, mask_draw, (const frame *f, const struct mask_target *t, const struct chunk_view *v));
/* A row of tiles of what was drawn so far. */
LANES_DECLARE(void, mask_look, (visibility_mask * m, uint32_t down, struct mask_bench *b));
/* In the end rows of tiles from .. end, without holes: all threads look around theirs before any of them finishes some. */
LANES_DECLARE(void, mask_look_around,
	(const visibility_mask *m, uint32_t from, uint32_t end, struct mask_bench *b));
LANES_DECLARE(void, mask_finish,
	(visibility_mask * m, uint32_t from, uint32_t end, struct mask_bench *b));

static inline int32_t *mask_first_key(const visibility_mask *m, int32_t *memory)
{
	return memory + (size_t)MASK_MARGIN * m->pitch + MASK_MARGIN;
}

static inline void mask_clear(int32_t *keys, size_t count)
{
	for (size_t i = 0; i < count; i++)
		keys[i] = MASK_EMPTY;
}

#endif
