/* Each filter as passes, those that smooth apart (gles-filter-smooth.c): beside the functions of the same names in filter-*.c, whose shaders say what planes are. */
#include "render/edl.h"
#include "render/filter-tables.h"
#include "render/filter-trace.h"
#include "render/gles-filter.h"
#include <math.h>
#include <string.h>

static void set_colour(float to[4], const uint8_t colour[4])
{
	for (int k = 0; k < 3; k++)
		to[k] = colour[k];
}

/* ---- tones and lines ---- */

enum { QUANTISE_TAKE = QUANTISE_CHANNELS + 1 };

/* Plane 0 is CIELab then, plane 2 smoothed lightness. */
static void quantise_lightness(struct gles_filter_job *j, float sigma_px, struct gles_pass *p)
{
	GLuint lab = gles_to_lab(j, 0), own = gles_filter_plane(j, 1, 1),
	       smooth = gles_filter_plane(j, 2, 1);
	struct gles_pass first = {
		.use = GLES_FILTER_QUANTISE, .mode = QUANTISE_TAKE, .plane = { lab, own }
	};
	gles_pass_run(j, &first);
	gles_blur_run(j, &(struct gles_blur){ own, smooth, j->image.width, j->image.height, 1, 3 },
		sigma_px);
	p->plane[0] = lab;
	p->plane[2] = smooth;
}

static void quantise(struct gles_filter_job *j, const struct step *s)
{
	const struct quantise_step *k = &s->quantise;
	struct gles_pass p = { .use = GLES_FILTER_QUANTISE,
		.mode = k->by,
		.by = { { rintf(k->levels), k->softness } },
		.whole = { { k->smooth_px > 0 } } };
	float sigma_px = k->smooth_px * j->px;
	if (k->by == QUANTISE_LIGHTNESS) {
		quantise_lightness(j, sigma_px, &p);
	} else if (k->smooth_px > 0) {
		p.plane[2] = gles_filter_plane(j, 2, 4);
		gles_blur_run(j, &(struct gles_blur){ 0, p.plane[2], 0, 0, 4, 3 }, sigma_px);
	}
	gles_pass_run(j, &p);
	gles_filter_finish(j, k->where, 1, 0);
}

enum { DOG_COMBINE, DOG_DRAW };

static void dog_numbers(const struct dog_step *k, struct gles_pass *ret)
{
	*ret = (struct gles_pass){ .use = GLES_FILTER_DOG,
		.mode = DOG_DRAW,
		.by = { { k->sharpness, k->threshold, k->contrast, k->opacity } },
		.whole = { { k->flow_px > 0, k->alone } },
		.where = k->where };
	set_colour(ret->by[1], k->colour);
}

/* Into the returned plane: 5. */
static GLuint dog_along(
	struct gles_filter_job *j, const struct dog_step *k, float sigma, GLuint lightness)
{
	struct gles_pass p;
	GLuint fine = gles_filter_plane(j, 3, 1), coarse = gles_filter_plane(j, 5, 1),
	       difference = gles_filter_plane(j, 7, 1);
	struct gles_trace t = { .flow = gles_flow_find(j, 2 * k->sigma_px + 1),
		.from = lightness,
		.to = fine,
		.is_across = true,
		.sigma = sigma };
	gles_trace_run(j, &t);
	t.to = coarse;
	t.sigma = sigma * k->ratio;
	gles_trace_run(j, &t);
	dog_numbers(k, &p);
	p.mode = DOG_COMBINE;
	p.plane[0] = fine;
	p.plane[1] = coarse;
	p.plane[3] = difference;
	gles_pass_run(j, &p);
	t = (struct gles_trace){ .flow = t.flow,
		.from = difference,
		.to = coarse,
		.sigma = fmaxf(k->flow_px * j->px, 0.5f) };
	gles_trace_run(j, &t);
	return coarse;
}

