#include "process/bench-export.h"
#include "acquire/strict-json.h"
#include "firmware-io/files.h"
#include "process/bench-run.h"
#include "process/bench-street.h"
#include <glib/gstdio.h>
#include <stdio.h>
#include <string.h>

/* What is to be reached, for 100 million points. */
#define PEAK_MIB_MAX    1024.0
#define E57_MILLION_MIN 20.0

struct row {
	const char *format, *extension;
	const char *option; /* NULL: none */
	struct bench_run run;
	uint64_t bytes;
};

static bool export_one(const char *site_path, const char *folder, struct row *r, GError **error)
{
	g_autofree char *program = bench_program("export"),
			*name = g_strconcat("street.", r->extension, NULL),
			*path = g_build_filename(folder, name, NULL);
	const char *argv[] = { program, site_path, "-o", path, "--json", r->option, NULL };
	GStatBuf about;
	if (!bench_run(argv, &r->run, error))
		return false;
	if (g_stat(path, &about))
		return files_fail(error, path, "look at it");
	r->bytes = (uint64_t)about.st_size;
	g_clear_pointer(&r->run.output, g_free);
	g_unlink(path);
	return true;
}

static bool make_site(const char *path, uint32_t scans, uint64_t *ret_points, GError **error)
{
	g_autoptr(site) s = site_open_for_writing(path, error);
	scan_graph g = bench_street_graph(scans);
	g.edges = g_array_new(false, true, sizeof(struct edge));
	bool good = s;
	for (uint32_t i = 0; good && i < scans; i++)
		good = bench_street_add(s, i, ret_points, error);
	good = good && scan_graph_save(&g, s, "made", error);
	g_array_unref(g.scans);
	g_array_unref(g.edges);
	return good;
}

/* ---- the figures ---- */

static double million_a_minute(const struct row *r, uint64_t count)
{
	return (double)count * 1e-6 / (r->run.cpu_seconds / 60);
}

static void print_text(const struct row *rows, size_t count, uint64_t made, uint32_t scans)
{
	printf("export: %.1f million points of %u scans; each file is read back and compared\n",
		(double)made * 1e-6, scans);
	printf("%-20s %10s %10s %22s %12s %12s\n", "", "s", "s of cpu", "million points/minute",
		"bytes/point", "peak MiB");
	for (size_t i = 0; i < count; i++) {
		const struct row *r = &rows[i];
		double rate = million_a_minute(r, made);
		bool is_e57 = !strcmp(r->format, "E57");
		printf("%-20s %10.1f %10.1f %21.1f%s %12.1f %11.0f%s\n", r->format, r->run.seconds,
			r->run.cpu_seconds, rate, is_e57 && rate < E57_MILLION_MIN ? "*" : " ",
			(double)r->bytes / (double)made, r->run.peak_mib,
			r->run.peak_mib > PEAK_MIB_MAX ? "*" : "");
	}
	printf("meant to reach, of one core: E57 >= %.0f million points a minute; peak <= %.0f MiB "
	       "for 100 million "
	       "points; * is not\n",
		E57_MILLION_MIN, PEAK_MIB_MAX);
}

static void print_json(const struct row *rows, size_t count, uint64_t made, uint32_t scans)
{
	JsonObject *o = json_object_new();
	JsonArray *array = json_array_new();
	for (size_t i = 0; i < count; i++) {
		const struct row *r = &rows[i];
		JsonObject *row = json_object_new();
		json_object_set_string_member(row, "format", r->format);
		json_object_set_double_member(row, "seconds", r->run.seconds);
		json_object_set_double_member(row, "cpu_seconds", r->run.cpu_seconds);
		json_object_set_double_member(
			row, "million_points_a_minute", million_a_minute(r, made));
		json_object_set_double_member(
			row, "bytes_a_point", (double)r->bytes / (double)made);
		json_object_set_double_member(row, "peak_mib", r->run.peak_mib);
		json_array_add_object_element(array, row);
	}
	json_object_set_int_member(o, "points", (gint64)made);
	json_object_set_int_member(o, "scans", scans);
	json_object_set_array_member(o, "formats", array);
	g_autoptr(JsonNode) node = json_node_new(JSON_NODE_OBJECT);
	json_node_take_object(node, o);
	g_autofree char *text = strict_json_write(node);
	fputs(text, stdout);
}

bool bench_export(const struct bench_export_options *options, GError **error)
{
	struct row rows[] = { { "E57", "e57" }, { "E57, 2 cm apart", "e57", "--spacing=0.02" },
		{ "PTX", "ptx" }, { "LAS", "las" }, { "PLY", "ply" }, { "PCD", "pcd" } };
	const char *parent = options->folder ? options->folder : g_get_tmp_dir();
	uint32_t scans = (uint32_t)CLAMP(
		options->million_points * 1e6 / BENCH_STREET_POINTS, 1, SITE_SCANS_MAX);
	uint64_t made = 0;
	g_autofree char *folder = g_build_filename(parent, "pleinair-bench-XXXXXX", NULL);
	if (!g_mkdtemp(folder))
		return files_fail(error, folder, "make the folder");
	g_autofree char *path = g_build_filename(folder, "site", NULL);
	bool good = make_site(path, scans, &made, error);
	for (size_t i = 0; good && i < G_N_ELEMENTS(rows); i++)
		good = export_one(path, folder, &rows[i], error);
	if (!files_remove_tree(folder, good ? error : NULL) || !good)
		return false;
	if (options->json)
		print_json(rows, G_N_ELEMENTS(rows), made, scans);
	else
		print_text(rows, G_N_ELEMENTS(rows), made, scans);
	return true;
}
