/* What leaves inherit from a style: replaced, changed, removed and added steps, by class, name and number; and which of them are
 * drawn as one. */
#include "render/style.h"
#include <string.h>

/* Two trees, one of them in parts, and a house with what a person drew in it. */
enum { TREE_1 = 16, TREE_2, TRUNK, CROWN, HOUSE, WALL, DOOR, HANDLE };
static const struct {
	uint32_t parent;
	const char *name;
} things[] = { { 4, "Tree 1" }, { 4, "Tree 2" }, { TREE_2, "Trunk" }, { TREE_2, "Crown" },
	{ 3, "House" }, { HOUSE, "Wall" }, { WALL, "Door" }, { DOOR, "Handle" } };

static segments *make_tree(void)
{
	segments *s = segments_new();
	g_assert_cmpuint(segment_of_class(CLASS_VEGETATION), ==, 4);
	g_assert_cmpuint(segment_of_class(CLASS_BUILDING), ==, 3);
	for (size_t i = 0; i < G_N_ELEMENTS(things); i++)
		g_assert_cmpuint(
			segments_add(s, things[i].parent, things[i].name, "user"), ==, TREE_1 + i);
	return s;
}

static drawing *draw_with(const char *nodes, const segments *tree, char ***unused, GError **error)
{
	g_autofree char *text = g_strdup_printf("{\"schema\":1,\"segments\":{%s}}", nodes);
	g_autoptr(style) s = style_parse(text, -1, "x.json", error);
	g_assert_nonnull(s);
	return drawing_new(s, tree, unused, error);
}

static drawing *draw(const char *nodes)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(segments) tree = make_tree();
	drawing *d = draw_with(nodes, tree, NULL, &error);
	g_assert_no_error(error);
	return d;
}

static const struct pipeline *of(const drawing *d, uint32_t id)
{
	return &g_array_index(d->pipelines, struct pipeline, d->pipeline_of[id]);
}

/* "edges:30 points | edl" with lengths of ink. */
static void assert_steps(const drawing *d, uint32_t id, const char *wanted)
{
	const struct pipeline *p = of(d, id);
	g_autoptr(GString) text = g_string_new(NULL);
	for (uint32_t i = 0; i < p->layers + p->filters; i++) {
		g_string_append_printf(text, "%s%s%s", text->len ? " " : "",
			i == p->layers ? "| " : "", p->steps[i].id);
		if (step_parameter_find(p->steps[i].kind->parameters, "length_px"))
			g_string_append_printf(text, ":%g", (double)p->steps[i].ink.length_px);
	}
	g_assert_cmpstr(text->str, ==, wanted);
}

#define SITE                                                                                       \
	"\"site\":{\"steps\":[{\"step\":\"edl\"},{\"step\":\"strokes\",\"id\":\"edges\"},{"        \
	"\"step\":\"points\"}]}"

static void test_inherit(void)
{
	g_autoptr(drawing) d = draw(SITE);
	g_assert_cmpuint(d->pipelines->len, ==, 1);
	for (uint32_t id = 0; id <= SEGMENTS_MAX; id++)
		g_assert_cmpuint(d->pipeline_of[id], ==, 0);
	assert_steps(d, HANDLE, "edges:30 points | edl");
	g_assert_cmpfloat(of(d, 0)->mask.disc, ==, 1.5f);
	g_assert_cmpuint(of(d, 0)->layers, ==, 2);
	g_assert_cmpuint(of(d, 0)->filters, ==, 1);
}

