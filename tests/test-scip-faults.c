/* The SCIP decoder and every fault of a wire. Every scene ends with a whole telegram, which must
 * come out. */
#include "tests/scip-made.h"

static GString *scan_of_time(const char *echo, uint32_t time_ms)
{
	GString *values = made_values(60, 3, echo[1] == 'E', echo[0] == 'N');
	GString *s = telegram(echo, "99", time_ms, values);
	g_string_free(values, TRUE);
	return s;
}

static const char *const fault_echoes[] = { "MD0044010301000", "ME0044010301000",
	"NE0044010301000" };

/* What a feed of first and then a whole telegram of time 777 gives: the hash of what first alone
 * gave out, and whether the whole one came. */
static unsigned feed_then_whole(
	const GString *first, const char *echo, bool *ret_same, uint64_t alone)
{
	struct bench b;
	GString *whole = scan_of_time(echo, 777);
	bench_open(&b, PP_URG);
	b.got->hash = 0;
	feed(&b, first);
	unsigned scanlines = b.got->scanlines;
	*ret_same = scanlines == 0 || b.got->hash == alone;
	feed(&b, whole);
	g_assert_cmpuint(b.got->scanlines, ==, scanlines + 1);
	g_assert_cmpuint(b.got->line.ticks, ==, 777);
	assert_made(&b, 60, echo[1] == 'E');
	g_string_free(whole, TRUE);
	bench_close(&b);
	return scanlines;
}

static uint64_t hash_of(const GString *s)
{
	struct bench b;
	bench_open(&b, PP_URG);
	b.got->hash = 0;
	feed(&b, s);
	uint64_t hash = b.got->hash;
	g_assert_cmpuint(b.got->scanlines, ==, 1);
	bench_close(&b);
	return hash;
}

/* Of all flips only those in the interval and the count of the echo, which has no sum, leave a
 * scan, and that is the same scan; so does a cluster of 01 that becomes 00 and means the same. */
static void test_every_bit_flipped(gconstpointer data)
{
	const char *echo = data;
	GString *s = scan_of_time(echo, 12345);
	uint64_t alone = hash_of(s);
	unsigned accepted = 0, acceptable = 0;
	for (size_t bit = 0; bit < s->len * 8; bit++) {
		GString *flipped = g_string_new_len(s->str, (gssize)s->len);
		bool same;
		flipped->str[bit / 8] ^= (char)(1 << bit % 8);
		char c = flipped->str[bit / 8];
		bool in_digits = bit / 8 >= 12 && bit / 8 < 15;
		acceptable += (in_digits && g_ascii_isdigit(c)) || bit == 11 * 8;
		accepted += feed_then_whole(flipped, echo, &same, alone);
		g_assert_true(same);
		g_string_free(flipped, TRUE);
	}
	g_assert_cmpuint(accepted, ==, acceptable);
	g_string_free(s, TRUE);
}

static void test_every_byte_dropped(gconstpointer data)
{
	const char *echo = data;
	GString *s = scan_of_time(echo, 12345);
	uint64_t alone = hash_of(s);
	for (size_t at = 0; at < s->len; at++) {
		GString *cut = g_string_new_len(s->str, (gssize)s->len);
		bool same;
		g_string_erase(cut, (gssize)at, 1);
		unsigned scanlines = feed_then_whole(cut, echo, &same, alone);
		g_assert_cmpuint(scanlines, ==, 0);
		g_string_free(cut, TRUE);
	}
	g_string_free(s, TRUE);
}

/* Cut anywhere, the next telegram following at once. */
static void test_every_cut(gconstpointer data)
{
	const char *echo = data;
	GString *s = scan_of_time(echo, 12345);
	for (size_t length = 0; length < s->len; length++) {
		GString *cut = g_string_new_len(s->str, (gssize)length);
		bool same;
		g_assert_cmpuint(feed_then_whole(cut, echo, &same, 0), ==, 0);
		g_string_free(cut, TRUE);
	}
	g_string_free(s, TRUE);
}

