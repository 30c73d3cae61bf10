/* pleinair-acquired on a bus of the test's own: what callers get, what they may not, and that a kill costs no scan. */
#include "acquire/scan.h"
#include "tests/acquisition-bench.h"
#include "tests/simulated.h"
#include <fcntl.h>
#include <gio/gunixfdlist.h>
#include <sys/mman.h>

/* A draft of it takes some seconds, so that it can be met amid its work. */
#define SLOW_SCENE "hall?seed=3&ares=1584&camera=180x320&divergence_mrad=0"

struct bench {
	struct bus_bench bus;
	BusAcquisition1 *service;
	char *folder, *site_path, *elsewhere;
	const char *device;
	bool on_system;
	/* Of signals. */
	guint finished, stopped;
	bool partial;
	char *sentence, *advice;
};

/* ---- the daemon ---- */

static void daemon_start(struct bench *b)
{
	char *argv[] = { NULL, (char *)"--sites", b->folder, (char *)"--device", (char *)b->device,
		b->on_system ? (char *)"--system" : NULL, NULL };
	bus_bench_start(&b->bus, "pleinair-acquired", argv);
}

static const char *state_of(struct bench *b)
{
	const char *state = bus_acquisition1_get_state(b->service);
	return state ? state : "";
}

static bool is_in(struct bench *b, const char *state)
{
	return !strcmp(state_of(b), state);
}

static void has_finished(BusAcquisition1 *a, const char *path, guint scan, gpointer user_data)
{
	struct bench *b = user_data;
	(void)a;
	(void)path;
	(void)scan;
	b->finished++;
}

static void has_stopped(BusAcquisition1 *a, const char *path, guint scan, gboolean partial,
	const char *sentence, const char *advice, gpointer user_data)
{
	struct bench *b = user_data;
	(void)a;
	(void)path;
	(void)scan;
	b->stopped++;
	b->partial = partial;
	g_free(b->sentence);
	g_free(b->advice);
	b->sentence = g_strdup(sentence);
	b->advice = g_strdup(advice);
}

static void set_up(struct bench *b, gconstpointer data)
{
	const char *device = data;
	b->folder = simulated_folder();
	b->elsewhere = simulated_folder();
	b->site_path = g_build_filename(b->folder, "oak", NULL);
	b->device = device ? device : "sim:" SLOW_SCENE "&station=%n";
	bus_bench_begin(&b->bus);
	b->service = acquisition_reach(&b->bus);
	g_signal_connect(b->service, "finished", G_CALLBACK(has_finished), b);
	g_signal_connect(b->service, "stopped", G_CALLBACK(has_stopped), b);
}

static void set_up_running(struct bench *b, gconstpointer data)
{
	set_up(b, data);
	daemon_start(b);
	WAIT_FOR(acquisition_is_there(b->service));
}

static void tear_down(struct bench *b, gconstpointer data)
{
	(void)data;
	g_object_unref(b->service);
	bus_bench_end(&b->bus);
	g_free(b->folder);
	g_free(b->elsewhere);
	g_free(b->site_path);
	g_free(b->sentence);
	g_free(b->advice);
}

/* ---- calls ---- */

static guint start_scan(struct bench *b)
{
	guint number = 0;
	g_autoptr(GError) error = NULL;
	bus_acquisition1_call_start_sync(b->service, b->site_path, "draft",
		g_variant_new("a{sv}", NULL), &number, NULL, &error);
	g_assert_no_error(error);
	return number;
}

static GError *fails_to_start(struct bench *b, const char *path, const char *preset)
{
	guint number;
	GError *error = NULL;
	g_assert_false(bus_acquisition1_call_start_sync(
		b->service, path, preset, g_variant_new("a{sv}", NULL), &number, NULL, &error));
	return error;
}

/* All scans of the site, with all their files as they were written. */
static guint whole_scans(struct bench *b)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(site) s = site_open(b->site_path, &error);
	g_assert_no_error(error);
	g_autoptr(GArray) scans = site_scans(s, &error);
	g_assert_no_error(error);
	for (guint i = 0; i < scans->len; i++) {
		g_autoptr(panorama) p =
			scan_load(s, g_array_index(scans, uint32_t, i), true, &error);
		g_assert_no_error(error);
	}
	return scans->len;
}

