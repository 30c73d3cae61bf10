#ifndef TESTS_FUZZ_DECODER_H
#define TESTS_FUZZ_DECODER_H
/* The body of the decoders' fuzz targets: the same bytes at once and in pieces must give the same.
 */
#include "tests/collect.h"

/* pieces says how long the pieces are, over and over: 1 to 256 bytes. */
static inline void fuzz_feed(decoder *d, const uint8_t *bytes, size_t length, const uint8_t *pieces,
	size_t pieces_length)
{
	for (size_t at = 0, piece = 0; at < length; piece++) {
		size_t wanted = pieces_length > 0 ? pieces[piece % pieces_length] + 1u : length;
		size_t n = MIN(wanted, length - at);
		/* A copy of its own, so that a read past the piece is seen. */
		uint8_t *copy = g_memdup2(bytes + at, n);
		decoder_feed(d, copy, n, 0);
		g_free(copy);
		at += n;
	}
}

/* The first byte says how many of the following are pieces; the rest comes from the device, behind
 * the given start. */
static inline void fuzz_decoder(
	const char *protocol, const char *start, const uint8_t *data, size_t size)
{
	if (size < 1)
		return;
	size_t pieces_length = MIN(data[0] & 15u, size - 1);
	const uint8_t *pieces = data + 1, *bytes = pieces + pieces_length;
	size_t length = size - 1 - pieces_length;
	struct collected *whole = collected_new(), *cut = collected_new();
	decoder *a = collected_decoder(whole, protocol), *b = collected_decoder(cut, protocol);
	if (data[0] & 16) {
		decoder_feed(a, start, strlen(start), 0);
		decoder_feed(b, start, strlen(start), 0);
	}
	fuzz_feed(a, bytes, length, NULL, 0);
	fuzz_feed(b, bytes, length, pieces, pieces_length);
	g_assert_cmpuint(whole->scanlines, ==, cut->scanlines);
	g_assert_cmpuint(whole->replies, ==, cut->replies);
	g_assert_cmphex(whole->hash, ==, cut->hash);
	g_assert_cmpmem(decoder_get_counts(a), sizeof(struct decoder_counts), decoder_get_counts(b),
		sizeof(struct decoder_counts));
	g_assert_cmpuint(decoder_get_counts(a)->skipped_bytes, <=, size + strlen(start) + 1);
	decoder_free(a);
	decoder_free(b);
	collected_free(whole);
	collected_free(cut);
}

#endif
