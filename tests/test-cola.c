/* The CoLa-A decoder against the captured telegrams, and made ones of every kind. */
#include "acquire/cola-scan.h"
#include "acquire/cola.h"
#include "tests/cola-made.h"
#include "tests/support.h"
#include <math.h>

static void assert_deg(double rad, double deg)
{
	g_assert_cmpfloat_with_epsilon(rad * 180 / M_PI, deg, 1e-9);
}

/* Captured telegrams */

static const struct capture {
	const char *path;
	uint32_t beams, counter;
	uint64_t ticks, sent_after;
	uint32_t first[5], last[3];
	unsigned zeros, codes;
	int first_intensity; /* -1: none */
} captures[] = {
	{ "vectors/sick_tim551_271pts_sRA_rssi.txt", 271, 0x2add, 2030565117, 3939,
		{ 278, 288, 291, 285, 288 }, { 1142, 1130, 1112 }, 7, 1, 0x9a },
	{ "vectors/sick_tim551_271pts_sSN_rssi.txt", 271, 0xe789, 0x3d611e4a, 3797,
		{ 440, 435, 441, 445, 505 }, { 1378, 1352, 1333 }, 0, 0, 0xaa },
	{ "vectors/sick_tim561_811pts_sSN.txt", 811, 0xaa0, 0xba09fb5, 4304, { 0 }, { 0 }, 0, 0,
		-1 },
};

static char *read_shared(const char *relative, gsize *ret_length)
{
	const char *path = shared_path(relative);
	char *bytes = NULL;
	if (!path)
		g_test_skip("no ../shared here");
	else
		g_assert_true(g_file_get_contents(path, &bytes, ret_length, NULL));
	return bytes;
}

static void assert_captured_values(const struct scanline *line, const struct capture *c)
{
	unsigned zeros = 0, codes = 0;
	for (uint32_t i = 0; i < line->beams; i++) {
		zeros += line->range_mm[i] == 0;
		codes += line->range_mm[i] > 0 && line->range_mm[i] < 16;
		g_assert_true(scanline_has_range(line, i) == (line->range_mm[i] >= 16));
	}
	for (uint32_t i = 0; c->first[0] && i < 5; i++)
		g_assert_cmpuint(line->range_mm[i], ==, c->first[i]);
	for (uint32_t i = 0; c->last[0] && i < 3; i++)
		g_assert_cmpuint(line->range_mm[line->beams - 3 + i], ==, c->last[i]);
	if (c->zeros) {
		g_assert_cmpuint(zeros, ==, c->zeros);
		g_assert_cmpuint(codes, ==, c->codes);
	}
	if (c->first_intensity >= 0)
		g_assert_cmpuint(line->intensity[0], ==, c->first_intensity);
}

static void test_capture(gconstpointer data)
{
	const struct capture *c = data;
	gsize length;
	g_autofree char *bytes = read_shared(c->path, &length);
	if (!bytes)
		return;
	struct bench b;
	bench_open(&b, "");
	feed(&b, bytes, length);
	const struct scanline *line = &b.got->line;
	g_assert_cmpuint(b.got->scanlines, ==, 1);
	g_assert_cmpuint(b.counts->malformed, ==, 0);
	g_assert_cmpint(line->arrival_ns, ==, 42);
	g_assert_cmpuint(line->beams, ==, c->beams);
	g_assert_cmpuint(line->counter, ==, c->counter);
	g_assert_cmpuint(line->ticks, ==, c->ticks);
	g_assert_cmpuint(line->sent_ticks - line->ticks, ==, c->sent_after);
	g_assert_false(line->device_error);
	g_assert_cmpfloat(line->scan_rate_hz, ==, 15);
	g_assert_cmpuint(line->range_min_mm, ==, 16);
	assert_deg(line->first_angle_rad, -135);
	assert_deg(line->angle_step_rad, 270.0 / (c->beams - 1));
	assert_deg(line->first_angle_rad + (c->beams - 1) * line->angle_step_rad, 135);
	g_assert_true((line->intensity != NULL) == (c->first_intensity >= 0));
	assert_captured_values(line, c);
	bench_close(&b);
}

static void test_captured_acks(void)
{
	gsize length;
	g_autofree char *on = read_shared("vectors/sick_sEA_on.txt", &length);
	if (!on)
		return;
	struct bench b;
	bench_open(&b, "");
	feed(&b, on, length);
	g_assert_cmpstr(b.got->command->str, ==, "sEA LMDscandata");
	g_assert_cmpstr(b.got->text->str, ==, "1");
	g_autofree char *off = read_shared("vectors/sick_sEA_off.txt", &length);
	feed(&b, off, length);
	g_assert_cmpstr(b.got->text->str, ==, "0");
	g_assert_cmpuint(b.got->replies, ==, 2);
	bench_close(&b);
}