static uint32_t partial_scan(struct bench *b)
{
	uint32_t number = 0;
	if (!g_file_test(b->site_path, G_FILE_TEST_IS_DIR))
		return 0;
	g_autoptr(site) s = site_open(b->site_path, NULL);
	g_assert_true(!s || site_find_partial(s, &number, NULL));
	return number;
}

/* ---- what it tells ---- */

static double predicted(struct bench *b, guint n, const char *key)
{
	g_autoptr(GVariant) all = NULL;
	double value = -1;
	g_assert_true(bus_acquisition1_call_list_presets_sync(b->service, &all, NULL, NULL));
	g_assert_cmpuint(g_variant_n_children(all), ==, 3);
	g_autoptr(GVariant) one = g_variant_get_child_value(all, n);
	g_autoptr(GVariant) found = g_variant_lookup_value(one, key, NULL);
	if (found && g_variant_is_of_type(found, G_VARIANT_TYPE_UINT64))
		value = (double)g_variant_get_uint64(found);
	else if (found && g_variant_is_of_type(found, G_VARIANT_TYPE_DOUBLE))
		value = g_variant_get_double(found);
	return value;
}

static void presets_are_predicted(struct bench *b, gconstpointer data)
{
	g_autoptr(GVariant) devices = NULL;
	g_autoptr(GError) error = NULL;
	(void)data;
	g_assert_true(bus_acquisition1_call_check_sync(b->service, &devices, NULL, &error));
	g_assert_cmpuint(g_variant_n_children(devices), ==, 3);
	for (gsize i = 0; i < 3; i++) {
		g_autoptr(GVariant) d = g_variant_get_child_value(devices, i);
		const char *state = "", *sentence = "";
		g_variant_lookup(d, "state", "&s", &state);
		g_variant_lookup(d, "sentence", "&s", &sentence);
		g_assert_cmpstr(state, ==, "good");
		g_assert_cmpstr(sentence, !=, "");
	}
	g_assert_cmpfloat(predicted(b, 0, "seconds"), >, 20);
	g_assert_cmpfloat(predicted(b, 2, "seconds"), >, predicted(b, 0, "seconds"));
	g_assert_cmpfloat(predicted(b, 0, "points"), >, 10000);
	g_assert_cmpfloat(predicted(b, 2, "points"), >, predicted(b, 0, "points"));
	g_assert_cmpfloat(predicted(b, 0, "bytes"), >, 1e6);
}

/* Sealed: nobody can change it, or make it shorter under who reads it. */
static void assert_preview(struct bench *b, const char *plane)
{
	g_autoptr(GUnixFDList) fds = NULL;
	g_autoptr(GVariant) handle = NULL;
	g_autoptr(GError) error = NULL;
	guint columns, rows;
	guint64 serial;
	bus_acquisition1_call_preview_sync(
		b->service, plane, NULL, &handle, &columns, &rows, &serial, &fds, NULL, &error);
	g_assert_no_error(error);
	g_assert_cmpuint(columns, ==, 750);
	g_assert_cmpuint(rows, ==, 198);
	int fd = g_unix_fd_list_get(fds, g_variant_get_handle(handle), &error);
	g_assert_no_error(error);
	size_t bytes = (size_t)4 * columns * rows;
	g_assert_cmpint(lseek(fd, 0, SEEK_END), ==, bytes);
	g_assert_cmpint(fcntl(fd, F_GET_SEALS), ==,
		F_SEAL_SEAL | F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_WRITE);
	const uint8_t(*rgba)[4] = mmap(NULL, bytes, PROT_READ, MAP_SHARED, fd, 0);
	g_assert_true(rgba != MAP_FAILED);
	guint seen = 0;
	for (size_t i = 0; i < bytes / 4; i++)
		seen += rgba[i][3] == 255;
	munmap((void *)rgba, bytes);
	close(fd);
	g_assert_cmpuint(seen, >, columns * rows / 4);
}

