#include "render/bench-hatching.h"
#include "acquire/cli.h"
#include "firmware-io/files.h"
#include "render/bench-render-private.h"
#include "render/bench-statue.h"
#include <math.h>
#include <stdio.h>

/* What is allowed of the paper's time, without a GPU. */
#define TIMES_SLOWER 4.0

static const struct thing {
	uint64_t points;
	uint32_t width, height;
	double paper_ms; /* 0: it gives none */
	double wanted_ms;
} things[] = {
	{ 3500000, 2947, 1661, 30, 30 * TIMES_SLOWER },
	{ 5700000, 2947, 1661, 60, 60 * TIMES_SLOWER },
	{ 11000000, 2947, 1661, 100, 100 * TIMES_SLOWER },
	{ 72027, 1024, 1024, 0, 1000 / 30. },
	{ 152807, 1024, 1024, 0, 1000 / 30. },
	{ 172974, 1024, 1024, 0, 1000 / 30. },
	{ 542199, 1024, 1024, 0, 1000 / 30. },
};

struct bench {
	const struct bench_hatching_options *options;
	painter *painter;
	char *folder;
	JsonArray *rows; /* NULL: printed */
};

/* From the side and above, such that the knot fills most of the height. */
static struct camera camera_of(const struct thing *t)
{
	static const double eye[3] = { 1.6, -4.2, 2.4 }, target[3] = { 0, 0, 0 };
	return camera_look_at(eye, target, 42, t->width, t->height);
}

static drawing *drawing_of(const char *name, GError **error)
{
	g_autoptr(style) s = style_find(name, NULL, error);
	return s ? drawing_new(s, NULL, NULL, error) : NULL;
}

static void print(const struct thing *t, const char *name, const struct draw_times *d)
{
	double ms = d->all_s * 1e3;
	char paper[32] = "-";
	if (t->paper_ms > 0)
		g_snprintf(paper, sizeof paper, "%.0f ms", t->paper_ms);
	printf("%10.3f  %4u x %-4u  %-18s %6.1f %6.1f %6.1f %6.1f %8.1f%s %7.1f  %8s %5.2f M\n",
		(double)t->points * 1e-6, t->width, t->height, name, d->mask_s * 1e3,
		d->choose_s * 1e3, d->bin_s * 1e3, d->draw_s * 1e3, ms,
		ms <= t->wanted_ms ? " " : "*", t->wanted_ms, paper, d->strokes * 1e-6);
	fflush(stdout);
}

static JsonObject *to_json(const struct thing *t, const char *name, const struct draw_times *d)
{
	JsonObject *o = json_object_new();
	json_object_set_int_member(o, "points", (gint64)t->points);
	json_object_set_int_member(o, "width", t->width);
	json_object_set_int_member(o, "height", t->height);
	json_object_set_string_member(o, "style", name);
	json_object_set_double_member(o, "mask_ms", d->mask_s * 1e3);
	json_object_set_double_member(o, "choose_ms", d->choose_s * 1e3);
	json_object_set_double_member(o, "bin_ms", d->bin_s * 1e3);
	json_object_set_double_member(o, "draw_ms", d->draw_s * 1e3);
	json_object_set_double_member(o, "all_ms", d->all_s * 1e3);
	json_object_set_double_member(o, "wanted_ms", t->wanted_ms);
	if (t->paper_ms > 0)
		json_object_set_double_member(o, "paper_ms", t->paper_ms);
	json_object_set_int_member(o, "strokes", d->strokes);
	return o;
}

static bool measure(struct bench *b, const struct thing *t, const scene *s,
	struct picture_buffer *picture, const char *name, GError **error)
{
	struct camera c = camera_of(t);
	struct draw_times times;
	g_autoptr(drawing) d = drawing_of(name, error);
	g_autoptr(frame) f = d ? frame_new(s, d, &c, error) : NULL;
	if (!f || !render_fastest(b->painter, f, b->options->repeats, picture, &times, error))
		return false;
	if (b->rows)
		json_array_add_object_element(b->rows, to_json(t, name, &times));
	else
		print(t, name, &times);
	return true;
}

static bool measure_all(struct bench *b, const struct thing *t, const scene *s, GError **error)
{
	static const char *const large[] = { "pencil", "charcoal", "coloured-crayons", NULL };
	static const char *const small[] = { "stipple-diffuse", "stipple-highlight", "stippling",
		NULL };
	const char *const *names = b->options->styles ? (const char *const *)b->options->styles
				   : t->paper_ms > 0  ? large
						      : small;
	struct picture_buffer picture = picture_buffer_new(t->width, t->height);
	bool good = true;
	for (; good && *names; names++)
		good = measure(b, t, s, &picture, *names, error);
	picture_buffer_clear(&picture);
	return good;
}

static bool measure_thing(struct bench *b, const struct thing *t, GError **error)
{
	g_autofree char *path = g_build_filename(b->folder, "statue.model", NULL);
	if (!bench_statue_write(path, t->points, error))
		return false;
	g_autoptr(model) m = model_open_file(path, error);
	g_autoptr(scene) s = m ? scene_new(m, error) : NULL;
	return s && measure_all(b, t, s, error);
}

static bool measure_things(struct bench *b, GError **error)
{
	b->painter = painter_new(b->options->backend, error);
	if (!b->painter)
		return false;
	if (!b->rows)
		printf("%s\nhatching, the least of %u, ms; * is more than wanted\n"
		       "  M points  picture      style               mask  choose    bin   "
		       "draw      all   wanted   paper's strokes\n",
			painter_why(b->painter), b->options->repeats);
	for (size_t n = 0; n < G_N_ELEMENTS(things); n++)
		if (!measure_thing(b, &things[n], error))
			return false;
	return true;
}

bool bench_hatching(const struct bench_hatching_options *options, GError **error)
{
	struct bench b = { .options = options, .rows = options->json ? json_array_new() : NULL };
	b.folder = g_dir_make_tmp("pleinair-bench-XXXXXX", error);
	bool good = b.folder && measure_things(&b, error);
	if (good && b.rows) {
		JsonObject *o = json_object_new();
		json_object_set_array_member(o, "hatching", g_steal_pointer(&b.rows));
		cli_print_json(o);
	}
	painter_free(b.painter);
	g_clear_pointer(&b.rows, json_array_unref);
	if (b.folder)
		files_remove_tree(b.folder, NULL);
	g_free(b.folder);
	return good;
}
