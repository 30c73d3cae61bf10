#include "process/import-grid.h"
#include "acquire/panorama.h"
#include <gio/gio.h>
#include <math.h>

#define SAMPLES_MAX 20000
/* Fewer neighbours tell nothing. */
#define SAMPLES_MIN 3
/* The right layout's neighbours must be closer by this than the next one's. */
#define CLEARLY 2.0
/* Makes the nearest of equals the best: every second column is a column too. */
#define DISTANCE_WEIGHT 0.05
/* Beams that differ by less are one. */
#define SPACING_MIN_RAD 1e-6
#define BAND_BYTES      (16u << 20)
/* Beams that were coarser than their grid leave rows or columns empty: neighbours are looked for so far away. */
#define REACH_MAX 8u

/* ---- which cells are neighbours ---- */

struct direction {
	bool measured;
	double azimuth, elevation;
};

static struct direction direction_of(const struct point_record *r)
{
	double level = sqrt(r->x_m * r->x_m + r->y_m * r->y_m);
	return (struct direction){ r->cell == CELL_MEASURED, atan2(r->x_m, r->y_m),
		atan2(r->z_m, level) };
}

/* How neighbours at one distance in the file differ, over the samples. */
struct differences {
	GArray *across,
		*up; /* of double, radians, signed; across as seen, times the cosine of the elevation */
};

static struct differences differences_new(void)
{
	return (struct differences){ g_array_new(false, false, sizeof(double)),
		g_array_new(false, false, sizeof(double)) };
}

static void differences_clear(struct differences *d)
{
	g_array_unref(d->across);
	g_array_unref(d->up);
}

static void add_difference(
	struct differences *d, const struct direction *a, const struct direction *b)
{
	if (!a->measured || !b->measured)
		return;
	double across = remainder(b->azimuth - a->azimuth, 2 * G_PI) * cos(a->elevation);
	double up = b->elevation - a->elevation;
	g_array_append_val(d->across, across);
	g_array_append_val(d->up, up);
}

