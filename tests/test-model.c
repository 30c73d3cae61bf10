/* The model's file: normals, the order inside a chunk, the curve, and what a file that does not hold together is answered. */
#include "firmware-io/files.h"
#include "process/chunk-order.h"
#include "process/model-write.h"
#include "tests/simulated.h"
#include <json-glib/json-glib.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void random_direction(GRand *r, float ret[3])
{
	double z = g_rand_double_range(r, -1, 1), a = g_rand_double_range(r, 0, 2 * G_PI);
	ret[0] = (float)(sqrt(1 - z * z) * cos(a));
	ret[1] = (float)(sqrt(1 - z * z) * sin(a));
	ret[2] = (float)z;
}

static double angle_deg(const float a[3], const float b[3])
{
	double cross[3] = { (double)a[1] * b[2] - (double)a[2] * b[1],
		(double)a[2] * b[0] - (double)a[0] * b[2],
		(double)a[0] * b[1] - (double)a[1] * b[0] };
	double dot = (double)a[0] * b[0] + (double)a[1] * b[1] + (double)a[2] * b[2];
	return atan2(sqrt(cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2]), dot) *
	       180 / G_PI;
}

static double packing_error_deg(const float n[3])
{
	int16_t packed[2];
	float back[3];
	model_pack_normal(n, packed);
	g_assert_true(packed[0] != MODEL_NORMAL_NONE && packed[1] != MODEL_NORMAL_NONE);
	model_unpack_normal(packed, back);
	return angle_deg(n, back);
}

static void test_normals(void)
{
	g_autoptr(GRand) r = g_rand_new_with_seed(1);
	double worst = 0;
	for (int i = 0; i < 200000; i++) {
		float n[3];
		random_direction(r, n);
		worst = fmax(worst, packing_error_deg(n));
	}
	for (int i = 0; i < 27; i++) {
		float n[3] = { (float)(i % 3 - 1), (float)(i / 3 % 3 - 1), (float)(i / 9 - 1) };
		if (i != 13)
			worst = fmax(worst, packing_error_deg(n));
	}
	g_test_message("worst %.4f degrees", worst);
	g_assert_cmpfloat(worst, <, 0.01);
}

static void test_no_normal(void)
{
	static const float none[][3] = { { 0, 0, 0 }, { NAN, 0, 1 }, { INFINITY, 0, 0 } };
	for (size_t i = 0; i < G_N_ELEMENTS(none); i++) {
		int16_t packed[2];
		float back[3];
		model_pack_normal(none[i], packed);
		g_assert_true(packed[0] == MODEL_NORMAL_NONE && packed[1] == MODEL_NORMAL_NONE);
		model_unpack_normal(packed, back);
		g_assert_true(back[0] == 0 && back[1] == 0 && back[2] == 0);
	}
}

/* Each of them there and back. */
static void test_halves(void)
{
	float last = -1;
	for (uint32_t h = 0; h < 0x7C00; h++) {
		float value = model_unpack_half((uint16_t)h);
		g_assert_cmpfloat(value, >, last);
		last = value;
		g_assert_cmpuint(model_pack_half(value), ==, h);
		g_assert_cmpuint(model_pack_half(-value), ==, h | 0x8000);
		g_assert_true(model_unpack_half((uint16_t)(h | 0x8000)) == -value);
		if (h + 1 == 0x7C00)
			break;
		/* Just beside the middle of two, and the middle, which goes to the even one. */
		float next = model_unpack_half((uint16_t)(h + 1)), middle = 0.5f * (value + next);
		g_assert_cmpuint(model_pack_half(nextafterf(middle, 0)), ==, h);
		g_assert_cmpuint(model_pack_half(nextafterf(middle, INFINITY)), ==, h + 1);
		g_assert_cmpuint(model_pack_half(middle), ==, h + h % 2);
	}
	g_assert_true(last == 65504);
}

static void test_halves_known(void)
{
	static const struct {
		float value;
		uint16_t half;
	} known[] = { { 0, 0 }, { 1, 0x3C00 }, { -2, 0xC000 }, { 0.333251953125f, 0x3555 },
		{ 0x1p-14f, 0x0400 }, { 0x1p-24f, 1 }, { 0x1p-26f, 0 }, { 65519, 0x7BFF },
		{ 1e9f, 0x7BFF }, { INFINITY, 0x7BFF }, { -INFINITY, 0xFBFF },
		{ NAN, MODEL_HALF_NONE } };
	for (size_t i = 0; i < G_N_ELEMENTS(known); i++)
		g_assert_cmphex(model_pack_half(known[i].value), ==, known[i].half);
	g_assert_true(isnan(model_unpack_half(MODEL_HALF_NONE)));
	g_assert_true(isinf(model_unpack_half(0x7C00)) && model_unpack_half(0xFC00) < 0);
}

