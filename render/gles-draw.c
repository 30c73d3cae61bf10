#include "render/gles-filter.h"
#include "render/gles-ink.h"
#include "render/light.h"
#include <float.h>
#include <string.h>

/* Camera of common.glsl. */
struct camera_block {
	float lens[4], rays[4], cuts[4], turn[3][4], size[4], paper[4], light[256], light_from[4],
		focus[4], eye[4], paint_light[4], focus_reach[4];
	int32_t window[4];
};

/* ---- open, close ---- */

static GLuint srgb_table(const struct gles_functions *gl)
{
	GLuint name;
	_Static_assert(LIGHT_STEPS == 64 * 64, "as out.frag.glsl has it");
	gl->GenTextures(1, &name);
	gl->BindTexture(GL_TEXTURE_2D, name);
	gl->TexStorage2D(GL_TEXTURE_2D, 1, GL_R8, 64, 64);
	gl->PixelStorei(GL_UNPACK_ALIGNMENT, 1);
	gl->TexSubImage2D(
		GL_TEXTURE_2D, 0, 0, 0, 64, 64, GL_RED, GL_UNSIGNED_BYTE, light_srgb_bytes());
	gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
	gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
	return name;
}

gles_draw *gles_draw_new(const gles_context *c, GError **error)
{
	g_autoptr(gles_draw) d = g_new0(gles_draw, 1);
	d->c = c;
	if (!gles_programs_make(c, d->program, error))
		return NULL;
	d->srgb = srgb_table(&c->gl);
	c->gl.GenVertexArrays(1, &d->vertices);
	if (!gles_context_check(c, "making ready to draw", error) ||
		!gles_ink_trial(c, &d->sums_ink, error))
		return NULL;
	return g_steal_pointer(&d);
}

void gles_draw_set_sums(gles_draw *d, bool sums_ink)
{
	d->sums_ink = sums_ink;
}

void gles_draw_free(gles_draw *d)
{
	if (!d)
		return;
	struct gles_buffer *buffers[] = { &d->keys, &d->deepest, &d->sums, &d->marks, &d->asked,
		&d->commands, &d->links, &d->shown, &d->ink, &d->camera };
	for (size_t n = 0; n < G_N_ELEMENTS(buffers); n++)
		gles_buffer_clear(d->c, buffers[n]);
	for (int n = 0; n < FRAME_LAYERS_MAX; n++)
		gles_buffer_clear(d->c, &d->strokes[n]);
	gles_planes_clear(d->c, &d->planes);
	gles_stipple_clear(d->c, &d->stipple);
	gles_filters_clear(d->c, &d->filters);
	gles_sheets_clear(d->c, &d->sheets);
	gles_programs_clear(d->c, d->program);
	gles_scene_clear(d->c, &d->scene);
	gles_layers_clear(d->c, &d->layers);
	gles_views_clear(d->c, &d->views);
	gles_targets_clear(d->c, &d->targets);
	d->c->gl.DeleteVertexArrays(1, &d->vertices);
	d->c->gl.DeleteTextures(1, &d->srgb);
	gles_buffers_rest(d->c);
	g_free(d);
}

/* ---- small things of all stages ---- */

void gles_draw_bind_storage(const gles_draw *d, GLuint binding, GLuint name)
{
	d->c->gl.BindBufferBase(GL_SHADER_STORAGE_BUFFER, binding, name);
}

void gles_draw_bind_texture(const gles_draw *d, GLuint unit, GLenum target, GLuint name)
{
	d->c->gl.ActiveTexture(GL_TEXTURE0 + unit);
	d->c->gl.BindTexture(target, name);
}

