#include "render/stipple-plan.h"
#include "process/lanes.h"
#include "render/stipple-quadtree.h"
#include <stdlib.h>

/* Of a parallel light, in radii: depths are even there. And the nearest that another one comes. */
#define FAR_AWAY    8.0
#define NEAREST     1.1
#define PASSES_MOST 16u
/* Gaps among so many of the points are closed; points that lie by chance have gaps so much wider than their mean distance. */
#define CLOSED_PART 0.9
#define GAP         2.f
/* Of the eye's plane. */
#define COLUMNS_MOST 8192
/* Points of a chunk that tell how far they are apart. */
#define ASKED 64u

/* ---- which points ---- */

static bool is_stippled(const frame *f, const struct scene_chunk *c)
{
	const struct pipeline *p = frame_pipeline(f, f->drawing->pipeline_of[c->leaf]);
	for (uint32_t n = 0; n < p->layers; n++)
		if (p->steps[n].kind == step_kind_find("stipple"))
			return true;
	return false;
}

static float spacing_of(const scene *s, const struct scene_chunk *c, float apart_m)
{
	double squares = 0;
	uint32_t asked = MIN(c->count, ASKED);
	for (uint32_t i = 0; i < asked; i++)
		squares += (double)s->place[c->first + i].spacing * s->place[c->first + i].spacing;
	return (float)sqrt(squares / MAX(asked, 1)) * apart_m;
}

static void take_part(stipple_plan *p, const frame *f)
{
	const scene *s = f->scene;
	float coarser = f->ink_px / f->px, most = f->layer[p->layer].stipple->most_points * 1000;
	float part = fminf(most / (float)MAX(s->count, 1u), 1) / (coarser * coarser);
	p->apart_m = s->unit_m / sqrtf(part);
	p->slot = g_new0(uint32_t, s->chunks + 1);
	p->part = g_new0(uint32_t, s->chunks + 1);
	p->spacing_m = g_new0(float, s->chunks + 1);
	p->is_lit = g_new0(bool, s->chunks + 1);
	for (uint32_t n = 0; n < s->chunks; n++) {
		const struct scene_chunk *c = &s->chunk[n];
		p->part[n] = MIN((uint32_t)ceilf(part * (float)c->count), c->count);
		p->slot[n + 1] = p->slot[n] + (p->part[n] + LANES - 1) / LANES * LANES;
		p->spacing_m[n] = spacing_of(s, c, p->apart_m);
		p->is_lit[n] = is_stippled(f, c);
	}
}

/* ---- how often depths are spread ---- */

/* Points by how many passes close the gaps between them. */
struct gaps {
	uint64_t points[PASSES_MOST + 1], all;
};

/* points that are so far apart. So many passes are squares of 2 passes + 1. */
static void add_gaps(struct gaps *g, float texels, uint32_t points)
{
	g->points[(uint32_t)CLAMP(ceilf((texels * GAP - 1) / 2), 1, PASSES_MOST)] += points;
	g->all += points;
}

/* As often as closes the gaps of most points. */
static uint32_t passes_for(const stipple_plan *p, const frame *f, const struct gaps *g)
{
	uint64_t sum = 0;
	uint32_t n = 1;
	if (f->layer[p->layer].stipple->passes >= 0.5f)
		return (uint32_t)(f->layer[p->layer].stipple->passes + 0.5f);
	while (n < PASSES_MOST && (double)(sum += g->points[n]) < CLOSED_PART * (double)g->all)
		n++;
	return n;
}

/* ---- the light ---- */

static void bound_site(
	const stipple_plan *p, const scene *s, double ret_middle_m[3], double *ret_radius_m)
{
	double radius2 = 0;
	for (int k = 0; k < 3; k++) {
		double low = INFINITY, high = -INFINITY;
		for (uint32_t n = 0; n < s->chunks; n++)
			if (p->is_lit[n]) {
				const struct scene_chunk *c = &s->chunk[n];
				low = fmin(low, c->centre_m[k] - c->half_m[k]);
				high = fmax(high, c->centre_m[k] + c->half_m[k]);
			}
		if (!(low <= high))
			low = high = 0;
		ret_middle_m[k] = s->origin_m[k] + (low + high) / 2;
		radius2 += (high - low) * (high - low) / 4;
	}
	*ret_radius_m = fmax(sqrt(radius2), 1e-3);
}

