#include "process/bench-fine.h"
#include "process/bench-cloudcompare.h"
#include "process/bench-open3d.h"
#include "process/fine.h"
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#define DEGREE        (G_PI / 180)
#define TRIALS_MAX    100
#define START_DEGREES 3.0
#define START_M       0.5

static const struct method {
	const char *title, *key;
	uint32_t trials_most; /* what takes long is tried less often */
} methods[BENCH_FINE_METHODS] = {
	[BENCH_FINE_OURS] = { "pleinair", "pleinair", TRIALS_MAX },
	[BENCH_FINE_GICP] = { "PCL GICP", "pcl_gicp", TRIALS_MAX },
	[BENCH_FINE_PLANE] = { "PCL point-to-plane", "pcl_point_to_plane", TRIALS_MAX },
	[BENCH_FINE_OPEN3D_GICP] = { "Open3D GICP", "open3d_gicp", 3 },
	[BENCH_FINE_OPEN3D_PLANE] = { "Open3D point-to-plane", "open3d_point_to_plane", 3 },
	[BENCH_FINE_CLOUDCOMPARE] = { "CloudCompare ICP", "cloudcompare_icp", 1 },
};

static double cpu_s(void)
{
	struct timespec t;
	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
	return t.tv_sec + t.tv_nsec * 1e-9;
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

static bool run_method(enum bench_fine_method method, const struct bench_fine_input *in,
	const char *folder, const struct pose *start, struct bench_fine_run *ret, GError **error)
{
	switch (method) {
	case BENCH_FINE_OURS: return run_ours(in->a, in->b, start, ret), true;
	case BENCH_FINE_OPEN3D_GICP:
	case BENCH_FINE_OPEN3D_PLANE:
		return bench_open3d_fine(folder, method, in->a, in->b, start, ret, error);
	case BENCH_FINE_CLOUDCOMPARE:
		return bench_cloudcompare_fine(folder, in->a, in->b, start, ret, error);
	default: return bench_fine_pcl(method, in->a, in->b, start, ret, error);
	}
}

static bool try_once(enum bench_fine_method method, const struct bench_fine_input *in,
	const char *folder, uint32_t trial, struct outcome *ret, GError **error)
{
	struct pose start = start_of(&in->exact, trial);
	struct bench_fine_run result;
	if (!run_method(method, in, folder, &start, &result, error))
		return false;
	struct pose between = pose_between(&result.pose, &in->exact);
	double twist[6];
	pose_difference(&result.pose, &in->exact, twist);
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
	double prepare = rank(o, count, offsetof(struct outcome, prepare_s), 0),
	       align = rank(o, count, offsetof(struct outcome, align_s), 0),
	       degrees = rank(o, count, offsetof(struct outcome, degrees), 0.5),
	       degrees_most = rank(o, count, offsetof(struct outcome, degrees), 1),
	       mm = rank(o, count, offsetof(struct outcome, mm), 0.5),
	       mm_most = rank(o, count, offsetof(struct outcome, mm), 1);
	if (!json) {
		printf("  %-21s prepare %6.3f s  align %6.3f s  error %.4f (worst %.4f) degrees, "
		       "%.2f (worst %.2f) mm\n",
			methods[method].title, prepare, align, degrees, degrees_most, mm, mm_most);
		fflush(stdout);
		return;
	}
	JsonObject *j = json_object_new();
	json_object_set_string_member(j, "method", methods[method].key);
	json_object_set_int_member(j, "trials", count);
	json_object_set_double_member(j, "prepare_cpu_s", prepare);
	json_object_set_double_member(j, "align_cpu_s", align);
	json_object_set_double_member(j, "error_deg", degrees);
	json_object_set_double_member(j, "error_deg_worst", degrees_most);
	json_object_set_double_member(j, "error_mm", mm);
	json_object_set_double_member(j, "error_mm_worst", mm_most);
	json_array_add_object_element(json, j);
}

static void tell_why_not(enum bench_fine_method method, const char *why_not, JsonArray *json)
{
	if (!json) {
		printf("  %-21s %s\n", methods[method].title, why_not);
		return;
	}
	JsonObject *j = json_object_new();
	json_object_set_string_member(j, "method", methods[method].key);
	json_object_set_string_member(j, "why_not", why_not);
	json_array_add_object_element(json, j);
}

static const char *why_not(enum bench_fine_method method)
{
	if (method == BENCH_FINE_CLOUDCOMPARE && !bench_cloudcompare_is_there())
		return BENCH_CLOUDCOMPARE_WHY_NOT;
	if ((method == BENCH_FINE_OPEN3D_GICP || method == BENCH_FINE_OPEN3D_PLANE) &&
		!bench_open3d_is_there())
		return BENCH_OPEN3D_WHY_NOT;
	return NULL;
}

bool bench_fine(const struct bench_fine_input *in, const char *folder, uint32_t trials,
	JsonArray *json, GError **error)
{
	struct outcome outcome[TRIALS_MAX];
	trials = CLAMP(trials, 1, TRIALS_MAX);
	for (int method = 0; method < BENCH_FINE_METHODS; method++) {
		g_autoptr(GError) failed = NULL;
		uint32_t count = MIN(trials, methods[method].trials_most), t = 0;
		const char *missing = why_not(method);
		while (!missing && !failed && t < count)
			if (try_once(method, in, folder, t, &outcome[t], &failed))
				t++;
		if (missing || (failed && method != BENCH_FINE_OURS)) {
			tell_why_not(method, missing ? missing : failed->message, json);
		} else if (failed) {
			g_propagate_error(error, g_steal_pointer(&failed));
			return false;
		} else {
			tell(method, outcome, count, json);
		}
	}
	return true;
}
