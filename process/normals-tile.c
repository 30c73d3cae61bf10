#include "process/normals-tile.h"
#include "process/normals-lanes.h"
#include <string.h>

#define GROUPS (TILE_COLUMNS / LANES)
#define WIDTH  (TILE_COLUMNS + 2 * TILE_REACH)
#define HEIGHT (TILE_ROWS + 2 * TILE_REACH)
#define FRAME_STEP                                                                                 \
	8 /* of that many cells one is enough for the frame; each column and row has its turn */
#define MARGIN 8 /* columns, rows of nothing around it all */
#define PITCH  (WIDTH + 2 * MARGIN)
#define RING   (2 * TILE_REACH + 1) /* rows that a window may touch */

/* Windows are wide enough for this error of a normal, 1 sigma about each axis. */
#define AIM_RAD 0.014f
/* A surface is tilted by about this much against the ray, if nothing is known: the slope that holds what the neighbours leave
 * open (a wire has no width). */
#define PRIOR_SLOPE 1.5f
/* At least so many cells each way: fewer do not tell a slope from noise. */
#define ARM_MIN   3
#define COUNT_MIN 4
/* So many cells of an arm are summed up before it is asked whether any lane goes on. */
#define NO_LINKS_EACH 4

enum { N, U, V, W, UU, UV, VV, UW, VW, WW, SUMS };

struct tile {
	/* Direction and inverse depth in the frame of the tile: point = (u, v, 1) / w; w 0: none. v is relative to v_mean of its
	 * row. With rows and columns of nothing around. */
	float u[HEIGHT + 2 * MARGIN][PITCH], v[HEIGHT + 2 * MARGIN][PITCH],
		w[HEIGHT + 2 * MARGIN][PITCH], range[HEIGHT + 2 * MARGIN][PITCH];
	/* -1: to the next cell in the row, or column, is a link. */
	int32_t right[HEIGHT][PITCH], down[HEIGHT][PITCH];
	uint32_t segment[HEIGHT + 2 * MARGIN][PITCH];
	vf sum[RING][SUMS]; /* of one group of columns: row y is at y % RING */
	float v_mean[HEIGHT + 2 * MARGIN], u_mean[GROUPS], level[HEIGHT + 2 * MARGIN];
	float axis[3][3];  /* of the frame: right, up, ahead */
	int height, width; /* with the reach */
	bool has_segments;
};

tile *tile_new(void)
{
	return g_aligned_alloc0(1, sizeof(tile), 64);
}

void tile_free(tile *t)
{
	g_aligned_free(t);
}

/* ---- the frame and the points in it ---- */

/* Looks where the tile's points are on average. false: it has none. */
static bool set_frame(tile *t, const struct tile_job *job)
{
	const range_grid *g = job->grid;
	double ahead[3] = { 0 };
	for (uint32_t r = 0; r < job->rows; r++)
		for (uint32_t c = r % FRAME_STEP; c < job->columns; c += FRAME_STEP) {
			size_t i = (size_t)(job->row + r) * g->columns + job->column + c;
			if (!(g->range_m[i] > 0))
				continue;
			float nearness = 1 / g->range_m[i];
			ahead[0] += g->x_m[i] * nearness;
			ahead[1] += g->y_m[i] * nearness;
			ahead[2] += g->z_m[i] * nearness;
		}
	double length = sqrt(ahead[0] * ahead[0] + ahead[1] * ahead[1] + ahead[2] * ahead[2]);
	if (!(length > 0))
		return false;
	for (int k = 0; k < 3; k++)
		ahead[k] /= length;
	double level = hypot(ahead[0], ahead[1]);
	double right[3] = { 1, 0, 0 };
	if (level > 1e-3) {
		right[0] = ahead[1] / level;
		right[1] = -ahead[0] / level;
	} else {
		double along = ahead[0], rest = sqrt(1 - along * along);
		for (int k = 0; k < 3; k++)
			right[k] = ((k == 0) - along * ahead[k]) / rest;
	}
	for (int k = 0; k < 3; k++) {
		int a = (k + 1) % 3, b = (k + 2) % 3;
		t->axis[0][k] = (float)right[k];
		t->axis[1][k] = (float)(right[a] * ahead[b] - right[b] * ahead[a]);
		t->axis[2][k] = (float)ahead[k];
	}
	return true;
}

