/* Lines through places, and profile lines of a block whose edges are known. */
#include "process/line-grow.h"
#include "process/profile-lines.h"
#include "process/profile-pieces.h"
#include "process/vector3.h"
#include "tests/line-places.h"
#include "tests/profile-model.h"
#include <math.h>
#include <string.h>

/* ---- straight lines ---- */

static void test_fit(void)
{
	g_autoptr(GRand) r = g_rand_new_with_seed(5);
	for (int n = 0; n < 50; n++) {
		struct line_sums sums = { 0 };
		double from[3], way[3], length = 0;
		for (int k = 0; k < 3; k++) {
			from[k] = g_rand_double_range(r, -50, 50);
			way[k] = g_rand_double_range(r, -1, 1);
			length += way[k] * way[k];
		}
		for (int i = 0; i < 200; i++) {
			double at[3], along = g_rand_double_range(r, 0, 3);
			for (int k = 0; k < 3; k++)
				at[k] = from[k] + along * way[k] / sqrt(length) +
					g_rand_double_range(r, -0.002, 0.002);
			line_sums_add(&sums, at, 1 + i % 3);
		}
		struct straight line;
		double off_m;
		g_assert_true(line_sums_fit(&sums, &line, &off_m));
		g_assert_cmpfloat(off_m, <, 0.002);
		g_assert_cmpfloat(off_m, >, 0.001);
		g_assert_cmpfloat(straight_off(&line, from), <, 0.001);
		g_assert_cmpfloat(fabs(straight_along(&line, line.at)), <, 1e-9);
	}
	struct line_sums one = { 0 };
	struct straight none;
	g_assert_false(line_sums_fit(&one, &none, NULL));
	line_sums_add(&one, (double[3]){ 1, 2, 3 }, 1);
	g_assert_false(line_sums_fit(&one, &none, NULL));
}

/* Two rows that cross, a gap in one of them, and a crowd around. */
static void test_grow(void)
{
	g_autoptr(GArray) all = g_array_new(FALSE, TRUE, sizeof(struct line_place));
	g_autoptr(GRand) r = g_rand_new_with_seed(9);
	for (int i = 0; i < 400; i++) {
		struct line_place p = { .within_m = 0.01f, .weight = 1 };
		p.at[i % 2] = 0.01 * (i / 2) + (i % 2 == 0 && i >= 200 ? 0.5 : 0);
		p.at[2] = g_rand_double_range(r, -0.003, 0.003);
		if (i % 4 < 2)
			p.along[i % 2] = i % 3 ? 1 : -1;
		g_array_append_val(all, p);
	}
	for (int i = 0; i < 300; i++) {
		struct line_place p = { .within_m = 0.01f, .weight = 1 };
		for (int k = 0; k < 3; k++)
			p.at[k] = g_rand_double_range(r, 0.1, 2);
		g_array_append_val(all, p);
	}
	g_autoptr(line_grower) g =
		line_grower_new(all->data, all->len, sizeof(struct line_place), 0.1, cos(0.2));
	struct line_run found;
	/* Place 200 + 2 is undirected, on the second row past the gap of the first. */
	g_assert_true(line_grower_grow(g, 4, 0.15, &found));
	g_assert_cmpfloat(found.to_m - found.from_m, >, 0.97);
	g_assert_cmpfloat(found.to_m - found.from_m, <, 1.02);
	g_assert_cmpfloat(fabs(found.line.along[0]), >, 0.9999);
	g_assert_cmpuint(found.found->len, >=, 95);
	g_assert_true(line_grower_grow(g, 103, 0.15, &found));
	g_assert_cmpfloat(fabs(found.line.along[1]), >, 0.9999);
	g_assert_cmpfloat(found.to_m - found.from_m, >, 1.95);
	for (guint n = 0; n < found.found->len; n++)
		g_assert_true(g_array_index(
			all, struct line_place, g_array_index(found.found, uint32_t, n))
				      .is_used);
	/* One of the crowd, far from any other. */
	struct line_place *crowd = &g_array_index(all, struct line_place, 650);
	crowd->at[0] = crowd->at[1] = crowd->at[2] = 9;
	g_autoptr(line_grower) anew =
		line_grower_new(all->data, all->len, sizeof(struct line_place), 0.1, cos(0.2));
	g_assert_false(line_grower_grow(anew, 650, 0.15, &found));
}