void gles_draw_fill(gles_draw *d, const struct gles_buffer *b, uint32_t words, uint32_t value)
{
	const struct gles_functions *gl = &d->c->gl;
	gl->UseProgram(d->program[GLES_CLEAR]);
	gl->Uniform1ui(0, value);
	gl->Uniform1ui(1, words);
	gles_draw_bind_storage(d, 2, b->name);
	gl->DispatchCompute(MIN((words + 255) / 256, 4096), 1, 1);
	gl->MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

/* ---- a frame ---- */

static bool set_camera(gles_draw *d, const frame *f, GError **error)
{
	const struct camera *c = &f->camera;
	const struct style_paper *paper = &f->drawing->whole.paper;
	struct lens l = lens_of(c);
	struct camera_block b = { .lens = { l.focal_px, l.middle_x, l.middle_y, l.near_m },
		.rays = { l.fan, l.parallel_m, l.by_parallel, l.begin_m },
		.cuts = { c->is_cut, (float)c->cut_m, fminf(l.far_m, FLT_MAX), f->scene->unit_m },
		.size = { (float)c->width, (float)c->height, f->px, (float)c->far_m },
		.window = { (int32_t)c->whole.left, (int32_t)c->whole.top } };
	const double *row[3] = { c->right, c->down, c->forward };
	for (int k = 0; k < 3; k++)
		for (int n = 0; n < 3; n++)
			b.turn[k][n] = (float)row[k][n];
	for (int k = 0; k < 3; k++)
		b.paper[k] = light_of_srgb((float)paper->colour[k] / 255);
	b.paper[3] = paper->grain;
	memcpy(b.light, light_of_bytes(), sizeof b.light);
	memcpy(b.light_from, f->light.from, sizeof f->light.from);
	b.light_from[3] = f->light.amount;
	for (int k = 0; k < 3; k++)
		b.eye[k] = (float)f->eye_m[k];
	frame_paint_light(f, b.paint_light);
	memcpy(b.focus, f->focus.at_m, sizeof f->focus.at_m);
	b.focus[3] = f->focus.amount;
	b.focus_reach[0] = f->focus.radius_m;
	b.focus_reach[1] = f->focus.per_m;
	b.focus_reach[2] = f->focus.abstraction;
	static const float on[] = { [FOCUS_PLACE] = 1, [FOCUS_PICTURE] = 2, [FOCUS_SEGMENT] = 3 };
	b.focus_reach[3] = f->focus.is_there ? on[f->focus.on] : 0;
	if (!gles_buffer_put(d->c, &d->camera, &b, sizeof b, "the camera", error))
		return false;
	d->c->gl.BindBufferBase(GL_UNIFORM_BUFFER, 0, d->camera.name);
	return true;
}

double gles_draw_lap(const gles_draw *d, bool is_timed, int64_t *since_us)
{
	if (!is_timed)
		return 0;
	d->c->gl.Finish();
	int64_t now_us = g_get_monotonic_time();
	double s = (double)(now_us - *since_us) * 1e-6;
	*since_us = now_us;
	return s;
}

static void set_up(gles_draw *d)
{
	const struct gles_functions *gl = &d->c->gl;
	gl->Viewport(0, 0, (GLsizei)d->targets.width, (GLsizei)d->targets.height);
	gl->BindVertexArray(d->vertices);
	gl->Disable(GL_BLEND);
	gl->Disable(GL_DITHER);
	gl->Disable(GL_CULL_FACE);
	gl->Disable(GL_DEPTH_TEST);
}

/* It takes the places of what shaders read, so all is made before they are bound. */
bool gles_draw_hold(gles_draw *d, const frame *f, GError **error)
{
	gles_buffers_rest(d->c);
	bool good = gles_scene_hold(d->c, &d->scene, f->scene, error) &&
		    gles_targets_hold(d->c, &d->targets, f->camera.width, f->camera.height,
			    f->is_filtered, error) &&
		    gles_layers_hold(d->c, &d->layers, f, error);
	for (uint32_t n = 0; good && n < f->layers; n++)
		if (f->layer[n].bend)
			good = gles_scene_hold_bends(d->c, &d->scene, f->scene, error);
	for (uint32_t n = 0; good && n < f->layers; n++)
		if (f->layer[n].paint)
			good = gles_scene_hold_paint(d->c, &d->scene, f->scene, error);
	for (uint32_t n = 0; good && n < f->layers; n++)
		if (!gles_ink_is_summed(d, &f->layer[n]) && !gles_layer_is_direct(&f->layer[n]))
			good = gles_targets_hold_ink(
				d->c, &d->targets, band_blend_of(&f->layer[n]), error);
	if (good)
		set_up(d);
	return good && set_camera(d, f, error);
}

static bool draw_canvas(gles_draw *d, const frame *f, const struct gles_part *p,
	struct draw_times *t, bool is_timed, GError **error)
{
	int64_t since_us = g_get_monotonic_time();
	bool wants_views = !p->is_over || p->layers;
	if (wants_views &&
		!gles_views_fill(d->c, &d->views, f, &d->scene, p->view, p->count, error))
		return false;
	t->cull_s += gles_draw_lap(d, is_timed, &since_us);
	if ((!p->is_over && !gles_draw_mask(d, f, error)) ||
		(wants_views && !gles_draw_hide(d, error)))
		return false;
	t->mask_s += gles_draw_lap(d, is_timed, &since_us);
	if (!gles_draw_choose(d, f, p->layers, error))
		return false;
	t->choose_s += gles_draw_lap(d, is_timed, &since_us);
	if (!(p->is_over ? gles_sheets_ground(d, error) : gles_draw_ground(d, p->is_flat, error)))
		return false;
	if (!gles_draw_ink(d, f, p->layers, error))
		return false;
	gles_draw_out(d);
	t->draw_s += gles_draw_lap(d, is_timed, &since_us);
	return true;
}

/* Again where a buffer of strokes was too small; then it is as large as it must be. */
bool gles_draw_part(gles_draw *d, const frame *f, const struct gles_part *p, struct draw_times *t,
	bool is_timed, GError **error)
{
	for (int n = 0; n < 3; n++) {
		bool is_whole;
		uint32_t strokes;
		if (!draw_canvas(d, f, p, t, is_timed, error) ||
			!gles_draw_strokes(d, f->layers, &strokes, &is_whole, error))
			return false;
		if (is_whole) {
			t->strokes += strokes;
			return true;
		}
	}
	g_set_error(error, GLES_ERROR, GLES_ERROR_DRIVER,
		"the GPU chooses other strokes each time it draws the same picture");
	return false;
}

static bool draw_plain(
	gles_draw *d, const frame *f, struct draw_times *t, bool is_timed, GError **error)
{
	uint32_t count;
	int64_t since_us = g_get_monotonic_time();
	g_autofree struct chunk_view *views = chunk_views_new(f, &count);
	t->cull_s = gles_draw_lap(d, is_timed, &since_us);
	struct gles_part all = { .view = views, .count = count, .layers = UINT64_MAX };
	t->chunks_in_view = count;
	bool good = gles_draw_part(d, f, &all, t, is_timed, error);
	t->points_in_view = d->views.points;
	return good;
}

static bool check_all(const gles_draw *d, GError **error)
{
	if (!gles_context_is_lost(d->c))
		return gles_context_check(d->c, "drawing", error);
	g_set_error(error, GLES_ERROR, GLES_ERROR_DRIVER, "the GPU was reset while drawing");
	return false;
}

bool gles_draw_frame(gles_draw *d, const frame *f, struct picture_buffer *to,
	struct draw_times *ret_times, GError **error)
{
	struct draw_times t = { 0 };
	int64_t begin_us = g_get_monotonic_time();
	bool is_timed = ret_times != NULL, is_drawn = true;
	g_assert(to->width == f->camera.width && to->height == f->camera.height);
	if (!gles_draw_hold(d, f, error) ||
		!(f->is_filtered ? gles_sheets_draw(d, f, to, &t, is_timed, &is_drawn, error)
				 : draw_plain(d, f, &t, is_timed, error)))
		return false;
	int64_t drawn_us = g_get_monotonic_time();
	if (is_drawn && !gles_pixels_read(d->c, to->width, to->height, to->rgba, error))
		return false;
	t.draw_s += (double)(g_get_monotonic_time() - drawn_us) * 1e-6;
	t.all_s = (double)(g_get_monotonic_time() - begin_us) * 1e-6;
	if (ret_times)
		*ret_times = t;
	return check_all(d, error);
}
