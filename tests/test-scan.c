/* Whole scans against the simulator's truth: where the beams went, what they measured, what is
 * called measured. */
#include "sim/truth.h"
#include "tests/simulated.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define DEGREE (G_PI / 180)

/* ---- the truth of every beam that was sent ---- */

struct beam {
	double azimuth_rad;
	float elevation_rad, range_m;
	bool even; /* the beams before and after it go on as a plane does */
};

struct beams {
	GArray *rows; /* of GArray of struct beam, by row of the panorama */
	struct panorama_desc desc;
	double column_rad, row_rad;
	double row_slack; /* of a device that rounds its angles: near an edge a beam may have come into
			     the row beside */
};

static void beams_init(struct beams *b, const struct preset *preset)
{
	b->desc = panorama_desc_for(preset->columns, preset->rows);
	b->column_rad = 2 * G_PI / b->desc.columns;
	b->row_rad = (b->desc.elevation_max_rad - b->desc.elevation_min_rad) / b->desc.rows;
	b->rows = g_array_new(FALSE, FALSE, sizeof(GArray *));
	for (uint32_t i = 0; i < b->desc.rows; i++) {
		GArray *row = g_array_new(FALSE, FALSE, sizeof(struct beam));
		g_array_append_val(b->rows, row);
	}
}

static void beams_clear(struct beams *b)
{
	for (uint32_t i = 0; i < b->desc.rows; i++)
		g_array_unref(g_array_index(b->rows, GArray *, i));
	g_array_unref(b->rows);
}

/* Second differences of range along the sweep: small on planes, also slanted ones; leaves and edges
 * are neither. */
static bool is_even(const struct sim_truth_revolution *r, uint32_t i)
{
	if (i == 0 || i + 1 >= r->beams || r->range_m[i - 1] == 0 || r->range_m[i + 1] == 0)
		return false;
	double bend = r->range_m[i - 1] - 2 * r->range_m[i] + r->range_m[i + 1];
	return r->range_m[i] > 0 && fabs(bend) < 0.01 + 0.002 * r->range_m[i];
}

static void keep_in_row(struct beams *b, double row, const struct beam *beam)
{
	if (row >= 0 && row < b->desc.rows)
		g_array_append_vals(g_array_index(b->rows, GArray *, (int)row), beam, 1);
}

/* In front of the zenith and the nadir, or behind. */
static void keep_truth(const struct sim_truth_revolution *r, gpointer user_data)
{
	struct beams *b = user_data;
	for (uint32_t i = 0; i < r->beams; i++) {
		double theta = remainder(r->theta_rad[i], 2 * G_PI);
		bool front = fabs(theta) <= 90 * DEGREE;
		struct beam beam = { .azimuth_rad =
					     fmod(r->azimuth_rad[i] + (front ? 0 : G_PI), 2 * G_PI),
			.elevation_rad = (float)(front ? theta : remainder(G_PI - theta, 2 * G_PI)),
			.range_m = (float)r->range_m[i],
			.even = is_even(r, i) };
		double row = (b->desc.elevation_max_rad - (double)beam.elevation_rad) / b->row_rad;
		keep_in_row(b, floor(row - b->row_slack), &beam);
		if (floor(row + b->row_slack) > floor(row - b->row_slack))
			keep_in_row(b, floor(row + b->row_slack), &beam);
	}
}

static int by_azimuth(const void *a, const void *b)
{
	double d = ((const struct beam *)a)->azimuth_rad - ((const struct beam *)b)->azimuth_rad;
	return (d > 0) - (d < 0);
}

static int by_value(const void *a, const void *b)
{
	double d = *(const double *)a - *(const double *)b;
	return (d > 0) - (d < 0);
}

/* ---- the comparison ---- */

#define MET_MAX    64 /* beams in a cell, where the stage runs up; two or four elsewhere */
#define CHOOSE_MAX 8
/* As near as this a choice of beams lies where the point is. Two of four may lie where all four do. */
#define THERE 0.008

struct comparison {
	size_t measured, unmatched; /* cells called measured; of them without a beam within a tenth
				       of a column */
	double azimuth_worst_columns;
	double azimuth_bias_columns;
	size_t smooth;
	double bias_mm;
	/* Of the points that are one beam, and of those that are the mean of two, and so on. */
	size_t of_beams[CHOOSE_MAX + 1];
	double sigma_mm[CHOOSE_MAX + 1];
};

