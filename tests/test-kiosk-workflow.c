/* The whole way by touch, against the simulated scanner: a new site, two scans, their alignment, the drawing, a style, a thing drawn in its
 * own way, and what is taken home. $PLEINAIR_SHOTS: a folder for pictures of the screens on the way. */
#include "acquire/scan.h"
#include "process/scan-data.h"
#include "process/scan-graph.h"
#include "tests/commands.h"
#include "tests/kiosk-rig.h"
#include "tests/simulated.h"
#include <math.h>

/* A draft of it takes some seconds, so that its screen is seen. */
#define SCENE "hall?seed=3&ares=1584&camera=180x320&divergence_mrad=0"

#define COURT "court?seed=7&camera=180x320&station=%d"

static const double limit_s = 120;

struct walk {
	rig *rig;
	int width, height;
	const char *part; /* of the names of its pictures */
	guint shots;
	const char *scene; /* with %d for the station */
	char *folder;      /* of sites */
	char *drives;      /* with one drive, STICK */
	const char *thing; /* what is tapped in the drawing, in small letters */
};

static void shot(struct walk *w, const char *name)
{
	g_autofree char *whole =
		g_strdup_printf("%dx%d-%s%02u-%s", w->width, w->height, w->part, w->shots++, name);
	rig_keep_shot(w->rig, whole);
}

static void walk_begin(struct walk *w, int width, int height, const char *scene)
{
	g_autofree char *program = commands_program("pleinair-kiosk");
	g_autofree char *size = g_strdup_printf("%dx%d", width, height);
	g_auto(GStrv) parts = g_strsplit(scene, "%d", -1);
	g_autofree char *description = g_strjoinv("%n", parts);
	g_autofree char *device = g_strconcat("sim:", description, NULL);
	*w = (struct walk){ .part = "",
		.width = width,
		.height = height,
		.scene = scene,
		.folder = simulated_folder(),
		.drives = simulated_folder() };
	g_autofree char *drive = g_build_filename(w->drives, "STICK", NULL);
	g_mkdir(drive, 0755);
	const char *const arguments[] = { "--device", device, "--size", size, "--drives", w->drives,
		w->folder, NULL };
	w->rig = rig_new(&(struct rig_desc){
		.program = program, .arguments = arguments, .width = width, .height = height });
}

/* Something was done that can be undone. */
static void wait_undo(struct walk *w)
{
	struct rig_place p = { 0 };
	for (int i = 0; i < 600 && !(rig_find(w->rig, "undo", &p) && p.sensitive); i++)
		g_usleep(100000);
	g_assert_true(p.sensitive);
}

static void make_site(struct walk *w)
{
	shot(w, "sites-none");
	rig_tap(w->rig, "new-site");
	rig_wait_for(w->rig, "new-site-name", limit_s);
	shot(w, "new-site");
	rig_tap(w->rig, "new-site-yes");
	rig_wait_for(w->rig, "scan-start", limit_s);
	shot(w, "site-empty");
}

/* Its screen may come and go quickly: what counts is the folder. */
static void scan(struct walk *w, guint number, const char *name)
{
	g_autofree char *path = g_strdup_printf("%s/Site 1/scans/%04u", w->folder, number);
	bool shown = false;
	rig_tap(w->rig, "preset-draft");
	rig_tap(w->rig, "scan-start");
	for (int i = 0; i < 1200 && !g_file_test(path, G_FILE_TEST_IS_DIR); i++) {
		g_autofree char *screen = rig_state(w->rig, "screen");
		g_usleep(100000);
		if (shown || g_strcmp0(screen, "scan"))
			continue;
		g_usleep(G_USEC_PER_SEC);
		shot(w, name);
		shown = true;
	}
	g_assert_true(g_file_test(path, G_FILE_TEST_IS_DIR));
	rig_wait_gone(w->rig, "scan-panorama", limit_s);
}

/* ---- points that both scans see ---- */

#define PAIRS 4

struct cell {
	uint32_t column, row;
};

