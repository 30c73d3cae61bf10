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

INLINE float square(float x)
{
	return x * x;
}

/* How far the range changes from a cell to the next, beyond what noise does: the lesser of both sides. */
INLINE vf slope_m2(vf before, vf here, vf after, float noise_m)
{
	const vf steep = all(1e9f);
	vf a = choose(before > 0, magnitude(here - before), steep),
	   b = choose(after > 0, magnitude(after - here), steep), least_m = least(a, b);
	return most(least_m * least_m * 0.25f - 0.5f * noise_m * noise_m, all(0));
}

/* Square of the cells each way that the window holds; slope_m2: square of the distance of neighbours on the surface along it. */
INLINE vf arm_cells2(vf range, float beam_rad, float along_rad, vf slope_m2,
	const struct normals_options *o, float most_cells)
{
	vf along = along_rad * range;
	vf wide_m2 = most(all(o->radius_m * o->radius_m),
		0.87f / AIM_RAD * o->range_noise_m * beam_rad * range);
	vf cells2 = wide_m2 / most(along * along + slope_m2, all(1e-12f));
	return where(range > 0,
		least(most(cells2, all(ARM_MIN * ARM_MIN)), all(most_cells * most_cells)));
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
INLINE vi add_run(struct sums *sum, const tile *t, int y, int c, int side, vf arm2)
{
	const int far = (int)__builtin_sqrtf(largest(arm2));
	vf here = load(cell(t->w[kept(y)], c));
	vi in = here > 0, count = { 0 };
	for (int k = 1; k <= far; k++) {
		const int i = c + side * k;
		in &= (arm2 >= square((float)k)) & link_at(t->right[kept(y)], side > 0 ? i - 1 : i);
		if (k % NO_LINKS_EACH == 0 && !any(in))
			break;
		count += in;
		add_cell(sum, where(in, load(cell(t->u[kept(y)], i))),
			where(in, load(cell(t->v[kept(y)], i))),
			where(in, load(cell(t->w[kept(y)], i)) - here));
	}
	return count;
}

INLINE vf arm2_across(const tile *t, const struct tile_job *job, int y, int c)
{
	const unsigned r = kept(y);
	vf range = load(cell(t->range[r], c));
	vf slope = slope_m2(load(cell(t->range[r], c - 2)), range, load(cell(t->range[r], c + 2)),
		job->options->range_noise_m);
	return arm_cells2(range, t->beam_rad[r], (float)job->grid->column_rad * t->level[r], slope,
		job->options, (float)job->reach_columns);
}

INLINE vf arm2_down(const tile *t, const struct tile_job *job, int y, int c)
{
	const unsigned r = kept(y);
	vf range = load(cell(t->range[r], c));
	vf slope = slope_m2(load(cell(t->range[kept(y - 2)], c)), range,
		load(cell(t->range[kept(y + 2)], c)), job->options->range_noise_m);
	return arm_cells2(
		range, t->beam_rad[r], (float)job->grid->row_rad, slope, job->options, TILE_REACH);
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
		vf arm2 = arm2_across(t, job, y, c);
		add_cell(&sum, where(is, load(cell(t->u[kept(y)], c))),
			load(cell(t->v[kept(y)], c)), (vf){ 0 });
		vi count = is + add_run(&sum, t, y, c, 1, arm2) + add_run(&sum, t, y, c, -1, arm2);
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

INLINE vi is_block(const tile *t, int y, int c)
{
	return load_mask(&t->quads[kept(y) / 2].block[c >> 1]);
}

/* Adds four cells, which begin at column 2 * i. */
INLINE void add_quad(struct sums *s, const tile *t, int y, int i, vf here, vi in)
{
	const struct quads *q = &t->quads[kept(y) / 2];
	vf u = where(in, load(q->u + i)), v = where(in, load(q->v + i)),
	   w = where(in, load(q->w + i)), dw = where(in, load(&t->w[kept(y)][0][i]) - here);
	vf moved = 4 * dw + w;
	s->u += u;
	s->v += v;
	s->w += moved;
	s->uu += where(in, load(q->uu + i));
	s->uv += where(in, load(q->uv + i));
	s->vv += where(in, load(q->vv + i));
	s->uw += where(in, load(q->uw + i)) + dw * u;
	s->vw += where(in, load(q->vw + i)) + dw * v;
	s->ww += where(in, load(q->ww + i)) + dw * (w + moved);
}

/* As add_run, four cells a step, w relative to `here`; gives minus how many steps. */
INLINE vi add_block_run(
	struct sums *sum, const tile *t, int y, int c, int side, vi in, vf arm2, vf here)
{
	const int32_t *linked =
		side > 0 ? t->quads[kept(y) / 2].from_left : t->quads[kept(y) / 2].from_right;
	const int far = (int)((__builtin_sqrtf(largest(arm2)) + PAIR_SLACK) * 0.5f);
	vi count = { 0 };
	for (int k = 1; k <= far; k++) {
		const int i = (c >> 1) + side * k;
		in &= (arm2 >= square(2 * (float)k - PAIR_SLACK)) & load_mask(linked + i);
		if (k % (NO_LINKS_EACH / 2) == 0 && !any(in))
			break;
		count += in;
		add_quad(sum, t, y, i, here, in);
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
	vi is = is_block(t, y, c), count = is;
	vf here = load(cell(t->w[kept(y)], c)), arm2 = arm2_across(t, job, y, c);
	add_quad(&sum, t, y, c >> 1, here, is);
	count += add_block_run(&sum, t, y, c, 1, is, arm2, here) +
		 add_block_run(&sum, t, y, c, -1, is, arm2, here);
	sum.n = __builtin_convertvector(-4 * count, vf);
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

/* How far the rows of a window go on to one side, lane by lane. */
struct walk {
	int steps;
	vi in[TILE_REACH];
};

/* Below (side 1) or above (-1), as far as the arm and the links reach; of blocks, until what is none. The sums there are made. */
INLINE void find_steps(struct walk *ret, tile *t, const struct tile_job *job, int y, int c,
	int side, vf arm2, int rows)
{
	vi in = arm2 > 0;
	int k = 1;
	for (; k <= TILE_REACH / rows; k++) {
		const int i = y + rows * side * k;
		in &= link_at(t->down[kept(side > 0 ? i - 1 : i + rows - 1)], c) &
		      (arm2 >= square((float)(rows * k) - (rows == 2 ? PAIR_SLACK : 0)));
		if (rows == 2)
			in &= is_block(t, i, c);
		if (!any(in))
			break;
		ret->in[k - 1] = in;
		make_sums(t, job, i, c, rows);
	}
	ret->steps = k - 1;
}

INLINE void add_steps(
	struct sums *s, tile *t, int y, int c, int side, const struct walk *walk, int rows)
{
	vf here = load(cell(t->w[kept(y)], c));
	for (int k = 1; k <= walk->steps; k++) {
		const int i = y + rows * side * k;
		add_row(s, made_sums(t, i, c, rows), load(cell(t->w[kept(i)], c)) - here,
			walk->in[k - 1]);
	}
}

/* Of the blocks of rows y and y + 1. */
INLINE struct sums sum_blocks(tile *t, const struct tile_job *job, int y, int c)
{
	vf arm2 = arm2_down(t, job, y, c);
	struct walk below, above;
	make_blocks(t, job, y, c);
	find_steps(&below, t, job, y, c, 1, arm2, 2);
	find_steps(&above, t, job, y, c, -1, arm2, 2);
	struct sums s = *blocks_of(t, y, c);
	add_steps(&s, t, y, c, 1, &below, 2);
	add_steps(&s, t, y, c, -1, &above, 2);
	return s;
}

/* Of the cells of row y and, when both, of row y + 1. Where they are linked they share what is above and what is below, so that
 * each is walked once. */
INLINE void sum_cells(
	tile *t, const struct tile_job *job, int y, int c, bool both, struct sums ret[2])
{
	const int low = y + both;
	struct walk below, above;
	make_row(t, job, y, c);
	if (both)
		make_row(t, job, low, c);
	find_steps(&above, t, job, y, c, -1, arm2_down(t, job, y, c), 1);
	find_steps(&below, t, job, low, c, 1, arm2_down(t, job, low, c), 1);
	struct sums s = *sums_of(t, y, c);
	add_steps(&s, t, y, c, -1, &above, 1);
	if (both) {
		struct sums rest = *sums_of(t, low, c);
		add_steps(&rest, t, low, c, 1, &below, 1);
		vf dw = load(cell(t->w[kept(low)], c)) - load(cell(t->w[kept(y)], c));
		vi linked = link_at(t->down[kept(y)], c);
		ret[0] = s;
		ret[1] = rest;
		add_row(&ret[0], &rest, dw, linked);
		add_row(&ret[1], &s, -dw, linked);
	} else {
		add_steps(&s, t, y, c, 1, &below, 1);
		ret[0] = s;
	}
}

/* Whether all cells of the group in rows y and y + 1 are in blocks, or not there. */
INLINE bool is_all_blocks(const tile *t, int y, int c)
{
	vf highest = most(most(load(cell(t->w[kept(y)], c)), load(cell(t->w[kept(y)], c + 1))),
		most(load(cell(t->w[kept(y + 1)], c)), load(cell(t->w[kept(y + 1)], c + 1))));
	return !any((highest > 0) & ~is_block(t, y, c));
}

#endif
