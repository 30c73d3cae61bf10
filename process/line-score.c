#include "process/line-score.h"
#include "process/cloud-cells.h"
#include "process/line-grow.h"
#include "process/range-grid.h"
#include "process/vector3.h"
#include <string.h>

#define BANDS 5
static const double band_end_m[BANDS] = { 5, 10, 20, 40, INFINITY };

/* Of creases: the faces are so far apart in direction; and touch. */
#define CREASE_COS    0.866f
#define TOUCH_M       0.03f
#define FACE_M        0.06f
#define FACE_CELLS    3 /* of the scan */
#define SAME_FACE_COS 0.985f
/* Places within so much of a line, and half a cell of the truth, are on it. */
#define ON_LINE_M     0.004f
#define ON_LINE_CELLS 0.6f
#define SEED_M        0.15 /* around a place its direction is told */
#define TURN_COS      0.996
#define EDGE_STEP_M   0.02 /* edges are asked so often, and lines are told */
#define LINE_STEP_M   0.005

/* Of an edge, as one station sees it. */
struct place {
	struct line_place on;
	float range_m;
	bool is_building, is_crease;
};
/* Where the truth is not smooth and even. */
struct spot {
	double at[3];
	float cell_m;
};
/* A straight edge, from begin to end along it. */
struct edge_run {
	struct straight line;
	double from_m, to_m;
	float range_m;
	bool is_crease;
};

struct line_truth {
	GArray *places, *spots, *runs;
	bool is_linked;
};

line_truth *line_truth_new(void)
{
	line_truth *t = g_new0(line_truth, 1);
	t->places = g_array_new(FALSE, TRUE, sizeof(struct place));
	t->spots = g_array_new(FALSE, TRUE, sizeof(struct spot));
	t->runs = g_array_new(FALSE, TRUE, sizeof(struct edge_run));
	return t;
}

void line_truth_free(line_truth *t)
{
	if (!t)
		return;
	g_array_unref(t->places);
	g_array_unref(t->spots);
	g_array_unref(t->runs);
	g_free(t);
}

/* ---- what a station sees ---- */

struct station {
	const struct bench_truth_scan *seen;
	struct feature_truth *cell;
	range_grid *grid;
	uint8_t *mark;
	double scan_cell_rad;
};

static void look(const range_grid *g, size_t i, double ret[3])
{
	double azimuth = ((double)(i % g->columns) + 0.5) * g->lattice.column_rad;
	double elevation = g->lattice.elevation_max_rad -
			   ((double)(i / g->columns) + 0.5) * g->lattice.row_rad;
	ret[0] = cos(elevation) * sin(azimuth);
	ret[1] = cos(elevation) * cos(azimuth);
	ret[2] = sin(elevation);
}

static void point(const struct station *s, size_t i, double ret[3])
{
	look(s->grid, i, ret);
	for (int k = 0; k < 3; k++)
		ret[k] *= (double)s->cell[i].range_m;
}

static double dot(const double a[3], const float b[3])
{
	return a[0] * (double)b[0] + a[1] * (double)b[1] + a[2] * (double)b[2];
}

/* What of it does not run along the other, as long as it is. */
static double across(const double off[3], const double along[3])
{
	double part = 0, length2 = 0, square = 0;
	for (int c = 0; c < 3; c++) {
		part += off[c] * along[c];
		length2 += along[c] * along[c];
	}
	part = length2 > 0 ? part / length2 : 0;
	for (int c = 0; c < 3; c++)
		square += (off[c] - part * along[c]) * (off[c] - part * along[c]);
	return sqrt(square);
}

/* Whether what is so far away stands as far before or behind a face as faces are wide at least: an edge is between them. */
static bool stands_off(const double off[3], const float normal[3])
{
	return fabs(dot(off, normal)) >= (double)FACE_M;
}

/* Whether the face of the cell goes on for a while, away from the edge. Where cells lie aslant of an edge they run along it for long:
 * its direction, where it is known (else 0 0 0), is what widths are measured across, in space and as the station sees it. */
