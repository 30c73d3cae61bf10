/* A scan played back from its record: the same devices, the same run, the same panorama. */
#include "acquire/planes.h"
#include "firmware-io/record-format.h"
#include "tests/simulated.h"
#include <string.h>

static char *record_path(const char *folder)
{
	return g_build_filename(folder, "scans", "0001", "raw.rec", NULL);
}

static bool replay(const char *from, const char *to, const char *preset, struct scan_result *result,
	GError **error)
{
	g_autofree char *uri = g_strconcat("replay:", from, NULL);
	struct scan_options options = { .device = uri, .preset = preset_find(preset) };
	uint32_t partial;
	g_autoptr(site) s = site_open_for_writing(to, error);
	return s && scan_record(s, &options, result, &partial, error);
}

static void assert_same_file(const char *a, const char *b, const char *name)
{
	g_autofree char *pa = g_build_filename(a, "scans", "0001", name, NULL),
			*pb = g_build_filename(b, "scans", "0001", name, NULL), *ta = NULL,
			*tb = NULL;
	gsize la, lb;
	g_test_message("%s", name);
	bool in_a = g_file_get_contents(pa, &ta, &la, NULL),
	     in_b = g_file_get_contents(pb, &tb, &lb, NULL);
	g_assert_true(in_a == in_b);
	if (in_a)
		g_assert_cmpmem(ta, la, tb, lb);
}

/* Entries of each kind. */
static void count_entries(const char *path, uint32_t counts[RECORD_KINDS])
{
	g_autoptr(GError) error = NULL;
	g_autoptr(record_reader) r = record_open(path, &error);
	struct record_entry e;
	g_assert_no_error(error);
	memset(counts, 0, RECORD_KINDS * sizeof *counts);
	while (record_next(r, &e, NULL) == RECORD_ENTRY)
		counts[e.kind]++;
}

/* What one pass over the record counts; developing goes through it twice. */
static struct stream_report count_once(const char *path)
{
	g_autoptr(record_reader) r = record_open(path, NULL);
	g_autoptr(stream) s = stream_new(STREAM_LIVE, &(struct stream_sink){ 0 });
	struct record_entry e;
	while (record_next(r, &e, NULL) == RECORD_ENTRY)
		g_assert_true(stream_feed(s, &e, NULL));
	return stream_get_report(s);
}

static const struct scene {
	const char *path, *description;
} scenes[] = {
	{ "/replay/scip", "hall?seed=4&ares=400&camera=48x80" },
	{ "/replay/cola", "hall?seed=4&lidar=cola&beams=271&camera=none" },
	{ "/replay/jitter", "hall?seed=4&ares=400&camera=none&jitter_ms=4&packet=64" },
	{ "/replay/lost-and-slipped",
		"hall?seed=4&ares=400&camera=none&fault=drop@300x4,slip@900:60" },
	{ "/replay/unplugged",
		"hall?seed=4&ares=400&camera=32x48&fault=unplug@500:3,garble@700x2" },
	{ "/replay/stalled", "hall?seed=4&ares=400&camera=none&fault=stall@500" },
	{ "/replay/camera-gone", "hall?seed=4&ares=400&camera=32x48&fault=cameragone@500" },
};

static void test_same(gconstpointer data)
{
	const struct scene *s = data;
	g_autofree char *folder = simulated_folder(), *a = g_build_filename(folder, "a", NULL),
			*b = g_build_filename(folder, "b", NULL), *ra = record_path(a),
			*rb = record_path(b);
	struct scan_options options = { .preset = preset_find("draft") };
	struct scan_result first, second;
	uint32_t partial, in_a[RECORD_KINDS], in_b[RECORD_KINDS];
	g_autoptr(GError) error = NULL;
	g_assert_true(
		simulated_scan(a, s->description, &options, NULL, NULL, &first, &partial, &error));
	g_assert_no_error(error);
	g_assert_true(replay(ra, b, "draft", &second, &error));
	g_assert_no_error(error);
	count_entries(ra, in_a);
	count_entries(rb, in_b);
	for (int kind = RECORD_SESSION; kind < RECORD_KINDS; kind++)
		g_test_message("kind %d: %u and %u entries", kind, in_a[kind], in_b[kind]);
	/* Also what was asked: the dialogue keeps step with the answers. */
	g_assert_cmpuint(in_a[RECORD_LIDAR_OUT], ==, in_b[RECORD_LIDAR_OUT]);
	g_assert_cmpuint(in_a[RECORD_STAGE], ==, in_b[RECORD_STAGE]);
	g_assert_cmpuint(in_a[RECORD_LIDAR_IN], ==, in_b[RECORD_LIDAR_IN]);
	g_assert_cmpuint(in_a[RECORD_FRAME], ==, in_b[RECORD_FRAME]);
	g_assert_cmpuint(first.report.revolutions, ==, second.report.revolutions);
	g_assert_cmpuint(first.counts.measured, >, 10000);
	struct stream_report once = count_once(ra);
	g_test_message("%u bad telegrams", (unsigned)once.bad_telegrams);
	g_assert_cmpuint(first.report.bad_telegrams, ==, once.bad_telegrams);
	g_assert_cmpuint(first.report.lost_revolutions, ==, once.lost_revolutions);
	g_assert_true((strstr(s->description, "garble") != NULL) == (once.bad_telegrams > 0));
	for (int i = 0; planes_names[i]; i++)
		assert_same_file(a, b, planes_names[i]);
}

