/* Pairs of scans as edges: grids, clouds and one of each; from nothing, from a start, and as given. */
#include "process/align-scans.h"
#include "tests/placed-scans.h"

#define DEGREE (G_PI / 180)
#define SCENE  "court?seed=9&station="

static align_scan *scan_of_grid(uint32_t number, enum scan_kind kind, range_grid *g)
{
	struct scan_data d = { .number = number,
		.kind = kind,
		.grid = g,
		.fingerprint = (char *)(number == 1 ? "one" : "two") };
	g_autoptr(GError) error = NULL;
	align_scan *s = align_scan_new(&d, &error);
	g_assert_no_error(error);
	return s;
}

static const struct placed *station(int number)
{
	g_autofree char *what = g_strdup_printf(SCENE "%d", number);
	return placed_scan(what);
}

/* Made once. */
static const align_scan *grid_scan(int number)
{
	static align_scan *made[3];
	if (!made[number])
		made[number] = scan_of_grid((uint32_t)number, SCAN_RECORDED, station(number)->grid);
	return made[number];
}

/* Every each-th point, moved. */
static align_scan *cloud_of(
	uint32_t number, const range_grid *g, size_t each, const struct pose *by)
{
	g_autofree struct point_record *record = g_new0(struct point_record, range_grid_cells(g));
	struct points p = { .record = record };
	g_autoptr(GError) error = NULL;
	for (size_t i = 0; i < range_grid_cells(g); i += each) {
		double at[3] = { g->x_m[i], g->y_m[i], g->z_m[i] };
		if (!(g->range_m[i] > 0))
			continue;
		pose_apply(by, at, at);
		record[p.count++] = (struct point_record){
			.x_m = at[0], .y_m = at[1], .z_m = at[2], .cell = CELL_MEASURED
		};
	}
	struct scan_data d = {
		.number = number, .kind = SCAN_CLOUD, .points = &p, .fingerprint = (char *)"cloud"
	};
	align_scan *s = align_scan_new(&d, &error);
	g_assert_no_error(error);
	return s;
}

static struct pose right_pose(void)
{
	return pose_between(&station(1)->pose, &station(2)->pose);
}

static struct pose off_by(const struct pose *p, double turn_rad, double x_m)
{
	double twist[6] = { 0, 0, turn_rad, x_m };
	return pose_perturb(p, twist);
}

static void assert_apart(const struct pose *a, const struct pose *b, double most_m, double most_rad)
{
	struct pose d = pose_between(a, b);
	g_test_message(
		"%.1f mm, %.3f degrees", 1000 * pose_distance_m(&d), pose_angle_rad(&d) / DEGREE);
	g_assert_cmpfloat(pose_distance_m(&d), <, most_m);
	g_assert_cmpfloat(pose_angle_rad(&d), <, most_rad);
}

static struct edge align(const align_scan *a, const align_scan *b, const struct pose *start)
{
	struct edge e;
	g_autoptr(GError) error = NULL;
	g_assert_true(align_scans(a, b, start, start ? EDGE_PICKED : EDGE_AUTOMATIC, &e, &error));
	g_assert_no_error(error);
	g_test_message("%s: %s", verdict_names[e.verification.verdict], e.verification.reason);
	return e;
}

static void test_grids(void)
{
	struct edge e = align(grid_scan(1), grid_scan(2), NULL);
	struct pose right = right_pose();
	g_assert_cmpint(e.verification.verdict, ==, VERDICT_ACCEPTED);
	assert_apart(&right, &e.pose, 0.01, 0.05 * DEGREE);
	g_assert_cmpuint(e.a, ==, 1);
	g_assert_cmpuint(e.b, ==, 2);
	g_assert_cmpint(e.origin, ==, EDGE_AUTOMATIC);
	g_assert_cmpint(e.decision, ==, DECISION_NONE);
	g_assert_cmpfloat(e.covariance[5][5], >, 0);
	g_autofree char *inputs = align_inputs("one", "two", EDGE_AUTOMATIC);
	g_assert_cmpstr(e.inputs, ==, inputs);
	g_free(e.inputs);
	g_assert_cmpuint(align_scan_bytes(grid_scan(1)), >, 1000000);
}

/* A start that is nearly right gives the same; one that is wrong gives what is there, refused. */
static void test_start(void)
{
	struct pose right = right_pose(), near = off_by(&right, DEGREE, 0.15),
		    far = off_by(&right, 40 * DEGREE, 4);
	struct edge e = align(grid_scan(1), grid_scan(2), &near);
	g_assert_cmpint(e.verification.verdict, ==, VERDICT_ACCEPTED);
	assert_apart(&right, &e.pose, 0.01, 0.05 * DEGREE);
	g_assert_cmpint(e.origin, ==, EDGE_PICKED);
	g_free(e.inputs);
	e = align(grid_scan(1), grid_scan(2), &far);
	g_assert_cmpint(e.verification.verdict, !=, VERDICT_ACCEPTED);
	assert_apart(&far, &e.pose, 0.5, 4 * DEGREE);
	g_assert_cmpfloat(e.covariance[5][5], >, 0);
	g_free(e.inputs);
}

