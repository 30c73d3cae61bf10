#include "process/bench-run.h"
#include "render/bench-render-private.h"
#include <malloc.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What is slow is not repeated for longer. */
#define REPEAT_S       4.0
#define NEW_REPEATS    3
#define PARITY_CHANNEL 8

const char *const render_styles[RENDER_STYLES] = { "figure-7a", "figure-7d", "impressionist",
	"points" };

const struct render_paper render_papers[2] = {
	{ "A", 2878000, { 854000, 1017000, 1655000 }, { 725, 763, 1023 }, { 419, 512, 572 },
		{ 33, 30, 28 } },
	{ "B", 3955000, { 1259000, 1990000, 3198000 }, { 1140, 1518, 2214 }, { 621, 800, 974 },
		{ 20, 18, 15 } },
};

static double now_s(void)
{
	return (double)g_get_monotonic_time() * 1e-6;
}

/* ---- memory ---- */

static double resident_bytes(void)
{
	g_autofree char *text = NULL;
	if (!g_file_get_contents("/proc/self/status", &text, NULL, NULL))
		return NAN;
	const char *line = strstr(text, "VmRSS:");
	return line ? strtod(line + 6, NULL) * 1024 : NAN;
}

/* ---- frames ---- */

bool render_fastest(painter *p, const frame *f, uint32_t repeats, struct picture_buffer *to,
	struct draw_times *ret, GError **error)
{
	double began_s = now_s(), all_s = INFINITY;
	for (uint32_t n = 0; n == 0 || (n < repeats && now_s() - began_s < REPEAT_S); n++) {
		struct draw_times t;
		if (!painter_draw(p, f, to, &t, error))
			return false;
		if (n == 0 || t.all_s < ret->all_s)
			*ret = t;
		double from_s = now_s();
		if (!painter_draw(p, f, to, NULL, error))
			return false;
		all_s = fmin(all_s, now_s() - from_s);
	}
	ret->all_s = fmin(ret->all_s, all_s);
	return true;
}

/* One style, all cameras. reference NULL: none to compare with. */
struct series {
	struct render_scene *to;
	const struct bench_render_options *options;
	const char *style;
	frame *frame;
	painter *painter, *reference;
	struct picture_buffer *picture;
};

static struct render_parity parity_of(
	const struct picture_buffer *a, const struct picture_buffer *b)
{
	uint64_t sum = 0, near = 0, pixels = (uint64_t)a->width * a->height;
	for (uint64_t i = 0; i < pixels; i++) {
		int most = 0;
		for (int k = 0; k < 3; k++) {
			int off = abs(a->rgba[i][k] - b->rgba[i][k]);
			sum += (uint64_t)off;
			most = MAX(most, off);
		}
		near += most <= PARITY_CHANNEL;
	}
	return (struct render_parity){ (double)sum / (3.0 * (double)pixels),
		(double)near / (double)pixels };
}

static bool compare(const struct series *s, struct render_row *row, GError **error)
{
	struct picture_buffer other = picture_buffer_new(s->picture->width, s->picture->height);
	bool good = painter_draw(s->reference, s->frame, &other, NULL, error);
	if (good)
		row->parity = parity_of(s->picture, &other);
	row->has_parity = good;
	picture_buffer_clear(&other);
	return good;
}

static bool run_series(const struct series *s, GError **error)
{
	for (int n = 0; n < RENDER_CAMERAS; n++) {
		struct render_row row = { .camera = &s->to->camera[n],
			.style = s->style,
			.backend = painter_name(s->painter),
			.paper_fps = s->to->paper->fps[n] };
		if (!frame_move(s->frame, &row.camera->camera, error) ||
			!render_fastest(s->painter, s->frame, s->options->repeats, s->picture,
				&row.times, error) ||
			(s->reference && !compare(s, &row, error)))
			return false;
		g_array_append_val(s->to->rows, row);
	}
	return true;
}

/* ---- backends ---- */

/* NULL: the reason is told. */
static painter *open_gles(char **ret_why_not)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(painter) p = painter_new(BACKEND_WISH_GLES, &error);
	if (!p)
		*ret_why_not = g_strdup(error->message);
	else if (strcmp(painter_name(p), "gles") != 0)
		*ret_why_not = g_strdup("this program draws with cpu only");
	else
		return g_steal_pointer(&p);
	return NULL;
}

