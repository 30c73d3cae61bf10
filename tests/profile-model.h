#ifndef TESTS_PROFILE_MODEL_H
#define TESTS_PROFILE_MODEL_H
/* Models of few points, for tests of profile lines. */
#include "process/model-write.h"
#include "process/model.h"
#include "tests/simulated.h"
#include <json-glib/json-glib.h>
#include <math.h>

static inline double gauss(GRand *r)
{
	return sqrt(-2 * log(1 - g_rand_double(r))) * cos(2 * G_PI * g_rand_double(r));
}

static inline int by_order(const void *a, const void *b)
{
	return part_point_compare(a, b);
}

/* Points of this leaf are of scan 2, others of scan 1. */
#define SECOND_LEAF 21

/* Of all points, with what the manifest says of where they were seen from; NULL: nothing. */
static inline model *write_model(GArray *all, JsonArray *made_from)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *folder = simulated_folder();
	g_autofree char *path = g_build_filename(folder, "points.model", NULL);
	JsonObject *made = json_object_new();
	if (made_from)
		json_object_set_array_member(made, "made_from", made_from);
	g_array_sort(all, by_order);
	g_autoptr(model_writer) w = model_writer_new(path, 0, &error);
	for (guint n = 0; n < all->len; n++) {
		const struct part_point *p = &g_array_index(all, struct part_point, n);
		g_assert_true(model_writer_add(w, p, p->leaf == SECOND_LEAF ? 2 : 1, NULL));
	}
	g_assert_true(model_writer_finish(w, NULL, 0, made, NULL));
	model *m = model_open_file(path, &error);
	g_assert_no_error(error);
	return m;
}

/* Of one scan, from a scanner that stands upright there. */
static inline JsonArray *made_from_one(const double scanner_m[3])
{
	JsonArray *scans = json_array_new(), *pose = json_array_new();
	JsonObject *scan = json_object_new();
	for (int n = 0; n < 12; n++)
		json_array_add_double_element(pose, n < 9 ? n % 4 == 0 : scanner_m[n - 9]);
	json_object_set_int_member(scan, "scan", 1);
	json_object_set_array_member(scan, "pose", pose);
	json_array_add_object_element(scans, scan);
	return scans;
}

#endif
