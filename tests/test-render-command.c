/* pleinair render as people type it, on a small site. */
#include "process/site-lines.h"
#include "render/texels.h"
#include "tests/commands.h"
#include "tests/scene-made.h"
#include <glib/gstdio.h>

static char *folder, *oak;

/* Caller frees. */
static char *in_folder(const char *name)
{
	return g_build_filename(folder, name, NULL);
}

static char *put(const char *name, const char *text)
{
	char *path = in_folder(name);
	g_autofree char *in = g_path_get_dirname(path);
	g_assert_cmpint(g_mkdir_with_parents(in, 0755), ==, 0);
	g_assert_true(g_file_set_contents(path, text, -1, NULL));
	return path;
}

static void put_site(const char *name)
{
	g_autofree char *file = g_build_filename(name, "site.json", NULL);
	g_autofree char *path = put(file,
		"{\"schema\":1,\"name\":\"Oak\",\"id\":\"6f1f6c8e-1b1e-4c3a-9d55-0c9a3b0a7a11\","
		"\"created\":\"2026-11-23T10:00:00Z\",\"units\":\"metres\"}");
}

static void put_model(void)
{
	g_auto(made) m = made_court();
	g_autofree char *in = g_build_filename(oak, "model", NULL), *path = model_path(oak);
	g_assert_cmpint(g_mkdir_with_parents(in, 0755), ==, 0);
	made_write_to(&m, path);
	g_autoptr(segments) tree = made_tree();
	g_autofree char *other = g_build_filename(oak, "segments", NULL);
	g_autoptr(GError) error = NULL;
	g_assert_cmpint(g_mkdir_with_parents(other, 0755), ==, 0);
	g_assert_true(segments_save(tree, oak, &error));
	g_assert_no_error(error);
	g_autoptr(site) s = site_open(oak, &error);
	g_assert_no_error(error);
	g_autoptr(profile_lines) lines = site_lines_make(s, NULL, &error);
	g_assert_no_error(error);
	g_assert_cmpuint(lines->line->len, >, 0);
}

/* A style of lines says so where there are none. */
static void test_no_lines(void)
{
	g_autofree char *path = site_lines_path(oak), *to = in_folder("bare.png");
	g_autofree char *aside = g_strconcat(path, ".aside", NULL);
	g_auto(answer) with = commands_run(
		"render", oak, "--style", "line-drawing", "--size", "64x48", "--output", to);
	commands_assert_done(&with);
	g_assert_null(strstr(with.err, "no profile lines"));
	g_assert_cmpint(g_rename(path, aside), ==, 0);
	g_auto(answer) without = commands_run(
		"render", oak, "--style", "line-drawing", "--size", "64x48", "--output", to);
	g_auto(answer) other = commands_run(
		"render", oak, "--style", "figure-7d", "--size", "64x48", "--output", to);
	g_assert_cmpint(g_rename(aside, path), ==, 0);
	commands_assert_done(&without);
	commands_assert_done(&other);
	g_assert_nonnull(strstr(without.err, "no profile lines"));
	g_assert_null(strstr(other.err, "no profile lines"));
}

/* Of a picture's grey: how many of its pixels are darker than that. */
static size_t dark_pixels(const char *path, uint32_t width, uint32_t height, uint8_t than)
{
	g_autoptr(GError) error = NULL;
	uint32_t w, h;
	g_autofree uint8_t *grey = texels_read_png(path, TEXELS_LIGHT, &w, &h, &error);
	size_t dark = 0;
	g_assert_no_error(error);
	g_assert_cmpuint(w, ==, width);
	g_assert_cmpuint(h, ==, height);
	for (size_t i = 0; i < (size_t)w * h; i++)
		dark += grey[i] < than;
	return dark;
}

/* ---- pictures ---- */

static void test_default(void)
{
	g_auto(answer) a = commands_run("render", oak, "--size", "320x240", "--backend", "cpu");
	commands_assert_done(&a);
	g_autofree char *file = g_build_filename(oak, "exports", "figure-7d-overview.png", NULL);
	g_autofree char *wanted = g_strdup_printf("%s\nfigure-7d; cpu: as asked for\n", file);
	g_assert_cmpstr(a.out, ==, wanted);
	g_assert_cmpstr(a.err, ==, "");
	size_t dark = dark_pixels(file, 320, 240, 200);
	g_assert_cmpuint(dark, >, 100);
	g_assert_cmpuint(dark, <, 320 * 240 / 2);
}

