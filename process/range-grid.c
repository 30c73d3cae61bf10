#include "process/range-grid.h"
#include <gio/gio.h>
#include <stdlib.h>
#include <string.h>

/* Of a sample: medians need no more. */
#define SPACING_SAMPLES    20000u
#define SPACING_APART_MOST 8
/* Angles between neighbours below this are repeats of one beam. */
#define SPACING_MIN_RAD   1e-6
#define LATTICE_CELLS_MAX (1u << 28)

static void *plane(size_t count, size_t bytes)
{
	return g_aligned_alloc0(count + 64, bytes, 64); /* vectors may read past the end */
}

static range_grid *grid_of_size(uint32_t columns, uint32_t rows, bool intensity, bool colour)
{
	range_grid *g = g_new0(range_grid, 1);
	size_t n = (size_t)columns * rows;
	g->columns = columns;
	g->rows = rows;
	g->x_m = plane(n, sizeof *g->x_m);
	g->y_m = plane(n, sizeof *g->y_m);
	g->z_m = plane(n, sizeof *g->z_m);
	g->range_m = plane(n, sizeof *g->range_m);
	g->cell = plane(n, sizeof *g->cell);
	g->intensity = intensity ? plane(n, sizeof *g->intensity) : NULL;
	g->rgb = colour ? plane(n, 3) : NULL;
	return g;
}

void range_grid_free(range_grid *g)
{
	if (!g)
		return;
	g_aligned_free(g->x_m);
	g_aligned_free(g->y_m);
	g_aligned_free(g->z_m);
	g_aligned_free(g->range_m);
	g_aligned_free(g->cell);
	g_aligned_free(g->intensity);
	g_aligned_free(g->rgb);
	g_free(g->lattice.cell);
	g_free(g);
}

size_t range_grid_count(const range_grid *g)
{
	size_t count = 0;
	for (size_t i = 0; i < range_grid_cells(g); i++)
		count += g->range_m[i] > 0;
	return count;
}

/* ---- from a panorama ---- */

struct angle_table {
	float *sine, *cosine;
};

static struct angle_table angle_table_new(uint32_t count, double first, double step)
{
	struct angle_table t = { g_new(float, count), g_new(float, count) };
	for (uint32_t i = 0; i < count; i++) {
		t.sine[i] = (float)sin(first + i * step);
		t.cosine[i] = (float)cos(first + i * step);
	}
	return t;
}

static void angle_table_clear(struct angle_table *t)
{
	g_free(t->sine);
	g_free(t->cosine);
}

/* A beam is less than a cell from the centre of its cell, so the addition theorem with two terms of the series is exact to a
 * billionth. */
static void place_row(range_grid *g, const panorama *p, uint32_t row,
	const struct angle_table *azimuth, float sine, float cosine)
{
	size_t from = (size_t)row * g->columns;
	const float across = (float)(p->column_rad / PANORAMA_OFFSET_ONE),
		    up = (float)(p->row_rad / PANORAMA_OFFSET_ONE);
	for (uint32_t c = 0; c < g->columns; c++) {
		size_t i = from + c;
		float range = p->cell[i] == CELL_MEASURED ? p->range_m[i] : 0;
		float a = p->azimuth_offset[i] * across, e = p->elevation_offset[i] * up;
		float ac = 1 - a * a / 2, as = a - a * a * a / 6;
		float ec = 1 - e * e / 2, es = e - e * e * e / 6;
		float level = range * (cosine * ec - sine * es);
		g->range_m[i] = range;
		g->x_m[i] = level * (azimuth->sine[c] * ac + azimuth->cosine[c] * as);
		g->y_m[i] = level * (azimuth->cosine[c] * ac - azimuth->sine[c] * as);
		g->z_m[i] = range * (sine * ec + cosine * es);
	}
}

