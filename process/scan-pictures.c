#include "process/scan-pictures.h"
#include "acquire/picture.h"
#include <math.h>
#include <string.h>

static void grey(uint8_t rgb[3], uint8_t value)
{
	memset(rgb, value, 3);
}

static bool is_feature(const struct scan_picture_input *of, size_t i)
{
	return of->features->kind[i] >= FEATURE_UNDIRECTED;
}

static void paint_degree(const struct scan_picture_input *of, size_t i, uint8_t rgb[3])
{
	grey(rgb, of->features->degree[i]);
}

static void paint_points(const struct scan_picture_input *of, size_t i, uint8_t rgb[3])
{
	grey(rgb, is_feature(of, i) ? 0 : 255);
}

static void paint_kinds(const struct scan_picture_input *of, size_t i, uint8_t rgb[3])
{
	static const uint8_t directed[3] = { 20, 60, 200 }, undirected[3] = { 220, 120, 30 };
	if (is_feature(of, i))
		memcpy(rgb, of->features->kind[i] == FEATURE_DIRECTED ? directed : undirected, 3);
}

static void paint_sources(const struct scan_picture_input *of, size_t i, uint8_t rgb[3])
{
	const uint8_t flags = of->features->flags[i];
	if (!is_feature(of, i))
		return;
	rgb[0] = flags & FEATURE_SILHOUETTE ? 200 : 0;
	rgb[1] = flags & FEATURE_CREASE ? 160 : 0;
	rgb[2] = flags & (FEATURE_COLOUR_EDGE | FEATURE_INTENSITY_EDGE) ? 220 : 0;
}

static void paint_dithering(const struct scan_picture_input *of, size_t i, uint8_t rgb[3])
{
	grey(rgb, of->features->kind[i] == FEATURE_DITHER ? 0 : 255);
}

static void paint_drawing(const struct scan_picture_input *of, size_t i, uint8_t rgb[3])
{
	grey(rgb, of->features->kind[i] == FEATURE_DITHER ? 90 : is_feature(of, i) ? 0 : 255);
}

/* 1 / 0.1 m is full colour; a square root shows weak bends too. */
static void paint_curvature(const struct scan_picture_input *of, size_t i, uint8_t rgb[3])
{
	const float k = of->features->k1[i];
	if (!(of->grid->range_m[i] > 0))
		grey(rgb, 0);
	else if (!isfinite(k))
		grey(rgb, 128);
	else {
		uint8_t less = (uint8_t)lrintf(255 * (1 - sqrtf(fminf(fabsf(k) * 0.1f, 1))));
		rgb[0] = k < 0 ? less : 255;
		rgb[1] = less;
		rgb[2] = k < 0 ? 255 : less;
	}
}

/* Hues that lie far from those of the numbers before; things of a class are alike in nothing else. */
static void own_colour(uint32_t id, uint8_t rgb[3])
{
	double hue = 6 * fmod(id * 0.6180339887, 1), value = 0.62 + 0.09 * (id / 3 % 5),
	       saturation = 0.35 + 0.12 * (id % 4);
	for (int k = 0; k < 3; k++) {
		double off = fabs(fmod(hue + 2.0 * k, 6) - 3) - 1;
		double pure = fmin(fmax(off, 0), 1);
		rgb[k] = (uint8_t)lrint(255 * value * (1 - saturation + saturation * pure));
	}
}

struct segment_colour *segment_colours(const segments *tree)
{
	struct segment_colour *colour = g_new0(struct segment_colour, SEGMENTS_MAX + 1);
	for (guint i = 0; i < tree->nodes->len; i++) {
		const struct segment *node = &g_array_index(tree->nodes, struct segment, i);
		memcpy(colour[node->id].class, segment_classes[node->class].rgb, 3);
		own_colour(node->id, colour[node->id].own);
	}
	return colour;
}

/* Darker where there are features, so that shapes show. */
static void paint_leaf(
	const struct scan_picture_input *of, size_t i, const uint8_t paint[3], uint8_t rgb[3])
{
	float shade = 1 - 0.6f * of->features->degree[i] / 255;
	for (int k = 0; k < 3; k++)
		rgb[k] = of->segments->leaf[i] ? (uint8_t)lrintf(shade * paint[k]) : 0;
}

static void paint_classes(const struct scan_picture_input *of, size_t i, uint8_t rgb[3])
{
	paint_leaf(of, i, of->colour[of->segments->leaf[i]].class, rgb);
}

static void paint_segments(const struct scan_picture_input *of, size_t i, uint8_t rgb[3])
{
	paint_leaf(of, i, of->colour[of->segments->leaf[i]].own, rgb);
}

const struct scan_picture scan_pictures[] = {
	{ "classes",
		"Classes: buildings red, vegetation green, terrain sand, structures slate, water "
		"blue, "
		"other things violet",
		paint_classes },
	{ "segments", "Segments: every thing, and every part of one, in a colour of its own",
		paint_segments },
	{ "degree", "Feature degree: brighter is higher", paint_degree },
	{ "points", "Feature points", paint_points },
	{ "kinds", "Feature points: directional ones blue, the others orange", paint_kinds },
	{ "sources",
		"What they come from: silhouettes red, creases green, colour and intensity blue",
		paint_sources },
	{ "dithering", "Dithering points", paint_dithering },
	{ "drawing", "Feature points black, dithering points grey", paint_drawing },
	{ "curvature", "Curvature: bulging red, hollow blue, not known grey", paint_curvature },
	{ NULL },
};

bool scan_picture_save(const struct scan_picture *p, const struct scan_picture_input *of,
	const char *path, GError **error)
{
	const size_t cells = range_grid_cells(of->grid);
	g_autofree uint8_t *rgb = g_malloc(3 * cells + 1);
	memset(rgb, 255, 3 * cells);
	for (size_t i = 0; i < cells; i++)
		p->paint(of, i, rgb + 3 * i);
	return picture_write(path, rgb, of->grid->columns, of->grid->rows, error);
}

static const char style[] =
	":root{color-scheme:light dark}"
	"body{font:16px/1.5 system-ui,sans-serif;margin:0 auto;max-width:1500px;padding:1rem "
	"1.5rem}"
	"h1,h2{font-weight:600}figure{margin:0 0 1rem}figcaption{font-size:.85rem}"
	"img{width:100%;height:auto;display:block;border-radius:4px}";

bool scan_pictures_write_page(
	const char *folder, const char *title, const GArray *numbers, GError **error)
{
	g_autofree char *path = g_build_filename(folder, "index.html", NULL),
			*name = g_markup_escape_text(title, -1);
	g_autoptr(GString) html =
		g_string_new("<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
			     "<meta name=\"viewport\" content=\"width=device-width\">");
	g_string_append_printf(html,
		"<title>%s</title><style>%s</style></head>\n<body>\n<h1>%s</h1>\n", name, style,
		name);
	for (guint i = 0; i < numbers->len; i++) {
		uint32_t number = g_array_index(numbers, uint32_t, i);
		g_string_append_printf(
			html, "<section id=\"scan-%04u\"><h2>Scan %04u</h2>\n", number, number);
		for (const struct scan_picture *p = scan_pictures; p->name; p++)
			g_string_append_printf(html,
				"<figure><figcaption>%s</figcaption><a href=\"%04u-%s.png\"><img "
				"src=\"%04u-%s.png\" alt=\"%s\" loading=\"lazy\"></a></figure>\n",
				p->title, number, p->name, number, p->name, p->title);
		g_string_append(html, "</section>\n");
	}
	g_string_append(html, "</body></html>\n");
	return g_file_set_contents(path, html->str, (gssize)html->len, error);
}
