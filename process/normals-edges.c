#include "process/normals-lanes.h"
#include "process/normals.h"
#include <string.h>

/* A fit leaves about the noise along the rays. What leaves this much more reaches over a crease. */
#define CREASED_NOISES 1.35f
/* How far off the plane of a neighbour's window the point itself may be, in sigma. */
#define ON_PLANE     2.5f
#define WINDOW_SHARE 60
#define REACH_MOST   14
#define EDGE_COLUMNS 16 /* nearer to the ends of a row, neighbours may be at the other */
/* Neighbours in space: cells each way, and how far away, in metric windows and in beams. */
#define NEAR_CELLS   3
#define NEAR_WINDOWS 2.0f
#define NEAR_BEAMS   5.0f
#define NEAR_MIN     3
#define PRIOR_SLOPE  1.5

/* The cell that many rows and columns away; false: beyond the grid. */
static bool step(
	const range_grid *g, uint32_t row, uint32_t column, int down, int right, size_t *ret)
{
	int64_t r = (int64_t)row + down, c = (int64_t)column + right;
	if (g->wraps)
		c = c < 0 ? c + g->columns : c >= g->columns ? c - g->columns : c;
	if (r < 0 || r >= g->rows || c < 0 || c >= g->columns)
		return false;
	*ret = (size_t)r * g->columns + (size_t)c;
	return true;
}

enum fitted { NOT_FITTED, WHOLE, CREASED };

/* CREASED: what the fit left along the ray is more than noise. */
static void judge_row(const range_grid *g, const struct normals_planes *p, uint32_t row,
	float noise_m, uint8_t *ret)
{
	size_t from = (size_t)row * g->columns;
	const float *error_m = p->error_m + from, *offset_m = p->offset_m + from,
		    *range_m = g->range_m + from;
	for (uint32_t c = 0; c < g->columns; c++) {
		bool creased = error_m[c] * range_m[c] > CREASED_NOISES * noise_m * offset_m[c];
		ret[c] = (uint8_t)((offset_m[c] > 0) + ((offset_m[c] > 0) & creased));
	}
}

/* How far the point is from the plane of cell k's window, along the ray. */
static float off_plane_m(const range_grid *g, const struct normals_planes *p, size_t i, size_t k)
{
	float away = p->normal[0][k] * g->x_m[i] + p->normal[1][k] * g->y_m[i] +
		     p->normal[2][k] * g->z_m[i];
	return away < 0 ? fabsf(g->range_m[i] * (1 + p->offset_m[k] / away)) : INFINITY;
}

/* About the windows of the fit; a quarter of their half width. */
static inline float window_cells(
	const range_grid *g, const struct normals_options *o, float range_m)
{
	float beam_m = range_m * (float)g->row_rad;
	float reach_m = fmaxf(o->radius_m, sqrtf(WINDOW_SHARE * o->range_noise_m * beam_m));
	return fminf(reach_m / beam_m, REACH_MOST) / 4;
}

/* Half the windows' width away in all directions, then a quarter. */
static const int8_t way[8][2] = { { 0, -4 }, { 0, 4 }, { -4, 0 }, { 4, 0 }, { -3, -3 }, { -3, 3 },
	{ 3, -3 }, { 3, 3 } };

static size_t find_plane(const range_grid *g, const struct normals_options *o,
	const struct normals_planes *p, const uint8_t *fitted, uint32_t row, uint32_t column)
{
	size_t i = (size_t)row * g->columns + column, best = i, k;
	float least = ON_PLANE * o->range_noise_m, cells = window_cells(g, o, g->range_m[i]);
	for (int shift = 0; shift < 2 && best == i; shift++, cells /= 2)
		for (int w = 0; w < 8; w++) {
			if (!step(g, row, column, (int)(way[w][0] * cells),
				    (int)(way[w][1] * cells), &k) ||
				fitted[k] != WHOLE)
				continue;
			float off = off_plane_m(g, p, i, k);
			if (off < least) {
				least = off;
				best = k;
			}
		}
	return best;
}

static void sharpen_cell(const range_grid *g, const struct normals_options *o,
	const struct normals_planes *p, const uint8_t *fitted, uint32_t row, uint32_t column)
{
	size_t i = (size_t)row * g->columns + column;
	size_t k = fitted[i] == CREASED ? find_plane(g, o, p, fitted, row, column) : i;
	for (int axis = 0; axis < 3 && k != i; axis++)
		p->normal[axis][i] = p->normal[axis][k];
}

/* The same for eight cells side by side, with the window of the first that needs it. Only planes of WHOLE cells are taken and
 * only others are replaced, so nothing is read that was written. */
