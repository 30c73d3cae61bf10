#ifndef RENDER_STROKE_BRUSH_H
#define RENDER_STROKE_BRUSH_H
/* A layer as one chunk draws it, and what a point's surface looks like from the camera: where it goes on the screen, at what angle it
 * is seen, along what its edge runs. Internal to stroke.c; all is inlined. */
#include "process/vector3.h"
#include "render/stroke.h"
#include <math.h>

/* A surface seen at a lower cosine counts as seen at this one. */
#define COSINE_LEAST 0.05f
/* Of points without a normal. */
#define COSINE_UNKNOWN 0.5f
#define UNIT_M         1e-4f /* of the scene's lengths */

/* A layer as one chunk draws it. */
struct brush {
	const frame *f;
	const struct frame_layer *layer;
	const struct chunk_view *view;
	const visibility_mask *mask;
	float focal_px, middle_x, middle_y, near_m;
	float turn[3][3]; /* site to camera: rows right, down, forward */
	float ray_most;   /* length of the longest ray of depth 1 */
	int kind;
	float wanted_most; /* need is this * (px_per_m * spacing)^2 at most, of points on surface */
	uint32_t list_from, list_count; /* of the kind in the chunk */
};

/* A point that may become a stroke. */
struct candidate {
	uint32_t point;
	float rank, spacing_m;
	float x_px, y_px, depth_m;
};

static inline float around_zero(uint32_t point, uint32_t salt)
{
	return 2 * stroke_chance(point, salt) - 1;
}

static inline void to_camera(const struct brush *b, const int16_t packed[2], float ret[3])
{
	float v[3];
	model_unpack_normal(packed, v);
	for (int k = 0; k < 3; k++)
		ret[k] = vector3_dot(b->turn[k], v);
}

/* The ray through a place on the screen, of depth 1. */
static inline void ray_of(const struct brush *b, const struct candidate *c, float ret[3])
{
	ret[0] = (c->x_px - b->middle_x) / b->focal_px;
	ret[1] = (c->y_px - b->middle_y) / b->focal_px;
	ret[2] = 1;
}

/* Of the angle that the surface is seen at, times how much longer the ray is than the depth: a square metre of it covers so many
 * (focal length / depth)^2. */
static inline float cosine_of(
	const struct brush *b, const struct candidate *c, const float normal[3])
{
	float ray[3];
	if (normal[0] == 0 && normal[1] == 0 && normal[2] == 0)
		return COSINE_UNKNOWN;
	ray_of(b, c, ray);
	return MAX(fabsf(vector3_dot(normal, ray)), COSINE_LEAST);
}

/* 1/depth over the screen, of the plane through the point. */
static inline void plane_slope(const struct brush *b, const struct candidate *c,
	const float normal[3], float reach_px, float ret[2])
{
	float ray[3], steepest = 0.5f / (c->depth_m * MAX(reach_px, 1));
	ray_of(b, c, ray);
	float away = vector3_dot(normal, ray) * c->depth_m * b->focal_px;
	for (int k = 0; k < 2; k++) {
		ret[k] = fabsf(away) > 1e-6f ? normal[k] / away : 0;
		ret[k] = CLAMP(ret[k], -steepest, steepest);
	}
}

/* The line through the point on the screen: unit, and pixels to a metre of it; 1/depth along it. */
struct line {
	float along[2], px_per_m, slope;
};

static inline bool line_of(const struct brush *b, const struct candidate *c, struct line *ret)
{
	float d[3], ray[3];
	const int16_t *packed = b->f->scene->direction[c->point];
	if (packed[0] == MODEL_NORMAL_NONE)
		return false;
	to_camera(b, packed, d);
	ray_of(b, c, ray);
	float scale = b->focal_px / c->depth_m;
	float x = (d[0] - ray[0] * d[2]) * scale, y = (d[1] - ray[1] * d[2]) * scale;
	float length = sqrtf(x * x + y * y);
	if (!(length > 1e-3f * scale))
		return false;
	ret->along[0] = x / length;
	ret->along[1] = y / length;
	ret->px_per_m = length;
	ret->slope = -d[2] / (c->depth_m * c->depth_m * length);
	return true;
}

/* Moves the point in its plane, inside the patch that it stands for. */
static inline void scatter(const struct brush *b, const float normal[3], struct candidate *c)
{
	/* Two axes of the plane (Duff et al. 2017, "Building an Orthonormal Basis, Revisited"). */
	float sign = normal[2] >= 0 ? 1 : -1, s = -1 / (sign + normal[2]),
	      t = normal[0] * normal[1] * s;
	float axis[2][3] = { { 1 + sign * normal[0] * normal[0] * s, sign * t, -sign * normal[0] },
		{ t, sign + normal[1] * normal[1] * s, -normal[1] } };
	float reach_m = b->layer->ink.scatter * b->f->scene->disc[c->point] * (UNIT_M / 2), at[3];
	ray_of(b, c, at);
	for (int k = 0; k < 3; k++)
		at[k] = at[k] * c->depth_m +
			reach_m * (around_zero(c->point, 5) * axis[0][k] +
					  around_zero(c->point, 6) * axis[1][k]);
	if (at[2] < b->near_m)
		return;
	c->depth_m = at[2];
	c->x_px = b->middle_x + b->focal_px * at[0] / at[2];
	c->y_px = b->middle_y + b->focal_px * at[1] / at[2];
}

#endif
