#ifndef PROCESS_POSE_GRAPH_CHOLESKY_H
#define PROCESS_POSE_GRAPH_CHOLESKY_H
/* A symmetric positive definite matrix of 6x6 blocks, most of them zero: factored in an order of least degree (George and Liu
 * 1989), solved, and of its inverse the blocks on the diagonal (Takahashi, Fagan and Chin 1973), all without a dense matrix.
 * The pattern is fixed when it is made; the values are then set as often as one likes. Not thread-safe. */
#include <glib.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef double block6[6][6];
typedef struct cholesky cholesky;

/* pair: the blocks off the diagonal that may be there, in any order, also twice; none of a node with itself. */
cholesky *cholesky_new(size_t nodes, const uint32_t (*pair)[2], size_t pairs);
void cholesky_free(cholesky *c); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(cholesky, cholesky_free)

void cholesky_clear(cholesky *c); /* all values to zero */
void cholesky_add_diagonal(cholesky *c, uint32_t node, const block6 value);
/* To the block of row a, column b, and so its transpose to b, a. */
void cholesky_add(cholesky *c, uint32_t a, uint32_t b, const block6 value);
/* The matrix plus damping times its own diagonal. false: it is not positive definite. The values are kept. */
bool cholesky_factor(cholesky *c, double damping);
void cholesky_solve(const cholesky *c, double *x); /* 6 a node, in place */
/* The blocks on the diagonal of the inverse. */
void cholesky_inverse(const cholesky *c, block6 *ret);

#endif
