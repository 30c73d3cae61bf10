#include "process/scribble.h"
#include "process/scribble-edges.h"
#include "process/scribble-floor.h"
#include "process/scribble-window.h"
#include <stdlib.h>
#include <string.h>

#define RANGE_WEIGHT     1.0f
#define CREASE_WEIGHT    0.5f
#define INTENSITY_WEIGHT 0.1f
#define COLOUR_WEIGHT    0.2f
#define LEAF_WEIGHT      0.3f
#define REACH            2.0f
/* Between a floor and what stands on it. */
#define FLOOR_WEIGHT 0.6f
/* A dab has an extent too. */
#define EXTENT_LEAST_M 0.3f
/* Points of a stroke that distances are taken from. */
#define ANCHORS 24

enum label { UNKNOWN = 0, INSIDE = 1, OUTSIDE = 2, VOID = -1 };

struct anchor {
	float x_m, y_m, z_m;
};

/* A stroke as the cells that it goes over, and where it is in space. */
struct mark {
	enum scribble_side side;
	uint32_t *cell;
	size_t cells;
	struct anchor anchor[ANCHORS];
	uint32_t anchors;
	float reach_m;
	struct anchor middle;
	float all_m;    /* around it, along each axis: nothing beyond is within reach */
	uint16_t floor; /* that it is on; 0: none */
};

struct scribble {
	const range_grid *grid;
	struct scribble_options options;
	struct scribble_edges edges;
	uint16_t *floor;
	GArray *mark;
	int32_t *label;
	uint8_t *selected;
};

static void mark_clear(struct mark *m)
{
	g_free(m->cell);
}

static float weight(float given, float usual)
{
	return given == 0 ? usual : fmaxf(given, 0);
}

static struct scribble_options complete(const struct scribble_options *options)
{
	struct scribble_options o = options ? *options : (struct scribble_options){ 0 };
	return (struct scribble_options){
		.range_weight = weight(o.range_weight, RANGE_WEIGHT),
		.crease_weight = weight(o.crease_weight, CREASE_WEIGHT),
		.intensity_weight = weight(o.intensity_weight, INTENSITY_WEIGHT),
		.colour_weight = weight(o.colour_weight, COLOUR_WEIGHT),
		.leaf_weight = weight(o.leaf_weight, LEAF_WEIGHT),
		.reach = weight(o.reach, REACH),
	};
}

/* Things stand on a floor, they do not grow out of it. */
static void part_floors(scribble *s)
{
	const range_grid *g = s->grid;
	size_t n = range_grid_cells(g);
	for (size_t i = 0; i < n; i++) {
		uint32_t source = s->edges.source[i];
		if (source == RANGE_GRID_NONE)
			continue;
		size_t right = i % g->columns + 1 < g->columns ? i + 1 : i + 1 - g->columns,
		       below = i + g->columns;
		uint32_t beside = s->edges.source[right],
			 under = below < n ? s->edges.source[below] : RANGE_GRID_NONE;
		if (beside != RANGE_GRID_NONE && s->floor[source] != s->floor[beside])
			s->edges.step_right[i] += FLOOR_WEIGHT;
		if (under != RANGE_GRID_NONE && s->floor[source] != s->floor[under])
			s->edges.step_down[i] += FLOOR_WEIGHT;
	}
}

scribble *scribble_new(const range_grid *grid, const geometry *normals, const uint16_t *leaf,
	const struct scribble_options *options)
{
	size_t n = range_grid_cells(grid);
	scribble *s = g_new0(scribble, 1);
	g_autoptr(geometry) estimated = normals ? NULL : geometry_estimate(grid, NULL);
	if (!normals)
		normals = estimated;
	s->grid = grid;
	s->options = complete(options);
	scribble_edges_find(grid, normals, leaf, &s->options, &s->edges);
	s->floor = scribble_floors_find(grid, normals, &s->edges, NULL);
	part_floors(s);
	s->mark = g_array_new(false, false, sizeof(struct mark));
	g_array_set_clear_func(s->mark, (GDestroyNotify)mark_clear);
	s->label = g_new(int32_t, n);
	s->selected = g_new0(uint8_t, n);
	return s;
}

void scribble_free(scribble *s)
{
	if (!s)
		return;
	scribble_edges_clear(&s->edges);
	g_free(s->floor);
	g_array_unref(s->mark);
	g_free(s->label);
	g_free(s->selected);
	g_free(s);
}

/* ---- strokes ---- */

