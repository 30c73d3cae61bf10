/* pleinair copy: what arrives is what was there, a cut-off copy goes on, and what others put there stays. */
#include "tests/commands.h"
#include "tests/simulated.h"

static char *oak;

static void check_sums(const char *copy)
{
	commands_shell("cd '%s' && sha256sum --quiet --strict -c SHA256SUMS", copy);
}

static int64_t number(const answer *a, const char *key)
{
	g_autoptr(JsonNode) n = commands_json(a);
	return json_object_get_int_member(json_node_get_object(n), key);
}

static answer copy_to(const char *to, const char *what)
{
	return commands_run("copy", oak, "--to", to, "--what", what, "--json");
}

static void whole_site(void)
{
	g_autofree char *to = simulated_folder(), *copy = g_build_filename(to, "oak", NULL);
	g_auto(answer) first = copy_to(to, "site");
	commands_assert_done(&first);
	check_sums(copy);
	commands_shell("rm '%s/SHA256SUMS' && diff -r '%s' '%s'", copy, oak, copy);
	g_assert_cmpint(number(&first, "files"), ==, number(&first, "written"));
	/* Without the list the same files are known by their content. */
	g_auto(answer) again = copy_to(to, "site");
	commands_assert_done(&again);
	g_assert_cmpint(number(&again, "written"), ==, 0);
	g_assert_cmpint(number(&again, "files"), ==, number(&first, "files"));
	check_sums(copy);
}

static void parts(void)
{
	g_autofree char *to = simulated_folder(), *copy = g_build_filename(to, "oak", NULL);
	g_auto(answer) exports = copy_to(to, "exports");
	commands_assert_done(&exports);
	g_autofree char *names = commands_names(copy);
	g_assert_cmpstr(names, ==, "SHA256SUMS exports/ exports/a.png exports/notes.txt");
	g_auto(answer) pictures = copy_to(to, "pictures");
	commands_assert_done(&pictures);
	g_assert_cmpint(number(&pictures, "files"), ==, 1);
	g_auto(answer) scans = copy_to(to, "scans");
	commands_assert_done(&scans);
	check_sums(copy);
	/* A copy of the scans is a site. */
	g_auto(answer) known = commands_run("process", copy, "--dry-run", "--json");
	commands_assert_done(&known);
}

/* Ours is replaced, that of others is not. */
static void changed_files(void)
{
	g_autofree char *to = simulated_folder(), *copy = g_build_filename(to, "oak", NULL);
	g_autofree char *note = g_build_filename(oak, "exports", "notes.txt", NULL);
	g_autofree char *there = g_build_filename(copy, "exports", "notes.txt", NULL);
	g_autofree char *text = NULL;
	g_auto(answer) first = copy_to(to, "exports");
	commands_assert_done(&first);
	g_assert_true(g_file_set_contents(note, "new", -1, NULL));
	g_auto(answer) second = copy_to(to, "exports");
	commands_assert_done(&second);
	g_assert_cmpint(number(&second, "written"), ==, 1);
	check_sums(copy);
	g_assert_true(g_file_set_contents(there, "somebody's", -1, NULL));
	g_auto(answer) third = copy_to(to, "exports");
	commands_assert_refused(&third, 1, "other content");
	g_assert_true(g_file_get_contents(there, &text, NULL, NULL));
	g_assert_cmpstr(text, ==, "somebody's");
}

/* A drive that takes no more: nothing half, and the next one goes on. */
static void cut_off(void)
{
	g_autofree char *to = simulated_folder(), *copy = g_build_filename(to, "oak", NULL);
	g_autofree char *half = NULL;
	struct surroundings small = { .file_bytes_max = 20000 };
	g_auto(answer) first = commands_run_in(
		&small, (const char *const[]){ "copy", oak, "--to", to, "--json", NULL });
	commands_assert_refused(&first, 1, "written");
	half = commands_names(copy);
	g_assert_null(strstr(half, ".part"));
	g_auto(answer) second = copy_to(to, "site");
	commands_assert_done(&second);
	g_assert_cmpint(number(&second, "written"), <, number(&second, "files"));
	check_sums(copy);
}