static scan_data *load_scan(struct walk *w, uint32_t number)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *path = g_build_filename(w->folder, "Site 1", NULL);
	g_autoptr(site) s = site_open(path, &error);
	g_assert_no_error(error);
	scan_data *d = scan_data_load(s, number, &error);
	g_assert_no_error(error);
	return d;
}

/* The cell of d that looks at a point of its frame, when it measured it there. */
static bool find_cell(const scan_data *d, const double point_m[3], struct cell *ret)
{
	const range_grid *g = d->grid;
	double range =
		sqrt(point_m[0] * point_m[0] + point_m[1] * point_m[1] + point_m[2] * point_m[2]);
	double azimuth = atan2(point_m[0], point_m[1]), up = asin(point_m[2] / range);
	double turn = azimuth - g->lattice.azimuth_min_rad;
	turn -= 2 * G_PI * floor(turn / (2 * G_PI));
	double row = (g->lattice.elevation_max_rad - up) / g->lattice.row_rad;
	ret->column = (uint32_t)(turn / g->lattice.column_rad) % g->columns;
	if (row < 0 || row >= g->rows)
		return false;
	ret->row = (uint32_t)row;
	return fabs(g->range_m[(size_t)ret->row * g->columns + ret->column] - range) < 0.05;
}

/* Cells that look the same way in truth, far from each other: one in each part of the turn. */
static void find_pairs(struct walk *w, struct cell a[PAIRS], struct cell b[PAIRS])
{
	g_autoptr(scan_data) first = load_scan(w, 1), second = load_scan(w, 2);
	g_autofree char *one = g_strdup_printf(w->scene, 1), *two = g_strdup_printf(w->scene, 2);
	struct pose pa = simulated_pose(one), pb = simulated_pose(two);
	struct pose to_a = pose_between(&pb, &pa);
	const range_grid *g = first->grid;
	guint found = 0;
	for (uint32_t part = 0; part < PAIRS; part++)
		for (uint32_t n = 0; n < 4000 && found == part; n++) {
			uint32_t c = g->columns * part / PAIRS + n % (g->columns / PAIRS),
				 r = g->rows / 4 + (part % 2) * g->rows / 5 +
				     n / (g->columns / PAIRS);
			size_t i = (size_t)r * g->columns + c;
			double p[3] = { g->x_m[i], g->y_m[i], g->z_m[i] }, q[3];
			pose_apply(&to_a, p, q);
			if (!(g->range_m[i] > 0) || !find_cell(second, q, &b[part]))
				continue;
			a[part] = (struct cell){ c, r };
			found++;
		}
	g_assert_cmpuint(found, ==, PAIRS);
}

/* The second scan stands where it does in truth, and not at the other end of the hall. */
static void check_pose(struct walk *w)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *path = g_build_filename(w->folder, "Site 1", NULL);
	g_autoptr(site) s = site_open(path, &error);
	g_assert_no_error(error);
	g_autoptr(scan_graph) g = scan_graph_load(s, &error);
	g_assert_no_error(error);
	g_autofree char *one = g_strdup_printf(w->scene, 1), *two = g_strdup_printf(w->scene, 2);
	struct pose pa = simulated_pose(one), pb = simulated_pose(two);
	struct pose wanted = pose_between(&pa, &pb);
	struct pose got = pose_between(&scan_graph_scan(g, 1)->pose, &scan_graph_scan(g, 2)->pose);
	struct pose off = pose_between(&wanted, &got);
	double mm = 1000 * pose_distance_m(&off), deg = pose_angle_rad(&off) * 180 / G_PI;
	g_test_message("scan 2 is %.1f mm and %.3f degrees from where it stands", mm, deg);
	g_assert_cmpfloat(mm, <, 30);
	g_assert_cmpfloat(deg, <, 0.3);
}

static void tap_cell(struct walk *w, const char *pane, struct cell cell)
{
	struct rig_place p = rig_wait_for(w->rig, pane, limit_s);
	double scale = p.width / 750;
	double x = p.width / 2 + (cell.column + 0.5 - 375) * scale;
	double y = p.height / 2 + (cell.row + 0.5 - 99) * scale;
	g_assert_true(x > 0 && x < p.width && y > 0 && y < p.height);
	rig_tap_at(w->rig, p.x + x, p.y + y);
}

