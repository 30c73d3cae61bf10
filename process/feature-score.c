#include "process/feature-score.h"
#include "process/features-private.h"
#include "process/model.h"
#include "process/vector3.h"
#include <string.h>

#define DEPTH_STEP_M   0.1f
#define DEPTH_SIGMAS   4.0f
#define SLOPE_SHARE    0.5f
#define SMOOTH_SIGMAS  3.0f
#define CREASE_COS     0.866f /* 30 degrees */
#define SAME_FACE_COS  0.985f /* 10 */
#define SMOOTH_COS     0.978f /* 12 */
#define FACE_CELLS     3
#define FACE_M         0.06f
#define TOUCH_M        0.03f
#define COLOUR_STEP    0.06f
#define NEARBY         2
#define MEASURED_OFF_M 0.15f
/* Silhouettes: cells each way; how far off a line their centres are, at most (0.29 by the grid alone); how long it is, 1 sigma. */
#define ALONG_CELLS    12
#define STRAIGHT_CELLS 0.5
#define LONG_CELLS     4.0
/* Of a face that is seen from its side the line is not known well. */
#define SEEN_FROM_SIDE 0.94f

struct scene {
	const range_grid *g;
	const struct feature_truth *t;
	float noise_m;
};

/* The direction that a cell's centre looks in. */
static void look(const range_grid *g, size_t i, float ret[3])
{
	double azimuth = g->lattice.azimuth_min_rad +
			 ((double)(i % g->columns) + 0.5) * g->lattice.column_rad;
	double elevation = g->lattice.elevation_max_rad -
			   ((double)(i / g->columns) + 0.5) * g->lattice.row_rad;
	ret[0] = (float)(cos(elevation) * sin(azimuth));
	ret[1] = (float)(cos(elevation) * cos(azimuth));
	ret[2] = (float)sin(elevation);
}

/* How far, along the rays, the two surfaces are off each other's planes, beyond half of what the slope makes from cell to cell. */
static float step_m(const struct scene *s, size_t i, size_t k)
{
	const struct feature_truth *a = &s->t[i], *b = &s->t[k];
	float da[3], db[3];
	if (!(a->range_m > 0) || !(b->range_m > 0))
		return a->range_m > 0 || b->range_m > 0 ? INFINITY : 0;
	look(s->g, i, da);
	look(s->g, k, db);
	float there = vector3_dot(a->normal, db), here = vector3_dot(b->normal, da);
	float ahead = there < 0 ? a->range_m * vector3_dot(a->normal, da) / there : INFINITY;
	float back = here < 0 ? b->range_m * vector3_dot(b->normal, db) / here : INFINITY;
	float step = fminf(fabsf(ahead - b->range_m) - SLOPE_SHARE * fabsf(ahead - a->range_m),
		fabsf(back - a->range_m) - SLOPE_SHARE * fabsf(back - b->range_m));
	return fminf(fmaxf(step, 0), fabsf(a->range_m - b->range_m));
}

static bool is_measured(const struct scene *s, uint32_t row, uint32_t column)
{
	const range_grid *g = s->g;
	size_t i = (size_t)row * g->columns + column, k;
	for (int y = -1; y <= 1; y++)
		for (int x = -1; x <= 1; x++)
			if (range_grid_step(g, row, column, y, x, &k) &&
				fabsf(g->range_m[i] - s->t[k].range_m) <
					MEASURED_OFF_M + 0.02f * g->range_m[i])
				return g->range_m[i] > 0;
	return false;
}

static bool is_depth_edge(const struct scene *s, uint32_t row, uint32_t column)
{
	static const int8_t way[4][2] = { { 0, 1 }, { 0, -1 }, { 1, 0 }, { -1, 0 } };
	size_t i = (size_t)row * s->g->columns + column, k;
	float least_m = fmaxf(DEPTH_STEP_M, DEPTH_SIGMAS * s->noise_m);
	for (int w = 0; w < 4; w++)
		if (range_grid_step(s->g, row, column, way[w][0], way[w][1], &k) &&
			step_m(s, i, k) > least_m)
			return s->t[i].range_m > 0;
	return false;
}

