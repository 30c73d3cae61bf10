#ifndef PROCESS_VOXEL_SHAPE_H
#define PROCESS_VOXEL_SHAPE_H
/* What the surface does around each voxel, from those linked to it. */
#include "process/voxels.h"

struct voxel_shape {
	float scatter; /* smallest eigenvalue of the places over the sum of all, 0..1/3 (Weinmann et al. 2015) */
	float linear;  /* (largest - middle) / largest, 0..1 */
	float spread;  /* of the normals: 1 - the length of their mean, 0..1 */
	float error_m; /* of the plane fits, mean over the links */
	float rough; /* 0..1, of scatter and spread, smoothed over the links: foliage is above a half */
};
/* Of all voxels; caller frees. Voxels must be linked. */
struct voxel_shape *voxel_shapes(const voxels *v);
/* Eigenvalues of the symmetric matrix xx xy xz yy yz zz, the largest first. */
void symmetric_eigenvalues(const double m[6], double ret[3]);

#endif