static bool goes_on(const struct station *s, uint32_t row, uint32_t column, int down, int right,
	const double along[3])
{
	size_t i = (size_t)row * s->grid->columns + column, k;
	double from[3], at[3], ahead[3], seen[3], off[3], turn[3];
	const int cells = (int)ceil(FACE_CELLS * s->scan_cell_rad / s->grid->column_rad);
	point(s, i, from);
	look(s->grid, i, ahead);
	double facing = along[0] * ahead[0] + along[1] * ahead[1] + along[2] * ahead[2];
	for (int c = 0; c < 3; c++)
		seen[c] = along[c] - facing * ahead[c];
	for (int n = 1; n < 64; n++) {
		if (!range_grid_step(s->grid, row, column, n * down, n * right, &k) ||
			s->cell[k].instance != s->cell[i].instance ||
			vector3_dot(s->cell[k].normal, s->cell[i].normal) < SAME_FACE_COS)
			return false;
		point(s, k, at);
		look(s->grid, k, turn);
		for (int c = 0; c < 3; c++) {
			off[c] = at[c] - from[c];
			turn[c] -= ahead[c];
		}
		if (stands_off(off, s->cell[i].normal))
			return false;
		if (across(off, along) >= (double)FACE_M &&
			across(turn, seen) >= (cells - 0.5) * s->grid->row_rad)
			return true;
	}
	return false;
}

static bool is_building(const struct station *s, size_t i)
{
	return s->seen->cell[i].class == BENCH_TRUTH_BUILDING;
}

static void add_place(
	line_truth *t, const struct station *s, const double at[3], const double along[3], size_t i)
{
	struct place p = { .range_m = s->cell[i].range_m,
		.is_building = is_building(s, i),
		.is_crease = along[0] != 0 || along[1] != 0 || along[2] != 0 };
	double turned[3];
	p.on.within_m = ON_LINE_M + ON_LINE_CELLS * s->cell[i].range_m * (float)s->grid->row_rad;
	p.on.weight = 1;
	pose_apply(&s->seen->pose, at, p.on.at);
	pose_rotate(&s->seen->pose, along, turned);
	for (int k = 0; k < 3; k++)
		p.on.along[k] = (float)turned[k];
	g_array_append_val(t->places, p);
}

/* The direction in which both planes cut each other; false: none. */
static bool find_cut(const struct station *s, size_t i, size_t k, double ret[3])
{
	float cut[3];
	vector3_cross(s->cell[i].normal, s->cell[k].normal, cut);
	bool good = vector3_unit(cut);
	for (int c = 0; c < 3; c++)
		ret[c] = (double)cut[c];
	return good;
}

/* Where both planes cut each other, next to the middle of both points. */
static void add_crease(
	line_truth *t, const struct station *s, size_t i, size_t k, const double along[3])
{
	const float *a = s->cell[i].normal, *b = s->cell[k].normal;
	double p[3], q[3], at[3];
	point(s, i, p);
	point(s, k, q);
	for (int c = 0; c < 3; c++)
		at[c] = (p[c] + q[c]) / 2;
	double cosine = (double)vector3_dot(a, b), sine2 = 1 - cosine * cosine;
	double off_a = dot(p, a) - dot(at, a), off_b = dot(q, b) - dot(at, b);
	double by_a = (off_a - cosine * off_b) / sine2, by_b = (off_b - cosine * off_a) / sine2;
	for (int c = 0; c < 3; c++)
		at[c] += by_a * (double)a[c] + by_b * (double)b[c];
	double moved = 0;
	for (int c = 0; c < 3; c++)
		moved += (at[c] - (p[c] + q[c]) / 2) * (at[c] - (p[c] + q[c]) / 2);
	if (sqrt(moved) < (double)(TOUCH_M + 2 * s->cell[i].range_m * (float)s->grid->row_rad))
		add_place(t, s, at, along, i);
}

