/* Sums of points in voxels against plain ones, and which voxels are linked. */
#include "process/voxel-columns.h"
#include "tests/surfaces-made.h"
#include <stdlib.h>

#define SIZE_M 0.2
#define POINTS 20000

static const uint8_t colour[3] = { 10, 100, 250 };

/* Lines across the origin, thick; half of them with colour and a scanner. */
static struct voxel_point *make_points(uint32_t scans)
{
	g_autoptr(GRand) chance = g_rand_new_with_seed(7);
	struct voxel_point *p = g_new0(struct voxel_point, POINTS);
	for (int i = 0; i < POINTS; i++) {
		double along = g_rand_double_range(chance, -4, 4);
		for (int k = 0; k < 3; k++) {
			p[i].at_m[k] =
				along * (k == i % 3) + g_rand_double_range(chance, -0.5, 0.5);
			p[i].normal[k] = (float)(k == i % 3);
			p[i].towards[k] = i % 2 ? (float)(k == 1) : 0;
		}
		p[i].error_m = 0.001f * (float)(i % 7);
		p[i].size_m = 0.01f + 0.001f * (float)(i % 5);
		p[i].area_m2 = 0.0001f * (float)(1 + i % 3);
		p[i].scan = (uint32_t)i * scans / POINTS;
		p[i].rgb = i % 2 ? colour : NULL;
		p[i].intensity = (uint16_t)(i % 1000);
		p[i].is_late = i % 4 == 0;
	}
	return p;
}

static voxels *add_all(const struct voxel_point *p, bool backwards)
{
	voxels *v = voxels_new(SIZE_M);
	for (int i = 0; i < POINTS; i++)
		g_assert_cmpuint(voxels_add(v, &p[backwards ? POINTS - 1 - i : i]), !=, VOXEL_NONE);
	voxels_finish(v);
	return v;
}

/* In parts that are put together. */
static voxels *add_in_parts(const struct voxel_point *p, int parts)
{
	voxels *v = voxels_new(SIZE_M);
	for (int k = 0; k < parts; k++) {
		g_autoptr(voxels) part = voxels_new(SIZE_M);
		for (int i = POINTS * k / parts; i < POINTS * (k + 1) / parts; i++)
			voxels_add(part, &p[i]);
		voxels_merge(v, part);
	}
	voxels_finish(v);
	return v;
}

static bool is_in(const struct voxel *v, const struct voxel_point *p)
{
	for (int k = 0; k < 3; k++)
		if ((int32_t)floor(p->at_m[k] / SIZE_M) != v->at[k])
			return false;
	return true;
}

static void assert_near(double got, double wanted, double most)
{
	if (!(fabs(got - wanted) <= most))
		g_test_message("%.9g, but %.9g is wanted", got, wanted);
	g_assert_true(fabs(got - wanted) <= most);
}

static void check_voxel(const voxels *v, uint32_t i, const struct voxel_point *p, uint32_t scans)
{
	const struct voxel *c = &v->voxel[i];
	double n = 0, place[3] = { 0 }, normal[3] = { 0 }, towards[3] = { 0 }, error = 0, size = 1,
	       coloured = 0, intensity = 0, late = 0, area[8] = { 0 }, most = 0;
	for (int k = 0; k < POINTS; k++) {
		if (!is_in(c, &p[k]))
			continue;
		n++;
		for (int a = 0; a < 3; a++) {
			place[a] += p[k].at_m[a] / SIZE_M - c->at[a];
			normal[a] += p[k].normal[a];
			towards[a] += p[k].towards[a];
		}
		error += p[k].error_m;
		size = fmin(size, p[k].size_m);
		coloured += p[k].rgb != NULL;
		intensity += p[k].intensity;
		late += p[k].is_late;
		area[p[k].scan] += p[k].area_m2;
	}
	for (uint32_t s = 0; s < scans; s++)
		most = fmax(most, area[s]);
	g_assert_cmpfloat(n, ==, c->points);
	for (int a = 0; a < 3; a++) {
		assert_near(c->place[a], place[a] / n, 1e-4);
		assert_near(c->normal[a], normal[a] / n, 1e-4);
		assert_near(c->towards[a], towards[a] / n, 1e-4);
		assert_near(c->rgb[a], coloured > 0 ? colour[a] / 255.0 : 0, 1e-4);
	}
	assert_near(c->error_m, error / n, 1e-6);
	assert_near(c->size_m, size, 1e-6);
	assert_near(c->coloured, coloured / n, 1e-5);
	assert_near(c->intensity, intensity / n, 0.02);
	assert_near(c->late, late / n, 1e-5);
	assert_near(c->area_m2, most, 1e-5);
}

