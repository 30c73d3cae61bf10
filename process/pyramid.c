#include "process/pyramid.h"
#include "process/pyramid-sums.h"

/* Cells of level 0 are at most this wide: finer scans are summed up in blocks. */
#define CELL_MAX_RAD   (0.5 * G_PI / 180)
#define NARROW_MAX_RAD (0.3 * G_PI / 180)
#define BLOCK_MAX      8u
#define FILLED_MIN     0.6
/* Neighbours on one surface: to an incidence of 80 degrees, or within the noise. */
#define SLACK_M 0.05f
#define SLOPE   5.7f
/* Planes met at a smaller slant than this tell little and are widest. */
#define COSINE_MIN  0.08f
#define NOISE_BINS  4096
#define NOISE_BIN_M 5e-5

void pyramid_free(pyramid *p)
{
	if (!p)
		return;
	for (int l = 0; l < PYRAMID_LEVELS; l++)
		g_free(p->level[l].surfel);
	g_free(p);
}

static bool lattice_has(const range_grid *g, uint32_t row, uint32_t column)
{
	const struct range_lattice *l = &g->lattice;
	size_t at = (size_t)row * l->columns + column;
	uint32_t cell = l->cell ? l->cell[at] : (uint32_t)at;
	return cell != RANGE_GRID_NONE && g->range_m[cell] > 0;
}

/* Share of the points that have another one so many cells away; of a sample. */
static double neighbours_share(const range_grid *g, uint32_t across, uint32_t down)
{
	const struct range_lattice *l = &g->lattice;
	size_t points = 0, beside = 0;
	for (uint32_t r = 0; r + down < l->rows; r += 7)
		for (uint32_t c = r % 5; c + across < l->columns; c += 5) {
			if (!lattice_has(g, r, c))
				continue;
			points++;
			beside += lattice_has(g, r + down, c + across);
		}
	return points ? (double)beside / points : 1;
}

/* A grid may be finer than the beams that filled it. Then cells are wide enough to hold one. */
static uint32_t block_for(const range_grid *g, double cell_max_rad, bool across)
{
	double cell_rad = across ? g->lattice.column_rad : g->lattice.row_rad;
	uint32_t block = 1;
	while (block < BLOCK_MAX && 2 * block * cell_rad <= cell_max_rad)
		block *= 2;
	if (block == 1 && neighbours_share(g, across, !across) < FILLED_MIN)
		block = 2;
	return block;
}

/* The fitted planes of a whole level, row by row. */
struct fits {
	float *plane[FIT_PLANES];
};

static struct fits fit_level(const struct sums *s, double cell_rad, bool portable)
{
	struct fits f;
	for (int k = 0; k < FIT_PLANES; k++)
		f.plane[k] = g_new(float, (size_t)s->columns * s->rows);
	for (uint32_t r = 0; r < s->rows; r++) {
		float *row[FIT_PLANES];
		for (int k = 0; k < FIT_PLANES; k++)
			row[k] = f.plane[k] + (size_t)r * s->columns;
		sums_fit_row(s, r, SLACK_M, SLOPE * (float)cell_rad, portable, row);
	}
	return f;
}

static void fits_clear(struct fits *f)
{
	for (int k = 0; k < FIT_PLANES; k++)
		g_free(f->plane[k]);
}

/* Most of what a scanner meets is even at this scale, so the median of the deviations is the noise. */
static double noise_of(const struct fits *f, size_t count)
{
	g_autofree uint32_t *bin = g_new0(uint32_t, NOISE_BINS);
	size_t all = 0, sum = 0;
	for (size_t i = 0; i < count; i++) {
		if (!(f->plane[FIT_COUNT][i] >= 8 && f->plane[FIT_COSINE][i] > 0.3f))
			continue;
		double at = sqrt(f->plane[FIT_VARIANCE][i]) / NOISE_BIN_M;
		bin[(size_t)CLAMP(at, 0, NOISE_BINS - 1)]++;
		all++;
	}
	for (int k = 0; k < NOISE_BINS; k++) {
		sum += bin[k];
		if (all && 2 * sum >= all)
			return (k + 0.5) * NOISE_BIN_M;
	}
	return NOISE_BIN_M;
}

/* What the points deviate from the plane beyond the noise is the surface's own and does not average out. */
static float deviation(float own_count, float count, float variance, float cosine, float noise2)
{
	float sure = noise2 * (1 + 2 * sqrtf(2 / fmaxf(count - 3, 1)));
	float uneven = fmaxf(variance - sure, 0);
	return cosine * sqrtf(noise2 / own_count + uneven);
}

static void pack_level(
	const struct sums *s, const struct fits *f, double noise_m, struct pyramid_level *ret)
{
	float noise2 = (float)(noise_m * noise_m);
	ret->columns = s->columns;
	ret->rows = s->rows;
	ret->surfel = g_new(struct surfel, (size_t)s->columns * s->rows);
	for (uint32_t r = 0; r < s->rows; r++)
		for (uint32_t c = 0; c < s->columns; c++) {
			size_t i = (size_t)r * s->columns + c;
			float *const *p = f->plane;
			size_t at = sums_at(s, r, c);
			bool good = p[FIT_COUNT][i] > 0 && p[FIT_COSINE][i] > COSINE_MIN;
			ret->surfel[i] = (struct surfel){
				.point_m = { s->plane[SUM_X][at], s->plane[SUM_Y][at],
					s->plane[SUM_Z][at] },
				.normal = { p[FIT_NX][i], p[FIT_NY][i], p[FIT_NZ][i] },
				.sigma_m =
					good ? deviation(s->plane[SUM_COUNT][at], p[FIT_COUNT][i],
						       p[FIT_VARIANCE][i], p[FIT_COSINE][i], noise2)
					     : 0,
				.range_m = s->plane[SUM_RANGE][at],
			};
		}
}

static void make_level(pyramid *p, int level, const struct sums *s, bool portable)
{
	double cell_rad = fmax(p->column_rad, p->row_rad) * (1 << level);
	struct fits fits = fit_level(s, cell_rad, portable);
	if (level == 0)
		p->noise_m = noise_of(&fits, (size_t)s->columns * s->rows);
	pack_level(s, &fits, p->noise_m, &p->level[level]);
	fits_clear(&fits);
}

static pyramid *make(const range_grid *g, double cell_max_rad, bool portable)
{
	const struct range_lattice *l = &g->lattice;
	pyramid *p = g_new0(pyramid, 1);
	uint32_t across = block_for(g, cell_max_rad, true),
		 down = block_for(g, cell_max_rad, false);
	p->column_rad = l->column_rad * across;
	p->row_rad = l->row_rad * down;
	p->azimuth_min_rad = l->azimuth_min_rad;
	p->elevation_max_rad = l->elevation_max_rad;
	p->wraps = l->wraps;
	struct sums sums;
	sums_of_grid(g, across, down, portable, &sums);
	for (int level = 0; level < PYRAMID_LEVELS; level++) {
		make_level(p, level, &sums, portable);
		if (level + 1 < PYRAMID_LEVELS) {
			struct sums above;
			sums_of_level_below(&sums, p->wraps, &above);
			sums_clear(&sums);
			sums = above;
		}
	}
	sums_clear(&sums);
	return p;
}

pyramid *pyramid_new(const range_grid *g)
{
	return make(g, CELL_MAX_RAD, false);
}

pyramid *pyramid_new_portable(const range_grid *g)
{
	return make(g, CELL_MAX_RAD, true);
}

pyramid *pyramid_new_narrow(const range_grid *g)
{
	return make(g, NARROW_MAX_RAD, false);
}
