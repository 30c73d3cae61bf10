/* A style for the tree of a site: what each leaf inherits, from the site downwards. */
#include "render/style-private.h"
#include <string.h>

#define UNKNOWN G_MAXUINT32

struct resolving {
	const style *style;
	const segments *tree;
	bool is_whole;             /* of the tree, only the site counts else */
	GHashTable *nodes;         /* by key, a GPtrArray of struct style_node */
	GHashTable *used;          /* the keys that something has */
	GPtrArray *lists;          /* of struct step_list, each once; the first is empty */
	GHashTable *places;        /* of the lists, + 1 */
	uint32_t *list_of;         /* [SEGMENTS_MAX + 1]; UNKNOWN: not yet */
	GArray *pipeline_of_list;  /* of uint32_t; UNKNOWN: nothing is drawn with it yet */
	GArray *pipeline_in_focus; /* the same of what the focus is on */
	GError **error;
};

/* ---- lists, each kept once ---- */

static guint hash_list(gconstpointer data)
{
	const struct step_list *list = data;
	g_autoptr(GBytes) bytes =
		g_bytes_new_static(list->steps, list->count * sizeof *list->steps);
	return g_bytes_hash(bytes);
}

static gboolean equal_lists(gconstpointer a, gconstpointer b)
{
	const struct step_list *x = a, *y = b;
	return x->count == y->count && x->mask_given == y->mask_given &&
	       memcmp(x->steps, y->steps, x->count * sizeof *x->steps) == 0;
}

static uint32_t keep_list(struct resolving *w, const struct step_list *list)
{
	guint place = GPOINTER_TO_UINT(g_hash_table_lookup(w->places, list));
	if (place)
		return place - 1;
	static const uint32_t unknown = UNKNOWN;
	struct step_list *kept = g_memdup2(list, sizeof *list);
	g_ptr_array_add(w->lists, kept);
	g_hash_table_insert(w->places, kept, GUINT_TO_POINTER(w->lists->len));
	g_array_append_val(w->pipeline_of_list, unknown);
	g_array_append_val(w->pipeline_in_focus, unknown);
	return w->lists->len - 1;
}

/* ---- what the nodes of a style do to a list ---- */

static bool apply_key(struct resolving *w, const char *key, struct step_list *list, bool *changed)
{
	const GPtrArray *nodes = g_hash_table_lookup(w->nodes, key);
	if (!nodes)
		return true;
	g_hash_table_add(w->used, ((struct style_node *)nodes->pdata[0])->key);
	*changed = true;
	for (guint i = 0; i < nodes->len; i++)
		if (!step_list_apply(list, nodes->pdata[i], w->error))
			return false;
	return true;
}

/* These mean what they say, whatever is called so. */
static bool is_reserved(const char *name)
{
	return *name == '#' || strcmp(name, "site") == 0 || strcmp(name, "picture") == 0 ||
	       segment_class_find(name) >= 0;
}

/* The names that a segment has in a style, the last one counts most. */
static bool apply_segment(
	struct resolving *w, const struct segment *s, struct step_list *list, bool *changed)
{
	char number[16];
	g_snprintf(number, sizeof number, "#%u", s->id);
	if (s->id == SEGMENT_SITE && !apply_key(w, "site", list, changed))
		return false;
	if (s->id == segment_of_class(s->class) &&
		!apply_key(w, segment_classes[s->class].name, list, changed))
		return false;
	return (is_reserved(s->name) || apply_key(w, s->name, list, changed)) &&
	       apply_key(w, number, list, changed);
}

/* ---- the tree ---- */

static bool resolve_one(struct resolving *w, const struct segment *s, uint32_t above)
{
	struct step_list list = *(const struct step_list *)w->lists->pdata[above];
	bool changed = false;
	if (!apply_segment(w, s, &list, &changed))
		return false;
	w->list_of[s->id] = changed ? keep_list(w, &list) : above;
	return true;
}

/* First what stands above it and is not known yet, from there down: a tree may be deep. */
static bool resolve(struct resolving *w, const struct segment *s)
{
	g_autoptr(GPtrArray) way = g_ptr_array_new();
	const struct segment *node = s;
	for (; node && w->list_of[node->id] == UNKNOWN; node = segments_find(w->tree, node->parent))
		g_ptr_array_add(way, (gpointer)node);
	uint32_t above = node ? w->list_of[node->id] : 0;
	for (guint i = way->len; i-- > 0;) {
		node = way->pdata[i];
		if (!resolve_one(w, node, above))
			return false;
		above = w->list_of[node->id];
	}
	return true;
}

static bool resolve_all(struct resolving *w)
{
	struct step_list nothing;
	step_list_clear(&nothing);
	keep_list(w, &nothing);
	if (!resolve(w, segments_find(w->tree, SEGMENT_SITE)))
		return false;
	for (guint i = 0; w->is_whole && i < w->tree->nodes->len; i++)
		if (!resolve(w, &g_array_index(w->tree->nodes, struct segment, i)))
			return false;
	return true;
}

