#include "process/verify-conflicts.h"

#define TOGETHER_MIN 6

/* A car, a stall, a group of people beside the scanner covers as much of its view as half the street: it is one thing, and
 * came or went as one. Such a thing is this near and at most this large. */
#define THING_RANGE_MAX_M  6.0f
#define THING_EXTENT_MAX_M 8.0f
#define THING_HEIGHT_MAX_M 4.0f
#define THING_MIN_SR       0.20
/* Its parts are this near to each other: what the other scan has in its way, a post, a sill, cuts it up. */
#define THING_GAP_M     0.3f
#define THING_GAP_CELLS 12

double conflicts_cell_sr(const struct conflicts_view *v, uint32_t row)
{
	const struct verify_view *f = v->from;
	double up = f->elevation_max_rad - (row * v->stride + 0.5) * f->row_rad;
	return f->column_rad * f->row_rad * cos(up) * v->stride * v->stride;
}

/* The cell beside one, around the whole turn; negative: above or below all. */
static int64_t beside(const struct conflicts_view *v, size_t at, int down, int right)
{
	int64_t row = (int64_t)(at / v->columns) + down;
	int64_t column = ((int64_t)(at % v->columns) + right + v->columns) % v->columns;
	return row >= 0 && row < v->rows ? row * v->columns + column : -1;
}

/* Whether most cells around see the same: a thing, not an edge, a chair's leg or a beam met at a slant. */
static bool is_together(const struct conflicts_view *v, size_t at)
{
	int same = 0;
	for (int down = -1; down <= 1; down++)
		for (int right = -1; right <= 1; right++) {
			int64_t k = beside(v, at, down, right);
			same += k >= 0 && v->kind[k] == COMPARED_THROUGH;
		}
	return same >= TOGETHER_MIN;
}

/* ---- things ---- */

/* The cell's surface. With a stride, every other row's cells lie shifted (verify_compare). */
static const struct surfel *surfel_of(const struct conflicts_view *v, size_t at)
{
	size_t row = at / v->columns, column = at % v->columns;
	size_t shifted = column * v->stride + row % v->stride;
	return &v->from->surfel[row * v->stride * v->from->columns +
				MIN(shifted, v->from->columns - 1)];
}

struct thing {
	double sr, together_sr, range_sr; /* range_sr: sum of range * solid angle */
	float least_m[3], most_m[3];
};

static void add_cell(const struct conflicts_view *v, size_t at, struct thing *t)
{
	const struct surfel *s = surfel_of(v, at);
	double sr = conflicts_cell_sr(v, (uint32_t)(at / v->columns));
	for (int k = 0; k < 3; k++) {
		t->least_m[k] = t->sr > 0 ? fminf(t->least_m[k], s->point_m[k]) : s->point_m[k];
		t->most_m[k] = t->sr > 0 ? fmaxf(t->most_m[k], s->point_m[k]) : s->point_m[k];
	}
	t->sr += sr;
	t->range_sr += sr * s->range_m;
	t->together_sr += is_together(v, at) ? sr : 0;
}

static bool is_near(const struct surfel *a, const struct surfel *b)
{
	float sum = 0;
	for (int k = 0; k < 3; k++)
		sum += (a->point_m[k] - b->point_m[k]) * (a->point_m[k] - b->point_m[k]);
	return sum <= THING_GAP_M * THING_GAP_M;
}

/* Cells each way that may hold a part as near. */
static int gap_cells(const struct conflicts_view *v, const struct surfel *s)
{
	float cell_m = s->range_m * fminf(v->from->column_rad, v->from->row_rad) * v->stride;
	return (int)fminf(THING_GAP_M / cell_m + 1, THING_GAP_CELLS);
}

/* A stack of cells that are still to be looked around. */
struct search {
	uint8_t *left; /* of all cells: whether it is in no thing yet */
	uint32_t *cell;
	size_t count;
};

static void look_around(const struct conflicts_view *v, size_t at, struct search *s)
{
	const struct surfel *here = surfel_of(v, at);
	int gap = gap_cells(v, here);
	for (int down = -gap; down <= gap; down++)
		for (int right = -gap; right <= gap; right++) {
			int64_t k = beside(v, at, down, right);
			if (k < 0 || !s->left[k] || !is_near(here, surfel_of(v, (size_t)k)))
				continue;
			s->left[k] = 0;
			s->cell[s->count++] = (uint32_t)k;
		}
}

/* All that hangs together with a cell. */
static struct thing take_thing(const struct conflicts_view *v, size_t first, struct search *s)
{
	struct thing t = { 0 };
	s->left[first] = 0;
	s->cell[s->count++] = (uint32_t)first;
	while (s->count) {
		size_t at = s->cell[--s->count];
		add_cell(v, at, &t);
		look_around(v, at, s);
	}
	return t;
}

static bool is_thing(const struct thing *t)
{
	float size[3];
	for (int k = 0; k < 3; k++)
		size[k] = t->most_m[k] - t->least_m[k];
	return t->sr >= THING_MIN_SR && t->range_sr <= t->sr * THING_RANGE_MAX_M &&
	       hypotf(size[0], size[1]) <= THING_EXTENT_MAX_M && size[2] <= THING_HEIGHT_MAX_M;
}

static struct thing find_largest(const struct conflicts_view *v)
{
	struct thing largest = { 0 };
	size_t cells = (size_t)v->rows * v->columns;
	g_autofree uint8_t *left = g_malloc(cells);
	g_autofree uint32_t *cell = g_new(uint32_t, cells);
	struct search search = { left, cell, 0 };
	for (size_t i = 0; i < cells; i++)
		left[i] = v->kind[i] == COMPARED_THROUGH;
	for (size_t i = 0; i < cells; i++) {
		if (!left[i])
			continue;
		struct thing t = take_thing(v, i, &search);
		if (is_thing(&t) && t.sr > largest.sr)
			largest = t;
	}
	return largest;
}

void conflicts_add(const struct conflicts_view *v, struct comparison *ret)
{
	size_t cells = (size_t)v->rows * v->columns;
	double together_sr = 0;
	for (size_t i = 0; i < cells; i++)
		if (v->kind[i] == COMPARED_THROUGH && is_together(v, i))
			together_sr += conflicts_cell_sr(v, (uint32_t)(i / v->columns));
	struct thing thing = find_largest(v);
	ret->together_sr += together_sr - thing.together_sr;
	ret->sr[COMPARED_THROUGH] -= thing.sr;
	ret->thing_sr += thing.sr;
	ret->thing_together_sr += thing.together_sr;
}