/* Whether the face goes on from the cell, that way. */
static bool goes_on(const struct scene *s, uint32_t row, uint32_t column, int down, int right)
{
	size_t i = (size_t)row * s->g->columns + column, before = i, k;
	float da[3], db[3], wide_m = 0;
	look(s->g, i, da);
	for (int n = 1; n <= FACE_CELLS || wide_m < FACE_M; n++) {
		if (!range_grid_step(s->g, row, column, n * down, n * right, &k) ||
			!(s->t[k].range_m > 0) ||
			vector3_dot(s->t[k].normal, s->t[i].normal) < SAME_FACE_COS ||
			step_m(s, before, k) > TOUCH_M)
			return false;
		look(s->g, k, db);
		float away_m = 0;
		for (int a = 0; a < 3; a++)
			away_m += powf(s->t[k].range_m * db[a] - s->t[i].range_m * da[a], 2);
		wide_m = sqrtf(away_m);
		before = k;
	}
	return true;
}

/* *ret_direction may be NULL. */
static bool is_crease(const struct scene *s, uint32_t row, uint32_t column, float *ret_direction)
{
	static const int8_t way[4][2] = { { 0, 1 }, { 0, -1 }, { 1, 0 }, { -1, 0 } };
	size_t i = (size_t)row * s->g->columns + column, k;
	const struct feature_truth *a = &s->t[i];
	for (int w = 0; w < 4; w++) {
		int64_t r = (int64_t)row + way[w][0];
		if (!(a->range_m > 0) ||
			!range_grid_step(s->g, row, column, way[w][0], way[w][1], &k))
			continue;
		const struct feature_truth *b = &s->t[k];
		if (!(b->range_m > 0) || a->is_plant || b->is_plant || a->is_glass || b->is_glass ||
			vector3_dot(a->normal, b->normal) > CREASE_COS ||
			step_m(s, i, k) > TOUCH_M ||
			!goes_on(s, row, column, -way[w][0], -way[w][1]) ||
			!goes_on(s, (uint32_t)r, (uint32_t)(k % s->g->columns), way[w][0],
				way[w][1]))
			continue;
		if (ret_direction) {
			for (int c = 0; c < 3; c++) {
				int p = (c + 1) % 3, q = (c + 2) % 3;
				ret_direction[c] =
					a->normal[p] * b->normal[q] - a->normal[q] * b->normal[p];
			}
			float length = sqrtf(vector3_dot(ret_direction, ret_direction));
			for (int c = 0; c < 3; c++)
				ret_direction[c] /= length;
		}
		return true;
	}
	return false;
}

static float display(float linear)
{
	return powf(CLAMP(linear, 0.0f, 1.0f), 1 / 2.2f);
}

/* Of the cell with those beside it alone. */
static bool is_even(const struct scene *s, uint32_t row, uint32_t column)
{
	size_t i = (size_t)row * s->g->columns + column, k;
	const struct feature_truth *here = &s->t[i];
	float low[3] = { 1, 1, 1 }, high[3] = { 0 };
	if (!(here->range_m > 0) || here->is_plant || here->is_glass)
		return false;
	for (int y = -1; y <= 1; y++)
		for (int x = -1; x <= 1; x++) {
			if (!range_grid_step(s->g, row, column, y, x, &k))
				continue;
			const struct feature_truth *t = &s->t[k];
			if (!(t->range_m > 0) || t->instance != here->instance ||
				vector3_dot(t->normal, here->normal) < SMOOTH_COS ||
				step_m(s, i, k) > SMOOTH_SIGMAS * s->noise_m)
				return false;
			for (int c = 0; c < 3; c++) {
				low[c] = fminf(low[c], display(t->rgb[c]));
				high[c] = fmaxf(high[c], display(t->rgb[c]));
			}
		}
	for (int c = 0; c < 3; c++)
		if (high[c] - low[c] > COLOUR_STEP)
			return false;
	return true;
}

static uint8_t mark_of(const struct scene *s, uint32_t row, uint32_t column)
{
	size_t i = (size_t)row * s->g->columns + column;
	if (is_even(s, row, column))
		return FEATURE_TRUTH_SMOOTH;
	if (!is_measured(s, row, column))
		return 0;
	if (is_depth_edge(s, row, column))
		return s->t[i].is_plant ? FEATURE_TRUTH_PLANT : FEATURE_TRUTH_DEPTH;
	return is_crease(s, row, column, NULL) ? FEATURE_TRUTH_CREASE : 0;
}

uint8_t *feature_truth_marks(const range_grid *g, const struct feature_truth *truth, float noise_m)
{
	struct scene s = { g, truth, noise_m };
	uint8_t *marks = g_malloc0(range_grid_cells(g) + 1);
#pragma omp parallel for schedule(dynamic, 8)
	for (uint32_t row = 0; row < g->rows; row++)
		for (uint32_t column = 0; column < g->columns; column++)
			marks[(size_t)row * g->columns + column] = mark_of(&s, row, column);
	return marks;
}

