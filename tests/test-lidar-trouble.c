/* What is wrong at a lidar's port, told apart and in words: no power, the wrong speed, another
 * lidar, a broken one, a mirror that stands; and each make is found at its own speed. */
#include "acquire/run-private.h"
#include "acquire/scan-manifest.h"
#include "acquire/sniff.h"
#include "tests/simulated.h"
#include <string.h>

/* Prepares the lidar of a simulated head as if it were opened as the protocol's; NULL for its own. */
static run *prepare(simulated *s, const char *description, const char *protocol, head **ret_head,
	GError **error)
{
	static const struct run_options options = { .preset = NULL };
	struct run_options o = options;
	head *h = *ret_head = simulated_take_head(s);
	o.preset = preset_find("draft");
	if (protocol) {
		g_free(h->lidar_protocol);
		h->lidar_protocol = g_strdup(protocol);
	}
	run *r = run_new(h, &o);
	g_autofree char *text = scan_session_text(description, h);
	struct record_entry e = { .kind = RECORD_SESSION,
		.length = strlen(text),
		.time_ns = head_now_ns(h),
		.payload = text };
	g_assert_true(run_begin(r, &e, NULL));
	run_prepare(r, error);
	return r;
}

static const struct trouble {
	const char *path, *description, *protocol, *says[3];
} troubles[] = {
	{ "/trouble/ld/no-byte", "hall?lidar=scip", "ld",
		{ "no byte comes", "at 230400 or 921600 baud", "have power" } },
	{ "/trouble/ld/wrong-speed", "hall?lidar=ld06&baud=57600", NULL,
		{ "nothing that makes sense at 230400 or 921600 baud" } },
	{ "/trouble/ld/stands", "hall?lidar=ld19&stuck=1", NULL, { "its mirror does not turn" } },
	{ "/trouble/ld/not-there", "hall?lidar=none", "ld", { "the lidar is not there" } },
	{ "/trouble/rplidar/no-byte", "hall?lidar=rplidar-a1&baud=57600", NULL,
		{ "no byte comes", "at 115200, 256000, 460800 or 1000000 baud", "have power" } },
	{ "/trouble/rplidar/ld-there", "hall?lidar=ld06", "rplidar",
		{ "another lidar", "LDRobot", "at 230400 baud; open it as ld:" } },
	{ "/trouble/rplidar/stl-there", "hall?lidar=stl27l", "rplidar",
		{ "another lidar", "LDRobot", "at 921600 baud; open it as ld:" } },
	{ "/trouble/rplidar/unknown-there", "hall?lidar=ld06&baud=57600", "rplidar",
		{ "nothing that makes sense at 115200, 256000, 460800 or 1000000 baud" } },
	{ "/trouble/rplidar/broken", "hall?lidar=rplidar-a2&health=2", NULL,
		{ "health 2, error 8001", "after a reset too" } },
	{ "/trouble/rplidar/stands", "hall?lidar=rplidar-s2&stuck=1", NULL,
		{ "its mirror does not turn" } },
	/* At 9600 baud, as a port is that nobody has set. */
	{ "/trouble/cola/ld-there", "hall?lidar=ld06&baud=9600", "cola",
		{ "another lidar", "LDRobot", "open it as ld:" } },
	{ "/trouble/cola/garbage", "hall?lidar=ld06", "cola", { "nothing that makes sense" } },
	{ "/trouble/cola/no-ranges", "hall?lidar=cola&ident=TiM3XX", NULL,
		{ "this lidar measures no ranges", "TiM3XX" } },
	{ "/trouble/cola/silent", "hall?lidar=scip", "cola", { "the lidar is silent" } },
	{ "/trouble/scip/garbage", "hall?lidar=ld06", "scip", { "nothing that makes sense" } },
	{ "/trouble/scip/silent", "hall?lidar=cola", "scip", { "the lidar is silent" } },
};

