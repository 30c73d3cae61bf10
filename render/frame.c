#include "process/vector3.h"
#include "render/frame-want.h"
#include "render/light.h"
#include "render/scene-bend.h"
#include "render/scene-list.h"
#include "render/stroke.h"
#include <gio/gio.h>
#include <math.h>
#ifdef _OPENMP
#include <omp.h>
#endif
#include <string.h>

static uint32_t kinds_of(const struct ink_step *ink)
{
	static const uint32_t none = 1 << FEATURE_NONE, dither = 1 << FEATURE_DITHER,
			      undirected = 1 << FEATURE_UNDIRECTED,
			      directed = 1 << FEATURE_DIRECTED;
	switch (ink->points) {
	case INK_SURFACE: return none | dither;
	case INK_FEATURES: return undirected | directed;
	case INK_DIRECTIONAL: return directed;
	case INK_NON_DIRECTIONAL: return undirected;
	case INK_DITHERING:
		if (ink->tone == TONE_EVEN)
			return dither;
		break;
	default: break;
	}
	return none | dither | undirected | directed;
}

/* ---- layers ---- */

/* Edges are drawn along their lines, whatever else there is around. */
static uint32_t kinds_together(const struct frame_layer *l)
{
	const uint32_t leaves = 1u << FEATURE_UNDIRECTED,
		       surface = 1u << FEATURE_NONE | 1u << FEATURE_DITHER;
	if (l->is_queue)
		return l->kinds & ~(1u << FEATURE_DITHER);
	return l->kinds & leaves && l->kinds & surface ? l->kinds & (leaves | surface) : 0;
}

uint32_t frame_copies(const struct frame_layer *l)
{
	bool has_surface = l->hatch || l->kinds & (1 << FEATURE_NONE | 1 << FEATURE_DITHER);
	return has_surface && l->ink.scatter > 0 ? (uint32_t)l->ink.copies : 1;
}

float frame_dither_m(const scene *s, const struct frame_layer *l, const struct scene_chunk *c)
{
	return l->dithers_alone ? scene_dither_m(s, c) : 0;
}

static float area_of(const struct frame_layer *l)
{
	const struct ink_step *ink = &l->ink;
	float opacity = ink->opacity * (1 - ink->opacity_variation / 2), mean = 0;
	if (step_is_dots(l->step)) /* 2 pi sigma^2, the diameter being 5 sigma */
		return opacity * (float)(2 * G_PI) * ink->length_px * ink->length_px / 25;
	if (!l->texture)
		return opacity * ink->length_px * ink->width_px;
	for (uint32_t v = 0; v < l->texture->variants; v++)
		mean += (float)l->texture->mean_alpha[v] / (float)l->texture->variants;
	return opacity * ink->length_px * ink->width_px * mean;
}

/* Thin lines of hatching are drawn as lines are, which is faster. */
static bool has_texture(const struct step *s)
{
	return s->kind == step_kind_find("strokes") ||
	       ((step_is_hatching(s) || step_is_contours(s) || step_is_cut(s)) &&
		       strcmp(s->ink.texture, "line") != 0);
}

static bool load_texture(struct frame_layer *l, GError **error)
{
	if (!has_texture(l->step))
		return true;
	g_autoptr(stroke_texture) whole = stroke_texture_new(l->ink.texture, error);
	if (whole)
		l->texture =
			stroke_texture_scaled(whole, (uint32_t)fmaxf(l->ink.length_px + 0.5f, 4),
				(uint32_t)fmaxf(l->ink.width_px + 0.5f, 2));
	if (l->texture) {
		l->texels = frame_pack_texels(l->texture, &l->texel_shift);
		l->few_texels = frame_pack_few_texels(l->texture);
	}
	return whole;
}

static void set_ways(struct frame_layer *l)
{
	float own = l->ink.angle_deg * (float)(G_PI / 180);
	l->own_way[0] = cosf(own);
	l->own_way[1] = -sinf(own);
	for (int n = 0; n < 256; n++) {
		float by = l->ink.angle_variation_deg * (float)(G_PI / 180) * ((float)n - 127.5f) /
			   127.5f;
		l->turn[n][0] = cosf(by);
		l->turn[n][1] = sinf(by);
	}
}