/* ---- the score ---- */

static bool is_feature(const features *f, size_t i)
{
	return f->kind[i] >= FEATURE_UNDIRECTED;
}

static bool feature_near(const features *f, const range_grid *g, uint32_t row, uint32_t column)
{
	size_t k;
	for (int y = -1; y <= 1; y++)
		for (int x = -1; x <= 1; x++)
			if (range_grid_step(g, row, column, y, x, &k) && is_feature(f, k))
				return true;
	return false;
}

static bool all_smooth(const range_grid *g, const uint8_t *marks, uint32_t row, uint32_t column)
{
	size_t k;
	for (int y = -NEARBY; y <= NEARBY; y++)
		for (int x = -NEARBY; x <= NEARBY; x++)
			if (range_grid_step(g, row, column, y, x, &k) &&
				marks[k] != FEATURE_TRUTH_SMOOTH)
				return false;
	return true;
}

static void count_edges(
	const features *f, const struct scene *s, const uint8_t *marks, struct feature_score *ret)
{
	const range_grid *g = s->g;
	for (uint32_t row = 1; row + 1 < g->rows; row++)
		for (uint32_t column = 0; column < g->columns; column++) {
			size_t i = (size_t)row * g->columns + column;
			bool found = feature_near(f, g, row, column);
			ret->depth_edges += marks[i] == FEATURE_TRUTH_DEPTH;
			ret->depth_found += marks[i] == FEATURE_TRUTH_DEPTH && found;
			ret->creases += marks[i] == FEATURE_TRUTH_CREASE;
			ret->creases_found += marks[i] == FEATURE_TRUTH_CREASE && found;
			ret->plant_edges += marks[i] == FEATURE_TRUTH_PLANT;
			ret->plant_found += marks[i] == FEATURE_TRUTH_PLANT && found;
			ret->points += is_feature(f, i);
			ret->false_points += is_feature(f, i) && all_smooth(g, marks, row, column);
		}
	ret->edges = ret->depth_edges + ret->creases;
	ret->edges_found = ret->depth_found + ret->creases_found;
}

/* The direction of the one crease that is near; false: none, or several. */
static bool crease_direction(
	const struct scene *s, const uint8_t *marks, uint32_t row, uint32_t column, float ret[3])
{
	bool any = false;
	size_t k;
	for (int y = -3; y <= 3; y++)
		for (int x = -3; x <= 3; x++) {
			float d[3];
			if (!range_grid_step(s->g, row, column, y, x, &k) ||
				marks[k] == FEATURE_TRUTH_SMOOTH || !marks[k])
				continue;
			if (marks[k] != FEATURE_TRUTH_CREASE ||
				!is_crease(s, (uint32_t)(k / s->g->columns),
					(uint32_t)(k % s->g->columns), d) ||
				(any && fabsf(vector3_dot(d, ret)) < 0.9986f))
				return false;
			memcpy(ret, d, sizeof d);
			any = true;
		}
	return any;
}

/* ---- straight silhouettes ---- */

/* The near side of a depth edge. */
static bool is_silhouette(
	const struct scene *s, const uint8_t *marks, uint32_t row, uint32_t column)
{
	static const int8_t way[4][2] = { { 0, 1 }, { 0, -1 }, { 1, 0 }, { -1, 0 } };
	size_t i = (size_t)row * s->g->columns + column, k;
	float least_m = fmaxf(DEPTH_STEP_M, DEPTH_SIGMAS * s->noise_m);
	for (int w = 0; w < 4 && marks[i] == FEATURE_TRUTH_DEPTH; w++)
		if (range_grid_step(s->g, row, column, way[w][0], way[w][1], &k) &&
			(!(s->t[k].range_m > 0) ||
				(s->t[k].range_m > s->t[i].range_m && step_m(s, i, k) > least_m)))
			return true;
	return false;
}

/* Cells of one silhouette around one of them: moments of rows and columns, in cells of equal angle. */
struct silhouette {
	double n, x, y, xx, xy, yy;
};

