/* The decoder of RPLIDARs: a captured session, frames from the layouts, streams of all formats that
 * the simulator writes on its own, and damage. */
#include "acquire/rplidar-frames.h"
#include "sim/rplidar-frames.h"
#include "tests/collect.h"
#include "tests/support.h"
#include <math.h>

#define DEGREE (G_PI / 180)

struct bench {
	struct collected *got;
	decoder *d;
	const struct decoder_counts *counts;
};

static void bench_open(struct bench *b)
{
	b->got = collected_new();
	b->d = collected_decoder(b->got, "rplidar");
	b->counts = decoder_get_counts(b->d);
}

static void bench_close(struct bench *b)
{
	decoder_free(b->d);
	collected_free(b->got);
}

static void feed(struct bench *b, const GByteArray *bytes)
{
	decoder_feed(b->d, bytes->data, bytes->len, 42);
}

static GByteArray *from_hex(const char *text)
{
	GByteArray *bytes = g_byte_array_new();
	for (; g_ascii_isxdigit(text[0]) || text[0] == ' '; text++)
		if (text[0] != ' ') {
			guint8 byte = (guint8)(g_ascii_xdigit_value(text[0]) << 4 |
					       g_ascii_xdigit_value(text[1]));
			g_byte_array_append(bytes, &byte, 1);
			text++;
		}
	return bytes;
}

static __attribute__((noinline)) char *shared_text(const char *relative)
{
	const char *path = shared_path(relative);
	char *text = NULL;
	if (!path || !g_file_get_contents(path, &text, NULL, NULL))
		g_test_skip("no ../shared here");
	return text;
}

/* What an A1 said. */
static void test_session(void)
{
	g_autofree char *text = shared_text("vectors/rplidar_a1_session.txt");
	if (!text)
		return;
	struct bench b;
	bench_open(&b);
	g_auto(GStrv) lines = g_strsplit(text, "\n", -1);
	unsigned replies = 0;
	for (char **line = lines; *line; line++) {
		if (!g_str_has_prefix(*line, "< a5"))
			continue;
		g_autoptr(GByteArray) bytes = from_hex(*line + 2);
		feed(&b, bytes);
		if (bytes->data[5] == 0) {
			g_assert_cmpuint(b.got->replies, ==, ++replies);
			g_assert_cmpuint(strlen(b.got->text->str), ==, 2 * (bytes->len - 7));
		}
	}
	g_assert_cmpuint(replies, ==, 7);
	const struct lidar_identity *identity = decoder_identity(b.d);
	g_assert_cmpstr(identity->model, ==, "RPLIDAR A1 (model 18)");
	g_assert_cmpstr(identity->firmware, ==, "1.29");
	g_assert_cmpfloat(identity->range_max_m, ==, 12);
	g_assert_cmpuint(b.counts->skipped_bytes, ==, 0);
	bench_close(&b);
}

static GByteArray *synthetic(const char *name)
{
	char *text = shared_text("vectors/rplidar_synthetic.hex");
	if (!text)
		return NULL;
	const char *at = strstr(text, name);
	g_assert_nonnull(at);
	GByteArray *bytes = from_hex(at + strlen(name) + 1);
	g_free(text);
	return bytes;
}

static void test_synthetic_nodes(void)
{
	g_autoptr(GByteArray) bytes = synthetic("std_scan_descriptor_then_36_nodes");
	if (!bytes)
		return;
	struct bench b;
	bench_open(&b);
	feed(&b, bytes);
	decoder_feed(b.d, bytes->data + 7, bytes->len - 7, 42);
	decoder_feed(b.d, bytes->data + 7, bytes->len - 7, 42);
	g_assert_cmpuint(b.got->scanlines, ==, 2);
	g_assert_cmpuint(b.got->line.beams, ==, 36);
	g_assert_cmpfloat(b.got->line.beam_s, ==, 500e-6);
	for (uint32_t i = 0; i < 36; i++) {
		g_assert_cmpfloat_with_epsilon(
			(double)b.got->line.angle_rad[i], -10.0 * i * DEGREE, 1e-5);
		g_assert_cmpuint(b.got->line.range_mm[i], ==, 1000 + i);
		g_assert_cmpuint(b.got->line.intensity[i], ==, 47);
	}
	bench_close(&b);
}

