#include "acquire/lidar-delay.h"
#include <math.h>

#define LINES_MAX  2000u
#define LINES_MIN  20u
#define PASSES     6
#define CUT_SIGMAS 3.0
/* What a single line's shift is worth at best. */
#define LINE_DEVIATION_RAD 1e-4
#define DEVIATION_MAX_S    3e-4
/* What is thought before anything is seen: a cable delays by about a millisecond, gears are tight. */
#define DELAY_PRIOR_S   2e-3
#define SLACK_PRIOR_RAD 3e-4
/* Cells round a beam whose ranges differ by more than this share hold an edge. */
#define EDGE_SHARE    0.1f
#define EVEN_RMS_M    0.015
#define BEAM_CUT_M    0.06
#define RANGE_NOISE_M 0.015
/* Walls are not even between two columns; met at a slant, that is more along the beam. */
#define RELIEF_M 0.006

struct back_beam {
	double azimuth_rad;
	float elevation_rad, range_m;
};
struct back_line {
	guint first, count; /* beams */
	double pace_rad_s;
};
struct lidar_delay {
	GArray *beams; /* of struct back_beam */
	GArray *lines; /* of struct back_line */
	uint32_t forth;
	double forth_pace_rad_s; /* sum over lines */
};

lidar_delay *lidar_delay_new(void)
{
	lidar_delay *d = g_new0(lidar_delay, 1);
	d->beams = g_array_new(FALSE, FALSE, sizeof(struct back_beam));
	d->lines = g_array_new(FALSE, FALSE, sizeof(struct back_line));
	return d;
}

void lidar_delay_free(lidar_delay *d)
{
	if (!d)
		return;
	g_array_unref(d->beams);
	g_array_unref(d->lines);
	g_free(d);
}

static void keep_line(lidar_delay *d, const struct placed_line *placed, double pace_rad_s)
{
	struct back_line line = { .first = d->beams->len, .pace_rad_s = pace_rad_s };
	for (uint32_t i = 0; i < placed->beams; i++) {
		struct back_beam b = { placed->azimuth_rad[i], placed->elevation_rad[i],
			placed->range_m[i] };
		if (b.range_m > 0)
			g_array_append_val(d->beams, b);
	}
	line.count = d->beams->len - line.first;
	g_array_append_val(d->lines, line);
}

void lidar_delay_add(lidar_delay *d, const struct scanline *line, const struct placed_line *placed)
{
	double pace_rad_s = placed->turn_rad * line->scan_rate_hz;
	if (placed->suspect)
		return;
	if (pace_rad_s > 0) {
		d->forth_pace_rad_s += pace_rad_s;
		d->forth++;
	} else if (pace_rad_s < 0 && d->lines->len < LINES_MAX)
		keep_line(d, placed, pace_rad_s);
}

/* ---- what the panorama says in the direction of a beam ---- */

struct local_fit {
	double inverse, slope; /* of 1/range, and of it along the azimuth, in 1/m and 1/(m rad) */
	double slope_variance;
};

struct moments {
	double n, a, e, u, aa, ae, ee, au, eu, uu;
};

static bool add_cell(const panorama *p, const struct back_beam *b, int64_t row, int64_t column,
	struct moments *m)
{
	if (row < 0 || row >= p->desc.rows)
		return true;
	column = (column + p->desc.columns) % p->desc.columns;
	size_t i = panorama_index(p, (uint32_t)row, (uint32_t)column);
	if (p->cell[i] != CELL_MEASURED)
		return true;
	if (fabsf(p->range_m[i] - b->range_m) > EDGE_SHARE * b->range_m)
		return false;
	double a = panorama_azimuth_rad(p, (uint32_t)row, (uint32_t)column) - b->azimuth_rad,
	       e = panorama_elevation_rad(p, (uint32_t)row, (uint32_t)column) - b->elevation_rad,
	       u = 1 / (double)p->range_m[i];
	/* Both lie within a turn. */
	a += a > G_PI ? -2 * G_PI : a < -G_PI ? 2 * G_PI : 0;
	m->n += 1;
	m->a += a;
	m->e += e;
	m->u += u;
	m->aa += a * a;
	m->ae += a * e;
	m->ee += e * e;
	m->au += a * u;
	m->eu += e * u;
	m->uu += u * u;
	return true;
}

/* Plane through the inverse ranges of the cells around, which must be even. */
static bool fit_around(const panorama *p, const struct back_beam *b, struct local_fit *ret)
{
	struct moments m = { 0 };
	int64_t row = (int64_t)floor((p->desc.elevation_max_rad - b->elevation_rad) / p->row_rad),
		column = (int64_t)floor(b->azimuth_rad / p->column_rad);
	for (int dr = -1; dr <= 1; dr++)
		for (int dc = -2; dc <= 2; dc++)
			if (!add_cell(p, b, row + dr, column + dc, &m))
				return false;
	if (m.n < 10)
		return false;
	double aa = m.aa - m.a * m.a / m.n, ae = m.ae - m.a * m.e / m.n,
	       ee = m.ee - m.e * m.e / m.n, au = m.au - m.a * m.u / m.n,
	       eu = m.eu - m.e * m.u / m.n, uu = m.uu - m.u * m.u / m.n;
	double determinant = aa * ee - ae * ae;
	if (!(determinant > 1e-3 * aa * ee))
		return false;
	double slope = (au * ee - eu * ae) / determinant, rise = (eu * aa - au * ae) / determinant;
	double left = fmax(uu - slope * au - rise * eu, 0);
	double range = b->range_m;
	*ret = (struct local_fit){ (m.u - slope * m.a - rise * m.e) / m.n, slope,
		left / (m.n - 3) * ee / determinant };
	return sqrt(left / m.n) * range * range < EVEN_RMS_M;
}

