#include "render/filter-solid.h"
#include "render/grain.h"
#include <math.h>

struct edges_pass {
	const struct filter_job *j;
	const struct edges_step *step;
	struct filter_solid solid;
	float bend_cosine;
	float *found;       /* of each pixel, 0: it is none */
	float *linked;      /* the same without what is alone */
	const float *crowd; /* means of found around */
	float *wide, *line;
	const float *sway[2]; /* noise, for wobbling */
	int radius;
};

/* Depth at a place, so many pixels on in one of four ways; FAR beyond the picture too. */
static float depth_on(
	const struct filter_image *i, uint32_t x, uint32_t y, const int way[2], int pixels)
{
	int at_x = (int)x + way[0] * pixels, at_y = (int)y + way[1] * pixels;
	if (at_x < 0 || at_y < 0 || at_x >= (int)i->width || at_y >= (int)i->height)
		return -1;
	return i->depth_m[(size_t)at_y * i->width + (size_t)at_x];
}

/* What is deeper must be so for some pixels, or it is a gap between points. */
#define BEYOND 4

/* The nearer side has the line; so has the outermost pixel of what is there. */
static bool steps_down(const struct edges_pass *p, uint32_t x, uint32_t y, const int way[2])
{
	const struct filter_image *i = &p->j->image;
	float here = i->depth_m[(size_t)y * i->width + x], back = depth_on(i, x, y, way, -2);
	/* What a slope would have there is no step. */
	float slope = back > 0 && back < FILTER_FAR ? fmaxf(here - back, 0) / 2 : 0;
	for (int n = 1; n <= BEYOND; n++) {
		float there = depth_on(i, x, y, way, n);
		if (there < 0)
			return n > 1;
		if (there >= FILTER_FAR)
			continue;
		if (p->step->depth <= 0 || there - here - slope * (float)n <= p->step->depth * here)
			return false;
	}
	return depth_on(i, x, y, way, 1) >= 0;
}

/* Normals of this many pixels on either side are compared by their sums: those of single points are noisy where two surfaces meet. */
#define SIDE 3

/* The sum of the normals of the pixels from at on, as far as they are of the same surface; false: there is none. */
static bool add_normals(const struct filter_image *i, uint32_t x, uint32_t y, const int way[2],
	int first, float ret[3])
{
	float last_m = i->depth_m[(size_t)y * i->width + x];
	ret[0] = ret[1] = ret[2] = 0;
	for (int n = first; n < first + SIDE; n++) {
		float here_m = depth_on(i, x, y, way, n);
		if (here_m < 0 || fabsf(here_m - last_m) > 0.02f * last_m)
			break;
		const float *add = i->normal[((size_t)((int)y + way[1] * n)) * i->width +
					     (size_t)((int)x + way[0] * n)];
		for (int k = 0; k < 3; k++)
			ret[k] += add[k];
		last_m = here_m;
	}
	return ret[0] * ret[0] + ret[1] * ret[1] + ret[2] * ret[2] > 0.5f;
}

static bool bends(const struct edges_pass *p, uint32_t x, uint32_t y, const int way[2])
{
	const int back[2] = { -way[0], -way[1] };
	float one[3], other[3], along = 0, length2[2] = { 0 };
	if (p->step->bend_deg <= 0 || !add_normals(&p->j->image, x, y, back, 0, one) ||
		!add_normals(&p->j->image, x, y, way, 1, other))
		return false;
	for (int k = 0; k < 3; k++) {
		along += one[k] * other[k];
		length2[0] += one[k] * one[k];
		length2[1] += other[k] * other[k];
	}
	return along < p->bend_cosine * sqrtf(length2[0] * length2[1]);
}

static bool is_edge(const struct edges_pass *p, uint32_t x, uint32_t y)
{
	static const int way[4][2] = { { 1, 0 }, { 0, 1 }, { -1, 0 }, { 0, -1 } };
	const struct filter_image *i = &p->j->image;
	size_t at = (size_t)y * i->width + x;
	float here = i->depth_m[at];
	if (here >= FILTER_FAR)
		return false;
	for (int n = 0; n < 4; n++) {
		int dx = way[n][0], dy = way[n][1];
		if ((int)x + dx < 0 || (int)y + dy < 0 || x + (uint32_t)dx >= i->width ||
			y + (uint32_t)dy >= i->height)
			continue;
		ptrdiff_t by = (ptrdiff_t)dy * (ptrdiff_t)i->width + dx;
		size_t other = (size_t)((ptrdiff_t)at + by);
		if (steps_down(p, x, y, way[n]))
			return true;
		if (i->depth_m[other] >= FILTER_FAR)
			continue;
		/* Of two that meet, the nearer one; right and down of two as far. */
		bool is_mine = here < i->depth_m[other] || (here == i->depth_m[other] && n < 2);
		if (is_mine && bends(p, x, y, way[n]))
			return true;
		if (p->step->segments && is_mine && i->leaf[at] && i->leaf[other] &&
			i->leaf[at] != i->leaf[other])
			return true;
	}
	return false;
}

static void find_rows(const void *data, uint32_t from, uint32_t end)
{
	const struct edges_pass *p = data;
	const struct filter_image *i = &p->j->image;
	for (uint32_t y = from; y < end; y++)
		for (uint32_t x = 0; x < i->width; x++) {
			size_t at = (size_t)y * i->width + x;
			p->found[at] = is_edge(p, x, y) ? filter_solid_at(&p->solid, x, y) : 0;
		}
}

