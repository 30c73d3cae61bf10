/* The languages of the simulated lidars, word for word. */
#include "tests/sim-heard.h"

static void test_scip_text(void)
{
	g_autoptr(GString) out = g_string_new(NULL);

	/* Lines of real devices. */
	scip_append_property(out, "SERI:H0614967");
	scip_append_property(out, "MODL:UTM-30LX-EW");
	scip_append_property(out, "ARES:1440");
	scip_append_line(out, "99", 2);
	g_assert_cmpstr(out->str, ==, "SERI:H0614967;V\nMODL:UTM-30LX-EW;I\nARES:1440;^\n99b\n");
	g_string_set_size(out, 0);
	scip_append_number(out, 1234, 2);
	scip_append_number(out, 5432, 3);
	scip_append_number(out, 16000000, 4);
	g_assert_cmpstr(out->str, ==, "CB1Dhm2@0");
}

static void test_scip_dialogue(void)
{
	struct rig *rig = start_open("hall?ares=1440");

	assert_answer(rig, "PP\n",
		"PP\n00P\nMODL:PLEINAIR-SIM-200;?\nDMIN:23;7\nDMAX:200000;6\nARES:1440;^\nAMIN:0;?"
		"\n"
		"AMAX:1080;Z\nAFRT:540;0\nSCAN:2400;U\n\n");
	assert_answer(rig, "QT;abc\r\n", "QT;abc\n00P\n\n");
	assert_answer(rig, "BM\n", "BM\n00P\n\n");
	assert_answer(rig, "BM\r", "BM\n02R\n\n");
	assert_answer(rig, "TM1\n", "TM1\n04T\n\n");
	assert_answer(rig, "TM0\n", "TM0\n00P\n\n");
	assert_answer(rig, "TM0\n", "TM0\n02R\n\n");
	assert_answer(rig, "PP\n", "PP\n0Ee\n\n");
	rig_free(rig);
}

static void test_scip_time(void)
{
	struct rig *rig = start_open("hall?clock_start=16777000&drift_ppm=0&jitter_ms=0");

	assert_answer(rig, "TM0\n", "TM0\n00P\n\n");
	g_autofree char *first = rig_ask(rig, "TM1\n");

	rig_run(rig, 0.98);
	g_autofree char *second = rig_ask(rig, "TM1\n");
	uint32_t a = decode(first + 8, 4), b = decode(second + 8, 4);

	g_assert_true(g_str_has_prefix(first, "TM1\n00P\n"));
	g_assert_cmpint(first[12], ==, scip_line_sum(first + 8, 4));
	g_assert_cmpuint(b, <, 1000); /* it wrapped at 2^24 */
	g_assert_cmpuint((b - a) & 0xffffff, ==, 1000);
	assert_answer(rig, "TM2\n", "TM2\n00P\n\n");
	assert_answer(rig, "TM2\n", "TM2\n03S\n\n");
	rig_free(rig);
}

static void test_scip_refusals(void)
{
	static const char *const rows[][2] = { { "XX\n", "0E" }, { "V\n", "0E" }, { "VVV\n", "0D" },
		{ "MD0000\n", "0C" }, { "MDx000108001000\n", "01" }, { "MD0000x08001000\n", "02" },
		{ "MD00001080x1000\n", "03" }, { "MD0000108101000\n", "04" },
		{ "MD0010000901000\n", "05" }, { "MD000010800100x\n", "07" },
		{ "MD00001080010x0\n", "07" }, { "MD000010800 x00\n", "03" },
		{ "MD000010801x000\n", "03" }, { "MD0000108001x00\n", "06" },
		{ "GD0000108001\n", "10" }, { "HD0000108001\n", "0E" },
		{ "NE0000108001000\n", "0E" }, { "SS123456\n", "02" }, { "SS115200\n", "03" },
		{ "SS019200\n", "00" }, { "CR11\n", "02" }, { "CR00\n", "03" },
		{ "VV;12345678901234567\n", "0G" }, { "VV;a-b\n", "0H" }, { "RB\n", "01" } };
	struct rig *rig = start_open("hall?ares=1440");

	for (gsize i = 0; i < G_N_ELEMENTS(rows); i++) {
		g_autofree char *got = rig_ask(rig, rows[i][0]);
		g_autofree char *echo = g_strndup(rows[i][0], strlen(rows[i][0]) - 1);
		g_autofree char *wanted = g_strdup_printf(
			"%s\n%s%c\n\n", echo, rows[i][1], scip_line_sum(rows[i][1], 2));

		g_assert_cmpstr(got, ==, wanted);
	}
	rig_free(rig);
}

