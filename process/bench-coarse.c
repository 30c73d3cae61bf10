#include "process/bench-coarse.h"
#include "firmware-io/files.h"
#include "process/bench-open3d.h"
#include <stdio.h>

static bool by_pcl(const char *folder, const range_grid *a, const range_grid *b,
	struct bench_coarse_run *ret, GError **error)
{
	(void)folder;
	return bench_coarse_pcl(a, b, ret, error);
}

static const struct program {
	const char *title, *key;
	bool (*run)(const char *folder, const range_grid *a, const range_grid *b,
		struct bench_coarse_run *ret, GError **error);
} programs[] = {
	{ "Open3D FPFH + RANSAC", "open3d_fpfh_ransac", bench_open3d_coarse },
	{ "PCL FPFH + prerejective", "pcl_fpfh_prerejective", by_pcl },
	{ NULL },
};

struct score {
	uint32_t pairs, right;
	double cpu_s; /* of one, the mean */
	char *why_not;
};

static bool is_right(const struct pose *found, const struct pose *truth)
{
	struct pose off = pose_between(truth, found);
	return pose_angle_rad(&off) <= BENCH_COARSE_RIGHT_RAD &&
	       pose_distance_m(&off) <= BENCH_COARSE_RIGHT_M;
}

static struct score score_of(const struct program *p, const char *folder,
	const struct bench_coarse_pair *pairs, uint32_t count)
{
	struct score s = { 0 };
	for (uint32_t n = 0; n < count && !s.why_not; n++) {
		g_autoptr(GError) error = NULL;
		struct bench_coarse_run r;
		if (!p->run(folder, pairs[n].a, pairs[n].b, &r, &error)) {
			s.why_not = g_strdup(error->message);
			continue;
		}
		s.pairs++;
		s.right += is_right(&r.pose, &pairs[n].truth);
		s.cpu_s += (r.cpu_s - s.cpu_s) / s.pairs;
	}
	return s;
}

static struct score score_of_ours(const struct bench_coarse_pair *pairs, uint32_t count)
{
	struct score s = { .pairs = count };
	for (uint32_t n = 0; n < count; n++) {
		s.right += pairs[n].ours_right;
		s.cpu_s += pairs[n].ours_cpu_s / count;
	}
	return s;
}

static void tell(const char *title, const char *key, const struct score *s, JsonArray *json)
{
	if (!json && s->why_not)
		printf("  %-24s %s\n", title, s->why_not);
	else if (!json)
		printf("  %-24s %6.2f s a pair, %u of %u right\n", title, s->cpu_s, s->right,
			s->pairs);
	fflush(stdout);
	if (!json)
		return;
	JsonObject *o = json_object_new();
	json_object_set_string_member(o, "method", key);
	if (s->why_not) {
		json_object_set_string_member(o, "why_not", s->why_not);
	} else {
		json_object_set_int_member(o, "pairs", s->pairs);
		json_object_set_int_member(o, "right", s->right);
		json_object_set_double_member(
			o, "right_percent", 100.0 * s->right / MAX(s->pairs, 1));
		json_object_set_double_member(o, "cpu_s", s->cpu_s);
	}
	json_array_add_object_element(json, o);
}

bool bench_coarse(
	const struct bench_coarse_pair *pairs, uint32_t count, JsonArray *json, GError **error)
{
	g_autofree char *folder = g_dir_make_tmp("pleinair-bench-XXXXXX", error);
	if (!folder)
		return false;
	if (!json)
		printf("the first %u pairs that overlap, beside other programs, one thread:\n",
			count);
	struct score ours = score_of_ours(pairs, count);
	tell("pleinair, with fine", "pleinair", &ours, json);
	for (const struct program *p = programs; p->run; p++) {
		struct score s = score_of(p, folder, pairs, count);
		tell(p->title, p->key, &s, json);
		g_free(s.why_not);
	}
	return files_remove_tree(folder, error);
}
