#include "process/bench-cloudcompare.h"
#include "firmware-io/files.h"
#include "process/bench-other.h"
#include <gio/gio.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PROGRAM "CloudCompare"

bool bench_cloudcompare_is_there(void)
{
	g_autofree char *path = g_find_program_in_path(PROGRAM);
	return path != NULL;
}

/* words: after those that every run has; ends with NULL. */
static bool run(const char *folder, const char *const *words, double *ret_cpu_s, GError **error)
{
	g_autoptr(GPtrArray) argv = g_ptr_array_new();
	static const char *const first[] = { PROGRAM, "-SILENT", "-AUTO_SAVE", "OFF" };
	struct bench_other_run ran;
	for (size_t n = 0; n < G_N_ELEMENTS(first); n++)
		g_ptr_array_add(argv, (char *)first[n]);
	for (size_t n = 0; words[n]; n++)
		g_ptr_array_add(argv, (char *)words[n]);
	g_ptr_array_add(argv, NULL);
	if (!bench_other_run(PROGRAM, folder, (const char *const *)argv->pdata, &ran, error))
		return false;
	g_free(ran.output);
	*ret_cpu_s = ran.cpu_s;
	return true;
}

static bool fail(GError **error, const char *what)
{
	g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_DATA, PROGRAM ": %s", what);
	return false;
}

/* ---- normals ---- */

/* A PLY as it writes them: each point with x, y, z and nx, ny, nz, all floats. */
static bool read_normals(
	const char *path, const range_grid *g, float *const ret_normal[3], GError **error)
{
	g_autofree char *bytes = NULL;
	size_t length, points = range_grid_count(g);
	static const char last[] = "end_header\n";
	if (!g_file_get_contents(path, &bytes, &length, error))
		return g_prefix_error(error, PROGRAM ": "), false;
	const char *end = g_strstr_len(bytes, (gssize)MIN(length, 4096), last);
	const char *body = end ? end + strlen(last) : NULL;
	size_t rest = body ? length - (size_t)(body - bytes) : 0;
	size_t stride = points ? rest / points : 0;
	if (!g_strstr_len(bytes, (gssize)MIN(length, 4096), "property float nx") ||
		rest != stride * points || stride != 6 * sizeof(float))
		return fail(error, "what it wrote has no normals of these points");
	/* The body begins anywhere. */
	g_autofree float *normals = g_malloc(rest);
	memcpy(normals, body, rest);
	bench_other_spread(g, normals + 3, 6, ret_normal);
	return true;
}

bool bench_cloudcompare_normals(const char *folder, const range_grid *g, float *const ret_normal[3],
	double *ret_cpu_s, GError **error)
{
	static const char *const save[] = { "-C_EXPORT_FMT", "PLY", "-PLY_EXPORT_FMT", "BINARY_LE",
		"-SAVE_CLOUDS", "FILE", "normals.ply" };
	const char *with[] = { "-O", "points.ply", "-OCTREE_NORMALS", "0.1", save[0], save[1],
		save[2], save[3], save[4], save[5], save[6], NULL };
	const char *without[] = { "-O", "points.ply", save[0], save[1], save[2], save[3], save[4],
		save[5], save[6], NULL };
	g_autofree char *work = g_build_filename(folder, "cloudcompare", NULL),
			*points = g_build_filename(work, "points.ply", NULL),
			*normals = g_build_filename(work, "normals.ply", NULL);
	double all_s = 0, rest_s = 0;
	bool good = files_make_folder(work, error) && bench_other_write(g, NULL, points, error) &&
		    run(work, without, &rest_s, error) && run(work, with, &all_s, error) &&
		    read_normals(normals, g, ret_normal, error);
	*ret_cpu_s = fmax(all_s - rest_s, 0);
	return files_remove_tree(work, good ? error : NULL) && good;
}

/* ---- fine alignment ---- */

/* It names the file of its matrix by the time of day. */
static bool read_matrix(const char *folder, double ret[16], GError **error)
{
	g_autoptr(GPtrArray) names = files_names(folder, error);
	for (guint n = 0; names && n < names->len; n++) {
		g_autofree char *path = g_build_filename(folder, names->pdata[n], NULL),
				*text = NULL;
		if (!strstr(names->pdata[n], "REGISTRATION_MATRIX"))
			continue;
		if (!g_file_get_contents(path, &text, NULL, error))
			return false;
		char *at = text;
		for (int i = 0; i < 16; i++)
			ret[i] = g_ascii_strtod(at, &at);
		return true;
	}
	return names && fail(error, "it wrote no matrix");
}

bool bench_cloudcompare_fine(const char *folder, const range_grid *a, const range_grid *b,
	const struct pose *start, struct bench_fine_run *ret, GError **error)
{
	const char *with[] = { "-O", "b.ply", "-O", "a.ply", "-ICP", "-OVERLAP", "60", NULL };
	const char *without[] = { "-O", "b.ply", "-O", "a.ply", NULL };
	g_autofree char *work = g_build_filename(folder, "cloudcompare", NULL),
			*first = g_build_filename(work, "a.ply", NULL),
			*second = g_build_filename(work, "b.ply", NULL);
	double all_s = 0, rest_s = 0, m[16];
	struct pose step;
	/* It begins where the points stand. */
	bool good = files_make_folder(work, error) && bench_other_write(a, NULL, first, error) &&
		    bench_other_write(b, start, second, error) &&
		    run(work, without, &rest_s, error) && run(work, with, &all_s, error) &&
		    read_matrix(work, m, error) &&
		    (bench_other_pose(m, &step) || fail(error, "its matrix is no pose"));
	if (good)
		*ret = (struct bench_fine_run){ .pose = pose_compose(&step, start),
			.align_s = fmax(all_s - rest_s, 0),
			.converged = true };
	return files_remove_tree(work, good ? error : NULL) && good;
}
