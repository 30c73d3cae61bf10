#include "process/model-overlaps.h"
#include "process/overlap.h"
#include <json-glib/json-glib.h>
#include <string.h>

#define KIND    "overlap"
#define VERSION 1

char *model_part_path(const site *s, uint32_t number, const char *ending)
{
	return g_strdup_printf("%s/model/parts/%04u.%s", site_path(s), number, ending);
}

/* ---- files ---- */

static void pack_bits(const uint8_t *bytes, uint64_t count, uint64_t *words)
{
	for (uint64_t i = 0; i < count; i++)
		words[i / 64] |= (uint64_t)(bytes[i] & 1) << i % 64;
}

/* compared: of every scan that it was compared with, its key. */
static bool save(const site *s, const struct model_input *input, const uint8_t *dropped,
	uint64_t cells, double reach_m, GHashTable *compared, GError **error)
{
	g_autofree char *path = model_part_path(s, input->number, "overlap");
	g_autoptr(product_writer) w = product_writer_new(path, error);
	g_autofree uint64_t *words = g_new0(uint64_t, cells / 64 + 1);
	pack_bits(dropped, cells, words);
	if (!w || !product_writer_begin(w, "dropped", sizeof *words, error) ||
		!product_writer_append(w, words, cells / 64 + 1, error))
		return false;
	JsonObject *made = json_object_new();
	JsonArray *keys = json_array_new();
	g_autoptr(GList) sorted =
		g_list_sort(g_hash_table_get_keys(compared), (GCompareFunc)strcmp);
	for (GList *k = sorted; k; k = k->next)
		json_array_add_string_element(keys, k->data);
	json_object_set_string_member(made, "key", input->key);
	json_object_set_int_member(made, "cells", (gint64)cells);
	json_object_set_double_member(made, "reach_m", reach_m);
	json_object_set_array_member(made, "compared", keys);
	return product_writer_finish(w, KIND, VERSION, made, error);
}

/* The file when it is of these inputs, else NULL: then it is made anew, whatever was wrong with it. */
static product *open_current(const site *s, const struct model_input *input, uint64_t *ret_cells)
{
	g_autofree char *path = model_part_path(s, input->number, "overlap");
	g_autoptr(product) p = product_open(path, KIND, VERSION, NULL);
	JsonObject *m = p ? product_manifest(p) : NULL;
	uint64_t words;
	if (!m || !product_section(p, "dropped", sizeof(uint64_t), &words, NULL) ||
		!product_verify(p, NULL) || !json_object_has_member(m, "compared") ||
		g_strcmp0(json_object_get_string_member_with_default(m, "key", ""), input->key))
		return NULL;
	*ret_cells = (uint64_t)json_object_get_int_member_with_default(m, "cells", -1);
	return words == *ret_cells / 64 + 1 ? g_steal_pointer(&p) : NULL;
}

static uint8_t *bits_of(const product *p, uint64_t cells)
{
	uint64_t words;
	const uint64_t *bits = product_section(p, "dropped", sizeof *bits, &words, NULL);
	uint8_t *bytes = g_malloc(cells + 1);
	for (uint64_t i = 0; i < cells; i++)
		bytes[i] = bits[i / 64] >> i % 64 & 1;
	return bytes;
}

product *model_overlaps_open(const site *s, const struct model_input *input,
	const uint64_t **ret_dropped, uint64_t *ret_words)
{
	uint64_t cells;
	product *p = open_current(s, input, &cells);
	*ret_dropped = p ? product_section(p, "dropped", sizeof(uint64_t), ret_words, NULL) : NULL;
	return p;
}

/* ---- what is to be done ---- */

struct target {
	const struct model_input *input;
	GHashTable *compared; /* keys of the scans that its bits already know */
	uint8_t *dropped;
	uint64_t cells;
	double reach_m; /* of the scan; negative: not known before it is loaded */
	bool is_due;
	overlap_scan *scan; /* while it is in memory */
};

static void clear_target(gpointer data)
{
	struct target *t = data;
	g_clear_pointer(&t->compared, g_hash_table_unref);
	g_free(t->dropped);
	overlap_scan_free(t->scan);
}

static struct target *target_at(const GArray *targets, guint i)
{
	return &g_array_index(targets, struct target, i);
}

static bool is_known(const GArray *targets, const char *key)
{
	for (guint i = 0; i < targets->len; i++)
		if (strcmp(target_at(targets, i)->input->key, key) == 0)
			return true;
	return false;
}