INLINE void sharpen_lanes(const range_grid *g, const struct normals_options *o,
	const struct normals_planes *p, const uint8_t *fitted, uint32_t row, uint32_t column)
{
	size_t i = (size_t)row * g->columns + column;
	uint64_t eight;
	memcpy(&eight, fitted + i, sizeof eight);
	eight &= 0x0202020202020202; /* CREASED */
	if (!eight)
		return;
	int first = 0;
	while (fitted[i + first] != CREASED)
		first++;
	float cells = window_cells(g, o, g->range_m[i + first]);
	vf x = load(g->x_m + i), y = load(g->y_m + i), z = load(g->z_m + i),
	   range = load(g->range_m + i);
	vi open = load_bytes(fitted + i) == (float)CREASED;
	vf normal[3] = { load(p->normal[0] + i), load(p->normal[1] + i), load(p->normal[2] + i) };
	for (int shift = 0; shift < 2 && largest(where(open, all(1))) > 0; shift++, cells /= 2) {
		vf least_off = all(ON_PLANE * o->range_noise_m);
		vi found = { 0 };
		for (int w = 0; w < 8; w++) {
			int down = (int)(way[w][0] * cells), right = (int)(way[w][1] * cells);
			if ((int64_t)row + down < 0 || (int64_t)row + down >= g->rows)
				continue;
			size_t k = i + (ptrdiff_t)down * g->columns + right;
			memcpy(&eight, fitted + k, sizeof eight);
			if (!(eight & 0x0101010101010101)) /* none is WHOLE */
				continue;
			vi whole = load_bytes(fitted + k) == (float)WHOLE;
			vf nx = load(p->normal[0] + k), ny = load(p->normal[1] + k),
			   nz = load(p->normal[2] + k);
			vf away = nx * x + ny * y + nz * z;
			whole &= open & (away < 0);
			vf off = magnitude(
				range * (1 + load(p->offset_m + k) / choose(whole, away, all(-1))));
			vi better = whole & (off < least_off);
			found |= better;
			least_off = choose(better, off, least_off);
			normal[0] = choose(better, nx, normal[0]);
			normal[1] = choose(better, ny, normal[1]);
			normal[2] = choose(better, nz, normal[2]);
		}
		open &= ~found;
	}
	for (int axis = 0; axis < 3; axis++)
		store(p->normal[axis] + i, normal[axis]);
}

INLINE void sharpen_row(const range_grid *g, const struct normals_options *o,
	const struct normals_planes *p, const uint8_t *fitted, uint32_t row)
{
	uint32_t column = 0;
	for (; column < MIN(g->columns, EDGE_COLUMNS); column++)
		sharpen_cell(g, o, p, fitted, row, column);
	for (; column + LANES + EDGE_COLUMNS <= g->columns; column += LANES)
		sharpen_lanes(g, o, p, fitted, row, column);
	for (; column < g->columns; column++)
		sharpen_cell(g, o, p, fitted, row, column);
}

static void sharpen_row_portable(const range_grid *g, const struct normals_options *o,
	const struct normals_planes *p, const uint8_t *fitted, uint32_t row)
{
	sharpen_row(g, o, p, fitted, row);
}

#if defined __x86_64__
__attribute__((target("avx2,fma"))) static void sharpen_row_avx2(const range_grid *g,
	const struct normals_options *o, const struct normals_planes *p, const uint8_t *fitted,
	uint32_t row)
{
	sharpen_row(g, o, p, fitted, row);
}
#endif

