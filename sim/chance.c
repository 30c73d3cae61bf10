#include "sim/chance.h"
#include <math.h>

/* The finalizer of SplitMix64 (Steele, Lea, Flood 2014). */
static uint64_t mix(uint64_t x)
{
	x ^= x >> 30;
	x *= 0xbf58476d1ce4e5b9u;
	x ^= x >> 27;
	x *= 0x94d049bb133111ebu;
	return x ^ x >> 31;
}

uint64_t chance_hash(uint64_t seed, enum chance_stream stream, uint64_t a, uint64_t b)
{
	const uint64_t golden = 0x9e3779b97f4a7c15u;
	uint64_t h = mix(seed + golden * (uint64_t)stream);

	h = mix(h + golden + a);
	return mix(h + golden + b);
}

double chance_uniform(uint64_t hash)
{
	return (double)(hash >> 11) * 0x1p-53;
}

double chance_gauss(uint64_t hash)
{
	double u = ((double)(hash >> 32) + 0.5) * 0x1p-32, v = (double)(uint32_t)hash * 0x1p-32;

	return sqrt(-2 * log(u)) * cos(2 * M_PI * v);
}

double chance_exponential(uint64_t hash)
{
	return -log1p(-chance_uniform(hash));
}
