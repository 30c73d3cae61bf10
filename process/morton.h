#ifndef PROCESS_MORTON_H
#define PROCESS_MORTON_H
/* Morton codes on a lattice that is fixed in the site's frame: 21 bits an axis, x the lowest. The lattice is the same for every
 * scan, so the codes of one do not change when another comes. Its cells are 1 mm times a power of two: 1 mm spans 2 km, which
 * most sites fit in; larger ones take the next finer that holds them. */
#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#define MORTON_AXIS_BITS 21
#define MORTON_HALF      (1 << (MORTON_AXIS_BITS - 1))
#define MORTON_LEVEL_MAX 30 /* a million kilometres */

/* Edge of a cell. */
static inline double morton_cell_m(unsigned level)
{
	return ldexp(0.001, (int)level);
}

/* Spreads 21 bits to every third of 63. */
static inline uint64_t morton_spread(uint64_t v)
{
	v &= 0x1FFFFF;
	v = (v | v << 32) & 0x001F00000000FFFFu;
	v = (v | v << 16) & 0x001F0000FF0000FFu;
	v = (v | v << 8) & 0x100F00F00F00F00Fu;
	v = (v | v << 4) & 0x10C30C30C30C30C3u;
	return (v | v << 2) & 0x1249249249249249u;
}

static inline uint32_t morton_gather(uint64_t v)
{
	v &= 0x1249249249249249u;
	v = (v ^ v >> 2) & 0x10C30C30C30C30C3u;
	v = (v ^ v >> 4) & 0x100F00F00F00F00Fu;
	v = (v ^ v >> 8) & 0x001F0000FF0000FFu;
	v = (v ^ v >> 16) & 0x001F00000000FFFFu;
	return (uint32_t)((v ^ v >> 32) & 0x1FFFFF);
}

/* A cell's numbers, each -MORTON_HALF..MORTON_HALF-1, and where in the cell, in 65536ths. */
struct morton_place {
	uint64_t code;
	uint16_t within[3];
};

/* false: outside the lattice. */
static inline bool morton_from_point(
	const double point_m[3], double cell_m, struct morton_place *ret)
{
	*ret = (struct morton_place){ 0 };
	for (int i = 0; i < 3; i++) {
		double at = point_m[i] / cell_m, cell = floor(at);
		if (!(cell >= -MORTON_HALF && cell < MORTON_HALF))
			return false;
		ret->code |= morton_spread((uint64_t)((int64_t)cell + MORTON_HALF)) << i;
		ret->within[i] = (uint16_t)fmin((at - cell) * 65536.0, 65535);
	}
	return true;
}

static inline void morton_to_point(const struct morton_place *p, double cell_m, double ret_m[3])
{
	for (int i = 0; i < 3; i++)
		ret_m[i] = cell_m * ((double)morton_gather(p->code >> i) - MORTON_HALF +
					    (p->within[i] + 0.5) / 65536.0);
}

#endif
