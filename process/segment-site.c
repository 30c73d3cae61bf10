#include "process/segment-site.h"
#include "firmware-io/files.h"
#include "process/segment-model.h"
#include "process/segment-names.h"
#include "process/segment-numbers.h"
#include "process/segment-state.h"
#include <glib/gstdio.h>
#include <json-glib/json-glib.h>
#include <math.h>
#include <string.h>

/* Rises when the same inputs give other segments. */
#define METHOD     4
#define GAP_MOST_M 100

/* ---- what goes in ---- */

struct parameters {
	double gap_m;
	int64_t points_min;
	enum segment_labels labels;
	char *model, *model_state; /* NULL: none */
	double confidence;
};

static void parameters_clear(struct parameters *p)
{
	g_free(p->model);
	g_free(p->model_state);
}
typedef struct parameters parameters;
G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC(parameters, parameters_clear)

static bool read_labels(const manifest *m, enum segment_labels *ret, GError **error)
{
	JsonNode *node = manifest_get_node(m, "segmentation.labels");
	*ret = LABELS_OF_LAS;
	if (!node)
		return true;
	if (JSON_NODE_HOLDS_VALUE(node) && json_node_get_value_type(node) == G_TYPE_BOOLEAN) {
		*ret = json_node_get_boolean(node) ? LABELS_ALL : LABELS_NONE;
		return true;
	}
	g_set_error(error, MANIFEST_ERROR, MANIFEST_ERROR_VALUE,
		"%s: 'segmentation.labels' is neither true nor false", manifest_path(m));
	return false;
}

/* A path that is not absolute is one in the site's folder. */
static bool read_model(const site *s, struct parameters *ret, GError **error)
{
	const manifest *m = site_manifest(s);
	ret->confidence = SEGMENT_MODEL_CONFIDENCE;
	if (!manifest_has(m, "segmentation.model"))
		return true;
	const char *path = manifest_get_string(m, "segmentation.model", error);
	if (!path || (manifest_has(m, "segmentation.confidence") &&
			     !manifest_get_number(
				     m, "segmentation.confidence", 0, 1, &ret->confidence, error)))
		return false;
	ret->model = g_path_is_absolute(path) ? g_strdup(path)
					      : g_build_filename(site_path(s), path, NULL);
	ret->model_state = segment_model_fingerprint(ret->model, error);
	return ret->model_state;
}

static bool read_parameters(const site *s, struct parameters *ret, GError **error)
{
	const manifest *m = site_manifest(s);
	*ret = (struct parameters){ 0 };
	return read_labels(m, &ret->labels, error) && read_model(s, ret, error) &&
	       (!manifest_has(m, "segmentation.gap_m") ||
		       manifest_get_number(
			       m, "segmentation.gap_m", 0.01, GAP_MOST_M, &ret->gap_m, error)) &&
	       (!manifest_has(m, "segmentation.points_min") ||
		       manifest_get_int(m, "segmentation.points_min", 1, G_MAXUINT32,
			       &ret->points_min, error));
}

static char *key_of(const segment_scans *scans, const struct parameters *p)
{
	g_autoptr(GString) text = g_string_new(NULL);
	g_string_printf(text, "%s %d %d %.9g %" G_GINT64_FORMAT " %d", SCAN_SEGMENTS_KIND,
		SCAN_SEGMENTS_VERSION, METHOD, p->gap_m, p->points_min, p->labels);
	if (p->model)
		g_string_append_printf(text, " %s %.9g", p->model_state, p->confidence);
	for (guint i = 0; i < scans->scans->len; i++) {
		const struct segment_scan *scan = segment_scans_at(scans, i);
		g_string_append_printf(text, "\n%u %" G_GINT64_FORMAT " %s", scan->number,
			scan->frame, scan->state);
	}
	return g_compute_checksum_for_string(G_CHECKSUM_SHA256, text->str, -1);
}

/* ---- one frame ---- */

/* The leaf of each cell or point of a scan. */
struct found {
	uint64_t count;
	uint16_t *leaf;
};

static void found_clear(gpointer data)
{
	g_free(((struct found *)data)->leaf);
}

struct maker {
	site *site;
	const struct segment_site_options *options;
	const struct parameters *parameters;
	segment_scans *scans;
	GArray *frame; /* of guint: the scans that are segmented now */
	segments *tree;
	GArray *found;        /* of struct found, of scans, in their order */
	segment_model *model; /* NULL: none */
	double from, to;      /* of the whole */
};

static struct found *found_at(const struct maker *m, guint i)
{
	return &g_array_index(m->found, struct found, i);
}

static bool open_scan(gpointer user_data, size_t i, struct segmentation_scan *ret, GError **error)
{
	struct maker *m = user_data;
	return segment_scans_open(m->scans, g_array_index(m->frame, guint, i), ret, error);
}