static void dog(struct gles_filter_job *j, const struct step *s)
{
	const struct dog_step *k = &s->dog;
	float sigma = fmaxf(k->sigma_px * j->px, 0.3f);
	uint32_t width = j->image.width, height = j->image.height;
	GLuint solid = gles_solidity(j, 6), lightness = gles_lightness(j, 4);
	struct gles_pass p;
	dog_numbers(k, &p);
	if (k->flow_px > 0) {
		p.plane[0] = dog_along(j, k, sigma, lightness);
	} else {
		GLuint fine = gles_filter_plane(j, 0, 1), coarse = gles_filter_plane(j, 1, 1);
		struct gles_blur b = { lightness, fine, width, height, 1, 2 };
		gles_blur_run(j, &b, sigma);
		b.to = coarse;
		gles_blur_run(j, &b, sigma * k->ratio);
		p.plane[0] = fine;
		p.plane[1] = coarse;
	}
	p.plane[2] = solid;
	gles_pass_run(j, &p);
	if (k->alone)
		gles_filter_finish(j, k->where, 1, 0);
	else
		gles_filter_swap(&j->image);
}

enum { EDGES_FIND, EDGES_SPREAD, EDGES_LINK, EDGES_WIDEN, EDGES_DRAW };

static void edges_numbers(const struct gles_filter_job *j, const struct edges_step *k,
	GLuint surface, struct gles_pass *ret)
{
	float px = j->px;
	float bend[2];
	int ways[EDGES_WAYS][EDGES_REACH][2];
	edges_bends(k, bend);
	edges_ways(ways);
	*ret = (struct gles_pass){ .use = GLES_FILTER_EDGES,
		.by = { { k->depth, bend[0], k->opacity, k->wobble_px * px },
			{ k->colour[0], k->colour[1], k->colour[2], bend[1] },
			{ EDGES_STRAIGHT_SOME, EDGES_STRAIGHT_ALL, EDGES_ONE_SIDE,
				j->f->scene->spacing_median_m } },
		.whole = { { (int32_t)floorf(fmaxf(k->width_px * px, 0.5f) / 2), k->segments } },
		.plane = { [3] = surface },
		.where = k->where };
	memcpy(ret->whole[1], ways, sizeof ways);
}

static void edges_step(
	struct gles_filter_job *j, struct gles_pass *p, int32_t mode, GLuint a, GLuint b, GLuint d)
{
	p->mode = mode;
	p->plane[0] = a;
	p->plane[1] = b;
	p->plane[3] = d;
	gles_pass_run(j, p);
}

static void edges(struct gles_filter_job *j, const struct step *s)
{
	const struct edges_step *k = &s->edges;
	struct gles_pass p;
	GLuint sway[2] = { 0 }, found, spread, line, surface = j->image.surface->name;
	edges_numbers(j, k, surface, &p);
	GLuint calm = k->wobble_px > 0 ? gles_calm_depth(j, 7, 0) : 0;
	for (uint32_t n = 0; n < 2 && k->wobble_px > 0; n++)
		sway[n] = gles_noise(j, 4 + n, 40 * j->px, 71 + n, calm);
	p.plane[2] = gles_solidity(j, 3);
	found = gles_filter_plane(j, 0, 1);
	spread = gles_filter_plane(j, 1, 1);
	line = gles_filter_plane(j, 6, 1);
	edges_step(j, &p, EDGES_FIND, 0, found, surface);
	edges_step(j, &p, EDGES_SPREAD, found, spread, 0);
	edges_step(j, &p, EDGES_LINK, found, spread, line);
	edges_step(j, &p, EDGES_WIDEN, line, spread, 0);
	gles_blur_run(j, &(struct gles_blur){ spread, line, j->image.width, j->image.height, 1, 2 },
		EDGES_SOFT_PX);
	edges_step(j, &p, EDGES_DRAW, line, sway[0], sway[1]);
	gles_filter_swap(&j->image);
}

/* ---- paint and pencil ---- */

enum { WATERCOLOUR_WOBBLE, WATERCOLOUR_PAINT };

