#include "firmware-io/files.h"
#include "render/vector-private.h"
#include <math.h>
#include <string.h>

/* Of a millimetre: what coordinates of strokes are whole numbers of. Layers are scaled by that, so that numbers have no point. */
#define PARTS 25

/* ---- numbers ---- */

/* A number follows another without a space when it begins with a sign. */
static void add_number(GString *to, long parts, bool follows)
{
	char digits[24];
	if (parts >= 0 && follows)
		g_string_append_c(to, ' ');
	g_string_append_len(to, digits, g_snprintf(digits, sizeof digits, "%ld", parts));
}

struct pen_at {
	long x, y;
};

/* false: it is where the pen is already, and must not be written. */
static bool add_move(GString *to, struct pen_at *at, const float corner[2], bool follows, bool must)
{
	long x = lround((double)corner[0] * PARTS), y = lround((double)corner[1] * PARTS);
	if (x == at->x && y == at->y && !must)
		return false;
	add_number(to, x - at->x, follows);
	add_number(to, y - at->y, true);
	*at = (struct pen_at){ x, y };
	return true;
}

/* ---- paths ---- */

static void add_shape(GString *to, struct pen_at *at, const float (*corner)[2], uint32_t corners,
	enum vector_form form)
{
	g_string_append_c(to, 'm');
	add_move(to, at, corner[0], false, true);
	struct pen_at first = *at;
	if (form == VECTOR_DOTS) { /* some show nothing of a line without any length */
		g_string_append(to, "h1");
		at->x++;
		return;
	}
	/* A move's further corners are lines to them. */
	for (uint32_t n = 1; n < corners; n++)
		add_move(to, at, corner[n], true, n == 1);
	if (form == VECTOR_AREAS) {
		g_string_append_c(to, 'z');
		*at = first;
	}
}

static void add_path(GString *to, const struct vector_path *p, const struct vector_layer *l)
{
	const float(*corner)[2] = (const void *)p->corner->data;
	const char *what = l->form == VECTOR_AREAS ? "fill" : "stroke";
	char number[G_ASCII_DTOSTR_BUF_SIZE];
	struct pen_at at = { 0 };
	g_string_append(to, "<path");
	if (l->blend == VECTOR_EACH_DARK)
		g_string_append(to, " style=\"mix-blend-mode:multiply\"");
	if (l->blend != VECTOR_MULTIPLY)
		g_string_append_printf(
			to, " %s=\"#%02x%02x%02x\"", what, p->rgb[0], p->rgb[1], p->rgb[2]);
	if (l->form != VECTOR_AREAS)
		g_string_append_printf(to, " stroke-width=\"%s\"",
			g_ascii_formatd(
				number, sizeof number, "%.3g", (double)p->width_mm * PARTS));
	if (p->opacity < 1)
		g_string_append_printf(to, " %s-opacity=\"%s\"", what,
			g_ascii_formatd(number, sizeof number, "%.3g", (double)p->opacity));
	g_string_append(to, " d=\"");
	for (guint n = 0, first = 0; n < p->end->len; n++) {
		uint32_t end = g_array_index(p->end, uint32_t, n);
		add_shape(to, &at, corner + first, end - first, l->form);
		first = end;
	}
	g_string_append(to, "\"/>\n");
}

/* ---- layers ---- */

static void add_layer_begin(GString *to, const char *id, const char *name, const char *looks)
{
	g_autofree char *text = g_markup_escape_text(name, -1);
	g_string_append_printf(to,
		"<g inkscape:groupmode=\"layer\" id=\"%s\" inkscape:label=\"%s\"%s>\n", id, text,
		looks);
}

/* Of the looks that all paths of a layer have. */
static char *looks_of(const struct vector_layer *l)
{
	g_autoptr(GString) s = g_string_new(" style=\"");
	char ink[8] = "none";
	if (l->blend == VECTOR_MULTIPLY && l->groups->len) {
		const struct vector_group *g = g_ptr_array_index(l->groups, 0);
		const struct vector_path *p = g_ptr_array_index(g->paths, 0);
		g_snprintf(ink, sizeof ink, "#%02x%02x%02x", p->rgb[0], p->rgb[1], p->rgb[2]);
	}
	if (l->blend != VECTOR_COVER)
		g_string_append(s, "mix-blend-mode:multiply;");
	if (l->form == VECTOR_AREAS)
		g_string_append_printf(s, "fill:%s\"", ink);
	else
		g_string_append_printf(s, "fill:none;stroke:%s;stroke-linecap:%s\"", ink,
			l->form == VECTOR_DOTS ? "round" : "butt");
	g_string_append_printf(s, " transform=\"scale(%g)\"", 1.0 / PARTS);
	return g_strdup(s->str);
}