/* ---- order ---- */

static void test_order_is_a_permutation(void)
{
	static const uint32_t counts[] = { 1, 2, 3, 100, 2048, 2049, 4095, 4096 };
	for (size_t k = 0; k < G_N_ELEMENTS(counts); k++) {
		uint16_t place[4096], again[4096], other[4096];
		uint8_t seen[4096] = { 0 };
		chunk_order(7, counts[k], place);
		chunk_order(7, counts[k], again);
		chunk_order(8, counts[k], other);
		for (uint32_t i = 0; i < counts[k]; i++) {
			g_assert_cmpuint(place[i], <, counts[k]);
			g_assert_cmpuint(seen[place[i]]++, ==, 0);
		}
		g_assert_cmpmem(place, counts[k] * 2, again, counts[k] * 2);
		g_assert_true(counts[k] < 100 || memcmp(place, other, counts[k] * 2));
	}
}

/* One of the first 2^k in each of 2^k parts. */
static void test_order_is_stratified(void)
{
	for (uint64_t seed = 0; seed < 50; seed++) {
		uint16_t place[4096];
		chunk_order(seed, 4096, place);
		for (uint32_t n = 1; n <= 4096; n *= 2) {
			uint8_t in_part[4096] = { 0 };
			for (uint32_t i = 0; i < n; i++)
				g_assert_cmpuint(in_part[place[i] / (4096 / n)]++, ==, 0);
		}
	}
}

/* Every place is as likely as any to be among the first 37: chi squared over 64 parts, and no two places always together. */
static void test_order_is_uniform(void)
{
	uint32_t hits[64] = { 0 }, both = 0;
	const uint32_t tries = 4000, first = 37;
	double chi2 = 0, expected = tries * first / 64.0;
	for (uint32_t t = 0; t < tries; t++) {
		uint16_t place[4096];
		bool has[2] = { false, false };
		chunk_order(t * 7919u + 3, 4096, place);
		for (uint32_t i = 0; i < first; i++) {
			hits[place[i] / 64]++;
			has[0] |= place[i] < 64;
			has[1] |= place[i] / 64 == 41;
		}
		both += has[0] && has[1];
	}
	for (int i = 0; i < 64; i++)
		chi2 += (hits[i] - expected) * (hits[i] - expected) / expected;
	g_test_message("chi squared %.1f of 63, both %u of %u", chi2, both, tries);
	g_assert_cmpfloat(chi2, <, 103); /* one in a thousand */
	/* Independent they would be 37/64 squared of all. */
	g_assert_cmpfloat(fabs(both / (double)tries - 0.334), <, 0.05);
}

/* ---- the curve ---- */

/* How far the nearest of the first so many is from each of them, in the mean. */
static double mean_gap_m(const double (*at_m)[3], const uint16_t place[4096], uint32_t count)
{
	double sum = 0;
	for (uint32_t i = 0; i < count; i++) {
		double nearest = INFINITY;
		for (uint32_t j = 0; j < count; j++) {
			const double *a = at_m[place[i]], *b = at_m[place[j]];
			double away = hypot(a[0] - b[0], a[1] - b[1]);
			nearest = i != j ? fmin(nearest, away) : nearest;
		}
		sum += nearest;
	}
	return sum / count;
}

/* A square, in whose right half points are twice as dense each way. */
static void make_square(double (*at_m)[3], float *spacing_m)
{
	GRand *r = g_rand_new_with_seed(3);
	for (uint32_t n = 0; n < 4096; n++) {
		bool dense = n % 5 != 0;
		at_m[n][0] = g_rand_double(r) * 0.5 + (dense ? 0.5 : 0);
		at_m[n][1] = g_rand_double(r);
		at_m[n][2] = 7;
		spacing_m[n] = sqrtf(0.5f / (dense ? 3276 : 820));
	}
	g_rand_free(r);
}

/* Every prefix keeps its points apart, and is as dense as all are. */
static void test_even_order(void)
{
	static double at_m[4096][3];
	static float spacing_m[4096];
	uint16_t plain[4096], even[4096];
	bool seen[4096] = { false };
	make_square(at_m, spacing_m);
	chunk_order(11, 4096, plain);
	memcpy(even, plain, sizeof even);
	chunk_order_even((const double(*)[3])at_m, spacing_m, 4096, even);
	for (uint32_t n = 0; n < 4096; n++) {
		g_assert_false(seen[even[n]]);
		seen[even[n]] = true;
	}
	for (uint32_t count = 64; count <= 1024; count *= 2) {
		double gap = mean_gap_m((const double(*)[3])at_m, even, count),
		       before = mean_gap_m((const double(*)[3])at_m, plain, count);
		uint32_t dense = 0;
		for (uint32_t n = 0; n < count; n++)
			dense += at_m[even[n]][0] > 0.5;
		g_test_message("%u: %.4f m apart instead of %.4f, %.3f in the dense half", count,
			gap, before, (double)dense / count);
		g_assert_cmpfloat(gap, >, 1.3 * before);
		g_assert_cmpfloat_with_epsilon((double)dense / count, 0.8, 0.08);
	}
}