static void scan_is_followed(struct bench *b, gconstpointer data)
{
	double last = 0;
	(void)data;
	g_assert_cmpuint(start_scan(b), ==, 1);
	while (!b->finished) {
		g_main_context_iteration(NULL, TRUE);
		double now = bus_acquisition1_get_fraction(b->service);
		g_assert_cmpfloat(now, >=, last);
		g_assert_cmpfloat(now, <=, 1);
		g_assert_cmpuint(b->stopped, ==, 0);
		last = now;
	}
	g_assert_cmpstr(state_of(b), ==, "idle");
	g_assert_cmpstr(bus_acquisition1_get_site(b->service), ==, b->site_path);
	g_assert_cmpuint(bus_acquisition1_get_scan(b->service), ==, 1);
	g_assert_cmpfloat(bus_acquisition1_get_column_fraction(b->service), >, 0.99);
	assert_preview(b, "range");
	assert_preview(b, "intensity");
	assert_preview(b, "colour");
	g_assert_cmpuint(whole_scans(b), ==, 1);
	/* And the next one. */
	g_assert_cmpuint(start_scan(b), ==, 2);
	WAIT_FOR(b->finished == 2);
	g_assert_cmpuint(whole_scans(b), ==, 2);
}

/* ---- pausing ---- */

/* Answers overtake properties: those of the scan before may still stand. */
static void wait_for_columns(struct bench *b)
{
	WAIT_FOR(is_in(b, "scanning"));
	WAIT_FOR(bus_acquisition1_get_column_fraction(b->service) > 0.2 || b->finished);
	g_assert_cmpuint(b->finished, ==, 0);
}

/* The site's only scan. */
static void go_on_to_the_end(struct bench *b, bool without_damaged)
{
	g_autoptr(GError) error = NULL;
	guint number = 0;
	bus_acquisition1_call_resume_sync(
		b->service, b->site_path, without_damaged, &number, NULL, &error);
	g_assert_no_error(error);
	g_assert_cmpuint(number, ==, 1);
	WAIT_FOR(b->finished);
	g_assert_cmpuint(whole_scans(b), ==, 1);
}

static void paused_scan_goes_on(struct bench *b, gconstpointer data)
{
	g_autoptr(GError) error = NULL;
	guint number = 0;
	(void)data;
	start_scan(b);
	wait_for_columns(b);
	bus_acquisition1_call_pause_sync(b->service, NULL, &error);
	g_assert_no_error(error);
	/* At once: while it still stops. */
	bus_acquisition1_call_resume_sync(b->service, b->site_path, FALSE, &number, NULL, &error);
	g_assert_no_error(error);
	g_assert_cmpuint(number, ==, 1);
	WAIT_FOR(b->finished);
	g_assert_cmpuint(b->stopped, ==, 1);
	g_assert_true(b->partial);
	g_assert_cmpstr(b->sentence, ==, "");
	g_assert_cmpuint(whole_scans(b), ==, 1);
	g_assert_cmpuint(partial_scan(b), ==, 0);
}

static void aborted_scan_leaves_nothing(struct bench *b, gconstpointer data)
{
	g_autoptr(GError) error = NULL;
	(void)data;
	start_scan(b);
	wait_for_columns(b);
	bus_acquisition1_call_abort_sync(b->service, FALSE, NULL, &error);
	g_assert_no_error(error);
	WAIT_FOR(b->stopped);
	g_assert_false(b->partial);
	WAIT_FOR(is_in(b, "idle"));
	g_assert_cmpuint(partial_scan(b), ==, 0);
	/* One that was kept can be thrown away later. */
	start_scan(b);
	wait_for_columns(b);
	bus_acquisition1_call_abort_sync(b->service, TRUE, NULL, &error);
	g_assert_no_error(error);
	WAIT_FOR(is_in(b, "paused"));
	g_assert_cmpuint(partial_scan(b), ==, 1);
	bus_acquisition1_call_discard_sync(b->service, b->site_path, NULL, &error);
	g_assert_no_error(error);
	g_assert_cmpuint(partial_scan(b), ==, 0);
}

/* SIGTERM again and again, as from someone in a hurry; its status. */
static int end_impatiently(struct bench *b)
{
	int status = 0;
	do {
		kill(b->bus.pid, SIGTERM);
		g_usleep(500);
	} while (!waitpid(b->bus.pid, &status, WNOHANG));
	b->bus.pid = 0;
	return status;
}

