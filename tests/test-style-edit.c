/* A style of one's own: what is changed comes out in the drawing, for the node that it was said of and no other. */
#include "firmware-io/files.h"
#include "render/style-edit.h"
#include <string.h>

static char *site_folder(void)
{
	char *folder = g_dir_make_tmp("style-edit-XXXXXX", NULL);
	g_autofree char *styles = g_build_filename(folder, "styles", NULL);
	g_assert_cmpint(g_mkdir_with_parents(styles, 0700), ==, 0);
	return folder;
}

static const struct step *find(const GArray *steps, const char *id)
{
	for (guint i = 0; i < steps->len; i++)
		if (!g_strcmp0(g_array_index(steps, struct step, i).id, id))
			return &g_array_index(steps, struct step, i);
	return NULL;
}

static GArray *steps_of(const style_edit *e, const char *folder, uint32_t node)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(style) s = style_edit_style(e, folder, &error);
	g_assert_no_error(error);
	GArray *steps = style_steps(s, NULL, node, &error);
	g_assert_no_error(error);
	return steps;
}

static JsonNode *number(double v)
{
	return json_node_init_double(json_node_alloc(), v);
}

static void test_change(void)
{
	g_autofree char *folder = site_folder();
	g_autoptr(GError) error = NULL;
	g_autoptr(style_edit) e = style_edit_new("figure-7c", folder, &error);
	g_assert_no_error(error);
	g_autoptr(GArray) before = steps_of(e, folder, segment_of_class(CLASS_VEGETATION));
	style_edit_change(e, "site", "details", "length_px", number(17));
	style_edit_change(e, "vegetation", "details", "opacity", number(0.25));
	g_autoptr(GArray) whole = steps_of(e, folder, SEGMENT_SITE);
	g_autoptr(GArray) leaves = steps_of(e, folder, segment_of_class(CLASS_VEGETATION));
	g_assert_cmpfloat(find(whole, "details")->ink.length_px, ==, 17);
	g_assert_cmpfloat(find(whole, "details")->ink.opacity, !=, 0.25);
	g_assert_cmpfloat(find(leaves, "details")->ink.length_px, ==, 17);
	g_assert_cmpfloat(find(leaves, "details")->ink.opacity, ==, 0.25);
	style_edit_reset(e, "site");
	style_edit_reset(e, "vegetation");
	g_autoptr(GArray) after = steps_of(e, folder, segment_of_class(CLASS_VEGETATION));
	g_assert_cmpuint(after->len, ==, before->len);
	g_assert_cmpmem(after->data, after->len * sizeof(struct step), before->data,
		before->len * sizeof(struct step));
	g_assert_true(files_remove_tree(folder, NULL));
}

/* Steps of any style, written out and read again, are the same. */
static void test_steps(void)
{
	g_autofree char *folder = site_folder();
	g_auto(GStrv) names = style_names(NULL);
	g_assert_cmpuint(g_strv_length(names), >=, 8);
	for (char **n = names; *n; n++) {
		g_autoptr(GError) error = NULL;
		g_autoptr(style_edit) e = style_edit_new("points", folder, &error);
		g_autoptr(style) s = style_find(*n, NULL, &error);
		g_assert_no_error(error);
		g_autoptr(GArray) want =
			style_steps(s, NULL, segment_of_class(CLASS_VEGETATION), &error);
		g_assert_no_error(error);
		style_edit_set_steps(e, "building", want);
		g_autoptr(GArray) got = steps_of(e, folder, segment_of_class(CLASS_BUILDING));
		g_assert_cmpmem(got->data, got->len * sizeof(struct step), want->data,
			want->len * sizeof(struct step));
	}
	g_assert_true(files_remove_tree(folder, NULL));
}

static void test_changes_a_listed_step(void)
{
	g_autofree char *folder = site_folder();
	g_autoptr(GError) error = NULL;
	g_autoptr(style_edit) e = style_edit_new("points", folder, &error);
	g_autoptr(style) s = style_find("figure-7c", NULL, &error);
	g_autoptr(GArray) steps = style_steps(s, NULL, SEGMENT_SITE, &error);
	g_assert_no_error(error);
	style_edit_set_steps(e, "building", steps);
	style_edit_change(e, "building", "details", "opacity", number(0.5));
	g_autoptr(GArray) got = steps_of(e, folder, segment_of_class(CLASS_BUILDING));
	g_assert_cmpfloat(find(got, "details")->ink.opacity, ==, 0.5);
	g_assert_true(files_remove_tree(folder, NULL));
}

