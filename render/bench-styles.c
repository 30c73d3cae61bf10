#include "render/bench-styles.h"
#include "acquire/cli.h"
#include "process/site-lines.h"
#include "render/bench-flight.h"
#include "render/painter.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define FPS_WANTED 60.0
/* GPUs run slowly when they have had nothing to do: frames that do not count are drawn for so long. */
#define WARM_S 0.25
/* What is slow is not repeated for longer. */
#define REPEAT_S 3.0
/* Of the flight, from one frame to the next. */
#define STEP     2e-4
#define FLIGHT_S 20.0

static const struct place {
	const char *name;
	double at; /* of the flight */
} places[] = { { "among", 0.3 }, { "above", 1.0 - 64 * STEP } };

struct bench {
	const struct bench_styles_options *options;
	bench_place *place;
	char *path;
	model *model;
	segments *tree;
	scene *scene;
	painter *painter;
	struct bench_flight flight;
	struct picture_buffer picture;
	JsonArray *rows; /* NULL: printed */
};

struct row {
	const char *style;
	const struct place *place;
	struct draw_times times; /* of one frame, whose stages wait for each other */
	double median_s, worst_s;
};

static double now_s(void)
{
	return 1e-6 * (double)g_get_monotonic_time();
}

/* ---- the site ---- */

static bool find_site(struct bench *b, GError **error)
{
	const struct bench_styles_options *o = b->options;
	struct bench_town town;
	b->place = bench_place_new(&o->place, (double)o->width / o->height, error);
	if (!b->place)
		return false;
	b->path = o->million_points > 0
			  ? bench_place_town(b->place, o->million_points, &town, error)
			  : g_strdup(b->place->path);
	b->model = b->path ? model_open(b->path, error) : NULL;
	return b->model && segments_load_any(b->path, &b->tree, error);
}

static bool open_all(struct bench *b, GError **error)
{
	if (!find_site(b, error))
		return false;
	b->flight = bench_flight_over(b->model, FLIGHT_S);
	b->scene = scene_new(b->model, error);
	g_autoptr(profile_lines) lines = b->scene ? site_lines_load(b->path, NULL) : NULL;
	if (lines)
		scene_set_lines(b->scene, lines);
	b->painter = b->scene ? painter_new(b->options->backend, error) : NULL;
	return b->painter;
}

static struct camera camera_of(const struct bench *b, const struct place *p, uint32_t step)
{
	return bench_flight_camera(
		&b->flight, p->at + STEP * (step % 64), b->options->width, b->options->height);
}

/* ---- frames ---- */

static int by_value(const void *a, const void *b)
{
	const double *x = a, *y = b;
	return (*x > *y) - (*x < *y);
}

static bool draw(struct bench *b, frame *f, const struct place *p, uint32_t step,
	struct draw_times *ret_times, double *ret_s, GError **error)
{
	struct camera c = camera_of(b, p, step);
	double began_s = now_s();
	bool good = frame_move(f, &c, error) &&
		    painter_draw(b->painter, f, &b->picture, ret_times, error);
	*ret_s = now_s() - began_s;
	return good;
}

static bool measure(struct bench *b, frame *f, struct row *row, GError **error)
{
	g_autofree double *s = g_new(double, b->options->repeats);
	double began_s = now_s(), unused;
	uint32_t step = 0, n = 0;
	do {
		if (!draw(b, f, row->place, step++, NULL, &unused, error))
			return false;
	} while (now_s() - began_s < WARM_S);
	if (!draw(b, f, row->place, step++, &row->times, &unused, error))
		return false;
	for (began_s = now_s(); n == 0 || (n < b->options->repeats && now_s() - began_s < REPEAT_S);
		n++)
		if (!draw(b, f, row->place, step++, NULL, &s[n], error))
			return false;
	qsort(s, n, sizeof *s, by_value);
	row->median_s = s[n / 2];
	row->worst_s = s[n - 1];
	return true;
}

/* ---- figures ---- */

static void print_row(const struct row *r)
{
	const struct draw_times *t = &r->times;
	printf("%-26s %-6s %7.2f %6.0f  %6.1f %6.1f %6.1f %6.1f %6.1f  %7.1f %7.1f %6.1f%s\n",
		r->style, r->place->name, 1e-6 * (double)t->points_in_view, 1e-3 * t->strokes,
		1e3 * t->cull_s, 1e3 * t->mask_s, 1e3 * t->choose_s, 1e3 * (t->bin_s + t->draw_s),
		1e3 * (t->filter_s + t->composite_s), 1e3 * r->median_s, 1e3 * r->worst_s,
		1 / r->median_s, 1 / r->median_s >= FPS_WANTED ? "" : "*");
	fflush(stdout);
}

