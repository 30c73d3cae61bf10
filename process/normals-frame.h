#ifndef PROCESS_NORMALS_FRAME_H
#define PROCESS_NORMALS_FRAME_H
/* A tile's cells in its own frame, and which of them are linked. Internal to normals-tile.c; all is inlined, so that it takes on
 * the caller's target. */
#include "process/normals-lanes.h"
#include "process/normals-tile.h"

#define GROUPS (TILE_COLUMNS / LANES)
#define WIDTH  (TILE_COLUMNS + 2 * TILE_REACH)
#define HEIGHT (TILE_ROWS + 2 * TILE_REACH)
#define FRAME_STEP                                                                                 \
	8 /* of that many cells one is enough for the frame; each column and row has its turn */
#define MARGIN 8 /* columns, rows of nothing around it all */
#define PITCH  (WIDTH + 2 * MARGIN)
#define RING   (2 * TILE_REACH + 2) /* rows that the windows of two rows may touch */

enum { N, U, V, W, UU, UV, VV, UW, VW, WW, SUMS };

struct tile {
	/* Direction and inverse depth in the frame of the tile: point = (u, v, 1) / w; w 0: none. v is relative to v_mean of its
	 * row. With rows and columns of nothing around. */
	float u[HEIGHT + 2 * MARGIN][PITCH], v[HEIGHT + 2 * MARGIN][PITCH],
		w[HEIGHT + 2 * MARGIN][PITCH], range[HEIGHT + 2 * MARGIN][PITCH];
	/* -1: to the next cell in the row, or column, is a link. */
	int32_t right[HEIGHT][PITCH], down[HEIGHT][PITCH];
	uint32_t segment[HEIGHT + 2 * MARGIN][PITCH];
	/* Of one group of columns: row y is at y % RING, rows y and y + 1 together, y even, at y / 2 % (RING / 2). */
	vf sum[RING][SUMS], pair[RING / 2][SUMS];
	float v_mean[HEIGHT + 2 * MARGIN], u_mean[GROUPS], level[HEIGHT + 2 * MARGIN];
	float axis[3][3];  /* of the frame: right, up, ahead */
	int height, width; /* with the reach */
	bool has_segments;
};

/* ---- the frame and the points in it ---- */

/* Looks where the tile's points are on average. false: it has none. */
static inline bool set_frame(tile *t, const struct tile_job *job)
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
static inline void copy_row(const struct tile_job *job, int y, const float *plane, float *ret)
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
static inline const float *find_row(
	const struct tile_job *job, int y, const float *plane, float *buffer)
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
	for (int r = MARGIN + t->height; r < 2 * MARGIN + t->height; r++) {
		memset(t->w[r], 0, sizeof t->w[r]); /* a tile before may have been higher */
		memset(t->range[r], 0, sizeof t->range[r]);
	}
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

#endif
