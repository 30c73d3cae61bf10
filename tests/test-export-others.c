/* Programs not of our making read what was exported: PCD and PLY those of PCL, PTX and PLY CloudCompare, E57 the package web-e57. And the
 * command itself, as people type it. */
#include "tests/exported-site.h"

/* Runs it in the folder; false: there is no such program. */
static bool run_other(const char *folder, const char *const *argv)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *program = g_find_program_in_path(argv[0]), *out = NULL, *err = NULL;
	int status;
	if (!program)
		return false;
	g_spawn_sync(folder, (char **)argv, NULL, G_SPAWN_SEARCH_PATH, commands_enter, NULL, &out,
		&err, &status, &error);
	g_assert_no_error(error);
	if (status)
		g_test_message("%s: status %d: %s %s", argv[0], status, out, err);
	g_assert_cmpint(status, ==, 0);
	return true;
}

/* The points of a station in the file's coordinates, to compare with lines of text. */
static GArray *wanted_of(const exported *e)
{
	GArray *all = g_array_new(false, false, 3 * sizeof(double));
	for (uint32_t number = 1; number <= 2; number++) {
		g_autoptr(panorama) p = scan_load(e->site, number, false, NULL);
		g_autofree char *description = g_strdup_printf(EXPORTED_SCENE "%u", number);
		struct pose pose = simulated_pose(description);
		for (uint32_t row = 0; row < p->desc.rows; row++)
			for (uint32_t c = 0; c < p->desc.columns; c++) {
				double at_m[3];
				if (p->cell[panorama_index(p, row, c)] != CELL_MEASURED)
					continue;
				panorama_point(p, row, c, at_m);
				pose_apply(&pose, at_m, at_m);
				g_array_append_val(all, at_m);
			}
	}
	return all;
}

/* Lines of x y z and more, in the order of the points; lines before them are passed over. */
static void assert_lines(const char *path, const GArray *wanted, double most_m)
{
	g_autofree char *text = NULL;
	guint count = 0;
	g_assert_true(g_file_get_contents(path, &text, NULL, NULL));
	for (char *line = text; line && *line; line = strchr(line, '\n'), line += line != NULL) {
		double at_m[3];
		char *at = line;
		int numbers = 0;
		for (; numbers < 3; numbers++) {
			char *end;
			at_m[numbers] = g_ascii_strtod(at, &end);
			if (end == at || (*end != ' ' && *end != '\n' && *end != '\r'))
				break;
			at = end;
		}
		if (numbers < 3)
			continue;
		g_assert_cmpuint(count, <, wanted->len);
		const double *w = (const double *)(gconstpointer)wanted->data + 3 * (gsize)count++;
		for (int k = 0; k < 3; k++)
			g_assert_cmpfloat(fabs(w[k] - at_m[k]), <=, most_m);
	}
	g_assert_cmpuint(count, ==, wanted->len);
}

static char *export_as(const exported *e, const char *name)
{
	struct export_options o = { 0 };
	struct export_result r;
	char *path = exported_write(e, name, &o, &r);
	export_result_clear(&r);
	return path;
}

/* ---- PCL ---- */

static void test_pcl(void)
{
	g_auto(exported) e = exported_new();
	g_autoptr(GArray) wanted = wanted_of(&e);
	g_autofree char *pcd = export_as(&e, "hall.pcd"), *ply = export_as(&e, "hall.ply");
	const char *to_text[] = { "pcl_convert_pcd_ascii_binary", "hall.pcd", "text.pcd", "0",
		NULL };
	const char *ply_to_pcd[] = { "pcl_ply2pcd", "hall.ply", "of-ply.pcd", NULL };
	const char *then_to_text[] = { "pcl_convert_pcd_ascii_binary", "of-ply.pcd", "text2.pcd",
		"0", NULL };
	if (!run_other(e.folder, to_text) || !run_other(e.folder, ply_to_pcd) ||
		!run_other(e.folder, then_to_text))
		return g_test_skip("PCL's tools are not installed (pcl-tools)");
	g_autofree char *a = exported_file(&e, "text.pcd"), *b = exported_file(&e, "text2.pcd");
	assert_lines(a, wanted, 1e-5);
	assert_lines(b, wanted, 1e-5);
}