/* ---- pipelines ---- */

static struct pipeline to_pipeline(const struct step_list *list)
{
	struct pipeline p;
	memset(&p, 0, sizeof p);
	p.mask = list->steps[0].mask;
	p.inpaint = step_defaults(step_kind_find("inpaint")).inpaint;
	for (uint32_t i = 1; i < list->count; i++)
		if (list->steps[i].kind->stage == STEP_LAYER)
			p.steps[p.layers++] = list->steps[i];
	for (uint32_t i = 1; i < list->count; i++)
		if (list->steps[i].kind->stage == STEP_FILTER)
			p.steps[p.layers + p.filters++] = list->steps[i];
		else if (list->steps[i].kind == step_kind_find("inpaint"))
			p.inpaint = list->steps[i].inpaint;
	return p;
}

static bool same_pipeline(const struct pipeline *a, const struct pipeline *b)
{
	if (memcmp(&a->mask, &b->mask, sizeof a->mask) || a->layers != b->layers ||
		a->filters != b->filters || a->is_focus != b->is_focus ||
		memcmp(&a->inpaint, &b->inpaint, sizeof a->inpaint))
		return false;
	for (uint32_t i = 0; i < a->layers + a->filters; i++)
		if (a->steps[i].kind != b->steps[i].kind ||
			memcmp(a->steps[i].bytes, b->steps[i].bytes, STEP_SIZE_MAX))
			return false;
	return true;
}

static uint32_t add_pipeline(drawing *d, const struct pipeline *p)
{
	for (guint i = 0; i < d->pipelines->len; i++)
		if (same_pipeline(&g_array_index(d->pipelines, struct pipeline, i), p))
			return i;
	g_array_append_vals(d->pipelines, p, 1);
	return d->pipelines->len - 1;
}

/* Of the segment that the focus is on, or below it. */
static bool is_in_focus(const struct resolving *w, uint32_t id)
{
	const struct style_focus *f = &w->style->whole.focus;
	uint32_t wanted = (uint32_t)f->segment;
	if (f->on != FOCUS_SEGMENT || !wanted)
		return false;
	const struct segment *s = segments_find(w->tree, id);
	for (; s && s->id != wanted && s->id != SEGMENT_SITE; s = segments_find(w->tree, s->parent))
		;
	return s && s->id == wanted;
}

/* Of a node that is drawn. */
static bool draw_node(struct resolving *w, drawing *d, uint32_t id, uint8_t *ret)
{
	uint32_t list = w->list_of[id];
	bool is_focus = is_in_focus(w, id);
	GArray *known = is_focus ? w->pipeline_in_focus : w->pipeline_of_list;
	uint32_t *pipeline = &g_array_index(known, uint32_t, list);
	if (*pipeline == UNKNOWN) {
		struct pipeline p = to_pipeline(w->lists->pdata[list]);
		p.is_focus = is_focus;
		*pipeline = add_pipeline(d, &p);
	}
	if (*pipeline >= PIPELINES_MAX) {
		g_set_error(w->error, STYLE_ERROR, STYLE_ERROR_MANY,
			"%s: more than %d things would be drawn in different ways on this site",
			w->style->path ? w->style->path : w->style->name, PIPELINES_MAX);
		return false;
	}
	*ret = (uint8_t)*pipeline;
	return true;
}

static bool draw_leaves(struct resolving *w, drawing *d)
{
	const GArray *nodes = w->tree->nodes;
	g_autofree uint8_t *is_parent = g_new0(uint8_t, SEGMENTS_MAX + 1);
	if (!draw_node(w, d, SEGMENT_SITE, &d->pipeline_of[0]))
		return false;
	memset(d->pipeline_of, d->pipeline_of[0], SEGMENTS_MAX + 1);
	for (guint i = 0; i < nodes->len; i++)
		is_parent[g_array_index(nodes, struct segment, i).parent] = 1;
	for (guint i = 0; w->is_whole && i < nodes->len; i++) {
		uint32_t id = g_array_index(nodes, struct segment, i).id;
		if (!is_parent[id] && !draw_node(w, d, id, &d->pipeline_of[id]))
			return false;
	}
	return true;
}

/* ---- the whole ---- */

static bool find_picture(struct resolving *w, struct step_list *list)
{
	bool changed = false;
	step_list_clear(list);
	return apply_key(w, "picture", list, &changed);
}

static bool filter_picture(struct resolving *w, drawing *d)
{
	struct step_list list;
	if (!find_picture(w, &list))
		return false;
	d->picture = to_pipeline(&list);
	for (uint32_t i = 1; i < list.count; i++)
		if (list.steps[i].kind == step_kind_find("composite"))
			d->composite_by = list.steps[i].composite.by;
	return true;
}

