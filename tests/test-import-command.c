/* pleinair import as people type it: what it says, what it leaves, and how it is stopped. */
#include "acquire/points.h"
#include "acquire/site.h"
#include "tests/commands.h"
#include "tests/simulated.h"

#define CELLS "1 2 0.5 0.5 1 2 3\n1.01 2 0.4 0.25 1 2 3\n0 0 0 0.5 0 0 0\n1.03 2.01 0.4 1 1 2 3\n"
#define HEAD  "2\n2\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
#define AT(x) HEAD "1 0 0 0\n0 1 0 0\n0 0 1 0\n" x " 0 0 1\n"
#define ONE   AT("0") CELLS
#define THREE AT("0") CELLS AT("5") CELLS AT("7000.5") CELLS
#define BAD   AT("0") CELLS AT("5") "1 2 x\n"

struct folder {
	char *path, *site;
};

static struct folder folder_new(void)
{
	char *path = simulated_folder();
	return (struct folder){ path, g_build_filename(path, "site", NULL) };
}

static void folder_clear(struct folder *f)
{
	g_free(f->site);
	g_free(f->path);
}

static char *write_file(const struct folder *f, const char *name, const char *text)
{
	char *path = g_build_filename(f->path, name, NULL);
	g_assert_true(g_file_set_contents(path, text, -1, NULL));
	return path;
}

/* ---- usage ---- */

