#ifndef PROCESS_NORMALS_WINDOW_H
#define PROCESS_NORMALS_WINDOW_H
/* The sums over windows: of a cell alone, or of four side by side. Internal to normals-tile.c. */
#include "process/normals-frame.h"

/* Windows are wide enough for this error of a normal, 1 sigma about each axis. */
#define AIM_RAD 0.014f
/* At least so many cells each way: fewer do not tell a slope from noise. */
#define ARM_MIN 3
/* So many cells of an arm are summed up before it is asked whether any lane goes on. */
#define NO_LINKS_EACH 4
/* Two cells at once come in when the further one is at most this much beyond the arm's end. */
#define PAIR_SLACK 0.25f

/* ---- of a cell ---- */

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

INLINE void add_cell(struct sums *s, vf u, vf v, vf w)
{
	s->u += u;
	s->v += v;
	s->w += w;
	s->uu += u * u;
	s->uv += u * v;
	s->vv += v * v;
	s->uw += u * w;
	s->vw += v * w;
	s->ww += w * w;
}

/* Cells to the right (side 1) or left (-1) as far as the arm and the links reach; gives minus how many. */
INLINE vi add_run(struct sums *sum, const tile *t, int y, int c, int side, vf arm)
{
	const int far = (int)largest(arm);
	vf here = load(cell(t->w[kept(y)], c));
	vi in = here > 0, count = { 0 };
	for (int k = 1; k <= far; k++) {
		const int i = c + side * k;
		in &= (arm >= (float)k) & link_at(t->right[kept(y)], side > 0 ? i - 1 : i);
		if (k % NO_LINKS_EACH == 0 && !any(in))
			break;
		count += in;
		add_cell(sum, where(in, load(cell(t->u[kept(y)], i))),
			where(in, load(cell(t->v[kept(y)], i))),
			where(in, load(cell(t->w[kept(y)], i)) - here));
	}
	return count;
}

INLINE vf arm_across(const tile *t, const struct tile_job *job, int y, int c)
{
	vf range = load(cell(t->range[kept(y)], c));
	vf slope = slope_m(load(cell(t->range[kept(y)], c - 2)), range,
		load(cell(t->range[kept(y)], c + 2)), job->options->range_noise_m);
	return arm_cells(range, (float)job->grid->row_rad,
		(float)job->grid->column_rad * t->level[kept(y)], slope, job->options,
		(float)job->reach_columns);
}

INLINE vf arm_down(const tile *t, const struct tile_job *job, int y, int c)
{
	vf range = load(cell(t->range[kept(y)], c));
	vf slope = slope_m(load(cell(t->range[kept(y - 2)], c)), range,
		load(cell(t->range[kept(y + 2)], c)), job->options->range_noise_m);
	return arm_cells(range, (float)job->grid->column_rad * t->level[kept(y)],
		(float)job->grid->row_rad, slope, job->options, TILE_REACH);
}

INLINE int group_of(int c)
{
	return (c - MARGIN - TILE_REACH) / GROUP;
}

INLINE struct sums *sums_of(tile *t, int y, int c)
{
	return &t->sum[group_of(c)][kept(y)][c & 1];
}

INLINE struct sums *blocks_of(tile *t, int y, int c)
{
	return &t->block[group_of(c)][kept(y) / 2];
}

/* Along a row; w relative to the cell's own. */
INLINE void make_row(tile *t, const struct tile_job *job, int y, int c)
{
	int *made = &t->sum_row[group_of(c)][kept(y)][c & 1];
	if (*made == y)
		return;
	*made = y;
	struct sums sum = { 0 };
	vi is = load(cell(t->w[kept(y)], c)) > 0;
	if (any(is)) {
		vf arm = arm_across(t, job, y, c);
		add_cell(&sum, where(is, load(cell(t->u[kept(y)], c))),
			load(cell(t->v[kept(y)], c)), (vf){ 0 });
		vi count = is + add_run(&sum, t, y, c, 1, arm) + add_run(&sum, t, y, c, -1, arm);
		sum.n = __builtin_convertvector(-count, vf);
	}
	*sums_of(t, y, c) = sum;
}

/* Adds the sums of another row, moved to this cell's w. */
INLINE void add_row(struct sums *s, const struct sums *other, vf dw, vi in)
{
	vf n = where(in, other->n), u = where(in, other->u), v = where(in, other->v),
	   w = where(in, other->w) + dw * n, away = where(in, other->w) + w;
	s->n += n;
	s->u += u;
	s->v += v;
	s->w += w;
	s->uu += where(in, other->uu);
	s->uv += where(in, other->uv);
	s->vv += where(in, other->vv);
	s->uw += where(in, other->uw) + dw * u;
	s->vw += where(in, other->vw) + dw * v;
	s->ww += where(in, other->ww) + dw * away;
}

/* ---- of four cells ---- */

/* Cells of rows y and y + 1, columns c and c + 1, share a window when three of the four links around hold, so that each is linked
 * with all others; c even. */
INLINE vi is_block(const tile *t, int y, int c)
{
	vi above = link_at(t->right[kept(y)], c), below = link_at(t->right[kept(y + 1)], c),
	   left = link_at(t->down[kept(y)], c), right = link_at(t->down[kept(y)], c + 1);
	return (above & below & (left | right)) | (left & right & (above | below));
}

