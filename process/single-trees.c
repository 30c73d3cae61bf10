#include "process/single-trees.h"
#include "process/components.h"
#include "process/watershed.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define CELL_LEAST_M 0.25
#define SMOOTH_M     0.45
#define CELLS_MAX    (16u << 20)
/* A top rises so much above the saddle to the next, in metres and as a share of its height; nearer than this it is none. */
#define RISE_M     0.5f
#define RISE_SHARE 0.1f
#define APART_M    1.5

struct canopy {
	double cell_m, low_m[2];
	uint32_t columns, rows;
	float *height_m; /* 0: no vegetation */
	int32_t *label;
};

static bool lay_out(struct canopy *c, const voxels *v, const uint8_t *is_tall)
{
	double high[2] = { -INFINITY, -INFINITY };
	c->low_m[0] = c->low_m[1] = INFINITY;
	for (uint32_t i = 0; i < v->count; i++) {
		double at[3];
		if (!is_tall[i])
			continue;
		voxel_point_m(v, i, at);
		for (int k = 0; k < 2; k++) {
			c->low_m[k] = fmin(c->low_m[k], at[k]);
			high[k] = fmax(high[k], at[k]);
		}
	}
	if (!(high[0] >= c->low_m[0]))
		return false;
	c->cell_m = fmax(v->size_m, CELL_LEAST_M);
	while ((high[0] - c->low_m[0]) / c->cell_m * ((high[1] - c->low_m[1]) / c->cell_m) >
		CELLS_MAX)
		c->cell_m *= 2;
	c->columns = (uint32_t)((high[0] - c->low_m[0]) / c->cell_m) + 1;
	c->rows = (uint32_t)((high[1] - c->low_m[1]) / c->cell_m) + 1;
	return true;
}

static size_t cell_of(const struct canopy *c, const voxels *v, uint32_t i)
{
	double at[3];
	voxel_point_m(v, i, at);
	size_t column = (size_t)((at[0] - c->low_m[0]) / c->cell_m),
	       row = (size_t)((at[1] - c->low_m[1]) / c->cell_m);
	return row * c->columns + column;
}

/* Mean of what is there, weighed by distance, along rows or columns. */
static void blur(const struct canopy *c, float *plane, ptrdiff_t step, uint32_t length,
	size_t lines, ptrdiff_t next_line)
{
	int reach = (int)ceil(2 * SMOOTH_M / c->cell_m);
	g_autofree float *line = g_new(float, length);
	for (size_t l = 0; l < lines; l++) {
		float *first = plane + (ptrdiff_t)l * next_line;
		for (uint32_t i = 0; i < length; i++)
			line[i] = first[i * step];
		for (int i = 0; i < (int)length; i++) {
			double sum = 0, weights = 0;
			if (!(line[i] > 0))
				continue;
			for (int k = MAX(i - reach, 0); k <= MIN(i + reach, (int)length - 1); k++) {
				double off = (k - i) * c->cell_m / SMOOTH_M,
				       weight = exp(-off * off / 2);
				if (line[k] > 0) {
					sum += weight * line[k];
					weights += weight;
				}
			}
			first[i * step] = (float)(sum / weights);
		}
	}
}

static void raise_canopy(
	struct canopy *c, const voxels *v, const uint8_t *is_tall, const float *height_m)
{
	c->height_m = g_new0(float, (size_t)c->columns * c->rows);
	for (uint32_t i = 0; i < v->count; i++)
		if (is_tall[i]) {
			float *h = &c->height_m[cell_of(c, v, i)];
			*h = fmaxf(*h, fmaxf(height_m[i], 0.01f));
		}
	blur(c, c->height_m, 1, c->columns, c->rows, c->columns);
	blur(c, c->height_m, c->columns, c->rows, c->columns, 1);
}

/* ---- tops ---- */

/* Cells from the highest down join the top that they lie beside; where two meet, the lower one is a top of its own only if it rises
 * enough above the saddle between them. */
struct summits {
	uint32_t *top; /* the top that each cell belongs to, its cell; or a way to it */
	const struct canopy *c;
};

static uint32_t top_of(struct summits *s, uint32_t cell)
{
	while (s->top[cell] != cell) {
		s->top[cell] = s->top[s->top[cell]];
		cell = s->top[cell];
	}
	return cell;
}

static bool is_one_crown(const struct canopy *c, uint32_t a, uint32_t b, float saddle_m)
{
	float lower = fminf(c->height_m[a], c->height_m[b]);
	double apart = c->cell_m * hypot((double)(a % c->columns) - (double)(b % c->columns),
					   (double)(a / c->columns) - (double)(b / c->columns));
	return lower - saddle_m < fmaxf(RISE_M, RISE_SHARE * lower) || apart < APART_M;
}