/* ---- a block ---- */

#define SPACING_M 0.02
#define NOISE_M   0.005
static const double block_m[3] = { 2, 1.2, 1.5 };

/* Of one of three faces, x = 2, y = 1.2, z = 1.5, which a scanner beyond their corner sees. */
static struct part_point point_of(GRand *r, int face, double a, double b)
{
	double at[3];
	int u = (face + 1) % 3, v = (face + 2) % 3, nearest = 0;
	double edge[4] = { a, block_m[u] - a, b, block_m[v] - b };
	float normal[3] = { 0 }, along[3] = { 0 };
	at[face] = block_m[face] + NOISE_M * gauss(r);
	at[u] = a;
	at[v] = b;
	for (int n = 1; n < 4; n++)
		if (edge[n] < edge[nearest])
			nearest = n;
	normal[face] = 1;
	along[nearest < 2 ? v : u] = 1;
	for (int k = 0; k < 3; k++)
		along[k] += (float)(0.03 * gauss(r));
	struct morton_place place;
	g_assert_true(morton_from_point(at, morton_cell_m(0), &place));
	struct part_point p = { .code = place.code,
		.leaf = 20,
		.size = 200,
		.spacing = (uint16_t)(SPACING_M * 1e4),
		.plane_error = 50 };
	memcpy(p.within, place.within, sizeof p.within);
	model_pack_normal(normal, p.normal);
	model_pack_normal(along, p.direction);
	p.k1 = p.k2 = MODEL_HALF_NONE;
	if (edge[nearest] < 2 * SPACING_M) {
		p.kind = g_rand_double(r) < 0.6 ? FEATURE_DIRECTED : FEATURE_UNDIRECTED;
		p.feature = (uint8_t)(200 - edge[nearest] * 1000);
	}
	return p;
}

static model *make_block(void)
{
	g_autoptr(GRand) r = g_rand_new_with_seed(11);
	g_autoptr(GArray) all = g_array_new(FALSE, FALSE, sizeof(struct part_point));
	for (int face = 0; face < 3; face++)
		for (double a = SPACING_M / 3; a < block_m[(face + 1) % 3]; a += SPACING_M)
			for (double b = SPACING_M / 4; b < block_m[(face + 2) % 3];
				b += SPACING_M) {
				double shift = SPACING_M * 0.4;
				struct part_point p = point_of(r, face,
					CLAMP(a + shift * (g_rand_double(r) - 0.5), 0,
						block_m[(face + 1) % 3]),
					CLAMP(b + shift * (g_rand_double(r) - 0.5), 0,
						block_m[(face + 2) % 3]));
				g_array_append_val(all, p);
			}
	return write_model(all, NULL);
}

/* The nine edges that the faces have: those at which two meet, and those at which one ends. */
static void edge_of(int n, double ret_a[3], double ret_b[3])
{
	int axis = n / 3, u = (axis + 1) % 3, v = (axis + 2) % 3;
	ret_a[axis] = 0;
	ret_b[axis] = block_m[axis];
	ret_a[u] = ret_b[u] = n % 3 == 1 ? 0 : block_m[u];
	ret_a[v] = ret_b[v] = n % 3 == 2 ? 0 : block_m[v];
}

static double nearest_edge(const double at[3])
{
	double least = INFINITY;
	for (int n = 0; n < 9; n++) {
		double a[3], b[3];
		edge_of(n, a, b);
		least = fmin(least, off_segment(at, a, b));
	}
	return least;
}