/* ---- CloudCompare ---- */

static void test_cloudcompare(void)
{
	static const char *const names[] = { "hall.ptx", "hall.ply" };
	g_auto(exported) e = exported_new();
	g_autoptr(GArray) wanted = wanted_of(&e);
	g_setenv("QT_QPA_PLATFORM", "offscreen", TRUE);
	for (gsize i = 0; i < G_N_ELEMENTS(names); i++) {
		g_autofree char
			*path = export_as(&e, names[i]),
			*text = exported_file(
				&e, i ? "all.asc"
				      : "all.asc_0"); /* a name of its own for what was merged */
		const char *argv[] = { "CloudCompare", "-SILENT", "-AUTO_SAVE", "OFF", "-O",
			names[i], "-MERGE_CLOUDS", "-C_EXPORT_FMT", "ASC", "-PREC", "6",
			"-SAVE_CLOUDS", "FILE", "all.asc", NULL };
		/* Of one cloud there is nothing to merge. */
		if (g_str_has_suffix(names[i], ".ply"))
			for (int k = 6; argv[k]; k++)
				argv[k] = argv[k + 1];
		if (!run_other(e.folder, argv))
			return g_test_skip("CloudCompare is not installed (cloudcompare)");
		/* Its PTX comes column by column. */
		if (g_str_has_suffix(names[i], ".ply"))
			assert_lines(text, wanted, 1e-5);
		g_autofree char *lines = NULL;
		guint count = 0;
		g_assert_true(g_file_get_contents(text, &lines, NULL, NULL));
		for (const char *c = lines; *c; c++)
			count += *c == '\n';
		g_assert_cmpuint(count, ==, wanted->len);
		g_unlink(text);
	}
}

/* ---- web-e57 ---- */

/* From the registry of packages; false: it cannot be had. */
static bool fetch_package(const char *folder)
{
	const char *argv[] = { "sh", "-c",
		"npm pack --silent web-e57@1.2.0 >/dev/null 2>&1 && tar xzf web-e57-1.2.0.tgz",
		NULL };
	int status = 1;
	g_autofree char *npm = g_find_program_in_path("npm"),
			*node = g_find_program_in_path("node");
	return npm && node &&
	       g_spawn_sync(folder, (char **)argv, NULL, G_SPAWN_SEARCH_PATH, commands_enter, NULL,
		       NULL, NULL, &status, NULL) &&
	       status == 0;
}

static void test_web_e57(void)
{
	static const char script[] = "import { readFileSync, writeFileSync } from 'fs';\n"
				     "import { convertE57 } from './package/e57.js';\n"
				     "writeFileSync('all.xyz', convertE57(new "
				     "Uint8Array(readFileSync('hall.e57')), 'XYZ'));\n";
	g_auto(exported) e = exported_new();
	if (!fetch_package(e.folder))
		return g_test_skip("the npm package web-e57 cannot be had");
	g_autoptr(GArray) wanted = wanted_of(&e);
	g_autofree char *path = export_as(&e, "hall.e57"), *to = exported_file(&e, "run.mjs"),
			*text = exported_file(&e, "all.xyz");
	const char *argv[] = { "node", "--experimental-wasm-modules", "--no-warnings", "run.mjs",
		NULL };
	g_assert_true(g_file_set_contents(to, script, -1, NULL));
	g_assert_true(run_other(e.folder, argv));
	/* It applies the poses. */
	assert_lines(text, wanted, 3e-6);
}

/* ---- the command ---- */

