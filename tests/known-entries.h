#ifndef TESTS_KNOWN_ENTRIES_H
#define TESTS_KNOWN_ENTRIES_H
/* Entries whose every byte follows from their number, so that what comes back can be judged without
 * keeping what was written. For record tests. */
#include "firmware-io/record.h"
#include <string.h>

struct known {
	enum record_kind kind;
	int64_t time_ns;
	uint32_t length;
	uint8_t *payload; /* caller frees */
};

static inline uint64_t known_random(uint64_t *state)
{
	*state ^= *state << 13;
	*state ^= *state >> 7;
	return *state ^= *state << 17;
}

/* Lengths are 0 .. longest; every eighth payload is empty. */
static inline struct known known_entry(uint32_t number, uint32_t longest)
{
	uint64_t state = (number + 1) * 0x9e3779b97f4a7c15u;
	struct known k = {
		.kind = 1 + (enum record_kind)(known_random(&state) % (RECORD_KINDS - 1)),
		.time_ns = (int64_t)known_random(&state),
		.length = (uint32_t)(known_random(&state) % (longest + 1)),
	};
	if (number % 8 == 5)
		k.length = 0;
	k.payload = g_malloc0(k.length + 8);
	for (uint32_t i = 0; i < k.length; i += 8) {
		uint64_t word = known_random(&state);
		memcpy(k.payload + i, &word, MIN(8, k.length - i));
	}
	return k;
}

/* In two parts, cut at a place that differs from entry to entry. */
static inline bool known_write(record_writer *w, uint32_t number, uint32_t longest, GError **error)
{
	struct known k = known_entry(number, longest);
	uint32_t cut = number % 3 ? (uint32_t)((uint64_t)k.length * (number % 5) / 4) : k.length;
	bool ok = record_write(w, k.kind, k.time_ns, k.payload, cut,
		cut < k.length ? k.payload + cut : NULL, k.length - cut, error);
	g_free(k.payload);
	return ok;
}

static inline void known_check(const struct record_entry *e, uint32_t longest)
{
	struct known k = known_entry(e->sequence, longest);
	g_assert_cmpint(e->kind, ==, k.kind);
	g_assert_cmpint(e->time_ns, ==, k.time_ns);
	g_assert_cmpuint(e->length, ==, k.length);
	g_assert_cmpuint((uintptr_t)e->payload % 8, ==, 0);
	g_assert_true(memcmp(e->payload, k.payload, k.length) == 0);
	g_free(k.payload);
}

#endif
