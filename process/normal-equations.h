#ifndef PROCESS_NORMAL_EQUATIONS_H
#define PROCESS_NORMAL_EQUATIONS_H
/* A few unknowns by least squares: information * step = gradient, where the information (J^T W J) is symmetric, row by row, n x n.
 * By OpenCV. Pure. */
#include <stdbool.h>
#include <stddef.h>
#ifdef __cplusplus
extern "C" {
#endif

/* false: the information does not tell all unknowns. ret_covariance, its inverse, may be NULL. */
bool normal_equations_solve(const double *information, const double *gradient, size_t n,
	double *ret_step, double *ret_covariance);
/* Eigenvalues of a symmetric matrix, falling, and the vectors that belong to them, a row each. */
void normal_equations_eigen(
	const double *matrix, size_t n, double *ret_values, double *ret_vectors);

#ifdef __cplusplus
}
#endif
#endif