static void fix_by_points(struct walk *w)
{
	struct cell a[PAIRS], b[PAIRS];
	find_pairs(w, a, b);
	rig_tap(w->rig, "site-align");
	rig_wait_text(w->rig, "align-verdict", "They fit in more than one way.", limit_s);
	shot(w, "align-refused");
	for (int i = 0; i < PAIRS; i++) {
		g_autofree char *row = g_strdup_printf("pick-%d", i + 1);
		tap_cell(w, "pane-a", a[i]);
		rig_wait_for(w->rig, row, limit_s);
		tap_cell(w, "pane-b", b[i]);
		rig_wait_for(w->rig, row, limit_s);
		g_usleep(300000);
	}
	shot(w, "align-picked");
	rig_tap(w->rig, "align-points");
	rig_wait_words(w->rig, "align-advice", "as your points say", limit_s);
	shot(w, "align-after");
	/* The hall is its own half turn: only a person can know. */
	rig_tap(w->rig, "align-vouch");
	rig_wait_for(w->rig, "sure", limit_s);
	shot(w, "align-vouch");
	rig_tap(w->rig, "sure");
	rig_wait_text(w->rig, "align-verdict", "You vouched that these two fit.", limit_s);
	shot(w, "align-vouched");
	rig_tap(w->rig, "back");
	rig_wait_words(w->rig, "site-words", "All 2 scans fit together", limit_s);
	check_pose(w);
}

/* ---- the drawing ---- */

/* Taps here and there, as people do, until it is the thing that is meant. */
static void select_thing(struct walk *w, const char *kind)
{
	struct rig_place p = rig_wait_for(w->rig, "draw-canvas", limit_s), panel;
	for (int i = 0; i < 60; i++) {
		double x = p.x + p.width * (0.19 + 0.06 * (i % 8));
		double y = p.y + p.height * (0.2 + 0.1 * (i / 8));
		rig_tap_at(w->rig, x, y);
		g_usleep(700000);
		if (!rig_find(w->rig, "node-name", &panel))
			continue;
		g_autofree char *name = rig_text(w->rig, "node-name");
		g_autofree char *lower = g_utf8_strdown(name, -1);
		if (strstr(lower, kind))
			return;
	}
	g_error("no %s was met", kind);
}

static void use_style(struct walk *w, const char *button)
{
	rig_scroll_to(w->rig, "draw-strip", button);
	rig_tap(w->rig, button);
}

/* Three numbers that the kiosk tells of the light, or the focus. */
static void accents_of(struct walk *w, const char *key, double ret[3])
{
	g_autofree char *text = rig_state(w->rig, key);
	g_assert_nonnull(text);
	g_assert_cmpint(sscanf(text, "%lf %lf %lf", &ret[0], &ret[1], &ret[2]), ==, 3);
}

/* A finger moves the light and the focus, and both can be taken back. */
static void light_and_focus(struct walk *w)
{
	struct rig_place p = rig_wait_for(w->rig, "draw-canvas", limit_s);
	double x = p.x + p.width / 2, y = p.y + p.height / 2, before[3], after[3];
	use_style(w, "style-figure-1-strokes-hatching");
	rig_tap(w->rig, "draw-light");
	rig_wait_for(w->rig, "tool-hint", limit_s);
	accents_of(w, "light", before);
	g_assert_cmpfloat(before[0], >, 0);
	rig_drag(w->rig, x, y, x + 180, y - 20, 0.5);
	accents_of(w, "light", after);
	g_assert_cmpfloat(fabs(remainder(after[1] - before[1], 360)), >, 30);
	g_usleep(4000000);
	shot(w, "draw-light");
	rig_tap(w->rig, "draw-focus");
	rig_tap_at(w->rig, x, y + 30);
	g_usleep(1500000);
	accents_of(w, "focus", before);
	g_assert_cmpfloat(before[0], >, 0);
	rig_drag(w->rig, x, y, x + 80, y + 20, 0.5);
	accents_of(w, "focus", after);
	g_assert_cmpfloat(after[2], >, before[2] * 1.1);
	g_assert_cmpfloat(after[0], <, before[0]);
	g_usleep(4000000);
	shot(w, "draw-focus");
	rig_tap(w->rig, "tool-without");
	rig_wait_gone(w->rig, "tool-hint", limit_s);
	rig_tap(w->rig, "undo");
	g_usleep(500000);
	accents_of(w, "focus", before);
	g_assert_cmpfloat(fabs(before[0] - after[0]), <, 0.01);
	rig_tap(w->rig, "draw-focus");
	rig_tap(w->rig, "tool-without");
	rig_wait_gone(w->rig, "tool-hint", limit_s);
	accents_of(w, "focus", after);
	g_assert_cmpfloat(after[0] + after[1], ==, 0);
}