static void take_cell(const range_grid *g, GArray *cells, GHashTable *taken, long row, long column)
{
	if (g->wraps)
		column = (column % (long)g->columns + (long)g->columns) % (long)g->columns;
	if (row < 0 || row >= (long)g->rows || column < 0 || column >= (long)g->columns)
		return;
	uint32_t i = (uint32_t)(row * (long)g->columns + column);
	if (g_hash_table_add(taken, GUINT_TO_POINTER(i + 1)))
		g_array_append_val(cells, i);
}

static void dab(const range_grid *g, GArray *cells, GHashTable *taken, float column, float row,
	float radius)
{
	long reach = (long)ceilf(radius);
	take_cell(g, cells, taken, lroundf(floorf(row)), lroundf(floorf(column)));
	for (long dy = -reach; dy <= reach; dy++)
		for (long dx = -reach; dx <= reach; dx++)
			if ((float)(dx * dx + dy * dy) <= radius * radius)
				take_cell(g, cells, taken, lroundf(floorf(row)) + dy,
					lroundf(floorf(column)) + dx);
}

/* In steps of half a cell, in order along the stroke. */
static uint32_t *cells_of(const range_grid *g, const struct scribble_stroke *stroke, size_t *ret)
{
	GArray *cells = g_array_new(false, false, sizeof(uint32_t));
	g_autoptr(GHashTable) taken = g_hash_table_new(NULL, NULL);
	float radius = fminf(fmaxf(stroke->radius, 0), (float)g->rows);
	for (size_t k = 0; k < stroke->points; k++) {
		struct scribble_point to = stroke->point[k], from = stroke->point[k ? k - 1 : 0];
		float length = hypotf(to.column - from.column, to.row - from.row);
		long steps = lroundf(fminf(2 * length, 8.0f * (float)(g->columns + g->rows))) + 1;
		for (long i = 1; i <= steps; i++) {
			float t = (float)i / (float)steps;
			dab(g, cells, taken, from.column + t * (to.column - from.column),
				from.row + t * (to.row - from.row), radius);
		}
	}
	*ret = cells->len;
	return (uint32_t *)(void *)g_array_free(cells, false);
}

static int by_value(const void *a, const void *b)
{
	float x = *(const float *)a, y = *(const float *)b;
	return (x > y) - (x < y);
}

static float median_range_m(const range_grid *g, const struct mark *m)
{
	g_autofree float *range = g_new(float, m->cells + 1);
	size_t count = 0;
	for (size_t k = 0; k < m->cells; k++)
		if (g->range_m[m->cell[k]] > 0)
			range[count++] = g->range_m[m->cell[k]];
	qsort(range, count, sizeof *range, by_value);
	return count ? range[count / 2] : 0;
}

/* Through leaves a stroke meets also what is behind: what is further from the middle range than the stroke is wide is not meant.
 */
static void place_anchors(const range_grid *g, struct mark *m, float length_rad, float reach)
{
	float range = median_range_m(g, m), extent = fmaxf(range * length_rad, EXTENT_LEAST_M);
	m->reach_m = reach * extent;
	size_t stride = m->cells / ANCHORS + 1, met = 0;
	for (size_t k = 0; k < m->cells; k++) {
		size_t i = m->cell[k];
		if (!(g->range_m[i] > 0) || fabsf(g->range_m[i] - range) > extent)
			continue;
		if (met++ % stride == 0)
			m->anchor[m->anchors++] =
				(struct anchor){ g->x_m[i], g->y_m[i], g->z_m[i] };
	}
}

static void surround_anchors(struct mark *m)
{
	struct anchor low = { INFINITY, INFINITY, INFINITY },
		      high = { -INFINITY, -INFINITY, -INFINITY };
	for (uint32_t k = 0; k < m->anchors; k++) {
		const struct anchor *a = &m->anchor[k];
		low = (struct anchor){ fminf(low.x_m, a->x_m), fminf(low.y_m, a->y_m),
			fminf(low.z_m, a->z_m) };
		high = (struct anchor){ fmaxf(high.x_m, a->x_m), fmaxf(high.y_m, a->y_m),
			fmaxf(high.z_m, a->z_m) };
	}
	if (!m->anchors)
		return;
	m->middle = (struct anchor){ (low.x_m + high.x_m) / 2, (low.y_m + high.y_m) / 2,
		(low.z_m + high.z_m) / 2 };
	m->all_m = m->reach_m +
		   fmaxf(high.x_m - low.x_m, fmaxf(high.y_m - low.y_m, high.z_m - low.z_m)) / 2;
}

