#include "process/features-private.h"
#include "process/model.h"
#include "process/normals.h"
#include <string.h>

#define POINTS_MOST 96 /* of a window; of more, every second, third ... */
#define WINDOW_MOST 12 /* cells each way */
#define WINDOW_CLIP 40
#define WINDOW_LEAST 2
/* The window is at least so many beams wide each way. */
#define BEAMS_WIDE 8.0f
/* And so many windows of planes: where those waver from noise, edges do, as far as they reach. */
#define WINDOWS_WIDE 3.5f
/* Edges are found within so many cells of where they are. */
#define SPACING_SHARE 0.7f
/* Points so far off the line are on it, in what is explained. */
#define ON_LINE 2.0f
/* What lies along the line is so much more than what lies along any other through the point, on average: leaves have as much. */
#define STANDS_OUT 1.9f
#define OTHERS     6
#define ERROR_MOST 1.2f
/* The direction's own error, from how far the points are off the line, 1 sigma. */
#define CERTAIN_RAD 0.032f
#define LONG_ENOUGH   0.27f /* standard deviation along it, in the radius */
#define POINTS_LEAST  6
#define ROUNDS 3
#define TUBE   1.5f
/* Lines that are tried first, to points in this part of the radius. */
#define STARTS 16
#define START_SHARE 0.4f
#define OWN_WEIGHT    2.0f
#define NEAR_CELLS    4.0f

/* The feature points around one, relative to it. */
struct around {
	uint32_t count;
	float x[POINTS_MOST], y[POINTS_MOST], z[POINTS_MOST], weight[POINTS_MOST];
};

struct line {
	float direction[3], middle[3];
	float error_m, spread_m; /* root mean squares across and along */
};

struct fitter {
	features *f;
	const struct features_input *of;
	const struct features_view *views;
	size_t count;
	const struct features_options *o;
	struct pose *to_view, *from_view; /* from the scan's frame into each view's, and back */
	struct ridges *ridges;            /* of each view */
	uint8_t least;        /* degree of a feature point */
};

/* ---- which points ---- */

/* Which cells are feature points as high as those beside them: a bit each, rows begin with whole words. */
struct ridges {
	uint32_t words; /* of a row */
	uint64_t *bits;
};

static inline bool is_ridge(const struct ridges *r, uint32_t row, uint32_t column)
{
	return r->bits[(size_t)row * r->words + column / 64] >> column % 64 & 1;
}

/* Edges are some cells wide; where they are highest, they are. */
static bool is_highest(const struct features_view *v, uint32_t row, uint32_t column)
{
	static const int8_t way[2][2] = { { 0, 1 }, { 1, 0 } };
	const range_grid *g = v->scan.grid;
	size_t i = (size_t)row * g->columns + column, a = i, b = i;
	for (int w = 0; w < 2; w++) {
		bool is_a = feature_step(g, row, column, way[w][0], way[w][1], &a);
		bool is_b = feature_step(g, row, column, -way[w][0], -way[w][1], &b);
		if ((!is_a || v->degree[a] < v->degree[i]) && (!is_b || v->degree[b] <= v->degree[i]))
			return true;
	}
	return false;
}

static struct ridges find_ridges(const struct features_view *v, uint8_t least, bool single_thread)
{
	const range_grid *g = v->scan.grid;
	struct ridges ret = { .words = g->columns / 64 + 1 };
	ret.bits = g_new0(uint64_t, (size_t)ret.words * g->rows + 1);
#pragma omp parallel for schedule(static) if (!single_thread)
	for (uint32_t row = 0; row < g->rows; row++)
		for (uint32_t column = 0; column < g->columns; column++) {
			size_t i = (size_t)row * g->columns + column;
			if (v->degree[i] > least && g->range_m[i] > 0 && is_highest(v, row, column))
				ret.bits[(size_t)row * ret.words + column / 64] |= (uint64_t)1 << column % 64;
		}
	return ret;
}

