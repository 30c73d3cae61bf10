/* Plane regions of a site, from scans of a simulated hall to the file: they lie where the simulator says that surfaces are, nothing is there
 * where it sees through, and they are due when the model is another. */
#include "process/build-model.h"
#include "process/plane-find.h"
#include "process/plane-inside.h"
#include "process/plane-site.h"
#include "process/scan-geometry.h"
#include "process/segment-site.h"
#include "process/segments.h"
#include "sim/truth.h"
#include "tests/simulated.h"
#include <math.h>

#define SCENE "hall?seed=3&camera=none&station=1"

static struct {
	site *site;
	scan_graph graph;
} hall;

static void set_up(void)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *path = simulated_folder();
	simulated_draft(path, SCENE);
	struct placed_scan p = { .number = 1, .group = 1, .pose = simulated_pose(SCENE) };
	hall.graph.scans = g_array_new(FALSE, TRUE, sizeof p);
	hall.graph.edges = g_array_new(FALSE, TRUE, sizeof(struct edge));
	g_array_append_val(hall.graph.scans, p);
	hall.site = site_open_existing(path, &error);
	g_assert_no_error(error);
}

static void tear_down(void)
{
	site_free(hall.site);
	g_array_unref(hall.graph.scans);
	g_array_unref(hall.graph.edges);
}

static bool is_due(void)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *why = NULL;
	bool due;
	g_assert_true(plane_site_is_due(hall.site, &due, &why, &error));
	g_assert_true(due == (why != NULL));
	return due;
}

static void make_planes(struct plane_site_result *ret)
{
	g_autoptr(GError) error = NULL;
	struct plane_options o = { 0 };
	g_assert_true(plane_site(hall.site, &o, ret, &error));
	g_assert_no_error(error);
}

static void make_model(void)
{
	g_autoptr(GError) error = NULL;
	struct build_result built;
	struct segment_site_result found;
	g_assert_true(geometry_site(hall.site, &hall.graph, NULL, NULL, &error));
	g_assert_true(segment_site(hall.site, &hall.graph, NULL, &found, &error));
	g_assert_true(build_model(hall.site, &hall.graph, NULL, &built, &error));
	g_assert_no_error(error);
}

/* What is a wall is another thing then. */
static void change_a_class(void)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(segments) tree = segments_load(site_path(hall.site), &error);
	g_assert_no_error(error);
	g_assert_cmpuint(
		segments_add(tree, segment_of_class(CLASS_BUILDING), "Porch", "user"), >, 0);
	g_assert_true(segments_save(tree, site_path(hall.site), &error));
	g_assert_no_error(error);
}

static void test_due(void)
{
	struct plane_site_result made;
	g_autofree char *path = plane_regions_path(site_path(hall.site));
	g_assert_false(is_due()); /* there is no model */
	make_model();
	g_assert_true(is_due());
	make_planes(&made);
	g_test_message("%u planes of %.0f m2, %.0f %% of the points", made.planes, made.area_m2,
		100 * (double)made.explained / (double)made.points);
	g_assert_cmpuint(made.planes, >, 3);
	g_assert_cmpfloat((double)made.explained, >, 0.4 * (double)made.points);
	g_assert_false(is_due());
	g_assert_true(g_file_set_contents(path, "PLPRODUC", -1, NULL));
	g_assert_true(is_due());
	make_planes(&made);
	g_assert_false(is_due());
	change_a_class();
	g_assert_true(is_due());
	make_planes(&made);
	g_assert_false(is_due());
}

/* ---- against the truth ---- */

struct measured {
	uint32_t count, on, through;
	double off[1 << 16], turned[1 << 16];
};

static int by_size(const void *a, const void *b)
{
	const double *x = a, *y = b;
	return (*x > *y) - (*x < *y);
}

static struct plane_draft draft_of(const plane_regions *r, uint32_t n)
{
	struct plane_draft d = { .r = r->region[n],
		.ring = g_array_new(FALSE, FALSE, sizeof(struct plane_ring)),
		.vertex = g_array_new(FALSE, FALSE, sizeof(float[2])),
		.met = g_array_new(FALSE, FALSE, sizeof(struct plane_met)) };
	for (uint32_t k = d.r.first_ring; k < d.r.first_ring + d.r.rings; k++) {
		struct plane_ring ring = { d.vertex->len, r->ring[k].count };
		g_array_append_vals(d.vertex, r->vertex[r->ring[k].first], ring.count);
		g_array_append_val(d.ring, ring);
	}
	return d;
}

