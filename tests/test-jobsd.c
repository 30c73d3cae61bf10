/* pleinair-jobsd on a bus of the test's own, with commands that are scripts of the test, and with real ones. */
#include "acquire/site.h"
#include "process/jobs-bus.h"
#include "tests/bus-bench.h"
#include "tests/simulated.h"

#define NAME        "org.pleinair.Jobs1"
#define OBJECT_PATH "/org/pleinair/Jobs1"

struct bench {
	struct bus_bench bus;
	BusJobs1 *service;
	char *folder, *site_path, *state_path, *log_path, *elsewhere;
	bool on_system;
	GPtrArray *ended; /* "KIND STATE" */
};

static void daemon_start(struct bench *b)
{
	char *argv[] = { NULL, (char *)"--sites", b->folder, (char *)"--state", b->state_path,
		b->on_system ? (char *)"--system" : NULL, NULL };
	bus_bench_start(&b->bus, "pleinair-jobsd", argv);
}

static bool is_owned(struct bench *b)
{
	g_autofree char *owner = g_dbus_proxy_get_name_owner(G_DBUS_PROXY(b->service));
	return owner && bus_jobs1_get_sites_folder(b->service);
}

static void job_has_ended(BusJobs1 *service, const char *path, const char *kind,
	const char *site_path, const char *state, gpointer user_data)
{
	struct bench *b = user_data;
	(void)service;
	(void)path;
	(void)site_path;
	g_ptr_array_add(b->ended, g_strdup_printf("%s %s", kind, state));
}

/* A program that says how far it is, for 0.2 s a step; "fail" and "hang" by its options. */
#define SCRIPT                                                                                     \
	"#!/bin/sh\n"                                                                              \
	"echo \"${0##*/pleinair-} $*\" >> '%s'\n"                                                  \
	"case \"$*\" in *--to=fail*) echo 'pleinair process: the disk is full' >&2; exit 1;; "     \
	"esac\n"                                                                                   \
	"case \"$*\" in *--to=hang*) trap '' TERM; sleep 100 & wait; sleep 100;; esac\n"           \
	"for i in 1 2 3 4; do echo \"0.$i step $i\" >&3; sleep 0.2; done\n"                        \
	"echo '{ \"done\": true }'\n"

/* In a folder of its own, with the scripts beside it. */
static void make_programs(struct bench *b)
{
	static const char *const names[] = { "process", "align", "render" };
	g_autofree char *bin = g_build_filename(b->elsewhere, "bin", NULL);
	g_autofree char *script = g_strdup_printf(SCRIPT, b->log_path);
	g_autofree char *daemon_path = commands_program("pleinair-jobsd");
	g_mkdir(bin, 0755);
	commands_shell("cp '%s' '%s/pleinair-jobsd'", daemon_path, bin);
	for (size_t i = 0; i < G_N_ELEMENTS(names); i++) {
		g_autofree char *path = g_strdup_printf("%s/pleinair-%s", bin, names[i]);
		g_assert_true(g_file_set_contents(path, script, -1, NULL));
		g_assert_cmpint(g_chmod(path, 0755), ==, 0);
	}
	g_setenv("PLEINAIR_BIN", bin, TRUE);
}

static void set_up_real(struct bench *b, gconstpointer data)
{
	g_autoptr(GError) error = NULL;
	(void)data;
	b->folder = simulated_folder();
	b->elsewhere = simulated_folder();
	b->site_path = g_build_filename(b->folder, "oak", NULL);
	b->state_path = g_build_filename(b->elsewhere, "jobs", NULL);
	b->log_path = g_build_filename(b->elsewhere, "log", NULL);
	b->ended = g_ptr_array_new_with_free_func(g_free);
	/* Freed before the bus: its watcher is a child, which would hold the site's lock. */
	site_free(site_open_for_writing(b->site_path, &error));
	g_assert_no_error(error);
	bus_bench_begin(&b->bus);
	b->service = bus_jobs1_proxy_new_sync(b->bus.connection,
		G_DBUS_PROXY_FLAGS_DO_NOT_AUTO_START, NAME, OBJECT_PATH, NULL, &error);
	g_assert_no_error(error);
	g_signal_connect(b->service, "ended", G_CALLBACK(job_has_ended), b);
}

