#ifndef PROCESS_NORMALS_FRAME_H
#define PROCESS_NORMALS_FRAME_H
/* A tile's cells in its own frame, and which of them are linked. Internal to normals-tile.c; all is inlined, so that it takes on
 * the caller's target. */
#include "process/lanes.h"
#include "process/normals-tile.h"

#define GROUP                                                                                      \
	(2 * LANES) /* columns that are fitted together: its even ones, or its odd ones, are eight lanes */
#define GROUPS (TILE_COLUMNS / GROUP)
#define WIDTH  (TILE_COLUMNS + 2 * TILE_REACH)
/* Of that many rows and columns one is enough for the frame; each column has its turn. */
#define FRAME_ROWS    3
#define FRAME_COLUMNS 8
#define MARGIN        16 /* columns of nothing left and right */
#define PITCH         (WIDTH + 2 * MARGIN)
#define LINK_REACH    3  /* rows, columns that a link looks ahead */
#define ROWS_AHEAD    3  /* are fetched from memory */
#define KEPT_ROWS     64 /* at least what TILE_STEP and their windows and links touch */

_Static_assert(TILE_COLUMNS % GROUP == 0 && TILE_REACH % GROUP == 0, "whole groups");

/* Of windows, one in each lane. Named, not an array: those the compiler clears and copies in memory. */
struct sums {
	vf n, u, v, w, uu, uv, vv, uw, vw, ww;
};

/* A row of cells, even columns and odd ones apart: see cell(). */
typedef float row_cells[2][PITCH / 2];
typedef int32_t row_links[2][PITCH / 2];

/* Sums of four cells side by side, from each even column on, w relative to the first one's; and whether from the four before,
 * or behind, one comes to these on links in both rows. */
typedef float quad_cells[PITCH / 2];
struct quads {
	quad_cells u, v, w, uu, uv, vv, uw, vw, ww;
	int32_t from_left[PITCH / 2], from_right[PITCH / 2];
	int32_t block[PITCH / 2]; /* each of the four is linked with all others */
};

/* Only the rows that windows may touch are kept: row y is at kept(y). */
struct tile {
	/* Direction and inverse depth in the frame of the tile: point = (u, v, 1) / w; w 0: none. With columns of nothing around. */
	row_cells u[KEPT_ROWS], v[KEPT_ROWS], w[KEPT_ROWS], range[KEPT_ROWS];
	row_links right[KEPT_ROWS],
		down[KEPT_ROWS];      /* -1: to the next cell in the row, or column, is a link */
	row_cells segment[KEPT_ROWS]; /* bits of numbers */
	float level[KEPT_ROWS], beam_rad[KEPT_ROWS];
	struct quads quads[KEPT_ROWS / 2]; /* of rows y and y + 1, y even */
	/* Made when asked for. Of row y, the even or odd columns of a group; or the blocks of rows y and y + 1, y even. */
	struct sums sum[GROUPS][KEPT_ROWS][2], block[GROUPS][KEPT_ROWS / 2];
	int sum_row[GROUPS][KEPT_ROWS][2], block_row[GROUPS][KEPT_ROWS / 2]; /* whose they are */
	float axis[3][3];  /* of the frame: right, up, ahead */
	int height, width; /* with the reach */
	int taken;         /* rows before this one were */
	bool has_segments, is_empty;
};

/* y may be as low as -KEPT_ROWS. */
INLINE unsigned kept(int y)
{
	return (unsigned)(y + KEPT_ROWS) % KEPT_ROWS;
}

/* Where eight cells are that lie two columns apart, from column c on. */
INLINE const float *cell(const row_cells row, int c)
{
	return &row[c & 1][c >> 1];
}

INLINE vi link_at(const row_links row, int c)
{
	return load_mask(&row[c & 1][c >> 1]);
}

/* ---- the frame and the points in it ---- */

