#include "process/segment-editor.h"
#include "process/segment-site.h"
#include <gio/gio.h>

struct segment_editor {
	site *site;
	segment_scans *scans;
	segment_edits *edits;
	segment_state *state;
};

void segment_editor_free(segment_editor *e)
{
	if (!e)
		return;
	segment_state_free(e->state);
	segment_edits_free(e->edits);
	segment_scans_free(e->scans);
	g_free(e);
}

static bool check_due(site *s, const scan_graph *g, GError **error)
{
	bool due;
	g_autofree char *why = NULL;
	if (!segment_site_is_due(s, g, &due, &why, error))
		return false;
	if (due)
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_NOT_INITIALIZED,
			"%s: its segments are not up to date (%s); pleinair process brings them "
			"there",
			site_path(s), why);
	return !due;
}

segment_editor *segment_editor_new(site *s, const scan_graph *g, GError **error)
{
	g_autoptr(segment_editor) e = g_new0(segment_editor, 1);
	e->site = s;
	if (!check_due(s, g, error) || !(e->scans = segment_scans_new(s, g, error)) ||
		!(e->edits = segment_edits_load(s, error)))
		return NULL;
	if (!e->scans->scans->len) {
		g_set_error(
			error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND, "%s: has no scans", site_path(s));
		return NULL;
	}
	e->state = segment_state_load(s, e->scans, error);
	return e->state ? g_steal_pointer(&e) : NULL;
}

const segments *segment_editor_tree(const segment_editor *e)
{
	return e->state->tree;
}

const segment_edits *segment_editor_edits(const segment_editor *e)
{
	return e->edits;
}

const uint16_t *segment_editor_leaves(const segment_editor *e, uint32_t scan, uint64_t *ret_count)
{
	for (guint i = 0; i < e->scans->scans->len; i++)
		if (segment_scans_at(e->scans, i)->number == scan) {
			*ret_count = e->state->label[i].count;
			return e->state->label[i].leaf;
		}
	return NULL;
}

bool segment_editor_refer(segment_editor *e, segment_edit *edit, uint32_t id, GError **error)
{
	if (!segments_find(e->state->tree, id) || id == SEGMENT_SITE) {
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_ARGUMENT,
			"there is no segment %u", id);
		return false;
	}
	segment_state_refer(e->state, edit, id);
	return true;
}

static bool save(segment_editor *e, GError **error)
{
	g_autofree char *done = segment_edits_done(e->edits);
	return segment_state_save(e->state, done, error);
}

bool segment_editor_change(segment_editor *e, segment_edit *edit, GError **error)
{
	g_free(edit->base);
	edit->base = g_strdup(e->state->tree->key);
	uint32_t first = e->state->tree->next;
	if (!segment_state_apply(e->state, edit, error))
		return false;
	segment_state_refer_made(e->state, edit, first);
	return segment_edits_append(e->edits, e->site, edit, error) && save(e, error);
}

static bool build_anew(segment_editor *e, GError **error)
{
	g_autoptr(segment_state) state = segment_state_load_automatic(e->site, e->scans, error);
	if (!state)
		return false;
	/* numbers of what is undone are not given to what is made next */
	state->tree->next = MAX(state->tree->next, e->state->tree->next);
	if (!segment_state_apply_all(state, e->edits, error))
		return false;
	segment_state_free(e->state);
	e->state = g_steal_pointer(&state);
	return save(e, error);
}

bool segment_editor_undo(segment_editor *e, GError **error)
{
	return segment_edits_undo(e->edits, e->site, error) && build_anew(e, error);
}

bool segment_editor_redo(segment_editor *e, GError **error)
{
	return segment_edits_redo(e->edits, e->site, error) && build_anew(e, error);
}
