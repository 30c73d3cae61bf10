#include "process/bench-open3d.h"
#include "process/bench-other.h"
#include <glib/gstdio.h>
#include <string.h>

/* Arguments: what to do, a file, a second file, and for fine alignment the start, row by row. */
static const char program[] =
	"import json, sys, time\n"
	"import numpy\n"
	"import open3d\n"
	"registration = open3d.pipelines.registration\n"
	"nearest = open3d.geometry.KDTreeSearchParamKNN(20)\n"
	"clock = time.process_time\n"
	"def thin(cloud, voxel):\n"
	"    small = cloud.voxel_down_sample(voxel)\n"
	"    small.estimate_normals(nearest)\n"
	"    return small\n"
	"def normals(cloud, to):\n"
	"    began = clock()\n"
	"    cloud.estimate_normals(nearest)\n"
	"    took = clock() - began\n"
	"    numpy.asarray(cloud.normals, dtype='<f4').tofile(to)\n"
	"    return {'cpu_s': took}\n"
	"def answer(began, between, found):\n"
	"    return {'prepare_s': between - began, 'align_s': clock() - between,\n"
	"            'pose': found.transformation.flatten().tolist()}\n"
	"def fine(method, a, b, start):\n"
	"    began = clock()\n"
	"    a, b = thin(a, 0.25), thin(b, 0.25)\n"
	"    between = clock()\n"
	"    enough = registration.ICPConvergenceCriteria(1e-10, 1e-10, 100)\n"
	"    if method == 'gicp':\n"
	"        how = registration.TransformationEstimationForGeneralizedICP()\n"
	"        found = registration.registration_generalized_icp(b, a, 1.0, start, how, enough)\n"
	"    else:\n"
	"        how = registration.TransformationEstimationPointToPlane()\n"
	"        found = registration.registration_icp(b, a, 1.0, start, how, enough)\n"
	"    return answer(began, between, found)\n"
	"def coarse(a, b):\n"
	"    began = clock()\n"
	"    a, b = thin(a, 0.5), thin(b, 0.5)\n"
	"    wide = open3d.geometry.KDTreeSearchParamHybrid(2.5, 100)\n"
	"    of_a, of_b = (registration.compute_fpfh_feature(c, wide) for c in (a, b))\n"
	"    between = clock()\n"
	"    checks = [registration.CorrespondenceCheckerBasedOnEdgeLength(0.9),\n"
	"              registration.CorrespondenceCheckerBasedOnDistance(0.75)]\n"
	"    found = registration.registration_ransac_based_on_feature_matching(\n"
	"        b, a, of_b, of_a, True, 0.75,\n"
	"        registration.TransformationEstimationPointToPoint(False), 3, checks,\n"
	"        registration.RANSACConvergenceCriteria(100000, 0.999))\n"
	"    return answer(began, between, found)\n"
	"open3d.utility.set_verbosity_level(open3d.utility.VerbosityLevel.Error)\n"
	"if hasattr(open3d.utility, 'random'):\n"
	"    open3d.utility.random.seed(1)\n"
	"read = open3d.io.read_point_cloud\n"
	"what, first, second = sys.argv[1:4]\n"
	"if what == 'normals':\n"
	"    done = normals(read(first), second)\n"
	"elif what == 'coarse':\n"
	"    done = coarse(read(first), read(second))\n"
	"else:\n"
	"    start = numpy.array([float(x) for x in sys.argv[4:]]).reshape(4, 4)\n"
	"    done = fine(what, read(first), read(second), start)\n"
	"print(json.dumps(done))\n";

bool bench_open3d_is_there(void)
{
	return bench_python("open3d") != NULL;
}

/* ---- the program ---- */

static void add_start(GPtrArray *argv, const struct pose *start)
{
	char text[G_ASCII_DTOSTR_BUF_SIZE];
	for (int n = 0; n < 16; n++) {
		int i = n / 4, k = n % 4;
		double value = i == 3   ? k == 3
			       : k == 3 ? start->translation_m[i]
					: start->rotation[i][k];
		g_ptr_array_add(argv, g_strdup(g_ascii_dtostr(text, sizeof text, value)));
	}
}