/* All shipped styles draw something, each another thing. */
static void test_styles(void)
{
	g_auto(GStrv) names = style_names(NULL);
	g_autoptr(GHashTable) seen = g_hash_table_new_full(g_str_hash, g_str_equal, g_free, NULL);
	g_autofree char *file = in_folder("style.png");
	for (char **name = names; *name; name++) {
		g_auto(answer) a = commands_run("render", oak, "--size", "160x120", "--style",
			*name, "--view", "walk", "-o", file);
		g_autofree char *bytes = NULL;
		gsize length;
		commands_assert_done(&a);
		g_assert_true(g_file_get_contents(file, &bytes, &length, NULL));
		g_assert_cmpuint(dark_pixels(file, 160, 120, 235), >, 20);
		g_hash_table_add(seen, g_compute_checksum_for_data(
					       G_CHECKSUM_SHA256, (const guchar *)bytes, length));
	}
	g_assert_cmpuint(g_strv_length(names), >=, 10);
	g_assert_cmpuint(g_hash_table_size(seen), ==, g_strv_length(names));
}

/* pleinair styles draws all of them, with a page. */
static void test_thumbnails(void)
{
	g_auto(GStrv) names = style_names(NULL);
	g_autofree char *to = in_folder("gallery"), *none = in_folder("none");
	g_autofree char *film = in_folder("a film.mp4"), *report = in_folder("report.html");
	g_assert_true(g_file_set_contents(film, "f", -1, NULL));
	g_assert_true(g_file_set_contents(report, "r", -1, NULL));
	g_auto(answer) a = commands_run("styles", oak, "--thumbnails", to, "--size", "120x90",
		"--view", "overview", "--title", "Oak & elm", "--with", film, "--with", report);
	g_autofree char *page = g_build_filename(to, "index.html", NULL), *text = NULL;
	commands_assert_done(&a);
	g_assert_true(g_file_get_contents(page, &text, NULL, NULL));
	for (char **name = names; *name; name++) {
		g_autofree char *file = g_strdup_printf("%s.png", *name);
		g_autofree char *path = g_build_filename(to, file, NULL);
		g_assert_nonnull(strstr(text, file));
		g_assert_cmpuint(dark_pixels(path, 120, 90, 235), >, 10);
	}
	g_assert_nonnull(strstr(text, "<h1>Oak &amp; elm</h1>"));
	g_assert_nonnull(strstr(text, "<video src=\"../a%20film.mp4\""));
	g_assert_nonnull(strstr(text, "<iframe src=\"../report.html\""));
	g_autofree char *sheet = g_build_filename(to, "contact-sheet.png", NULL);
	g_assert_true(g_file_test(sheet, G_FILE_TEST_IS_REGULAR));
	g_auto(answer) no_film = commands_run("styles", oak, "--thumbnails", to, "--with", none);
	commands_assert_refused(&no_film, 1, none);
	g_auto(answer) of_none = commands_run("styles", "--thumbnails", to);
	commands_assert_refused(&of_none, 2, "thumbnails of which site?");
	g_auto(answer) size = commands_run("styles", oak, "--thumbnails", to, "--size", "0x9");
	commands_assert_refused(&size, 2, "not '0x9'");
	g_auto(answer) view = commands_run("styles", oak, "--thumbnails", to, "--view", "nowhere");
	commands_assert_refused(&view, 1, "nowhere");
	g_auto(answer) missing = commands_run("styles", none, "--thumbnails", to);
	commands_assert_refused(&missing, 1, none);
}

/* The same command twice writes the same file. */
static void test_twice(void)
{
	g_autofree char *one = in_folder("one.png"), *two = in_folder("two.png");
	g_autofree char *a_bytes = NULL, *b_bytes = NULL;
	gsize a_length, b_length;
	g_auto(answer) a = commands_run("render", oak, "--size", "200x150", "-o", one);
	g_auto(answer) b = commands_run("render", oak, "--size", "200x150", "-o", two);
	commands_assert_done(&a);
	commands_assert_done(&b);
	g_assert_true(g_file_get_contents(one, &a_bytes, &a_length, NULL));
	g_assert_true(g_file_get_contents(two, &b_bytes, &b_length, NULL));
	g_assert_cmpmem(a_bytes, a_length, b_bytes, b_length);
}