static void test_scip_stream(void)
{
	struct rig *rig = start_open("hall?ares=1440&drift_ppm=0&jitter_ms=0&clock_start=16777000");
	struct scan scan;
	g_string_set_size(rig->lidar, 0);
	rig_say(rig, "MD0000108001005;here\n");
	rig_run(rig, 0.3);
	const char *at = rig->lidar->str;
	uint32_t before = 0;

	g_assert_true(g_str_has_prefix(at, "MD0000108001005;here\n00P\n\n"));
	at = skip_answer(at);
	for (int left = 4; left >= 0; left--) {
		g_autofree char *echo = g_strdup_printf("MD00001080010%02d;here", left);

		g_assert_true(next_scan(&at, "99", &scan));
		g_assert_cmpstr(scan.echo, ==, echo);
		g_assert_cmpuint(scan.count, ==, 1081);
		g_assert_true(left == 4 || ((scan.stamp_ms - before) & 0xffffff) == 25);
		before = scan.stamp_ms;
	}
	g_assert_cmpstr(at, ==, "");
	g_autofree char *laser = rig_ask(rig, "BM\n");

	g_assert_true(g_str_has_prefix(laser, "BM\n02R"));
	rig_free(rig);
}

/* Parts, clusters, intervals, intensities, single scans, and answers amid a stream. */
static void test_scip_shapes(void)
{
	struct rig *rig = start_open("hall?ares=1440&jitter_ms=0&noise_mm=0");
	struct scan whole, part, lit;

	g_free(rig_ask(rig, "BM\n"));
	g_string_set_size(rig->lidar, 0);
	rig_say(rig, "GD0000108000\n");
	rig_run(rig, 0.06);
	const char *at = rig->lidar->str;

	g_assert_true(next_scan(&at, "00", &whole));
	g_assert_cmpuint(whole.count, ==, 1081);
	g_string_set_size(rig->lidar, 0);
	rig_say(rig, "MD0100011905201\n"); /* interval 2, one scan */
	rig_run(rig, 0.1);
	at = skip_answer(rig->lidar->str);
	g_assert_true(next_scan(&at, "99", &part));
	g_assert_cmpuint(part.count, ==, 4);
	for (int k = 0; k < 4; k++) {
		uint32_t nearest = 0;

		for (int i = 0; i < 5; i++) {
			uint32_t value = whole.value[100 + 5 * k + i];

			nearest = value >= 23 && (!nearest || value < nearest) ? value : nearest;
		}
		g_assert_cmpuint(part.value[k], ==, nearest);
	}
	g_string_set_size(rig->lidar, 0);
	rig_say(rig, "ME0100011901300\n");
	rig_run(rig, 0.31);
	rig_say(rig, "VV\n");
	rig_run(rig, 0.1);
	at = skip_answer(rig->lidar->str);
	uint32_t stamps[2];

	for (int i = 0; i < 2; i++) {
		g_assert_true(next_scan(&at, "99", &lit));
		stamps[i] = lit.stamp_ms;
	}
	g_assert_cmpuint((stamps[1] - stamps[0]) & 0xffffff, ==, 100);
	g_assert_cmpuint(lit.count, ==, 40);
	g_assert_cmpuint(lit.value[0], ==, whole.value[100]);
	g_assert_cmpuint(lit.value[1], >, 0);
	g_assert_nonnull(strstr(rig->lidar->str, "\n\nVV\n00P\nVEND:"));
	g_free(rig_ask(rig, "QT\n"));
	g_string_set_size(rig->lidar, 0);
	rig_run(rig, 0.3);
	g_assert_cmpuint(rig->lidar->len, ==, 0);
	rig_free(rig);
}

