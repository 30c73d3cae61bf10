#include "render/page-legend.h"
#include "render/page-scale.h"
#include "render/vector-private.h"
#include <math.h>
#include <string.h>

/* Of the shorter side of the page, and of an A3. */
#define EDGE_PART  0.034
#define EDGE_MOST  10.0
#define STRIP_PART 0.048
#define STRIP_MOST 14.0
/* Of the strip: sizes of texts, the bar's height, the length that it is not longer than. */
#define TITLE_PART 0.29
#define SMALL_PART 0.22
#define BAR_PART   0.11
#define BAR_MOST   5.0
#define ARROW_PART 1.1
#define DARK       128

static void text_clear(void *data)
{
	g_free(((struct legend_text *)data)->text);
}

void page_legend_free(page_legend *l)
{
	if (!l)
		return;
	g_array_unref(l->texts);
	g_array_unref(l->shapes);
	g_free(l);
}

void page_legend_edges(double width_mm, double height_mm, double *ret_edge_mm, double *ret_strip_mm)
{
	double side = fmin(width_mm, height_mm);
	*ret_edge_mm = fmin(EDGE_PART * side, EDGE_MOST);
	*ret_strip_mm = fmin(STRIP_PART * side, STRIP_MOST);
}

/* ---- parts ---- */

static void add_text(page_legend *l, double x_mm, double y_mm, double size_mm,
	enum legend_anchor anchor, const char *text)
{
	struct legend_text t = { x_mm, y_mm, size_mm, anchor, g_strdup(text) };
	g_array_append_val(l->texts, t);
}

static void add_box(page_legend *l, double x_mm, double y_mm, double width_mm, double height_mm)
{
	struct legend_shape s = { 4,
		{ { x_mm, y_mm }, { x_mm + width_mm, y_mm }, { x_mm + width_mm, y_mm + height_mm },
			{ x_mm, y_mm + height_mm } } };
	g_array_append_val(l->shapes, s);
}

/* Ends at a place. */
static void add_length(page_legend *l, double x_mm, double y_mm, double size_mm, double metres)
{
	g_autofree char *text = metres >= 1000 ? g_strdup_printf("%g km", metres / 1000)
				: metres >= 1  ? g_strdup_printf("%g m", metres)
					       : g_strdup_printf("%g cm", metres * 100);
	add_text(l, x_mm, y_mm, size_mm, LEGEND_RIGHT, text);
}

/* Parts by turns filled and framed, ending at the right; returns where it begins. */
static double add_bar(page_legend *l, const struct page_legend_desc *d, double right_mm,
	double y_mm, double strip_mm)
{
	double most_mm = fmin(BAR_MOST * strip_mm, d->width_mm / 3);
	double metres = page_scale_round_length(most_mm / 1000 * d->scale);
	double length = metres * 1000 / d->scale, left = right_mm - length;
	double high = BAR_PART * strip_mm, line = high / 8, small = SMALL_PART * strip_mm;
	int parts = metres / pow(10, floor(log10(metres) + 1e-9)) < 1.5 ? 5
		    : metres / pow(10, floor(log10(metres) + 1e-9)) < 3 ? 4
									: 5;
	for (int n = 0; n < parts; n += 2)
		add_box(l, left + n * length / parts, y_mm - high, length / parts, high);
	add_box(l, left, y_mm - high, length, line);
	add_box(l, left, y_mm - line, length, line);
	add_box(l, right_mm - line, y_mm - high, line, high);
	add_text(l, left, y_mm - high - small * 0.45, small, LEGEND_LEFT, "0");
	add_length(l, right_mm, y_mm - high - small * 0.45, small, metres);
	return left;
}

/* A slim arrow, one half filled, and N at its tip, around a middle. */
static void add_north(page_legend *l, double x_mm, double y_mm, double size_mm, double north_rad)
{
	double up[2] = { sin(north_rad), -cos(north_rad) }, aside[2] = { -up[1], up[0] };
	const double at[2] = { x_mm, y_mm };
	/* Along and aside, in sizes: a filled half, and the outline of the other. */
	static const double shapes[3][4][2] = {
		{ { 0.5, 0 }, { -0.5, -0.22 }, { -0.32, 0 }, { 0.5, 0 } },
		{ { 0.5, 0 }, { 0.5, 0.02 }, { -0.5, 0.22 }, { -0.45, 0.17 } },
		{ { -0.32, 0 }, { -0.5, 0.22 }, { -0.45, 0.17 }, { -0.30, 0.02 } },
	};
	for (int n = 0; n < 3; n++) {
		struct legend_shape s = { .corners = 4 };
		for (int k = 0; k < 4; k++)
			for (int axis = 0; axis < 2; axis++)
				s.corner[k][axis] =
					at[axis] + size_mm * (shapes[n][k][0] * up[axis] +
								     shapes[n][k][1] * aside[axis]);
		g_array_append_val(l->shapes, s);
	}
	double letter = size_mm * 0.32;
	add_text(l, x_mm + size_mm * 0.72 * up[0], y_mm + size_mm * 0.72 * up[1] + letter * 0.36,
		letter, LEGEND_MIDDLE, "N");
}