static bool tell_progress(double fraction, const char *doing, gpointer user_data)
{
	const struct maker *m = user_data;
	return !m->options || !m->options->progress ||
	       m->options->progress(
		       m->from + fraction * (m->to - m->from), doing, m->options->user_data);
}

/* Boxes and numbers of points by leaf. */
struct leaf_box {
	uint64_t points;
	double low_m[3], high_m[3];
};

static struct leaf_box *leaf_boxes_new(void)
{
	struct leaf_box *ret = g_new(struct leaf_box, SEGMENTS_MAX + 1);
	for (uint32_t k = 0; k <= SEGMENTS_MAX; k++)
		ret[k] = (struct leaf_box){ 0, { INFINITY, INFINITY, INFINITY },
			{ -INFINITY, -INFINITY, -INFINITY } };
	return ret;
}

static void add_box(
	struct leaf_box *to, uint64_t count, const double low_m[3], const double high_m[3])
{
	to->points += count;
	for (int k = 0; k < 3; k++) {
		to->low_m[k] = fmin(to->low_m[k], low_m[k]);
		to->high_m[k] = fmax(to->high_m[k], high_m[k]);
	}
}

static void count_leaves(segments *tree, const struct scan_points *p, const uint16_t *leaf)
{
	g_autofree struct leaf_box *all = leaf_boxes_new();
#pragma omp parallel
	{
		g_autofree struct leaf_box *own = leaf_boxes_new();
#pragma omp for schedule(static) nowait
		for (uint64_t i = 0; i < p->count; i++) {
			double at[3];
			if (leaf[i] == SEGMENT_NONE)
				continue;
			scan_points_position(p, i, at);
			add_box(&own[leaf[i]], 1, at, at);
		}
#pragma omp critical
		for (uint32_t k = 1; k <= SEGMENTS_MAX; k++)
			add_box(&all[k], own[k].points, own[k].low_m, own[k].high_m);
	}
	for (uint32_t k = 1; k <= SEGMENTS_MAX; k++)
		if (all[k].points)
			segments_count(tree, k, all[k].points, all[k].low_m, all[k].high_m, 0);
}

static bool label_scans(struct maker *m, const segmentation *seg, GError **error)
{
	for (guint i = 0; i < m->frame->len; i++) {
		struct segmentation_scan scan;
		if (!open_scan(m, i, &scan, error))
			return false;
		if (!tell_progress(0.7 + 0.3 * i / m->frame->len, "labelling points", m)) {
			g_set_error(error, G_IO_ERROR, G_IO_ERROR_CANCELLED,
				"stopped while labelling points");
			return false;
		}
		struct found *found = found_at(m, g_array_index(m->frame, guint, i));
		found->count = scan.points.count;
		found->leaf = g_new(uint16_t, scan.points.count + 1);
		segmentation_label(seg, i, &scan, found->leaf);
		count_leaves(m->tree, &scan.points, found->leaf);
	}
	return true;
}

static bool segment_frame(struct maker *m, GError **error)
{
	struct segmentation_source source = { m->frame->len, open_scan, m };
	struct segmentation_options options = { m->parameters->gap_m,
		(uint32_t)m->parameters->points_min, tell_progress, m,
		m->model ? segment_model_label : NULL, m->model };
	g_autoptr(segmentation) seg = segmentation_new(&source, &options, m->tree, error);
	return seg && label_scans(m, seg, error);
}

/* ---- all frames ---- */

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
	guint count = m->scans->scans->len, finished = 0;
	g_autofree bool *done = g_new0(bool, count + 1);
	for (guint i = 0; i < count; i++) {
		if (done[i])
			continue;
		g_array_set_size(m->frame, 0);
		for (guint k = i; k < count; k++)
			if (segment_scans_at(m->scans, k)->frame ==
				segment_scans_at(m->scans, i)->frame) {
				done[k] = true;
				g_array_append_val(m->frame, k);
			}
		m->from = (double)finished / count;
		finished += m->frame->len;
		m->to = (double)finished / count;
		if (!segment_frame(m, error))
			return false;
	}
	return true;
}

/* What is left is numbered in the order in which it was found. */
static void finish_tree(segments *tree)
{
	remove_empty_leaves(tree);
	for (guint i = 0; i < tree->nodes->len; i++) {
		struct segment *node = &g_array_index(tree->nodes, struct segment, i);
		node->found = node->id < SEGMENT_FIRST ? 0 : node->id;
	}
	tree->next = MAX(g_array_index(tree->nodes, struct segment, tree->nodes->len - 1).id + 1,
		SEGMENT_FIRST);
}

/* ---- numbers of before ---- */

