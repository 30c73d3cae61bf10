/* The whole way by touch, against the simulated scanner: a new site, two scans, their alignment, the drawing, a style, a thing drawn in its
 * own way, and what is taken home. $PLEINAIR_SHOTS: a folder for pictures of the screens on the way. */
#include "tests/commands.h"
#include "tests/kiosk-rig.h"
#include "tests/simulated.h"

static const double limit_s = 120;

struct walk {
	rig *rig;
	int width, height;
	guint shots;
};

static void shot(struct walk *w, const char *name)
{
	const char *folder = g_getenv("PLEINAIR_SHOTS");
	if (!folder)
		return;
	g_mkdir_with_parents(folder, 0755);
	g_autofree char *path = g_strdup_printf(
		"%s/%dx%d-%02u-%s.png", folder, w->width, w->height, w->shots++, name);
	rig_shot(w->rig, path);
}

static void walk_begin(struct walk *w, int width, int height, const char *device)
{
	g_autofree char *program = commands_program("pleinair-kiosk");
	g_autofree char *size = g_strdup_printf("%dx%d", width, height);
	const char *const arguments[] = { "--device", device, "--size", size, NULL };
	*w = (struct walk){ .width = width, .height = height };
	w->rig = rig_new(&(struct rig_desc){
		.program = program, .arguments = arguments, .width = width, .height = height });
}

static void make_site(struct walk *w)
{
	shot(w, "sites-none");
	rig_tap(w->rig, "new-site");
	rig_wait_for(w->rig, "new-site-name", limit_s);
	shot(w, "new-site");
	rig_tap(w->rig, "new-site-create");
	rig_wait_for(w->rig, "scan-start", limit_s);
	shot(w, "site-empty");
}

static void scan(struct walk *w, const char *name)
{
	rig_tap(w->rig, "preset-draft");
	rig_tap(w->rig, "scan-start");
	rig_wait_for(w->rig, "scan-panorama", limit_s);
	g_usleep(1500000);
	shot(w, name);
	rig_wait_gone(w->rig, "scan-panorama", limit_s);
}

static void whole_way(struct walk *w)
{
	make_site(w);
	scan(w, "scanning");
	shot(w, "site-one");
	g_autofree char *list = rig_list(w->rig);
	g_test_message("%s", list);
	scan(w, "scanning-again");
	shot(w, "site-two");
	rig_wait_for(w->rig, "site-draw", limit_s);
	rig_wait_gone(w->rig, "work-bar", limit_s);
	shot(w, "site-done");
	rig_tap(w->rig, "site-draw");
	rig_wait_for(w->rig, "draw-strip", limit_s);
	g_usleep(3000000);
	shot(w, "draw");
	g_autofree char *list2 = rig_list(w->rig);
	g_test_message("%s", list2);
}

static void small_screen(void)
{
	struct walk w;
	walk_begin(&w, 1280, 800, "sim:" COMMANDS_SCENE "&station=%n");
	whole_way(&w);
	rig_free(w.rig);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	commands_find_programs();
	const char *missing = rig_missing();
	if (missing) {
		g_print("1..0 # SKIP %s\n", missing);
		return 0;
	}
	g_test_add_func("/kiosk-workflow/1280x800", small_screen);
	return g_test_run();
}
