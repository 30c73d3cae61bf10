/* The commands as people type them: usage, results, and what they say when they are refused. */
#include "tests/commands.h"
#include "tests/simulated.h"
#include <stdio.h>

#define DEVICE "sim:" COMMANDS_SCENE

/* ---- usage ---- */

static const struct usage {
	const char *path;
	const char *arguments[8];
	int status;
	const char *names; /* on stderr */
} usages[] = {
	{ "command-unknown", { "nope" }, 2, "'nope'" },
	{ "command-empty", { "" }, 2, "''" },
	{ "command-path", { "../bin/scan" }, 2, "'../bin/scan'" },
	{ "scan-option-unknown", { "scan", "x", "--frob" }, 2, "--frob" },
	{ "panoramas-option-unknown", { "panoramas", "x", "--frob" }, 2, "--frob" },
	{ "bench-option-unknown", { "bench", "--frob" }, 2, "--frob" },
	{ "scan-option-without-value", { "scan", "x", "--device" }, 2, "--device" },
	{ "scan-no-site", { "scan" }, 2, "which site" },
	{ "scan-empty-site", { "scan", "" }, 2, "which site" },
	{ "scan-two-sites", { "scan", "x", "y", "--device", DEVICE }, 2, "one site" },
	{ "scan-no-device", { "scan", "x" }, 1, "no lidar was found" },
	{ "scan-preset", { "scan", "x", "--device", DEVICE, "--preset", "rough" }, 2, "'rough'" },
	{ "scan-salvage-alone", { "scan", "x", "--salvage" }, 2, "--salvage" },
	{ "scan-discard-resume", { "scan", "x", "--discard", "--resume" }, 2, "--discard" },
	{ "panoramas-no-site", { "panoramas" }, 2, "which site" },
	{ "panoramas-two-sites", { "panoramas", "x", "y" }, 2, "one site" },
	{ "panoramas-scan-text", { "panoramas", "x", "--scan", "one" }, 2, "one" },
	{ "panoramas-scan-0", { "panoramas", "x", "--scan", "0" }, 2, "--scan=0" },
	{ "panoramas-scan-negative", { "panoramas", "x", "--scan=-1" }, 2, "--scan=-1" },
	{ "panoramas-scan-huge", { "panoramas", "x", "--scan", "70000" }, 2, "70000" },
	{ "bench-unknown", { "bench", "everything" }, 2, "'everything'" },
	{ "bench-seconds", { "bench", "acquire", "--seconds=-3" }, 2, "seconds" },
	{ "bench-size", { "bench", "render", "--size=1600" }, 2, "sizes" },
	{ "bench-frames", { "bench", "coherence", "--frames=40" }, 2, "frames" },
	{ "scan-scheme", { "scan", "x", "--device", "warp:9" }, 1, "'warp:9'" },
	{ "scan-no-scheme", { "scan", "x", "--device", "court" }, 1, "'court'" },
	{ "scan-no-lidar", { "scan", "x", "--device", "scip:/dev/no-port" }, 1, "/dev/no-port" },
	{ "scan-scene", { "scan", "x", "--device", "sim:moon" }, 1, "sim:moon" },
	{ "scan-sim-option", { "scan", "x", "--device", "sim:hall?sed=3" }, 1, "sed" },
	{ "scan-sim-value", { "scan", "x", "--device", "sim:hall?ares=-7" }, 1, "ares=-7" },
	{ "scan-sim-number", { "scan", "x", "--device", "sim:hall?noise_mm=nan" }, 1, "noise_mm" },
	{ "scan-sim-fault", { "scan", "x", "--device", "sim:hall?fault=boo@3" }, 1, "boo@3" },
	{ "scan-sim-socket", { "scan", "x", "--device", "sim:/no/socket" }, 1, "/no/socket" },
	{ "scan-replay-missing", { "scan", "x", "--device", "replay:no.rec" }, 1, "no.rec" },
	{ "scan-replay-folder", { "scan", "x", "--device", "replay:/" }, 1, "/: is a folder" },
	{ "scan-replay-other", { "scan", "x", "--device", "replay:/bin/sh" }, 1, "/bin/sh" },
	{ "scan-parent-missing", { "scan", "no/x", "--device", DEVICE }, 1, "no/x" },
	{ "resume-no-site", { "scan", "x", "--resume" }, 1, "x: " },
	{ "discard-no-site", { "scan", "x", "--discard" }, 1, "x: " },
	{ "panoramas-no-such-site", { "panoramas", "x" }, 1, "x: " },
	{ "develop-no-such-site", { "panoramas", "x", "--develop" }, 1, "x: " },
};

