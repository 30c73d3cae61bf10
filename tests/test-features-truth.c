/* Feature points and lines of simulated scenes against the truth. */
#include "process/feature-score.h"
#include "process/features.h"
#include "process/normals.h"
#include "sim/truth.h"
#include "tests/placed-scans.h"

static struct feature_truth *truth_of(const char *description, const range_grid *g)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(truth) t = truth_new(description, &error);
	g_assert_no_error(error);
	size_t cells = range_grid_cells(g);
	struct feature_truth *ret = g_new0(struct feature_truth, cells);
	g_autofree struct truth_cell *seen = g_new0(struct truth_cell, cells);
	struct truth_panorama p = { g->columns, g->rows, 50 * G_PI / 180, -40 * G_PI / 180 };
	truth_look_around(t, &p, seen);
	for (size_t i = 0; i < cells; i++) {
		ret[i].range_m = seen[i].range_m;
		memcpy(ret[i].normal, seen[i].normal, sizeof ret[i].normal);
		ret[i].instance = seen[i].instance;
		ret[i].is_plant = seen[i].class == WORLD_VEGETATION;
		ret[i].is_glass = seen[i].optics != WORLD_DIFFUSE;
	}
	return ret;
}

static void test_simulated(void)
{
	static const char *const scenes[] = {
		"court?seed=21&station=", "street?seed=22&station=", "bridge?seed=23&station="
	};
	for (size_t s = 0; s < G_N_ELEMENTS(scenes); s++) {
		struct features_input in[2] = { 0 };
		const struct placed *scan[2];
		g_autofree char *first = g_strconcat(scenes[s], "1", NULL),
				*second = g_strconcat(scenes[s], "2", NULL);
		scan[0] = placed_scan(first);
		scan[1] = placed_scan(second);
		for (int k = 0; k < 2; k++)
			in[k] = (struct features_input){ .grid = scan[k]->grid,
				.pose = scan[k]->pose };
		g_autoptr(features) f = features_of_scans(in, 2, 0, NULL);
		g_autofree struct feature_truth *really = truth_of(first, in[0].grid);
		struct feature_score score;
		feature_score_make(f, in[0].grid, really, normals_range_noise_m(in[0].grid, NULL),
			NULL, &score);
		double recall = (double)score.edges_found / (double)score.edges;
		double wrong = (double)score.false_points / (double)score.points;
		double leaves = (double)score.leaves_directed / (double)MAX(score.leaves, 1);
		g_test_message("%s: recall %.3f, false %.3f, leaves directed %.3f", scenes[s],
			recall, wrong, leaves);
		g_assert_cmpuint(score.edges, >, 1000);
		g_assert_cmpfloat(recall, >, 0.9);
		g_assert_cmpfloat(wrong, <, 0.1);
		g_assert_cmpfloat(leaves, <, 0.1);
		const struct feature_lines *l = &score.straight;
		g_test_message("straight: %.3f of %u directed, off by %.2f degrees, p90 %.2f",
			(double)l->directed / (double)l->straight, (unsigned)l->straight,
			l->p50_deg, l->p90_deg);
		if (l->straight < 100)
			continue;
		g_assert_cmpfloat(l->p90_deg, <, 3);
		g_assert_cmpuint(5 * l->directed, >, 2 * l->straight);
	}
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/features-truth/simulated", test_simulated);
	return g_test_run();
}