static void add_row(JsonArray *to, const struct row *r)
{
	const struct draw_times *t = &r->times;
	JsonObject *o = json_object_new();
	json_object_set_string_member(o, "style", r->style);
	json_object_set_string_member(o, "camera", r->place->name);
	json_object_set_int_member(o, "points_in_view", (gint64)t->points_in_view);
	json_object_set_int_member(o, "strokes", t->strokes);
	json_object_set_double_member(o, "cull_ms", 1e3 * t->cull_s);
	json_object_set_double_member(o, "mask_ms", 1e3 * t->mask_s);
	json_object_set_double_member(o, "choose_ms", 1e3 * t->choose_s);
	json_object_set_double_member(o, "draw_ms", 1e3 * (t->bin_s + t->draw_s));
	json_object_set_double_member(o, "filters_ms", 1e3 * (t->filter_s + t->composite_s));
	json_object_set_double_member(o, "frame_median_ms", 1e3 * r->median_s);
	json_object_set_double_member(o, "frame_worst_ms", 1e3 * r->worst_s);
	json_object_set_double_member(o, "fps", 1 / r->median_s);
	json_array_add_object_element(to, o);
}

static bool measure_style(struct bench *b, const char *name, GError **error)
{
	g_autoptr(style) s = style_find(name, b->path, error);
	g_autoptr(drawing) d = s ? drawing_new(s, b->tree, NULL, error) : NULL;
	for (size_t n = 0; d && n < G_N_ELEMENTS(places); n++) {
		struct camera c = camera_of(b, &places[n], 0);
		struct row row = { .style = name, .place = &places[n] };
		g_autoptr(frame) f = frame_new(b->scene, d, &c, error);
		if (!f || !measure(b, f, &row, error))
			return false;
		if (b->rows)
			add_row(b->rows, &row);
		else
			print_row(&row);
	}
	return d;
}

static bool measure_all(struct bench *b, GError **error)
{
	const struct bench_styles_options *o = b->options;
	g_auto(GStrv) shipped = o->styles ? NULL : style_names(NULL);
	char **name = o->styles ? o->styles : shipped;
	if (!b->rows)
		printf("%s\nstyles: %.1f million points, %u x %u, frames of a moving camera, the "
		       "median of %u; reach on a GPU: %.0f fps, * is fewer\n"
		       "style                      camera  M seen k strk    cull   mask choose   "
		       "draw filter "
		       "  median   worst    fps\n",
			painter_why(b->painter), 1e-6 * (double)model_count(b->model), o->width,
			o->height, o->repeats, FPS_WANTED);
	for (; *name && !cli_interrupted(); name++) {
		g_autoptr(GError) why = NULL;
		if (measure_style(b, *name, &why))
			continue;
		if (o->styles) {
			g_propagate_error(error, g_steal_pointer(&why));
			return false;
		}
		/* It needs what is not there, a network of one's own, say. */
		if (!b->rows)
			printf("%-22s %s\n", *name, why->message);
	}
	return true;
}

static void print_json(struct bench *b)
{
	JsonObject *o = json_object_new();
	json_object_set_int_member(o, "points", (gint64)model_count(b->model));
	json_object_set_string_member(o, "backend", painter_name(b->painter));
	json_object_set_string_member(o, "why", painter_why(b->painter));
	json_object_set_int_member(o, "width", b->options->width);
	json_object_set_int_member(o, "height", b->options->height);
	json_object_set_array_member(o, "styles", g_steal_pointer(&b->rows));
	cli_print_json(o);
}

bool bench_styles(const struct bench_styles_options *options, GError **error)
{
	struct bench b = { .options = options,
		.picture = picture_buffer_new(options->width, options->height),
		.rows = options->json ? json_array_new() : NULL };
	cli_catch_interrupts();
	bool good = open_all(&b, error) && measure_all(&b, error);
	if (good && b.rows)
		print_json(&b);
	g_clear_pointer(&b.rows, json_array_unref);
	picture_buffer_clear(&b.picture);
	painter_free(b.painter);
	scene_free(b.scene);
	segments_free(b.tree);
	model_free(b.model);
	bench_place_free(b.place);
	g_free(b.path);
	return good;
}
