/* How a large site keeps up with a finger: $PLEINAIR_BIG_SITE is a folder of sites with one of that size, as the demo's. Figures are
 * told, not judged: what a machine is busy with besides is no error of the program. */
#include "tests/commands.h"
#include "tests/kiosk-rig.h"
#include "tests/simulated.h"

static const double limit_s = 120;

static char *first_site(rig *r)
{
	rig_wait_for(r, "card-name", limit_s);
	g_autofree char *name = rig_text(r, "card-name");
	return g_strconcat("site-", name, NULL);
}

static void measure(rig *r, const char *style_name)
{
	g_autofree char *button = g_strconcat("style-", style_name, NULL);
	struct rig_place p;
	rig_tap(r, button);
	/* Till it stands still, and small pictures are drawn. */
	g_usleep(12 * G_USEC_PER_SEC);
	p = rig_wait_for(r, "draw-canvas", limit_s);
	double x = p.x + p.width / 2, y = p.y + p.height / 2;
	guint64 before = rig_frames(r);
	int64_t since_us = g_get_monotonic_time();
	rig_drag(r, x - 300, y, x + 300, y + 40, 5);
	double seconds = (double)(g_get_monotonic_time() - since_us) * 1e-6;
	double painted = (double)(rig_frames(r) - before) / seconds;
	g_autofree char *pace = rig_state(r, "pace");
	g_auto(GStrv) words = g_strsplit(pace ? pace : "0 1 0 0", " ", -1);
	g_test_message(
		"%s: %.1f pictures a second of %s px width, %.1f frames painted a second, the "
		"latest %.0f ms after its touch",
		style_name, g_ascii_strtod(words[0], NULL) / g_ascii_strtod(words[1], NULL),
		words[3], painted, 1000 * g_ascii_strtod(words[2], NULL));
}

/* Again and again, as a program that crashed is started. */
static void opens(void)
{
	g_autofree char *program = commands_program("pleinair-kiosk");
	g_autofree char *folder = simulated_folder();
	const char *const arguments[] = { "--size", "1280x800", folder, NULL };
	g_autoptr(rig) r = rig_new(&(struct rig_desc){
		.program = program, .arguments = arguments, .width = 1280, .height = 800 });
	for (int i = 0; i < 5; i++) {
		rig_kill(r);
		int64_t since_us = g_get_monotonic_time();
		rig_start(r);
		g_autofree char *first = NULL;
		while (!(first = rig_state(r, "first-frame")))
			g_usleep(10000);
		int64_t after_us = g_ascii_strtoll(first, NULL, 10) - since_us;
		g_assert_cmpint(after_us, >, 0);
		g_test_message("first frame after %.2f s", (double)after_us * 1e-6);
	}
}

static void keeps_up(void)
{
	const char *folder = g_getenv("PLEINAIR_BIG_SITE");
	static const char *const names[] = { "figure-7a", "figure-7c", "eye-dome",
		"figure-1-strokes-hatching" };
	g_autofree char *program = commands_program("pleinair-kiosk");
	if (!folder) {
		g_test_skip("PLEINAIR_BIG_SITE names no folder of sites");
		return;
	}
	const char *const arguments[] = { "--size", "1280x800", folder, NULL };
	g_autoptr(rig) r = rig_new(&(struct rig_desc){
		.program = program, .arguments = arguments, .width = 1280, .height = 800 });
	g_autofree char *card = first_site(r);
	rig_tap(r, card);
	rig_tap(r, "site-draw");
	rig_wait_for(r, "draw-strip", limit_s);
	g_usleep(5 * G_USEC_PER_SEC);
	for (size_t i = 0; i < G_N_ELEMENTS(names); i++)
		measure(r, names[i]);
}

int main(int argc, char **argv)
{
	if (!rig_tests_begin(&argc, &argv))
		return 0;
	g_test_add_func("/kiosk-speed/opens", opens);
	g_test_add_func("/kiosk-speed/keeps-up", keeps_up);
	return g_test_run();
}