static void set_up(struct bench *b, gconstpointer data)
{
	set_up_real(b, data);
	make_programs(b);
	daemon_start(b);
	WAIT_FOR(is_owned(b));
}

static void tear_down(struct bench *b, gconstpointer data)
{
	(void)data;
	g_object_unref(b->service);
	bus_bench_end(&b->bus);
	g_setenv("PLEINAIR_BIN", g_getenv("PLEINAIR_REAL_BIN"), TRUE);
	g_ptr_array_unref(b->ended);
	g_free(b->folder);
	g_free(b->elsewhere);
	g_free(b->site_path);
	g_free(b->state_path);
	g_free(b->log_path);
}

/* ---- calls ---- */

/* options: text of a{sv}. Caller frees. */
static char *start(struct bench *b, const char *kind, const char *options)
{
	char *path = NULL;
	g_autoptr(GError) error = NULL;
	GVariant *o = g_variant_parse(G_VARIANT_TYPE_VARDICT, options, NULL, NULL, &error);
	g_assert_no_error(error);
	bus_jobs1_call_start_sync(b->service, kind, b->site_path, o, &path, NULL, &error);
	g_assert_no_error(error);
	return path;
}

static GError *fails_to_start(
	struct bench *b, const char *kind, const char *site_path, const char *options)
{
	GError *error = NULL;
	g_autofree char *path = NULL;
	GVariant *o = g_variant_parse(G_VARIANT_TYPE_VARDICT, options, NULL, NULL, &error);
	g_assert_no_error(error);
	g_assert_false(
		bus_jobs1_call_start_sync(b->service, kind, site_path, o, &path, NULL, &error));
	return error;
}

/* What the service says now. */
static BusJobs1Job *job_at(struct bench *b, const char *path)
{
	g_autoptr(GError) error = NULL;
	BusJobs1Job *job = bus_jobs1_job_proxy_new_sync(
		b->bus.connection, G_DBUS_PROXY_FLAGS_DO_NOT_AUTO_START, NAME, path, NULL, &error);
	g_assert_no_error(error);
	return job;
}

static void assert_state(struct bench *b, const char *path, const char *state)
{
	g_autoptr(BusJobs1Job) job = job_at(b, path);
	g_assert_cmpstr(bus_jobs1_job_get_state(job), ==, state);
}

static bool has_state(BusJobs1Job *job, const char *state)
{
	return !g_strcmp0(bus_jobs1_job_get_state(job), state);
}

/* ---- the queue ---- */

static void one_after_another(struct bench *b, gconstpointer data)
{
	(void)data;
	g_autofree char *first = start(b, "process", "{'to': <'model'>}");
	g_autofree char *second =
		start(b, "align", "{'accept': <true>, 'arguments': <['1', '2']>}");
	g_autofree char *third = start(b, "render", "{'size': <'640x400'>, 'dpi': <150.5>}");
	g_assert_cmpstr(first, ==, OBJECT_PATH "/job/1");
	g_autoptr(BusJobs1Job) job = job_at(b, first);
	WAIT_FOR(bus_jobs1_job_get_fraction(job) > 0.15);
	g_assert_nonnull(strstr(bus_jobs1_job_get_doing(job), "step"));
	assert_state(b, first, "running");
	assert_state(b, second, "waiting");
	const char *const *list = bus_jobs1_get_jobs(b->service);
	g_assert_cmpuint(g_strv_length((char **)list), ==, 3);
	g_assert_cmpstr(list[0], ==, first);
	WAIT_FOR(b->ended->len == 3);
	g_assert_cmpstr(b->ended->pdata[0], ==, "process done");
	g_assert_cmpstr(b->ended->pdata[1], ==, "align done");
	g_assert_cmpstr(b->ended->pdata[2], ==, "render done");
	WAIT_FOR(has_state(job, "done"));
	g_assert_cmpstr(bus_jobs1_job_get_result(job), ==, "{ \"done\": true }\n");
	g_assert_cmpfloat(bus_jobs1_job_get_fraction(job), ==, 1);
	g_assert_cmpstr(bus_jobs1_job_get_error(job), ==, "");
	/* The last one first. */
	WAIT_FOR(!g_strcmp0(bus_jobs1_get_jobs(b->service)[0], third));
	g_autofree char *log = NULL, *wanted = g_strdup_printf(
					     "process --to=model --json -- %s\n"
					     "align --accept --json -- %s 1 2\n"
					     "render --size=640x400 --dpi=150.5 --json -- %s\n",
					     b->site_path, b->site_path, b->site_path);
	g_assert_true(g_file_get_contents(b->log_path, &log, NULL, NULL));
	g_assert_cmpstr(log, ==, wanted);
}