static bool draw_all(struct series *s, const bench_place *p, const scene *points, GError **error)
{
	for (int n = 0; n < RENDER_STYLES; n++) {
		s->style = render_styles[n];
		g_autoptr(drawing) d = bench_place_drawing(p, s->style, error);
		g_autoptr(frame) f =
			d ? frame_new(points, d, &s->to->camera[0].camera, error) : NULL;
		s->frame = f;
		if (!f || !run_series(s, error))
			return false;
	}
	return true;
}

/* ---- a scene ---- */

static struct camera overview_camera(const bench_place *p, const struct bench_render_options *o)
{
	g_autoptr(view) all = view_built_in(&p->sources, "overview");
	return view_camera(all, o->width, o->height);
}

/* Nearly all points are in view, as in what masks of others were measured with. */
static bool measure_mask(
	struct series *s, const bench_place *p, const scene *points, GError **error)
{
	struct camera c = overview_camera(p, s->options);
	struct draw_times t;
	g_autoptr(drawing) d = bench_place_drawing(p, render_styles[0], error);
	g_autoptr(frame) f = d ? frame_new(points, d, &c, error) : NULL;
	if (!f || !render_fastest(s->painter, f, s->options->repeats, s->picture, &t, error))
		return false;
	s->to->overview_mask_rate = t.points_in_view / t.mask_s;
	return true;
}

static bool find_cameras(struct render_scene *s, const bench_place *p, const scene *points,
	const struct bench_render_options *o, GError **error)
{
	g_autoptr(drawing) d = bench_place_drawing(p, render_styles[0], error);
	struct camera c = overview_camera(p, o);
	g_autoptr(frame) f = d ? frame_new(points, d, &c, error) : NULL;
	return f && bench_cameras_find(p, f, s->paper->in_view, RENDER_CAMERAS, s->camera, error);
}

static bool time_new(struct render_scene *s, const model *m, GError **error)
{
	s->new_s = INFINITY;
	for (int n = 0; n < NEW_REPEATS; n++) {
		double began_s = now_s();
		g_autoptr(scene) points = scene_new(m, error);
		if (!points)
			return false;
		s->new_s = fmin(s->new_s, now_s() - began_s);
	}
	return true;
}

static bool measure_with(struct render_scene *s, struct series *series, const bench_place *p,
	const model *m, painter *gles, GError **error)
{
	if (!time_new(s, m, error))
		return false;
	malloc_trim(0);
	double before = resident_bytes();
	g_autoptr(scene) points = scene_new(m, error);
	if (!points || !find_cameras(s, p, points, series->options, error) ||
		!draw_all(series, p, points, error) || !measure_mask(series, p, points, error))
		return false;
	s->points = points->count;
	s->bytes_resident = (resident_bytes() - before) / points->count;
	s->bytes_of_scene = (double)scene_bytes(points) / points->count;
	bench_vtk_run(points, s->camera, RENDER_CAMERAS, p->work, &s->vtk);
	series->reference = series->painter;
	series->painter = gles;
	return !gles || draw_all(series, p, points, error);
}

bool render_scene_measure(struct render_scene *s, const bench_place *p, const model *m,
	const struct bench_render_options *o, GError **error)
{
	g_autoptr(painter) cpu = painter_new(BACKEND_WISH_CPU, error);
	g_autoptr(painter) gles = o->cpu_only ? NULL : open_gles(&s->gles_why_not);
	struct picture_buffer picture = picture_buffer_new(o->width, o->height);
	/* So that it is there before memory is counted. */
	memset(picture.rgba, 0, (size_t)o->width * o->height * 4);
	s->rows = g_array_new(FALSE, FALSE, sizeof(struct render_row));
	struct series series = { s, o, NULL, NULL, cpu, NULL, &picture };
	bool good = cpu && measure_with(s, &series, p, m, gles, error);
	picture_buffer_clear(&picture);
	return good;
}

void render_scene_clear(struct render_scene *s)
{
	if (s->rows)
		g_array_unref(s->rows);
	g_free(s->gles_why_not);
	bench_vtk_clear(&s->vtk);
}

double render_mask_rate(const struct render_scene *s)
{
	double points = 0, seconds = 0;
	for (guint n = 0; n < s->rows->len; n++) {
		const struct render_row *r = &g_array_index(s->rows, struct render_row, n);
		if (r->has_parity || strcmp(r->style, render_styles[0]) != 0)
			continue;
		points += (double)r->camera->in_view;
		seconds += r->times.mask_s;
	}
	return points / seconds;
}