/* Made telegrams */

static const struct kind {
	const char *name;
	struct made made;
	double step_deg;
	uint32_t intensities;
} kinds[] = {
	{ "streamed", { 0 }, 1, 0 },
	{ "polled", { .type = "sRA" }, 1, 0 },
	{ "narrow-intensity", { .narrow_intensities = 271 }, 1, 255 },
	{ "wide-intensity", { .wide_intensities = 271 }, 1, 27000 },
	{ "intensity-of-other-length", { .wide_intensities = 11 }, 1, 0 },
	{ "thirds", { .beams = 811, .step = "D05" }, 1 / 3.0, 0 },
	{ "sixths-rounded", { .beams = 3, .step = "683" }, 1 / 6.0, 0 },
	{ "sixths-cut", { .beams = 3, .step = "682" }, 1 / 6.0, 0 },
	{ "two-thirds", { .beams = 3, .step = "1A0B" }, 2 / 3.0, 0 },
	{ "twelfths", { .beams = 3, .step = "341" }, 1 / 12.0, 0 },
	{ "halves", { .beams = 541, .step = "1388" }, 0.5, 0 },
	{ "quarters", { .beams = 3, .step = "9C4" }, 0.25, 0 },
	{ "tenths", { .beams = 3, .step = "3E8" }, 0.1, 0 },
	{ "encoders", { .rates = "5DC 36 2 FFFF 1 8000 2" }, 1, 0 },
	{ "old-extra-token", { .rates = "0 5DC 36 0" }, 1, 0 },
	{ "more-channels",
		{ .before = " ANGL1 3F800000 0 FFF92230 2710 2 AAAA BBBB",
			.between = " DIST2 3F800000 0 FFF92230 2710 1 9 VANGL 3F800000 0 0 2710 0",
			.more = 3 },
		1, 0 },
	{ "bare-tail", { .tail = "0 0 0 0 0" }, 1, 0 },
	{ "space-at-end", { .tail = "0 0 0 0 0 " }, 1, 0 },
	{ "whole-tail",
		{ .tail = "1 3F800000 0 0 0 0 0 1 1 4 a  b 1 0  1 7E9 1 2 3 4 5 6 1 FastDigIn 0 7 "
			  "0" },
		1, 0 },
	{ "empty-comment", { .tail = "0 0 1 0 0 0" }, 1, 0 },
};

static void test_kind(gconstpointer data)
{
	const struct kind *k = data;
	struct bench b;
	bench_open(&b, "");
	feed_made(&b, &k->made);
	const struct scanline *line = &b.got->line;
	g_assert_cmpuint(b.got->scanlines, ==, 1);
	g_assert_cmpuint(b.got->replies, ==, 0);
	g_assert_cmpuint(b.counts->malformed, ==, 0);
	assert_ranges(line, k->made.beams ? k->made.beams : 271);
	assert_deg(line->first_angle_rad, -135);
	assert_deg(line->angle_step_rad, k->step_deg);
	g_assert_cmpfloat(line->scan_rate_hz, ==, 15);
	g_assert_cmpuint(line->counter, ==, 0x2003);
	g_assert_cmpuint(line->ticks, ==, 0x5a0b1c20);
	g_assert_cmpuint(line->sent_ticks, ==, 0x5a0b2b90);
	g_assert_true((line->intensity != NULL) == (k->intensities > 0));
	for (uint32_t i = 0; i < line->beams && k->intensities; i++)
		g_assert_cmpuint(line->intensity[i], ==, k->intensities == 255 ? i & 255 : i * 100);
	bench_close(&b);
}

static const struct {
	const char *head;
	bool error;
} states[] = {
	{ "1 1 1 0 0 1 1 1 1 0 0 0 0 0", false },
	{ "1 1 1 0 1 1 1 1 1 0 0 0 0 0", true },
	{ "1 1 1 0 2 1 1 1 1 0 0 0 0 0", false }, /* dirt on the window, a warning */
	{ "1 1 1 0 5 1 1 1 1 0 0 0 0 0", true },
	{ "1 1 1 1 0 1 1 1 1 0 0 0 0 0", true },
};

