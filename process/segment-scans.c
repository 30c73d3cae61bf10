#include "process/segment-scans.h"
#include <gio/gio.h>
#include <string.h>

#define CACHED 4

static void clear_scan(gpointer data)
{
	g_free(((struct segment_scan *)data)->state);
}

static char *state_of(const site *s, const scan_data *d, const struct pose *pose)
{
	g_autoptr(scan_geometry) g = scan_geometry_open(s, d->number, NULL);
	g_autoptr(GString) text = g_string_new(d->fingerprint);
	g_string_append_printf(text, " %08x", g ? product_checksum(g->file) : 0);
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 4; j++)
			g_string_append_printf(text, " %.9g",
				j < 3 ? pose->rotation[i][j] : pose->translation_m[i]);
	return g_string_free(g_steal_pointer(&text), FALSE);
}

/* Groups that have a scan that came with its pose stand in one frame with each other. */
static bool find_scans(segment_scans *all, const scan_graph *g, GError **error)
{
	g_autoptr(GHashTable) given = g_hash_table_new(NULL, NULL);
	for (guint i = 0; i < g->scans->len; i++) {
		const struct placed_scan *p = &g_array_index(g->scans, struct placed_scan, i);
		g_autoptr(scan_data) d = scan_data_peek(all->site, p->number, error);
		if (!d)
			return false;
		struct segment_scan scan = { p->number, p->group ? p->group : -(int64_t)p->number,
			p->group ? p->pose : POSE_IDENTITY, state_of(all->site, d, &p->pose) };
		if (p->group && d->has_given_pose)
			g_hash_table_add(given, GUINT_TO_POINTER(p->group));
		g_array_append_val(all->scans, scan);
	}
	for (guint i = 0; i < all->scans->len; i++) {
		struct segment_scan *scan = &g_array_index(all->scans, struct segment_scan, i);
		if (scan->frame > 0 &&
			g_hash_table_contains(given, GUINT_TO_POINTER((guint)scan->frame)))
			scan->frame = 0;
	}
	return true;
}

segment_scans *segment_scans_new(const site *s, const scan_graph *g, GError **error)
{
	g_autoptr(segment_scans) all = g_new0(segment_scans, 1);
	all->site = s;
	all->scans = g_array_new(FALSE, TRUE, sizeof(struct segment_scan));
	g_array_set_clear_func(all->scans, clear_scan);
	all->cache = scan_cache_new(s, CACHED);
	return find_scans(all, g, error) ? g_steal_pointer(&all) : NULL;
}

void segment_scans_free(segment_scans *s)
{
	if (!s)
		return;
	g_array_unref(s->scans);
	scan_cache_free(s->cache);
	scan_geometry_free(s->geometry);
	g_free(s->label);
	g_free(s);
}

static uint8_t *labels_of(const points *p)
{
	uint8_t *label = g_malloc(p->count + 1);
	for (uint64_t i = 0; i < p->count; i++) {
		int class = segment_class_from_las(p->record[i].classification);
		label[i] = class < 0 ? LABEL_NONE : (uint8_t) class;
	}
	return label;
}

static bool open_geometry(segment_scans *s, const scan_data *d, uint64_t count, GError **error)
{
	g_autoptr(GError) missing = NULL;
	scan_geometry_free(s->geometry);
	s->geometry = scan_geometry_open(s->site, d->number, &missing);
	if (!s->geometry && !g_error_matches(missing, G_IO_ERROR, G_IO_ERROR_NOT_FOUND)) {
		g_propagate_error(error, g_steal_pointer(&missing));
		return false;
	}
	if (!s->geometry || s->geometry->count == count)
		return true;
	g_set_error(error, PRODUCT_ERROR, PRODUCT_ERROR_DAMAGED,
		"%s: is of %" G_GUINT64_FORMAT " points, but the scan has %" G_GUINT64_FORMAT,
		product_path(s->geometry->file), s->geometry->count, count);
	return false;
}

bool segment_scans_open(segment_scans *s, guint i, struct segmentation_scan *ret, GError **error)
{
	const struct segment_scan *scan = segment_scans_at(s, i);
	const scan_data *d = scan_cache_load(s->cache, scan->number, error);
	if (!d ||
		!open_geometry(s, d, d->grid ? range_grid_cells(d->grid) : d->points->count, error))
		return false;
	g_clear_pointer(&s->label, g_free);
	bool count = s->labels == LABELS_ALL || (s->labels == LABELS_OF_LAS && d->is_las);
	if (count && d->points && d->points->have & POINTS_HAVE_CLASSIFICATION)
		s->label = labels_of(d->points);
	*ret = (struct segmentation_scan){ .points = scan_points_of(d, s->geometry, &scan->pose),
		.has_station = d->grid != NULL,
		.label = s->label };
	memcpy(ret->station_m, scan->pose.translation_m, sizeof ret->station_m);
	return true;
}
