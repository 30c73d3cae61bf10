#ifndef RENDER_STIPPLE_TEXTURE_H
#define RENDER_STIPPLE_TEXTURE_H
/* The hidden-points texture (Awano et al. 2010, section 2.1): the least key of the points at each texel of a plane, spread into the
 * eight texels around with a slightly larger depth, once or more often. And what points ask it (sections 2.4.1 and 2.4.3). */
#include "render/stipple-plane.h"

struct stipple_texture {
	int32_t columns, rows, pitch;
	int32_t *key;   /* rows of pitch texels; the border is STIPPLE_EMPTY */
	int32_t *other; /* as large, for spreading */
	void *memory;
};
/* Empty, of the plane's size; memory of the same size is used again. */
void stipple_texture_begin(
	struct stipple_texture *t, const struct stipple_plane *p, bool single_thread);
/* As often as the plane says. Once it is done the texture holds no points that are behind others but for gaps between those. */
void stipple_texture_spread(struct stipple_texture *t, const struct stipple_plane *p,
	enum lanes_path lanes, bool single_thread);
LANES_DECLARE(void, stipple_spread_row,
	(const int32_t *from, int32_t *to, int32_t pitch, int32_t columns, int32_t row,
		int32_t step));
void stipple_texture_clear(struct stipple_texture *t);

/* Any thread, in any order. */
static inline void stipple_lower(int32_t *at, int32_t key)
{
	int32_t there = __atomic_load_n(at, __ATOMIC_RELAXED);
	while (key < there && !__atomic_compare_exchange_n(
				      at, &there, key, true, __ATOMIC_RELAXED, __ATOMIC_RELAXED))
		;
}

/* A point is seen when a texel beside its own is deeper than it; empty ones are deeper than all. */
static inline bool stipple_is_seen(const struct stipple_texture *t, int32_t place, int32_t key)
{
	const int32_t *at = t->key + place;
	for (int32_t row = -1; row <= 1; row++)
		for (int32_t column = -1; column <= 1; column++)
			if (at[row * t->pitch + column] > key)
				return true;
	return false;
}

/* Around a point these texels may be its own: 9 after one pass, 25 after two, and no more are looked at. */
static inline int32_t stipple_rings(const struct stipple_plane *p)
{
	return p->passes < STIPPLE_RINGS_MOST ? (int32_t)p->passes : STIPPLE_RINGS_MOST;
}
static inline uint32_t stipple_around(const struct stipple_plane *p)
{
	int32_t side = 2 * stipple_rings(p) + 1;
	return (uint32_t)(side * side);
}
/* Of those, how many hold the point's own depth, or what was spread of it: about as many as its surface is wide there. */
static inline uint32_t stipple_count(
	const struct stipple_texture *t, const struct stipple_plane *p, int32_t place, int32_t key)
{
	const int32_t *at = t->key + place, rings = stipple_rings(p);
	uint32_t count = 0;
	for (int32_t row = -rings; row <= rings; row++)
		for (int32_t column = -rings; column <= rings; column++) {
			int32_t ring = MAX(ABS(row), ABS(column));
			count += at[row * t->pitch + column] == key + ring * p->step;
		}
	return count;
}

#endif
