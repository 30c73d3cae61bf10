/* Poses of many scans from relative ones: exact where those are exact, and not bent by those that are wrong. */
#include "process/pose-graph-private.h"
#include <math.h>
#include <string.h>

#define DEGREE (G_PI / 180)

struct made {
	size_t nodes, links;
	struct pose *truth;
	struct pose_node *node;
	struct pose_link *link;
	bool *wrong;
	GRand *chance;
};

static double normal(GRand *chance)
{
	double u = 1 - g_rand_double(chance), v = g_rand_double(chance);
	return sqrt(-2 * log(u)) * cos(2 * G_PI * v);
}

static void made_clear(struct made *m)
{
	g_free(m->truth);
	g_free(m->node);
	g_free(m->link);
	g_free(m->wrong);
	g_rand_free(m->chance);
}

static struct pose any_pose(GRand *chance, double x, double y)
{
	double at[3] = { x, y, g_rand_double_range(chance, -0.2, 0.2) };
	struct pose p = pose_from_yaw(g_rand_double_range(chance, -3.1, 3.1), at);
	double tilt[6] = { 0.01 * normal(chance), 0.01 * normal(chance) };
	struct pose by = pose_perturb(&POSE_IDENTITY, tilt);
	return pose_compose(&p, &by);
}

static struct made make(size_t nodes, size_t links_max, uint32_t seed)
{
	return (struct made){ .nodes = nodes,
		.truth = g_new0(struct pose, nodes),
		.node = g_new0(struct pose_node, nodes),
		.link = g_new0(struct pose_link, links_max),
		.wrong = g_new0(bool, links_max),
		.chance = g_rand_new_with_seed(seed) };
}

/* sigma of turns in rad is a twentieth of that of moves in m. */
static void add(struct made *m, uint32_t a, uint32_t b, double sigma_m)
{
	struct pose_link *l = &m->link[m->links++];
	double twist[6];
	*l = (struct pose_link){ .a = a, .b = b };
	l->pose = pose_between(&m->truth[a], &m->truth[b]);
	for (int i = 0; i < 6; i++) {
		double sigma = i < 3 ? sigma_m / 20 : sigma_m;
		twist[i] = sigma * normal(m->chance);
		l->covariance[i][i] = sigma * sigma;
	}
	l->pose = pose_perturb(&l->pose, twist);
}

static void spoil(struct made *m, size_t link, double by_m)
{
	double twist[6];
	for (int i = 0; i < 6; i++)
		twist[i] = (i < 3 ? 0.3 : by_m) * normal(m->chance);
	twist[3] += by_m;
	m->link[link].pose = pose_perturb(&m->link[link].pose, twist);
	m->wrong[link] = true;
}

static struct made ring(size_t nodes, double sigma_m, uint32_t seed)
{
	struct made m = make(nodes, 3 * nodes, seed);
	double radius = 8.0 * (double)nodes / (2 * G_PI);
	for (uint32_t i = 0; i < nodes; i++) {
		double angle = 2 * G_PI * i / (double)nodes;
		m.truth[i] = any_pose(m.chance, radius * cos(angle), radius * sin(angle));
	}
	for (uint32_t i = 0; i < nodes; i++)
		add(&m, i, (i + 1) % (uint32_t)nodes, sigma_m);
	return m;
}

static void solve(struct made *m)
{
	pose_graph_solve(m->node, m->nodes, m->link, m->links, NULL);
}

/* How far the poses are from the truth, both seen from the node `from`. */
static double worst_m(const struct made *m, uint32_t from, uint32_t first, uint32_t last)
{
	double worst = 0;
	for (uint32_t i = first; i <= last; i++) {
		struct pose is = pose_between(&m->node[from].pose, &m->node[i].pose);
		struct pose should = pose_between(&m->truth[from], &m->truth[i]);
		struct pose d = pose_between(&should, &is);
		worst = fmax(worst, pose_distance_m(&d) + 10 * pose_angle_rad(&d));
	}
	return worst;
}