/* The cells of row y of the tile from the grid's plane, 0 where it has none. */
static void copy_row(const struct tile_job *job, int y, const float *plane, float *ret)
{
	const range_grid *g = job->grid;
	int64_t row = (int64_t)job->row + y - TILE_REACH;
	memset(ret, 0, PITCH * sizeof *ret);
	if (row < 0 || row >= g->rows)
		return;
	plane += row * g->columns;
	int64_t columns = g->columns, from = (int64_t)job->column - job->reach_columns,
		to = (int64_t)job->column + job->columns + job->reach_columns;
	if (to - from > columns) /* a narrow grid: no cell twice */
		to = from + columns;
	float *into = ret + MARGIN + TILE_REACH - job->reach_columns;
	for (int64_t c = from; c < to;) {
		int64_t at = c < 0 ? c + columns : c >= columns ? c - columns : c;
		int64_t run = MIN(to - c, c < 0 ? -c : c < columns ? columns - c : to - c);
		if (at == c || g->wraps)
			memcpy(into + (c - from), plane + at, run * sizeof *plane);
		c += run;
	}
}

/* That row of the plane: as it lies in the grid when all the tile needs is there, else in buffer. At MARGIN it begins. */
static const float *find_row(const struct tile_job *job, int y, const float *plane, float *buffer)
{
	const range_grid *g = job->grid;
	int64_t row = (int64_t)job->row + y - TILE_REACH,
		from = (int64_t)job->column - TILE_REACH - MARGIN;
	if (job->reach_columns == TILE_REACH && job->columns % LANES == 0 && row >= 0 &&
		row < g->rows && from >= 0 &&
		from + job->columns + PITCH - TILE_COLUMNS <= g->columns)
		return plane + row * g->columns + from;
	copy_row(job, y, plane, buffer);
	return buffer;
}

INLINE void place_row(tile *t, const struct tile_job *job, int y, vf *u_sum, vf *u_count)
{
	const range_grid *g = job->grid;
	float buffer[4][PITCH];
	const float *line[4] = { find_row(job, y, g->x_m, buffer[0]),
		find_row(job, y, g->y_m, buffer[1]), find_row(job, y, g->z_m, buffer[2]),
		find_row(job, y, g->range_m, buffer[3]) };
	const float(*axis)[3] = (const float(*)[3])t->axis;
	int r = y + MARGIN;
	vf v_sum = { 0 }, level = { 0 }, count = { 0 };
	if (t->has_segments)
		copy_row(job, y, (const float *)job->options->segment, (float *)t->segment[r]);
	for (int c = MARGIN; c < MARGIN + t->width; c += LANES) {
		vf x = load(line[0] + c), yy = load(line[1] + c), z = load(line[2] + c),
		   range = load(line[3] + c);
		vf depth = axis[2][0] * x + axis[2][1] * yy + axis[2][2] * z;
		vi good = (range > 0) & (depth > 0.2f * range);
		vf w = where(good, 1 / choose(good, depth, all(1)));
		vf u = (axis[0][0] * x + axis[0][1] * yy + axis[0][2] * z) * w;
		vf v = (axis[1][0] * x + axis[1][1] * yy + axis[1][2] * z) * w;
		vf one = where(good, all(1));
		store(t->u[r] + c, u);
		store(t->v[r] + c, v);
		store(t->w[r] + c, w);
		store(t->range[r] + c, where(good, range));
		v_sum += v;
		count += one;
		level += where(good, root(x * x + yy * yy) / choose(good, range, all(1)));
		int group = (c - MARGIN - TILE_REACH) / LANES;
		if (c >= MARGIN + TILE_REACH && group < GROUPS) {
			u_sum[group] += u;
			u_count[group] += one;
		}
	}
	store(t->w[r] + MARGIN + t->width, (vf){ 0 });
	store(t->range[r] + MARGIN + t->width, (vf){ 0 });
	float n = 0, v_all = 0, level_all = 0;
	for (int k = 0; k < LANES; k++) {
		n += count[k];
		v_all += v_sum[k];
		level_all += level[k];
	}
	t->v_mean[r] = n > 0 ? v_all / n : 0;
	t->level[r] = n > 0 ? level_all / n : 1;
	for (int c = MARGIN; n > 0 && c < MARGIN + t->width; c += LANES) {
		vf w = load(t->w[r] + c);
		store(t->v[r] + c, where(w > 0, load(t->v[r] + c) - t->v_mean[r]));
	}
}