static void set_ink(struct frame_layer *l, const uint8_t rgb[3])
{
	memcpy(l->ink.ink, rgb, 3);
	for (int k = 0; k < 3; k++)
		l->ink_linear[k] = light_of_srgb((float)rgb[k] / 255);
}

/* Unless all its strokes are of one ink they have colours of their own. */
static bool add_hatch(struct frame_layer *l, const scene *s, GError **error)
{
	const struct hatching_step *step = &l->step->hatching;
	l->hatch = frame_hatch_new(l, s, error);
	if (!l->hatch)
		return false;
	if (step->curvature > 0 || step->follows == FOLLOWS_CURVATURE)
		l->bend = scene_bend(s);
	if (l->hatch->step.colouring != COLOURING_INK || l->hatch->pencils.count)
		l->ink.colour = COLOUR_POINT;
	else
		set_ink(l, l->hatch->rgba[0]);
	return true;
}

/* In all of the band as many as make a line of it: of its mean strength, a half. */
static void add_contours(struct frame_layer *l, const scene *s, float px)
{
	float band_px = l->step->contours.band_px * px;
	l->is_contours = true;
	l->bend = scene_bend(s);
	l->ink.grow = 1;
	for (int n = 0; n < 256; n++)
		l->wanted_per_px[n] =
			fminf(1 / (0.5f * band_px * l->ink.spacing_px), FRAME_DENSEST_PER_PX) /
			STROKE_FADE_MEAN;
}

/* It has the texture at all sizes, and as many strokes as cover all. */
static bool add_paint(struct frame_layer *l, const scene *s, const struct mask_step *mask, float px,
	GError **error)
{
	g_autoptr(stroke_texture) whole = stroke_texture_new(l->ink.texture, error);
	if (!whole)
		return false;
	l->paint = frame_paint_new(l, s, mask, px, whole);
	l->ink.colour = COLOUR_POINT;
	l->ink.blend = BLEND_PAINT;
	l->ink.spacing_px = 1 / sqrtf(l->paint->wanted_per_px);
	for (int n = 0; n < 256; n++)
		l->wanted_per_px[n] =
			fminf(l->paint->wanted_per_px, FRAME_DENSEST_PER_PX) / STROKE_FADE_MEAN;
	return true;
}

static bool add_layer(frame *f, uint8_t pipeline, const struct step *step, GError **error)
{
	struct frame_layer *l = &f->layer[f->layers];
	if (f->layers == FRAME_LAYERS_MAX) {
		g_set_error(error, STYLE_ERROR, STYLE_ERROR_FIELD,
			"the style has more than %d layers for the segments of this site",
			FRAME_LAYERS_MAX);
		return false;
	}
	*l = (struct frame_layer){ step, pipeline, kinds_of(&step->ink), step->ink };
	l->is_focus = frame_pipeline(f, pipeline)->is_focus;
	if (step->kind == step_kind_find("stipple"))
		l->stipple = &step->stipple;
	l->ink.spacing_px *= f->ink_px;
	l->ink.length_px *= f->ink_px;
	l->ink.width_px *= f->ink_px;
	if (step_is_dots(step))
		l->ink.width_px = l->ink.length_px;
	set_ink(l, step->ink.ink);
	f->layers++; /* with what is freed later */
	if (!load_texture(l, error))
		return false;
	set_ways(l);
	l->stroke_area_px = area_of(l);
	frame_want(l, f->scene);
	if (step_is_hatching(step) && !add_hatch(l, f->scene, error))
		return false;
	if (step_is_paint(step) &&
		!add_paint(l, f->scene, &frame_pipeline(f, pipeline)->mask, f->px, error))
		return false;
	f->is_painted |= l->paint != NULL;
	if (step_is_contours(step))
		add_contours(l, f->scene, f->ink_px);
	l->is_cut = step_is_cut(step);
	l->is_profile = step_is_profile(step);
	l->is_queue = l->ink.tone == TONE_COLOUR && l->ink.points == INK_DITHERING;
	l->together = kinds_together(l);
	l->dithers_alone = l->is_queue || !(l->kinds & 1u << FEATURE_NONE);
	return true;
}

static bool has_cut(const struct pipeline *line)
{
	for (uint32_t n = 0; n < line->layers; n++)
		if (step_is_cut(&line->steps[n]))
			return true;
	return false;
}