static void test_json(void)
{
	g_autofree char *file = in_folder("json.png");
	g_auto(answer) a = commands_run("render", oak, "--size", "64x48", "-o", file, "--json",
		"--style", "points", "--supersample", "1", "--view", "103,195,6:103,204,4:50");
	commands_assert_done(&a);
	g_autoptr(JsonNode) root = commands_json(&a);
	JsonObject *o = json_node_get_object(root);
	g_assert_cmpstr(json_object_get_string_member(o, "file"), ==, file);
	g_assert_cmpstr(json_object_get_string_member(o, "style"), ==, "points");
	g_assert_cmpint(json_object_get_int_member(o, "frames"), ==, 1);
	g_assert_cmpint(json_object_get_int_member(o, "width"), ==, 64);
	g_assert_cmpint(json_object_get_int_member(o, "height"), ==, 48);
	g_assert_cmpuint(dark_pixels(file, 64, 48, 250), >, 1000);
}

static void test_times(void)
{
	g_autofree char *file = in_folder("times.png");
	g_auto(answer) a = commands_run("render", oak, "--size", "64x48", "-o", file, "--times");
	commands_assert_done(&a);
	g_assert_nonnull(strstr(a.out, "\nmask "));
	g_assert_nonnull(strstr(a.out, " million points in view, "));
}

static void test_path(void)
{
	g_autofree char *file = in_folder("frame.png"), *first = in_folder("frame-0000.png");
	g_auto(answer) a =
		commands_run("render", oak, "--size", "80x60", "-o", file, "--path", "orbit:20:3");
	commands_assert_done(&a);
	g_autofree char *line = g_strdup_printf("3 frames, %s and so on\n", first);
	g_assert_true(g_str_has_prefix(a.out, line));
	for (int n = 0; n < 3; n++) {
		g_autofree char *name = g_strdup_printf("frame-%04d.png", n);
		g_autofree char *path = in_folder(name);
		g_assert_cmpuint(dark_pixels(path, 80, 60, 220), >, 5);
	}
	g_autofree char *fourth = in_folder("frame-0003.png");
	g_assert_false(g_file_test(fourth, G_FILE_TEST_EXISTS));
	g_assert_false(g_file_test(file, G_FILE_TEST_EXISTS));
}

/* ---- views ---- */

static void test_views(void)
{
	g_autofree char *file = in_folder("view.png");
	g_auto(answer) saved = commands_run("render", oak, "--size", "64x48", "-o", file, "--view",
		"103,195,6:103,204,4:50", "--style", "points", "--save-view", "gate");
	g_auto(answer) list = commands_run("render", oak, "--list-views");
	g_auto(answer) again =
		commands_run("render", oak, "--size", "64x48", "-o", file, "--view", "gate");
	commands_assert_done(&saved);
	commands_assert_done(&list);
	commands_assert_done(&again);
	static const char *const names[] = { "gate", "overview\n", "walk\n", "plan\n",
		"station-1\n" };
	for (size_t n = 0; n < G_N_ELEMENTS(names); n++)
		g_assert_nonnull(strstr(list.out, names[n]));
	g_assert_nonnull(strstr(again.out, "\npoints; ")); /* the style that it was kept with */
	g_autofree char *kept = g_build_filename(oak, "views", "gate.json", NULL);
	g_assert_true(g_file_test(kept, G_FILE_TEST_EXISTS));
}

/* ---- what is wrong ---- */

