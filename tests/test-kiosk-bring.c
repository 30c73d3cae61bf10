/* Files of others come from a drive into a site by touch: the one that a person chooses, all of them, and what is to be known of
 * them. */
#include "acquire/points.h"
#include "acquire/site.h"
#include "tests/commands.h"
#include "tests/kiosk-rig.h"
#include "tests/simulated.h"
#include <math.h>

static const double limit_s = 60;

struct desk {
	char *folder, *drives, *stick, *site;
	rig *rig;
};

static void put(const struct desk *d, const char *name, const char *text)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *path = g_build_filename(d->stick, name, NULL);
	g_autofree char *folder = g_path_get_dirname(path);
	g_assert_cmpint(g_mkdir_with_parents(folder, 0755), ==, 0);
	g_file_set_contents(path, text, -1, &error);
	g_assert_no_error(error);
}

/* Two scans of the hall as another scanner's file. */
static void put_hall(const struct desk *d)
{
	g_autofree char *other = simulated_folder(), *from = g_build_filename(other, "hall", NULL),
			*to = g_build_filename(d->stick, "hall.e57", NULL);
	simulated_draft(from, COMMANDS_SCENE "&station=1");
	simulated_draft(from, COMMANDS_SCENE "&station=2");
	g_auto(answer) a = commands_run("export", "--raw", "--output", to, from);
	commands_assert_done(&a);
}

/* A box of 4 x 3 x 2 m, in millimetres, whose y looks up. */
static void put_box(const struct desk *d)
{
	g_autoptr(GString) obj = g_string_new("# a box\n");
	for (int i = 0; i < 8; i++)
		g_string_append_printf(
			obj, "v %d %d %d\n", i & 1 ? 4000 : 0, i & 2 ? 2000 : 0, i & 4 ? 3000 : 0);
	g_string_append(obj, "f 1 2 4 3\nf 5 7 8 6\nf 1 5 6 2\nf 3 4 8 7\nf 1 3 7 5\nf 2 6 8 4\n");
	put(d, "meshes/box.obj", obj->str);
}

static void desk_begin(struct desk *d)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *program = commands_program("pleinair-kiosk");
	*d = (struct desk){ .folder = simulated_folder(), .drives = simulated_folder() };
	d->stick = g_build_filename(d->drives, "STICK", NULL);
	d->site = g_build_filename(d->folder, "oak", NULL);
	g_mkdir(d->stick, 0755);
	site_free(site_open_for_writing(d->site, &error));
	g_assert_no_error(error);
	const char *const arguments[] = { "--size", "1280x800", "--drives", d->drives, d->folder,
		NULL };
	d->rig = rig_new(&(struct rig_desc){
		.program = program, .arguments = arguments, .width = 1280, .height = 800 });
	rig_tap(d->rig, "site-oak");
}

static void desk_end(struct desk *d)
{
	rig_free(d->rig);
	g_free(d->folder);
	g_free(d->drives);
	g_free(d->stick);
	g_free(d->site);
}

static void wait_for_scan(const struct desk *d, guint number)
{
	g_autofree char *path = g_strdup_printf("%s/scans/%04u", d->site, number);
	for (int i = 0; i < 600 && !g_file_test(path, G_FILE_TEST_IS_DIR); i++)
		g_usleep(100000);
	g_assert_true(g_file_test(path, G_FILE_TEST_IS_DIR));
}

/* How far its points reach along each axis, metres. */
static void extent_of(const struct desk *d, guint number, double ret[3])
{
	g_autoptr(GError) error = NULL;
	g_autofree char *path = g_strdup_printf("%s/scans/%04u/points.ply", d->site, number);
	g_autoptr(points) p = points_open(path, &error);
	g_assert_no_error(error);
	float low[3] = { INFINITY, INFINITY, INFINITY },
	      high[3] = { -INFINITY, -INFINITY, -INFINITY };
	for (uint64_t i = 0; i < p->count; i++) {
		const float at[3] = { p->record[i].x_m, p->record[i].y_m, p->record[i].z_m };
		for (int k = 0; k < 3; k++) {
			low[k] = fminf(low[k], at[k]);
			high[k] = fmaxf(high[k], at[k]);
		}
	}
	for (int k = 0; k < 3; k++)
		ret[k] = high[k] - low[k];
}

