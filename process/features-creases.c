#include "process/features-private.h"
#include "process/model.h"
#include <string.h>

/* Windows on either side begin so many cells away, at most. */
#define REACH_MOST 12
/* Answers from this share of the way between them: the sine of the angle of a crease, times a half for the edge filter. */
#define CREASE_LEAST 0.13f
/* And this often what the planes' tilts are uncertain by. */
#define CREASE_SIGMAS 4.0f
#define ANSWER_MOST   8.0f
#define RIDGE_LEAST   0.2f /* answers to less are nothing */
/* The sine of the angle of planes that cut each other in a line that is known well. */
#define CUT_LEAST 0.3f
/* That line is not further off than this share of how far the planes are apart. */
#define MOVED_MOST 0.5f

/* ---- how far it is to the next depth edge ---- */

#define FAR_AWAY (REACH_MOST + 1)

/* Cells along the row, up to FAR_AWAY. */
static void measure_row(
	const range_grid *g, const uint8_t *flags, uint32_t row, uint8_t *restrict distance)
{
	const int32_t width = (int32_t)g->columns, before = g->wraps ? MIN(FAR_AWAY, width) : 0;
	const size_t from = (size_t)row * g->columns;
	for (int32_t c = 0; c < width; c++)
		distance[c] = !(g->range_m[from + (size_t)c] > 0) ||
					      (flags[from + (size_t)c] &
						      (FEATURE_SILHOUETTE | FEATURE_BEHIND))
				      ? 0
				      : FAR_AWAY;
	for (int32_t n = -before, last = FAR_AWAY; n < width; n++) {
		uint8_t *d = distance + (n < 0 ? n + width : n);
		last = *d = (uint8_t)MIN(*d, last + 1);
	}
	for (int32_t n = width - 1 + before, last = FAR_AWAY; n >= 0; n--) {
		uint8_t *d = distance + (n >= width ? n - width : n);
		last = *d = (uint8_t)MIN(*d, last + 1);
	}
}

/* Cells, up to FAR_AWAY, the longer way along a row or a column counts. */
static void measure_distance(const struct features_input *of, const struct features_options *o,
	const uint8_t *flags, uint8_t *distance)
{
	const range_grid *g = of->grid;
	const int32_t rows = (int32_t)g->rows;
	const size_t width = g->columns;
	g_autofree uint8_t *along = g_malloc(range_grid_cells(g) + 1);
#pragma omp parallel for schedule(static) if (!o->single_thread)
	for (int32_t row = 0; row < rows; row++)
		measure_row(g, flags, (uint32_t)row, along + (size_t)row * width);
#pragma omp parallel for schedule(static) if (!o->single_thread)
	for (int32_t row = 0; row < rows; row++) {
		uint8_t *restrict ret = distance + (size_t)row * width;
		memcpy(ret, along + (size_t)row * width, width);
		for (int32_t r = MAX(row - REACH_MOST, 0); r <= MIN(row + REACH_MOST, rows - 1);
			r++) {
			const uint8_t *restrict there = along + (size_t)r * width,
						away = (uint8_t)abs(r - row);
			for (size_t c = 0; c < width; c++) {
				uint8_t d = MAX(there[c], away);
				ret[c] = MIN(ret[c], d);
			}
		}
	}
}

/* ---- the error of the planes on both sides ---- */

struct creases {
	const struct features_input *of;
	const struct feature_planes *planes;
	const struct features_options *options;
	const uint8_t *distance;
	float *meets; /* the ray of each cell meets its plane so many times as far away as its point; 0: nowhere */
	float *tilt2; /* square of 1 sigma of the plane's tilt */
	float *error; /* of the planes on both sides, over the distance in between: the sine of their angle */
	uint8_t *reach; /* cells to either side */
	float *ridge;   /* the filter's answer */
	float *best;    /* of all ways so far, sharpened */
};

static const int8_t ways[4][2] = { { 0, 1 }, { 1, 0 }, { 1, 1 }, { 1, -1 } };

