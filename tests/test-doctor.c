/* pleinair doctor as people type it: on machines that lack something. */
#include "tests/commands.h"
#include "tests/simulated.h"

static char *folder;

/* The first finding of that subject whose sentence has the words; asserts that there is one. */
static JsonObject *finding(JsonNode *root, const char *subject, const char *words)
{
	JsonArray *all = json_node_get_array(root);
	for (guint i = 0; i < json_array_get_length(all); i++) {
		JsonObject *o = json_array_get_object_element(all, i);
		if (g_str_equal(json_object_get_string_member(o, "subject"), subject) &&
			strstr(json_object_get_string_member(o, "sentence"), words))
			return o;
	}
	g_error("no finding about '%s' says '%s'", subject, words);
}

static void assert_state(JsonNode *root, const char *subject, const char *words, const char *state)
{
	JsonObject *o = finding(root, subject, words);
	g_assert_cmpstr(json_object_get_string_member(o, "state"), ==, state);
	/* What is bad can be mended, and the line says how. */
	if (g_str_equal(state, "bad"))
		g_assert_true(*json_object_get_string_member(o, "advice"));
}

static void test_good(void)
{
	g_auto(answer) a =
		commands_run("doctor", "--json", "--device", "sim:" COMMANDS_SCENE, folder);
	commands_assert_done(&a);
	g_autoptr(JsonNode) root = json_from_string(a.out, NULL);
	assert_state(root, "head", "answers", "good");
	assert_state(root, "space", "fine scans", "good");
	assert_state(root, "space", "can be written", "good");
	assert_state(root, "kernel", "Linux", "good");
	finding(root, "clock", "the clock says");
	finding(root, "clock", "wakes");
	/* It leaves nothing behind. */
	g_autoptr(GDir) dir = g_dir_open(folder, 0, NULL);
	g_assert_null(g_dir_read_name(dir));
}

static void test_no_device(void)
{
	g_auto(answer) a =
		commands_run("doctor", "--json", "--device", "scip:/dev/pleinair-none", folder);
	g_assert_cmpint(a.status, ==, 1);
	g_autoptr(JsonNode) root = json_from_string(a.out, NULL);
	assert_state(root, "head", "/dev/pleinair-none does not exist", "bad");
	/* One that is looked at only is not talked to. */
	g_auto(answer) b =
		commands_run("doctor", "--look", "--device", "scip:/dev/pleinair-none", folder);
	g_assert_cmpint(b.status, ==, 0);
	g_assert_null(strstr(b.out, "does not exist"));
	g_assert_nonnull(strstr(b.out, "nothing is bad"));
}

static void test_no_rights(void)
{
	g_autofree char *closed = g_build_filename(folder, "closed", NULL);
	if (geteuid() != 0) {
		g_test_skip("needs root, to run a command without its rights");
		return;
	}
	g_assert_cmpint(g_mkdir(closed, 0700), ==, 0);
	g_assert_cmpint(g_chmod(folder, 0755), ==, 0);
	const struct surroundings nobody = { .nobody = true };
	g_auto(answer) a = commands_run_in(
		&nobody, (const char *const[]){ "doctor", "--json", "--look", closed, NULL });
	g_assert_cmpint(a.status, ==, 1);
	g_autoptr(JsonNode) root = json_from_string(a.out, NULL);
	assert_state(root, "space", "cannot be written", "bad");
	assert_state(root, "rights", "real-time priority", "note");
	g_rmdir(closed);
}

static void test_no_space(void)
{
	const struct surroundings tight = { .file_bytes_max = 65536 };
	g_auto(answer) a = commands_run_in(
		&tight, (const char *const[]){ "doctor", "--json", "--look", folder, NULL });
	g_auto(answer) b = commands_run("doctor", "--json", "--look", "/pleinair/none");
	g_assert_cmpint(a.status, ==, 1);
	g_autoptr(JsonNode) full = json_from_string(a.out, NULL),
			    none = json_from_string(b.out, NULL);
	assert_state(full, "space", "cannot be written", "bad");
	g_assert_cmpint(b.status, ==, 1);
	assert_state(none, "space", "cannot be looked at", "bad");
}

static JsonNode *look_with(const char *conf)
{
	g_autofree char *path = g_build_filename(folder, "conf", NULL);
	g_assert_true(g_file_set_contents(path, conf, -1, NULL));
	g_setenv("PLEINAIR_CONF", path, TRUE);
	g_auto(answer) a = commands_run("doctor", "--json", folder);
	g_unsetenv("PLEINAIR_CONF");
	g_unlink(path);
	g_assert_cmpint(a.status, ==, 1);
	return json_from_string(a.out, NULL);
}

static void test_configuration(void)
{
	g_autoptr(JsonNode) misspelt = look_with("[stage]\nestpo=4\n"),
			    absent = look_with("[head]\ndevice=ld:/dev/pleinair-none\n");
	assert_state(misspelt, "configuration", "no key 'estpo' in [stage]", "bad");
	/* The head that it names is the one that is talked to. */
	assert_state(absent, "head", "/dev/pleinair-none does not exist", "bad");
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	folder = simulated_folder();
	g_test_add_func("/doctor/good", test_good);
	g_test_add_func("/doctor/no-device", test_no_device);
	g_test_add_func("/doctor/no-rights", test_no_rights);
	g_test_add_func("/doctor/no-space", test_no_space);
	g_test_add_func("/doctor/configuration", test_configuration);
	return g_test_run();
}