/* No folder is made, whatever is wrong. */
static void test_usage(gconstpointer data)
{
	const struct usage *u = data;
	g_autofree char *folder = simulated_folder(), *here = g_get_current_dir();
	g_assert_cmpint(g_chdir(folder), ==, 0);
	g_auto(answer) a = commands_run_in(NULL, u->arguments);
	g_assert_cmpint(g_chdir(here), ==, 0);
	commands_assert_refused(&a, u->status, u->names);
	g_autofree char *names = commands_names(folder);
	g_assert_cmpstr(names, ==, "");
}

static void test_help(gconstpointer data)
{
	g_auto(GStrv) words = g_strsplit(data, " ", -1);
	g_auto(answer) a = commands_run_in(NULL, (const char *const *)words);
	commands_assert_done(&a);
	g_assert_cmpstr(a.err, ==, "");
	g_assert_nonnull(strstr(a.out, "pleinair"));
	if (!strstr(data, "version"))
		g_assert_nonnull(strstr(a.out, "Usage:"));
}

/* Without a command: the help, but on stderr. */
static void test_nothing(void)
{
	const char *nothing[] = { NULL };
	g_auto(answer) a = commands_run_in(NULL, nothing);
	g_assert_cmpint(a.status, ==, 2);
	g_assert_cmpstr(a.out, ==, "");
	g_assert_nonnull(strstr(a.err, "Usage:"));
}

/* What a command gets as this variable of the environment; it is a script beside a copy of pleinair. Caller frees. */
static char *variable_of(const char *name, const char *variable, const char *set)
{
	g_autofree char *folder = simulated_folder(), *whole = commands_program("pleinair"),
			*copy = g_build_filename(folder, "pleinair", NULL),
			*file = g_strconcat("pleinair-", name, NULL),
			*script = g_build_filename(folder, file, NULL),
			*text = g_strdup_printf("#!/bin/sh\necho \"${%s-nothing}\"\n", variable);
	const char *copies[] = { "cp", whole, copy, NULL }, *argv[] = { copy, name, NULL };
	g_auto(GStrv) environment = g_environ_unsetenv(g_get_environ(), variable);
	g_autoptr(GError) error = NULL;
	char *said = NULL;
	if (set)
		environment = g_environ_setenv(environment, variable, set, TRUE);
	g_file_set_contents_full(script, text, -1, G_FILE_SET_CONTENTS_NONE, 0755, &error);
	g_assert_no_error(error);
	g_spawn_sync(NULL, (char **)copies, NULL, G_SPAWN_SEARCH_PATH, NULL, NULL, NULL, NULL, NULL,
		&error);
	g_assert_no_error(error);
	g_spawn_sync(NULL, (char **)argv, environment, G_SPAWN_DEFAULT, NULL, NULL, &said, NULL,
		NULL, &error);
	g_assert_no_error(error);
	return g_strchomp(said);
}

/* In large pages, but for what runs all day, and unless somebody else chose. */
static void test_large_pages(void)
{
	const char *variable = "GLIBC_TUNABLES";
	g_autofree char *command = variable_of("process", variable, NULL),
			*chosen = variable_of("process", variable, ""),
			*all_day = variable_of("kiosk", variable, NULL),
			*other = variable_of("other", variable, NULL);
	g_assert_nonnull(strstr(command, "glibc.malloc.hugetlb=1"));
	g_assert_cmpstr(chosen, ==, "");
	g_assert_cmpstr(all_day, ==, "nothing");
	g_assert_cmpstr(other, ==, "nothing");
}

/* Threads that wait sleep, unless somebody else chose. */
static void test_waiting(void)
{
	const char *variable = "OMP_WAIT_POLICY";
	g_autofree char *all_day = variable_of("kiosk", variable, NULL),
			*other = variable_of("other", variable, NULL),
			*chosen = variable_of("kiosk", variable, "active");
	g_assert_cmpstr(all_day, ==, "passive");
	g_assert_cmpstr(other, ==, "passive");
	g_assert_cmpstr(chosen, ==, "active");
}

