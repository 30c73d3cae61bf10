/* The SCIP decoder against the lines of the manual, and made telegrams of every kind. */
#include "acquire/scip.h"
#include "tests/scip-made.h"
#include "tests/support.h"
#include <math.h>

#define PP_UTM                                                                                     \
	"PP\n00P\nMODL:UTM-30LX-EW;I\nDMIN:23;7\nDMAX:60000;J\nARES:1440;^\nAMIN:0;?\n"            \
	"AMAX:1080;Z\nAFRT:540;0\nSCAN:2400;U\n\n"
#define II_URG                                                                                     \
	"II\n00P\nMODL:URG-04LX(Hokuyo Automatic Co.,Ltd.);N\nLASR:OFF;7\n"                        \
	"SCSP:Initial(600[rpm])<-Default setting by user;A\nMESM:IDLE;:\n"                         \
	"SBPS:19200[bps]<-Default setting by user;A\nTIME:081615;N\nSTAT:Sensor works well.;8\n\n"

/* Sums and numbers */

static void test_sums(void)
{
	const char *const status[] = { "00P", "99b", "01Q", "02R", "04T", "0Cc", "0Dd", "0Ee",
		"10Q" };
	for (size_t i = 0; i < G_N_ELEMENTS(status); i++)
		g_assert_cmpint(scip_sum(status[i], 2), ==, status[i][2]);
}

static void test_numbers(void)
{
	uint32_t value;
	g_assert_true(scip_number("CB", 2, &value) && value == 1234);
	g_assert_true(scip_number("1Dh", 3, &value) && value == 5432);
	g_assert_true(scip_number("m2@0", 4, &value) && value == 16000000);
	g_assert_true(scip_number("oo", 2, &value) && value == 4095);
	g_assert_true(scip_number("ooo", 3, &value) && value == 262143);
	g_assert_false(scip_number("0p", 2, &value));
	g_assert_false(scip_number("/0", 2, &value));
}

/* Replies */

static void test_parameters(void)
{
	struct bench b;
	bench_open(&b, PP_URG);
	const struct lidar_identity *identity = decoder_identity(b.d);
	g_assert_cmpstr(identity->model, ==, "URG-04LX(Hokuyo Automatic Co.,Ltd.)");
	g_assert_cmpuint(identity->beams, ==, 682);
	g_assert_cmpfloat_with_epsilon(identity->first_angle_rad, -340 * 2 * M_PI / 1024, 1e-12);
	g_assert_cmpfloat_with_epsilon(identity->angle_step_rad, 2 * M_PI / 1024, 1e-12);
	g_assert_cmpfloat(identity->scan_rate_hz, ==, 10);
	g_assert_cmpfloat(identity->range_max_m, ==, 5.6);
	g_assert_cmpstr(b.got->command->str, ==, "PP");
	g_assert_cmpstr(b.got->status->str, ==, "00");
	g_assert_true(g_str_has_prefix(
		b.got->text->str, "MODL:URG-04LX(Hokuyo Automatic Co.,Ltd.)\nDMIN:20\n"));
	feed_text(&b, PP_UTM);
	g_assert_cmpstr(identity->model, ==, "UTM-30LX-EW");
	g_assert_cmpuint(identity->beams, ==, 1081);
	g_assert_cmpfloat_with_epsilon(identity->first_angle_rad, -0.75 * M_PI, 1e-12);
	g_assert_cmpfloat(identity->scan_rate_hz, ==, 40);
	g_assert_cmpfloat(identity->range_max_m, ==, 60);
	g_assert_cmpuint(b.counts->replies, ==, 2);
	assert_refused(&b, 0, 0);
	bench_close(&b);
}

static void test_version_and_state(void)
{
	struct bench b;
	bench_open(&b, VV_URG);
	const struct lidar_identity *identity = decoder_identity(b.d);
	g_assert_cmpstr(identity->model, ==, "SOKUIKI Sensor URG-04LX");
	g_assert_cmpstr(identity->serial, ==, "H0614967");
	g_assert_cmpstr(identity->firmware, ==, "3.1.00(18/Jan./2007)");
	feed_text(&b, II_URG);
	g_assert_cmpstr(b.got->command->str, ==, "II");
	g_assert_nonnull(strstr(b.got->text->str, "\nSTAT:Sensor works well."));
	g_assert_cmpuint(b.counts->replies, ==, 2);
	assert_refused(&b, 0, 0);
	g_assert_cmpuint(b.counts->skipped_bytes, ==, 0);
	bench_close(&b);
}