static void failing_says_why(struct bench *b, gconstpointer data)
{
	(void)data;
	g_autofree char *path = start(b, "process", "{'to': <'fail'>}");
	WAIT_FOR(b->ended->len == 1);
	g_assert_cmpstr(b->ended->pdata[0], ==, "process failed");
	g_autoptr(BusJobs1Job) job = job_at(b, path);
	g_assert_cmpstr(bus_jobs1_job_get_error(job), ==, "the disk is full");
	g_assert_cmpstr(bus_jobs1_job_get_result(job), ==, "");
	/* A program that is not there. */
	g_autofree char *none = start(b, "report", "{}");
	g_autofree char *gone = g_find_program_in_path("pleinair-report");
	WAIT_FOR(b->ended->len == 2);
	if (!gone)
		assert_state(b, none, "failed");
}

static void cancelled_ones_end(struct bench *b, gconstpointer data)
{
	g_autoptr(GError) error = NULL;
	(void)data;
	g_autofree char *first = start(b, "process", "{'to': <'hang'>}");
	g_autofree char *second = start(b, "process", "{}");
	g_autoptr(BusJobs1Job) running_job = job_at(b, first), waiting = job_at(b, second);
	WAIT_FOR(has_state(running_job, "running"));
	bus_jobs1_job_call_cancel_sync(waiting, NULL, &error);
	g_assert_no_error(error);
	assert_state(b, second, "cancelled");
	/* One that does not listen is killed. */
	bus_jobs1_job_call_cancel_sync(running_job, NULL, &error);
	g_assert_no_error(error);
	WAIT_FOR(b->ended->len == 2);
	assert_state(b, first, "cancelled");
	bus_jobs1_job_call_cancel_sync(running_job, NULL, &error);
	bus_bench_assert_refused(g_steal_pointer(&error), "Failed", "ended already");
}

/* ---- what callers may not ---- */

static void refusals(struct bench *b, gconstpointer data)
{
	const char *s = b->site_path;
	(void)data;
	bus_bench_assert_refused(
		fails_to_start(b, "rm", s, "{}"), "Invalid", "no kind of job 'rm'");
	bus_bench_assert_refused(
		fails_to_start(b, "process", "oak", "{}"), "Invalid", "whole path");
	bus_bench_assert_refused(
		fails_to_start(b, "process", s, "{'force': <true>}"), "Invalid", "force");
	bus_bench_assert_refused(
		fails_to_start(b, "process", s, "{'to': <true>}"), "Invalid", "another type");
	bus_bench_assert_refused(
		fails_to_start(b, "process", s, "{'arguments': <['x']>}"), "Invalid", "arguments");
	bus_bench_assert_refused(
		fails_to_start(b, "process", s, "{'to': <'a\\nb'>}"), "Invalid", "cannot be");
	g_assert_cmpuint(b->ended->len, ==, 0);
	g_assert_false(g_file_test(b->log_path, G_FILE_TEST_EXISTS));
}

static void only_its_own_sites(struct bench *b, gconstpointer data)
{
	const char *s = b->site_path;
	(void)data;
	b->on_system = true;
	make_programs(b);
	daemon_start(b);
	WAIT_FOR(is_owned(b));
	g_autofree char *inside = g_build_filename(s, "exports", "a.png", NULL);
	g_autofree char *good = g_strdup_printf("{'output': <'%s'>}", inside);
	g_autofree char *sly = g_strdup_printf("{'output': <'%s/../../a.png'>}", s);
	g_autofree char *link = g_build_filename(s, "link", NULL);
	g_autofree char *through = g_strdup_printf("{'output': <'%s/a.png'>}", link);
	g_assert_cmpint(symlink(b->elsewhere, link), ==, 0);
	bus_bench_assert_refused(
		fails_to_start(b, "process", b->elsewhere, "{}"), "NotAllowed", "does not lie in");
	bus_bench_assert_refused(
		fails_to_start(b, "render", s, "{'output': <'/etc/passwd'>}"), "NotAllowed", "lie");
	bus_bench_assert_refused(fails_to_start(b, "render", s, sly), "NotAllowed", "lie");
	bus_bench_assert_refused(fails_to_start(b, "render", s, through), "NotAllowed", "lie");
	bus_bench_assert_refused(
		fails_to_start(b, "render", s, "{'style': <'/etc/shadow'>}"), "NotAllowed", "lie");
	bus_bench_assert_refused(
		fails_to_start(b, "copy", s, "{'to': <'/etc'>}"), "NotAllowed", "drive");
	bus_bench_assert_refused(fails_to_start(b, "import", s, "{'arguments': <['/etc/passwd']>}"),
		"NotAllowed", "drive");
	g_autofree char *path = start(b, "render", good);
	WAIT_FOR(b->ended->len == 1);
	assert_state(b, path, "done");
}

