/* Which numbers things keep when they are found anew: made trees, of a row of cells each. */
#include "process/segment-numbers.h"
#include <string.h>

#define CELLS 1000

struct world {
	segments *tree;
	uint16_t leaf[CELLS];
};

static struct world *world_new(const char *key)
{
	struct world *w = g_new0(struct world, 1);
	w->tree = segments_new();
	g_free(w->tree->key);
	w->tree->key = g_strdup(key);
	return w;
}

static void world_free(struct world *w)
{
	segments_free(w->tree);
	g_free(w);
}
typedef struct world world;
G_DEFINE_AUTOPTR_CLEANUP_FUNC(world, world_free)

static uint32_t add_below(struct world *w, uint32_t parent, const char *name, int from, int to)
{
	uint32_t id = segments_add(w->tree, parent, name, "rules");
	segments_find(w->tree, id)->found = id;
	for (int i = from; i < to; i++)
		w->leaf[i] = (uint16_t)id;
	return id;
}

static uint32_t add(struct world *w, enum segment_class class, const char *name, int from, int to)
{
	return add_below(w, segment_of_class(class), name, from, to);
}

struct numbers {
	uint16_t becomes[SEGMENTS_MAX + 1];
	uint32_t next;
	bool good;
};

static struct numbers *find_from(const struct world *was, const struct world *now, uint32_t next)
{
	struct numbers *r = g_new0(struct numbers, 1);
	g_autoptr(segment_numbers) n = segment_numbers_new(was->tree, now->tree);
	segment_numbers_count(n, was->leaf, now->leaf, CELLS);
	r->next = next;
	r->good = segment_numbers_find(n, &r->next, r->becomes);
	return r;
}

/* No two become one, and what is new gets what none had. */
static struct numbers *find(const struct world *was, const struct world *now)
{
	struct numbers *r = find_from(was, now, was->tree->next);
	g_autofree bool *is_taken = g_new0(bool, SEGMENTS_MAX + 1);
	g_assert_true(r->good);
	for (guint i = 0; i < now->tree->nodes->len; i++) {
		uint32_t id = g_array_index(now->tree->nodes, struct segment, i).id;
		uint32_t as = r->becomes[id];
		g_assert_true(id >= SEGMENT_FIRST || as == id);
		g_assert_false(is_taken[as]);
		is_taken[as] = true;
		g_assert_cmpuint(as, <, r->next);
		g_assert_true(segments_find(was->tree, as) || as >= was->tree->next);
	}
	g_assert_cmpuint(r->becomes[SEGMENT_NONE], ==, SEGMENT_NONE);
	return r;
}

/* ---- tests ---- */

/* In another order, with borders moved, one gone, one new. */
static void test_moved(void)
{
	g_autoptr(world) was = world_new("a"), now = world_new("b");
	uint32_t tree = add(was, CLASS_VEGETATION, "Tree 1", 0, 100),
		 bush = add(was, CLASS_VEGETATION, "Bush 1", 100, 200),
		 car = add(was, CLASS_STRUCTURE, "Structure 1", 300, 400);
	uint32_t fence = add(now, CLASS_STRUCTURE, "Structure 1", 500, 700),
		 bush_now = add(now, CLASS_VEGETATION, "Tree 1", 120, 220),
		 tree_now = add(now, CLASS_VEGETATION, "Tree 2", 0, 120);
	g_autofree struct numbers *n = find(was, now);
	g_assert_cmpuint(n->becomes[tree_now], ==, tree);
	g_assert_cmpuint(n->becomes[bush_now], ==, bush);
	g_assert_cmpuint(n->becomes[fence], ==, car + 1);
	g_assert_cmpuint(n->next, ==, car + 2);
}

/* The number of what is gone stays free also when the next one is just as large. */
static void test_gone(void)
{
	g_autoptr(world) was = world_new("a"), now = world_new("b");
	add(was, CLASS_STRUCTURE, "Structure 1", 0, 100);
	add(was, CLASS_STRUCTURE, "Structure 2", 100, 200);
	uint32_t other = add(now, CLASS_STRUCTURE, "Structure 1", 300, 400);
	was->tree->next = 77;
	g_autofree struct numbers *n = find(was, now);
	g_assert_cmpuint(n->becomes[other], ==, 77);
	g_assert_cmpuint(n->next, ==, 78);
}

