#include "process/normals-lanes.h"
#include "process/normals-tile.h"
#include <string.h>

/* Neighbours in space: cells each way, and how far away, in metric windows and in beams. */
#define NEAR_CELLS   3
#define NEAR_WINDOWS 2.0f
#define NEAR_BEAMS   12.0f
#define NEAR_MIN     3

_Static_assert(2 * NEAR_CELLS + 1 <= LANES, "a row of neighbours at once");

/* Inverse depth over directions, in a frame that looks at the cell; as the fits of tiles have it. */
struct fan {
	float axis[3][3], at[3], here, reach_m;
	vf n, u, v, w, uu, uv, vv, uw, vw, ww; /* sums, lane by lane */
};

INLINE void look_at(struct fan *f, const range_grid *g, const struct normals_options *o, size_t i)
{
	float r = g->range_m[i], ahead[3] = { g->x_m[i] / r, g->y_m[i] / r, g->z_m[i] / r };
	int k = fabsf(ahead[0]) < 0.6f ? 0 : 1; /* an axis that is not nearly ahead */
	float rest = sqrtf(1 - ahead[k] * ahead[k]);
	*f = (struct fan){ .at = { g->x_m[i], g->y_m[i], g->z_m[i] }, .here = 1 / r };
	f->reach_m = fmaxf(NEAR_WINDOWS * o->radius_m, NEAR_BEAMS * range_grid_point_size_m(g, i));
	for (int j = 0; j < 3; j++) {
		f->axis[0][j] = ((float)(j == k) - ahead[k] * ahead[j]) / rest;
		f->axis[2][j] = ahead[j];
	}
	for (int j = 0; j < 3; j++) {
		int a = (j + 1) % 3, b = (j + 2) % 3;
		f->axis[1][j] = f->axis[2][a] * f->axis[0][b] - f->axis[2][b] * f->axis[0][a];
	}
}

/* Eight cells of a row from `column`, which may be beyond the grid's ends: there, and in lanes that are too many, range 0. */
static void take(const range_grid *g, uint32_t row, int64_t column, vf ret[4])
{
	const float *plane[4] = { g->x_m, g->y_m, g->z_m, g->range_m };
	size_t from = (size_t)row * g->columns;
	for (int p = 0; p < 4; p++)
		for (int k = 0; k < LANES; k++) {
			int64_t c = column + k;
			if (g->wraps)
				c = c < 0 ? c + g->columns : c >= g->columns ? c - g->columns : c;
			ret[p][k] = c >= 0 && c < g->columns ? plane[p][from + (size_t)c] : 0;
		}
}

INLINE void add_near(struct fan *f, const range_grid *g, uint32_t row, uint32_t column)
{
	const vi lane = { 0, 1, 2, 3, 4, 5, 6, 7 };
	int64_t from = (int64_t)column - NEAR_CELLS;
	vf p[4];
	if (from >= 0 && from + LANES <= g->columns) {
		size_t i = (size_t)row * g->columns + (size_t)from;
		p[0] = load(g->x_m + i);
		p[1] = load(g->y_m + i);
		p[2] = load(g->z_m + i);
		p[3] = load(g->range_m + i);
	} else {
		take(g, row, from, p);
	}
	vf x = p[0] - f->at[0], y = p[1] - f->at[1], z = p[2] - f->at[2];
	vf ahead = f->axis[2][0] * p[0] + f->axis[2][1] * p[1] + f->axis[2][2] * p[2];
	vi in = (p[3] > 0) & (ahead > 0) & (lane <= 2 * NEAR_CELLS) &
		(x * x + y * y + z * z <= f->reach_m * f->reach_m);
	vf w = 1 / choose(in, ahead, all(1));
	vf u = where(in, (f->axis[0][0] * x + f->axis[0][1] * y + f->axis[0][2] * z) * w);
	vf v = where(in, (f->axis[1][0] * x + f->axis[1][1] * y + f->axis[1][2] * z) * w);
	w = where(in, w - f->here);
	f->n += where(in, all(1));
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

INLINE double total(vf x)
{
	x += __builtin_shufflevector(x, x, 4, 5, 6, 7, 0, 1, 2, 3);
	x += __builtin_shufflevector(x, x, 2, 3, 0, 1, 6, 7, 4, 5);
	return x[0] + x[1];
}

INLINE void put_plane(const struct fan *f, const struct normals_options *o,
	const struct normals_planes *p, size_t i)
{
	double n = total(f->n), here = f->here;
	if (n < NEAR_MIN)
		return;
	double u = total(f->u) / n, v = total(f->v) / n, w = total(f->w) / n;
	double uu = total(f->uu) / n - u * u, uv = total(f->uv) / n - u * v,
	       vv = total(f->vv) / n - v * v;
	double uw = total(f->uw) / n - u * w, vw = total(f->vw) / n - v * w,
	       ww = total(f->ww) / n - w * w;
	double hold = o->range_noise_m * here / NORMALS_PRIOR_SLOPE, held = hold * hold / n + 1e-14;
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
			(float)(-(f->axis[0][k] * a + f->axis[1][k] * b + f->axis[2][k] * c) /
				length);
	p->error_m[i] = (float)error;
	double least = fmin(error * error, spread / 2);
	p->curvature[i] = (float)(least / fmax(spread + least, 1e-20));
	p->offset_m[i] = (float)(1 / length);
}

INLINE vi is_left_out(const range_grid *g, const struct normals_planes *p, size_t i)
{
	return (load(g->range_m + i) > 0) & (load(p->offset_m + i) == 0);
}

INLINE void fill_row(const range_grid *g, const struct normals_options *o,
	const struct normals_planes *p, uint32_t row)
{
	size_t from = (size_t)row * g->columns;
	uint32_t top = row > NEAR_CELLS ? row - NEAR_CELLS : 0,
		 bottom = MIN(row + NEAR_CELLS, g->rows - 1);
	for (uint32_t c = 0; c < g->columns; c++) {
		struct fan f;
		while (c + LANES <= g->columns && !any(is_left_out(g, p, from + c)))
			c += LANES;
		if (c == g->columns || !(g->range_m[from + c] > 0) || p->offset_m[from + c] != 0)
			continue;
		look_at(&f, g, o, from + c);
		for (uint32_t r = top; r <= bottom; r++)
			add_near(&f, g, r, c);
		put_plane(&f, o, p, from + c);
	}
}

static void fill_row_portable(const range_grid *g, const struct normals_options *o,
	const struct normals_planes *p, uint32_t row)
{
	fill_row(g, o, p, row);
}

#if defined __x86_64__
__attribute__((target("avx2,fma"))) static void fill_row_avx2(const range_grid *g,
	const struct normals_options *o, const struct normals_planes *p, uint32_t row)
{
	fill_row(g, o, p, row);
}
#endif

void fill_rows(const range_grid *g, const struct normals_options *o, const struct normals_planes *p,
	uint32_t first, uint32_t end)
{
	void (*fill)(const range_grid *, const struct normals_options *,
		const struct normals_planes *, uint32_t) = fill_row_portable;
#if defined __x86_64__
	if (!o->portable && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
		fill = fill_row_avx2;
#endif
#pragma omp parallel for schedule(dynamic, 8) if (!o->single_thread)
	for (uint32_t row = first; row < end; row++)
		fill(g, o, p, row);
}