static void assert_marked(const struct made *m)
{
	for (size_t i = 0; i < m->links; i++) {
		if (m->link[i].outlier != m->wrong[i])
			g_test_message("link %zu (%u, %u): outlier %d, wrong %d, %g m", i,
				m->link[i].a, m->link[i].b, m->link[i].outlier, m->wrong[i],
				m->link[i].loop_m);
		g_assert_cmpint(m->link[i].outlier, ==, m->wrong[i]);
	}
}

/* ---- the parts ---- */

static void test_derivatives(void)
{
	GRand *chance = g_rand_new_with_seed(3);
	for (int pass = 0; pass < 20; pass++) {
		struct pose a = any_pose(chance, 3, -4), b = any_pose(chance, 9, 2);
		struct pose_link l = { .pose = any_pose(chance, 5, 1) };
		double r[6], by_a[6][6], by_b[6][6];
		pose_link_residual(&l, &a, &b, r, by_a, by_b);
		for (int j = 0; j < 12; j++) {
			double step[6] = { 0 }, more[6], less[6], h = 1e-6;
			struct pose *moved = j < 6 ? &a : &b, kept = *moved, by;
			step[j % 6] = h;
			by = pose_perturb(&POSE_IDENTITY, step);
			*moved = pose_compose(&kept, &by);
			pose_link_residual(&l, &a, &b, more, NULL, NULL);
			step[j % 6] = -h;
			by = pose_perturb(&POSE_IDENTITY, step);
			*moved = pose_compose(&kept, &by);
			pose_link_residual(&l, &a, &b, less, NULL, NULL);
			*moved = kept;
			for (int i = 0; i < 6; i++)
				g_assert_cmpfloat_with_epsilon((more[i] - less[i]) / (2 * h),
					j < 6 ? by_a[i][j] : by_b[i][j - 6], 2e-6);
		}
	}
	g_rand_free(chance);
}

#define CHECKED 12
/* Against the same matrix, dense. */
static void test_cholesky(void)
{
	GRand *chance = g_rand_new_with_seed(5);
	static double dense[6 * CHECKED][6 * CHECKED];
	uint32_t pair[40][2];
	size_t pairs = 0;
	memset(dense, 0, sizeof dense);
	for (uint32_t a = 0; a < CHECKED; a++)
		for (uint32_t b = a + 1; b < CHECKED; b++)
			if (g_rand_double(chance) < 0.3 && pairs < 40) {
				pair[pairs][0] = a % 2 ? a : b;
				pair[pairs++][1] = a % 2 ? b : a;
			}
	g_autoptr(cholesky) c = cholesky_new(CHECKED, (const uint32_t(*)[2])pair, pairs);
	for (size_t p = 0; p < pairs; p++) {
		block6 m;
		for (int i = 0; i < 36; i++)
			m[i / 6][i % 6] = g_rand_double_range(chance, -1, 1);
		cholesky_add(c, pair[p][0], pair[p][1], m);
		for (int i = 0; i < 36; i++) {
			size_t row = 6 * pair[p][0] + i / 6, col = 6 * pair[p][1] + i % 6;
			dense[row][col] += m[i / 6][i % 6];
			dense[col][row] += m[i / 6][i % 6];
		}
	}
	for (uint32_t n = 0; n < CHECKED; n++) {
		block6 m = { 0 };
		for (int i = 0; i < 6; i++)
			m[i][i] = dense[6 * n + i][6 * n + i] = 40 + i;
		cholesky_add_diagonal(c, n, m);
	}
	double x[6 * CHECKED], wanted[6 * CHECKED];
	for (int i = 0; i < 6 * CHECKED; i++)
		wanted[i] = g_rand_double(chance);
	for (int i = 0; i < 6 * CHECKED; i++) {
		x[i] = 0;
		for (int j = 0; j < 6 * CHECKED; j++)
			x[i] += dense[i][j] * wanted[j];
	}
	g_assert_true(cholesky_factor(c, 0));
	cholesky_solve(c, x);
	for (int i = 0; i < 6 * CHECKED; i++)
		g_assert_cmpfloat_with_epsilon(x[i], wanted[i], 1e-11);
	block6 inverse[CHECKED];
	cholesky_inverse(c, inverse);
	for (int column = 0; column < 6 * CHECKED; column++) {
		double unit[6 * CHECKED] = { 0 };
		unit[column] = 1;
		cholesky_solve(c, unit);
		for (int i = 0; i < 6; i++)
			g_assert_cmpfloat_with_epsilon(inverse[column / 6][i][column % 6],
				unit[column / 6 * 6 + i], 1e-12);
	}
	block6 less = { { -1000 } };
	cholesky_add_diagonal(c, 4, less);
	g_assert_false(cholesky_factor(c, 0));
	g_rand_free(chance);
}