static inline float dot_at(const struct feature_planes *p, size_t i, const float v[3])
{
	return p->normal[0][i] * v[0] + p->normal[1][i] * v[1] + p->normal[2][i] * v[2];
}

static float meets_at(const struct creases *c, size_t i)
{
	const range_grid *g = c->of->grid;
	const float at[3] = { g->x_m[i], g->y_m[i], g->z_m[i] }, ahead = dot_at(c->planes, i, at);
	const float offset_m = fabsf(c->planes->offset_m[i]);
	return offset_m > 0 && ahead < 0 ? -offset_m / ahead : 0;
}

/* Of a plane of that many cells. */
static float tilt2_of(const struct creases *c, size_t i)
{
	const range_grid *g = c->of->grid;
	const float spacing_m = g->range_m[i] * (float)sqrt(g->row_rad * g->column_rad);
	const float cosine = fminf(fabsf(c->planes->offset_m[i]) / g->range_m[i], 1);
	const float cells = fmaxf(c->planes->count[i], 4);
	const float noise_m = feature_range_noise_m(c->options, g->range_m[i]);
	const float tilt = 3.5f * noise_m * cosine / (cells * spacing_m);
	return tilt * tilt * cosine;
}

/* The point on the plane of the cell, on its own ray. */
static inline bool point_on(const struct creases *c, size_t i, float ret[3])
{
	const range_grid *g = c->of->grid;
	const float meets = c->meets[i];
	ret[0] = meets * g->x_m[i];
	ret[1] = meets * g->y_m[i];
	ret[2] = meets * g->z_m[i];
	return meets > 0;
}

/* Half the width of the windows in metres, as normals.c has it. */
static float window_m(const range_grid *g, const struct features_options *o, float range_m)
{
	return fmaxf(o->radius_m, sqrtf(62 * o->range_noise_m * range_m * (float)g->row_rad));
}

/* How many cells that is, one way. */
static int reach_of(
	const struct creases *c, size_t i, uint32_t row, uint32_t column, const int8_t way[2])
{
	const range_grid *g = c->of->grid;
	float away_m = 0;
	size_t a, b;
	if (range_grid_step(g, row, column, way[0], way[1], &a) &&
		range_grid_step(g, row, column, -way[0], -way[1], &b)) {
		float pa[3], pb[3];
		if (point_on(c, a, pa) && point_on(c, b, pb))
			away_m = 0.5f * sqrtf((pa[0] - pb[0]) * (pa[0] - pb[0]) +
						(pa[1] - pb[1]) * (pa[1] - pb[1]) +
						(pa[2] - pb[2]) * (pa[2] - pb[2]));
	}
	away_m = fmaxf(away_m, 0.7f * g->range_m[i] * (float)g->row_rad);
	float cells = window_m(g, c->options, g->range_m[i]) / away_m;
	return MIN(MAX((int)lrintf(cells), 3), MIN(REACH_MOST, (int)c->distance[i]));
}

static void measure_error(
	const struct creases *c, uint32_t row, uint32_t column, const int8_t way[2])
{
	const range_grid *g = c->of->grid;
	size_t i = (size_t)row * g->columns + column, a, b;
	float pa[3], pb[3];
	c->error[i] = 0;
	c->reach[i] = 0;
	if (!(g->range_m[i] > 0) || c->distance[i] < 2)
		return;
	int reach = reach_of(c, i, row, column, way);
	c->reach[i] = (uint8_t)reach;
	if (!range_grid_step(g, row, column, way[0] * reach, way[1] * reach, &a) ||
		!range_grid_step(g, row, column, -way[0] * reach, -way[1] * reach, &b) ||
		!point_on(c, a, pa) || !point_on(c, b, pb))
		return;
	float between[3] = { pa[0] - pb[0], pa[1] - pb[1], pa[2] - pb[2] };
	float away2_m2 =
		between[0] * between[0] + between[1] * between[1] + between[2] * between[2];
	float off_m = 0.5f *
		      (fabsf(dot_at(c->planes, a, between)) + fabsf(dot_at(c->planes, b, between)));
	float tilt = CREASE_SIGMAS * sqrtf(c->tilt2[a] + c->tilt2[b]);
	c->error[i] = 2 * off_m / sqrtf(fmaxf(away2_m2, 1e-12f)) / fmaxf(CREASE_LEAST, tilt);
}

