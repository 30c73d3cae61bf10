#include "render/filter-tables.h"
#include "render/grain.h"
#include <math.h>
#include <string.h>

struct edges_pass {
	const struct filter_job *j;
	const struct edges_step *step;
	struct filter_solid solid;
	float bend_cosine, sharp_cosine; /* bends are lines from there on, and all of one there */
	float *found;                    /* of each pixel, 0..1 */
	float *spread;                   /* the most around it */
	float *wide, *line;
	const float *sway[2]; /* noise, for wobbling */
	int radius;
	int way[EDGES_WAYS][EDGES_REACH]
	       [2]; /* places on straight lines through a pixel, to one side */
};

/* ---- where edges are ---- */

/* Depth so many pixels on in one of four ways; -1 beyond the picture. */
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
/* 1/depth, which is linear on planes, goes on as it came from two pixels before, but changes by no more than this part a pixel. */
#define SLOPE_MOST 0.05f
/* Steps of these parts of what the style says begin to be lines, and are lines. */
#define STEP_SOME 0.7f
#define STEP_ALL  1.1f

/* How much of 1/depth what is seen aslant changes by between two points, of which each has a disc: so much down from one of them to the
 * next is no step (edl.h has the same for shades). Of the two sides of a pixel, the flatter one tells. */
static float step_of_points(const struct filter_job *j, uint32_t x, uint32_t y)
{
	static const int way[2][2] = { { 1, 0 }, { 0, 1 } };
	float here_m = j->image.depth_m[(size_t)y * j->image.width + x], slant = 0;
	for (int n = 0; n < 2; n++) {
		float before = depth_on(&j->image, x, y, way[n], -2),
		      behind = depth_on(&j->image, x, y, way[n], 2);
		if (before > 0 && before < FILTER_FAR && behind > 0 && behind < FILTER_FAR)
			slant = fmaxf(slant, fminf(fabsf(1 / here_m - 1 / before),
						     fabsf(1 / here_m - 1 / behind)));
	}
	return slant / 2 * frame_apart_px(j->f, here_m);
}

/* The nearer side has the line; so has the outermost pixel of what is there. */
static float steps_down(
	const struct edges_pass *p, uint32_t x, uint32_t y, const int way[2], float no_step)
{
	const struct filter_image *i = &p->j->image;
	float here = 1 / i->depth_m[(size_t)y * i->width + x], back = depth_on(i, x, y, way, -2),
	      slope = 0, least = 1;
	if (back > 0 && back < FILTER_FAR)
		slope = CLAMP((here - 1 / back) / 2, -SLOPE_MOST * here, SLOPE_MOST * here);
	for (int n = 1; n <= BEYOND; n++) {
		float there = depth_on(i, x, y, way, n);
		if (there < 0)
			return n > 1 ? least : 0;
		if (there >= FILTER_FAR)
			continue;
		if (p->step->depth <= 0)
			return 0;
		float over = (here + slope * (float)n - no_step) * there - 1;
		least = fminf(least,
			grain_step(STEP_SOME * p->step->depth, STEP_ALL * p->step->depth, over));
		if (least <= 0)
			return 0;
	}
	return least;
}

/* Normals of this many pixels on either side are compared by their sums: those of single points are noisy where two surfaces meet. */
#define SIDE 4
/* Bends of so much more are all of a line. */
#define BEND_SOFT_DEG 20

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

static float bends(const struct edges_pass *p, uint32_t x, uint32_t y, const int way[2])
{
	const int back[2] = { -way[0], -way[1] };
	float one[3], other[3], along = 0, length2[2] = { 0 };
	if (p->step->bend_deg <= 0 || !add_normals(&p->j->image, x, y, back, 0, one) ||
		!add_normals(&p->j->image, x, y, way, 1, other))
		return 0;
	for (int k = 0; k < 3; k++) {
		along += one[k] * other[k];
		length2[0] += one[k] * one[k];
		length2[1] += other[k] * other[k];
	}
	return grain_step(p->bend_cosine, p->sharp_cosine, along / sqrtf(length2[0] * length2[1]));
}