/* ---- graphs ---- */

static void test_exact(void)
{
	struct made m = ring(10, 0, 7);
	add(&m, 2, 7, 0);
	add(&m, 9, 4, 0);
	solve(&m);
	assert_marked(&m);
	g_assert_cmpfloat(worst_m(&m, 0, 0, 9), <, 1e-10);
	g_assert_true(memcmp(&m.node[0].pose, &POSE_IDENTITY, sizeof(struct pose)) == 0);
	for (size_t i = 0; i < m.nodes; i++)
		g_assert_cmpuint(m.node[i].component, ==, 1);
	made_clear(&m);
}

static void test_two(void)
{
	struct made m = make(2, 1, 8);
	m.truth[0] = any_pose(m.chance, 0, 0);
	m.truth[1] = any_pose(m.chance, 7, 2);
	add(&m, 1, 0, 0.002);
	struct pose said = m.link[0].pose;
	solve(&m);
	struct pose is = pose_between(&m.node[1].pose, &m.node[0].pose);
	struct pose d = pose_between(&said, &is);
	g_assert_cmpfloat(pose_distance_m(&d), <, 1e-10);
	g_assert_cmpfloat(pose_angle_rad(&d), <, 1e-10);
	/* 2 mm, and the floor of 1 mm. */
	g_assert_cmpfloat(m.node[0].covariance[3][3], ==, 0);
	double t = m.node[1].covariance[3][3] + m.node[1].covariance[4][4] +
		   m.node[1].covariance[5][5];
	g_assert_cmpfloat(t, >=, 3 * 5e-6 * (1 - 1e-9));
	g_assert_cmpfloat(t, <, 3 * 5e-6 + 60 * (1.3e-8));
	made_clear(&m);
}

/* Errors are as large as the covariances tell: the mean over many rings. */
static void test_ring_noise(void)
{
	double squares = 0, worst = 0;
	int count = 0;
	for (uint32_t seed = 0; seed < 60; seed++) {
		struct made m = ring(10, 0.003, 100 + seed);
		solve(&m);
		assert_marked(&m);
		worst = fmax(worst, worst_m(&m, 0, 0, 9));
		for (uint32_t i = 1; i < 10; i++) {
			struct pose should = pose_between(&m.truth[0], &m.truth[i]);
			struct pose d = pose_between(&m.node[i].pose, &should);
			double r[6], x[6];
			pose_difference(&POSE_IDENTITY, &d, r);
			memcpy(x, r, sizeof x);
			g_autoptr(cholesky) c = cholesky_new(1, NULL, 0);
			cholesky_add_diagonal(c, 0, (const double(*)[6])m.node[i].covariance);
			g_assert_true(cholesky_factor(c, 0));
			cholesky_solve(c, x);
			for (int j = 0; j < 6; j++)
				squares += r[j] * x[j];
			count += 6;
		}
		made_clear(&m);
	}
	g_test_message("mean squared error %g of what is told; worst %g m", squares / count, worst);
	g_assert_cmpfloat(squares / count, >, 0.6);
	g_assert_cmpfloat(squares / count, <, 1.2);
	g_assert_cmpfloat(worst, <, 0.06);
}

