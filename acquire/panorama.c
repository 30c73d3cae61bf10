#include "acquire/panorama.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Two ranges belong to one surface when they differ by less than this share: filling does not
 * bridge more. */
#define FILL_RANGE_RATIO 1.08f
/* The zenith, and the half row by which a grid that has a row on the horizon may reach beyond it.
 */
#define ELEVATION_MAX (G_PI / 2 + 0.01)

panorama *panorama_new(const struct panorama_desc *desc, GError **error)
{
	if (desc->columns < 4 || desc->columns > PANORAMA_COLUMNS_MAX || desc->rows < 1 ||
		desc->rows > PANORAMA_ROWS_MAX ||
		(uint64_t)desc->columns * desc->rows > PANORAMA_CELLS_MAX ||
		!(desc->elevation_max_rad > desc->elevation_min_rad) ||
		desc->elevation_min_rad < -ELEVATION_MAX ||
		desc->elevation_max_rad > ELEVATION_MAX) {
		g_set_error(error, G_FILE_ERROR, G_FILE_ERROR_INVAL,
			"a panorama of %u columns and %u rows cannot be", desc->columns,
			desc->rows);
		return NULL;
	}
	size_t cells = (size_t)desc->columns * desc->rows;
	panorama *p = g_new0(panorama, 1);
	p->desc = *desc;
	p->column_rad = 2 * G_PI / desc->columns;
	p->row_rad = (desc->elevation_max_rad - desc->elevation_min_rad) / desc->rows;
	p->range_m = g_new0(float, cells);
	p->intensity = g_new0(uint16_t, cells);
	p->cell = g_new0(uint8_t, cells);
	p->azimuth_offset = g_new0(int16_t, cells);
	p->elevation_offset = g_new0(int16_t, cells);
	return p;
}

void panorama_free(panorama *p)
{
	if (!p)
		return;
	g_free(p->range_m);
	g_free(p->intensity);
	g_free(p->cell);
	g_free(p->azimuth_offset);
	g_free(p->elevation_offset);
	g_free(p->rgb);
	g_free(p);
}

struct panorama_desc panorama_desc_for(uint32_t columns, uint32_t rows)
{
	double row_rad = G_PI / 2 / rows;
	/* Rows above the horizon's: 50 of 90 degrees, less the row that lies on it. */
	double above = floor(rows * 5.0 / 9.0);
	return (struct panorama_desc){ .columns = columns,
		.rows = rows,
		.elevation_max_rad = (above - 0.5) * row_rad,
		.elevation_min_rad = (above - 0.5 - rows) * row_rad };
}

static int64_t distance2(int16_t a, int16_t b)
{
	return (int64_t)a * a + (int64_t)b * b;
}

/* Beams that are equally far from the centre must have an order too, or the panorama would depend
 * on which came first. */
static bool wins(const panorama *p, const struct panorama_beam *b)
{
	size_t i = b->cell;
	int64_t mine = distance2(b->across, b->up),
		its = distance2(p->azimuth_offset[i], p->elevation_offset[i]);
	if (p->cell[i] == CELL_EMPTY || mine != its)
		return p->cell[i] == CELL_EMPTY || mine < its;
	if (b->across != p->azimuth_offset[i])
		return b->across < p->azimuth_offset[i];
	if (b->up != p->elevation_offset[i])
		return b->up < p->elevation_offset[i];
	return b->range_m != p->range_m[i] ? b->range_m > p->range_m[i]
					   : b->intensity > p->intensity[i];
}

bool panorama_find_beam(const panorama *p, double azimuth_rad, double elevation_rad, float range_m,
	uint16_t intensity, struct panorama_beam *ret)
{
	double x = azimuth_rad / p->column_rad,
	       y = (p->desc.elevation_max_rad - elevation_rad) / p->row_rad;
	double column = floor(x), row = floor(y);
	if (!(row >= 0 && row < p->desc.rows && x >= 0 && column <= p->desc.columns))
		return false;
	/* A calibration's range offset can make a range negative. */
	bool hit = range_m > 0 && range_m < PANORAMA_RANGE_MAX_M;
	*ret = (struct panorama_beam){
		.cell = (uint32_t)panorama_index(
			p, (uint32_t)row, (uint32_t)column % p->desc.columns),
		.across = (int16_t)lrint((x - column - 0.5) * PANORAMA_OFFSET_ONE),
		.up = (int16_t)lrint((row + 0.5 - y) * PANORAMA_OFFSET_ONE),
		.range_m = hit ? range_m : 0,
		.intensity = hit ? intensity : 0,
	};
	return true;
}

void panorama_add_beam(panorama *p, const struct panorama_beam *b)
{
	if (!wins(p, b))
		return;
	p->range_m[b->cell] = b->range_m;
	p->intensity[b->cell] = b->intensity;
	p->cell[b->cell] = b->range_m > 0 ? CELL_MEASURED : CELL_NO_RETURN;
	p->azimuth_offset[b->cell] = b->across;
	p->elevation_offset[b->cell] = b->up;
}