static void test_cola_dialogue(void)
{
	static const char *const rows[][2] = {
		{ "\2sRI0\3", "\2sRA 0 6 TiM571 E V2.61-17.11.20\3" },
		{ "\2sRN SCdevicestate\3", "\2sRA SCdevicestate 1\3" },
		{ "\2sRN LocationName\3\0", "\2sRA LocationName B not defined\3" },
		{ "\2sRN LMPoutputRange\3", "\2sRA LMPoutputRange 1 D05 FFF92230 225510\3" },
		{ "\2sRN LMPscancfg\3", "\2sRA LMPscancfg 5DC 1 D05 FFF92230 225510\3" },
		{ "\2sWN LMPoutputRange 1 D05 0 1B7740\3", "\2sFA A\3" },
		{ "\2sMN mSCreboot\3", "\2sFA 1\3" },
		{ "\2sMN SetAccessMode 03 F4724744\3", "\2sAN SetAccessMode 1\3" },
		{ "\2sRN SCdevicestate\3", "\2sRA SCdevicestate 0\3" },
		{ "\2sWN LMPoutputRange 1 D05 0 1B7740\3", "\2sWA LMPoutputRange\3" },
		{ "\2sWN LMPoutputRange 1 D05 -450001 +2250000\3", "\2sFA 4\3" },
		{ "\2sRN LMPoutputRange\3", "\2sRA LMPoutputRange 1 D05 0 1B7740\3" },
		{ "\2sWN LMDscandatacfg 01 00 1 1 0 00 00 0 1 0 0 +1\3", "\2sWA LMDscandatacfg\3" },
		{ "\2sRN LMDscandatacfg\3", "\2sRA LMDscandatacfg 1 0 1 1 0 0 0 0 1 0 0 1\3" },
		{ "\2sWN LMDscandatacfg 01 00 1\3", "\2sFA 8\3" },
		{ "\2sWN LMDscandatacfg 01 00 1 z 0 00 00 0 1 0 0 +1\3", "\2sFA 11\3" },
		{ "\2sMN Run\3", "\2sAN Run 1\3" },
		{ "\2sMN SetAccessMode 3 12345678\3", "\2sAN SetAccessMode 0\3" },
		{ "\2sRN Nonsense\3", "\2sFA 3\3" },
		{ "\2sMN Nonsense\3", "\2sFA 2\3" },
		{ "\2sEN Nonsense 1\3", "\2sFA F\3" },
		{ "\2xyz\3", "\2sFA C\3" },
		{ "sRN SCdevicestate", "" },
		{ "\2sRN ODpwrc\3\2sRN ODpwrc\3", "\2sRA ODpwrc 79\3\2sFA D\3" },
		{ "\2sMN LMCstopmeas\3", "\2sAN LMCstopmeas 0\3" },
		{ "\2sMN LMCstartmeas\3", "\2sAN LMCstartmeas 0\3" },
	};
	struct rig *rig = start_open("hall?lidar=cola");

	g_assert_cmpstr(rig->hello.lidar_protocol, ==, "cola");
	for (gsize i = 0; i < G_N_ELEMENTS(rows); i++)
		assert_answer(rig, rows[i][0], rows[i][1]);
	rig_free(rig);
}

static void test_cola_stream(void)
{
	struct rig *rig =
		start_open("hall?lidar=cola&drift_ppm=0&clock_start=4294900000&packet=64");
	struct telegram t, before = { 0 };
	int seen = 0;

	g_string_set_size(rig->lidar, 0);
	rig_say(rig, "\2sEN LMDscandata 1\3");
	rig_run(rig, 0.5);
	const char *at = rig->lidar->str;

	g_assert_true(g_str_has_prefix(at, "\2sEA LMDscandata 1\3\2sSN LMDscandata 1 1 1 0 0 "));
	for (; next_telegram(&at, &t); seen++) {
		/* As the captured telegram of a TiM561 without remission. */
		g_assert_cmpuint(t.count, ==, 843);
		g_assert_cmpuint(t.distances, ==, 811);
		g_assert_cmpstr(t.words[16], ==, "5DC");
		g_assert_cmpstr(t.words[20], ==, "DIST1");
		g_assert_cmpstr(t.words[21], ==, "3F800000");
		g_assert_cmpstr(t.words[23], ==, "FFF92230");
		g_assert_cmpstr(t.words[24], ==, "D05");
		g_assert_cmpuint(t.leaves_us - t.end_us, >=, 3900);
		g_assert_cmpuint(t.leaves_us - t.end_us, <=, 4210);
		if (before.words) {
			g_assert_cmpint((t.telegram - before.telegram) & 0xffff, ==, 1);
			g_assert_cmpint((t.scan - before.scan) & 0xffff, ==, 1);
			g_assert_cmpuint(t.end_us - before.end_us, >=, 66666);
			g_assert_cmpuint(t.end_us - before.end_us, <=, 66667);
		}
		telegram_clear(&before);
		before = t;
	}
	g_assert_cmpuint(before.end_us, <, 1000000); /* wrapped at 2^32 */
	telegram_clear(&before);
	g_assert_cmpint(seen, >=, 6);
	g_assert_cmpuint(rig->deliveries, >, 100);
	rig_free(rig);
}