/* ---- the edge filter ---- */

/* A ridge is higher than what is half the way to either side: not so an even bend. */
static float ridge_at(const struct creases *c, uint32_t row, uint32_t column, const int8_t way[2])
{
	const range_grid *g = c->of->grid;
	size_t i = (size_t)row * g->columns + column, k;
	int half = MAX((2 * c->reach[i] + 2) / 3, 1);
	float beside = 0;
	for (int side = -1; side <= 1; side += 2) {
		bool known = range_grid_step(g, row, column, side * way[0] * half,
				     side * way[1] * half, &k) &&
			     c->reach[k];
		beside += known ? c->error[k]
				: c->error[i]; /* beside a depth edge it is not known to end */
	}
	return c->error[i] - 0.5f * beside;
}

/* Beside its top a ridge counts for less: an edge is where it is highest. */
static float sharpen(const struct creases *c, uint32_t row, uint32_t column, const int8_t way[2])
{
	const range_grid *g = c->of->grid;
	size_t i = (size_t)row * g->columns + column, k;
	float here = c->ridge[i], most = here;
	for (int n = 1; n <= c->reach[i]; n++)
		for (int side = -n; side <= n; side += 2 * n)
			if (range_grid_step(g, row, column, side * way[0], side * way[1], &k))
				most = fmaxf(most, c->ridge[k]);
	float share = here / most;
	return here * share * share * share * share;
}

/* Where the planes on both sides cut each other; false: nowhere near, or not well. */
static bool cut_at(const struct creases *c, uint32_t row, uint32_t column, const int8_t way[2],
	struct feature_cut *ret)
{
	const range_grid *g = c->of->grid;
	size_t i = (size_t)row * g->columns + column, a, b;
	int reach = reach_of(c, i, row, column, way);
	float pa[3], pb[3], n[2][3], off_m[2] = { 0 }, sine2 = 0, cosine = 0;
	if (!range_grid_step(g, row, column, way[0] * reach, way[1] * reach, &a) ||
		!range_grid_step(g, row, column, -way[0] * reach, -way[1] * reach, &b) ||
		!point_on(c, a, pa) || !point_on(c, b, pb))
		return false;
	const float at[3] = { g->x_m[i], g->y_m[i], g->z_m[i] };
	for (int k = 0; k < 3; k++) {
		n[0][k] = c->planes->normal[k][a];
		n[1][k] = c->planes->normal[k][b];
		off_m[0] += n[0][k] * (at[k] - pa[k]);
		off_m[1] += n[1][k] * (at[k] - pb[k]);
		cosine += n[0][k] * n[1][k];
	}
	for (int k = 0; k < 3; k++) {
		int p = (k + 1) % 3, q = (k + 2) % 3;
		ret->direction[k] = n[0][p] * n[1][q] - n[0][q] * n[1][p];
		sine2 += ret->direction[k] * ret->direction[k];
	}
	if (!(sine2 > CUT_LEAST * CUT_LEAST))
		return false;
	/* The foot of the perpendicular from the cell's own point. */
	float s0 = (off_m[0] - cosine * off_m[1]) / sine2,
	      s1 = (off_m[1] - cosine * off_m[0]) / sine2, moved2 = 0, apart2 = 0;
	for (int k = 0; k < 3; k++) {
		float move = -s0 * n[0][k] - s1 * n[1][k];
		ret->at_m[k] = at[k] + move;
		moved2 += move * move;
		apart2 += (pa[k] - pb[k]) * (pa[k] - pb[k]);
		ret->direction[k] /= sqrtf(sine2);
	}
	ret->cell = (uint32_t)i;
	return moved2 < MOVED_MOST * MOVED_MOST * apart2;
}

