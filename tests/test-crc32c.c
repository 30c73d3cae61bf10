/* CRC-32C: known values, and the two ways of computing it against each other. */
#include "firmware-io/crc32c.h"
#include <glib.h>
#include <string.h>

typedef uint32_t way(uint32_t crc, const void *bytes, size_t length);

static void check_known(way *w)
{
	uint8_t zeros[32] = { 0 }, ones[32], rising[32], falling[32];
	memset(ones, 0xff, sizeof ones);
	for (int i = 0; i < 32; i++) {
		rising[i] = (uint8_t)i;
		falling[i] = (uint8_t)(31 - i);
	}
	/* RFC 3720, B.4 */
	g_assert_cmphex(w(0, zeros, 32), ==, 0x8a9136aa);
	g_assert_cmphex(w(0, ones, 32), ==, 0x62a8ab43);
	g_assert_cmphex(w(0, rising, 32), ==, 0x46dd794e);
	g_assert_cmphex(w(0, falling, 32), ==, 0x113fdb5c);
	g_assert_cmphex(w(0, "123456789", 9), ==, 0xe3069283);
	g_assert_cmphex(w(0, NULL, 0), ==, 0);
}

static void test_tables(void)
{
	check_known(crc32c_by_tables);
	check_known(crc32c);
}

static void test_instruction(void)
{
	if (!crc32c_has_instruction())
		g_test_skip("this processor has no instruction for it");
	else
		check_known(crc32c_by_instruction);
}

static void test_ways_agree(void)
{
	enum { SIZE = 600 };
	uint8_t bytes[SIZE];
	if (!crc32c_has_instruction()) {
		g_test_skip("this processor has no instruction for it");
		return;
	}
	for (int i = 0; i < SIZE; i++)
		bytes[i] = (uint8_t)g_test_rand_int();
	for (size_t start = 0; start < 9; start++)
		for (size_t length = 0; start + length < SIZE; length++)
			g_assert_cmphex(crc32c_by_tables(7, bytes + start, length), ==,
				crc32c_by_instruction(7, bytes + start, length));
}

static void test_pieces(void)
{
	uint8_t bytes[97];
	for (size_t i = 0; i < sizeof bytes; i++)
		bytes[i] = (uint8_t)(i * 37);
	uint32_t whole = crc32c(0, bytes, sizeof bytes);
	for (size_t cut = 0; cut <= sizeof bytes; cut++)
		g_assert_cmphex(
			crc32c(crc32c(0, bytes, cut), bytes + cut, sizeof bytes - cut), ==, whole);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/crc32c/tables", test_tables);
	g_test_add_func("/crc32c/instruction", test_instruction);
	g_test_add_func("/crc32c/ways-agree", test_ways_agree);
	g_test_add_func("/crc32c/pieces", test_pieces);
	return g_test_run();
}
