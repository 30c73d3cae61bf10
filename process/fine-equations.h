#ifndef PROCESS_FINE_EQUATIONS_H
#define PROCESS_FINE_EQUATIONS_H
/* Normal equations of six unknowns, and what they say of the solution. */
#include "process/pose.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct equations {
	double matrix[6][6]; /* the upper half is summed, equations_mirror fills the lower */
	double right[6];
	double slope[6][6];  /* of the right side, negative; only where tiles are summed */
	double weight;       /* sum of weights */
	double point_m[3];   /* sum of weight * point */
	double square_m2;    /* sum of weight * point^2 */
	double distance2_m2; /* sum of weight * distance^2 */
	uint32_t pairs;
};

void equations_mirror(struct equations *e);
/* matrix * x = right, by Cholesky; false when it is singular. */
bool equations_solve(const double matrix[6][6], const double right[6], double ret[6]);
bool equations_invert(const double matrix[6][6], double ret[6][6]);
/* Of a symmetric matrix, rising; Jacobi. */
void equations_eigenvalues(const double matrix[6][6], double ret[6]);
/* Turned about the mean of the points instead of the origin, rotations as lengths at their mean distance from it, and
 * divided by the sum of weights. */
void equations_scale(const struct equations *e, double ret[6][6]);

#endif
