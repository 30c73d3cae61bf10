#include "process/bench-fine.h"
#include "acquire/scan.h"
#include "process/fine.h"
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#define DEGREE        (G_PI / 180)
#define SCENE         "court?seed=7"
#define TRIALS        5
#define TRIALS_MAX    100
#define START_DEGREES 3.0
#define START_M       0.5

static const char *const titles[] = { "ours", "PCL GICP", "PCL point-to-plane" };
static const char *const keys[] = { "ours", "pcl_gicp", "pcl_point_to_plane" };

static double cpu_s(void)
{
	struct timespec t;
	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
	return t.tv_sec + t.tv_nsec * 1e-9;
}

/* ---- the scans and the truth ---- */

static bool simulate(const char *scene, const char *path, GError **error)
{
	g_autoptr(site) s = site_open_for_writing(path, error);
	for (int station = 1; s && station <= 2; station++) {
		g_autofree char *uri =
			g_strdup_printf("sim:%s&station=%d&camera=none", scene, station);
		struct scan_options options = { .device = uri, .preset = preset_find("fine") };
		struct scan_result result;
		uint32_t partial;
		if (!scan_record(s, &options, &result, &partial, error))
			return false;
	}
	return s != NULL;
}

static range_grid *load(const site *s, uint32_t number, GError **error)
{
	g_autoptr(panorama) p = scan_load(s, number, false, error);
	return p ? range_grid_from_panorama(p) : NULL;
}

static double number_in(JsonArray *a, guint i)
{
	return json_array_get_double_element(a, i);
}

static struct pose pose_in(JsonArray *stations, guint i)
{
	JsonObject *o = json_array_get_object_element(stations, i);
	JsonArray *position = json_object_get_array_member(o, "position_m"),
		  *rotation = json_object_get_array_member(o, "rotation");
	struct pose p;
	for (guint k = 0; k < 3; k++) {
		p.translation_m[k] = number_in(position, k);
		for (guint m = 0; m < 3; m++)
			p.rotation[k][m] = number_in(json_array_get_array_element(rotation, k), m);
	}
	return p;
}

/* The simulator stands beside this program, or on the path. */
static char *simulator(void)
{
	g_autofree char *self = g_file_read_link("/proc/self/exe", NULL);
	g_autofree char *folder = self ? g_path_get_dirname(self) : g_strdup(".");
	char *beside = g_build_filename(folder, "pleinair-sim", NULL);
	if (g_file_test(beside, G_FILE_TEST_IS_EXECUTABLE))
		return beside;
	g_free(beside);
	return g_strdup("pleinair-sim");
}

static bool true_pose(const char *scene, struct pose *ret, GError **error)
{
	g_autofree char *program = simulator(), *json = NULL;
	g_autoptr(JsonParser) parser = json_parser_new();
	const char *argv[] = { program, "--truth-poses", scene, NULL };
	int status;
	if (!g_spawn_sync(NULL, (char **)argv, NULL, G_SPAWN_SEARCH_PATH, NULL, NULL, &json, NULL,
		    &status, error) ||
		!g_spawn_check_wait_status(status, error) ||
		!json_parser_load_from_data(parser, json, -1, error))
		return false;
	JsonArray *stations = json_node_get_array(json_parser_get_root(parser));
	struct pose a = pose_in(stations, 0), b = pose_in(stations, 1);
	*ret = pose_between(&a, &b);
	return true;
}

/* ---- trials ---- */

struct outcome {
	double prepare_s, align_s, degrees, mm;
};

static struct pose start_of(const struct pose *exact, uint32_t trial)
{
	g_autoptr(GRand) chance = g_rand_new_with_seed(1000 + trial);
	double v[6], n = 0, m = 0, turn[6] = { 0 };
	for (int k = 0; k < 6; k++)
		v[k] = g_rand_double_range(chance, -1, 1);
	for (int k = 0; k < 3; k++) {
		n += v[k] * v[k];
		m += v[3 + k] * v[3 + k];
	}
	for (int k = 0; k < 3; k++)
		turn[k] = v[k] / sqrt(n) * START_DEGREES * DEGREE;
	struct pose off = POSE_IDENTITY;
	off = pose_perturb(&off, turn);
	off = pose_compose(exact, &off);
	for (int k = 0; k < 3; k++)
		off.translation_m[k] += v[3 + k] / sqrt(m) * START_M;
	return off;
}

static void run_ours(const range_grid *a, const range_grid *b, const struct pose *start,
	struct bench_fine_run *ret)
{
	double begin = cpu_s();
	g_autoptr(fine_scan) fa = fine_scan_new(a);
	g_autoptr(fine_scan) fb = fine_scan_new(b);
	struct fine_result r;
	ret->prepare_s = cpu_s() - begin;
	ret->converged = fine_align(fa, fb, start, FINE_FROM_COARSE, &r) && r.converged;
	ret->align_s = cpu_s() - begin - ret->prepare_s;
	ret->pose = r.pose;
}

