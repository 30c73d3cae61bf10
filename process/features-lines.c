#include "process/features-ridges.h"
#include "process/model.h"
#include "process/normals.h"
#include "process/vector3.h"
#include <string.h>

/* The window is at least so many beams wide each way. */
#define BEAMS_WIDE 10.0f
/* And so many windows of planes: where those waver from noise, edges do, as far as they reach. */
#define WINDOWS_WIDE 4.5f
/* Edges are found within so many cells of where they are. */
#define SPACING_SHARE 0.7f
/* Among so many of the 81 cells around it a point is on no line: that is foliage. */
#define CROWDED    34
#define NEAR_CELLS 8.0f
/* Points of a pole are of both its sides: a line that no face tells is askew by as much as they are apart. */
#define NARROW 0.06f
/* Lines are fitted at one in so many of the highest cells: where row + CHOSEN_STEP column is a multiple of that, which is so along any
 * row, column or diagonal once in as many cells. */
#define CHOSEN_OF   11
#define CHOSEN_STEP 3
#define CHOSEN_BACK 4 /* times CHOSEN_STEP leaves 1 */
#define CHOSEN_AWAY 6 /* rows, and columns, within which one is taken over */
_Static_assert(CHOSEN_STEP *CHOSEN_BACK % CHOSEN_OF == 1, "its inverse");
/* Rows and columns of a block. */
#define BLOCK_CELLS 64
/* Cells so far off a line are passed by it. */
#define PASSING_CELLS 1.5f

struct fitter {
	features *f;
	const struct features_input *of;
	const struct features_view *views;
	size_t count;
	const struct features_options *o;
	const features_ridges *own;
	struct pose *to_view, *to_own; /* from the scan's frame into each view's, and back */
	uint8_t least;                 /* degree of a feature point */
};

/* Whether the line of the feature points, which is one or not, is one in the end. Faces that cut each other make one of their own. */
static bool settle_line(const struct fitter *t, size_t i, const float here[3], float explained_m,
	float radius_m, bool is, struct feature_line *l)
{
	const bool is_end = is && !(t->f->flags[i] & FEATURE_CREASE);
	switch (feature_faces_at(t->of->grid, i, here, t->o, explained_m, radius_m, !is_end, l)) {
	case FEATURE_FACES_CUT: return true;
	case FEATURE_FACES_ONE:
	case FEATURE_FACES_UNKNOWN: /* a pole, a twig */
	case FEATURE_FACES_END: return is_end && l->error_m < NARROW * l->spread_m;
	default: return false;
	}
}

/* From the frames of the views into the scan's own. */
static void turn_points(const struct fitter *t, struct feature_around *a)
{
	for (uint32_t i = 0; i < a->count; i++) {
		double off[3] = { (double)a->x[i], (double)a->y[i], (double)a->z[i] };
		double cut[3] = { (double)a->cut[i][0], (double)a->cut[i][1],
			(double)a->cut[i][2] };
		if (t->views[a->frame[i]].scan.grid == t->of->grid)
			continue;
		pose_rotate(&t->to_own[a->frame[i]], off, off);
		pose_rotate(&t->to_own[a->frame[i]], cut, cut);
		a->x[i] = (float)off[0];
		a->y[i] = (float)off[1];
		a->z[i] = (float)off[2];
		for (int k = 0; k < 3; k++)
			a->cut[i][k] = (float)cut[k];
	}
}

/* Gathers the feature points around one, of all views. */
static void look_around(const struct fitter *t, size_t i, const struct ridge_point *here,
	float radius_m, struct feature_around *a)
{
	const range_grid *g = t->of->grid;
	struct ridges_window w = { .leaf = here->leaf,
		.radius_m = radius_m,
		.spacing_m = range_grid_point_size_m(g, i),
		.is_cut = ridge_has_cut(here) };
	a->count = 0;
	for (size_t k = 0; k < t->count; k++) {
		const bool is_own = t->views[k].scan.grid == g;
		const double at[3] = { (double)here->x, (double)here->y, (double)here->z };
		uint32_t cell = (uint32_t)i;
		w.ridges = t->views[k].ridges;
		w.frame = (uint8_t)k;
		memcpy(w.at, at, sizeof at);
		if (!is_own) {
			pose_apply(&t->to_view[k], at, w.at);
			cell = range_grid_find(w.ridges->grid, w.at[0], w.at[1], w.at[2]);
		}
		if (cell != RANGE_GRID_NONE)
			ridges_look_around(&w, cell, a);
	}
	turn_points(t, a);
}