static void keep_point(struct around *a, const float at[3], float weight)
{
	if (a->count == POINTS_MOST) { /* a window wider than it must be: half of them are enough */
		for (uint32_t i = 0; i < POINTS_MOST / 2; i++) {
			a->x[i] = a->x[2 * i];
			a->y[i] = a->y[2 * i];
			a->z[i] = a->z[2 * i];
			a->weight[i] = 2 * a->weight[2 * i];
		}
		a->count = POINTS_MOST / 2;
	}
	a->x[a->count] = at[0];
	a->y[a->count] = at[1];
	a->z[a->count] = at[2];
	a->weight[a->count++] = weight;
}

/* Where one view is looked around in, and what from. */
struct window {
	const struct features_view *view;
	const struct ridges *ridges;
	const struct pose *back; /* from the view's frame; NULL: it is the scan's own */
	uint16_t leaf;           /* of the point; 0: not known */
	float here[3], radius_m, trust;
	uint32_t stride; /* of a window of many cells every second is enough, or every third ... */
};

static void add_cell(const struct window *w, size_t k, struct around *a)
{
	const range_grid *g = w->view->scan.grid;
	const uint16_t *leaf = w->view->scan.leaf;
	float off[3] = { g->x_m[k] - w->here[0], g->y_m[k] - w->here[1], g->z_m[k] - w->here[2] };
	float near = 1 - (off[0] * off[0] + off[1] * off[1] + off[2] * off[2]) / (w->radius_m * w->radius_m);
	if (near <= 0 || (leaf && w->leaf && leaf[k] && leaf[k] != w->leaf))
		return;
	if (w->back) {
		double turned[3] = { off[0], off[1], off[2] };
		pose_rotate(w->back, turned, turned);
		for (int d = 0; d < 3; d++)
			off[d] = (float)turned[d];
	}
	float degree = w->view->degree[k] * (1 / 255.f);
	keep_point(a, off, w->trust * near * degree * degree);
}

/* Columns from..to of a row, both included. */
static void add_run(const struct window *w, uint32_t row, int32_t from, int32_t to, struct around *a)
{
	const range_grid *g = w->view->scan.grid;
	for (uint32_t at = (uint32_t)from / 64; from <= to && at <= (uint32_t)to / 64; at++) {
		uint64_t bits = w->ridges->bits[(size_t)row * w->ridges->words + at];
		for (; bits; bits &= bits - 1) {
			int32_t c = (int32_t)(at * 64) + __builtin_ctzll(bits);
			if (c >= from && c <= to && (row + (uint32_t)c) % w->stride == 0)
				add_cell(w, (size_t)row * g->columns + (size_t)c, a);
		}
	}
}

/* Adds what is around a place, `at` in the view's frame; cell: which looks there. */
static void add_view(struct window *w, float spacing_m, uint32_t cell, const double at[3], struct around *a)
{
	const range_grid *g = w->view->scan.grid;
	const float range_m = (float)sqrt(at[0] * at[0] + at[1] * at[1] + at[2] * at[2]);
	const float level = fmaxf((float)(hypot(at[0], at[1]) / range_m), 0.1f);
	const float row_m = range_m * (float)g->row_rad, column_m = range_m * level * (float)g->column_rad;
	const int32_t width = (int32_t)g->columns, row = (int32_t)cell / width, column = (int32_t)cell % width;
	const int32_t down = CLAMP((int)ceilf(w->radius_m / row_m), WINDOW_LEAST, WINDOW_CLIP);
	const int32_t right = MIN(CLAMP((int)ceilf(w->radius_m / column_m), WINDOW_LEAST, WINDOW_CLIP), (width - 1) / 2);
	for (int k = 0; k < 3; k++)
		w->here[k] = (float)at[k];
	w->trust = fminf(1, spacing_m * spacing_m / (row_m * row_m));
	w->stride = (uint32_t)(MAX(down, right) / WINDOW_MOST + 1);
	for (int32_t r = MAX(row - down, 0); r <= MIN(row + down, (int32_t)g->rows - 1); r++) {
		add_run(w, (uint32_t)r, MAX(column - right, 0), MIN(column + right, width - 1), a);
		if (g->wraps && column < right)
			add_run(w, (uint32_t)r, column - right + width, width - 1, a);
		if (g->wraps && column + right >= width)
			add_run(w, (uint32_t)r, 0, column + right - width, a);
	}
}