static void test_device_error(void)
{
	for (size_t i = 0; i < G_N_ELEMENTS(states); i++) {
		struct bench b;
		bench_open(&b, "");
		feed_made(&b, &(struct made){ .head = states[i].head });
		g_assert_cmpuint(b.got->scanlines, ==, 1);
		g_assert_true(b.got->line.device_error == states[i].error);
		bench_close(&b);
	}
}

/* Codes stay codes under any scale. */
static void test_scale_and_codes(void)
{
	static const struct {
		const char *scale;
		uint32_t expected[6];
	} cases[] = {
		{ "3F800000 00000000", { 0, 2, 15, 16, 1000, 65535 } },
		{ "40000000 00000000", { 0, 2, 15, 32, 2000, 131070 } },
		{ "40000000 40A00000", { 0, 2, 15, 37, 2005, 131075 } },
		{ "3DCCCCCD 00000000", { 0, 2, 15, 0, 100, 6554 } },
		{ "3F800000 C2C80000", { 0, 2, 15, 0, 900, 65435 } },
	};
	for (size_t k = 0; k < G_N_ELEMENTS(cases); k++) {
		struct bench b;
		g_autofree char *text = g_strdup_printf(
			"\x02sSN LMDscandata 1 1 1 0 0 1 1 1 1 0 0 0 0 0 5DC 36 0 1 "
			"DIST1 %s FFF92230 2710 6 0 2 F 10 3E8 FFFF 0 0 0 0 0 0\x03",
			cases[k].scale);
		bench_open(&b, text);
		g_assert_cmpuint(b.got->scanlines, ==, 1);
		for (uint32_t i = 0; i < 6; i++)
			g_assert_cmpuint(b.got->line.range_mm[i], ==, cases[k].expected[i]);
		g_assert_false(scanline_has_range(&b.got->line, 2));
		g_assert_true(scanline_has_range(&b.got->line, 4));
		bench_close(&b);
	}
}

/* Short lists take the slow way, long ones the fast one. */
static const struct {
	const char *text;
	bool good; /* as three values and nothing else */
} values[] = {
	{ "1 2 3", true },
	{ "1 2 3 ", true },
	{ "FFFF 0 ABCD", true },
	{ "0001 02 003", true },
	{ "1 2", false },
	{ "1 2 3 4", false },
	{ "1 2  3", false },
	{ " 1 2 3", false },
	{ "1 2 3x", false },
	{ "1 G 3", false },
	{ "1 a 3", false },
	{ "1 / 3", false },
	{ "1 : 3", false },
	{ "1 @ 3", false },
	{ "1 \xb1 3", false },
	{ "1 10000 3", false },
	{ "1 -1 3", false },
};

static void test_values(void)
{
	for (size_t k = 0; k < G_N_ELEMENTS(values); k++) {
		uint16_t got[13];
		g_autofree char *longer = g_strdup_printf("%s 4 5 6 7 8 9 A B C D", values[k].text);
		struct cola_cursor c = cola_cursor_of(values[k].text, strlen(values[k].text));
		cola_values(&c, 3, 4, got);
		g_assert_true(cola_at_end(&c) == values[k].good);
		if (g_str_has_suffix(values[k].text, " ") || strcmp(values[k].text, "1 2 3 4") == 0)
			continue; /* with what follows it is another list */
		c = cola_cursor_of(longer, strlen(longer));
		cola_values(&c, 13, 4, got);
		g_assert_true(cola_at_end(&c) == values[k].good);
	}
}

static void test_every_value(void)
{
	GString *s = g_string_new(NULL);
	g_autofree uint16_t *got = g_new(uint16_t, 65536);
	for (uint32_t i = 0; i < 65536; i++)
		g_string_append_printf(s, "%X ", i);
	struct cola_cursor c = cola_cursor_of(s->str, s->len);
	cola_values(&c, 65536, 4, got);
	g_assert_true(cola_at_end(&c));
	for (uint32_t i = 0; i < 65536; i++)
		g_assert_cmpuint(got[i], ==, i);
	c = cola_cursor_of(s->str, s->len);
	cola_values(&c, 257, 2, got); /* 100 is the first with three digits */
	g_assert_true(c.bad);
	g_string_free(s, TRUE);
}

/* Replies */