/* The same lines with the ';' in their sums. */
static void test_other_sums(void)
{
	struct bench b;
	GString *s = g_string_new("VV\n00P\n");
	put_line(s, "PROD:SOKUIKI Sensor URG-04LX;", 29);
	put_line(s, "SERI:H0614967;", 14);
	g_string_append_c(s, '\n');
	bench_open(&b, s->str);
	g_assert_cmpstr(b.got->text->str, ==, "PROD:SOKUIKI Sensor URG-04LX\nSERI:H0614967");
	g_assert_cmpstr(decoder_identity(b.d)->serial, ==, "H0614967");
	g_string_free(s, TRUE);
	bench_close(&b);
}

static const struct answer {
	const char *wire, *command, *status, *text;
} answers[] = {
	{ "BM\n00P\n\n", "BM", "00", "" },
	{ "BM\n02R\n\n", "BM", "02", "" },
	{ "QT;hello w.+@1\n00P\n\n", "QT", "00", "" },
	{ "TM1\n00P\n030il\n\n", "TM1", "00", "030i" },
	{ "TM1\n00P\n030;>\n\n", "TM1", "00", "030;" },
	{ "TM2\n03S\n\n", "TM2", "03", "" },
	{ "SS115200\n03S\n\n", "SS115200", "03", "" },
	{ "CR03\n00P\n\n", "CR03", "00", "" },
	{ "MD0044010301000;a b\n00P\n\n", "MD0044010301000", "00", "" },
	{ "MD0044010301000\n0Dd\n\n", "MD0044010301000", "0D", "" },
	{ "MD0044010301007\n51V\n\n", "MD0044010301007", "51", "" },
	{ "GD0044010301\n10Q\n\n", "GD0044010301", "10", "" },
	{ "XY12\n0Ee\n\n", "XY12", "0E", "" },
	{ "SCIP2.0\n0Ee\n\n", "SCIP2.0", "0E", "" },
	{ "QT\nE\n\n", "QT", "E", "" },
	{ "QT\r00P\r\r", "QT", "00", "" },
	{ "QT\r\n00P\r\n\r\n", "QT", "00", "" },
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
		assert_refused(&b, 0, 0);
		bench_close(&b);
	}
}

/* Scans */

/* The documented lines themselves. */
static void test_documented_scan(void)
{
	struct bench b;
	GString *s = made_telegram("MD0044010301000", "99", 60);
	const char *start = "MD0044010301000\n99b\n030il\n"
			    "0?X0?[0?^0?a0?d0?g0?j0?m0@00@30@60@90@<0@?0@B0@E0@H0@K0@N0@Q0@T06\n";
	g_assert_true(g_str_has_prefix(s->str, start));
	bench_open(&b, PP_URG);
	feed(&b, s);
	assert_made(&b, 60, false);
	const struct scanline *line = &b.got->line;
	g_assert_cmpint(line->arrival_ns, ==, 42);
	g_assert_cmpuint(line->ticks, ==, 12345);
	g_assert_cmpuint(line->sent_ticks, ==, 12345);
	g_assert_cmpuint(line->counter, ==, 0);
	g_assert_false(line->device_error);
	g_assert_cmpuint(line->range_min_mm, ==, 20);
	g_assert_cmpfloat(line->scan_rate_hz, ==, 10);
	g_assert_cmpfloat_with_epsilon(line->first_angle_rad, -340 * 2 * M_PI / 1024, 1e-12);
	g_assert_cmpfloat_with_epsilon(line->angle_step_rad, 2 * M_PI / 1024, 1e-12);
	g_string_free(s, TRUE);
	bench_close(&b);
}

static const struct scan_kind {
	const char *echo, *status;
	uint32_t steps;
} scan_kinds[] = {
	{ "GD0044010301", "00", 60 },
	{ "GS0044010301", "00", 60 },
	{ "GE0044010301", "00", 60 },
	{ "HD0044010301", "00", 60 },
	{ "HE0044010301", "00", 60 },
	{ "MD0044010301000", "99", 60 },
	{ "MS0044010301000", "99", 60 },
	{ "ME0044010301000", "99", 60 },
	{ "ND0044010301000", "99", 60 },
	{ "NE0044010301000", "99", 60 },
	{ "MD0044010300000", "99", 60 },
	{ "MD0044010307000", "99", 9 },
	{ "ME0000108001102;x", "99", 1081 },
	{ "NE0000108001102", "99", 1081 },
	{ "MD0007000701000", "99", 1 },
	{ "MS0000006301000", "99", 64 },
};

