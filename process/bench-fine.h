#ifndef PROCESS_BENCH_FINE_H
#define PROCESS_BENCH_FINE_H
/* pleinair bench process, fine alignment: ours beside generalised and point-to-plane ICP by PCL and Open3D, and ICP by CloudCompare, on
 * the same two scans, from the same starts. */
#include "process/range-grid.h"
#include <json-glib/json-glib.h>

struct bench_fine_input {
	const range_grid *a, *b;
	struct pose exact; /* takes b to a */
};
/* Prints a table, or, when json is not NULL, adds what it measured: per method the least CPU time of preparing both scans and
 * aligning them, on one thread, and the median and worst error against the true pose. Programs of others that are missing or
 * fail are told to be so. folder: for files on the way. */
bool bench_fine(const struct bench_fine_input *in, const char *folder, uint32_t trials,
	JsonArray *json, GError **error);

/* ---- the other side: bench-fine_pcl.cpp ---- */

enum bench_fine_method {
	BENCH_FINE_OURS,
	BENCH_FINE_GICP,
	BENCH_FINE_PLANE,
	BENCH_FINE_OPEN3D_GICP,
	BENCH_FINE_OPEN3D_PLANE,
	BENCH_FINE_CLOUDCOMPARE,
	BENCH_FINE_METHODS
};

struct bench_fine_run {
	struct pose pose;
	double prepare_s, align_s; /* CPU time of the process */
	bool converged;
};

/* Voxels of 0.25 m and, for point-to-plane, normals of 20 neighbours; partners to 1 m, at most 100 steps, in double. */
bool bench_fine_pcl(enum bench_fine_method method, const range_grid *a, const range_grid *b,
	const struct pose *start, struct bench_fine_run *ret, GError **error);

#endif
