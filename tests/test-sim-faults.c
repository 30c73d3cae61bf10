/* Faults of a simulated head do what they say. */
#include "tests/sim-heard.h"
#include <math.h>

/* Starts a stream, homes, and turns once past the given column; what the lidar says is in
 * rig->lidar. */
static struct rig *scan_past(const char *description, const char *start_command, int column)
{
	struct rig *rig = start_open(description);
	int64_t home = rig_home(rig);

	g_string_set_size(rig->lidar, 0);
	rig->deliveries = 0;
	rig_say(rig, start_command);
	rig_run(rig, 0.25);
	rig_move(rig, home + (int64_t)ceil(column * 11886 / 3000.0) + 20, 1000, 20000);
	rig_run(rig, column / 3000.0 * 11.886 + 0.7);
	return rig;
}

#define SCIP_START  "MD0000027001000\n"
#define SCIP_COARSE "hall?home_deg=350&ares=360&drift_ppm=0&jitter_ms=0&dropouts=0&fault="

/* The gaps between the stamps of a stream's scans, in revolutions; damaged scans are passed over.
 */
static GArray *gaps_of(const struct rig *rig)
{
	GArray *gaps = g_array_new(FALSE, FALSE, sizeof(guint));
	const char *at = skip_answer(rig->lidar->str);
	static struct scan scan;
	uint32_t before = UINT32_MAX;

	while (next_scan(&at, "99", &scan)) {
		guint gap = (guint)(((scan.stamp_ms - before) & 0xffffff) + 12) / 25;

		if (before != UINT32_MAX)
			g_array_append_val(gaps, gap);
		before = scan.stamp_ms;
	}
	return gaps;
}

static guint most(const GArray *gaps)
{
	guint highest = 0;

	for (guint i = 0; i < gaps->len; i++)
		highest = MAX(highest, g_array_index(gaps, guint, i));
	return highest;
}

static void test_fault_drop_and_stall(void)
{
	struct rig *rig = scan_past(SCIP_COARSE "drop@200x3", SCIP_START, 200);
	g_autoptr(GArray) gaps = gaps_of(rig);

	g_assert_cmpuint(most(gaps), ==, 4);
	rig_free(rig);
	rig = scan_past(SCIP_COARSE "stall@200:0.4", SCIP_START, 200);
	g_autoptr(GArray) silent = gaps_of(rig);

	g_assert_cmpuint(most(silent), >=, 16);
	g_assert_cmpuint(most(silent), <=, 17);
	rig_free(rig);
	rig = scan_past(SCIP_COARSE "stall@100", SCIP_START, 300);
	g_string_set_size(rig->lidar, 0);
	rig_run(rig, 5);
	g_assert_cmpuint(rig->lidar->len, ==, 0);
	rig_send(rig, LINK_LIDAR_CLOSE, NULL, 0);
	g_assert_true(rig_open(rig));
	rig_run(rig, 0.2);
	g_assert_cmpuint(rig->lidar->len, >, 0); /* it never stopped measuring */
	rig_free(rig);
}

static void test_fault_bytes(void)
{
	struct rig *good = scan_past(SCIP_COARSE "jump@200", SCIP_START, 200);
	struct rig *rig = scan_past(SCIP_COARSE "garble@200x2", SCIP_START, 200);
	guint differ = 0;

	g_assert_cmpuint(good->lidar->len, >, 10000);
	for (gsize i = 0; i < MIN(good->lidar->len, rig->lidar->len); i++)
		differ += good->lidar->str[i] != rig->lidar->str[i];
	g_assert_true(differ > 0 || good->lidar->len != rig->lidar->len);
	g_assert_cmpint(labs((long)good->lidar->len - (long)rig->lidar->len), <=, 8);
	rig_free(rig);
	rig = scan_past(SCIP_COARSE "split@200:11", SCIP_START, 200);
	g_assert_cmpstr(rig->lidar->str, ==, good->lidar->str);
	g_assert_cmpuint(rig->deliveries, >, good->deliveries + 50);
	rig_free(rig);
	rig = scan_past(SCIP_COARSE "merge@200x3", SCIP_START, 200);
	g_assert_cmpstr(rig->lidar->str, ==, good->lidar->str);
	g_assert_cmpuint(rig->deliveries, ==, good->deliveries - 3);
	rig_free(rig);
	rig_free(good);
}