static void refusals(void)
{
	g_autofree char *inside = g_build_filename(oak, "exports", NULL);
	g_autofree char *nowhere = g_build_filename(oak, "..", "nowhere", NULL);
	g_autofree char *linked = simulated_folder();
	g_autofree char *part = g_build_filename(linked, "oak", NULL);
	g_auto(answer) into_itself = copy_to(inside, "site");
	commands_assert_refused(&into_itself, 1, "in the site itself");
	g_auto(answer) no_drive = copy_to(nowhere, "site");
	commands_assert_refused(&no_drive, 1, "plugged in");
	g_auto(answer) no_site = commands_run("copy", linked, "--to", linked);
	commands_assert_refused(&no_site, 1, linked);
	g_auto(answer) what = copy_to(linked, "dreams");
	commands_assert_refused(&what, 2, NULL);
	g_assert_false(g_file_test(part, G_FILE_TEST_EXISTS));
}

/* What a link in the site leads to is no part of it. */
static void links_stay_behind(void)
{
	g_autofree char *to = simulated_folder(), *copy = g_build_filename(to, "oak", NULL);
	g_autofree char *link = g_build_filename(oak, "exports", "passwd.png", NULL);
	g_assert_cmpint(symlink("/etc/passwd", link), ==, 0);
	g_auto(answer) a = copy_to(to, "exports");
	g_assert_cmpint(unlink(link), ==, 0);
	commands_assert_done(&a);
	g_autofree char *names = commands_names(copy);
	g_assert_null(strstr(names, "passwd"));
}

static void assert_empty(const char *folder)
{
	g_autofree char *names = commands_names(folder);
	g_assert_cmpstr(names, ==, "");
}

/* A drive is whoever's: nothing on it leads the copy elsewhere. */
static void drives_lead_nowhere(void)
{
	static const char *const at[] = { "oak", "oak/exports" };
	for (size_t i = 0; i < G_N_ELEMENTS(at); i++) {
		g_autofree char *to = simulated_folder(), *outside = simulated_folder();
		g_autofree char *link = g_build_filename(to, at[i], NULL);
		g_autofree char *in = g_path_get_dirname(link);
		g_assert_cmpint(g_mkdir_with_parents(in, 0755), ==, 0);
		g_assert_cmpint(symlink(outside, link), ==, 0);
		g_auto(answer) a = copy_to(to, "exports");
		commands_assert_refused(&a, 1, "may lead out of the drive");
		assert_empty(outside);
	}
	/* Files that are links are replaced, and what they lead to stays. */
	g_autofree char *to = simulated_folder(), *outside = simulated_folder();
	g_autofree char *aim = g_build_filename(outside, "aim", NULL);
	g_autofree char *link = g_build_filename(to, "oak", "SHA256SUMS", NULL);
	g_autofree char *in = g_path_get_dirname(link), *text = NULL;
	g_assert_cmpint(g_mkdir_with_parents(in, 0755), ==, 0);
	g_assert_true(g_file_set_contents(aim, "kept", -1, NULL));
	g_assert_cmpint(symlink(aim, link), ==, 0);
	g_auto(answer) a = copy_to(to, "exports");
	commands_assert_done(&a);
	g_assert_true(g_file_get_contents(aim, &text, NULL, NULL));
	g_assert_cmpstr(text, ==, "kept");
	check_sums(in);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	commands_find_programs();
	g_autofree char *folder = simulated_folder();
	oak = g_build_filename(folder, "oak", NULL);
	simulated_draft(oak, COMMANDS_SCENE);
	commands_shell(
		"mkdir '%s/exports' && cd '%s/exports' && echo picture > a.png && echo note > "
		"notes.txt",
		oak, oak);
	g_test_add_func("/copy/whole-site", whole_site);
	g_test_add_func("/copy/parts", parts);
	g_test_add_func("/copy/changed-files", changed_files);
	g_test_add_func("/copy/cut-off", cut_off);
	g_test_add_func("/copy/refusals", refusals);
	g_test_add_func("/copy/links-stay-behind", links_stay_behind);
	g_test_add_func("/copy/drives-lead-nowhere", drives_lead_nowhere);
	int status = g_test_run();
	g_free(oak);
	return status;
}