/* As when the machine is switched off. */
static void scan_outlives_the_daemon(struct bench *b, gconstpointer data)
{
	(void)data;
	start_scan(b);
	wait_for_columns(b);
	g_assert_cmpint(end_impatiently(b), ==, 0);
	WAIT_FOR(!acquisition_is_there(b->service));
	g_assert_cmpuint(partial_scan(b), ==, 1);
	daemon_start(b);
	WAIT_FOR(acquisition_is_there(b->service));
	go_on_to_the_end(b, FALSE);
}

/* A bit of the record has flipped: it says so by a name of its own, and goes on without what is damaged when it is told to. */
static void damaged_record_is_gone_on_with(struct bench *b, gconstpointer data)
{
	g_autoptr(GError) error = NULL;
	guint number = 0;
	(void)data;
	start_scan(b);
	wait_for_columns(b);
	bus_acquisition1_call_abort_sync(b->service, TRUE, NULL, &error);
	g_assert_no_error(error);
	WAIT_FOR(is_in(b, "paused"));
	commands_shell("raw=$(ls '%s'/scans/.0001.partial/raw.rec) && "
		       "printf 'damaged!' | dd of=\"$raw\" bs=1 conv=notrunc status=none "
		       "seek=$(($(stat -c %%s \"$raw\") / 2))",
		b->site_path);
	bus_acquisition1_call_resume_sync(b->service, b->site_path, FALSE, &number, NULL, &error);
	bus_bench_assert_refused(g_steal_pointer(&error), "Damaged", "raw.rec");
	g_assert_cmpuint(partial_scan(b), ==, 1);
	go_on_to_the_end(b, TRUE);
}

/* ---- faults ---- */

static void fault_says_what_to_do(struct bench *b, gconstpointer data)
{
	const char *sentence, *advice;
	(void)data;
	start_scan(b);
	WAIT_FOR(b->stopped);
	g_assert_cmpstr(b->sentence, !=, "");
	g_assert_cmpstr(b->advice, !=, "");
	g_assert_true(b->partial);
	WAIT_FOR(is_in(b, "paused"));
	g_variant_get(bus_acquisition1_get_fault(b->service), "(&s&s)", &sentence, &advice);
	g_assert_cmpstr(sentence, ==, b->sentence);
	g_assert_cmpstr(advice, ==, b->advice);
	g_assert_cmpuint(partial_scan(b), ==, 1);
}

static GError *fails_to_go_on(struct bench *b)
{
	guint number;
	GError *error = NULL;
	g_assert_false(bus_acquisition1_call_resume_sync(
		b->service, b->site_path, FALSE, &number, NULL, &error));
	return error;
}

static const char *state_of_stage(struct bench *b)
{
	const char *state = "";
	g_autoptr(GVariant) device =
		g_variant_get_child_value(bus_acquisition1_get_devices(b->service), 1);
	g_variant_lookup(device, "state", "&s", &state);
	return g_intern_string(state);
}

/* What was stopped for safety goes on only after somebody has said that it is safe; looking at the head says nothing of it. */
static void estop_wants_a_reset(struct bench *b, gconstpointer data)
{
	guint number = 0;
	g_autoptr(GError) error = NULL;
	g_autoptr(GVariant) devices = NULL;
	(void)data;
	g_assert_false(bus_acquisition1_get_needs_reset(b->service));
	start_scan(b);
	WAIT_FOR(b->stopped);
	g_assert_true(b->partial);
	g_assert_nonnull(strstr(b->sentence, "emergency stop"));
	g_assert_nonnull(strstr(b->advice, "Reset"));
	WAIT_FOR(bus_acquisition1_get_needs_reset(b->service));
	g_assert_cmpstr(state_of_stage(b), ==, "fault");
	g_assert_true(bus_acquisition1_call_check_sync(b->service, &devices, NULL, &error));
	g_assert_cmpstr(state_of_stage(b), ==, "fault");
	g_autoptr(GError) first = fails_to_go_on(b),
			  other = fails_to_start(b, b->elsewhere, "draft");
	g_assert_nonnull(strstr(first->message, "reset it"));
	g_assert_nonnull(strstr(other->message, "reset it"));
	g_assert_true(bus_acquisition1_call_reset_sync(b->service, NULL, &error));
	g_assert_no_error(error);
	WAIT_FOR(!bus_acquisition1_get_needs_reset(b->service));
	g_assert_cmpstr(state_of_stage(b), ==, "good");
	g_assert_cmpuint(partial_scan(b), ==, 1);
	/* It begins; this head's emergency stop is pressed at the same place once more. */
	g_assert_true(bus_acquisition1_call_resume_sync(
		b->service, b->site_path, FALSE, &number, NULL, &error));
	g_assert_no_error(error);
	WAIT_FOR(b->stopped == 2);
	g_assert_true(b->partial);
	WAIT_FOR(bus_acquisition1_get_needs_reset(b->service));
}