static void test_fault_codes(void)
{
	struct rig *rig = scan_past(SCIP_COARSE "codes@200x2:60", SCIP_START, 200);
	const char *at = skip_answer(rig->lidar->str);
	static struct scan scan;
	int usual = -1, struck = 0;

	while (next_scan(&at, "99", &scan)) {
		int codes = 0;

		for (guint i = 0; i < scan.count; i++)
			codes += scan.value[i] == 1;
		usual = usual < 0 ? codes : usual;
		struck += codes >= usual + 30;
	}
	g_assert_cmpint(struck, ==, 2);
	rig_free(rig);
}

static void test_fault_error(void)
{
	struct rig *rig = scan_past(SCIP_COARSE "error@200", SCIP_START, 200);

	g_assert_true(g_str_has_suffix(rig->lidar->str, "\n\nMD0000027001000\n50U\n\n"));
	g_autofree char *state = rig_ask(rig, "II\n");

	g_assert_nonnull(strstr(state, "STAT:Error"));
	assert_answer(rig, "BM\n", "BM\n01Q\n\n");
	assert_answer(rig, "RS\n", "RS\n00P\n\n");
	assert_answer(rig, "BM\n", "BM\n00P\n\n");
	rig_free(rig);
	rig = scan_past("hall?lidar=cola&home_deg=350&beams=271&fault=error@200,jump@250:7",
		"\2sEN LMDscandata 1\3", 300);
	const char *at = rig->lidar->str;
	struct telegram t = { 0 };
	long scan = -1, jumps = 0, errors = 0, first_status = -1;

	while (next_telegram(&at, &t)) {
		first_status = first_status < 0 ? t.status : first_status;
		errors += t.status;
		jumps += scan >= 0 && ((t.scan - scan) & 0xffff) == 8;
		scan = t.scan;
		telegram_clear(&t);
	}
	g_assert_cmpint(first_status, ==, 0);
	g_assert_cmpint(errors, >, 1);
	g_assert_cmpint(jumps, ==, 1);
	g_free(rig_ask(rig, "\2sEN LMDscandata 0\3"));
	rig_run(rig, 0.2);
	assert_answer(rig, "\2sRN SCdevicestate\3", "\2sRA SCdevicestate 2\3");
	g_free(rig_ask(rig, "\2sMN SetAccessMode 3 F4724744\3"));
	assert_answer(rig, "\2sMN mSCreboot\3", "\2sAN mSCreboot\3");
	g_assert_cmpuint(rig->unplugged, ==, 1);
	g_assert_false(rig_open(rig));
	rig_run(rig, 8);
	g_assert_true(rig_open(rig));
	assert_answer(rig, "\2sRN SCdevicestate\3", "\2sRA SCdevicestate 1\3");
	rig_free(rig);
}

static void test_fault_unplug(void)
{
	struct rig *rig = scan_past(SCIP_COARSE "unplug@200:3", SCIP_START, 200);

	g_assert_cmpuint(rig->unplugged, ==, 1);
	g_assert_false(g_str_has_suffix(rig->lidar->str, "\n\n")); /* amid a telegram */
	g_assert_false(rig_open(rig));
	g_assert_cmpuint(rig->unplugged, ==, 2);
	rig_run(rig, 3);
	g_assert_true(rig_open(rig));
	g_autofree char *state = rig_ask(rig, "II\n");

	g_assert_nonnull(strstr(state, "LASR:OFF")); /* it began anew, its clock too */
	g_assert_nonnull(strstr(state, "TIME:000"));
	rig_free(rig);
	rig = start("hall?lidar=none");
	g_assert_false(rig_open(rig));
	g_assert_cmpuint(rig->unplugged, ==, 1);
	rig_free(rig);
}

static void test_fault_power(void)
{
	struct rig *rig = scan_past(SCIP_COARSE "power@200", SCIP_START, 200);

	g_assert_true(rig->gone);
	rig_stop(rig);
	g_assert_true(rig->good);
	g_assert_no_error(rig->error);
	rig_free(rig);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_autoptr(truth) t = truth_new("hall", NULL);

	shared = truth_world(t);
	g_test_add_func("/sim/fault/drop-and-stall", test_fault_drop_and_stall);
	g_test_add_func("/sim/fault/bytes", test_fault_bytes);
	g_test_add_func("/sim/fault/codes", test_fault_codes);
	g_test_add_func("/sim/fault/error", test_fault_error);
	g_test_add_func("/sim/fault/unplug", test_fault_unplug);
	g_test_add_func("/sim/fault/power", test_fault_power);
	return g_test_run();
}
