#include "process/lanes.h"
#include "process/normals-tile.h"
#include <string.h>

/* Neighbours in space: cells each way, and how far away, in metric windows and in beams. */
#define NEAR_CELLS   3
#define NEAR_WINDOWS 2.0f
#define NEAR_BEAMS   12.0f
#define NEAR_MIN     3

_Static_assert(2 * NEAR_CELLS + 1 <= LANES, "a row of neighbours at once");

/* Sums over what is near, from the cell's point on. */
struct near {
	vf n, x, y, z, xx, xy, xz, yy, yz, zz;
};
#define SUMS (sizeof(struct near) / sizeof(vf))

/* Cells whose planes are worked out together, one a lane. */
struct batch {
	uint32_t count;
	size_t cell[LANES];
	vf near[LANES][SUMS]; /* eight neighbours a lane */
};

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

INLINE void add_near(struct near *f, const range_grid *g, uint32_t row, uint32_t column,
	const float at[3], float reach2_m2)
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
	vf x = p[0] - at[0], y = p[1] - at[1], z = p[2] - at[2];
	vi in = (p[3] > 0) & (lane <= 2 * NEAR_CELLS) & (x * x + y * y + z * z <= reach2_m2);
	x = where(in, x);
	y = where(in, y);
	z = where(in, z);
	f->n += where(in, all(1));
	f->x += x;
	f->y += y;
	f->z += z;
	f->xx += x * x;
	f->xy += x * y;
	f->xz += x * z;
	f->yy += y * y;
	f->yz += y * z;
	f->zz += z * z;
}

INLINE vf pairs(vf a, vf b)
{
	return evens(a, b) + odds(a, b);
}

/* What the lanes of each cell's k-th sum are together. */
INLINE vf total(const struct batch *b, size_t k)
{
	vf x[LANES];
	for (int c = 0; c < LANES; c++)
		x[c] = b->near[c][k];
	for (int n = LANES / 2; n; n /= 2)
		for (int c = 0; c < n; c++)
			x[c] = pairs(x[2 * c], x[2 * c + 1]);
	return x[0];
}