void normals_sharpen(
	const range_grid *g, const struct normals_options *o, const struct normals_planes *p)
{
	void (*sharpen)(const range_grid *, const struct normals_options *,
		const struct normals_planes *, const uint8_t *, uint32_t) = sharpen_row_portable;
#if defined __x86_64__
	if (!o->portable && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
		sharpen = sharpen_row_avx2;
#endif
	g_autofree uint8_t *fitted = g_malloc(range_grid_cells(g));
#pragma omp parallel for schedule(static) if (!o->single_thread)
	for (uint32_t row = 0; row < g->rows; row++)
		judge_row(g, p, row, o->range_noise_m, fitted + (size_t)row * g->columns);
#pragma omp parallel for schedule(dynamic, 8) if (!o->single_thread)
	for (uint32_t row = 0; row < g->rows; row++)
		sharpen(g, o, p, fitted, row);
}

/* ---- what has no neighbours beside it ---- */

/* Sums of inverse depth over directions, in a frame that looks at the cell. */
struct fan {
	double axis[3][3], n, u, v, w, uu, uv, vv, uw, vw, ww;
};

static void look_at(struct fan *f, const range_grid *g, size_t i)
{
	double r = g->range_m[i], ahead[3] = { g->x_m[i] / r, g->y_m[i] / r, g->z_m[i] / r };
	int k = fabs(ahead[0]) < 0.6 ? 0 : 1; /* an axis that is not nearly ahead */
	double rest = sqrt(1 - ahead[k] * ahead[k]);
	*f = (struct fan){ 0 };
	for (int j = 0; j < 3; j++) {
		f->axis[0][j] = ((j == k) - ahead[k] * ahead[j]) / rest;
		f->axis[2][j] = ahead[j];
	}
	for (int j = 0; j < 3; j++) {
		int a = (j + 1) % 3, b = (j + 2) % 3;
		f->axis[1][j] = f->axis[2][a] * f->axis[0][b] - f->axis[2][b] * f->axis[0][a];
	}
}

static void add_point(struct fan *f, const double d[3], double here)
{
	double local[3];
	for (int k = 0; k < 3; k++)
		local[k] = f->axis[k][0] * d[0] + f->axis[k][1] * d[1] + f->axis[k][2] * d[2];
	double w = 1 / local[2], u = local[0] * w, v = local[1] * w;
	w -= here;
	f->n += 1;
	f->u += u;
	f->v += v;
	f->w += w;
	f->uu += u * u;
	f->uv += u * v;
	f->vv += v * v;
	f->uw += u * w;
	f->vw += v * w;
	f->ww += w * w;
}

static void add_near(struct fan *f, const range_grid *g, const struct normals_options *o, size_t i)
{
	float range = g->range_m[i];
	float reach_m =
		fmaxf(NEAR_WINDOWS * o->radius_m, NEAR_BEAMS * range_grid_point_size_m(g, i));
	uint32_t row = (uint32_t)(i / g->columns), column = (uint32_t)(i % g->columns);
	for (int down = -NEAR_CELLS; down <= NEAR_CELLS; down++)
		for (int right = -NEAR_CELLS; right <= NEAR_CELLS; right++) {
			size_t k;
			if (!step(g, row, column, down, right, &k) ||
				fabsf(g->range_m[k] - range) > reach_m || !(g->range_m[k] > 0))
				continue;
			float x = g->x_m[k] - g->x_m[i], y = g->y_m[k] - g->y_m[i],
			      z = g->z_m[k] - g->z_m[i];
			double d[3] = { g->x_m[k], g->y_m[k], g->z_m[k] };
			if (x * x + y * y + z * z <= reach_m * reach_m)
				add_point(f, d, 1.0 / range);
		}
}

static void fill_cell(const range_grid *g, const struct normals_options *o,
	const struct normals_planes *p, size_t i)
{
	struct fan f;
	look_at(&f, g, i);
	add_near(&f, g, o, i);
	if (f.n < NEAR_MIN)
		return;
	double here = 1 / g->range_m[i], u = f.u / f.n, v = f.v / f.n, w = f.w / f.n;
	double uu = f.uu / f.n - u * u, uv = f.uv / f.n - u * v, vv = f.vv / f.n - v * v;
	double uw = f.uw / f.n - u * w, vw = f.vw / f.n - v * w, ww = f.ww / f.n - w * w;
	double hold = o->range_noise_m * here / PRIOR_SLOPE, held = hold * hold / f.n + 1e-14;
	double scale = 1 / ((uu + held) * (vv + held) - uv * uv);
	double a = (uw * (vv + held) - vw * uv) * scale, b = (vw * (uu + held) - uw * uv) * scale;
	double c = here + w - a * u - b * v, length = sqrt(a * a + b * b + c * c);
	double left =
		fmax(ww - 2 * (a * uw + b * vw) + a * a * uu + 2 * a * b * uv + b * b * vv, 0);
	double error = sqrt(left) / (here * length), spread = (uu + vv) / (here * here);
	if (!(c > 0))
		return;
	for (int k = 0; k < 3; k++)
		p->normal[k][i] =
			(float)(-(f.axis[0][k] * a + f.axis[1][k] * b + f.axis[2][k] * c) / length);
	p->error_m[i] = (float)error;
	double least = fmin(error * error, spread / 2);
	p->curvature[i] = (float)(least / fmax(spread + least, 1e-20));
	p->offset_m[i] = (float)(1 / length);
}

void normals_fill(
	const range_grid *g, const struct normals_options *o, const struct normals_planes *p)
{
	size_t n = range_grid_cells(g);
#pragma omp parallel for schedule(dynamic, 4096) if (!o->single_thread)
	for (size_t i = 0; i < n; i++)
		if (g->range_m[i] > 0 && !(p->offset_m[i] > 0))
			fill_cell(g, o, p, i);
}