/* The filters of the whole picture stand in the panel; a style whose focus is on a thing is about the one that is tapped. */
static void filters(struct walk *w)
{
	struct rig_place p = rig_wait_for(w->rig, "draw-canvas", limit_s);
	double focus[3];
	use_style(w, "style-watercolour");
	g_usleep(6000000);
	shot(w, "draw-watercolour");
	rig_tap(w->rig, "draw-adjust");
	struct rig_place step;
	rig_wait_for(w->rig, "panel-close", limit_s);
	g_assert_true(rig_find(w->rig, "step-watercolour", &step));
	shot(w, "draw-filters");
	rig_tap(w->rig, "panel-close");
	rig_wait_gone(w->rig, "panel-close", limit_s);
	use_style(w, "style-focus-thing");
	rig_tap(w->rig, "draw-focus");
	rig_tap_at(w->rig, p.x + p.width / 2, p.y + p.height / 2 + 30);
	g_usleep(6000000);
	shot(w, "draw-focus-thing");
	rig_tap(w->rig, "tool-without");
	rig_wait_gone(w->rig, "tool-hint", limit_s);
	accents_of(w, "focus", focus);
	g_assert_cmpfloat(focus[0] + focus[1], ==, 0);
}

static void draw_it(struct walk *w)
{
	rig_tap(w->rig, "site-draw");
	rig_wait_for(w->rig, "draw-strip", limit_s);
	g_usleep(6000000);
	shot(w, "draw");
	use_style(w, "style-figure-7a");
	g_usleep(4000000);
	shot(w, "draw-other-style");
	struct rig_place p = rig_wait_for(w->rig, "draw-canvas", limit_s), panel;
	double x = p.x + p.width / 2, y = p.y + p.height / 2;
	rig_drag(w->rig, x, y, x + 120, y, 0.4);
	rig_pinch(w->rig, x, y, 120, 200, 0.4);
	g_usleep(4000000);
	shot(w, "draw-turned");
	/* None of that was a tap. */
	g_assert_false(rig_find(w->rig, "node-name", &panel));
	filters(w);
	light_and_focus(w);
	rig_tap(w->rig, "draw-overview");
	g_usleep(3000000);
	select_thing(w, w->thing);
	shot(w, "thing-selected");
	use_style(w, "style-figure-1-stipple");
	wait_undo(w);
	g_usleep(5000000);
	shot(w, "thing-in-its-own-style");
}

/* ---- what is taken home ---- */

