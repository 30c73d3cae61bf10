#include "render/gles-draw-private.h"
#include "render/stipple-quadtree.h"
#include "render/stipple-texture.h"
#include <float.h>
#include <string.h>

/* Of a view: few of them have more points than these have threads. */
#define GROUPS     4
#define SPOT_BYTES 12

/* Of stipple.glsl. */
enum { PLANE = 3, GRID, KEYS, SHARE, TREE_OF, REACH, ALL_SPOTS = 10 };

/* ---- kept ---- */

static void forget(const gles_context *c, struct gles_stippled *s)
{
	g_clear_pointer(&s->plan, stipple_plan_free);
	gles_buffer_clear(c, &s->parts);
	gles_buffer_clear(c, &s->eye);
	gles_buffer_clear(c, &s->light);
}

void gles_stipple_clear(const gles_context *c, struct gles_stipple *s)
{
	for (int n = 0; n < FRAME_LAYERS_MAX; n++)
		forget(c, &s->layer[n]);
	gles_buffer_clear(c, &s->texture[0]);
	gles_buffer_clear(c, &s->texture[1]);
	gles_buffer_clear(c, &s->tree);
	gles_buffer_clear(c, &s->views);
	gles_views_clear(c, &s->seen);
}

static bool upload_parts(
	const gles_context *c, struct gles_stippled *s, const frame *f, GError **error)
{
	const stipple_plan *p = s->plan;
	g_autofree uint32_t(*part)[4] = g_malloc0_n(f->scene->chunks + 1, sizeof *part);
	for (uint32_t n = 0; n < f->scene->chunks; n++) {
		uint32_t word[4] = { p->slot[n], p->part[n], p->is_lit[n] };
		memcpy(&word[3], &p->light_scale[n], sizeof word[3]);
		memcpy(part[n], word, sizeof word);
	}
	return gles_buffer_put(
		c, &s->parts, part, f->scene->chunks * sizeof *part, "the chunks", error);
}

static bool reserve_texture(gles_draw *d, const struct stipple_plane *p, GError **error)
{
	int64_t bytes = (int64_t)p->pitch * p->rows * 4;
	for (int n = 0; n < 2; n++)
		if (!gles_buffer_reserve(
			    d->c, &d->stipple.texture[n], bytes, "the depths of points", error))
			return false;
	return true;
}

/* ---- points on a plane ---- */

/* What the program asks of it. */
static void set_plane(const gles_draw *d, enum gles_use use, const struct stipple_plane *p)
{
	const struct gles_functions *gl = &d->c->gl;
	gl->UseProgram(d->program[use]);
	if (use == GLES_STIPPLE_PUT || use == GLES_STIPPLE_DECIDE)
		gl->Uniform4f(PLANE, p->scale, p->middle[0], p->middle[1], p->near_m);
	if (use == GLES_STIPPLE_PUT)
		gl->Uniform1f(REACH, fminf(p->far_m, FLT_MAX));
	if (use == GLES_STIPPLE_DECIDE)
		return;
	gl->Uniform4i(GRID, p->columns, p->rows, p->pitch, p->is_parallel);
	gl->Uniform4i(KEYS, p->low, p->shift, p->step, stipple_rings(p));
}