static void fit_cell(const struct fitter *t, size_t i)
{
	const range_grid *g = t->of->grid;
	const uint32_t row = (uint32_t)(i / g->columns), column = (uint32_t)(i % g->columns);
	struct feature_around a;
	if (ridges_count(t->own, row, column) > CROWDED)
		return;
	const float spacing_m = range_grid_point_size_m(g, i);
	const float noise_m = feature_range_noise_m(t->o, g->range_m[i]);
	const float window_m = sqrtf(62 * noise_m * spacing_m);
	const float radius_m =
		fmaxf(t->o->line_radius_m, fmaxf(BEAMS_WIDE * spacing_m, WINDOWS_WIDE * window_m));
	const float explained_m = t->o->line_error * hypotf(noise_m, SPACING_SHARE * spacing_m);
	const struct ridge_point *here = ridges_at(t->own, row, column);
	const float point[3] = { here->x, here->y, here->z };
	look_around(t, i, here, radius_m, &a);
	const float ahead[3] = { g->x_m[i] / g->range_m[i], g->y_m[i] / g->range_m[i],
		g->z_m[i] / g->range_m[i] };
	struct feature_line l;
	bool is = feature_fit_line(
		&a, ridge_has_cut(here) ? here->cut : NULL, ahead, explained_m, radius_m, &l);
	if (isfinite(l.error_m)) {
		is = settle_line(t, i, point, explained_m, radius_m, is, &l);
		feature_measure_line(&a, explained_m, &l);
	}
	feature_keep_line(t->f, i, &l, is);
}

static bool is_chosen(const features_ridges *ridges, uint32_t row, uint32_t column)
{
	return (row + CHOSEN_STEP * column) % CHOSEN_OF == 0 && ridges_has(ridges, row, column);
}

/* How many columns further on the next cell of the row is that may be chosen: 0..CHOSEN_OF-1. */
static int32_t columns_to_chosen(uint32_t row, uint32_t column)
{
	return (int32_t)((CHOSEN_OF - CHOSEN_BACK) * (row + CHOSEN_STEP * column) % CHOSEN_OF);
}

/* Cells of a block look around in the same ones, which stay in the cache meanwhile. */
static void fit_block(const struct fitter *t, uint32_t from_row, uint32_t from_column)
{
	const range_grid *g = t->of->grid;
	const uint32_t rows = MIN(from_row + BLOCK_CELLS, g->rows),
		       columns = MIN(from_column + BLOCK_CELLS, g->columns);
	for (uint32_t row = from_row; row < rows; row++)
		for (uint32_t column = from_column; column < columns; column++)
			if (is_chosen(t->own, row, column))
				fit_cell(t, (size_t)row * g->columns + column);
}

/* Whether the line of cell k passes cell i, as the scanner sees it: what lies beside an edge may be far off it in depth. */
static bool passes(const struct fitter *t, size_t k, size_t i)
{
	const range_grid *g = t->of->grid;
	const float at[3] = { g->x_m[i], g->y_m[i], g->z_m[i] };
	const struct ridge_point *p =
		ridges_at(t->own, (uint32_t)(k / g->columns), (uint32_t)(k % g->columns));
	const float on[3] = { p->x, p->y, p->z };
	float u[3], aside[3];
	if (t->f->kind[k] != FEATURE_DIRECTED)
		return false;
	model_unpack_normal(t->f->direction[k], u);
	vector3_cross(on, u, aside);
	return fabsf(vector3_dot(aside, at)) <
	       PASSING_CELLS * range_grid_point_size_m(g, i) * vector3_length(aside);
}

/* A cell that others may take the line from, and how far away it is. */
struct chosen {
	size_t cell;
	int32_t away2;
	bool passes, found;
};