static const struct usage {
	const char *arguments[8]; /* OAK: the site's path */
	int status;
	const char *names;
} usages[] = {
	{ { "render" }, 2, "which site" },
	{ { "render", "OAK", "OAK" }, 2, "which site" },
	{ { "render", "OAK", "--frob" }, 2, "--frob" },
	{ { "render", "OAK", "--size", "0x0" }, 2, "'0x0'" },
	{ { "render", "OAK", "--size", "40000x10" }, 2, "'40000x10'" },
	{ { "render", "OAK", "--size", "10x40000" }, 2, "'10x40000'" },
	{ { "render", "OAK", "--size", "-5x10" }, 2, "'-5x10'" },
	{ { "render", "OAK", "--size", "wide" }, 2, "'wide'" },
	{ { "render", "OAK", "--size", "10x10x10" }, 2, "'10x10x10'" },
	{ { "render", "OAK", "--size", "" }, 2, "''" },
	{ { "render", "OAK", "--size", "30000x30000" }, 2, "30000x30000" },
	{ { "render", "OAK", "--supersample", "9" }, 2, "--supersample" },
	{ { "render", "OAK", "--supersample", "0" }, 2, "--supersample" },
	{ { "render", "OAK", "--supersample", "x" }, 2, "supersample" },
	{ { "render", "OAK", "--memory", "much" }, 2, "memory is told as 512M or 4G" },
	{ { "render", "OAK", "--memory", "4GB" }, 2, "memory is told as 512M or 4G" },
	{ { "render", "OAK", "--memory", "12" }, 2, "1M at least" },
	{ { "render", "OAK", "--output", "x.jpg" }, 2, "'x.jpg'" },
	{ { "render", "OAK", "--output", "" }, 2, "''" },
	{ { "render", "OAK", "--backend", "foo" }, 2, "foo" },
	{ { "render", "no/such/site" }, 1, "no/such/site" },
	{ { "render", "OAK", "--style", "nonesuch" }, 1, "nonesuch" },
	{ { "render", "OAK", "--style", "figure-7x" }, 1, "figure-7" },
	{ { "render", "OAK", "--style", "no/such.json" }, 1, "no/such.json" },
	{ { "render", "OAK", "--view", "nowhere" }, 1, "nowhere" },
	{ { "render", "OAK", "--view", "1,2,3:1,2,3" }, 1, "1,2,3" },
	{ { "render", "OAK", "--view", "1,2:1" }, 1, "1,2:1" },
	{ { "render", "OAK", "--path", "zigzag" }, 1, "zigzag" },
	{ { "render", "OAK", "--path", "orbit:1:0" }, 1, "orbit" },
	{ { "render", "OAK", "--size", "8x8", "--output", "no/such/folder/x.png" }, 1,
		"no/such/folder" },
	{ { "render", "OAK", "--size", "8x8", "--save-view", "a/b" }, 2, "'a/b'" },
};

static void test_usage(gconstpointer data)
{
	const struct usage *u = data;
	const char *arguments[9] = { NULL };
	for (int n = 0; u->arguments[n]; n++)
		arguments[n] = g_str_equal(u->arguments[n], "OAK") ? oak : u->arguments[n];
	g_auto(answer) a = commands_run_in(NULL, arguments);
	commands_assert_refused(&a, u->status, u->names);
}

static void test_no_model(void)
{
	put_site("bare");
	g_autofree char *bare = in_folder("bare");
	g_auto(answer) a = commands_run("render", bare);
	commands_assert_refused(&a, 1, "points.model");
}

/* A copy of the model, then damaged. */
static char *damaged_site(const char *name, long at, int byte)
{
	char *path = in_folder(name);
	g_autofree char *from = model_path(oak), *to = model_path(path),
			*in = g_path_get_dirname(to), *bytes = NULL;
	gsize length;
	put_site(name);
	g_assert_cmpint(g_mkdir_with_parents(in, 0755), ==, 0);
	g_assert_true(g_file_get_contents(from, &bytes, &length, NULL));
	if (at < 0)
		length = (gsize)-at;
	else
		bytes[at] = (char)byte;
	g_assert_true(g_file_set_contents(to, bytes, (gssize)length, NULL));
	return path;
}

static void test_damaged(void)
{
	g_autofree char *cut = damaged_site("cut", -100000, 0), *none = damaged_site("none", -1, 0),
			*head = damaged_site("head", 20, 0x55);
	g_auto(answer) a = commands_run("render", cut), b = commands_run("render", none),
		       c = commands_run("render", head);
	commands_assert_refused(&a, 1, "points.model");
	commands_assert_refused(&b, 1, "points.model");
	commands_assert_refused(&c, 1, "points.model");
}