/* Of an edge, the share that the one line covers which covers the most. */
static double covered(const profile_lines *lines, int n)
{
	double a[3], b[3], best = 0;
	edge_of(n, a, b);
	for (guint i = 0; i < lines->line->len; i++) {
		const struct profile_line *line =
			&g_array_index(lines->line, struct profile_line, i);
		int some = 0;
		for (int s = 0; s < 100; s++) {
			double at[3], least = INFINITY;
			for (int k = 0; k < 3; k++)
				at[k] = a[k] + (s + 0.5) / 100 * (b[k] - a[k]);
			for (uint32_t v = line->first; v + 1 < line->first + line->count; v++) {
				double p[3], q[3];
				vertex_at(lines, v, p);
				vertex_at(lines, v + 1, q);
				least = fmin(least, off_segment(at, p, q));
			}
			some += least < 0.01;
		}
		best = fmax(best, some / 100.0);
	}
	return best;
}

static void test_block(void)
{
	g_autoptr(model) m = make_block();
	g_autoptr(profile_lines) lines = profile_lines_find(m, NULL);
	double all_m = 0, astray_m = 0, edges_m = 0;
	for (int n = 0; n < 9; n++) {
		double share = covered(lines, n);
		g_test_message("edge %d: %.0f %% covered by one line", n, 100 * share);
		g_assert_cmpfloat(share, >=, 0.9);
		edges_m += block_m[n / 3];
	}
	for (guint i = 0; i < lines->line->len; i++) {
		const struct profile_line *line =
			&g_array_index(lines->line, struct profile_line, i);
		double length = 0;
		g_assert_cmpuint(line->count, >=, 2);
		g_assert_cmpuint(line->leaf, ==, 20);
		for (uint32_t v = line->first; v + 1 < line->first + line->count; v++) {
			double p[3], q[3], middle[3], part = 0;
			vertex_at(lines, v, p);
			vertex_at(lines, v + 1, q);
			for (int k = 0; k < 3; k++) {
				middle[k] = (p[k] + q[k]) / 2;
				part += (p[k] - q[k]) * (p[k] - q[k]);
			}
			length += sqrt(part);
			if (fmax(nearest_edge(middle), fmax(nearest_edge(p), nearest_edge(q))) >
				0.02)
				astray_m += sqrt(part);
		}
		g_assert_cmpfloat(fabs(length - (double)line->length_m), <, 1e-3);
		all_m += length;
	}
	g_test_message("%u lines, %.2f m of %.2f m of edges, %.2f m astray", lines->line->len,
		all_m, edges_m, astray_m);
	g_assert_cmpfloat(all_m, <, 1.15 * edges_m);
	g_assert_cmpfloat(astray_m, <, 0.05 * all_m);
}

/* ---- a moulding ---- */

/* A band 8 cm high stands 9 cm out of a wall, y = 0, above a scanner whose beams are 2.1 mrad apart and waver by 8 mm. */
#define BAND_LOW_M    1.0
#define BAND_HIGH_M   1.08
#define BAND_OUT_M    0.09
#define BAND_LONG_M   1.2 /* to either side */
#define BEAM_RAD      0.0021
#define RANGE_NOISE_M 0.008
static const double scanner_m[3] = { 0.3, -7, -3 };

/* What a beam from the scanner meets, per metre along y: the band's front, its underside, the wall. */
static double meet_band(const double way[3], float ret_normal[3])
{
	double front = -scanner_m[1] - BAND_OUT_M, under = (BAND_LOW_M - scanner_m[2]) / way[2],
	       z = scanner_m[2] + front * way[2];
	memset(ret_normal, 0, 3 * sizeof *ret_normal);
	ret_normal[1] = -1;
	if (z >= BAND_LOW_M && z <= BAND_HIGH_M)
		return front;
	if (under > front && under < -scanner_m[1]) {
		ret_normal[1] = 0;
		ret_normal[2] = -1;
		return under;
	}
	return -scanner_m[1];
}

/* Its three edges that are seen, all along x. */
static const double band_edge[3][2] = { { -BAND_OUT_M, BAND_LOW_M }, { 0, BAND_LOW_M },
	{ -BAND_OUT_M, BAND_HIGH_M } };