/* ---- results ---- */

static const char scan_files[] = "scans/ scans/0001/ scans/0001/cell.tiff scans/0001/colour.tiff "
				 "scans/0001/intensity.tiff scans/0001/offset.tiff "
				 "scans/0001/range.tiff scans/0001/raw.rec scans/0001/scan.json "
				 "site.json";
static const char picture_files[] = "exports/ exports/panoramas/ exports/panoramas/0001-cells.png "
				    "exports/panoramas/0001-colour.png "
				    "exports/panoramas/0001-intensity.png "
				    "exports/panoramas/0001-range.png "
				    "exports/panoramas/index.html ";

static char *folder, *oak, *partial_site;
static listener simulator;

static void assert_png(const char *in, const char *name, uint32_t width, uint32_t height)
{
	static const uint8_t magic[] = "\x89PNG\r\n\x1a\n";
	g_autofree char *path = g_build_filename(in, name, NULL), *bytes = NULL;
	gsize length;
	g_assert_true(g_file_get_contents(path, &bytes, &length, NULL));
	g_assert_cmpuint(length, >, 1000);
	g_assert_cmpmem(bytes, 8, magic, 8);
	uint32_t size[2];
	memcpy(size, bytes + 16, sizeof size);
	g_assert_cmpuint(GUINT32_FROM_BE(size[0]), ==, width);
	g_assert_cmpuint(GUINT32_FROM_BE(size[1]), ==, height);
	g_assert_cmpmem(bytes + length - 8, 4, "IEND", 4);
}

/* Every picture that the page names is there, and the other way round. */
static void assert_page(const char *in)
{
	g_autofree char *path = g_build_filename(in, "index.html", NULL), *html = NULL;
	g_assert_true(g_file_get_contents(path, &html, NULL, NULL));
	g_assert_true(g_str_has_prefix(html, "<!doctype html>"));
	g_assert_true(g_str_has_suffix(html, "</body></html>\n"));
	g_autoptr(GDir) dir = g_dir_open(in, 0, NULL);
	int pictures = 0;
	for (const char *name; (name = g_dir_read_name(dir));)
		if (g_str_has_suffix(name, ".png")) {
			g_assert_nonnull(strstr(html, name));
			assert_png(in, name, 750, 198);
			pictures++;
		}
	g_assert_cmpint(pictures, ==, 4);
}

static void test_scan(void)
{
	g_autofree char *preview = g_build_filename(folder, "preview.png", NULL);
	g_auto(answer) a = commands_run("scan", oak, "--device", simulator.device, "--preset",
		"draft", "--json", "--preview", preview);
	commands_assert_done(&a);
	g_assert_cmpstr(a.err, ==, "");
	g_autoptr(JsonNode) node = commands_json(&a);
	JsonObject *o = json_node_get_object(node);
	g_autofree char *scan = g_build_filename(oak, "scans", "0001", NULL);
	g_assert_cmpstr(json_object_get_string_member(o, "folder"), ==, scan);
	g_assert_cmpint(json_object_get_int_member(o, "scan"), ==, 1);
	g_assert_cmpint(json_object_get_int_member(o, "columns"), ==, 750);
	g_assert_cmpint(json_object_get_int_member(o, "missing_columns"), ==, 0);
	g_assert_cmpint(json_object_get_int_member(o, "measured"), >, 60000);
	g_autofree char *names = commands_names(oak);
	g_assert_cmpstr(names, ==, scan_files);
	assert_png(folder, "preview.png", 750, 198);
}

static void test_panoramas(void)
{
	g_auto(answer) a = commands_run("panoramas", oak, "--json");
	commands_assert_done(&a);
	g_assert_cmpstr(a.err, ==, "");
	g_autoptr(JsonNode) node = commands_json(&a);
	JsonObject *o = json_node_get_object(node);
	g_assert_cmpint(json_object_get_int_member(o, "scans"), ==, 1);
	g_autofree char *in = g_build_filename(oak, "exports", "panoramas", NULL);
	g_autofree char *index = g_build_filename(in, "index.html", NULL);
	g_assert_cmpstr(json_object_get_string_member(o, "page"), ==, index);
	assert_page(in);
	g_autofree char *names = commands_names(oak),
			*wanted = g_strconcat(picture_files, scan_files, NULL);
	g_assert_cmpstr(names, ==, wanted);
}

