#include "process/segment-site.h"
#include "firmware-io/files.h"
#include "process/scan-cache.h"
#include "process/segmentation.h"
#include <glib/gstdio.h>
#include <math.h>
#include <string.h>

/* Rises when the same inputs give other segments. */
#define METHOD     1
#define CACHED     4
#define GAP_MOST_M 100

/* ---- what goes in ---- */

struct member {
	uint32_t number;
	int64_t frame; /* scans of the same stand in one; below 0: alone */
	struct pose pose;
	enum scan_kind kind;
	char *state; /* of its points, its geometry and its pose */
};

static void clear_member(gpointer data)
{
	g_free(((struct member *)data)->state);
}

static struct member *member_at(const GArray *members, guint i)
{
	return &g_array_index(members, struct member, i);
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
static GArray *find_members(const site *s, const scan_graph *g, GError **error)
{
	g_autoptr(GArray) members = g_array_new(FALSE, TRUE, sizeof(struct member));
	g_autoptr(GHashTable) given = g_hash_table_new(NULL, NULL);
	g_array_set_clear_func(members, clear_member);
	for (guint i = 0; i < g->scans->len; i++) {
		const struct placed_scan *p = &g_array_index(g->scans, struct placed_scan, i);
		g_autoptr(scan_data) d = scan_data_peek(s, p->number, error);
		if (!d)
			return NULL;
		struct member m = { p->number, p->group ? p->group : -(int64_t)p->number,
			p->group ? p->pose : POSE_IDENTITY, d->kind, state_of(s, d, &p->pose) };
		if (p->group && d->has_given_pose)
			g_hash_table_add(given, GUINT_TO_POINTER(p->group));
		g_array_append_val(members, m);
	}
	for (guint i = 0; i < members->len; i++) {
		struct member *m = member_at(members, i);
		if (m->frame > 0 && g_hash_table_contains(given, GUINT_TO_POINTER((guint)m->frame)))
			m->frame = 0;
	}
	return g_steal_pointer(&members);
}

struct parameters {
	double gap_m;
	int64_t points_min;
	bool labels;
};

static bool read_parameters(const site *s, struct parameters *ret, GError **error)
{
	const manifest *m = site_manifest(s);
	*ret = (struct parameters){ .labels = true };
	JsonNode *labels = manifest_get_node(m, "segmentation.labels");
	ret->labels = !labels || !JSON_NODE_HOLDS_VALUE(labels) || json_node_get_boolean(labels);
	return (!manifest_has(m, "segmentation.gap_m") ||
		       manifest_get_number(
			       m, "segmentation.gap_m", 0.01, GAP_MOST_M, &ret->gap_m, error)) &&
	       (!manifest_has(m, "segmentation.points_min") ||
		       manifest_get_int(m, "segmentation.points_min", 1, G_MAXUINT32,
			       &ret->points_min, error));
}

static char *key_of(const GArray *members, const struct parameters *p)
{
	g_autoptr(GString) text = g_string_new(NULL);
	g_string_printf(text, "%s %d %d %.9g %" G_GINT64_FORMAT " %d", SCAN_SEGMENTS_KIND,
		SCAN_SEGMENTS_VERSION, METHOD, p->gap_m, p->points_min, p->labels);
	for (guint i = 0; i < members->len; i++)
		g_string_append_printf(text, "\n%u %" G_GINT64_FORMAT " %s",
			member_at(members, i)->number, member_at(members, i)->frame,
			member_at(members, i)->state);
	return g_compute_checksum_for_string(G_CHECKSUM_SHA256, text->str, -1);
}

/* ---- one frame ---- */

struct maker {
	site *site;
	const struct segment_site_options *options;
	const struct parameters *parameters;
	GArray *members;
	GArray *frame; /* of guint: the members that are segmented now */
	scan_cache *cache;
	scan_geometry *geometry; /* of the scan that was opened last */
	uint8_t *label;
	segments *tree;
	const char *key;
	double from, to; /* of the whole */
};

static uint8_t *labels_of(const points *p)
{
	uint8_t *label = g_malloc(p->count + 1);
	for (uint64_t i = 0; i < p->count; i++) {
		int class = segment_class_from_las(p->record[i].classification);
		label[i] = class < 0 ? LABEL_NONE : (uint8_t) class;
	}
	return label;
}

static bool open_geometry(struct maker *m, const scan_data *d, uint64_t count, GError **error)
{
	g_autoptr(GError) missing = NULL;
	scan_geometry_free(m->geometry);
	m->geometry = scan_geometry_open(m->site, d->number, &missing);
	if (!m->geometry && !g_error_matches(missing, G_IO_ERROR, G_IO_ERROR_NOT_FOUND)) {
		g_propagate_error(error, g_steal_pointer(&missing));
		return false;
	}
	if (!m->geometry || m->geometry->count == count)
		return true;
	g_set_error(error, PRODUCT_ERROR, PRODUCT_ERROR_DAMAGED,
		"%s: is of %" G_GUINT64_FORMAT " points, but the scan has %" G_GUINT64_FORMAT,
		product_path(m->geometry->file), m->geometry->count, count);
	return false;
}

static bool open_scan(gpointer user_data, size_t i, struct segmentation_scan *ret, GError **error)
{
	struct maker *m = user_data;
	const struct member *member = member_at(m->members, g_array_index(m->frame, guint, i));
	const scan_data *d = scan_cache_load(m->cache, member->number, error);
	if (!d ||
		!open_geometry(m, d, d->grid ? range_grid_cells(d->grid) : d->points->count, error))
		return false;
	g_clear_pointer(&m->label, g_free);
	if (d->points && d->points->have & POINTS_HAVE_CLASSIFICATION && m->parameters->labels)
		m->label = labels_of(d->points);
	*ret = (struct segmentation_scan){ .points = scan_points_of(d, m->geometry, &member->pose),
		.has_station = d->grid != NULL,
		.label = m->label };
	memcpy(ret->station_m, member->pose.translation_m, sizeof ret->station_m);
	return true;
}

static bool tell_progress(double fraction, const char *doing, gpointer user_data)
{
	const struct maker *m = user_data;
	return !m->options || !m->options->progress ||
	       m->options->progress(
		       m->from + fraction * (m->to - m->from), doing, m->options->user_data);
}

/* Boxes and numbers of points by leaf. */
struct leaf_sum {
	uint64_t points;
	double low_m[3], high_m[3];
};

static void count_leaves(segments *tree, const struct scan_points *p, const uint16_t *leaf)
{
	g_autofree struct leaf_sum *sum = g_new(struct leaf_sum, SEGMENTS_MAX + 1);
	for (uint32_t k = 0; k <= SEGMENTS_MAX; k++)
		sum[k] = (struct leaf_sum){ 0, { INFINITY, INFINITY, INFINITY },
			{ -INFINITY, -INFINITY, -INFINITY } };
	for (uint64_t i = 0; i < p->count; i++) {
		double at[3];
		if (leaf[i] == SEGMENT_NONE)
			continue;
		struct leaf_sum *s = &sum[leaf[i]];
		scan_points_position(p, i, at);
		s->points++;
		for (int k = 0; k < 3; k++) {
			s->low_m[k] = fmin(s->low_m[k], at[k]);
			s->high_m[k] = fmax(s->high_m[k], at[k]);
		}
	}
	for (uint32_t k = 1; k <= SEGMENTS_MAX; k++)
		if (sum[k].points)
			segments_count(tree, k, sum[k].points, sum[k].low_m, sum[k].high_m, 0);
}

static bool label_scans(struct maker *m, const segmentation *seg, GError **error)
{
	for (guint i = 0; i < m->frame->len; i++) {
		struct segmentation_scan scan;
		if (!open_scan(m, i, &scan, error))
			return false;
		g_autofree uint16_t *leaf = g_new(uint16_t, scan.points.count + 1);
		if (!tell_progress(0.7 + 0.3 * i / m->frame->len, "labelling points", m)) {
			g_set_error(error, G_IO_ERROR, G_IO_ERROR_CANCELLED,
				"stopped while labelling points");
			return false;
		}
		segmentation_label(seg, &scan, leaf);
		count_leaves(m->tree, &scan.points, leaf);
		if (!scan_segments_write(m->site, scan.points.data->number, m->key, leaf, leaf,
			    scan.points.count, error))
			return false;
	}
	return true;
}

static bool segment_frame(struct maker *m, GError **error)
{
	struct segmentation_source source = { m->frame->len, open_scan, m };
	struct segmentation_options options = { m->parameters->gap_m,
		(uint32_t)m->parameters->points_min, tell_progress, m };
	g_autoptr(segmentation) seg = segmentation_new(&source, &options, m->tree, error);
	return seg && label_scans(m, seg, error);
}

/* ---- the site ---- */

static void remove_empty_leaves(segments *tree)
{
	for (guint i = tree->nodes->len; i--;) {
		const struct segment *node = &g_array_index(tree->nodes, struct segment, i);
		if (node->id >= SEGMENT_FIRST && !node->points && segments_is_leaf(tree, node->id))
			segments_remove(tree, node->id);
	}
}

static bool segment_frames(struct maker *m, GError **error)
{
	g_autofree bool *done = g_new0(bool, m->members->len + 1);
	guint finished = 0;
	for (guint i = 0; i < m->members->len; i++) {
		if (done[i])
			continue;
		g_array_set_size(m->frame, 0);
		for (guint k = i; k < m->members->len; k++)
			if (member_at(m->members, k)->frame == member_at(m->members, i)->frame) {
				done[k] = true;
				g_array_append_val(m->frame, k);
			}
		m->from = (double)finished / m->members->len;
		finished += m->frame->len;
		m->to = (double)finished / m->members->len;
		if (!segment_frame(m, error))
			return false;
	}
	remove_empty_leaves(m->tree);
	return true;
}

static bool remove_strangers(const struct maker *m, GError **error)
{
	g_autofree char *folder = g_build_filename(site_path(m->site), "segments", NULL);
	g_autoptr(GPtrArray) names = files_names(folder, error);
	for (guint i = 0; names && i < names->len; i++) {
		g_autofree char *path = g_build_filename(folder, names->pdata[i], NULL);
		bool is_ours = !g_str_has_suffix(path, ".segments");
		for (guint k = 0; k < m->members->len; k++)
			is_ours |= g_ascii_strtoull(names->pdata[i], NULL, 10) ==
				   member_at(m->members, k)->number;
		if (!is_ours && g_unlink(path))
			return files_fail(error, path, "remove");
	}
	return names;
}

static void sum_up(const segments *tree, struct segment_site_result *ret)
{
	*ret = (struct segment_site_result){ 0 };
	for (guint i = 0; i < tree->nodes->len; i++) {
		const struct segment *node = &g_array_index(tree->nodes, struct segment, i);
		ret->things += node->points && segments_is_leaf(tree, node->id);
		if (node->id == SEGMENT_SITE)
			ret->points = node->points;
		else if (node->parent == SEGMENT_SITE)
			ret->class_points[node->class] = node->points;
	}
}

static void maker_clear(struct maker *m)
{
	g_array_unref(m->frame);
	scan_cache_free(m->cache);
	scan_geometry_free(m->geometry);
	g_free(m->label);
	segments_free(m->tree);
}

bool segment_site(site *s, const scan_graph *g, const struct segment_site_options *options,
	struct segment_site_result *ret, GError **error)
{
	struct parameters parameters;
	g_autoptr(GArray) members = find_members(s, g, error);
	g_autofree char *folder = g_build_filename(site_path(s), "segments", NULL);
	if (!members || !read_parameters(s, &parameters, error) ||
		!files_make_folder(folder, error))
		return false;
	g_autofree char *key = key_of(members, &parameters);
	struct maker m = { .site = s,
		.options = options,
		.parameters = &parameters,
		.members = members,
		.frame = g_array_new(FALSE, FALSE, sizeof(guint)),
		.cache = scan_cache_new(s, CACHED),
		.tree = segments_new(),
		.key = key };
	m.tree->key = (g_free(m.tree->key), g_strdup(key));
	bool good = segment_frames(&m, error) && remove_strangers(&m, error) &&
		    segments_save(m.tree, site_path(s), error);
	if (good)
		sum_up(m.tree, ret);
	maker_clear(&m);
	return good;
}

/* A few words; NULL: nothing is due. */
static char *why_due(const site *s, const GArray *members, const char *key)
{
	g_autoptr(GError) damage = NULL;
	g_autoptr(segments) tree = segments_load(site_path(s), &damage);
	if (!members->len)
		return NULL;
	if (g_error_matches(damage, G_IO_ERROR, G_IO_ERROR_NOT_FOUND))
		return g_strdup("there are no segments yet");
	if (!tree)
		return g_strdup("the segments cannot be read");
	if (strcmp(tree->key, key))
		return g_strdup("scans, or how to tell things apart, have changed");
	for (guint i = 0; i < members->len; i++) {
		g_autofree char *own = scan_segments_key(s, member_at(members, i)->number);
		if (g_strcmp0(own, key))
			return g_strdup_printf("the segments of scan %u cannot be read",
				member_at(members, i)->number);
	}
	return NULL;
}

bool segment_site_is_due(
	const site *s, const scan_graph *g, bool *ret_due, char **ret_why, GError **error)
{
	struct parameters parameters;
	g_autoptr(GArray) members = find_members(s, g, error);
	if (!members || !read_parameters(s, &parameters, error))
		return false;
	g_autofree char *key = key_of(members, &parameters);
	*ret_why = why_due(s, members, key);
	*ret_due = *ret_why;
	return true;
}