/* Of the pixels around, so many belong to a line that goes on; fewer are noise. */
#define LINKED_LEAST 3
#define LINKED_ALL   5

static void link_rows(const void *data, uint32_t from, uint32_t end)
{
	const struct edges_pass *p = data;
	const struct filter_image *i = &p->j->image;
	for (uint32_t y = from; y < end; y++)
		for (uint32_t x = 0; x < i->width; x++) {
			size_t at = (size_t)y * i->width + x;
			float sum = 0;
			p->linked[at] = 0;
			if (!(p->found[at] > 0))
				continue;
			for (uint32_t at_y = y > 1 ? y - 2 : 0; at_y < MIN(y + 3, i->height);
				at_y++)
				for (uint32_t at_x = x > 1 ? x - 2 : 0; at_x < MIN(x + 3, i->width);
					at_x++)
					sum += p->found[(size_t)at_y * i->width + at_x] > 0;
			p->linked[at] = p->found[at] * grain_step(LINKED_LEAST, LINKED_ALL, sum);
		}
}

/* Leaves and gravel would be all lines: where more than these parts of all pixels are lines, there are none. */
#define CROWD_SOME 0.16f
#define CROWD_ALL  0.32f

static void thin_rows(const void *data, uint32_t from, uint32_t end)
{
	const struct edges_pass *p = data;
	size_t width = p->j->image.width;
	for (size_t at = from * width; at < end * width; at++)
		p->linked[at] *= grain_step(CROWD_ALL, CROWD_SOME, p->crowd[at]);
}

/* As wide as lines are. */
static void widen_rows(const void *data, uint32_t from, uint32_t end)
{
	const struct edges_pass *p = data;
	const struct filter_image *i = &p->j->image;
	int radius2 = p->radius * p->radius + p->radius;
	for (uint32_t y = from; y < end; y++)
		for (uint32_t x = 0; x < i->width; x++) {
			float most = 0;
			for (int dy = -p->radius; dy <= p->radius; dy++)
				for (int dx = -p->radius; dx <= p->radius; dx++) {
					int at_x = (int)x + dx, at_y = (int)y + dy;
					if (dx * dx + dy * dy > radius2 || at_x < 0 || at_y < 0 ||
						at_x >= (int)i->width || at_y >= (int)i->height)
						continue;
					most = fmaxf(most,
						p->linked[(size_t)at_y * i->width + (size_t)at_x]);
				}
			p->wide[(size_t)y * i->width + x] = most;
		}
}

static float line_at(const struct edges_pass *p, uint32_t x, uint32_t y)
{
	const struct filter_image *i = &p->j->image;
	float wobble = p->step->wobble_px * p->j->px;
	if (wobble <= 0)
		return p->line[(size_t)y * i->width + x];
	size_t at = (size_t)y * i->width + x;
	return filter_between(p->line, i->width, i->height, (float)x + 2 * wobble * p->sway[0][at],
		(float)y + 2 * wobble * p->sway[1][at]);
}

static void draw_rows(const void *data, uint32_t from, uint32_t end)
{
	const struct edges_pass *p = data;
	const struct filter_image *i = &p->j->image;
	const struct edges_step *s = p->step;
	for (uint32_t y = from; y < end; y++)
		for (uint32_t x = 0; x < i->width; x++) {
			size_t at = (size_t)y * i->width + x;
			float rgb[3], part = line_at(p, x, y) * s->opacity *
					     filter_weight(p->j, s->where, at);
			for (int k = 0; k < 3; k++)
				rgb[k] = (float)i->rgba[at][k] +
					 part * ((float)s->colour[k] - (float)i->rgba[at][k]);
			filter_put(i->spare[at], rgb);
		}
}

void filter_edges(struct filter_job *j, const struct step *s)
{
	const struct edges_step *k = &s->edges;
	const struct filter_image *i = &j->image;
	size_t bytes = filter_pixels(i) * sizeof(float);
	float width = fmaxf(k->width_px * j->px, 0.5f);
	struct edges_pass p = { .j = j,
		.step = k,
		.bend_cosine = cosf(k->bend_deg * (float)(G_PI / 180)),
		.found = filter_room_part(j->room, 0, bytes),
		.linked = filter_room_part(j->room, 6, bytes),
		.wide = filter_room_part(j->room, 1, bytes),
		.radius = (int)floorf(width / 2) };
	for (uint32_t n = 0; n < 2 && k->wobble_px > 0; n++)
		p.sway[n] = filter_noise(j, 4 + n, 40 * j->px, 71 + n);
	p.solid = filter_solidity(j, 3);
	filter_each_rows(j, find_rows, &p, i->height, 32);
	filter_each_rows(j, link_rows, &p, i->height, 32);
	p.crowd = p.wide;
	struct filter_blur around = { p.linked, p.wide, false, i->width, i->height, 1, 0, NULL };
	filter_blur_run(j, &around, 5 * j->px);
	filter_each_rows(j, thin_rows, &p, i->height, 32);
	filter_each_rows(j, widen_rows, &p, i->height, 16);
	/* Soft by half a pixel; what is thinner than a pixel is fainter. */
	p.line = p.found;
	struct filter_blur b = { p.wide, p.line, false, i->width, i->height, 1, 0, NULL };
	filter_blur_run(j, &b, 0.6f);
	filter_each_rows(j, draw_rows, &p, i->height, 16);
	filter_swap(&j->image);
}
