/* How much surface the points of a model stand for: all of a floor that is met aslant, and no more than was seen of things that merely
 * look like one. */
#define STATIONS 1
#include "process/build-model.h"
#include "render/scene.h"
#include "tests/segmented-site.h"

/* As masks draw them. */
#define DISC 0.75

struct place {
	double at_m[3];
};

static scene *scene_of_draft(model **ret_model, scan_data **ret_scan)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *path = fresh_site();
	g_autoptr(site) s = site_open_existing(path, &error);
	g_autoptr(scan_graph) g = graph_of(STATIONS);
	struct build_result result;
	build_model(s, g, NULL, &result, &error);
	g_assert_no_error(error);
	*ret_scan = scan_data_load(s, 1, &error);
	g_assert_no_error(error);
	*ret_model = model_open(path, &error);
	scene *made = scene_new(*ret_model, &error);
	g_assert_no_error(error);
	g_assert_cmpuint(made->count, >, 20000);
	return made;
}

static struct place *places_of(const scene *s)
{
	struct place *all = g_new(struct place, s->count);
	for (uint32_t n = 0; n < s->chunks; n++)
		for (uint32_t i = 0; i < s->chunk[n].count; i++)
			scene_position(s, &s->chunk[n], i, all[s->chunk[n].first + i].at_m);
	return all;
}

/* Points that a disc of so much lies over, in its plane. */
static uint32_t held(const scene *s, const struct place *all, uint32_t i, double radius_m)
{
	float normal[3];
	uint32_t found = 0;
	model_unpack_normal(s->normal[i], normal);
	for (uint32_t j = 0; j < s->count; j++) {
		double far2 = 0, off = 0;
		for (int k = 0; k < 3; k++) {
			double to = all[j].at_m[k] - all[i].at_m[k];
			far2 += to * to;
			off += to * normal[k];
		}
		found += j != i && far2 < radius_m * radius_m && fabs(off) < 0.15 * radius_m + 0.03;
	}
	return found;
}

static void test_lone(void)
{
	g_autoptr(model) m = NULL;
	g_autoptr(scan_data) d = NULL;
	g_autoptr(scene) s = scene_of_draft(&m, &d);
	g_autofree struct place *all = places_of(s);
	uint32_t large = 0, lone = 0;
	for (uint32_t i = 0; i < s->count; i++) {
		double radius_m = DISC * s->disc[i] * (double)s->unit_m;
		if (s->normal[i][0] == MODEL_NORMAL_NONE ||
			s->disc[i] < 3 * model_points(m)[i].size)
			continue;
		large++;
		lone += held(s, all, i, radius_m) < 2;
	}
	g_test_message(
		"%u discs are three times as large as their beams, %u of them lie over nothing",
		large, lone);
	g_assert_cmpuint(large, >, 500);
	g_assert_cmpuint(lone, <=, large / 200);
}

/* Smooth ground, which is no leaf that lies level. */
#define SMOOTH       100 /* 0.1 mm */
#define COSINE_LEAST 0.05

/* How the scanner met a point, if that is ground that is taken here. */
static bool is_ground(const scene *s, const model *m, const struct place *at, uint32_t i,
	double *ret_far, double *ret_level, double *ret_cosine)
{
	const double *eye = true_pose[1].translation_m;
	float normal[3];
	double ray[3], far = 0, cosine = 0;
	model_unpack_normal(s->normal[i], normal);
	for (int k = 0; k < 3; k++) {
		ray[k] = at->at_m[k] - eye[k];
		far += ray[k] * ray[k];
		cosine -= ray[k] * normal[k];
	}
	*ret_far = far = sqrt(far);
	*ret_level = hypot(ray[0], ray[1]) / far;
	*ret_cosine = cosine /= far;
	return normal[2] >= 0.98F && ray[2] <= -1 && far >= 5 && far <= 20 &&
	       cosine >= COSINE_LEAST && model_points(m)[i].plane_error <= SMOOTH;
}

static size_t nearest_cell(const range_grid *g, const double at_m[3])
{
	const struct pose back = pose_inverse(&true_pose[1]);
	double from[3];
	pose_apply(&back, at_m, from);
	size_t cell = 0;
	double least = INFINITY;
	for (size_t i = 0; i < range_grid_cells(g); i++) {
		double x = g->x_m[i] - from[0], y = g->y_m[i] - from[1], z = g->z_m[i] - from[2];
		double far2 = g->range_m[i] > 0 ? x * x + y * y + z * z : INFINITY;
		cell = far2 < least ? i : cell;
		least = fmin(least, far2);
	}
	return cell;
}

/* Columns from the middle between its beam and the one before to the middle between it and the one behind; 0: one is not there. */
static double columns_of(const range_grid *g, size_t i)
{
	double azimuth[2];
	for (int k = 0; k < 2; k++) {
		size_t j;
		if (!range_grid_step(g, (uint32_t)(i / g->columns), (uint32_t)(i % g->columns), 0,
			    2 * k - 1, &j) ||
			!(g->range_m[j] > 0))
			return 0;
		azimuth[k] = atan2((double)g->x_m[j], (double)g->y_m[j]);
	}
	return remainder(azimuth[1] - azimuth[0], 2 * G_PI) / 2 / g->column_rad;
}

/* Also beside gaps between lines, which stand otherwise than columns do. */
static void test_ground(void)
{
	g_autoptr(model) m = NULL;
	g_autoptr(scan_data) d = NULL;
	g_autoptr(scene) s = scene_of_draft(&m, &d);
	g_autofree struct place *all = places_of(s);
	double cell_sr = d->grid->column_rad * d->grid->row_rad;
	uint32_t ground = 0, right = 0, wide = 0;
	for (uint32_t i = 0; i < s->count; i++) {
		double far, level, cosine, columns;
		if (!is_ground(s, m, &all[i], i, &far, &level, &cosine))
			continue;
		columns = columns_of(d->grid, nearest_cell(d->grid, all[i].at_m));
		if (columns == 0)
			continue;
		double wanted_m = far * sqrt(cell_sr * level / cosine * columns);
		ground++;
		wide += columns > 1.15;
		right += fabs(model_points(m)[i].spacing * 1e-4 - wanted_m) < 0.05 * wanted_m;
	}
	g_test_message("%u points of the ground, %u of them beside gaps; %u stand for as much of "
		       "it as they should",
		ground, wide, right);
	g_assert_cmpuint(ground, >, 250);
	g_assert_cmpuint(wide, >, 20);
	g_assert_cmpuint(right, >=, ground - ground / 10);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/model-spacing/lone", test_lone);
	g_test_add_func("/model-spacing/ground", test_ground);
	return g_test_run();
}