static int by_value(gconstpointer a, gconstpointer b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

static double median(const GArray *values, bool absolute)
{
	g_autoptr(GArray) sorted = g_array_copy((GArray *)values);
	for (guint i = 0; absolute && i < sorted->len; i++)
		g_array_index(sorted, double, i) = fabs(g_array_index(sorted, double, i));
	g_array_sort(sorted, by_value);
	return sorted->len ? g_array_index(sorted, double, sorted->len / 2) : 0;
}

/* ---- the answers ---- */

/* Neighbours in a run of `run` cells (not over its end), and those beside it in the next run, so many cells away. */
struct neighbours {
	uint32_t run;
	struct differences inner, outer;
};

struct answer {
	uint32_t run;
	bool column_by_column;
	double cost;
};

/* The cell so far behind i; none: not measured. */
static bool read_direction(const struct grid_records *records, uint64_t i, bool is_there,
	struct direction *ret, GError **error)
{
	struct point_record r = { 0 };
	if (is_there && !records->read(records->user_data, i, 1, &r, error))
		return false;
	*ret = direction_of(&r);
	return true;
}

static bool sample(const struct grid_records *records, uint64_t cells, uint32_t reach,
	struct neighbours n[2], GError **error)
{
	uint64_t count = MIN(cells, SAMPLES_MAX);
	for (uint64_t k = 0; k < count; k++) {
		/* Spread evenly, in step with no size of a grid. */
		double spread = (double)k * 0.6180339887498949;
		uint64_t i =
			count == cells ? k : (uint64_t)((spread - floor(spread)) * (double)cells);
		struct direction d, next, other;
		if (!read_direction(records, i, true, &d, error) ||
			(d.measured && !read_direction(records, i + reach, i + reach < cells, &next,
					       error)))
			return false;
		for (int j = 0; j < 2 && d.measured; j++) {
			uint64_t beside = i + (uint64_t)reach * n[j].run;
			if (i % n[j].run + reach < n[j].run)
				add_difference(&n[j].inner, &d, &next);
			if (!read_direction(records, beside, beside < cells, &other, error))
				return false;
			add_difference(&n[j].outer, &d, &other);
		}
	}
	return true;
}

static struct answer judge(const struct neighbours *n, bool column_by_column)
{
	const GArray *inner = column_by_column ? n->inner.across : n->inner.up;
	const GArray *outer = column_by_column ? n->outer.up : n->outer.across;
	const GArray *step = column_by_column ? n->outer.across : n->outer.up;
	struct answer a = { n->run, column_by_column, G_MAXDOUBLE };
	if (inner->len >= SAMPLES_MIN && outer->len >= SAMPLES_MIN)
		a.cost = median(inner, true) + median(outer, true) +
			 DISTANCE_WEIGHT * median(step, true);
	return a;
}

/* The best answer, and whether it is clearly that. */
static bool choose(const struct neighbours n[2], bool same, struct answer *ret)
{
	struct answer best = { 0, false, G_MAXDOUBLE };
	double second = G_MAXDOUBLE;
	for (int i = 0; i < (same ? 1 : 2); i++)
		for (int by_column = 1; by_column >= 0; by_column--) {
			struct answer a = judge(&n[i], by_column);
			second = MIN(second, MAX(a.cost, best.cost));
			if (a.cost < best.cost)
				best = a;
		}
	*ret = best;
	return best.cost < G_MAXDOUBLE && second > CLEARLY * best.cost;
}

/* ---- the layout ---- */

static bool any_apart(const GArray *differences)
{
	for (guint i = 0; i < differences->len; i++)
		if (fabs(g_array_index(differences, double, i)) > SPACING_MIN_RAD)
			return true;
	return false;
}

static void set_directions(struct grid_layout *l, const struct neighbours *n)
{
	const GArray *across = l->column_by_column ? n->outer.across : n->inner.across;
	const GArray *up = l->column_by_column ? n->inner.up : n->outer.up;
	l->anticlockwise = median(across, false) < 0;
	l->upwards = median(up, false) > 0;
	l->is_grid = any_apart(across) && any_apart(up);
}

static void set_sizes(struct grid_layout *l, uint32_t first, uint32_t second, uint32_t run)
{
	bool run_is_second = run == second;
	uint32_t runs = run_is_second ? first : second;
	l->rows = l->column_by_column ? run : runs;
	l->columns = l->column_by_column ? runs : run;
	l->rows_first = l->column_by_column != run_is_second;
}

static bool find_at(const struct grid_records *records, enum import_order order, uint32_t first,
	uint32_t second, uint32_t reach, struct grid_layout *ret, GError **error)
{
	bool by_content = order == IMPORT_BY_CONTENT;
	uint32_t usual = order == IMPORT_ROW_BY_ROW ? first : second;
	struct neighbours n[2] = { { usual, differences_new(), differences_new() },
		{ usual == first ? second : first, differences_new(), differences_new() } };
	struct answer a = { usual, order != IMPORT_ROW_BY_ROW, 0 }, told;
	bool good = sample(records, (uint64_t)first * second, reach, n, error);
	*ret = (struct grid_layout){ .told = good && by_content &&
					     choose(n, first == second, &told) };
	ret->assumed = by_content && !ret->told;
	if (ret->told)
		a = told;
	ret->column_by_column = a.column_by_column;
	if (by_content)
		set_sizes(ret, first, second, a.run);
	else
		ret->columns = first, ret->rows = second;
	set_directions(ret, &n[a.run != n[0].run]);
	for (int i = 0; i < 2; i++) {
		differences_clear(&n[i].inner);
		differences_clear(&n[i].outer);
	}
	return good;
}

bool grid_layout_find(const struct grid_records *records, enum import_order order, uint32_t first,
	uint32_t second, struct grid_layout *ret, GError **error)
{
	for (uint32_t reach = 1; reach <= REACH_MAX; reach++) {
		struct grid_layout there;
		if (!find_at(records, order, first, second, reach, &there, error))
			return false;
		if (reach == 1 || there.is_grid)
			*ret = there;
		if (there.is_grid)
			break;
	}
	return true;
}

char *grid_layout_text(const struct grid_layout *l)
{
	return g_strdup_printf("%s first%s, %s, %s, %s", l->rows_first ? "rows" : "columns",
		l->assumed ? " (assumed)" : "",
		l->column_by_column ? "column by column" : "row by row",
		l->upwards ? "upwards" : "downwards",
		l->anticlockwise ? "anticlockwise" : "clockwise");
}

/* ---- turning ---- */

struct turning {
	const struct grid_records *records;
	const struct grid_layout *l;
	struct point_record *band, *run;
};

/* The run holds these rows of one column in the order of the file. */
static void put_column(struct turning *t, uint32_t rows, uint32_t file_column)
{
	const struct grid_layout *l = t->l;
	uint32_t column = l->anticlockwise ? l->columns - 1 - file_column : file_column;
	for (uint32_t row = 0; row < rows; row++) {
		uint32_t in_run = l->upwards ? rows - 1 - row : row;
		t->band[(size_t)row * l->columns + column] = t->run[in_run];
	}
}

/* Rows of the file first..first+rows-1 of every column. */
static bool read_columns(struct turning *t, uint32_t first, uint32_t rows, GError **error)
{
	uint32_t from = t->l->upwards ? t->l->rows - first - rows : first;
	for (uint32_t column = 0; column < t->l->columns; column++) {
		uint64_t at = (uint64_t)column * t->l->rows + from;
		if (!t->records->read(t->records->user_data, at, rows, t->run, error))
			return false;
		put_column(t, rows, column);
	}
	return true;
}

static bool read_rows(struct turning *t, uint32_t first, uint32_t rows, GError **error)
{
	const struct grid_layout *l = t->l;
	for (uint32_t i = 0; i < rows; i++) {
		uint32_t row = l->upwards ? l->rows - 1 - (first + i) : first + i;
		struct point_record *into = t->band + (size_t)i * l->columns;
		if (!t->records->read(t->records->user_data, (uint64_t)row * l->columns, l->columns,
			    into, error))
			return false;
		for (uint32_t c = 0; l->anticlockwise && c < l->columns / 2; c++) {
			struct point_record kept = into[c];
			into[c] = into[l->columns - 1 - c];
			into[l->columns - 1 - c] = kept;
		}
	}
	return true;
}

bool grid_turn(const struct grid_records *records, const struct grid_layout *l, points_writer *w,
	bool (*step)(double fraction, gpointer user_data), gpointer user_data, GError **error)
{
	uint64_t row_bytes = (uint64_t)l->columns * sizeof(struct point_record);
	uint32_t band_rows = (uint32_t)CLAMP(BAND_BYTES / row_bytes, 1, l->rows);
	g_autofree struct point_record *band = g_malloc(band_rows * row_bytes);
	g_autofree struct point_record *run = g_new(struct point_record, band_rows);
	struct turning t = { records, l, band, run };
	for (uint32_t first = 0; first < l->rows; first += band_rows) {
		uint32_t rows = MIN(band_rows, l->rows - first);
		if (step && !step((double)first / l->rows, user_data)) {
			g_set_error_literal(error, G_IO_ERROR, G_IO_ERROR_CANCELLED, "stopped");
			return false;
		}
		if (!(l->column_by_column ? read_columns : read_rows)(&t, first, rows, error) ||
			!points_writer_append(w, band, (size_t)rows * l->columns, error))
			return false;
	}
	return true;
}
