#include "process/watershed.h"
#include <glib.h>
#include <math.h>
#include <string.h>

#define LEVELS 65536u
#define NONE   G_MAXUINT32
#define WALL   LEVELS /* as a height: no way through */
/* States beside a height that water waits at. */
#define DRY  (LEVELS + 1)
#define DONE (LEVELS + 2)

/* The cells at the water's edge, in a list for each height, first come first served. A cell waits at the lowest height that was
 * found for it, and moves when a lower one is. */
struct shore {
	uint32_t first[LEVELS], last[LEVELS];
	uint32_t *before, *after; /* of each cell in its list */
	uint32_t *height;         /* that the cell waits at; DRY, DONE */
};

static struct shore *shore_new(size_t cells)
{
	struct shore *s = g_new(struct shore, 1);
	memset(s->first, 0xff, sizeof s->first);
	memset(s->last, 0xff, sizeof s->last);
	s->before = g_new(uint32_t, cells);
	s->after = g_new(uint32_t, cells);
	s->height = g_new(uint32_t, cells);
	return s;
}

static void shore_free(struct shore *s)
{
	g_free(s->before);
	g_free(s->after);
	g_free(s->height);
	g_free(s);
}

static void shore_leave(struct shore *s, uint32_t cell)
{
	uint32_t h = s->height[cell], before = s->before[cell], after = s->after[cell];
	*(before == NONE ? &s->first[h] : &s->after[before]) = after;
	*(after == NONE ? &s->last[h] : &s->before[after]) = before;
}

static void shore_join(struct shore *s, uint32_t cell, uint32_t height)
{
	uint32_t last = s->last[height];
	s->before[cell] = last;
	s->after[cell] = NONE;
	*(last == NONE ? &s->first[height] : &s->after[last]) = cell;
	s->last[height] = cell;
	s->height[cell] = height;
}

struct flood {
	const struct watershed_image *image;
	int32_t *label;
	struct shore *shore;
	float lowest, steps_per_unit;
};

static void widen(const float *plane, size_t cells, float *low, float *high)
{
	for (size_t i = 0; plane && i < cells; i++)
		if (isfinite(plane[i])) {
			*low = fminf(*low, plane[i]);
			*high = fmaxf(*high, plane[i]);
		}
}

static void measure(struct flood *f, size_t cells)
{
	float low = INFINITY, high = -INFINITY;
	widen(f->image->level, cells, &low, &high);
	widen(f->image->step_right, cells, &low, &high);
	widen(f->image->step_down, cells, &low, &high);
	f->lowest = low;
	/* Halves, since the difference of two floats may be none. */
	f->steps_per_unit = high > low ? (LEVELS - 1) / 2.0f / (high / 2 - low / 2) : 0;
}

static uint32_t height_of(const struct flood *f, const float *plane, size_t i)
{
	if (!plane)
		return 0;
	if (!isfinite(plane[i]))
		return WALL;
	float height = (plane[i] / 2 - f->lowest / 2) * 2 * f->steps_per_unit;
	return MIN((uint32_t)height, LEVELS - 1);
}

struct place {
	uint32_t row, column;
};

static inline size_t index_of(const struct flood *f, struct place p)
{
	return (size_t)p.row * f->image->columns + p.column;
}

static bool walk(const struct flood *f, struct place from, int down, int right, struct place *ret)
{
	int64_t row = (int64_t)from.row + down, column = (int64_t)from.column + right;
	uint32_t columns = f->image->columns;
	if (row < 0 || row >= f->image->rows)
		return false;
	if (column < 0 || column >= columns) {
		if (!f->image->wraps)
			return false;
		column = column < 0 ? columns - 1 : 0;
	}
	*ret = (struct place){ (uint32_t)row, (uint32_t)column };
	return true;
}

/* Between cells that share a side. */
static uint32_t step_between(
	const struct flood *f, struct place from, int down, struct place to, int right)
{
	if (down)
		return height_of(f, f->image->step_down, index_of(f, down > 0 ? from : to));
	return height_of(f, f->image->step_right, index_of(f, right > 0 ? from : to));
}

static uint32_t step_to(
	const struct flood *f, struct place from, int down, int right, struct place to)
{
	if (!down || !right)
		return step_between(f, from, down, to, right);
	struct place level = { from.row, to.column }, plumb = { to.row, from.column };
	uint32_t over = MAX(step_between(f, from, 0, level, right),
			 step_between(f, level, down, to, 0)),
		 under = MAX(step_between(f, from, down, plumb, 0),
			 step_between(f, plumb, 0, to, right));
	return MIN(over, under);
}

/* The water of a cell that it has just come to, at that height, looks at a neighbour. */
static void reach(struct flood *f, struct place from, uint32_t height, int down, int right)
{
	struct place to;
	if (!walk(f, from, down, right, &to))
		return;
	size_t at = index_of(f, to);
	uint32_t waits = f->shore->height[at];
	if (waits == DONE || waits <= height)
		return;
	uint32_t over = MAX(height_of(f, f->image->level, at), step_to(f, from, down, right, to));
	over = MAX(over, height);
	if (over == WALL || over >= waits)
		return;
	if (waits != DRY)
		shore_leave(f->shore, (uint32_t)at);
	shore_join(f->shore, (uint32_t)at, over);
	f->label[at] = f->label[index_of(f, from)];
}

static const int around[8][2] = { { -1, 0 }, { 0, -1 }, { 0, 1 }, { 1, 0 }, { -1, -1 }, { -1, 1 },
	{ 1, -1 }, { 1, 1 } };

static void spread(struct flood *f, uint32_t cell, uint32_t height)
{
	struct place from = { cell / f->image->columns, cell % f->image->columns };
	f->shore->height[cell] = DONE;
	for (int k = 0; k < (f->image->diagonals ? 8 : 4); k++)
		reach(f, from, height, around[k][0], around[k][1]);
}

static bool is_beside_dry(const struct flood *f, uint32_t cell)
{
	struct place from = { cell / f->image->columns, cell % f->image->columns }, to;
	for (int k = 0; k < (f->image->diagonals ? 8 : 4); k++)
		if (walk(f, from, around[k][0], around[k][1], &to) &&
			f->shore->height[index_of(f, to)] == DRY)
			return true;
	return false;
}

size_t watershed_flood(const struct watershed_image *image, int32_t *label)
{
	size_t cells = (size_t)image->columns * image->rows, markers = 0, reached = 0;
	g_assert(cells <= G_MAXINT32);
	struct flood f = { .image = image, .label = label, .shore = shore_new(cells) };
	measure(&f, cells);
	for (size_t i = 0; i < cells; i++)
		f.shore->height[i] = label[i] == 0 ? DRY : DONE;
	for (size_t i = 0; i < cells; i++)
		if (label[i] > 0 && is_beside_dry(&f, (uint32_t)i)) {
			shore_join(f.shore, (uint32_t)i, 0);
			markers++;
		}
	for (uint32_t height = 0; height < LEVELS; height++)
		for (uint32_t cell; (cell = f.shore->first[height]) != NONE; reached++) {
			shore_leave(f.shore, cell);
			spread(&f, cell, height);
		}
	shore_free(f.shore);
	return reached - markers;
}