static void test_synthetic_capsules(void)
{
	g_autoptr(GByteArray) express = synthetic("express_descriptor_then_2_capsules");
	struct rplidar_samples s;
	if (!express)
		return;
	const uint8_t *a = express->data + 7, *next = a + 84;
	g_assert_true(rplidar_is_frame(RPLIDAR_EXPRESS, a));
	g_assert_true(rplidar_is_frame(RPLIDAR_EXPRESS, next));
	g_assert_true(rplidar_begins_anew(RPLIDAR_EXPRESS, a));
	g_assert_cmpuint(rplidar_start_q6(RPLIDAR_EXPRESS, a), ==, 0);
	uint32_t span_q6 = rplidar_start_q6(RPLIDAR_EXPRESS, next);
	rplidar_decode_capsule(RPLIDAR_EXPRESS, a, next, span_q6, &s);
	g_assert_cmpuint(s.count, ==, 32);
	for (uint32_t i = 0; i < 32; i++) {
		double degrees = span_q6 / 64.0 * i / 32 - 12 / 8.0;
		g_assert_cmpfloat_with_epsilon((double)s.clockwise_rad[i], degrees * DEGREE, 1e-5);
		g_assert_cmpuint(s.range_mm[i], ==, 1000 + i);
	}
}

static void test_synthetic_dense(void)
{
	g_autoptr(GByteArray) dense = synthetic("dense_capsule_84B_40pts");
	struct rplidar_samples s;
	if (!dense)
		return;
	g_assert_true(rplidar_is_frame(RPLIDAR_DENSE, dense->data));
	rplidar_decode_capsule(RPLIDAR_DENSE, dense->data, NULL, 40 * 64, &s);
	g_assert_cmpuint(s.count, ==, 40);
	for (uint32_t i = 0; i < 40; i++) {
		g_assert_cmpuint(s.range_mm[i], ==, 1000 + i);
		g_assert_cmpfloat_with_epsilon((double)s.clockwise_rad[i], i * DEGREE, 1e-5);
	}
}

/* Distances of twelve bits and what is added to them, as the maker's own tests have it. */
static void test_ultra_distances(void)
{
	static const struct {
		uint32_t raw, mm;
	} known[] = { { 0, 0 }, { 511, 511 }, { 512, 512 }, { 1000, 1488 }, { 1280, 2048 },
		{ 1500, 2928 }, { 1792, 4096 }, { 2000, 5760 }, { 3328, 16384 }, { 4095, 28656 } };
	for (size_t i = 0; i < G_N_ELEMENTS(known); i++) {
		uint8_t frame[132] = { 0 };
		struct rplidar_samples s;
		/* +3 and -5 of the steps there, of the one before and of the one behind. */
		uint32_t word = known[i].raw | 3u << 12 | (uint32_t)(-5 & 0x3ff) << 22;
		for (int k = 0; k < 32; k++)
			memcpy(frame + 4 + 4 * k, &(uint32_t){ GUINT32_TO_LE(word) }, 4);
		rplidar_decode_capsule(RPLIDAR_ULTRA, frame, NULL, 96 * 64, &s);
		int step = known[i].raw >= 3328   ? 16
			   : known[i].raw >= 1792 ? 8
			   : known[i].raw >= 1280 ? 4
			   : known[i].raw >= 512  ? 2
						  : 1;
		int low = (int)known[i].mm - 5 * step;
		g_assert_cmpuint(s.range_mm[0], ==, known[i].mm);
		g_assert_cmpuint(s.range_mm[1], ==, known[i].mm + 3 * (uint32_t)step);
		g_assert_cmpuint(s.range_mm[2], ==, (uint32_t)MAX(low, 0));
		g_assert_cmpuint(
			s.range_mm[95], ==, 0); /* depends on a capsule that is not there */
	}
}

/* ---- streams of all formats, by the simulator's own writer ---- */

#define BEATS 8000

static const struct kind {
	const char *name;
	enum sim_format format;
	enum rplidar_format read_as;
	double beams_a_turn;
	uint32_t coarse_mm; /* ranges are rounded by up to so much */
	double coarse_deg;
	uint32_t far_mm;
} kinds[] = {
	{ "standard", SIM_STANDARD, RPLIDAR_STANDARD, 361.7, 1, 0.01, 16000 },
	{ "express", SIM_EXPRESS, RPLIDAR_EXPRESS, 401.3, 1, 0.02, 16000 },
	{ "ultra", SIM_ULTRA, RPLIDAR_ULTRA, 1601.3, 8, 0.02, 26000 },
	{ "dense", SIM_DENSE, RPLIDAR_DENSE, 803.9, 0, 0.02, 30000 },
	{ "ultra-dense", SIM_ULTRA_DENSE, RPLIDAR_ULTRA_DENSE, 1603.3, 3, 0.02, 40000 },
	{ "hq", SIM_HQ, RPLIDAR_HQ, 815.5, 1, 0.01, 40000 },
};