/* A file that knows a scan which is no more, or elsewhere, is of no use: what that one dropped may have to come back. */
static void take_compared(struct target *t, const GArray *targets, const product *p)
{
	JsonNode *node = json_object_get_member(product_manifest(p), "compared");
	JsonArray *keys = JSON_NODE_HOLDS_ARRAY(node) ? json_node_get_array(node) : NULL;
	for (guint i = 0; keys && i < json_array_get_length(keys); i++) {
		JsonNode *k = json_array_get_element(keys, i);
		const char *key = JSON_NODE_HOLDS_VALUE(k) ? json_node_get_string(k) : NULL;
		if (!key || !is_known(targets, key)) {
			g_hash_table_remove_all(t->compared);
			return;
		}
		g_hash_table_add(t->compared, g_strdup(key));
	}
}

static void look_what_is_there(const site *s, struct target *t, const GArray *targets)
{
	uint64_t cells;
	g_autoptr(product) p = open_current(s, t->input, &cells);
	t->compared = g_hash_table_new_full(g_str_hash, g_str_equal, g_free, NULL);
	t->reach_m =
		p ? json_object_get_double_member_with_default(product_manifest(p), "reach_m", -1)
		  : -1;
	if (p)
		take_compared(t, targets, p);
	/* A scan that stands alone needs a file too. */
	t->is_due = !p || g_hash_table_size(t->compared) != targets->len - 1;
}

static GArray *targets_new(const site *s, const model_inputs *inputs)
{
	GArray *targets = g_array_new(FALSE, TRUE, sizeof(struct target));
	g_array_set_clear_func(targets, clear_target);
	for (guint i = 0; i < inputs->scans->len; i++) {
		struct target t = { .input = model_inputs_at(inputs, i) };
		if (t.input->kind != SCAN_CLOUD)
			g_array_append_val(targets, t);
	}
	for (guint i = 0; i < targets->len; i++)
		look_what_is_there(s, target_at(targets, i), targets);
	return targets;
}

/* ---- the work ---- */

static overlap_scan *load_scan(const site *s, const struct model_input *input, GError **error)
{
	g_autoptr(scan_data) d = scan_data_load(s, input->number, error);
	g_autoptr(scan_geometry) g = NULL;
	if (!d || !model_input_geometry(s, input, d, &g, error))
		return NULL;
	overlap_scan *scan = overlap_scan_new(input->number, d->grid, g);
	scan->pose = input->pose;
	return scan;
}

/* When few scans are new it pays to look how far they reach before all others are loaded. */
static bool learn_reaches(const site *s, const GArray *targets, GError **error)
{
	guint unknown = 0;
	for (guint i = 0; i < targets->len; i++)
		unknown += target_at(targets, i)->reach_m < 0;
	for (guint i = 0; i < targets->len && 2 * unknown < targets->len; i++) {
		struct target *t = target_at(targets, i);
		if (t->reach_m >= 0)
			continue;
		overlap_scan *scan = load_scan(s, t->input, error);
		if (!scan)
			return false;
		t->reach_m = scan->reach_m;
		/* A single new one is compared with each of the others: it stays. */
		t->scan = unknown == 1 && t->is_due ? scan : NULL;
		if (!t->scan)
			overlap_scan_free(scan);
	}
	return true;
}

/* Reaches become known as scans are loaded. */
static bool are_apart(const struct target *a, const struct target *b)
{
	overlap_scan of_a = { .pose = a->input->pose, .reach_m = a->reach_m };
	overlap_scan of_b = { .pose = b->input->pose, .reach_m = b->reach_m };
	return a->reach_m >= 0 && b->reach_m >= 0 && !overlap_is_possible(&of_a, &of_b);
}

/* Scans that are too far away need no comparing, so a target that lacks no other is done without being loaded. */
static bool pass_over_distant(
	const site *s, const GArray *targets, struct target *t, GError **error)
{
	uint64_t cells;
	g_autoptr(product) p = t->is_due ? open_current(s, t->input, &cells) : NULL;
	if (!p || !g_hash_table_size(t->compared))
		return true;
	for (guint j = 0; j < targets->len; j++) {
		const struct target *other = target_at(targets, j);
		if (other != t && are_apart(t, other))
			g_hash_table_add(t->compared, g_strdup(other->input->key));
	}
	if (g_hash_table_size(t->compared) != targets->len - 1)
		return true;
	t->is_due = false;
	g_clear_pointer(&t->scan, overlap_scan_free);
	g_autofree uint8_t *dropped = bits_of(p, cells);
	return save(s, t->input, dropped, cells, t->reach_m, t->compared, error);
}