static void test_sums(void)
{
	for (uint32_t scans = 1; scans <= 5; scans += 4) {
		g_autofree struct voxel_point *p = make_points(scans);
		g_autoptr(voxels) v = add_all(p, false);
		uint64_t points = 0;
		for (uint32_t i = 0; i < v->count; i++) {
			points += v->voxel[i].points;
			if (i % 7 == 0)
				check_voxel(v, i, p, scans);
		}
		g_assert_cmpuint(points, ==, POINTS);
		g_assert_cmpuint(v->count, >, 1000);
	}
}

/* Each part is of one scan; the area is still that of all its parts. */
static void test_merged(void)
{
	for (uint32_t scans = 1; scans <= 5; scans += 4) {
		g_autofree struct voxel_point *p = make_points(scans);
		g_autoptr(voxels) v = add_in_parts(p, 10);
		for (uint32_t i = 0; i < v->count; i += 7)
			check_voxel(v, i, p, scans);
		g_assert_cmpuint(v->count, >, 1000);
	}
}

static void test_order_of_points(void)
{
	g_autofree struct voxel_point *p = make_points(1);
	g_autoptr(voxels) a = add_all(p, false);
	g_autoptr(voxels) b = add_all(p, true);
	g_assert_cmpuint(a->count, ==, b->count);
	for (uint32_t i = 0; i < a->count; i++) {
		g_assert_cmpmem(a->voxel[i].at, 12, b->voxel[i].at, 12);
		g_assert_cmpuint(a->voxel[i].points, ==, b->voxel[i].points);
		for (int k = 0; k < 3; k++)
			assert_near(a->voxel[i].place[k], b->voxel[i].place[k], 1e-5);
	}
}

static void test_find(void)
{
	g_autofree struct voxel_point *p = make_points(1);
	g_autoptr(voxels) v = add_all(p, false);
	for (uint32_t i = 0; i < v->count; i++) {
		double at[3];
		voxel_point_m(v, i, at);
		g_assert_cmpuint(voxels_find(v, v->voxel[i].at), ==, i);
		/* a mean may round to the edge */
		for (int k = 0; k < 3; k++)
			g_assert_true(fabs(at[k] / SIZE_M - v->voxel[i].at[k] - 0.5) <= 0.5 + 1e-6);
	}
	for (int i = 0; i < POINTS; i++)
		g_assert_true(is_in(&v->voxel[voxels_find_point(v, p[i].at_m)], &p[i]));
	double none[3] = { 3, 3, 3 }, beyond[3] = { 0, 1e12, 0 }, nan[3] = { 0, 0, NAN };
	g_assert_cmpuint(voxels_find_point(v, none), ==, VOXEL_NONE);
	g_assert_cmpuint(voxels_find_point(v, beyond), ==, VOXEL_NONE);
	g_assert_cmpuint(voxels_find_point(v, nan), ==, VOXEL_NONE);
	struct voxel_point far = { .at_m = { 0, 1e12, 0 } };
	g_assert_cmpuint(voxels_add(v, &far), ==, VOXEL_NONE);
}

/* ---- links ---- */

static bool has_link(const voxels *v, uint32_t from, uint32_t to)
{
	for (uint32_t l = v->first_link[from]; l < v->first_link[from + 1]; l++)
		if (v->link[l] == to)
			return true;
	return false;
}

static int apart(const voxels *v, uint32_t a, uint32_t b)
{
	int far = 0;
	for (int k = 0; k < 3; k++)
		far = MAX(far, abs(v->voxel[a].at[k] - v->voxel[b].at[k]));
	return far;
}

/* z first, then y, then x: what spreads along links goes the same way always. */
static void check_order(const voxels *v)
{
	for (uint32_t i = 0; i < v->count; i++)
		for (uint32_t l = v->first_link[i] + 1; l < v->first_link[i + 1]; l++) {
			const int32_t *a = v->voxel[v->link[l - 1]].at,
				      *b = v->voxel[v->link[l]].at;
			g_assert_true(
				a[2] < b[2] ||
				(a[2] == b[2] && (a[1] < b[1] || (a[1] == b[1] && a[0] < b[0]))));
		}
}

/* Every pair of some voxels with all others. */
static void check_links(const voxels *v, int reach)
{
	check_order(v);
	for (uint32_t i = 0; i < v->count; i += 11)
		for (uint32_t j = 0; j < v->count; j++) {
			bool wanted = i != j && apart(v, i, j) <= reach;
			g_assert_true(has_link(v, i, j) == wanted);
			g_assert_true(has_link(v, j, i) == wanted);
		}
}

static void test_links_of_dense(void)
{
	g_autofree struct voxel_point *p = make_points(1);
	g_autoptr(voxels) v = add_all(p, false);
	voxels_link(v, 2);
	check_links(v, 1);
	voxels_link(v, 2); /* once more is the same */
	check_links(v, 1);
}

