#include "render/drawn-site.h"
#include "process/model-look.h"
#include "process/site-lines.h"
#include <gio/gio.h>
#include <math.h>
#include <string.h>

drawn_site *drawn_site_new(const char *folder, double aspect, GError **error)
{
	g_autoptr(drawn_site) d = g_new0(drawn_site, 1);
	d->folder = g_strdup(folder);
	d->site = site_open(folder, error);
	d->model = d->site ? model_look_open(d->site, &d->is_look, error) : NULL;
	d->stations = d->model ? view_stations(d->site, d->model, error) : NULL;
	if (!d->stations)
		return NULL;
	d->sources = (struct view_sources){ .site = d->site,
		.stations = (const struct view_station *)(void *)d->stations->data,
		.station_count = d->stations->len,
		.aspect = aspect };
	d->sources.boxes = d->boxes = view_boxes_new(d->model);
	return g_steal_pointer(&d);
}

static uint64_t memory_bytes;

bool drawn_site_set_memory(const char *text, GError **error)
{
	static const char units[] = "KMGT";
	char *end = NULL;
	double number = text ? g_ascii_strtod(text, &end) : 0;
	const char *unit = text && *end ? strchr(units, g_ascii_toupper(*end)) : NULL;
	double bytes = unit ? ldexp(number, 10 * (int)(unit - units + 1)) : number;
	bool good = !text || (end != text && (unit ? !end[1] : !*end));
	if (good && (!text || (bytes >= 1 << 20 && bytes <= 0x1p50))) {
		memory_bytes = (uint64_t)bytes;
		return true;
	}
	g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_ARGUMENT,
		"memory is told as 512M or 4G, and is 1M at least, not '%s'", text);
	return false;
}

/* Sites of before there were any have none until they are processed again. */
static bool load_lines(drawn_site *d, GError **error)
{
	g_autoptr(GError) none = NULL;
	g_autoptr(profile_lines) lines = site_lines_load(d->folder, &none);
	if (lines)
		scene_set_lines(d->scene, lines);
	else if (!g_error_matches(none, G_IO_ERROR, G_IO_ERROR_NOT_FOUND) &&
		 !g_error_matches(none, PRODUCT_ERROR, PRODUCT_ERROR_VERSION)) {
		g_propagate_error(error, g_steal_pointer(&none));
		return false;
	}
	return true;
}

bool drawn_site_load(drawn_site *d, GError **error)
{
	if (!segments_load_any(d->folder, &d->tree, error))
		return false;
	g_autofree uint8_t *leaf_class = d->tree ? segments_classes(d->tree) : NULL;
	d->scene = scene_new_within(d->model, leaf_class, memory_bytes, error);
	return d->scene && load_lines(d, error);
}

void drawn_site_free(drawn_site *d)
{
	if (!d)
		return;
	scene_free(d->scene);
	segments_free(d->tree);
	if (d->stations)
		g_array_unref(d->stations);
	view_boxes_free(d->boxes);
	model_free(d->model);
	site_free(d->site);
	g_free(d->folder);
	g_free(d);
}

bool drawn_site_lacks_lines(const drawn_site *d, const drawing *how)
{
	for (guint p = 0; !d->scene->lines && p < how->pipelines->len; p++) {
		const struct pipeline *line = &g_array_index(how->pipelines, struct pipeline, p);
		for (uint32_t n = 0; n < line->layers; n++)
			if (step_is_profile(&line->steps[n]))
				return true;
	}
	return false;
}

drawing *drawn_site_style(const drawn_site *d, const char *style_name, GError **error)
{
	g_autoptr(style) s = style_find(style_name, d->folder, error);
	return s ? drawing_new(s, d->tree, NULL, error) : NULL;
}
