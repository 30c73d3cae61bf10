/* Plane regions of a wall with a window and of the ground before it: where they lie, their outlines, holes, colours, which points they
 * explain; the same on any number of threads; and their file. */
#include "process/plane-inside.h"
#include "tests/planes-made.h"
#ifdef _OPENMP
#include <gio/gio.h>
#include <omp.h>
#endif

static made room;
static plane_regions *found;

static const struct plane_region *of_normal(int axis)
{
	for (uint32_t n = 0; n < found->count; n++)
		if (fabsf(found->region[n].normal[axis]) > 0.9f)
			return &found->region[n];
	g_assert_not_reached();
}

static void test_count(void)
{
	g_assert_cmpuint(found->count, ==, 2);
	g_assert_cmpuint(found->points, ==, model_count(room.model));
	for (uint32_t n = 0; n < found->count; n++)
		g_assert_cmpuint(found->region[n].leaf, ==, MADE_LEAF);
}

static void assert_lies(const struct plane_region *r, const double at_m[3])
{
	double off = 0;
	for (int k = 0; k < 3; k++)
		off += (at_m[k] - r->origin_m[k]) * (double)r->normal[k];
	g_assert_cmpfloat(fabs(off), <, 0.002);
}

/* Towards where it is seen from; its own axes stand on each other. */
static void test_place(void)
{
	const struct plane_region *wall = of_normal(1), *ground = of_normal(2);
	static const double corner[][3] = { { 100, 203, 3 }, { 104, 203, 3 }, { 100, 203, 6 },
		{ 104, 203, 6 } };
	static const double flat[][3] = { { 100, 200, 3 }, { 104, 200, 3 }, { 104, 203, 3 } };
	for (size_t n = 0; n < G_N_ELEMENTS(corner); n++)
		assert_lies(wall, corner[n]);
	for (size_t n = 0; n < G_N_ELEMENTS(flat); n++)
		assert_lies(ground, flat[n]);
	g_assert_cmpfloat(wall->normal[1], <, -cosf(0.2f * G_PI / 180));
	g_assert_cmpfloat(ground->normal[2], >, cosf(0.2f * G_PI / 180));
	g_assert_cmpfloat(wall->v[2], >, 0.9999f);
	g_assert_cmpfloat(fabsf(wall->noise_m - (float)ROOM_NOISE_M), <, 0.001);
	g_assert_cmpfloat(wall->thickness_m, <, 0.02);
}

static void place_of(const struct plane_region *r, const float at[2], double ret_m[3])
{
	for (int k = 0; k < 3; k++)
		ret_m[k] = r->origin_m[k] + (double)(at[0] * r->u[k] + at[1] * r->v[k]);
}

/* The vertex of the region that is nearest to a place. */
static double nearest_m(const struct plane_region *r, const double at_m[3])
{
	double least = INFINITY;
	for (uint32_t n = r->first_ring; n < r->first_ring + r->rings; n++)
		for (uint32_t k = 0; k < found->ring[n].count; k++) {
			double there_m[3], away[3];
			place_of(r, found->vertex[found->ring[n].first + k], there_m);
			for (int i = 0; i < 3; i++)
				away[i] = there_m[i] - at_m[i];
			least = fmin(least, made_length(away));
		}
	return least;
}

/* Four corners of the wall and four of the window, and no vertex elsewhere; where it meets the ground to the millimetre. */
static void test_outline(void)
{
	const struct plane_region *wall = of_normal(1);
	uint32_t vertices = 0;
	g_assert_cmpuint(wall->rings, ==, 2);
	for (int n = 0; n < 4; n++) {
		double outer[3] = { n & 1 ? 104 : 100, 203, n & 2 ? 6 : 3 },
		       inner[3] = { n & 1 ? 102.2 : 101, 203, n & 2 ? 5.1 : 3.9 };
		g_test_message("corner %d: %.4f m, of the window %.4f m", n, nearest_m(wall, outer),
			nearest_m(wall, inner));
		g_assert_cmpfloat(nearest_m(wall, outer), <, 0.03);
		g_assert_cmpfloat(nearest_m(wall, inner), <, 0.035);
	}
	for (uint32_t n = 0; n < wall->rings; n++)
		vertices += found->ring[wall->first_ring + n].count;
	g_assert_cmpuint(vertices, <=, 10);
	g_assert_cmpfloat(wall->area_m2, >, 0.97f * (12 - 1.44f));
	g_assert_cmpfloat(wall->area_m2, <, 1.03f * (12 - 1.44f));
}

static void test_meeting(void)
{
	const struct plane_region *wall = of_normal(1), *ground = of_normal(2);
	int met = 0;
	for (uint32_t n = wall->first_ring; n < wall->first_ring + wall->rings; n++)
		for (uint32_t k = 0; k < found->ring[n].count; k++) {
			double at_m[3], off = 0;
			place_of(wall, found->vertex[found->ring[n].first + k], at_m);
			for (int i = 0; i < 3; i++)
				off += (at_m[i] - ground->origin_m[i]) * (double)ground->normal[i];
			met += fabs(off) < 1e-4;
		}
	g_assert_cmpint(met, ==, 2);
}

