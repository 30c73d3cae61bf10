/* Without a finger: the whole way from a new site to its drawing with the keys of a keyboard alone, and on every screen all that can be
 * pressed is reached by Tab and has words for a screen reader. */
#include "tests/commands.h"
#include "tests/kiosk-rig.h"
#include "tests/simulated.h"
#include <linux/input-event-codes.h>

#define SCENE "sim:court?seed=7&ares=360&camera=64x96&divergence_mrad=0&station=%n"

static const double limit_s = 120;

/* Of one line of rig_controls. */
struct control {
	char *name, *type, *words;
};

static void control_free(gpointer data)
{
	struct control *c = data;
	g_free(c->name);
	g_free(c->type);
	g_free(c->words);
	g_free(c);
}

static GPtrArray *controls_of(rig *r)
{
	g_autofree char *all = rig_controls(r);
	g_auto(GStrv) lines = g_strsplit(all, "\n", -1);
	GPtrArray *ret = g_ptr_array_new_with_free_func(control_free);
	for (char **l = lines; *l; l++) {
		g_auto(GStrv) words = g_strsplit(*l, " ", 3);
		if (g_strv_length(words) < 2)
			continue;
		struct control *c = g_new(struct control, 1);
		*c = (struct control){ g_strdup(words[0]), g_strdup(words[1]),
			g_strdup(words[2] ? g_strstrip(words[2]) : "") };
		g_ptr_array_add(ret, c);
	}
	g_assert_cmpuint(ret->len, >, 0);
	return ret;
}

/* What it then goes to; the caller frees it. The key takes its time through the compositor. */
static char *tab(rig *r)
{
	g_autofree char *before = rig_focus(r);
	rig_key(r, KEY_TAB);
	for (int i = 0; i < 40; i++) {
		g_autofree char *now = rig_focus(r);
		if (strcmp(now, before))
			return g_steal_pointer(&now);
		g_usleep(10000);
	}
	return g_steal_pointer(&before);
}

static GPtrArray *check_words(rig *r, const char *screen)
{
	GPtrArray *controls = controls_of(r);
	for (guint i = 0; i < controls->len; i++) {
		const struct control *c = controls->pdata[i];
		if (!*c->words)
			g_error("on %s, '%s' (%s) says nothing to a screen reader", screen, c->name,
				c->type);
	}
	return controls;
}

static bool has(const GPtrArray *controls, const char *name)
{
	for (guint i = 0; i < controls->len; i++)
		if (!strcmp(((const struct control *)controls->pdata[i])->name, name))
			return true;
	return false;
}

/* Once round by Tab; ret: where it never came to, though that was there before and after; NULL: nowhere. Caller frees. */
static char *missed(rig *r, const char *screen, char **ret_way)
{
	g_autoptr(GPtrArray) before = check_words(r, screen);
	g_autoptr(GHashTable) reached =
		g_hash_table_new_full(g_str_hash, g_str_equal, g_free, NULL);
	g_autoptr(GString) way = g_string_new(NULL);
	for (guint i = 0; i < before->len + 10; i++) {
		char *at = tab(r);
		g_string_append_printf(way, " %s", at);
		g_hash_table_add(reached, at);
	}
	g_autoptr(GPtrArray) after = check_words(r, screen);
	*ret_way = g_strdup(way->str);
	for (guint i = 0; i < before->len; i++) {
		const char *name = ((const struct control *)before->pdata[i])->name;
		if (has(after, name) && !g_hash_table_contains(reached, name))
			return g_strdup(name);
	}
	g_test_message("%s: %u things to press", screen, before->len);
	return NULL;
}

/* All says something, and Tab comes by all of it; what comes and goes meanwhile may send the keys elsewhere. */
static void check_screen(rig *r, const char *screen)
{
	for (int i = 0;; i++) {
		g_autofree char *way = NULL, *name = missed(r, screen, &way);
		if (!name)
			return;
		if (i == 2)
			g_error("on %s, Tab never comes to '%s', but to:%s", screen, name, way);
	}
}

/* Keys stay on what lies over all else. */
static void check_sheet(rig *r)
{
	g_ptr_array_unref(check_words(r, "the new site's sheet"));
	for (int i = 0; i < 60; i++) {
		g_autofree char *at = tab(r);
		if (!g_str_has_prefix(at, "new-site-") && !g_str_has_prefix(at, "key-"))
			g_error("Tab goes to '%s' under the sheet", at);
	}
}

static void go_to(rig *r, const char *name)
{
	rig_wait_for(r, name, limit_s);
	for (int i = 0; i < 200; i++) {
		g_autofree char *focus = tab(r);
		if (!strcmp(focus, name))
			return;
	}
	g_error("Tab never comes to '%s'", name);
}

static void press(rig *r, const char *name)
{
	go_to(r, name);
	rig_key(r, KEY_ENTER);
}

