#ifndef TESTS_SCIP_MADE_H
#define TESTS_SCIP_MADE_H
/* Telegrams of SCIP written from the layouts, on their own, and a decoder to give them to. */
#include "tests/collect.h"

/* The lines of the manual. */
#define PP_URG                                                                                     \
	"PP\n00P\nMODL:URG-04LX(Hokuyo Automatic Co.,Ltd.);N\nDMIN:20;4\nDMAX:5600;_\n"            \
	"ARES:1024;\\\nAMIN:44;7\nAMAX:725;o\nAFRT:384;6\nSCAN:600;e\n\n"
#define VV_URG                                                                                     \
	"VV\n00P\nVEND:Hokuyo Automatic Co.,Ltd.;[\nPROD:SOKUIKI Sensor URG-04LX;[\n"              \
	"FIRM:3.1.00(18/Jan./2007);`\nPROT:SCIP 2.0;N\nSERI:H0614967;V\n\n"

struct bench {
	struct collected *got;
	decoder *d;
	const struct decoder_counts *counts;
};

static inline void bench_open(struct bench *b, const char *parameters)
{
	b->got = collected_new();
	b->d = collected_decoder(b->got, "scip");
	b->counts = decoder_get_counts(b->d);
	decoder_feed(b->d, parameters, strlen(parameters), 1);
}

static inline void bench_close(struct bench *b)
{
	decoder_free(b->d);
	collected_free(b->got);
}

static inline void feed(struct bench *b, const GString *s)
{
	decoder_feed(b->d, s->str, s->len, 42);
}

static inline void feed_text(struct bench *b, const char *text)
{
	decoder_feed(b->d, text, strlen(text), 42);
}

/* The device's side, written on its own from the layouts. */

static inline void put_number(GString *s, uint32_t value, int chars)
{
	for (int i = chars - 1; i >= 0; i--)
		g_string_append_c(s, (char)((value >> 6 * i & 63) + 0x30));
}

static inline void put_line(GString *s, const char *text, size_t length)
{
	unsigned sum = 0;
	for (size_t i = 0; i < length; i++)
		sum += (uint8_t)text[i];
	g_string_append_len(s, text, (gssize)length);
	g_string_append_c(s, (char)((sum & 63) + 0x30));
	g_string_append_c(s, '\n');
}

static inline GString *telegram(
	const char *echo, const char *status, uint32_t time_ms, const GString *values)
{
	GString *s = g_string_new(echo), *time = g_string_new(NULL);
	g_string_append_c(s, '\n');
	put_line(s, status, 2);
	put_number(time, time_ms, 4);
	put_line(s, time->str, time->len);
	for (size_t at = 0; at < values->len; at += 64)
		put_line(s, values->str + at, MIN(64, values->len - at));
	g_string_append_c(s, '\n');
	g_string_free(time, TRUE);
	return s;
}

static inline uint32_t made_range(uint32_t i)
{
	return 1000 + 3 * i;
}

/* Steps of one scan: distances 1000 + 3i, intensities 500 + i, up to two more echoes. */
static inline GString *made_values(uint32_t steps, int chars, bool intensity, bool echoes)
{
	GString *s = g_string_new(NULL);
	for (uint32_t i = 0; i < steps; i++)
		for (uint32_t echo = 0; echo <= (echoes ? i % 3 : 0); echo++) {
			if (echo > 0)
				g_string_append_c(s, '&');
			put_number(s, made_range(i) + 700 * echo, chars);
			if (intensity)
				put_number(s, 500 + i + 9000 * echo, 3);
		}
	return s;
}

static inline GString *made_telegram(const char *echo, const char *status, uint32_t steps)
{
	bool intensity = echo[1] == 'E', echoes = echo[0] == 'H' || echo[0] == 'N';
	GString *values = made_values(steps, echo[1] == 'S' ? 2 : 3, intensity, echoes);
	GString *s = telegram(echo, status, 12345, values);
	g_string_free(values, TRUE);
	return s;
}

static inline void assert_made(const struct bench *b, uint32_t steps, bool intensity)
{
	const struct scanline *line = &b->got->line;
	g_assert_cmpuint(line->beams, ==, steps);
	g_assert_true((line->intensity != NULL) == intensity);
	for (uint32_t i = 0; i < steps; i++) {
		g_assert_cmpuint(line->range_mm[i], ==, made_range(i));
		if (intensity)
			g_assert_cmpuint(line->intensity[i], ==, 500 + i);
	}
}

static inline void assert_refused(const struct bench *b, unsigned bad_sums, unsigned malformed)
{
	g_assert_cmpuint(b->counts->bad_sums, ==, bad_sums);
	g_assert_cmpuint(b->counts->malformed, ==, malformed);
}

#endif