static const int8_t way[4][2] = { { 0, 1 }, { 0, -1 }, { 1, 0 }, { -1, 0 } };

/* A scan's cells there are small enough to tell the place to a half of them. */
static bool is_fine_enough(const struct station *s, size_t i)
{
	return (double)s->cell[i].range_m * s->scan_cell_rad <= 2 * LINE_SCORE_WITHIN_M;
}

/* Whether what is beside the cell, farther away, is as far behind its face as faces are wide at least. */
static bool stands_out(const struct station *s, size_t i, size_t k)
{
	double p[3], q[3];
	if (!(s->cell[k].range_m > 0))
		return true;
	point(s, i, p);
	point(s, k, q);
	for (int c = 0; c < 3; c++)
		q[c] -= p[c];
	return s->cell[k].range_m > s->cell[i].range_m && stands_off(q, s->cell[i].normal);
}

static void add_creases(line_truth *t, const struct station *s, uint32_t row, uint32_t column)
{
	size_t i = (size_t)row * s->grid->columns + column, k;
	for (int w = 0; w < 4 && is_fine_enough(s, i); w++) {
		double along[3];
		if (range_grid_step(s->grid, row, column, way[w][0], way[w][1], &k) &&
			s->cell[k].range_m > 0 && !s->cell[k].is_plant && !s->cell[k].is_glass &&
			vector3_dot(s->cell[i].normal, s->cell[k].normal) < CREASE_COS &&
			find_cut(s, i, k, along) &&
			goes_on(s, row, column, -way[w][0], -way[w][1], along) &&
			goes_on(s, (uint32_t)(k / s->grid->columns),
				(uint32_t)(k % s->grid->columns), way[w][0], way[w][1], along)) {
			add_crease(t, s, i, k, along);
			return;
		}
	}
}

/* On the plane of the near side, half way to the cell behind. */
static void add_ends(line_truth *t, const struct station *s, uint32_t row, uint32_t column)
{
	static const double none[3] = { 0 };
	size_t i = (size_t)row * s->grid->columns + column, k;
	const struct feature_truth *near = &s->cell[i];
	if (!is_fine_enough(s, i))
		return;
	for (int w = 0; w < 4; w++) {
		double p[3], a[3], b[3], at[3];
		if (!range_grid_step(s->grid, row, column, way[w][0], way[w][1], &k) ||
			!stands_out(s, i, k) ||
			!goes_on(s, row, column, -way[w][0], -way[w][1], none))
			continue;
		point(s, i, p);
		look(s->grid, i, a);
		look(s->grid, k, b);
		for (int c = 0; c < 3; c++)
			at[c] = (a[c] + b[c]) / 2;
		double ahead = dot(p, near->normal) / dot(at, near->normal);
		if (!(fabs(ahead - (double)near->range_m) < 0.05 * (double)near->range_m))
			ahead = (double)near->range_m;
		for (int c = 0; c < 3; c++)
			at[c] *= ahead;
		add_place(t, s, at, none, i);
		return;
	}
}

static bool is_leaf(const struct station *s, uint32_t row, uint32_t column)
{
	size_t k, i = (size_t)row * s->grid->columns + column;
	float sum[3] = { 0 };
	int count = 0;
	if (!s->cell[i].is_plant)
		return false;
	for (int y = -1; y <= 1; y++)
		for (int x = -1; x <= 1; x++)
			if (range_grid_step(s->grid, row, column, y, x, &k) &&
				s->cell[k].is_plant) {
				vector3_add(sum, 1, s->cell[k].normal);
				count++;
			}
	return vector3_length(sum) < 0.85f * (float)count;
}

static void add_spot(line_truth *t, const struct station *s, size_t i)
{
	double at[3];
	struct spot spot = { .cell_m = s->cell[i].range_m * (float)s->grid->row_rad };
	point(s, i, at);
	pose_apply(&s->seen->pose, at, spot.at);
	g_array_append_val(t->spots, spot);
}

