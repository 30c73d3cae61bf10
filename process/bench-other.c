#include "process/bench-other.h"
#include "firmware-io/files.h"
#include "process/bench-run.h"
#include <gio/gio.h>
#include <stdio.h>
#include <string.h>

#define LIMIT_S         "600"
#define TIMEOUT_EXPIRED 124

/* ---- what is there ---- */

static bool has_modules(const char *python, const char *modules)
{
	g_autofree char *program = g_strconcat("import ", modules, NULL);
	const char *argv[] = { python, "-c", program, NULL };
	int status;
	return g_spawn_sync(NULL, (char **)argv, NULL,
		       G_SPAWN_SEARCH_PATH | G_SPAWN_STDOUT_TO_DEV_NULL |
			       G_SPAWN_STDERR_TO_DEV_NULL,
		       NULL, NULL, NULL, NULL, &status, NULL) &&
	       g_spawn_check_wait_status(status, NULL);
}

/* Debian's modules belong to Debian's Python, which need not be the first. */
const char *bench_python(const char *modules)
{
	static const char *const pythons[] = { "/usr/bin/python3", "python3" };
	for (size_t n = 0; n < G_N_ELEMENTS(pythons); n++)
		if (has_modules(pythons[n], modules))
			return pythons[n];
	return NULL;
}

/* ---- points ---- */

static bool is_point(const range_grid *g, size_t cell)
{
	return g->range_m[cell] > 0;
}

bool bench_other_write(
	const range_grid *g, const struct pose *moved, const char *path, GError **error)
{
	FILE *to = fopen(path, "wbe");
	if (!to)
		return files_fail(error, path, "write");
	fprintf(to,
		"ply\nformat binary_little_endian 1.0\nelement vertex %zu\n"
		"property float x\nproperty float y\nproperty float z\nend_header\n",
		range_grid_count(g));
	for (size_t i = 0; i < range_grid_cells(g); i++) {
		double at_m[3] = { g->x_m[i], g->y_m[i], g->z_m[i] };
		if (!is_point(g, i))
			continue;
		if (moved)
			pose_apply(moved, at_m, at_m);
		float written_m[3] = { (float)at_m[0], (float)at_m[1], (float)at_m[2] };
		fwrite(written_m, sizeof written_m, 1, to);
	}
	bool good = !ferror(to);
	return (fclose(to) == 0 && good) || files_fail(error, path, "write");
}

void bench_other_spread(
	const range_grid *g, const float *normals, size_t stride, float *const ret_normal[3])
{
	size_t point = 0;
	for (size_t i = 0; i < range_grid_cells(g); i++) {
		bool there = is_point(g, i);
		const float *n = normals + point * stride;
		bool good = there && isfinite(n[0]) && isfinite(n[1]) && isfinite(n[2]);
		for (int k = 0; k < 3; k++)
			ret_normal[k][i] = good ? n[k] : 0;
		point += there;
	}
}

bool bench_other_pose(const double m[16], struct pose *ret)
{
	struct pose p;
	for (int i = 0; i < 3; i++) {
		for (int k = 0; k < 3; k++)
			p.rotation[i][k] = m[4 * i + k];
		p.translation_m[i] = m[4 * i + 3];
	}
	if (!pose_is_rigid(&p, 1e-3))
		return false;
	pose_orthonormalise(&p);
	*ret = p;
	return true;
}

/* ---- running ---- */

/* The last line that a program left behind mostly tells what was wrong. */
static char *last_line(const char *output)
{
	g_auto(GStrv) lines = g_strsplit(output ? output : "", "\n", -1);
	for (guint n = g_strv_length(lines); n > 0; n--)
		if (*g_strstrip(lines[n - 1]))
			return g_strndup(lines[n - 1], 200);
	return g_strdup("it says nothing");
}

bool bench_other_run(const char *name, const char *folder, const char *const *argv,
	struct bench_other_run *ret, GError **error)
{
	/* The status goes to the end of what it writes, so that what it wrote is not lost with it. */
	static const char *const before[] = {
		"sh",
		"-c",
		"cd \"$0\" && OMP_NUM_THREADS=1 QT_QPA_PLATFORM=offscreen timeout " LIMIT_S
		" \"$@\" 2>&1; s=$?; echo; echo \"status $s\"",
	};
	g_autoptr(GPtrArray) all = g_ptr_array_new();
	for (size_t n = 0; n < G_N_ELEMENTS(before); n++)
		g_ptr_array_add(all, (char *)before[n]);
	g_ptr_array_add(all, (char *)folder);
	for (size_t n = 0; argv[n]; n++)
		g_ptr_array_add(all, (char *)argv[n]);
	g_ptr_array_add(all, NULL);
	struct bench_run run = { 0 };
	if (!bench_run((const char *const *)all->pdata, &run, error))
		return g_prefix_error(error, "%s: ", name), false;
	g_autofree char *output = run.output;
	char *end = strrchr(output, '\n') ? g_strrstr(output, "\nstatus ") : NULL;
	int status = end ? atoi(end + 8) : 1;
	if (end)
		*end = '\0';
	if (status) {
		g_autofree char *line = last_line(output);
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_FAILED, "%s: %s", name,
			status == TIMEOUT_EXPIRED ? "did not end within ten minutes" : line);
		return false;
	}
	*ret = (struct bench_other_run){ g_steal_pointer(&output), run.cpu_seconds };
	return true;
}