range_grid *range_grid_from_panorama(const panorama *p)
{
	uint32_t columns = p->desc.columns, rows = p->desc.rows;
	range_grid *g = grid_of_size(columns, rows, true, p->rgb);
	size_t n = range_grid_cells(g);
	struct angle_table azimuth = angle_table_new(columns, p->column_rad / 2, p->column_rad);
	struct angle_table elevation =
		angle_table_new(rows, p->desc.elevation_max_rad - p->row_rad / 2, -p->row_rad);
#pragma omp parallel for schedule(static)
	for (uint32_t r = 0; r < rows; r++)
		place_row(g, p, r, &azimuth, elevation.sine[r], elevation.cosine[r]);
	angle_table_clear(&azimuth);
	angle_table_clear(&elevation);
	memcpy(g->cell, p->cell, n);
	memcpy(g->intensity, p->intensity, n * sizeof *g->intensity);
	if (p->rgb)
		memcpy(g->rgb, p->rgb, n * 3);
	g->wraps = true;
	g->column_rad = p->column_rad;
	g->row_rad = p->row_rad;
	g->lattice = (struct range_lattice){ .columns = columns,
		.rows = rows,
		.column_rad = p->column_rad,
		.row_rad = p->row_rad,
		.elevation_max_rad = p->desc.elevation_max_rad,
		.wraps = true };
	return g;
}

/* ---- from another grid ---- */

/* Where beams are sparser than cells whole rows have none. */
static size_t first_of_block(const range_grid *g, uint32_t every, uint32_t row, uint32_t column)
{
	for (uint32_t r = row; r < MIN(row + every, g->rows); r++)
		for (uint32_t c = column; c < MIN(column + every, g->columns); c++)
			if (g->range_m[(size_t)r * g->columns + c] > 0)
				return (size_t)r * g->columns + c;
	return (size_t)row * g->columns + column;
}

static void thin_row(const range_grid *from, uint32_t every, uint32_t row, range_grid *to)
{
	for (uint32_t column = 0; column < to->columns; column++) {
		size_t i = first_of_block(from, every, row * every, column * every);
		size_t at = (size_t)row * to->columns + column;
		to->x_m[at] = from->x_m[i];
		to->y_m[at] = from->y_m[i];
		to->z_m[at] = from->z_m[i];
		to->range_m[at] = from->range_m[i];
		to->cell[at] = from->cell[i];
		if (from->intensity)
			to->intensity[at] = from->intensity[i];
		if (from->rgb)
			memcpy(to->rgb + 3 * at, from->rgb + 3 * i, 3);
	}
}

range_grid *range_grid_thin(const range_grid *g, uint32_t every)
{
	range_grid *ret = grid_of_size((g->columns + every - 1) / every,
		(g->rows + every - 1) / every, g->intensity, g->rgb);
#pragma omp parallel for schedule(static)
	for (uint32_t row = 0; row < ret->rows; row++)
		thin_row(g, every, row, ret);
	ret->wraps = g->wraps;
	ret->column_rad = g->column_rad * every;
	ret->row_rad = g->row_rad * every;
	return ret;
}

/* ---- from points ---- */

static double wrap(double angle) /* 0..2 pi */
{
	angle = fmod(angle, 2 * G_PI);
	return angle < 0 ? angle + 2 * G_PI : angle;
}

static double azimuth_of(const range_grid *g, size_t i)
{
	return wrap(atan2(g->x_m[i], g->y_m[i]));
}

static double elevation_of(const range_grid *g, size_t i)
{
	return atan2(g->z_m[i], hypot(g->x_m[i], g->y_m[i]));
}