static void test_override(void)
{
	g_autoptr(drawing) d =
		draw(SITE ",\"vegetation\":{\"change\":{\"edges\":{\"length_px\":50}}},"
			  "\"Tree 2\":{\"remove\":[\"points\"],\"add\":[{\"step\":\"sprites\"}]},"
			  "\"Crown\":{\"change\":{\"edges\":{\"length_px\":60},\"sprites\":{"
			  "\"length_px\":7}}},"
			  "\"building\":{\"steps\":[{\"step\":\"lines\",\"length_px\":8}]},"
			  "\"Wall\":{\"change\":{\"lines\":{\"length_px\":9}}},"
			  "\"#22\":{\"steps\":[]},"
			  "\"Handle\":{\"add\":[{\"step\":\"points\"}]},"
			  "\"water\":{\"change\":{\"mask\":{\"disc\":3}}}");
	assert_steps(d, 0, "edges:30 points | edl");
	assert_steps(d, 2, "edges:30 points | edl");
	assert_steps(d, TREE_1, "edges:50 points | edl");
	assert_steps(d, TRUNK, "edges:50 sprites:2.5 | edl");
	assert_steps(d, CROWN, "edges:60 sprites:7 | edl");
	assert_steps(d, HANDLE, "points");
	assert_steps(d, segment_of_class(CLASS_WATER), "edges:30 points | edl");
	g_assert_cmpfloat(of(d, segment_of_class(CLASS_WATER))->mask.disc, ==, 3);
	/* what is no leaf, is as the site */
	g_assert_cmpuint(d->pipeline_of[WALL], ==, 0);
	g_assert_cmpuint(d->pipeline_of[DOOR], ==, 0);
	g_assert_cmpuint(d->pipelines->len, ==, 6);
}

/* A step may make place for another one of its id; what is said by number counts last. */
static void test_order(void)
{
	g_autoptr(drawing) d = draw(SITE
		",\"#16\":{\"change\":{\"edges\":{\"length_px\":5}}},"
		"\"Tree 1\":{\"remove\":[\"edges\"],\"add\":[{\"step\":\"lines\",\"id\":\"edges\"},"
		"{\"step\":\"mask\",\"offset_m\":1}]}");
	assert_steps(d, TREE_1, "points edges:5 | edl");
	g_assert_cmpstr(of(d, TREE_1)->steps[1].kind->name, ==, "lines");
	g_assert_cmpfloat(of(d, TREE_1)->mask.offset_m, ==, 1);
	g_assert_cmpfloat(of(d, TREE_1)->mask.disc, ==, 1.5f);
}

/* Other names and other ways to the same are the same; the smallest difference is none. */
static void test_merge(void)
{
	g_autoptr(drawing) d = draw(
		"\"site\":{\"steps\":[{\"step\":\"points\",\"size\":2}]},"
		"\"vegetation\":{\"steps\":[{\"step\":\"points\",\"id\":\"p\",\"size\":3}]},"
		"\"Tree 1\":{\"change\":{\"p\":{\"size\":2.0}}},"
		"\"Crown\":{\"steps\":[{\"step\":\"points\",\"size\":3}]},"
		"\"water\":{\"steps\":[{\"step\":\"points\",\"size\":2},{\"step\":\"edl\"}]},"
		"\"terrain\":{\"steps\":[{\"step\":\"points\",\"size\":2,\"brightness\":0}]},"
		"\"other\":{\"steps\":[{\"step\":\"points\",\"size\":2,\"brightness\":-0.0}]},"
		"\"structure\":{\"steps\":[{\"step\":\"points\",\"size\":2},{\"step\":\"mask\"}]}");
	g_assert_cmpuint(d->pipelines->len, ==, 4);
	g_assert_cmpuint(d->pipeline_of[TREE_1], ==, 0);
	g_assert_cmpuint(d->pipeline_of[segment_of_class(CLASS_STRUCTURE)], ==, 0);
	g_assert_cmpuint(d->pipeline_of[CROWN], ==, d->pipeline_of[TRUNK]);
	g_assert_cmpuint(d->pipeline_of[segment_of_class(CLASS_TERRAIN)], ==,
		d->pipeline_of[segment_of_class(CLASS_OTHER)]);
	g_assert_cmpuint(d->pipeline_of[segment_of_class(CLASS_WATER)], !=, 0);
}

static void test_unused(void)
{
	static const char nodes[] = SITE
		",\"Tree 9\":{\"steps\":[]},\"#4000\":{},\"Tree 1\":{},\"#16\":{},\"water\":{}";
	g_autoptr(GError) error = NULL;
	g_autoptr(segments) tree = make_tree();
	g_auto(GStrv) unused = NULL, without = NULL;
	g_autoptr(drawing) d = draw_with(nodes, tree, &unused, &error);
	g_assert_no_error(error);
	g_autofree char *names = g_strjoinv(" ", unused);
	g_assert_cmpstr(names, ==, "Tree 9 #4000");
	g_autoptr(drawing) whole = draw_with(nodes, NULL, &without, &error);
	g_assert_no_error(error);
	g_autofree char *all = g_strjoinv(" ", without);
	g_assert_cmpstr(all, ==, "Tree 9 #4000 Tree 1 #16 water");
	g_assert_cmpuint(whole->pipelines->len, ==, 1);
	g_assert_cmpuint(whole->pipeline_of[TREE_1], ==, 0);
	assert_steps(whole, 0, "edges:30 points | edl");
}