INLINE void place(tile *t, const struct tile_job *job)
{
	vf u_sum[GROUPS] = { 0 }, u_count[GROUPS] = { 0 };
	for (int y = 0; y < t->height; y++)
		place_row(t, job, y, u_sum, u_count);
	for (int r = MARGIN + t->height; r < 2 * MARGIN + t->height; r++)
		memset(t->w[r], 0, sizeof t->w[r]); /* a tile before may have been higher */
	for (int group = 0; group < GROUPS; group++) {
		float sum = 0, count = 0;
		for (int k = 0; k < LANES; k++) {
			sum += u_sum[group][k];
			count += u_count[group][k];
		}
		t->u_mean[group] = count > 0 ? sum / count : 0;
	}
}

/* ---- links ---- */

/* Four cells in a line, a b c d: b and c are side by side, a is two before b, d two behind c. */
struct line {
	vf w[4], at[4]; /* inverse depth, direction along the line */
};

/* What goes on as the cells before b, or after c, foretell it is a surface, however steep: from `behind` to `from` it went up by
 * rise over run, and `to` is a step further. All is times run, for division is slow. */
INLINE vi is_foretold(vf from, vf behind, vf run, vf step, vf to, vf noise)
{
	vf going_on = (from - behind) * step;
	return magnitude((from - to) * run + going_on) <=
	       6 * noise * magnitude(run) + 0.5f * magnitude(going_on);
}

INLINE vi is_linked(const struct line *l, float noise_m, float step_rad)
{
	vf b = l->w[1], c = l->w[2], noise = noise_m * (b * c);
	vf difference = magnitude(c - b), size = step_rad * most(b, c);
	vf step = l->at[2] - l->at[1];
	vi before = (l->w[0] > 0) & is_foretold(b, l->w[0], l->at[1] - l->at[0], step, c, noise);
	vi after = (l->w[3] > 0) & is_foretold(c, l->w[3], l->at[2] - l->at[3], -step, b, noise);
	vi gentle = difference <= 5 * noise + size;
	vi steep = difference > 5 * noise + 12 * size;
	return (b > 0) & (c > 0) & (gentle | (before & after) | ((before | after) & ~steep));
}

INLINE vi same_segment(const tile *t, int r, int c, int down, int right)
{
	vi a = (vi) * (const vu_loose *)&t->segment[r][c];
	vi b = (vi) * (const vu_loose *)&t->segment[r + down][c + right];
	return (a == 0) | (b == 0) | (a == b);
}

INLINE vi link_right(const tile *t, int r, int c, const struct tile_job *job)
{
	struct line l;
	static const int at[4] = { -2, 0, 1, 3 };
	for (int k = 0; k < 4; k++) {
		l.w[k] = load(t->w[r] + c + at[k]);
		l.at[k] = load(t->u[r] + c + at[k]);
	}
	vi linked = is_linked(
		&l, job->options->range_noise_m, (float)job->grid->column_rad * t->level[r]);
	return t->has_segments ? linked & same_segment(t, r, c, 0, 1) : linked;
}