static void a_grid_and_a_mesh(void)
{
	struct desk d;
	struct rig_place p;
	double size[3];
	desk_begin(&d);
	rig_tap(d.rig, "site-bring");
	rig_wait_text(d.rig, "bring-nothing",
		"There is no file of points on the drive, nor a mesh.", limit_s);
	rig_keep_shot(d.rig, "bring-none");
	rig_tap(d.rig, "back");
	put_hall(&d);
	put_box(&d);
	put(&d, "read-me.txt", "What was scanned on Monday.\n");
	put(&d, ".hidden.xyz", "1 2 3\n4 5 6\n");
	commands_shell("ln -s / '%s/everything'", d.stick);
	rig_tap(d.rig, "site-bring");
	rig_wait_for(d.rig, "file-hall.e57", limit_s);
	g_assert_true(rig_find(d.rig, "file-box.obj", &p));
	/* Neither what says something else, nor what is hidden. */
	g_assert_false(rig_find(d.rig, "file-read-me.txt", &p));
	g_assert_false(rig_find(d.rig, "file-.hidden.xyz", &p));
	g_assert_true(rig_find(d.rig, "bring-start", &p) && !p.sensitive);
	rig_tap(d.rig, "file-box.obj");
	rig_wait_for(d.rig, "bring-unit", limit_s);
	rig_tap(d.rig, "bring-unit");
	rig_tap(d.rig, "bring-unit-mm");
	rig_tap(d.rig, "bring-up");
	rig_tap(d.rig, "bring-up-y");
	rig_tap(d.rig, "bring-spacing");
	rig_keep_shot(d.rig, "bring-spacing");
	rig_tap(d.rig, "bring-spacing-0.05");
	rig_keep_shot(d.rig, "bring-mesh");
	rig_tap(d.rig, "bring-start");
	wait_for_scan(&d, 1);
	extent_of(&d, 1, size);
	g_test_message("the box is %.2f x %.2f x %.2f m", size[0], size[1], size[2]);
	g_assert_cmpfloat(fabs(size[0] - 4), <, 0.1);
	g_assert_cmpfloat(fabs(size[1] - 3), <, 0.1);
	g_assert_cmpfloat(fabs(size[2] - 2), <, 0.1);
	rig_wait_for(d.rig, "job-notes", limit_s);
	rig_keep_shot(d.rig, "bring-mesh-notes");
	/* Of scans with a grid there is nothing to be read: the site comes back, and is computed. */
	rig_tap(d.rig, "file-hall.e57");
	rig_tap(d.rig, "bring-start");
	wait_for_scan(&d, 3);
	rig_wait_for(d.rig, "scan-start", limit_s);
	rig_keep_shot(d.rig, "bring-came");
	rig_wait_gone(d.rig, "work-bar", 4 * limit_s);
	g_usleep(3000000);
	rig_keep_shot(d.rig, "bring-computed");
	desk_end(&d);
}

/* Two files at once, of which one has something to say; and what the site has already is refused in words. */
static void all_of_them(void)
{
	struct desk d;
	g_autoptr(GError) error = NULL;
	desk_begin(&d);
	put(&d, "monday/a.xyz", "5 5 5\n1 0 0\nnan 0 0\n0 1 0\n0 0 1\n");
	put(&d, "monday/b.xyz", "2 0 0\n3 0 0\n2 1 0\n2 0 1\n");
	rig_tap(d.rig, "site-bring");
	rig_wait_for(d.rig, "file-a.xyz", limit_s);
	rig_tap(d.rig, "bring-all");
	rig_wait_text(d.rig, "bring-chosen", "2 files, 56 bytes", limit_s);
	rig_keep_shot(d.rig, "bring-all");
	rig_tap(d.rig, "bring-start");
	wait_for_scan(&d, 2);
	rig_wait_text(
		d.rig, "job-notes", "Scan 1: 1 point of the file is not to be used.", limit_s);
	rig_wait_text(
		d.rig, "bring-chosen", "Tap the files that are to come into the site.", limit_s);
	rig_wait_text(d.rig, "toast-text", "Brought in: 2 scans, 8 points.", limit_s);
	rig_keep_shot(d.rig, "bring-notes");
	rig_tap(d.rig, "job-note-read");
	rig_wait_gone(d.rig, "job-notes", limit_s);
	rig_tap(d.rig, "file-a.xyz");
	rig_tap(d.rig, "bring-start");
	rig_wait_for(d.rig, "toast-close", limit_s);
	g_usleep(1000000);
	g_autofree char *said = rig_text(d.rig, "toast-text");
	g_test_message("%s", said);
	g_assert_nonnull(strstr(said, "a.xyz"));
	rig_keep_shot(d.rig, "bring-refused");
	g_autoptr(site) s = site_open(d.site, &error);
	g_assert_no_error(error);
	g_autoptr(GArray) scans = site_scans(s, &error);
	g_assert_no_error(error);
	g_assert_cmpuint(scans->len, ==, 2);
	desk_end(&d);
}

int main(int argc, char **argv)
{
	if (!rig_tests_begin(&argc, &argv))
		return 0;
	g_test_add_func("/kiosk-bring/a-grid-and-a-mesh", a_grid_and_a_mesh);
	g_test_add_func("/kiosk-bring/all-of-them", all_of_them);
	return g_test_run();
}
