/* The decoder of LDRobot's lidars: captured packets, turns put together of made ones, gaps and
 * damage. */
#include "acquire/ld.h"
#include "tests/ld-made.h"
#include "tests/support.h"

#define DEGREE (G_PI / 180)

static const struct made_motor ld06 = { 4500, 10, 0, 0.123, 29900 },
			       stl27l = { 21600, 10, 0, 0.9, 12 };

struct bench {
	struct collected *got;
	decoder *d;
	const struct decoder_counts *counts;
	struct made_motor motor;
};

static void bench_open(struct bench *b, const struct made_motor *motor)
{
	b->got = collected_new();
	b->d = collected_decoder(b->got, "ld");
	b->counts = decoder_get_counts(b->d);
	b->motor = *motor;
}

static void bench_close(struct bench *b)
{
	decoder_free(b->d);
	collected_free(b->got);
}

static void feed_packets(struct bench *b, unsigned packets)
{
	uint8_t bytes[LD_PACKET_BYTES];
	while (packets-- > 0) {
		made_packet(&b->motor, bytes);
		decoder_feed(b->d, bytes, sizeof bytes, made_arrival_ns(&b->motor));
	}
}

static void feed_until_lines(struct bench *b, unsigned lines)
{
	for (unsigned packets = 0; b->got->scanlines < lines; packets++) {
		g_assert_cmpuint(packets, <, 10000);
		feed_packets(b, 1);
	}
}

/* The measurement that a beam of the last line is, by the line's own ticks. */
static uint64_t index_of(const struct bench *b, uint32_t i)
{
	return (uint64_t)llround((double)b->got->line.ticks * b->motor.samples_hz * 1e-9) + i;
}

static void assert_line(const struct bench *b)
{
	const struct scanline *line = &b->got->line;
	g_assert_nonnull(line->angle_rad);
	g_assert_nonnull(line->intensity);
	for (uint32_t i = 0; i < line->beams; i++) {
		uint64_t index = index_of(b, i);
		double off = remainder(
			(double)line->angle_rad[i] + 2 * G_PI * made_turns(&b->motor, index),
			2 * G_PI);
		g_assert_cmpfloat(fabs(off), <, 0.011 * DEGREE);
		g_assert_cmpuint(line->range_mm[i], ==, made_range(index));
		g_assert_true(scanline_has_range(line, i) == (made_range(index) > 0));
		g_assert_cmpuint(line->intensity[i], ==, index & 255);
	}
}

static void test_sums(void)
{
	static const uint8_t one = 1, two = 2, most = 255;
	g_assert_cmphex(ld_crc(&one, 1), ==, 0x4d);
	g_assert_cmphex(ld_crc(&two, 1), ==, 0x9a);
	g_assert_cmphex(ld_crc(&most, 1), ==, 0xa8);
	uint8_t bytes[46];
	for (unsigned i = 0; i < sizeof bytes; i++)
		bytes[i] = (uint8_t)(i * 89 + 3);
	for (unsigned n = 0; n <= sizeof bytes; n++)
		g_assert_cmphex(ld_crc(bytes, n), ==, made_sum(bytes, n));
}

