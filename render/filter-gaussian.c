/* Blur, and gaps that are closed. */
#include "render/filter-tables.h"
#include <math.h>

void filter_gaussian(struct filter_job *j, const struct step *s)
{
	struct filter_blur b = { j->image.rgba, j->image.spare, true, j->image.width,
		j->image.height, 4, 0, NULL };
	filter_blur_run(j, &b, s->gaussian.sigma_px * j->px);
	filter_finish(j, s->gaussian.where);
}

/* ---- gaps ---- */

struct closing {
	struct filter_image *image;
	int radius;
	float *depth_m; /* as it becomes */
	/* Of blocks of pixels: whether something is in them; and in any that a gap in them is closed by. */
	uint32_t across, down;
	uint8_t *there, *near;
};
#define BLOCK 8

struct around {
	float rgb[3], depth_m, weight;
	unsigned sides; /* a bit for each eighth of the circle where something is */
};

static void add_around(const struct closing *c, int x, int y, int dx, int dy, struct around *a)
{
	const struct filter_image *i = c->image;
	int at_x = x + dx, at_y = y + dy;
	if (at_x < 0 || at_y < 0 || at_x >= (int)i->width || at_y >= (int)i->height)
		return;
	size_t at = (size_t)at_y * i->width + (size_t)at_x;
	if (i->depth_m[at] >= FILTER_FAR)
		return;
	float weight = 1 / (float)(dx * dx + dy * dy);
	for (int k = 0; k < 3; k++)
		a->rgb[k] += weight * (float)i->rgba[at][k];
	a->depth_m += weight * i->depth_m[at];
	a->weight += weight;
	a->sides |= 1u << ((dx > 0) | (dy > 0) << 1 | (abs(dx) > abs(dy)) << 2);
}

/* What has something on most sides is a gap; what lies beside a thing is not. */
#define SIDES_LEAST 6

static void there_rows(const void *data, uint32_t from, uint32_t end)
{
	const struct closing *c = data;
	const struct filter_image *i = c->image;
	memset(c->there + (size_t)from * c->across, 0, (size_t)(end - from) * c->across);
	for (uint32_t y = from * BLOCK; y < MIN(end * BLOCK, i->height); y++) {
		const float *row = i->depth_m + (size_t)y * i->width;
		uint8_t *to = c->there + (size_t)(y / BLOCK) * c->across;
		for (uint32_t x = 0; x < i->width; x++)
			to[x / BLOCK] |= row[x] < FILTER_FAR;
	}
}

static void near_rows(const void *data, uint32_t from, uint32_t end)
{
	const struct closing *c = data;
	int reach = (c->radius + BLOCK - 1) / BLOCK;
	for (int y = (int)from; y < (int)end; y++)
		for (int x = 0; x < (int)c->across; x++) {
			uint8_t any = 0;
			for (int b = MAX(y - reach, 0); b <= MIN(y + reach, (int)c->down - 1); b++)
				for (int a = MAX(x - reach, 0);
					a <= MIN(x + reach, (int)c->across - 1); a++)
					any |= c->there[b * (int)c->across + a];
			c->near[y * (int)c->across + x] = any;
		}
}

static void close_rows(const void *data, uint32_t from, uint32_t end)
{
	const struct closing *c = data;
	const struct filter_image *i = c->image;
	int step = gaps_step_px(c->radius), reach = c->radius / step * step;
	for (uint32_t y = from; y < end; y++)
		for (uint32_t x = 0; x < i->width; x++) {
			size_t at = (size_t)y * i->width + x;
			struct around a = { 0 };
			memcpy(i->spare[at], i->rgba[at], 4);
			c->depth_m[at] = i->depth_m[at];
			if (i->depth_m[at] < FILTER_FAR ||
				!c->near[(y / BLOCK) * c->across + x / BLOCK])
				continue;
			for (int dy = -reach; dy <= reach; dy += step)
				for (int dx = -reach; dx <= reach; dx += step)
					if ((dx || dy) &&
						dx * dx + dy * dy <= c->radius * c->radius)
						add_around(c, (int)x, (int)y, dx, dy, &a);
			if (__builtin_popcount(a.sides) < SIDES_LEAST)
				continue;
			for (int k = 0; k < 3; k++)
				a.rgb[k] /= a.weight;
			filter_put(i->spare[at], a.rgb);
			c->depth_m[at] = a.depth_m / a.weight;
		}
}

/* Where nobody says: as wide as points ask for that are a little farther apart than most. */
#define OF_SPACING 1.2f
int gaps_radius(const struct gaps_step *s, float px, float spacing_px)
{
	float radius = s->radius_px * px;
	if (s->radius_px <= 0)
		radius = fminf(OF_SPACING * spacing_px, GAPS_RADIUS_MOST_PX * px);
	return MAX((int)rintf(radius), 1);
}

void filter_gaps(struct filter_job *j, const struct step *s)
{
	struct closing c = { &j->image, gaps_radius(&s->gaps, j->px, j->spacing_px),
		filter_room_part(j->room, 0, filter_pixels(&j->image) * sizeof(float)) };
	c.across = (j->image.width + BLOCK - 1) / BLOCK;
	c.down = (j->image.height + BLOCK - 1) / BLOCK;
	c.there = filter_room_part(j->room, 1, 2 * (size_t)c.across * c.down);
	c.near = c.there + (size_t)c.across * c.down;
	filter_each_rows(j, there_rows, &c, c.down, 8);
	filter_each_rows(j, near_rows, &c, c.down, 8);
	filter_each_rows(j, close_rows, &c, j->image.height, 16);
	memcpy(j->image.depth_m, c.depth_m, filter_pixels(&j->image) * sizeof(float));
	filter_swap(&j->image);
}
