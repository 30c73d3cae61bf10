#include "acquire/coverage.h"
#include <math.h>

/* A column is whole with this share of what full columns have: a lost revolution takes far more
 * than that. */
#define WHOLE_SHARE 0.97
/* Beams are never wider apart in a sweep without gaps: 1.8 degrees at 2000 a second and ten turns. */
#define BEAMS_APART_RAD (2.5 * G_PI / 180)

struct coverage {
	struct panorama_desc desc;
	double column_rad, row_rad;
	uint8_t *seen;   /* columns * rows, column by column */
	uint32_t *count; /* of a column */
};

coverage *coverage_new(const struct panorama_desc *desc)
{
	coverage *c = g_new0(coverage, 1);
	c->desc = *desc;
	c->column_rad = 2 * G_PI / desc->columns;
	c->row_rad = (desc->elevation_max_rad - desc->elevation_min_rad) / desc->rows;
	c->seen = g_malloc0(((size_t)desc->columns * desc->rows + 7) / 8);
	c->count = g_new0(uint32_t, desc->columns);
	return c;
}

void coverage_free(coverage *c)
{
	if (!c)
		return;
	g_free(c->seen);
	g_free(c->count);
	g_free(c);
}

static void see(coverage *c, uint32_t column, uint32_t first_row, uint32_t last_row)
{
	for (uint32_t row = first_row; row <= last_row; row++) {
		size_t cell = (size_t)column * c->desc.rows + row;
		uint8_t bit = 1u << (cell & 7);
		c->count[column] += !(c->seen[cell / 8] & bit);
		c->seen[cell / 8] |= bit;
	}
}

void coverage_add(coverage *c, const double *azimuth_rad, const float *elevation_rad, size_t beams)
{
	uint32_t apart_max = (uint32_t)fmax(BEAMS_APART_RAD / c->row_rad, 1);
	int64_t last_column = -1;
	uint32_t last_row = 0;
	for (size_t i = 0; i < beams; i++) {
		double row = floor((c->desc.elevation_max_rad - elevation_rad[i]) / c->row_rad);
		double x = azimuth_rad[i] / c->column_rad;
		if (!(row >= 0 && row < c->desc.rows && x >= 0 && x < c->desc.columns + 1.0)) {
			last_column = -1;
			continue;
		}
		uint32_t column = (uint32_t)x % c->desc.columns, here = (uint32_t)row,
			 low = MIN(here, last_row), high = MAX(here, last_row);
		bool joins = column == last_column && high - low <= apart_max;
		see(c, column, joins ? low : here, joins ? high : here);
		last_column = column;
		last_row = here;
	}
}

static void clear_column(coverage *c, uint32_t column)
{
	for (uint32_t row = 0; row < c->desc.rows; row++) {
		size_t cell = (size_t)column * c->desc.rows + row;
		c->seen[cell / 8] &= ~(1u << (cell & 7));
	}
	c->count[column] = 0;
}

void coverage_clear(coverage *c, double from_rad, double to_rad)
{
	int64_t first = (int64_t)floor(from_rad / c->column_rad),
		last = (int64_t)floor(to_rad / c->column_rad);
	int64_t n = c->desc.columns;
	for (int64_t i = first; i <= last && i < first + n; i++) {
		clear_column(c, (uint32_t)(((i % n) + n) % n));
		clear_column(c, (uint32_t)((((i + n / 2) % n) + n) % n));
	}
}

/* What a full column has: not all rows, where the lidar's beams are wider apart than they. Before
 * anything was seen, all. */
static uint32_t full_count(const coverage *c)
{
	g_autofree uint32_t *columns = g_new0(uint32_t, c->desc.rows + 1); /* that have so many */
	uint32_t above = 0, most = 0;
	for (uint32_t i = 0; i < c->desc.columns; i++) {
		columns[c->count[i]]++;
		most = MAX(most, c->count[i]);
	}
	/* A fiftieth of them may have more. */
	for (uint32_t n = most; n > 0; n--) {
		above += columns[n];
		if (above > c->desc.columns / 50)
			return n;
	}
	return most;
}

static bool is_whole(const coverage *c, uint32_t column, uint32_t full)
{
	return full > 0 && c->count[column] >= WHOLE_SHARE * full;
}

uint32_t coverage_missing_columns(const coverage *c)
{
	uint32_t full = full_count(c), missing = 0;
	for (uint32_t i = 0; i < c->desc.columns; i++)
		missing += !is_whole(c, i, full);
	return missing;
}

double coverage_fraction(const coverage *c)
{
	return 1 - (double)coverage_missing_columns(c) / c->desc.columns;
}

GArray *coverage_missing(const coverage *c, double join_rad)
{
	GArray *list = g_array_new(FALSE, FALSE, sizeof(struct front_interval));
	uint32_t half = (c->desc.columns + 1) / 2, full = full_count(c);
	for (uint32_t i = 0; i < half; i++) {
		if (is_whole(c, i, full) &&
			is_whole(c, (i + c->desc.columns / 2) % c->desc.columns, full))
			continue;
		struct front_interval f = { (i - 0.5) * c->column_rad, (i + 1.5) * c->column_rad };
		struct front_interval *last =
			list->len ? &g_array_index(list, struct front_interval, list->len - 1)
				  : NULL;
		if (last && f.from_rad - last->to_rad <= join_rad)
			last->to_rad = f.to_rad;
		else
			g_array_append_val(list, f);
	}
	return list;
}