/* false: another edge is near. */
static bool gather_silhouette(const struct scene *s, const uint8_t *marks, uint32_t row,
	uint32_t column, struct silhouette *ret)
{
	const struct feature_truth *own = &s->t[(size_t)row * s->g->columns + column];
	size_t k;
	for (int y = -ALONG_CELLS; y <= ALONG_CELLS; y++)
		for (int x = -ALONG_CELLS; x <= ALONG_CELLS; x++) {
			if (!range_grid_step(s->g, row, column, y, x, &k) ||
				marks[k] == FEATURE_TRUTH_SMOOTH || !marks[k])
				continue;
			const struct feature_truth *t = &s->t[k];
			bool same = t->instance == own->instance &&
				    vector3_dot(t->normal, own->normal) > SAME_FACE_COS;
			bool ahead = is_silhouette(s, marks, (uint32_t)(k / s->g->columns),
				(uint32_t)(k % s->g->columns));
			if (abs(y) <= 3 && abs(x) <= 3 &&
				(marks[k] != FEATURE_TRUTH_DEPTH || (ahead && !same)))
				return false;
			if (!same || !ahead)
				continue;
			ret->n++;
			ret->x += x;
			ret->y += y;
			ret->xx += x * x;
			ret->xy += x * y;
			ret->yy += y * y;
		}
	return true;
}

/* The direction of a straight silhouette of an even face: where the plane that it is seen in meets the face. */
static bool silhouette_direction(
	const struct scene *s, const uint8_t *marks, uint32_t row, uint32_t column, float ret[3])
{
	const range_grid *g = s->g;
	size_t i = (size_t)row * g->columns + column;
	struct silhouette e = { 0 };
	if (!is_silhouette(s, marks, row, column) ||
		!gather_silhouette(s, marks, row, column, &e) || e.n < ALONG_CELLS)
		return false;
	double x = e.x / e.n, y = e.y / e.n, xx = e.xx / e.n - x * x, xy = e.xy / e.n - x * y,
	       yy = e.yy / e.n - y * y;
	double half = hypot(0.5 * (xx - yy), xy), mean = 0.5 * (xx + yy),
	       angle = 0.5 * atan2(2 * xy, xx - yy);
	if (sqrt(fmax(mean - half, 0)) > STRAIGHT_CELLS || sqrt(mean + half) < LONG_CELLS ||
		fabs((0 - x) * sin(angle) - (0 - y) * cos(angle)) > 1)
		return false;
	double azimuth =
		       g->lattice.azimuth_min_rad + ((double)column + 0.5) * g->lattice.column_rad,
	       elevation = g->lattice.elevation_max_rad - ((double)row + 0.5) * g->lattice.row_rad;
	double right = cos(angle) * g->lattice.column_rad * cos(elevation),
	       down = sin(angle) * g->lattice.row_rad;
	float ahead[3], along[3], across[3], size = (float)hypot(right, down);
	look(g, i, ahead);
	along[0] = (float)(right * cos(azimuth) + down * sin(elevation) * sin(azimuth)) / size;
	along[1] = (float)(-right * sin(azimuth) + down * sin(elevation) * cos(azimuth)) / size;
	along[2] = (float)(-down * cos(elevation)) / size;
	for (int c = 0; c < 3; c++)
		across[c] = ahead[(c + 1) % 3] * along[(c + 2) % 3] -
			    ahead[(c + 2) % 3] * along[(c + 1) % 3];
	const float *n = s->t[i].normal;
	if (fabsf(vector3_dot(across, n)) > SEEN_FROM_SIDE)
		return false;
	for (int c = 0; c < 3; c++)
		ret[c] =
			across[(c + 1) % 3] * n[(c + 2) % 3] - across[(c + 2) % 3] * n[(c + 1) % 3];
	float length = sqrtf(vector3_dot(ret, ret));
	for (int c = 0; c < 3; c++)
		ret[c] /= length;
	return true;
}

