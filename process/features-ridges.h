#ifndef PROCESS_FEATURES_RIDGES_H
#define PROCESS_FEATURES_RIDGES_H
/* The feature points that lines are fitted to: of edges, which are some cells wide, those that are as high as the ones beside them. Of a
 * view, in the frame of the scan whose lines are fitted, at creases moved to the cut of the planes on both sides. Found once, then
 * looked around in many times, on any number of threads. */
#include "process/features-private.h"

#define RIDGE_LEVELS 3

/* A feature point, in the frame of the scan whose lines are fitted. */
struct ridge_point {
	float x, y, z, weight;
	uint32_t cell;
	float cut[3]; /* its direction; 0 0 0: none, else the point is moved there */
};

/* Those of squares of cells side by side, for a window looks at few of many; of every cell, of every second diagonal, of every
 * fourth. */
struct ridge_tiles {
	uint32_t size, across; /* cells, tiles in a row of them */
	uint32_t *first;       /* of each tile, and the end */
	struct ridge_point *point;
};

/* Which cells are feature points as high as those beside them: a bit each, rows begin with whole words; those of a word begin at
 * its place. */
struct ridges {
	uint32_t words; /* of a row */
	uint64_t *bits;
	uint32_t *place;
	struct ridge_point *point;
	struct ridge_tiles tiles[RIDGE_LEVELS];
};

/* Of a cell that is one. */
static inline const struct ridge_point *ridges_at(
	const struct ridges *r, uint32_t row, uint32_t column)
{
	size_t word = (size_t)row * r->words + column / 64;
	return r->point + r->place[word] +
	       __builtin_popcountll(r->bits[word] & (((uint64_t)1 << column % 64) - 1));
}

static inline bool ridges_has(const struct ridges *r, uint32_t row, uint32_t column)
{
	return r->bits[(size_t)row * r->words + column / 64] >> column % 64 & 1;
}

/* Of the cells so many cells around, and itself: how many are. rows: of the grid. */
#define RIDGES_NEAR 4
uint32_t ridges_count(const struct ridges *r, uint32_t rows, uint32_t row, uint32_t column);

static inline bool ridge_has_cut(const struct ridge_point *p)
{
	return p->cut[0] != 0 || p->cut[1] != 0 || p->cut[2] != 0;
}

/* least: degree of a feature point; to_scan: from the view's frame, NULL: it is the scan itself. */
struct ridges ridges_find(const struct features_view *v, const struct pose *to_scan, uint8_t least,
	bool single_thread);
void ridges_clear(struct ridges *r);

/* Where one view is looked around in. */
struct ridges_window {
	const struct features_view *view;
	const struct ridges *ridges;
	uint16_t leaf; /* of the point; 0: not known */
	float here[3], radius_m,
		spacing_m; /* in the scan's frame; the spacing of its beams there */
	bool is_cut;       /* the point is moved to a cut */
};
/* Adds what is around a place, `at` in the view's frame, where its cell looks. */
void ridges_look_around(
	const struct ridges_window *w, uint32_t cell, const double at[3], struct feature_around *a);

#endif