static const struct usage {
	const char *path;
	const char *arguments[6];
	int status;
	const char *names;
} usages[] = {
	{ "no-site", { "import" }, 2, "which site" },
	{ "empty-site", { "import", "", "a.ptx" }, 2, "which site" },
	{ "no-files", { "import", "x" }, 2, "which files" },
	{ "empty-file", { "import", "x", "" }, 2, "no name" },
	{ "option", { "import", "x", "a.ptx", "--frob" }, 2, "--frob" },
	{ "missing-file", { "import", "x", "a.ptx" }, 1, "a.ptx: cannot open" },
	{ "folder", { "import", "x", "/" }, 1, "/: is a folder" },
	{ "device", { "import", "x", "/dev/zero" }, 1, "not a plain file" },
	{ "other-format", { "import", "x", "/bin/sh" }, 1, "PTX" },
	{ "samples", { "import", "x", "a.off", "--samples", "-1" }, 2, "points go from 1" },
	{ "samples-and-spacing", { "import", "x", "a.off", "--samples=9", "--spacing=0.1" }, 2,
		"take one" },
	{ "parent-missing", { "import", "no/x", "/bin/sh" }, 1, "no/x" },
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

static void test_help(void)
{
	g_auto(answer) a = commands_run("import", "--help"), all = commands_run("--help");
	commands_assert_done(&a);
	g_assert_nonnull(strstr(a.out, "SITE FILE..."));
	g_assert_nonnull(strstr(all.out, "  import "));
}

/* ---- results ---- */

static void test_lines(void)
{
	struct folder f = folder_new();
	g_autofree char *file = write_file(&f, "three.ptx", THREE);
	g_auto(answer) a = commands_run("import", f.site, file);
	commands_assert_done(&a);
	g_assert_cmpstr(a.err, ==, "");
	g_auto(GStrv) lines = g_strsplit(a.out, "\n", -1);
	g_assert_cmpuint(g_strv_length(lines), ==, 4); /* one a scan, and the end of the last */
	g_assert_nonnull(strstr(lines[2], "/scans/0003: scan 3 of "));
	g_assert_nonnull(strstr(lines[2], "3 points, a grid of 2 x 2"));
	g_assert_nonnull(strstr(lines[2], "intensity, colour, at 7000.500 0.000 0.000"));
	g_autofree char *names = commands_names(f.site);
	g_assert_cmpstr(names, ==,
		"scans/ scans/0001/ scans/0001/points.ply scans/0001/scan.json scans/0002/ "
		"scans/0002/points.ply scans/0002/scan.json scans/0003/ scans/0003/points.ply "
		"scans/0003/scan.json site.json");
	folder_clear(&f);
}

static JsonObject *scan_of(JsonNode *node, guint index)
{
	JsonArray *scans = json_object_get_array_member(json_node_get_object(node), "scans");
	return json_array_get_object_element(scans, index);
}

static void test_json(void)
{
	struct folder f = folder_new();
	g_autofree char *file = write_file(&f, "three.ptx", THREE);
	g_auto(answer) a = commands_run("import", f.site, file, "--json");
	commands_assert_done(&a);
	g_autoptr(JsonNode) node = commands_json(&a);
	JsonObject *o = scan_of(node, 2);
	g_assert_cmpint(json_object_get_int_member(o, "scan"), ==, 3);
	g_assert_cmpint(json_object_get_int_member(o, "scan_in_file"), ==, 3);
	g_assert_cmpint(json_object_get_int_member(o, "points"), ==, 3);
	g_assert_cmpint(json_object_get_int_member(o, "columns"), ==, 2);
	g_assert_cmpint(json_object_get_int_member(o, "rows"), ==, 2);
	g_assert_true(json_object_get_boolean_member(o, "colour"));
	g_assert_false(json_object_get_boolean_member(o, "classes"));
	JsonArray *position = json_object_get_array_member(o, "position_m");
	g_assert_cmpfloat(json_array_get_double_element(position, 0), ==, 7000.5);
	folder_clear(&f);
}

/* A mesh, by either name of the number of its points, gives the same ones. */
static void test_samples(void)
{
	struct folder f = folder_new();
	g_autofree char *file = write_file(&f, "tetra.off",
				"OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
				"3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n"),
			*other = g_build_filename(f.path, "other", NULL);
	g_auto(answer) a = commands_run("import", f.site, file, "--samples", "300", "--json"),
		       b = commands_run("import", other, file, "--points", "300", "--json");
	commands_assert_done(&a);
	commands_assert_done(&b);
	g_autoptr(JsonNode) one = commands_json(&a), two = commands_json(&b);
	gint64 count = json_object_get_int_member(scan_of(one, 0), "points");
	g_assert_cmpint(count, >, 200);
	g_assert_cmpint(count, <, 400);
	g_assert_cmpint(json_object_get_int_member(scan_of(two, 0), "points"), ==, count);
	folder_clear(&f);
}

/* The first bad file stops it; what came before stays. */
static void test_second_bad(void)
{
	struct folder f = folder_new();
	g_autofree char *one = write_file(&f, "one.ptx", ONE),
			*bad = write_file(&f, "bad.ptx", BAD),
			*three = write_file(&f, "three.ptx", THREE);
	g_auto(answer) a = commands_run("import", f.site, one, bad, three);
	g_assert_cmpint(a.status, ==, 1);
	g_assert_nonnull(strstr(a.err, "bad.ptx: line 25: "));
	g_assert_nonnull(strstr(a.out, "/scans/0001: "));
	g_autofree char *names = commands_names(f.site);
	g_assert_cmpstr(names, ==,
		"scans/ scans/0001/ scans/0001/points.ply scans/0001/scan.json site.json");
	g_autofree char *before = commands_snapshot(f.site);
	g_auto(answer) again = commands_run("import", f.site, bad, "--json");
	commands_assert_refused(&again, 1, "bad.ptx: line 25: ");
	g_autofree char *after = commands_snapshot(f.site);
	g_assert_cmpstr(before, ==, after);
	folder_clear(&f);
}

static void test_first_bad(void)
{
	struct folder f = folder_new();
	g_autofree char *bad = write_file(&f, "bad.ptx", BAD);
	g_auto(answer) a = commands_run("import", f.site, bad);
	commands_assert_refused(&a, 1, "bad.ptx: line 25: ");
	g_assert_false(g_file_test(f.site, G_FILE_TEST_EXISTS));
	folder_clear(&f);
}

/* ---- the same file twice ---- */

static void test_twice(void)
{
	struct folder f = folder_new();
	g_autofree char *three = write_file(&f, "three.ptx", THREE),
			*copy = write_file(&f, "copy.ptx", THREE);
	g_auto(answer) first = commands_run("import", f.site, three);
	commands_assert_done(&first);
	g_autofree char *before = commands_snapshot(f.site);
	g_auto(answer) a = commands_run("import", f.site, copy);
	commands_assert_refused(&a, 1, "copy.ptx: is in this site already, as scan 0001");
	g_autofree char *after = commands_snapshot(f.site);
	g_assert_cmpstr(before, ==, after);
	g_auto(answer) again = commands_run("import", f.site, copy, "--again");
	commands_assert_done(&again);
	g_assert_nonnull(strstr(again.out, "/scans/0006: scan 3 of "));
	folder_clear(&f);
}

/* A file of which a scan is missing, because a person removed it or the power went: that one comes again. */
static void test_missing_one(void)
{
	struct folder f = folder_new();
	g_autofree char *three = write_file(&f, "three.ptx", THREE);
	g_auto(answer) first = commands_run("import", f.site, three);
	commands_assert_done(&first);
	commands_shell("rm -r '%s/scans/0002'", f.site);
	g_auto(answer) a = commands_run("import", f.site, three);
	commands_assert_done(&a);
	g_assert_nonnull(strstr(a.out, "/scans/0004: scan 2 of "));
	g_assert_null(strstr(a.out, "scan 3 of"));
	g_auto(answer) none = commands_run("import", f.site, three);
	commands_assert_refused(&none, 1, "already");
	folder_clear(&f);
}

/* ---- with scans of our own ---- */

static void begin_partial(const struct folder *f)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(site) s = site_open_for_writing(f->site, &error);
	g_autoptr(manifest) m = manifest_new("scan.json");
	uint32_t number;
	manifest_set_int(m, "schema", 1);
	g_assert_true(site_begin_scan(s, m, &number, &error));
	g_assert_no_error(error);
}

