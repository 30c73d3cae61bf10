#include "process/features-private.h"
#include "process/model.h"
#include "process/normals.h"
#include <string.h>

#define WINDOW_MOST 12 /* cells each way */
/* Scans that see the place with so much wider beams do not tell more of it. */
#define TRUST_LEAST  0.2f
#define WINDOW_CLIP  40
#define WINDOW_LEAST 2
#define LEVELS       3 /* by the two above: of every cell, every second, every fourth */
#define TILE_CELLS   8
/* The window is at least so many beams wide each way. */
#define BEAMS_WIDE 10.0f
/* And so many windows of planes: where those waver from noise, edges do, as far as they reach. */
#define WINDOWS_WIDE 4.5f
/* Edges are found within so many cells of where they are. */
#define SPACING_SHARE 0.7f
/* Points so far off the line are on it, in what is explained. */
#define ON_LINE 2.0f
/* What lies along the line is so much more than what lies along any other through the point, on average: leaves have as much. */
#define STANDS_OUT 2.1f
#define OTHERS     6
#define ERROR_MOST 1.2f
/* The direction's own error, from how far the points are off the line, 1 sigma. */
#define CERTAIN_RAD  0.024f
#define LONG_ENOUGH  0.27f /* standard deviation along it, in the radius */
#define POINTS_LEAST 6
/* Directions of the halves of a line are apart by less, in rad; of one that the cuts agree with. */
#define HALVES_APART     0.1f
#define CUT_HALVES_APART 0.2f
/* Cuts of planes along a crease: the cosine of what they may be apart, how many, how far they are off their mean. */
#define SAME_CUT        0.966f
#define CUTS_LEAST      4
#define CUT_CERTAIN_RAD 0.12f
#define CUT_STANDS_OUT  1.3f
/* A line that they agree with is not further from their mean (8 degrees), and may be this uncertain; without one they must be
 * this close to each other: planes that hold something else beside are tilted alike. */
#define CUT_AGREES          0.99f
#define CUT_FIT_CERTAIN_RAD 0.03f
#define CUT_ALONE_RAD       0.03f
#define ROUNDS              3
#define TUBE                1.5f
/* Lines that are tried first, to points in this part of the radius. */
#define STARTS      16
#define START_SHARE 0.4f
#define OWN_WEIGHT  2.0f
/* What is not moved to a cut counts less among what is. */
#define UNMOVED_WEIGHT 0.25f
#define NEAR_CELLS     4.0f
/* Cells so far off a line are passed by it. */
#define PASSING_CELLS 1.5f

struct fitter {
	features *f;
	const struct features_input *of;
	const struct features_view *views;
	size_t count;
	const struct features_options *o;
	const struct ridges *own;
	struct pose *to_view;  /* from the scan's frame into each view's */
	struct ridges *ridges; /* of each view */
	uint8_t least;         /* degree of a feature point */
};

/* ---- which points ---- */

/* A feature point, in the frame of the scan whose lines are fitted. */
struct ridge_point {
	float x, y, z, weight;
	uint32_t cell;
	float cut[3]; /* its direction; 0 0 0: none, else the point is moved there */
};

/* Those of squares of cells side by side, for a window looks at few of many; of every cell, of every second diagonal, of every
 * fourth. */
struct tiles {
	uint32_t size, across; /* cells, tiles in a row of them */
	uint32_t *first;       /* of each tile, and the end */
	struct ridge_point *point;
};

/* Which cells are feature points as high as those beside them: a bit each, rows begin with whole words; those of a word begin at
 * its place. */
struct ridges {
	uint32_t words; /* of a row */
	uint64_t *bits;
	uint32_t *place;
	struct ridge_point *point;
	struct tiles tiles[LEVELS];
};

/* Of a cell that is one. */
static inline const struct ridge_point *ridge_at(
	const struct ridges *r, uint32_t row, uint32_t column)
{
	size_t word = (size_t)row * r->words + column / 64;
	return r->point + r->place[word] +
	       __builtin_popcountll(r->bits[word] & (((uint64_t)1 << column % 64) - 1));
}

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
		bool is_a = range_grid_step(g, row, column, way[w][0], way[w][1], &a);
		bool is_b = range_grid_step(g, row, column, -way[w][0], -way[w][1], &b);
		if ((!is_a || v->degree[a] < v->degree[i]) &&
			(!is_b || v->degree[b] <= v->degree[i]))
			return true;
	}
	return false;
}

