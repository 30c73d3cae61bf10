/* SHA-256 against GLib's, at all lengths around a block and in parts of any size. */
#include "firmware-io/sha256.h"
#include <stdint.h>

static void test_known(void)
{
	g_autofree char *empty = sha256_of("", 0), *abc = sha256_of("abc", 3);
	g_assert_cmpstr(
		empty, ==, "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
	g_assert_cmpstr(
		abc, ==, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

static void test_lengths(void)
{
	uint8_t bytes[400];
	g_autoptr(GRand) rand = g_rand_new_with_seed(3);
	for (size_t i = 0; i < sizeof bytes; i++)
		bytes[i] = (uint8_t)g_rand_int(rand);
	for (size_t length = 0; length <= sizeof bytes; length++) {
		g_autofree char *got = sha256_of(bytes, length),
				*wanted = g_compute_checksum_for_data(
					G_CHECKSUM_SHA256, bytes, length);
		g_assert_cmpstr(got, ==, wanted);
	}
}

static void test_parts(void)
{
	g_autofree uint8_t *bytes = g_malloc(100000);
	g_autoptr(GRand) rand = g_rand_new_with_seed(4);
	for (size_t i = 0; i < 100000; i++)
		bytes[i] = (uint8_t)g_rand_int(rand);
	g_autofree char *wanted = g_compute_checksum_for_data(G_CHECKSUM_SHA256, bytes, 100000);
	for (int most = 1; most < 3000; most = most * 2 + 1) {
		g_autoptr(sha256) s = sha256_new();
		for (size_t at = 0; at < 100000;) {
			size_t part = (size_t)g_rand_int_range(rand, 0, most + 1);
			part = MIN(part, 100000 - at);
			sha256_update(s, bytes + at, part);
			at += part;
		}
		g_autofree char *got = sha256_end(s);
		g_assert_cmpstr(got, ==, wanted);
	}
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/sha256/known", test_known);
	g_test_add_func("/sha256/lengths", test_lengths);
	g_test_add_func("/sha256/parts", test_parts);
	return g_test_run();
}
