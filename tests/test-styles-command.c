/* pleinair styles as people type it. */
#include "firmware-io/files.h"
#include "tests/commands.h"
#include "tests/simulated.h"

static char *folder;

static char *put(const char *name, const char *text)
{
	char *path = g_build_filename(folder, name, NULL);
	g_autofree char *in = g_path_get_dirname(path);
	g_assert_cmpint(g_mkdir_with_parents(in, 0700), ==, 0);
	g_assert_true(g_file_set_contents(path, text, -1, NULL));
	return path;
}

static void put_site(void)
{
	g_autofree char *oak = put("oak/site.json",
		"{\"schema\":1,\"name\":\"Oak\",\"id\":\"6f1f6c8e-1b1e-4c3a-9d55-0c9a3b0a7a11\","
		"\"created\":\"2026-11-23T10:00:00Z\",\"units\":\"metres\"}");
	g_autofree char *mine = put("oak/styles/mine.json",
		"{\"schema\":1,\"title\":\"Kr\\u00e4ftig\",\"base\":\"figure-7b\"}");
}

/* Title of a style of the answer, an array; NULL: it is not there. */
static const char *title_in(JsonNode *root, const char *name)
{
	g_assert_true(JSON_NODE_HOLDS_ARRAY(root));
	JsonArray *list = json_node_get_array(root);
	for (guint i = 0; i < json_array_get_length(list); i++) {
		JsonObject *o = json_array_get_object_element(list, i);
		g_assert_true(*json_object_get_string_member(o, "source"));
		if (g_str_equal(json_object_get_string_member(o, "name"), name))
			return json_object_get_string_member(o, "title");
	}
	return NULL;
}

static void test_json(void)
{
	g_autofree char *oak = g_build_filename(folder, "oak", NULL);
	g_auto(answer) a = commands_run("styles", "--json"),
		       b = commands_run("styles", "--json", oak);
	commands_assert_done(&a);
	commands_assert_done(&b);
	g_autoptr(JsonNode) all = json_from_string(a.out, NULL),
			    ours = json_from_string(b.out, NULL);
	g_assert_cmpstr(title_in(all, "figure-1-stipple"), ==, "Stippling");
	g_assert_null(title_in(all, "mine"));
	g_assert_cmpstr(title_in(ours, "mine"), ==,
		"Kr\xc3\xa4"
		"ftig");
	g_assert_cmpstr(title_in(ours, "points"), ==, "Coloured points");
}

static void test_list(void)
{
	g_autofree char *oak = g_build_filename(folder, "oak", NULL);
	g_auto(answer) a = commands_run("styles", oak);
	commands_assert_done(&a);
	g_assert_cmpstr(a.err, ==, "");
	g_assert_nonnull(strstr(a.out, "figure-7b  "));
	g_assert_nonnull(strstr(a.out, "Xu & Chen 2004, Figure 7(b)\n"));
	g_assert_nonnull(strstr(a.out, "\nmine  "));
}

/* One that is wrong is told, the others are listed. */
static void test_wrong(void)
{
	g_autofree char *oak = g_build_filename(folder, "oak", NULL),
			*path = put("oak/styles/broken.json", "{\"schema\":1,\n\"titel\":\"x\"}");
	g_auto(answer) a = commands_run("styles", oak), b = commands_run("styles", "--check", path),
		       c = commands_run("styles", "--json", oak);
	g_unlink(path);
	g_autofree char *message = g_strdup_printf("pleinair styles: %s line 2: titel: a style has "
						   "no such field; did you mean 'title'?\n",
		path);
	g_assert_cmpint(a.status, ==, 1);
	g_assert_cmpstr(a.err, ==, message);
	g_assert_nonnull(strstr(a.out, "mine"));
	g_assert_cmpint(b.status, ==, 1);
	g_assert_cmpstr(b.err, ==, message);
	g_assert_cmpstr(b.out, ==, "");
	g_assert_cmpint(c.status, ==, 1);
	g_autoptr(JsonNode) list = json_from_string(c.out, NULL);
	g_assert_nonnull(title_in(list, "mine"));
}