static void test_identity(void)
{
	struct bench b;
	bench_open(&b, "\x02sRA 0 6 TiM3XX E V2.10-11.11.11\x03");
	const struct lidar_identity *identity = decoder_identity(b.d);
	g_assert_cmpstr(identity->model, ==, "TiM3XX");
	g_assert_cmpstr(identity->firmware, ==, "V2.10-11.11.11");
	g_assert_cmpstr(b.got->command->str, ==, "sRA 0");
	const char *more = "\x02sRA DeviceIdent 7 TiM 561 E V2.54-19.05.14\x03\x02sRA SerialNumber "
			   "8 16150012\x03"
			   "\x02sRA LMPscancfg 5DC 1 2710 FFFB6C20 1B7740\x03";
	feed(&b, more, strlen(more));
	g_assert_cmpstr(identity->model, ==, "TiM 561");
	g_assert_cmpstr(identity->firmware, ==, "V2.54-19.05.14");
	g_assert_cmpstr(identity->serial, ==, "16150012");
	g_assert_cmpfloat(identity->scan_rate_hz, ==, 15);
	g_assert_cmpuint(identity->beams, ==, 211);
	assert_deg(identity->first_angle_rad, -30 - 90);
	more = "\x02sRA FirmwareVersion 5 V2.60\x03\x02sRA LMPoutputRange 1 D05 FFF92230 225510\x03"
	       "\x02sRA LMPscancfg 5DC 1 2710 0 1B7740\x03";
	feed(&b, more, strlen(more));
	g_assert_cmpstr(identity->firmware, ==, "V2.60");
	g_assert_cmpuint(identity->beams, ==, 811);
	assert_deg(identity->first_angle_rad, -135);
	assert_deg(identity->angle_step_rad, 270.0 / 810);
	g_assert_cmpuint(b.counts->replies, ==, 7);
	g_assert_cmpuint(b.counts->malformed, ==, 0);
	bench_close(&b);
}

static const struct answer {
	const char *wire, *command, *status, *text;
} answers[] = {
	{ "\x02sFA 1\x03", "sFA", "1", "" },
	{ "\x02sFA 1A\x03", "sFA", "1A", "" },
	{ "\x02sAN SetAccessMode 1\x03", "sAN SetAccessMode", "", "1" },
	{ "\x02sAN Run 1\x03", "sAN Run", "", "1" },
	{ "\x02sMA SetAccessMode\x03", "sMA SetAccessMode", "", "" },
	{ "\x02sWA LMDscandatacfg\x03", "sWA LMDscandatacfg", "", "" },
	{ "\x02sEA LMDscandata 1\x03", "sEA LMDscandata", "", "1" },
	{ "\x02sRA SCdevicestate 1\x03", "sRA SCdevicestate", "", "1" },
	{ "\x02sRA LocationName B not defined\x03", "sRA LocationName", "", "B not defined" },
	{ "\x02sSN LIDoutputstate 0 1 2\x03", "sSN LIDoutputstate", "", "0 1 2" },
};

static void test_answers(void)
{
	for (const struct answer *a = answers; a < answers + G_N_ELEMENTS(answers); a++) {
		struct bench b;
		bench_open(&b, a->wire);
		g_assert_cmpuint(b.got->replies, ==, 1);
		g_assert_cmpstr(b.got->command->str, ==, a->command);
		g_assert_cmpstr(b.got->status->str, ==, a->status);
		g_assert_cmpstr(b.got->text->str, ==, a->text);
		g_assert_cmpuint(b.counts->skipped_bytes, ==, 0);
		bench_close(&b);
	}
	g_assert_nonnull(strstr(cola_error_text("A"), "writing"));
	g_assert_cmpstr(cola_error_text("1B"), ==, "unknown error");
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	for (size_t i = 0; i < G_N_ELEMENTS(captures); i++) {
		g_autofree char *base = g_path_get_basename(captures[i].path);
		g_autofree char *path = g_strdup_printf("/cola/captured/%s", base);
		g_test_add_data_func(path, &captures[i], test_capture);
	}
	g_test_add_func("/cola/captured/acks", test_captured_acks);
	for (size_t i = 0; i < G_N_ELEMENTS(kinds); i++) {
		g_autofree char *path = g_strdup_printf("/cola/scan/%s", kinds[i].name);
		g_test_add_data_func(path, &kinds[i], test_kind);
	}
	g_test_add_func("/cola/device-error", test_device_error);
	g_test_add_func("/cola/scale-and-codes", test_scale_and_codes);
	g_test_add_func("/cola/values", test_values);
	g_test_add_func("/cola/every-value", test_every_value);
	g_test_add_func("/cola/identity", test_identity);
	g_test_add_func("/cola/answers", test_answers);
	return g_test_run();
}