static struct ridge_point point_of(const struct features_view *v, size_t i,
	const struct feature_cut *cut, const struct pose *to_scan)
{
	const range_grid *g = v->scan.grid;
	double at[3] = { g->x_m[i], g->y_m[i], g->z_m[i] };
	float degree = v->degree[i] * (1 / 255.f);
	struct ridge_point ret = { .weight = degree * degree, .cell = (uint32_t)i };
	for (int k = 0; cut && k < 3; k++) {
		at[k] = cut->at_m[k];
		ret.cut[k] = cut->direction[k];
		if (to_scan)
			ret.cut[k] = (float)(to_scan->rotation[k][0] * (double)cut->direction[0] +
					     to_scan->rotation[k][1] * (double)cut->direction[1] +
					     to_scan->rotation[k][2] * (double)cut->direction[2]);
	}
	if (to_scan)
		pose_apply(to_scan, at, at);
	ret.x = (float)at[0];
	ret.y = (float)at[1];
	ret.z = (float)at[2];
	return ret;
}

/* The cut of a cell, if it has one; *at goes on with the cells. */
static const struct feature_cut *next_cut(const GArray *cuts, guint *at, size_t i)
{
	while (cuts && *at < cuts->len && g_array_index(cuts, struct feature_cut, *at).cell < i)
		++*at;
	const struct feature_cut *ret =
		cuts && *at < cuts->len ? &g_array_index(cuts, struct feature_cut, *at) : NULL;
	return ret && ret->cell == i ? ret : NULL;
}

static void list_points(struct ridges *r, const struct features_view *v, const struct pose *to_scan)
{
	const range_grid *g = v->scan.grid;
	const size_t words = (size_t)r->words * g->rows;
	uint32_t count = 0;
	guint at_cut = 0;
	r->place = g_new(uint32_t, words + 1);
	for (size_t w = 0; w < words; w++) {
		r->place[w] = count;
		count += (uint32_t)__builtin_popcountll(r->bits[w]);
	}
	r->place[words] = count;
	r->point = g_new(struct ridge_point, count + 1);
	for (size_t w = 0; w < words; w++) {
		struct ridge_point *to = r->point + r->place[w];
		for (uint64_t bits = r->bits[w]; bits; bits &= bits - 1) {
			size_t i = w / r->words * g->columns + w % r->words * 64 +
				   (size_t)__builtin_ctzll(bits);
			*to++ = point_of(v, i, next_cut(v->cuts, &at_cut, i), to_scan);
		}
	}
}

static void ridges_clear(struct ridges *r)
{
	for (int level = 0; level < LEVELS; level++) {
		g_free(r->tiles[level].first);
		g_free(r->tiles[level].point);
	}
	g_free(r->bits);
	g_free(r->place);
	g_free(r->point);
}

/* The tile of a cell; false: it is not on one of the diagonals. */
static bool find_tile(
	const struct tiles *t, const range_grid *g, uint32_t cell, uint32_t stride, size_t *ret)
{
	const uint32_t row = cell / g->columns, column = cell % g->columns;
	*ret = (size_t)(row / t->size) * t->across + column / t->size;
	return ((row + column) & (stride - 1)) == 0;
}

static struct tiles lay_tiles(const struct ridges *r, const range_grid *g, uint32_t stride)
{
	const uint32_t count = r->place[(size_t)r->words * g->rows];
	struct tiles ret = { .size = TILE_CELLS * MAX(stride / 2, 1) };
	ret.across = (g->columns + ret.size - 1) / ret.size;
	const size_t tiles = (size_t)ret.across * ((g->rows + ret.size - 1) / ret.size);
	size_t tile;
	ret.first = g_new0(uint32_t, tiles + 2);
	for (uint32_t n = 0; n < count; n++)
		if (find_tile(&ret, g, r->point[n].cell, stride, &tile))
			ret.first[tile + 2]++;
	for (size_t k = 2; k < tiles + 2; k++)
		ret.first[k] += ret.first[k - 1];
	ret.point = g_new(struct ridge_point, ret.first[tiles + 1] + 1);
	for (uint32_t n = 0; n < count; n++)
		if (find_tile(&ret, g, r->point[n].cell, stride, &tile))
			ret.point[ret.first[tile + 1]++] = r->point[n];
	return ret;
}