/* What a cell holds: one beam, or the mean of some of those that met it. */
struct match {
	uint32_t beams;
	double azimuth_rad, elevation_rad, range_m;
	double away; /* of the directions, in cells */
	bool even;
};

static size_t first_from(const GArray *row, double azimuth_rad)
{
	const struct beam *beams = (const struct beam *)(const void *)row->data;
	size_t low = 0, high = row->len;
	while (low < high) {
		size_t middle = (low + high) / 2;
		if (beams[middle].azimuth_rad < azimuth_rad)
			low = middle + 1;
		else
			high = middle;
	}
	return low;
}

/* The beams that met the cell, or may have: a tenth of a column beside it. */
static uint32_t find_met(
	const GArray *row, const panorama *p, uint32_t column, const struct beam *ret_met[MET_MAX])
{
	uint32_t count = 0;
	double from = (column - 0.1) * p->column_rad, to = (column + 1.1) * p->column_rad;
	for (int turn = -1; turn <= 1; turn++)
		for (size_t i = first_from(row, from + turn * 2 * G_PI);
			i < row->len && count < MET_MAX; i++) {
			const struct beam *b = &g_array_index(row, struct beam, i);
			if (b->azimuth_rad >= to + turn * 2 * G_PI)
				break;
			ret_met[count++] = b;
		}
	return count;
}

static struct match mean_of(const struct beam *const met[], uint32_t chosen)
{
	struct match m = { .even = true };
	double across = 0, up = 0, inverse = 0;
	for (uint32_t k = 0; k < CHOOSE_MAX; k++) {
		if (!(chosen >> k & 1))
			continue;
		double turn =
			remainder(met[k]->azimuth_rad - (m.beams ? m.azimuth_rad : 0), 2 * G_PI);
		m.azimuth_rad = m.beams ? m.azimuth_rad : met[k]->azimuth_rad;
		across += m.beams ? turn : 0;
		m.beams++;
		up += (double)met[k]->elevation_rad;
		inverse += 1 / (double)met[k]->range_m;
		m.even &= met[k]->even;
	}
	m.azimuth_rad += across / m.beams;
	m.elevation_rad = up / m.beams;
	m.range_m = m.beams / inverse;
	return m;
}

/* Of many beams, where the stage ran up: it lies among them. */
static struct match lie_among(const struct beam *const met[], uint32_t count, const panorama *p,
	uint32_t r, uint32_t column)
{
	double azimuth = panorama_azimuth_rad(p, r, column),
	       up = panorama_elevation_rad(p, r, column), least[2] = { 0 }, most[2] = { 0 };
	for (uint32_t k = 0; k < count; k++) {
		double off[2] = { remainder(met[k]->azimuth_rad - azimuth, 2 * G_PI) /
					  p->column_rad,
			((double)met[k]->elevation_rad - up) / p->row_rad };
		for (int i = 0; i < 2; i++) {
			least[i] = k ? fmin(least[i], off[i]) : off[i];
			most[i] = k ? fmax(most[i], off[i]) : off[i];
		}
	}
	return (struct match){ count, azimuth, up, 0,
		fmax(fmax(least[0], -most[0]), fmax(least[1], -most[1])), false };
}

static void match_better(
	const panorama *p, uint32_t r, uint32_t column, struct match m, struct match *best)
{
	double across = remainder(panorama_azimuth_rad(p, r, column) - m.azimuth_rad, 2 * G_PI),
	       up = panorama_elevation_rad(p, r, column) - m.elevation_rad;
	m.away = hypot(across / p->column_rad, up / p->row_rad);
	bool both_there = m.away < THERE && best->away < THERE;
	if (both_there ? m.beams > best->beams : m.away < best->away)
		*best = m;
}

/* The beam, or the mean of some beams, that lies where the cell says that its point is. */
static struct match find_match(const GArray *row, const panorama *p, uint32_t r, uint32_t column)
{
	const struct beam *met[MET_MAX];
	uint32_t count = find_met(row, p, column, met);
	struct match best = { .away = INFINITY };
	if (count > CHOOSE_MAX)
		return lie_among(met, count, p, r, column);
	for (uint32_t chosen = 1; chosen < 1u << count; chosen++)
		match_better(p, r, column, mean_of(met, chosen), &best);
	return best;
}

