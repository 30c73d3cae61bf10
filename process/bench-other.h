#ifndef PROCESS_BENCH_OTHER_H
#define PROCESS_BENCH_OTHER_H
/* Programs of others that benches run beside ours, on the same points: CloudCompare, and Open3D through its Python. They are
 * looked for when a bench runs and are needed for nothing else. What they take is processor time of one thread, as ours is. */
#include "process/range-grid.h"
#include <glib.h>
#include <stdbool.h>

/* Debian's Python, or that of PATH, that has these modules ("open3d", or more with commas); NULL: neither has. */
const char *bench_python(const char *modules);

/* A binary PLY of the points that were measured, row by row, in the scanner's frame or as moved takes them. */
bool bench_other_write(
	const range_grid *g, const struct pose *moved, const char *path, GError **error);

struct bench_other_run {
	char *output; /* stdout and stderr; caller frees */
	double cpu_s; /* of all its threads */
};
/* Runs argv in a folder, with one thread where it lets itself be told, for ten minutes at most. name is how errors call it. */
bool bench_other_run(const char *name, const char *folder, const char *const *argv,
	struct bench_other_run *ret, GError **error);

/* Planes of the grid's cells from x y z of each measured one, which come every `stride` floats. */
void bench_other_spread(
	const range_grid *g, const float *normals, size_t stride, float *const ret_normal[3]);

/* 16 numbers, row by row, as files and programs round them. false: they are no pose. */
bool bench_other_pose(const double m[16], struct pose *ret);

#endif