static void test_colours(void)
{
	const struct plane_region *wall = of_normal(1), *ground = of_normal(2);
	const uint8_t(*of_wall)[4] = found->texel + wall->first_texel,
	      (*of_ground)[4] = found->texel + ground->first_texel;
	for (int k = 0; k < 3; k++) {
		size_t wall_at = (size_t)wall->height / 4 * wall->width + wall->width / 8,
		       ground_at = (size_t)ground->height / 2 * ground->width + ground->width / 2;
		g_assert_cmpint(abs(of_wall[wall_at][k] - room_wall_rgba[k]), <=, 1);
		g_assert_cmpint(abs(of_ground[ground_at][k] - room_ground_rgba[k]), <=, 1);
	}
	/* All have a colour, also in the window. */
	for (uint64_t n = 0; n < found->texels; n++)
		g_assert_cmpuint(found->texel[n][3], ==, 255);
}

/* Nearly all of the wall and the ground, and no leaf of the tree. */
static void test_explained(void)
{
	uint64_t chunks, of_yard = 0, explained = 0, sum = 0;
	const struct model_chunk *c = model_chunks(room.model, &chunks);
	for (uint64_t n = 0; n < chunks; n++)
		for (uint64_t i = c[n].first; i < c[n].first + c[n].points; i++) {
			bool is = plane_regions_explain(found, i);
			of_yard += c[n].leaf == MADE_LEAF;
			explained += is;
			g_assert_false(is && c[n].leaf != MADE_LEAF);
		}
	for (uint32_t n = 0; n < found->count; n++)
		sum += found->region[n].points;
	g_test_message(
		"%.2f %% of the points are explained", 100 * (double)explained / (double)of_yard);
	g_assert_cmpuint(sum, ==, explained);
	g_assert_cmpfloat((double)explained, >, 0.97 * (double)of_yard);
}

static char *save(const plane_regions *r, gsize *ret_length)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *path = g_build_filename(room.folder, "saved.regions", NULL);
	char *bytes;
	g_assert_true(plane_regions_save(r, room.model, path, &error));
	g_assert_true(g_file_get_contents(path, &bytes, ret_length, &error));
	return bytes;
}

static void test_threads(void)
{
#ifdef _OPENMP
	int before = omp_get_max_threads();
	gsize length, again_length;
	g_autofree char *first = save(found, &length);
	for (int threads = 1; threads <= 3; threads++) {
		omp_set_num_threads(threads);
		g_autoptr(plane_regions) r = made_find_planes(room.model);
		g_autofree char *again = save(r, &again_length);
		g_assert_cmpmem(first, length, again, again_length);
	}
	omp_set_num_threads(before);
#endif
}

static void test_file(void)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *path = g_build_filename(room.folder, "file.regions", NULL);
	g_assert_true(plane_regions_save(found, room.model, path, &error));
	g_autoptr(plane_regions) r = plane_regions_open(path, &error);
	g_assert_no_error(error);
	g_assert_true(plane_regions_are_of(r, room.model));
	g_assert_cmpmem(r->region, r->count * sizeof *r->region, found->region,
		found->count * sizeof *found->region);
	g_assert_cmpmem(r->vertex, r->vertices * sizeof *r->vertex, found->vertex,
		found->vertices * sizeof *found->vertex);
	g_assert_cmpmem(r->texel, r->texels * 4, found->texel, found->texels * 4);
	g_autofree char *none = g_build_filename(room.folder, "none.regions", NULL);
	g_assert_null(plane_regions_open(none, &error));
	g_assert_error(error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND);
	g_clear_error(&error);
	g_assert_null(plane_regions_open(room.path, &error));
	g_assert_error(error, PRODUCT_ERROR, PRODUCT_ERROR_KIND);
}

/* What does not belong together. */
static void test_damage(void)
{
	for (int wrong = 0; wrong < 4; wrong++) {
		g_autoptr(GError) error = NULL;
		g_autofree char *path = g_build_filename(room.folder, "damaged.regions", NULL);
		g_autofree struct plane_region *region =
			g_memdup2(found->region, found->count * sizeof *region);
		plane_regions bad = *found;
		bad.region = region;
		switch (wrong) {
		case 0: region[1].first_ring++; break;
		case 1: region[0].width++; break;
		case 2: region[1].normal[0] = NAN; break;
		case 3: bad.vertices--; break;
		}
		g_assert_true(plane_regions_save(&bad, room.model, path, &error));
		g_assert_null(plane_regions_open(path, &error));
		g_assert_error(error, PRODUCT_ERROR, PRODUCT_ERROR_DAMAGED);
	}
}

static bool stop(double fraction, gpointer user_data)
{
	(void)fraction;
	(void)user_data;
	return false;
}

static void test_stop(void)
{
	g_autoptr(GError) error = NULL;
	struct plane_options o = { .progress = stop };
	g_assert_null(plane_regions_find(room.model, &o, &error));
	g_assert_no_error(error);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	room = made_room();
	made_read_planes(&room);
	found = made_find_planes(room.model);
	g_test_add_func("/plane-regions/count", test_count);
	g_test_add_func("/plane-regions/place", test_place);
	g_test_add_func("/plane-regions/outline", test_outline);
	g_test_add_func("/plane-regions/meeting", test_meeting);
	g_test_add_func("/plane-regions/colours", test_colours);
	g_test_add_func("/plane-regions/explained", test_explained);
	g_test_add_func("/plane-regions/threads", test_threads);
	g_test_add_func("/plane-regions/file", test_file);
	g_test_add_func("/plane-regions/damage", test_damage);
	g_test_add_func("/plane-regions/stop", test_stop);
	int failed = g_test_run();
	plane_regions_free(found);
	made_clear(&room);
	return failed;
}
