#ifndef PROCESS_COARSE_UPRIGHT_H
#define PROCESS_COARSE_UPRIGHT_H
/* Which way is up in a scan that was not levelled? Up is the direction that many surfaces face from one height below the
 * scanner, that most others stand along, and below whose ground there is nothing. */
#include "process/coarse-check.h"

struct coarse_upright {
	struct pose level; /* takes the scanner frame to one whose +z is up; no translation */
	double score;      /* comparable within one scan */
};

/* Candidates that are at least 20 degrees apart, best first; at most max. The samples are spread evenly over all surfaces. */
size_t coarse_upright_find(
	const struct coarse_sample *sample, size_t count, struct coarse_upright *ret, size_t max);

/* The turn that takes a unit vector to +z on the shortest way. */
struct pose coarse_upright_pose(const double up[3]);

#endif