static void test_turns(gconstpointer data)
{
	struct bench b;
	bench_open(&b, data);
	uint32_t beams = (uint32_t)(b.motor.samples_hz / b.motor.turns_hz);
	feed_until_lines(&b, 1);
	for (unsigned lines = 2; lines < 8; lines++) {
		uint64_t ticks = b.got->line.ticks;
		feed_until_lines(&b, lines);
		const struct scanline *line = &b.got->line;
		assert_line(&b);
		g_assert_cmpuint(line->beams, ==, beams);
		g_assert_cmpfloat_with_epsilon(line->scan_rate_hz, 10, 1e-6);
		g_assert_cmpfloat_with_epsilon(line->beam_s, 1 / b.motor.samples_hz, 1e-12);
		g_assert_cmpfloat_with_epsilon((double)(line->ticks - ticks), 1e8, 2);
		/* From straight ahead clockwise, all round. */
		g_assert_cmpfloat((double)line->angle_rad[0], <=, 1e-4);
		g_assert_cmpfloat((double)line->angle_rad[0], >, -1 * DEGREE);
		g_assert_cmpfloat((double)line->angle_rad[beams - 1], <, -359 * DEGREE);
		g_assert_cmpuint(line->sent_ticks, >, line->ticks + 100000000);
		g_assert_cmpuint(line->sent_ticks, <, line->ticks + 110000000);
	}
	g_assert_cmpuint(b.counts->bad_sums, ==, 0);
	g_assert_cmpuint(b.counts->skipped_bytes, ==, 0);
	const struct lidar_identity *identity = decoder_identity(b.d);
	g_assert_cmpstr(identity->model, ==, b.motor.samples_hz > 10000 ? "STL-27L" : "LD06/LD19");
	g_assert_cmpuint(identity->beams, ==, beams);
	bench_close(&b);
}

/* Whatever is missing, the ticks of what follows count it. */
static void test_gaps(gconstpointer data)
{
	for (unsigned missing = 1; missing < 60; missing++) {
		struct bench b;
		bench_open(&b, data);
		double packet_turns = 12 * b.motor.turns_hz / b.motor.samples_hz;
		feed_until_lines(&b, 3);
		feed_packets(&b, 5);
		b.motor.next += 12 * missing;
		feed_packets(&b, 1);
		bool bridged = missing * packet_turns < 1.5;
		/* The part before, and one behind where the turn ends with this packet. */
		unsigned lines = b.got->scanlines;
		g_assert_cmpuint(lines, >=, 4);
		if (b.got->line.epoch == 0)
			assert_line(&b);
		feed_until_lines(&b, lines + 1);
		g_assert_cmpuint(b.got->line.epoch, ==, bridged ? 0 : 1);
		if (bridged)
			assert_line(&b);
		bench_close(&b);
	}
}

static void test_no_return(void)
{
	struct bench b;
	uint32_t zeros = 0;
	bench_open(&b, &ld06);
	feed_until_lines(&b, 3);
	for (uint32_t i = 0; i < b.got->line.beams; i++)
		if (b.got->line.range_mm[i] == 0) {
			zeros++;
			g_assert_false(scanline_has_range(&b.got->line, i));
		}
	g_assert_cmpuint(zeros, ==, 9);
	bench_close(&b);
}

/* Each bit that is wrong is seen, and costs its packet and no other. */
static void test_flipped(void)
{
	for (unsigned bit = 0; bit < LD_PACKET_BYTES * 8; bit++) {
		struct bench b;
		uint8_t bytes[LD_PACKET_BYTES];
		bench_open(&b, &ld06);
		feed_until_lines(&b, 3);
		feed_packets(&b, 4);
		made_packet(&b.motor, bytes);
		bytes[bit / 8] ^= (uint8_t)(1 << bit % 8);
		decoder_feed(b.d, bytes, sizeof bytes, made_arrival_ns(&b.motor));
		feed_until_lines(&b, 6);
		assert_line(&b);
		g_assert_cmpuint(b.got->line.epoch, ==, 0);
		g_assert_cmpuint(b.got->line.beams, ==, 450);
		g_assert_cmpuint(b.counts->bad_sums, <=, 1);
		g_assert_cmpuint(b.counts->skipped_bytes, ==, LD_PACKET_BYTES);
		bench_close(&b);
	}
}