/* The same in one feed. */
static void assert_only_whole(const GString *first, const char *echo)
{
	struct bench b;
	GString *whole = scan_of_time(echo, 777);
	g_string_prepend_len(whole, first->str, (gssize)first->len);
	bench_open(&b, PP_URG);
	feed(&b, whole);
	g_assert_cmpuint(b.got->scanlines, ==, 1);
	g_assert_cmpuint(b.got->line.ticks, ==, 777);
	g_string_free(whole, TRUE);
	bench_close(&b);
}

/* A cut line of values that takes the next echo along, made so that all looks like one good line,
 * the echo's last digit being its sum: a full one and shorter ones. */
static void test_echo_in_a_good_line(void)
{
	const char *echo = "MD0044010301000";
	for (size_t chars = 1; chars <= 50; chars++) {
		GString *s = g_string_new("MD0044010301000\n99b\n030il\n");
		unsigned sum = 0;
		bool same;
		for (size_t i = 0; i < 14; i++)
			sum += (uint8_t)echo[i];
		for (size_t i = 1; i < chars; i++) {
			g_string_append_c(s, 'Z');
			sum += 'Z';
		}
		g_string_append_c(s, (char)(0x30 + ((0u - sum - 0x30) & 63)));
		g_assert_cmpuint(feed_then_whole(s, echo, &same, 0), ==, 0);
		assert_only_whole(s, echo);
		g_string_free(s, TRUE);
	}
}

/* Good sums, the right number of digits, but a line that is too short before the last. */
static void test_short_line_inside(void)
{
	GString *s = g_string_new("MD0000000301000\n99b\n030il\n");
	bool same;
	put_line(s, "0?X0?[", 6);
	put_line(s, "0?^0?a", 6);
	g_string_append_c(s, '\n');
	g_assert_cmpuint(feed_then_whole(s, "MD0044010301000", &same, 0), ==, 0);
	g_string_free(s, TRUE);
}

/* Bits 6 and 7 are not in a sum. Bit 7 makes no text; bit 6 may go unseen. */
static void test_reply_bits_flipped(void)
{
	const size_t first = strlen("PP\n00P\n"), last = strlen(PP_URG) - 2;
	for (size_t at = first; at < last; at++)
		for (int bit = 0; bit < 8; bit++) {
			struct bench b;
			g_autofree char *flipped = g_strdup(PP_URG);
			if (bit == 6 || flipped[at] == '\n')
				continue;
			flipped[at] ^= (char)(1 << bit);
			bench_open(&b, flipped);
			g_assert_cmpuint(b.got->replies, ==, 0);
			g_assert_cmpuint(decoder_identity(b.d)->beams, ==, 0);
			bench_close(&b);
		}
}

static const struct garbage {
	const char *bytes;
	size_t length;
} garbages[] = {
	{ "\n", 1 },
	{ "\r\n\r\n", 4 },
	{ "\0\0\0\0", 4 },
	{ "0?X0?[0?", 8 },
	{ "garbage\n", 8 },
	{ "VV\n", 3 },
	{ "QT\n00Q\n", 7 },
	{ "MD0044010301000\n", 16 },
	{ "MD0044010301000\n99b\n", 20 },
	{ "VV\n00P\nVEND:x;", 14 },
	{ "\xff\xfe;;;\x02\x03", 7 },
};

static void test_garbage(void)
{
	for (const struct garbage *g = garbages; g < garbages + G_N_ELEMENTS(garbages); g++) {
		GString *before = g_string_new_len(g->bytes, (gssize)g->length);
		GString *s = scan_of_time("MD0044010301000", 12345);
		uint64_t alone = hash_of(s);
		bool same;
		feed_then_whole(before, "MD0044010301000", &same, 0);
		/* Inside, after the second line of values. */
		g_string_insert_len(s, 16 + 4 + 6 + 66, g->bytes, (gssize)g->length);
		g_assert_cmpuint(feed_then_whole(s, "MD0044010301000", &same, alone), ==, 0);
		g_string_free(before, TRUE);
		g_string_free(s, TRUE);
	}
}

