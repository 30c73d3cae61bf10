#ifndef PROCESS_NORMALS_H
#define PROCESS_NORMALS_H
/* The plane fits of one scan, all cells, as geometry*.c need them.
 *
 * A range is noisy along its ray, and only there. So the plane is not fitted to the points, which would tilt it, but to what was
 * measured: with directions (u, v, 1) in a frame that looks along the rays, the inverse depth w of a plane is linear in u and v,
 * and its normal is the three coefficients. That is a linear least squares fit, without bias and without eigenvectors.
 *
 * Which neighbours count. Between cells side by side is a link unless there is a depth edge between them. From each cell an arm
 * goes left and right as far as the window and the links let it; the window of a cell is the arms of all cells on its own arms
 * up and down (the cross-based windows of stereo matching, Zhang, Lu and Lafruit 2009). So nothing beyond an edge comes in, and
 * two passes over rows and columns sum it all up: relative to the cell's own depth, so that floats hold the sums. Four cells
 * side by side that are linked share a window; two of a column that are, what is above and below them. */
#include "process/range-grid.h"

/* A surface is tilted by about this much against the ray, if nothing is known: the slope that holds what the neighbours leave
 * open (a wire has no width). */
#define NORMALS_PRIOR_SLOPE 1.5f

struct normals_options {
	float radius_m, range_noise_m;
	const uint32_t *
		segment; /* leaf of each cell, 0: not known; no link between known ones that differ; NULL */
	bool single_thread;
	bool portable; /* without the vectors of this very processor: for tests */
};

/* Planes of all cells; those that are NULL are not filled. */
struct normals_planes {
	float *normal[3];
	float *error_m, *curvature;
	/* Distance of the fitted plane from the scanner, 0: none; negative where the fit leaves more than noise, for it reaches
	 * over a crease or takes in clutter. */
	float *offset_m;
	size_t offset_from; /* the cell that offset_m begins with; the others begin with the first */
	/* The neighbours, as they lie on the plane: how many, their centre, and the covariance xx xy xz yy yz zz. */
	float *count, *centre_m[3], *covariance_m2[6];
};

/* The fits; those that the two below are to mend must have all of normal, error_m, curvature and offset_m. */
void normals_fit(const range_grid *g, const struct normals_options *options,
	const struct normals_planes *ret);
/* Cells at creases take the plane of a neighbour's window that holds them and does not reach over the crease; those that the
 * fit left out, for they have no neighbours beside them, one of what is near in space. */
void normals_mend(const range_grid *g, const struct normals_options *options,
	const struct normals_planes *planes);
/* Both: the same planes, sooner. Needs no offset_m, and fills none. */
void normals_estimate(const range_grid *g, const struct normals_options *options,
	const struct normals_planes *ret);
/* 1 sigma of the ranges, from how they vary over smooth runs. Of a camera of depth, which tells it in steps that grow with its square, that of
 * the farther part of the scan. ret_at_m (may be NULL): how far away it is so much; 0: it is the same everywhere. */
float normals_range_noise_m(const range_grid *g, float *ret_at_m);

#endif
