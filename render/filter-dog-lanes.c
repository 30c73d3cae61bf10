#include "render/filter-dog.h"
#include "render/filter-lanes.h"

/* Of a row, beyond whose end nothing is read. */
INLINE vf some(const float *from, uint32_t count)
{
	if (count == LANES)
		return load(from);
	vf ret = { 0 };
	memcpy(&ret, from, count * sizeof *from);
	return ret;
}

/* 0..1: how dark the line is. */
INLINE vf dark_at(const struct dog_pass *p, size_t at, uint32_t count)
{
	const struct dog_step *s = p->step;
	vf d = p->difference
		       ? some(p->difference + at, count)
		       : DOG_COMBINED(s, some(p->fine + at, count), some(p->coarse + at, count));
	return tanh_of(s->contrast * most(s->threshold - d, all(0)));
}

void LANES_NAME(filter_dog_rows)(const void *data, uint32_t from, uint32_t end)
{
	const struct dog_pass *p = data;
	const struct filter_image *i = &p->j->image;
	const struct dog_step *s = p->step;
	bool is_weighted = !s->alone && filter_is_weighted(p->j, s->where);
	g_autofree float *solid = g_new(float, i->width);
	for (uint32_t y = from; y < end; y++) {
		filter_solid_row(&p->solid, y, solid, i->width);
		for (uint32_t x = 0; x < i->width; x += LANES) {
			size_t at = (size_t)y * i->width + x;
			uint32_t count = MIN(LANES, i->width - x);
			vf part = dark_at(p, at, count) * some(solid + x, count) * s->opacity;
			for (uint32_t k = 0; is_weighted && k < count; k++)
				part[k] *= filter_weight(p->j, s->where, at + k);
			vi pixel = { 0 }, to = { 0 };
			for (uint32_t k = 0; s->alone && k < LANES; k++)
				memcpy((char *)&pixel + 4 * k, i->paper, 4);
			if (!s->alone)
				memcpy(&pixel, i->rgba[at], 4 * (size_t)count);
			for (int k = 0; k < 4; k++) {
				vf below = __builtin_convertvector(pixel >> 8 * k & 255, vf);
				/* The last is 255 and stays so. */
				if (k < 3)
					below += part * ((float)s->colour[k] - below);
				to |= __builtin_convertvector(below + 0.5f, vi) << 8 * k;
			}
			memcpy(i->spare[at], &to, 4 * (size_t)count);
		}
	}
}
