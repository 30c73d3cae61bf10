#include "render/filter-lanes.h"
#include "render/filter-planes.h"

/* part: what is written counts, of 256. */
INLINE vi mixed(vi was, vi is, vi part)
{
	vi ret = { 0 };
	for (int k = 0; k < 4; k++) {
		vi from = was >> 8 * k & 255, to = is >> 8 * k & 255;
		ret |= (from + (((to - from) * part + 128) >> 8)) << 8 * k;
	}
	return ret;
}

void LANES_NAME(filter_mix_rows)(const void *data, uint32_t from, uint32_t end)
{
	const struct filter_mix_job *m = data;
	const struct filter_image *i = &m->j->image;
	size_t at = (size_t)from * i->width, last = (size_t)end * i->width;
	for (; at < last; at += LANES) {
		size_t count = MIN(LANES, last - at);
		vf weight = weight_of(m->j, m->where, at, count) * m->times - m->less;
		vi is = mixed(some_pixels((const uint8_t(*)[4])i->rgba + at, count),
			some_pixels((const uint8_t(*)[4])i->spare + at, count),
			__builtin_convertvector(clamp01(weight) * 256 + 0.5f, vi));
		memcpy(i->spare[at], &is, 4 * count);
	}
}
