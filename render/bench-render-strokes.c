/* Strokes alone: how many of 24 x 6 px a second. */
#include "render/bench-render-private.h"
#include <stdio.h>

static drawing *strokes_drawing(const bench_place *p, uint32_t height, GError **error)
{
	/* Lengths in styles are for FRAME_STYLE_HEIGHT. */
	double px = FRAME_STYLE_HEIGHT / height;
	char length[3][G_ASCII_DTOSTR_BUF_SIZE];
	g_autofree char *text = g_strdup_printf(
		"{ \"schema\": 1, \"name\": \"bench\", \"title\": \"Bench\", \"source\": "
		"\"pleinair\", \"segments\": { \"site\": { \"steps\": [ { \"step\": \"strokes\", "
		"\"points\": \"all\", \"direction\": \"screen\", \"texture\": \"pencil\", "
		"\"length_variation\": 0, \"length_px\": %s, \"width_px\": %s, "
		"\"spacing_px\": %s } ] } } }",
		g_ascii_dtostr(length[0], sizeof length[0], 24 * px),
		g_ascii_dtostr(length[1], sizeof length[1], 6 * px),
		g_ascii_dtostr(length[2], sizeof length[2], 2 * px));
	g_autoptr(style) s = style_parse(text, -1, "bench", error);
	return s ? drawing_new(s, p->tree, NULL, error) : NULL;
}

static uint64_t count_submitted(const frame *f)
{
	uint32_t count;
	uint64_t strokes = 0;
	g_autofree struct chunk_view *views = chunk_views_new(f, &count);
	stroke_list *lists = stroke_lists_new(f, NULL, views, count);
	for (uint32_t l = 0; l < f->layers; l++)
		strokes += lists[l].count;
	stroke_lists_free(lists, f->layers);
	return strokes;
}

bool render_strokes_measure(struct render_strokes *ret, const bench_place *p, const scene *s,
	const struct camera *c, uint32_t repeats, GError **error)
{
	g_autoptr(painter) cpu = painter_new(BACKEND_WISH_CPU, error);
	g_autoptr(drawing) d = cpu ? strokes_drawing(p, c->height, error) : NULL;
	g_autoptr(frame) f = d ? frame_new(s, d, c, error) : NULL;
	struct draw_times t;
	if (!f)
		return false;
	struct picture_buffer picture = picture_buffer_new(c->width, c->height);
	bool good = render_fastest(cpu, f, repeats, &picture, &t, error);
	picture_buffer_clear(&picture);
	if (good)
		*ret = (struct render_strokes){ count_submitted(f), t.strokes,
			t.choose_s + t.bin_s + t.draw_s, t.choose_s, t.bin_s, t.draw_s };
	return good;
}
