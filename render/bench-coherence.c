#include "acquire/cli.h"
#include "render/bench-coherence-style.h"
#include "render/camera-path.h"
#include <math.h>
#include <stdio.h>

#define PATH_FRAMES 40u
/* Of pairs, those that density and tone are measured in. */
#define SAMPLES 5u

static const char *const path_names[PATHS] = { "dolly", "orbit", "pan", "light" };
static const char *const path_specs[PATHS] = { "dolly:2:40", "orbit:0.5:40", "pan:8:40", NULL };
/* Degrees a frame, of the path on which only the light moves. */
#define LIGHT_DEG 0.5
static const char *const all_styles[] = { "figure-7a", "figure-7b", "figure-7c", "figure-7d",
	"figure-1-stipple", "figure-1-strokes-hatching", "figure-1-strokes-stipple", NULL };
/* What the others are compared with. */
#define BASELINE "points"

struct bench {
	const struct bench_coherence_options *options;
	bench_place *place;
	scene *scene;
	view *view;
	struct styled *style; /* the first is the baseline */
	uint32_t styles;
	float *scratch[2];
	struct picture_buffer picture, fine;
	JsonArray *rows; /* NULL: printed */
	uint32_t bars, missed;
};

/* ---- styles ---- */

static bool open_styles(struct bench *b, const struct camera *c, GError **error)
{
	const char *const *names =
		b->options->styles ? (const char *const *)b->options->styles : all_styles;
	b->styles = g_strv_length((char **)names) + 1;
	b->style = g_new0(struct styled, b->styles);
	for (uint32_t n = 0; n < b->styles; n++) {
		struct styled *s = &b->style[n];
		if (!styled_open(s, n ? names[n - 1] : BASELINE, b->place, b->scene, c,
			    n ? b->style : NULL, error) ||
			!styled_try_static(s, c, &b->picture, error))
			return false;
	}
	return true;
}

/* ---- frames ---- */

static bool take_all(struct bench *b, const struct camera *c, GError **error)
{
	for (uint32_t n = 0; n < b->styles; n++)
		if (!styled_take(&b->style[n], c, b->style, &b->picture, &b->fine, error))
			return false;
	return true;
}

static void measure_pair(struct bench *b)
{
	const struct shot *now = &b->style->now, *before = &b->style->before;
	const struct fine_shot *fine_now = &b->style->fine_now,
			       *fine_before = &b->style->fine_before;
	g_autoptr(reprojection) r =
		reprojection_new(&now->camera, now->depth_m, &before->camera, before->depth_m);
	g_autoptr(reprojection) fine = reprojection_new(
		&fine_now->camera, fine_now->depth_m, &fine_before->camera, fine_before->depth_m);
	for (uint32_t n = 0; n < b->styles; n++)
		styled_measure_pair(&b->style[n], r, fine, b->scratch);
}

static bool measure_frame(struct bench *b, GError **error)
{
	for (uint32_t n = 1; n < b->styles; n++)
		if (!styled_measure_frame(
			    &b->style[n], b->style->now.lightness, &b->picture, error))
			return false;
	return true;
}

/* ---- a path ---- */

static void report_path(struct bench *b, int path)
{
	if (!b->rows)
		printf("%s: %.1f million pixels compared, of plain points off by %.4f (root mean "
		       "square)\n",
			path_names[path], (double)b->style->change.places * 1e-6,
			sqrt(reprojection_change(&b->style->change)));
	for (uint32_t n = 0; n < b->styles; n++) {
		struct coherence_row row = styled_row(&b->style[n], path_names[path], b->style);
		if (b->rows)
			json_array_add_object_element(b->rows, coherence_to_json(&row));
		else
			coherence_print(&row, &b->bars, &b->missed);
	}
	fflush(stdout);
}

/* Where the k-th of some pairs begins, spread from one end of the path to the other. */
static uint32_t frame_of_pair(uint32_t k, uint32_t pairs)
{
	return pairs > 1 ? (k * (PATH_FRAMES - 2) + (pairs - 1) / 2) / (pairs - 1) : 0;
}