/* What only this tree tells: the step is in the style, but not above this thing. */
static void test_not_inherited(void)
{
	static const char nodes[] = SITE ",\"vegetation\":{\"remove\":[\"edges\"]},"
					 "\n\"Trunk\":{\"change\":{\"edges\":{\"length_px\":9}}}";
	g_autoptr(GError) error = NULL;
	g_autoptr(segments) tree = make_tree(), other = segments_new();
	g_assert_null(draw_with(nodes, tree, NULL, &error));
	g_assert_error(error, STYLE_ERROR, STYLE_ERROR_FIELD);
	g_assert_cmpstr(error->message, ==,
		"x.json line 2: segments.Trunk.change.edges: no step with the id 'edges' is "
		"inherited "
		"here; there is mask, edl, points");
	g_clear_error(&error);
	g_autoptr(drawing) d = draw_with(nodes, other, NULL, &error);
	g_assert_no_error(error);
}

/* A thing that is called as a class is does not take what is said of the class; one called as the number of another neither. */
static void test_reserved_names(void)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(segments) tree = segments_new();
	uint32_t a = segments_add(tree, 4, "building", "user"),
		 b = segments_add(tree, 4, "#16", "user"),
		 c = segments_add(tree, 4, "site", "user");
	g_autoptr(drawing) d =
		draw_with(SITE ",\"building\":{\"steps\":[]},\"#16\":{\"remove\":[\"edl\"]}", tree,
			NULL, &error);
	g_assert_no_error(error);
	assert_steps(d, a, "edges:30 points");
	assert_steps(d, b, "edges:30 points | edl");
	assert_steps(d, c, "edges:30 points | edl");
}

static drawing *draw_many(uint32_t count, GError **error)
{
	g_autoptr(segments) tree = segments_new();
	g_autoptr(GString) nodes = g_string_new("\"site\":{\"steps\":[{\"step\":\"points\"}]}");
	for (uint32_t i = 0; i < count; i++) {
		g_autofree char *name = g_strdup_printf("Tree %u", i);
		segments_add(tree, 4, name, "rules");
		g_string_append_printf(nodes, ",\"%s\":{\"change\":{\"points\":{\"least_px\":%g}}}",
			name, 2 + 0.001 * i);
	}
	return draw_with(nodes->str, tree, NULL, error);
}

static void test_many(void)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(drawing) d = draw_many(254, &error);
	g_assert_no_error(error);
	g_assert_cmpuint(d->pipelines->len, ==, 255);
	g_assert_cmpuint(d->pipeline_of[SEGMENT_FIRST + 253], ==, 254);
	g_assert_null(draw_many(255, &error));
	g_assert_error(error, STYLE_ERROR, STYLE_ERROR_MANY);
	g_assert_cmpstr(error->message, ==,
		"x: more than 255 things would be drawn in different ways on this site");
}

/* A user's parts of parts, as deep as numbers go. */
static void test_deep(void)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(segments) tree = segments_new();
	uint32_t above = 4;
	for (int i = 0; i < 20000; i++)
		above = segments_add(tree, above, i == 10000 ? "Middle" : "Part", "user");
	g_autoptr(drawing) d = draw_with(
		SITE ",\"Middle\":{\"steps\":[{\"step\":\"sprites\"}]}", tree, NULL, &error);
	g_assert_no_error(error);
	assert_steps(d, above, "sprites:2.5");
	assert_steps(d, above - 1, "edges:30 points | edl");
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/drawing/inherit", test_inherit);
	g_test_add_func("/drawing/override", test_override);
	g_test_add_func("/drawing/order", test_order);
	g_test_add_func("/drawing/merge", test_merge);
	g_test_add_func("/drawing/unused", test_unused);
	g_test_add_func("/drawing/not-inherited", test_not_inherited);
	g_test_add_func("/drawing/reserved-names", test_reserved_names);
	g_test_add_func("/drawing/many", test_many);
	g_test_add_func("/drawing/deep", test_deep);
	return g_test_run();
}