/* Where a surface goes on evenly: no edge within two cells, so that no beam saw two things. */
static bool is_smooth(const panorama *p, uint32_t row, uint32_t column)
{
	if (row < 2 || row + 2 >= p->desc.rows)
		return false;
	double here = p->range_m[panorama_index(p, row, column)];
	for (int dr = -2; dr <= 2; dr++)
		for (int dc = -2; dc <= 2; dc++) {
			uint32_t c = (column + p->desc.columns + dc) % p->desc.columns;
			size_t i = panorama_index(p, row + dr, c);
			if (p->cell[i] == CELL_NO_RETURN ||
				fabs(p->range_m[i] - here) > 0.15 + 0.02 * here)
				return false;
		}
	return true;
}

/* The spread of the middle two thirds, which a stray mixed pixel cannot touch. */
static double spread_of(GArray *off)
{
	g_array_sort(off, by_value);
	return off->len ? (g_array_index(off, double, (guint)(0.8413 * off->len)) -
				  g_array_index(off, double, (guint)(0.1587 * off->len))) /
				  2
			: 0;
}

static void compare_cell(const panorama *p, const GArray *beams, uint32_t row, uint32_t column,
	struct comparison *c, GArray *const off[])
{
	struct match m = find_match(beams, p, row, column);
	c->measured++;
	c->unmatched += !(m.away <= 0.1);
	if (!(m.away <= 0.1))
		return;
	double away = remainder(panorama_azimuth_rad(p, row, column) - m.azimuth_rad, 2 * G_PI) /
		      p->column_rad;
	c->azimuth_worst_columns = fmax(c->azimuth_worst_columns, fabs(away));
	c->azimuth_bias_columns += away;
	if (!m.even || !is_smooth(p, row, column))
		return;
	double error_mm = 1000.0 * ((double)p->range_m[panorama_index(p, row, column)] - m.range_m);
	c->smooth++;
	c->bias_mm += error_mm;
	g_array_append_val(off[m.beams], error_mm);
}

static struct comparison compare(const panorama *p, const struct beams *b)
{
	struct comparison c = { 0 };
	GArray *off[CHOOSE_MAX + 1];
	for (uint32_t k = 0; k <= CHOOSE_MAX; k++)
		off[k] = g_array_new(FALSE, FALSE, sizeof(double));
	for (uint32_t i = 0; i < b->desc.rows; i++)
		g_array_sort(g_array_index(b->rows, GArray *, i), by_azimuth);
	for (uint32_t row = 0; row < p->desc.rows; row++)
		for (uint32_t column = 0; column < p->desc.columns; column++)
			if (p->cell[panorama_index(p, row, column)] == CELL_MEASURED)
				compare_cell(p, g_array_index(b->rows, GArray *, row), row, column,
					&c, off);
	c.azimuth_bias_columns /= c.measured;
	c.bias_mm /= c.smooth;
	for (uint32_t k = 0; k <= CHOOSE_MAX; k++) {
		c.of_beams[k] = off[k]->len;
		c.sigma_mm[k] = spread_of(off[k]);
		g_array_unref(off[k]);
	}
	return c;
}

static const struct round_trip {
	const char *path, *description, *preset;
	double noise_mm;
	uint32_t beams;   /* that most cells are the mean of; 0: of very many */
	double unmatched; /* at most so many, where a beam's angle depends on its rounded range */
} round_trips[] = {
	{ "/scan/round-trip/court-fast-clock",
		"court?seed=11&station=2&camera=none&drift_ppm=200&ares=1584", "standard", 12, 1 },
	{ "/scan/round-trip/hall-slow-clock",
		"hall?seed=4&station=1&camera=none&drift_ppm=-200&ares=1584", "standard", 12, 1 },
	{ "/scan/round-trip/street-noise-3",
		"street?seed=5&station=3&camera=none&drift_ppm=90&noise_mm=3&ares=792", "draft", 3,
		1 },
	{ "/scan/round-trip/bridge-cola",
		"bridge?seed=2&station=2&camera=none&drift_ppm=200&lidar=cola", "standard", 12, 1 },
	{ "/scan/round-trip/court-wraps",
		"court?seed=11&camera=none&clock_start=16776000&stage_clock_start=4294000000&ares="
		"792",
		"draft", 12, 1 },
	{ "/scan/round-trip/two-beams-a-cell", "street?seed=6&camera=none", "standard", 12, 2 },
	{ "/scan/round-trip/four-beams-a-cell", "court?seed=12&camera=none", "draft", 12, 4 },
	{ "/scan/round-trip/ld06", "court?seed=11&camera=none&lidar=ld06&drift_ppm=60", "draft", 12,
		1 },
	{ "/scan/round-trip/stl27l", "hall?seed=4&camera=none&lidar=stl27l", "draft", 12, 0 },
	{ "/scan/round-trip/rplidar-standard",
		"hall?seed=4&camera=none&lidar=rplidar-a1&format=standard&rate_hz=5", "draft", 12,
		1 },
	{ "/scan/round-trip/rplidar-express", "hall?seed=4&camera=none&lidar=rplidar-a2", "draft",
		12, 1 },
	{ "/scan/round-trip/rplidar-ultra", "hall?seed=4&camera=none&lidar=rplidar-a3", "draft", 12,
		0, 0.001 },
	{ "/scan/round-trip/rplidar-dense", "court?seed=11&camera=none&lidar=rplidar-s2", "draft",
		12, 0 },
	{ "/scan/round-trip/rplidar-ultra-dense", "hall?seed=4&camera=none&lidar=rplidar-s3",
		"draft", 12, 0 },
	{ "/scan/round-trip/rplidar-hq", "hall?seed=4&camera=none&lidar=rplidar-s2&format=hq",
		"draft", 12, 0 },
	{ "/scan/round-trip/jitter", "hall?seed=4&camera=none&jitter_ms=3&drift_ppm=150&ares=792",
		"draft", 12, 1 },
};

