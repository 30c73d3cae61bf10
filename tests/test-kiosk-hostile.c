/* What others have written, on the touch screen: broken sites, styles and drives, and names that are made to be taken for something
 * else. Each is one sentence, the screen goes on, and nothing of it is changed. */
#include "acquire/site.h"
#include "tests/commands.h"
#include "tests/kiosk-rig.h"
#include "tests/simulated.h"

static const double limit_s = 60;
/* Markup, a format, and a path that would lead out. */
#define ODD "<b>%n & %s<b>"

struct place {
	char *folder, *drives, *outside;
	rig *rig;
};

/* A small site with a model. */
static char *good_site(struct place *p, const char *name)
{
	char *path = g_build_filename(p->folder, name, NULL);
	simulated_draft(path, COMMANDS_SCENE);
	simulated_draft(path, COMMANDS_SCENE "&station=2");
	g_auto(answer) a = commands_run("process", path, NULL);
	commands_assert_done(&a);
	return path;
}

static void put(const char *folder, const char *name, const char *text)
{
	g_autofree char *path = g_build_filename(folder, name, NULL),
			*in = g_path_get_dirname(path);
	g_assert_cmpint(g_mkdir_with_parents(in, 0755), ==, 0);
	g_assert_true(g_file_set_contents(path, text, -1, NULL));
}

/* Of all files in a folder; caller frees. */
static char *sums_of(const char *folder)
{
	const char *argv[] = { "sh", "-c",
		"cd \"$0\" && find . -type f ! -path './exports/*' -exec sha256sum {} + | sort",
		folder, NULL };
	char *out = NULL;
	g_assert_true(g_spawn_sync(NULL, (char **)argv, NULL, G_SPAWN_SEARCH_PATH, NULL, NULL, &out,
		NULL, NULL, NULL));
	g_assert_cmpuint(strlen(out), >, 64);
	return out;
}

static void begin(struct place *p)
{
	g_autofree char *program = commands_program("pleinair-kiosk");
	const char *const arguments[] = { "--device", "sim:" COMMANDS_SCENE, "--drives", p->drives,
		p->folder, NULL };
	p->rig = rig_new(&(struct rig_desc){ .program = program, .arguments = arguments });
}

static struct place place_new(void)
{
	return (struct place){ simulated_folder(), simulated_folder(), simulated_folder(), NULL };
}

static void place_clear(struct place *p)
{
	g_assert_true(rig_runs(p->rig));
	rig_free(p->rig);
	g_free(p->folder);
	g_free(p->drives);
	g_free(p->outside);
}

/* One sentence that names what is meant; put away afterwards. */
static void complains_of(struct place *p, const char *part)
{
	for (int i = 0; i < 600; i++) {
		struct rig_place place;
		g_autofree char *said = rig_find(p->rig, "toast-text", &place)
						? rig_text(p->rig, "toast-text")
						: NULL;
		if (said && strstr(said, part)) {
			g_assert_null(strstr(said, "\\n"));
			return;
		}
		g_usleep(100000);
	}
	g_autofree char *last = rig_text(p->rig, "toast-text");
	g_error("nothing was said of %s, but: %s", part, last);
}

static void open_site(struct place *p, const char *name)
{
	g_autofree char *card = g_strconcat("site-", name, NULL);
	rig_tap(p->rig, card);
}

/* ---- tests ---- */

static void broken_sites(void)
{
	struct place p = place_new();
	g_autofree char *long_name = g_strnfill(200, 'x');
	put(p.folder, "Broken/site.json", "{ \"name\": ");
	put(p.folder, "Later/site.json", "{ \"schema\": 99, \"name\": \"Later\" }");
	put(p.folder, "Binary/site.json", "\x01\x02\xff\xfe");
	put(p.folder, long_name, "no folder at all");
	g_autofree char *to = g_build_filename(p.folder, "Loop", NULL);
	g_assert_cmpint(symlink("Loop", to), ==, 0);
	g_autofree char *before = sums_of(p.folder);
	begin(&p);
	open_site(&p, "Broken");
	complains_of(&p, "site.json");
	open_site(&p, "Later");
	complains_of(&p, "Later");
	open_site(&p, "Binary");
	complains_of(&p, "Binary");
	g_autofree char *screen = rig_state(p.rig, "screen");
	g_assert_cmpstr(screen, ==, "sites");
	g_autofree char *after = sums_of(p.folder);
	g_assert_cmpstr(after, ==, before);
	place_clear(&p);
}