static void test_scan_kinds(void)
{
	for (const struct scan_kind *k = scan_kinds; k < scan_kinds + G_N_ELEMENTS(scan_kinds);
		k++) {
		struct bench b;
		GString *s = made_telegram(k->echo, k->status, k->steps);
		bench_open(&b, PP_UTM);
		feed(&b, s);
		g_assert_cmpuint(b.got->scanlines, ==, 1);
		assert_made(&b, k->steps, k->echo[1] == 'E');
		assert_refused(&b, 0, 0);
		g_assert_cmpuint(b.got->replies, ==, 1); /* of PP */
		g_string_free(s, TRUE);
		bench_close(&b);
	}
}

/* A cluster of 7 from step 44: its middle is step 47. */
static void test_cluster_angles(void)
{
	struct bench b;
	GString *s = made_telegram("MD0044010307000", "99", 9);
	bench_open(&b, PP_URG);
	feed(&b, s);
	g_assert_cmpfloat_with_epsilon(
		b.got->line.first_angle_rad, (47 - 384) * 2 * M_PI / 1024, 1e-12);
	g_assert_cmpfloat_with_epsilon(b.got->line.angle_step_rad, 7 * 2 * M_PI / 1024, 1e-12);
	g_string_free(s, TRUE);
	bench_close(&b);
}

static void test_saturation_and_codes(void)
{
	struct bench b;
	GString *values = g_string_new(NULL), *s;
	const uint32_t ranges[] = { 0, 19, 20, 262143 },
		       intensities[] = { 0, 65535, 65536, 262143 };
	for (size_t i = 0; i < 4; i++) {
		put_number(values, ranges[i], 3);
		put_number(values, intensities[i], 3);
	}
	s = telegram("ME0000000301000", "99", 0xffffff, values);
	bench_open(&b, PP_URG);
	feed(&b, s);
	const struct scanline *line = &b.got->line;
	g_assert_cmpuint(line->ticks, ==, 0xffffff);
	for (uint32_t i = 0; i < 4; i++) {
		g_assert_cmpuint(line->range_mm[i], ==, ranges[i]);
		g_assert_cmpuint(line->intensity[i], ==, MIN(intensities[i], 65535));
		g_assert_true(scanline_has_range(line, i) == (i >= 2));
	}
	g_string_free(values, TRUE);
	g_string_free(s, TRUE);
	bench_close(&b);
}

static void test_shared_scan(gconstpointer data)
{
	const char *path = shared_path(data);
	g_autofree char *bytes = NULL;
	gsize length;
	if (!path) {
		g_test_skip("no ../shared here");
		return;
	}
	g_assert_true(g_file_get_contents(path, &bytes, &length, NULL));
	struct bench b;
	bench_open(&b, PP_URG);
	decoder_feed(b.d, bytes, length, 42);
	const struct scanline *line = &b.got->line;
	bool intensity = strstr(path, "_ME") != NULL;
	g_assert_cmpuint(b.got->scanlines, ==, 1);
	g_assert_cmpuint(b.got->replies, ==, 2);
	g_assert_cmpuint(line->ticks, ==, 12345);
	g_assert_cmpuint(line->beams, ==, 60);
	for (uint32_t i = 0; i < 60; i++) {
		g_assert_cmpuint(line->range_mm[i], ==, 1000 + (intensity ? 1 : 3) * i);
		if (intensity)
			g_assert_cmpuint(line->intensity[i], ==, 500 + i);
	}
	bench_close(&b);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/scip/sums", test_sums);
	g_test_add_func("/scip/numbers", test_numbers);
	g_test_add_func("/scip/parameters", test_parameters);
	g_test_add_func("/scip/version-and-state", test_version_and_state);
	g_test_add_func("/scip/sums-with-semicolon", test_other_sums);
	g_test_add_func("/scip/answers", test_answers);
	g_test_add_func("/scip/documented-scan", test_documented_scan);
	g_test_add_func("/scip/scan-kinds", test_scan_kinds);
	g_test_add_func("/scip/cluster-angles", test_cluster_angles);
	g_test_add_func("/scip/saturation-and-codes", test_saturation_and_codes);
	g_test_add_data_func("/scip/shared-MD", "vectors/scip_synthetic_MD.txt", test_shared_scan);
	g_test_add_data_func("/scip/shared-ME", "vectors/scip_synthetic_ME.txt", test_shared_scan);
	return g_test_run();
}