/* Patches of 0.5 m reach over 2 gaps of 1 m: as far as it goes; of 0.25 m over 2: three voxels of 0.2 m. */
static void test_links_of_sparse(void)
{
	static const struct {
		float size_m;
		int reach;
	} cases[] = { { 0.5f, VOXELS_REACH }, { 0.25f, 3 }, { 0.15f, 2 } };
	for (size_t n = 0; n < G_N_ELEMENTS(cases); n++) {
		g_autofree struct voxel_point *p = make_points(1);
		for (int i = 0; i < POINTS; i++)
			p[i].size_m = cases[n].size_m;
		g_autoptr(voxels) v = add_all(p, false);
		voxels_link(v, 2);
		check_links(v, cases[n].reach);
	}
}

/* One that is dense does not reach back to one that is sparse. */
static void test_links_both_ways(void)
{
	g_autoptr(voxels) v = voxels_new(SIZE_M);
	struct voxel_point sparse = { .at_m = { 0.1, 0.1, 0.1 }, .size_m = 0.5f },
			   dense = { .at_m = { 0.7, 0.1, 0.1 }, .size_m = 0.01f },
			   other = { .at_m = { 0.1, 0.7, 0.1 }, .size_m = 0.5f };
	voxels_add(v, &sparse);
	voxels_add(v, &dense);
	voxels_add(v, &other);
	voxels_finish(v);
	voxels_link(v, 2);
	uint32_t s = voxels_find_point(v, sparse.at_m), d = voxels_find_point(v, dense.at_m),
		 o = voxels_find_point(v, other.at_m);
	g_assert_true(has_link(v, s, o) && has_link(v, o, s));
	g_assert_false(has_link(v, s, d) || has_link(v, d, s));
}

/* Of every place of the plan, heights from far below to far above, against a look at each. */
static void check_column(const voxel_columns *c, int32_t x, int32_t y, int32_t low, int32_t high)
{
	const uint32_t *found = NULL;
	uint32_t count = voxel_columns_find(c, x, y, low, high, &found), known = 0;
	for (int32_t z = low; z <= high; z++) {
		uint32_t i = voxels_find(c->v, (const int32_t[3]){ x, y, z });
		if (i == VOXEL_NONE)
			continue;
		g_assert_cmpuint(known, <, count);
		g_assert_cmpuint(found[known++], ==, i);
	}
	g_assert_cmpuint(known, ==, count);
}

static void test_columns(void)
{
	g_autofree struct voxel_point *p = make_points(1);
	g_autoptr(voxels) v = add_all(p, false);
	g_autoptr(voxel_columns) c = voxel_columns_new(v);
	for (int32_t x = -25; x <= 25; x++)
		for (int32_t y = -25; y <= 25; y++)
			for (int32_t low = -24; low <= 24; low += 8) {
				check_column(c, x, y, low, low + 4);
				check_column(c, x, y, low, low);
				check_column(c, x, y, -100, low);
			}
	g_assert_cmpuint(c->column[c->count - 1].end, ==, v->count);
}

static void test_find_after(void)
{
	g_autofree struct voxel_point *p = make_points(1);
	g_autoptr(voxels) v = add_all(p, false);
	uint32_t last = VOXEL_NONE;
	for (int i = 0; i < POINTS; i++) {
		g_assert_cmpuint(voxels_find_point_after(v, p[i].at_m, last), ==,
			voxels_find_point(v, p[i].at_m));
		last = i % 3 ? voxels_find_point(v, p[i].at_m) : (uint32_t)i % v->count;
	}
}

static void test_empty(void)
{
	g_autoptr(voxels) v = voxels_new(1);
	voxels_finish(v);
	voxels_link(v, 2);
	g_assert_cmpuint(v->count, ==, 0);
	g_assert_cmpuint(voxels_find_point(v, (double[3]){ 0, 0, 0 }), ==, VOXEL_NONE);
	g_autoptr(voxel_columns) c = voxel_columns_new(v);
	check_column(c, 0, 0, -3, 3);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/voxels/sums", test_sums);
	g_test_add_func("/voxels/merged", test_merged);
	g_test_add_func("/voxels/order-of-points", test_order_of_points);
	g_test_add_func("/voxels/find", test_find);
	g_test_add_func("/voxels/links-of-dense", test_links_of_dense);
	g_test_add_func("/voxels/links-of-sparse", test_links_of_sparse);
	g_test_add_func("/voxels/links-both-ways", test_links_both_ways);
	g_test_add_func("/voxels/columns", test_columns);
	g_test_add_func("/voxels/find-after", test_find_after);
	g_test_add_func("/voxels/empty", test_empty);
	return g_test_run();
}