static float edge_at(const struct edges_pass *p, uint32_t x, uint32_t y)
{
	static const int way[4][2] = { { 1, 0 }, { 0, 1 }, { -1, 0 }, { 0, -1 } };
	const struct filter_image *i = &p->j->image;
	size_t at = (size_t)y * i->width + x;
	float here = i->depth_m[at], most = 0;
	if (here >= FILTER_FAR)
		return 0;
	float no_step = step_of_points(p->j, x, y);
	for (int n = 0; n < 4 && most < 1; n++) {
		int dx = way[n][0], dy = way[n][1];
		if ((int)x + dx < 0 || (int)y + dy < 0 || x + (uint32_t)dx >= i->width ||
			y + (uint32_t)dy >= i->height)
			continue;
		ptrdiff_t by = (ptrdiff_t)dy * (ptrdiff_t)i->width + dx;
		size_t other = (size_t)((ptrdiff_t)at + by);
		most = fmaxf(most, steps_down(p, x, y, way[n], no_step));
		if (i->depth_m[other] >= FILTER_FAR)
			continue;
		/* Of two that meet, the nearer one; right and down of two as far. */
		bool is_mine = here < i->depth_m[other] || (here == i->depth_m[other] && n < 2);
		if (is_mine && most < 1)
			most = fmaxf(most, bends(p, x, y, way[n]));
		if (p->step->segments && is_mine && i->leaf[at] && i->leaf[other] &&
			i->leaf[at] != i->leaf[other])
			most = 1;
	}
	return most;
}

static void find_rows(const void *data, uint32_t from, uint32_t end)
{
	const struct edges_pass *p = data;
	const struct filter_image *i = &p->j->image;
	for (uint32_t y = from; y < end; y++) {
		float *to = p->found + (size_t)y * i->width;
		filter_solid_row(&p->solid, y, to, i->width);
		for (uint32_t x = 0; x < i->width; x++)
			to[x] *= edge_at(p, x, y);
	}
}

/* ---- which of them are lines ---- */

/* The most of the eight pixels around, and its own. */
static void spread_rows(const void *data, uint32_t from, uint32_t end)
{
	const struct edges_pass *p = data;
	const struct filter_image *i = &p->j->image;
	size_t width = i->width;
	g_autofree float *column = g_new(float, width + 2);
	for (uint32_t y = from; y < end; y++) {
		const float *row = p->found + y * width, *above = row - (y ? width : 0),
			    *below = row + (y + 1 < i->height ? width : 0);
		float *to = p->spread + y * width;
		for (size_t x = 0; x < width; x++) {
			float most = above[x] > row[x] ? above[x] : row[x];
			column[x + 1] = below[x] > most ? below[x] : most;
		}
		column[0] = column[width + 1] = 0;
		for (size_t x = 0; x < width; x++) {
			float most = column[x] > column[x + 1] ? column[x] : column[x + 1];
			to[x] = column[x + 2] > most ? column[x + 2] : most;
		}
	}
}

/* Of edges on one side of a pixel, along a way. */
static float along(const struct edges_pass *p, uint32_t x, uint32_t y, int way, int side)
{
	const struct filter_image *i = &p->j->image;
	float sum = 0;
	for (int n = 0; n < EDGES_REACH; n++) {
		int at_x = (int)x + side * p->way[way][n][0],
		    at_y = (int)y + side * p->way[way][n][1];
		at_x = CLAMP(at_x, 0, (int)i->width - 1);
		at_y = CLAMP(at_y, 0, (int)i->height - 1);
		sum += p->spread[(size_t)at_y * i->width + (size_t)at_x];
	}
	return sum;
}

/* How much more there is of edges along the straight line of the most than along all of them. Where a line ends or turns, one side of it
 * is enough. */
static float straightness_at(const struct edges_pass *p, uint32_t x, uint32_t y)
{
	float best = 0, all = 0;
	for (int w = 0; w < EDGES_WAYS; w++) {
		float one = along(p, x, y, w, -1), other = along(p, x, y, w, 1),
		      sum = fmaxf(one + other, EDGES_ONE_SIDE * fmaxf(one, other));
		best = fmaxf(best, sum);
		all += sum;
	}
	return (best - all / EDGES_WAYS) / (2 * EDGES_REACH);
}