/* ---- the line ---- */

struct moments {
	float n, s[3], m[6];
};

/* Of the points, each weighed by how near the line it is (tube_m: a quarter is left). */
static struct moments sum_moments(const struct around *a, const struct line *l, float tube_m)
{
	float n = OWN_WEIGHT, sx = 0, sy = 0, sz = 0, xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
	const float per = 1 / (tube_m * tube_m), ux = l->direction[0], uy = l->direction[1], uz = l->direction[2];
	const float ox = l->middle[0], oy = l->middle[1], oz = l->middle[2];
#pragma omp simd reduction(+ : n, sx, sy, sz, xx, xy, xz, yy, yz, zz)
	for (uint32_t i = 0; i < a->count; i++) {
		float x = a->x[i], y = a->y[i], z = a->z[i], dx = x - ox, dy = y - oy, dz = z - oz;
		float along = dx * ux + dy * uy + dz * uz;
		float off = 1 + (dx * dx + dy * dy + dz * dz - along * along) * per;
		float w = a->weight[i] / (off * off);
		n += w;
		sx += w * x;
		sy += w * y;
		sz += w * z;
		xx += w * x * x;
		xy += w * x * y;
		xz += w * x * z;
		yy += w * y * y;
		yz += w * y * z;
		zz += w * z * z;
	}
	return (struct moments){ n, { sx, sy, sz }, { xx, xy, xz, yy, yz, zz } };
}

/* The smallest eigenvalue of their M' = sigma I - M is the largest of M: by its powers, from the direction before. */
static void fit_round(struct line *l, const struct around *a, float tube_m)
{
	struct moments t = sum_moments(a, l, tube_m);
	float c[3][3] = { { t.m[0], t.m[1], t.m[2] }, { t.m[1], t.m[3], t.m[4] }, { t.m[2], t.m[4], t.m[5] } };
	float *v = l->direction;
	for (int p = 0; p < 3; p++)
		l->middle[p] = t.s[p] / t.n;
	for (int p = 0; p < 3; p++)
		for (int q = 0; q < 3; q++)
			c[p][q] = c[p][q] / t.n - l->middle[p] * l->middle[q];
	for (int k = 0; k < 3; k++) {
		float next[3], length = 0;
		for (int p = 0; p < 3; p++) {
			next[p] = c[p][0] * v[0] + c[p][1] * v[1] + c[p][2] * v[2];
			length += next[p] * next[p];
		}
		length = sqrtf(length);
		if (!(length > 1e-12f))
			return;
		for (int p = 0; p < 3; p++)
			v[p] = next[p] / length;
	}
}

/* How much lies about the line from the point itself that way. */
static float weight_along(const struct around *a, const float u[3], float tube_m)
{
	const float ux = u[0], uy = u[1], uz = u[2], most = tube_m * tube_m;
	float sum = 0;
#pragma omp simd reduction(+ : sum)
	for (uint32_t i = 0; i < a->count; i++) {
		float along = a->x[i] * ux + a->y[i] * uy + a->z[i] * uz;
		float off2 = a->x[i] * a->x[i] + a->y[i] * a->y[i] + a->z[i] * a->z[i] - along * along;
		sum += off2 < most ? a->weight[i] : 0;
	}
	return sum;
}

