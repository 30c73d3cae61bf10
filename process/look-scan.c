#include "process/look-scan.h"
#include "process/geometry.h"
#include "process/part-point.h"
#include <math.h>
#include <string.h>

/* Rows and columns: a quarter of the points is seen four times as soon, and more than a screen shows of a site. */
#define EVERY 2u
/* Points are of one surface when they are no farther apart than noise and their spacing explain, by normals that do not look away
 * from each other. */
#define NOISE_M  0.05f
#define SPACINGS 1.5f
#define SAME_DOT 0.3f
/* A surface goes on where the next cell is so near its plane, and looks the same way. */
#define GOES_ON_SHARE 0.25f /* of how far it is away */
#define GOES_ON_DOT   0.9f

struct look_scan {
	uint32_t number;
	scan_data *whole;
	scan_data thin; /* its grid is ours */
	struct pose pose, from_site;
	float reach_m;
	int16_t (
		*normal)[2]; /* as in struct scan_geometry; of the thin cells, as is what follows */
	float *plane_error_m, *curvature, *point_size_m;
	features *features;
	struct part_point *point; /* of cells that have one, row by row; sorted in the end */
	uint32_t *of_cell;        /* index of its point, RANGE_GRID_NONE */
	size_t count;
	/* Of each cell, written by any thread: */
	uint8_t *is_left_out;
	uint32_t *
		leaf; /* the greatest that the model told, so that it does not matter who came first */
};

void look_scan_free(look_scan *l)
{
	if (!l)
		return;
	scan_data_free(l->whole);
	range_grid_free(l->thin.grid);
	features_free(l->features);
	g_free(l->normal);
	g_free(l->plane_error_m);
	g_free(l->curvature);
	g_free(l->point_size_m);
	g_free(l->point);
	g_free(l->of_cell);
	g_free(l->is_left_out);
	g_free(l->leaf);
	g_free(l);
}

/* ---- what it is by itself ---- */

static void find_geometry(look_scan *l)
{
	const range_grid *g = l->thin.grid;
	const size_t cells = range_grid_cells(g);
	g_autoptr(geometry) found = geometry_estimate(g, NULL);
	l->normal = g_malloc_n(cells, sizeof *l->normal);
	l->plane_error_m = g_memdup2(found->plane_error_m, cells * sizeof(float));
	l->curvature = g_memdup2(found->curvature, cells * sizeof(float));
	l->point_size_m = g_new(float, cells);
#pragma omp parallel for schedule(static)
	for (size_t i = 0; i < cells; i++) {
		const float normal[3] = { found->normal_x[i], found->normal_y[i],
			found->normal_z[i] };
		model_pack_normal(normal, l->normal[i]);
		l->point_size_m[i] = g->range_m[i] > 0 ? range_grid_point_size_m(g, i) : NAN;
	}
}

static void find_features(look_scan *l)
{
	const struct features_input of = { .grid = l->thin.grid, .pose = l->pose };
	l->features = features_of_scans(&of, 1, 0, NULL);
}

/* ---- its points ---- */

static struct scan_geometry geometry_of(const look_scan *l)
{
	return (struct scan_geometry){ .count = range_grid_cells(l->thin.grid),
		.normal = (const int16_t(*)[2])l->normal,
		.plane_error_m = l->plane_error_m,
		.curvature = l->curvature,
		.point_size_m = l->point_size_m };
}

static struct scan_features features_of(const look_scan *l)
{
	const features *f = l->features;
	return (struct scan_features){ .count = range_grid_cells(l->thin.grid),
		.degree = f->degree,
		.kind = f->kind,
		.flags = f->flags,
		.direction = (const int16_t(*)[2])f->direction,
		.principal = (const int16_t(*)[2])f->principal,
		.line_error = f->line_error,
		.k1 = f->k1,
		.k2 = f->k2 };
}

/* All cells that have a point, in their order: each knows its place. */
static void count_points(look_scan *l)
{
	const range_grid *g = l->thin.grid;
	const size_t cells = range_grid_cells(g);
	l->of_cell = g_new(uint32_t, cells);
	for (size_t i = 0; i < cells; i++)
		l->of_cell[i] = g->range_m[i] > 0 ? (uint32_t)l->count++ : RANGE_GRID_NONE;
}

static void take_points(look_scan *l, double cell_m)
{
	const struct scan_geometry planes = geometry_of(l);
	const struct scan_features known = features_of(l);
	const struct part_source source = { .points = scan_points_of(&l->thin, &planes, &l->pose),
		.features = &known };
	const size_t cells = range_grid_cells(l->thin.grid);
	count_points(l);
	l->point = g_new(struct part_point, l->count + 1);
	l->is_left_out = g_malloc0(cells + 1);
	l->leaf = g_new0(uint32_t, cells + 1);
#pragma omp parallel for schedule(dynamic, 4096)
	for (size_t i = 0; i < cells; i++) {
		double reach_m = 0;
		/* Beyond the lattice are very few, which the model will have. */
		if (l->of_cell[i] != RANGE_GRID_NONE &&
			!part_point_take(&source, i, cell_m, &l->point[l->of_cell[i]], &reach_m))
			l->is_left_out[i] = 1;
	}
}

static float reach_of(const range_grid *g)
{
	float reach_m = 0;
	for (size_t i = 0; i < range_grid_cells(g); i++)
		reach_m = fmaxf(reach_m, g->range_m[i]);
	return reach_m;
}