static void scan(rig *r, const char *folder, int number, bool hdr)
{
	g_autofree char *path = g_strdup_printf("%s/Keys/scans/%04d", folder, number),
			*json = g_build_filename(path, "scan.json", NULL), *said = NULL;
	press(r, "preset-draft");
	if (hdr) {
		press(r, "preset-hdr");
		rig_keep_shot(r, "keys-hdr");
	}
	press(r, "scan-start");
	for (int i = 0; i < 1200 && !g_file_test(path, G_FILE_TEST_IS_DIR); i++)
		g_usleep(100000);
	g_assert_true(g_file_test(path, G_FILE_TEST_IS_DIR));
	rig_wait_gone(r, "scan-panorama", limit_s);
	g_assert_true(g_file_get_contents(json, &said, NULL, NULL));
	g_assert_cmpint(strstr(said, "\"hdr\"") != NULL, ==, hdr);
}

/* A key changes what the kiosk tells of that. */
static void key_changes(rig *r, unsigned key, const char *state)
{
	g_autofree char *before = rig_state(r, state);
	for (int i = 0; i < 600; i++) {
		if (i % 20 == 0)
			rig_key(r, key);
		g_usleep(50000);
		g_autofree char *now = rig_state(r, state);
		if (g_strcmp0(now, before))
			return;
	}
	g_error("the key %u never changed '%s'", key, state);
}

static void draw_by_keys(rig *r)
{
	press(r, "site-draw");
	rig_wait_for(r, "style-figure-7d", limit_s); /* where the strip opens */
	check_screen(r, "draw");
	press(r, "style-wax-crayons"); /* Tab has left the strip at its end */
	go_to(r, "draw-canvas");
	key_changes(r, KEY_LEFT, "pace");
	key_changes(r, KEY_EQUAL, "pace");
	press(r, "draw-light");
	go_to(r, "draw-canvas");
	key_changes(r, KEY_RIGHT, "light");
	press(r, "draw-light");
	press(r, "draw-adjust");
	rig_wait_for(r, "panel-close", limit_s);
	check_screen(r, "the style's own parameters");
	press(r, "panel-close");
	rig_wait_gone(r, "panel-close", limit_s);
	rig_key(r, KEY_ESC);
	rig_wait_for(r, "scan-start", limit_s);
}

/* A point in one panorama, above the middle, and one in the other. */
static void pick_by_keys(rig *r)
{
	go_to(r, "pane-a");
	rig_key(r, KEY_UP);
	rig_key(r, KEY_RIGHT);
	rig_key(r, KEY_SPACE);
	rig_wait_for(r, "pick-1", limit_s);
	go_to(r, "pane-b");
	rig_key(r, KEY_EQUAL);
	rig_key(r, KEY_SPACE);
	rig_wait_for(r, "pick-1", limit_s);
	rig_keep_shot(r, "keys-align");
	press(r, "undo");
	press(r, "undo");
	rig_wait_gone(r, "pick-1", limit_s);
}

static void whole_way(void)
{
	g_autofree char *program = commands_program("pleinair-kiosk"), *folder = simulated_folder();
	g_autofree char *drives = simulated_folder();
	commands_shell("mkdir '%s/STICK' && echo 1 2 3 > '%s/STICK/one.xyz'", drives, drives);
	const char *const arguments[] = { "--device", SCENE, "--size", "1280x800", "--drives",
		drives, folder, NULL };
	g_autoptr(rig) r = rig_new(&(struct rig_desc){
		.program = program, .arguments = arguments, .width = 1280, .height = 800 });
	rig_wait_for(r, "new-site", limit_s);
	check_screen(r, "sites");
	press(r, "new-site");
	rig_wait_for(r, "new-site-name", limit_s);
	check_sheet(r);
	go_to(r, "new-site-name");
	rig_type(r, "Keys");
	press(r, "new-site-yes");
	rig_wait_for(r, "scan-start", limit_s);
	check_screen(r, "an empty site");
	scan(r, folder, 1, false);
	scan(r, folder, 2, true);
	rig_wait_for(r, "site-draw", limit_s);
	check_screen(r, "a site");
	press(r, "site-bring");
	rig_wait_for(r, "file-one.xyz", limit_s);
	go_to(r, "file-one.xyz");
	rig_type(r, " ");
	rig_wait_for(r, "bring-start", limit_s);
	check_screen(r, "bring in");
	rig_key(r, KEY_ESC);
	rig_wait_for(r, "scan-start", limit_s);
	draw_by_keys(r);
	press(r, "site-align");
	rig_wait_gone(r, "scan-start", limit_s);
	check_screen(r, "align");
	pick_by_keys(r);
	rig_key(r, KEY_ESC);
	press(r, "site-take");
	rig_wait_gone(r, "scan-start", limit_s);
	check_screen(r, "take home");
	rig_key(r, KEY_ESC);
	rig_wait_for(r, "scan-start", limit_s);
	press(r, "status");
	rig_wait_gone(r, "scan-start", limit_s);
	check_screen(r, "health");
	rig_key(r, KEY_ESC);
	rig_wait_for(r, "scan-start", limit_s);
	rig_key(r, KEY_ESC);
	rig_wait_for(r, "manage-Keys", limit_s);
	check_screen(r, "sites, one of them");
}

int main(int argc, char **argv)
{
	if (!rig_tests_begin(&argc, &argv))
		return 0;
	g_test_add_func("/kiosk-keys/whole-way", whole_way);
	return g_test_run();
}
