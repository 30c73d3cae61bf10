#include "firmware-io/files.h"
#include "render/vector-private.h"
#include <cairo-pdf.h>
#include <gio/gio.h>

#define PT_PER_MM (72 / 25.4)

/* ---- shapes ---- */

static void trace(cairo_t *cr, const struct vector_path *p, enum vector_form form)
{
	const float(*corner)[2] = (const void *)p->corner->data;
	for (guint n = 0, k = 0; n < p->end->len; n++) {
		uint32_t end = g_array_index(p->end, uint32_t, n);
		cairo_move_to(cr, (double)corner[k][0], (double)corner[k][1]);
		if (form == VECTOR_DOTS)
			cairo_line_to(cr, (double)corner[k][0], (double)corner[k][1]);
		for (k++; k < end; k++)
			cairo_line_to(cr, (double)corner[k][0], (double)corner[k][1]);
		if (form == VECTOR_AREAS)
			cairo_close_path(cr);
	}
}

static void paint_path(cairo_t *cr, const struct vector_path *p, enum vector_form form)
{
	cairo_set_source_rgba(
		cr, p->rgb[0] / 255.0, p->rgb[1] / 255.0, p->rgb[2] / 255.0, (double)p->opacity);
	trace(cr, p, form);
	if (form == VECTOR_AREAS) {
		cairo_fill(cr);
		return;
	}
	cairo_set_line_width(cr, (double)p->width_mm);
	cairo_stroke(cr);
}

static void paint_layer(cairo_t *cr, const struct vector_layer *l)
{
	cairo_push_group(cr);
	cairo_set_line_cap(cr, l->form == VECTOR_DOTS ? CAIRO_LINE_CAP_ROUND : CAIRO_LINE_CAP_BUTT);
	cairo_set_operator(
		cr, l->blend == VECTOR_EACH_DARK ? CAIRO_OPERATOR_MULTIPLY : CAIRO_OPERATOR_OVER);
	for (guint g = 0; g < l->groups->len; g++) {
		const struct vector_group *group = g_ptr_array_index(l->groups, g);
		for (guint n = 0; n < group->paths->len; n++)
			paint_path(cr, g_ptr_array_index(group->paths, n), l->form);
	}
	cairo_pop_group_to_source(cr);
	cairo_set_operator(
		cr, l->blend == VECTOR_COVER ? CAIRO_OPERATOR_OVER : CAIRO_OPERATOR_MULTIPLY);
	cairo_paint(cr);
	cairo_set_operator(cr, CAIRO_OPERATOR_OVER);
}

/* ---- ground ---- */

cairo_surface_t *vector_ground_surface(const struct picture_buffer *p)
{
	cairo_surface_t *s =
		cairo_image_surface_create(CAIRO_FORMAT_RGB24, (int)p->width, (int)p->height);
	if (cairo_surface_status(s) != CAIRO_STATUS_SUCCESS)
		return s;
	cairo_surface_flush(s);
	for (uint32_t y = 0; y < p->height; y++) {
		uint32_t *to = (void *)(cairo_image_surface_get_data(s) +
					(size_t)y * (size_t)cairo_image_surface_get_stride(s));
		const uint8_t(*from)[4] = (const void *)(p->rgba + (size_t)y * p->width);
		for (uint32_t x = 0; x < p->width; x++)
			to[x] = (uint32_t)from[x][0] << 16 | (uint32_t)from[x][1] << 8 | from[x][2];
	}
	cairo_surface_mark_dirty(s);
	return s;
}

static void paint_ground(cairo_t *cr, const vector_page *p)
{
	cairo_set_source_rgb(cr, p->paper[0] / 255.0, p->paper[1] / 255.0, p->paper[2] / 255.0);
	cairo_rectangle(cr, 0, 0, p->width_mm, p->height_mm);
	cairo_fill(cr);
	if (!p->ground.rgba)
		return;
	cairo_surface_t *s = vector_ground_surface(&p->ground);
	cairo_save(cr);
	cairo_scale(cr, p->width_mm / p->ground.width, p->height_mm / p->ground.height);
	cairo_set_source_surface(cr, s, 0, 0);
	cairo_pattern_set_extend(cairo_get_source(cr), CAIRO_EXTEND_PAD);
	cairo_rectangle(cr, 0, 0, p->ground.width, p->ground.height);
	cairo_fill(cr);
	cairo_restore(cr);
	cairo_surface_destroy(s);
}

/* ---- page ---- */

void vector_page_paint(const vector_page *p, void *cairo)
{
	cairo_t *cr = cairo;
	cairo_save(cr);
	cairo_rectangle(cr, 0, 0, p->width_mm, p->height_mm);
	cairo_clip(cr);
	if (p->has_paper)
		paint_ground(cr, p);
	for (guint n = 0; n < p->layers->len; n++)
		paint_layer(cr, g_ptr_array_index(p->layers, n));
	if (p->legend)
		page_legend_paint(p->legend, cr);
	cairo_restore(cr);
}

/* ---- PDF ---- */

bool vector_check(cairo_status_t status, const char *path, GError **error)
{
	if (status == CAIRO_STATUS_SUCCESS)
		return true;
	g_set_error(error, G_IO_ERROR, G_IO_ERROR_FAILED, "%s: cannot be written: %s", path,
		cairo_status_to_string(status));
	return false;
}

cairo_status_t vector_append(void *bytes, const unsigned char *more, unsigned length)
{
	g_byte_array_append(bytes, more, length);
	return CAIRO_STATUS_SUCCESS;
}

static void describe(cairo_surface_t *s, const vector_page *p)
{
	cairo_pdf_surface_set_metadata(s, CAIRO_PDF_METADATA_TITLE, p->title);
	cairo_pdf_surface_set_metadata(s, CAIRO_PDF_METADATA_CREATOR, "pleinair");
	/* The same bytes for the same page: no time of day. */
	cairo_pdf_surface_set_metadata(s, CAIRO_PDF_METADATA_CREATE_DATE, "2004-01-01T00:00:00Z");
}

bool vector_page_save_pdf(const vector_page *p, const char *path, GError **error)
{
	g_autoptr(GByteArray) bytes = g_byte_array_new();
	cairo_surface_t *s = cairo_pdf_surface_create_for_stream(
		vector_append, bytes, p->width_mm * PT_PER_MM, p->height_mm * PT_PER_MM);
	cairo_t *cr = cairo_create(s);
	describe(s, p);
	cairo_scale(cr, PT_PER_MM, PT_PER_MM);
	vector_page_paint(p, cr);
	cairo_show_page(cr);
	cairo_status_t status = cairo_status(cr);
	cairo_destroy(cr);
	cairo_surface_finish(s);
	if (status == CAIRO_STATUS_SUCCESS)
		status = cairo_surface_status(s);
	cairo_surface_destroy(s);
	return vector_check(status, path, error) &&
	       files_write(path, bytes->data, bytes->len, error);
}