/* is_crooked: feature points beside the second edge tell any direction. */
static struct part_point band_point(GRand *r, const double way[3], bool is_crooked)
{
	float normal[3], along[3] = { 1, 0, 0 };
	double far = meet_band(way, normal), length = sqrt(way[0] * way[0] + 1 + way[2] * way[2]),
	       wavers = RANGE_NOISE_M * gauss(r) / length, at[3], nearest = INFINITY;
	for (int n = 0; n < 3; n++) {
		double off = hypot(scanner_m[1] + far - band_edge[n][0],
			scanner_m[2] + far * way[2] - band_edge[n][1]);
		if (off < nearest)
			nearest = off;
		for (int k = 0; k < 3 && n == 1 && off == nearest && is_crooked; k++)
			along[k] = (float)gauss(r);
	}
	vector3_unit(along);
	for (int k = 0; k < 3; k++)
		at[k] = scanner_m[k] + (far + wavers) * way[k];
	struct morton_place place;
	g_assert_true(morton_from_point(at, morton_cell_m(0), &place));
	struct part_point p = { .code = place.code,
		.leaf = 20,
		.size = 170,
		.spacing = 170,
		.plane_error = 80,
		.feature = 200 };
	memcpy(p.within, place.within, sizeof p.within);
	model_pack_normal(normal, p.normal);
	model_pack_normal(along, p.direction);
	p.k1 = p.k2 = MODEL_HALF_NONE;
	if (nearest < 0.025)
		p.kind = is_crooked || g_rand_double(r) < 0.6 ? FEATURE_DIRECTED
							      : FEATURE_UNDIRECTED;
	return p;
}

static model *make_band(bool is_crooked)
{
	g_autoptr(GRand) r = g_rand_new_with_seed(3);
	g_autoptr(GArray) all = g_array_new(FALSE, FALSE, sizeof(struct part_point));
	for (double x = -0.25; x < 0.16; x += BEAM_RAD)
		for (double z = 0.5; z < 0.64; z += BEAM_RAD) {
			struct part_point p = band_point(r, (double[3]){ x, 1, z }, is_crooked);
			double side = scanner_m[0] - scanner_m[1] * x;
			if (fabs(side) < BAND_LONG_M)
				g_array_append_val(all, p);
		}
	return write_model(all, made_from_one(scanner_m));
}

static double nearest_line(const profile_lines *lines, const double at[3])
{
	double least = INFINITY;
	for (guint i = 0; i < lines->line->len; i++) {
		const struct profile_line *line =
			&g_array_index(lines->line, struct profile_line, i);
		for (uint32_t v = line->first; v + 1 < line->first + line->count; v++) {
			double p[3], q[3];
			vertex_at(lines, v, p);
			vertex_at(lines, v + 1, q);
			least = fmin(least, off_segment(at, p, q));
		}
	}
	return least;
}

/* Of an edge of the band, in percent, what is within 2 cm of lines. */
static int band_covered(const profile_lines *lines, int n)
{
	int some = 0;
	for (int s = 0; s < 100; s++) {
		double at[3] = { (s / 50.0 - 0.99) * 0.95 * BAND_LONG_M, band_edge[n][0],
			band_edge[n][1] };
		some += nearest_line(lines, at) < 0.02;
	}
	g_test_message("edge %d: %d %% within 2 cm of lines", n, some);
	return some;
}

/* Four rows of beams meet its front, two its underside; all along it that is enough. */
static void test_band(void)
{
	g_autoptr(model) m = make_band(false);
	g_autoptr(profile_lines) lines = profile_lines_find(m, NULL);
	for (int n = 0; n < 3; n++)
		g_assert_cmpint(band_covered(lines, n), >=, 90);
}

/* Where feature points of an edge tell no direction it is found beside the others, of a building alone. */
static void test_crooked(void)
{
	g_autoptr(model) m = make_band(true);
	for (int is_building = 0; is_building < 2; is_building++) {
		uint8_t leaf_class[21];
		memset(leaf_class, is_building ? CLASS_BUILDING : CLASS_OTHER, sizeof leaf_class);
		const struct profile_options options = { .leaf_class = leaf_class };
		g_autoptr(profile_lines) lines = profile_lines_find(m, &options);
		g_assert_cmpint(band_covered(lines, 0), >=, 90);
		int covered = band_covered(lines, 1);
		g_assert_true(is_building ? covered >= 90 : covered < 10);
	}
}