/* Entries of one instant are all given out, whichever is asked for first; what nobody asks for does
 * not hold up the rest. */
static void test_one_instant(void)
{
	static const char session[] = "{\"protocol\":\"scip\",\"calibration\":{}}";
	static const enum record_kind kinds[] = { RECORD_LIDAR_OPENED, RECORD_STAGE,
		RECORD_LIDAR_IN, RECORD_FRAME, RECORD_STAGE, RECORD_LIDAR_IN, RECORD_LIDAR_IN };
	g_autofree char *folder = simulated_folder(),
			*path = g_build_filename(folder, "a.rec", NULL);
	g_autoptr(record_writer) w = record_create(path, NULL);
	record_write(w, RECORD_SESSION, 0, session, strlen(session), NULL, 0, NULL);
	for (int i = 0; i < 3; i++)
		for (size_t k = 0; k < G_N_ELEMENTS(kinds); k++)
			record_write(w, kinds[k], 5000 * (i + 1), "12345678", 8, NULL, 0, NULL);
	g_assert_true(record_close(g_steal_pointer(&w), NULL));
	g_autoptr(head) h = head_open_replay(path, NULL);
	g_assert_nonnull(h);
	g_assert_true(wire_open(h->lidar, NULL));
	int lidar_bytes = 0, events_read = 0;
	for (int turn = 0; turn < 100; turn++) {
		uint8_t bytes[3];
		const struct stage_event *events;
		int64_t at_ns;
		g_assert_true(head_wait(h, head_now_ns(h) + 1000, NULL));
		for (gssize n; (n = wire_read(h->lidar, bytes, sizeof bytes, &at_ns, NULL)) > 0;)
			lidar_bytes += (int)n;
		for (gssize n; (n = stage_read(h->stage, &events, &at_ns, NULL)) > 0;)
			events_read += (int)n;
	}
	g_assert_cmpint(lidar_bytes, ==, 3 * 3 * 8);
	g_assert_cmpint(events_read, ==, 3 * 2);
}

/* An attempt to open fails as it did when the record was made. */
static void test_plugging(void)
{
	static const char session[] = "{\"protocol\":\"scip\",\"calibration\":{}}";
	g_autofree char *folder = simulated_folder(),
			*path = g_build_filename(folder, "a.rec", NULL);
	g_autoptr(record_writer) w = record_create(path, NULL);
	record_write(w, RECORD_SESSION, 0, session, strlen(session), NULL, 0, NULL);
	record_write(w, RECORD_LIDAR_OPENED, 0, NULL, 0, NULL, 0, NULL);
	record_write(w, RECORD_LIDAR_GONE, 1000, NULL, 0, NULL, 0, NULL);
	record_write(w, RECORD_STAGE, 3000, "12345678", 8, NULL, 0, NULL);
	record_write(w, RECORD_LIDAR_OPENED, 4000, NULL, 0, NULL, 0, NULL);
	record_write(w, RECORD_LIDAR_IN, 9000, "1", 1, NULL, 0, NULL);
	g_assert_true(record_close(g_steal_pointer(&w), NULL));
	g_autoptr(head) h = head_open_replay(path, NULL);
	g_assert_true(wire_open(h->lidar, NULL));
	for (int turn = 0; turn < 12; turn++) {
		uint8_t byte;
		int64_t at_ns = head_now_ns(h);
		const struct stage_event *events;
		if (at_ns == 1500 || at_ns == 2500)
			g_assert_false(wire_open(h->lidar, NULL));
		if (at_ns == 4500)
			g_assert_true(wire_open(h->lidar, NULL));
		g_assert_true(head_wait(h, at_ns + 500, NULL));
		wire_read(h->lidar, &byte, 1, &at_ns, NULL);
		stage_read(h->stage, &events, &at_ns, NULL);
	}
	g_assert_cmpint(head_now_ns(h), >, 4000);
}

/* ---- what cannot be replayed ---- */

static void write_record(const char *path, const char *session)
{
	g_autoptr(record_writer) w = record_create(path, NULL);
	g_assert_nonnull(w);
	if (session)
		g_assert_true(record_write(
			w, RECORD_SESSION, 1000, session, strlen(session), NULL, 0, NULL));
	g_assert_true(record_write(w, RECORD_LIDAR_OPENED, 2000, NULL, 0, NULL, 0, NULL));
	g_assert_true(record_write(w, RECORD_LIDAR_IN, 3000, "", 0, NULL, 0, NULL));
	g_assert_true(record_write(w, RECORD_STAGE, 3000, "abc", 3, NULL, 0, NULL));
	g_assert_true(record_write(w, RECORD_FRAME, 3000, "abc", 3, NULL, 0, NULL));
	g_assert_true(record_write(w, RECORD_LIDAR_GONE, 4000, NULL, 0, NULL, 0, NULL));
}