/* to_scan: from the view's frame; NULL: it is the scan itself. */
static struct ridges find_ridges(const struct features_view *v, const struct pose *to_scan,
	uint8_t least, bool single_thread)
{
	const range_grid *g = v->scan.grid;
	struct ridges ret = { .words = g->columns / 64 + 1 };
	ret.bits = g_new0(uint64_t, (size_t)ret.words * g->rows + 1);
#pragma omp parallel for schedule(static) if (!single_thread)
	for (uint32_t row = 0; row < g->rows; row++)
		for (uint32_t column = 0; column < g->columns; column++) {
			size_t i = (size_t)row * g->columns + column;
			if (v->degree[i] > least && g->range_m[i] > 0 && is_highest(v, row, column))
				ret.bits[(size_t)row * ret.words + column / 64] |= (uint64_t)1
										   << column % 64;
		}
	list_points(&ret, v, to_scan);
	for (int level = 0; level < LEVELS; level++)
		ret.tiles[level] = lay_tiles(&ret, g, 1u << level);
	return ret;
}

void feature_keep_point(
	struct feature_around *a, const float at[3], const float cut[3], float weight)
{
	if (a->count ==
		FEATURE_POINTS_MOST) { /* a window wider than it must be: half of them are enough */
		for (uint32_t i = 0; i < FEATURE_POINTS_MOST / 2; i++) {
			a->x[i] = a->x[2 * i];
			a->y[i] = a->y[2 * i];
			a->z[i] = a->z[2 * i];
			a->weight[i] = 2 * a->weight[2 * i];
			memcpy(a->cut[i], a->cut[2 * i], sizeof a->cut[i]);
		}
		a->count = FEATURE_POINTS_MOST / 2;
	}
	a->x[a->count] = at[0];
	a->y[a->count] = at[1];
	a->z[a->count] = at[2];
	for (int k = 0; k < 3; k++)
		a->cut[a->count][k] = cut ? cut[k] : 0;
	a->weight[a->count++] = weight;
}

/* Where one view is looked around in. */
struct window {
	const struct features_view *view;
	const struct ridges *ridges;
	const struct tiles *tiles;      /* of many cells every second is enough, or every fourth */
	uint16_t leaf;                  /* of the point; 0: not known */
	float here[3], radius_m, trust; /* in the scan's frame */
	bool is_cut;                    /* the point is moved to a cut */
};

static bool has_cut(const struct ridge_point *p)
{
	return p->cut[0] != 0 || p->cut[1] != 0 || p->cut[2] != 0;
}

static void add_point(const struct window *w, const struct ridge_point *p, struct feature_around *a)
{
	float off[3] = { p->x - w->here[0], p->y - w->here[1], p->z - w->here[2] };
	float near = 1 - (off[0] * off[0] + off[1] * off[1] + off[2] * off[2]) /
				 (w->radius_m * w->radius_m);
	if (near > 0)
		feature_keep_point(a, off, p->cut,
			w->trust * near * p->weight *
				(w->is_cut && !has_cut(p) ? UNMOVED_WEIGHT : 1));
}

static bool is_of_leaf(const struct window *w, uint32_t cell)
{
	const uint16_t *leaf = w->view->scan.leaf;
	uint16_t there = leaf && w->leaf ? leaf[cell] : 0;
	return there == 0 || there == w->leaf;
}

/* Tiles that hold columns from..to, both included, of a row of tiles. */
static void add_run(
	const struct window *w, uint32_t row, int32_t from, int32_t to, struct feature_around *a)
{
	const struct tiles *t = w->tiles;
	const size_t at = (size_t)row * t->across;
	const uint32_t end = t->first[at + (uint32_t)to / t->size + 1];
	for (uint32_t n = t->first[at + (uint32_t)from / t->size]; n < end; n++)
		if (is_of_leaf(w, t->point[n].cell))
			add_point(w, &t->point[n], a);
}

