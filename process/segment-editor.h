#ifndef PROCESS_SEGMENT_EDITOR_H
#define PROCESS_SEGMENT_EDITOR_H
/* Changes the segments of a site, as a person asks for it. Each change is on disk when it returns. One owner, one thread; the site
 * must be open for writing. */
#include "process/segment-state.h"

typedef struct segment_editor segment_editor;
/* Refuses when segments are missing or out of date. */
segment_editor *segment_editor_new(site *s, const scan_graph *g, GError **error);
void segment_editor_free(segment_editor *e); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(segment_editor, segment_editor_free)
const segments *segment_editor_tree(const segment_editor *e); /* until the next change */
const segment_edits *segment_editor_edits(const segment_editor *e);
/* The leaves of a scan's cells, until the next change; NULL: there is no such scan. */
const uint16_t *segment_editor_leaves(const segment_editor *e, uint32_t scan, uint64_t *ret_count);

/* Names a segment in a change; refuses one that is not there. */
bool segment_editor_refer(segment_editor *e, segment_edit *edit, uint32_t id, GError **error);
/* Fails as segment_state_apply does, and nothing has changed then. */
bool segment_editor_change(segment_editor *e, segment_edit *edit, GError **error);
bool segment_editor_undo(segment_editor *e, GError **error);
bool segment_editor_redo(segment_editor *e, GError **error);

#endif
