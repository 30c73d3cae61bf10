#ifndef PROCESS_BENCH_CLOUDCOMPARE_H
#define PROCESS_BENCH_CLOUDCOMPARE_H
/* CloudCompare by its command line. It tells no times of its calls alone, so what counts is the processor time of a run that does it, less
 * that of a run which only reads, and writes, the same clouds. */
#include "process/bench-fine.h"

#define BENCH_CLOUDCOMPARE_WHY_NOT "not installed (apt install cloudcompare)"
bool bench_cloudcompare_is_there(void);

/* Octree normals of 0.1 m around; the radius that it chooses itself (AUTO) is another one each time. As bench_pcl_normals. */
bool bench_cloudcompare_normals(const char *folder, const range_grid *g, float *const ret_normal[3],
	double *ret_cpu_s, GError **error);
/* Its ICP, point to point, of points that it draws at random, of which six tenths have a partner. */
bool bench_cloudcompare_fine(const char *folder, const range_grid *a, const range_grid *b,
	const struct pose *start, struct bench_fine_run *ret, GError **error);

#endif
