#ifndef RENDER_PROJECT_LANES_H
#define RENDER_PROJECT_LANES_H
/* Points of a chunk on the screen, eight at a time. All is inlined, so that it takes on the caller's target. */
#include "process/lanes.h"
#include "render/chunk-view.h"
#include "render/lens.h"
#include "render/scene-planes.h"

#if defined LANES_WIDE
static const vf lane_number = { 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15 };
#else
static const vf lane_number = { 0, 1, 2, 3, 4, 5, 6, 7 };
#endif

struct lane_points {
	vf x_px, y_px, depth_m, px_per_m;
};

/* Of points whose coordinates in the box are q. */
INLINE struct lane_points project_lanes(
	const struct chunk_view *v, const vf q[3], const struct lens *l)
{
	vf at[3];
	for (int k = 0; k < 3; k++)
		at[k] = v->base[k] + q[0] * v->axis[0][k] + q[1] * v->axis[1][k] +
			q[2] * v->axis[2][k];
	vf scale = l->focal_px / LENS_SCALE_M(l, at[2]);
	return (struct lane_points){ l->middle_x + at[0] * scale, l->middle_y + at[1] * scale,
		at[2], scale };
}

typedef uint16_t vs_loose __attribute__((vector_size(2 * LANES), aligned(2), may_alias));

/* Eight in a row. */
INLINE vi load_u16_whole(const uint16_t *at)
{
	return __builtin_convertvector(*(const vs_loose *)at, vi);
}

typedef uint8_t vb_row __attribute__((vector_size(LANES), aligned(1), may_alias));

INLINE vi load_u8_whole(const uint8_t *at)
{
	return __builtin_convertvector(*(const vb_row *)at, vi);
}

INLINE vf load_u16(const uint16_t *at)
{
	return __builtin_convertvector(load_u16_whole(at), vf);
}

/* Of points in a row: their coordinates in the box and their spacing, in units. */
struct lane_places {
	vf q[3], spacing;
};

/* Of two words each. */
INLINE struct lane_places places_apart(vi low, vi high)
{
	return (struct lane_places){ { __builtin_convertvector(low & UINT16_MAX, vf),
					     __builtin_convertvector((vi)((vu)low >> 16), vf),
					     __builtin_convertvector(high & UINT16_MAX, vf) },
		__builtin_convertvector((vi)((vu)high >> 16), vf) };
}

INLINE struct lane_places load_places(const struct scene_place *at)
{
	vf first = load((const float *)(const void *)at),
	   second = load((const float *)(const void *)(at + LANES / 2));
	return places_apart((vi)evens(first, second), (vi)odds(first, second));
}

/* Of points anywhere. */
INLINE struct lane_places gather_places(const struct scene_place *from, vi at)
{
	vi low, high;
	gather_pairs(from, at, sizeof *from, &low, &high);
	return places_apart(low, high);
}

/* Diameters of discs, without what marks those on planes (scene-planes.h). */
INLINE vf disc_sizes(vf disc)
{
	return disc - where(disc >= (float)SCENE_DISC_PLANE, all((float)SCENE_DISC_PLANE));
}

/* Of packed normals, of any length; 0 0 0 where there is none. */
INLINE void unpack_lanes(vi both, vf ret[3])
{
	vi first = both << 16 >> 16, second = both >> 16;
	vi some = first != INT16_MIN;
	vf x = __builtin_convertvector(first, vf) * (1 / 32767.f),
	   y = __builtin_convertvector(second, vf) * (1 / 32767.f);
	vf z = 1 - magnitude(x) - magnitude(y), over = where(z < 0, -z);
	ret[0] = where(some, choose(x >= 0, x - over, x + over));
	ret[1] = where(some, choose(y >= 0, y - over, y + over));
	ret[2] = where(some, z);
}

/* The first pixels from 0 to end whose middles are not before x, which may be anywhere. */
INLINE vi pixels_from(vf x, int32_t end)
{
	return __builtin_convertvector(least(most(x, all(0)), all((float)end)) + 0.5f, vi);
}

#endif
