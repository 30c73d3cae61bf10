/* Which plane a point belongs to, by the lists of its chunk, as when all planes are asked; and that the lists are short. */
#include "process/plane-near.h"
#include "process/vector3.h"
#include <math.h>

#define PLANES 300u
#define CHUNKS 40u
#define POINTS 200u

static struct plane_draft plane[PLANES];
static struct model_chunk chunk[CHUNKS];

static double around(GRand *r, double by)
{
	return g_rand_double_range(r, -by, by);
}

static void make_plane(GRand *r, struct plane_draft *d)
{
	float other[3];
	for (int k = 0; k < 3; k++) {
		d->r.origin_m[k] = around(r, 20);
		d->r.normal[k] = (float)around(r, 1);
		other[k] = (float)around(r, 1);
	}
	vector3_unit(d->r.normal);
	vector3_cross(d->r.normal, other, d->r.u);
	vector3_unit(d->r.u);
	vector3_cross(d->r.normal, d->r.u, d->r.v);
	d->r.thickness_m = (float)g_rand_double_range(r, 0.01, 0.3);
	for (int k = 0; k < 2; k++) {
		d->box_m[0][k] = (float)g_rand_double_range(r, -8, -0.2);
		d->box_m[1][k] = (float)g_rand_double_range(r, 0.2, 8);
	}
}

/* Chunks about places on planes, so that some points belong to some. */
static void make(GRand *r)
{
	for (uint32_t n = 0; n < PLANES; n++)
		make_plane(r, &plane[n]);
	for (uint32_t c = 0; c < CHUNKS; c++)
		for (int k = 0; k < 3; k++) {
			chunk[c].centre_m[k] = plane[c].r.origin_m[k] + around(r, 1);
			chunk[c].half_size_m[k] = (float)g_rand_double_range(r, 0.2, 3);
		}
}

/* All of them, one by one. */
static uint32_t nearest_of_all(const double at_m[3], const float normal[3], float within_m)
{
	uint32_t best = PLANES;
	double best_m = INFINITY;
	for (uint32_t n = 0; n < PLANES; n++) {
		const struct plane_region *r = &plane[n].r;
		double away_m = fabs(plane_distance_m(r, at_m));
		float at[2], cosine = vector3_dot(normal, r->normal);
		bool has_normal = normal[0] != 0 || normal[1] != 0 || normal[2] != 0, inside = true;
		plane_place(r, at_m, at);
		for (int k = 0; k < 2; k++)
			inside &= at[k] >= plane[n].box_m[0][k] && at[k] <= plane[n].box_m[1][k];
		if (inside && away_m <= (double)MIN(within_m, r->thickness_m) &&
			(!has_normal || cosine >= 0.6f) && away_m < best_m) {
			best = n;
			best_m = away_m;
		}
	}
	return best;
}

static void test_nearest(void)
{
	g_autoptr(GRand) r = g_rand_new_with_seed(5);
	make(r);
	g_autoptr(plane_near) near = plane_near_new(plane, PLANES, chunk, 0, CHUNKS);
	uint32_t found = 0;
	for (uint32_t c = 0; c < CHUNKS; c++)
		for (uint32_t i = 0; i < POINTS; i++) {
			double at_m[3], away_m = NAN;
			float normal[3], within_m = i % 3 ? INFINITY : 0.05f;
			for (int k = 0; k < 3; k++) {
				at_m[k] = chunk[c].centre_m[k] +
					  around(r, (double)chunk[c].half_size_m[k]);
				normal[k] = i % 4 ? (float)around(r, 1) : 0;
			}
			if (i % 4)
				vector3_unit(normal);
			uint32_t wanted = nearest_of_all(at_m, normal, within_m);
			struct plane_draft *d =
				plane_nearest(near, c, at_m, normal, within_m, &away_m);
			g_assert_cmpuint(d ? (uint32_t)(d - plane) : PLANES, ==, wanted);
			if (!d)
				continue;
			g_assert_cmpfloat(away_m, ==, plane_distance_m(&d->r, at_m));
			found++;
		}
	g_assert_cmpuint(found, >, CHUNKS * POINTS / 40);
}

/* What asks them is as slow as they are long. */
static void test_short(void)
{
	uint32_t listed = 0;
	for (uint32_t c = 0; c < CHUNKS; c++)
		for (uint32_t n = 0; n < PLANES; n++)
			listed += plane_may_reach(
				&plane[n], &chunk[c], (double)plane[n].r.thickness_m);
	g_assert_cmpuint(listed, <, CHUNKS * PLANES / 4);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/plane-near/nearest", test_nearest);
	g_test_add_func("/plane-near/short", test_short);
	return g_test_run();
}