static bool prepare(const site *s, const GArray *targets, GError **error)
{
	if (!learn_reaches(s, targets, error))
		return false;
	for (guint i = 0; i < targets->len; i++)
		if (!pass_over_distant(s, targets, target_at(targets, i), error))
			return false;
	return true;
}

static bool open_target(const site *s, struct target *t, GError **error)
{
	uint64_t cells = 0;
	g_autoptr(product) p = open_current(s, t->input, &cells);
	if (!t->scan && !(t->scan = load_scan(s, t->input, error)))
		return false;
	t->reach_m = t->scan->reach_m;
	t->cells = (uint64_t)t->scan->columns * t->scan->rows;
	bool goes_on = p && cells == t->cells && g_hash_table_size(t->compared);
	if (!goes_on)
		g_hash_table_remove_all(t->compared);
	t->dropped = goes_on ? bits_of(p, cells) : g_malloc0(t->cells + 1);
	return true;
}

/* Targets from first on that are due, as many as the memory holds, at least one. *ret_end: behind the last. */
static bool open_block(const site *s, GArray *targets, guint first, uint64_t memory_bytes,
	guint *ret_end, GError **error)
{
	uint64_t bytes = 0;
	guint i = first;
	for (; i < targets->len && bytes < memory_bytes; i++) {
		struct target *t = target_at(targets, i);
		if (!t->is_due)
			continue;
		if (!open_target(s, t, error))
			return false;
		bytes += overlap_scan_bytes(t->scan) + t->cells;
	}
	*ret_end = i;
	return true;
}

/* Whether a target of the block has to look at the points of the other. One that is known to be too far away counts as seen. */
static bool is_wanted(const GArray *targets, guint first, guint end, const struct target *other)
{
	bool wanted = false;
	for (guint i = first; i < end; i++) {
		const struct target *t = target_at(targets, i);
		if (!t->scan || t == other)
			continue;
		if (are_apart(t, other))
			g_hash_table_add(t->compared, g_strdup(other->input->key));
		wanted |= !g_hash_table_contains(t->compared, other->input->key);
	}
	return wanted;
}

/* Each target of the block against one other scan. */
static bool compare_with(const site *s, GArray *targets, guint first, guint end,
	struct target *other, GError **error)
{
	g_autoptr(overlap_scan) loaded = NULL;
	if (!is_wanted(targets, first, end, other))
		return true;
	if (!other->scan && !(loaded = load_scan(s, other->input, error)))
		return false;
	const overlap_scan *b = other->scan ? other->scan : loaded;
	other->reach_m = b->reach_m;
	for (guint i = first; i < end; i++) {
		struct target *t = target_at(targets, i);
		if (!t->scan || t == other ||
			!g_hash_table_add(t->compared, g_strdup(other->input->key)))
			continue;
		if (overlap_is_possible(t->scan, b))
			overlap_mark(t->scan, b, NULL, t->dropped);
	}
	return true;
}

static bool close_block(const site *s, GArray *targets, guint first, guint end, GError **error)
{
	for (guint i = first; i < end; i++) {
		struct target *t = target_at(targets, i);
		if (t->scan && !save(s, t->input, t->dropped, t->cells, t->scan->reach_m,
				       t->compared, error))
			return false;
		g_clear_pointer(&t->scan, overlap_scan_free);
		g_clear_pointer(&t->dropped, g_free);
	}
	return true;
}

static bool do_block(const site *s, GArray *targets, guint first, guint *ret_end,
	const struct build_progress *progress, GError **error)
{
	if (!open_block(s, targets, first, build_memory(progress->options) / 2, ret_end, error))
		return false;
	double share = (double)(*ret_end - first) / targets->len;
	for (guint j = 0; j < targets->len; j++) {
		double done = (double)first / targets->len + share * j / targets->len;
		if (!build_progress_step(progress, done, "comparing scans", error) ||
			!compare_with(s, targets, first, *ret_end, target_at(targets, j), error))
			return false;
	}
	return close_block(s, targets, first, *ret_end, error);
}

bool model_overlaps_update(const site *s, const model_inputs *inputs,
	const struct build_progress *progress, GError **error)
{
	g_autoptr(GArray) targets = targets_new(s, inputs);
	if (!prepare(s, targets, error))
		return false;
	for (guint first = 0; first < targets->len;)
		if (!do_block(s, targets, first, &first, progress, error))
			return false;
	return true;
}