/* Over all else. */
static bool add_cuts(frame *f, GError **error)
{
	const struct style_paper *paper = &f->drawing->whole.paper;
	f->cut = step_defaults(step_kind_find("cut"));
	f->cut.ink.over = true;
	if (scene_lightness(paper->colour) < 128) {
		f->cut.ink.blend = BLEND_PAINT;
		memset(f->cut.ink.ink, 0xf4, 3);
	}
	for (guint p = 0; f->camera.is_cut && p < f->drawing->pipelines->len; p++)
		if (!has_cut(frame_pipeline(f, p)) && !add_layer(f, (uint8_t)p, &f->cut, error))
			return false;
	return true;
}

/* The first layers of all pipelines, then the second ones. */
static bool add_layers(frame *f, GError **error)
{
	for (uint32_t n = 0; n < PIPELINE_STEPS_MAX; n++)
		for (guint p = 0; p < f->drawing->pipelines->len; p++) {
			const struct pipeline *line =
				&g_array_index(f->drawing->pipelines, struct pipeline, p);
			if (n < line->layers && step_is_ink(&line->steps[n]) &&
				!step_draws_nothing(&line->steps[n]) &&
				!add_layer(f, (uint8_t)p, &line->steps[n], error))
				return false;
		}
	return add_cuts(f, error);
}

/* ---- light and focus ---- */

static enum frame_lit lit_of(const struct frame_layer *l, float amount)
{
	if (amount <= 0)
		return LIT_NOT;
	if (l->hatch || l->is_cut ||
		l->is_profile) /* its X-Toon takes on the light; others do not */
		return LIT_NOT;
	if (l->ink.tone == TONE_COLOUR)
		return LIT_TONE;
	return l->ink.colour == COLOUR_POINT ? LIT_COLOUR : LIT_OMITTED;
}

static void turn_to_camera(const frame *f, const double v[3], float ret[3])
{
	const double *row[3] = { f->camera.right, f->camera.down, f->camera.forward };
	for (int k = 0; k < 3; k++)
		ret[k] = (float)(row[k][0] * v[0] + row[k][1] * v[1] + row[k][2] * v[2]);
}

static void see_accents(frame *f)
{
	double away_m[3];
	float focal = (float)f->camera.focal_px, px = f->px / focal;
	for (int k = 0; k < 3; k++)
		away_m[k] = f->focus.site_m[k] - f->camera.eye_m[k];
	turn_to_camera(f, f->light.site_from, f->light.from);
	for (uint32_t n = 0; n < f->layers; n++)
		if (f->layer[n].hatch)
			turn_to_camera(f, f->layer[n].hatch->site_way, f->layer[n].hatch->way);
	turn_to_camera(f, away_m, f->focus.at_m);
	f->focus.lens = lens_of(&f->camera);
	if (f->focus.on == FOCUS_PICTURE) {
		f->focus.at_m[0] =
			(f->focus.across - 0.5f) * (float)camera_whole_width(&f->camera) / focal;
		f->focus.at_m[1] =
			(f->focus.down - 0.5f) * (float)camera_whole_height(&f->camera) / focal;
		f->focus.at_m[2] = 1;
		f->focus.radius_m = f->focus.radius_px * px;
		f->focus.per_m = 1 / (f->focus.falloff_px * px);
	}
}

void frame_set_light(frame *f, const struct style_light *light)
{
	double azimuth = light->azimuth_deg * (G_PI / 180),
	       elevation = light->elevation_deg * (G_PI / 180);
	f->light.amount = light->amount;
	f->light.site_from[0] = sin(azimuth) * cos(elevation);
	f->light.site_from[1] = cos(azimuth) * cos(elevation);
	f->light.site_from[2] = sin(elevation);
	for (uint32_t n = 0; n < f->layers; n++) {
		struct frame_layer *l = &f->layer[n];
		l->lit = lit_of(l, light->amount);
		frame_want_at_most(l, f->scene, l->lit == LIT_TONE ? light->amount : 0);
	}
	f->serial = scene_serial(); /* of what layers want */
	see_accents(f);
}

