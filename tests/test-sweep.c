/* Sweeps as people type them, on a small site: a picture of each value, a sheet of them, a page; and what cannot be is refused before
 * anything is written. */
#include "render/sweep.h"
#include "render/texels.h"
#include "tests/commands.h"
#include "tests/scene-made.h"

static char *folder, *oak;

/* ---- the text ---- */

static const struct wrong {
	const char *text, *names;
} wrongs[] = {
	{ "a | b", "TITLE | CAPTION | SWEEP" },
	{ "pencil:", "STEP.PARAMETER" },
	{ "pencil:length_px=3", "'length_px=3'" },
	{ "pencil:.x=3", "'.x=3'" },
	{ "pencil:x.=3", "'x.=3'" },
	{ "pencil:a.b", "'a.b'" },
	{ "pencil:a.b=", "a value of 'a.b' is empty" },
	{ "pencil:a.b=1,,2", "a value of 'a.b' is empty" },
	{ "", "'' is not" },
	{ ",pencil", "a value of 'style' is empty" },
	{ "pencil:a.b=1,2;c.d=1,2,3", "'a.b' has 2 values where another has 3" },
	{ "pencil,points:a.b=1,2,3", "'style' has 2 values where another has 3" },
	{ "pencil:a.b=1;a.b=2", "'a.b' is there twice" },
};

static void test_wrong(gconstpointer data)
{
	const struct wrong *w = data;
	g_autoptr(GError) error = NULL;
	g_autoptr(sweep) s = sweep_new(w->text, &error);
	g_assert_null(s);
	g_assert_error(error, STYLE_ERROR, STYLE_ERROR_FIELD);
	if (!strstr(error->message, w->names))
		g_test_message("%s", error->message);
	g_assert_nonnull(strstr(error->message, w->names));
	g_autofree char *to = g_build_filename(folder, "wrong", NULL);
	g_auto(answer) a = commands_run("styles", oak, "--sweep", w->text, "-o", to);
	commands_assert_refused(&a, 2, w->names);
	g_assert_false(g_file_test(to, G_FILE_TEST_EXISTS));
}

/* Commas in lists and quotes are not between values. */
static void test_text(void)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(sweep) s = sweep_new("Boxes, of two | What they do. | pencil,points : a.b = "
				       "[\"#ff0000\",\"#00ff00\"] , - ;view=\"1,2,3:4,5,6\"; c.d=7",
		&error);
	g_assert_no_error(error);
	g_assert_cmpstr(s->title, ==, "Boxes, of two");
	g_assert_cmpstr(s->caption, ==, "What they do.");
	g_assert_cmpstr(s->name, ==, "boxes-of-two");
	g_assert_cmpuint(s->count, ==, 2);
	g_assert_cmpstr(sweep_value(s, "style", 1), ==, "points");
	g_assert_cmpstr(sweep_value(s, "a.b", 0), ==, "[\"#ff0000\",\"#00ff00\"]");
	g_assert_cmpstr(sweep_value(s, "view", 1), ==, "\"1,2,3:4,5,6\"");
	g_assert_cmpstr(sweep_value(s, "c.d", 1), ==, "7");
	g_assert_null(sweep_value(s, "site", 0));
	g_autofree char *first = sweep_label(s, 0), *second = sweep_label(s, 1),
			*fixed = sweep_fixed(s);
	g_assert_cmpstr(first, ==, "pencil, b 2");
	g_assert_cmpstr(second, ==, "points");
	g_assert_cmpstr(fixed, ==, "1,2,3:4,5,6, d 7");
}

