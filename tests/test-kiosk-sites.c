/* Sites as a whole, by touch: another name, away with one, and both taken back. */
#include "acquire/site.h"
#include "tests/commands.h"
#include "tests/kiosk-rig.h"
#include "tests/simulated.h"

static const double limit_s = 60;

static char *made_site(const char *folder, const char *name)
{
	g_autoptr(GError) error = NULL;
	char *path = g_build_filename(folder, name, NULL);
	site_free(site_open_for_writing(path, &error));
	g_assert_no_error(error);
	return path;
}

static void rename_and_remove(void)
{
	g_autofree char *program = commands_program("pleinair-kiosk"), *folder = simulated_folder();
	g_autofree char *oak = made_site(folder, "oak"), *elm = made_site(folder, "elm");
	const char *const arguments[] = { "--size", "1280x800", folder, NULL };
	g_autoptr(rig) r = rig_new(&(struct rig_desc){
		.program = program, .arguments = arguments, .width = 1280, .height = 800 });
	rig_wait_for(r, "site-elm", limit_s);
	rig_tap(r, "manage-oak");
	rig_wait_for(r, "site-remove", limit_s);
	rig_keep_shot(r, "sites-manage");
	rig_tap(r, "site-rename");
	rig_wait_for(r, "rename-site-name", limit_s);
	rig_type(r, "\b");
	rig_type(r, "Ash");
	rig_keep_shot(r, "sites-rename");
	rig_tap(r, "rename-site-yes");
	rig_wait_for(r, "site-Ash", limit_s);
	rig_wait_gone(r, "site-oak", limit_s);
	rig_tap(r, "undo");
	rig_wait_for(r, "site-oak", limit_s);
	rig_tap(r, "manage-oak");
	rig_tap(r, "site-remove");
	rig_wait_gone(r, "site-oak", limit_s);
	rig_keep_shot(r, "sites-removed");
	g_assert_false(g_file_test(oak, G_FILE_TEST_EXISTS));
	g_assert_true(g_file_test(elm, G_FILE_TEST_IS_DIR));
	rig_tap(r, "undo");
	rig_wait_for(r, "site-oak", limit_s);
	g_assert_true(g_file_test(oak, G_FILE_TEST_IS_DIR));
	/* It opens as before. */
	rig_tap(r, "site-oak");
	rig_wait_for(r, "scan-start", limit_s);
}

/* Somebody writes into it. */
static void refused(void)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *program = commands_program("pleinair-kiosk"), *folder = simulated_folder();
	g_autofree char *oak = made_site(folder, "oak");
	const char *const arguments[] = { "--size", "1280x800", folder, NULL };
	g_autoptr(rig) r = rig_new(&(struct rig_desc){
		.program = program, .arguments = arguments, .width = 1280, .height = 800 });
	g_autoptr(site) writer = site_open_for_writing(oak, &error);
	g_assert_no_error(error);
	rig_tap(r, "manage-oak");
	rig_tap(r, "site-remove");
	rig_wait_for(r, "toast-text", limit_s);
	g_autofree char *said = rig_text(r, "toast-text");
	g_assert_nonnull(strstr(said, "another program is writing to it"));
	g_assert_true(g_file_test(oak, G_FILE_TEST_IS_DIR));
}

int main(int argc, char **argv)
{
	if (!rig_tests_begin(&argc, &argv))
		return 0;
	g_test_add_func("/kiosk-sites/rename-and-remove", rename_and_remove);
	g_test_add_func("/kiosk-sites/refused", refused);
	return g_test_run();
}