static char *nested(void)
{
	char *text = g_malloc(3000001);
	memset(text, '[', 3000000);
	text[3000000] = '\0';
	return text;
}

static const struct {
	const char *why, *session, *complaint;
} headers[] = {
	{ "no session", NULL, "no session" },
	{ "no JSON", "{", "no session" },
	{ "no object", "[1]", "no session" },
	{ "nested", "*", "no session" },
	{ "no protocol", "{\"calibration\":{}}", "no session" },
	{ "odd protocol", "{\"protocol\":7,\"calibration\":{}}", "no session" },
	{ "null protocol", "{\"protocol\":null,\"calibration\":{}}", "no session" },
	{ "no calibration", "{\"protocol\":\"scip\"}", "no session" },
	{ "no calibration to speak of", "{\"protocol\":\"scip\",\"calibration\":7}",
		"calibration" },
	{ "an empty calibration", "{\"protocol\":\"scip\",\"calibration\":{}}", "'serial'" },
};

static void assert_refused(const char *from, const char *to, const char *why, const char *complaint)
{
	g_autoptr(GError) error = NULL;
	struct scan_result result;
	g_assert_false(replay(from, to, "draft", &result, &error));
	g_assert_nonnull(error);
	g_test_message("%s: %s", why, error->message);
	g_assert_nonnull(strstr(error->message, complaint));
	g_assert_null(strchr(error->message, '\n'));
}

static void test_headers(void)
{
	g_autofree char *folder = simulated_folder(), *to = g_build_filename(folder, "site", NULL),
			*deep = nested();
	for (size_t i = 0; i < G_N_ELEMENTS(headers); i++) {
		g_autofree char *path = g_strdup_printf("%s/%zu.rec", folder, i);
		const char *session = headers[i].session;
		write_record(path, session && *session == '*' ? deep : session);
		assert_refused(path, to, headers[i].why, headers[i].complaint);
	}
}

static void test_files(void)
{
	g_autofree char *folder = simulated_folder(), *to = g_build_filename(folder, "site", NULL),
			*none = g_build_filename(folder, "none.rec", NULL),
			*other = g_build_filename(folder, "other.rec", NULL);
	assert_refused(none, to, "missing", "none.rec");
	g_assert_true(g_file_set_contents(other, "P5 640 480 255", -1, NULL));
	assert_refused(other, to, "another kind of file", "other.rec");
	g_assert_true(g_file_set_contents(other, "", 0, NULL));
	assert_refused(other, to, "empty", "other.rec");
}

/* A record that has been cut, or spoilt in the middle, plays up to there and then says so. */
static void test_damaged(void)
{
	g_autofree char *folder = simulated_folder(), *a = g_build_filename(folder, "a", NULL),
			*path = record_path(a), *bytes = NULL,
			*cut = g_build_filename(folder, "cut.rec", NULL),
			*spoilt = g_build_filename(folder, "spoilt.rec", NULL),
			*to = g_build_filename(folder, "b", NULL),
			*session2 = g_strconcat(path, "?session=2", NULL);
	struct scan_options options = { .preset = preset_find("draft") };
	struct scan_result result;
	uint32_t partial;
	gsize length;
	g_assert_true(simulated_scan(a, "hall?seed=4&ares=400&camera=none", &options, NULL, NULL,
		&result, &partial, NULL));
	g_assert_true(g_file_get_contents(path, &bytes, &length, NULL));
	g_assert_true(g_file_set_contents(cut, bytes, 5000, NULL));
	assert_refused(cut, to, "cut early", "the record has ended");
	bytes[4500] ^= 0x10;
	g_assert_true(g_file_set_contents(spoilt, bytes, (gssize)length, NULL));
	assert_refused(spoilt, to, "spoilt", "spoilt.rec");
	assert_refused(session2, to, "no second session", "session 2");
}

/* The draft's stage moves are in the record; a standard scan would want others. It ends with what
 * the record has. */
static void test_other_preset(void)
{
	g_autofree char *folder = simulated_folder(), *a = g_build_filename(folder, "a", NULL),
			*path = record_path(a), *b = g_build_filename(folder, "b", NULL);
	struct scan_options options = { .preset = preset_find("draft") };
	struct scan_result result;
	uint32_t partial;
	g_autoptr(GError) error = NULL;
	g_assert_true(simulated_scan(a, "hall?seed=4&ares=400&camera=none", &options, NULL, NULL,
		&result, &partial, NULL));
	bool good = replay(path, b, "standard", &result, &error);
	g_test_message("%s", error ? error->message : "done");
	g_assert_true(good == !error);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	for (size_t i = 0; i < G_N_ELEMENTS(scenes); i++)
		g_test_add_data_func(scenes[i].path, &scenes[i], test_same);
	g_test_add_func("/replay/one-instant", test_one_instant);
	g_test_add_func("/replay/plugging", test_plugging);
	g_test_add_func("/replay/headers", test_headers);
	g_test_add_func("/replay/files", test_files);
	g_test_add_func("/replay/damaged", test_damaged);
	g_test_add_func("/replay/other-preset", test_other_preset);
	return g_test_run();
}
