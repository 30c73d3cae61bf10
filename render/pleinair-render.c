/* pleinair render SITE: draws a site in a style, as a picture, a page of shapes, a film, or numbered frames along a path of the camera. */
#include "acquire/cli.h"
#include "render/camera-path.h"
#include "render/drawn-site.h"
#include "render/output.h"
#include "render/page-scale.h"
#include "render/scene-pager.h"
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define COMMAND "render"
/* Of the picture before it is reduced. */
#define PIXELS_MAX  ((uint64_t)1 << 29) /* of pages and films */
#define FPS_NORMAL  25.0
#define FPS_MAX     240.0
#define SECONDS_MAX 86400.0
/* What a film goes along when nobody says. */
#define FILM_STATIONS "stations:150"
#define FILM_ORBIT    "orbit:1.2:300"

static char *style_name, *size_text, *view_name, *output, *backend_name, *path_text, *save_name,
	*title_text, *scale_text, *memory_text;
static gboolean list_views, times, json, no_paper, no_frame;
static int supersample = 2;
static double dpi = PAGE_DPI_NORMAL, seconds, time_s, fps = FPS_NORMAL, cut_m = NAN;

static const GOptionEntry entries[] = {
	{ "style", 's', 0, G_OPTION_ARG_STRING, &style_name,
		"A style by its name, or a file (default: the view's, else figure-7d)", "STYLE" },
	{ "size", 0, 0, G_OPTION_ARG_STRING, &size_text,
		"Of the picture: pixels, 297x210mm, A0 to A8, A3-landscape (default 1600x1200)",
		"SIZE" },
	{ "dpi", 0, 0, G_OPTION_ARG_DOUBLE, &dpi, "Pixels an inch, on paper (default 150)", "N" },
	{ "view", 'v', 0, G_OPTION_ARG_STRING, &view_name,
		"A saved view, overview, walk, station-K, plan, plan:HEIGHT, elevation-north, "
		"section-a, section:X1,Y1:X2,Y2[:DEPTH], or X,Y,Z:X,Y,Z[:FOV] (default overview)",
		"VIEW" },
	{ "output", 'o', 0, G_OPTION_ARG_FILENAME, &output,
		"Where it goes: .png or .tif a picture, .svg or .pdf a page of shapes, .mp4 or "
		".webm a "
		"film "
		"(default SITE/exports/STYLE-VIEW.png); of a path FILE-0000.png and so on",
		"FILE" },
	{ "path", 0, 0, G_OPTION_ARG_STRING, &path_text,
		"Frames along a way of the camera: orbit, dolly, pan, stations, views:A,B,C",
		"PATH" },
	{ "seconds", 0, 0, G_OPTION_ARG_DOUBLE, &seconds,
		"Of a film (default: as many frames as the path has)", "S" },
	{ "fps", 0, 0, G_OPTION_ARG_DOUBLE, &fps, "Frames a second of a film (default 25)", "N" },
	{ "time", 0, 0, G_OPTION_ARG_DOUBLE, &time_s,
		"When it is, for styles in which things move (default 0); frames go on from there",
		"S" },
	{ "title", 0, 0, G_OPTION_ARG_STRING, &title_text,
		"Of a page of shapes (default: the site's name and the view's)", "TEXT" },
	{ "scale", 0, 0, G_OPTION_ARG_STRING, &scale_text,
		"Of a plan, elevation or section on paper, as 1:50 (default: the largest of 1:1, "
		"1:2, "
		"1:5, 1:10 and so on that fits)",
		"1:N" },
	{ "no-frame", 0, 0, G_OPTION_ARG_NONE, &no_frame,
		"A page at a scale without title, scale bar and north arrow at its edge", NULL },
	{ "cut", 0, 0, G_OPTION_ARG_DOUBLE, &cut_m,
		"How thick a slab of what a plan or section cuts is drawn as cut, in metres "
		"(default: "
		"as the points' spacing asks for; 0: none)",
		"M" },
	{ "no-paper", 0, 0, G_OPTION_ARG_NONE, &no_paper,
		"A page of strokes alone, without paper and coloured points", NULL },
	{ "supersample", 0, 0, G_OPTION_ARG_INT, &supersample,
		"Draw so many times as large and reduce (1 to 8; default 2)", "N" },
	{ "backend", 0, 0, G_OPTION_ARG_STRING, &backend_name, "auto, cpu or gles (default auto)",
		"WHICH" },
	{ "memory", 0, 0, G_OPTION_ARG_STRING, &memory_text,
		"That the points may take, as 512M or 4G; what is more is read as it is needed "
		"(default: half of the machine's)",
		"SIZE" },
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
	struct output out;
	char *style;
	struct cli_bar bar;
	struct draw_times sum;
	uint32_t frames, count; /* drawn, of so many */
	double scale;           /* of the page; 0: none */
	page_legend *legend;
};