/* The way's frame; without a way the light's. */
static bool take_frame(struct bench *b, const camera_path *way, uint32_t at, GError **error)
{
	struct camera c = way ? camera_path_at(way, at, b->picture.width, b->picture.height)
			      : view_camera(b->view, b->picture.width, b->picture.height);
	for (uint32_t n = 0; !way && n < b->styles; n++)
		styled_turn_light(&b->style[n], LIGHT_DEG * at);
	return take_all(b, &c, error);
}

/* drawn: whether the first one is there already. */
static bool take_pair(
	struct bench *b, const camera_path *way, uint32_t at, bool drawn, GError **error)
{
	if (!drawn && !take_frame(b, way, at, error))
		return false;
	for (uint32_t n = 0; n < b->styles; n++)
		styled_step(&b->style[n]);
	return take_frame(b, way, at + 1, error);
}

static bool measure_path(struct bench *b, int path, GError **error)
{
	uint32_t pairs = b->options->pairs, every = MAX(pairs / SAMPLES, 1);
	g_autoptr(camera_path) way = NULL;
	if (path_specs[path])
		way = camera_path_parse(path_specs[path], b->view, &b->place->sources, error);
	if (path_specs[path] && !way)
		return false;
	for (uint32_t n = 0; n < b->styles; n++)
		styled_begin_path(&b->style[n]);
	for (uint32_t k = 0; k < pairs; k++) {
		uint32_t at = frame_of_pair(k, pairs);
		bool drawn = k && at == frame_of_pair(k - 1, pairs) + 1;
		if (!take_pair(b, way, at, drawn, error))
			return false;
		measure_pair(b);
		if ((k % every == 0 || k + 1 == pairs) && !measure_frame(b, error))
			return false;
	}
	report_path(b, path);
	return true;
}

/* ---- all of it ---- */

static bool measure(struct bench *b, GError **error)
{
	struct camera c = view_camera(b->view, b->picture.width, b->picture.height);
	if (!open_styles(b, &c, error))
		return false;
	if (!b->rows)
		coherence_print_heading(b->options);
	for (int path = 0; path < PATHS; path++)
		if (!measure_path(b, path, error))
			return false;
	return true;
}

static bool open_all(struct bench *b, GError **error)
{
	const struct bench_coherence_options *o = b->options;
	b->place = bench_place_new(&o->place, (double)o->width / o->height, error);
	if (!b->place ||
		!view_find(&b->place->sources, o->view ? o->view : "walk", &b->view, error))
		return false;
	b->scene = bench_place_scene(b->place, error);
	if (!b->scene)
		return false;
	for (int k = 0; k < 2; k++)
		b->scratch[k] = g_new0(float, b->scene->count);
	b->picture = picture_buffer_new(o->width, o->height);
	b->fine = picture_buffer_new(FINE * o->width, FINE * o->height);
	return true;
}

static void report(struct bench *b)
{
	if (!b->rows) {
		printf("%u of %u bars are missed\n", b->missed, b->bars);
		return;
	}
	JsonObject *o = json_object_new();
	json_object_set_int_member(o, "width", b->options->width);
	json_object_set_int_member(o, "height", b->options->height);
	json_object_set_int_member(o, "pairs", b->options->pairs);
	json_object_set_string_member(o, "view", b->view->name);
	json_object_set_array_member(o, "rows", g_steal_pointer(&b->rows));
	cli_print_json(o);
}

bool bench_coherence(const struct bench_coherence_options *o, GError **error)
{
	struct bench b = { .options = o, .rows = o->json ? json_array_new() : NULL };
	bool good = open_all(&b, error) && measure(&b, error);
	if (good)
		report(&b);
	for (uint32_t n = 0; b.style && n < b.styles; n++)
		styled_close(&b.style[n]);
	g_free(b.style);
	for (int k = 0; k < 2; k++)
		g_free(b.scratch[k]);
	picture_buffer_clear(&b.picture);
	picture_buffer_clear(&b.fine);
	g_clear_pointer(&b.rows, json_array_unref);
	scene_free(b.scene);
	view_free(b.view);
	bench_place_free(b.place);
	return good;
}