static void head_that_is_not_there(struct bench *b, gconstpointer data)
{
	(void)data;
	GError *error = fails_to_start(b, b->site_path, "draft");
	g_assert_nonnull(error);
	g_error_free(error);
	g_assert_false(g_file_test(b->site_path, G_FILE_TEST_EXISTS));
	g_assert_cmpuint(b->stopped, ==, 0);
}

/* ---- what callers may not ---- */

static void refusals(struct bench *b, gconstpointer data)
{
	GError *error = NULL;
	g_autoptr(GVariant) devices = NULL;
	(void)data;
	bus_bench_assert_refused(
		fails_to_start(b, b->site_path, "best"), "Invalid", "no preset 'best'");
	bus_bench_assert_refused(fails_to_start(b, "oak", "draft"), "Invalid", "whole path");
	bus_acquisition1_call_pause_sync(b->service, NULL, &error);
	bus_bench_assert_refused(g_steal_pointer(&error), "Busy", "no scan is under way");
	bus_acquisition1_call_preview_sync(
		b->service, "range", NULL, NULL, NULL, NULL, NULL, NULL, NULL, &error);
	bus_bench_assert_refused(g_steal_pointer(&error), "Failed", "nothing has been scanned");
	bus_acquisition1_call_preview_sync(
		b->service, "smell", NULL, NULL, NULL, NULL, NULL, NULL, NULL, &error);
	bus_bench_assert_refused(g_steal_pointer(&error), "Invalid", "no plane 'smell'");
	bus_acquisition1_call_resume_sync(b->service, b->site_path, FALSE, NULL, NULL, &error);
	bus_bench_assert_refused(g_steal_pointer(&error), "Failed", b->site_path);
	start_scan(b);
	bus_bench_assert_refused(
		fails_to_start(b, b->site_path, "draft"), "Busy", "a scan is under way");
	bus_acquisition1_call_check_sync(b->service, &devices, NULL, &error);
	bus_bench_assert_refused(g_steal_pointer(&error), "Busy", "a scan is under way");
	bus_acquisition1_call_set_device_sync(b->service, "sim:court", NULL, &error);
	bus_bench_assert_refused(g_steal_pointer(&error), "Busy", "at work");
	WAIT_FOR(b->finished);
}

static GError *fails_to_take(struct bench *b, const char *device)
{
	GError *error = NULL;
	g_assert_false(bus_acquisition1_call_set_device_sync(b->service, device, NULL, &error));
	return error;
}

static void only_its_own_sites(struct bench *b, gconstpointer data)
{
	(void)data;
	b->on_system = true;
	daemon_start(b);
	WAIT_FOR(acquisition_is_there(b->service));
	g_autofree char *other = g_build_filename(b->elsewhere, "elm", NULL);
	g_autofree char *through = g_build_filename(b->folder, "..", "elm", NULL);
	g_autofree char *link = g_build_filename(b->folder, "link", NULL);
	g_autofree char *linked = g_build_filename(link, "elm", NULL);
	g_assert_cmpint(symlink(b->elsewhere, link), ==, 0);
	bus_bench_assert_refused(
		fails_to_start(b, other, "draft"), "NotAllowed", "does not lie in");
	bus_bench_assert_refused(
		fails_to_start(b, through, "draft"), "NotAllowed", "does not lie in");
	bus_bench_assert_refused(fails_to_start(b, link, "draft"), "NotAllowed", "does not lie in");
	bus_bench_assert_refused(
		fails_to_start(b, linked, "draft"), "NotAllowed", "does not lie in");
	bus_bench_assert_refused(
		fails_to_start(b, b->folder, "draft"), "NotAllowed", "does not lie in");
	bus_bench_assert_refused(fails_to_take(b, "replay:/etc/passwd"), "NotAllowed", "no file");
	bus_bench_assert_refused(fails_to_take(b, "sim:/run/socket"), "NotAllowed", "no file");
	g_autofree char *names = commands_names(b->elsewhere);
	g_assert_cmpstr(names, ==, "");
	start_scan(b);
	WAIT_FOR(b->finished);
}

