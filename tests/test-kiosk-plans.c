/* Plans and sections on the touch screen: chosen, moved, scaled and kept, and left again. */
#include "process/model.h"
#include "render/view.h"
#include "tests/commands.h"
#include "tests/kiosk-rig.h"
#include "tests/scene-made.h"

static const double limit_s = 60;

static void put_site(const char *oak)
{
	g_autofree char *file = g_build_filename(oak, "site.json", NULL),
			*in = g_build_filename(oak, "model", NULL), *path = model_path(oak);
	g_auto(made) m = made_court();
	g_assert_cmpint(g_mkdir_with_parents(in, 0755), ==, 0);
	g_assert_true(g_file_set_contents(file,
		"{\"schema\":1,\"name\":\"oak\",\"id\":\"6f1f6c8e-1b1e-4c3a-9d55-0c9a3b0a7a11\","
		"\"created\":\"2026-11-23T10:00:00Z\",\"units\":\"metres\"}",
		-1, NULL));
	made_write_to(&m, path);
}

/* The one view that was kept; its file is gone then. Caller frees. */
static view *kept(rig *r, const char *oak)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(site) s = site_open(oak, &error);
	g_assert_no_error(error);
	rig_tap(r, "draw-keep-view");
	g_autoptr(GPtrArray) names = NULL;
	for (int n = 0; n < 600 && !(names && names->len); n++) {
		g_usleep(100000);
		g_clear_pointer(&names, g_ptr_array_unref);
		names = view_names(s, NULL);
	}
	g_assert_cmpuint(names->len, ==, 1);
	view *v = view_load(s, g_ptr_array_index(names, 0), &error);
	g_assert_no_error(error);
	g_assert_true(view_remove(s, g_ptr_array_index(names, 0), NULL));
	return v;
}

static void choose(rig *r, const char *name)
{
	g_autofree char *button = g_strconcat("draw-plan-", name, NULL);
	rig_tap(r, "draw-plan");
	rig_wait_for(r, button, limit_s);
	rig_keep_shot(r, "plans-sheet");
	rig_tap(r, button);
	rig_wait_gone(r, button, limit_s);
	g_usleep(2 * G_USEC_PER_SEC); /* on the way there */
}

static void plans(void)
{
	g_autofree char *program = commands_program("pleinair-kiosk"),
			*folder = g_dir_make_tmp("kiosk-plans-XXXXXX", NULL),
			*oak = g_build_filename(folder, "oak", NULL);
	put_site(oak);
	const char *const arguments[] = { "--size", "1280x800", folder, NULL };
	g_autoptr(rig) r = rig_new(&(struct rig_desc){
		.program = program, .arguments = arguments, .width = 1280, .height = 800 });
	rig_tap(r, "site-oak");
	rig_tap(r, "site-draw");
	rig_wait_for(r, "draw-strip", limit_s);
	choose(r, "section-a");
	rig_keep_shot(r, "plans-section");
	g_autoptr(view) section = kept(r, oak);
	g_assert_true(view_is_parallel(section) && section->is_cut);
	/* A finger moves it by what it went; two make it twice as large. */
	struct rig_place p = rig_wait_for(r, "draw-canvas", limit_s);
	double x = p.x + p.width / 2, y = p.y + p.height / 2;
	rig_drag(r, x, y, x + 120, y, 0.4);
	g_autoptr(view) moved = kept(r, oak);
	g_assert_cmpfloat(
		hypot(moved->eye_m[0] - section->eye_m[0], moved->eye_m[1] - section->eye_m[1]), >,
		0.05 * section->height_m);
	g_assert_cmpfloat_with_epsilon(
		moved->eye_m[2], section->eye_m[2], 0.02 * section->height_m);
	g_assert_cmpfloat_with_epsilon(moved->height_m, section->height_m, 1e-9);
	rig_pinch(r, x, y, 100, 200, 0.4);
	g_autoptr(view) large = kept(r, oak);
	g_assert_cmpfloat_with_epsilon(section->height_m / large->height_m, 2, 0.2);
	choose(r, "plan:1.2");
	rig_keep_shot(r, "plans-plan");
	g_autoptr(view) plan = kept(r, oak);
	g_assert_true(plan->is_cut && plan->target_m[2] < plan->eye_m[2]);
	rig_tap(r, "draw-overview");
	g_usleep(2 * G_USEC_PER_SEC);
	g_autoptr(view) overview = kept(r, oak);
	g_assert_false(view_is_parallel(overview));
	g_clear_pointer(&r, rig_free);
	commands_shell("rm -rf '%s'", folder);
}

int main(int argc, char **argv)
{
	if (!rig_tests_begin(&argc, &argv))
		return 0;
	g_test_add_func("/kiosk-plans/chosen", plans);
	return g_test_run();
}
