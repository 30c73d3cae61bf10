#include "process/scan-segments.h"
#include "firmware-io/crc32c.h"
#include <json-glib/json-glib.h>
#include <string.h>

#define AUTOMATIC "automatic"
#define LEAF      "leaf"

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
		!(g->automatic = product_section(g->file, AUTOMATIC, 2, &g->count, error)) ||
		!(g->leaf = product_section(g->file, LEAF, 2, &count, error)))
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

uint32_t scan_segments_automatic_checksum(const scan_segments *s)
{
	return product_section_checksum(s->file, AUTOMATIC);
}

uint32_t scan_segments_leaf_checksum(const scan_segments *s)
{
	return product_section_checksum(s->file, LEAF);
}

uint32_t scan_segments_checksum(const uint16_t *labels, uint64_t count)
{
	return crc32c(0, labels, count * sizeof *labels);
}

/* The labels themselves are compared, so what was damaged is written anew. */
static bool is_there(const site *s, uint32_t number, const uint16_t *automatic,
	const uint16_t *leaf, uint64_t count)
{
	g_autoptr(scan_segments) g = scan_segments_open(s, number, NULL);
	return g && g->count == count && memcmp(g->automatic, automatic, 2 * count) == 0 &&
	       (!leaf || memcmp(g->leaf, leaf, 2 * count) == 0);
}

bool scan_segments_write(const site *s, uint32_t number, const uint16_t *automatic,
	const uint16_t *leaf, uint64_t count, GError **error)
{
	if (is_there(s, number, automatic, leaf, count))
		return true;
	g_autofree char *path = path_of(s, number);
	g_autoptr(product_writer) w = product_writer_new(path, error);
	return w && product_writer_begin(w, AUTOMATIC, 2, error) &&
	       product_writer_append(w, automatic, count, error) &&
	       product_writer_begin(w, LEAF, 2, error) &&
	       product_writer_append(w, leaf ? leaf : automatic, count, error) &&
	       product_writer_finish(
		       w, SCAN_SEGMENTS_KIND, SCAN_SEGMENTS_VERSION, json_object_new(), error);
}