static void test_trouble(gconstpointer data)
{
	const struct trouble *t = data;
	g_autoptr(GError) error = NULL;
	head *h;
	simulated *s = simulated_start(t->description, NULL, NULL);
	g_autoptr(run) r = prepare(s, t->description, t->protocol, &h, &error);
	g_assert_nonnull(error);
	g_test_message("%s", error->message);
	for (size_t i = 0; i < G_N_ELEMENTS(t->says) && t->says[i]; i++)
		g_assert_nonnull(strstr(error->message, t->says[i]));
	head_close(h);
	simulated_stop(s);
}

static const struct find {
	const char *path, *description, *model;
	double rate_hz;
	uint32_t beams; /* of a turn, give or take the motor */
} finds[] = {
	{ "/find/ld06", "hall?lidar=ld06", "LD06/LD19", 10, 450 },
	{ "/find/ld19-slow", "hall?lidar=ld19&rate_hz=6", "LD06/LD19", 6, 750 },
	{ "/find/stl27l", "hall?lidar=stl27l", "STL-27L", 10, 2160 },
	{ "/find/rplidar-a1", "hall?lidar=rplidar-a1", "RPLIDAR A1 (model 18)", 5.5, 1432 },
	{ "/find/rplidar-a1-standard", "hall?lidar=rplidar-a1&format=standard",
		"RPLIDAR A1 (model 18)", 5.5, 385 },
	{ "/find/rplidar-a2-warning", "hall?lidar=rplidar-a2&health=1", "RPLIDAR A2 (model 28)", 10,
		395 },
	{ "/find/rplidar-a3", "hall?lidar=rplidar-a3", "RPLIDAR A3 (model 31)", 10, 1600 },
	{ "/find/rplidar-c1", "hall?lidar=rplidar-c1", "RPLIDAR C (model 41)", 10, 500 },
	{ "/find/rplidar-s1", "hall?lidar=rplidar-s1", "RPLIDAR S1 (model 61)", 10, 922 },
	{ "/find/rplidar-s2", "hall?lidar=rplidar-s2", "RPLIDAR S (model 71)", 10, 3200 },
	{ "/find/rplidar-s3", "hall?lidar=rplidar-s3", "RPLIDAR S (model 81)", 10, 3200 },
};

static void test_find(gconstpointer data)
{
	const struct find *t = data;
	g_autoptr(GError) error = NULL;
	head *h;
	simulated *s = simulated_start(t->description, NULL, NULL);
	g_autoptr(run) r = prepare(s, t->description, NULL, &h, &error);
	g_assert_no_error(error);
	const struct lidar_identity *identity = run_lidar(r);
	g_test_message(
		"%s: %.3f Hz, %u beams", identity->model, identity->scan_rate_hz, identity->beams);
	g_assert_cmpstr(identity->model, ==, t->model);
	g_assert_cmpfloat_with_epsilon(identity->scan_rate_hz, t->rate_hz, 0.01 * t->rate_hz);
	g_assert_cmpfloat_with_epsilon(identity->beams, t->beams, 0.02 * t->beams);
	head_close(h);
	simulated_stop(s);
}

/* ---- its motor ---- */

static struct {
	const struct wire_ops *real;
	unsigned times;
	struct wire_line line;
} lines;

static bool note_line(wire *w, const struct wire_line *line, GError **error)
{
	lines.times++;
	lines.line = *line;
	return lines.real->set_line(w, line, error);
}