/* As add_run, two columns a step, w relative to `here`; gives minus how many steps. */
INLINE vi add_block_run(
	struct sums *sum, const tile *t, int y, int c, int side, vi in, vf arm, vf here)
{
	const int far = (int)((largest(arm) + PAIR_SLACK) * 0.5f);
	vi count = { 0 };
	for (int k = 1; k <= far; k++) {
		const int i = c + 2 * side * k;
		in &= (arm >= 2 * (float)k - PAIR_SLACK) &
		      link_at(t->right[kept(y)], side > 0 ? i - 1 : i + 1) &
		      link_at(t->right[kept(y)], i);
		if (k % (NO_LINKS_EACH / 2) == 0 && !any(in))
			break;
		count += in;
		for (int odd = 0; odd < 2; odd++)
			add_cell(sum, where(in, load(cell(t->u[kept(y)], i + odd))),
				where(in, load(cell(t->v[kept(y)], i + odd))),
				where(in, load(cell(t->w[kept(y)], i + odd)) - here));
	}
	return count;
}

/* Along rows y and y + 1, w relative to the first cell's; only where they are blocks does it mean anything. */
INLINE void make_blocks(tile *t, const struct tile_job *job, int y, int c)
{
	int *made = &t->block_row[group_of(c)][kept(y) / 2];
	if (*made == y)
		return;
	*made = y;
	struct sums sum = { 0 };
	vi is = is_block(t, y, c), count = is + is;
	vf here = load(cell(t->w[kept(y)], c)), arm = arm_across(t, job, y, c);
	for (int below = 0; below < 2; below++) {
		const unsigned r = kept(y + below);
		for (int odd = 0; odd < 2; odd++)
			add_cell(&sum, where(is, load(cell(t->u[r], c + odd))),
				where(is, load(cell(t->v[r], c + odd))),
				where(is, load(cell(t->w[r], c + odd)) - here));
		count += add_block_run(&sum, t, y + below, c, 1, is, arm, here) +
			 add_block_run(&sum, t, y + below, c, -1, is, arm, here);
	}
	sum.n = __builtin_convertvector(-2 * count, vf);
	*blocks_of(t, y, c) = sum;
}

/* ---- the rows of a window ---- */

/* `rows` is how many a step takes: 1, of a cell's own window, or 2, of a block's. It is known where this is inlined. */
INLINE void make_sums(tile *t, const struct tile_job *job, int y, int c, int rows)
{
	if (rows == 1)
		make_row(t, job, y, c);
	else
		make_blocks(t, job, y, c);
}

INLINE struct sums *made_sums(tile *t, int y, int c, int rows)
{
	return rows == 1 ? sums_of(t, y, c) : blocks_of(t, y, c);
}

/* Whether the arms and the links go on to the k-th step below (side 1) or above (-1); of blocks, they end before what is none. */
INLINE vi goes_on(const tile *t, int y, int c, int side, vf arm, int k, int rows)
{
	const int i = y + rows * side * k;
	vi linked = link_at(t->down[kept(side > 0 ? i - 1 : i + rows - 1)], c);
	if (rows == 1)
		return (arm >= (float)k) & linked;
	return (arm >= 2 * (float)k - PAIR_SLACK) & linked & is_block(t, i, c);
}

/* How many steps some lane goes; the sums there are made. */
INLINE int find_steps(tile *t, const struct tile_job *job, int y, int c, int side, vf arm, int rows)
{
	const int far = rows == 1 ? (int)largest(arm) : (int)((largest(arm) + PAIR_SLACK) * 0.5f);
	vi in = { 0 };
	in = ~in;
	for (int k = 1; k <= far; k++) {
		in &= goes_on(t, y, c, side, arm, k, rows);
		if (!any(in))
			return k - 1;
		make_sums(t, job, y + rows * side * k, c, rows);
	}
	return far;
}

INLINE void add_steps(struct sums *s, tile *t, int y, int c, int side, vf arm, int steps, int rows)
{
	vf here = load(cell(t->w[kept(y)], c));
	vi in = here > 0;
	for (int k = 1; k <= steps; k++) {
		const int i = y + rows * side * k;
		in &= goes_on(t, y, c, side, arm, k, rows);
		add_row(s, made_sums(t, i, c, rows), load(cell(t->w[kept(i)], c)) - here, in);
	}
}

INLINE struct sums sum_window(tile *t, const struct tile_job *job, int y, int c, int rows)
{
	vf arm = arm_down(t, job, y, c);
	make_sums(t, job, y, c, rows);
	int below = find_steps(t, job, y, c, 1, arm, rows),
	    above = find_steps(t, job, y, c, -1, arm, rows);
	struct sums s = *made_sums(t, y, c, rows);
	add_steps(&s, t, y, c, 1, arm, below, rows);
	add_steps(&s, t, y, c, -1, arm, above, rows);
	return s;
}

/* Whether all cells of the group in rows y and y + 1 are in blocks, or not there. */
INLINE bool is_all_blocks(const tile *t, int y, int c)
{
	vf highest = most(most(load(cell(t->w[kept(y)], c)), load(cell(t->w[kept(y)], c + 1))),
		most(load(cell(t->w[kept(y + 1)], c)), load(cell(t->w[kept(y + 1)], c + 1))));
	return !any((highest > 0) & ~is_block(t, y, c));
}

#endif
