#include "process/profile-around.h"
#include "process/vector3.h"
#include "tests/profile-model.h"
#include <string.h>

/* Points all over a cube on both sides of the origin, so many that the table of blocks has to widen, and some that are dense. */
#define HALF_M  20.0
#define POINTS  40000u
#define DENSE_M 0.6
#define DENSE   5000u
#define QUERIES 300u

static void add_point(GArray *all, GRand *r, double half_m)
{
	double at[3];
	struct morton_place place;
	for (int k = 0; k < 3; k++)
		at[k] = g_rand_double_range(r, -half_m, half_m);
	g_assert_true(morton_from_point(at, morton_cell_m(0), &place));
	struct part_point p = {
		.code = place.code, .size = 100, .spacing = 100, .plane_error = MODEL_ERROR_NONE
	};
	memcpy(p.within, place.within, sizeof p.within);
	p.k1 = p.k2 = MODEL_HALF_NONE;
	g_array_append_val(all, p);
}

static model *make_cloud(GRand *r)
{
	g_autoptr(GArray) all = g_array_new(FALSE, FALSE, sizeof(struct part_point));
	for (uint32_t n = 0; n < POINTS; n++)
		add_point(all, r, HALF_M);
	for (uint32_t n = 0; n < DENSE; n++)
		add_point(all, r, DENSE_M);
	return write_model(all, NULL);
}

static struct profile_frame random_frame(GRand *r, double half_m)
{
	struct profile_frame f;
	float *along = f.axis[2], other[3];
	for (int k = 0; k < 3; k++) {
		f.at[k] = g_rand_double_range(r, -half_m, half_m);
		along[k] = (float)g_rand_double_range(r, -1, 1);
		other[k] = (float)g_rand_double_range(r, -1, 1);
	}
	/* Some run along the cubes. */
	if (g_rand_boolean(r))
		along[g_rand_int_range(r, 0, 3)] = along[g_rand_int_range(r, 0, 3)] = 0;
	along[g_rand_int_range(r, 0, 3)] += 0.5f;
	g_assert_true(vector3_unit(along));
	vector3_cross(along, other, f.axis[0]);
	g_assert_true(vector3_unit(f.axis[0]));
	vector3_cross(along, f.axis[0], f.axis[1]);
	return f;
}

struct query {
	struct profile_frame frame;
	double from_m, to_m;
	float radius_m;
};

/* Each point asked: how many there are, how many more so near to a border that rounding decides, and where they are on average. */
static uint32_t ask_each(
	const model *m, const struct query *q, uint32_t *near_border, double sum[3])
{
	uint32_t in = 0;
	uint64_t chunks;
	const struct model_chunk *chunk = model_chunks(m, &chunks);
	*near_border = 0;
	for (uint64_t n = 0; n < chunks; n++)
		for (uint32_t i = 0; i < chunk[n].points; i++) {
			const struct model_point *p = &model_points(m)[chunk[n].first + i];
			double at[3] = { 0 };
			for (int a = 0; a < 3; a++)
				for (int k = 0; k < 3; k++)
					at[a] += (chunk[n].centre_m[k] + (double)p->position_m[k] -
							 q->frame.at[k]) *
						 (double)q->frame.axis[a][k];
			double inside = fmin((double)q->radius_m - hypot(at[0], at[1]),
				fmin(at[2] - q->from_m, q->to_m - at[2]));
			if (fabs(inside) < 1e-4)
				++*near_border;
			if (inside < 0)
				continue;
			in++;
			for (int a = 0; a < 3; a++)
				sum[a] += at[a];
		}
	return in;
}

/* All that are within the radius of a line, and no other, however it runs through the cubes; one in so many layers, some of them. */
static void test_all(void)
{
	const double origin_m[3] = { 0 };
	g_autoptr(GRand) r = g_rand_new_with_seed(11);
	g_autoptr(model) m = make_cloud(r);
	g_autoptr(profile_around) around = profile_around_new(m, origin_m, 1);
	g_autoptr(GArray) found = g_array_new(FALSE, FALSE, sizeof(struct profile_near));
	uint32_t all = 0, some = 0;
	for (uint32_t n = 0; n < QUERIES; n++) {
		bool is_dense = n % 2;
		const struct query q = {
			.frame = random_frame(r, is_dense ? DENSE_M : HALF_M),
			.from_m = g_rand_double_range(r, -1, 0) * (is_dense ? 0.5 : HALF_M),
			.to_m = g_rand_double_range(r, 0, 1) * (is_dense ? 0.5 : HALF_M),
			.radius_m = (float)g_rand_double_range(r, 0.05, is_dense ? 0.3 : 1.5),
		};
		uint32_t near_border;
		double sum[3] = { 0 };
		uint32_t in = ask_each(m, &q, &near_border, sum);
		profile_around_look(around, &q.frame, q.from_m, q.to_m, q.radius_m, 1, found);
		g_assert_cmpuint(found->len, >=, in - MIN(near_border, in));
		g_assert_cmpuint(found->len, <=, in + near_border);
		for (guint i = 0; i < found->len && !near_border; i++) {
			const struct profile_near *p =
				&g_array_index(found, struct profile_near, i);
			sum[0] -= (double)p->u;
			sum[1] -= (double)p->v;
			sum[2] -= (double)p->t;
		}
		for (int a = 0; a < 3 && !near_border; a++)
			g_assert_cmpfloat(fabs(sum[a]), <, 1e-4 * (in + 1));
		all += found->len;
		profile_around_look(around, &q.frame, q.from_m, q.to_m, q.radius_m, 3, found);
		some += found->len;
	}
	g_test_message("%u, in every third layer %u", all, some);
	g_assert_cmpuint(all, >, 10000);
	g_assert_cmpfloat(fabs((double)some / all - 1.0 / 3), <, 0.05);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/profile-around/all", test_all);
	return g_test_run();
}
