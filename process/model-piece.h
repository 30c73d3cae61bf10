#ifndef PROCESS_MODEL_PIECE_H
#define PROCESS_MODEL_PIECE_H
/* Pieces of the curve, each of whole chunks: section "pieces" of a model. Space is divided into blocks of about a metre, and of
 * MODEL_PIECE_BLOCKS blocks that hold points, one by chance begins a piece: a hash of its own place decides. So a piece depends
 * on the points between its own ends alone, and what stays the same there stays the same in the file. */
#include "process/model-part.h"

#define MODEL_BLOCK_M      1.0
#define MODEL_PIECE_BLOCKS 32u

struct model_piece {
	uint64_t code; /* of its first block's first cell; 0 for the first piece of a leaf */
	uint64_t first_chunk;
	uint32_t leaf, reserved;
};
_Static_assert(sizeof(struct model_piece) == 24, "the file's own layout");

/* A code without this many of its lowest bits is that of a cube, of at least this size if the lattice goes so far. */
static inline unsigned model_cube_shift(double size_m, double cell_m)
{
	unsigned bits = 0;
	while (bits < MORTON_AXIS_BITS && ldexp(cell_m, (int)bits) < size_m)
		bits++;
	return 3 * bits;
}

/* block: a code, shifted. */
static inline bool model_block_begins_piece(uint64_t block)
{
	uint64_t v = block + 0x9E3779B97F4A7C15u; /* as SplitMix64 (Steele et al. 2014) */
	v = (v ^ v >> 30) * 0xBF58476D1CE4E5B9u;
	v = (v ^ v >> 27) * 0x94D049BB133111EBu;
	return (v ^ v >> 31) % MODEL_PIECE_BLOCKS == 0;
}

#endif
