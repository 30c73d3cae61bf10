#include "render/output.h"
#include "render/picture-writer.h"
#include "render/vector-page.h"
#include <string.h>

static const struct {
	const char *ending;
	enum output_kind kind;
} endings[] = { { ".png", OUTPUT_PICTURE }, { ".tif", OUTPUT_PICTURE }, { ".tiff", OUTPUT_PICTURE },
	{ ".svg", OUTPUT_SVG }, { ".pdf", OUTPUT_PDF } };
const char output_endings[] = ".png, .tif, .svg, .pdf, .mp4 or .webm";

enum output_kind output_kind_of(const char *path)
{
	for (size_t n = 0; n < G_N_ELEMENTS(endings); n++)
		if (g_str_has_suffix(path, endings[n].ending))
			return endings[n].kind;
	return film_is(path) ? OUTPUT_FILM : OUTPUT_KINDS;
}

void output_clear(struct output *o)
{
	picture_buffer_clear(&o->large);
	draw_room_free(o->room);
	film_free(o->film);
	o->room = NULL;
	o->film = NULL;
}

char *output_file(const struct output *o, uint32_t number)
{
	if (!o->numbered || o->kind == OUTPUT_FILM)
		return g_strdup(o->path);
	const char *ending = strrchr(o->path, '.');
	g_autofree char *stem = g_strndup(o->path, (gsize)(ending - o->path));
	return g_strdup_printf("%s-%04u%s", stem, number, ending);
}

/* As large as the frame; what it becomes is as large as was asked for. */
static void make_room(struct output *o, const frame *f)
{
	if (!o->large.rgba)
		o->large = picture_buffer_new(f->camera.width, f->camera.height);
}

/* Caller clears it with clear_small. */
static struct picture_buffer small_of(const struct output *o)
{
	return o->supersample > 1 ? picture_buffer_reduced(&o->large, o->supersample) : o->large;
}

static void clear_small(const struct output *o, struct picture_buffer *small)
{
	if (small->rgba != o->large.rgba)
		picture_buffer_clear(small);
}

/* ---- pages ---- */

static bool add_page(struct output *o, const frame *f, const char *file, struct draw_times *times,
	GError **error)
{
	if (!o->room)
		o->room = draw_room_new();
	g_autoptr(vector_page) page = vector_page_new(
		o->room, f, o->tree, o->size.width_mm, o->size.height_mm, o->title, times);
	page->has_paper = o->has_paper;
	page->legend = o->legend;
	if (o->has_paper && vector_page_wants_ground(f)) {
		make_room(o, f);
		draw_below_strokes(o->room, f, &o->large);
		page->ground = picture_buffer_reduced(&o->large, o->supersample);
	}
	return o->kind == OUTPUT_SVG ? vector_page_save_svg(page, file, error)
				     : vector_page_save_pdf(page, file, error);
}

/* ---- films ---- */

static bool add_to_film(
	struct output *o, painter *p, const frame *f, struct draw_times *times, GError **error)
{
	make_room(o, f);
	if (!painter_draw(p, f, &o->large, times, error))
		return false;
	struct picture_buffer small = small_of(o);
	if (!o->film)
		o->film = film_new(o->path, small.width, small.height, o->fps, error);
	bool good = o->film && film_add(o->film, &small, error);
	clear_small(o, &small);
	return good;
}

/* ---- pictures ---- */

struct writing {
	const struct output *o;
	picture_writer *to;
};

static bool take_rows(void *data, struct picture_buffer *rows, uint32_t from, GError **error)
{
	const struct writing *w = data;
	if (w->o->legend)
		page_legend_print(w->o->legend, rows, from, rows->width / w->o->size.width_mm);
	return picture_writer_add(w->to, rows, error);
}

static bool is_going(void *data, double part, GError **error)
{
	const struct writing *w = data;
	return !w->o->going || w->o->going(w->o->data, part, error);
}

static bool add_picture(struct output *o, painter *p, frame *f, const struct camera *c,
	const char *file, struct draw_times *times, GError **error)
{
	uint32_t width = c->width / o->supersample, height = c->height / o->supersample;
	double dpi = o->size.on_paper ? width * 25.4 / o->size.width_mm : 0;
	g_autoptr(picture_writer) to = picture_writer_new(file, width, height, dpi, error);
	struct writing w = { o, to };
	struct poster_desc desc = {
		.reduce = o->supersample, .take = take_rows, .going = is_going, .data = &w
	};
	return to && poster_draw(p, f, c, &desc, times, error) && picture_writer_finish(to, error);
}

/* ---- all ---- */

struct camera output_first_camera(const struct output *o, const struct camera *c)
{
	return o->kind == OUTPUT_PICTURE ? camera_window(c, 0, 0, 1, 1) : *c;
}

bool output_add(struct output *o, painter *p, frame *f, const struct camera *c, uint32_t number,
	struct draw_times *ret_times, GError **error)
{
	g_autofree char *file = output_file(o, number);
	if (o->kind == OUTPUT_PICTURE)
		return add_picture(o, p, f, c, file, ret_times, error);
	return output_is_page(o->kind) ? add_page(o, f, file, ret_times, error)
				       : add_to_film(o, p, f, ret_times, error);
}

bool output_finish(struct output *o, GError **error)
{
	return !o->film || film_finish(o->film, error);
}
