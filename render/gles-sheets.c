/* Frames with filters on a GPU: the stages of draw-sheets.c, over buffers. */
#include "render/gles-filter.h"
#include "render/sheet-plan.h"
#include <string.h>

enum { TAKE_ALL, TAKE_AWAY };                   /* of sheet-take.glsl */
enum { MERGE_BEGIN, MERGE_SHEET, MERGE_BLEND }; /* of sheet-merge.glsl */

struct sheets_job {
	gles_draw *d;
	const frame *f;
	struct gles_sheets *s;
	struct draw_times *t;
	bool is_timed;
	int64_t since_us;
	bool has_soft;
	bool wants_surface; /* the filters of the picture do */
	uint32_t width, height;
	GError *error;
};

void gles_sheets_clear(const gles_context *c, struct gles_sheets *s)
{
	struct gles_buffer *all = (struct gles_buffer *)(void *)s;
	for (size_t n = 0; n < sizeof *s / sizeof *all; n++)
		gles_buffer_clear(c, &all[n]);
}

static void lap(struct sheets_job *j, double *to)
{
	*to += gles_draw_lap(j->d, j->is_timed, &j->since_us);
}

static bool hold(struct sheets_job *j, struct gles_buffer *b, int64_t pixels, int64_t bytes)
{
	return !j->error &&
	       gles_buffer_reserve(j->d->c, b, pixels * bytes, "filters of a picture", &j->error);
}

static bool has_away(const frame *f)
{
	return f->focus.is_there && f->focus.filters > 0;
}

/* Filters of a box of the picture; what it is of is not there yet. */
static struct gles_filter_job job_of(struct sheets_job *j, const struct sheet_box *b)
{
	struct gles_filter_job ret = { .d = j->d,
		.f = j->f,
		.px = j->f->px,
		.time_s = j->f->time_s,
		.image = { .width = b->right - b->left,
			.height = b->bottom - b->top,
			.left = b->left,
			.top = b->top } };
	memcpy(ret.paper, j->f->drawing->whole.paper.colour, 3);
	return ret;
}

/* A pass of these shaders, which have buffers of their own. */
static void pass(struct sheets_job *j, struct gles_filter_job *on, const struct gles_pass *p)
{
	on->error = g_steal_pointer(&j->error);
	gles_pass_run(on, p);
	j->error = g_steal_pointer(&on->error);
}

/* ---- the picture of all ---- */

static void set_whole(const struct sheets_job *j, struct gles_pass *p, bool soft, bool surface)
{
	const struct gles_sheets *s = j->s;
	p->use = GLES_SHEET_MERGE;
	p->whole[0][0] = (int32_t)j->width;
	p->whole[0][2] = soft;
	p->whole[0][3] = surface;
	p->own[1] = s->whole.name;
	p->own[3] = s->whole_depth.name;
	p->own[5] = s->soft.name;
	p->own[7] = s->whole_surface.name;
}

static bool hold_whole(struct sheets_job *j)
{
	int64_t pixels = (int64_t)j->width * j->height;
	struct gles_sheets *s = j->s;
	return hold(j, &s->whole, pixels, 4) && hold(j, &s->whole_depth, pixels, 4) &&
	       hold(j, &s->joined, pixels, 4) && (!j->has_soft || hold(j, &s->soft, pixels, 8)) &&
	       (!j->wants_surface || hold(j, &s->whole_surface, pixels, 16));
}

/* Numbers of pipelines that sheet-take.glsl asks for. */
static void tell_pipelines(struct sheets_job *j)
{
	float told[256][4] = { { 0 } };
	for (guint n = 0; n < j->f->drawing->pipelines->len; n++) {
		struct sheet_depth d = sheet_depth_of(j->f, n);
		told[n][0] = d.offset_m;
		told[n][1] = d.per;
		told[n][2] = frame_pipeline(j->f, n)->is_focus;
	}
	if (!j->error)
		gles_buffer_put(j->d->c, &j->s->pushed, told, sizeof told, "filters of a picture",
			&j->error);
}

static void begin(struct sheets_job *j)
{
	struct sheet_box b = { 0, 0, j->width, j->height };
	struct gles_filter_job on = job_of(j, &b);
	struct gles_pass p = { .mode = MERGE_BEGIN };
	if (!hold_whole(j))
		return;
	tell_pipelines(j);
	set_whole(j, &p, j->has_soft, j->wants_surface);
	pass(j, &on, &p);
	gles_draw_fill(j->d, &j->s->joined, j->width * j->height, MASK_EMPTY);
}

