#include "process/lanes.h"
#include "render/filter-planes.h"

/* Of 256, what is written counts. */
INLINE vi part_of(const struct filter_mix_job *m, vf away)
{
	vf part = m->where == WHERE_AWAY ? away : 1 - away;
	vf weight = 1 + m->j->f->focus.filters * (part - 1);
	return __builtin_convertvector(clamp01(weight * m->times - m->less) * 256 + 0.5f, vi);
}

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
		vf away = { 0 };
		vi was = { 0 }, is = { 0 };
		memcpy(&away, i->away + at, count * sizeof(float));
		memcpy(&was, i->rgba[at], 4 * count);
		memcpy(&is, i->spare[at], 4 * count);
		is = mixed(was, is, part_of(m, away));
		memcpy(i->spare[at], &is, 4 * count);
	}
}