static void watercolour(struct gles_filter_job *j, const struct step *s)
{
	const struct watercolour_step *k = &s->watercolour;
	uint32_t width = j->image.width, height = j->image.height;
	GLuint wobbled = gles_filter_plane(j, 0, 1), edge = gles_filter_plane(j, 2, 1),
	       smooth = gles_filter_plane(j, 1, 1), more[2] = { 0 };
	struct gles_pass p = { .use = GLES_FILTER_WATERCOLOUR,
		.mode = WATERCOLOUR_WOBBLE,
		.to = wobbled,
		.by = { { k->wobble_px * j->px, k->darkening, k->turbulence, k->dispersion },
			{ k->grain } } };
	GLuint calm = gles_calm_depth(j, 8, 7);
	p.plane[0] = gles_noise(j, 3, 18 * j->px, 11, calm);
	p.plane[1] = gles_noise(j, 4, 18 * j->px, 12, calm);
	p.plane[3] = edge;
	if (k->turbulence > 0)
		more[0] = gles_noise(j, 5, k->turbulence_px * j->px, 31, calm);
	if (k->dispersion > 0)
		more[1] = gles_noise(j, 6, 5 * j->px, 57, calm);
	gles_pass_run(j, &p);
	gles_blur_run(j, &(struct gles_blur){ edge, smooth, width, height, 1, 7 }, 1.2f * j->px);
	p.mode = WATERCOLOUR_PAINT;
	p.from = wobbled;
	p.to = 0;
	p.plane[0] = smooth;
	p.plane[1] = more[0];
	p.plane[3] = more[1];
	gles_pass_run(j, &p);
	gles_filter_swap(&j->image);
}

static void oil(struct gles_filter_job *j, const struct step *s)
{
	const struct oil_step *k = &s->oil;
	float width = fmaxf(k->width_px * j->px, 1.2f);
	struct gles_pass p = { .use = GLES_FILTER_OIL,
		.by = { { k->relief, k->shine, k->variation, k->canvas } } };
	struct gles_trace t = { .flow = gles_flow_find(j, k->tensor_px),
		.from = gles_noise(j, 3, width, 5, gles_calm_depth(j, 5, 6)),
		.to = gles_filter_plane(j, 4, 1),
		.by = TRACE_NOISE,
		.sigma = fmaxf(k->length_px * j->px / 2, 1) };
	gles_trace_run(j, &t);
	p.plane[0] = t.to;
	gles_pass_run(j, &p);
	gles_filter_swap(&j->image);
}

/* Where filter-pencil.glsl has them. */
enum { PENCIL_EYE = 8, PENCIL_PARAMETERS = 80 };

static void pencil(struct gles_filter_job *j, const struct step *s)
{
	const struct pencil_step *k = &s->pencil;
	struct pencil_layer layer[PENCIL_LAYERS_MOST];
	struct gles_pass p = { .use = GLES_FILTER_PENCIL };
	int layers = pencil_layers(k, j->f, layer);
	p.whole[0][0] = layers;
	for (int n = 0; n < layers; n++) {
		int at = PENCIL_EYE + n * FILTER_NOISE_OCTAVES / 4;
		memcpy(p.by[n], layer[n].across, sizeof layer[n].across);
		memcpy(p.by[at], layer[n].eye, sizeof layer[n].eye);
		memcpy(p.whole[at], layer[n].eye_whole, sizeof layer[n].eye_whole);
	}
	float *rule = p.by[PENCIL_PARAMETERS];
	rule[0] = k->spacing_px;
	rule[1] = k->width_px;
	rule[2] = k->wobble_px;
	rule[3] = k->pressure;
	p.by[PENCIL_PARAMETERS + 1][0] = k->own_colour;
	set_colour(p.by[PENCIL_PARAMETERS + 2], k->colour);
	p.plane[0] = gles_lightness(j, 0);
	GLuint calm = gles_calm_depth(j, 3, 4);
	p.plane[1] = gles_noise(j, 1, 45 * j->px, 17, calm);
	p.plane[2] = gles_waves(j, 2, PENCIL_SWAY_PX * j->px, calm);
	p.plane[3] = j->image.surface->name;
	gles_pass_run(j, &p);
	gles_filter_swap(&j->image);
}

/* ---- by pixels alone ---- */

static void grade(struct gles_filter_job *j, const struct step *s)
{
	const struct grade_step *k = &s->grade;
	struct grade_tables t;
	struct gles_pass p = { .use = GLES_FILTER_GRADE,
		.by = { [3] = { k->saturation, k->warmth, k->tint_amount, k->segments } } };
	grade_tables_make(k, &t);
	for (int n = 0; n < 3; n++) {
		memcpy(p.by[n], t.turn[n], sizeof t.turn[n]);
		p.by[4][n] = (float)k->tint[n] / 255;
	}
	memcpy(p.by[8], t.curve, sizeof t.curve);
	p.plane[3] = j->image.surface ? j->image.surface->name : 0;
	gles_pass_run(j, &p);
	gles_filter_finish(j, k->where, 1, 0);
}