static void test_own_title(void)
{
	g_autoptr(sweep) s = sweep_new("pencil:hatching.length_px=8,16;light.amount=1", NULL);
	g_assert_cmpstr(s->title, ==, "pencil, hatching.length_px");
	g_assert_cmpstr(s->name, ==, "pencil-hatching-length-px");
	g_assert_true(sweep_has_site(s, "oak"));
	g_autoptr(sweep) of_one = sweep_new("pencil:a.b=-,1", NULL);
	g_autofree char *plain = sweep_label(of_one, 0), *other = sweep_label(of_one, 1);
	g_assert_cmpstr(plain, ==, "as it is");
	g_assert_cmpstr(other, ==, "b 1");
}

/* ---- values ---- */

static struct step hatching_of(const char *text, guint i, float *ret_azimuth_deg)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(sweep) s = sweep_new(text, &error);
	g_assert_no_error(error);
	g_autoptr(style) drawn = sweep_style(s, i, NULL, &error);
	g_assert_no_error(error);
	g_autoptr(GArray) steps = style_steps(drawn, NULL, SEGMENT_SITE, &error);
	g_assert_no_error(error);
	*ret_azimuth_deg = drawn->whole.light.azimuth_deg;
	for (guint k = 0; k < steps->len; k++)
		if (step_is_hatching(&g_array_index(steps, struct step, k)))
			return g_array_index(steps, struct step, k);
	g_assert_not_reached();
}

static void test_values(void)
{
	static const char text[] = "pencil:hatching.length_px=-,@wax-crayons,11;"
				   "hatching.pencils=[],@wax-crayons,[\"#ff0000\"];"
				   "light.azimuth_deg=10,-,@pencil;hatching.follows=curvature";
	float azimuth_deg[3], of_pencil, ignored;
	struct step plain = hatching_of("pencil", 0, &of_pencil),
		    wax = hatching_of("wax-crayons", 0, &ignored), s[3];
	for (guint i = 0; i < 3; i++)
		s[i] = hatching_of(text, i, &azimuth_deg[i]);
	g_assert_cmpfloat(s[0].ink.length_px, ==, plain.ink.length_px);
	g_assert_cmpfloat(s[1].ink.length_px, ==, wax.ink.length_px);
	g_assert_cmpfloat(s[2].ink.length_px, ==, 11);
	g_assert_cmpstr(s[0].hatching.pencils, ==, "[]");
	g_assert_cmpstr(s[1].hatching.pencils, ==, wax.hatching.pencils);
	g_assert_cmpstr(s[2].hatching.pencils, ==, "[\"#ff0000\"]");
	g_assert_cmpfloat(azimuth_deg[0], ==, 10);
	g_assert_cmpfloat(azimuth_deg[1], ==, of_pencil);
	g_assert_cmpfloat(azimuth_deg[2], ==, of_pencil);
	for (guint i = 0; i < 3; i++)
		g_assert_cmpint(s[i].hatching.follows, ==, FOLLOWS_CURVATURE);
}

/* ---- files ---- */

static void find_size(const char *path, uint32_t ret[2])
{
	g_autoptr(GError) error = NULL;
	g_autofree uint8_t *grey = texels_read_png(path, TEXELS_LIGHT, &ret[0], &ret[1], &error);
	g_assert_no_error(error);
}

static char *checksum_of(const char *path)
{
	g_autofree char *bytes = NULL;
	gsize length;
	g_assert_true(g_file_get_contents(path, &bytes, &length, NULL));
	return g_compute_checksum_for_data(G_CHECKSUM_SHA256, (const guchar *)bytes, length);
}

/* Each picture is there, in its size, and is another one. */
static void assert_pictures(const char *in, const char *const *names)
{
	g_autoptr(GHashTable) seen = g_hash_table_new_full(g_str_hash, g_str_equal, g_free, NULL);
	guint count = 0;
	for (; names[count]; count++) {
		g_autofree char *path = g_build_filename(in, names[count], NULL);
		uint32_t size[2];
		find_size(path, size);
		g_assert_cmpuint(size[0], ==, 120);
		g_assert_cmpuint(size[1], ==, 90);
		g_hash_table_add(seen, checksum_of(path));
	}
	g_assert_cmpuint(g_hash_table_size(seen), ==, count);
}