/* The scanner lay askew: its rows are not level, and what is up must be found. */
static void test_tilted(void)
{
	double twist[6] = { 0.5, 0.3, 0 };
	struct pose tilt = pose_perturb(&POSE_IDENTITY, twist), back = pose_inverse(&tilt);
	const range_grid *g = station(2)->grid;
	size_t cells = range_grid_cells(g);
	g_autofree double *xyz = g_new0(double, 3 * cells);
	g_autoptr(GError) error = NULL;
	for (size_t i = 0; i < cells; i++) {
		double at[3] = { g->x_m[i], g->y_m[i], g->z_m[i] };
		pose_apply(&tilt, at, at);
		for (size_t k = 0; k < 3; k++)
			xyz[k * cells + i] = at[k];
	}
	struct range_grid_desc desc = { g->columns, g->rows, xyz, xyz + cells, xyz + 2 * cells,
		g->cell, NULL, NULL };
	g_autoptr(range_grid) tilted = range_grid_new(&desc, &error);
	g_assert_no_error(error);
	g_autoptr(align_scan) b = scan_of_grid(2, SCAN_ORDERED, tilted);
	struct edge e = align(grid_scan(1), b, NULL);
	struct pose between = right_pose(), right = pose_compose(&between, &back);
	g_assert_cmpint(e.verification.verdict, ==, VERDICT_ACCEPTED);
	assert_apart(&right, &e.pose, 0.02, 0.1 * DEGREE);
	g_free(e.inputs);
}

static struct edge check(const align_scan *a, const align_scan *b, const struct pose *given)
{
	struct edge e;
	g_autoptr(GError) error = NULL;
	g_assert_true(align_scans_check(a, b, given, &e, &error));
	g_assert_no_error(error);
	g_test_message("%s: %s", verdict_names[e.verification.verdict], e.verification.reason);
	g_assert_cmpint(e.origin, ==, EDGE_GIVEN);
	g_assert_true(memcmp(&e.pose, given, sizeof e.pose) == 0);
	g_free(e.inputs);
	return e;
}

static void test_given(void)
{
	struct pose right = right_pose(), wrong = off_by(&right, 0, 0.05);
	struct edge e = check(grid_scan(1), grid_scan(2), &right);
	g_assert_cmpint(e.verification.verdict, ==, VERDICT_ACCEPTED);
	g_assert_cmpfloat(e.covariance[3][3], <, 0.01 * 0.01);
	e = check(grid_scan(1), grid_scan(2), &wrong);
	g_assert_cmpint(e.verification.verdict, !=, VERDICT_ACCEPTED);
	g_assert_cmpfloat(e.covariance[3][3], >, 0.03 * 0.03);
	wrong = off_by(&right, 90 * DEGREE, 5);
	e = check(grid_scan(1), grid_scan(2), &wrong);
	g_assert_cmpint(e.verification.verdict, !=, VERDICT_ACCEPTED);
}

/* Its own frame is turned and far off. */
static void test_cloud(void)
{
	double at[3] = { 40, -25, 3 };
	struct pose own = pose_from_yaw(2, at), back = pose_inverse(&own);
	struct pose between = right_pose(), right = pose_compose(&between, &back);
	g_autoptr(align_scan) cloud = cloud_of(2, station(2)->grid, 3, &own);
	g_assert_true(align_scan_is_cloud(cloud));
	g_assert_false(align_scan_is_cloud(grid_scan(1)));
	struct pose start = off_by(&right, DEGREE, 0);
	struct edge e = align(grid_scan(1), cloud, &start);
	double centre[3], found[3], wanted[3];
	pose_apply(&own, (double[3]){ 0 }, centre);
	pose_apply(&e.pose, centre, found);
	pose_apply(&right, centre, wanted);
	g_test_message("off by %g %g %g m", found[0] - wanted[0], found[1] - wanted[1],
		found[2] - wanted[2]);
	for (int i = 0; i < 3; i++)
		g_assert_cmpfloat_with_epsilon(found[i], wanted[i], 0.1);
	g_free(e.inputs);
	e = check(grid_scan(1), cloud, &right);
	start = off_by(&right, 30 * DEGREE, 3);
	e = check(grid_scan(1), cloud, &start);
	g_assert_cmpint(e.verification.verdict, !=, VERDICT_ACCEPTED);
}

