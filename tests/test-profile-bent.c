/* Edges of what is bent: lines follow them, and do not lie as chords between the edges of a moulding. */
#include "process/profile-lines.h"
#include "process/vector3.h"
#include "tests/profile-model.h"
#include <string.h>

/* A road that rises in the middle, and along it a wall with a band of stone that goes the same way: all of it is straight in plan. */
#define HALF_M     6.0
#define RISE_M     0.3
#define SPACING_M  0.02
#define NOISE_M    0.004
#define ROAD_M     0.5
#define WALL_M     0.6
#define BAND_OUT_M 0.07
#define WITHIN_M   0.02
/* From the foot of the wall: across, out of it, and up. */
static const double corner[][2] = { { ROAD_M, 0 }, { 0, 0 }, { 0, 0.2 }, { BAND_OUT_M, 0.24 },
	{ BAND_OUT_M, 0.36 }, { 0, 0.4 }, { 0, WALL_M } };
#define CORNERS G_N_ELEMENTS(corner)
static const double scanner_m[3] = { 0.5, -5, 1.2 };

static double rise(double x)
{
	return RISE_M * (1 - x * x / (HALF_M * HALF_M));
}

/* So far between the corners n and n + 1. */
static struct part_point point_of(GRand *r, double x, size_t n, double part)
{
	const double *a = corner[n], *b = corner[n + 1], way[2] = { b[0] - a[0], b[1] - a[1] };
	double out = a[0] + part * way[0], up = a[1] + part * way[1],
	       length = hypot(way[0], way[1]);
	double at[3] = { x, -out, rise(x) + up }, beam[3], far = 0;
	/* A road seen from above, a wall from before it. */
	float normal[3] = { 0, (float)(-way[1] / length), (float)(-way[0] / length) },
	      along[3] = { 1, 0, (float)(-2 * RISE_M * x / (HALF_M * HALF_M)) };
	for (int k = 0; k < 3; k++) {
		beam[k] = at[k] - scanner_m[k];
		far += beam[k] * beam[k];
	}
	double noise = NOISE_M * gauss(r) / sqrt(far);
	for (int k = 0; k < 3; k++)
		at[k] += noise * beam[k];
	struct morton_place place;
	g_assert_true(morton_from_point(at, morton_cell_m(0), &place));
	struct part_point p = { .code = place.code,
		.leaf = 1,
		.size = (uint16_t)(SPACING_M * 1e4),
		.spacing = (uint16_t)(SPACING_M * 1e4),
		.plane_error = 50,
		.feature = 200 };
	memcpy(p.within, place.within, sizeof p.within);
	vector3_unit(normal);
	vector3_unit(along);
	model_pack_normal(normal, p.normal);
	model_pack_normal(along, p.direction);
	p.k1 = p.k2 = MODEL_HALF_NONE;
	double to_corner = length * fmin(part, 1 - part);
	if (to_corner < SPACING_M && !(n == 0 && part < 0.5))
		p.kind = g_rand_double(r) < 0.7 ? FEATURE_DIRECTED : FEATURE_UNDIRECTED;
	return p;
}

static model *make_bridge(void)
{
	g_autoptr(GRand) r = g_rand_new_with_seed(3);
	g_autoptr(GArray) all = g_array_new(FALSE, FALSE, sizeof(struct part_point));
	for (double x = -HALF_M; x < HALF_M; x += SPACING_M)
		for (size_t n = 0; n + 1 < CORNERS; n++) {
			double length = hypot(
				corner[n + 1][0] - corner[n][0], corner[n + 1][1] - corner[n][1]);
			for (double at = g_rand_double(r) * SPACING_M; at < length;
				at += SPACING_M) {
				struct part_point p = point_of(
					r, x + g_rand_double(r) * SPACING_M, n, at / length);
				g_array_append_val(all, p);
			}
		}
	return write_model(all, made_from_one(scanner_m));
}

/* From the nearest edge; ret_edge, which one that is: a corner. */
static double off_edges(const double at[3], size_t *ret_edge)
{
	double least = INFINITY;
	for (size_t n = 1; n < CORNERS; n++) {
		double off = hypot(-at[1] - corner[n][0], at[2] - rise(at[0]) - corner[n][1]);
		if (off < least) {
			least = off;
			*ret_edge = n;
		}
	}
	return least;
}

static void test_bent(void)
{
	g_autoptr(model) m = make_bridge();
	g_autoptr(profile_lines) lines = profile_lines_find(m, NULL);
	double length_m = 0, astray_m = 0, of_m[CORNERS] = { 0 };
	for (guint i = 0; i < lines->line->len; i++) {
		const struct profile_line *line =
			&g_array_index(lines->line, struct profile_line, i);
		for (uint32_t v = line->first; v + 1 < line->first + line->count; v++) {
			const float *a = g_array_index(lines->vertex, struct profile_vertex, v)
						 .at_m,
				    *b = a + sizeof(struct profile_vertex) / sizeof *a;
			float way[3] = { b[0] - a[0], b[1] - a[1], b[2] - a[2] };
			double step_m = (double)vector3_length(way) / 100;
			for (int s = 0; s < 100; s++) {
				double at[3];
				size_t edge = 0;
				for (int k = 0; k < 3; k++)
					at[k] = lines->origin_m[k] + (double)a[k] +
						(s + 0.5) / 100 * (double)way[k];
				bool is_on = off_edges(at, &edge) < WITHIN_M;
				length_m += step_m;
				astray_m += is_on ? 0 : step_m;
				of_m[edge] += is_on ? step_m : 0;
			}
		}
	}
	g_test_message("%.1f m of lines, %.1f m on no edge", length_m, astray_m);
	for (size_t n = 1; n < CORNERS; n++)
		g_test_message("edge %zu: %.1f m", n, of_m[n]);
	/* 107 of 237 m before halves were looked at; it should be less yet. */
	g_assert_cmpfloat(astray_m, <, 0.25 * length_m);
	for (size_t n = 1; n + 1 < CORNERS; n++)
		g_assert_cmpfloat(of_m[n], >, 0.9 * 2 * HALF_M);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/profile-bent/lines", test_bent);
	return g_test_run();
}
