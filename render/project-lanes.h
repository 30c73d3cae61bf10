#ifndef RENDER_PROJECT_LANES_H
#define RENDER_PROJECT_LANES_H
/* Points of a chunk on the screen, eight at a time. All is inlined, so that it takes on the caller's target. */
#include "process/lanes.h"
#include "render/chunk-view.h"

static const vf lane_number = { 0, 1, 2, 3, 4, 5, 6, 7 };

struct lane_points {
	vf x_px, y_px, depth_m, px_per_m;
};

/* Of points whose coordinates in the box are q. */
INLINE struct lane_points project_lanes(
	const struct chunk_view *v, const vf q[3], float focal_px, float middle_x, float middle_y)
{
	vf at[3];
	for (int k = 0; k < 3; k++)
		at[k] = v->base[k] + q[0] * v->axis[0][k] + q[1] * v->axis[1][k] +
			q[2] * v->axis[2][k];
	vf scale = focal_px / at[2];
	return (struct lane_points){ middle_x + at[0] * scale, middle_y + at[1] * scale, at[2],
		scale };
}

typedef uint16_t vs __attribute__((vector_size(16)));
typedef uint16_t vs_loose __attribute__((vector_size(16), aligned(2), may_alias));

/* Eight in a row. */
INLINE vf load_u16(const uint16_t *at)
{
	vs v = *(const vs_loose *)at;
	return __builtin_convertvector(__builtin_convertvector(v, vi), vf);
}

#endif
