#ifndef PROCESS_SCRIBBLE_H
#define PROCESS_SCRIBBLE_H
/* Scribbles tell a program what a person means: a stroke over a statue says "this", and all of the statue is selected. It is the
 * user-assisted segmentation on the panorama of one scan of Xu and Chen 2004, section 3: edges of range, intensity and colour
 * together, which scribble-edges.h finds once, and a flood from the strokes that is held up by them (watershed.h).
 *
 * One stroke is enough where what is outside can be told: floors, which are large horizontal surfaces (scribble-floor.h) unless
 * the stroke is on them, and what is further from the stroke in space than some multiple of its extent. Every further stroke
 * mends what is wrong; a later one is right where two cross.
 *
 * Not cv::grabCut, which learns what the colours inside and outside are like: with the same strokes on range, height and
 * intensity it selected less well and took longer, for a thing is told from others by its edges, not by its distance.
 *
 * Cells without a point are never selected. Holes of a few cells, such as windows, do not hold up the flood, wider ones do.
 *
 * One owner, one thread; the grid must stay, what else is given to scribble_new need not. Beside it a session takes 19 bytes a
 * cell, a stroke some more while it is worked on. */
#include "process/geometry.h"

enum scribble_side { SCRIBBLE_INSIDE, SCRIBBLE_OUTSIDE };

/* A polyline over the panorama. Columns may lie beyond the seam where the grid wraps: a stroke that is drawn on over it has a
 * column of -3 or of columns + 3. What lies outside the grid is passed over. */
struct scribble_point {
	float column, row; /* in cells; the middle of cell 0 is at 0.5 */
};
struct scribble_stroke {
	enum scribble_side side;
	const struct scribble_point *point;
	size_t points; /* 1: a dab */
	float radius;  /* of the brush, in cells; 0: only the cells that the line goes through */
};

/* What weighs how much as an edge, and how far a stroke reaches; 0: as it is meant to be. Below 0: not at all. */
struct scribble_options {
	float range_weight;  /* 1; what the surface on neither side explains */
	float crease_weight; /* 0.5; of hollow creases: things meet there; of others half of it */
	float intensity_weight; /* 0.1 */
	float colour_weight;    /* 0.2 */
	float leaf_weight; /* 0.3; where two leaves of a segmentation that is already there meet */
	float reach;       /* 2; times the extent of a stroke, beyond which it selects nothing */
};

typedef struct scribble scribble;
/* geometry: of the grid; NULL: it is estimated. leaf: of each cell, or NULL. options may be NULL. */
scribble *scribble_new(const range_grid *grid, const geometry *normals, const uint16_t *leaf,
	const struct scribble_options *options);
void scribble_free(scribble *s); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(scribble, scribble_free)

/* Adds a stroke, of which a copy is kept, and selects anew. */
void scribble_draw(scribble *s, const struct scribble_stroke *stroke);
/* Takes the last stroke back; false: there is none. */
bool scribble_undo(scribble *s);
/* A byte a cell: 1 in the object, 0 not. Owned by s, valid until the next stroke or undo. */
const uint8_t *scribble_selected(const scribble *s);
size_t scribble_count(const scribble *s); /* selected cells */

#endif
