#ifndef PROCESS_CHUNK_ORDER_H
#define PROCESS_CHUNK_ORDER_H
/* The order of the points inside a chunk: a permutation whose every prefix is spread evenly over the chunk's piece of the Morton
 * curve. It is van der Corput's sequence with Owen's scrambling (Owen 1995, "Randomly Permuted (t,m,s)-Nets and (t,s)-Sequences"),
 * drawn from the seed: each place is equally likely to come at any rank, and among the first 2^k ranks each 2^k-th part of the
 * chunk has exactly one. */
#include <stdint.h>

/* 0..4095: ret_place[rank] is a place along the curve, count of them, all below count; count 1..4096. When it is fewer than
 * 4096, a part that has lost places to the end of the chunk may have none. */
void chunk_order(uint64_t seed, uint32_t count, uint16_t ret_place[4096]);

/* The same order made even in space: points of every prefix keep apart from each other as far as so many can, so that they are blue noise
 * (progressive Poisson discs: dart throwing in the order above, with discs that become smaller by the root of two, each in how far
 * points are apart where it is). Of a prefix the density stays in proportion to that of the points. spacing_m: of each place, above 0;
 * its median is where to begin. */
void chunk_order_even(
	const double (*at_m)[3], const float *spacing_m, uint32_t count, uint16_t place[4096]);

#endif
