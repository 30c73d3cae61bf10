/* What a thing that stands alone is: its size, and what it touches, tell. */
#include "process/classify-thing.h"
#include <glib.h>

/* One on the ground that touches nothing and is of no colour. */
static struct thing standing(float high_m, double length_m, double width_m)
{
	return (struct thing){
		.low_m = 0.3f, .high_m = high_m, .length_m = length_m, .width_m = width_m
	};
}

static int class_of(const struct thing *t, uint32_t count)
{
	const struct component c = { .voxels = count };
	return classify_thing(t, &c);
}

static void test_people_and_cars(void)
{
	const struct thing person = standing(1.7f, 0.5, 0.3), car = standing(1.5f, 4.2, 1.7),
			   rear = standing(1.6f, 1.7, 0.2), post = standing(3.9f, 0.3, 0.3),
			   bench = standing(0.9f, 2, 0.7);
	g_assert_cmpint(class_of(&person, 80), ==, CLASS_OTHER);
	g_assert_cmpint(class_of(&car, 300), ==, CLASS_OTHER);
	g_assert_cmpint(class_of(&rear, 100), ==, CLASS_OTHER);
	g_assert_cmpint(class_of(&post, 140), ==, CLASS_STRUCTURE);
	g_assert_cmpint(class_of(&bench, 170), ==, CLASS_STRUCTURE);
}

/* As wide and high as the rear of a car, but not alone. */
static void test_not_a_rear(void)
{
	struct thing t = standing(1.6f, 1.7, 0.2);
	t.contacts[CLASS_STRUCTURE] = 5;
	g_assert_cmpint(class_of(&t, 100), ==, CLASS_STRUCTURE);
	t = standing(1.6f, 1.7, 0.2);
	t.near_building = true;
	g_assert_cmpint(class_of(&t, 100), ==, CLASS_STRUCTURE);
}

static void test_fragment_of_a_front(void)
{
	struct thing t = standing(2.5f, 0.8, 0.2);
	g_assert_cmpint(class_of(&t, 28), ==, CLASS_STRUCTURE);
	t.in_line = true;
	g_assert_cmpint(class_of(&t, 28), ==, CLASS_BUILDING);
	t.high_m = 0.9f; /* a bollard, a bin */
	g_assert_cmpint(class_of(&t, 28), ==, CLASS_STRUCTURE);
}

/* Trunk and limbs together are wider than a trunk; a lamp post passes a crown with less about it. */
static void test_limbs(void)
{
	struct thing t = standing(6.1f, 1.19, 1.12);
	t.contacts[CLASS_VEGETATION] = 1900;
	g_assert_cmpint(class_of(&t, 425), ==, CLASS_VEGETATION);
	t.contacts[CLASS_VEGETATION] = 400;
	g_assert_cmpint(class_of(&t, 425), !=, CLASS_VEGETATION);
	t = standing(5, 0.4, 0.3);
	t.contacts[CLASS_VEGETATION] = 60;
	g_assert_cmpint(class_of(&t, 150), ==, CLASS_VEGETATION);
	t.contacts[CLASS_STRUCTURE] = 80;
	g_assert_cmpint(class_of(&t, 150), ==, CLASS_STRUCTURE);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/classify-thing/people-and-cars", test_people_and_cars);
	g_test_add_func("/classify-thing/not-a-rear", test_not_a_rear);
	g_test_add_func("/classify-thing/fragment-of-a-front", test_fragment_of_a_front);
	g_test_add_func("/classify-thing/limbs", test_limbs);
	return g_test_run();
}