INLINE vf dot(const vf a[3], const vf b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Right, up and ahead, as one looks there. */
INLINE void look_at(const vf at[3], vf nearness, vf axis[3][3])
{
	vf *right = axis[0], *up = axis[1], *ahead = axis[2];
	for (int k = 0; k < 3; k++)
		ahead[k] = at[k] * nearness;
	vi along = magnitude(ahead[0]) <
		   0.6f; /* the first axis is not nearly ahead; else the second */
	vf share = choose(along, ahead[0], ahead[1]), part = 1 / root(1 - share * share);
	right[0] = (where(along, all(1)) - share * ahead[0]) * part;
	right[1] = (where(~along, all(1)) - share * ahead[1]) * part;
	right[2] = -share * ahead[2] * part;
	for (int k = 0; k < 3; k++) {
		int a = (k + 1) % 3, b = (k + 2) % 3;
		up[k] = ahead[a] * right[b] - ahead[b] * right[a];
	}
}

/* Depth over what is right and up, in a frame that looks at the cell: all is so near that directions are as good as parallel. */
INLINE void put_planes(struct batch *b, const range_grid *g, const struct normals_options *o,
	const struct normals_planes *p)
{
	float place[4][LANES];
	for (uint32_t k = 0; k < LANES; k++) {
		size_t i = b->cell[k < b->count ? k : 0];
		place[0][k] = g->x_m[i];
		place[1][k] = g->y_m[i];
		place[2][k] = g->z_m[i];
		place[3][k] = g->range_m[i];
	}
	vf at[3] = { load(place[0]), load(place[1]), load(place[2]) }, range = load(place[3]),
	   axis[3][3], mean[3], s[3][3], c[3][3], normal[3];
	vf n = total(b, 0), part = 1 / most(n, all(1));
	for (int k = 0; k < 3; k++)
		mean[k] = total(b, 1 + k) * part;
	for (int i = 0, k = 4; i < 3; i++)
		for (int j = i; j < 3; j++)
			s[i][j] = s[j][i] = total(b, k++) * part - mean[i] * mean[j];
	look_at(at, 1 / range, axis);
	for (int i = 0; i < 3; i++) {
		vf row[3] = { dot(s[0], axis[i]), dot(s[1], axis[i]), dot(s[2], axis[i]) };
		for (int j = 0; j <= i; j++)
			c[i][j] = dot(row, axis[j]);
	}
	float hold_m = o->range_noise_m / NORMALS_PRIOR_SLOPE;
	vf held = hold_m * hold_m * part + 1e-14f * range * range;
	vf across = c[0][0] + held, upwards = c[1][1] + held,
	   scale = 1 / (across * upwards - c[1][0] * c[1][0]);
	vf slope_x = (c[2][0] * upwards - c[2][1] * c[1][0]) * scale,
	   slope_y = (c[2][1] * across - c[2][0] * c[1][0]) * scale;
	vf inverse = 1 / root(1 + slope_x * slope_x + slope_y * slope_y), offset_m = { 0 };
	for (int k = 0; k < 3; k++) {
		normal[k] = (axis[0][k] * slope_x + axis[1][k] * slope_y - axis[2][k]) * inverse;
		offset_m -= normal[k] * (at[k] + mean[k]);
	}
	vf left_m2 = c[2][2] - 2 * (slope_x * c[2][0] + slope_y * c[2][1]) +
		     slope_x * slope_x * c[0][0] + 2 * slope_x * slope_y * c[1][0] +
		     slope_y * slope_y * c[1][1];
	vf error_m = root(most(left_m2, all(0))) * inverse, spread = c[0][0] + c[1][1],
	   least_m2 = least(error_m * error_m, spread * 0.5f),
	   curvature = least_m2 / most(spread + least_m2, all(1e-20f));
	vi good = (n >= NEAR_MIN) & (offset_m > 0);
	for (uint32_t k = 0; k < b->count; k++) {
		size_t i = b->cell[k];
		if (!good[k])
			continue;
		for (int j = 0; j < 3; j++)
			p->normal[j][i] = normal[j][k];
		p->error_m[i] = error_m[k];
		p->curvature[i] = curvature[k];
	}
	b->count = 0;
}

INLINE void fill_cell(struct batch *b, const range_grid *g, const struct normals_options *o,
	uint32_t row, uint32_t column)
{
	size_t i = (size_t)row * g->columns + column;
	uint32_t top = row > NEAR_CELLS ? row - NEAR_CELLS : 0,
		 bottom = MIN(row + NEAR_CELLS, g->rows - 1);
	float reach_m =
		fmaxf(NEAR_WINDOWS * o->radius_m, NEAR_BEAMS * range_grid_point_size_m(g, i));
	const float at[3] = { g->x_m[i], g->y_m[i], g->z_m[i] };
	struct near near = { 0 };
	for (uint32_t r = top; r <= bottom; r++)
		add_near(&near, g, r, column, at, reach_m * reach_m);
	memcpy(b->near[b->count], &near, sizeof near);
	b->cell[b->count++] = i;
}

INLINE void fill_cells(const range_grid *g, const struct normals_options *o,
	const struct normals_planes *p, struct area area)
{
	struct batch batch;
	batch.count = 0;
	memset(batch.near, 0, sizeof batch.near);
	for (uint32_t row = area.row; row < area.rows_end; row++)
		for (uint32_t c = area.column; c < area.columns_end; c += LANES) {
			size_t i = (size_t)row * g->columns + c;
			vi there = load(g->range_m + i) > 0,
			   none = load(p->offset_m + (i - p->offset_from)) == 0;
			unsigned left_out = bits(there & none);
			if (c + LANES > area.columns_end)
				left_out &= (1u << (area.columns_end - c)) - 1;
			for (; left_out; left_out &= left_out - 1) {
				fill_cell(&batch, g, o, row, c + (uint32_t)__builtin_ctz(left_out));
				if (batch.count == LANES)
					put_planes(&batch, g, o, p);
			}
		}
	if (batch.count)
		put_planes(&batch, g, o, p);
}

static void fill_portable(const range_grid *g, const struct normals_options *o,
	const struct normals_planes *p, struct area area)
{
	fill_cells(g, o, p, area);
}

#if defined __x86_64__
__attribute__((target("avx2,fma"))) static void fill_avx2(const range_grid *g,
	const struct normals_options *o, const struct normals_planes *p, struct area area)
{
	fill_cells(g, o, p, area);
}
#endif

void fill_area(const range_grid *g, const struct normals_options *o, const struct normals_planes *p,
	struct area area)
{
#if defined __x86_64__
	if (!o->portable && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
		fill_avx2(g, o, p, area);
		return;
	}
#endif
	fill_portable(g, o, p, area);
}