static bool is_edge(const struct station *s, size_t i)
{
	return s->cell[i].range_m > 0 && s->mark[i] != FEATURE_TRUTH_SMOOTH;
}

static void add_cell(line_truth *t, const struct station *s, uint32_t row, uint32_t column)
{
	size_t i = (size_t)row * s->grid->columns + column;
	if (!is_edge(s, i))
		return;
	if (!is_leaf(s, row, column))
		add_spot(t, s, i);
	if (s->mark[i] == FEATURE_TRUTH_CREASE)
		add_creases(t, s, row, column);
	if (s->mark[i] == FEATURE_TRUTH_DEPTH)
		add_ends(t, s, row, column);
}

static range_grid *grid_of(const struct bench_truth_scan *seen)
{
	const struct panorama_desc desc = { seen->columns, seen->rows, seen->elevation_min_rad,
		seen->elevation_max_rad };
	g_autoptr(panorama) p = panorama_new(&desc, NULL);
	g_assert(p);
	for (size_t i = 0; i < (size_t)desc.columns * desc.rows; i++) {
		p->range_m[i] = seen->cell[i].range_m;
		p->cell[i] = seen->cell[i].range_m > 0 ? CELL_MEASURED : CELL_NO_RETURN;
	}
	return range_grid_from_panorama(p);
}

static void begin_station(
	struct station *s, const struct bench_truth_scan *seen, const float *light)
{
	*s = (struct station){ .seen = seen, .grid = grid_of(seen) };
	size_t cells = range_grid_cells(s->grid);
	s->cell = g_new0(struct feature_truth, cells);
	for (size_t i = 0; i < cells; i++) {
		struct feature_truth *c = &s->cell[i];
		c->range_m = seen->cell[i].range_m;
		memcpy(c->normal, seen->cell[i].normal, sizeof c->normal);
		if (light)
			memcpy(c->rgb, &light[3 * i], sizeof c->rgb);
		c->instance = seen->cell[i].instance;
		c->is_plant = seen->cell[i].class == BENCH_TRUTH_VEGETATION;
		c->is_glass = seen->cell[i].optics != 0;
	}
	s->mark = feature_truth_marks(s->grid, s->cell, 0.005f);
}

static void end_station(struct station *s)
{
	g_free(s->mark);
	g_free(s->cell);
	range_grid_free(s->grid);
}

void line_truth_add(line_truth *t, const struct bench_truth_scan *seen, const float *light,
	uint32_t scan_columns)
{
	struct station s;
	begin_station(&s, seen, light);
	s.scan_cell_rad = 2 * G_PI / scan_columns;
	for (uint32_t row = 1; row + 1 < s.grid->rows; row++)
		for (uint32_t column = 0; column < s.grid->columns; column++)
			add_cell(t, &s, row, column);
	end_station(&s);
}

void line_truth_add_behind(
	line_truth *t, const struct bench_truth_scan *seen, const struct bench_truth_scan *behind)
{
	struct station s;
	begin_station(&s, behind, NULL);
	for (uint32_t row = 1; row + 1 < s.grid->rows; row++)
		for (uint32_t column = 0; column < s.grid->columns; column++) {
			size_t i = (size_t)row * s.grid->columns + column;
			if (seen->cell[i].optics == BENCH_TRUTH_GLASS && is_edge(&s, i) &&
				!is_leaf(&s, row, column))
				add_spot(t, &s, i);
		}
	end_station(&s);
}

/* ---- straight edges ---- */

static int by_number(const void *a, const void *b)
{
	const double *x = a, *y = b;
	return (*x > *y) - (*x < *y);
}