static void test_develop(void)
{
	g_autofree char *before = commands_snapshot(oak);
	g_auto(answer) a = commands_run("panoramas", oak, "--develop", "--verify");
	commands_assert_done(&a);
	g_autofree char *after = commands_snapshot(oak);
	g_assert_cmpstr(before, ==, after);
}

static void test_scan_that_is_not_there(void)
{
	g_autofree char *before = commands_snapshot(oak);
	g_auto(answer) a = commands_run("panoramas", oak, "--scan", "2");
	commands_assert_refused(&a, 1, "0002");
	g_autofree char *after = commands_snapshot(oak);
	g_assert_cmpstr(before, ==, after);
}

/* A recording stands for the head that made it. */
static void test_replay(void)
{
	g_autofree char *at = g_build_filename(folder, "replayed", NULL),
			*uri = g_strdup_printf("replay:%s/scans/0001/raw.rec", oak);
	g_auto(answer) a = commands_run("scan", at, "--device", uri, "--preset", "draft", "--json");
	commands_assert_done(&a);
	g_autofree char *names = commands_names(at);
	g_assert_cmpstr(names, ==, scan_files);
	commands_shell("cmp '%s/scans/0001/range.tiff' '%s/scans/0001/range.tiff'", oak, at);
}

/* A site's name is bytes to the system; what is printed is text. */
static void test_odd_name(void)
{
	g_autofree char *at = g_build_filename(folder, "o\xff k' \"&<", NULL);
	g_auto(answer) a = commands_run(
		"scan", at, "--device", simulator.device, "--preset", "draft", "--json");
	commands_assert_done(&a);
	g_autoptr(JsonNode) scanned = commands_json(&a);
	g_auto(answer) b = commands_run("panoramas", at, "--json", "--verify");
	commands_assert_done(&b);
	g_autoptr(JsonNode) shown = commands_json(&b);
	g_autofree char *in = g_build_filename(at, "exports", "panoramas", NULL);
	assert_page(in);
}

/* A result that nobody could read is no success. */
static void test_full_stdout(void)
{
	if (!g_file_test("/dev/full", G_FILE_TEST_EXISTS)) {
		g_test_skip("there is no /dev/full");
		return;
	}
	const struct surroundings full = { .stdout_path = "/dev/full" };
	const char *arguments[] = { "panoramas", oak, "--json", NULL };
	g_auto(answer) a = commands_run_in(&full, arguments);
	commands_assert_refused(&a, 1, "cannot be written");
}

/* ---- scans that stop ---- */

/* Stopped in the middle, the site is locked to others; interrupted, the scan keeps what it has. */
static void test_interrupt(void)
{
	g_autofree char *raw =
		g_build_filename(partial_site, "scans", ".0001.partial", "raw.rec", NULL);
	const char *arguments[] = { "scan", partial_site, "--device", simulator.device, "--preset",
		"draft", "--json", NULL };
	running first = commands_start(arguments);
	commands_wait_for_size(raw, 700000);
	kill(first.pid, SIGSTOP);
	g_auto(answer) second = commands_run("scan", partial_site, "--device", DEVICE);
	commands_assert_refused(&second, 1, "another program is writing");
	g_auto(answer) third = commands_run("scan", partial_site, "--resume");
	commands_assert_refused(&third, 1, "another program is writing");
	g_auto(answer) fourth = commands_run("scan", partial_site, "--discard");
	commands_assert_refused(&fourth, 1, "another program is writing");
	g_auto(answer) fifth = commands_run("panoramas", partial_site, "--develop");
	commands_assert_refused(&fifth, 1, "another program is writing");
	g_auto(answer) reader = commands_run("panoramas", partial_site);
	commands_assert_refused(&reader, 1, "no scans yet");
	kill(first.pid, SIGINT);
	kill(first.pid, SIGCONT);
	g_auto(answer) a = commands_end(&first);
	g_assert_cmpint(a.status, ==, 1);
	g_assert_cmpstr(a.out, ==, "");
	/* Also where the signal meets a wait for the head: the sentence is this one. */
	g_assert_nonnull(strstr(a.err, "was stopped"));
	g_assert_nonnull(strstr(a.err, "--resume"));
	g_assert_nonnull(strstr(a.err, "--discard"));
	g_autofree char *names = commands_names(partial_site);
	g_assert_cmpstr(names, ==,
		"scans/ scans/.0001.partial/ scans/.0001.partial/raw.rec "
		"scans/.0001.partial/scan.json site.json");
}