static void join_beside(struct summits *s, uint32_t cell)
{
	const struct canopy *c = s->c;
	int column = (int)(cell % c->columns), row = (int)(cell / c->columns);
	for (int k = 0; k < 9; k++) {
		int x = column + k % 3 - 1, y = row + k / 3 - 1;
		if (x < 0 || y < 0 || x >= (int)c->columns || y >= (int)c->rows)
			continue;
		uint32_t other = (uint32_t)y * c->columns + (uint32_t)x;
		if (other == cell || s->top[other] == UINT32_MAX)
			continue;
		uint32_t a = top_of(s, cell), b = top_of(s, other);
		if (a == b || !(a == cell || is_one_crown(c, a, b, c->height_m[cell])))
			continue;
		/* of equal ones, the first */
		bool a_stays = c->height_m[a] > c->height_m[b] ||
			       (c->height_m[a] == c->height_m[b] && a < b);
		s->top[a_stays && a != cell ? b : a] = a_stays && a != cell ? a : b;
	}
}

struct by_height {
	float height_m;
	uint32_t cell;
};

static int highest_first(const void *a, const void *b)
{
	const struct by_height *x = a, *y = b;
	int by = (x->height_m < y->height_m) - (x->height_m > y->height_m);
	return by ? by : (x->cell > y->cell) - (x->cell < y->cell);
}

static uint32_t mark_tops(struct canopy *c)
{
	size_t cells = (size_t)c->columns * c->rows, count = 0;
	uint32_t tops = 0;
	g_autofree struct by_height *order = g_new(struct by_height, cells);
	g_autofree uint32_t *top = g_new(uint32_t, cells);
	struct summits s = { top, c };
	c->label = g_new0(int32_t, cells);
	memset(top, 0xFF, cells * sizeof *top);
	for (size_t i = 0; i < cells; i++)
		if (c->height_m[i] > 0)
			order[count++] = (struct by_height){ c->height_m[i], (uint32_t)i };
		else
			c->label[i] = -1;
	qsort(order, count, sizeof *order, highest_first);
	for (size_t k = 0; k < count; k++) {
		top[order[k].cell] = order[k].cell;
		join_beside(&s, order[k].cell);
	}
	for (size_t k = 0; k < count; k++)
		if (top[order[k].cell] == order[k].cell && order[k].height_m >= TREE_LEAST_M)
			c->label[order[k].cell] = (int32_t)++tops;
	return tops;
}

static void flood(struct canopy *c)
{
	size_t cells = (size_t)c->columns * c->rows;
	g_autofree float *depth = g_new(float, cells);
	for (size_t i = 0; i < cells; i++)
		depth[i] = -c->height_m[i];
	struct watershed_image image = {
		.columns = c->columns, .rows = c->rows, .diagonals = true, .level = depth
	};
	watershed_flood(&image, c->label);
}

static void grow_trees(
	const voxels *v, const uint8_t *is_tall, const float *height_m, struct single_trees *t)
{
	struct canopy c = { 0 };
	if (!lay_out(&c, v, is_tall))
		return;
	raise_canopy(&c, v, is_tall, height_m);
	t->trees = mark_tops(&c);
	flood(&c);
	for (uint32_t i = 0; i < v->count; i++) {
		int32_t label = is_tall[i] ? c.label[cell_of(&c, v, i)] : 0;
		if (label > 0)
			t->of[i] = (uint32_t)label - 1;
	}
	g_free(c.height_m);
	g_free(c.label);
}

struct single_trees single_trees_find(
	const voxels *v, const uint8_t *is_plant, const float *height_m, uint32_t points_min)
{
	g_autoptr(components) c = components_find(v, is_plant, points_min);
	g_autofree float *high = g_new0(float, c->count + 1);
	g_autofree uint8_t *is_tall = g_new0(uint8_t, v->count + 1);
	g_autofree uint32_t *bush = g_new(uint32_t, c->count + 1);
	struct single_trees t = { .of = g_new(uint32_t, v->count + 1) };
	memset(t.of, 0xFF, v->count * sizeof *t.of);
	for (uint32_t i = 0; i < v->count; i++)
		if (c->of[i] != VOXEL_NONE)
			high[c->of[i]] = fmaxf(high[c->of[i]], height_m[i]);
	for (uint32_t i = 0; i < v->count; i++)
		is_tall[i] = c->of[i] != VOXEL_NONE && high[c->of[i]] >= TREE_LEAST_M;
	grow_trees(v, is_tall, height_m, &t);
	t.count = t.trees;
	for (uint32_t k = 0; k < c->count; k++)
		bush[k] = high[k] < TREE_LEAST_M ? t.count++ : TREE_NONE;
	for (uint32_t i = 0; i < v->count; i++)
		if (c->of[i] != VOXEL_NONE && !is_tall[i])
			t.of[i] = bush[c->of[i]];
	return t;
}