/* Adds what is around a place, `at` in the view's frame; cell: which looks there. */
static void add_view(struct window *w, float spacing_m, uint32_t cell, const double at[3],
	struct feature_around *a)
{
	const range_grid *g = w->view->scan.grid;
	const float range_m = (float)sqrt(at[0] * at[0] + at[1] * at[1] + at[2] * at[2]);
	const float level = fmaxf((float)(hypot(at[0], at[1]) / range_m), 0.1f);
	const float row_m = range_m * (float)g->row_rad,
		    column_m = range_m * level * (float)g->column_rad;
	const int32_t width = (int32_t)g->columns, row = (int32_t)cell / width,
		      column = (int32_t)cell % width;
	const int32_t down = CLAMP((int)ceilf(w->radius_m / row_m), WINDOW_LEAST, WINDOW_CLIP);
	const int32_t right =
		MIN(CLAMP((int)ceilf(w->radius_m / column_m), WINDOW_LEAST, WINDOW_CLIP),
			(width - 1) / 2);
	w->trust = fminf(1, spacing_m * spacing_m / (row_m * row_m));
	if (w->trust < TRUST_LEAST)
		return;
	w->tiles = w->ridges->tiles;
	for (int32_t most = WINDOW_MOST; MAX(down, right) >= most; most *= 2)
		w->tiles++;
	const int32_t size = (int32_t)w->tiles->size, low = MAX(row - down, 0),
		      high = MIN(row + down, (int32_t)g->rows - 1);
	const int32_t left = MAX(column - right, 0), end = MIN(column + right, width - 1);
	/* Those that begin beyond the seam; tiles there are not to be looked at twice. */
	const int32_t beyond = column - right + width, after = column + right - width;
	for (int32_t r = low / size; r <= high / size; r++) {
		add_run(w, (uint32_t)r, left, end, a);
		if (g->wraps && column < right && beyond / size > end / size)
			add_run(w, (uint32_t)r, beyond, width - 1, a);
		if (g->wraps && after >= 0 && after / size < left / size)
			add_run(w, (uint32_t)r, 0, after, a);
	}
}

/* ---- the line ---- */

struct moments {
	float n, s[3], m[6];
};