static int by_value(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

/* Which cells are compared: `apart` columns from each other in a row, or rows in a column. */
struct stride {
	uint32_t columns, rows, apart;
};

/* Median angle between cells of a stride, of one cell; 0: there are none. */
static double median_spacing(
	const range_grid *g, struct stride s, double (*angle)(const range_grid *, size_t))
{
	size_t n = range_grid_cells(g), every = n / SPACING_SAMPLES + 1, count = 0;
	size_t step = (size_t)s.rows * g->columns + s.columns;
	g_autofree double *spacing = g_new(double, SPACING_SAMPLES + 1);
	for (size_t i = 0; i + step < n && count < SPACING_SAMPLES; i += every) {
		if (i % g->columns + s.columns >= g->columns)
			continue;
		if (!(g->range_m[i] > 0 && g->range_m[i + step] > 0))
			continue;
		double difference = fabs(remainder(angle(g, i + step) - angle(g, i), 2 * G_PI));
		if (difference > SPACING_MIN_RAD)
			spacing[count++] = difference / s.apart;
	}
	if (!count)
		return 0;
	qsort(spacing, count, sizeof *spacing, by_value);
	return spacing[count / 2];
}

/* A scanner whose rows are closer than its beams has measured only each second or third of them. */
static double nearest_spacing(const range_grid *g, bool across)
{
	double spacing = 0;
	for (uint32_t apart = 1; apart <= SPACING_APART_MOST && !(spacing > 0); apart++)
		spacing = median_spacing(g,
			(struct stride){ across ? apart : 0, across ? 0 : apart, apart },
			across ? azimuth_of : elevation_of);
	return spacing;
}

struct extent {
	double azimuth_min, azimuth_span, elevation_min, elevation_max;
};

/* The azimuths that were looked at are what the widest gap leaves. */
#define GAP_BINS 3600
static struct extent extent_of(const range_grid *g)
{
	g_autofree bool *seen = g_new0(bool, GAP_BINS);
	struct extent e = { 0, 0, G_PI, -G_PI };
	for (size_t i = 0; i < range_grid_cells(g); i++) {
		if (!(g->range_m[i] > 0))
			continue;
		double up = elevation_of(g, i);
		e.elevation_min = fmin(e.elevation_min, up);
		e.elevation_max = fmax(e.elevation_max, up);
		seen[(int)(azimuth_of(g, i) * (GAP_BINS / (2 * G_PI))) % GAP_BINS] = true;
	}
	int widest = 0, end = 0, run = 0;
	for (int i = 0; i < 2 * GAP_BINS; i++) {
		run = seen[i % GAP_BINS] ? 0 : run + 1;
		if (run > widest && run <= GAP_BINS) {
			widest = run;
			end = i + 1;
		}
	}
	e.azimuth_min = (end % GAP_BINS) * 2 * G_PI / GAP_BINS;
	e.azimuth_span = (GAP_BINS - widest) * 2 * G_PI / GAP_BINS;
	return e;
}

static bool lay_lattice(range_grid *g, GError **error)
{
	struct extent e = extent_of(g);
	struct range_lattice *l = &g->lattice;
	l->wraps = e.azimuth_span > 2 * G_PI - 4 * fmax(g->column_rad, 2 * G_PI / GAP_BINS);
	l->azimuth_min_rad = l->wraps ? 0 : e.azimuth_min;
	double span = l->wraps ? 2 * G_PI : e.azimuth_span;
	l->elevation_max_rad = e.elevation_max + g->row_rad / 2;
	double columns = fmax(round(span / g->column_rad), 1),
	       rows = ceil((l->elevation_max_rad - e.elevation_min) / g->row_rad + 0.5);
	if (columns * rows > LATTICE_CELLS_MAX) {
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_DATA,
			"its points are too unevenly spread for a grid");
		return false;
	}
	l->columns = (uint32_t)columns;
	l->rows = (uint32_t)rows;
	l->column_rad = span / l->columns;
	l->row_rad = g->row_rad;
	g->wraps = l->wraps;
	return true;
}

/* Angular distance of a point from the centre of its lattice cell, in cells, squared. */
static float off_centre(const range_grid *g, size_t i, int64_t at)
{
	const struct range_lattice *l = &g->lattice;
	double column = wrap(azimuth_of(g, i) - l->azimuth_min_rad) / l->column_rad -
			(double)(at % l->columns) - 0.5;
	double row = (l->elevation_max_rad - elevation_of(g, i)) / l->row_rad -
		     (double)(at / l->columns) - 0.5;
	return (float)(column * column + row * row);
}

