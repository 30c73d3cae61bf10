#ifndef TESTS_COLA_MADE_H
#define TESTS_COLA_MADE_H
/* Telegrams of CoLa-A written from the layouts, on their own, and a decoder to give them to. */
#include "tests/collect.h"

struct bench {
	struct collected *got;
	decoder *d;
	const struct decoder_counts *counts;
};

static inline void feed(struct bench *b, const char *bytes, size_t length)
{
	decoder_feed(b->d, bytes, length, 42);
}

static inline void bench_open(struct bench *b, const char *text)
{
	b->got = collected_new();
	b->d = collected_decoder(b->got, "cola");
	b->counts = decoder_get_counts(b->d);
	feed(b, text, strlen(text));
}

static inline void bench_close(struct bench *b)
{
	decoder_free(b->d);
	collected_free(b->got);
}

/* Zero is the telegram of a TiM561 that saw nothing odd. */
struct made {
	const char *type, *head, *rates, *tail;
	uint32_t beams, wide_intensities, narrow_intensities;
	const char *scale; /* of DIST1, both numbers */
	const char *step;
	const char *before, *between; /* more 16-bit channels before and behind DIST1 */
	unsigned more;
};

static inline uint32_t made_range(uint32_t i)
{
	return 0x10 + 37 * i % 5000;
}

static inline void put_channel(
	GString *s, const char *name, const char *scale, const char *step, uint32_t count)
{
	g_string_append_printf(s, " %s %s FFF92230 %s %X", name, scale, step, count);
}

static inline GString *made_scan(const struct made *m)
{
	GString *s = g_string_new("\x02");
	const char *step = m->step ? m->step : "2710";
	uint32_t beams = m->beams ? m->beams : 271;
	g_string_append_printf(s, "%s LMDscandata %s %s %X%s", m->type ? m->type : "sSN",
		m->head ? m->head : "1 1 1A2B3C4 0 0 1FFE 2003 5A0B1C20 5A0B2B90 0 0 1 0 0",
		m->rates ? m->rates : "5DC 36 0", 1 + m->more + (m->wide_intensities > 0),
		m->before ? m->before : "");
	put_channel(s, "DIST1", m->scale ? m->scale : "3F800000 00000000", step, beams);
	for (uint32_t i = 0; i < beams; i++)
		g_string_append_printf(s, " %X", made_range(i));
	g_string_append(s, m->between ? m->between : "");
	if (m->wide_intensities)
		put_channel(s, "RSSI1", "3F800000 00000000", step, m->wide_intensities);
	for (uint32_t i = 0; i < m->wide_intensities; i++)
		g_string_append_printf(s, " %X", i * 100);
	g_string_append_printf(s, " %d", m->narrow_intensities > 0);
	if (m->narrow_intensities)
		put_channel(s, "RSSI1", "3F800000 00000000", step, m->narrow_intensities);
	for (uint32_t i = 0; i < m->narrow_intensities; i++)
		g_string_append_printf(s, " %X", i & 255);
	g_string_append_printf(s, " %s\x03", m->tail ? m->tail : "0 1 B not defined 0 0 0");
	return s;
}

static inline void feed_made(struct bench *b, const struct made *m)
{
	GString *s = made_scan(m);
	feed(b, s->str, s->len);
	g_string_free(s, TRUE);
}

static inline void assert_ranges(const struct scanline *line, uint32_t beams)
{
	g_assert_cmpuint(line->beams, ==, beams);
	for (uint32_t i = 0; i < beams; i++)
		g_assert_cmpuint(line->range_mm[i], ==, made_range(i));
}

#endif