static void test_round_trip(gconstpointer data)
{
	const struct round_trip *t = data;
	struct beams beams;
	struct scan_result result;
	uint32_t partial;
	g_autoptr(GError) error = NULL;
	g_autofree char *folder = simulated_folder(),
			*path = g_build_filename(folder, "site", NULL);
	struct scan_options options = { .preset = preset_find(t->preset) };
	beams_init(&beams, options.preset);
	beams.row_slack = strstr(t->description, "lidar=ld") ||
					  strstr(t->description, "lidar=stl") ||
					  strstr(t->description, "lidar=rplidar")
				  ? 0.05
				  : 0;
	bool good = simulated_scan(
		path, t->description, &options, keep_truth, &beams, &result, &partial, &error);
	g_assert_no_error(error);
	g_assert_true(good);
	g_autoptr(site) s = site_open(path, &error);
	g_autoptr(panorama) p = scan_load(s, result.number, true, &error);
	g_assert_no_error(error);
	struct comparison c = compare(p, &beams);
	g_test_message("%zu measured, %zu unmatched, azimuth worst %.3f bias %+.4f columns; %zu "
		       "smooth: bias %+.3f mm, drift %.1f ppm",
		c.measured, c.unmatched, c.azimuth_worst_columns, c.azimuth_bias_columns, c.smooth,
		c.bias_mm, result.report.drift_ppm);
	g_assert_cmpuint(result.missing_columns, ==, 0);
	g_assert_cmpuint(result.report.lost_revolutions, ==, 0);
	g_assert_cmpuint(c.measured, >, 1000);
	/* No cell is called measured without a beam there. */
	g_assert_cmpfloat((double)c.unmatched, <=, t->unmatched * (double)c.measured);
	g_assert_cmpfloat(c.azimuth_worst_columns, <=, 0.1);
	g_assert_cmpfloat(fabs(c.azimuth_bias_columns), <=, 0.015);
	g_assert_cmpfloat(fabs(c.bias_mm), <=, 1.0);
	/* Means are that much better. */
	for (uint32_t k = 1; k <= CHOOSE_MAX && t->beams; k++) {
		g_assert_cmpuint(c.of_beams[k], <=, c.of_beams[t->beams]);
		if (c.of_beams[k] < 12000)
			continue;
		g_test_message("of %u beams: %zu, sigma %.3f mm", k, c.of_beams[k], c.sigma_mm[k]);
		/* Of many, another choice of beams may lie nearer where the point is. */
		g_assert_cmpfloat(
			fabs(c.sigma_mm[k] * sqrt(k) / t->noise_mm - 1), <, k == 1 ? 0.05 : 0.10);
	}
	if (t->beams)
		g_assert_cmpuint(c.of_beams[t->beams], >, 12000);
	beams_clear(&beams);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	for (size_t i = 0; i < G_N_ELEMENTS(round_trips); i++)
		g_test_add_data_func(round_trips[i].path, &round_trips[i], test_round_trip);
	return g_test_run();
}
