#ifndef RENDER_STROKE_PACK_LANES_H
#define RENDER_STROKE_PACK_LANES_H
/* What stroke_pack() and stroke_unpack() do, for all lanes at once. Internal to files *-lanes.c; all is inlined. */
#include "process/lanes.h"
#include "render/stroke-pack.h"

INLINE vi packed_along(vf x)
{
	vf half = choose(x < 0, all(-0.5f), all(0.5f));
	return __builtin_convertvector(x * STROKE_ALONG + half, vi) & 0xffff;
}

/* In parts of STROKE_ALONG. */
INLINE vf first_along(vi both)
{
	return __builtin_convertvector(both << 16 >> 16, vf);
}

INLINE vf second_along(vi both)
{
	return __builtin_convertvector(both >> 16, vf);
}

INLINE vi packed_length(vf px)
{
	vi ret = ((vi)px - STROKE_LENGTH_LEAST + (1 << (STROKE_LENGTH_SHIFT - 1))) >>
		 STROKE_LENGTH_SHIFT;
	return lower(higher(ret, (vi){ 0 }), 0xffff + (vi){ 0 });
}

INLINE vf first_length(vi both)
{
	return (vf)(((both & 0xffff) << STROKE_LENGTH_SHIFT) + STROKE_LENGTH_LEAST);
}

INLINE vf second_length(vi both)
{
	return first_length((vi)((vu)both >> 16));
}

INLINE vi packed_slope(vf x)
{
	return (vi)(((vu)x + 0x8000) >> 16);
}

#endif