static float length_rad_of(const range_grid *g, const struct scribble_stroke *stroke)
{
	double least[2] = { INFINITY, INFINITY }, most[2] = { -INFINITY, -INFINITY };
	for (size_t k = 0; k < stroke->points; k++) {
		double at[2] = { stroke->point[k].column * g->column_rad,
			stroke->point[k].row * g->row_rad };
		for (int a = 0; a < 2; a++) {
			least[a] = fmin(least[a], at[a]);
			most[a] = fmax(most[a], at[a]);
		}
	}
	return (float)(hypot(most[0] - least[0], most[1] - least[1]) +
		       2 * stroke->radius * fmax(g->column_rad, g->row_rad));
}

/* More than half of it is on one. */
static uint16_t floor_under(const scribble *s, const struct mark *m)
{
	uint16_t floor = 0;
	int64_t lead = 0;
	for (size_t k = 0; k < m->cells; k++) {
		uint16_t f = s->floor[m->cell[k]];
		if (lead == 0)
			floor = f;
		lead += f == floor ? 1 : -1;
	}
	size_t on = 0;
	for (size_t k = 0; k < m->cells; k++)
		on += s->floor[m->cell[k]] == floor;
	return 2 * on > m->cells ? floor : 0;
}

/* ---- selecting ---- */

static bool within_reach(const struct mark *m, float x, float y, float z)
{
	if (!(fmaxf(fabsf(x - m->middle.x_m),
		      fmaxf(fabsf(y - m->middle.y_m), fabsf(z - m->middle.z_m))) < m->all_m))
		return false;
	float least = INFINITY;
	for (uint32_t k = 0; k < m->anchors; k++) {
		float dx = x - m->anchor[k].x_m, dy = y - m->anchor[k].y_m,
		      dz = z - m->anchor[k].z_m;
		least = fminf(least, dx * dx + dy * dy + dz * dz);
	}
	return least < m->reach_m * m->reach_m;
}

static int32_t first_label(const scribble *s, size_t i)
{
	uint32_t source = s->edges.source[i];
	if (source == RANGE_GRID_NONE)
		return VOID;
	const range_grid *g = s->grid;
	uint16_t floor = s->floor[source];
	bool near = false, meant = floor == 0;
	for (guint k = 0; k < s->mark->len && !(near && meant); k++) {
		const struct mark *m = &g_array_index(s->mark, struct mark, k);
		if (m->side != SCRIBBLE_INSIDE)
			continue;
		near = near || within_reach(m, g->x_m[source], g->y_m[source], g->z_m[source]);
		meant = meant || m->floor == floor;
	}
	return near && meant ? UNKNOWN : OUTSIDE;
}

static void paint(scribble *s)
{
	for (guint k = 0; k < s->mark->len; k++) {
		const struct mark *m = &g_array_index(s->mark, struct mark, k);
		for (size_t i = 0; i < m->cells; i++)
			s->label[m->cell[i]] = m->side == SCRIBBLE_INSIDE ? INSIDE : OUTSIDE;
	}
}

static void select_anew(scribble *s)
{
	size_t n = range_grid_cells(s->grid);
#pragma omp parallel for schedule(static)
	for (size_t i = 0; i < n; i++)
		s->label[i] = first_label(s, i);
	paint(s);
	scribble_window_flood(s->grid, &s->edges, INSIDE, s->label);
#pragma omp parallel for schedule(static)
	for (size_t i = 0; i < n; i++)
		s->selected[i] = s->label[i] == INSIDE && s->grid->range_m[i] > 0;
}

void scribble_draw(scribble *s, const struct scribble_stroke *stroke)
{
	struct mark m = { .side = stroke->side };
	m.cell = cells_of(s->grid, stroke, &m.cells);
	place_anchors(s->grid, &m, length_rad_of(s->grid, stroke), s->options.reach);
	surround_anchors(&m);
	m.floor = floor_under(s, &m);
	g_array_append_val(s->mark, m);
	select_anew(s);
}

bool scribble_undo(scribble *s)
{
	if (!s->mark->len)
		return false;
	g_array_set_size(s->mark, s->mark->len - 1);
	select_anew(s);
	return true;
}

const uint8_t *scribble_selected(const scribble *s)
{
	return s->selected;
}

size_t scribble_count(const scribble *s)
{
	size_t count = 0;
	for (size_t i = 0; i < range_grid_cells(s->grid); i++)
		count += s->selected[i];
	return count;
}
