#include "process/bench-model.h"
#include "acquire/strict-json.h"
#include "firmware-io/files.h"
#include "process/bench-street.h"
#include "process/build-model.h"
#include <glib/gstdio.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>

struct figures {
	uint64_t measured, file_bytes;
	struct build_result most, last;
	double cpu_s, cpu_last_s; /* of all threads, and the system's for them */
	double peak_mib;
};

static double cpu_now_s(void)
{
	struct rusage u;
	getrusage(RUSAGE_SELF, &u);
	return (double)(u.ru_utime.tv_sec + u.ru_stime.tv_sec) +
	       1e-6 * (double)(u.ru_utime.tv_usec + u.ru_stime.tv_usec);
}

static bool build(site *s, uint32_t scans, const struct bench_model_options *o,
	struct build_result *ret, double *ret_cpu_s, GError **error)
{
	double began_s = cpu_now_s();
	struct build_options options = { .memory_bytes = o->memory_bytes };
	scan_graph g = bench_street_graph(scans);
	bool ok = build_model(s, &g, &options, ret, error);
	g_array_unref(g.scans);
	*ret_cpu_s = cpu_now_s() - began_s;
	return ok;
}

static bool measure(const char *path, uint32_t scans, const struct bench_model_options *o,
	struct figures *f, GError **error)
{
	g_autoptr(site) s = site_open_for_writing(path, error);
	if (!s)
		return false;
	for (uint32_t k = 0; k < scans; k++)
		if (!bench_street_add(s, k, &f->measured, error))
			return false;
	if (!build(s, scans - 1, o, &f->most, &f->cpu_s, error) ||
		!build(s, scans, o, &f->last, &f->cpu_last_s, error))
		return false;
	g_autofree char *model = g_build_filename(path, "model", "points.model", NULL);
	GStatBuf about;
	if (g_stat(model, &about) != 0)
		return files_fail(error, model, "look at");
	f->file_bytes = (uint64_t)about.st_size;
	struct rusage u;
	getrusage(RUSAGE_SELF, &u);
	f->peak_mib = (double)u.ru_maxrss / 1024;
	return true;
}

/* ---- the figures ---- */

static void print_json(uint32_t scans, const struct figures *f)
{
	JsonObject *j = json_object_new();
	json_object_set_int_member(j, "scans", scans);
	json_object_set_int_member(j, "measured", (gint64)f->measured);
	json_object_set_int_member(j, "points", (gint64)f->last.points);
	json_object_set_int_member(j, "redundant", (gint64)f->last.redundant);
	json_object_set_int_member(j, "file_bytes", (gint64)f->file_bytes);
	json_object_set_double_member(j, "seconds", f->most.seconds);
	json_object_set_double_member(j, "seconds_one_more", f->last.seconds);
	json_object_set_double_member(j, "cpu_seconds", f->cpu_s);
	json_object_set_double_member(j, "cpu_seconds_one_more", f->cpu_last_s);
	json_object_set_int_member(j, "rebuilt_one_more", f->last.scans_rebuilt);
	json_object_set_int_member(j, "taken_over", (gint64)f->last.points_taken_over);
	json_object_set_double_member(j, "peak_mib", f->peak_mib);
	g_autoptr(JsonNode) node = json_node_new(JSON_NODE_OBJECT);
	json_node_take_object(node, j);
	g_autofree char *text = strict_json_write(node);
	fputs(text, stdout);
}

static void print_text(uint32_t scans, const struct figures *f)
{
	double most = (double)(f->most.points + f->most.redundant);
	printf("model: %u scans of %u x %u along a street\n", scans, BENCH_STREET_COLUMNS,
		BENCH_STREET_ROWS);
	printf("  %-28s %10.1f million\n", "measured points", (double)f->measured * 1e-6);
	printf("  %-28s %10.1f million\n", "in the model", (double)f->last.points * 1e-6);
	printf("  %-28s %10.1f\n", "bytes a point", (double)f->file_bytes / (double)f->last.points);
	printf("  %-28s %10.1f s, %.1f s of processors\n", "all scans but the last",
		f->most.seconds, f->cpu_s);
	printf("  %-28s %10.2f million points/s\n", "", most / f->most.seconds * 1e-6);
	printf("  %-28s %10.1f s, %.1f s of processors (%u scans sorted anew)\n", "with the last",
		f->last.seconds, f->cpu_last_s, f->last.scans_rebuilt);
	printf("  %-28s %10.1f %% of the points\n", "taken over as they were",
		100 * (double)f->last.points_taken_over / (double)f->last.points);
	printf("  %-28s %10.0f MiB  (reach: <= 4096 for 100 million)\n", "peak resident memory",
		f->peak_mib);
}

bool bench_model(const struct bench_model_options *options, GError **error)
{
	struct figures f = { 0 };
	const char *parent = options->folder ? options->folder : g_get_tmp_dir();
	uint32_t scans = (uint32_t)CLAMP(options->million_points / 1.9, 2, SITE_SCANS_MAX);
	g_autofree char *folder = g_build_filename(parent, "pleinair-bench-XXXXXX", NULL);
	if (!g_mkdtemp(folder))
		return files_fail(error, folder, "make the folder");
	g_autofree char *path = g_build_filename(folder, "site", NULL);
	bool ok = measure(path, scans, options, &f, error);
	if (!files_remove_tree(folder, ok ? error : NULL) || !ok)
		return false;
	if (options->json)
		print_json(scans, &f);
	else
		print_text(scans, &f);
	return true;
}