INLINE vi link_down(const tile *t, int r, int c, const struct tile_job *job)
{
	struct line l;
	static const int at[4] = { -2, 0, 1, 3 };
	for (int k = 0; k < 4; k++) {
		l.w[k] = load(t->w[r + at[k]] + c);
		l.at[k] = load(t->v[r + at[k]] + c) + t->v_mean[r + at[k]];
	}
	vi linked = is_linked(&l, job->options->range_noise_m, (float)job->grid->row_rad);
	return t->has_segments ? linked & same_segment(t, r, c, 1, 0) : linked;
}

INLINE void find_links(tile *t, const struct tile_job *job)
{
	for (int y = 0; y < t->height; y++) {
		for (int c = MARGIN; c < MARGIN + t->width; c += LANES)
			store_mask(t->right[y] + c, link_right(t, y + MARGIN, c, job));
		store_mask(t->right[y] + MARGIN + t->width - 1, (vi){ 0 });
	}
	for (int y = 0; y < t->height - 1; y++)
		for (int c = MARGIN + TILE_REACH; c < MARGIN + t->width - TILE_REACH; c += LANES)
			store_mask(t->down[y] + c, link_down(t, y + MARGIN, c, job));
	memset(t->down[t->height - 1], 0, sizeof t->down[0]);
}

/* ---- windows ---- */

/* How far the range changes from a cell to the next, beyond what noise does: the lesser of both sides, 0 where a side is
 * missing. */
INLINE vf slope_m(vf before, vf here, vf after, float noise_m)
{
	vf a = where(before > 0, here - before), b = where(after > 0, after - here);
	vf both = (vf)((vi)magnitude(a) & (before > 0) & (after > 0));
	vf least_m = choose((before > 0) & (after > 0), least(both, magnitude(b)),
		most(magnitude(a), magnitude(b)));
	return most(least_m * least_m * 0.25f - 0.5f * noise_m * noise_m, all(0));
}

/* Cells each way that the window holds; spacing_m2: square of the distance of neighbours on the surface along it. */
INLINE vf arm_cells(vf range, float across_rad, float along_rad, vf slope_m2,
	const struct normals_options *o, float most_cells)
{
	vf along = along_rad * range;
	vf beam = range * __builtin_sqrtf(along_rad * across_rad);
	vf wide_m2 =
		most(all(o->radius_m * o->radius_m), 0.87f / AIM_RAD * o->range_noise_m * beam);
	vf cells = root(wide_m2 / most(along * along + slope_m2, all(1e-12f)));
	return where(range > 0, least(most(cells, all(ARM_MIN)), all(most_cells)));
}

INLINE void add_cell(vf *s, vf u, vf v, vf w)
{
	s[U] += u;
	s[V] += v;
	s[W] += w;
	s[UU] += u * u;
	s[UV] += u * v;
	s[VV] += v * v;
	s[UW] += u * w;
	s[VW] += v * w;
	s[WW] += w * w;
}

/* Cells to the right (side 1) or left (-1) as far as the arm and the links reach; gives minus how many. */
INLINE vi add_run(vf *sum, const tile *t, int y, int c, int side, vf arm, float u_mean)
{
	const int r = y + MARGIN, far = (int)largest(arm);
	vf here = load(t->w[r] + c);
	vi in = here > 0, count = { 0 };
	for (int k = 1; k <= far; k++) {
		const int i = c + side * k;
		in &= (arm >= (float)k) & load_mask(t->right[y] + (side > 0 ? i - 1 : i));
		if (k % NO_LINKS_EACH == 0 && !any(in))
			break;
		count += in;
		add_cell(sum, where(in, load(t->u[r] + i) - u_mean), where(in, load(t->v[r] + i)),
			where(in, load(t->w[r] + i) - here));
	}
	return count;
}