/* Leaves and gravel would be all lines, single points would be lines: in these all ways are alike. */
static void link_rows(const void *data, uint32_t from, uint32_t end)
{
	const struct edges_pass *p = data;
	size_t width = p->j->image.width;
	for (uint32_t y = from; y < end; y++)
		for (uint32_t x = 0; x < width; x++) {
			size_t at = y * width + x;
			p->line[at] = p->found[at];
			if (p->found[at] > 0)
				p->line[at] *= grain_step(EDGES_STRAIGHT_SOME, EDGES_STRAIGHT_ALL,
					straightness_at(p, x, y));
		}
}

/* ---- drawing ---- */

/* As wide as lines are: the most within a radius. */
static void widen_rows(const void *data, uint32_t from, uint32_t end)
{
	const struct edges_pass *p = data;
	const struct filter_image *i = &p->j->image;
	int radius = p->radius, radius2 = radius * radius + radius;
	if (!radius) {
		memcpy(p->wide + (size_t)from * i->width, p->line + (size_t)from * i->width,
			(size_t)(end - from) * i->width * sizeof *p->wide);
		return;
	}
	for (uint32_t y = from; y < end; y++)
		for (uint32_t x = 0; x < i->width; x++) {
			float most = 0;
			for (int dy = -radius; dy <= radius; dy++)
				for (int dx = -radius; dx <= radius; dx++) {
					int at_x = (int)x + dx, at_y = (int)y + dy;
					if (dx * dx + dy * dy > radius2 || at_x < 0 || at_y < 0 ||
						at_x >= (int)i->width || at_y >= (int)i->height)
						continue;
					most = fmaxf(most,
						p->line[(size_t)at_y * i->width + (size_t)at_x]);
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

void edges_ways(int ret[EDGES_WAYS][EDGES_REACH][2])
{
	for (int w = 0; w < EDGES_WAYS; w++)
		for (int n = 0; n < EDGES_REACH; n++) {
			float turn = (float)G_PI * (float)w / EDGES_WAYS;
			ret[w][n][0] = (int)lrintf(cosf(turn) * (float)(n + 1));
			ret[w][n][1] = (int)lrintf(sinf(turn) * (float)(n + 1));
		}
}

void edges_bends(const struct edges_step *s, float ret[2])
{
	const float degrees = (float)(G_PI / 180);
	ret[0] = s->bend_deg > 0 ? cosf(s->bend_deg * degrees) : 2;
	ret[1] = cosf(fminf(s->bend_deg + BEND_SOFT_DEG, 180) * degrees);
}

void filter_edges(struct filter_job *j, const struct step *s)
{
	const struct edges_step *k = &s->edges;
	const struct filter_image *i = &j->image;
	size_t bytes = filter_pixels(i) * sizeof(float);
	float width = fmaxf(k->width_px * j->px, 0.5f), bend[2];
	struct edges_pass p = { .j = j,
		.step = k,
		.found = filter_room_part(j->room, 0, bytes),
		.spread = filter_room_part(j->room, 1, bytes),
		.line = filter_room_part(j->room, 6, bytes),
		.radius = (int)floorf(width / 2) };
	edges_bends(k, bend);
	p.bend_cosine = bend[0];
	p.sharp_cosine = bend[1];
	edges_ways(p.way);
	const float *calm_m = k->wobble_px > 0 ? filter_calm_depth(j, 7) : NULL;
	for (uint32_t n = 0; n < 2 && calm_m; n++)
		p.sway[n] = filter_noise(j, 4 + n, 40 * j->px, 71 + n, calm_m);
	p.solid = filter_solidity(j, 3);
	filter_each_rows(j, find_rows, &p, i->height, 32);
	filter_each_rows(j, spread_rows, &p, i->height, 32);
	filter_each_rows(j, link_rows, &p, i->height, 16);
	p.wide = p.spread;
	filter_each_rows(j, widen_rows, &p, i->height, 16);
	/* Soft borders; what is thinner than a pixel is fainter. */
	struct filter_blur b = { p.wide, p.line, false, i->width, i->height, 1, 0, NULL };
	filter_blur_run(j, &b, EDGES_SOFT_PX);
	filter_each_rows(j, draw_rows, &p, i->height, 16);
	filter_swap(&j->image);
}