static void test_wrong_links(void)
{
	for (uint32_t seed = 0; seed < 40; seed++) {
		struct made m = ring(10, 0.002, 200 + seed);
		for (uint32_t i = 0; i < 5; i++)
			add(&m, i, (i + 2) % 10, 0.002);
		add(&m, 1, 6, 0.001);
		spoil(&m, m.links - 1, 3);
		add(&m, 8, 4, 0.0005); /* claims to be the best of all */
		spoil(&m, m.links - 1, 6);
		spoil(&m, seed % 5, 2); /* one of the ring, that others go round */
		solve(&m);
		assert_marked(&m);
		g_assert_cmpfloat(worst_m(&m, 0, 0, 9), <, 0.04);
		made_clear(&m);
	}
}

/* Wrong links that agree with nothing, as many as a third of all. */
static void test_many_wrong(void)
{
	for (uint32_t seed = 0; seed < 10; seed++) {
		struct made m = make(30, 400, 300 + seed);
		for (uint32_t i = 0; i < 30; i++)
			m.truth[i] = any_pose(m.chance, 8 * (i % 6), 8 * (i / 6));
		for (uint32_t a = 0; a < 30; a++)
			for (uint32_t b = a + 1; b < 30; b++) {
				struct pose d = pose_between(&m.truth[a], &m.truth[b]);
				if (pose_distance_m(&d) < 12)
					add(&m, a, b, 0.002);
			}
		size_t right = m.links;
		for (size_t i = 0; i < right / 2; i++) {
			uint32_t a = (uint32_t)g_rand_int_range(m.chance, 0, 15);
			add(&m, a, a + (uint32_t)g_rand_int_range(m.chance, 1, 15), 0.001);
			spoil(&m, m.links - 1, 4);
		}
		solve(&m);
		assert_marked(&m);
		g_assert_cmpfloat(worst_m(&m, 0, 0, 29), <, 0.02);
		made_clear(&m);
	}
}

/* Three scans, one wrong link of three: nothing tells which, so none is used. One that a person vouches for is. */
static void test_undecided(void)
{
	struct made m = ring(3, 0.001, 9);
	spoil(&m, 1, 2);
	solve(&m);
	for (int i = 0; i < 3; i++) {
		g_assert_true(m.link[i].outlier);
		g_assert_cmpuint(m.node[i].component, ==, (uint32_t)i + 1);
	}
	m.link[0].trusted = m.link[2].trusted = true;
	solve(&m);
	assert_marked(&m);
	g_assert_false(m.link[1].undecided);
	g_assert_cmpfloat(worst_m(&m, 0, 0, 2), <, 0.02);
	made_clear(&m);
}

static void test_groups(void)
{
	struct made m = make(9, 20, 10);
	for (uint32_t i = 0; i < 9; i++)
		m.truth[i] = any_pose(m.chance, 5.0 * i, 2);
	for (uint32_t i = 0; i < 8; i++)
		if (i != 4 && i != 7)
			add(&m, i, i + 1, 0);
	solve(&m);
	for (uint32_t i = 0; i < 9; i++)
		g_assert_cmpuint(m.node[i].component, ==, i < 5 ? 1u : i < 8 ? 2u : 3u);
	g_assert_true(memcmp(&m.node[5].pose, &POSE_IDENTITY, sizeof(struct pose)) == 0);
	g_assert_cmpfloat(worst_m(&m, 0, 0, 4), <, 1e-10);
	g_assert_cmpfloat(worst_m(&m, 5, 5, 7), <, 1e-10);
	g_assert_cmpfloat(m.node[8].covariance[0][0], ==, 0);
	made_clear(&m);
}