static void blend_soft(struct sheets_job *j)
{
	struct sheet_box b = { 0, 0, j->width, j->height };
	struct gles_filter_job on = job_of(j, &b);
	struct gles_pass p = { .mode = MERGE_BLEND };
	set_whole(j, &p, true, false);
	pass(j, &on, &p);
	lap(j, &j->t->composite_s);
}

/* ---- a sheet ---- */

static void join(struct sheets_job *j)
{
	const struct gles_functions *gl = &j->d->c->gl;
	if (j->error || !gles_programs_want(j->d->c, j->d->program, GLES_SHEET_JOIN, &j->error))
		return;
	gl->UseProgram(j->d->program[GLES_SHEET_JOIN]);
	gles_draw_bind_storage(j->d, 2, j->s->joined.name);
	gl->DispatchCompute((j->width + 31) / 32, (j->height + 7) / 8, 1);
	gl->MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

/* Leaves that are not told by what is nearest: of a sheet of one, all have that. */
static bool has_leaves(const struct sheets_job *j)
{
	return j->d->views.leaf < 0 || j->d->planes.spans > 0;
}

/* Sums of normals, nearest depths and segments, of the whole picture. */
static void find_surface(struct sheets_job *j)
{
	union {
		float depth_m;
		uint32_t bits;
	} far = { FILTER_FAR };
	gles_draw *d = j->d;
	struct gles_sheets *s = j->s;
	uint32_t pixels = j->width * j->height;
	if (!hold(j, &s->sums, pixels, 12) || !hold(j, &s->nearest, pixels, 4) ||
		!hold(j, &s->leaves, pixels, 4) ||
		!gles_programs_want(d->c, d->program, GLES_SHEET_SURFACE, &j->error))
		return;
	bool has_planes = d->planes.spans > 0;
	if (has_planes && !gles_programs_want(d->c, d->program, GLES_PLANE_SURFACE, &j->error))
		return;
	gles_draw_fill(d, &s->sums, 3 * pixels, 0);
	gles_draw_fill(d, &s->nearest, pixels, far.bits);
	gles_draw_fill(d, &s->leaves, pixels, 0);
	gles_draw_bind_storage(d, 2, s->sums.name);
	gles_draw_bind_storage(d, 3, s->nearest.name);
	gles_draw_bind_storage(d, 4, s->leaves.name);
	for (GLuint finds_leaf = 0; finds_leaf < (has_leaves(j) ? 2 : 1); finds_leaf++) {
		if (has_planes) {
			d->c->gl.UseProgram(d->program[GLES_PLANE_SURFACE]);
			d->c->gl.Uniform1ui(2, finds_leaf);
			gles_planes_draw(d->c, &d->planes);
		}
		d->c->gl.UseProgram(d->program[GLES_SHEET_SURFACE]);
		gles_draw_bind_storage(d, 1, d->views.buffer.name);
		d->c->gl.Uniform1ui(2, finds_leaf);
		for (guint n = 0; n < d->views.runs->len; n++)
			gles_draw_points_of(d, gles_draw_run(d, n));
		d->c->gl.MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
	}
}

/* Of a sheet that was drawn, or (TAKE_AWAY) of the picture of all. */
static void take(struct sheets_job *j, struct gles_filter_job *on, int32_t mode)
{
	const struct gles_filter_image *i = &on->image;
	struct gles_pass p = { .use = GLES_SHEET_TAKE,
		.mode = mode,
		.whole = { { (int32_t)j->width, i->surface != NULL, i->away != NULL,
			has_leaves(j) ? 0 : j->d->views.leaf + 1 } },
		.own = { i->pixels->name, j->s->leaves.name, i->depth->name,
			i->away ? i->away->name : 0, j->s->pushed.name, j->s->sums.name,
			j->s->nearest.name, i->surface ? i->surface->name : 0 } };
	gles_draw_bind_texture(j->d, 3, GL_TEXTURE_2D, j->d->targets.picture.plane[0]);
	pass(j, on, &p);
}

static bool hold_image(struct sheets_job *j, struct gles_filter_job *on, bool filters, bool surface)
{
	struct gles_sheets *s = j->s;
	int64_t pixels = (int64_t)on->image.width * on->image.height;
	on->image.pixels = &s->pixels;
	on->image.spare = &s->spare;
	on->image.depth = &s->depth;
	on->image.surface = surface ? &s->surface : NULL;
	on->image.away = has_away(j->f) ? &s->away : NULL;
	on->image.grey = filters ? &s->grey : NULL;
	return hold(j, &s->pixels, pixels, 4) && hold(j, &s->spare, pixels, 4) &&
	       hold(j, &s->depth, pixels, 4) && (!surface || hold(j, &s->surface, pixels, 16)) &&
	       (!on->image.away || hold(j, &s->away, pixels, 4)) &&
	       (!filters || hold(j, &s->grey, pixels, 4));
}

static void merge(struct sheets_job *j, struct gles_filter_job *on, GLuint compared, int32_t by)
{
	struct gles_pass p = { .mode = MERGE_SHEET };
	set_whole(j, &p, j->has_soft, j->wants_surface && on->image.surface);
	p.whole[0][1] = by;
	p.own[0] = on->image.pixels->name;
	p.own[2] = on->image.depth->name;
	p.own[4] = compared;
	p.own[6] = on->image.surface ? on->image.surface->name : 0;
	pass(j, on, &p);
	lap(j, &j->t->composite_s);
}

static void filter_sheet(struct sheets_job *j, const struct sheet_plan *p)
{
	struct gles_filter_job on = job_of(j, &p->box);
	bool surface = j->wants_surface || filter_wants_surface(p->steps, p->filters);
	int32_t by = j->f->drawing->composite_by;
	GLuint compared;
	on.spacing_px = p->spacing_px;
	if (surface)
		find_surface(j);
	if (!hold_image(j, &on, p->filters, surface))
		return;
	take(j, &on, TAKE_ALL);
	compared = on.image.depth->name;
	if (p->filters && !j->error) {
		gles_inpaint_begin(&on);
		lap(j, &j->t->composite_s);
		for (uint32_t n = 0; n < p->filters; n++)
			if (step_is_filter(&p->steps[n]))
				gles_filter_run(&on, &p->steps[n]);
		lap(j, &j->t->filter_s);
		compared = on.image.depth->name;
		if (by == COMPOSITE_INPAINTED)
			compared = gles_inpaint(&on, p->threshold, p->radius, 0);
		j->error = g_steal_pointer(&on.error);
	}
	/* What nothing filters has the depths that it was drawn with. */
	merge(j, &on, compared, p->filters || j->wants_surface ? by : COMPOSITE_DEPTH);
}

static bool do_plan(struct sheets_job *j, const struct sheet_plan *p)
{
	struct gles_part part = { .view = p->views,
		.count = p->count,
		.layers = frame_layers_over(j->f, false),
		.is_flat = true };
	if (!gles_draw_part(j->d, j->f, &part, j->t, j->is_timed, &j->error))
		return false;
	j->since_us = g_get_monotonic_time();
	join(j);
	if (p->box.right > p->box.left && p->box.bottom > p->box.top)
		filter_sheet(j, p);
	return !j->error && !frame_is_stopped(j->f);
}

static bool do_sheet(
	struct sheets_job *j, const struct chunk_view *all, uint32_t count, uint32_t sheet)
{
	struct sheet_plan p = sheet_plan_new(j->f, all, count, sheet);
	bool going = !p.count || do_plan(j, &p);
	sheet_plan_clear(&p);
	return going;
}

/* ---- what comes over all ---- */

/* From here on the mask is that of all sheets. */
static void take_joined(struct sheets_job *j)
{
	gles_draw *d = j->d;
	if (j->error || !gles_programs_want(d->c, d->program, GLES_SHEET_KEYS, &j->error))
		return;
	gles_draw_bind_storage(d, 2, j->s->joined.name);
	gles_draw_keys(d, GLES_SHEET_KEYS);
}

static void filter_whole(struct sheets_job *j, const struct chunk_view *views, uint32_t count)
{
	const struct pipeline *p = &j->f->drawing->picture;
	struct sheet_box b = { 0, 0, j->width, j->height };
	struct gles_filter_job on = job_of(j, &b);
	int64_t pixels = (int64_t)j->width * j->height;
	on.spacing_px = sheet_whole_spacing_px(j->f, views, count);
	on.image.pixels = &j->s->whole;
	on.image.spare = &j->s->spare;
	on.image.depth = &j->s->whole_depth;
	on.image.surface = j->wants_surface ? &j->s->whole_surface : NULL;
	on.image.away = has_away(j->f) ? &j->s->away : NULL;
	if (!hold(j, &j->s->spare, pixels, 4) ||
		(on.image.away && !hold(j, &j->s->away, pixels, 4)))
		return;
	if (on.image.away) {
		/* Surfaces are there already. */
		struct gles_filter_job of_away = on;
		of_away.image.surface = NULL;
		take(j, &of_away, TAKE_AWAY);
	}
	lap(j, &j->t->composite_s);
	for (uint32_t n = 0; n < p->filters && !j->error; n++) {
		gles_filter_run(&on, &p->steps[n]);
		j->error = g_steal_pointer(&on.error);
	}
	lap(j, &j->t->filter_s);
}

bool gles_sheets_ground(gles_draw *d, GError **error)
{
	if (!gles_programs_want(d->c, d->program, GLES_SHEET_GROUND, error))
		return false;
	d->c->gl.BindFramebuffer(GL_FRAMEBUFFER, d->targets.canvas.frame);
	gles_layers_bind_pipelines(d->c, &d->layers);
	gles_draw_bind_texture(d, 2, GL_TEXTURE_2D, d->layers.relief);
	gles_draw_bind_storage(d, 2, d->sheets.whole.name);
	d->c->gl.UseProgram(d->program[GLES_SHEET_GROUND]);
	d->c->gl.DrawArrays(GL_TRIANGLES, 0, 3);
	return true;
}

static bool is_finished(const frame *f, uint64_t over)
{
	return !over && !(f->focus.amount > 0) && !(f->drawing->whole.paper.grain > 0);
}

/* Paper's grain, what fades away from the focus, and strokes that lie over. */
static bool finish(struct sheets_job *j, const struct chunk_view *views, uint32_t count,
	uint64_t over, bool *ret_is_drawn)
{
	struct gles_part part = { .view = views, .count = count, .layers = over, .is_over = true };
	*ret_is_drawn = !is_finished(j->f, over);
	return !*ret_is_drawn || gles_draw_part(j->d, j->f, &part, j->t, j->is_timed, &j->error);
}

static bool draw_all(
	struct sheets_job *j, const struct chunk_view *views, uint32_t count, bool *ret_is_drawn)
{
	bool going = true;
	begin(j);
	lap(j, &j->t->cull_s);
	for (uint32_t n = 0; going && !j->error && n < j->f->sheets; n++)
		going = do_sheet(j, views, count, n);
	if (!going || j->error)
		return !j->error; /* stopped: nobody wants it */
	if (j->has_soft)
		blend_soft(j);
	take_joined(j);
	if (j->f->drawing->picture.filters && !j->error)
		filter_whole(j, views, count);
	return !j->error && finish(j, views, count, frame_layers_over(j->f, true), ret_is_drawn);
}

bool gles_sheets_draw(gles_draw *d, const frame *f, struct picture_buffer *to, struct draw_times *t,
	bool is_timed, bool *ret_is_drawn, GError **error)
{
	uint32_t count;
	int64_t since_us = g_get_monotonic_time();
	g_autofree struct chunk_view *views = chunk_views_new(f, &count);
	struct sheets_job j = { .d = d,
		.f = f,
		.s = &d->sheets,
		.t = t,
		.is_timed = is_timed,
		.since_us = since_us,
		.has_soft = sheets_have_soft(f),
		.wants_surface = filter_wants_surface(
			f->drawing->picture.steps, f->drawing->picture.filters),
		.width = f->camera.width,
		.height = f->camera.height };
	*ret_is_drawn = false;
	bool good = draw_all(&j, views, count, ret_is_drawn);
	if (good && !*ret_is_drawn && !frame_is_stopped(f))
		good = gles_buffer_read(
			d->c, &d->sheets.whole, (size_t)j.width * j.height * 4, to->rgba, &j.error);
	t->chunks_in_view = count;
	t->points_in_view = 0;
	for (uint32_t n = 0; n < count; n++)
		t->points_in_view += views[n].chunk->count;
	if (!good)
		g_propagate_error(error, j.error);
	return good;
}