static void test_morton(void)
{
	g_autoptr(GRand) r = g_rand_new_with_seed(2);
	for (unsigned level = 0; level < 12; level += 3) {
		double cell = morton_cell_m(level), reach = cell * MORTON_HALF;
		for (int i = 0; i < 20000; i++) {
			double at[3], back[3];
			struct morton_place p;
			for (int k = 0; k < 3; k++)
				at[k] = g_rand_double_range(r, -reach, reach);
			g_assert_true(morton_from_point(at, cell, &p));
			morton_to_point(&p, cell, back);
			for (int k = 0; k < 3; k++)
				g_assert_cmpfloat(fabs(at[k] - back[k]), <=, cell / 65536 * 0.51);
		}
		struct morton_place p;
		g_assert_false(morton_from_point((double[3]){ reach, 0, 0 }, cell, &p));
		g_assert_false(morton_from_point((double[3]){ 0, NAN, 0 }, cell, &p));
		g_assert_true(morton_from_point((double[3]){ 0, -1e-30, -reach }, cell, &p));
	}
	/* Bit by bit: x, y, z from the lowest on. */
	g_assert_cmpuint(
		morton_spread(5) | morton_spread(3) << 1 | morton_spread(1) << 2, ==, 0x57);
}

static int by_order(const void *a, const void *b)
{
	const struct part_point *p = a, *q = b;
	int order = part_point_compare(p, q);
	return order ? order : (p->intensity > q->intensity) - (p->intensity < q->intensity);
}

static void test_sort(void)
{
	g_autoptr(GRand) r = g_rand_new_with_seed(3);
	static const size_t counts[] = { 0, 1, 2, 1000, 60000 };
	for (size_t k = 0; k < 2 * G_N_ELEMENTS(counts); k++) {
		size_t n = counts[k / 2];
		g_autofree struct part_point *p = g_new0(struct part_point, n + 1);
		for (size_t i = 0; i < n; i++) {
			p[i].code = (uint64_t)g_rand_int(r) << 31 ^ g_rand_int(r);
			p[i].code >>= k % 2 ? 52 : 0; /* many equal ones */
			p[i].leaf = k % 2 ? (uint16_t)(g_rand_int(r) % 5000) : 0;
			p[i].intensity = (uint16_t)i;
		}
		g_autofree struct part_point *q = g_memdup2(p, (n + 1) * sizeof *p);
		g_autofree struct part_point *sorted = part_points_sorted(p, n);
		qsort(q, n, sizeof *q, by_order);
		g_assert_cmpmem(sorted, n * sizeof *p, q, n * sizeof *q);
	}
}

/* ---- files ---- */

/* 10,000 points of leaf 0 and 5 of leaf 3, far from the origin. */
static char *write_model(void)
{
	g_autofree char *folder = simulated_folder();
	char *path = g_build_filename(folder, "points.model", NULL);
	g_autoptr(model_writer) w = model_writer_new(path, 0, NULL);
	for (uint32_t i = 0; i < 10005; i++) {
		struct morton_place place;
		double at[3] = { 902 + i * 1e-3, 902, i % 7 * 1e-3 };
		g_assert_true(morton_from_point(at, 1e-3, &place));
		struct part_point p = { .code = place.code, .leaf = i < 10000 ? 0 : 3, .size = 9 };
		memcpy(p.within, place.within, sizeof p.within);
		g_assert_true(model_writer_add(w, &p, 4, NULL));
	}
	g_assert_cmpuint(model_writer_count(w), ==, 10005);
	g_assert_true(model_writer_finish(w, NULL, 0, json_object_new(), NULL));
	return path;
}

