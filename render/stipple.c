#include "render/stipple.h"
#include "render/large.h"
#include "render/stipple-quadtree.h"
#include "render/stipple-texture.h"
#include <string.h>

#define ALPHA_LEAST (1 / 255.f)
/* Instead of a count. */
enum { UNSEEN = 255 };

/* What a plane has of all points that take part, by their slots. */
struct spots {
	int32_t *place, *key;
	uint8_t *count; /* of texels around that hold its own depth; or UNSEEN */
};

struct stipple {
	stipple_plan *plan; /* NULL: nothing was looked at yet */
	struct stipple_plane eye_plane;
	struct stipple_texture eye_texture, light_texture;
	struct stipple_quadtree tree;
	struct spots eye, light;
	void *memory; /* of the spots */
	bool is_lit;  /* the style has a light */
};

stipple *stipple_new(void)
{
	return g_new0(stipple, 1);
}

static void forget(stipple *s)
{
	stipple_plan_free(s->plan);
	large_free(s->memory);
	s->plan = NULL;
	s->memory = NULL;
}

void stipple_free(stipple *s)
{
	if (!s)
		return;
	forget(s);
	stipple_texture_clear(&s->eye_texture);
	stipple_texture_clear(&s->light_texture);
	stipple_quadtree_clear(&s->tree);
	g_free(s);
}

/* ---- points on a plane ---- */

static void take_spots(struct spots *s, char **at, size_t slots)
{
	s->place = large_take(at, slots * sizeof *s->place);
	s->key = large_take(at, slots * sizeof *s->key);
	s->count = large_take(at, slots);
}

static void put(const struct stipple_texture *t, const struct stipple_plane *p,
	const struct spots *s, const frame *f, const struct chunk_view *v, uint32_t slot,
	uint32_t part)
{
	LANES_OF(f->lanes, stipple_project)(p, f->scene, v, part, s->place + slot, s->key + slot);
	for (uint32_t i = slot; i < slot + part; i++)
		if (s->place[i] >= 0)
			stipple_lower(&t->key[s->place[i]], s->key[i]);
}

static void ask(const struct stipple_texture *t, const struct stipple_plane *p,
	const struct spots *s, uint32_t slot, uint32_t part, bool counted)
{
	for (uint32_t i = slot; i < slot + part; i++) {
		int32_t place = s->place[i], key = s->key[i];
		if (place < 0 || !stipple_is_seen(t, place, key))
			s->count[i] = UNSEEN;
		else
			s->count[i] = counted ? (uint8_t)stipple_count(t, p, place, key) : 0;
	}
}

/* ---- the light ---- */

/* All that takes part of the site, on the light's plane. */
static void look_from_light(stipple *s, const frame *f)
{
	const stipple_plan *p = s->plan;
	const struct stipple_plane *plane = &p->light_plane;
	uint32_t chunks = f->scene->chunks;
	stipple_texture_begin(&s->light_texture, plane, f->single_thread);
#pragma omp parallel for schedule(dynamic, 8) if (!f->single_thread)
	for (uint32_t n = 0; n < chunks; n++) {
		struct chunk_view v;
		if (!p->is_lit[n])
			continue;
		stipple_plane_view(&p->light, f->scene, &f->scene->chunk[n], &v);
		put(&s->light_texture, plane, &s->light, f, &v, p->slot[n], p->part[n]);
	}
	stipple_texture_spread(&s->light_texture, plane, f->lanes, f->single_thread);
#pragma omp parallel for schedule(dynamic, 8) if (!f->single_thread)
	for (uint32_t n = 0; n < chunks; n++)
		if (p->is_lit[n])
			ask(&s->light_texture, plane, &s->light, p->slot[n], p->part[n], true);
}