void panorama_add(panorama *p, const double *azimuth_rad, const float *elevation_rad,
	const float *range_m, const uint16_t *intensity, size_t beams)
{
	struct panorama_beam beam;
	for (size_t i = 0; i < beams; i++)
		if (panorama_find_beam(
			    p, azimuth_rad[i], elevation_rad[i], range_m[i], intensity[i], &beam))
			panorama_add_beam(p, &beam);
}

/* One line of cells, along a row or a column. */
struct run {
	size_t start, stride;
	uint32_t length;
	bool wraps;
	bool over_filled; /* what is filled already is bridged from, too */
};

static size_t run_index(const struct run *r, uint32_t i)
{
	return r->start + (i % r->length) * r->stride;
}

static void fill_between(panorama *p, const struct run *r, uint32_t from, uint32_t gap)
{
	size_t a = run_index(r, from), b = run_index(r, from + gap);
	bool both = p->range_m[a] > 0 && p->range_m[b] > 0;
	float near = fminf(p->range_m[a], p->range_m[b]), far = fmaxf(p->range_m[a], p->range_m[b]);
	bool smooth = both && far <= near * FILL_RANGE_RATIO;
	for (uint32_t k = 1; k < gap; k++) {
		size_t i = run_index(r, from + k), side = k * 2 <= gap ? a : b;
		float t = (float)k / gap;
		if (p->cell[i] != CELL_EMPTY)
			continue;
		p->cell[i] = smooth || p->range_m[side] > 0 ? CELL_FILLED : CELL_EMPTY;
		/* Inverse range is linear across a plane. */
		p->range_m[i] = smooth ? 1 / ((1 - t) / p->range_m[a] + t / p->range_m[b])
				       : p->range_m[side];
		p->intensity[i] =
			smooth ? (uint16_t)lrintf((1 - t) * p->intensity[a] + t * p->intensity[b])
			       : p->intensity[side];
	}
}

static bool is_beam(const panorama *p, size_t i)
{
	return p->cell[i] == CELL_MEASURED || p->cell[i] == CELL_NO_RETURN;
}

static void fill_run(panorama *p, const struct run *r, uint32_t reach)
{
	int64_t last = -1;
	uint32_t end = r->wraps ? r->length + reach : r->length;
	for (uint32_t i = 0; i < end; i++) {
		size_t k = run_index(r, i);
		if (!is_beam(p, k) && !(r->over_filled && p->cell[k] == CELL_FILLED))
			continue;
		if (last >= 0 && i - last > 1 && i - last <= reach)
			fill_between(p, r, (uint32_t)last, i - (uint32_t)last);
		last = i;
	}
}

void panorama_fill(panorama *p, uint32_t reach)
{
	/* Along columns first: there the beams of one revolution stand, without a turn of the stage
	 * between them. Then along rows, over the filled as well: a lidar of wide steps leaves
	 * rows without a beam, in which a lost column would stay open. */
	for (uint32_t c = 0; c < p->desc.columns; c++)
		fill_run(p, &(struct run){ c, p->desc.columns, p->desc.rows, false, false }, reach);
	for (uint32_t r = 0; r < p->desc.rows; r++)
		fill_run(p,
			&(struct run){
				(size_t)r * p->desc.columns, 1, p->desc.columns, true, true },
			reach);
}

double panorama_azimuth_rad(const panorama *p, uint32_t row, uint32_t column)
{
	double offset = p->azimuth_offset[panorama_index(p, row, column)] / PANORAMA_OFFSET_ONE;
	return (column + 0.5 + offset) * p->column_rad;
}

double panorama_elevation_rad(const panorama *p, uint32_t row, uint32_t column)
{
	double offset = p->elevation_offset[panorama_index(p, row, column)] / PANORAMA_OFFSET_ONE;
	return p->desc.elevation_max_rad - (row + 0.5 - offset) * p->row_rad;
}

void panorama_point(const panorama *p, uint32_t row, uint32_t column, double ret_m[3])
{
	double azimuth = panorama_azimuth_rad(p, row, column),
	       elevation = panorama_elevation_rad(p, row, column);
	double range = p->range_m[panorama_index(p, row, column)];
	ret_m[0] = range * cos(elevation) * sin(azimuth);
	ret_m[1] = range * cos(elevation) * cos(azimuth);
	ret_m[2] = range * sin(elevation);
}

float panorama_point_size_m(const panorama *p, uint32_t row, uint32_t column)
{
	double across = p->column_rad * cos(panorama_elevation_rad(p, row, column));
	return (float)(p->range_m[panorama_index(p, row, column)] * fmax(across, p->row_rad));
}

double panorama_column_coverage(const panorama *p, uint32_t column)
{
	uint32_t seen = 0;
	for (uint32_t r = 0; r < p->desc.rows; r++)
		seen += is_beam(p, panorama_index(p, r, column));
	return (double)seen / p->desc.rows;
}

struct panorama_counts panorama_count(const panorama *p)
{
	size_t n[4] = { 0 };
	for (size_t i = 0; i < (size_t)p->desc.columns * p->desc.rows; i++)
		n[p->cell[i] & 3]++;
	return (struct panorama_counts){ .measured = n[CELL_MEASURED],
		.filled = n[CELL_FILLED],
		.no_return = n[CELL_NO_RETURN],
		.empty = n[CELL_EMPTY] };
}