void frame_set_focus(frame *f, const struct style_focus *focus)
{
	f->focus = (struct frame_focus){ .is_there = style_focus_is_there(focus),
		.on = focus->on,
		.amount = focus->amount,
		.abstraction = focus->abstraction,
		.filters = focus->filters,
		.radius_m = focus->radius_m,
		.per_m = 1 / focus->falloff_m,
		.site_m = { focus->x_m, focus->y_m, focus->z_m },
		.across = focus->across,
		.down = focus->down,
		.radius_px = focus->radius_px,
		.falloff_px = focus->falloff_px };
	see_accents(f);
}

/* ---- paper ---- */

static float height_at(const paper_texture *p, float x, float y)
{
	float fx = floorf(x), fy = floorf(y), u = x - fx, v = y - fy;
	uint32_t wrap = p->side - 1, x0 = (uint32_t)(int32_t)fx & wrap,
		 y0 = (uint32_t)(int32_t)fy & wrap, x1 = (x0 + 1) & wrap, y1 = (y0 + 1) & wrap;
	float a = p->height[y0 * p->side + x0], b = p->height[y0 * p->side + x1],
	      c = p->height[y1 * p->side + x0], d = p->height[y1 * p->side + x1];
	float upper = a + u * (b - a), lower = c + u * (d - c);
	return upper + v * (lower - upper);
}

/* Does not move with the camera, so it is laid once; of each window again. */
static bool lay_paper(frame *f, GError **error)
{
	const struct camera_whole *whole = &f->camera.whole;
	float step = 1 / (f->px * f->drawing->whole.paper.scale);
	if (!f->paper)
		f->paper = paper_texture_new(f->drawing->whole.paper.texture, error);
	const paper_texture *p = f->paper;
	if (!p)
		return false;
	g_free(f->relief);
	f->relief_serial = scene_serial();
	f->relief_width = f->camera.width;
	f->relief_height = f->camera.height;
	f->relief = g_malloc((size_t)f->relief_width * f->relief_height);
#pragma omp parallel for
	for (uint32_t y = 0; y < f->relief_height; y++)
		for (uint32_t x = 0; x < f->relief_width; x++)
			f->relief[(size_t)y * f->relief_width + x] =
				(uint8_t)(height_at(p, ((float)(x + whole->left) + 0.5f) * step,
						  ((float)(y + whole->top) + 0.5f) * step) +
					  0.5f);
	return true;
}

/* ---- sheets ---- */

static bool same_filters(const struct pipeline *a, const struct pipeline *b)
{
	uint32_t n = 0, m = 0;
	while (n < a->filters || m < b->filters) {
		const struct step *s = &a->steps[a->layers + n], *t = &b->steps[b->layers + m];
		if (n < a->filters && !step_is_filter(s))
			n++;
		else if (m < b->filters && !step_is_filter(t))
			m++;
		else if (n == a->filters || m == b->filters || s->kind != t->kind ||
			 memcmp(s->bytes, t->bytes, STEP_SIZE_MAX))
			return false;
		else
			n++, m++;
	}
	return memcmp(&a->inpaint, &b->inpaint, sizeof a->inpaint) == 0;
}

static void find_sheets(frame *f)
{
	const GArray *pipelines = f->drawing->pipelines;
	f->is_filtered = f->drawing->picture.filters > 0;
	for (guint p = 0; p < pipelines->len; p++) {
		const struct pipeline *own = frame_pipeline(f, p);
		guint q = 0;
		for (uint32_t n = own->layers; n < own->layers + own->filters; n++)
			f->is_filtered |= step_is_filter(&own->steps[n]);
		while (q < p && !same_filters(frame_pipeline(f, q), own))
			q++;
		f->sheet_of[p] = q < p ? f->sheet_of[q] : (uint8_t)f->sheets++;
	}
	if (!f->is_filtered) {
		memset(f->sheet_of, 0, sizeof f->sheet_of);
		f->sheets = 1;
	}
}

/* All of a sheet have the same filters. */
static const struct pipeline *pipeline_of_sheet(const frame *f, uint32_t sheet)
{
	uint32_t p = 0;
	while (f->sheet_of[p] != sheet)
		p++;
	return frame_pipeline(f, p);
}

/* Those of "edl" are drawn with points. */
const struct step *frame_filters(const frame *f, uint32_t sheet, uint32_t *ret_count)
{
	const struct pipeline *own = pipeline_of_sheet(f, sheet);
	uint32_t first = own->layers, end = own->layers + own->filters;
	while (first < end && !step_is_filter(&own->steps[first]))
		first++;
	*ret_count = end - first;
	return &own->steps[first];
}