/* ---- sites ---- */

static GVariant *listed(GVariant *all, const char *name)
{
	for (gsize i = 0; i < g_variant_n_children(all); i++) {
		g_autoptr(GVariant) one = g_variant_get_child_value(all, i);
		const char *this = "";
		g_variant_lookup(one, "name", "&s", &this);
		if (!strcmp(this, name))
			return g_steal_pointer(&one);
	}
	g_assert_not_reached();
}

static void sites_are_listed(struct bench *b, gconstpointer data)
{
	g_autoptr(GVariant) all = NULL;
	g_autoptr(GError) error = NULL;
	guint32 scans = 99;
	guint64 bytes = 0;
	const char *sentence = "";
	(void)data;
	g_autofree char *broken = g_build_filename(b->folder, "broken", NULL);
	g_autofree char *file = g_build_filename(broken, "site.json", NULL);
	g_autofree char *other = g_build_filename(b->folder, "photos", NULL);
	g_mkdir(broken, 0755);
	g_mkdir(other, 0755);
	g_assert_true(g_file_set_contents(file, "{ \"name\": ", -1, NULL));
	simulated_draft(b->site_path, COMMANDS_SCENE);
	daemon_start(b);
	WAIT_FOR(is_owned(b));
	bus_jobs1_call_list_sites_sync(b->service, "", &all, NULL, &error);
	g_assert_no_error(error);
	g_assert_cmpuint(g_variant_n_children(all), ==, 2);
	g_autoptr(GVariant) oak = listed(all, "oak");
	g_autoptr(GVariant) bad = listed(all, "broken");
	g_assert_true(g_variant_lookup(oak, "scans", "u", &scans));
	g_assert_cmpuint(scans, ==, 1);
	g_assert_true(g_variant_lookup(oak, "bytes", "t", &bytes));
	g_assert_cmpuint(bytes, >, 10000);
	g_assert_false(g_variant_lookup(oak, "error", "&s", &sentence));
	g_assert_true(g_variant_lookup(bad, "error", "&s", &sentence));
	g_assert_nonnull(strstr(sentence, "site.json"));
}

/* ---- kills ---- */

static void waiting_jobs_survive(struct bench *b, gconstpointer data)
{
	(void)data;
	g_autofree char *first = start(b, "process", "{}");
	g_autofree char *second = start(b, "align", "{'undo': <true>}");
	g_autofree char *third = start(b, "render", "{}");
	g_autoptr(BusJobs1Job) job = job_at(b, first);
	WAIT_FOR(bus_jobs1_job_get_fraction(job) > 0);
	bus_bench_kill(&b->bus, SIGKILL);
	WAIT_FOR(!is_owned(b));
	daemon_start(b);
	WAIT_FOR(is_owned(b));
	WAIT_FOR(b->ended->len == 3);
	assert_state(b, first, "done");
	assert_state(b, second, "done");
	assert_state(b, third, "done");
	/* What cannot be done twice is not: it may have been done. */
	g_autofree char *edit = start(b, "align", "{}");
	g_autoptr(BusJobs1Job) running_job = job_at(b, edit);
	/* Not "running", which it is before its first word is in the log. */
	WAIT_FOR(bus_jobs1_job_get_fraction(running_job) > 0);
	bus_bench_kill(&b->bus, SIGKILL);
	WAIT_FOR(!is_owned(b));
	daemon_start(b);
	WAIT_FOR(is_owned(b));
	assert_state(b, edit, "failed");
	g_autofree char *log = NULL;
	g_assert_true(g_file_get_contents(b->log_path, &log, NULL, NULL));
	g_auto(GStrv) lines = g_strsplit(g_strchomp(log), "\n", -1);
	g_assert_cmpuint(g_strv_length(lines), ==, 5);
}

