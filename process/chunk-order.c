#include "process/chunk-order.h"
#include <glib.h>

#define BITS  12
#define COUNT (1u << BITS)

/* SplitMix64 (Steele, Lea and Flood 2014). */
static uint64_t next(uint64_t *state)
{
	uint64_t z = *state += 0x9E3779B97F4A7C15u;
	z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9u;
	z = (z ^ z >> 27) * 0x94D049BB133111EBu;
	return z ^ z >> 31;
}

/* Scrambling is a coin for every node of the binary tree over the places: heads swaps its halves. Node 1 is the root, node n has
 * the halves 2 n and 2 n + 1. */
static void toss(uint64_t seed, uint64_t coins[COUNT / 64])
{
	for (uint32_t i = 0; i < COUNT / 64; i++)
		coins[i] = next(&seed);
}

/* The rank's lowest bit chooses the half of the chunk, the next the quarter of it, and so on. */
static uint32_t place_of(uint32_t rank, const uint64_t coins[COUNT / 64])
{
	uint32_t node = 1;
	for (uint32_t bit = 0; bit < BITS; bit++)
		node = 2 * node + ((rank >> bit ^ (uint32_t)(coins[node / 64] >> node % 64)) & 1);
	return node - COUNT;
}

void chunk_order(uint64_t seed, uint32_t count, uint16_t ret_place[4096])
{
	uint64_t coins[COUNT / 64];
	uint32_t found = 0;
	g_assert(count >= 1 && count <= COUNT);
	toss(seed, coins);
	for (uint32_t rank = 0; rank < COUNT; rank++) {
		uint32_t place = place_of(rank, coins);
		if (place < count)
			ret_place[found++] = (uint16_t)place;
	}
	g_assert(found == count);
}