/* Of the points, each weighed by how near the line it is (tube_m: a quarter is left). */
static struct moments sum_moments(
	const struct feature_around *a, const struct feature_line *l, float tube_m)
{
	float n = OWN_WEIGHT, sx = 0, sy = 0, sz = 0, xx = 0, xy = 0, xz = 0, yy = 0, yz = 0,
	      zz = 0;
	const float per = 1 / (tube_m * tube_m), ux = l->direction[0], uy = l->direction[1],
		    uz = l->direction[2];
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
static void fit_round(struct feature_line *l, const struct feature_around *a, float tube_m)
{
	struct moments t = sum_moments(a, l, tube_m);
	float c[3][3] = { { t.m[0], t.m[1], t.m[2] }, { t.m[1], t.m[3], t.m[4] },
		{ t.m[2], t.m[4], t.m[5] } };
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
static float weight_along(const struct feature_around *a, const float u[3], float tube_m)
{
	const float ux = u[0], uy = u[1], uz = u[2], most = tube_m * tube_m;
	float sum = 0;
#pragma omp simd reduction(+ : sum)
	for (uint32_t i = 0; i < a->count; i++) {
		float along = a->x[i] * ux + a->y[i] * uy + a->z[i] * uz;
		float off2 =
			a->x[i] * a->x[i] + a->y[i] * a->y[i] + a->z[i] * a->z[i] - along * along;
		sum += off2 < most ? a->weight[i] : 0;
	}
	return sum;
}

/* Of the lines to points far enough off, the one that has most about it: where several edges meet, their common axis is none. */
static bool find_start(
	struct feature_line *l, const struct feature_around *a, float radius_m, float tube_m)
{
	float best = 0;
	uint32_t stride = MAX(a->count / STARTS, 1);
	for (uint32_t i = stride / 2; i < a->count; i += stride) {
		float u[3] = { a->x[i], a->y[i], a->z[i] },
		      length = sqrtf(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
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
static float weight_of_others(const struct feature_around *a, const float ahead[3], float tube_m)
{
	const float level = fmaxf(hypotf(ahead[0], ahead[1]), 1e-6f);
	const float right[3] = { ahead[1] / level, -ahead[0] / level, 0 };
	const float up[3] = { ahead[2] * right[1], -ahead[2] * right[0], level };
	float sum = 0;
	for (int k = 0; k < OTHERS; k++) {
		float c = cosf((float)G_PI * (float)k / OTHERS),
		      s = sinf((float)G_PI * (float)k / OTHERS), u[3];
		for (int d = 0; d < 3; d++)
			u[d] = c * right[d] + s * up[d];
		sum += weight_along(a, u, tube_m);
	}
	return sum / OTHERS;
}

/* Measures what lies on the line; 0: nothing, or not the point itself; else how many points, if all had the same weight. */
static float measure_line(
	const struct feature_around *a, struct feature_line *l, float on_m2, float *ret_on)
{
	const float ux = l->direction[0], uy = l->direction[1], uz = l->direction[2],
		    ox = l->middle[0], oy = l->middle[1], oz = l->middle[2];
	float on = 0, on2 = 0, error = 0, along2 = 0, mean = 0;
#pragma omp simd reduction(+ : on, on2, error, along2, mean)
	for (uint32_t i = 0; i < a->count; i++) {
		float dx = a->x[i] - ox, dy = a->y[i] - oy, dz = a->z[i] - oz,
		      along = dx * ux + dy * uy + dz * uz;
		float off2 = dx * dx + dy * dy + dz * dz - along * along;
		float w = off2 < on_m2 ? a->weight[i] : 0;
		on += w;
		on2 += w * w;
		error += w * off2;
		mean += w * along;
		along2 += w * along * along;
	}
	float own = ox * ux + oy * uy + oz * uz, own2 = ox * ox + oy * oy + oz * oz - own * own;
	*ret_on = on;
	if (!(on > 0))
		return 0;
	l->error_m = sqrtf(fmaxf(error / on, 0));
	l->spread_m = sqrtf(fmaxf(along2 / on - mean * mean / (on * on), 0));
	return own2 < on_m2 ? on * on / on2 : 0;
}

/* By how much the directions of the two halves of a line differ, as the sine. */
static float halves_apart(const struct feature_around *a, const struct feature_line *l, float on_m2)
{
	float n[2] = { 0 }, t[2] = { 0 }, tt[2] = { 0 }, p[2][3] = { { 0 } }, tp[2][3] = { { 0 } };
	const float *u = l->direction, *o = l->middle;
	for (uint32_t i = 0; i < a->count; i++) {
		float d[3] = { a->x[i] - o[0], a->y[i] - o[1], a->z[i] - o[2] },
		      along = d[0] * u[0] + d[1] * u[1] + d[2] * u[2], off2 = 0;
		for (int k = 0; k < 3; k++) {
			d[k] -= along * u[k];
			off2 += d[k] * d[k];
		}
		if (off2 >= on_m2)
			continue;
		int h = along > 0;
		float w = a->weight[i];
		n[h] += w;
		t[h] += w * along;
		tt[h] += w * along * along;
		for (int k = 0; k < 3; k++) {
			p[h][k] += w * d[k];
			tp[h][k] += w * along * d[k];
		}
	}
	float apart2 = 0;
	for (int k = 0; k < 3; k++) {
		float slope[2];
		for (int h = 0; h < 2; h++)
			slope[h] =
				(tp[h][k] - t[h] * p[h][k] / n[h]) / (tt[h] - t[h] * t[h] / n[h]);
		apart2 += (slope[0] - slope[1]) * (slope[0] - slope[1]);
	}
	return isfinite(apart2) ? sqrtf(apart2) : INFINITY;
}

/* Whether it is one: it stands out, its direction is certain, and the point itself is on it. */
static bool is_line(const struct feature_around *a, struct feature_line *l, const float ahead[3],
	float explained_m, float radius_m)
{
	const float on_m2 = ON_LINE * ON_LINE * explained_m * explained_m;
	float on, count = measure_line(a, l, on_m2, &on);
	return count > 0 && l->error_m <= ERROR_MOST * explained_m &&
	       l->error_m <= CERTAIN_RAD * l->spread_m * sqrtf(count) &&
	       l->spread_m >= LONG_ENOUGH * radius_m && halves_apart(a, l, on_m2) <= HALVES_APART &&
	       on >= STANDS_OUT * weight_of_others(a, ahead, ON_LINE * explained_m);
}

/* The mean of the cuts of planes about a line through the point that agree with one, and how far off it they are, in rad;
 * the number of them. */
static uint32_t mean_cut(const struct feature_around *a, const float with[3], float on_m2,
	float ret[3], float *ret_off_rad)
{
	float sum[3] = { 0 }, all = 0;
	uint32_t count = 0;
	for (uint32_t i = 0; i < a->count; i++) {
		const float *c = a->cut[i];
		float cosine = c[0] * with[0] + c[1] * with[1] + c[2] * with[2];
		float along = a->x[i] * with[0] + a->y[i] * with[1] + a->z[i] * with[2];
		float off2 =
			a->x[i] * a->x[i] + a->y[i] * a->y[i] + a->z[i] * a->z[i] - along * along;
		if (fabsf(cosine) < SAME_CUT || off2 > on_m2)
			continue;
		float w = cosine > 0 ? a->weight[i] : -a->weight[i];
		for (int k = 0; k < 3; k++)
			sum[k] += w * c[k];
		all += a->weight[i];
		count++;
	}
	float length = sqrtf(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
	if (!(length > 0))
		return 0;
	for (int k = 0; k < 3; k++)
		ret[k] = sum[k] / length;
	*ret_off_rad = sqrtf(fmaxf(2 * (1 - length / all), 0));
	return count;
}

/* At a crease: the line that the planes' cuts along it agree on, if the points do. */
static bool fit_cut(const struct feature_around *a, const float cut[3], const float ahead[3],
	float explained_m, float radius_m, struct feature_line *ret, float *ret_off)
{
	const float on_m2 = ON_LINE * ON_LINE * explained_m * explained_m;
	float off_rad = 0, on;
	uint32_t count = mean_cut(a, cut, on_m2, ret->direction, &off_rad);
	for (int round = 0; round < 2 && count; round++) {
		float with[3] = { ret->direction[0], ret->direction[1], ret->direction[2] };
		count = mean_cut(a, with, on_m2, ret->direction, &off_rad);
	}
	if (count < CUTS_LEAST || off_rad > CUT_CERTAIN_RAD)
		return false;
	memset(ret->middle, 0, sizeof ret->middle);
	*ret_off = off_rad;
	return measure_line(a, ret, on_m2, &on) > 0 && ret->spread_m >= LONG_ENOUGH * radius_m &&
	       on >= CUT_STANDS_OUT * weight_of_others(a, ahead, ON_LINE * explained_m);
}

/* The line of the points, begun with the cuts' own; they need to agree. Or the cuts' own, where these agree very well. */
static bool fit_with_cuts(const struct feature_around *a, struct feature_line *cuts, float off_rad,
	const float ahead[3], float explained_m, float radius_m, struct feature_line *ret)
{
	const float on_m2 = ON_LINE * ON_LINE * explained_m * explained_m;
	float on, cosine = 0;
	memcpy(ret->direction, cuts->direction, sizeof ret->direction);
	for (int round = 0; round < ROUNDS; round++)
		fit_round(ret, a, explained_m * TUBE);
	for (int k = 0; k < 3; k++)
		cosine += cuts->direction[k] * ret->direction[k];
	float count = measure_line(a, ret, on_m2, &on);
	if (count > 0 && fabsf(cosine) > CUT_AGREES && ret->error_m <= ERROR_MOST * explained_m &&
		ret->error_m <= CUT_FIT_CERTAIN_RAD * ret->spread_m * sqrtf(count) &&
		ret->spread_m >= LONG_ENOUGH * radius_m &&
		halves_apart(a, ret, on_m2) <= CUT_HALVES_APART &&
		on >= CUT_STANDS_OUT * weight_of_others(a, ahead, ON_LINE * explained_m))
		return true;
	if (off_rad < CUT_ALONE_RAD)
		*ret = *cuts;
	return off_rad < CUT_ALONE_RAD;
}

bool feature_fit_line(const struct feature_around *a, const float cut[3], const float ahead[3],
	float explained_m, float radius_m, struct feature_line *ret)
{
	struct feature_line cuts = { .error_m = NAN };
	float off_rad;
	*ret = cuts;
	if (a->count < POINTS_LEAST)
		return false;
	if (cut && fit_cut(a, cut, ahead, explained_m, radius_m, &cuts, &off_rad))
		return fit_with_cuts(a, &cuts, off_rad, ahead, explained_m, radius_m, ret);
	if (!find_start(ret, a, radius_m, ON_LINE * explained_m))
		return false;
	for (int round = 0; round < ROUNDS; round++)
		fit_round(ret, a, explained_m * TUBE);
	return is_line(a, ret, ahead, explained_m, radius_m);
}

void feature_keep_line(features *f, size_t i, const struct feature_line *l, bool is_line)
{
	f->kind[i] = is_line ? FEATURE_DIRECTED : FEATURE_UNDIRECTED;
	if (!isfinite(l->error_m))
		return;
	f->line_error[i] = (uint16_t)fminf(lrintf(l->error_m * 1e4f), FEATURE_LINE_ERROR_NONE - 1);
	model_pack_normal(l->direction, f->direction[i]);
}

static void fit_cell(const struct fitter *t, size_t i)
{
	const range_grid *g = t->of->grid;
	struct feature_around a;
	const float spacing_m = g->range_m[i] * (float)MAX(g->row_rad, g->column_rad);
	const float window_m = sqrtf(62 * t->o->range_noise_m * spacing_m);
	const float radius_m =
		fmaxf(t->o->line_radius_m, fmaxf(BEAMS_WIDE * spacing_m, WINDOWS_WIDE * window_m));
	const float explained_m =
		t->o->line_error * hypotf(t->o->range_noise_m, SPACING_SHARE * spacing_m);
	a.count = 0;
	const struct ridge_point *here =
		ridge_at(t->own, (uint32_t)(i / g->columns), (uint32_t)(i % g->columns));
	const double point[3] = { here->x, here->y, here->z };
	for (size_t k = 0; k < t->count; k++) {
		bool is_own = t->views[k].scan.grid == g;
		double at[3] = { point[0], point[1], point[2] };
		if (!is_own)
			pose_apply(&t->to_view[k], point, at);
		uint32_t cell =
			is_own ? (uint32_t)i
			       : range_grid_find(t->views[k].scan.grid, at[0], at[1], at[2]);
		struct window w = { .view = &t->views[k],
			.ridges = &t->ridges[k],

			.leaf = t->of->leaf ? t->of->leaf[i] : 0,
			.here = { here->x, here->y, here->z },
			.radius_m = radius_m,
			.is_cut = has_cut(here) };
		if (cell != RANGE_GRID_NONE)
			add_view(&w, spacing_m, cell, at, &a);
	}
	const float ahead[3] = { g->x_m[i] / g->range_m[i], g->y_m[i] / g->range_m[i],
		g->z_m[i] / g->range_m[i] };
	struct feature_line l;
	bool is = feature_fit_line(
		&a, has_cut(here) ? here->cut : NULL, ahead, explained_m, radius_m, &l);
	feature_keep_line(t->f, i, &l, is);
}

/* Lines are fitted at one in five of the highest cells, such that along any row, column or diagonal every fifth is one. */
static bool is_chosen(const struct ridges *ridges, uint32_t row, uint32_t column)
{
	return (row + 2 * column) % 5 == 0 && is_ridge(ridges, row, column);
}

/* Whether the line of cell k passes cell i, as the scanner sees it: what lies beside an edge may be far off it in depth. */
static bool passes(const struct fitter *t, size_t k, size_t i)
{
	const range_grid *g = t->of->grid;
	const float at[3] = { g->x_m[i], g->y_m[i], g->z_m[i] };
	const struct ridge_point *p =
		ridge_at(t->own, (uint32_t)(k / g->columns), (uint32_t)(k % g->columns));
	const float on[3] = { p->x, p->y, p->z };
	float u[3], off_m = 0, size2 = 0;
	if (t->f->kind[k] != FEATURE_DIRECTED)
		return false;
	model_unpack_normal(t->f->direction[k], u);
	for (int c = 0; c < 3; c++) {
		float across = on[(c + 1) % 3] * u[(c + 2) % 3] - on[(c + 2) % 3] * u[(c + 1) % 3];
		off_m += across * at[c];
		size2 += across * across;
	}
	return fabsf(off_m) <
	       PASSING_CELLS * g->range_m[i] * (float)MAX(g->row_rad, g->column_rad) * sqrtf(size2);
}

/* A chosen cell near by, on the same surface: the nearest whose line passes here, else the nearest; false: there is none. */
static bool find_chosen(const struct fitter *t, const struct ridges *ridges, uint32_t row,
	uint32_t column, size_t *ret, bool *ret_passes)
{
	static const int8_t way[24][2] = { { 0, 1 }, { 0, -1 }, { 1, 0 }, { -1, 0 }, { 1, 1 },
		{ 1, -1 }, { -1, 1 }, { -1, -1 }, { 0, 2 }, { 0, -2 }, { 2, 0 }, { -2, 0 },
		{ 1, 2 }, { 1, -2 }, { -1, 2 }, { -1, -2 }, { 2, 1 }, { 2, -1 }, { -2, 1 },
		{ -2, -1 }, { 2, 2 }, { 2, -2 }, { -2, 2 }, { -2, -2 } };
	const range_grid *g = t->of->grid;
	const size_t i = (size_t)row * g->columns + column;
	const float near_m = NEAR_CELLS * g->range_m[i] * (float)MAX(g->row_rad, g->column_rad) +
			     3 * t->o->range_noise_m;
	bool found = *ret_passes = false;
	for (int w = 0; w < 24; w++) {
		size_t k;
		if (!range_grid_step(g, row, column, way[w][0], way[w][1], &k) ||
			!is_chosen(
				ridges, (uint32_t)(k / g->columns), (uint32_t)(k % g->columns)) ||
			fabsf(g->range_m[k] - g->range_m[i]) > near_m)
			continue;
		bool is_line = passes(t, k, i);
		if (is_line || !found)
			*ret = k;
		found = true;
		*ret_passes = is_line;
		if (is_line)
			break;
	}
	return found;
}

/* What is not chosen has the line of the nearest that is; where there is none, its own. */
static void take_over(
	const struct fitter *t, const struct ridges *ridges, uint32_t row, uint32_t column)
{
	features *f = t->f;
	size_t i = (size_t)row * t->of->grid->columns + column, k;
	bool is_line;
	if (!find_chosen(t, ridges, row, column, &k, &is_line)) {
		if (is_ridge(ridges, row, column))
			fit_cell(t, i);
		return;
	}
	f->kind[i] = is_line ? f->kind[k] : FEATURE_UNDIRECTED;
	memcpy(f->direction[i], f->direction[k], sizeof f->direction[i]);
	f->line_error[i] = f->line_error[k];
}

void features_fit_lines(features *f, const struct features_input *of,
	const struct features_view *views, size_t count, const struct features_options *options)
{
	struct features_options o = features_defaults(options);
	const range_grid *g = of->grid;
	if (!(o.range_noise_m > 0))
		o.range_noise_m = normals_range_noise_m(g);
	g_autofree struct pose *to_view = g_new0(struct pose, count + 1);
	g_autofree struct ridges *ridges = g_new0(struct ridges, count + 1);
	const struct ridges *own = NULL;
	struct fitter t = { f, of, views, count, &o, NULL, to_view, ridges, feature_least(&o) };
	for (size_t k = 0; k < count; k++) {
		to_view[k] = pose_between(&views[k].scan.pose, &of->pose);
		struct pose to_scan = pose_inverse(&to_view[k]);
		ridges[k] = find_ridges(&views[k], views[k].scan.grid == g ? NULL : &to_scan,
			t.least, o.single_thread);
		own = views[k].scan.grid == g ? &ridges[k] : own;
	}
	g_assert(own);
	t.own = own;
#pragma omp parallel for schedule(dynamic, 4) if (!o.single_thread)
	for (uint32_t row = 0; row < g->rows; row++)
		for (uint32_t column = 0; column < g->columns; column++)
			if (is_chosen(own, row, column))
				fit_cell(&t, (size_t)row * g->columns + column);
#pragma omp parallel for schedule(dynamic, 4) if (!o.single_thread)
	for (uint32_t row = 0; row < g->rows; row++)
		for (uint32_t column = 0; column < g->columns; column++) {
			size_t i = (size_t)row * g->columns + column;
			if (f->degree[i] > t.least && g->range_m[i] > 0 &&
				!is_chosen(own, row, column))
				take_over(&t, own, row, column);
		}
	for (size_t k = 0; k < count; k++)
		ridges_clear(&ridges[k]);
}
