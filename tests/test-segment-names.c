/* Which names things keep when they are found anew: made trees. */
#include "process/segment-names.h"

/* With this number, whichever that is. */
static void put(segments *s, uint32_t id, uint32_t parent, const char *name)
{
	s->next = id;
	g_assert_cmpuint(segments_add(s, parent, name, "rules"), ==, id);
}

static void expect(const segments *s, uint32_t id, const char *name)
{
	g_assert_cmpstr(segments_find(s, id)->name, ==, name);
}

enum {
	STRUCTURES = 2 + CLASS_STRUCTURE,
	BUILDINGS = 2 + CLASS_BUILDING,
	PLANTS = 2 + CLASS_VEGETATION,
	TERRAIN = 2 + CLASS_TERRAIN
};

/* What is there has its name, what is new the next one; the name of what is gone goes to nothing. */
static void test_kept(void)
{
	g_autoptr(segments) was = segments_new(), now = segments_new();
	put(was, 20, PLANTS, "Tree 1");
	put(was, 21, PLANTS, "Tree 2");
	put(was, 22, PLANTS, "Tree 7");
	put(was, 23, PLANTS, "Bush 1");
	put(now, 21, PLANTS, "Tree 3");
	put(now, 20, PLANTS, "Tree 1");
	put(now, 23, PLANTS, "Bush 4");
	put(now, 30, PLANTS, "Tree 2");
	put(now, 31, PLANTS, "Tree 4");
	put(now, 32, PLANTS, "Bush 1");
	segment_names_keep(was, now);
	expect(now, 20, "Tree 1");
	expect(now, 21, "Tree 2");
	expect(now, 23, "Bush 1");
	expect(now, 30, "Tree 8");
	expect(now, 31, "Tree 9");
	expect(now, 32, "Bush 2");
}

/* The same thing, but of another kind: that is what it is called. */
static void test_other_kind(void)
{
	g_autoptr(segments) was = segments_new(), now = segments_new();
	put(was, 20, PLANTS, "Bush 3");
	put(was, 21, STRUCTURES, "Structure 1");
	put(was, 22, PLANTS, "Tree 5");
	put(now, 20, PLANTS, "Tree 2");
	put(now, 21, BUILDINGS, "Building 1");
	put(now, 22, PLANTS, "Tree 1");
	put(now, 23, STRUCTURES, "Structure 1");
	segment_names_keep(was, now);
	expect(now, 20, "Tree 6");
	expect(now, 21, "Building 1");
	expect(now, 22, "Tree 5");
	expect(now, 23, "Structure 2");
}

/* Parts are numbered in each building. */
static void test_parts(void)
{
	g_autoptr(segments) was = segments_new(), now = segments_new();
	put(was, 20, BUILDINGS, "Building 1");
	put(was, 21, 20, "Wall 1");
	put(was, 22, 20, "Roof 2");
	put(was, 23, 20, "Details");
	put(was, 24, BUILDINGS, "Building 2");
	put(was, 25, 24, "Wall 1");
	put(now, 20, BUILDINGS, "Building 2");
	put(now, 22, 20, "Roof 1");
	put(now, 25, 20, "Wall 2"); /* of the other one before */
	put(now, 26, 20, "Wall 3");
	put(now, 27, 20, "Details");
	put(now, 30, BUILDINGS, "Building 1");
	put(now, 31, 30, "Wall 1");
	put(now, 21, 30, "Wall 2");
	segment_names_keep(was, now);
	expect(now, 20, "Building 1");
	expect(now, 22, "Roof 2");
	expect(now, 25, "Wall 2");
	expect(now, 26, "Wall 3");
	expect(now, 27, "Details");
	expect(now, 30, "Building 3");
	expect(now, 21, "Wall 1");
	expect(now, 31, "Wall 2");
}

/* Without numbers, and with what people or strange files say. */
static void test_strange(void)
{
	g_autoptr(segments) was = segments_new(), now = segments_new();
	put(was, 20, TERRAIN, "Ground");
	put(was, 21, PLANTS, "Old oak");
	put(was, 22, PLANTS, "Tree 18446744073709551616");
	put(was, 23, PLANTS, "");
	put(was, 24, PLANTS, " 3");
	put(was, 25, PLANTS, "Tree 9223372036854775807");
	put(now, 20, TERRAIN, "Ground");
	put(now, 21, PLANTS, "Tree 2");
	put(now, 22, PLANTS, "Undergrowth");
	put(now, 23, PLANTS, "Bush 1");
	put(now, 24, PLANTS, "Bush 2");
	segment_names_keep(was, now);
	expect(now, 20, "Ground");
	expect(now, 21, "Tree 9223372036854775808");
	expect(now, 22, "Undergrowth");
	expect(now, 23, "Bush 1");
	expect(now, 24, "Bush 2");
	expect(now, segment_of_class(CLASS_TERRAIN), segment_classes[CLASS_TERRAIN].title);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/segment-names/kept", test_kept);
	g_test_add_func("/segment-names/other-kind", test_other_kind);
	g_test_add_func("/segment-names/parts", test_parts);
	g_test_add_func("/segment-names/strange", test_strange);
	return g_test_run();
}
