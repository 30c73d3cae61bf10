#include "process/segment-state.h"
#include "process/scan-segments.h"
#include <gio/gio.h>
#include <stdarg.h>
#include <string.h>

#define ANCHORS 24u
/* Of its points: a segment with so many of them is still the one of this number. */
#define SAME_SHARE 0.25

/* ---- loading and saving ---- */

void segment_state_free(segment_state *s)
{
	if (!s)
		return;
	for (guint i = 0; s->label && i < s->scans->scans->len; i++) {
		g_free(s->label[i].automatic);
		g_free(s->label[i].leaf);
	}
	g_free(s->label);
	segments_free(s->tree);
	g_free(s);
}

static segment_state *load(
	site *s, segment_scans *scans, const char *path, bool changed, GError **error)
{
	g_autoptr(segment_state) state = g_new0(segment_state, 1);
	state->site = s;
	state->scans = scans;
	state->tree = segments_load_file(path, error);
	state->label = g_new0(struct segment_label, scans->scans->len + 1);
	for (guint i = 0; state->tree && i < scans->scans->len; i++) {
		g_autoptr(scan_segments) l =
			scan_segments_open(s, segment_scans_at(scans, i)->number, error);
		if (!l)
			return NULL;
		size_t bytes = l->count * sizeof(uint16_t);
		state->label[i] = (struct segment_label){ l->count, g_memdup2(l->automatic, bytes),
			g_memdup2(changed ? l->leaf : l->automatic, bytes) };
	}
	return state->tree ? g_steal_pointer(&state) : NULL;
}

segment_state *segment_state_load_automatic(site *s, segment_scans *scans, GError **error)
{
	g_autofree char *path = segments_automatic_path(site_path(s));
	return load(s, scans, path, false, error);
}

segment_state *segment_state_load(site *s, segment_scans *scans, GError **error)
{
	g_autofree char *path = segments_path(site_path(s));
	return load(s, scans, path, true, error);
}

bool segment_state_save(segment_state *s, const char *edits, GError **error)
{
	g_array_set_size(s->tree->labels, 0);
	for (guint i = 0; i < s->scans->scans->len; i++) {
		const struct segment_label *l = &s->label[i];
		uint32_t number = segment_scans_at(s->scans, i)->number;
		if (!scan_segments_write(s->site, number, l->automatic, l->leaf, l->count, error))
			return false;
		segments_add_labels(s->tree, number, scan_segments_checksum(l->leaf, l->count));
	}
	g_free(s->tree->edits);
	s->tree->edits = g_strdup(edits);
	return segments_save(s->tree, site_path(s->site), error);
}

/* ---- numbers of segments ---- */

bool segment_state_refuse(GError **error, const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	g_autofree char *text = g_strdup_vprintf(format, arguments);
	va_end(arguments);
	g_set_error_literal(error, G_IO_ERROR, G_IO_ERROR_INVALID_ARGUMENT, text);
	return false;
}

static uint32_t levels_above_leaves(const segments *tree, uint32_t id)
{
	uint32_t deepest = 0;
	for (guint i = 0; i < tree->nodes->len; i++) {
		const struct segment *node = &g_array_index(tree->nodes, struct segment, i);
		uint32_t up = 0;
		while (node && node->id != id) {
			node = segments_find(tree, node->parent);
			up++;
		}
		deepest = node ? MAX(deepest, up) : deepest;
	}
	return deepest;
}

uint8_t *segment_state_below(const segments *tree, uint32_t id)
{
	uint8_t *is = g_new0(uint8_t, SEGMENTS_MAX + 1);
	for (guint i = 0; i < tree->nodes->len; i++) {
		uint32_t node = g_array_index(tree->nodes, struct segment, i).id;
		is[node] = segments_is_above(tree, id, node);
	}
	return is;
}

