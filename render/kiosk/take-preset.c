#include "render/kiosk/take-preset.h"
#include "render/view-parallel.h"
#include <glib/gi18n.h>
#include <string.h>

static const struct take_preset pictures[] = {
	{ "screen", N_("Screen, 1920 × 1080"), "png", "1920x1080" },
	{ "screen-4k", N_("4K, 3840 × 2160"), "png", "3840x2160" },
	{ "a4", N_("A4, 300 dpi"), "png", "A4-landscape", .dpi = 300 },
	{ "a3", N_("A3, 300 dpi"), "png", "A3-landscape", .dpi = 300 },
	{ "poster", N_("Poster, A0, 300 dpi"), "png", "A0-landscape", .dpi = 300 },
	{ NULL },
};
static const struct take_preset drawings[] = {
	{ "pdf-a3", N_("PDF, A3"), "pdf", "A3-landscape" },
	{ "pdf-a4", N_("PDF, A4"), "pdf", "A4-landscape" },
	{ "pdf-a1", N_("PDF, A1"), "pdf", "A1-landscape" },
	{ "svg-a3", N_("SVG, A3"), "svg", "A3-landscape" },
	{ NULL },
};
/* Thirty frames are a second: four from station to station, twenty-four once around. */
static const struct take_preset films[] = {
	{ "walk", N_("Walk, 1920 × 1080"), "mp4", "1920x1080", .path = "stations:120" },
	{ "walk-small", N_("Walk, 1280 × 720"), "mp4", "1280x720", .path = "stations:120" },
	{ "orbit", N_("Orbit, 1920 × 1080"), "mp4", "1920x1080", .path = "orbit:0.5:720" },
	{ "orbit-small", N_("Orbit, 1280 × 720"), "mp4", "1280x720", .path = "orbit:0.5:720" },
	{ NULL },
};
static const struct take_preset reports[] = {
	{ "maps", N_("With pictures"), "html" },
	{ "plain", N_("Text and tables"), "html" },
	{ NULL },
};

/* A centimetre apart a room has some millions: programs on small machines open that. */
static const struct take_preset clouds[] = {
	{ "e57", N_("E57, all scans"), "e57" },
	{ "e57-1cm", N_("E57, 1 cm apart"), "e57", .spacing_m = 0.01 },
	{ "las", N_("LAS, with classes"), "las" },
	{ "las-1cm", N_("LAS, 1 cm apart"), "las", .spacing_m = 0.01 },
	{ "ptx", N_("PTX, all scans"), "ptx" },
	{ "ply", N_("PLY"), "ply" },
	{ "pcd", N_("PCD"), "pcd" },
	{ NULL },
};

const struct take_preset *take_presets(enum export_kind kind)
{
	static const struct take_preset none[] = { { NULL } };
	switch (kind) {
	case EXPORT_PICTURE: return pictures;
	case EXPORT_DRAWING: return drawings;
	case EXPORT_FILM: return films;
	case EXPORT_REPORT: return reports;
	case EXPORT_POINTS: return clouds;
	default: return none;
	}
}

const struct take_preset *take_preset_find(enum export_kind kind, const char *id)
{
	for (const struct take_preset *p = take_presets(kind); p->id; p++)
		if (!g_strcmp0(p->id, id))
			return p;
	return NULL;
}

char *take_stem(
	enum export_kind kind, const struct take_preset *p, const char *style, const char *seen)
{
	if (kind == EXPORT_REPORT)
		return g_strdup("report");
	if (kind == EXPORT_POINTS)
		return g_strdup(p->spacing_m > 0 ? "points-1cm" : "points");
	char *stem = p == take_presets(kind) ? g_strdup_printf("%s-%s", style, seen)
					     : g_strdup_printf("%s-%s-%s", style, seen, p->id);
	return g_strdelimit(
		stem, ":", '-'); /* which drives of other systems do not know in names */
}

const char *take_job(enum export_kind kind)
{
	return kind == EXPORT_REPORT ? "report" : kind == EXPORT_POINTS ? "export" : "render";
}

static void add_text(GVariantDict *d, const char *name, const char *value)
{
	if (value)
		g_variant_dict_insert(d, name, "s", value);
}

/* A camera that moves has perspective. */
static const char *view_of_film(const char *seen)
{
	return view_parallel_is(seen) ? "overview" : seen;
}

GVariant *take_options(enum export_kind kind, const struct take_preset *p, const char *style,
	const char *seen, const char *output)
{
	g_auto(GVariantDict) d = G_VARIANT_DICT_INIT(NULL);
	add_text(&d, "output", output);
	if (kind == EXPORT_POINTS) {
		if (p->spacing_m > 0)
			g_variant_dict_insert(&d, "spacing", "d", p->spacing_m);
	} else if (kind != EXPORT_REPORT) {
		add_text(&d, "style", style);
		add_text(&d, "view", kind == EXPORT_FILM ? view_of_film(seen) : seen);
		add_text(&d, "size", p->size);
		if (p->dpi > 0)
			g_variant_dict_insert(&d, "dpi", "d", p->dpi);
		add_text(&d, "path", p->path);
	} else if (!strcmp(p->id, "plain"))
		g_variant_dict_insert(&d, "no-maps", "b", TRUE);
	return g_variant_dict_end(&d);
}
