/* The CoLa-A decoder and every fault of a wire. Whatever came before, the next whole telegram comes
 * out. */
#include "acquire/cola.h"
#include "tests/cola-made.h"

static void assert_next_comes(struct bench *b)
{
	unsigned scanlines = b->got->scanlines;
	feed_made(b, &(struct made){ .narrow_intensities = 271 });
	g_assert_cmpuint(b->got->scanlines, ==, scanlines + 1);
	assert_ranges(&b->got->line, 271);
}

static const struct {
	const char *wire;
	unsigned malformed, skipped;
} refused[] = {
	{ "junk", 0, 4 },
	{ "\x03\x03", 0, 2 },
	{ "\x02\x03", 1, 0 },
	{ "\x02sRA\x03", 1, 0 },
	{ "\x02sFA\x03", 1, 0 },
	{ "\x02sFA G\x03", 1, 0 },
	{ "\x02sFA 1 2\x03", 1, 0 },
	{ "\x02sRN DeviceIdent\x03", 1, 0 },
	{ "\x02sRA DeviceIdent \x01\x03", 1, 0 },
	{ "\x02sSN LMDscandata \x03", 1, 0 },
	{ "\x02sSN LMDscandata 1 1\x02sFA 1\x03", 1, 0 },
	{ "\x02\x02\x02\x02", 3, 0 },
};

static void test_refused(void)
{
	for (size_t i = 0; i < G_N_ELEMENTS(refused); i++) {
		struct bench b;
		bench_open(&b, refused[i].wire);
		g_assert_cmpuint(b.got->scanlines, ==, 0);
		g_assert_cmpuint(b.counts->malformed, ==, refused[i].malformed);
		g_assert_cmpuint(b.counts->skipped_bytes, ==, refused[i].skipped);
		assert_next_comes(&b);
		bench_close(&b);
	}
}

static const struct made wrong[] = {
	{ .tail = "0 0 0 0" },
	{ .tail = "0 0 0 0 0 0" },
	{ .tail = "0 1 C not defined 0 0 0" },
	{ .tail = "0 1 A not defined 0 0 0" },
	{ .tail = "2 0 0 0 0" },
	{ .narrow_intensities = 271, .tail = "0 0 0 0 0", .more = 1 },
	{ .rates = "5DC 36 1" },
	{ .rates = "5DC 36 1 1 1 1" },
	{ .head = "1 1 1 0 0 10000 1 1 1 0 0 0 0 0" },
	{ .head = "1 1 1 0 0 1 1 100000000 1 0 0 0 0 0" },
	{ .head = "1 1 1 0 0 1 1 1 1 0 0 0 0" },
	{ .head = "1 1 1 0 0 1 1 1000 F000000 0 0 0 0 0", .rates = "0 5DC 36 0" },
	{ .scale = "7FC00000 00000000" },
	{ .scale = "7F800000 00000000" },
	{ .scale = "00000000 00000000" },
	{ .scale = "3F800000 7FC00000" },
	{ .scale = "BF800000 00000000" },
	{ .before = " DIST2 3F800000 0 FFF92230 2710 10001 1", .more = 1 },
};

static void test_wrong(void)
{
	for (size_t i = 0; i < G_N_ELEMENTS(wrong); i++) {
		struct bench b;
		bench_open(&b, "");
		feed_made(&b, &wrong[i]);
		g_assert_cmpuint(b.got->scanlines, ==, 0);
		g_assert_cmpuint(b.counts->malformed, ==, 1);
		assert_next_comes(&b);
		bench_close(&b);
	}
}

/* One value more than there can be, and all of them there. */
static void test_great_count(void)
{
	for (uint32_t beams = 65536; beams <= 65537; beams++) {
		struct bench b;
		bench_open(&b, "");
		feed_made(&b, &(struct made){ .beams = beams });
		g_assert_cmpuint(b.got->scanlines, ==, beams == 65536);
		g_assert_cmpuint(b.counts->malformed, ==, beams != 65536);
		assert_next_comes(&b);
		bench_close(&b);
	}
}

static void test_every_byte_dropped(void)
{
	GString *s = made_scan(&(struct made){ .beams = 41, .narrow_intensities = 41 });
	for (size_t at = 0; at < s->len; at++) {
		struct bench b;
		bench_open(&b, "");
		feed(&b, s->str, at);
		feed(&b, s->str + at + 1, s->len - at - 1);
		bool of_a_longer_number = at > 0 && s->str[at] != ' ' && at + 1 < s->len &&
					  (s->str[at - 1] != ' ' || s->str[at + 1] != ' ');
		g_assert_cmpuint(b.got->scanlines, <=, of_a_longer_number);
		assert_next_comes(&b);
		bench_close(&b);
	}
	g_string_free(s, TRUE);
}