/* What was found as runs without gaps. */
static void keep_runs(line_truth *t, const struct line_run *l)
{
	g_autofree double *along = g_new(double, l->found->len + 1);
	uint32_t building = 0, creases = 0;
	float range_m = INFINITY;
	for (guint n = 0; n < l->found->len; n++) {
		const struct place *p = &g_array_index(
			t->places, struct place, g_array_index(l->found, uint32_t, n));
		along[n] = straight_along(&l->line, p->on.at);
		building += p->is_building;
		creases += p->is_crease;
		range_m = fminf(range_m, p->range_m);
	}
	if (2 * building < l->found->len)
		return;
	qsort(along, l->found->len, sizeof *along, by_number);
	for (guint from = 0, n = 1; n <= l->found->len; n++)
		if (n == l->found->len || along[n] - along[n - 1] > LINE_SCORE_GAP_M) {
			struct edge_run run = { l->line, along[from], along[n - 1], range_m,
				2 * creases > l->found->len };
			if (run.to_m - run.from_m >= LINE_SCORE_LONG_M)
				g_array_append_val(t->runs, run);
			from = n;
		}
}

static void link_places(line_truth *t)
{
	g_autoptr(line_grower) g = line_grower_new(
		t->places->data, t->places->len, sizeof(struct place), LINE_SCORE_GAP_M, TURN_COS);
	struct line_run run;
	for (uint32_t i = 0; i < t->places->len; i++)
		if (!g_array_index(t->places, struct place, i).on.is_used &&
			line_grower_grow(g, i, SEED_M, &run) &&
			run.to_m - run.from_m >= LINE_SCORE_LONG_M)
			keep_runs(t, &run);
	t->is_linked = true;
}

/* ---- the score ---- */

/* A place every few centimetres of all lines. */
struct sample {
	double at[3];
	uint32_t line;
	float length_m;
};

static GArray *sample_lines(const profile_lines *lines, const struct pose *to_truth)
{
	GArray *all = g_array_new(FALSE, FALSE, sizeof(struct sample));
	for (guint n = 0; n < lines->line->len; n++) {
		const struct profile_line *line =
			&g_array_index(lines->line, struct profile_line, n);
		for (uint32_t v = line->first; v + 1 < line->first + line->count; v++) {
			const float *
				a = g_array_index(lines->vertex, struct profile_vertex, v).at_m,
			       *b = g_array_index(lines->vertex, struct profile_vertex, v + 1).at_m;
			double length = 0;
			for (int k = 0; k < 3; k++)
				length += ((double)b[k] - (double)a[k]) *
					  ((double)b[k] - (double)a[k]);
			length = sqrt(length);
			int steps = (int)ceil(length / LINE_STEP_M);
			for (int s = 0; s < steps; s++) {
				double part = (s + 0.5) / steps, at[3];
				for (int k = 0; k < 3; k++)
					at[k] = lines->origin_m[k] + (double)a[k] +
						part * ((double)b[k] - (double)a[k]);
				struct sample sample = { .line = n,
					.length_m = (float)(length / steps) };
				pose_apply(to_truth, at, sample.at);
				g_array_append_val(all, sample);
			}
		}
	}
	return all;
}

struct question {
	const struct sample *sample;
	const struct spot *spot;
	float nearest_m;
	GHashTable *lines; /* those within reach of a place of an edge, once each */
	bool is_any;
};

static void visit_spot(uint32_t i, const float off[3], void *data)
{
	struct question *q = data;
	if ((double)vector3_length(off) <= LINE_SCORE_WITHIN_M + (double)q->spot[i].cell_m)
		q->is_any = true;
}

static void score_astray(line_truth *t, GArray *samples, struct line_score *ret)
{
	struct cloud_view view = { t->spots->data, t->spots->len, sizeof(struct spot), false,
		{ 0 } };
	struct cloud_cells cells;
	cloud_cells_init(&cells, &view, 0.1f, NULL);
	for (guint n = 0; n < samples->len; n++) {
		const struct sample *s = &g_array_index(samples, struct sample, n);
		struct question q = { .spot = (const struct spot *)(void *)t->spots->data };
		cloud_cells_visit(&cells, s->at, 0.1f, 1u << 20, visit_spot, &q);
		ret->lines_m += (double)s->length_m;
		ret->astray_m += q.is_any ? 0 : (double)s->length_m;
	}
	cloud_cells_clear(&cells);
}