/* Along a row: u relative to the group's mean, v to the row's, w to the cell's own. */
INLINE void sum_row(tile *t, const struct tile_job *job, int y, int group)
{
	int r = y + MARGIN, c = MARGIN + TILE_REACH + group * LANES;
	vf *s = t->sum[y % RING], sum[SUMS] = { 0 };
	vf range = load(t->range[r] + c);
	if (largest(range) > 0) {
		float u_mean = t->u_mean[group];
		vf slope = slope_m(load(t->range[r] + c - 2), range, load(t->range[r] + c + 2),
			job->options->range_noise_m);
		vf arm = arm_cells(range, (float)job->grid->row_rad,
			(float)job->grid->column_rad * t->level[r], slope, job->options,
			(float)job->reach_columns);
		vi is = range > 0;
		add_cell(sum, where(is, load(t->u[r] + c) - u_mean), load(t->v[r] + c), (vf){ 0 });
		vi count = is + add_run(sum, t, y, c, 1, arm, u_mean) +
			   add_run(sum, t, y, c, -1, arm, u_mean);
		sum[N] = __builtin_convertvector(-count, vf);
	}
	for (int k = 0; k < SUMS; k++)
		s[k] = sum[k];
}

/* Adds the sums of another row, moved to this cell's v and w. */
INLINE void add_row(vf *s, const vf *other, float dv, vf dw, vi in)
{
	vf n = where(in, other[N]), u = where(in, other[U]), v = where(in, other[V]),
	   w = where(in, other[W]);
	vf wn = w + dw * n;
	s[N] += n;
	s[U] += u;
	s[V] += v + dv * n;
	s[W] += wn;
	s[UU] += where(in, other[UU]);
	s[UV] += where(in, other[UV]) + dv * u;
	s[VV] += where(in, other[VV]) + dv * (2 * v + dv * n);
	s[UW] += where(in, other[UW]) + dw * u;
	s[VW] += where(in, other[VW]) + dw * v + dv * wn;
	s[WW] += where(in, other[WW]) + dw * (2 * w + dw * n);
}

/* Rows below (side 1) or above (-1) as far as the arm and the links reach. */
INLINE void add_rows(vf *s, const tile *t, int y, int c, int side, vf arm)
{
	const int r = y + MARGIN, far = (int)largest(arm);
	vf here = load(t->w[r] + c);
	vi in = here > 0;
	for (int k = 1; k <= far; k++) {
		const int i = y + side * k;
		in &= (arm >= (float)k) & load_mask(t->down[side > 0 ? i - 1 : i] + c);
		if (k % NO_LINKS_EACH == 0 && !any(in))
			break;
		add_row(s, t->sum[i % RING], t->v_mean[i + MARGIN] - t->v_mean[r],
			load(t->w[i + MARGIN] + c) - here, in);
	}
}

INLINE void sum_window(const tile *t, const struct tile_job *job, int y, int group, vf *s)
{
	int r = y + MARGIN, c = MARGIN + TILE_REACH + group * LANES;
	const float column_rad = (float)job->grid->column_rad * t->level[r],
		    row_rad = (float)job->grid->row_rad;
	vf range = load(t->range[r] + c);
	vf slope = slope_m(load(t->range[r - 2] + c), range, load(t->range[r + 2] + c),
		job->options->range_noise_m);
	vf arm = arm_cells(range, column_rad, row_rad, slope, job->options, TILE_REACH);
	for (int k = 0; k < SUMS; k++)
		s[k] = t->sum[y % RING][k];
	add_rows(s, t, y, c, 1, arm);
	add_rows(s, t, y, c, -1, arm);
}

/* ---- planes ---- */

struct fit {
	vi good;
	vf count, u, v, uu, uv, vv; /* of the window: mean direction, relative; covariance */
	vf a, b, d;                 /* w = a * u + b * v + d, u and v of the tile */
	vf error_w2;                /* mean square of what remains, in w */
	vf centre_w;                /* of the plane at the mean direction, and there: */
	vf centre_u, centre_v;
};

