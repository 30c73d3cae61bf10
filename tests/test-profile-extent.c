#include "process/profile-extent.h"
#include "tests/profile-model.h"
#include <string.h>

/* A wall, y = 0, from z = 0 to 1 on the left of HIGHER_FROM_M; on its right it goes on to 1.5. At its foot a floor, z = 0, to y = -0.6. From
 * GAP_FROM_M to GAP_TO_M there is an opening, without a floor, under which the wall begins at GAP_UP_M; and a chink of CHINK_M beside
 * CHINK_AT_M. A colour changes on the wall at COLOUR_AT_M as far as COLOUR_TO_M, and feature points that are bent
 * lie at BENT_AT_M. */
#define SPACING_M     0.015
#define NOISE_M       0.001
#define LEFT_M        -1.6
#define RIGHT_M       1.2
#define HIGHER_FROM_M 0.4
#define GAP_FROM_M    -0.6
#define GAP_TO_M      0.6
#define GAP_UP_M      0.3
#define CHINK_AT_M    -1.1
#define CHINK_M       0.06
#define COLOUR_AT_M   0.5
#define BENT_AT_M     0.8
#define COLOUR_TO_M   0.3
#define LEAST_M       0.1

static void add_point(GArray *all, GRand *r, int face, double x, double across)
{
	const float normal[2][3] = { { 0, -1, 0 }, { 0, 0, 1 } };
	double noise = NOISE_M * (g_rand_double(r) - 0.5) * 3.4,
	       at[3] = { x, face ? -across : noise, face ? noise : across };
	struct morton_place place;
	g_assert_true(morton_from_point(at, morton_cell_m(0), &place));
	struct part_point p = { .code = place.code,
		.size = (uint16_t)(SPACING_M * 1e4),
		.spacing = (uint16_t)(SPACING_M * 1e4),
		.plane_error = 20 };
	memcpy(p.within, place.within, sizeof p.within);
	model_pack_normal(normal[face], p.normal);
	p.k1 = p.k2 = MODEL_HALF_NONE;
	bool is_coloured = x < COLOUR_TO_M && fabs(across - COLOUR_AT_M) < SPACING_M;
	if (face == 0 && (is_coloured || fabs(across - BENT_AT_M) < SPACING_M)) {
		p.kind = FEATURE_DIRECTED;
		p.feature = 200;
		p.flags = is_coloured ? FEATURE_COLOUR_EDGE : FEATURE_CREASE;
		model_pack_normal((const float[3]){ 1, 0, 0 }, p.direction);
	}
	g_array_append_val(all, p);
}

static bool has_floor(double x)
{
	return (x < GAP_FROM_M || x > GAP_TO_M) && fabs(x - CHINK_AT_M) > CHINK_M / 2;
}

static model *make_corner(void)
{
	g_autoptr(GRand) r = g_rand_new_with_seed(5);
	g_autoptr(GArray) all = g_array_new(FALSE, FALSE, sizeof(struct part_point));
	for (double x = LEFT_M; x < RIGHT_M; x += SPACING_M) {
		for (double z = SPACING_M / 2 + (has_floor(x) ? 0 : GAP_UP_M);
			z < (x > HIGHER_FROM_M ? 1.5 : 1); z += SPACING_M)
			add_point(all, r, 0, x, z);
		for (double y = SPACING_M / 3; y < 0.6 && has_floor(x); y += SPACING_M)
			add_point(all, r, 1, x, y);
	}
	return write_model(all, NULL);
}

/* Along x, at this height, longer than anything that is there. */
static struct profile_piece piece_at(double z, uint8_t kind)
{
	return (struct profile_piece){ .line = { { 0, 0, z }, { 1, 0, 0 } },
		.from_m = LEFT_M - 0.35,
		.to_m = RIGHT_M + 0.22,
		.spacing_m = (float)SPACING_M,
		.support = 1,
		.kind = kind,
		.face = { { 0, -1, 0 }, { 0, 0, kind == PROFILE_CREASE ? 1 : 0 } } };
}

