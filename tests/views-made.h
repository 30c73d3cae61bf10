#ifndef TESTS_VIEWS_MADE_H
#define TESTS_VIEWS_MADE_H
/* What tests of cameras and views share: any view, a site to save views in, and a court of chunks. */
#include "firmware-io/files.h"
#include "render/view-find.h"
#include <math.h>
#include <string.h>

#define WIDTH  1600u
#define HEIGHT 1200u

static inline double random_between(double low, double high)
{
	return g_test_rand_double_range(low, high);
}

static inline double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline double distance(const double a[3], const double b[3])
{
	double v[3] = { a[0] - b[0], a[1] - b[1], a[2] - b[2] };
	return sqrt(dot(v, v));
}

static inline void assert_near(const double a[3], const double b[3], double tolerance)
{
	for (int k = 0; k < 3; k++)
		g_assert_cmpfloat(fabs(a[k] - b[k]), <=, tolerance);
}

struct place {
	char *folder;
	site *site;
};

static inline void set_up(struct place *p, gconstpointer data)
{
	g_autoptr(GError) error = NULL;
	(void)data;
	p->folder = g_dir_make_tmp("test-camera-XXXXXX", &error);
	g_assert_no_error(error);
	g_autofree char *path = g_build_filename(p->folder, "oak", NULL);
	p->site = site_open_for_writing(path, &error);
	g_assert_no_error(error);
}

static inline void tear_down(struct place *p, gconstpointer data)
{
	(void)data;
	site_free(p->site);
	g_assert_true(files_remove_tree(p->folder, NULL));
	g_free(p->folder);
}

static inline view *any_view(const char *name)
{
	double eye[3], target[3];
	for (int k = 0; k < 3; k++) {
		eye[k] = random_between(-500, 500);
		target[k] = random_between(-500, 500);
	}
	return view_new(name, "Übers Tor \"hinaus\"", eye, target, random_between(1, 170));
}

static inline void save(const struct place *p, const view *v)
{
	g_autoptr(GError) error = NULL;
	g_assert_true(view_save(v, p->site, &error));
	g_assert_no_error(error);
}

/* A court of 40 x 30 m on ground at -1.6 m, its walls 8 m high but for the one in the south. */
static inline GArray *court(void)
{
	GArray *chunks = g_array_new(FALSE, TRUE, sizeof(struct model_chunk));
	for (int y = -15; y <= 15; y++)
		for (int x = -20; x <= 20; x++) {
			bool wall = x == -20 || x == 20 || y == 15;
			for (int z = 0; z < (wall ? 8 : 1); z++) {
				struct model_chunk c = { .centre_m = { x, y, z - 1.1 },
					.half_size_m = { 0.5f, 0.5f, 0.5f },
					.points = MODEL_CHUNK_POINTS };
				if (!wall) {
					c.centre_m[2] = -1.6;
					c.half_size_m[2] = 0.02f;
				}
				g_array_append_val(chunks, c);
			}
		}
	/* What was seen through a gate. */
	struct model_chunk far = {
		.centre_m = { 900, 40, 3 }, .half_size_m = { 80, 30, 9 }, .points = 100
	};
	g_array_append_val(chunks, far);
	return chunks;
}

struct model_site {
	GArray *chunks;
	struct view_station stations[3];
	view_boxes boxes;
	struct view_sources sources;
};

static inline void build(struct model_site *m)
{
	static const double at[3][3] = { { -12, -8, 0 }, { 11, 6, 0.1 }, { 0.5, 0, -0.1 } };
	m->chunks = court();
	for (int k = 0; k < 3; k++)
		m->stations[k] = (struct view_station){ 2 + (uint32_t)k, pose_from_yaw(k, at[k]) };
	m->boxes = (view_boxes){ .box = (struct model_chunk *)m->chunks->data,
		.count = m->chunks->len,
		.solid_points = MODEL_CHUNK_POINTS / 8.0 };
	m->sources = (struct view_sources){
		.boxes = &m->boxes, .stations = m->stations, .station_count = 3
	};
}

static inline void set_up_court(struct model_site *m, gconstpointer data)
{
	(void)data;
	build(m);
}

static inline void tear_down_court(struct model_site *m, gconstpointer data)
{
	(void)data;
	g_array_unref(m->chunks);
}

static inline view *find(const struct model_site *m, const char *spec)
{
	g_autoptr(GError) error = NULL;
	view *v = NULL;
	g_assert_true(view_find(&m->sources, spec, &v, &error));
	g_assert_no_error(error);
	g_assert_cmpstr(v->name, ==, spec);
	struct camera c = view_camera(v, WIDTH, HEIGHT);
	g_assert_true(camera_validate(&c, &error));
	return v;
}

#define ADD_COURT(name, function)                                                                  \
	g_test_add(name, struct model_site, NULL, set_up_court, function, tear_down_court)
#define ADD_PLACE(name, function) g_test_add(name, struct place, NULL, set_up, function, tear_down)

#endif
