#ifndef PROCESS_BENCH_OPEN3D_H
#define PROCESS_BENCH_OPEN3D_H
/* Open3D as people use it: a Python program that reads both clouds and tells the processor time of the calls alone. Its settings are
 * those of PCL beside it: normals of 20 neighbours; fine alignment of voxels of 0.25 m, partners to 1 m, at most 100 steps; coarse
 * alignment of voxels of 0.5 m, FPFH of 2.5 m, RANSAC of 100,000 draws. */
#include "process/bench-coarse.h"
#include "process/bench-fine.h"

#define BENCH_OPEN3D_WHY_NOT "not installed (apt install python3-open3d)"
bool bench_open3d_is_there(void);

/* As bench_pcl_normals. folder: for files on the way. */
bool bench_open3d_normals(const char *folder, const range_grid *g, float *const ret_normal[3],
	double *ret_cpu_s, GError **error);
/* method: BENCH_FINE_OPEN3D_GICP or BENCH_FINE_OPEN3D_PLANE. */
bool bench_open3d_fine(const char *folder, enum bench_fine_method method, const range_grid *a,
	const range_grid *b, const struct pose *start, struct bench_fine_run *ret, GError **error);
bool bench_open3d_coarse(const char *folder, const range_grid *a, const range_grid *b,
	struct bench_coarse_run *ret, GError **error);

#endif
