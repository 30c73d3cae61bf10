#include "process/verify-conflicts.h"

#define TOGETHER_MIN 6

/* A car, a stall, a group of people beside the scanner covers as much of its view as half the street: it is one thing, and
 * came or went as one. Such things are this near and at most this large. */
#define THING_RANGE_MAX_M  6.0f
#define THING_EXTENT_MAX_M 8.0f
#define THING_HEIGHT_MAX_M 4.0f
#define THING_MIN_SR       0.15
/* A thing is in cubes side by side: what the other scan has in its way, a post, a sill, cuts it up in the view. A wall nearby
 * goes on beyond a thing's size before the cubes end. */
#define CUBE_M     0.25f
#define CUBES_SIDE 72 /* on each side of a scanner, half of them */

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

/* The cube of a surface, 0 where it is too far away; the outermost ones stay empty. */
static size_t cube_of(const struct surfel *s)
{
	size_t cube = 0;
	for (int k = 0; k < 3; k++) {
		int i = (int)floorf(s->point_m[k] / CUBE_M) + CUBES_SIDE / 2;
		if (i < 1 || i >= CUBES_SIDE - 1)
			return 0;
		cube = cube * CUBES_SIDE + (size_t)i;
	}
	return cube;
}

/* Numbers all marked cubes that hang together with one alike. */
static void number_cubes(uint16_t *cube, size_t first, uint16_t number, GArray *stack)
{
	cube[first] = number;
	g_array_append_val(stack, first);
	while (stack->len) {
		size_t at = g_array_index(stack, size_t, stack->len - 1);
		g_array_set_size(stack, stack->len - 1);
		for (int k = 0; k < 27; k++) {
			size_t beside = at + (size_t)((k / 9 - 1) * CUBES_SIDE * CUBES_SIDE +
						      (k / 3 % 3 - 1) * CUBES_SIDE + k % 3 - 1);
			if (cube[beside] != G_MAXUINT16)
				continue;
			cube[beside] = number;
			g_array_append_val(stack, beside);
		}
	}
}

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

static bool is_thing(const struct thing *t)
{
	float size[3];
	for (int k = 0; k < 3; k++)
		size[k] = t->most_m[k] - t->least_m[k];
	return t->sr >= THING_MIN_SR && t->range_sr <= t->sr * THING_RANGE_MAX_M &&
	       hypotf(size[0], size[1]) <= THING_EXTENT_MAX_M && size[2] <= THING_HEIGHT_MAX_M;
}

/* All pieces of what was seen through and is near, of struct thing; caller frees. */
static GArray *find_pieces(const struct conflicts_view *v)
{
	size_t cells = (size_t)v->rows * v->columns;
	g_autofree uint16_t *cube = g_new0(uint16_t, CUBES_SIDE * CUBES_SIDE * CUBES_SIDE);
	g_autofree uint32_t *cube_of_cell = g_new0(uint32_t, cells);
	g_autoptr(GArray) stack = g_array_new(FALSE, FALSE, sizeof(size_t));
	GArray *pieces = g_array_new(FALSE, TRUE, sizeof(struct thing));
	for (size_t i = 0; i < cells; i++)
		if (v->kind[i] == COMPARED_THROUGH) {
			cube_of_cell[i] = (uint32_t)cube_of(surfel_of(v, i));
			cube[cube_of_cell[i]] = G_MAXUINT16;
		}
	cube[0] = 0;
	for (size_t i = 0; i < cells; i++) {
		size_t k = cube_of_cell[i];
		if (k && cube[k] == G_MAXUINT16 && pieces->len < G_MAXUINT16 - 1) {
			g_array_set_size(pieces, pieces->len + 1);
			number_cubes(cube, k, (uint16_t)pieces->len, stack);
		}
		if (k && cube[k] != G_MAXUINT16)
			add_cell(v, i, &g_array_index(pieces, struct thing, cube[k] - 1));
	}
	return pieces;
}

void conflicts_add(const struct conflicts_view *v, struct comparison *ret)
{
	size_t cells = (size_t)v->rows * v->columns;
	double together_sr = 0;
	for (size_t i = 0; i < cells; i++)
		if (v->kind[i] == COMPARED_THROUGH && is_together(v, i))
			together_sr += conflicts_cell_sr(v, (uint32_t)(i / v->columns));
	g_autoptr(GArray) pieces = find_pieces(v);
	ret->together_sr += together_sr;
	for (guint i = 0; i < pieces->len; i++) {
		const struct thing *t = &g_array_index(pieces, struct thing, i);
		if (!is_thing(t))
			continue;
		ret->together_sr -= t->together_sr;
		ret->sr[COMPARED_THROUGH] -= t->sr;
		ret->thing_sr += t->sr;
		ret->thing_together_sr += t->together_sr;
	}
}
