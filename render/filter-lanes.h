#ifndef RENDER_FILTER_LANES_H
#define RENDER_FILTER_LANES_H
/* Eight pixels at a time, for filters: what acts at them, powers. All is inlined. */
#include "process/lanes.h"
#include "render/filter.h"

/* Of a plane, beyond whose end nothing is read. */
INLINE vf some(const float *from, size_t count)
{
	if (count == LANES)
		return load(from);
	vf ret = { 0 };
	memcpy(&ret, from, count * sizeof *from);
	return ret;
}

INLINE vi some_pixels(const uint8_t (*from)[4], size_t count)
{
	vi ret = { 0 };
	memcpy(&ret, from, count * sizeof *from);
	return ret;
}

/* filter_weight() */
INLINE vf weight_of(const struct filter_job *j, int32_t where, size_t at, size_t count)
{
	if (!filter_is_weighted(j, where))
		return all(1);
	vf away = some(j->image.away + at, count), part = where == WHERE_AWAY ? away : 1 - away;
	return 1 + j->f->focus.filters * (part - 1);
}

/* Of numbers above 0, within 0.0001. */
INLINE vf log2_of(vf x)
{
	vi bits_of = (vi)x;
	vf exponent = __builtin_convertvector((bits_of >> 23) - 127, vf);
	vf m = (vf)((bits_of & 0x7fffff) | 0x3f800000); /* 1 .. 2 */
	vf t = (m - 1.4142135f) / (m + 1.4142135f), t2 = t * t;
	return exponent + 0.5f + t * (2.885390f + t2 * (0.961796f + t2 * 0.58977f));
}

/* Within 0.0002 of it; 0 far below. */
INLINE vf exp2_of(vf x)
{
	x = least(most(x, all(-126)), all(126));
	vi whole = __builtin_convertvector(x + 256.5f, vi) - 256; /* the nearest */
	vf t = x - __builtin_convertvector(whole, vf);
	vf part = 1 + t * (0.693147f + t * (0.240227f + t * (0.055504f + t * 0.009618f)));
	return part * (vf)((whole + 127) << 23);
}

/* Of numbers from 0 on, within 0.0001. */
INLINE vf tanh_of(vf x)
{
	return 1 - 2 / (exp2_of(2.885390f * x) + 1);
}

INLINE vi floor_of(vf x)
{
	vi whole = __builtin_convertvector(x, vi);
	return whole + (vi)(__builtin_convertvector(whole, vf) > x);
}

#endif
