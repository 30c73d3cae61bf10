/* pleinair render SITE: draws a site in a style, as a picture or as numbered frames along a path of the camera. */
#include "acquire/cli.h"
#include "render/camera-path.h"
#include "render/drawn-site.h"
#include "render/painter.h"
#include <errno.h>
#include <stdio.h>
#include <string.h>

#define COMMAND "render"
/* Of the picture before it is reduced. */
#define PIXELS_MAX ((uint64_t)1 << 29)

static char *style_name, *size_text, *view_name, *output, *backend_name, *path_text, *save_name;
static gboolean list_views, times, json;
static int supersample = 2;

static const GOptionEntry entries[] = {
	{ "style", 's', 0, G_OPTION_ARG_STRING, &style_name,
		"A style by its name, or a file (default: the view's, else figure-7d)", "STYLE" },
	{ "size", 0, 0, G_OPTION_ARG_STRING, &size_text, "Of the picture (default 1600x1200)",
		"WxH" },
	{ "view", 'v', 0, G_OPTION_ARG_STRING, &view_name,
		"A saved view, overview, walk, plan, station-K, or X,Y,Z:X,Y,Z[:FOV] (default "
		"overview)",
		"VIEW" },
	{ "output", 'o', 0, G_OPTION_ARG_FILENAME, &output,
		"Where the picture goes (default SITE/exports/STYLE-VIEW.png); of a path "
		"FILE-0000.png and so on",
		"FILE.png" },
	{ "path", 0, 0, G_OPTION_ARG_STRING, &path_text,
		"Frames along a way of the camera: orbit, dolly, pan, stations, views:A,B,C",
		"PATH" },
	{ "supersample", 0, 0, G_OPTION_ARG_INT, &supersample,
		"Draw so many times as large and reduce (1 to 8; default 2)", "N" },
	{ "backend", 0, 0, G_OPTION_ARG_STRING, &backend_name, "auto, cpu or gles (default auto)",
		"WHICH" },
	{ "save-view", 0, 0, G_OPTION_ARG_STRING, &save_name,
		"Keep the view, with the style, under this name", "NAME" },
	{ "list-views", 0, 0, G_OPTION_ARG_NONE, &list_views, "Only print the site's views", NULL },
	{ "times", 0, 0, G_OPTION_ARG_NONE, &times, "Print how long each stage took", NULL },
	{ "json", 0, 0, G_OPTION_ARG_NONE, &json, "Print what was drawn as JSON", NULL },
	{ NULL },
};

typedef struct work work;
struct work {
	drawn_site *site;
	drawing *drawing;
	view *view;
	camera_path *path; /* NULL: one picture */
	painter *painter;
	frame *frame;
	uint32_t width, height;
	char *style;
	struct cli_bar bar;
	struct draw_times sum;
	uint32_t frames;
};

static void work_clear(struct work *w)
{
	frame_free(w->frame);
	painter_free(w->painter);
	camera_path_free(w->path);
	view_free(w->view);
	drawing_free(w->drawing);
	drawn_site_free(w->site);
	g_free(w->style);
}
G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC(work, work_clear)

/* ---- what is drawn ---- */

static bool open_views(struct work *w, const char *site_folder, GError **error)
{
	w->site = drawn_site_new(site_folder, (double)w->width / w->height, error);
	return w->site;
}

static bool find_view(struct work *w, GError **error)
{
	const struct view_sources *sources = &w->site->sources;
	if (!view_find(sources, view_name ? view_name : "overview", &w->view, error))
		return false;
	w->style = g_strdup(style_name       ? style_name
			    : w->view->style ? w->view->style
					     : "figure-7d");
	if (path_text)
		w->path = camera_path_parse(path_text, w->view, sources, error);
	return !path_text || w->path;
}

static bool open_all(
	struct work *w, const char *site_folder, enum backend_wish wish, GError **error)
{
	if (!open_views(w, site_folder, error) || !find_view(w, error))
		return false;
	cli_bar_update(&w->bar, 0, "reading the model");
	/* The painter first: what it looks for a GPU with must be alone. */
	w->painter = painter_new(wish, error);
	if (!w->painter || !drawn_site_load(w->site, error))
		return false;
	w->drawing = drawn_site_style(w->site, w->style, error);
	return w->drawing;
}

/* ---- pictures ---- */

static struct camera camera_of(const struct work *w, uint32_t frame_number)
{
	struct camera c = w->path ? camera_path_at(w->path, frame_number, w->width, w->height)
				  : view_camera(w->view, w->width, w->height);
	return camera_scaled(&c, supersample);
}