/* way_of: of each cell, 1 + that of its highest answer; 0: no crease. */
static GArray *find_cuts(const struct creases *c, const uint8_t *way_of)
{
	GArray *ret = g_array_new(FALSE, FALSE, sizeof(struct feature_cut));
	const range_grid *g = c->of->grid;
#pragma omp parallel for ordered schedule(dynamic) if (!c->options->single_thread)
	for (uint32_t row = 0; row < g->rows; row++) {
		g_autoptr(GArray) of_row = g_array_new(FALSE, FALSE, sizeof(struct feature_cut));
		for (uint32_t column = 0; column < g->columns; column++) {
			uint8_t way = way_of[(size_t)row * g->columns + column];
			struct feature_cut cut;
			if (way && cut_at(c, row, column, ways[way - 1], &cut))
				g_array_append_val(of_row, cut);
		}
#pragma omp ordered
		g_array_append_vals(ret, of_row->data, of_row->len);
	}
	return ret;
}

void feature_creases(const struct features_input *of, const struct feature_planes *p,
	const struct features_options *o, float *answer, uint8_t *flags, GArray **ret_cuts)
{
	const range_grid *g = of->grid;
	size_t cells = range_grid_cells(g);
	g_autofree uint8_t *distance = g_malloc(cells + 1), *reach = g_malloc(cells + 1);
	g_autofree float *error = g_new(float, cells + 1);
	g_autofree float *ridge = g_new(float, cells + 1);
	g_autofree uint8_t *way_of = g_malloc0(cells + 1);
	g_autofree float *best = g_new0(float, cells + 1);
	g_autofree float *meets = g_new(float, cells + 1);
	g_autofree float *tilt2 = g_new(float, cells + 1);
	struct creases c = { of, p, o, distance, meets, tilt2, error, reach, ridge, best };
	measure_distance(of, o, flags, distance);
#pragma omp parallel for schedule(static) if (!o->single_thread)
	for (size_t i = 0; i < cells; i++)
		if (g->range_m[i] > 0) {
			meets[i] = meets_at(&c, i);
			tilt2[i] = tilt2_of(&c, i);
		} else
			meets[i] = tilt2[i] = 0;
	for (int w = 0; w < 4; w++) {
#pragma omp parallel for schedule(dynamic, 8) if (!o->single_thread)
		for (uint32_t row = 0; row < g->rows; row++)
			for (uint32_t column = 0; column < g->columns; column++)
				measure_error(&c, row, column, ways[w]);
#pragma omp parallel for schedule(dynamic, 8) if (!o->single_thread)
		for (uint32_t row = 0; row < g->rows; row++)
			for (uint32_t column = 0; column < g->columns; column++) {
				size_t i = (size_t)row * g->columns + column;
				ridge[i] = error[i] > RIDGE_LEAST
						   ? fmaxf(ridge_at(&c, row, column, ways[w]), 0)
						   : 0;
			}
#pragma omp parallel for schedule(dynamic, 8) if (!o->single_thread)
		for (uint32_t row = 0; row < g->rows; row++)
			for (uint32_t column = 0; column < g->columns; column++) {
				size_t i = (size_t)row * g->columns + column;
				float sharp = ridge[i] > RIDGE_LEAST
						      ? sharpen(&c, row, column, ways[w])
						      : 0;
				if (sharp >= 1)
					flags[i] |= FEATURE_CREASE;
				if (sharp >= 1 && sharp > best[i]) {
					best[i] = sharp;
					way_of[i] = (uint8_t)(w + 1);
				}
				answer[i] = fminf(fmaxf(answer[i], sharp), ANSWER_MOST);
			}
	}
	*ret_cuts = find_cuts(&c, way_of);
}