static void odd_names_and_styles(void)
{
	struct place p = place_new();
	g_autofree char *path = good_site(&p, ODD);
	put(path, "styles/bad.json", "{ \"schema\": 1, \"segments\": { \"site\": 7 } }");
	put(path, "styles/odd.json",
		"{ \"schema\": 1, \"title\": \"<i>%s %n</i>\", \"base\": \"points\", "
		"\"paper\": { \"texture\": \"../../../../dev/zero.png\" } }");
	g_autofree char *before = sums_of(path);
	begin(&p);
	open_site(&p, ODD);
	rig_wait_text(p.rig, "screen-title", ODD, limit_s);
	rig_tap(p.rig, "site-draw");
	complains_of(&p, "bad.json");
	rig_wait_for(p.rig, "draw-strip", limit_s);
	rig_scroll_to(p.rig, "draw-strip", "style-odd");
	rig_tap(p.rig, "style-odd");
	complains_of(&p, "zero.png");
	rig_scroll_to(p.rig, "draw-strip", "style-points");
	rig_tap(p.rig, "style-points");
	g_usleep(2000000);
	g_autofree char *after = sums_of(path);
	g_assert_cmpstr(after, ==, before);
	place_clear(&p);
}

/* What was made of the scans is made again; these are not touched. */
static void cut_model(void)
{
	struct place p = place_new();
	g_autofree char *path = good_site(&p, "Cut");
	g_autofree char *model = g_build_filename(path, "model", "points.model", NULL);
	g_autofree char *scans = g_build_filename(path, "scans", NULL);
	commands_shell("truncate -s 5000 '%s'", model);
	g_autofree char *before = sums_of(scans);
	begin(&p);
	open_site(&p, "Cut");
	for (int i = 0; i < 600; i++) {
		GStatBuf about;
		if (!g_stat(model, &about) && about.st_size > 5000)
			break;
		g_usleep(100000);
	}
	rig_tap(p.rig, "site-draw");
	rig_wait_for(p.rig, "draw-strip", limit_s);
	g_autofree char *after = sums_of(scans);
	g_assert_cmpstr(after, ==, before);
	place_clear(&p);
}

/* A drive that has a way out where the copy would be, and one that is a file there. */
static void drives_that_lie(void)
{
	struct place p = place_new();
	g_autofree char *path = good_site(&p, "Oak"), *trap = NULL, *picture = NULL;
	g_autofree char *stick = g_build_filename(p.drives, "STICK", NULL);
	trap = g_build_filename(stick, "Oak", NULL);
	g_mkdir(stick, 0755);
	g_assert_cmpint(symlink(p.outside, trap), ==, 0);
	put(path, "exports/picture.png", "not even a picture");
	g_autofree char *before = sums_of(path);
	begin(&p);
	open_site(&p, "Oak");
	rig_tap(p.rig, "site-take");
	rig_tap(p.rig, "drive-copy");
	rig_tap(p.rig, "copy-exports");
	complains_of(&p, "Oak");
	g_autoptr(GDir) outside = g_dir_open(p.outside, 0, NULL);
	g_assert_null(g_dir_read_name(outside));
	g_assert_cmpint(g_unlink(trap), ==, 0);
	put(stick, "Oak", "a file");
	rig_tap(p.rig, "drive-copy");
	rig_tap(p.rig, "copy-exports");
	complains_of(&p, "Oak");
	g_autofree char *text = NULL;
	g_assert_true(g_file_get_contents(trap, &text, NULL, NULL));
	g_assert_cmpstr(text, ==, "a file");
	g_autofree char *after = sums_of(path);
	g_assert_cmpstr(after, ==, before);
	place_clear(&p);
}

int main(int argc, char **argv)
{
	if (!rig_tests_begin(&argc, &argv))
		return 0;
	g_test_add_func("/kiosk-hostile/broken-sites", broken_sites);
	g_test_add_func("/kiosk-hostile/odd-names-and-styles", odd_names_and_styles);
	g_test_add_func("/kiosk-hostile/cut-model", cut_model);
	g_test_add_func("/kiosk-hostile/drives-that-lie", drives_that_lie);
	return g_test_run();
}
