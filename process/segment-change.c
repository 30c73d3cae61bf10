/* The changes but drawing: names, places in the tree, parts. */
#include "process/components.h"
#include "process/segment-sums.h"
#include <stdlib.h>
#include <string.h>

/* ---- rename, move ---- */

static void set_text(char **text, const char *to)
{
	g_free(*text);
	*text = g_strdup(to);
}

static bool do_rename(segment_state *s, const segment_edit *e, GError **error)
{
	uint32_t id;
	if (!segment_state_find(s, e, 0, &id, error))
		return false;
	if (id < SEGMENT_FIRST)
		return segment_state_refuse(
			error, "segment %u is a class, which keeps its name", id);
	set_text(&segments_find(s->tree, id)->name, e->name);
	return true;
}

static bool do_move(segment_state *s, const segment_edit *e, GError **error)
{
	uint32_t id, to = e->class >= 0 ? segment_of_class((enum segment_class)e->class) : 0;
	if (!segment_state_find(s, e, 0, &id, error) ||
		(!to && !segment_state_find(s, e, 1, &to, error)))
		return false;
	if (id < SEGMENT_FIRST)
		return segment_state_refuse(
			error, "segment %u is a class, which stays where it is", id);
	if (segments_is_above(s->tree, id, to))
		return segment_state_refuse(error, "segment %u cannot be put into itself", id);
	if (to >= SEGMENT_FIRST && segments_is_leaf(s->tree, to))
		return segment_state_refuse(
			error, "segment %u has points of its own: merge the two instead", to);
	g_autofree struct leaf_sum *sum = segment_sums_new(s->tree);
	enum segment_class class = segments_find(s->tree, to)->class;
	for (guint i = 0; i < s->tree->nodes->len; i++) {
		struct segment *node = &g_array_index(s->tree->nodes, struct segment, i);
		if (segments_is_above(s->tree, id, node->id))
			node->class = class;
	}
	segments_find(s->tree, id)->parent = to;
	set_text(&segments_find(s->tree, id)->made_by, "user");
	segment_sums_finish(s->tree, sum);
	return true;
}

/* ---- merge ---- */

/* The leaves below id become id, which is a leaf then. */
static void melt(
	segment_state *s, uint32_t id, uint32_t into, uint16_t *becomes, struct leaf_sum *sum)
{
	g_autofree uint8_t *is = segment_state_below(s->tree, id);
	for (uint32_t k = SEGMENT_FIRST; k <= SEGMENTS_MAX; k++) {
		if (!is[k] || k == into)
			continue;
		becomes[k] = (uint16_t)into;
		segment_sums_add(&sum[into], &sum[k]);
		sum[k] = (struct leaf_sum){ 0 };
	}
	for (uint32_t k = SEGMENTS_MAX; k >= SEGMENT_FIRST; k--)
		while (is[k] && k != into && segments_find(s->tree, k) &&
			segments_is_leaf(s->tree, k))
			segments_remove(s->tree, k);
}

static void relabel(segment_state *s, const uint16_t *becomes)
{
	for (guint i = 0; i < s->scans->scans->len; i++)
		for (uint64_t k = 0; k < s->label[i].count; k++)
			s->label[i].leaf[k] = becomes[s->label[i].leaf[k]];
}

static bool check_merge(segment_state *s, const segment_edit *e, uint32_t *id, GError **error)
{
	for (guint i = 0; i < e->segments->len; i++) {
		if (!segment_state_find(s, e, i, &id[i], error))
			return false;
		if (id[i] < SEGMENT_FIRST)
			return segment_state_refuse(
				error, "segment %u is a class, which cannot be merged", id[i]);
		for (guint k = 0; k < i; k++)
			if (segments_is_above(s->tree, id[k], id[i]) ||
				segments_is_above(s->tree, id[i], id[k]))
				return segment_state_refuse(error,
					"segment %u and segment %u are not apart", id[k], id[i]);
	}
	return true;
}

static bool do_merge(segment_state *s, const segment_edit *e, GError **error)
{
	g_autofree uint32_t *id = g_new0(uint32_t, e->segments->len);
	g_autofree uint16_t *becomes = g_new(uint16_t, SEGMENTS_MAX + 1);
	if (!check_merge(s, e, id, error))
		return false;
	g_autofree struct leaf_sum *sum = segment_sums_new(s->tree);
	for (uint32_t k = 0; k <= SEGMENTS_MAX; k++)
		becomes[k] = (uint16_t)k;
	for (guint i = 0; i < e->segments->len; i++)
		melt(s, id[i], id[0], becomes, sum);
	/* removal from the largest number on may leave those whose children have smaller ones */
	for (guint i = 0; i < e->segments->len; i++)
		melt(s, id[i], id[0], becomes, sum);
	relabel(s, becomes);
	if (e->name)
		set_text(&segments_find(s->tree, id[0])->name, e->name);
	set_text(&segments_find(s->tree, id[0])->made_by, "user");
	segment_sums_finish(s->tree, sum);
	return true;
}