const struct inpaint_step *frame_inpaint(const frame *f, uint32_t sheet)
{
	return &pipeline_of_sheet(f, sheet)->inpaint;
}

uint64_t frame_layers_over(const frame *f, bool over)
{
	uint64_t ret = 0;
	for (uint32_t n = 0; n < f->layers; n++)
		if (!f->layer[n].stipple && f->layer[n].ink.over ? over : !over)
			ret |= (uint64_t)1 << n;
	return ret;
}

/* ---- all ---- */

const struct step *frame_step(const frame *f, uint32_t pipeline, const char *kind_name)
{
	const struct pipeline *p = frame_pipeline(f, pipeline);
	const struct step_kind *kind = step_kind_find(kind_name);
	for (uint32_t n = 0; n < p->layers + p->filters; n++)
		if (p->steps[n].kind == kind)
			return &p->steps[n];
	return NULL;
}

float frame_ray_most(const frame *f, const struct frame_layer *l)
{
	float focal = (float)f->camera.focal_px, reach = l ? l->ink.length_px / 2 : 0;
	float corner[3] = { ((float)camera_whole_width(&f->camera) / 2 + reach) / focal,
		((float)camera_whole_height(&f->camera) / 2 + reach) / focal, 1 };
	return f->camera.parallel_m > 0 ? 1 : vector3_length(corner);
}

bool frame_move(frame *f, const struct camera *c, GError **error)
{
	if (!camera_validate(c, error))
		return false;
	uint32_t width = camera_whole_width(&f->camera), height = camera_whole_height(&f->camera);
	if (f->relief && (camera_whole_width(c) != width || camera_whole_height(c) != height)) {
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_ARGUMENT,
			"a frame of %ux%u cannot become one of %ux%u", width, height,
			camera_whole_width(c), camera_whole_height(c));
		return false;
	}
	bool is_paper_there =
		f->relief && c->width == f->relief_width && c->height == f->relief_height &&
		c->whole.left == f->camera.whole.left && c->whole.top == f->camera.whole.top;
	f->camera = *c;
	for (int k = 0; k < 3; k++)
		f->eye_m[k] = c->eye_m[k] - f->scene->origin_m[k];
	see_accents(f);
	return is_paper_there || lay_paper(f, error);
}

frame *frame_new(const scene *s, const drawing *d, const struct camera *c, GError **error)
{
	return frame_new_coarse(s, d, c, 1, error);
}

frame *frame_new_coarse(
	const scene *s, const drawing *d, const struct camera *c, double coarser, GError **error)
{
	g_autoptr(frame) f = g_new0(frame, 1);
	f->serial = scene_serial();
	f->scene = s;
	f->drawing = d;
	f->lanes = lanes_path_widest();
	f->px = (float)(camera_whole_height(c) / FRAME_STYLE_HEIGHT);
	f->ink_px = f->px * (float)coarser;
	f->layer = g_new0(struct frame_layer, FRAME_LAYERS_MAX + 1);
	g_autoptr(GError) wrong = NULL;
	f->nets = frame_nets_new(d, &wrong);
	if (wrong) {
		g_propagate_error(error, g_steal_pointer(&wrong));
		return NULL;
	}
	if (!frame_move(f, c, error) || !add_layers(f, error))
		return NULL;
	if (!f->is_painted)
		scene_paint_forget(s);
	find_sheets(f);
	frame_set_light(f, &d->whole.light);
	frame_set_focus(f, &d->whole.focus);
	return g_steal_pointer(&f);
}

uint32_t frame_threads(const frame *f)
{
#ifdef _OPENMP
	if (!f->single_thread)
		return (uint32_t)CLAMP(omp_get_max_threads(), 1, FRAME_THREADS_MOST);
#endif
	return 1;
}

void frame_free(frame *f)
{
	if (!f)
		return;
	for (uint32_t l = 0; l < f->layers; l++) {
		stroke_texture_free(f->layer[l].texture);
		g_free(f->layer[l].texels);
		g_free(f->layer[l].few_texels);
		frame_hatch_free(f->layer[l].hatch);
		frame_paint_free(f->layer[l].paint);
	}
	frame_nets_free(f->nets);
	g_free(f->relief);
	paper_texture_free(f->paper);
	g_free(f->layer);
	g_free(f);
}