static void test_pieces(void)
{
	g_autoptr(GByteArray) all = g_byte_array_new();
	struct made_motor motor = ld06;
	for (int i = 0; i < 320; i++) {
		uint8_t bytes[LD_PACKET_BYTES + 3] = { 0 };
		made_packet(&motor, bytes);
		/* Now and then something that does not belong there. */
		bytes[20] ^= i > 130 && i % 31 == 5;
		g_byte_array_append(all, bytes, LD_PACKET_BYTES + (i % 17 == 3 ? 3 : 0));
	}
	uint64_t hash = 0;
	for (guint piece = 1; piece < 200; piece += piece < 100 ? 1 : 33) {
		struct bench b;
		bench_open(&b, &ld06);
		for (guint at = 0; at < all->len; at += piece)
			decoder_feed(b.d, all->data + at, MIN(piece, all->len - at), 7);
		g_assert_cmpuint(b.got->scanlines, >, 2);
		g_assert_true(piece == 1 || b.got->hash == hash);
		hash = b.got->hash;
		bench_close(&b);
	}
}

/* Captured packets: their sums, and what is in the first. */
static guint8 *captured(unsigned line, gsize *ret_length)
{
	const char *path = shared_path("vectors/ld06_manual_packet.hex");
	g_autofree char *text = NULL;
	if (!path || !g_file_get_contents(path, &text, NULL, NULL)) {
		g_test_skip("no ../shared here");
		return NULL;
	}
	g_auto(GStrv) lines = g_strsplit(text, "\n", -1);
	g_assert_cmpuint(g_strv_length(lines), >, line);
	*ret_length = strlen(lines[line]) / 2;
	guint8 *bytes = g_malloc(*ret_length);
	for (gsize i = 0; i < *ret_length; i++)
		bytes[i] = (guint8)(g_ascii_xdigit_value(lines[line][2 * i]) << 4 |
				    g_ascii_xdigit_value(lines[line][2 * i + 1]));
	return bytes;
}

static void test_captured(void)
{
	static const uint32_t ranges[] = { 224, 220, 217, 213, 211, 208, 205, 202, 199, 197, 194,
		192 },
			      intensities[] = { 228, 226, 229, 227, 228, 233, 228, 226, 233, 229,
				      229, 229 };
	for (unsigned line = 0; line < 2; line++) {
		gsize length;
		g_autofree guint8 *bytes = captured(line, &length);
		if (!bytes)
			return;
		g_assert_cmpuint(length, ==, LD_PACKET_BYTES);
		g_assert_true(ld_is_packet(bytes));
		struct bench b;
		bench_open(&b, &ld06);
		feed_until_lines(&b, 3);
		unsigned before = b.got->scanlines;
		decoder_feed(b.d, bytes, length, made_arrival_ns(&b.motor));
		/* It does not follow what came before; what follows it ends its part of a turn. */
		b.motor.start_turns =
			0.2 - (double)b.motor.next * b.motor.turns_hz / b.motor.samples_hz;
		feed_packets(&b, 1);
		g_assert_cmpuint(b.got->scanlines, >, before);
		g_assert_cmpuint(b.got->line.beams, ==, 12);
		for (unsigned i = 0; i < 12; i++) {
			double degrees = line ? 344.80 + i * 5.94 / 11 : 324.27 + i * 10.43 / 11;
			g_assert_cmpfloat_with_epsilon(
				(double)b.got->line.angle_rad[i], -degrees * DEGREE, 1e-5);
			g_assert_cmpuint(b.got->line.range_mm[i], ==, line ? 0 : ranges[i]);
			g_assert_cmpuint(
				b.got->line.intensity[i], >, line ? 0 : intensities[i] - 1);
		}
		bench_close(&b);
	}
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/ld/sums", test_sums);
	g_test_add_data_func("/ld/turns/ld06", &ld06, test_turns);
	g_test_add_data_func("/ld/turns/stl27l", &stl27l, test_turns);
	g_test_add_data_func("/ld/gaps/ld06", &ld06, test_gaps);
	g_test_add_data_func("/ld/gaps/stl27l", &stl27l, test_gaps);
	g_test_add_func("/ld/no-return", test_no_return);
	g_test_add_func("/ld/flipped", test_flipped);
	g_test_add_func("/ld/pieces", test_pieces);
	g_test_add_func("/ld/captured", test_captured);
	return g_test_run();
}