static GArray *look_at_band(const profile_around *around, bool is_beside, double from_m,
	double to_m, bool (*is_known)(const struct profile_piece *p, const void *user_data))
{
	const struct profile_piece edge = { .line = { { 0, -BAND_OUT_M, BAND_LOW_M }, { 1, 0, 0 } },
		.from_m = from_m,
		.to_m = to_m,
		.spacing_m = 0.017f,
		.support = 1 };
	const struct profile_look look = { 0 };
	GArray *found = g_array_new(FALSE, FALSE, sizeof(struct profile_piece));
	(is_beside ? profile_piece_look_beside : profile_piece_settle)(
		around, &edge, &look, is_known, NULL, found);
	return found;
}

static bool is_known(const struct profile_piece *p, const void *user_data)
{
	(void)p;
	(void)user_data;
	return true;
}

/* Beside one of its edges the others are found, which are too far from it to be taken for it, and no more of them than what was looked
 * at; none where most of that lies past the band's end. */
static void test_beside(void)
{
	const double origin_m[3] = { 0 };
	g_autoptr(model) m = make_band(false);
	g_autoptr(profile_around) around = profile_around_new(m, origin_m, 1);
	g_autoptr(GArray) own = look_at_band(around, false, -0.5, 0.5, NULL);
	g_autoptr(GArray) found = look_at_band(around, true, -0.5, 0.5, NULL);
	g_autoptr(GArray) known = look_at_band(around, true, -0.5, 0.5, is_known);
	g_autoptr(GArray) past = look_at_band(around, true, -0.5, 5, NULL);
	g_assert_cmpuint(own->len, ==, 1);
	g_assert_cmpuint(found->len, ==, 3);
	g_assert_cmpuint(known->len, ==, 0);
	g_assert_cmpuint(past->len, ==, 0);
	for (int n = 0; n < 3; n++) {
		double least = INFINITY;
		for (guint k = 0; k < found->len; k++) {
			const struct profile_piece *p =
				&g_array_index(found, struct profile_piece, k);
			double off = 0, at[3];
			for (int end = 0; end < 2; end++) {
				straight_place(&p->line, end ? p->to_m : p->from_m, at);
				off = fmax(off,
					hypot(at[1] - band_edge[n][0], at[2] - band_edge[n][1]));
				g_assert_cmpfloat(fabs(at[0]), <, 0.62);
			}
			g_assert_cmpfloat(profile_piece_length(p), >, 0.9);
			least = fmin(least, off);
		}
		g_test_message("edge %d: %.1f mm off", n, 1000 * least);
		/* The last is an end, known as well as beams are close. */
		g_assert_cmpfloat(least, <, n == 2 ? 0.017 : 0.005);
	}
}

/* The same bytes on one thread and on many. */
static void test_threads(void)
{
	g_autoptr(model) m = make_block();
	const struct profile_options one = { .single_thread = true };
	g_autoptr(profile_lines) a = profile_lines_find(m, NULL), b = profile_lines_find(m, &one);
	g_assert_cmpmem(a->line->data, a->line->len * sizeof(struct profile_line), b->line->data,
		b->line->len * sizeof(struct profile_line));
	g_assert_cmpmem(a->vertex->data, a->vertex->len * sizeof(struct profile_vertex),
		b->vertex->data, b->vertex->len * sizeof(struct profile_vertex));
}

static bool stop(double fraction, gpointer user_data)
{
	(void)fraction;
	++*(int *)user_data;
	return false;
}

static void test_stopped(void)
{
	g_autoptr(model) m = make_block();
	int calls = 0;
	const struct profile_options options = { .progress = stop, .user_data = &calls };
	g_assert_null(profile_lines_find(m, &options));
	g_assert_cmpint(calls, ==, 1);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/profile-lines/fit", test_fit);
	g_test_add_func("/profile-lines/grow", test_grow);
	g_test_add_func("/profile-lines/block", test_block);
	g_test_add_func("/profile-lines/band", test_band);
	g_test_add_func("/profile-lines/crooked", test_crooked);
	g_test_add_func("/profile-lines/beside", test_beside);
	g_test_add_func("/profile-lines/threads", test_threads);
	g_test_add_func("/profile-lines/stopped", test_stopped);
	return g_test_run();
}