static void count_before(const struct maker *m, segment_numbers *numbers)
{
	for (guint i = 0; i < m->found->len; i++) {
		const struct found *found = found_at(m, i);
		uint32_t number = segment_scans_at(m->scans, i)->number;
		g_autoptr(scan_segments) was = scan_segments_open(m->site, number, NULL);
		if (was && was->count == found->count)
			segment_numbers_count(numbers, was->automatic, found->leaf, found->count);
	}
}

static void take_numbers(struct maker *m, const uint16_t *becomes)
{
	segments_renumber(m->tree, becomes);
	for (guint i = 0; i < m->found->len; i++) {
		struct found *found = found_at(m, i);
		for (uint64_t k = 0; k < found->count; k++)
			found->leaf[k] = becomes[found->leaf[k]];
	}
}

/* Of what is the same as before. Also what people drew has had its numbers, which stand in the tree with their changes; that is
 * good enough too where the other cannot be read. */
static bool keep_numbers(struct maker *m, GError **error)
{
	g_autofree char *path = segments_automatic_path(site_path(m->site));
	g_autoptr(segments) own = segments_load_file(path, NULL);
	g_autoptr(segments) changed = segments_load(site_path(m->site), NULL);
	const segments *was = own ? own : changed;
	g_autofree uint16_t *becomes = g_new(uint16_t, SEGMENTS_MAX + 1);
	if (!was)
		return true;
	uint32_t next = MAX(was->next, changed ? changed->next : 0);
	g_autoptr(segment_numbers) numbers = segment_numbers_new(was, m->tree);
	count_before(m, numbers);
	if (!segment_numbers_find(numbers, &next, becomes)) {
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_NO_SPACE, "there are more than %u things",
			SEGMENTS_MAX - SEGMENT_FIRST);
		return false;
	}
	m->tree->next = SEGMENT_FIRST;
	take_numbers(m, becomes);
	segment_names_keep(was, m->tree);
	m->tree->next = MAX(m->tree->next, next);
	return true;
}

/* ---- the files ---- */

static bool is_ours(const segment_scans *scans, const char *name)
{
	for (guint k = 0; k < scans->scans->len; k++)
		if (g_ascii_strtoull(name, NULL, 10) == segment_scans_at(scans, k)->number)
			return true;
	return !g_str_has_suffix(name, ".segments");
}

/* Files of scans that are there no more. */
static bool remove_strangers(const site *s, const segment_scans *scans, GError **error)
{
	g_autofree char *folder = g_build_filename(site_path(s), "segments", NULL);
	g_autoptr(GPtrArray) names = files_names(folder, error);
	for (guint i = 0; names && i < names->len; i++) {
		g_autofree char *path = g_build_filename(folder, names->pdata[i], NULL);
		if (!is_ours(scans, names->pdata[i]) && g_unlink(path))
			return files_fail(error, path, "remove");
	}
	return names;
}

static bool write_labels(struct maker *m, GError **error)
{
	for (guint i = 0; i < m->found->len; i++) {
		const struct found *found = found_at(m, i);
		uint32_t number = segment_scans_at(m->scans, i)->number;
		if (!scan_segments_write(m->site, number, found->leaf, NULL, found->count, error))
			return false;
		segments_add_labels(
			m->tree, number, scan_segments_checksum(found->leaf, found->count));
	}
	return true;
}

static bool find_all(struct maker *m, GError **error)
{
	g_autofree char *folder = g_build_filename(site_path(m->site), "segments", NULL);
	g_autofree char *path = segments_automatic_path(site_path(m->site));
	if (!files_make_folder(folder, error) || !segment_frames(m, error))
		return false;
	finish_tree(m->tree);
	return keep_numbers(m, error) && write_labels(m, error) &&
	       remove_strangers(m->site, m->scans, error) &&
	       segments_save_file(m->tree, path, error);
}

static bool find_segments(site *s, segment_scans *scans, const struct parameters *p,
	const char *key, const struct segment_site_options *options, GError **error)
{
	g_autoptr(GArray) frame = g_array_new(FALSE, FALSE, sizeof(guint));
	g_autoptr(GArray) found = g_array_new(FALSE, TRUE, sizeof(struct found));
	g_autoptr(segments) tree = segments_new();
	g_autoptr(segment_model) teller =
		p->model ? segment_model_open(p->model, p->confidence, error) : NULL;
	struct maker m = { s, options, p, scans, frame, tree, found, teller, 0, 1 };
	if (p->model && !teller)
		return false;
	g_array_set_clear_func(found, found_clear);
	g_array_set_size(found, scans->scans->len);
	g_free(tree->key);
	tree->key = g_strdup(key);
	return find_all(&m, error);
}

/* ---- what is due ---- */

