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

/* Where a pixel looks around. */
struct tap {
	int32_t dx, dy;
	ptrdiff_t away; /* in pixels of the image */
	float weight;
	uint32_t side; /* the bit of its eighth of the circle */
};

struct closing {
	struct filter_image *image;
	int reach;
	float *depth_m; /* as it becomes */
	const struct tap *taps;
	uint32_t taps_n;
	/* Of blocks of pixels: whether something is in them; and in any that a gap in them is closed by. */
	uint32_t across, down;
	uint8_t *there, *near;
};
#define BLOCK 8

static GArray *taps_around(int radius, uint32_t width)
{
	int step = gaps_step_px(radius), reach = radius / step * step;
	GArray *ret = g_array_new(FALSE, FALSE, sizeof(struct tap));
	for (int dy = -reach; dy <= reach; dy += step)
		for (int dx = -reach; dx <= reach; dx += step) {
			int apart = dx * dx + dy * dy;
			if (!apart || apart > radius * radius)
				continue;
			struct tap t = { dx, dy, (ptrdiff_t)dy * (ptrdiff_t)width + dx,
				1 / (float)apart,
				1u << ((dx > 0) | (dy > 0) << 1 | (abs(dx) > abs(dy)) << 2) };
			g_array_append_val(ret, t);
		}
	return ret;
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
	int reach = (c->reach + BLOCK - 1) / BLOCK;
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

/* A pixel at whose taps the image may end asks each of them. */
static bool is_there(
	const struct filter_image *i, const struct tap *t, uint32_t x, uint32_t y, bool is_inside)
{
	uint32_t at_x = x + (uint32_t)t->dx, at_y = y + (uint32_t)t->dy;
	if (!is_inside && (at_x >= i->width || at_y >= i->height))
		return false;
	return i->depth_m[(ptrdiff_t)((size_t)y * i->width + x) + t->away] < FILTER_FAR;
}

static bool is_gap(const struct closing *c, uint32_t x, uint32_t y, bool is_inside)
{
	uint32_t sides = 0;
	for (uint32_t n = 0; n < c->taps_n; n++) {
		const struct tap *t = &c->taps[n];
		if (sides & t->side || !is_there(c->image, t, x, y, is_inside))
			continue;
		sides |= t->side;
		if (__builtin_popcount(sides) >= SIDES_LEAST)
			return true;
	}
	return false;
}

static void close_gap(const struct closing *c, uint32_t x, uint32_t y, bool is_inside)
{
	const struct filter_image *i = c->image;
	size_t at = (size_t)y * i->width + x;
	float rgb[3] = { 0 }, depth_m = 0, weight = 0;
	for (uint32_t n = 0; n < c->taps_n; n++) {
		const struct tap *t = &c->taps[n];
		if (!is_there(i, t, x, y, is_inside))
			continue;
		ptrdiff_t there = (ptrdiff_t)at + t->away;
		for (int k = 0; k < 3; k++)
			rgb[k] += t->weight * (float)i->rgba[there][k];
		depth_m += t->weight * i->depth_m[there];
		weight += t->weight;
	}
	for (int k = 0; k < 3; k++)
		rgb[k] /= weight;
	filter_put(i->spare[at], rgb);
	c->depth_m[at] = depth_m / weight;
}

static void close_rows(const void *data, uint32_t from, uint32_t end)
{
	const struct closing *c = data;
	const struct filter_image *i = c->image;
	uint32_t reach = (uint32_t)c->reach;
	memcpy(i->spare[(size_t)from * i->width], i->rgba[(size_t)from * i->width],
		(size_t)(end - from) * i->width * 4);
	memcpy(c->depth_m + (size_t)from * i->width, i->depth_m + (size_t)from * i->width,
		(size_t)(end - from) * i->width * sizeof(float));
	for (uint32_t y = from; y < end; y++) {
		const uint8_t *near = c->near + (size_t)(y / BLOCK) * c->across;
		const float *row = i->depth_m + (size_t)y * i->width;
		bool is_row_inside = y >= reach && y + reach < i->height;
		for (uint32_t x = 0; x < i->width; x++) {
			bool is_inside = is_row_inside && x >= reach && x + reach < i->width;
			if (row[x] >= FILTER_FAR && near[x / BLOCK] && is_gap(c, x, y, is_inside))
				close_gap(c, x, y, is_inside);
		}
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
	int radius = gaps_radius(&s->gaps, j->px, j->spacing_px);
	g_autoptr(GArray) taps = taps_around(radius, j->image.width);
	struct closing c = { &j->image, radius,
		filter_room_part(j->room, 0, filter_pixels(&j->image) * sizeof(float)),
		(const struct tap *)(const void *)taps->data, taps->len };
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