struct ray {
	double way[3], normal[3]; /* in the site */
	float range_m;            /* that it truly goes; 0: on and on */
};

#define COLUMNS 720
#define ROWS    160
static struct ray *rays_of(const char *description, const struct pose *pose)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(truth) t = truth_new(description, &error);
	g_assert_no_error(error);
	struct ray *rays = g_new(struct ray, COLUMNS * ROWS);
	for (int n = 0; n < COLUMNS * ROWS; n++) {
		double azimuth = 2 * G_PI * (n % COLUMNS) / COLUMNS,
		       elevation = G_PI / 2 * (n / COLUMNS - ROWS / 2) / ROWS;
		/* Clockwise from home, which is ahead. */
		double v[3] = { sin(azimuth) * cos(elevation), cos(azimuth) * cos(elevation),
			sin(elevation) };
		struct truth_cell cell = truth_look(t, azimuth, elevation);
		double normal[3] = { (double)cell.normal[0], (double)cell.normal[1],
			(double)cell.normal[2] };
		rays[n].range_m = cell.range_m;
		pose_rotate(pose, v, rays[n].way);
		pose_rotate(pose, normal, rays[n].normal);
	}
	return rays;
}

/* A ray from a scanner: what the polygon says, and what is there. */
static void look(struct measured *m, const struct plane_draft *d, const plane_inside *inside,
	const double eye[3], const struct ray *ray)
{
	double along = 0, facing = 0;
	for (int k = 0; k < 3; k++)
		along += ray->way[k] * (double)d->r.normal[k];
	double range_m = -plane_distance_m(&d->r, eye) / along, at_m[3];
	if (!(range_m > 0.5) || range_m > 30 || fabs(along) < 0.2)
		return;
	float at[2];
	for (int k = 0; k < 3; k++)
		at_m[k] = eye[k] + range_m * ray->way[k];
	plane_place(&d->r, at_m, at);
	/* Well inside: borders are as good as points are dense. */
	if (!plane_inside_near(inside, at, 0) || plane_inside_is_border(inside, at, 0.15f))
		return;
	m->count++;
	/* What stands before it hides it; that it is seen through is wrong. */
	m->through += ray->range_m == 0 || (double)ray->range_m > range_m + 0.1;
	if (fabs((double)ray->range_m - range_m) > 0.04)
		return;
	for (int k = 0; k < 3; k++)
		facing += ray->normal[k] * (double)d->r.normal[k];
	if (fabs(facing) < 0.97)
		return;
	m->off[m->on & 0xffff] = fabs(((double)ray->range_m - range_m) * along);
	m->turned[m->on++ & 0xffff] = acos(fmin(fabs(facing), 1)) * 180 / G_PI;
}

static void test_truth(void)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *path = plane_regions_path(site_path(hall.site));
	g_autoptr(plane_regions) r = plane_regions_open(path, &error);
	g_assert_no_error(error);
	struct pose pose = simulated_pose(SCENE);
	g_autofree struct ray *rays = rays_of(SCENE, &pose);
	static struct measured m;
	for (uint32_t n = 0; n < r->count; n++) {
		struct plane_draft d = draft_of(r, n);
		g_autoptr(plane_inside) inside = plane_inside_new(&d);
		for (int k = 0; k < COLUMNS * ROWS; k++)
			look(&m, &d, inside, pose.translation_m, &rays[k]);
		plane_draft_clear(&d);
	}
	uint32_t kept = MIN(m.on, 1u << 16);
	g_assert_cmpuint(kept, >, 1000);
	qsort(m.off, kept, sizeof *m.off, by_size);
	qsort(m.turned, kept, sizeof *m.turned, by_size);
	g_test_message("of %u rays %u meet a polygon's own surface, median %.4f m and %.3f degrees "
		       "off; %u are seen through",
		m.count, m.on, m.off[kept / 2], m.turned[kept / 2], m.through);
	g_assert_cmpfloat(m.off[kept / 2], <, 0.005);
	g_assert_cmpfloat(m.turned[kept / 2], <, 0.2);
	g_assert_cmpfloat(m.through, <, 0.01 * m.count);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	set_up();
	g_test_add_func("/plane-site/due", test_due);
	g_test_add_func("/plane-site/truth", test_truth);
	int failed = g_test_run();
	tear_down();
	return failed;
}
