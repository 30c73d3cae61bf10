#include "render/output.h"
#include "render/vector-page.h"
#include <string.h>

static const char *const endings[OUTPUT_KINDS] = {
	[OUTPUT_PICTURE] = ".png", [OUTPUT_SVG] = ".svg", [OUTPUT_PDF] = ".pdf"
};
const char output_endings[] = ".png, .svg, .pdf, .mp4 or .webm";

enum output_kind output_kind_of(const char *path)
{
	for (int n = 0; n < OUTPUT_KINDS; n++)
		if (endings[n] && g_str_has_suffix(path, endings[n]))
			return (enum output_kind)n;
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
	g_autofree char *stem = g_strndup(o->path, strlen(o->path) - strlen(endings[o->kind]));
	return g_strdup_printf("%s-%04u%s", stem, number, endings[o->kind]);
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

/* ---- pictures and films ---- */

static bool add_to_film(struct output *o, const struct picture_buffer *p, GError **error)
{
	if (!o->film)
		o->film = film_new(o->path, p->width, p->height, o->fps, error);
	return o->film && film_add(o->film, p, error);
}

static bool add_picture(struct output *o, painter *p, const frame *f, const char *file,
	struct draw_times *times, GError **error)
{
	make_room(o, f);
	if (!painter_draw(p, f, &o->large, times, error))
		return false;
	struct picture_buffer small = small_of(o);
	if (o->legend)
		page_legend_print(o->legend, &small, small.width / o->size.width_mm);
	bool good = o->kind == OUTPUT_FILM ? add_to_film(o, &small, error)
		    : o->size.on_paper     ? picture_buffer_save_print(&small,
						     small.width * 25.4 / o->size.width_mm, file, error)
					   : picture_buffer_save(&small, file, error);
	clear_small(o, &small);
	return good;
}

bool output_add(struct output *o, painter *p, const frame *f, uint32_t number,
	struct draw_times *ret_times, GError **error)
{
	g_autofree char *file = output_file(o, number);
	return output_is_page(o->kind) ? add_page(o, f, file, ret_times, error)
				       : add_picture(o, p, f, file, ret_times, error);
}

bool output_finish(struct output *o, GError **error)
{
	return !o->film || film_finish(o->film, error);
}