/* Two that are held tie what hangs on them into one, and a link that disagrees with them goes. */
static void test_fixed(void)
{
	struct made m = ring(8, 0.001, 11);
	for (uint32_t i = 0; i < 8; i += 3) {
		m.node[i].fixed = true;
		m.node[i].pose = m.truth[i];
	}
	add(&m, 4, 6, 0.001);
	spoil(&m, 3, 1);
	struct pose kept = m.node[3].pose;
	solve(&m);
	assert_marked(&m);
	g_assert_true(memcmp(&kept, &m.node[3].pose, sizeof kept) == 0);
	for (uint32_t i = 0; i < 8; i++) {
		struct pose d = pose_between(&m.truth[i], &m.node[i].pose);
		g_assert_cmpfloat(pose_distance_m(&d), <, 0.01);
		g_assert_cmpuint(m.node[i].component, ==, 1);
	}
	made_clear(&m);
}

/* The poses between scans do not depend on which of them comes first. */
static void test_gauge(void)
{
	struct made m = ring(10, 0.004, 12), n = ring(10, 0.004, 12);
	for (size_t i = 0; i < n.links; i++) {
		n.link[i].a = 9 - n.link[i].a;
		n.link[i].b = 9 - n.link[i].b;
	}
	solve(&m);
	solve(&n);
	for (uint32_t i = 0; i < 9; i++) {
		struct pose one = pose_between(&m.node[i].pose, &m.node[i + 1].pose);
		struct pose two = pose_between(&n.node[9 - i].pose, &n.node[8 - i].pose);
		struct pose d = pose_between(&one, &two);
		g_assert_cmpfloat(pose_distance_m(&d), <, 1e-8);
	}
	made_clear(&n);
	made_clear(&m);
}

static void test_large(void)
{
	struct made m = make(500, 4000, 13);
	for (uint32_t i = 0; i < 500; i++)
		m.truth[i] = any_pose(m.chance, 8.0 * (i % 25), 8.0 * (i / 25));
	for (uint32_t i = 0; i < 500; i++) {
		if (i % 25 < 24)
			add(&m, i, i + 1, 0.002);
		if (i + 25 < 500)
			add(&m, i, i + 25, 0.002);
		if (i % 25 < 24 && i + 26 < 500)
			add(&m, i, i + 26, 0.003);
	}
	for (int i = 0; i < 40; i++) {
		uint32_t a = (uint32_t)g_rand_int_range(m.chance, 0, 400);
		add(&m, a, a + (uint32_t)g_rand_int_range(m.chance, 30, 90), 0.001);
		spoil(&m, m.links - 1, 5);
	}
	int64_t started_us = g_get_monotonic_time();
	solve(&m);
	g_test_message("%zu links: %g s, worst %g m", m.links,
		1e-6 * (double)(g_get_monotonic_time() - started_us), worst_m(&m, 0, 0, 499));
	assert_marked(&m);
	g_assert_cmpfloat(worst_m(&m, 0, 0, 499), <, 0.1);
	made_clear(&m);
}

/* A covariance that is none does no harm. */
static void test_bad_covariance(void)
{
	struct made m = ring(4, 0, 14);
	for (int i = 0; i < 6; i++)
		for (int j = 0; j < 6; j++)
			m.link[1].covariance[i][j] = i == j ? -1 : 5;
	solve(&m);
	g_assert_cmpfloat(worst_m(&m, 0, 0, 3), <, 1e-9);
	made_clear(&m);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/pose-graph/derivatives", test_derivatives);
	g_test_add_func("/pose-graph/cholesky", test_cholesky);
	g_test_add_func("/pose-graph/exact", test_exact);
	g_test_add_func("/pose-graph/two", test_two);
	g_test_add_func("/pose-graph/ring-noise", test_ring_noise);
	g_test_add_func("/pose-graph/wrong-links", test_wrong_links);
	g_test_add_func("/pose-graph/many-wrong", test_many_wrong);
	g_test_add_func("/pose-graph/undecided", test_undecided);
	g_test_add_func("/pose-graph/groups", test_groups);
	g_test_add_func("/pose-graph/fixed", test_fixed);
	g_test_add_func("/pose-graph/gauge", test_gauge);
	g_test_add_func("/pose-graph/large", test_large);
	g_test_add_func("/pose-graph/bad-covariance", test_bad_covariance);
	return g_test_run();
}