INLINE struct fit fit_plane(const vf *s, vf here, float u_mean, float v_mean, float noise_m)
{
	struct fit f;
	f.good = (s[N] >= COUNT_MIN) & (here > 0);
	f.count = choose(f.good, s[N], all(1));
	vf part = 1 / f.count;
	vf w = s[W] * part;
	f.u = s[U] * part;
	f.v = s[V] * part;
	f.uu = s[UU] * part - f.u * f.u;
	f.uv = s[UV] * part - f.u * f.v;
	f.vv = s[VV] * part - f.v * f.v;
	vf uw = s[UW] * part - f.u * w, vw = s[VW] * part - f.v * w, ww = s[WW] * part - w * w;
	f.centre_u = f.u + u_mean;
	f.centre_v = f.v + v_mean;
	/* Where nothing is known, the surface faces the scanner. */
	vf facing = (w + here) / (1 + f.centre_u * f.centre_u + f.centre_v * f.centre_v);
	vf a0 = facing * f.centre_u, b0 = facing * f.centre_v;
	vf hold = noise_m * here * (1 / PRIOR_SLOPE);
	hold = hold * hold * part + 1e-14f;
	vf p = f.uu + hold, q = f.vv + hold;
	vf ra = uw - f.uu * a0 - f.uv * b0, rb = vw - f.uv * a0 - f.vv * b0;
	vf scale = 1 / (p * q - f.uv * f.uv);
	f.a = a0 + (ra * q - rb * f.uv) * scale;
	f.b = b0 + (rb * p - ra * f.uv) * scale;
	f.centre_w = here + w;
	f.d = f.centre_w - f.a * f.centre_u - f.b * f.centre_v;
	f.error_w2 = most(ww - 2 * (f.a * uw + f.b * vw) + f.a * f.a * f.uu + 2 * f.a * f.b * f.uv +
				  f.b * f.b * f.vv,
		all(0));
	f.good &= f.centre_w > 0;
	return f;
}

/* Into the grid's planes, those of the lanes that are the tile's. */
INLINE void put(float *plane, size_t at, vf x, int lanes)
{
	if (!plane)
		return;
	if (lanes == LANES)
		store(plane + at, x);
	else
		memcpy(plane + at, &x, lanes * sizeof *plane);
}

INLINE vf turned(const tile *t, int k, vf x, vf y, vf z)
{
	return t->axis[0][k] * x + t->axis[1][k] * y + t->axis[2][k] * z;
}

/* The neighbours' places on the plane: moving by du, dv in direction moves the point by du * e + dv * f. */
INLINE void put_window(
	const tile *t, const struct normals_planes *p, size_t at, const struct fit *f, int lanes)
{
	vf z = 1 / choose(f->good, f->centre_w, all(1));
	vf ea = f->a * z, eb = f->b * z;
	vf e[3] = { z * (1 - f->centre_u * ea), -z * f->centre_v * ea, -z * ea };
	vf g[3] = { -z * f->centre_u * eb, z * (1 - f->centre_v * eb), -z * eb };
	vf along[3], up[3];
	put(p->count, at, where(f->good, f->count), lanes);
	for (int k = 0; k < 3; k++) {
		put(p->centre_m[k], at, turned(t, k, f->centre_u * z, f->centre_v * z, z), lanes);
		along[k] = turned(t, k, e[0], e[1], e[2]);
		up[k] = turned(t, k, g[0], g[1], g[2]);
	}
	for (int k = 0, i = 0; i < 3; i++)
		for (int j = i; j < 3; j++)
			put(p->covariance_m2[k++], at,
				f->uu * along[i] * along[j] +
					f->uv * (along[i] * up[j] + up[i] * along[j]) +
					f->vv * up[i] * up[j],
				lanes);
}

