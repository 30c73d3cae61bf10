#include "firmware-io/sha256.h"
#include <stdint.h>
#include <string.h>

#define BLOCK_BYTES 64

struct sha256 {
	GChecksum *portable; /* NULL: the processor does it */
	uint32_t state[8];
	uint64_t length;
	uint8_t rest[BLOCK_BYTES]; /* length % BLOCK_BYTES of it */
};

#if defined(__x86_64__)
#include <immintrin.h>

/* The first 32 bits of the fractions of the cube roots of the first 64 primes. */
static const uint32_t constants[64] = { 0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b,
	0x59f111f1, 0x923f82a4, 0xab1c5ed5, 0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3,
	0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174, 0xe49b69c1, 0xefbe4786, 0x0fc19dc6,
	0x240ca1cc, 0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da, 0x983e5152, 0xa831c66d,
	0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967, 0x27b70a85,
	0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
	0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585,
	0x106aa070, 0x19a4c116, 0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a,
	0x5b9cca4f, 0x682e6ff3, 0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa,
	0xa4506ceb, 0xbef9a3f7, 0xc67178f2 };

static bool has_instructions(void)
{
	uint32_t a, b, c, d;
	__asm__("cpuid" : "=a"(a), "=b"(b), "=c"(c), "=d"(d) : "a"(7), "c"(0));
	return (b >> 29 & 1) && __builtin_cpu_supports("sse4.1") && __builtin_cpu_supports("ssse3");
}

/* The state lies as the instructions want it, A B E F and C D G H from the highest lane down. */
__attribute__((target("sha,sse4.1,ssse3"))) static void add_blocks(
	uint32_t state[8], const uint8_t *bytes, size_t blocks)
{
	const __m128i swap = _mm_set_epi64x(0x0c0d0e0f08090a0b, 0x0405060700010203);
	__m128i abef = _mm_set_epi32((int)state[0], (int)state[1], (int)state[4], (int)state[5]);
	__m128i cdgh = _mm_set_epi32((int)state[2], (int)state[3], (int)state[6], (int)state[7]);
	for (; blocks; blocks--, bytes += BLOCK_BYTES) {
		__m128i abef_before = abef, cdgh_before = cdgh, w[4];
		for (int i = 0; i < 4; i++)
			w[i] = _mm_shuffle_epi8(
				_mm_loadu_si128((const __m128i *)(const void *)(bytes + 16 * i)),
				swap);
#pragma GCC unroll 16
		for (int i = 0; i < 16; i++) {
			__m128i now = w[i % 4];
			__m128i k =
				_mm_loadu_si128((const __m128i *)(const void *)(constants + 4 * i));
			__m128i sum = _mm_add_epi32(now, k);
			cdgh = _mm_sha256rnds2_epu32(cdgh, abef, sum);
			abef = _mm_sha256rnds2_epu32(abef, cdgh, _mm_shuffle_epi32(sum, 0x0e));
			/* The words of four rounds ahead: w16 = s1(w14) + w9 + s0(w1) + w0. */
			__m128i w9 = _mm_alignr_epi8(w[(i + 3) % 4], w[(i + 2) % 4], 4);
			__m128i next = _mm_add_epi32(_mm_sha256msg1_epu32(now, w[(i + 1) % 4]), w9);
			w[i % 4] = _mm_sha256msg2_epu32(next, w[(i + 3) % 4]);
		}
		abef = _mm_add_epi32(abef, abef_before);
		cdgh = _mm_add_epi32(cdgh, cdgh_before);
	}
	state[0] = (uint32_t)_mm_extract_epi32(abef, 3);
	state[1] = (uint32_t)_mm_extract_epi32(abef, 2);
	state[4] = (uint32_t)_mm_extract_epi32(abef, 1);
	state[5] = (uint32_t)_mm_extract_epi32(abef, 0);
	state[2] = (uint32_t)_mm_extract_epi32(cdgh, 3);
	state[3] = (uint32_t)_mm_extract_epi32(cdgh, 2);
	state[6] = (uint32_t)_mm_extract_epi32(cdgh, 1);
	state[7] = (uint32_t)_mm_extract_epi32(cdgh, 0);
}
#else
static bool has_instructions(void)
{
	return false;
}

static void add_blocks(uint32_t state[8], const uint8_t *bytes, size_t blocks)
{
	(void)state, (void)bytes, (void)blocks;
	g_assert_not_reached();
}
#endif

sha256 *sha256_new(void)
{
	static const uint32_t start[8] = { 0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
		0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19 };
	sha256 *s = g_new0(sha256, 1);
	memcpy(s->state, start, sizeof start);
	if (!has_instructions())
		s->portable = g_checksum_new(G_CHECKSUM_SHA256);
	return s;
}

void sha256_free(sha256 *s)
{
	if (!s)
		return;
	if (s->portable)
		g_checksum_free(s->portable);
	g_free(s);
}

static void update(sha256 *s, const uint8_t *bytes, size_t length)
{
	size_t held = s->length % BLOCK_BYTES, fits = MIN(length, BLOCK_BYTES - held);
	s->length += length;
	if (held) {
		memcpy(s->rest + held, bytes, fits);
		if (held + fits < BLOCK_BYTES)
			return;
		add_blocks(s->state, s->rest, 1);
		bytes += fits;
		length -= fits;
	}
	add_blocks(s->state, bytes, length / BLOCK_BYTES);
	memcpy(s->rest, bytes + length / BLOCK_BYTES * BLOCK_BYTES, length % BLOCK_BYTES);
}

void sha256_update(sha256 *s, const void *bytes, size_t length)
{
	/* GChecksum counts with signed sizes. */
	for (size_t part; length && s->portable; length -= part) {
		part = MIN(length, (size_t)1 << 30);
		g_checksum_update(s->portable, bytes, (gssize)part);
		bytes = (const uint8_t *)bytes + part;
	}
	if (length)
		update(s, bytes, length);
}

/* A one bit, zeros, and the length in bits. */
static void pad(sha256 *s)
{
	static const uint8_t padding[BLOCK_BYTES] = { 0x80 };
	uint64_t bits = GUINT64_TO_BE(s->length * 8);
	size_t held = s->length % BLOCK_BYTES;
	update(s, padding, held < 56 ? 56 - held : 120 - held);
	update(s, (const uint8_t *)&bits, sizeof bits);
}

char *sha256_end(sha256 *s)
{
	if (s->portable)
		return g_strdup(g_checksum_get_string(s->portable));
	pad(s);
	GString *text = g_string_new(NULL);
	for (int i = 0; i < 8; i++)
		g_string_append_printf(text, "%08x", s->state[i]);
	return g_string_free(text, FALSE);
}

char *sha256_of(const void *bytes, size_t length)
{
	g_autoptr(sha256) s = sha256_new();
	sha256_update(s, bytes, length);
	return sha256_end(s);
}