/* Too little to align is a verdict, no error. */
static void test_small(void)
{
	static const double x[4] = { 1, 1.01, 1, 1.01 }, y[4] = { 2, 2, 2.01, 2 },
			    z[4] = { 1, 1, 0, 0 };
	static const uint8_t cell[4] = { CELL_MEASURED, CELL_MEASURED, CELL_MEASURED,
		CELL_MEASURED };
	struct range_grid_desc desc = { 2, 2, x, y, z, cell, NULL, NULL };
	g_autoptr(GError) error = NULL;
	g_autoptr(range_grid) g = range_grid_new(&desc, &error);
	g_assert_no_error(error);
	g_autoptr(align_scan) grid = scan_of_grid(2, SCAN_ORDERED, g);
	g_autoptr(align_scan) cloud = cloud_of(2, g, 1, &POSE_IDENTITY);
	struct pose start = right_pose();
	const align_scan *small[] = { grid, cloud };
	for (int i = 0; i < 2; i++) {
		struct edge e = align(grid_scan(1), small[i], NULL);
		g_assert_cmpint(e.verification.verdict, !=, VERDICT_ACCEPTED);
		g_assert_cmpuint(e.verification.reason[0], !=, 0);
		g_free(e.inputs);
		e = align(grid_scan(1), small[i], &start);
		g_assert_cmpint(e.verification.verdict, !=, VERDICT_ACCEPTED);
		g_assert_true(memcmp(&e.pose, &start, sizeof start) == 0);
		g_free(e.inputs);
		e = check(grid_scan(1), small[i], &start);
		g_assert_cmpint(e.verification.verdict, !=, VERDICT_ACCEPTED);
	}
}

static struct edge accepted(
	uint32_t a, uint32_t b, enum edge_origin origin, const struct pose *pose)
{
	struct edge e = { .a = a, .b = b, .origin = origin, .pose = *pose };
	e.verification.verdict = VERDICT_ACCEPTED;
	return e;
}

/* Scan 3 came with a wrong pose. Picked pairs put it right; the others stay where their files say. */
static void test_wrong_given(void)
{
	struct scan_given given[3] = { { 1, true, POSE_IDENTITY }, { 2, true, POSE_IDENTITY },
		{ 3, true, POSE_IDENTITY } };
	g_autoptr(scan_graph) g = scan_graph_new();
	given[0].pose.translation_m[0] = 100;
	given[1].pose = off_by(&given[0].pose, 20 * DEGREE, 8);
	given[2].pose = off_by(&given[0].pose, 90 * DEGREE, 20);
	struct pose right = pose_from_yaw(1, (double[3]){ 3, 4, 0 });
	struct pose between = pose_between(&given[0].pose, &given[1].pose);
	struct edge one = accepted(1, 2, EDGE_GIVEN, &between),
		    two = accepted(2, 3, EDGE_PICKED, &right);
	scan_graph_set_edge(g, &one);
	scan_graph_set_edge(g, &two);
	scan_graph_solve(g, given, 3);
	for (uint32_t i = 0; i < 2; i++) {
		struct pose at = scan_graph_scan(g, i + 1)->pose;
		g_assert_true(memcmp(&at, &given[i].pose, sizeof at) == 0);
	}
	struct pose is = pose_between(&scan_graph_scan(g, 2)->pose, &scan_graph_scan(g, 3)->pose);
	assert_apart(&right, &is, 1e-6, 1e-6);
	g_assert_true(edge_is_used(scan_graph_edge(g, 2, 3)));
	/* A little off is no contradiction: the files' poses hold. */
	between = pose_between(&given[1].pose, &given[2].pose);
	scan_graph_edge(g, 2, 3)->pose = off_by(&between, 0, 0.004);
	scan_graph_solve(g, given, 3);
	is = scan_graph_scan(g, 3)->pose;
	g_assert_true(memcmp(&is, &given[2].pose, sizeof is) == 0);
}

static void test_no_points(void)
{
	struct scan_data d = { .number = 7, .fingerprint = (char *)"x" };
	g_autoptr(GError) error = NULL;
	g_assert_null(align_scan_new(&d, &error));
	g_assert_nonnull(strstr(error->message, "0007"));
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/align-scans/grids", test_grids);
	g_test_add_func("/align-scans/start", test_start);
	g_test_add_func("/align-scans/tilted", test_tilted);
	g_test_add_func("/align-scans/given", test_given);
	g_test_add_func("/align-scans/cloud", test_cloud);
	g_test_add_func("/align-scans/small", test_small);
	g_test_add_func("/align-scans/wrong-given", test_wrong_given);
	g_test_add_func("/align-scans/no-points", test_no_points);
	return g_test_run();
}