/* ---- by depths ---- */

enum { WARP_COLOURS, WARP_NUMBERS };

static void warp_numbers(
	struct gles_filter_job *j, struct gles_pass *p, struct gles_buffer *b, uint32_t floats)
{
	if (!b)
		return;
	p->whole[0][0] = (int32_t)floats;
	p->plane[0] = b->name;
	p->plane[1] = gles_filter_plane(j, 1, floats);
	gles_pass_run(j, p);
	gles_filter_take(j, b, 1);
}

static void warp(struct gles_filter_job *j, const struct step *s)
{
	struct warp_wave w = warp_wave_of(&s->warp, j->px, j->time_s);
	struct gles_pass p = { .use = GLES_FILTER_WARP,
		.mode = WARP_COLOURS,
		.plane = { 0, gles_filter_plane(j, 0, 1) },
		.by = { { w.wave[0], w.wave[1], w.way[0], w.way[1] }, { w.amplitude, w.phase } } };
	gles_pass_run(j, &p);
	p.mode = WARP_NUMBERS;
	warp_numbers(j, &p, j->image.surface, 4);
	warp_numbers(j, &p, j->image.grey, 1);
	gles_filter_take(j, j->image.depth, 0);
	gles_filter_swap(&j->image);
}

enum { SHADE_CORNERS, SHADE_DOME, SHADE_DARKEN };

static void darken(struct gles_filter_job *j, GLuint by)
{
	struct gles_pass p = { .use = GLES_FILTER_SHADE, .mode = SHADE_DARKEN, .plane = { by } };
	gles_pass_run(j, &p);
	gles_filter_swap(&j->image);
}

static void occlusion(struct gles_filter_job *j, const struct step *s)
{
	float ways[OCCLUSION_TURNS][OCCLUSION_RING][2];
	GLuint shade = gles_filter_plane(j, 0, 1), smooth = gles_filter_plane(j, 1, 1);
	struct gles_pass p = { .use = GLES_FILTER_SHADE,
		.mode = SHADE_CORNERS,
		.plane = { 0, shade },
		.by = { { s->occlusion.radius_m, s->occlusion.strength } } };
	_Static_assert(sizeof ways <= sizeof p.by - sizeof p.by[0], "there is room for them");
	occlusion_ways(ways);
	memcpy(p.by[1], ways, sizeof ways);
	gles_pass_run(j, &p);
	gles_blur_run(
		j, &(struct gles_blur){ shade, smooth, j->image.width, j->image.height, 1, 2 }, 2);
	darken(j, smooth);
}

static void edl(struct gles_filter_job *j, const struct step *s)
{
	int ring[EDL_AROUND][2];
	float radius = edl_radius(s->edl.radius_px * j->px);
	GLuint shade = gles_filter_plane(j, 0, 1);
	struct gles_pass p = { .use = GLES_FILTER_SHADE,
		.mode = SHADE_DOME,
		.plane = { 0, shade },
		.by = { { s->edl.strength, (float)j->f->camera.far_m, radius,
			j->f->scene->spacing_median_m } } };
	edl_ring(radius, ring);
	for (int n = 0; n < EDL_AROUND; n++)
		memcpy(p.whole[n], ring[n], sizeof ring[n]);
	gles_pass_run(j, &p);
	darken(j, shade);
}

/* ---- networks run on the processor ---- */

static void neural(struct gles_filter_job *j, const struct step *s)
{
	const struct gles_filter_image *i = &j->image;
	size_t pixels = (size_t)i->width * i->height;
	filter_room room = { 0 };
	g_autofree uint8_t(*rgba)[4] = g_malloc_n(pixels, sizeof *rgba),
		   (*spare)[4] = g_malloc_n(pixels, sizeof *spare);
	g_autofree float *away = i->away ? g_new(float, pixels) : NULL;
	struct filter_job on = { .f = j->f,
		.room = &room,
		.lanes = j->f->lanes,
		.px = j->px,
		.image = { .width = i->width,
			.height = i->height,
			.left = i->left,
			.top = i->top,
			.rgba = rgba,
			.spare = spare,
			.away = away,
			.paper = j->paper } };
	if (gles_buffer_read(j->d->c, i->pixels, pixels * 4, rgba, &j->error) &&
		(!away || gles_buffer_read(j->d->c, i->away, pixels * 4, away, &j->error))) {
		filter_neural(&on, s);
		gles_buffer_put(j->d->c, i->pixels, on.image.rgba, (int64_t)pixels * 4,
			"filters of a picture", &j->error);
	}
	filter_room_clear(&room);
}

