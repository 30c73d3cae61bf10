#include "firmware-io/crc32c.h"
#include <glib.h>
#include <string.h>

#define POLYNOMIAL 0x82f63b78u /* 1EDC6F41, bits reversed */

static uint32_t tables[8][256];
static uint32_t (*best_way)(uint32_t crc, const void *bytes, size_t length) = crc32c_by_tables;

/* tables[0][b] is the CRC of byte b; tables[n][b] that of b followed by n zeros, so that eight
 * bytes can be looked up side by side ("slicing by 8"). */
static void fill_tables(void)
{
	for (uint32_t b = 0; b < 256; b++) {
		uint32_t crc = b;
		for (int bit = 0; bit < 8; bit++)
			crc = crc >> 1 ^ (crc & 1 ? POLYNOMIAL : 0);
		tables[0][b] = crc;
	}
	for (int n = 1; n < 8; n++)
		for (uint32_t b = 0; b < 256; b++)
			tables[n][b] = tables[n - 1][b] >> 8 ^ tables[0][tables[n - 1][b] & 0xff];
}

static uint64_t load_le64(const uint8_t *p)
{
	uint64_t v;
	memcpy(&v, p, sizeof v);
	return GUINT64_FROM_LE(v);
}

uint32_t crc32c_by_tables(uint32_t crc, const void *bytes, size_t length)
{
	const uint8_t *p = bytes;
	crc = ~crc;
	for (; length >= 8; length -= 8, p += 8) {
		uint64_t v = load_le64(p) ^ crc;
		crc = tables[7][v & 0xff] ^ tables[6][v >> 8 & 0xff] ^ tables[5][v >> 16 & 0xff] ^
		      tables[4][v >> 24 & 0xff] ^ tables[3][v >> 32 & 0xff] ^
		      tables[2][v >> 40 & 0xff] ^ tables[1][v >> 48 & 0xff] ^ tables[0][v >> 56];
	}
	for (; length; length--, p++)
		crc = crc >> 8 ^ tables[0][(crc ^ *p) & 0xff];
	return ~crc;
}

#if defined __x86_64__
#include <nmmintrin.h>

__attribute__((target("sse4.2"))) uint32_t crc32c_by_instruction(
	uint32_t crc, const void *bytes, size_t length)
{
	const uint8_t *p = bytes;
	uint64_t sum = (uint32_t)~crc;
	for (; length >= 8; length -= 8, p += 8)
		sum = _mm_crc32_u64(sum, load_le64(p));
	uint32_t rest = (uint32_t)sum;
	for (; length; length--, p++)
		rest = _mm_crc32_u8(rest, *p);
	return ~rest;
}

bool crc32c_has_instruction(void)
{
	__builtin_cpu_init();
	return __builtin_cpu_supports("sse4.2");
}

#elif defined __ARM_FEATURE_CRC32
#include <arm_acle.h>

uint32_t crc32c_by_instruction(uint32_t crc, const void *bytes, size_t length)
{
	const uint8_t *p = bytes;
	crc = ~crc;
	for (; length >= 8; length -= 8, p += 8)
		crc = __crc32cd(crc, load_le64(p));
	for (; length; length--, p++)
		crc = __crc32cb(crc, *p);
	return ~crc;
}

bool crc32c_has_instruction(void)
{
	return true;
}

#else

uint32_t crc32c_by_instruction(uint32_t crc, const void *bytes, size_t length)
{
	return crc32c_by_tables(crc, bytes, length);
}

bool crc32c_has_instruction(void)
{
	return false;
}

#endif

/* Before main, so that no thread can come upon half-filled tables. */
__attribute__((constructor)) static void choose(void)
{
	fill_tables();
	if (crc32c_has_instruction())
		best_way = crc32c_by_instruction;
}

uint32_t crc32c(uint32_t crc, const void *bytes, size_t length)
{
	return best_way(crc, bytes, length);
}