/* Light and focus are the whole picture's, and go along to another style; what that says itself, counts. */
static void test_accents(void)
{
	g_autofree char *folder = site_folder();
	g_autoptr(GError) error = NULL;
	g_autoptr(style_edit) a = style_edit_new("figure-7c", folder, &error);
	g_autoptr(style_edit) b = style_edit_new("points", folder, &error);
	g_assert_no_error(error);
	style_edit_set(a, "light", "amount", number(0.5));
	style_edit_set(a, "light", "azimuth_deg", number(77));
	style_edit_set(a, "focus", "amount", number(0.75));
	style_edit_set(a, "paper", "grain", number(1));
	style_edit_set(b, "focus", "radius_m", number(3));
	style_edit_take_accents(b, a);
	style_edit_set(a, "light", "azimuth_deg", number(11));
	g_autoptr(style) of_a = style_edit_style(a, folder, &error);
	g_autoptr(style) of_b = style_edit_style(b, folder, &error);
	g_assert_no_error(error);
	g_assert_cmpfloat(of_a->whole.light.azimuth_deg, ==, 11);
	g_assert_cmpfloat(of_a->whole.paper.grain, ==, 1);
	g_assert_cmpfloat(of_b->whole.light.amount, ==, 0.5f);
	g_assert_cmpfloat(of_b->whole.light.azimuth_deg, ==, 77);
	g_assert_cmpfloat(of_b->whole.focus.radius_m, ==, 3);
	g_assert_cmpfloat(of_b->whole.focus.amount, ==, 0);
	g_assert_cmpfloat(of_b->whole.paper.grain, <, 1);
	g_assert_true(files_remove_tree(folder, NULL));
}

static void test_save(void)
{
	g_autofree char *folder = site_folder(), *name = NULL, *again = NULL;
	g_autoptr(GError) error = NULL;
	g_autoptr(style_edit) e = style_edit_new("figure-7c", folder, &error);
	style_edit_change(e, "site", "details", "length_px", number(17));
	g_assert_true(style_edit_save(e, folder, "Oak, in red!", &name, &error));
	g_assert_no_error(error);
	g_assert_cmpstr(name, ==, "oak-in-red");
	g_assert_true(style_edit_save(e, folder, "Oak in red", &again, &error));
	g_assert_cmpstr(again, ==, "oak-in-red-2");
	g_autoptr(style) s = style_find(name, folder, &error);
	g_assert_no_error(error);
	g_assert_cmpstr(s->title, ==, "Oak, in red!");
	/* What was saved is gone on with. */
	g_autoptr(style_edit) more = style_edit_new(name, folder, &error);
	g_autoptr(GArray) steps = steps_of(more, folder, SEGMENT_SITE);
	g_assert_cmpfloat(find(steps, "details")->ink.length_px, ==, 17);
	g_assert_true(files_remove_tree(folder, NULL));
}

static void test_refuses(void)
{
	g_autofree char *folder = site_folder(), *name = NULL;
	g_autoptr(GError) error = NULL;
	g_autoptr(style_edit) none = style_edit_new("no-such-style", folder, &error);
	g_assert_null(none);
	g_assert_error(error, STYLE_ERROR, STYLE_ERROR_UNKNOWN);
	g_clear_error(&error);
	g_autoptr(style_edit) e = style_edit_new("points", folder, &error);
	style_edit_change(e, "site", "no-such-step", "opacity", number(1));
	g_assert_false(style_edit_save(e, folder, "Broken", &name, &error));
	g_assert_nonnull(error);
	g_assert_null(name);
	g_clear_error(&error);
	g_assert_null(style_edit_parse("[1, 2]", &error));
	g_assert_error(error, STYLE_ERROR, STYLE_ERROR_JSON);
	g_assert_true(files_remove_tree(folder, NULL));
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/style-edit/change", test_change);
	g_test_add_func("/style-edit/steps", test_steps);
	g_test_add_func("/style-edit/changes-a-listed-step", test_changes_a_listed_step);
	g_test_add_func("/style-edit/accents", test_accents);
	g_test_add_func("/style-edit/save", test_save);
	g_test_add_func("/style-edit/refuses", test_refuses);
	return g_test_run();
}