typedef struct spoken spoken;
struct spoken {
	struct echo echoes[BEATS + 97];
	double turns[BEATS + 97], turned[BEATS + 97];
	GByteArray *bytes;
};

/* A room with steps in it, and some that answer nothing. */
static double range_of(const struct kind *k, uint32_t i)
{
	return i % 41 == 11 ? 0 : 0.3 + (i / 23 * 7919 % k->far_mm) * 0.9e-3 + i % 5 * 0.004;
}

static struct spoken *speak(const struct kind *k)
{
	struct spoken *s = g_new0(struct spoken, 1);
	s->bytes = g_byte_array_new();
	uint32_t bytes = (uint32_t)rplidar_frame_bytes(k->read_as),
		 samples = rplidar_frame_samples(k->read_as);
	for (uint32_t i = 0; i < G_N_ELEMENTS(s->echoes); i++) {
		double range = range_of(k, i);
		s->echoes[i] = (struct echo){ .range_m = range,
			.strength = 0.5f,
			.outcome = range > 0 ? ECHO_GOOD : ECHO_NONE };
		s->turns[i] = 3.21 + i / k->beams_a_turn;
		s->turned[i] = rplidar_turned_rad(k->format, range);
	}
	rplidar_put_descriptor(s->bytes, rplidar_type_of(k->format), bytes, true);
	struct rplidar_portion p = { s->echoes, s->turns, s->turned, BEATS / samples * samples,
		true, 5000, 500 };
	rplidar_put_portion(s->bytes, k->format, &p);
	return s;
}

static void spoken_free(struct spoken *s)
{
	g_byte_array_unref(s->bytes);
	g_free(s);
}
G_DEFINE_AUTOPTR_CLEANUP_FUNC(spoken, spoken_free)

struct check {
	const struct kind *kind;
	const struct spoken *spoken;
	uint32_t lines, beams, lost, epochs;
};

static void check_line(const struct scanline *line, gpointer user_data)
{
	struct check *c = user_data;
	/* Ticks count measurements of the beat that is standard where nothing else was said. */
	uint64_t first = (uint64_t)llround((double)line->ticks / line->beam_s * 1e-9);
	for (uint32_t i = 0; i < line->beams; i++) {
		uint32_t at = (uint32_t)first + i;
		g_assert_cmpuint(at, <, BEATS);
		double expected = c->spoken->echoes[at].range_m * 1000,
		       turn = 2 * G_PI * c->spoken->turns[at] - c->spoken->turned[at];
		if (expected > 0 && line->range_mm[i] == 0) {
			c->lost++; /* too far from its neighbour to be told by it */
			continue;
		}
		g_assert_cmpfloat(
			fabs(line->range_mm[i] - expected), <=, c->kind->coarse_mm + 0.51);
		if (expected > 0 && c->kind->format != SIM_ULTRA)
			g_assert_cmpfloat(
				fabs(remainder((double)line->angle_rad[i] + turn, 2 * G_PI)), <,
				c->kind->coarse_deg * DEGREE);
		if (c->kind->format == SIM_ULTRA &&
			expected > 0) /* a bin of its table more or less */
			g_assert_cmpfloat(
				fabs(remainder((double)line->angle_rad[i] + turn, 2 * G_PI)), <,
				0.09 * DEGREE + (expected < 600 ? 0.3 * DEGREE : 0));
	}
	c->lines++;
	c->beams += line->beams;
	c->epochs = MAX(c->epochs, line->epoch);
}

static void test_stream(gconstpointer data)
{
	const struct kind *k = data;
	g_autoptr(spoken) s = speak(k);
	struct check c = { .kind = k, .spoken = s };
	struct decoder_sink sink = { .scanline = check_line, .user_data = &c };
	decoder *d = decoder_new("rplidar", &sink);
	decoder_feed(d, s->bytes->data, s->bytes->len, 0);
	uint32_t turns = (uint32_t)(BEATS / k->beams_a_turn);
	g_test_message("%u lines, %u beams, %u not told", c.lines, c.beams, c.lost);
	g_assert_cmpuint(c.lines, >=, turns - 1);
	g_assert_cmpuint(c.beams, >=, (turns - 2) * (uint32_t)k->beams_a_turn);
	g_assert_cmpuint(c.lost, <=, k->format == SIM_ULTRA ? c.beams / 10 : 0);
	g_assert_cmpuint(c.epochs, ==, 0);
	g_assert_cmpuint(decoder_get_counts(d)->skipped_bytes, ==, 0);
	g_assert_cmpuint(decoder_get_counts(d)->bad_sums + decoder_get_counts(d)->malformed, ==, 0);
	g_assert_true(fabs(decoder_identity(d)->beams - k->beams_a_turn) <= 1);
	decoder_free(d);
}