/* There is no sum, so a digit that became another digit is believed, and so is any name; all else
 * is refused. */
static void test_every_bit_flipped(void)
{
	GString *s = made_scan(&(struct made){ .beams = 41, .narrow_intensities = 41 });
	size_t channel = (size_t)(strstr(s->str, "RSSI1") - s->str);
	for (size_t bit = 0; bit < s->len * 8; bit++) {
		struct bench b;
		bench_open(&b, "");
		s->str[bit / 8] ^= (char)(1 << bit % 8);
		char c = s->str[bit / 8];
		feed(&b, s->str, s->len);
		bool believable = g_ascii_isxdigit(c) && !g_ascii_islower(c);
		bool in_name = (bit / 8 >= s->len - 18 && bit / 8 < s->len - 7) ||
			       (bit / 8 >= channel && bit / 8 < channel + 5);
		g_assert_cmpuint(b.got->scanlines, <=, believable || in_name);
		s->str[bit / 8] ^= (char)(1 << bit % 8);
		assert_next_comes(&b);
		bench_close(&b);
	}
	g_string_free(s, TRUE);
}

static void test_every_cut(void)
{
	GString *s = made_scan(&(struct made){ .beams = 41, .narrow_intensities = 41 });
	for (size_t length = 0; length < s->len; length++) {
		struct bench b;
		bench_open(&b, "");
		feed(&b, s->str, length);
		assert_next_comes(&b);
		g_assert_cmpuint(b.counts->malformed, ==, length > 0);
		g_assert_cmpuint(b.got->scanlines, ==, 1);
		bench_close(&b);
	}
	g_string_free(s, TRUE);
}

static void test_pieces(void)
{
	GString *s = made_scan(&(struct made){ .narrow_intensities = 271 });
	g_string_append_len(s, "\0\0\x02sFA 1\x03\0junk", 14);
	GString *second = made_scan(&(struct made){ .type = "sRA", .beams = 41 });
	g_string_append_len(s, second->str, (gssize)second->len);
	g_string_append_c(s, '\0');
	uint64_t hash = 0;
	for (size_t piece = s->len; piece > 0; piece = piece > 300 ? piece / 2 : piece - 1) {
		struct bench b;
		bench_open(&b, "");
		for (size_t at = 0; at < s->len; at += piece)
			feed(&b, s->str + at, MIN(piece, s->len - at));
		g_assert_cmpuint(b.got->scanlines, ==, 2);
		g_assert_cmpuint(b.got->replies, ==, 1);
		g_assert_cmpuint(b.counts->skipped_bytes, ==, 8);
		g_assert_cmpuint(b.counts->malformed, ==, 0);
		g_assert_true(hash == 0 || hash == b.got->hash);
		hash = b.got->hash;
		bench_close(&b);
	}
	g_string_free(s, TRUE);
	g_string_free(second, TRUE);
}

/* A telegram without end is given up at its limit, in whatever pieces it comes. */
static void test_endless(void)
{
	const size_t lengths[] = { COLA_TELEGRAM_BYTES_MAX - 4, COLA_TELEGRAM_BYTES_MAX - 3,
		5 * COLA_TELEGRAM_BYTES_MAX };
	for (size_t k = 0; k < 2 * G_N_ELEMENTS(lengths); k++) {
		struct bench b;
		GString *s = g_string_new("\x02sRA N");
		while (s->len < lengths[k / 2])
			g_string_append_c(s, 'x');
		g_string_append(s, " 123\x03");
		size_t piece = k % 2 ? 65521 : s->len;
		bench_open(&b, "");
		for (size_t at = 0; at < s->len; at += piece)
			feed(&b, s->str + at, MIN(piece, s->len - at));
		g_assert_cmpuint(b.counts->malformed, ==, 1);
		g_assert_cmpuint(b.counts->skipped_bytes, ==,
			s->len > COLA_TELEGRAM_BYTES_MAX + 2 ? s->len - COLA_TELEGRAM_BYTES_MAX - 2
							     : 0);
		assert_next_comes(&b);
		g_string_free(s, TRUE);
		bench_close(&b);
	}
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/cola-faults/refused", test_refused);
	g_test_add_func("/cola-faults/wrong", test_wrong);
	g_test_add_func("/cola-faults/great-count", test_great_count);
	g_test_add_func("/cola-faults/every-byte-dropped", test_every_byte_dropped);
	g_test_add_func("/cola-faults/every-bit-flipped", test_every_bit_flipped);
	g_test_add_func("/cola-faults/every-cut", test_every_cut);
	g_test_add_func("/cola-faults/pieces", test_pieces);
	g_test_add_func("/cola-faults/endless", test_endless);
	return g_test_run();
}