/* Adds up the directions of one cell in so many; gives how long they are together. */
static inline double look_around(
	const struct tile_job *job, uint32_t rows, uint32_t columns, double ahead[3])
{
	const range_grid *g = job->grid;
	for (uint32_t r = 0; r < job->rows; r += rows)
		for (uint32_t c = r % columns; c < job->columns; c += columns) {
			size_t i = (size_t)(job->row + r) * g->columns + job->column + c;
			if (!(g->range_m[i] > 0))
				continue;
			float nearness = 1 / g->range_m[i];
			ahead[0] += g->x_m[i] * nearness;
			ahead[1] += g->y_m[i] * nearness;
			ahead[2] += g->z_m[i] * nearness;
		}
	return sqrt(ahead[0] * ahead[0] + ahead[1] * ahead[1] + ahead[2] * ahead[2]);
}

/* Looks where the tile's points are on average. false: it has none. */
static inline bool set_frame(tile *t, const struct tile_job *job)
{
	double ahead[3] = { 0 }, length = look_around(job, FRAME_ROWS, FRAME_COLUMNS, ahead);
	if (!(length > 0)) /* a sparse one */
		length = look_around(job, 1, 1, ahead);
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

/* The cells of row y of the tile, with its reach, from the grid's plane; 0 where it has none. */
static inline void copy_row(const struct tile_job *job, int y, const float *plane, float *ret)
{
	const range_grid *g = job->grid;
	int64_t row = (int64_t)job->row + y - TILE_REACH;
	memset(ret, 0, WIDTH * sizeof *ret);
	if (row < 0 || row >= g->rows)
		return;
	plane += row * g->columns;
	int64_t columns = g->columns, from = (int64_t)job->column - job->reach_columns,
		to = (int64_t)job->column + job->columns + job->reach_columns;
	if (to - from > columns) /* a narrow grid: no cell twice */
		to = from + columns;
	float *into = ret + TILE_REACH - job->reach_columns;
	for (int64_t c = from; c < to;) {
		int64_t at = c < 0 ? c + columns : c >= columns ? c - columns : c;
		int64_t run = MIN(to - c, c < 0 ? -c : c < columns ? columns - c : to - c);
		if (at == c || g->wraps)
			memcpy(into + (c - from), plane + at, run * sizeof *plane);
		c += run;
	}
}

/* That row of the plane: as it lies in the grid when all the tile needs is there, else in buffer. */
static inline const float *find_row(
	const struct tile_job *job, int y, const float *plane, float *buffer)
{
	const range_grid *g = job->grid;
	int64_t row = (int64_t)job->row + y - TILE_REACH, from = (int64_t)job->column - TILE_REACH;
	if (job->reach_columns == TILE_REACH && job->columns % GROUP == 0 && row >= 0 &&
		row < g->rows && from >= 0 && from + job->columns + 2 * TILE_REACH <= g->columns)
		return plane + row * g->columns + from;
	copy_row(job, y, plane, buffer);
	return buffer;
}

/* Eight cells, from column c on, from their points. */
INLINE void place_cells(tile *t, unsigned r, int c, const vf p[4])
{
	const float(*axis)[3] = (const float(*)[3])t->axis;
	vf range = p[3];
	vf depth = axis[2][0] * p[0] + axis[2][1] * p[1] + axis[2][2] * p[2];
	vi good = depth > 0.2f * range; /* of nothing it is not */
	vf w = where(good, 1 / depth);
	store((float *)cell(t->u[r], c),
		(axis[0][0] * p[0] + axis[0][1] * p[1] + axis[0][2] * p[2]) * w);
	store((float *)cell(t->v[r], c),
		(axis[1][0] * p[0] + axis[1][1] * p[1] + axis[1][2] * p[2]) * w);
	store((float *)cell(t->w[r], c), w);
	store((float *)cell(t->range[r], c), where(good, range));
}

static inline void place_segments(tile *t, const struct tile_job *job, int y)
{
	float buffer[WIDTH];
	copy_row(job, y, (const float *)job->options->segment, buffer);
	for (int x = 0; x < t->width; x++)
		memcpy(&t->segment[kept(y)][x & 1][(MARGIN + x) >> 1], &buffer[x],
			sizeof buffer[x]);
}

INLINE float total(vf x)
{
	float sum = 0;
	for (int k = 0; k < LANES; k++)
		sum += x[k];
	return sum;
}

INLINE void place_row(tile *t, const struct tile_job *job, int y)
{
	const range_grid *g = job->grid;
	float buffer[4][WIDTH];
	const float *line[4] = { find_row(job, y, g->x_m, buffer[0]),
		find_row(job, y, g->y_m, buffer[1]), find_row(job, y, g->z_m, buffer[2]),
		find_row(job, y, g->range_m, buffer[3]) };
	const unsigned r = kept(y);
	const size_t ahead = line[0] == buffer[0] ? 0 : ROWS_AHEAD * (size_t)g->columns;
	vf up = { 0 }, away = { 0 };
	if (t->has_segments)
		place_segments(t, job, y);
	for (int x = 0; x < t->width; x += GROUP) {
		vf even[4], odd[4];
		for (int k = 0; k < 4; k++) {
			__builtin_prefetch(line[k] + x + ahead);
			vf a = load(line[k] + x), b = load(line[k] + x + LANES);
			even[k] = evens(a, b);
			odd[k] = odds(a, b);
		}
		place_cells(t, r, MARGIN + x, even);
		up += magnitude(even[2]);
		away += even[3];
		place_cells(t, r, MARGIN + x + 1, odd);
	}
	for (int odd = 0; odd < 2; odd++) {
		store((float *)cell(t->w[r], MARGIN + t->width + odd), (vf){ 0 });
		store((float *)cell(t->range[r], MARGIN + t->width + odd), (vf){ 0 });
	}
	/* Half of the cells tell it well enough; beams of a row go up alike. */
	float slope = total(up) / fmaxf(total(away), 1e-9f);
	t->level[r] = __builtin_sqrtf(fmaxf(1 - slope * slope, 1e-6f));
	t->beam_rad[r] = __builtin_sqrtf((float)(g->column_rad * g->row_rad) * t->level[r]);
}

/* ---- links ---- */

/* Four cells in a line, a b c d: b and c are side by side, a is two before b, d two behind c. */
struct line {
	const float *w[4], *at[4]; /* inverse depth, direction along the line */
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
	vf b = load(l->w[1]), c = load(l->w[2]), product = b * c, difference = magnitude(c - b);
	vi there = product > 0;
	vi gentle = difference < 5 * noise_m * product + 0.5f * step_rad * (b + c);
	if (!any(there & ~gentle)) /* mostly; of two that are not there, none is less */
		return gentle;
	vf noise = noise_m * product, size = step_rad * most(b, c);
	vf a = load(l->w[0]), d = load(l->w[3]), at = load(l->at[1]), step = load(l->at[2]) - at;
	vi before = (a > 0) & is_foretold(b, a, at - load(l->at[0]), step, c, noise);
	vi after = (d > 0) & is_foretold(c, d, load(l->at[2]) - load(l->at[3]), -step, b, noise);
	vi steep = difference > 5 * noise + 12 * size;
	return there & (gentle | (before & after) | ((before | after) & ~steep));
}

INLINE vi same_segment(const tile *t, int y, int c, int down, int right)
{
	vi a = (vi)load(cell(t->segment[kept(y)], c));
	vi b = (vi)load(cell(t->segment[kept(y + down)], c + right));
	return (a == 0) | (b == 0) | (a == b);
}

INLINE vi link_right(const tile *t, int y, int c, const struct tile_job *job)
{
	struct line l;
	static const int at[4] = { -2, 0, 1, 3 };
	for (int k = 0; k < 4; k++) {
		l.w[k] = cell(t->w[kept(y)], c + at[k]);
		l.at[k] = cell(t->u[kept(y)], c + at[k]);
	}
	vi linked = is_linked(
		&l, job->options->range_noise_m, (float)job->grid->column_rad * t->level[kept(y)]);
	return t->has_segments ? linked & same_segment(t, y, c, 0, 1) : linked;
}

INLINE vi link_down(const tile *t, int y, int c, const struct tile_job *job)
{
	struct line l;
	static const int at[4] = { -2, 0, 1, 3 };
	for (int k = 0; k < 4; k++) {
		l.w[k] = cell(t->w[kept(y + at[k])], c);
		l.at[k] = cell(t->v[kept(y + at[k])], c);
	}
	vi linked = is_linked(&l, job->options->range_noise_m, (float)job->grid->row_rad);
	return t->has_segments ? linked & same_segment(t, y, c, 1, 0) : linked;
}

/* Of rows y and y + 1. */
INLINE void make_quads(tile *t, int y)
{
	const unsigned a = kept(y), b = kept(y + 1);
	struct quads *q = &t->quads[a / 2];
	for (int i = MARGIN / 2; i < (MARGIN + t->width) / 2; i += LANES) {
		vf here = load(&t->w[a][0][i]);
		vf u[4] = { load(&t->u[a][0][i]), load(&t->u[a][1][i]), load(&t->u[b][0][i]),
			load(&t->u[b][1][i]) };
		vf v[4] = { load(&t->v[a][0][i]), load(&t->v[a][1][i]), load(&t->v[b][0][i]),
			load(&t->v[b][1][i]) };
		vf w[4] = { { 0 }, load(&t->w[a][1][i]) - here, load(&t->w[b][0][i]) - here,
			load(&t->w[b][1][i]) - here };
		store(q->u + i, u[0] + u[1] + (u[2] + u[3]));
		store(q->v + i, v[0] + v[1] + (v[2] + v[3]));
		store(q->w + i, w[1] + (w[2] + w[3]));
		store(q->uu + i, u[0] * u[0] + u[1] * u[1] + (u[2] * u[2] + u[3] * u[3]));
		store(q->uv + i, u[0] * v[0] + u[1] * v[1] + (u[2] * v[2] + u[3] * v[3]));
		store(q->vv + i, v[0] * v[0] + v[1] * v[1] + (v[2] * v[2] + v[3] * v[3]));
		store(q->uw + i, u[1] * w[1] + u[2] * w[2] + u[3] * w[3]);
		store(q->vw + i, v[1] * w[1] + v[2] * w[2] + v[3] * w[3]);
		store(q->ww + i, w[1] * w[1] + w[2] * w[2] + w[3] * w[3]);
		vi within = load_mask(&t->right[a][0][i]) & load_mask(&t->right[b][0][i]);
		store_mask(q->from_right + i,
			within & load_mask(&t->right[a][1][i]) & load_mask(&t->right[b][1][i]));
		store_mask(q->from_left + i, within & load_mask(&t->right[a][1][i - 1]) &
						     load_mask(&t->right[b][1][i - 1]));
	}
}

/* Of rows y and y + 1: three of the four links around hold. */
INLINE void mark_blocks(tile *t, int y)
{
	const unsigned a = kept(y), b = kept(y + 1);
	for (int i = (MARGIN + TILE_REACH) / 2; i < (MARGIN + t->width - TILE_REACH) / 2;
		i += LANES) {
		vi above = load_mask(&t->right[a][0][i]), below = load_mask(&t->right[b][0][i]),
		   left = load_mask(&t->down[a][0][i]), right = load_mask(&t->down[a][1][i]);
		store_mask(t->quads[a / 2].block + i,
			(above & below & (left | right)) | (left & right & (above | below)));
	}
}

/* Row y comes in: its cells, the links along it, and those down from the row that is far enough before it. */
INLINE void take_row(tile *t, const struct tile_job *job, int y)
{
	const int from = MARGIN, to = MARGIN + t->width, above = y - LINK_REACH;
	if (y < 0 || y >= t->height) {
		memset(t->w[kept(y)], 0, sizeof t->w[0]);
		memset(t->range[kept(y)], 0, sizeof t->range[0]);
		memset(t->right[kept(y)], 0, sizeof t->right[0]);
	} else {
		place_row(t, job, y);
		for (int c = from; c < to; c += GROUP)
			for (int odd = 0; odd < 2; odd++)
				store_mask(&t->right[kept(y)][odd][c >> 1],
					link_right(t, y, c + odd, job));
		t->right[kept(y)][1][(to - 1) >> 1] = 0;
	}
	for (int c = from + TILE_REACH; above >= 0 && c < to - TILE_REACH; c += GROUP)
		for (int odd = 0; odd < 2; odd++)
			store_mask(&t->down[kept(above)][odd][c >> 1],
				link_down(t, above, c + odd, job));
	if (y % 2 != 0 && y > 0) {
		make_quads(t, y - 1);
		if (above >= 0)
			mark_blocks(t, above);
	}
}

#endif