static void test_sheet(void)
{
	static const char *const pictures[] = { "long-lines-1.png", "long-lines-2.png",
		"long-lines-3.png", "pencil-light-azimuth-deg-1.png",
		"pencil-light-azimuth-deg-2.png", NULL };
	g_autofree char *to = g_build_filename(folder, "sheets", NULL), *text = NULL;
	g_auto(answer) a = commands_run("styles", oak, "-o", to, "--size", "120x90", "--sweep",
		"Long lines | Longer & longer. | pencil:hatching.length_px=5,20,60", "--sweep",
		"pencil:light.azimuth_deg=0,180", "--view", "walk");
	commands_assert_done(&a);
	g_autofree char *page = g_build_filename(to, "index.html", NULL),
			*printed = g_strconcat(page, "\n", NULL),
			*sheet = g_build_filename(to, "long-lines.png", NULL);
	uint32_t size[2];
	g_assert_cmpstr(a.out, ==, printed);
	g_assert_cmpstr(a.err, ==, "");
	assert_pictures(to, pictures);
	find_size(sheet, size);
	g_assert_cmpuint(size[0], >, 3 * 120);
	g_assert_cmpuint(size[1], >, 90 + 60);
	g_assert_true(g_file_get_contents(page, &text, NULL, NULL));
	g_assert_nonnull(strstr(text, "<img src=\"long-lines.png\""));
	g_assert_nonnull(strstr(text, "Longer &amp; longer."));
	g_assert_nonnull(strstr(text, "<a href=\"long-lines-3.png\">length_px 60</a>"));
	g_assert_nonnull(strstr(text, "<img src=\"pencil-light-azimuth-deg.png\""));
}

/* Two sites are above one another, unless the sweep names one of them. */
static void test_two_sites(void)
{
	g_autofree char *elm = g_build_filename(folder, "elm", NULL),
			*to = g_build_filename(folder, "both", NULL);
	commands_shell("cp -r '%s' '%s'", oak, elm);
	g_auto(answer) a = commands_run("styles", oak, elm, "-o", to, "--size", "120x90", "--sweep",
		"Both | | pencil,points", "--sweep", "One | | pencil,points:site=elm", "--sweep",
		"One | again | pencil");
	commands_assert_done(&a);
	g_autofree char *names = commands_names(to);
	g_assert_cmpstr(names, ==,
		"both-elm-1.png both-elm-2.png both-oak-1.png both-oak-2.png both.png index.html "
		"one-3-elm-1.png one-3-oak-1.png one-3.png one-elm-1.png one-elm-2.png one.png");
	g_autofree char *both = g_build_filename(to, "both.png", NULL),
			*one = g_build_filename(to, "one.png", NULL);
	uint32_t two_rows[2], one_row[2];
	find_size(both, two_rows);
	find_size(one, one_row);
	g_assert_cmpuint(two_rows[0], ==, one_row[0]);
	g_assert_cmpuint(two_rows[1], >=, one_row[1] + 90);
}

/* ---- what cannot be ---- */

static const struct refused {
	const char *text, *names;
} refusals[] = {
	{ "pencl", "there is no style 'pencl'; did you mean 'pencil'?" },
	{ "pencil:hatchin.length_px=6", "did you mean 'hatching'?" },
	{ "pencil:hatching.lenght_px=6", "did you mean 'length_px'?" },
	{ "pencil:hatching.length_px=6,900",
		"pencil: hatching.length_px: 900 is too much; it goes from 1 to 400 px" },
	{ "pencil:hatching.length_px=6,long", "it must be a number from 1 to 400 px" },
	{ "pencil:hatching.follows=unform", "one of uniform, curvature" },
	{ "pencil:light.azimut_deg=3", "did you mean 'azimuth_deg'?" },
	{ "pencil:hatching.pencils=@edges", "there is no style 'edges'" },
	{ "pencil:edges.pencils=@pencil", "the style 'pencil' has no edges.pencils" },
	{ "pencil:hatching.xtoon=[{\"brightness\":2}]", "2 is too much" },
	{ "pencil:view=nowhere", "there is no view 'nowhere'" },
	{ "pencil:site=elm", "none of the sites is 'elm'" },
};