/* In two: the larger one is it. Too little of it, and none is. */
static void test_split(void)
{
	g_autoptr(world) was = world_new("a"), now = world_new("b"), crumbs = world_new("c");
	uint32_t tree = add(was, CLASS_VEGETATION, "Tree 1", 0, 100);
	uint32_t small = add(now, CLASS_VEGETATION, "Tree 1", 0, 45),
		 large = add(now, CLASS_VEGETATION, "Tree 2", 45, 100);
	g_autofree struct numbers *n = find(was, now);
	g_assert_cmpuint(n->becomes[large], ==, tree);
	g_assert_cmpuint(n->becomes[small], ==, tree + 1);
	for (int k = 0; k < 4; k++)
		add(crumbs, CLASS_VEGETATION, "Tree", 25 * k, 25 * k + 25);
	g_autofree struct numbers *none = find(was, crumbs);
	for (uint32_t id = SEGMENT_FIRST; id < SEGMENT_FIRST + 4; id++)
		g_assert_cmpuint(none->becomes[id], >, tree);
}

/* Two as one: it is the larger one. */
static void test_merged(void)
{
	g_autoptr(world) was = world_new("a"), now = world_new("b");
	add(was, CLASS_BUILDING, "Building 1", 0, 40);
	uint32_t large = add(was, CLASS_BUILDING, "Building 2", 40, 100);
	uint32_t both = add(now, CLASS_BUILDING, "Building 1", 0, 100);
	g_autofree struct numbers *n = find(was, now);
	g_assert_cmpuint(n->becomes[both], ==, large);
}

/* The greatest share first, not the first one that would do. */
static void test_greatest(void)
{
	g_autoptr(world) was = world_new("a"), now = world_new("b");
	uint32_t one = add(was, CLASS_OTHER, "Thing 1", 0, 100),
		 two = add(was, CLASS_OTHER, "Thing 2", 100, 210);
	uint32_t both = add(now, CLASS_OTHER, "Thing 1", 50, 200),
		 left = add(now, CLASS_OTHER, "Thing 2", 0, 50);
	g_autofree struct numbers *n = find(was, now);
	g_assert_cmpuint(n->becomes[both], ==, two); /* 100 of 160, not 50 of 200 */
	g_assert_cmpuint(n->becomes[left], ==, one); /* 50 of 100 */
}

/* Another class is the same thing all the same. */
static void test_class(void)
{
	g_autoptr(world) was = world_new("a"), now = world_new("b");
	uint32_t bush = add(was, CLASS_VEGETATION, "Bush 1", 0, 100);
	uint32_t hedge = add(now, CLASS_STRUCTURE, "Structure 1", 0, 100);
	g_autofree struct numbers *n = find(was, now);
	g_assert_cmpuint(n->becomes[hedge], ==, bush);
}

/* What is left over of a class is no thing, and stays what it is however much it changes. */
static void test_rest(void)
{
	g_autoptr(world) was = world_new("a"), now = world_new("b");
	uint32_t ground = add(was, CLASS_TERRAIN, "Ground", 0, 500),
		 rest = add(was, CLASS_STRUCTURE, "Small structures", 500, 600);
	uint32_t pole = add(now, CLASS_STRUCTURE, "Structure 1", 500, 595),
		 rest_now = add(now, CLASS_STRUCTURE, "Small structures", 595, 900),
		 ground_now = add(now, CLASS_TERRAIN, "Ground", 0, 60);
	g_autofree struct numbers *n = find(was, now);
	g_assert_cmpuint(n->becomes[ground_now], ==, ground);
	g_assert_cmpuint(n->becomes[rest_now], ==, rest);
	g_assert_cmpuint(n->becomes[pole], ==, rest + 1);
}

/* A house that is nearly all one wall: things are compared with things, parts with parts. */
static void test_parts(void)
{
	g_autoptr(world) was = world_new("a"), now = world_new("b");
	uint32_t house = add(was, CLASS_BUILDING, "Building 1", 0, 0),
		 wall = add_below(was, house, "Wall 1", 0, 190),
		 details = add_below(was, house, "Details", 190, 200);
	uint32_t other_now = add(now, CLASS_BUILDING, "Building 1", 600, 900),
		 house_now = add(now, CLASS_BUILDING, "Building 2", 0, 0),
		 details_now = add_below(now, house_now, "Details", 190, 202),
		 roof_now = add_below(now, house_now, "Roof 1", 202, 230),
		 wall_now = add_below(now, house_now, "Wall 1", 0, 190);
	g_autofree struct numbers *n = find(was, now);
	g_assert_cmpuint(n->becomes[house_now], ==, house);
	g_assert_cmpuint(n->becomes[wall_now], ==, wall);
	g_assert_cmpuint(n->becomes[details_now], ==, details);
	g_assert_cmpuint(n->becomes[other_now], ==, details + 1);
	g_assert_cmpuint(n->becomes[roof_now], ==, details + 2);
}