static int by_value(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

static double share_of(GArray *sorted, double share)
{
	return sorted->len ? g_array_index(sorted, double, (guint)(sorted->len * share)) : NAN;
}

static void score_direction(
	const features *f, size_t i, const float truth[3], struct feature_lines *ret, GArray *off)
{
	float ours[3];
	ret->straight++;
	if (f->kind[i] != FEATURE_DIRECTED)
		return;
	model_unpack_normal(f->direction[i], ours);
	double angle = acos(fmin(fabsf(vector3_dot(truth, ours)), 1)) * 180 / G_PI;
	g_array_append_val(off, angle);
	ret->directed++;
}

static void finish_lines(struct feature_lines *l, GArray *off)
{
	g_array_sort(off, by_value);
	l->p50_deg = share_of(off, 0.5);
	l->p90_deg = share_of(off, 0.9);
}

static void score_directions(
	const features *f, const struct scene *s, const uint8_t *marks, struct feature_score *ret)
{
	const range_grid *g = s->g;
	g_autoptr(GArray) creases = g_array_new(FALSE, FALSE, sizeof(double));
	g_autoptr(GArray) silhouettes = g_array_new(FALSE, FALSE, sizeof(double));
	for (uint32_t row = 0; row < g->rows; row++)
		for (uint32_t column = 0; column < g->columns; column++) {
			size_t i = (size_t)row * g->columns + column;
			float truth[3] = { 0 };
			if (!is_feature(f, i))
				continue;
			if (marks[i] == FEATURE_TRUTH_CREASE &&
				crease_direction(s, marks, row, column, truth))
				score_direction(f, i, truth, &ret->straight_creases, creases);
			else if (silhouette_direction(s, marks, row, column, truth))
				score_direction(
					f, i, truth, &ret->straight_silhouettes, silhouettes);
		}
	finish_lines(&ret->straight_creases, creases);
	finish_lines(&ret->straight_silhouettes, silhouettes);
	g_array_append_vals(creases, silhouettes->data, silhouettes->len);
	ret->straight.straight =
		ret->straight_creases.straight + ret->straight_silhouettes.straight;
	ret->straight.directed =
		ret->straight_creases.directed + ret->straight_silhouettes.directed;
	finish_lines(&ret->straight, creases);
}

static bool is_leaf(const struct scene *s, uint32_t row, uint32_t column)
{
	float sum[3] = { 0 };
	int count = 0;
	size_t k;
	for (int y = -1; y <= 1; y++)
		for (int x = -1; x <= 1; x++)
			if (range_grid_step(s->g, row, column, y, x, &k) && s->t[k].is_plant) {
				for (int c = 0; c < 3; c++)
					sum[c] += s->t[k].normal[c];
				count++;
			}
	return count >= 5 && sqrtf(vector3_dot(sum, sum)) < 0.85f * (float)count;
}

static void count_leaves(const features *f, const struct scene *s, struct feature_score *ret)
{
	for (uint32_t row = 0; row < s->g->rows; row++)
		for (uint32_t column = 0; column < s->g->columns; column++) {
			size_t i = (size_t)row * s->g->columns + column;
			if (!is_feature(f, i) || !s->t[i].is_plant || !is_leaf(s, row, column))
				continue;
			ret->leaves++;
			ret->leaves_directed += f->kind[i] == FEATURE_DIRECTED;
		}
}

/* Of smooth surface that is not met at a slant that leaves no beam for a point. */
static void score_dithering(const features *f, const struct scene *s, const uint8_t *marks,
	const struct features_options *options, struct feature_score *ret)
{
	const range_grid *g = s->g;
	struct features_options o = features_defaults(options);
	double points[FEATURE_BANDS] = { 0 }, inked_m2[FEATURE_BANDS] = { 0 };
	ret->band_m[0] = 5;
	for (int b = 0; b < FEATURE_BANDS; b++)
		ret->band_m[b + 1] = ret->band_m[b] * pow(10, 1.0 / FEATURE_BANDS);
	for (size_t i = 0; i < range_grid_cells(g); i++) {
		float d[3], range_m = g->range_m[i];
		if (!(range_m >= 5) || range_m >= 50 || marks[i] != FEATURE_TRUTH_SMOOTH ||
			is_feature(f, i) || !g->rgb)
			continue;
		int b = MIN((int)(FEATURE_BANDS * log10(range_m / 5)), FEATURE_BANDS - 1);
		look(g, i, d);
		float cosine = -vector3_dot(d, s->t[i].normal), level = sqrtf(1 - d[2] * d[2]);
		float m2 = range_m * range_m * (float)(g->column_rad * g->row_rad) * level / cosine;
		float dark = 1 - (0.299f * g->rgb[3 * i] + 0.587f * g->rgb[3 * i + 1] +
					 0.114f * g->rgb[3 * i + 2]) /
					 255;
		dark = powf(dark, o.tone_exponent);
		if (m2 * dark * o.dither_per_m2 > 0.9f)
			continue;
		inked_m2[b] += m2 * dark;
		ret->band_m2[b] += m2;
		points[b] += f->kind[i] == FEATURE_DITHER;
	}
	for (int b = 0; b < FEATURE_BANDS; b++)
		ret->density_per_m2[b] = points[b] / inked_m2[b];
}

void feature_score_make(const features *f, const range_grid *g, const struct feature_truth *truth,
	float noise_m, const struct features_options *options, struct feature_score *ret)
{
	struct scene s = { g, truth, noise_m };
	g_autofree uint8_t *marks = feature_truth_marks(g, truth, noise_m);
	*ret = (struct feature_score){ 0 };
	count_edges(f, &s, marks, ret);
	score_directions(f, &s, marks, ret);
	count_leaves(f, &s, ret);
	score_dithering(f, &s, marks, options, ret);
}