page_legend *page_legend_new(const struct page_legend_desc *d)
{
	page_legend *l = g_new0(page_legend, 1);
	double edge, strip;
	page_legend_edges(d->width_mm, d->height_mm, &edge, &strip);
	l->texts = g_array_new(FALSE, FALSE, sizeof(struct legend_text));
	g_array_set_clear_func(l->texts, text_clear);
	l->shapes = g_array_new(FALSE, FALSE, sizeof(struct legend_shape));
	memset(l->ink, scene_lightness(d->paper) < DARK ? 0xf0 : 0x22, sizeof l->ink);
	double bottom = d->height_mm - edge, right = d->width_mm - edge;
	double title = TITLE_PART * strip, small = SMALL_PART * strip;
	if (d->title)
		add_text(l, edge, bottom - (d->date ? small * 1.5 : 0), title, LEGEND_LEFT,
			d->title);
	if (d->date)
		add_text(l, edge, bottom, small, LEGEND_LEFT, d->date);
	double left = add_bar(l, d, right, bottom, strip);
	g_autofree char *scale = page_scale_text(d->scale);
	add_text(l, left - strip * 0.5, bottom, title, LEGEND_RIGHT, scale);
	if (!isnan(d->north_rad))
		add_north(l, right - strip * 0.6, edge + strip * 0.9, strip * ARROW_PART,
			d->north_rad);
	return l;
}

/* ---- on cairo ---- */

static void paint_text(cairo_t *cr, const struct legend_text *t)
{
	cairo_text_extents_t extents;
	cairo_set_font_size(cr, t->size_mm);
	cairo_text_extents(cr, t->text, &extents);
	double back = t->anchor == LEGEND_LEFT ? 0 : t->anchor == LEGEND_MIDDLE ? 0.5 : 1;
	cairo_move_to(cr, t->x_mm - back * extents.x_advance, t->y_mm);
	cairo_show_text(cr, t->text);
}

void page_legend_paint(const page_legend *l, void *cairo)
{
	cairo_t *cr = cairo;
	cairo_save(cr);
	cairo_set_source_rgb(cr, l->ink[0] / 255.0, l->ink[1] / 255.0, l->ink[2] / 255.0);
	cairo_select_font_face(cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
	for (guint n = 0; n < l->shapes->len; n++) {
		const struct legend_shape *s = &g_array_index(l->shapes, struct legend_shape, n);
		for (uint32_t k = 0; k < s->corners; k++)
			cairo_line_to(cr, s->corner[k][0], s->corner[k][1]);
		cairo_close_path(cr);
		cairo_fill(cr);
	}
	for (guint n = 0; n < l->texts->len; n++)
		paint_text(cr, &g_array_index(l->texts, struct legend_text, n));
	cairo_restore(cr);
}

void page_legend_print(
	const page_legend *l, struct picture_buffer *to, uint32_t from_row, double px_per_mm)
{
	cairo_surface_t *s = vector_ground_surface(to);
	cairo_t *cr = cairo_create(s);
	cairo_translate(cr, 0, -(double)from_row);
	cairo_scale(cr, px_per_mm, px_per_mm);
	page_legend_paint(l, cr);
	cairo_destroy(cr);
	cairo_surface_flush(s);
	for (uint32_t y = 0; cairo_surface_status(s) == CAIRO_STATUS_SUCCESS && y < to->height;
		y++) {
		const uint32_t *from =
			(const void *)(cairo_image_surface_get_data(s) +
				       (size_t)y * (size_t)cairo_image_surface_get_stride(s));
		for (uint32_t x = 0; x < to->width; x++)
			for (int k = 0; k < 3; k++)
				to->rgba[(size_t)y * to->width + x][k] =
					(uint8_t)(from[x] >> (16 - 8 * k));
	}
	cairo_surface_destroy(s);
}