static void test_beside_partial(void)
{
	struct folder f = folder_new();
	g_autofree char *one = write_file(&f, "one.ptx", ONE);
	begin_partial(&f);
	g_auto(answer) a = commands_run("import", f.site, one);
	commands_assert_done(&a);
	g_autofree char *names = commands_names(f.site);
	g_assert_cmpstr(names, ==,
		"scans/ scans/.0001.partial/ scans/.0001.partial/scan.json scans/0002/ "
		"scans/0002/points.ply scans/0002/scan.json site.json");
	folder_clear(&f);
}

static void test_recorded_and_imported(void)
{
	struct folder f = folder_new();
	g_autoptr(GString) map = g_string_new(AT("0") CELLS);
	g_string_replace(map, "1.01 2", "700000 2", 0);
	g_string_replace(map, "1 2 0.5 0.5", "700001 2 0.5 0.5", 0);
	/* 4 x 2: as small as a panorama can be, with neighbours */
	g_autofree char *row = write_file(&f, "row.ptx",
		"4\n2\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n" CELLS
			CELLS);
	g_autofree char *cloud = write_file(&f, "cloud.ptx", map->str);
	g_auto(answer) a = commands_run("import", f.site, row, cloud);
	commands_assert_done(&a);
	g_auto(answer) scan = commands_run(
		"scan", f.site, "--device", "sim:" COMMANDS_SCENE, "--preset", "draft");
	commands_assert_done(&scan);
	for (int again = 0; again < 2; again++) {
		g_auto(answer) shown = commands_run(
			"panoramas", f.site, "--verify", again ? "--develop" : "--json");
		commands_assert_done(&shown);
		if (again)
			g_assert_nonnull(
				strstr(shown.out, "1 scan without a grid: no picture\n2 scans: "));
	}
	g_autofree char *picture =
		g_build_filename(f.site, "exports/panoramas/0001-colour.png", NULL);
	g_assert_true(g_file_test(picture, G_FILE_TEST_EXISTS));
	commands_shell("printf x | dd of='%s/scans/0001/points.ply' bs=1 seek=530 conv=notrunc "
		       "2>/dev/null",
		f.site);
	g_auto(answer) damaged = commands_run("panoramas", f.site);
	commands_assert_refused(&damaged, 1, "points.ply: is not as it was written");
	folder_clear(&f);
}

/* ---- stopped ---- */