/* A house that becomes a part of a larger one: where no part was it, the part has its number. */
static void test_other_depth(void)
{
	g_autoptr(world) was = world_new("a"), now = world_new("b");
	uint32_t shed = add(was, CLASS_BUILDING, "Building 2", 0, 100);
	uint32_t house = add(now, CLASS_BUILDING, "Building 1", 0, 0),
		 wall = add_below(now, house, "Wall 1", 0, 100),
		 rest = add_below(now, house, "Details", 100, 900);
	g_autofree struct numbers *n = find(was, now);
	g_assert_cmpuint(n->becomes[wall], ==, shed);
	g_assert_cmpuint(n->becomes[house], ==, shed + 1);
	g_assert_cmpuint(n->becomes[rest], ==, shed + 2);
}

/* Found of the same: by their order, whatever the labels say, of which some may be lost. */
static void test_order(void)
{
	g_autoptr(world) was = world_new("a"), now = world_new("a");
	uint32_t tree = add(was, CLASS_VEGETATION, "Tree 1", 0, 0),
		 bush = add(was, CLASS_VEGETATION, "Bush 1", 0, 0);
	segments_find(was->tree, tree)->found = bush;
	segments_find(was->tree, bush)->found = tree;
	add(now, CLASS_VEGETATION, "Bush 1", 0, 100);
	add(now, CLASS_VEGETATION, "Tree 1", 100, 300);
	g_autofree struct numbers *n = find(was, now);
	g_assert_cmpuint(n->becomes[tree], ==, bush);
	g_assert_cmpuint(n->becomes[bush], ==, tree);
	g_assert_cmpuint(n->next, ==, was->tree->next);
	/* of others, by the labels */
	g_free(now->tree->key);
	now->tree->key = g_strdup("b");
	g_autofree struct numbers *other = find(was, now);
	g_assert_cmpuint(other->becomes[tree], >, bush);
}

/* Labels of leaves that are in no tree, as when files are of different times. */
static void test_strange_labels(void)
{
	g_autoptr(world) was = world_new("a"), now = world_new("b");
	uint32_t tree = add(was, CLASS_VEGETATION, "Tree 1", 0, 100);
	uint32_t tree_now = add(now, CLASS_VEGETATION, "Tree 1", 0, 300);
	for (int i = 100; i < CELLS; i++)
		was->leaf[i] = 60000;
	was->leaf[999] = SEGMENTS_MAX;
	g_autofree struct numbers *n = find(was, now);
	g_assert_cmpuint(n->becomes[tree_now], ==, tree);
}

/* When all numbers were used, those that nothing has are used again, and not that of what was there. */
static void test_used_up(void)
{
	g_autoptr(world) was = world_new("a"), now = world_new("b"), full = world_new("c");
	add(was, CLASS_VEGETATION, "Tree 1", 0, 100);
	add(was, CLASS_VEGETATION, "Tree 2", 100, 200);
	uint32_t tree = add(now, CLASS_VEGETATION, "Tree 1", 100, 200),
		 other = add(now, CLASS_VEGETATION, "Tree 2", 500, 600),
		 last = add(now, CLASS_VEGETATION, "Tree 3", 600, 700);
	g_autofree struct numbers *n = find_from(was, now, SEGMENTS_MAX);
	g_assert_true(n->good);
	g_assert_cmpuint(n->becomes[tree], ==, SEGMENT_FIRST + 1);
	g_assert_cmpuint(n->becomes[other], ==, SEGMENTS_MAX);
	g_assert_cmpuint(n->becomes[last], ==, SEGMENT_FIRST + 2);
	g_assert_cmpuint(n->next, ==, SEGMENTS_MAX + 1);
	while (segments_add(full->tree, segment_of_class(CLASS_OTHER), "Thing", "rules"))
		;
	g_autofree struct numbers *none = find_from(full, now, full->tree->next);
	g_assert_false(none->good);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/segment-numbers/moved", test_moved);
	g_test_add_func("/segment-numbers/gone", test_gone);
	g_test_add_func("/segment-numbers/split", test_split);
	g_test_add_func("/segment-numbers/merged", test_merged);
	g_test_add_func("/segment-numbers/greatest", test_greatest);
	g_test_add_func("/segment-numbers/class", test_class);
	g_test_add_func("/segment-numbers/rest", test_rest);
	g_test_add_func("/segment-numbers/parts", test_parts);
	g_test_add_func("/segment-numbers/other-depth", test_other_depth);
	g_test_add_func("/segment-numbers/order", test_order);
	g_test_add_func("/segment-numbers/strange-labels", test_strange_labels);
	g_test_add_func("/segment-numbers/used-up", test_used_up);
	return g_test_run();
}