/* Of the lines to points far enough off, the one that has most about it: where several edges meet, their common axis is none. */
static bool find_start(struct line *l, const struct around *a, float radius_m, float tube_m)
{
	float best = 0;
	uint32_t stride = MAX(a->count / STARTS, 1);
	for (uint32_t i = stride / 2; i < a->count; i += stride) {
		float u[3] = { a->x[i], a->y[i], a->z[i] }, length = sqrtf(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
		if (length < START_SHARE * radius_m)
			continue;
		for (int k = 0; k < 3; k++)
			u[k] /= length;
		float weight = weight_along(a, u, tube_m);
		if (weight > best) {
			best = weight;
			memcpy(l->direction, u, sizeof u);
		}
	}
	return best > 0;
}

/* What lies along lines through the point in the picture's plane, on average; ahead: where the scanner looks. */
static float weight_of_others(const struct around *a, const float ahead[3], float tube_m)
{
	const float level = fmaxf(hypotf(ahead[0], ahead[1]), 1e-6f);
	const float right[3] = { ahead[1] / level, -ahead[0] / level, 0 };
	const float up[3] = { ahead[2] * right[1], -ahead[2] * right[0], level };
	float sum = 0;
	for (int k = 0; k < OTHERS; k++) {
		float c = cosf((float)G_PI * (float)k / OTHERS), s = sinf((float)G_PI * (float)k / OTHERS), u[3];
		for (int d = 0; d < 3; d++)
			u[d] = c * right[d] + s * up[d];
		sum += weight_along(a, u, tube_m);
	}
	return sum / OTHERS;
}

/* Whether it is one: it stands out, its direction is certain, and the point itself is on it. */
static bool is_line(const struct around *a, struct line *l, const float ahead[3], float explained_m, float radius_m)
{
	const float on_m2 = ON_LINE * ON_LINE * explained_m * explained_m, ux = l->direction[0], uy = l->direction[1],
		    uz = l->direction[2], ox = l->middle[0], oy = l->middle[1], oz = l->middle[2];
	float on = 0, on2 = 0, error = 0, along2 = 0, mean = 0;
#pragma omp simd reduction(+ : on, on2, error, along2, mean)
	for (uint32_t i = 0; i < a->count; i++) {
		float dx = a->x[i] - ox, dy = a->y[i] - oy, dz = a->z[i] - oz, along = dx * ux + dy * uy + dz * uz;
		float off2 = dx * dx + dy * dy + dz * dz - along * along;
		float w = off2 < on_m2 ? a->weight[i] : 0;
		on += w;
		on2 += w * w;
		error += w * off2;
		mean += w * along;
		along2 += w * along * along;
	}
	float own = ox * ux + oy * uy + oz * uz, own2 = ox * ox + oy * oy + oz * oz - own * own;
	if (!(on > 0))
		return false;
	float count = on * on / on2; /* if all had the same weight */
	l->error_m = sqrtf(fmaxf(error / on, 0));
	l->spread_m = sqrtf(fmaxf(along2 / on - mean * mean / (on * on), 0));
	return l->error_m <= ERROR_MOST * explained_m && l->error_m <= CERTAIN_RAD * l->spread_m * sqrtf(count) &&
	       l->spread_m >= LONG_ENOUGH * radius_m && own2 < on_m2 &&
	       on >= STANDS_OUT * weight_of_others(a, ahead, ON_LINE * explained_m);
}

static void fit_cell(const struct fitter *t, size_t i)
{
	const range_grid *g = t->of->grid;
	struct around a = { 0 };
	const float spacing_m = g->range_m[i] * (float)MAX(g->row_rad, g->column_rad);
	const float window_m = sqrtf(62 * t->o->range_noise_m * spacing_m);
	const float radius_m = fmaxf(t->o->line_radius_m, fmaxf(BEAMS_WIDE * spacing_m, WINDOWS_WIDE * window_m));
	const float explained_m = t->o->line_error * hypotf(t->o->range_noise_m, SPACING_SHARE * spacing_m);
	const double point[3] = { g->x_m[i], g->y_m[i], g->z_m[i] };
	t->f->kind[i] = FEATURE_UNDIRECTED;
	for (size_t k = 0; k < t->count; k++) {
		bool is_own = t->views[k].scan.grid == g;
		double at[3] = { point[0], point[1], point[2] };
		if (!is_own)
			pose_apply(&t->to_view[k], point, at);
		uint32_t cell = is_own ? (uint32_t)i : range_grid_find(t->views[k].scan.grid, at[0], at[1], at[2]);
		struct window w = { .view = &t->views[k], .ridges = &t->ridges[k], .back = is_own ? NULL : &t->from_view[k],
			.leaf = t->of->leaf ? t->of->leaf[i] : 0, .radius_m = radius_m };
		if (cell != RANGE_GRID_NONE)
			add_view(&w, spacing_m, cell, at, &a);
	}
	if (a.count < POINTS_LEAST)
		return;
	struct line l = { 0 };
	if (!find_start(&l, &a, radius_m, ON_LINE * explained_m))
		return;
	for (int round = 0; round < ROUNDS; round++)
		fit_round(&l, &a, explained_m * TUBE);
	const float ahead[3] = { g->x_m[i] / g->range_m[i], g->y_m[i] / g->range_m[i], g->z_m[i] / g->range_m[i] };
	bool is = is_line(&a, &l, ahead, explained_m, radius_m);
	t->f->line_error[i] = (uint16_t)fminf(lrintf(l.error_m * 1e4f), FEATURE_LINE_ERROR_NONE - 1);
	model_pack_normal(l.direction, t->f->direction[i]);
	if (is)
		t->f->kind[i] = FEATURE_DIRECTED;
}

/* What stands beside the top of an edge has the line of the nearest cell that is on it. */
static void take_over_cell(const struct fitter *t, const struct ridges *ridges, uint32_t row, uint32_t column)
{
	static const int8_t way[12][2] = { { 0, 1 }, { 0, -1 }, { 1, 0 }, { -1, 0 }, { 1, 1 }, { 1, -1 }, { -1, 1 }, { -1, -1 },
		{ 0, 2 }, { 0, -2 }, { 2, 0 }, { -2, 0 } };
	const range_grid *g = t->of->grid;
	features *f = t->f;
	size_t i = (size_t)row * g->columns + column, k;
	const float near_m = NEAR_CELLS * g->range_m[i] * (float)MAX(g->row_rad, g->column_rad) + 3 * t->o->range_noise_m;
	f->kind[i] = FEATURE_UNDIRECTED;
	for (int w = 0; w < 12; w++) {
		if (!feature_step(g, row, column, way[w][0], way[w][1], &k) ||
			!is_ridge(ridges, (uint32_t)(k / g->columns), (uint32_t)(k % g->columns)) || f->kind[k] != FEATURE_DIRECTED ||
			fabsf(g->range_m[k] - g->range_m[i]) > near_m)
			continue;
		f->kind[i] = FEATURE_DIRECTED;
		memcpy(f->direction[i], f->direction[k], sizeof f->direction[i]);
		f->line_error[i] = f->line_error[k];
		return;
	}
}

static void take_over(const struct fitter *t, const struct ridges *ridges)
{
	const range_grid *g = t->of->grid;
#pragma omp parallel for schedule(static) if (!t->o->single_thread)
	for (uint32_t row = 0; row < g->rows; row++)
		for (uint32_t column = 0; column < g->columns; column++) {
			size_t i = (size_t)row * g->columns + column;
			if (t->f->degree[i] > t->least && g->range_m[i] > 0 && !is_ridge(ridges, row, column))
				take_over_cell(t, ridges, row, column);
		}
}

void features_fit_lines(features *f, const struct features_input *of, const struct features_view *views, size_t count,
	const struct features_options *options)
{
	struct features_options o = features_defaults(options);
	const range_grid *g = of->grid;
	if (!(o.range_noise_m > 0))
		o.range_noise_m = normals_range_noise_m(g);
	g_autofree struct pose *to_view = g_new0(struct pose, 2 * count + 1);
	g_autofree struct ridges *ridges = g_new0(struct ridges, count + 1);
	struct fitter t = { f, of, views, count, &o, to_view, to_view + count, ridges, feature_least(&o) };
	const struct ridges *own = NULL;
	for (size_t k = 0; k < count; k++) {
		to_view[k] = pose_between(&views[k].scan.pose, &of->pose);
		t.from_view[k] = pose_inverse(&to_view[k]);
		ridges[k] = find_ridges(&views[k], t.least, o.single_thread);
		own = views[k].scan.grid == g ? &ridges[k] : own;
	}
	g_assert(own);
#pragma omp parallel for schedule(dynamic, 4) if (!o.single_thread)
	for (uint32_t row = 0; row < g->rows; row++)
		for (uint32_t column = 0; column < g->columns; column++)
			if (is_ridge(own, row, column))
				fit_cell(&t, (size_t)row * g->columns + column);
	take_over(&t, own);
	for (size_t k = 0; k < count; k++)
		g_free(ridges[k].bits);
}