/* A model that has no points yet, as of a site of whose scans none can be used. */
static void test_empty(void)
{
	put_site("empty");
	g_autofree char *path = in_folder("empty"), *file = in_folder("empty.png"),
			*to = model_path(path), *in = g_path_get_dirname(to);
	g_auto(made) m = made_new();
	g_assert_cmpint(g_mkdir_with_parents(in, 0755), ==, 0);
	made_write_to(&m, to);
	g_auto(answer) a = commands_run("render", path, "--size", "64x48", "-o", file);
	g_auto(answer) b = commands_run(
		"render", path, "--size", "64x48", "-o", file, "--view", "0,0,0:1,0,0");
	g_auto(answer) c = commands_run("render", path, "--list-views");
	commands_assert_refused(&a, 1, "overview");
	commands_assert_done(&b);
	commands_assert_done(&c);
	g_assert_cmpuint(dark_pixels(file, 64, 48, 220), ==, 0); /* paper alone */
}

static void test_bad_styles(void)
{
	g_autofree char *typo = put("typo.json",
		"{\"schema\":1,\n\"segments\":{\"site\":{\"steps\":[{\"step\":\"stroke\"}]}}}");
	g_autofree char *texture =
		put("texture.json", "{\"schema\":1,\"segments\":{\"site\":{\"steps\":[{\"step\":"
				    "\"strokes\",\"texture\":"
				    "\"./missing.png\"}]}}}");
	g_autofree char *paper =
		put("paper.json", "{\"schema\":1,\"paper\":{\"texture\":\"./paper-missing.png\"},"
				  "\"segments\":{\"site\":{\"steps\":[{\"step\":\"edl\"}]}}}");
	g_autofree char *garbage = put("garbage.json", "\x01\x02");
	g_auto(answer) a = commands_run("render", oak, "--style", typo),
		       b = commands_run("render", oak, "--size", "64x48", "--style", texture),
		       c = commands_run("render", oak, "--size", "64x48", "--style", paper),
		       d = commands_run("render", oak, "--style", garbage);
	commands_assert_refused(&a, 1, "typo.json line 2");
	commands_assert_refused(&b, 1, "missing.png");
	commands_assert_refused(&c, 1, "paper-missing.png");
	commands_assert_refused(&d, 1, "garbage.json");
}

/* A tree that is damaged is no reason to draw all as one. */
static void test_bad_segments(void)
{
	g_autofree char *path = damaged_site("tree", 0, 'P');
	g_autofree char *file = put("tree/segments/segments.json", "{\"schema\":1,");
	g_auto(answer) a = commands_run("render", path, "--size", "64x48");
	commands_assert_refused(&a, 1, "segments.json");
}

static void test_unwritable(void)
{
	static const struct surroundings nobody = { .nobody = true };
	g_autofree char *locked = in_folder("locked"), *file = in_folder("locked/x.png");
	g_assert_cmpint(g_mkdir(locked, 0555), ==, 0);
	g_assert_cmpint(g_chmod(folder, 0755), ==, 0);
	const char *arguments[] = { "render", oak, "--size", "16x12", "-o", file, NULL };
	g_auto(answer) a = commands_run_in(&nobody, arguments);
	commands_assert_refused(&a, 1, "locked");
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	commands_find_programs();
	folder = g_dir_make_tmp("test-render-XXXXXX", NULL);
	oak = in_folder("oak");
	g_setenv("XDG_DATA_HOME", folder, TRUE);
	put_site("oak");
	put_model();
	g_test_add_func("/render-command/default", test_default);
	g_test_add_func("/render-command/styles", test_styles);
	g_test_add_func("/render-command/no-lines", test_no_lines);
	g_test_add_func("/render-command/thumbnails", test_thumbnails);
	g_test_add_func("/render-command/twice", test_twice);
	g_test_add_func("/render-command/json", test_json);
	g_test_add_func("/render-command/times", test_times);
	g_test_add_func("/render-command/path", test_path);
	g_test_add_func("/render-command/views", test_views);
	for (size_t i = 0; i < G_N_ELEMENTS(usages); i++)
		commands_add("/render-command/usage", i, &usages[i], test_usage);
	g_test_add_func("/render-command/no-model", test_no_model);
	g_test_add_func("/render-command/damaged", test_damaged);
	g_test_add_func("/render-command/empty", test_empty);
	g_test_add_func("/render-command/bad-styles", test_bad_styles);
	g_test_add_func("/render-command/bad-segments", test_bad_segments);
	g_test_add_func("/render-command/unwritable", test_unwritable);
	int status = g_test_run();
	files_remove_tree(folder, NULL);
	g_free(folder);
	g_free(oak);
	return status;
}