static void renew(stipple *s, const frame *f, uint32_t layer)
{
	if (stipple_plan_is_of(s->plan, f, layer))
		return;
	forget(s);
	s->plan = stipple_plan_new(f, layer);
	size_t slots = (size_t)s->plan->slot[f->scene->chunks] + LANES;
	char *at = s->memory =
		large_new(4 * large_part(slots * sizeof(int32_t)) + 2 * large_part(slots));
	take_spots(&s->eye, &at, slots);
	take_spots(&s->light, &at, slots);
	s->is_lit = f->light.amount > 0 && s->plan->light_plane.columns;
	if (s->is_lit)
		look_from_light(s, f);
}

/* ---- the eye ---- */

static uint32_t chunk_of(const frame *f, const struct chunk_view *v)
{
	return (uint32_t)(v->chunk - f->scene->chunk);
}

static void look_from_eye(
	stipple *s, const frame *f, const struct chunk_view *views, uint32_t count)
{
	const stipple_plan *p = s->plan;
	s->eye_plane = stipple_plan_eye(p, f, views, count);
	stipple_texture_begin(&s->eye_texture, &s->eye_plane, f->single_thread);
#pragma omp parallel for schedule(dynamic, 8) if (!f->single_thread)
	for (uint32_t n = 0; n < count; n++) {
		uint32_t chunk = chunk_of(f, &views[n]);
		put(&s->eye_texture, &s->eye_plane, &s->eye, f, &views[n], p->slot[chunk],
			p->part[chunk]);
	}
	stipple_texture_spread(&s->eye_texture, &s->eye_plane, f->lanes, f->single_thread);
}

static uint32_t texel_of(const stipple *s, uint32_t level, int32_t place)
{
	const struct stipple_plane *p = &s->plan->light_plane;
	return (uint32_t)stipple_quadtree_place(s->plan->levels, level,
		(uint32_t)(place % p->pitch - STIPPLE_BORDER),
		(uint32_t)(place / p->pitch - STIPPLE_BORDER));
}

/* Those that are seen, of leaves that the light sees. */
static void put_in_tree(stipple *s, uint32_t slot, uint32_t part)
{
	for (uint32_t i = slot; i < slot + part; i++)
		if (s->eye.count[i] != UNSEEN && s->light.place[i] >= 0)
			stipple_lower(&s->tree.key[texel_of(s, s->plan->levels, s->light.place[i])],
				s->light.key[i]);
}

static void look(
	stipple *s, const frame *f, uint32_t layer, const struct chunk_view *views, uint32_t count)
{
	renew(s, f, layer);
	look_from_eye(s, f, views, count);
	if (s->is_lit)
		stipple_quadtree_begin(&s->tree, s->plan->levels, f->single_thread);
#pragma omp parallel for schedule(dynamic, 8) if (!f->single_thread)
	for (uint32_t n = 0; n < count; n++) {
		uint32_t chunk = chunk_of(f, &views[n]), slot = s->plan->slot[chunk],
			 part = s->plan->part[chunk];
		if (!s->plan->is_lit[chunk])
			continue;
		ask(&s->eye_texture, &s->eye_plane, &s->eye, slot, part, s->is_lit);
		if (s->is_lit)
			put_in_tree(s, slot, part);
	}
	if (s->is_lit)
		stipple_quadtree_fill(&s->tree, f->single_thread);
}

void stipple_look(
	stipple *s, const frame *f, uint32_t layer, const struct chunk_view *views, uint32_t count)
{
	if (!camera_is_window(&f->camera)) {
		look(s, f, layer, views, count);
		return;
	}
	/* Which dots there are is told by all that the picture shows, so that windows of it fit together. */
	frame whole = frame_of_whole(f);
	uint32_t whole_count;
	g_autofree struct chunk_view *all = chunk_views_new(&whole, &whole_count);
	look(s, &whole, layer, all, whole_count);
}

/* ---- what is drawn ---- */

/* A point that may be drawn. */
struct dot {
	uint32_t chunk, point, slot;
	float at_m[3]; /* as the camera sees it */
};

