/* The boxes that views of small models are found by, and what comes of them: a thing fills its picture, and is seen from where it was
 * scanned. */
#include "firmware-io/crc32c.h"
#include "firmware-io/files.h"
#include "render/view-find.h"
#include "tests/support.h"
#include <json-glib/json-glib.h>
#include <math.h>

#define POINTS 3000u
#define WIDE_M 2.f /* of a plate that stands in the plane x = 7 */
#define HIGH_M 1.f
#define AT_M   7.0

static model *model_of(const char *folder, const struct model_point *point, uint32_t count)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *path = g_build_filename(folder, "plate.model", NULL);
	struct model_chunk chunk = { .centre_m = { AT_M, 0, 0 },
		.half_size_m = { 0, WIDE_M / 2, HIGH_M / 2 },
		.points = count,
		.crc32c = crc32c(0, point, count * sizeof *point) };
	g_autoptr(product_writer) w = product_writer_new(path, &error);
	g_assert_no_error(error);
	g_assert_true(
		product_writer_begin(w, "points", sizeof *point, &error) &&
		product_writer_append(w, point, count, &error) &&
		product_writer_begin(w, "chunks", sizeof chunk, &error) &&
		product_writer_append(w, &chunk, 1, &error) &&
		product_writer_finish(w, MODEL_KIND, MODEL_VERSION, json_object_new(), &error));
	model *m = model_open_file(path, &error);
	g_assert_no_error(error);
	return m;
}

/* facing: +1, -1, or 0 for no normals. */
static model *plate_of(const char *folder, float facing)
{
	g_autofree struct model_point *point = g_new0(struct model_point, POINTS);
	for (uint32_t i = 0; i < POINTS; i++) {
		point[i].position_m[1] = (float)g_test_rand_double_range(-0.5, 0.5) * WIDE_M;
		point[i].position_m[2] = (float)g_test_rand_double_range(-0.5, 0.5) * HIGH_M;
		model_pack_normal((float[3]){ facing, 0, 0 }, point[i].normal);
	}
	return model_of(folder, point, POINTS);
}

struct place {
	char *folder;
};

static void set_up(struct place *p, gconstpointer data)
{
	(void)data;
	p->folder = g_dir_make_tmp("test-view-boxes-XXXXXX", NULL);
}

static void tear_down(struct place *p, gconstpointer data)
{
	(void)data;
	g_assert_true(files_remove_tree(p->folder, NULL));
	g_free(p->folder);
}

static void test_boxes(struct place *p, gconstpointer data)
{
	g_autoptr(model) m = plate_of(p->folder, -1);
	g_autoptr(view_boxes) b = view_boxes_new(m);
	uint64_t points = 0;
	(void)data;
	g_assert_cmpuint(b->count, ==, 16); /* one deep */
	for (uint64_t n = 0; n < b->count; n++) {
		const struct model_chunk *box = &b->box[n];
		points += box->points;
		g_assert_cmpfloat_with_epsilon(box->centre_m[0], AT_M, 1e-6);
		g_assert_cmpfloat(box->half_size_m[1], <=, WIDE_M / 8 + 1e-6);
		g_assert_cmpfloat(box->half_size_m[2], <=, HIGH_M / 8 + 1e-6);
		g_assert_cmpfloat(fabs(box->centre_m[1]) + box->half_size_m[1], <=, WIDE_M / 2);
		g_assert_cmpfloat_with_epsilon(b->facing[n][0], -1, 1e-3);
	}
	g_assert_cmpuint(points, >, POINTS - 20);
	g_assert_cmpuint(points, <=, POINTS);
}

/* Points that are nowhere are in no box. */
static void test_nowhere(struct place *p, gconstpointer data)
{
	struct model_point nowhere[3] = { { .position_m = { NAN, 0, 0 } },
		{ .position_m = { 0, INFINITY, 0 } }, { .position_m = { 0, 0, -INFINITY } } };
	g_autoptr(model) m = model_of(p->folder, nowhere, 3);
	(void)data;
	g_assert_null(view_boxes_new(m));
}

/* How much of the picture's width and height its corners are apart. */
static void assert_fills(const struct camera *c)
{
	double low[2] = { INFINITY, INFINITY }, high[2] = { -INFINITY, -INFINITY };
	for (int corner = 0; corner < 4; corner++) {
		double px[2] = { 0 }, depth_m = 0,
		       at[3] = { AT_M, (corner & 1 ? 0.5 : -0.5) * (double)WIDE_M,
			       (corner & 2 ? 0.5 : -0.5) * (double)HIGH_M };
		g_assert_true(camera_project(c, at, px, &depth_m));
		for (int k = 0; k < 2; k++) {
			low[k] = fmin(low[k], px[k]);
			high[k] = fmax(high[k], px[k]);
		}
	}
	double part = fmax((high[0] - low[0]) / c->width, (high[1] - low[1]) / c->height);
	g_assert_cmpfloat(part, >, 0.85);
	g_assert_cmpfloat(part, <, 1);
}

static void test_seen_from_its_face(struct place *p, gconstpointer data)
{
	(void)data;
	for (int facing = -1; facing <= 1; facing += 2) {
		g_autoptr(model) m = plate_of(p->folder, (float)facing);
		g_autoptr(view_boxes) b = view_boxes_new(m);
		struct view_sources s = { .boxes = b, .aspect = 1.5 };
		g_autoptr(view) v = view_built_in(&s, "overview");
		struct camera c = view_camera(v, 600, 400);
		g_assert_cmpfloat(facing * (v->eye_m[0] - AT_M), >, 0.5);
		assert_fills(&c);
	}
}

static void test_no_normals(struct place *p, gconstpointer data)
{
	g_autoptr(model) m = plate_of(p->folder, 0);
	g_autoptr(view_boxes) b = view_boxes_new(m);
	struct view_sources s = { .boxes = b, .aspect = 1.5 };
	g_autoptr(view) v = view_built_in(&s, "overview");
	struct camera c = view_camera(v, 600, 400);
	(void)data;
	g_assert_cmpfloat(b->facing[0][0], ==, 0);
	assert_fills(&c);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add("/view-boxes/boxes", struct place, NULL, set_up, test_boxes, tear_down);
	g_test_add("/view-boxes/nowhere", struct place, NULL, set_up, test_nowhere, tear_down);
	g_test_add("/view-boxes/seen-from-its-face", struct place, NULL, set_up,
		test_seen_from_its_face, tear_down);
	g_test_add(
		"/view-boxes/no-normals", struct place, NULL, set_up, test_no_normals, tear_down);
	return g_test_run();
}
