/* Pieces of edges put together: round ones, corners, and what runs through another one. */
#include "process/profile-chain.h"
#include "process/profile-cross.h"
#include <math.h>
#include <string.h>

/* Of a face that looks up. */
static void add_straight(GArray *pieces, const double from[2], const double to[2])
{
	struct profile_piece p = { .spacing_m = 0.01f, .support = 1, .kind = PROFILE_END };
	double length = hypot(to[0] - from[0], to[1] - from[1]);
	for (int k = 0; k < 2; k++) {
		p.line.at[k] = from[k];
		p.line.along[k] = (to[k] - from[k]) / length;
	}
	p.to_m = length;
	p.face[0][2] = 1;
	g_array_append_val(pieces, p);
}

/* Tangents of a circle of a metre, each longer than its part, some one way around and some the other. */
static void test_round(void)
{
	enum { PIECES = 16 };
	g_autoptr(GArray) pieces = g_array_new(FALSE, FALSE, sizeof(struct profile_piece));
	for (int n = 0; n < PIECES; n++) {
		double turn = 2 * G_PI * n / PIECES,
		       half = (n % 3 ? 1.15 : -1.1) * tan(G_PI / PIECES);
		const double x = cos(turn), y = sin(turn);
		add_straight(pieces, (double[]){ x + half * y, y - half * x },
			(double[]){ x - half * y, y + half * x });
	}
	const struct profile_options options = { .length_least_m = 0.2f };
	g_autoptr(profile_lines) lines =
		profile_chain(pieces, (const double[3]){ 0, 0, 0 }, &options);
	g_assert_cmpuint(lines->line->len, ==, 1);
	const struct profile_line *l = &g_array_index(lines->line, struct profile_line, 0);
	g_assert_true(l->closed);
	g_assert_cmpuint(l->count, >, 3 * PIECES);
	g_assert_cmpfloat(fabsf(l->length_m - 2 * (float)G_PI), <, 0.05f);
	const struct profile_vertex *v =
		&g_array_index(lines->vertex, struct profile_vertex, l->first);
	for (uint32_t n = 0; n < l->count; n++) {
		g_assert_cmpfloat(
			fabs(hypot((double)v[n].at_m[0], (double)v[n].at_m[1]) - 1), <, 0.012);
		g_assert_cmpint(v[n].face[0][0], ==, v[0].face[0][0]);
	}
	g_assert_cmpmem(v[0].at_m, sizeof v->at_m, v[l->count - 1].at_m, sizeof v->at_m);
}

/* What crosses and goes on farther than anybody could mistake for the other is an edge of its own; and what nearly follows another, but on no
 * face of it. */
static void test_crossing(void)
{
	const struct profile_options options = { .length_least_m = 0.2f };
	for (int n = 0; n < 3; n++) {
		g_autoptr(GArray) pieces = g_array_new(FALSE, FALSE, sizeof(struct profile_piece));
		double past = n == 1 ? 0.3 : 0.06;
		add_straight(pieces, (double[]){ -2, 0 }, (double[]){ past, 0 });
		add_straight(pieces, (double[]){ -past * cos(0.5), -past * sin(0.5) },
			(double[]){ 2 * cos(0.5), 2 * sin(0.5) });
		if (n == 2)
			memcpy(g_array_index(pieces, struct profile_piece, 1).face[0],
				(const float[3]){ 1, 0, 0 }, sizeof(float[3]));
		g_autoptr(profile_lines) lines =
			profile_chain(pieces, (const double[3]){ 0, 0, 0 }, &options);
		g_assert_cmpuint(lines->line->len, ==, n ? 2 : 1);
		const struct profile_line *l = &g_array_index(lines->line, struct profile_line, 0);
		/* So long straight parts that meet are no curve: their corner stays one. */
		g_assert_cmpuint(l->count, ==, n ? 2 : 3);
		g_assert_cmpfloat(
			fabsf(l->length_m - (n ? 2 + (float)past : 4)), <, n == 2 ? 0.1f : 1e-3f);
	}
}

/* The shorter of two that run through each other ends there, if it is not of a building, and goes where too little is left; not where they
 * meet in a corner, one passes the other, or both are rails. */
static void test_through(void)
{
	static const uint8_t classes[2] = { CLASS_STRUCTURE, CLASS_BUILDING };
	const struct profile_options options = { .length_least_m = 0.2f, .leaf_class = classes };
	static const struct {
		double from, to, height_m, left_m; /* of the second one, across the first */
		uint16_t leaf;
		uint8_t kind;
	} way[] = { { -0.4, 0.7, 0, 0.7, 0, PROFILE_CREASE },
		{ -0.9, 0.2, 0.05, 0.9, 0, PROFILE_END }, { -0.15, 0.15, 0, 0, 0, PROFILE_CREASE },
		{ -0.02, 0.7, 0, 0.72, 0, PROFILE_CREASE },
		{ -0.4, 0.7, 0.08, 1.1, 0, PROFILE_CREASE },
		{ -0.4, 0.7, 0, 1.1, 1, PROFILE_CREASE }, { -0.4, 0.7, 0, 1.1, 0, PROFILE_THIN } };
	for (size_t n = 0; n < G_N_ELEMENTS(way); n++) {
		g_autoptr(GArray) pieces = g_array_new(FALSE, FALSE, sizeof(struct profile_piece));
		add_straight(pieces, (double[]){ -2, 0 }, (double[]){ 1, 0 });
		add_straight(pieces, (double[]){ 0, way[n].from }, (double[]){ 0, way[n].to });
		struct profile_piece *p = &g_array_index(pieces, struct profile_piece, 0);
		p[1].line.at[2] += way[n].height_m;
		p[1].leaf = way[n].leaf;
		p[0].kind = p[1].kind = way[n].kind;
		profile_cross_cut(pieces, &options);
		g_assert_cmpuint(pieces->len, ==, way[n].left_m > 0 ? 2 : 1);
		g_assert_cmpfloat(fabs(profile_piece_length(p) - 3), <, 1e-9);
		if (pieces->len == 2)
			g_assert_cmpfloat(
				fabs(profile_piece_length(p + 1) - way[n].left_m), <, 1e-9);
	}
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/profile-chain/round", test_round);
	g_test_add_func("/profile-chain/crossing", test_crossing);
	g_test_add_func("/profile-chain/through", test_through);
	return g_test_run();
}
