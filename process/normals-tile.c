#include "process/normals-tile.h"
#include "process/normals-frame.h"
#include "process/normals-plane.h"
#include <string.h>

/* Windows are wide enough for this error of a normal, 1 sigma about each axis. */
#define AIM_RAD 0.014f
/* At least so many cells each way: fewer do not tell a slope from noise. */
#define ARM_MIN 3
/* So many cells of an arm are summed up before it is asked whether any lane goes on. */
#define NO_LINKS_EACH 4
/* Two rows at once: a pair comes in when its further row is at most this much beyond the arm's end. */
#define PAIR_SLACK 0.25f

tile *tile_new(void)
{
	return g_aligned_alloc0(1, sizeof(tile), 64);
}

void tile_free(tile *t)
{
	g_aligned_free(t);
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

INLINE vf arm_down(const tile *t, const struct tile_job *job, int y, int c)
{
	int r = y + MARGIN;
	vf range = load(t->range[r] + c);
	vf slope = slope_m(load(t->range[r - 2] + c), range, load(t->range[r + 2] + c),
		job->options->range_noise_m);
	return arm_cells(range, (float)job->grid->column_rad * t->level[r],
		(float)job->grid->row_rad, slope, job->options, TILE_REACH);
}

INLINE void sum_window(const tile *t, const struct tile_job *job, int y, int c, vf *s)
{
	vf arm = arm_down(t, job, y, c);
	for (int k = 0; k < SUMS; k++)
		s[k] = t->sum[y % RING][k];
	add_rows(s, t, y, c, 1, arm);
	add_rows(s, t, y, c, -1, arm);
}

/* ---- two rows at once ---- */

INLINE vf *pair_of(tile *t, int y)
{
	return t->pair[y / 2 % (RING / 2)];
}

/* Rows y and y + 1, relative to row y; only where they are linked does it mean anything. */
INLINE void sum_pair(tile *t, int y, int c)
{
	const int r = y + MARGIN;
	vf s[SUMS], *pair = pair_of(t, y);
	for (int k = 0; k < SUMS; k++)
		s[k] = t->sum[y % RING][k];
	add_row(s, t->sum[(y + 1) % RING], t->v_mean[r + 1] - t->v_mean[r],
		load(t->w[r + 1] + c) - load(t->w[r] + c), load_mask(t->down[y] + c));
	for (int k = 0; k < SUMS; k++)
		pair[k] = s[k];
}

/* As add_rows, two rows a step; an arm ends before a pair that is not linked. */
INLINE void add_pairs(vf *s, tile *t, int y, int c, int side, vf arm)
{
	const int r = y + MARGIN, far = (int)((largest(arm) + PAIR_SLACK) * 0.5f);
	vf here = load(t->w[r] + c);
	vi in = here > 0;
	for (int k = 1; k <= far; k++) {
		const int i = y + 2 * side * k;
		in &= (arm >= 2 * (float)k - PAIR_SLACK) &
		      load_mask(t->down[side > 0 ? i - 1 : i + 1] + c) & load_mask(t->down[i] + c);
		if (k % (NO_LINKS_EACH / 2) == 0 && !any(in))
			break;
		add_row(s, pair_of(t, i), t->v_mean[i + MARGIN] - t->v_mean[r],
			load(t->w[i + MARGIN] + c) - here, in);
	}
}

/* One window for a cell of row y and that below it. */
INLINE void sum_pair_window(tile *t, const struct tile_job *job, int y, int c, vf *s)
{
	vf arm = arm_down(t, job, y, c);
	for (int k = 0; k < SUMS; k++)
		s[k] = pair_of(t, y)[k];
	add_pairs(s, t, y, c, 1, arm);
	add_pairs(s, t, y, c, -1, arm);
}

/* Whether all cells of the group in row y are linked to those below, or neither is there. */
INLINE bool is_paired(const tile *t, int y, int c)
{
	const int r = y + MARGIN;
	vi one = (load(t->w[r] + c) > 0) | (load(t->w[r + 1] + c) > 0);
	return !any(one & ~load_mask(t->down[y] + c));
}

/* ---- cells ---- */

INLINE struct place place_of(const struct tile_job *job, int y, int group, bool paired)
{
	size_t columns = job->grid->columns;
	return (struct place){ .at = (size_t)(job->row + y - TILE_REACH) * columns + job->column +
				     group * LANES,
		.below = paired ? columns : 0,
		.lanes = MIN(LANES, (int)job->columns - group * LANES) };
}

INLINE void fit_cells(tile *t, const struct tile_job *job, int y, int group, bool paired)
{
	int c = MARGIN + TILE_REACH + group * LANES, r = y + MARGIN;
	vf s[SUMS];
	if (paired)
		sum_pair_window(t, job, y, c, s);
	else
		sum_window(t, job, y, c, s);
	struct fit f = fit_plane(
		s, load(t->w[r] + c), t->u_mean[group], t->v_mean[r], job->options->range_noise_m);
	put_plane(t, job->planes, place_of(job, y, group, paired), &f, load(t->range[r] + c),
		job->options->range_noise_m);
}

/* Rows y and y + 1. Their windows are all but the same, so one does for both; but not where something ends between them. Who
 * asks for the windows themselves gets each cell's own. */
INLINE void fit_rows(tile *t, const struct tile_job *job, int y, int group)
{
	bool both = y + 1 < TILE_REACH + (int)job->rows;
	bool paired =
		both && !job->planes->count && is_paired(t, y, MARGIN + TILE_REACH + group * LANES);
	fit_cells(t, job, y, group, paired);
	if (both && !paired)
		fit_cells(t, job, y + 1, group, false);
}

/* A group of columns after the other: what its windows take in stays in the nearest cache. */
INLINE void fit_tile(tile *t, const struct tile_job *job)
{
	place(t, job);
	find_links(t, job);
	for (int group = 0; group * LANES < (int)job->columns; group++)
		for (int y = 0; y < t->height; y += 2) {
			sum_row(t, job, y, group);
			sum_row(t, job, y + 1, group);
			sum_pair(t, y, MARGIN + TILE_REACH + group * LANES);
			if (y >= 2 * TILE_REACH)
				fit_rows(t, job, y - TILE_REACH, group);
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