/* What the program said last; caller unrefs. */
static JsonObject *run(const char *folder, const char *what, const char *first, const char *second,
	const struct pose *start, GError **error)
{
	const char *words[] = { bench_python("open3d"), "-c", program, what, first, second };
	g_autoptr(GPtrArray) argv = g_ptr_array_new_with_free_func(g_free);
	g_autoptr(JsonParser) parser = json_parser_new();
	struct bench_other_run ran;
	if (!words[0]) {
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND, "Open3D: %s",
			BENCH_OPEN3D_WHY_NOT);
		return NULL;
	}
	for (size_t n = 0; n < G_N_ELEMENTS(words); n++)
		g_ptr_array_add(argv, g_strdup(words[n]));
	if (start)
		add_start(argv, start);
	g_ptr_array_add(argv, NULL);
	if (!bench_other_run("Open3D", folder, (const char *const *)argv->pdata, &ran, error))
		return NULL;
	g_autofree char *said = ran.output;
	/* Warnings may stand before it. */
	const char *answer = strrchr(said, '{');
	if (!json_parser_load_from_data(parser, answer ? answer : said, -1, error) ||
		!JSON_NODE_HOLDS_OBJECT(json_parser_get_root(parser))) {
		if (error && !*error)
			g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_DATA,
				"its answer is no object");
		return g_prefix_error(error, "Open3D: "), NULL;
	}
	return json_object_ref(json_node_get_object(json_parser_get_root(parser)));
}

static bool read_pose(JsonObject *o, struct pose *ret, GError **error)
{
	JsonArray *pose =
		json_object_has_member(o, "pose") ? json_object_get_array_member(o, "pose") : NULL;
	double m[16];
	for (guint n = 0; pose && n < 16; n++)
		m[n] = n < json_array_get_length(pose) ? json_array_get_double_element(pose, n)
						       : NAN;
	if (pose && bench_other_pose(m, ret))
		return true;
	g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_DATA, "Open3D: its answer is no pose");
	return false;
}

/* ---- what is measured ---- */

bool bench_open3d_normals(const char *folder, const range_grid *g, float *const ret_normal[3],
	double *ret_cpu_s, GError **error)
{
	g_autofree char *points = g_build_filename(folder, "points.ply", NULL),
			*normals = g_build_filename(folder, "normals.f32", NULL), *bytes = NULL;
	size_t length, wanted = range_grid_count(g) * 3 * sizeof(float);
	g_autoptr(JsonObject) o = bench_other_write(g, NULL, points, error)
					  ? run(folder, "normals", points, normals, NULL, error)
					  : NULL;
	bool good = o && g_file_get_contents(normals, &bytes, &length, error);
	if (good && length != wanted) {
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_DATA,
			"Open3D: it wrote %zu bytes of normals, not %zu", length, wanted);
		good = false;
	}
	if (good) {
		*ret_cpu_s = json_object_get_double_member(o, "cpu_s");
		bench_other_spread(g, (const float *)(const void *)bytes, 3, ret_normal);
	}
	g_unlink(points);
	g_unlink(normals);
	return good;
}

static bool align(const char *folder, const char *what, const range_grid *a, const range_grid *b,
	const struct pose *start, struct bench_fine_run *ret, GError **error)
{
	g_autofree char *first = g_build_filename(folder, "a.ply", NULL),
			*second = g_build_filename(folder, "b.ply", NULL);
	g_autoptr(JsonObject) o = bench_other_write(a, NULL, first, error) &&
						  bench_other_write(b, NULL, second, error)
					  ? run(folder, what, first, second, start, error)
					  : NULL;
	g_unlink(first);
	g_unlink(second);
	if (!o || !read_pose(o, &ret->pose, error))
		return false;
	ret->prepare_s = json_object_get_double_member(o, "prepare_s");
	ret->align_s = json_object_get_double_member(o, "align_s");
	ret->converged = true;
	return true;
}

bool bench_open3d_fine(const char *folder, enum bench_fine_method method, const range_grid *a,
	const range_grid *b, const struct pose *start, struct bench_fine_run *ret, GError **error)
{
	return align(folder, method == BENCH_FINE_OPEN3D_GICP ? "gicp" : "plane", a, b, start, ret,
		error);
}

bool bench_open3d_coarse(const char *folder, const range_grid *a, const range_grid *b,
	struct bench_coarse_run *ret, GError **error)
{
	struct bench_fine_run run_of;
	if (!align(folder, "coarse", a, b, NULL, &run_of, error))
		return false;
	*ret = (struct bench_coarse_run){ run_of.pose, run_of.prepare_s + run_of.align_s };
	return true;
}