static bool draw_one(struct work *w, uint32_t number, struct picture_buffer *large,
	const char *file, GError **error)
{
	struct draw_times t;
	struct camera c = camera_of(w, number);
	if (w->frame ? !frame_move(w->frame, &c, error)
		     : !(w->frame = frame_new(w->site->scene, w->drawing, &c, error)))
		return false;
	if (!painter_draw(w->painter, w->frame, large, &t, error))
		return false;
	w->sum.cull_s += t.cull_s;
	w->sum.mask_s += t.mask_s;
	w->sum.choose_s += t.choose_s;
	w->sum.bin_s += t.bin_s;
	w->sum.draw_s += t.draw_s;
	w->sum.all_s += t.all_s;
	w->sum.strokes += t.strokes;
	w->sum.points_in_view += t.points_in_view;
	w->sum.chunks_in_view += t.chunks_in_view;
	w->sum.chunks_hidden += t.chunks_hidden;
	struct picture_buffer small =
		supersample > 1 ? picture_buffer_reduced(large, (uint32_t)supersample) : *large;
	bool good = picture_buffer_save(&small, file, error);
	if (supersample > 1)
		picture_buffer_clear(&small);
	return good;
}

static char *file_of_frame(const char *file, uint32_t number)
{
	g_autofree char *stem = g_strndup(file, strlen(file) - strlen(".png"));
	return g_strdup_printf("%s-%04u.png", stem, number);
}

static bool draw_frames(struct work *w, const char *file, GError **error)
{
	uint32_t count = w->path ? camera_path_frames(w->path) : 1;
	struct picture_buffer large = picture_buffer_new(
		w->width * (uint32_t)supersample, w->height * (uint32_t)supersample);
	bool good = true;
	for (; good && w->frames < count; w->frames++) {
		g_autofree char *name = w->path ? file_of_frame(file, w->frames) : g_strdup(file);
		cli_bar_update(&w->bar, (double)w->frames / count, "drawing");
		good = draw_one(w, w->frames, &large, name, error);
		if (good && cli_interrupted()) {
			g_set_error(error, G_IO_ERROR, G_IO_ERROR_CANCELLED,
				"stopped after %u of %u frames", w->frames + 1, count);
			good = false;
		}
	}
	picture_buffer_clear(&large);
	return good;
}

static bool save_view(const struct work *w, GError **error)
{
	g_autoptr(view) v =
		view_new(save_name, save_name, w->view->eye_m, w->view->target_m, w->view->fov_deg);
	v->style = g_strdup(w->style);
	return view_save(v, w->site->site, error);
}

/* ---- what is said ---- */

static void print_times(const struct work *w)
{
	const struct {
		const char *name;
		double s;
	} row[] = { { "cull", w->sum.cull_s }, { "mask", w->sum.mask_s },
		{ "choose", w->sum.choose_s }, { "bin", w->sum.bin_s }, { "draw", w->sum.draw_s },
		{ "all", w->sum.all_s } };
	for (size_t n = 0; n < G_N_ELEMENTS(row); n++)
		printf("%-8s %8.1f ms\n", row[n].name, 1e3 * row[n].s / w->frames);
	printf("%.2f million points in view, in %u chunks, %u of them hidden; %.3f million strokes "
	       "drawn\n",
		1e-6 * w->sum.points_in_view / w->frames, w->sum.chunks_in_view / w->frames,
		w->sum.chunks_hidden / w->frames, 1e-6 * w->sum.strokes / w->frames);
}

static void say_as_json(const struct work *w, const char *file)
{
	JsonObject *o = json_object_new();
	json_object_set_string_member(o, "file", file);
	json_object_set_int_member(o, "frames", w->frames);
	json_object_set_string_member(o, "style", w->style);
	json_object_set_string_member(o, "view", w->view->name);
	json_object_set_string_member(o, "backend", painter_why(w->painter));
	json_object_set_int_member(o, "width", w->width);
	json_object_set_int_member(o, "height", w->height);
	json_object_set_double_member(o, "seconds_per_frame", w->sum.all_s / w->frames);
	json_object_set_int_member(o, "strokes_per_frame", w->sum.strokes / w->frames);
	cli_print_json(o);
}

static void say(const struct work *w, const char *file)
{
	if (json) {
		say_as_json(w, file);
		return;
	}
	if (w->path)
		printf("%u frames, %s and so on\n", w->frames, file);
	else
		printf("%s\n", file);
	printf("%s; %s\n", w->style, painter_why(w->painter));
	if (times)
		print_times(w);
}