void segment_state_refer(const segment_state *s, segment_edit *e, uint32_t id)
{
	struct segment_ref *r =
		segment_edit_add_ref(e->segments, id, levels_above_leaves(s->tree, id));
	const struct segment *node = segments_find(s->tree, id);
	g_autofree uint8_t *is = segment_state_below(s->tree, id);
	uint64_t step = node ? MAX(node->points / ANCHORS, 1) : 1, seen = 0;
	for (guint i = 0; i < s->scans->scans->len; i++)
		for (uint64_t k = 0; k < s->label[i].count; k++) {
			struct segment_anchor a = { segment_scans_at(s->scans, i)->number,
				(uint32_t)k };
			if (is[s->label[i].leaf[k]] && seen++ % step == step / 2)
				g_array_append_val(r->anchors, a);
		}
}

void segment_state_refer_made(const segment_state *s, segment_edit *e, uint32_t first)
{
	g_autofree struct segment_ref **made = g_new0(struct segment_ref *, SEGMENTS_MAX + 1);
	g_autofree uint64_t *seen = g_new0(uint64_t, SEGMENTS_MAX + 1),
			    *step = g_new0(uint64_t, SEGMENTS_MAX + 1);
	for (guint i = 0; i < s->tree->nodes->len; i++) {
		const struct segment *node = &g_array_index(s->tree->nodes, struct segment, i);
		if (node->id < first || !segments_is_leaf(s->tree, node->id))
			continue;
		made[node->id] = segment_edit_add_ref(e->made, node->id, 0);
		step[node->id] = MAX(node->points / ANCHORS, 1);
	}
	for (guint i = 0; e->made->len && i < s->scans->scans->len; i++)
		for (uint64_t k = 0; k < s->label[i].count; k++) {
			uint16_t leaf = s->label[i].leaf[k];
			struct segment_anchor a = { segment_scans_at(s->scans, i)->number,
				(uint32_t)k };
			if (made[leaf] && seen[leaf]++ % step[leaf] == step[leaf] / 2)
				g_array_append_val(made[leaf]->anchors, a);
		}
}

static const struct segment_label *labels_of(const segment_state *s, uint32_t scan)
{
	for (guint i = 0; i < s->scans->scans->len; i++)
		if (segment_scans_at(s->scans, i)->number == scan)
			return &s->label[i];
	return NULL;
}

/* Leaf of the k-th point that names a segment; SEGMENT_NONE: it is not there. */
static uint32_t leaf_of_anchor(const segment_state *s, const struct segment_ref *r, guint k)
{
	const struct segment_anchor *a = &g_array_index(r->anchors, struct segment_anchor, k);
	const struct segment_label *l = labels_of(s, a->scan);
	uint32_t leaf = l && a->cell < l->count ? l->leaf[a->cell] : SEGMENT_NONE;
	return segments_find(s->tree, leaf) ? leaf : SEGMENT_NONE;
}

/* The leaf that most of its points are in now, and from there as far up as it stood; classes stay out of it. */
static uint32_t find_by_points(const segment_state *s, const struct segment_ref *r)
{
	g_autofree uint32_t *votes = g_new0(uint32_t, SEGMENTS_MAX + 1);
	uint32_t best = 0;
	for (guint k = 0; k < r->anchors->len; k++) {
		uint32_t leaf = leaf_of_anchor(s, r, k);
		if (leaf && ++votes[leaf] > votes[best])
			best = leaf;
	}
	for (uint32_t up = 0; best && up < r->up; up++) {
		uint32_t parent = segments_find(s->tree, best)->parent;
		if (parent < SEGMENT_FIRST)
			break;
		best = parent;
	}
	return best;
}

/* Whether the segment that has its number now has enough of its points. */
static bool is_still_there(const segment_state *s, const struct segment_ref *r)
{
	guint in = 0;
	for (guint k = 0; k < r->anchors->len; k++) {
		uint32_t leaf = leaf_of_anchor(s, r, k);
		in += leaf && segments_is_above(s->tree, r->id, leaf);
	}
	return in && in >= SAME_SHARE * r->anchors->len;
}