static void barrier(const gles_draw *d)
{
	d->c->gl.MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

/* Runs of views: a program for all their points. */
static void go_through(const gles_draw *d, GArray *runs)
{
	const struct gles_functions *gl = &d->c->gl;
	for (guint k = 0; k < runs->len; k++) {
		const struct gles_run *r = &g_array_index(runs, struct gles_run, k);
		gles_draw_bind_storage(d, 0, d->scene.slab[r->slab].points);
		for (uint32_t n = 0; n < r->count; n += GLES_GROUPS_MAX) {
			gl->Uniform1ui(0, r->first + n);
			gl->DispatchCompute(GROUPS, MIN(r->count - n, GLES_GROUPS_MAX), 1);
		}
	}
	barrier(d);
}

/* So often that the first texture holds it in the end. */
static void spread(gles_draw *d, const struct stipple_plane *p)
{
	struct gles_buffer *t = d->stipple.texture;
	set_plane(d, GLES_STIPPLE_SPREAD, p);
	for (uint32_t n = 0; n < p->passes; n++) {
		gles_draw_bind_storage(d, 6, t[0].name);
		gles_draw_bind_storage(d, 5, t[1].name);
		d->c->gl.DispatchCompute(
			(GLuint)(p->columns + 15) / 16, (GLuint)(p->rows + 15) / 16, 1);
		barrier(d);
		struct gles_buffer spread_into = t[1];
		t[1] = t[0];
		t[0] = spread_into;
	}
}

static void put(gles_draw *d, const struct gles_stippled *s, const struct stipple_plane *p,
	GLuint views, GLuint spots, GArray *runs)
{
	uint32_t texels = (uint32_t)(p->pitch * p->rows);
	for (int n = 0; n < 2; n++)
		gles_draw_fill(d, &d->stipple.texture[n], texels, STIPPLE_EMPTY);
	set_plane(d, GLES_STIPPLE_PUT, p);
	gles_draw_bind_storage(d, 1, views);
	gles_draw_bind_storage(d, 2, s->parts.name);
	gles_draw_bind_storage(d, 3, spots);
	gles_draw_bind_storage(d, 6, d->stipple.texture[0].name);
	go_through(d, runs);
	spread(d, p);
}

static void set_tree(const gles_draw *d, const stipple_plan *p, bool is_lit)
{
	d->c->gl.Uniform4ui(TREE_OF, p->levels, p->level, (GLuint)p->light_plane.pitch, is_lit);
}

static void ask(gles_draw *d, const struct gles_stippled *s, const struct stipple_plane *p,
	GLuint spots, GArray *runs, bool to_tree)
{
	set_plane(d, GLES_STIPPLE_ASK, p);
	set_tree(d, s->plan, to_tree);
	gles_draw_bind_storage(d, 3, spots);
	gles_draw_bind_storage(d, 4, s->light.name);
	gles_draw_bind_storage(d, 5, d->stipple.tree.name);
	gles_draw_bind_storage(d, 6, d->stipple.texture[0].name);
	go_through(d, runs);
}

/* ---- the light ---- */

static void describe(const frame *f, const stipple_plan *p, const struct gles_slab *slab,
	uint32_t chunk, struct gles_view *ret)
{
	const struct scene_chunk *c = &f->scene->chunk[chunk];
	struct chunk_view v;
	stipple_plane_view(&p->light, f->scene, c, &v);
	*ret = (struct gles_view){ .at = { c->first - slab->first, scene_id(f->scene, c->first),
					   c->count },
		.pipeline = { 0, chunk } };
	memcpy(ret->base, v.base, sizeof v.base);
	for (int k = 0; k < 3; k++)
		memcpy(ret->axis[k], v.axis[k], sizeof v.axis[k]);
}

/* A run for each slab; free it. NULL: no room. */
static GArray *view_from_light(
	gles_draw *d, const struct gles_stippled *s, const frame *f, GError **error)
{
	g_autoptr(GArray) runs = g_array_new(FALSE, TRUE, sizeof(struct gles_run));
	g_autofree struct gles_view *view = g_new(struct gles_view, f->scene->chunks + 1);
	uint32_t count = 0;
	for (uint32_t k = 0; k < d->scene.slabs; k++) {
		const struct gles_slab *slab = &d->scene.slab[k];
		struct gles_run run = { .slab = k, .first = count };
		for (uint32_t n = 0; n < f->scene->chunks; n++)
			if (s->plan->is_lit[n] &&
				gles_scene_slab(&d->scene, &f->scene->chunk[n]) == k)
				describe(f, s->plan, slab, n, &view[count++]);
		run.count = count - run.first;
		g_array_append_val(runs, run);
	}
	if (!gles_buffer_put(
		    d->c, &d->stipple.views, view, count * sizeof *view, "the chunks", error))
		return NULL;
	return g_steal_pointer(&runs);
}

static bool look_from_light(
	gles_draw *d, const struct gles_stippled *s, const frame *f, GError **error)
{
	const struct stipple_plane *p = &s->plan->light_plane;
	g_autoptr(GArray) runs = view_from_light(d, s, f, error);
	if (!runs || !reserve_texture(d, p, error))
		return false;
	put(d, s, p, d->stipple.views.name, s->light.name, runs);
	ask(d, s, p, s->light.name, runs, false);
	return true;
}

static bool is_lit(const struct gles_stippled *s, const frame *f)
{
	return f->light.amount > 0 && s->plan->light_plane.columns;
}

static void tell_spots(const gles_draw *d, const struct gles_stippled *s, const frame *f)
{
	static const enum gles_use uses[] = { GLES_STIPPLE_PUT, GLES_STIPPLE_ASK,
		GLES_STIPPLE_DECIDE, GLES_STIPPLE_COUNT, GLES_STIPPLE_WRITE };
	for (size_t n = 0; n < G_N_ELEMENTS(uses); n++) {
		d->c->gl.UseProgram(d->program[uses[n]]);
		d->c->gl.Uniform1ui(ALL_SPOTS, s->plan->slot[f->scene->chunks]);
	}
}

/* What is the same for all eyes. */
static bool begin(gles_draw *d, struct gles_stippled *s, const frame *f, GError **error)
{
	int64_t bytes = ((int64_t)s->plan->slot[f->scene->chunks] + 1) * SPOT_BYTES,
		tree = (int64_t)8 << (2 * s->plan->levels);
	return upload_parts(d->c, s, f, error) &&
	       gles_buffer_reserve(d->c, &s->eye, bytes, "the points", error) &&
	       gles_buffer_reserve(d->c, &s->light, bytes, "the points", error) &&
	       gles_buffer_reserve(d->c, &d->stipple.tree, tree, "the light", error) &&
	       (!is_lit(s, f) || look_from_light(d, s, f, error));
}

/* ---- the eye ---- */

static void fill_tree(gles_draw *d, const stipple_plan *p)
{
	const struct gles_functions *gl = &d->c->gl;
	gl->UseProgram(d->program[GLES_STIPPLE_TREE]);
	gles_draw_bind_storage(d, 5, d->stipple.tree.name);
	for (uint32_t level = p->levels; level > 0; level--) {
		GLuint groups = ((1u << (level - 1)) + 15) / 16;
		gl->Uniform4ui(TREE_OF, p->levels, level - 1, 0, 0);
		gl->DispatchCompute(groups, groups, 1);
		barrier(d);
	}
}

static void decide(gles_draw *d, const struct gles_stippled *s, const frame *f,
	const struct stipple_plane *eye, uint32_t layer)
{
	set_plane(d, GLES_STIPPLE_DECIDE, eye);
	set_tree(d, s->plan, is_lit(s, f));
	d->c->gl.Uniform4f(SHARE, (float)stipple_around(eye),
		(float)stipple_around(&s->plan->light_plane), f->layer[layer].stipple->epsilon,
		s->plan->apart_m);
	go_through(d, d->views.runs);
	d->c->gl.UseProgram(d->program[GLES_STIPPLE_WRITE]);
	d->c->gl.Uniform4f(SHARE, 0, 0, 0, s->plan->apart_m);
}

/* What the eye sees is told by all that the whole picture shows, so that windows of it fit together. */
static bool look_from_eye(
	gles_draw *d, struct gles_stippled *s, const frame *f, uint32_t layer, GError **error)
{
	bool is_window = camera_is_window(&f->camera);
	frame whole = frame_of_whole(f);
	const gles_views *seen = is_window ? &d->stipple.seen : &d->views;
	g_autofree struct chunk_view *views = NULL;
	uint32_t count;
	if (is_window) {
		views = chunk_views_new(&whole, &count);
		if (!gles_views_fill(
			    d->c, &d->stipple.seen, &whole, &d->scene, views, count, error))
			return false;
	}
	struct stipple_plane eye = stipple_plan_eye(s->plan, &whole, seen->view, seen->count);
	if (!reserve_texture(d, &eye, error))
		return false;
	if (is_lit(s, f))
		gles_draw_fill(d, &d->stipple.tree, 2u << (2 * s->plan->levels), STIPPLE_EMPTY);
	put(d, s, &eye, seen->buffer.name, s->eye.name, seen->runs);
	ask(d, s, &eye, s->eye.name, seen->runs, is_lit(s, f));
	if (is_lit(s, f))
		fill_tree(d, s->plan);
	gles_draw_bind_storage(d, 1, d->views.buffer.name);
	decide(d, s, f, &eye, layer);
	return true;
}

bool gles_draw_stipple(gles_draw *d, const frame *f, uint32_t layer, GError **error)
{
	struct gles_stippled *s = &d->stipple.layer[layer];
	bool is_kept = stipple_plan_is_of(s->plan, f, layer);
	if (!is_kept) {
		forget(d->c, s);
		s->plan = stipple_plan_new(f, layer);
	}
	tell_spots(d, s, f);
	if (!is_kept && !begin(d, s, f, error)) {
		forget(d->c, s);
		return false;
	}
	return look_from_eye(d, s, f, layer, error);
}