static void begin(struct resolving *w)
{
	w->nodes = g_hash_table_new_full(
		g_str_hash, g_str_equal, NULL, (GDestroyNotify)g_ptr_array_unref);
	w->used = g_hash_table_new(g_str_hash, g_str_equal);
	w->lists = g_ptr_array_new_with_free_func(g_free);
	w->places = g_hash_table_new(hash_list, equal_lists);
	w->pipeline_of_list = g_array_new(FALSE, FALSE, sizeof(uint32_t));
	w->pipeline_in_focus = g_array_new(FALSE, FALSE, sizeof(uint32_t));
	w->list_of = g_new(uint32_t, SEGMENTS_MAX + 1);
	memset(w->list_of, 0xff, (SEGMENTS_MAX + 1) * sizeof *w->list_of);
	for (guint i = 0; i < w->style->nodes->len; i++) {
		const struct style_node *n = style_node_at(w->style, i);
		GPtrArray *same = g_hash_table_lookup(w->nodes, n->key);
		if (!same) {
			same = g_ptr_array_new();
			g_hash_table_insert(w->nodes, n->key, same);
		}
		g_ptr_array_add(same, (gpointer)n);
	}
}

static void end(struct resolving *w)
{
	g_hash_table_unref(w->places);
	g_hash_table_unref(w->nodes);
	g_hash_table_unref(w->used);
	g_ptr_array_unref(w->lists);
	g_array_unref(w->pipeline_of_list);
	g_array_unref(w->pipeline_in_focus);
	g_free(w->list_of);
}

/* Caller frees. */
static char **unused_keys(const struct resolving *w)
{
	GPtrArray *keys = g_ptr_array_new();
	for (guint i = 0; i < w->style->nodes->len; i++) {
		const char *key = style_node_at(w->style, i)->key;
		if (!g_hash_table_contains(w->used, key)) {
			g_hash_table_add(w->used, (gpointer)key); /* each once */
			g_ptr_array_add(keys, g_strdup(key));
		}
	}
	g_ptr_array_add(keys, NULL);
	return (char **)g_ptr_array_free(keys, FALSE);
}

drawing *drawing_new(const style *s, const segments *tree, char ***ret_unused, GError **error)
{
	g_autoptr(segments) none = tree ? NULL : segments_new();
	struct resolving w = {
		.style = s, .tree = tree ? tree : none, .is_whole = tree, .error = error
	};
	g_autoptr(drawing) d = g_new0(drawing, 1);
	d->whole = s->whole;
	d->pipelines = g_array_new(FALSE, FALSE, sizeof(struct pipeline));
	d->pipeline_of = g_new0(uint8_t, SEGMENTS_MAX + 1);
	begin(&w);
	bool good = resolve_all(&w) && draw_leaves(&w, d) && filter_picture(&w, d);
	if (good && ret_unused)
		*ret_unused = unused_keys(&w);
	end(&w);
	return good ? g_steal_pointer(&d) : NULL;
}

GArray *style_steps(const style *s, const segments *tree, uint32_t node, GError **error)
{
	g_autoptr(segments) none = tree ? NULL : segments_new();
	struct resolving w = { .style = s, .tree = tree ? tree : none, .error = error };
	struct step_list nothing;
	GArray *steps = NULL;
	begin(&w);
	step_list_clear(&nothing);
	keep_list(&w, &nothing);
	if (node == STYLE_PICTURE) {
		if (find_picture(&w, &nothing)) {
			steps = g_array_new(FALSE, FALSE, sizeof(struct step));
			g_array_append_vals(steps, nothing.steps + 1, nothing.count - 1);
		}
		end(&w);
		return steps;
	}
	const struct segment *at = segments_find(w.tree, node);
	if (resolve(&w, at ? at : segments_find(w.tree, SEGMENT_SITE))) {
		const struct step_list *list = w.lists->pdata[w.list_of[at ? node : SEGMENT_SITE]];
		steps = g_array_new(FALSE, FALSE, sizeof(struct step));
		g_array_append_vals(steps, list->steps, list->count);
	}
	end(&w);
	return steps;
}

static bool sways(const struct pipeline *p)
{
	for (uint32_t n = p->layers; n < p->layers + p->filters; n++)
		if (strcmp(p->steps[n].kind->name, "warp") == 0 &&
			p->steps[n].warp.amplitude_px > 0)
			return true;
	return false;
}

bool drawing_sways(const drawing *d)
{
	bool ret = sways(&d->picture);
	for (guint n = 0; n < d->pipelines->len; n++)
		ret |= sways(&g_array_index(d->pipelines, struct pipeline, n));
	return ret;
}

void drawing_free(drawing *d)
{
	if (!d)
		return;
	g_array_unref(d->pipelines);
	g_free(d->pipeline_of);
	g_free(d);
}