/* How far a line of the way back has to be turned to lie on the panorama. */
struct shift {
	double lead_rad_s; /* the pace of the way forth less its own */
	double shift_rad, variance_rad2;
};

/* Least squares over the beams of a line; those that are far off see something else. The noise of the
 * slopes adds to their squares, and would make every shift too small. */
static bool shift_of_line(
	const lidar_delay *d, const panorama *p, const struct back_line *line, struct shift *ret)
{
	double squares = 0, products = 0;
	for (guint i = line->first; i < line->first + line->count; i++) {
		const struct back_beam *b = &g_array_index(d->beams, struct back_beam, i);
		double scale = (double)b->range_m * b->range_m;
		struct local_fit fit;
		if (!fit_around(p, b, &fit))
			continue;
		double off_m = (1 / (double)b->range_m - fit.inverse) * scale;
		if (fabs(off_m) > BEAM_CUT_M)
			continue;
		double tangent = fit.slope * (double)b->range_m;
		double noise2 = RANGE_NOISE_M * RANGE_NOISE_M,
		       weight = noise2 / (noise2 + RELIEF_M * RELIEF_M * (1 + tangent * tangent));
		squares += weight * (fit.slope * fit.slope - fit.slope_variance) * scale * scale;
		products += weight * fit.slope * scale * off_m;
	}
	if (!(squares > 0))
		return false;
	*ret = (struct shift){ .lead_rad_s = d->forth_pace_rad_s / d->forth - line->pace_rad_s,
		.shift_rad = products / squares,
		.variance_rad2 = RANGE_NOISE_M * RANGE_NOISE_M / squares +
				 LINE_DEVIATION_RAD * LINE_DEVIATION_RAD };
	return true;
}

/* Of struct shift, in the order of the lines. */
static GArray *find_shifts(const lidar_delay *d, const panorama *p)
{
	GArray *shifts = g_array_new(FALSE, FALSE, sizeof(struct shift));
	g_autofree struct shift *shift = g_new(struct shift, d->lines->len);
	g_autofree bool *is_there = g_new(bool, d->lines->len);
#pragma omp parallel for schedule(dynamic, 8)
	for (guint i = 0; i < d->lines->len; i++)
		is_there[i] = shift_of_line(
			d, p, &g_array_index(d->lines, struct back_line, i), &shift[i]);
	for (guint i = 0; i < d->lines->len; i++)
		if (is_there[i])
			g_array_append_val(shifts, shift[i]);
	return shifts;
}

struct solution {
	double delay_s, slack_rad, variance_s2;
	guint lines;
};

/* One weighted step: shift = lead * delay - slack. Lines far off the solution before count less
 * (Huber), and by how far they are off the variance grows. */
static struct solution solve(const GArray *shifts, const struct solution *before)
{
	double dd = 1 / (DELAY_PRIOR_S * DELAY_PRIOR_S), ds = 0,
	       ss = 1 / (SLACK_PRIOR_RAD * SLACK_PRIOR_RAD), dy = 0, sy = 0, off2 = 0;
	for (guint i = 0; i < shifts->len; i++) {
		const struct shift *q = &g_array_index(shifts, struct shift, i);
		double off = q->shift_rad - q->lead_rad_s * before->delay_s + before->slack_rad,
		       sigma = sqrt(q->variance_rad2),
		       huber = fmin(1, CUT_SIGMAS / 2 * sigma / fmax(fabs(off), 1e-12)),
		       weight = before->lines ? huber / q->variance_rad2 : 1 / q->variance_rad2;
		dd += weight * q->lead_rad_s * q->lead_rad_s;
		ds -= weight * q->lead_rad_s;
		ss += weight;
		dy += weight * q->lead_rad_s * q->shift_rad;
		sy -= weight * q->shift_rad;
		off2 += weight * off * off;
	}
	double determinant = dd * ss - ds * ds,
	       spread = before->lines ? fmax(off2 / MAX(shifts->len, 1), 1) : 1;
	return (struct solution){ (dy * ss - sy * ds) / determinant,
		(sy * dd - dy * ds) / determinant, spread * ss / determinant, shifts->len };
}

bool lidar_delay_estimate(const lidar_delay *d, const panorama *p, struct lidar_delay_result *ret)
{
	if (!d->forth || d->lines->len < LINES_MIN)
		return false;
	g_autoptr(GArray) shifts = find_shifts(d, p);
	struct solution s = { 0 };
	for (int pass = 0; pass < PASSES; pass++)
		s = solve(shifts, &s);
	*ret = (struct lidar_delay_result){ s.delay_s, sqrt(s.variance_s2), s.slack_rad, s.lines };
	return s.lines >= LINES_MIN && ret->deviation_s <= DEVIATION_MAX_S;
}