static void test_scan_beside_partial(void)
{
	g_autofree char *before = commands_snapshot(partial_site);
	g_auto(answer) a = commands_run("scan", partial_site, "--device", simulator.device);
	commands_assert_refused(&a, 1, "resume or discard");
	g_autofree char *after = commands_snapshot(partial_site);
	g_assert_cmpstr(before, ==, after);
}

static void test_resume(void)
{
	g_autofree char *at = g_build_filename(folder, "resumed", NULL);
	commands_shell("cp -a '%s' '%s'", partial_site, at);
	g_auto(answer) a = commands_run("scan", at, "--resume", "--json");
	commands_assert_done(&a);
	g_autoptr(JsonNode) node = commands_json(&a);
	JsonObject *o = json_node_get_object(node);
	g_assert_cmpint(json_object_get_int_member(o, "sessions"), ==, 2);
	g_assert_cmpint(json_object_get_int_member(o, "missing_columns"), ==, 0);
	g_autofree char *names = commands_names(at);
	g_assert_cmpstr(names, ==, scan_files);
	g_auto(answer) again = commands_run("scan", at, "--resume");
	commands_assert_refused(&again, 1, "no partial scan");
}

static void test_discard(void)
{
	g_auto(answer) a = commands_run("scan", partial_site, "--discard", "--json");
	commands_assert_done(&a);
	g_autoptr(JsonNode) node = commands_json(&a);
	g_assert_cmpint(json_object_get_int_member(json_node_get_object(node), "discarded"), ==, 1);
	g_autofree char *names = commands_names(partial_site);
	g_assert_cmpstr(names, ==, "scans/ site.json");
	g_auto(answer) b = commands_run("scan", partial_site, "--discard", "--json");
	commands_assert_done(&b);
	g_autoptr(JsonNode) none = commands_json(&b);
	g_assert_true(json_object_get_null_member(json_node_get_object(none), "discarded"));
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	commands_find_programs();
	folder = simulated_folder();
	oak = g_build_filename(folder, "oak", NULL);
	partial_site = g_build_filename(folder, "partial", NULL);
	simulator = commands_listen(folder, COMMANDS_SCENE);
	for (size_t i = 0; i < G_N_ELEMENTS(usages); i++) {
		g_autofree char *path = g_strconcat("/commands/usage/", usages[i].path, NULL);
		g_test_add_data_func(path, &usages[i], test_usage);
	}
	g_test_add_data_func("/commands/help", "--help", test_help);
	g_test_add_data_func("/commands/version", "--version", test_help);
	g_test_add_data_func("/commands/help-scan", "scan --help", test_help);
	g_test_add_data_func("/commands/help-panoramas", "panoramas --help", test_help);
	g_test_add_data_func("/commands/help-bench", "bench --help", test_help);
	g_test_add_func("/commands/nothing", test_nothing);
	g_test_add_func("/commands/large-pages", test_large_pages);
	g_test_add_func("/commands/waiting", test_waiting);
	g_test_add_func("/commands/scan", test_scan);
	g_test_add_func("/commands/panoramas", test_panoramas);
	g_test_add_func("/commands/develop", test_develop);
	g_test_add_func("/commands/scan-that-is-not-there", test_scan_that_is_not_there);
	g_test_add_func("/commands/replay", test_replay);
	g_test_add_func("/commands/odd-name", test_odd_name);
	g_test_add_func("/commands/full-stdout", test_full_stdout);
	g_test_add_func("/commands/interrupt", test_interrupt);
	g_test_add_func("/commands/scan-beside-partial", test_scan_beside_partial);
	g_test_add_func("/commands/resume", test_resume);
	g_test_add_func("/commands/discard", test_discard);
	int status = g_test_run();
	listener_clear(&simulator);
	g_free(folder);
	g_free(oak);
	g_free(partial_site);
	return status;
}