INLINE void put_plane(
	const tile *t, const struct normals_planes *p, size_t at, const struct fit *f, int lanes)
{
	vf length = root(f->a * f->a + f->b * f->b + f->d * f->d),
	   inverse = 1 / choose(f->good, length, all(1));
	vf z = 1 / choose(f->good, f->centre_w, all(1));
	for (int k = 0; k < 3; k++)
		put(p->normal[k], at, where(f->good, -inverse * turned(t, k, f->a, f->b, f->d)),
			lanes);
	vf error = z * inverse * root(f->error_w2), none = all(NAN);
	put(p->error_m, at, choose(f->good, error, none), lanes);
	put(p->offset_m, at, where(f->good, inverse), lanes);
	if (p->curvature) {
		vf ea = f->a * z, eb = f->b * z, u = f->centre_u, v = f->centre_v,
		   one = 1 + u * u + v * v;
		vf spread = z * z *
			    (f->uu * (1 - 2 * u * ea + one * ea * ea) +
				    f->vv * (1 - 2 * v * eb + one * eb * eb) -
				    2 * f->uv * (u * eb + v * ea - one * ea * eb));
		vf least_m2 = least(error * error, spread * 0.5f);
		put(p->curvature, at,
			choose(f->good, least_m2 / most(spread + least_m2, all(1e-20f)), none),
			lanes);
	}
	if (p->count)
		put_window(t, p, at, f, lanes);
}

INLINE void fit_cells(const tile *t, const struct tile_job *job, int y, int group)
{
	int c = MARGIN + TILE_REACH + group * LANES, r = y + MARGIN;
	size_t at = (size_t)(job->row + y - TILE_REACH) * job->grid->columns + job->column +
		    group * LANES;
	vf s[SUMS], here = load(t->w[r] + c);
	int lanes = MIN(LANES, (int)job->columns - group * LANES);
	sum_window(t, job, y, group, s);
	struct fit f =
		fit_plane(s, here, t->u_mean[group], t->v_mean[r], job->options->range_noise_m);
	put_plane(t, job->planes, at, &f, lanes);
}

/* A group of columns after the other: what its windows take in stays in the nearest cache. */
INLINE void fit_tile(tile *t, const struct tile_job *job)
{
	place(t, job);
	find_links(t, job);
	for (int group = 0; group * LANES < (int)job->columns; group++)
		for (int y = 0; y < t->height; y++) {
			sum_row(t, job, y, group);
			if (y >= 2 * TILE_REACH)
				fit_cells(t, job, y - TILE_REACH, group);
		}
}

static void fit_tile_portable(tile *t, const struct tile_job *job)
{
	fit_tile(t, job);
}

#if defined __x86_64__
__attribute__((target("avx2,fma"))) static void fit_tile_avx2(tile *t, const struct tile_job *job)
{
	fit_tile(t, job);
}
#endif

static void put_nothing(const struct tile_job *job)
{
	const struct normals_planes *p = job->planes;
	float *none[] = { p->error_m, p->curvature },
	      *zero[] = { p->normal[0], p->normal[1], p->normal[2], p->offset_m, p->count };
	for (uint32_t r = 0; r < job->rows; r++)
		for (uint32_t c = 0; c < job->columns; c++) {
			size_t i = (size_t)(job->row + r) * job->grid->columns + job->column + c;
			for (size_t k = 0; k < G_N_ELEMENTS(none); k++)
				if (none[k])
					none[k][i] = NAN;
			for (size_t k = 0; k < G_N_ELEMENTS(zero); k++)
				if (zero[k])
					zero[k][i] = 0;
		}
}

void tile_fit(tile *t, const struct tile_job *job)
{
	t->has_segments = job->options->segment;
	t->height = (int)job->rows + 2 * TILE_REACH;
	t->width = (int)(job->columns + LANES - 1) / LANES * LANES + 2 * TILE_REACH;
	if (!set_frame(t, job)) {
		put_nothing(job);
		return;
	}
#if defined __x86_64__
	if (!job->options->portable && __builtin_cpu_supports("avx2") &&
		__builtin_cpu_supports("fma")) {
		fit_tile_avx2(t, job);
		return;
	}
#endif
	fit_tile_portable(t, job);
}
