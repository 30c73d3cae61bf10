#include "render/sweep-sheet.h"
#include "firmware-io/files.h"
#include "render/vector-private.h"
#include <math.h>

#define COLUMNS_MOST 5u
#define MANY_CELLS   20u
#define MARGIN       24.
#define GAP          12.
#define TITLE_SIZE   30.
#define BELOW_SIZE   17.
#define LABEL_SIZE   20.
#define LABEL_HEIGHT 36.

struct sheet {
	cairo_surface_t *surface;
	cairo_t *cr;
	guint columns, rows;
	double top, width, height, scale; /* of one picture on the sheet */
};

/* As few lines of cells as can be, all of about the same length. */
static guint columns_of(guint cells)
{
	guint lines = (cells + COLUMNS_MOST - 1) / COLUMNS_MOST;
	return lines ? (cells + lines - 1) / lines : 1;
}

/* Smaller where it would be wider than there is room. */
static void write_text(cairo_t *cr, double x, double y, double size, double most, const char *text)
{
	cairo_text_extents_t e;
	cairo_set_font_size(cr, size);
	cairo_text_extents(cr, text, &e);
	if (e.x_advance > most)
		cairo_set_font_size(cr, size * most / e.x_advance);
	cairo_move_to(cr, x, y);
	cairo_show_text(cr, text);
}

static double cell_height(const sheet *s)
{
	return s->rows * s->height + (s->rows - 1) * GAP / 2 + LABEL_HEIGHT + GAP;
}

static void find_place(const sheet *s, guint cell, double ret[2])
{
	ret[0] = MARGIN + cell % s->columns * (s->width + GAP);
	ret[1] = s->top + cell / s->columns * cell_height(s);
}

static void write_head(sheet *s, double room, const char *title, const char *below)
{
	cairo_set_source_rgb(s->cr, 0.965, 0.953, 0.925);
	cairo_paint(s->cr);
	cairo_set_source_rgb(s->cr, 0.17, 0.15, 0.14);
	cairo_select_font_face(
		s->cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_BOLD);
	write_text(s->cr, MARGIN, MARGIN + TITLE_SIZE, TITLE_SIZE, room, title);
	cairo_select_font_face(
		s->cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
	write_text(s->cr, MARGIN, MARGIN + TITLE_SIZE + BELOW_SIZE + GAP, BELOW_SIZE, room, below);
}

sheet *sheet_new(const char *title, const char *below, guint cells, guint rows, uint32_t width,
	uint32_t height)
{
	sheet *s = g_new0(sheet, 1);
	s->columns = columns_of(cells);
	s->rows = rows;
	s->scale = MIN(1, (double)(cells > MANY_CELLS ? SHEET_MANY_MOST : SHEET_CELL_MOST) / width);
	s->width = round(width * s->scale);
	s->height = round(height * s->scale);
	s->top = MARGIN + TITLE_SIZE + BELOW_SIZE + 3 * GAP;
	guint lines = (cells + s->columns - 1) / s->columns;
	double wide = s->columns * (s->width + GAP) - GAP;
	s->surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, (int)(wide + 2 * MARGIN),
		(int)(s->top + lines * cell_height(s) + MARGIN - GAP));
	s->cr = cairo_create(s->surface);
	write_head(s, wide, title, below);
	return s;
}

void sheet_free(sheet *s)
{
	if (!s)
		return;
	cairo_destroy(s->cr);
	cairo_surface_destroy(s->surface);
	g_free(s);
}

void sheet_put(sheet *s, guint cell, guint row, const struct picture_buffer *picture)
{
	double at[2];
	cairo_surface_t *p = vector_ground_surface(picture);
	find_place(s, cell, at);
	cairo_save(s->cr);
	cairo_translate(s->cr, at[0], at[1] + row * (s->height + GAP / 2));
	cairo_scale(s->cr, s->scale, s->scale);
	cairo_set_source_surface(s->cr, p, 0, 0);
	cairo_pattern_set_filter(cairo_get_source(s->cr), CAIRO_FILTER_GOOD);
	cairo_paint(s->cr);
	cairo_restore(s->cr);
	cairo_surface_destroy(p);
}

void sheet_label(sheet *s, guint cell, const char *text)
{
	double at[2];
	find_place(s, cell, at);
	cairo_set_source_rgb(s->cr, 0.17, 0.15, 0.14);
	write_text(s->cr, at[0], at[1] + cell_height(s) - GAP - LABEL_HEIGHT + LABEL_SIZE + 4,
		LABEL_SIZE, s->width, text);
}

bool sheet_save(sheet *s, const char *path, GError **error)
{
	g_autoptr(GByteArray) bytes = g_byte_array_new();
	cairo_status_t status = cairo_surface_write_to_png_stream(s->surface, vector_append, bytes);
	return vector_check(status, path, error) &&
	       files_write(path, bytes->data, bytes->len, error);
}