/* The good sweep before it is not drawn either. */
static void test_refused(gconstpointer data)
{
	const struct refused *r = data;
	g_autofree char *to = g_build_filename(folder, "refused", NULL);
	g_auto(answer) a = commands_run("styles", oak, "-o", to, "--size", "60x40", "--sweep",
		"pencil", "--sweep", r->text);
	commands_assert_refused(&a, 1, r->names);
	g_assert_false(g_file_test(to, G_FILE_TEST_EXISTS));
}

static void test_usage(void)
{
	g_autofree char *again = g_build_filename(oak, "..", "oak", NULL);
	g_auto(answer) none = commands_run("styles", "--sweep", "pencil"),
		       both = commands_run("styles", oak, "--sweep", "pencil", "-t", "x"),
		       size = commands_run("styles", oak, "--sweep", "pencil", "--size", "9"),
		       same = commands_run("styles", oak, again, "--sweep", "pencil");
	commands_assert_refused(&none, 2, "sweeps of which site?");
	commands_assert_refused(&both, 2, "one at a time");
	commands_assert_refused(&size, 2, "'9'");
	commands_assert_refused(&same, 1, "two of the sites are named 'oak'");
	g_autofree char *file = g_build_filename(oak, "site.json", "x", NULL);
	g_auto(answer) into = commands_run("styles", oak, "--sweep", "pencil", "-o", file);
	commands_assert_refused(&into, 1, "site.json/x");
}

/* ---- the site ---- */

static void put_site(void)
{
	g_auto(made) m = made_court();
	g_autoptr(segments) tree = made_tree();
	g_autoptr(GError) error = NULL;
	g_autofree char *in = g_build_filename(oak, "model", NULL), *path = model_path(oak),
			*other = g_build_filename(oak, "segments", NULL),
			*file = g_build_filename(oak, "site.json", NULL);
	g_assert_cmpint(g_mkdir_with_parents(in, 0755), ==, 0);
	g_assert_cmpint(g_mkdir_with_parents(other, 0755), ==, 0);
	g_assert_true(g_file_set_contents(file,
		"{\"schema\":1,\"name\":\"Oak\",\"id\":\"6f1f6c8e-1b1e-4c3a-9d55-0c9a3b0a7a11\","
		"\"created\":\"2026-11-23T10:00:00Z\",\"units\":\"metres\"}",
		-1, NULL));
	made_write_to(&m, path);
	g_assert_true(segments_save(tree, oak, &error));
	g_assert_no_error(error);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	commands_find_programs();
	folder = g_dir_make_tmp("pleinair-sweep-XXXXXX", NULL);
	g_setenv("XDG_DATA_HOME", folder, TRUE);
	oak = g_build_filename(folder, "oak", NULL);
	put_site();
	for (size_t i = 0; i < G_N_ELEMENTS(wrongs); i++)
		commands_add("/sweep/wrong", i, &wrongs[i], test_wrong);
	g_test_add_func("/sweep/text", test_text);
	g_test_add_func("/sweep/own-title", test_own_title);
	g_test_add_func("/sweep/values", test_values);
	g_test_add_func("/sweep/sheet", test_sheet);
	g_test_add_func("/sweep/two-sites", test_two_sites);
	for (size_t i = 0; i < G_N_ELEMENTS(refusals); i++)
		commands_add("/sweep/refused", i, &refusals[i], test_refused);
	g_test_add_func("/sweep/usage", test_usage);
	int status = g_test_run();
	files_remove_tree(folder, NULL);
	g_free(oak);
	g_free(folder);
	return status;
}
