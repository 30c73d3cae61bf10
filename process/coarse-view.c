#include "process/coarse-view.h"
#include <stdlib.h>
#include <string.h>

/* Cells that normals are gathered from, and that two by two make a cell of the view. */
#define FINE_RAD        (0.48 * G_PI / 180)
#define BLOCK_RAD       (0.8 * G_PI / 180) /* grids this coarse are not thinned further */
#define SPACINGS        2000
#define SPACING_MIN_RAD 1e-6f
#define REACH_M         0.15f /* between the samples of a normal's window */
#define REACH_CELLS     8
#define GATE_M          0.25f
#define GATE_SHARE      0.04f /* of the range: surfaces seen at a slant */
#define PLANE_RMS_M     0.04f
#define PLANE_SHARE     0.002f
#define SUPPORT_MIN     8

static int by_float(const void *a, const void *b)
{
	float x = *(const float *)a, y = *(const float *)b;
	return (x > y) - (x < y);
}

/* Every step-th cell of the grid in both directions. */
struct thinned {
	uint32_t columns, rows, step_column, step_row;
	bool wraps;
	float column_rad, row_rad;
	float (*point)[4]; /* x, y, z, range; range 0: nothing, -1: nobody looked */
};

/* Median angle between cells that are `step` apart. An uneven grid's own spacing is of azimuths and elevations, which tell
 * nothing of a scan that lies on its side. */
