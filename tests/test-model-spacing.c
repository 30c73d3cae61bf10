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

/* ret_cell_sr: what a beam at the horizon looks at. */
static scene *scene_of_draft(model **ret_model, double *ret_cell_sr)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *path = fresh_site();
	g_autoptr(site) s = site_open_existing(path, &error);
	g_autoptr(scan_graph) g = graph_of(STATIONS);
	struct build_result result;
	build_model(s, g, NULL, &result, &error);
	g_assert_no_error(error);
	g_autoptr(scan_data) d = scan_data_load(s, 1, &error);
	g_assert_no_error(error);
	*ret_cell_sr = d->grid->column_rad * d->grid->row_rad;
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
	double cell_sr;
	g_autoptr(scene) s = scene_of_draft(&m, &cell_sr);
	g_autofree struct place *all = places_of(s);
	uint32_t large = 0, lone = 0;
	for (uint32_t i = 0; i < s->count; i++) {
		double radius_m = DISC * s->disc[i] * SCENE_UNIT_M;
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

static void test_ground(void)
{
	g_autoptr(model) m = NULL;
	double cell_sr;
	g_autoptr(scene) s = scene_of_draft(&m, &cell_sr);
	g_autofree struct place *all = places_of(s);
	const double *eye = true_pose[1].translation_m;
	uint32_t ground = 0, right = 0;
	for (uint32_t i = 0; i < s->count; i++) {
		float normal[3];
		double ray[3], far = 0, cosine = 0;
		model_unpack_normal(s->normal[i], normal);
		for (int k = 0; k < 3; k++) {
			ray[k] = all[i].at_m[k] - eye[k];
			far += ray[k] * ray[k];
			cosine -= ray[k] * normal[k];
		}
		far = sqrt(far);
		cosine /= far;
		if (normal[2] < 0.98F || ray[2] > -1 || far < 5 || far > 20 ||
			cosine < COSINE_LEAST || model_points(m)[i].plane_error > SMOOTH)
			continue;
		double level = hypot(ray[0], ray[1]) / far;
		double wanted_m = far * sqrt(cell_sr * level / cosine);
		ground++;
		right += fabs(model_points(m)[i].spacing * 1e-4 - wanted_m) < 0.15 * wanted_m;
	}
	g_test_message("%u points of the ground, %u stand for as much of it as they should", ground,
		right);
	g_assert_cmpuint(ground, >, 250);
	g_assert_cmpuint(right, >=, ground - ground / 10);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/model-spacing/lone", test_lone);
	g_test_add_func("/model-spacing/ground", test_ground);
	return g_test_run();
}
