#ifndef ACQUIRE_BYTES_H
#define ACQUIRE_BYTES_H
/* Small helpers of the decoders over runs of wire bytes. */
#include <glib.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#define BYTES_EVERY(b) (UINT64_C(0x0101010101010101) * (uint8_t)(b))

/* The high bit of the lowest byte of word that is zero; what stands above that one is not exact. */
static inline uint64_t bytes_zero_mask(uint64_t word)
{
	return (word - BYTES_EVERY(0x01)) & ~word & BYTES_EVERY(0x80);
}

/* Eight bytes, the first one lowest, on every machine. */
static inline uint64_t bytes_load64(const char *at)
{
	uint64_t word;
	memcpy(&word, at, sizeof word);
	return GUINT64_FROM_LE(word);
}

/* The first a or b in at..end, or end. Two memchr would be simpler, but a stream without one of the
 * two bytes would make them look through all that follows, again for every line. */
static inline const char *bytes_find_either(const char *at, const char *end, char a, char b)
{
	for (; end - at >= 8; at += 8) {
		uint64_t word = bytes_load64(at);
		uint64_t hit = bytes_zero_mask(word ^ BYTES_EVERY(a)) |
			       bytes_zero_mask(word ^ BYTES_EVERY(b));
		if (hit)
			return at + (__builtin_ctzll(hit) >> 3);
	}
	while (at < end && *at != a && *at != b)
		at++;
	return at;
}

/* A name from the wire as a string for people and manifests: cut to size, '?' for what is not
 * printable ASCII. */
static inline void bytes_copy_name(char *to, size_t size, const char *from, size_t length)
{
	size_t n = MIN(length, size - 1);
	for (size_t i = 0; i < n; i++)
		to[i] = g_ascii_isprint(from[i]) ? from[i] : '?';
	to[n] = '\0';
}

#endif