static void work_clear(struct work *w)
{
	output_clear(&w->out);
	page_legend_free(w->legend);
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
	w->site = drawn_site_new(site_folder, w->out.size.width_mm / w->out.size.height_mm, error);
	return w->site;
}

/* Only a film needs one: a walk from scanner to scanner, or once around. */
static const char *default_path(const struct work *w)
{
	if (w->out.kind != OUTPUT_FILM)
		return NULL;
	return w->site->sources.station_count > 1 ? FILM_STATIONS : FILM_ORBIT;
}

static bool set_cut(view *v, GError **error)
{
	if (isnan(cut_m))
		return true;
	if (!v->is_cut) {
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_ARGUMENT,
			"--cut: view '%s' cuts nothing; plan:HEIGHT and sections do", v->name);
		return false;
	}
	v->cut_m = cut_m;
	v->is_cut = cut_m > 0;
	return true;
}

static bool is_on_paper(const struct work *w)
{
	return output_is_page(w->out.kind) || w->out.size.on_paper;
}

/* What has parallel rays has one on paper, whoever chooses it. */
static bool set_scale(struct work *w, GError **error)
{
	if (!scale_text && (!is_on_paper(w) || w->path || !view_is_parallel(w->view)))
		return true;
	if (!scale_text)
		w->scale = page_scale_fitting(w->view, &w->out.size, !no_frame);
	else
		page_scale_parse(scale_text, &w->scale);
	return page_scale_set(w->view, &w->out.size, !no_frame, w->scale, error);
}

static bool find_view(struct work *w, GError **error)
{
	const struct view_sources *sources = &w->site->sources;
	if (!view_find(sources, view_name ? view_name : "overview", &w->view, error))
		return false;
	w->style = g_strdup(style_name       ? style_name
			    : w->view->style ? w->view->style
					     : "figure-7d");
	const char *along = path_text ? path_text : default_path(w);
	if (along)
		w->path = camera_path_parse(along, w->view, sources, error);
	return (!along || w->path) && set_cut(w->view, error) && set_scale(w, error);
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
	if (w->site->is_look)
		g_printerr(
			"pleinair render: this is a first look at new scans: 'pleinair process %s' "
			"makes the model of them\n",
			w->site->folder);
	w->drawing = drawn_site_style(w->site, w->style, error);
	if (w->drawing && drawn_site_lacks_lines(w->site, w->drawing))
		g_printerr("pleinair render: the site has no profile lines yet, which %s draws: "
			   "'pleinair process %s' finds them\n",
			w->style, w->site->folder);
	return w->drawing;
}

/* ---- pictures ---- */

/* A film goes through all of the path in its own time. */
static struct camera camera_of(const struct work *w, uint32_t number)
{
	uint32_t width = w->out.size.width, height = w->out.size.height;
	double step = w->count > 1 ? (camera_path_frames(w->path) - 1.0) / (w->count - 1) : 0;
	struct camera c = w->path ? camera_path_at(w->path, number * step, width, height)
				  : view_camera(w->view, width, height);
	return camera_scaled(&c, supersample);
}

static void add_times(struct draw_times *sum, const struct draw_times *t)
{
	sum->cull_s += t->cull_s;
	sum->mask_s += t->mask_s;
	sum->choose_s += t->choose_s;
	sum->bin_s += t->bin_s;
	sum->draw_s += t->draw_s;
	sum->filter_s += t->filter_s;
	sum->composite_s += t->composite_s;
	sum->all_s += t->all_s;
	sum->strokes += t->strokes;
	sum->points_in_view += t->points_in_view;
	sum->chunks_in_view += t->chunks_in_view;
	sum->chunks_hidden += t->chunks_hidden;
}

static bool draw_one(struct work *w, uint32_t number, GError **error)
{
	struct draw_times t;
	struct camera c = camera_of(w, number);
	struct camera first = output_first_camera(&w->out, &c);
	if (w->frame ? !frame_move(w->frame, &first, error)
		     : !(w->frame = frame_new(w->site->scene, w->drawing, &first, error)))
		return false;
	w->frame->time_s = time_s + number / fps;
	if (!scene_pager_settle_for(w->site->scene, &c, w->frame->ink_px, error) ||
		!output_add(&w->out, w->painter, w->frame, &c, number, &t, error))
		return false;
	add_times(&w->sum, &t);
	return true;
}

