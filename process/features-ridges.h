#ifndef PROCESS_FEATURES_RIDGES_H
#define PROCESS_FEATURES_RIDGES_H
/* The feature points that lines are fitted to: of edges, which are some cells wide, those that are as high as the ones beside them, at
 * creases moved to the cut of the planes on both sides. Found once, then looked around in many times, on any number of threads. */
#include "process/features-private.h"

#define RIDGE_LEVELS 3

/* A feature point, in its scanner's frame. */
struct ridge_point {
	float x, y, z, weight;
	float cut[3];  /* its direction; 0 0 0: none, else the point is moved there */
	uint16_t leaf; /* 0: not known */
};

/* Those of squares of cells side by side, for a window looks at few of many; of every cell, of every second diagonal, of every
 * fourth. */
struct ridge_tiles {
	uint32_t size, across; /* cells, tiles in a row of them */
	uint32_t *first;       /* of each tile, and the end */
	float *x, *y, *z; /* of the points, side by side: most are only found to be too far away */
	struct ridge_point *point;
};

/* Which cells are feature points as high as those beside them: a bit each, rows begin with whole words; those of a word begin at
 * its place. */
struct features_ridges {
	const range_grid *grid;
	uint32_t words; /* of a row */
	uint64_t *bits;
	uint32_t *place;
	struct ridge_point *point;
	struct ridge_tiles tiles[RIDGE_LEVELS];
};

/* Of a cell that is one. */
static inline const struct ridge_point *ridges_at(
	const features_ridges *r, uint32_t row, uint32_t column)
{
	size_t word = (size_t)row * r->words + column / 64;
	return r->point + r->place[word] +
	       __builtin_popcountll(r->bits[word] & (((uint64_t)1 << column % 64) - 1));
}

static inline bool ridges_has(const features_ridges *r, uint32_t row, uint32_t column)
{
	return r->bits[(size_t)row * r->words + column / 64] >> column % 64 & 1;
}

/* Of the cells so many cells around, and itself: how many are. */
#define RIDGES_NEAR 4
uint32_t ridges_count(const features_ridges *r, uint32_t row, uint32_t column);

static inline bool ridge_has_cut(const struct ridge_point *p)
{
	return p->cut[0] != 0 || p->cut[1] != 0 || p->cut[2] != 0;
}

/* Where one scan is looked around in. */
struct ridges_window {
	const features_ridges *ridges;
	uint8_t frame;             /* of what is kept: this one */
	uint16_t leaf;             /* of the point; 0: not known */
	double at[3];              /* in the frame of the ridges */
	float radius_m, spacing_m; /* spacing of its own scan's beams there */
	bool is_cut;               /* the point is moved to a cut */
};
/* Adds what is around the place, where the cell of its grid looks. */
void ridges_look_around(const struct ridges_window *w, uint32_t cell, struct feature_around *a);

#endif