static void take_home(struct walk *w)
{
	g_autofree char *drive = g_build_filename(w->drives, "STICK", NULL);
	g_autofree char *sums = g_build_filename(drive, "Site 1", "SHA256SUMS", NULL);
	g_autofree char *exports = g_build_filename(w->folder, "Site 1", "exports", NULL);
	rig_tap(w->rig, "panel-close");
	rig_tap(w->rig, "draw-take");
	rig_wait_for(w->rig, "take-picture", limit_s);
	shot(w, "take");
	rig_tap(w->rig, "take-picture");
	rig_wait_for(w->rig, "job", limit_s);
	shot(w, "take-making");
	rig_wait_gone(w->rig, "job", limit_s);
	g_autoptr(GDir) made = g_dir_open(exports, 0, NULL);
	g_assert_nonnull(made);
	/* Smaller than the scan: it may have come and gone before anybody looked. */
	g_autofree char *e57 = g_build_filename(exports, "points.e57", NULL);
	rig_tap(w->rig, "take-points");
	for (int i = 0; i < 600 && !g_file_test(e57, G_FILE_TEST_EXISTS); i++)
		g_usleep(100000);
	g_assert_true(g_file_test(e57, G_FILE_TEST_EXISTS));
	rig_wait_gone(w->rig, "job", limit_s);
	shot(w, "take-made");
	rig_tap(w->rig, "drive-copy");
	g_usleep(1000000);
	shot(w, "take-copy");
	rig_tap(w->rig, "copy-exports");
	for (int i = 0; i < 600 && !g_file_test(sums, G_FILE_TEST_EXISTS); i++)
		g_usleep(100000);
	commands_shell("cd '%s/Site 1' && sha256sum --quiet --strict -c SHA256SUMS", drive);
	g_usleep(1500000);
	shot(w, "take-copied");
}

static void look_at_health(struct walk *w)
{
	rig_tap(w->rig, "status");
	rig_wait_for(w->rig, "health-devices", limit_s);
	g_usleep(1000000);
	shot(w, "health");
	rig_tap(w->rig, "health-doctor");
	rig_wait_for(w->rig, "finding-first", limit_s);
	shot(w, "health-doctor");
	rig_tap(w->rig, "theme");
	g_usleep(500000);
	shot(w, "health-dark");
	rig_tap(w->rig, "back");
}

static void whole_way(struct walk *w)
{
	make_site(w);
	scan(w, 1, "scanning");
	shot(w, "site-one");
	scan(w, 2, "scanning-again");
	rig_wait_words(w->rig, "site-words", "All 2 scans fit together", limit_s);
	rig_wait_for(w->rig, "site-draw", limit_s);
	g_usleep(3000000);
	shot(w, "site-done");
	draw_it(w);
	take_home(w);
	look_at_health(w);
}

static void every_screen(gconstpointer data)
{
	const char *size = data;
	struct walk w;
	int width = 0, height = 0;
	g_assert_cmpint(sscanf(size, "%dx%d", &width, &height), ==, 2);
	walk_begin(&w, width, height, COURT);
	w.thing = "tree";
	whole_way(&w);
	rig_free(w.rig);
}

static void refused(void)
{
	struct walk w;
	walk_begin(&w, 1920, 1080, SCENE "&symmetric=1&station=%d");
	w.part = "refused-";
	make_site(&w);
	scan(&w, 1, "scanning");
	scan(&w, 2, "scanning-again");
	rig_wait_words(w.rig, "site-words", "does not fit", limit_s);
	shot(&w, "site-refused");
	fix_by_points(&w);
	rig_free(w.rig);
}

/* ---- the screen is turned ---- */

/* As on the appliance: the choice is kept where kiosk-screen reads it, and the program ends for weston to be started anew. */
static void turned(void)
{
	g_autoptr(GTestDBus) bus = g_test_dbus_new(G_TEST_DBUS_NONE);
	g_autofree char *folder = simulated_folder(), *program = commands_program("pleinair-kiosk");
	g_autofree char *config = simulated_folder();
	g_test_dbus_up(bus);
	const char *address = g_test_dbus_get_bus_address(bus);
	g_autofree char *session = g_strconcat("DBUS_SESSION_BUS_ADDRESS=", address, NULL),
			*system = g_strconcat("DBUS_SYSTEM_BUS_ADDRESS=", address, NULL),
			*home = g_strconcat("XDG_CONFIG_HOME=", config, NULL);
	const char *const environment[] = { session, system, home, NULL };
	const char *const arguments[] = { "--system", "--fullscreen", folder, NULL };
	g_autoptr(rig) r = rig_new(&(struct rig_desc){
		.program = program, .arguments = arguments, .environment = environment });
	rig_tap(r, "status");
	rig_tap(r, "settings-turned");
	rig_tap(r, "settings-turned-rotate-270");
	for (int i = 0; i < 200 && rig_runs(r); i++)
		g_usleep(100000);
	g_assert_false(rig_runs(r));
	commands_shell("grep -q '^turned=rotate-270$' '%s/pleinair/kiosk.conf'", config);
	g_clear_pointer(&r, rig_free);
	g_test_dbus_down(bus);
}

