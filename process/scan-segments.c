#include "process/scan-segments.h"

static char *path_of(const site *s, uint32_t number)
{
	return g_strdup_printf("%s/segments/%04u.segments", site_path(s), number);
}

scan_segments *scan_segments_open(const site *s, uint32_t number, GError **error)
{
	g_autofree char *path = path_of(s, number);
	g_autoptr(scan_segments) g = g_new0(scan_segments, 1);
	uint64_t count;
	g->file = product_open(path, SCAN_SEGMENTS_KIND, SCAN_SEGMENTS_VERSION, error);
	if (!g->file ||
		!(g->automatic = product_section(g->file, "automatic", 2, &g->count, error)) ||
		!(g->leaf = product_section(g->file, "leaf", 2, &count, error)))
		return NULL;
	if (count == g->count)
		return g_steal_pointer(&g);
	g_set_error(error, PRODUCT_ERROR, PRODUCT_ERROR_DAMAGED,
		"%s: its sections are of %" G_GUINT64_FORMAT " and %" G_GUINT64_FORMAT " points",
		path, g->count, count);
	return NULL;
}

void scan_segments_free(scan_segments *s)
{
	if (!s)
		return;
	product_free(s->file);
	g_free(s);
}

bool scan_segments_write(const site *s, uint32_t number, const char *key, const uint16_t *automatic,
	const uint16_t *leaf, uint64_t count, GError **error)
{
	g_autofree char *path = path_of(s, number);
	g_autoptr(product_writer) w = product_writer_new(path, error);
	if (!w || !product_writer_begin(w, "automatic", 2, error) ||
		!product_writer_append(w, automatic, count, error) ||
		!product_writer_begin(w, "leaf", 2, error) ||
		!product_writer_append(w, leaf, count, error))
		return false;
	JsonObject *made_from = json_object_new();
	json_object_set_string_member(made_from, "key", key);
	return product_writer_finish(
		w, SCAN_SEGMENTS_KIND, SCAN_SEGMENTS_VERSION, made_from, error);
}

char *scan_segments_key(const site *s, uint32_t number)
{
	g_autoptr(scan_segments) g = scan_segments_open(s, number, NULL);
	return g ? g_strdup(json_object_get_string_member_with_default(
			   product_manifest(g->file), "key", ""))
		 : NULL;
}