static void test_check(void)
{
	g_autofree char *mine = g_build_filename(folder, "oak", "styles", "mine.json", NULL),
			*none = g_build_filename(folder, "none.json", NULL);
	g_auto(answer) a = commands_run("styles", "--check", mine, mine),
		       b = commands_run("styles", "--check", none, mine);
	commands_assert_done(&a);
	g_assert_cmpstr(a.out, ==, "");
	commands_assert_refused(&b, 1, "none.json");
}

static void test_check_sweeps(void)
{
	g_auto(answer)
		a = commands_run("styles", "--check", "--sweep", "pencil:hatching.length_px=6,12",
			"--sweep", "figure-7a"),
		b = commands_run("styles", "--check", "--sweep", "pencil:hatching.lenth_px=6,12"),
		c = commands_run("styles", "--check", "--sweep", "a,b:view=x,y,z");
	commands_assert_done(&a);
	g_assert_cmpstr(a.out, ==, "");
	commands_assert_refused(&b, 1, "lenth_px");
	commands_assert_refused(&c, 2, "another has 3");
}

/* What make gallery would draw, which takes minutes. */
static void test_gallery(void)
{
	const char *source = g_getenv("PLEINAIR_SOURCE");
	g_autofree char *script = g_build_filename(
				source ? source : ".", "tests", "gallery.sh", NULL),
			*into = g_build_filename(folder, "gallery", NULL), *out = NULL, *err = NULL;
	const char *const command[] = { "sh", script, g_getenv("PLEINAIR_BIN"), "court", into,
		"check", NULL };
	g_autoptr(GError) error = NULL;
	int status;
	g_spawn_sync(NULL, (char **)command, NULL, G_SPAWN_SEARCH_PATH, NULL, NULL, &out, &err,
		&status, &error);
	g_assert_no_error(error);
	g_assert_cmpstr(err, ==, "");
	g_assert_cmpint(status, ==, 0);
}

static void test_made_of(void)
{
	g_auto(answer) a = commands_run("styles", "--steps"),
		       b = commands_run("styles", "--schema");
	commands_assert_done(&a);
	commands_assert_done(&b);
	g_assert_nonnull(strstr(a.out, "\nstrokes (layer): strokes with a texture\n"));
	g_assert_nonnull(strstr(a.out, "1 to 400 px, else 30\n"));
	g_autoptr(JsonNode) schema = json_from_string(b.out, NULL);
	g_assert_true(JSON_NODE_HOLDS_OBJECT(schema));
}

static const struct usage {
	const char *arguments[6];
	int status;
	const char *names;
} usages[] = {
	{ { "styles", "--frob" }, 2, "--frob" },
	{ { "styles", "--check" }, 2, "which files" },
	{ { "styles", "--check", "a", "--sweep", "figure-7a" }, 2, "not both" },
	{ { "styles", "a", "b" }, 2, "'b'" },
	{ { "styles", "--steps", "a" }, 2, "'a'" },
	{ { "styles", "--steps", "--json" }, 2, "one at a time" },
	{ { "styles", "no/site" }, 1, "no/site" },
};

static void test_usage(gconstpointer data)
{
	const struct usage *u = data;
	g_auto(answer) a = commands_run_in(NULL, u->arguments);
	commands_assert_refused(&a, u->status, u->names);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	commands_find_programs();
	folder = simulated_folder();
	g_setenv("XDG_DATA_HOME", folder, TRUE);
	put_site();
	g_test_add_func("/styles-command/json", test_json);
	g_test_add_func("/styles-command/list", test_list);
	g_test_add_func("/styles-command/wrong", test_wrong);
	g_test_add_func("/styles-command/check", test_check);
	g_test_add_func("/styles-command/check-sweeps", test_check_sweeps);
	g_test_add_func("/styles-command/gallery", test_gallery);
	g_test_add_func("/styles-command/made-of", test_made_of);
	for (size_t i = 0; i < G_N_ELEMENTS(usages); i++)
		commands_add("/styles-command/usage", i, &usages[i], test_usage);
	int status = g_test_run();
	files_remove_tree(folder, NULL);
	g_free(folder);
	return status;
}