/* A count as part of those that a surface which faces the plane gives to each of its points, at most all around. */
static float share_of(uint32_t count, const struct stipple_plane *p, float wide)
{
	float most = (float)stipple_around(p);
	return (float)count / fminf(fmaxf(wide * wide, 1), most);
}

static bool is_highlight(
	const stipple *s, const frame *f, const struct stipple_step *step, const struct dot *d)
{
	float apart_m = (float)f->scene->place[d->point].spacing * s->plan->apart_m;
	float light = share_of(s->light.count[d->slot], &s->plan->light_plane,
		      apart_m * s->plan->light_scale[d->chunk]),
	      eye = share_of(s->eye.count[d->slot], &s->eye_plane,
		      apart_m * s->eye_plane.scale / (s->eye_plane.is_parallel ? 1 : d->at_m[2]));
	return step->epsilon > 0 && light - eye > step->epsilon;
}

static bool is_left_out(
	const stipple *s, const frame *f, const struct stipple_step *step, const struct dot *d)
{
	if (!s->is_lit || s->light.count[d->slot] == UNSEEN)
		return false;
	uint32_t texel = texel_of(s, s->plan->level, s->light.place[d->slot]);
	return s->tree.key[texel] == s->light.key[d->slot] || is_highlight(s, f, step, d);
}

static struct dot find(
	const stipple *s, const frame *f, const struct chunk_view *v, uint32_t chunk, uint32_t i)
{
	struct dot d = { chunk, v->chunk->first + i, s->plan->slot[chunk] + i };
	const uint16_t *q = f->scene->place[d.point].q;
	for (int k = 0; k < 3; k++)
		d.at_m[k] = v->base[k] + (float)q[0] * v->axis[0][k] + (float)q[1] * v->axis[1][k] +
			    (float)q[2] * v->axis[2][k];
	return d;
}

/* Dots as large as the points are apart, within what may be. */
static float radius_of(
	const stipple *s, const frame *f, const struct frame_layer *l, const struct dot *d)
{
	float apart_px = (float)f->scene->place[d->point].spacing * s->plan->apart_m *
			 (float)f->camera.focal_px / camera_scale_f(&f->camera, d->at_m[2]);
	float growth = apart_px / (STIPPLE_APART * l->ink.length_px);
	return l->ink.length_px / 2 * fminf(fmaxf(growth, 1), l->ink.grow);
}

static struct stroke stroke_of(const stipple *s, const frame *f, const struct frame_layer *l,
	const struct dot *d, bool left_out)
{
	float half_px = radius_of(s, f, l, d),
	      scale = (float)f->camera.focal_px / camera_scale_f(&f->camera, d->at_m[2]);
	struct stroke one = { .x_px = (float)camera_middle_x(&f->camera) + d->at_m[0] * scale,
		.y_px = (float)camera_middle_y(&f->camera) + d->at_m[1] * scale,
		.along = { 1, 0 },
		.half_length_px = half_px,
		.half_width_px = half_px,
		.alpha = l->ink.opacity * (left_out ? 1 - f->light.amount : 1) *
			 (1 - f->focus.amount * frame_away(&f->focus, d->at_m, l->is_focus)),
		.q = 1 / d->at_m[2],
		.point = scene_id(f->scene, d->point) };
	memcpy(one.rgb, l->ink.ink, 3);
	return one;
}

void stipple_draw(
	const stipple *s, const frame *f, const struct chunk_view *v, struct stroke_chain *to)
{
	const struct frame_layer *l = &f->layer[s->plan->layer];
	uint32_t chunk = chunk_of(f, v);
	for (uint32_t i = 0; i < s->plan->part[chunk]; i++) {
		struct dot d = find(s, f, v, chunk, i);
		if (s->eye.count[d.slot] == UNSEEN)
			continue;
		struct stroke one = stroke_of(s, f, l, &d, is_left_out(s, f, l->stipple, &d));
		if (one.alpha < ALPHA_LEAST)
			continue;
		stroke_chain_add(to, &one);
	}
}