look_scan *look_scan_new(
	const site *s, const struct model_input *input, double cell_m, GError **error)
{
	g_autoptr(look_scan) l = g_new0(look_scan, 1);
	l->number = input->number;
	l->pose = input->pose;
	l->from_site = pose_inverse(&input->pose);
	l->whole = scan_data_load(s, input->number, error);
	if (!l->whole)
		return NULL;
	g_assert(l->whole->grid);
	l->thin = (struct scan_data){ .number = input->number,
		.kind = input->kind,
		.grid = range_grid_thin(l->whole->grid, EVERY) };
	l->reach_m = reach_of(l->thin.grid);
	find_geometry(l);
	find_features(l);
	take_points(l, cell_m);
	return g_steal_pointer(&l);
}

/* ---- what the model has of it ---- */

static float cosine(const int16_t a[2], const int16_t b[2])
{
	float p[3], q[3];
	model_unpack_normal(a, p);
	model_unpack_normal(b, q);
	return p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
}

static bool has_normal(const int16_t packed[2])
{
	return packed[0] != MODEL_NORMAL_NONE || packed[1] != MODEL_NORMAL_NONE;
}

/* The thin cell that has the surface at a place in the scan's frame; RANGE_GRID_NONE: there is another one, or none. */
static uint32_t find_same(const look_scan *l, const struct model_point *p, const double at_m[3])
{
	const range_grid *g = l->whole->grid, *thin = l->thin.grid;
	const uint32_t i = range_grid_find(g, at_m[0], at_m[1], at_m[2]);
	if (i == RANGE_GRID_NONE || !(g->range_m[i] > 0))
		return RANGE_GRID_NONE;
	const uint32_t cell = i / g->columns / EVERY * thin->columns + i % g->columns / EVERY;
	const uint32_t k = l->of_cell[cell];
	if (k == RANGE_GRID_NONE)
		return RANGE_GRID_NONE;
	const struct part_point *q = &l->point[k];
	const float off[3] = { (float)at_m[0] - g->x_m[i], (float)at_m[1] - g->y_m[i],
		(float)at_m[2] - g->z_m[i] };
	const float most_m =
		NOISE_M + SPACINGS * 1e-4f * (float)MAX(p->spacing, q->spacing / EVERY);
	if (off[0] * off[0] + off[1] * off[1] + off[2] * off[2] > most_m * most_m ||
		(has_normal(p->normal) && has_normal(q->normal) &&
			cosine(p->normal, q->normal) < SAME_DOT))
		return RANGE_GRID_NONE;
	return cell;
}

static void tell_leaf(uint32_t *to, uint32_t leaf)
{
	uint32_t was = __atomic_load_n(to, __ATOMIC_RELAXED);
	while (was < leaf && !__atomic_compare_exchange_n(
				     to, &was, leaf, true, __ATOMIC_RELAXED, __ATOMIC_RELAXED))
		;
}

bool look_scan_saw_better(look_scan *l, const struct model_point *p, const double at_m[3])
{
	double at[3];
	pose_apply(&l->from_site, at_m, at);
	if (at[0] * at[0] + at[1] * at[1] + at[2] * at[2] > (double)l->reach_m * l->reach_m)
		return false;
	const uint32_t cell = find_same(l, p, at);
	if (cell == RANGE_GRID_NONE)
		return false;
	tell_leaf(&l->leaf[cell], p->leaf);
	if (p->spacing > l->point[l->of_cell[cell]].spacing / EVERY)
		return true;
	__atomic_store_n(&l->is_left_out[cell], 1, __ATOMIC_RELAXED);
	return false;
}

/* ---- segments ---- */

static bool goes_on(const look_scan *l, size_t from, size_t to)
{
	const range_grid *g = l->thin.grid;
	float normal[3];
	if (!(g->range_m[to] > 0) || !has_normal(l->normal[to]) ||
		cosine(l->normal[from], l->normal[to]) < GOES_ON_DOT)
		return false;
	const float step[3] = { g->x_m[to] - g->x_m[from], g->y_m[to] - g->y_m[from],
		g->z_m[to] - g->z_m[from] };
	model_unpack_normal(l->normal[from], normal);
	const float off = step[0] * normal[0] + step[1] * normal[1] + step[2] * normal[2];
	const float far2 = step[0] * step[0] + step[1] * step[1] + step[2] * step[2];
	return off * off < GOES_ON_SHARE * GOES_ON_SHARE * far2;
}

/* From the cells whose segment is known, over smooth surface. */
static void spread_leaves(look_scan *l)
{
	static const int8_t beside[4][2] = { { 0, 1 }, { 1, 0 }, { 0, -1 }, { -1, 0 } };
	const range_grid *g = l->thin.grid;
	const size_t cells = range_grid_cells(g);
	g_autofree uint32_t *queue = g_new(uint32_t, cells + 1);
	size_t end = 0;
	for (size_t i = 0; i < cells; i++)
		if (l->leaf[i] && has_normal(l->normal[i]))
			queue[end++] = (uint32_t)i;
	for (size_t at = 0; at < end; at++)
		for (int k = 0; k < 4; k++) {
			const uint32_t i = queue[at];
			size_t to;
			if (!range_grid_step(g, i / g->columns, i % g->columns, beside[k][0],
				    beside[k][1], &to) ||
				l->leaf[to] || !goes_on(l, i, to))
				continue;
			l->leaf[to] = l->leaf[i];
			queue[end++] = (uint32_t)to;
		}
}

const struct part_point *look_scan_points(look_scan *l, size_t *ret_count)
{
	size_t kept = 0;
	spread_leaves(l);
	for (size_t i = 0; i < range_grid_cells(l->thin.grid); i++) {
		const uint32_t k = l->of_cell[i];
		if (k == RANGE_GRID_NONE || l->is_left_out[i])
			continue;
		l->point[kept] = l->point[k];
		l->point[kept++].leaf = (uint16_t)l->leaf[i];
	}
	g_autofree struct part_point *before = l->point;
	*ret_count = kept;
	return l->point = part_points_sorted(before, kept);
}