/* Bytes in pieces of any size give the same; so do those of a stream with damage. */
static void test_pieces(gconstpointer data)
{
	const struct kind *k = data;
	g_autoptr(spoken) s = speak(k);
	for (guint at = s->bytes->len * 2 / 3; at < s->bytes->len; at += 1777)
		s->bytes->data[at] ^= 0x11;
	uint64_t hash = 0;
	for (guint piece = 1; piece < 3000; piece = piece * 2 + 1) {
		struct bench b;
		bench_open(&b);
		for (guint at = 0; at < s->bytes->len; at += piece)
			decoder_feed(b.d, s->bytes->data + at, MIN(piece, s->bytes->len - at), 42);
		g_assert_true(piece == 1 || b.got->hash == hash);
		g_assert_cmpuint(b.got->scanlines, >, 0);
		hash = b.got->hash;
		bench_close(&b);
	}
}

/* Of capsules each bit that is wrong is seen; nodes have two that are checked. */
static void test_flipped(gconstpointer data)
{
	const struct kind *k = data;
	g_autoptr(spoken) s = speak(k);
	guint bytes = (guint)rplidar_frame_bytes(k->read_as);
	uint8_t *frame = s->bytes->data + RPLIDAR_DESCRIPTOR_BYTES;
	g_assert_true(rplidar_is_frame(k->read_as, frame));
	for (guint bit = 0; bit < bytes * 8 && k->format != SIM_STANDARD; bit++) {
		frame[bit / 8] ^= (uint8_t)(1 << bit % 8);
		g_assert_false(rplidar_is_frame(k->read_as, frame));
		frame[bit / 8] ^= (uint8_t)(1 << bit % 8);
	}
	/* Frames that are lost in the middle are counted: what follows has ticks of its own. */
	struct check c = { .kind = k, .spoken = s };
	struct decoder_sink sink = { .scanline = check_line, .user_data = &c };
	decoder *d = decoder_new("rplidar", &sink);
	guint at = RPLIDAR_DESCRIPTOR_BYTES + bytes * (s->bytes->len / bytes * 2 / 3);
	if (k->format != SIM_STANDARD && k->format != SIM_HQ)
		s->bytes->data[at + bytes / 2] ^= 0x40;
	decoder_feed(d, s->bytes->data, s->bytes->len, 0);
	g_assert_cmpuint(decoder_get_counts(d)->bad_sums, ==,
		k->format != SIM_STANDARD && k->format != SIM_HQ);
	g_assert_cmpuint(c.epochs, ==, 0);
	decoder_free(d);
}

/* A stream that is stopped anywhere, and the answer to the next question. */
static void test_stopped(gconstpointer data)
{
	const struct kind *k = data;
	g_autoptr(spoken) s = speak(k);
	g_autoptr(GByteArray) answer = from_hex("a5 5a 03 00 00 00 06 00 00 00");
	unsigned heard = 0, tried = 0;
	for (guint cut = 3000; cut < 3000 + 300; cut++, tried++) {
		struct bench b;
		bench_open(&b);
		decoder_feed(b.d, s->bytes->data, cut, 42);
		feed(&b, answer);
		heard += b.got->replies == 1 && strcmp(b.got->command->str, "health") == 0;
		/* Asked again, it is heard for certain. */
		feed(&b, answer);
		g_assert_cmpstr(b.got->command->str, ==, "health");
		bench_close(&b);
	}
	g_test_message("%u of %u at once", heard, tried);
	g_assert_cmpuint(heard, >=, k->format == SIM_STANDARD ? tried / 2 : tried * 9 / 10);
}

int main(int argc, char **argv)
{
	static const struct {
		const char *name;
		void (*function)(gconstpointer data);
	} tests[] = { { "stream", test_stream }, { "pieces", test_pieces },
		{ "damage", test_flipped }, { "stopped", test_stopped } };
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/rplidar/captured", test_session);
	g_test_add_func("/rplidar/synthetic/nodes", test_synthetic_nodes);
	g_test_add_func("/rplidar/synthetic/express", test_synthetic_capsules);
	g_test_add_func("/rplidar/synthetic/dense", test_synthetic_dense);
	g_test_add_func("/rplidar/ultra-distances", test_ultra_distances);
	for (size_t t = 0; t < G_N_ELEMENTS(tests); t++)
		for (size_t i = 0; i < G_N_ELEMENTS(kinds); i++) {
			g_autofree char *path =
				g_strdup_printf("/rplidar/%s/%s", tests[t].name, kinds[i].name);
			g_test_add_data_func(path, &kinds[i], tests[t].function);
		}
	return g_test_run();
}
