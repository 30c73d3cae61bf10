#ifndef PROCESS_PYRAMID_H
#define PROCESS_PYRAMID_H
/* A scan as planes of rising size. Each level is a grid of equal angles whose cells are twice as wide as those of the level
 * below; a cell that looks at something has a surfel: the plane through the points of the cell and of those of its eight
 * neighbours that lie on the same surface.
 *
 * The points are read once, as sums over blocks (count, mean, products about the mean), and each level's sums come from the
 * level below. A plane is fitted along the beams, not across them, since that is where the noise of a range lies: with Q the
 * products about the mean and v the view, the normal is Q^-1 v, and the variance along the beam 1 / (v . Q^-1 v). This
 * is the fit of inverse ranges of Badino et al. 2011 ("Fast and accurate computation of surface normals from range
 * images"), with the constant taken out; it has no bias at grazing incidence, and asks for an adjugate instead of
 * eigenvectors.
 *
 * Const after it is made; keeps nothing of the grid. */
#include "process/range-grid.h"

#define PYRAMID_LEVELS 6

struct surfel {
	/* Mean of the cell's own points. Not of all that the plane was fitted to: on a vault that mean lies inside the curve,
	 * the further the longer the window, so two scans would see the vault at different places. */
	float point_m[3];
	float normal[3]; /* unit, towards the scanner */
	/* Standard deviation of the point along the normal, from the noise and the number of points; of what is no plane
	 * (foliage, an edge), of the points themselves. 0: no plane. */
	float sigma_m;
	float range_m; /* of what the cell itself looks at; 0: nothing */
};

struct pyramid_level {
	uint32_t columns, rows;
	struct surfel *surfel;
};

typedef struct pyramid pyramid;
struct pyramid {
	struct pyramid_level level[PYRAMID_LEVELS];
	double column_rad, row_rad; /* of a cell of level 0 */
	double azimuth_min_rad, elevation_max_rad;
	bool wraps;
	double noise_m; /* 1 sigma of a range, as the scan itself tells */
};

pyramid *pyramid_new(const range_grid *g);
/* With cells of level 0 of a quarter of a degree, not half of one, as far as the grid has such. */
pyramid *pyramid_new_narrow(const range_grid *g);
/* Without the vector instructions that the processor has, for tests. */
pyramid *pyramid_new_portable(const range_grid *g);
void pyramid_free(pyramid *p); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(pyramid, pyramid_free)

#endif