static bool try_once(enum bench_fine_method method, const range_grid *a, const range_grid *b,
	const struct pose *exact, uint32_t trial, struct outcome *ret, GError **error)
{
	struct pose start = start_of(exact, trial);
	struct bench_fine_run result;
	if (method == BENCH_FINE_OURS)
		run_ours(a, b, &start, &result);
	else if (!bench_fine_pcl(method, a, b, &start, &result, error))
		return false;
	struct pose between = pose_between(&result.pose, exact);
	double twist[6];
	pose_difference(&result.pose, exact, twist);
	*ret = (struct outcome){ result.prepare_s, result.align_s,
		pose_angle_rad(&between) / DEGREE,
		1e3 * sqrt(twist[3] * twist[3] + twist[4] * twist[4] + twist[5] * twist[5]) };
	return true;
}

/* ---- what came of it ---- */

static int by_value(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

/* Of one member of the outcomes; sorts a copy. */
static double rank(const struct outcome *o, uint32_t count, size_t member, double share)
{
	double value[TRIALS_MAX];
	for (uint32_t i = 0; i < count; i++)
		value[i] = G_STRUCT_MEMBER(double, &o[i], member);
	qsort(value, count, sizeof *value, by_value);
	return value[(uint32_t)(share * (count - 1))];
}

static void tell(
	enum bench_fine_method method, const struct outcome *o, uint32_t count, JsonArray *json)
{
	double prepare = rank(o, count, offsetof(struct outcome, prepare_s), 0.5),
	       align = rank(o, count, offsetof(struct outcome, align_s), 0.5),
	       degrees = rank(o, count, offsetof(struct outcome, degrees), 0.5),
	       degrees_most = rank(o, count, offsetof(struct outcome, degrees), 1),
	       mm = rank(o, count, offsetof(struct outcome, mm), 0.5),
	       mm_most = rank(o, count, offsetof(struct outcome, mm), 1);
	if (!json) {
		printf("%-20s prepare %6.3f s  align %6.3f s  error %.4f (worst %.4f) degrees, "
		       "%.2f "
		       "(worst %.2f) mm\n",
			titles[method], prepare, align, degrees, degrees_most, mm, mm_most);
		fflush(stdout);
		return;
	}
	JsonObject *j = json_object_new();
	json_object_set_string_member(j, "method", keys[method]);
	json_object_set_int_member(j, "trials", count);
	json_object_set_double_member(j, "prepare_cpu_s", prepare);
	json_object_set_double_member(j, "align_cpu_s", align);
	json_object_set_double_member(j, "error_deg", degrees);
	json_object_set_double_member(j, "error_deg_worst", degrees_most);
	json_object_set_double_member(j, "error_mm", mm);
	json_object_set_double_member(j, "error_mm_worst", mm_most);
	json_array_add_object_element(json, j);
}

static bool measure(
	const char *site_path, const char *scene, uint32_t trials, JsonArray *json, GError **error)
{
	g_autoptr(site) s = site_open(site_path, error);
	g_autoptr(range_grid) a = s ? load(s, 1, error) : NULL;
	g_autoptr(range_grid) b = a ? load(s, 2, error) : NULL;
	struct pose exact;
	struct outcome outcome[TRIALS_MAX];
	if (!b || !true_pose(scene, &exact, error))
		return false;
	for (int method = 0; method < BENCH_FINE_METHODS; method++) {
		for (uint32_t t = 0; t < trials; t++)
			if (!try_once(method, a, b, &exact, t, &outcome[t], error))
				return false;
		tell(method, outcome, trials, json);
	}
	return true;
}

static void remove_folder(const char *path)
{
	const char *argv[] = { "rm", "-rf", "--", path, NULL };
	g_spawn_sync(
		NULL, (char **)argv, NULL, G_SPAWN_SEARCH_PATH, NULL, NULL, NULL, NULL, NULL, NULL);
}

bool bench_fine(const struct bench_fine_options *o, JsonArray **ret_json, GError **error)
{
	const char *scene = o->scene ? o->scene : SCENE;
	uint32_t trials = CLAMP(o->trials ? o->trials : TRIALS, 1, TRIALS_MAX);
	g_autofree char *folder = o->site ? NULL : g_dir_make_tmp("pleinair-bench-XXXXXX", error);
	g_autofree char *path = o->site  ? g_strdup(o->site)
				: folder ? g_build_filename(folder, "site", NULL)
					 : NULL;
	JsonArray *json = ret_json ? json_array_new() : NULL;
	bool good = path && (o->site || simulate(scene, path, error)) &&
		    measure(path, scene, trials, json, error);
	if (folder)
		remove_folder(folder);
	if (good && ret_json)
		*ret_json = json;
	else if (json)
		json_array_unref(json);
	return good;
}