/* ---- the table ---- */

static const struct row {
	const char *name;
	gles_filter_kind *run;
} rows[] = {
	{ "kuwahara", gles_kuwahara },
	{ "anisotropic-kuwahara", gles_anisotropic },
	{ "bilateral", gles_bilateral },
	{ "gaussian", gles_gaussian },
	{ "gaps", gles_gaps },
	{ "quantise", quantise },
	{ "dog", dog },
	{ "edges", edges },
	{ "watercolour", watercolour },
	{ "flow", gles_flow },
	{ "oil", oil },
	{ "pencil", pencil },
	{ "grade", grade },
	{ "warp", warp },
	{ "occlusion", occlusion },
	{ "edl", edl },
	{ "neural", neural },
};

void gles_filter_run(struct gles_filter_job *j, const struct step *s)
{
	gles_draw_bind_texture(j->d, 2, GL_TEXTURE_2D, j->d->layers.relief);
	gles_draw_bind_texture(j->d, 5, GL_TEXTURE_2D, j->d->srgb);
	for (size_t n = 0; n < G_N_ELEMENTS(rows); n++)
		if (!frame_is_stopped(j->f) && !j->error &&
			strcmp(rows[n].name, s->kind->name) == 0)
			rows[n].run(j, s);
}

/* ---- for tests ---- */

static bool upload(
	gles_draw *d, struct gles_buffer *b, const void *from, size_t bytes, GError **error)
{
	return from ? gles_buffer_put(d->c, b, from, (int64_t)bytes, "a picture", error)
		    : gles_buffer_reserve(d->c, b, (int64_t)bytes, "a picture", error);
}

/* NULL: there is none. */
static float *surface_of(const struct filter_image *i)
{
	size_t pixels = filter_pixels(i);
	float *ret = i->normal ? g_new(float, 4 * pixels) : NULL;
	for (size_t at = 0; ret && at < pixels; at++) {
		memcpy(ret + 4 * at, i->normal[at], sizeof *i->normal);
		ret[4 * at + 3] = i->leaf[at];
	}
	return ret;
}

bool gles_filter_picture(gles_draw *d, const struct filter_job *j, gles_filter_try *run,
	const void *data, GError **error)
{
	const struct filter_image *i = &j->image;
	size_t bytes = filter_pixels(i) * 4;
	g_autofree float *surface = surface_of(i);
	struct gles_buffer pixels = { 0 }, spare = { 0 }, depth = { 0 }, away = { 0 },
			   normals = { 0 }, grey = { 0 };
	struct gles_filter_job on = { .d = d,
		.f = j->f,
		.px = j->px,
		.spacing_px = j->spacing_px,
		.time_s = j->time_s,
		.image = { i->width, i->height, i->left, i->top, &pixels, &spare, &depth,
			surface ? &normals : NULL, i->away ? &away : NULL, &grey } };
	memcpy(on.paper, i->paper, 3);
	bool good = gles_draw_hold(d, j->f, error) && upload(d, &pixels, i->rgba, bytes, error) &&
		    upload(d, &spare, NULL, bytes, error) &&
		    upload(d, &depth, i->depth_m, bytes, error) &&
		    (!surface || upload(d, &normals, surface, 4 * bytes, error)) &&
		    (!i->away || upload(d, &away, i->away, bytes, error)) &&
		    upload(d, &grey, NULL, bytes, error);
	if (good)
		run(&on, data);
	if (on.error)
		g_propagate_error(error, on.error);
	good = good && !on.error && gles_buffer_read(d->c, &pixels, bytes, i->rgba, error) &&
	       gles_buffer_read(d->c, &depth, bytes, i->depth_m, error);
	struct gles_buffer *all[] = { &pixels, &spare, &depth, &away, &normals, &grey };
	for (size_t n = 0; n < G_N_ELEMENTS(all); n++)
		gles_buffer_clear(d->c, all[n]);
	return good;
}