static void second_one_is_refused(struct bench *b, gconstpointer data)
{
	g_autofree char *program = commands_program("pleinair-acquired"), *err = NULL;
	char *argv[] = { program, NULL };
	int status;
	(void)data;
	g_assert_true(g_spawn_sync(
		NULL, argv, NULL, G_SPAWN_DEFAULT, NULL, NULL, NULL, &err, &status, NULL));
	g_assert_cmpint(WEXITSTATUS(status), ==, 1);
	g_assert_nonnull(strstr(err, "another program has this name"));
	g_assert_true(acquisition_is_there(b->service));
}

/* ---- kills ---- */

/* Begins or goes on, whatever the last kill left. A kill while a folder is being made leaves nothing to go on with. */
static void go_on(struct bench *b)
{
	g_autoptr(GError) error = NULL;
	guint number;
	if (!partial_scan(b)) {
		start_scan(b);
		return;
	}
	bus_acquisition1_call_resume_sync(b->service, b->site_path, FALSE, &number, NULL, &error);
	g_assert_no_error(error);
}

static void kills_cost_no_scan(struct bench *b, gconstpointer data)
{
	guint before = 0, killed_while_scanning = 0;
	(void)data;
	daemon_start(b);
	for (guint i = 0; i < bus_bench_kills(); i++) {
		WAIT_FOR(acquisition_is_there(b->service));
		go_on(b);
		bus_bench_live_for((guint)g_test_rand_int_range(0, 3000));
		killed_while_scanning += !is_in(b, "idle");
		bus_bench_kill(&b->bus, SIGKILL);
		WAIT_FOR(!acquisition_is_there(b->service));
		guint now = whole_scans(b);
		g_assert_cmpuint(now, >=, before);
		before = now;
		int64_t since_us = g_get_monotonic_time();
		daemon_start(b);
		WAIT_FOR(acquisition_is_there(b->service));
		double back_s = (double)(g_get_monotonic_time() - since_us) * 1e-6;
		g_test_message("back after %.2f s, %u scans whole", back_s, now);
	}
	b->finished = 0;
	go_on(b);
	WAIT_FOR(b->finished);
	g_assert_cmpuint(whole_scans(b), ==, before + 1);
	g_assert_cmpuint(partial_scan(b), ==, 0);
	g_test_message("%u kills, %u of them during a scan; %u scans whole", bus_bench_kills(),
		killed_while_scanning, before + 1);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	commands_find_programs();
#define ADD(path, set_up_it, device, test)                                                         \
	g_test_add("/acquired/" path, struct bench, device, set_up_it, test, tear_down)
	ADD("presets-are-predicted", set_up_running, NULL, presets_are_predicted);
	ADD("scan-is-followed", set_up_running, NULL, scan_is_followed);
	ADD("paused-scan-goes-on", set_up_running, NULL, paused_scan_goes_on);
	ADD("aborted-scan-leaves-nothing", set_up_running, NULL, aborted_scan_leaves_nothing);
	ADD("scan-outlives-the-daemon", set_up_running, NULL, scan_outlives_the_daemon);
	ADD("damaged-record-is-gone-on-with", set_up_running, NULL, damaged_record_is_gone_on_with);
	ADD("fault-says-what-to-do", set_up_running, "sim:" COMMANDS_SCENE "&fault=stagefault@900",
		fault_says_what_to_do);
	ADD("estop-wants-a-reset", set_up_running, "sim:" COMMANDS_SCENE "&fault=estop@900",
		estop_wants_a_reset);
	ADD("head-that-is-not-there", set_up_running, "sim:/nowhere/at/all",
		head_that_is_not_there);
	ADD("refusals", set_up_running, NULL, refusals);
	ADD("only-its-own-sites", set_up, NULL, only_its_own_sites);
	ADD("second-one-is-refused", set_up_running, NULL, second_one_is_refused);
	/* As many scans as it takes: without stations, of which there are few. */
	ADD("kills-cost-no-scan", set_up, "sim:" SLOW_SCENE, kills_cost_no_scan);
	return g_test_run();
}
