#include "process/model-stale.h"
#include <json-glib/json-glib.h>
#include <string.h>

void model_stale_free(model_stale *s)
{
	if (!s)
		return;
	model_free(s->was);
	g_free(s->is_stale);
	g_free(s);
}

uint64_t model_stale_end(const model_stale *s, uint64_t piece)
{
	uint64_t chunks;
	model_chunks(s->was, &chunks);
	return piece + 1 < s->pieces ? s->piece[piece + 1].first_chunk : chunks;
}

/* ---- the model that is there ---- */

static int compare_places(uint32_t leaf_a, uint64_t code_a, uint32_t leaf_b, uint64_t code_b)
{
	int by_leaf = (leaf_a > leaf_b) - (leaf_a < leaf_b);
	return by_leaf ? by_leaf : (code_a > code_b) - (code_a < code_b);
}

static bool are_in_order(const model_stale *s)
{
	uint64_t chunks;
	model_chunks(s->was, &chunks);
	for (uint64_t i = 0; i < s->pieces; i++) {
		const struct model_piece *p = &s->piece[i];
		if (p->first_chunk >= chunks || p->leaf > UINT16_MAX)
			return false;
		if (i == 0 ? p->first_chunk != 0
			   : p->first_chunk <= p[-1].first_chunk ||
					compare_places(p[-1].leaf, p[-1].code, p->leaf, p->code) >=
						0)
			return false;
	}
	return s->pieces > 0;
}

static bool is_on_lattice(const model *m, unsigned level)
{
	JsonObject *made = product_manifest(model_file(m));
	return json_object_get_double_member_with_default(made, "lattice_m", 0) ==
		       morton_cell_m(level) &&
	       json_object_get_int_member_with_default(made, "method", 0) == MODEL_METHOD;
}

/* NULL: nothing of it can be used. */
static model_stale *open_before(const char *path, unsigned level)
{
	g_autoptr(model_stale) s = g_new0(model_stale, 1);
	s->was = model_open_file(path, NULL);
	s->block_shift = model_cube_shift(MODEL_BLOCK_M, morton_cell_m(level));
	if (!s->was || !is_on_lattice(s->was, level) ||
		!(s->piece = product_section(
			  model_file(s->was), "pieces", sizeof *s->piece, &s->pieces, NULL)) ||
		!are_in_order(s))
		return NULL;
	s->is_stale = g_new0(bool, s->pieces);
	return g_steal_pointer(&s);
}

/* What was dropped when it was made. */
struct before {
	JsonArray *scans; /* of the manifest */
	const uint64_t *word, *end;
	uint64_t words, ends;
};

static bool open_dropped(const model *m, struct before *b)
{
	JsonNode *node = json_object_get_member(product_manifest(model_file(m)), "made_from");
	b->scans = node && JSON_NODE_HOLDS_ARRAY(node) ? json_node_get_array(node) : NULL;
	b->word = product_section(model_file(m), "dropped", sizeof *b->word, &b->words, NULL);
	b->end = product_section(model_file(m), "dropped_end", sizeof *b->end, &b->ends, NULL);
	if (!b->scans || !b->word || !b->end || json_array_get_length(b->scans) != b->ends)
		return false;
	for (uint64_t i = 0, last = 0; i < b->ends; last = b->end[i++])
		if (b->end[i] < last || b->end[i] > b->words)
			return false;
	return true;
}

/* Of the scan with this key; negative: it was not in the model. */
static int64_t find_before(const struct before *b, const char *key)
{
	for (guint i = 0; i < b->ends; i++) {
		JsonNode *scan = json_array_get_element(b->scans, i);
		JsonNode *k = JSON_NODE_HOLDS_OBJECT(scan)
				      ? json_object_get_member(json_node_get_object(scan), "key")
				      : NULL;
		if (k && JSON_NODE_HOLDS_VALUE(k) && g_strcmp0(json_node_get_string(k), key) == 0)
			return i;
	}
	return -1;
}

/* ---- what is another now ---- */

static uint64_t piece_at(const model_stale *s, const struct part_point *p)
{
	uint64_t low = 0, high = s->pieces;
	while (high - low > 1) {
		uint64_t middle = low + (high - low) / 2;
		const struct model_piece *q = &s->piece[middle];
		if (compare_places(q->leaf, q->code, p->leaf, p->code) <= 0)
			low = middle;
		else
			high = middle;
	}
	return low;
}

/* A piece whose first block changes may not begin there any more. */
static void mark(model_stale *s, const struct part_point *p)
{
	uint64_t i = piece_at(s, p);
	s->is_stale[i] = true;
	if (i > 0 && s->piece[i].code >> s->block_shift == p->code >> s->block_shift)
		s->is_stale[i - 1] = true;
}

/* was: NULL when the scan is new. */
static bool is_changed(const model_part *p, const uint64_t *was, uint64_t i)
{
	if (!was)
		return !model_part_is_dropped(p, i);
	uint32_t cell = p->cell[i];
	return (p->dropped[cell / 64] ^ was[cell / 64]) >> cell % 64 & 1;
}

static bool mark_of_sum(
	model_stale *s, const model_part *p, const uint64_t *was, uint64_t sum, GError **error)
{
	uint64_t first = sum * MODEL_PART_SUM_POINTS, end = first + model_part_sum_points(p, sum);
	bool is_checked = false;
	if (!model_part_verify_cells(p, sum, error))
		return false;
	for (uint64_t i = first; i < end; i++) {
		if (!is_changed(p, was, i))
			continue;
		if (!is_checked && !model_part_verify_points(p, sum, error))
			return false;
		is_checked = true;
		mark(s, p->points + i);
	}
	return true;
}

static bool mark_of_part(model_stale *s, const model_part *p, const uint64_t *was, GError **error)
{
	for (uint64_t sum = 0; sum * MODEL_PART_SUM_POINTS < p->count; sum++)
		if (!mark_of_sum(s, p, was, sum, error))
			return false;
	model_part_forget(p, p->points, p->count);
	return true;
}

/* *ret_usable: false when the model has another scan, or knows other cells. */
static bool mark_all(model_stale *s, const model_inputs *inputs, model_part *const *part,
	const struct before *b, bool *ret_usable, GError **error)
{
	uint64_t found = 0;
	for (guint i = 0; i < inputs->scans->len; i++) {
		const model_part *p = part[i];
		int64_t k = find_before(b, model_inputs_at(inputs, i)->part_key);
		uint64_t from = k > 0 ? b->end[k - 1] : 0;
		const uint64_t *was = k >= 0 ? b->word + from : NULL;
		found += k >= 0;
		if (was && b->end[k] - from != p->words)
			return true;
		bool is_same = was && (p->words == 0 ||
					      memcmp(was, p->dropped, p->words * sizeof *was) == 0);
		if (!is_same && !mark_of_part(s, p, was, error))
			return false;
	}
	*ret_usable = found == b->ends;
	return true;
}

bool model_stale_find(const char *path, const model_inputs *inputs, model_part *const *part,
	unsigned level, model_stale **ret, GError **error)
{
	g_autoptr(model_stale) s = open_before(path, level);
	struct before b;
	bool is_usable = false;
	*ret = NULL;
	if (!s || !open_dropped(s->was, &b))
		return true;
	if (!mark_all(s, inputs, part, &b, &is_usable, error))
		return false;
	*ret = is_usable ? g_steal_pointer(&s) : NULL;
	return true;
}