static void cross(const double a[3], const double b[3], double ret[3])
{
	for (int k = 0; k < 3; k++)
		ret[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

/* Looking at the middle; straight from above the site's y axis is up. */
static struct camera look_from(const double from[3], const double middle_m[3], double away_m)
{
	struct camera c = { .near_m = CAMERA_NEAR_M, .far_m = CAMERA_FAR_M };
	double level = hypot(from[0], from[1]);
	c.right[0] = level > 1e-6 ? -from[1] / level : 1;
	c.right[1] = level > 1e-6 ? from[0] / level : 0;
	for (int k = 0; k < 3; k++) {
		c.forward[k] = -from[k];
		c.eye_m[k] = middle_m[k] + away_m * from[k];
	}
	cross(c.forward, c.right, c.down);
	return c;
}

/* Of what the light sees: along right and down, as places or as slopes, and how deep. */
struct extent {
	float low[3], high[3];
};

/* Of the points themselves: boxes around them reach much farther. */
static void bound_chunk(const scene *s, const struct chunk_view *v, uint32_t count,
	bool is_parallel, struct extent *e)
{
	for (uint32_t i = v->chunk->first; i < v->chunk->first + count; i++) {
		float at[3];
		for (int k = 0; k < 3; k++)
			at[k] = v->base[k] + (float)s->place[i].q[0] * v->axis[0][k] +
				(float)s->place[i].q[1] * v->axis[1][k] +
				(float)s->place[i].q[2] * v->axis[2][k];
		float per_depth = is_parallel ? 1 : 1 / at[2];
		at[0] *= per_depth;
		at[1] *= per_depth;
		for (int k = 0; k < 3; k++) {
			e->low[k] = fminf(e->low[k], at[k]);
			e->high[k] = fmaxf(e->high[k], at[k]);
		}
	}
}

static const struct extent nothing = { { INFINITY, INFINITY, INFINITY },
	{ -INFINITY, -INFINITY, -INFINITY } };

static struct extent extent_of(const stipple_plan *p, const frame *f)
{
	uint32_t chunks = f->scene->chunks;
	g_autofree struct extent *each = g_new(struct extent, chunks + 1);
#pragma omp parallel for schedule(dynamic, 8) if (!f->single_thread)
	for (uint32_t n = 0; n < chunks; n++) {
		struct chunk_view v;
		each[n] = nothing;
		if (!p->is_lit[n])
			continue;
		stipple_plane_view(&p->light, f->scene, &f->scene->chunk[n], &v);
		bound_chunk(f->scene, &v, p->part[n], p->light_plane.is_parallel, &each[n]);
	}
	struct extent all = nothing;
	for (uint32_t n = 0; n < chunks; n++)
		for (int k = 0; k < 3; k++) {
			all.low[k] = fminf(all.low[k], each[n].low[k]);
			all.high[k] = fmaxf(all.high[k], each[n].high[k]);
		}
	return all;
}

/* Its plane frames all that it sees. */
static void frame_site(stipple_plan *p, const frame *f)
{
	struct stipple_plane *plane = &p->light_plane;
	struct extent e = extent_of(p, f);
	float texels = (float)(1u << p->levels);
	if (!(e.low[2] <= e.high[2]))
		return;
	stipple_plane_set_size(plane, (int32_t)texels, (int32_t)texels);
	float side = fmaxf(fmaxf(e.high[0] - e.low[0], e.high[1] - e.low[1]) * 1.002f, 1e-6f);
	plane->scale = texels / side;
	for (int k = 0; k < 2; k++)
		plane->middle[k] =
			STIPPLE_BORDER + texels / 2 - (e.low[k] + e.high[k]) / 2 * plane->scale;
	stipple_plane_set_depths(plane, fmaxf(e.low[2] * 0.999f, 1e-4f), e.high[2] * 1.001f,
		f->layer[p->layer].stipple->behind_px);
}

static void set_light(stipple_plan *p, const frame *f)
{
	const struct stipple_step *step = f->layer[p->layer].stipple;
	double middle_m[3], radius_m;
	bound_site(p, f->scene, middle_m, &radius_m);
	p->light_plane.is_parallel = step->light_distance <= 0;
	double radii =
		p->light_plane.is_parallel ? FAR_AWAY : fmax((double)step->light_distance, NEAREST);
	p->light = look_from(f->light.site_from, middle_m, radii * radius_m);
	frame_site(p, f);
}

static void set_light_passes(stipple_plan *p, const frame *f)
{
	struct gaps g = { 0 };
	p->light_scale = g_new0(float, f->scene->chunks + 1);
	for (uint32_t n = 0; n < f->scene->chunks; n++) {
		struct chunk_view v;
		stipple_plane_view(&p->light, f->scene, &f->scene->chunk[n], &v);
		float scale = p->light_plane.scale;
		if (!p->light_plane.is_parallel)
			scale /= fmaxf((v.near_m + v.far_m) / 2, 1e-3f);
		p->light_scale[n] = scale;
		if (p->is_lit[n])
			add_gaps(&g, p->spacing_m[n] * scale, p->part[n]);
	}
	p->light_plane.passes = passes_for(p, f, &g);
}

/* ---- all ---- */

stipple_plan *stipple_plan_new(const frame *f, uint32_t layer)
{
	stipple_plan *p = g_new0(stipple_plan, 1);
	uint32_t coarser = (uint32_t)lroundf(log2f(f->ink_px / f->px)),
		 level = (uint32_t)lroundf(f->layer[layer].stipple->level);
	p->serial = f->serial;
	p->turn = f->scene->turn;
	p->layer = layer;
	p->levels = STIPPLE_LEVELS_MOST - MIN(coarser, STIPPLE_LEVELS_MOST - 1);
	p->level = level - MIN(coarser, level);
	take_part(p, f);
	set_light(p, f);
	set_light_passes(p, f);
	return p;
}

void stipple_plan_free(stipple_plan *p)
{
	if (!p)
		return;
	g_free(p->slot);
	g_free(p->part);
	g_free(p->spacing_m);
	g_free(p->light_scale);
	g_free(p->is_lit);
	g_free(p);
}

/* Pixels of the picture to a texel: as many as strokes are larger, and more where the picture is very wide. */
static float texel_px(const frame *f)
{
	return fmaxf(f->ink_px, (float)f->camera.width / COLUMNS_MOST);
}

struct stipple_plane stipple_plan_eye(
	const stipple_plan *p, const frame *f, const struct chunk_view *views, uint32_t count)
{
	const struct camera *c = &f->camera;
	float px = texel_px(f);
	bool is_parallel = c->parallel_m > 0;
	struct stipple_plane eye = { .is_parallel = is_parallel, .scale = (float)c->focal_px / px };
	float far_m = (float)c->near_m, near_m = INFINITY;
	int32_t columns = (int32_t)ceilf((float)c->width / px),
		rows = (int32_t)ceilf((float)c->height / px);
	struct gaps g = { 0 };
	stipple_plane_set_size(&eye, columns, rows);
	eye.middle[0] = STIPPLE_BORDER + (float)c->width / 2 / px;
	eye.middle[1] = STIPPLE_BORDER + (float)c->height / 2 / px;
	for (uint32_t n = 0; n < count; n++) {
		const struct chunk_view *v = &views[n];
		uint32_t chunk = (uint32_t)(v->chunk - f->scene->chunk);
		float middle_m = fmaxf((v->near_m + v->far_m) / 2, (float)c->near_m);
		float scale = eye.scale / camera_scale_f(c, middle_m);
		add_gaps(&g, p->spacing_m[chunk] * scale, p->part[chunk]);
		near_m = fminf(near_m, v->near_m);
		far_m = fmaxf(far_m, v->far_m);
	}
	eye.passes = passes_for(p, f, &g);
	if (is_parallel)
		eye.scale /= (float)c->parallel_m;
	stipple_plane_set_depths(
		&eye, fminf(near_m, far_m), far_m, f->layer[p->layer].stipple->behind_px);
	eye.far_m = lens_of(c).far_m;
	return eye;
}