static void broken_state_is_put_aside(struct bench *b, gconstpointer data)
{
	(void)data;
	make_programs(b);
	g_autofree char *aside = g_strconcat(b->state_path, ".broken", NULL);
	g_assert_true(g_file_set_contents(b->state_path, "[7]\nkind=dance\n", -1, NULL));
	daemon_start(b);
	WAIT_FOR(is_owned(b));
	g_assert_true(g_file_test(aside, G_FILE_TEST_EXISTS));
	g_autofree char *path = start(b, "process", "{}");
	WAIT_FOR(b->ended->len == 1);
	assert_state(b, path, "done");
}

static bool is_at_work(BusJobs1Job *job)
{
	return has_state(job, "waiting") || has_state(job, "running");
}

/* What processing made of the scans is gone: the next job has everything to do. */
static char *start_from_nothing(struct bench *b)
{
	commands_shell("cd '%s' && rm -rf poses geometry segments features model", b->site_path);
	return start(b, "process", "{}");
}

/* Real work on a real site; at last it is done, and the site is as if nothing had happened. */
static void kills_cost_no_site(struct bench *b, gconstpointer data)
{
	guint met = 0, gone_on = 0;
	(void)data;
	simulated_draft(b->site_path, COMMANDS_SCENE);
	simulated_draft(b->site_path, COMMANDS_SCENE "&station=2");
	daemon_start(b);
	WAIT_FOR(is_owned(b));
	int64_t since_us = g_get_monotonic_time();
	g_autofree char *path = start_from_nothing(b);
	WAIT_FOR(b->ended->len == 1);
	assert_state(b, path, "done");
	gint32 job_ms = (gint32)((g_get_monotonic_time() - since_us) / 1000);
	for (guint i = 0; i < bus_bench_kills(); i++) {
		g_autoptr(BusJobs1Job) left = job_at(b, path);
		if (is_at_work(left))
			gone_on++;
		else {
			g_free(path);
			path = start_from_nothing(b);
		}
		g_autoptr(BusJobs1Job) job = job_at(b, path);
		bus_bench_live_for((guint)g_test_rand_int_range(0, job_ms * 3 / 4));
		met += is_at_work(job);
		bus_bench_kill(&b->bus, SIGKILL);
		WAIT_FOR(!is_owned(b));
		since_us = g_get_monotonic_time();
		daemon_start(b);
		WAIT_FOR(is_owned(b));
		g_test_message(
			"back after %.2f s", (double)(g_get_monotonic_time() - since_us) * 1e-6);
	}
	g_autofree char *last = start(b, "process", "{}");
	g_autoptr(BusJobs1Job) job = job_at(b, last);
	WAIT_FOR(has_state(job, "done") || has_state(job, "failed"));
	g_assert_cmpstr(bus_jobs1_job_get_error(job), ==, "");
	g_auto(answer) dry = commands_run("process", b->site_path, "--dry-run", "--json");
	commands_assert_done(&dry);
	g_test_message(
		"%u kills, %u of them with a job of %.1f s at work, %u of what went on; left: %s",
		bus_bench_kills(), met, job_ms * 1e-3, gone_on, dry.out);
	g_assert_cmpuint(met, >, 0);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	commands_find_programs();
	g_setenv("PLEINAIR_REAL_BIN", g_getenv("PLEINAIR_BIN"), TRUE);
#define ADD(path, set_up_it, test)                                                                 \
	g_test_add("/jobsd/" path, struct bench, NULL, set_up_it, test, tear_down)
	ADD("one-after-another", set_up, one_after_another);
	ADD("failing-says-why", set_up, failing_says_why);
	ADD("cancelled-ones-end", set_up, cancelled_ones_end);
	ADD("refusals", set_up, refusals);
	ADD("only-its-own-sites", set_up_real, only_its_own_sites);
	ADD("sites-are-listed", set_up_real, sites_are_listed);
	ADD("waiting-jobs-survive", set_up, waiting_jobs_survive);
	ADD("broken-state-is-put-aside", set_up_real, broken_state_is_put_aside);
	ADD("kills-cost-no-site", set_up_real, kills_cost_no_site);
	return g_test_run();
}