static void test_counts(void)
{
	struct bench b;
	GString *s = scan_of_time("MD0044010301000", 12345);
	bench_open(&b, "");
	feed(&b, s);
	g_assert_cmpuint(b.got->scanlines, ==, 0); /* nobody knows its angles */
	assert_refused(&b, 0, 1);
	feed_text(&b, PP_URG "not an echo\n\n");
	g_assert_cmpuint(b.counts->skipped_bytes, ==, 12);
	feed_text(&b, "MD0044010301000\n99c\n\n");
	assert_refused(&b, 1, 1);
	s->str[30]++;
	feed(&b, s);
	assert_refused(&b, 2, 1);
	feed_text(&b, "MD9999000001000\n99b\n030il\n\n");
	assert_refused(&b, 2, 2);
	feed_text(&b, "PP\n00P\nDMIN:20;4\n\n");
	assert_refused(&b, 2, 3);
	g_assert_cmpuint(decoder_identity(b.d)->beams, ==, 682);
	g_assert_cmpuint(b.counts->scanlines, ==, 0);
	g_assert_cmpuint(b.counts->replies, ==, 2);
	g_string_free(s, TRUE);
	bench_close(&b);
}

/* The same bytes in pieces of every length, with each kind of line end. */
static void test_pieces(gconstpointer data)
{
	GString *s = g_string_new(PP_URG VV_URG "MD0044010301000\n00P\n\n");
	for (uint32_t i = 0; i < 3; i++) {
		GString *scan = scan_of_time(fault_echoes[i], i);
		g_string_append_len(s, scan->str, (gssize)scan->len);
		g_string_free(scan, TRUE);
	}
	g_string_replace(s, "\n", data, 0);
	uint64_t hash = 0;
	for (size_t piece = s->len; piece > 0; piece--) {
		struct bench b;
		bench_open(&b, "");
		for (size_t at = 0; at < s->len; at += piece)
			decoder_feed(b.d, s->str + at, MIN(piece, s->len - at), (int64_t)at);
		g_assert_cmpuint(b.got->scanlines, ==, 3);
		g_assert_cmpuint(b.got->replies, ==, 3);
		g_assert_true(hash == 0 || hash == b.got->hash);
		hash = b.got->hash;
		bench_close(&b);
	}
	g_string_free(s, TRUE);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	for (size_t i = 0; i < G_N_ELEMENTS(fault_echoes); i++) {
		g_autofree char *kind = g_strndup(fault_echoes[i], 2);
		g_autofree char *flip = g_strdup_printf("/scip-faults/every-bit-flipped/%s", kind);
		g_autofree char *drop = g_strdup_printf("/scip-faults/every-byte-dropped/%s", kind);
		g_autofree char *cut = g_strdup_printf("/scip-faults/every-cut/%s", kind);
		g_test_add_data_func(flip, fault_echoes[i], test_every_bit_flipped);
		g_test_add_data_func(drop, fault_echoes[i], test_every_byte_dropped);
		g_test_add_data_func(cut, fault_echoes[i], test_every_cut);
	}
	g_test_add_func("/scip-faults/echo-in-a-good-line", test_echo_in_a_good_line);
	g_test_add_func("/scip-faults/short-line-inside", test_short_line_inside);
	g_test_add_func("/scip-faults/reply-bits-flipped", test_reply_bits_flipped);
	g_test_add_func("/scip-faults/garbage", test_garbage);
	g_test_add_func("/scip-faults/counts", test_counts);
	g_test_add_data_func("/scip-faults/pieces/LF", "\n", test_pieces);
	g_test_add_data_func("/scip-faults/pieces/CR", "\r", test_pieces);
	g_test_add_data_func("/scip-faults/pieces/CRLF", "\r\n", test_pieces);
	return g_test_run();
}
