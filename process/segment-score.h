#ifndef PROCESS_SEGMENT_SCORE_H
#define PROCESS_SEGMENT_SCORE_H
/* Segments held against what really stands there, or against classes that points came with: for the bench and for tests.
 *
 * A cell's truth is what its beam meets first. Cells whose range is another one by more than 0.15 m saw two things at once and are
 * left out, but what stands behind a pane of a building counts as the building. A plant that is higher than 2.5 m and has 200
 * cells is a tree; it is found when it and one leaf have half of what either has in common. */
#include "process/bench-truth.h"
#include "process/scan-points.h"
#include "process/segments.h"

typedef struct segment_score segment_score;
struct segment_score {
	/* Rows: what it is, as bench-truth.h numbers it, or as segment-class.h does. */
	double cells[BENCH_TRUTH_CLASSES][SEGMENT_CLASSES];
	double points; /* that have a leaf */
	unsigned trees, trees_found;
	struct score_plants *plants;
};
segment_score *segment_score_new(void);
void segment_score_free(segment_score *s); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(segment_score, segment_score_free)

/* A scan with a grid; leaf and truth: of each cell. */
void segment_score_count(segment_score *s, const segments *tree, const struct scan_points *p,
	const uint16_t *leaf, const struct bench_truth_cell *truth);
/* Against the classes of the points; those without one do not count. */
void segment_score_count_told(
	segment_score *s, const segments *tree, const struct scan_points *p, const uint16_t *leaf);
/* When all scans are counted. */
void segment_score_count_trees(segment_score *s);

/* Intersection over union, or F1. NAN: too little of the class is there. */
double segment_score_of(const segment_score *s, int class, bool f1);
/* Of all classes that are there. */
double segment_score_mean(const segment_score *s, bool f1);
/* A table of cells, with IoU by class, trees that were not found, and what is to be reached; with f1, of what was told. Caller
 * frees. */
char *segment_score_text(const segment_score *s, bool f1);
/* The name of a row. */
const char *segment_score_row(int row, bool f1);

#endif
