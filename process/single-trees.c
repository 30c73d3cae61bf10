#include "process/single-trees.h"
#include "process/components.h"
#include "process/watershed.h"
#include <math.h>
#include <string.h>

#define CELL_LEAST_M 0.25
#define SMOOTH_M     0.45
#define CELLS_MAX    (16u << 20)
/* Two maxima nearer than this are one crown: the higher, the wider crowns are. */
#define APART_M      1.1
#define APART_RISE   0.14
#define APART_MOST_M 3.5

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

static bool is_top(const struct canopy *c, int column, int row)
{
	float here = c->height_m[(size_t)row * c->columns + (uint32_t)column];
	double apart = fmin(APART_M + APART_RISE * here, APART_MOST_M);
	int reach = (int)(apart / c->cell_m);
	for (int y = MAX(row - reach, 0); y <= MIN(row + reach, (int)c->rows - 1); y++)
		for (int x = MAX(column - reach, 0); x <= MIN(column + reach, (int)c->columns - 1);
			x++) {
			float other = c->height_m[(size_t)y * c->columns + (uint32_t)x];
			bool is_near = hypot(x - column, y - row) * c->cell_m <= apart;
			/* of equal ones, the first */
			if (is_near &&
				(other > here ||
					(other == here && (y < row || (y == row && x < column)))))
				return false;
		}
	return true;
}

static uint32_t mark_tops(struct canopy *c)
{
	uint32_t tops = 0;
	c->label = g_new0(int32_t, (size_t)c->columns * c->rows);
	for (uint32_t row = 0; row < c->rows; row++)
		for (uint32_t column = 0; column < c->columns; column++) {
			size_t i = (size_t)row * c->columns + column;
			if (!(c->height_m[i] > 0))
				c->label[i] = -1;
			else if (c->height_m[i] >= TREE_LEAST_M && is_top(c, (int)column, (int)row))
				c->label[i] = (int32_t)++tops;
		}
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
