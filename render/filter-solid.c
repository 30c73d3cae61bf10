#include "render/filter-tables.h"
#include "render/grain.h"
#include <math.h>
#include <string.h>

/* ---- solid or not ---- */

/* Parts of the surroundings that something is in. A straight border has half of them, a corner a quarter. */
#define SOLID_NOT 0.10f
#define SOLID_ALL 0.24f
/* It is asked for blocks of so many pixels a side. */
#define BLOCK FILTER_SOLID_BLOCK

struct counting {
	const struct filter_image *image;
	struct filter_solid solid;
};

static void count_rows(const void *data, uint32_t from, uint32_t end)
{
	const struct counting *c = data;
	const struct filter_image *i = c->image;
	for (uint32_t y = from; y < end; y++) {
		float *to = c->solid.part + (size_t)y * c->solid.width;
		memset(to, 0, c->solid.width * sizeof *to);
		uint32_t below = MIN((y + 1) * BLOCK, i->height);
		for (uint32_t at_y = y * BLOCK; at_y < below; at_y++) {
			const float *row = i->depth_m + (size_t)at_y * i->width;
			for (uint32_t x = 0; x < i->width; x++)
				to[x / BLOCK] += row[x] < FILTER_FAR;
		}
		for (uint32_t x = 0; x < c->solid.width; x++)
			to[x] /= (float)((MIN((x + 1) * BLOCK, i->width) - x * BLOCK) *
					 (below - y * BLOCK));
	}
}

struct filter_solid filter_solidity(struct filter_job *j, uint32_t part)
{
	struct counting c = { &j->image, { (j->image.width + BLOCK - 1) / BLOCK,
						 (j->image.height + BLOCK - 1) / BLOCK, NULL } };
	size_t blocks = (size_t)c.solid.width * c.solid.height;
	/* Counts stand behind what they become. */
	float *whole = filter_room_part(j->room, part, 2 * blocks * sizeof(float));
	c.solid.part = whole + blocks;
	filter_each_rows(j, count_rows, &c, c.solid.height, 16);
	struct filter_blur b = { c.solid.part, whole, false, c.solid.width, c.solid.height, 1, 0,
		NULL };
	filter_blur_run(j, &b, FILTER_SOLID_SIGMA_PX * j->px / BLOCK);
	c.solid.part = whole;
	for (size_t n = 0; n < blocks; n++)
		whole[n] = grain_step(SOLID_NOT, SOLID_ALL, whole[n]);
	return c.solid;
}

/* ---- noise ---- */

void filter_noise_look(struct filter_noise_job *n, const frame *f)
{
	for (int k = 0; k < 3; k++)
		for (int o = 0; o < FILTER_NOISE_OCTAVES; o++) {
			double at = ldexp(f->eye_m[k], -(o + FILTER_NOISE_LOWEST)),
			       whole = floor(at);
			n->cell[k][o] = (int32_t)(uint32_t)(int64_t)whole;
			n->within[k][o] = (float)(at - whole);
		}
}

const float *filter_noise(struct filter_job *j, uint32_t part, float grain_px, uint32_t seed)
{
	struct filter_noise_job n = { .j = j,
		.grain_px = fmaxf(grain_px, 1),
		.seed = seed,
		.to = filter_room_part(j->room, part, filter_pixels(&j->image) * sizeof(float)) };
	filter_noise_look(&n, j->f);
	filter_each_rows(j, LANES_OF(j->lanes, filter_noise_rows), &n, j->image.height, 16);
	return n.to;
}