/* ---- split ---- */

static bool gather(segment_state *s, uint32_t leaf, voxels *v, GError **error)
{
	for (guint i = 0; i < s->scans->scans->len; i++) {
		struct segmentation_scan scan;
		if (!segment_scans_open(s->scans, i, &scan, error))
			return false;
		for (uint64_t k = 0; k < s->label[i].count; k++) {
			struct voxel_point p;
			if (s->label[i].leaf[k] != leaf)
				continue;
			segmentation_point(&scan, i, k, &p);
			voxels_add(v, &p);
		}
	}
	voxels_finish(v);
	voxels_link(v, 0);
	return true;
}

static bool label_parts(segment_state *s, uint32_t leaf, const voxels *v, const components *c,
	const uint16_t *part, uint16_t rest, GError **error)
{
	for (guint i = 0; i < s->scans->scans->len; i++) {
		struct segmentation_scan scan;
		if (!segment_scans_open(s->scans, i, &scan, error))
			return false;
		for (uint64_t k = 0; k < s->label[i].count; k++) {
			double at[3];
			if (s->label[i].leaf[k] != leaf)
				continue;
			scan_points_position(&scan.points, k, at);
			uint32_t voxel = voxels_find_point(v, at);
			uint32_t of = voxel == VOXEL_NONE ? VOXEL_NONE : c->of[voxel];
			s->label[i].leaf[k] = of == VOXEL_NONE ? rest : part[of];
		}
	}
	return true;
}

static int by_points(const void *a, const void *b, void *user_data)
{
	const struct component *c = user_data;
	uint32_t x = c[*(const uint32_t *)a].points, y = c[*(const uint32_t *)b].points;
	return (x < y) - (x > y);
}

/* Numbers of parts by component, the largest first. 0 and an error: too many. */
static bool add_parts(segment_state *s, uint32_t leaf, const components *c, uint16_t *ret_part,
	uint16_t *ret_rest, GError **error)
{
	g_autofree uint32_t *order = g_new(uint32_t, c->count + 1);
	g_autofree char *name = g_strdup(segments_find(s->tree, leaf)->name);
	for (uint32_t k = 0; k < c->count; k++)
		order[k] = k;
	qsort_r(order, c->count, sizeof *order, by_points, c->component);
	for (uint32_t k = 0; k <= c->count; k++) {
		g_autofree char *part = k < c->count ? g_strdup_printf("%s, part %u", name, k + 1)
						     : g_strdup_printf("%s, the rest", name);
		uint32_t id = segments_add(s->tree, leaf, part, "user");
		if (!id)
			return segment_state_refuse(
				error, "there are more than %u segments", SEGMENTS_MAX);
		*(k < c->count ? &ret_part[order[k]] : ret_rest) = (uint16_t)id;
	}
	return true;
}

static bool do_split(segment_state *s, const segment_edit *e, GError **error)
{
	uint32_t id;
	if (!segment_state_find(s, e, 0, &id, error))
		return false;
	if (id < SEGMENT_FIRST || !segments_is_leaf(s->tree, id))
		return segment_state_refuse(error, "segment %u has parts already: split these", id);
	g_autoptr(voxels) v = voxels_new(e->gap_m);
	if (!gather(s, id, v, error))
		return false;
	g_autoptr(components) c = components_find(v, NULL, e->points_min);
	if (c->count < 2)
		return segment_state_refuse(error,
			"no gap of %g m divides segment %u into parts of %u points or more",
			e->gap_m, id, e->points_min);
	g_autoptr(segments) before = segments_copy(s->tree);
	g_autofree struct leaf_sum *sum = segment_sums_new(s->tree);
	g_autofree uint16_t *part = g_new0(uint16_t, c->count + 1);
	g_autofree uint8_t *which = g_new0(uint8_t, SEGMENTS_MAX + 1);
	uint16_t rest = 0;
	if (!add_parts(s, id, c, part, &rest, error)) {
		segments_free(s->tree);
		s->tree = g_steal_pointer(&before);
		return false;
	}
	for (uint32_t k = 0; k < c->count; k++)
		which[part[k]] = 1;
	which[rest] = 1;
	sum[id] = (struct leaf_sum){ 0 };
	if (!label_parts(s, id, v, c, part, rest, error) ||
		!segment_sums_measure(s, which, sum, error))
		return false;
	segment_sums_finish(s->tree, sum);
	return true;
}

/* ---- any ---- */

bool segment_state_apply(segment_state *s, const segment_edit *e, GError **error)
{
	static bool (*const doing[SEGMENT_OPS])(
		segment_state *, const segment_edit *, GError **) = {
		[EDIT_RENAME] = do_rename,
		[EDIT_MERGE] = do_merge,
		[EDIT_SPLIT] = do_split,
		[EDIT_MOVE] = do_move,
		[EDIT_DRAW] = segment_state_draw,
	};
	return doing[e->op](s, e, error);
}
