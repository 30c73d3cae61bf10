#ifndef PROCESS_SEGMENT_STATE_H
#define PROCESS_SEGMENT_STATE_H
/* The segments of a site in memory, tree and labels, to change them (segment-edits.h). Two bytes a cell of every scan, twice. */
#include "process/segment-edits.h"
#include "process/segment-scans.h"

struct segment_label {
	uint64_t count;
	uint16_t *automatic, *leaf; /* of each cell or point */
};

typedef struct segment_state segment_state;
struct segment_state {
	site *site;
	segment_scans *scans; /* not owned */
	segments *tree;
	struct segment_label *label; /* of scans, in their order */
	uint32_t left_out;           /* changes that speak of what is not there any more */
};

/* As the computer found it. */
segment_state *segment_state_load_automatic(site *s, segment_scans *scans, GError **error);
/* With all changes that are in the files. */
segment_state *segment_state_load(site *s, segment_scans *scans, GError **error);
void segment_state_free(segment_state *s); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(segment_state, segment_state_free)

/* ---- for those that make changes ---- */

/* false and G_IO_ERROR_INVALID_ARGUMENT with this sentence. */
bool segment_state_refuse(GError **error, const char *format, ...) G_GNUC_PRINTF(2, 3);
/* The i-th segment of a change, as it is now; refuses one that is not there. */
bool segment_state_find(
	const segment_state *s, const segment_edit *e, guint i, uint32_t *ret, GError **error);
/* A byte for each number: whether it is id or below it; caller frees. */
uint8_t *segment_state_below(const segments *tree, uint32_t id);
bool segment_state_draw(segment_state *s, const segment_edit *e, GError **error);

/* ---- for all ---- */

/* Names a segment in a change, by its number now and by points of it. */
void segment_state_refer(const segment_state *s, segment_edit *e, uint32_t id);
/* Names the leaves that a change has made: those with this number and with larger ones. */
void segment_state_refer_made(const segment_state *s, segment_edit *e, uint32_t first);
/* Makes a change. G_IO_ERROR_INVALID_ARGUMENT and a sentence when it cannot be made, and nothing has changed then. */
bool segment_state_apply(segment_state *s, const segment_edit *e, GError **error);
/* All that count, in their order; what cannot be made any more is left out and counted. What a change had made before has the
 * numbers that it had. */
bool segment_state_apply_all(segment_state *s, const segment_edits *edits, GError **error);
/* Labels first, the tree last. edits: which changes are in it. */
bool segment_state_save(segment_state *s, const char *edits, GError **error);

#endif