static void add_layer(GString *to, const struct vector_layer *l, guint number)
{
	g_autofree char *looks = looks_of(l), *id = g_strdup_printf("layer-%u", number + 1);
	add_layer_begin(to, id, l->name, looks);
	for (guint g = 0; g < l->groups->len; g++) {
		const struct vector_group *group = g_ptr_array_index(l->groups, g);
		g_autofree char *own = g_strdup_printf("%s-segment-%u", id, group->segment);
		add_layer_begin(to, own, group->name && *group->name ? group->name : "Site", "");
		for (guint n = 0; n < group->paths->len; n++)
			add_path(to, g_ptr_array_index(group->paths, n), l);
		g_string_append(to, "</g>\n");
	}
	g_string_append(to, "</g>\n");
}

/* ---- ground ---- */

static bool add_image(GString *to, const vector_page *p, const char *path, GError **error)
{
	g_autoptr(GByteArray) png = g_byte_array_new();
	cairo_surface_t *s = vector_ground_surface(&p->ground);
	cairo_status_t status = cairo_surface_write_to_png_stream(s, vector_append, png);
	cairo_surface_destroy(s);
	if (!vector_check(status, path, error))
		return false;
	g_autofree char *text = g_base64_encode(png->data, png->len);
	g_string_append_printf(to,
		"<image width=\"%.6g\" height=\"%.6g\" preserveAspectRatio=\"none\" "
		"xlink:href=\"data:image/png;base64,",
		p->width_mm, p->height_mm);
	g_string_append(to, text);
	g_string_append(to, "\"/>\n");
	return true;
}

static bool add_ground(GString *to, const vector_page *p, const char *path, GError **error)
{
	add_layer_begin(to, "paper", "Paper", "");
	g_string_append_printf(to,
		"<rect width=\"%.6g\" height=\"%.6g\" fill=\"#%02x%02x%02x\"/>\n", p->width_mm,
		p->height_mm, p->paper[0], p->paper[1], p->paper[2]);
	if (p->ground.rgba && !add_image(to, p, path, error))
		return false;
	g_string_append(to, "</g>\n");
	return true;
}

/* ---- legend ---- */

static void add_legend_shape(GString *to, const struct legend_shape *s)
{
	g_string_append(to, "<path d=\"");
	for (uint32_t n = 0; n < s->corners; n++)
		g_string_append_printf(
			to, "%s%.6g %.6g", n ? "L" : "M", s->corner[n][0], s->corner[n][1]);
	g_string_append(to, "z\"/>\n");
}

static void add_legend_text(GString *to, const struct legend_text *t)
{
	static const char *const anchors[] = {
		[LEGEND_LEFT] = "start", [LEGEND_MIDDLE] = "middle", [LEGEND_RIGHT] = "end"
	};
	g_autofree char *text = g_markup_escape_text(t->text, -1);
	g_string_append_printf(to,
		"<text x=\"%.6g\" y=\"%.6g\" font-size=\"%.6g\" text-anchor=\"%s\">%s</text>\n",
		t->x_mm, t->y_mm, t->size_mm, anchors[t->anchor], text);
}

static void add_legend(GString *to, const page_legend *l)
{
	g_autofree char *looks =
		g_strdup_printf(" font-family=\"sans-serif\" fill=\"#%02x%02x%02x\"", l->ink[0],
			l->ink[1], l->ink[2]);
	add_layer_begin(to, "legend", "Legend", looks);
	for (guint n = 0; n < l->shapes->len; n++)
		add_legend_shape(to, &g_array_index(l->shapes, struct legend_shape, n));
	for (guint n = 0; n < l->texts->len; n++)
		add_legend_text(to, &g_array_index(l->texts, struct legend_text, n));
	g_string_append(to, "</g>\n");
}

/* ---- page ---- */

static void add_head(GString *to, const vector_page *p)
{
	g_autofree char *title = g_markup_escape_text(p->title ? p->title : "", -1);
	g_string_append_printf(to,
		"<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
		"<svg xmlns=\"http://www.w3.org/2000/svg\" "
		"xmlns:xlink=\"http://www.w3.org/1999/xlink\"\n"
		" xmlns:inkscape=\"http://www.inkscape.org/namespaces/inkscape\"\n"
		" xmlns:sodipodi=\"http://sodipodi.sourceforge.net/DTD/sodipodi-0.dtd\"\n"
		" width=\"%.6gmm\" height=\"%.6gmm\" viewBox=\"0 0 %.6g %.6g\">\n"
		"<title>%s</title>\n<desc>Made by pleinair</desc>\n"
		"<sodipodi:namedview id=\"view\" inkscape:document-units=\"mm\"/>\n",
		p->width_mm, p->height_mm, p->width_mm, p->height_mm, title);
}

bool vector_page_save_svg(const vector_page *p, const char *path, GError **error)
{
	g_autoptr(GString) text = g_string_new(NULL);
	add_head(text, p);
	if (p->has_paper && !add_ground(text, p, path, error))
		return false;
	for (guint n = 0; n < p->layers->len; n++)
		add_layer(text, g_ptr_array_index(p->layers, n), n);
	if (p->legend)
		add_legend(text, p->legend);
	g_string_append(text, "</svg>\n");
	return files_write(path, text->str, text->len, error);
}
