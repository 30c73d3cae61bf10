#ifndef SIM_CHANCE_H
#define SIM_CHANCE_H
/* Chance that can be repeated: a draw is a hash of what it is for (the seed, a stream, two
 * counters), so it does not depend on the order of the draws, on threads or on what else was drawn.
 */
#include <stdint.h>

/* What a draw is for; each has its own stream. */
enum chance_stream {
	CHANCE_RANGE = 1,
	CHANCE_INTENSITY,
	CHANCE_DROPOUT,
	CHANCE_CODE,
	CHANCE_CABLE,
	CHANCE_GARBLE,
	CHANCE_CLOCK,
	CHANCE_STAGE,
	CHANCE_PIXEL,
	CHANCE_FRAME,
	CHANCE_MIRROR,
};

uint64_t chance_hash(uint64_t seed, enum chance_stream stream, uint64_t a, uint64_t b);
double chance_uniform(uint64_t hash);     /* 0 <= u < 1 */
double chance_gauss(uint64_t hash);       /* mean 0, sigma 1, never beyond 6.7 */
double chance_exponential(uint64_t hash); /* mean 1 */

#endif