static void enter_points(range_grid *g, float *off)
{
	struct range_lattice *l = &g->lattice;
	for (size_t i = 0; i < range_grid_cells(g); i++) {
		if (!(g->range_m[i] > 0))
			continue;
		int64_t at = range_lattice_find(l, g->x_m[i], g->y_m[i], g->z_m[i]);
		if (at < 0)
			continue;
		float distance = off_centre(g, i, at);
		if (l->cell[at] == RANGE_GRID_NONE || distance < off[at]) {
			l->cell[at] = (uint32_t)i;
			off[at] = distance;
		}
	}
}

/* Uneven beams leave holes of a cell between them: these take the nearest neighbour's. */
static void close_holes(struct range_lattice *l)
{
	static const int beside[4][2] = { { 0, -1 }, { 0, 1 }, { -1, 0 }, { 1, 0 } };
	size_t n = (size_t)l->columns * l->rows;
	g_autofree uint32_t *before = g_memdup2(l->cell, n * sizeof *before);
	for (uint32_t r = 0; r < l->rows; r++)
		for (uint32_t c = 0; c < l->columns; c++) {
			size_t at = (size_t)r * l->columns + c;
			for (int k = 0; k < 4 && l->cell[at] == RANGE_GRID_NONE; k++) {
				int64_t row = (int64_t)r + beside[k][0],
					column = (int64_t)c + beside[k][1];
				if (l->wraps)
					column = (column + l->columns) % l->columns;
				if (row >= 0 && row < l->rows && column >= 0 && column < l->columns)
					l->cell[at] = before[row * l->columns + column];
			}
		}
}

static bool take_points(range_grid *g, const struct range_grid_desc *desc, GError **error)
{
	for (size_t i = 0; i < range_grid_cells(g); i++) {
		g->cell[i] = desc->cell[i] == CELL_FILLED ? CELL_EMPTY : desc->cell[i];
		if (desc->cell[i] != CELL_MEASURED)
			continue;
		double x = desc->x_m[i], y = desc->y_m[i], z = desc->z_m[i];
		double range = sqrt(x * x + y * y + z * z);
		if (!(range <= PANORAMA_RANGE_MAX_M)) {
			g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_DATA,
				"row %zu, column %zu: a point that is no number or beyond %g km",
				i / g->columns, i % g->columns, PANORAMA_RANGE_MAX_M / 1e3);
			return false;
		}
		if (!(range > 0)) { /* the scanner's own place is no point */
			g->cell[i] = CELL_EMPTY;
			continue;
		}
		g->x_m[i] = (float)x;
		g->y_m[i] = (float)y;
		g->z_m[i] = (float)z;
		g->range_m[i] = (float)range;
	}
	return true;
}

static bool find_spacing(range_grid *g, GError **error)
{
	g->column_rad = nearest_spacing(g, true);
	g->row_rad = nearest_spacing(g, false);
	if (g->column_rad > 0 && g->row_rad > 0)
		return true;
	g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_DATA,
		range_grid_count(g) ? "no two points are neighbours in its grid"
				    : "it has no points");
	return false;
}

range_grid *range_grid_new(const struct range_grid_desc *desc, GError **error)
{
	if (!desc->columns || !desc->rows || desc->columns > PANORAMA_COLUMNS_MAX ||
		(uint64_t)desc->columns * desc->rows > PANORAMA_CELLS_MAX) {
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_DATA,
			"a grid of %u x %u cells is none that this program can take", desc->columns,
			desc->rows);
		return NULL;
	}
	g_autoptr(range_grid) g =
		grid_of_size(desc->columns, desc->rows, desc->intensity, desc->rgb);
	size_t n = range_grid_cells(g);
	if (!take_points(g, desc, error) || !find_spacing(g, error) || !lay_lattice(g, error))
		return NULL;
	if (desc->intensity)
		memcpy(g->intensity, desc->intensity, n * sizeof *g->intensity);
	if (desc->rgb)
		memcpy(g->rgb, desc->rgb, n * 3);
	size_t cells = (size_t)g->lattice.columns * g->lattice.rows;
	g->lattice.cell = g_new(uint32_t, cells);
	memset(g->lattice.cell, 0xff, cells * sizeof *g->lattice.cell);
	g_autofree float *off = g_new(float, cells);
	enter_points(g, off);
	close_holes(&g->lattice);
	return g_steal_pointer(&g);
}