static double spacing_of(const range_grid *g, size_t step)
{
	size_t n = range_grid_cells(g), stride = n / SPACINGS + 1, count = 0;
	g_autofree float *spacing = g_new(float, SPACINGS + 1);
	for (size_t i = 0; i + step < n && count < SPACINGS; i += stride) {
		size_t k = i + step;
		if (!(g->range_m[i] > 0 && g->range_m[k] > 0))
			continue;
		float d[3] = { g->x_m[i] / g->range_m[i] - g->x_m[k] / g->range_m[k],
			g->y_m[i] / g->range_m[i] - g->y_m[k] / g->range_m[k],
			g->z_m[i] / g->range_m[i] - g->z_m[k] / g->range_m[k] };
		float angle = sqrtf(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
		if (angle > SPACING_MIN_RAD)
			spacing[count++] = angle;
	}
	qsort(spacing, count, sizeof *spacing, by_float);
	return count ? spacing[count / 2] : 2 * FINE_RAD;
}

static uint32_t step_for(double cell_rad)
{
	return cell_rad > 0 && cell_rad < FINE_RAD ? (uint32_t)(FINE_RAD / cell_rad + 0.5) : 1;
}

static struct thinned thin(const range_grid *g)
{
	bool even = !g->lattice.cell;
	double column_rad = even ? g->column_rad : spacing_of(g, 1);
	double row_rad = even ? g->row_rad : spacing_of(g, g->columns);
	struct thinned t = { .step_column = step_for(column_rad),
		.step_row = step_for(row_rad),
		.wraps = g->wraps };
	t.columns = (g->columns + t.step_column - 1) / t.step_column;
	t.rows = (g->rows + t.step_row - 1) / t.step_row;
	t.column_rad = (float)(column_rad * t.step_column);
	t.row_rad = (float)(row_rad * t.step_row);
	t.point = g_malloc_n((size_t)t.columns * t.rows, sizeof *t.point);
	for (uint32_t r = 0; r < t.rows; r++)
		for (uint32_t c = 0; c < t.columns; c++) {
			size_t i = (size_t)r * t.step_row * g->columns + c * t.step_column;
			float *p = t.point[(size_t)r * t.columns + c];
			p[0] = g->x_m[i];
			p[1] = g->y_m[i];
			p[2] = g->z_m[i];
			p[3] = g->range_m[i] > 0              ? g->range_m[i]
			       : g->cell[i] == CELL_NO_RETURN ? 0
							      : -1;
		}
	return t;
}

static const float *thinned_at(const struct thinned *t, int row, int column)
{
	if (row < 0 || row >= (int)t->rows)
		return NULL;
	if (column < 0 || column >= (int)t->columns) {
		if (!t->wraps)
			return NULL;
		column += column < 0 ? (int)t->columns : -(int)t->columns;
	}
	return t->point[(size_t)row * t->columns + column];
}

struct moments {
	float n, sum[3], square[6]; /* xx xy xz yy yz zz, about the centre point */
};

static void moments_add(struct moments *m, const float d[3])
{
	m->n++;
	for (int i = 0; i < 3; i++)
		m->sum[i] += d[i];
	m->square[0] += d[0] * d[0];
	m->square[1] += d[0] * d[1];
	m->square[2] += d[0] * d[2];
	m->square[3] += d[1] * d[1];
	m->square[4] += d[1] * d[2];
	m->square[5] += d[2] * d[2];
}

/* The direction of least spread: the largest column of the adjugate, which that direction rules when the points are nearly
 * a plane. Returns false when they are not. */
static bool moments_plane(const struct moments *m, float rms_max, float ret[3])
{
	float k = 1 / m->n, s[6];
	for (int i = 0, at = 0; i < 3; i++)
		for (int j = i; j < 3; j++, at++)
			s[at] = m->square[at] * k - m->sum[i] * m->sum[j] * k * k;
	float trace = s[0] + s[3] + s[5];
	float adjugate[3][3] = { { s[3] * s[5] - s[4] * s[4], s[2] * s[4] - s[1] * s[5],
					 s[1] * s[4] - s[2] * s[3] },
		{ 0, s[0] * s[5] - s[2] * s[2], s[1] * s[2] - s[0] * s[4] },
		{ 0, 0, s[0] * s[3] - s[1] * s[1] } };
	adjugate[1][0] = adjugate[0][1];
	adjugate[2][0] = adjugate[0][2];
	adjugate[2][1] = adjugate[1][2];
	int best = adjugate[0][0] >= adjugate[1][1] ? 0 : 1;
	best = adjugate[best][best] >= adjugate[2][2] ? best : 2;
	const float *v = adjugate[best];
	float length = sqrtf(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
	if (!(length > 0.002f * trace * trace)) /* a line, or one place */
		return false;
	for (int i = 0; i < 3; i++)
		ret[i] = v[i] / length;
	float rms2 = ret[0] * (s[0] * ret[0] + 2 * (s[1] * ret[1] + s[2] * ret[2])) +
		     ret[1] * (s[3] * ret[1] + 2 * s[4] * ret[2]) + s[5] * ret[2] * ret[2];
	return rms2 < rms_max * rms_max && rms2 < 0.1f * trace;
}

static int window_step(float range, float cell_rad)
{
	float step = REACH_M / (range * cell_rad);
	return step < 1.5f ? 1 : step > REACH_CELLS ? REACH_CELLS : (int)(step + 0.5f);
}

static void normal_at(const struct thinned *t, int row, int column, float ret[3])
{
	const float *p = thinned_at(t, row, column);
	int down = window_step(p[3], t->row_rad), across = window_step(p[3], t->column_rad);
	float gate = GATE_M + GATE_SHARE * p[3];
	struct moments m = { 0 };
	for (int i = -2; i <= 2; i++)
		for (int j = -2; j <= 2; j++) {
			const float *q = thinned_at(t, row + i * down, column + j * across);
			if (!q || !(q[3] > 0) || !(fabsf(q[3] - p[3]) < gate))
				continue;
			moments_add(&m, (float[3]){ q[0] - p[0], q[1] - p[1], q[2] - p[2] });
		}
	if (m.n < SUPPORT_MIN || !moments_plane(&m, PLANE_RMS_M + PLANE_SHARE * p[3], ret)) {
		ret[0] = ret[1] = ret[2] = 0;
		return;
	}
	float towards = ret[0] * p[0] + ret[1] * p[1] + ret[2] * p[2] > 0 ? -1.0f : 1.0f;
	for (int i = 0; i < 3; i++)
		ret[i] *= towards;
}

static struct coarse_cell cell_of_block(
	const struct thinned *t, int row, int column, int down, int across)
{
	struct coarse_cell cell = { .near_m = COARSE_VIEW_NONE };
	int measured = 0, nothing = 0, at[2] = { 0 };
	for (int i = 0; i < down; i++)
		for (int j = 0; j < across; j++) {
			const float *p = thinned_at(t, row + i, column + j);
			nothing += p && p[3] == 0;
			if (!p || !(p[3] > 0))
				continue;
			if (!measured++) {
				memcpy(cell.point_m, p, sizeof cell.point_m);
				cell.near_m = cell.far_m = p[3];
				at[0] = row + i;
				at[1] = column + j;
			}
			cell.near_m = fminf(cell.near_m, p[3]);
			cell.far_m = fmaxf(cell.far_m, p[3]);
		}
	if (measured)
		normal_at(t, at[0], at[1], cell.normal);
	else if (nothing)
		cell.near_m = COARSE_VIEW_NOTHING;
	return cell;
}

static void make_cells(struct coarse_view *v, const struct thinned *t, int down, int across)
{
	v->columns = (t->columns + across - 1) / across;
	v->rows = (t->rows + down - 1) / down;
	v->cell = g_new(struct coarse_cell, (size_t)v->columns * v->rows);
	for (uint32_t r = 0; r < v->rows; r++)
		for (uint32_t c = 0; c < v->columns; c++)
			v->cell[(size_t)r * v->columns + c] =
				cell_of_block(t, r * down, c * across, down, across);
}

static void size_lattice(struct coarse_view *v, double azimuth_span, double elevation_span,
	double column_rad, double row_rad)
{
	v->lattice_columns = (uint32_t)fmax(1, ceil(azimuth_span / column_rad - 1e-6));
	v->lattice_rows = (uint32_t)fmax(1, ceil(elevation_span / row_rad - 1e-6));
	v->columns_per_rad = (float)(1 / column_rad);
	v->rows_per_rad = (float)(1 / row_rad);
	v->lattice = g_new(uint32_t, (size_t)v->lattice_columns * v->lattice_rows);
}

/* Of a panorama: the lattice is the grid. */
static void lay_even(struct coarse_view *v, const range_grid *g, uint32_t down, uint32_t across)
{
	const struct range_lattice *l = &g->lattice;
	double column_rad = fmax(2 * FINE_RAD, l->column_rad),
	       row_rad = fmax(2 * FINE_RAD, l->row_rad);
	size_lattice(v, l->columns * l->column_rad, l->rows * l->row_rad, column_rad, row_rad);
	v->azimuth_min_rad = (float)l->azimuth_min_rad;
	v->elevation_max_rad = (float)l->elevation_max_rad;
	for (uint32_t r = 0; r < v->lattice_rows; r++)
		for (uint32_t c = 0; c < v->lattice_columns; c++) {
			uint32_t row = (uint32_t)((r + 0.5) * row_rad / l->row_rad);
			uint32_t column = (uint32_t)((c + 0.5) * column_rad / l->column_rad);
			v->lattice[(size_t)r * v->lattice_columns + c] =
				MIN(row, l->rows - 1) / down * v->columns +
				MIN(column, l->columns - 1) / across;
		}
}

static uint32_t *lattice_at(struct coarse_view *v, const float p[3])
{
	float azimuth = coarse_atan2(p[0], p[1]);
	azimuth += azimuth < 0 ? (float)(2 * G_PI) : 0;
	float level = sqrtf(p[0] * p[0] + p[1] * p[1]);
	float row = (v->elevation_max_rad - coarse_atan2(p[2], level)) * v->rows_per_rad;
	uint32_t r = (uint32_t)CLAMP(row, 0, (float)(v->lattice_rows - 1));
	uint32_t c = (uint32_t)(azimuth * v->columns_per_rad);
	return &v->lattice[r * v->lattice_columns + MIN(c, v->lattice_columns - 1)];
}

/* Takes what is beside a hole, further to the sides where columns crowd towards the poles. */
static uint32_t beside_hole(
	const struct coarse_view *v, const uint32_t *lattice, uint32_t row, uint32_t column)
{
	uint32_t n = v->lattice_columns;
	double elevation = v->elevation_max_rad - (row + 0.5) / v->rows_per_rad;
	uint32_t reach = (uint32_t)fmin(ceil(1 / fmax(cos(elevation), 1e-3)), n / 2);
	for (uint32_t k = 1; k <= reach; k++)
		for (int side = -1; side <= 1; side += 2) {
			uint32_t at = lattice[row * n + (column + n + side * (int)k) % n];
			if (at != RANGE_GRID_NONE)
				return at;
		}
	if (row > 0 && lattice[(row - 1) * n + column] != RANGE_GRID_NONE)
		return lattice[(row - 1) * n + column];
	return row + 1 < v->lattice_rows ? lattice[(row + 1) * n + column] : RANGE_GRID_NONE;
}

/* Of any other grid: points are entered where they are seen. What looked into the void has no direction there. */
static void lay_uneven(
	struct coarse_view *v, const struct thinned *t, uint32_t down, uint32_t across)
{
	double cell_rad = fmax(2 * FINE_RAD, fmax(t->column_rad, t->row_rad) * 1.2);
	size_lattice(v, 2 * G_PI, G_PI, cell_rad, cell_rad);
	size_t cells = (size_t)v->lattice_columns * v->lattice_rows;
	v->elevation_max_rad = (float)G_PI_2;
	memset(v->lattice, 0xff, cells * sizeof *v->lattice);
	for (uint32_t r = 0; r < t->rows; r++)
		for (uint32_t c = 0; c < t->columns; c++) {
			const float *p = t->point[(size_t)r * t->columns + c];
			if (p[3] > 0)
				*lattice_at(v, p) = r / down * v->columns + c / across;
		}
	g_autofree uint32_t *before = g_memdup2(v->lattice, cells * sizeof *before);
	for (uint32_t r = 0; r < v->lattice_rows; r++)
		for (uint32_t c = 0; c < v->lattice_columns; c++)
			if (before[r * v->lattice_columns + c] == RANGE_GRID_NONE)
				v->lattice[r * v->lattice_columns + c] =
					beside_hole(v, before, r, c);
}

struct coarse_view *coarse_view_new(const range_grid *g)
{
	struct coarse_view *v = g_new0(struct coarse_view, 1);
	struct thinned t = thin(g);
	int down = t.row_rad < BLOCK_RAD ? 2 : 1, across = t.column_rad < BLOCK_RAD ? 2 : 1;
	make_cells(v, &t, down, across);
	if (g->lattice.cell)
		lay_uneven(v, &t, down, across);
	else
		lay_even(v, g, down * t.step_row, across * t.step_column);
	g_free(t.point);
	return v;
}

void coarse_view_free(struct coarse_view *v)
{
	if (!v)
		return;
	g_free(v->cell);
	g_free(v->lattice);
	g_free(v);
}
