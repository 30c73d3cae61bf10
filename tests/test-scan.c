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

/* The simulated sweep is 270 degrees, the first beam 45 degrees below the horizon in front, the
 * last behind. */
static void keep_truth(const struct sim_truth_revolution *r, gpointer user_data)
{
	struct beams *b = user_data;
	for (uint32_t i = 0; i < r->beams; i++) {
		double theta = (-45 + 270.0 * i / (r->beams - 1)) * DEGREE;
		bool front = theta <= 90 * DEGREE;
		struct beam beam = { .azimuth_rad =
					     fmod(r->azimuth_rad[i] + (front ? 0 : G_PI), 2 * G_PI),
			.elevation_rad = (float)(front ? theta : G_PI - theta),
			.range_m = (float)r->range_m[i],
			.even = is_even(r, i) };
		double row = floor((b->desc.elevation_max_rad - beam.elevation_rad) / b->row_rad);
		if (row >= 0 && row < b->desc.rows)
			g_array_append_val(g_array_index(b->rows, GArray *, (int)row), beam);
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

struct comparison {
	size_t measured, unmatched; /* cells called measured; of them without a beam within a tenth
				       of a column */
	double azimuth_worst_columns;
	double azimuth_bias_columns;
	size_t smooth;
	double bias_mm, sigma_mm;
};

/* The beam of the row that is nearest in azimuth, and whether its neighbours see the same surface.
 */
static const struct beam *nearest_beam(
	const GArray *row, double azimuth_rad, double elevation_rad, double row_rad)
{
	const struct beam *beams = (const struct beam *)(const void *)row->data, *best = NULL;
	size_t low = 0, high = row->len;
	if (high == 0)
		return NULL;
	while (low < high) {
		size_t middle = (low + high) / 2;
		if (beams[middle].azimuth_rad < azimuth_rad)
			low = middle + 1;
		else
			high = middle;
	}
	for (int64_t i = (int64_t)low - 8; i < (int64_t)low + 8; i++) {
		const struct beam *b = &beams[((i % row->len) + row->len) % row->len];
		if (fabs(b->elevation_rad - elevation_rad) > 0.1 * row_rad)
			continue;
		if (!best || fabs(remainder(b->azimuth_rad - azimuth_rad, 2 * G_PI)) <
				     fabs(remainder(best->azimuth_rad - azimuth_rad, 2 * G_PI)))
			best = b;
	}
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

static struct comparison compare(const panorama *p, const struct beams *b)
{
	struct comparison c = { 0 };
	double sum = 0;
	g_autoptr(GArray) off = g_array_new(FALSE, FALSE, sizeof(double));
	for (uint32_t i = 0; i < b->desc.rows; i++) {
		GArray *row = g_array_index(b->rows, GArray *, i);
		if (row->len)
			qsort(row->data, row->len, sizeof(struct beam), by_azimuth);
	}
	for (uint32_t row = 0; row < p->desc.rows; row++)
		for (uint32_t column = 0; column < p->desc.columns; column++) {
			size_t i = panorama_index(p, row, column);
			if (p->cell[i] != CELL_MEASURED)
				continue;
			double azimuth = panorama_azimuth_rad(p, row, column);
			const struct beam *beam =
				nearest_beam(g_array_index(b->rows, GArray *, row), azimuth,
					panorama_elevation_rad(p, row, column), p->row_rad);
			double away = beam ? remainder(azimuth - beam->azimuth_rad, 2 * G_PI) /
						      p->column_rad
					   : 1;
			c.measured++;
			c.unmatched += fabs(away) > 0.1;
			c.azimuth_worst_columns = fmax(c.azimuth_worst_columns, fabs(away));
			c.azimuth_bias_columns += away;
			double error_mm =
				beam ? 1000.0 * ((double)p->range_m[i] - beam->range_m) : 0;
			if (!beam || !beam->even || !is_smooth(p, row, column))
				continue;
			sum += error_mm;
			g_array_append_val(off, error_mm);
		}
	c.azimuth_bias_columns /= c.measured;
	c.smooth = off->len;
	c.bias_mm = sum / off->len;
	/* The spread of the middle two thirds, which a stray mixed pixel cannot touch. */
	qsort(off->data, off->len, sizeof(double), by_value);
	c.sigma_mm = (g_array_index(off, double, (guint)(0.8413 * off->len)) -
			     g_array_index(off, double, (guint)(0.1587 * off->len))) /
		     2;
	return c;
}

static const struct round_trip {
	const char *path, *description, *preset;
	double noise_mm;
} round_trips[] = {
	{ "/scan/round-trip/court-fast-clock",
		"court?seed=11&station=2&camera=none&drift_ppm=200&ares=1584", "standard", 12 },
	{ "/scan/round-trip/hall-slow-clock",
		"hall?seed=4&station=1&camera=none&drift_ppm=-200&ares=1584", "standard", 12 },
	{ "/scan/round-trip/street-noise-3",
		"street?seed=5&station=3&camera=none&drift_ppm=90&noise_mm=3&ares=792", "draft",
		3 },
	{ "/scan/round-trip/bridge-cola",
		"bridge?seed=2&station=2&camera=none&drift_ppm=200&lidar=cola", "standard", 12 },
	{ "/scan/round-trip/court-wraps",
		"court?seed=11&camera=none&clock_start=16776000&stage_clock_start=4294000000&ares="
		"792",
		"draft", 12 },
	{ "/scan/round-trip/jitter", "hall?seed=4&camera=none&jitter_ms=3&drift_ppm=150&ares=792",
		"draft", 12 },
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
	bool good = simulated_scan(
		path, t->description, &options, keep_truth, &beams, &result, &partial, &error);
	g_assert_no_error(error);
	g_assert_true(good);
	g_autoptr(site) s = site_open(path, &error);
	g_autoptr(panorama) p = scan_load(s, result.number, true, &error);
	g_assert_no_error(error);
	struct comparison c = compare(p, &beams);
	g_test_message("%zu measured, %zu unmatched, azimuth worst %.3f bias %+.4f columns; %zu "
		       "smooth: bias %+.3f mm, sigma %.3f mm, drift %.1f ppm",
		c.measured, c.unmatched, c.azimuth_worst_columns, c.azimuth_bias_columns, c.smooth,
		c.bias_mm, c.sigma_mm, result.report.drift_ppm);
	g_assert_cmpuint(result.missing_columns, ==, 0);
	g_assert_cmpuint(result.report.lost_revolutions, ==, 0);
	g_assert_cmpuint(c.measured, >, 1000);
	/* No cell is called measured without a beam there. */
	g_assert_cmpuint(c.unmatched, ==, 0);
	g_assert_cmpfloat(c.azimuth_worst_columns, <=, 0.1);
	g_assert_cmpfloat(fabs(c.bias_mm), <=, 1.0);
	g_assert_cmpfloat(fabs(c.sigma_mm / t->noise_mm - 1), <, 0.05);
	beams_clear(&beams);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	for (size_t i = 0; i < G_N_ELEMENTS(round_trips); i++)
		g_test_add_data_func(round_trips[i].path, &round_trips[i], test_round_trip);
	return g_test_run();
}