/* An A1's motor hangs on DTR: it rests when the lidar has stopped, and runs again when it is started. */
static void test_motor(void)
{
	static const char *const description = "hall?lidar=rplidar-a1";
	g_autoptr(GError) error = NULL;
	head *h;
	simulated *s = simulated_start(description, NULL, NULL);
	g_autoptr(run) r = prepare(s, description, NULL, &h, &error);
	g_assert_no_error(error);
	lines.real = h->lidar->ops;
	struct wire_ops noting = *lines.real;
	noting.set_line = note_line;
	h->lidar->ops = &noting;
	for (int i = 0; i < 2; i++) {
		g_assert_true(pump_start_lidar(&r->pump, &error));
		g_assert_no_error(error);
		g_assert_false(lines.line.dtr);
		g_assert_cmpuint(lines.line.baud, ==, 115200);
		g_assert_true(pump_stop_lidar(&r->pump, &error));
		g_assert_no_error(error);
		g_assert_true(lines.line.dtr);
		g_assert_cmpuint(lines.line.baud, ==, 115200);
	}
	g_assert_cmpuint(lines.times, ==, 4);
	h->lidar->ops = lines.real;
	head_close(h);
	simulated_stop(s);
}

/* ---- which protocol bytes look like ---- */

static const struct smell {
	const char *text;
	gsize length; /* 0: as text */
	enum sniffed what;
} smells[] = {
	{ "", 0, SNIFFED_NOTHING },
	{ "hello world, nobody knows me\r\n", 0, SNIFFED_GARBAGE },
	{ "\x02sRA SCdevicestate 1\x03", 0, SNIFFED_COLA },
	{ "CD 12 \x03\x02sSN LMDscandata 1 1", 0, SNIFFED_COLA },
	{ "\x02\x02\x02\x02\0\0\0\x13sRA DeviceIdent", 23, SNIFFED_COLA_B },
	{ "QT\n00P\n\n", 0, SNIFFED_SCIP },
	{ "x\nMD0000108000000\n99b\n0000", 0, SNIFFED_SCIP },
	{ "QT\n00X\n\n", 0, SNIFFED_GARBAGE },
	{ "\x01\xa5\x5a\x03\0\0\0\x06\0\0\0", 11, SNIFFED_RPLIDAR },
	{ "\xa5\x5a\x05\0\0\x40\x81", 7, SNIFFED_RPLIDAR },
	{ "\xa5\x5a\x05\0\0\x40\x82", 7, SNIFFED_GARBAGE },
};

static void test_smells(void)
{
	for (size_t i = 0; i < G_N_ELEMENTS(smells); i++) {
		struct sniff s = { 0 };
		gsize length = smells[i].length ? smells[i].length : strlen(smells[i].text);
		sniff_feed(&s, smells[i].text, length);
		g_assert_cmpint(sniff_what(&s), ==, smells[i].what);
	}
}

/* Of all that may come at a wrong speed nothing may be taken for a lidar. */
static void test_noise(void)
{
	g_autoptr(GRand) chance = g_rand_new_with_seed(7);
	for (int round = 0; round < 300; round++) {
		struct sniff s = { 0 };
		uint8_t bytes[SNIFF_BYTES];
		for (size_t i = 0; i < sizeof bytes; i++)
			bytes[i] = (uint8_t)(round % 3 == 2 ? (g_rand_int(chance) & 1 ? 0xff : 0xfe)
							    : g_rand_int(chance));
		sniff_feed(&s, bytes, sizeof bytes);
		g_assert_cmpint(sniff_what(&s), ==, SNIFFED_GARBAGE);
	}
	struct sniff s = { 0 };
	uint8_t zeros[9000] = { 0 };
	sniff_feed(&s, zeros, sizeof zeros);
	g_assert_cmpint(sniff_what(&s), ==, SNIFFED_GARBAGE);
	g_assert_cmpuint(s.total, ==, 9000);
	g_assert_cmpuint(s.length, ==, SNIFF_BYTES);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	for (size_t i = 0; i < G_N_ELEMENTS(troubles); i++)
		g_test_add_data_func(troubles[i].path, &troubles[i], test_trouble);
	for (size_t i = 0; i < G_N_ELEMENTS(finds); i++)
		g_test_add_data_func(finds[i].path, &finds[i], test_find);
	g_test_add_func("/rplidar/motor", test_motor);
	g_test_add_func("/sniff/kinds", test_smells);
	g_test_add_func("/sniff/noise", test_noise);
	return g_test_run();
}