/* ---- the screen is killed ---- */

static guint whole_scans(struct walk *w)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *path = g_build_filename(w->folder, "Site 1", NULL);
	g_autoptr(site) s = site_open(path, &error);
	g_assert_no_error(error);
	g_autoptr(GArray) scans = site_scans(s, &error);
	g_assert_no_error(error);
	for (guint i = 0; i < scans->len; i++) {
		uint32_t number = g_array_index(scans, uint32_t, i);
		g_autoptr(panorama) p = scan_load(s, number, true, &error);
		g_assert_no_error(error);
	}
	return scans->len;
}

/* A scan is under way, or is begun by touch. */
static void have_scan(struct walk *w)
{
	struct rig_place p;
	for (int i = 0; i < 1200; i++) {
		g_autofree char *screen = rig_state(w->rig, "screen");
		if (!g_strcmp0(screen, "scan"))
			return;
		if (!g_strcmp0(screen, "sites") && rig_find(w->rig, "site-Site 1", &p))
			rig_tap(w->rig, "site-Site 1");
		else if (!g_strcmp0(screen, "site") && rig_find(w->rig, "preset-draft", &p) &&
			 rig_find(w->rig, "scan-start", &p) && p.sensitive) {
			rig_tap(w->rig, "preset-draft");
			rig_tap(w->rig, "scan-start");
			g_usleep(500000);
		}
		g_usleep(100000);
	}
	g_error("no scan could be begun");
}

static void killed(void)
{
	struct walk w;
	const char *text = g_getenv("PLEINAIR_KILLS");
	guint kills = text ? (guint)g_ascii_strtoull(text, NULL, 10) : 3, met = 0;
	walk_begin(&w, 1280, 800, SCENE);
	make_site(&w);
	for (guint i = 0; i < kills; i++) {
		have_scan(&w);
		g_usleep((gulong)g_test_rand_int_range(0, 2000) * 1000);
		g_autofree char *screen = rig_state(w.rig, "screen");
		met += !g_strcmp0(screen, "scan");
		rig_kill(w.rig);
		int64_t since_us = g_get_monotonic_time();
		rig_start(w.rig);
		g_test_message(
			"back after %.2f s", (double)(g_get_monotonic_time() - since_us) * 1e-6);
		rig_wait_words(w.rig, "toast-text", "stopped unexpectedly", limit_s);
		whole_scans(&w);
	}
	guint before = whole_scans(&w);
	have_scan(&w);
	for (int i = 0; i < 1200 && whole_scans(&w) == before; i++)
		g_usleep(100000);
	g_assert_cmpuint(whole_scans(&w), ==, before + 1);
	g_test_message("%u kills of the screen, %u while it showed a scan: %u scans whole", kills,
		met, before + 1);
	rig_free(w.rig);
}

int main(int argc, char **argv)
{
	if (!rig_tests_begin(&argc, &argv))
		return 0;
	static const char *const sizes[] = { "1280x800", "1920x1080" };
	for (size_t i = 0; i < G_N_ELEMENTS(sizes); i++) {
		g_autofree char *name = g_strconcat("/kiosk-workflow/", sizes[i], NULL);
		g_test_add_data_func(name, sizes[i], every_screen);
	}
	/* Another one, by hand: as a screen that is turned. */
	if (g_getenv("PLEINAIR_SCREEN"))
		g_test_add_data_func(
			"/kiosk-workflow/screen", g_getenv("PLEINAIR_SCREEN"), every_screen);
	g_test_add_func("/kiosk-workflow/refused", refused);
	g_test_add_func("/kiosk-workflow/turned", turned);
	g_test_add_func("/kiosk-workflow/killed", killed);
	return g_test_run();
}