static void print_views(const struct work *w)
{
	g_autoptr(GPtrArray) saved = view_list(w->site->site, NULL, NULL);
	g_autoptr(GPtrArray) names = view_built_in_names(&w->site->sources);
	for (guint n = 0; saved && n < saved->len; n++) {
		const view *v = g_ptr_array_index(saved, n);
		printf("%-16s %s\n", v->name, v->title);
	}
	for (guint n = 0; n < names->len; n++)
		printf("%s\n", (char *)g_ptr_array_index(names, n));
}

/* ---- the command ---- */

static char *default_file(const struct work *w, const char *site_folder, GError **error)
{
	g_autofree char *folder = g_build_filename(site_folder, "exports", NULL);
	g_autofree char *style_word = g_path_get_basename(w->style);
	g_autofree char *name = g_strdup_printf("%s-%s.png", style_word, w->view->name);
	if (g_mkdir_with_parents(folder, 0777) != 0) {
		g_set_error(error, G_FILE_ERROR, g_file_error_from_errno(errno), "%s: %s", folder,
			g_strerror(errno));
		return NULL;
	}
	g_strdelimit(name, "/:", '_');
	return g_build_filename(folder, name, NULL);
}

/* What was typed, checked as far as it can be without a site. */
static int check_usage(struct work *w)
{
	if (!camera_size_parse(size_text ? size_text : "1600x1200", &w->width, &w->height))
		return cli_misuse(COMMAND, "--size is WIDTHxHEIGHT, each from 1 to %u, not '%s'",
			CAMERA_SIDE_MAX, size_text);
	if (supersample < 1 || supersample > 8)
		return cli_misuse(COMMAND, "--supersample goes from 1 to 8");
	if ((uint64_t)w->width * w->height * (uint64_t)(supersample * supersample) > PIXELS_MAX ||
		w->width * (uint32_t)supersample > CAMERA_SIDE_MAX ||
		w->height * (uint32_t)supersample > CAMERA_SIDE_MAX)
		return cli_misuse(COMMAND,
			"%ux%u drawn %d times as large is more than %u million pixels or %u a "
			"side: take a "
			"smaller --size or --supersample",
			w->width, w->height, supersample, (unsigned)(PIXELS_MAX / 1000000),
			CAMERA_SIDE_MAX);
	if (output && !g_str_has_suffix(output, ".png"))
		return cli_misuse(COMMAND, "--output ends in .png, not '%s'", output);
	if (save_name && !view_name_is_good(save_name))
		return cli_misuse(COMMAND,
			"--save-view is 1 to 64 letters of a-z and A-Z, digits, - and _, not '%s'",
			save_name);
	return CLI_DONE;
}

static bool draw(struct work *w, const char *site_folder, GError **error)
{
	g_autofree char *file = output ? g_strdup(output) : default_file(w, site_folder, error);
	if (!file || !draw_frames(w, file, error) || (save_name && !save_view(w, error)))
		return false;
	cli_bar_end(&w->bar);
	g_autofree char *first = w->path ? file_of_frame(file, 0) : g_strdup(file);
	say(w, first);
	return true;
}

static int run(struct work *w, const char *site_folder, enum backend_wish wish)
{
	g_autoptr(GError) error = NULL;
	bool good;
	cli_catch_interrupts();
	w->bar = cli_bar_begin(COMMAND);
	if (list_views) {
		good = open_views(w, site_folder, &error);
		if (good)
			print_views(w);
	} else
		good = open_all(w, site_folder, wish, &error) && draw(w, site_folder, &error);
	cli_bar_end(&w->bar);
	return good ? cli_done(COMMAND) : cli_fail(COMMAND, error);
}

int main(int argc, char **argv)
{
	g_autoptr(GError) error = NULL;
	g_auto(work) w = { 0 };
	enum backend_wish wish;
	g_autofree char *more =
		g_strdup_printf("The site must have a model ('pleinair process'). 'pleinair "
				"styles' lists the styles, --list-views the views.\nPaths: %s",
			camera_path_forms);
	int status;
	if (!cli_parse(COMMAND, "SITE", "Draws a site in a style.", more, entries, &argc, &argv,
		    &status))
		return status;
	if (argc != 2)
		return cli_misuse(COMMAND, "which site?");
	if (!backend_wish_parse(backend_name, &wish, &error))
		return cli_misuse(COMMAND, "%s", error->message);
	status = check_usage(&w);
	return status ? status : run(&w, argv[1], wish);
}
