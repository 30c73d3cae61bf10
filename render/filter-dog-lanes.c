#include "render/filter-dog.h"
#include "render/filter-lanes.h"

/* 0..1: how dark the line is. */
INLINE vf dark_at(const struct dog_pass *p, size_t at, size_t count)
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
	vi paper = { 0 };
	for (int k = 0; k < LANES; k++)
		memcpy((char *)&paper + 4 * k, i->paper, 4);
	g_autofree float *solid = g_new(float, i->width);
	for (uint32_t y = from; y < end; y++) {
		filter_solid_row(&p->solid, y, solid, i->width);
		for (uint32_t x = 0; x < i->width; x += LANES) {
			size_t at = (size_t)y * i->width + x;
			size_t count = MIN(LANES, i->width - x);
			vf part = dark_at(p, at, count) * some(solid + x, count) * s->opacity;
			vi pixel = paper, to = { 0 };
			if (!s->alone) {
				part *= weight_of(p->j, s->where, at, count);
				pixel = some_pixels((const uint8_t(*)[4])i->rgba + at, count);
			}
			for (int k = 0; k < 4; k++) {
				vf below = __builtin_convertvector(pixel >> 8 * k & 255, vf);
				/* The last is 255 and stays so. */
				if (k < 3)
					below += part * ((float)s->colour[k] - below);
				to |= __builtin_convertvector(below + 0.5f, vi) << 8 * k;
			}
			memcpy(i->spare[at], &to, 4 * count);
		}
	}
}