static void test_command(void)
{
	g_auto(exported) e = exported_new();
	g_autofree char *path = exported_file(&e, "hall.e57");
	g_auto(answer) a = commands_run("export", e.path, "-o", path, "--json");
	commands_assert_done(&a);
	g_autoptr(JsonNode) node = commands_json(&a);
	JsonObject *o = json_node_get_object(node);
	g_assert_cmpstr(json_object_get_string_member(o, "format"), ==, "E57");
	g_assert_cmpint(json_object_get_int_member(o, "scans"), ==, 2);
	g_assert_cmpint(json_object_get_int_member(o, "points"), >, 100000);
	g_assert_true(json_object_get_boolean_member(o, "verified"));
	g_auto(answer) b =
		commands_run("export", e.path, "-o", path, "--scans", "1-2", "--spacing", "0.5");
	commands_assert_done(&b);
	g_assert_nonnull(strstr(b.out, "left out for the spacing"));
}

static const struct misuse {
	const char *arguments, *words;
	int status;
} misuses[] = { { "", "which site?", 2 }, { "SITE", "into which file?", 2 },
	{ "SITE -o x.dwg", "must end in .e57", 2 },
	{ "SITE -o x.e57 --spacing -1", "a spacing is from", 2 },
	{ "SITE -o x.e57 --spacing cm", "a spacing is from", 2 },
	{ "SITE -o x.e57 --scans 1,,2", "no list of scans", 2 },
	{ "SITE -o x.e57 --scans 0", "no list of scans", 2 },
	{ "SITE -o x.e57 --scans 2-1", "no list of scans", 2 },
	{ "SITE -o x.e57 --scans 1,9", "has no scan 9", 1 },
	{ "SITE -o /nowhere/x.e57", "there is no folder /nowhere", 1 },
	{ "/nowhere -o x.e57", "/nowhere", 1 }, { "SITE SITE -o x.e57", "one site at a time", 2 } };

static void test_misuse(gconstpointer data)
{
	const struct misuse *m = data;
	g_auto(exported) e = exported_new();
	g_auto(GStrv) words = g_strsplit(m->arguments, " ", -1);
	g_autoptr(GPtrArray) argv = g_ptr_array_new();
	g_ptr_array_add(argv, (gpointer) "export");
	for (char **w = words; *w; w++)
		if (**w)
			g_ptr_array_add(argv, strcmp(*w, "SITE") ? *w : e.path);
	g_ptr_array_add(argv, NULL);
	g_autofree char *before = commands_snapshot(e.folder);
	g_auto(answer) a = commands_run_in(NULL, (const char *const *)argv->pdata);
	g_autofree char *after = commands_snapshot(e.folder);
	commands_assert_refused(&a, m->status, m->words);
	g_assert_cmpstr(before, ==, after);
}

/* A full disk: the file that was there stays. */
static void test_full(void)
{
	g_auto(exported) e = exported_new();
	g_autofree char *path = exported_file(&e, "hall.e57"), *was = NULL;
	struct surroundings s = { .file_bytes_max = 500000 };
	g_assert_true(g_file_set_contents(path, "as it was", -1, NULL));
	const char *argv[] = { "export", e.path, "-o", path, NULL };
	g_autofree char *before = commands_snapshot(e.folder);
	g_auto(answer) a = commands_run_in(&s, argv);
	g_autofree char *after = commands_snapshot(e.folder);
	commands_assert_refused(&a, 1, "hall.e57");
	g_assert_cmpstr(before, ==, after);
	g_assert_true(g_file_get_contents(path, &was, NULL, NULL));
	g_assert_cmpstr(was, ==, "as it was");
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	commands_find_programs();
	g_test_add_func("/export-others/pcl", test_pcl);
	g_test_add_func("/export-others/cloudcompare", test_cloudcompare);
	g_test_add_func("/export-others/web-e57", test_web_e57);
	g_test_add_func("/export-others/command", test_command);
	g_test_add_func("/export-others/full", test_full);
	for (gsize i = 0; i < G_N_ELEMENTS(misuses); i++)
		commands_add("/export-others/misuse", i, &misuses[i], test_misuse);
	return g_test_run();
}
