#ifndef PROCESS_SEGMENT_EDITS_H
#define PROCESS_SEGMENT_EDITS_H
/* What people change about the segments of a site: SITE/edits/. It is no product: when scans are added or segments are found anew,
 * the changes are made once more.
 *
 *     edits.json     "done": [1, 2, 5], "undone": [6]: the changes that count, in order, and those that can be done again
 *     0005.edit      one change (product.h): the manifest tells what, the section "runs" has pairs of uint32, a first cell and how
 *                    many cells follow on, of the scan that was drawn in
 *
 * Segments that are the same keep their numbers when they are found anew (segments.h), but one that was a single thing may be two
 * then, or gone. So a change names each segment by some of its points too, and by how far above their leaves it stands: the number
 * counts while the segment that has it has a quarter of these points, else the segment that most of them are in. The segments that
 * a change made are named in the same way, and have the same numbers when it is made once more. */
#include "acquire/site.h"
#include "process/segment-class.h"

enum segment_op {
	EDIT_RENAME, /* the first segment: name */
	EDIT_MERGE,  /* all segments into the first; name, if given */
	EDIT_SPLIT, /* the first, a leaf, where gaps of gap_m divide it into parts of points_min points */
	EDIT_MOVE, /* the first under the second, or under a class */
	EDIT_DRAW, /* cells of a scan, and what other scans have at these places, into a new segment of a class, or into the first */
	SEGMENT_OPS
};
extern const char *const segment_op_names[SEGMENT_OPS]; /* "rename", ... */

struct segment_anchor {
	uint32_t scan, cell;
};
struct segment_ref {
	uint32_t id;     /* when the change was made */
	uint32_t up;     /* levels above the leaves of its anchors */
	GArray *anchors; /* of struct segment_anchor */
};
struct cell_run {
	uint32_t first, count;
};

typedef struct segment_edit segment_edit;
struct segment_edit {
	uint32_t number;
	enum segment_op op;
	char *time;          /* UTC */
	char *base;          /* key of the segments that ids are of (segments.h) */
	GPtrArray *segments; /* of struct segment_ref */
	GPtrArray *made;     /* the same: leaves that came of it; none before it was made */
	char *name;          /* NULL: none */
	int class;           /* enum segment_class; -1: none */
	double gap_m;
	uint32_t points_min;
	uint32_t scan; /* that was drawn in */
	GArray *runs;  /* of struct cell_run */
};
segment_edit *segment_edit_new(enum segment_op op);
void segment_edit_free(segment_edit *e); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(segment_edit, segment_edit_free)
/* list: segments or made, of the change. */
struct segment_ref *segment_edit_add_ref(GPtrArray *list, uint32_t id, uint32_t up);

typedef struct segment_edits segment_edits;
struct segment_edits {
	GArray *done, *undone; /* of uint32_t; the last one undone last */
};
void segment_edits_free(segment_edits *e); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(segment_edits, segment_edits_free)
/* Empty where nothing was changed yet. */
segment_edits *segment_edits_load(const site *s, GError **error);
segment_edit *segment_edits_read(const site *s, uint32_t number, GError **error);
/* Writes a change and that it counts; sets its number and time. Changes that were undone cannot be done again then. */
bool segment_edits_append(segment_edits *e, site *s, segment_edit *edit, GError **error);
/* G_IO_ERROR_NOT_FOUND when there is none. */
bool segment_edits_undo(segment_edits *e, site *s, GError **error);
bool segment_edits_redo(segment_edits *e, site *s, GError **error);
/* "1 2 5"; caller frees. */
char *segment_edits_done(const segment_edits *e);

#endif