/* Of a picture, which may be of many windows. */
static bool is_going(void *data, double part, GError **error)
{
	struct work *w = data;
	cli_bar_update(&w->bar, (w->frames + part) / w->count, "drawing");
	if (cli_interrupted())
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_CANCELLED,
			"stopped at %.0f %% of the picture", 100 * part);
	return !cli_interrupted();
}

static bool draw_frames(struct work *w, GError **error)
{
	bool good = true;
	for (; good && w->frames < w->count; w->frames++) {
		cli_bar_update(&w->bar, (double)w->frames / w->count, "drawing");
		good = draw_one(w, w->frames, error);
		if (good && cli_interrupted()) {
			g_set_error(error, G_IO_ERROR, G_IO_ERROR_CANCELLED,
				"stopped after %u of %u frames", w->frames + 1, w->count);
			good = false;
		}
	}
	return good && output_finish(&w->out, error);
}

static bool save_view(const struct work *w, GError **error)
{
	g_autoptr(view) v = view_renamed(w->view, save_name, save_name);
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
		{ "filter", w->sum.filter_s }, { "combine", w->sum.composite_s },
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
	json_object_set_int_member(o, "width", w->out.size.width);
	json_object_set_int_member(o, "height", w->out.size.height);
	if (output_is_page(w->out.kind)) {
		json_object_set_double_member(o, "width_mm", w->out.size.width_mm);
		json_object_set_double_member(o, "height_mm", w->out.size.height_mm);
	}
	if (w->scale > 0)
		json_object_set_double_member(o, "scale", w->scale);
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
	if (w->out.kind == OUTPUT_FILM)
		printf("%s: %u frames, %.4g s\n", file, w->frames, w->frames / fps);
	else if (w->path)
		printf("%u frames, %s and so on\n", w->frames, file);
	else
		printf("%s\n", file);
	if (w->scale > 0) {
		g_autofree char *scale = page_scale_text(w->scale);
		printf("%s on %.4g x %.4g mm\n", scale, w->out.size.width_mm,
			w->out.size.height_mm);
	}
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

static int check_size(struct work *w)
{
	struct page_size *size = &w->out.size;
	if (!(dpi >= PAGE_DPI_MIN && dpi <= PAGE_DPI_MAX))
		return cli_misuse(COMMAND, "--dpi goes from %g to %g", PAGE_DPI_MIN, PAGE_DPI_MAX);
	if (!page_size_parse(size_text ? size_text : "1600x1200", dpi, size))
		return cli_misuse(COMMAND,
			"--size is WIDTHxHEIGHT in pixels, WIDTHxHEIGHTmm, or A0 to A8 with or "
			"without "
			"-landscape, each side from 1 to %u pixels, not '%s'",
			CAMERA_SIDE_MAX, size_text);
	if (supersample < 1 || supersample > 8)
		return cli_misuse(COMMAND, "--supersample goes from 1 to 8");
	return CLI_DONE;
}

/* A picture is drawn in windows; pages and films at once. */
static int check_pixels(const struct work *w)
{
	const struct page_size *size = &w->out.size;
	uint64_t by = (uint64_t)supersample, pixels = size->width * by * size->height * by;
	if (MAX(size->width, size->height) * by > CAMERA_SIDE_MAX)
		return cli_misuse(COMMAND,
			"%ux%u drawn %d times as large is more than %u pixels a side: take a "
			"smaller --size, --dpi or --supersample",
			size->width, size->height, supersample, CAMERA_SIDE_MAX);
	if (w->out.kind != OUTPUT_PICTURE && pixels > PIXELS_MAX)
		return cli_misuse(COMMAND,
			"%ux%u drawn %d times as large is more than the %u million pixels that "
			"pages and films have: take a smaller --size, --dpi or --supersample",
			size->width, size->height, supersample, (unsigned)(PIXELS_MAX / 1000000));
	return CLI_DONE;
}

static int check_film(struct work *w)
{
	g_autoptr(GError) error = NULL;
	if (!(fps > 0 && fps <= FPS_MAX))
		return cli_misuse(COMMAND, "--fps is more than 0 and at most %g", FPS_MAX);
	if (!(seconds >= 0 && seconds <= SECONDS_MAX))
		return cli_misuse(COMMAND, "--seconds goes up to %g", SECONDS_MAX);
	if (seconds * fps > CAMERA_PATH_FRAMES_MAX)
		return cli_misuse(COMMAND, "a film has at most %u frames", CAMERA_PATH_FRAMES_MAX);
	if (w->out.kind != OUTPUT_FILM)
		return seconds > 0 ? cli_misuse(COMMAND, "--seconds is of films, .mp4 or .webm")
				   : CLI_DONE;
	/* Colours are told for two pixels a side. */
	w->out.size.width = MAX(w->out.size.width & ~1u, 2);
	w->out.size.height = MAX(w->out.size.height & ~1u, 2);
	return film_can(&error) ? CLI_DONE : cli_fail(COMMAND, error);
}

/* What was typed, checked as far as it can be without a site. */
static int check_usage(struct work *w, enum backend_wish *wish)
{
	int status = check_size(w);
	w->out.kind = output ? output_kind_of(output) : OUTPUT_PICTURE;
	if (status != CLI_DONE)
		return status;
	if ((status = check_pixels(w)) != CLI_DONE)
		return status;
	if (w->out.kind == OUTPUT_KINDS)
		return cli_misuse(COMMAND, "--output ends in %s, not '%s'", output_endings, output);
	if (output_is_page(w->out.kind)) {
		if (*wish == BACKEND_WISH_GLES)
			return cli_misuse(COMMAND, "a page of shapes is made by the backend cpu");
		*wish = BACKEND_WISH_CPU;
	} else if (no_paper || (title_text && !w->out.size.on_paper))
		return cli_misuse(COMMAND, "--title and --no-paper are of pages, .svg or .pdf");
	double scale;
	if (scale_text && !page_scale_parse(scale_text, &scale))
		return cli_misuse(COMMAND, "--scale is 1:N, as in 1:50, not '%s'", scale_text);
	if (scale_text && (!is_on_paper(w) || path_text || w->out.kind == OUTPUT_FILM))
		return cli_misuse(COMMAND, "--scale is of one page: .svg, .pdf, or a picture with "
					   "a --size on paper, as "
					   "A3-landscape");
	if (!isnan(cut_m) && !(cut_m >= 0 && cut_m <= 10))
		return cli_misuse(COMMAND, "--cut goes from 0 to 10 m");
	if (save_name && !view_name_is_good(save_name))
		return cli_misuse(COMMAND,
			"--save-view is 1 to 64 letters of a-z and A-Z, digits, - and _, not '%s'",
			save_name);
	return check_film(w);
}

static uint32_t count_frames(const struct work *w)
{
	if (w->out.kind == OUTPUT_FILM && seconds > 0)
		return MAX((uint32_t)lround(seconds * fps), 1);
	return w->path ? camera_path_frames(w->path) : 1;
}

/* The day on which the site was begun; a plan's way to the north. */
static page_legend *legend_of(const struct work *w, const char *title)
{
	const char *created = manifest_get_string(site_manifest(w->site->site), "created", NULL);
	g_autofree char *day = created ? g_strndup(created, strlen("2026-01-31")) : NULL;
	struct camera c = view_camera(w->view, 2, 2);
	struct page_legend_desc d = { .width_mm = w->out.size.width_mm,
		.height_mm = w->out.size.height_mm,
		.scale = w->scale,
		.title = title,
		.date = day,
		.north_rad = c.forward[2] < -0.999 ? -camera_heading_rad(&c) : (double)NAN };
	memcpy(d.paper, w->drawing->whole.paper.colour, sizeof d.paper);
	return page_legend_new(&d);
}

static bool draw(struct work *w, const char *site_folder, GError **error)
{
	g_autofree char *file = output ? g_strdup(output) : default_file(w, site_folder, error);
	g_autofree char *name = g_path_get_basename(site_folder);
	g_autofree char *title =
		title_text ? g_strdup(title_text) : g_strdup_printf("%s, %s", name, w->view->title);
	w->out.path = file;
	w->out.title = title;
	w->out.tree = w->site->tree;
	w->out.supersample = (uint32_t)supersample;
	w->out.numbered = w->path;
	w->out.has_paper = !no_paper;
	w->out.fps = fps;
	w->out.going = is_going;
	w->out.data = w;
	w->legend = w->scale > 0 && !no_frame ? legend_of(w, title) : NULL;
	w->out.legend = w->legend;
	w->count = count_frames(w);
	if (!file || !draw_frames(w, error) || (save_name && !save_view(w, error)))
		return false;
	cli_bar_end(&w->bar);
	g_autofree char *first = output_file(&w->out, 0);
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
	if (!drawn_site_set_memory(memory_text, &error))
		return cli_misuse(COMMAND, "%s", error->message);
	status = check_usage(&w, &wish);
	return status ? status : run(&w, argv[1], wish);
}