static void check_parts(
	const profile_around *around, double z, uint8_t kind, const double (*part)[2], guint parts)
{
	const struct profile_piece p = piece_at(z, kind);
	g_autoptr(GArray) left = g_array_new(FALSE, FALSE, sizeof(struct profile_piece));
	profile_extent_cut(around, &p, LEAST_M, left);
	for (guint n = 0; n < left->len; n++) {
		const struct profile_piece *q = &g_array_index(left, struct profile_piece, n);
		g_test_message("%.3f to %.3f", q->from_m, q->to_m);
	}
	g_assert_cmpuint(left->len, ==, parts);
	for (guint n = 0; n < parts; n++) {
		const struct profile_piece *q = &g_array_index(left, struct profile_piece, n);
		g_assert_cmpfloat(fabs(q->from_m - part[n][0]), <, 1.5 * SPACING_M);
		g_assert_cmpfloat(fabs(q->to_m - part[n][1]), <, 1.5 * SPACING_M);
		g_assert_cmpint(q->kind, ==, kind);
	}
}

/* A crease is where both faces are, but for chinks; an end, where its face does not go on; a mark, where colours change. */
static void test_cut(void)
{
	const double origin_m[3] = { 0 };
	g_autoptr(model) m = make_corner();
	g_autoptr(profile_around) around = profile_around_new(m, origin_m, 1);
	check_parts(around, 0, PROFILE_CREASE,
		(const double[][2]){ { LEFT_M, GAP_FROM_M }, { GAP_TO_M, RIGHT_M } }, 2);
	check_parts(around, 1, PROFILE_END, (const double[][2]){ { LEFT_M, HIGHER_FROM_M } }, 1);
	check_parts(around, COLOUR_AT_M, PROFILE_MARK,
		(const double[][2]){ { LEFT_M, COLOUR_TO_M } }, 1);
	check_parts(around, BENT_AT_M, PROFILE_MARK, NULL, 0);
	const struct profile_piece thin = piece_at(1, PROFILE_THIN);
	check_parts(around, 1, PROFILE_THIN, (const double[][2]){ { thin.from_m, thin.to_m } }, 1);
}

/* Parts that are shorter than asked for are left out. */
static void test_short(void)
{
	const double origin_m[3] = { 0 };
	g_autoptr(model) m = make_corner();
	g_autoptr(profile_around) around = profile_around_new(m, origin_m, 1);
	const struct profile_piece p = piece_at(0, PROFILE_CREASE);
	g_autoptr(GArray) left = g_array_new(FALSE, FALSE, sizeof(struct profile_piece));
	profile_extent_cut(around, &p, 0.8, left);
	g_assert_cmpuint(left->len, ==, 1);
}

/* Lines are cut so: nothing bears out a mark of points that are bent. */
static void test_lines(void)
{
	g_autoptr(model) m = make_corner();
	g_autoptr(profile_lines) lines = profile_lines_find(m, NULL);
	double coloured_m = 0;
	for (guint n = 0; n < lines->line->len; n++) {
		const struct profile_line *line =
			&g_array_index(lines->line, struct profile_line, n);
		const float *at_m =
			g_array_index(lines->vertex, struct profile_vertex, line->first).at_m;
		double z = lines->origin_m[2] + (double)at_m[2];
		g_test_message(
			"kind %d, %.2f m at z = %.3f", line->kind, (double)line->length_m, z);
		g_assert_true(line->kind != PROFILE_MARK || fabs(z - BENT_AT_M) > 0.05);
		if (line->kind == PROFILE_MARK && fabs(z - COLOUR_AT_M) < 0.02)
			coloured_m += (double)line->length_m;
	}
	g_assert_cmpfloat(fabs(coloured_m - (COLOUR_TO_M - LEFT_M)), <, 0.05);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/profile-extent/cut", test_cut);
	g_test_add_func("/profile-extent/short", test_short);
	g_test_add_func("/profile-extent/lines", test_lines);
	return g_test_run();
}
