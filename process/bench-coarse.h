#ifndef PROCESS_BENCH_COARSE_H
#define PROCESS_BENCH_COARSE_H
/* pleinair bench register, the other side: pairs of scans with no idea where they stand, as PCL and Open3D find them by features, of
 * voxels of 0.5 m, FPFH of 2.5 m around. What they find is right within 5 degrees and a metre, which a fine alignment may then
 * improve; ours is held to more. */
#include "process/range-grid.h"
#include <json-glib/json-glib.h>

#define BENCH_COARSE_RIGHT_RAD (5 * G_PI / 180)
#define BENCH_COARSE_RIGHT_M   1.0

struct bench_coarse_pair {
	range_grid *a, *b;
	struct pose truth; /* takes b to a */
	/* What ours made of it, on one thread. */
	bool ours_right;
	double ours_cpu_s;
};
struct bench_coarse_run {
	struct pose pose;
	double cpu_s; /* from points to pose */
};

/* Prints a line for each program, or adds an object to json when that is not NULL: how many of the pairs were right, and the
 * seconds of one. A program that is missing or fails is told so. Errors are of folders alone. */
bool bench_coarse(
	const struct bench_coarse_pair *pairs, uint32_t count, JsonArray *json, GError **error);

/* In bench-coarse_pcl.cpp: normals of 20 neighbours, FPFH, SampleConsensusPrerejective with 50,000 draws. */
bool bench_coarse_pcl(
	const range_grid *a, const range_grid *b, struct bench_coarse_run *ret, GError **error);

#endif