/* Takes the one at that place if it is chosen, on the same surface, and better. */
static void try_chosen(const struct fitter *t, uint32_t row, uint32_t column, int32_t down,
	int32_t right, struct chosen *ret)
{
	const range_grid *g = t->of->grid;
	const size_t i = (size_t)row * g->columns + column;
	const float near_m = NEAR_CELLS * range_grid_point_size_m(g, i) + 3 * t->o->range_noise_m;
	const int32_t away2 = down * down + right * right;
	size_t k;
	if (!range_grid_step(g, row, column, down, right, &k) ||
		!is_chosen(t->own, (uint32_t)(k / g->columns), (uint32_t)(k % g->columns)) ||
		fabsf(g->range_m[k] - g->range_m[i]) > near_m)
		return;
	const bool is_line = passes(t, k, i);
	if (!ret->found || is_line > ret->passes || (is_line == ret->passes && away2 < ret->away2))
		*ret = (struct chosen){ k, away2, is_line, true };
}

/* The nearest whose line passes here, else the nearest. */
static struct chosen find_chosen(const struct fitter *t, uint32_t row, uint32_t column)
{
	struct chosen ret = { 0 };
	for (int32_t down = -CHOSEN_AWAY; down <= CHOSEN_AWAY; down++) {
		const int32_t ahead = columns_to_chosen((uint32_t)((int32_t)row + down), column);
		if (ahead <= CHOSEN_AWAY)
			try_chosen(t, row, column, down, ahead, &ret);
		if (CHOSEN_OF - ahead <= CHOSEN_AWAY)
			try_chosen(t, row, column, down, ahead - CHOSEN_OF, &ret);
	}
	return ret;
}

/* What is not chosen has the line of the nearest that is; where there is none, its own. */
static void take_over(const struct fitter *t, uint32_t row, uint32_t column)
{
	features *f = t->f;
	const size_t i = (size_t)row * t->of->grid->columns + column;
	const struct chosen from = find_chosen(t, row, column);
	if (!from.found) {
		if (ridges_has(t->own, row, column))
			fit_cell(t, i);
		return;
	}
	f->kind[i] = from.passes ? f->kind[from.cell] : FEATURE_UNDIRECTED;
	memcpy(f->direction[i], f->direction[from.cell], sizeof f->direction[i]);
	f->line_error[i] = f->line_error[from.cell];
}

void features_fit_lines(features *f, const struct features_input *of,
	const struct features_view *views, size_t count, const struct features_options *options)
{
	struct features_options o = features_defaults(options);
	const range_grid *g = of->grid;
	if (!(o.range_noise_m > 0))
		o.range_noise_m = normals_range_noise_m(g, &o.noise_at_m);
	g_autofree struct pose *to_view = g_new0(struct pose, count + 1);
	g_autofree struct pose *to_own = g_new0(struct pose, count + 1);
	const features_ridges *own = NULL;
	for (size_t k = 0; k < count; k++) {
		to_view[k] = pose_between(&views[k].scan.pose, &of->pose);
		to_own[k] = pose_inverse(&to_view[k]);
		own = views[k].scan.grid == g ? views[k].ridges : own;
	}
	g_assert(own && count <= UINT8_MAX);
	const struct fitter t = { f, of, views, count, &o, own, to_view, to_own,
		feature_least(&o) };
	const uint32_t across = (g->columns + BLOCK_CELLS - 1) / BLOCK_CELLS,
		       blocks = across * ((g->rows + BLOCK_CELLS - 1) / BLOCK_CELLS);
#pragma omp parallel for schedule(dynamic) if (!o.single_thread)
	for (uint32_t block = 0; block < blocks; block++)
		fit_block(&t, block / across * BLOCK_CELLS, block % across * BLOCK_CELLS);
#pragma omp parallel for schedule(dynamic, 4) if (!o.single_thread)
	for (uint32_t row = 0; row < g->rows; row++)
		for (uint32_t column = 0; column < g->columns; column++) {
			size_t i = (size_t)row * g->columns + column;
			if (f->degree[i] > t.least && g->range_m[i] > 0 &&
				!is_chosen(own, row, column))
				take_over(&t, row, column);
		}
}