static segment_scans *find_scans(
	const site *s, const scan_graph *g, struct parameters *p, GError **error)
{
	if (!read_parameters(s, p, error))
		return NULL;
	segment_scans *scans = segment_scans_new(s, g, error);
	if (scans)
		scans->labels = p->labels;
	return scans;
}

/* A few words; NULL: what the computer finds is up to date. */
static char *why_find(const site *s, const segment_scans *scans, const char *key)
{
	g_autoptr(GError) damage = NULL;
	g_autofree char *path = segments_automatic_path(site_path(s));
	if (!scans->scans->len)
		return NULL;
	g_autoptr(segments) tree = segments_load_file(path, &damage);
	if (g_error_matches(damage, G_IO_ERROR, G_IO_ERROR_NOT_FOUND))
		return g_strdup("there are no segments yet");
	if (!tree)
		return g_strdup("the segments cannot be read");
	if (strcmp(tree->key, key))
		return g_strdup("scans, or how to tell things apart, have changed");
	for (guint i = 0; i < scans->scans->len; i++) {
		uint32_t number = segment_scans_at(scans, i)->number;
		g_autoptr(scan_segments) own = scan_segments_open(s, number, NULL);
		if (!own || !product_verify(own->file, NULL))
			return g_strdup_printf("the segments of scan %u cannot be read", number);
		if (!segments_has_labels(tree, number, scan_segments_automatic_checksum(own)))
			return g_strdup_printf("the segments of scan %u are others", number);
	}
	return NULL;
}

/* After why_find has found nothing. */
static char *why_change(
	const site *s, const segment_scans *scans, const char *key, const char *edits)
{
	if (!scans->scans->len)
		return NULL;
	g_autoptr(segments) tree = segments_load(site_path(s), NULL);
	if (!tree)
		return g_strdup("the segments cannot be read");
	if (strcmp(tree->key, key) || strcmp(tree->edits, edits))
		return g_strdup("what you changed is not in them yet");
	for (guint i = 0; i < scans->scans->len; i++) {
		uint32_t number = segment_scans_at(scans, i)->number;
		g_autoptr(scan_segments) own = scan_segments_open(s, number, NULL);
		if (!own || !segments_has_labels(tree, number, scan_segments_leaf_checksum(own)))
			return g_strdup_printf("the segments of scan %u are others", number);
	}
	return NULL;
}

bool segment_site_is_due(
	const site *s, const scan_graph *g, bool *ret_due, char **ret_why, GError **error)
{
	g_auto(parameters) p = { 0 };
	g_autoptr(segment_scans) scans = find_scans(s, g, &p, error);
	g_autoptr(segment_edits) edits = scans ? segment_edits_load(s, error) : NULL;
	if (!edits)
		return false;
	g_autofree char *key = key_of(scans, &p), *done = segment_edits_done(edits);
	*ret_why = why_find(s, scans, key);
	if (!*ret_why)
		*ret_why = why_change(s, scans, key, done);
	*ret_due = *ret_why;
	return true;
}

/* ---- the site ---- */

static void sum_up(const segments *tree, struct segment_site_result *ret)
{
	for (guint i = 0; i < tree->nodes->len; i++) {
		const struct segment *node = &g_array_index(tree->nodes, struct segment, i);
		ret->things += node->points && segments_is_leaf(tree, node->id);
		if (node->id == SEGMENT_SITE)
			ret->points = node->points;
		else if (node->parent == SEGMENT_SITE)
			ret->class_points[node->class] = node->points;
	}
}

static bool change(site *s, segment_scans *scans, const segment_edits *edits,
	struct segment_site_result *ret, GError **error)
{
	g_autofree char *done = segment_edits_done(edits);
	g_autoptr(segments) before = segments_load(site_path(s), NULL);
	g_autoptr(segment_state) state = segment_state_load_automatic(s, scans, error);
	if (!state)
		return false;
	state->tree->next = MAX(state->tree->next, before ? before->next : 0);
	if (!segment_state_apply_all(state, edits, error) ||
		!segment_state_save(state, done, error))
		return false;
	ret->changes_left_out = state->left_out;
	sum_up(state->tree, ret);
	return true;
}

bool segment_site(site *s, const scan_graph *g, const struct segment_site_options *options,
	struct segment_site_result *ret, GError **error)
{
	g_auto(parameters) p = { 0 };
	g_autoptr(segment_scans) scans = find_scans(s, g, &p, error);
	g_autoptr(segment_edits) edits = scans ? segment_edits_load(s, error) : NULL;
	*ret = (struct segment_site_result){ 0 };
	if (!edits || !scans->scans->len)
		return edits;
	g_autofree char *key = key_of(scans, &p), *why = why_find(s, scans, key);
	return (!why || find_segments(s, scans, &p, key, options, error)) &&
	       change(s, scans, edits, ret, error);
}