static uint32_t find_segment(const segment_state *s, const segment_edit *e, guint i)
{
	const struct segment_ref *r = e->segments->pdata[i];
	bool is_same = r->id < SEGMENT_FIRST || (e->base && strcmp(e->base, s->tree->key) == 0);
	if (segments_find(s->tree, r->id) && (is_same || is_still_there(s, r)))
		return r->id;
	return find_by_points(s, r);
}

bool segment_state_find(
	const segment_state *s, const segment_edit *e, guint i, uint32_t *ret, GError **error)
{
	const struct segment_ref *r = e->segments->pdata[i];
	*ret = find_segment(s, e, i);
	return *ret || segment_state_refuse(error, "there is no segment %u", r->id);
}

/* ---- changes ---- */

static void renumber(segment_state *s, const uint16_t *becomes)
{
	segments_renumber(s->tree, becomes);
	for (guint i = 0; i < s->scans->scans->len; i++)
		for (uint64_t k = 0; k < s->label[i].count; k++)
			s->label[i].leaf[k] = becomes[s->label[i].leaf[k]];
}

/* What was made just now, from number `first` on, gets the numbers that it had when the change was made for the first time. */
static void keep_made(segment_state *s, const segment_edit *e, uint32_t first)
{
	g_autofree uint16_t *becomes = g_new(uint16_t, SEGMENTS_MAX + 1);
	uint32_t next = first;
	bool any = false;
	for (uint32_t id = 0; id <= SEGMENTS_MAX; id++)
		becomes[id] = (uint16_t)(id < first ? id : 0);
	for (guint i = 0; i < e->made->len; i++) {
		const struct segment_ref *r = e->made->pdata[i];
		uint32_t id = find_by_points(s, r);
		if (id < first || becomes[id] || r->id < SEGMENT_FIRST || r->id >= first ||
			segments_find(s->tree, r->id))
			continue;
		becomes[id] = (uint16_t)r->id;
		any = true;
	}
	for (guint i = 0; any && i < s->tree->nodes->len; i++) {
		uint32_t id = g_array_index(s->tree->nodes, struct segment, i).id;
		if (!becomes[id])
			becomes[id] = (uint16_t)next++;
	}
	if (!any)
		return;
	s->tree->next = next;
	renumber(s, becomes);
}

/* Numbers of before stay free for what has them. */
static void leave_room(segment_state *s, const segment_edit *e)
{
	for (guint i = 0; i < e->made->len; i++) {
		const struct segment_ref *r = e->made->pdata[i];
		if (r->id <= SEGMENTS_MAX)
			s->tree->next = MAX(s->tree->next, r->id + 1);
	}
}

static GPtrArray *read_all(segment_state *s, const segment_edits *edits, GError **error)
{
	g_autoptr(GPtrArray) all =
		g_ptr_array_new_with_free_func((GDestroyNotify)segment_edit_free);
	for (guint i = 0; i < edits->done->len; i++) {
		segment_edit *e =
			segment_edits_read(s->site, g_array_index(edits->done, uint32_t, i), error);
		if (!e)
			return NULL;
		g_ptr_array_add(all, e);
		leave_room(s, e);
	}
	return g_steal_pointer(&all);
}

bool segment_state_apply_all(segment_state *s, const segment_edits *edits, GError **error)
{
	g_autoptr(GPtrArray) all = read_all(s, edits, error);
	for (guint i = 0; all && i < all->len; i++) {
		g_autoptr(GError) why = NULL;
		uint32_t first = s->tree->next;
		if (segment_state_apply(s, all->pdata[i], &why)) {
			keep_made(s, all->pdata[i], first);
			continue;
		}
		if (!g_error_matches(why, G_IO_ERROR, G_IO_ERROR_INVALID_ARGUMENT)) {
			g_propagate_error(error, g_steal_pointer(&why));
			return false;
		}
		s->left_out++;
	}
	return all;
}