static void test_chunks(void)
{
	g_autofree char *path = write_model();
	g_autoptr(GError) error = NULL;
	g_autoptr(model) m = model_open_file(path, &error);
	g_assert_no_error(error);
	uint64_t chunks;
	const struct model_chunk *c = model_chunks(m, &chunks);
	g_assert_cmpuint(chunks, ==, 4);
	g_assert_cmpuint(c[0].points, ==, 4096);
	g_assert_cmpuint(c[2].points, ==, 10000 - 8192);
	g_assert_cmpuint(c[3].points, ==, 5);
	g_assert_cmpuint(c[3].leaf, ==, 3);
	uint8_t seen[10005] = { 0 };
	for (uint64_t k = 0; k < chunks; k++)
		for (uint32_t i = 0; i < c[k].points; i++) {
			const struct model_point *p = &model_points(m)[c[k].first + i];
			double x = c[k].centre_m[0] + p->position_m[0];
			for (int a = 0; a < 3; a++)
				g_assert_true(fabsf(p->position_m[a]) <= c[k].half_size_m[a]);
			seen[lrint((x - 902) * 1e3)]++;
			g_assert_cmpfloat(fabs(remainder((x - 902) * 1e3, 1)), <, 1e-3);
		}
	for (int i = 0; i < 10005; i++)
		g_assert_cmpuint(seen[i], ==, 1);
	g_assert_true(model_verify(m, &error));
}

static void test_damage(void)
{
	g_autofree char *path = write_model();
	g_autoptr(GError) error = NULL;
	FILE *f = fopen(path, "r+b");
	fseek(f, (long)(64 + 5000 * sizeof(struct model_point) + 3), SEEK_SET);
	int byte = fgetc(f);
	fseek(f, -1, SEEK_CUR);
	fputc(byte ^ 4, f);
	fclose(f);
	g_autoptr(model) m = model_open_file(path, &error);
	g_assert_no_error(error);
	g_assert_true(model_verify_chunk(m, 0, &error));
	g_assert_false(model_verify_chunk(m, 1, &error));
	g_assert_error(error, PRODUCT_ERROR, PRODUCT_ERROR_DAMAGED);
	g_assert_nonnull(strstr(error->message, "chunk 1"));
	g_clear_error(&error);
	g_assert_false(model_verify(m, &error));
}

/* Sections with right checksums that contradict each other. */
static void write_contradiction(const char *path, const struct model_chunk *chunks, size_t count)
{
	static const struct model_point p[10];
	g_autoptr(product_writer) w = product_writer_new(path, NULL);
	g_assert_true(product_writer_begin(w, "points", sizeof p[0], NULL));
	g_assert_true(product_writer_append(w, p, 10, NULL));
	g_assert_true(product_writer_begin(w, "chunks", sizeof *chunks, NULL));
	g_assert_true(product_writer_append(w, chunks, count, NULL));
	g_assert_true(product_writer_finish(w, MODEL_KIND, MODEL_VERSION, json_object_new(), NULL));
}

static void test_contradictions(void)
{
	static const struct model_chunk bad[][2] = {
		{ { .points = 4 }, { .first = 4, .points = 7 } },
		{ { .points = 4 }, { .first = 4, .points = 5 } },
		{ { .points = 4 }, { .first = 5, .points = 5 } },
		{ { .points = 10 }, { .first = 10 } },
		{ { .points = UINT32_MAX }, { .first = UINT32_MAX, .points = 11 } },
		{ { .points = 4, .half_size_m = { -1, 0, 0 } }, { .first = 4, .points = 6 } },
		{ { .points = 4, .centre_m = { 0, NAN, 0 } }, { .first = 4, .points = 6 } },
		{ { .points = 4 }, { .first = 4, .points = 6, .leaf = 65536 } },
	};
	static const struct model_chunk good[2] = { { .points = 4 }, { .first = 4, .points = 6 } };
	g_autofree char *folder = simulated_folder();
	g_autofree char *path = g_build_filename(folder, "m", NULL);
	write_contradiction(path, good, 2);
	g_autoptr(model) m = model_open_file(path, NULL);
	g_assert_nonnull(m);
	for (size_t i = 0; i < G_N_ELEMENTS(bad); i++) {
		g_autoptr(GError) error = NULL;
		write_contradiction(path, bad[i], 2);
		g_assert_null(model_open_file(path, &error));
		g_assert_error(error, PRODUCT_ERROR, PRODUCT_ERROR_DAMAGED);
	}
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/model/even-order", test_even_order);
	g_test_add_func("/model/normals", test_normals);
	g_test_add_func("/model/no-normal", test_no_normal);
	g_test_add_func("/model/halves", test_halves);
	g_test_add_func("/model/halves/known", test_halves_known);
	g_test_add_func("/model/order/permutation", test_order_is_a_permutation);
	g_test_add_func("/model/order/stratified", test_order_is_stratified);
	g_test_add_func("/model/order/uniform", test_order_is_uniform);
	g_test_add_func("/model/morton", test_morton);
	g_test_add_func("/model/sort", test_sort);
	g_test_add_func("/model/chunks", test_chunks);
	g_test_add_func("/model/damage", test_damage);
	g_test_add_func("/model/contradictions", test_contradictions);
	return g_test_run();
}
