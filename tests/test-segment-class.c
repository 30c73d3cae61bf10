/* Names of classes, and those of LAS 1.4. */
#include "process/segment-class.h"
#include <glib.h>

static void test_las(void)
{
	/* ASPRS LAS 1.4 R15, table 17; 26 as the Dutch elevation model has it */
	static const int8_t wanted[] = { [0] = -1,
		[1] = -1,
		[2] = CLASS_TERRAIN,
		[3] = CLASS_VEGETATION,
		[4] = CLASS_VEGETATION,
		[5] = CLASS_VEGETATION,
		[6] = CLASS_BUILDING,
		[7] = CLASS_OTHER,
		[8] = CLASS_TERRAIN,
		[9] = CLASS_WATER,
		[10] = CLASS_STRUCTURE,
		[11] = CLASS_TERRAIN,
		[12] = -1,
		[13] = CLASS_STRUCTURE,
		[14] = CLASS_STRUCTURE,
		[15] = CLASS_STRUCTURE,
		[16] = CLASS_STRUCTURE,
		[17] = CLASS_STRUCTURE,
		[18] = CLASS_OTHER,
		[19] = CLASS_STRUCTURE };
	for (size_t i = 0; i < G_N_ELEMENTS(wanted); i++)
		g_assert_cmpint(segment_class_from_las((uint8_t)i), ==, wanted[i]);
	for (int i = 20; i < 256; i++)
		g_assert_cmpint(
			segment_class_from_las((uint8_t)i), ==, i == 26 ? CLASS_STRUCTURE : -1);
}

static void test_names(void)
{
	for (int i = 0; i < SEGMENT_CLASSES; i++) {
		g_assert_cmpint(segment_class_find(segment_classes[i].name), ==, i);
		g_assert_nonnull(segment_classes[i].title);
		for (int k = 0; k < i; k++)
			g_assert_true(segment_classes[i].rgb[0] != segment_classes[k].rgb[0] ||
				      segment_classes[i].rgb[1] != segment_classes[k].rgb[1]);
	}
	g_assert_cmpint(segment_class_find("Buildings"), ==, -1);
	g_assert_cmpint(segment_class_find(""), ==, -1);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/segment-class/las", test_las);
	g_test_add_func("/segment-class/names", test_names);
	return g_test_run();
}