/* Large enough to be met while it is read. */
static char *write_large(const struct folder *f)
{
	char *path = g_build_filename(f->path, "large.ptx", NULL);
	g_autoptr(GString) text = g_string_new("1000\n2000\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
					       "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
	for (int i = 0; i < 1000; i++)
		for (int j = 0; j < 2000; j++)
			g_string_append(text, j % 2 ? "1 2 0.5 0.5\n" : "1.125 2.25 0.5 0.25\n");
	g_assert_true(g_file_set_contents(path, text->str, (gssize)text->len, NULL));
	return path;
}

static bool is_under_way(const struct folder *f)
{
	g_autofree char *names = commands_names(f->site);
	return strstr(names, ".new.");
}

static void test_stopped(gconstpointer data)
{
	int number = GPOINTER_TO_INT(data);
	struct folder f = folder_new();
	g_autofree char *one = write_file(&f, "one.ptx", ONE), *large = write_large(&f);
	g_auto(answer) first = commands_run("import", f.site, one);
	commands_assert_done(&first);
	g_autofree char *before = commands_snapshot(f.site);
	const char *const arguments[] = { "import", f.site, large, NULL };
	running r = commands_start(arguments);
	for (int i = 0; i < 20000 && !is_under_way(&f); i++)
		g_usleep(200);
	kill(r.pid, number);
	g_auto(answer) a = commands_end(&r);
	if (a.status == 0) {
		folder_clear(&f);
		return g_test_skip("it was done before it could be stopped");
	}
	g_assert_cmpint(a.status, ==, number == SIGKILL ? -1 : 1);
	if (number != SIGKILL)
		g_assert_nonnull(strstr(a.err, "stopped"));
	/* After a kill there are remains, which the next writer removes. */
	{
		g_autoptr(GError) error = NULL;
		g_autoptr(site) s = site_open_existing(f.site, &error);
		g_assert_no_error(error);
	}
	g_autofree char *after = commands_snapshot(f.site);
	g_assert_cmpstr(before, ==, after);
	folder_clear(&f);
}

/* The disk ends in the middle. */
static void test_full(void)
{
	struct folder f = folder_new();
	g_autofree char *one = write_file(&f, "one.ptx", ONE), *large = write_large(&f);
	g_auto(answer) first = commands_run("import", f.site, one);
	g_autofree char *before = commands_snapshot(f.site);
	const struct surroundings small = { .file_bytes_max = 3 << 20 };
	const char *const arguments[] = { "import", f.site, large, NULL };
	g_auto(answer) a = commands_run_in(&small, arguments);
	commands_assert_refused(&a, 1, "File too large");
	g_autofree char *after = commands_snapshot(f.site);
	g_assert_cmpstr(before, ==, after);
	folder_clear(&f);
}

static void test_locked(void)
{
	struct folder f = folder_new();
	g_autofree char *one = write_file(&f, "one.ptx", ONE);
	g_autoptr(site) s = site_open_for_writing(f.site, NULL);
	g_auto(answer) a = commands_run("import", f.site, one);
	commands_assert_refused(&a, 1, "another program is writing");
	folder_clear(&f);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	commands_find_programs();
	for (size_t i = 0; i < G_N_ELEMENTS(usages); i++) {
		g_autofree char *path = g_strconcat("/import-command/usage/", usages[i].path, NULL);
		g_test_add_data_func(path, &usages[i], test_usage);
	}
	g_test_add_func("/import-command/help", test_help);
	g_test_add_func("/import-command/lines", test_lines);
	g_test_add_func("/import-command/json", test_json);
	g_test_add_func("/import-command/samples", test_samples);
	g_test_add_func("/import-command/second-bad", test_second_bad);
	g_test_add_func("/import-command/first-bad", test_first_bad);
	g_test_add_func("/import-command/twice", test_twice);
	g_test_add_func("/import-command/missing-one", test_missing_one);
	g_test_add_func("/import-command/beside-partial", test_beside_partial);
	g_test_add_func("/import-command/recorded-and-imported", test_recorded_and_imported);
	g_test_add_data_func(
		"/import-command/stopped/interrupted", GINT_TO_POINTER(SIGINT), test_stopped);
	g_test_add_data_func(
		"/import-command/stopped/ended", GINT_TO_POINTER(SIGTERM), test_stopped);
	g_test_add_data_func(
		"/import-command/stopped/killed", GINT_TO_POINTER(SIGKILL), test_stopped);
	g_test_add_func("/import-command/full", test_full);
	g_test_add_func("/import-command/locked", test_locked);
	return g_test_run();
}