static void visit_line(uint32_t i, const float off[3], void *data)
{
	struct question *q = data;
	(void)off;
	g_hash_table_add(q->lines, GUINT_TO_POINTER(q->sample[i].line + 1));
}

/* How much of it each line covers, and those that cover the most. */
static void score_run(const struct edge_run *run, const struct cloud_cells *cells,
	const struct sample *sample, struct line_score *ret)
{
	uint32_t steps = (uint32_t)ceil((run->to_m - run->from_m) / EDGE_STEP_M), best[2] = { 0 },
		 any = 0, both = 0;
	double step_m = (run->to_m - run->from_m) / steps;
	g_autoptr(GHashTable) count = g_hash_table_new(NULL, NULL);
	g_autoptr(GPtrArray) sets =
		g_ptr_array_new_with_free_func((GDestroyNotify)g_hash_table_unref);
	for (uint32_t s = 0; s < steps; s++) {
		double at[3];
		struct question q = { .sample = sample, .lines = g_hash_table_new(NULL, NULL) };
		straight_place(&run->line, run->from_m + (s + 0.5) * step_m, at);
		cloud_cells_visit(cells, at, LINE_SCORE_WITHIN_M, 1u << 20, visit_line, &q);
		g_ptr_array_add(sets, q.lines);
		any += g_hash_table_size(q.lines) > 0;
		GHashTableIter i;
		gpointer line;
		g_hash_table_iter_init(&i, q.lines);
		while (g_hash_table_iter_next(&i, &line, NULL))
			g_hash_table_insert(count, line,
				GUINT_TO_POINTER(
					GPOINTER_TO_UINT(g_hash_table_lookup(count, line)) + 1));
	}
	/* The first covers most of all, the second most of what is left. */
	for (int n = 0; n < 2; n++) {
		GHashTableIter i;
		gpointer line, lines;
		uint32_t most = 0;
		g_hash_table_iter_init(&i, count);
		while (g_hash_table_iter_next(&i, &line, &lines)) {
			uint32_t adds = 0;
			for (guint k = 0; k < sets->len; k++)
				adds += g_hash_table_contains(sets->pdata[k], line) &&
					!(n && g_hash_table_contains(
						       sets->pdata[k], GUINT_TO_POINTER(best[0])));
			if (adds > most ||
				(adds == most && most && GPOINTER_TO_UINT(line) < best[n])) {
				most = adds;
				best[n] = GPOINTER_TO_UINT(line);
			}
		}
		both += most;
		if (!most)
			break;
	}
	int band = 0;
	while ((double)run->range_m > band_end_m[band])
		band++;
	ret->edges++;
	ret->edges_m += steps * step_m;
	ret->covered_m += both * step_m;
	ret->any_m += any * step_m;
	ret->band_m[band] += steps * step_m;
	ret->band_covered_m[band] += both * step_m;
}

void line_score_make(line_truth *t, const profile_lines *lines, const struct pose *to_truth,
	struct line_score *ret)
{
	*ret = (struct line_score){ .lines = lines->line->len };
	if (!t->is_linked)
		link_places(t);
	g_autoptr(GArray) samples = sample_lines(lines, to_truth);
	const struct sample *sample = (const struct sample *)(void *)samples->data;
	struct cloud_view view = { sample, samples->len, sizeof *sample, false, { 0 } };
	struct cloud_cells cells;
	score_astray(t, samples, ret);
	cloud_cells_init(&cells, &view, 0.1f, NULL);
	for (guint n = 0; n < t->runs->len; n++)
		score_run(&g_array_index(t->runs, struct edge_run, n), &cells, sample, ret);
	cloud_cells_clear(&cells);
}