static void ask_scan(struct rig *rig, const char *config, struct telegram *ret_telegram)
{
	g_autofree char *command = g_strdup_printf("\2sWN LMDscandatacfg %s\3", config);

	g_free(rig_ask(rig, "\2sMN SetAccessMode 3 F4724744\3"));
	assert_answer(rig, command, "\2sWA LMDscandatacfg\3");
	g_string_set_size(rig->lidar, 0);
	rig_say(rig, "\2sRN LMDscandata\3");
	rig_run(rig, 0.2);
	const char *at = rig->lidar->str;

	g_assert_true(g_str_has_prefix(at, "\2sRA LMDscandata "));
	g_assert_true(next_telegram(&at, ret_telegram));
	g_assert_cmpstr(at, ==, "");
}

static void test_cola_channels(void)
{
	struct rig *rig = start_open("hall?lidar=cola&beams=271");
	struct telegram t;

	ask_scan(
		rig, "01 00 1 0 0 00 00 0 1 0 0 +1", &t); /* as the captured telegram of a TiM551 */
	g_assert_cmpuint(t.count, ==, 583);
	g_assert_cmpstr(t.words[19], ==, "1");
	g_assert_cmpstr(t.words[26 + 271], ==, "1");
	g_assert_cmpstr(t.words[27 + 271], ==, "RSSI1");
	for (guint i = 33 + 271; i < 33 + 2 * 271; i++)
		g_assert_cmpint(hex(t.words[i]), <=, 255);
	g_autofree char *tail = g_strjoinv(" ", t.words + 575);

	g_assert_cmpstr(tail, ==, "0 1 B not defined 0 0 0");
	telegram_clear(&t);
	ask_scan(rig, "01 00 1 1 0 00 00 0 0 0 1 +1", &t); /* remission of 16 bits */
	g_assert_cmpstr(t.words[19], ==, "2");
	g_assert_cmpstr(t.words[26 + 271], ==, "RSSI1");
	g_assert_cmpstr(t.words[26 + 2 * 271 + 6], ==, "0");
	telegram_clear(&t);
	g_free(rig_ask(rig, "\2sMN SetAccessMode 3 F4724744\3"));
	assert_answer(rig, "\2sWN LMPoutputRange 1 2710 0 +100000\3", "\2sWA LMPoutputRange\3");
	ask_scan(rig, "01 00 0 0 0 00 00 0 0 0 0 +1", &t);
	g_assert_cmpstr(t.words[23], ==, "0");
	g_assert_cmpstr(t.words[25], ==, "B");
	telegram_clear(&t);
	rig_free(rig);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_autoptr(truth) t = truth_new("hall", NULL);

	shared = truth_world(t);
	g_test_add_func("/sim/scip/text", test_scip_text);
	g_test_add_func("/sim/scip/dialogue", test_scip_dialogue);
	g_test_add_func("/sim/scip/time", test_scip_time);
	g_test_add_func("/sim/scip/refusals", test_scip_refusals);
	g_test_add_func("/sim/scip/stream", test_scip_stream);
	g_test_add_func("/sim/scip/shapes", test_scip_shapes);
	g_test_add_func("/sim/cola/dialogue", test_cola_dialogue);
	g_test_add_func("/sim/cola/stream", test_cola_stream);
	g_test_add_func("/sim/cola/channels", test_cola_channels);
	return g_test_run();
}
