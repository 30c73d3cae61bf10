#include "process/bench-model.h"
#include "acquire/points.h"
#include "acquire/strict-json.h"
#include "firmware-io/files.h"
#include "process/build-model.h"
#include <glib/gstdio.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>

#define COLUMNS   3000u
#define ROWS      792u
#define SPACING_M 8.0
#define HALF_M    7.0 /* of the street's width */
#define HEIGHT_M  1.7 /* of the scanner */
#define REACH_M   60.0
#define NOISE_M   0.006

struct figures {
	uint64_t measured, file_bytes;
	struct build_result most, last;
	double cpu_s, cpu_last_s; /* of all threads, and the system's for them */
	double peak_mib;
};

/* ---- the street ---- */

/* The walls stand at +-HALF_M, with windows 0.3 m deep; along x. */
static double wall_m(double x, double z)
{
	bool is_window = fmod(x + 1e4, 3) < 1.4 && fmod(z + 1e3, 3.2) > 1.2;
	return HALF_M + (is_window ? 0.3 : 0);
}

/* Range to the ground or the wall, 0: beyond reach. The wall's depth is that of where its front would be met. */
static double cast(double at_x, const double d[3])
{
	double ground = d[2] < 0 ? -HEIGHT_M / d[2] : INFINITY;
	double front = fabs(d[1]) > 1e-9 ? HALF_M / fabs(d[1]) : INFINITY;
	double wall =
		front < REACH_M ? wall_m(at_x + front * d[0], front * d[2]) / fabs(d[1]) : INFINITY;
	bool is_sky = wall * d[2] > 14;
	double range = fmin(ground, is_sky ? INFINITY : wall);
	return range < REACH_M ? range : 0;
}

static uint64_t hash(uint64_t v)
{
	v = (v ^ v >> 30) * 0xBF58476D1CE4E5B9u;
	v = (v ^ v >> 27) * 0x94D049BB133111EBu;
	return v ^ v >> 31;
}

/* About normal, standard deviation 1: the sum of four. */
static double noise_of(uint64_t id)
{
	uint64_t h = hash(id * 0x9E3779B97F4A7C15u + 1);
	double sum = 0;
	for (int i = 0; i < 4; i++)
		sum += (double)(h >> 16 * i & 0xFFFF) / 65536 - 0.5;
	return sum * sqrt(3);
}

static struct point_record look(uint32_t scan, uint32_t row, uint32_t column)
{
	double azimuth = (column + 0.5) * 2 * G_PI / COLUMNS;
	double elevation = (50 - (row + 0.5) * 90 / ROWS) * G_PI / 180;
	double d[3] = { cos(elevation) * sin(azimuth), cos(elevation) * cos(azimuth),
		sin(elevation) };
	double range = cast(scan * SPACING_M, d);
	if (range <= 0)
		return (struct point_record){ .cell = CELL_NO_RETURN };
	range += NOISE_M * noise_of(((uint64_t)scan * ROWS + row) * COLUMNS + column);
	return (struct point_record){ .x_m = range * d[0],
		.y_m = range * d[1],
		.z_m = range * d[2],
		.intensity = (uint16_t)(30000 / (1 + range)),
		.rgb = { 200, 180, (uint8_t)row },
		.cell = CELL_MEASURED,
		.return_number = 1 };
}

/* ---- the site ---- */

static bool write_points(const char *path, uint32_t scan, uint64_t *ret_measured, GError **error)
{
	g_autoptr(points_writer) w = points_writer_new(path, COLUMNS, ROWS, error);
	for (uint32_t row = 0; w && row < ROWS; row++) {
		struct point_record line[COLUMNS];
		for (uint32_t c = 0; c < COLUMNS; c++) {
			line[c] = look(scan, row, c);
			*ret_measured += line[c].cell == CELL_MEASURED;
		}
		if (!points_writer_append(w, line, COLUMNS, error))
			return false;
	}
	return w && points_writer_finish(w, error);
}

/* What loading asks for; nothing checks the hash. */
static bool write_manifest(const char *path, uint32_t number, GError **error)
{
	g_autofree char *text = g_strdup_printf(
		"{ \"schema\": 1, \"number\": %u, \"created\": \"2000-01-01T00:00:00Z\", "
		"\"kind\": \"imported\", \"points\": { \"count\": %u, \"columns\": %u, \"rows\": "
		"%u }, "
		"\"files\": { \"points.ply\": { \"bytes\": 1, \"sha256\": \"%064u\" } } }\n",
		number, COLUMNS * ROWS, COLUMNS, ROWS, number);
	return files_write(path, text, strlen(text), error);
}

static bool add_scan(site *s, uint32_t scan, uint64_t *ret_measured, GError **error)
{
	uint32_t number;
	g_autofree char *folder = site_stage_scan(s, &number, error);
	if (!folder)
		return false;
	g_autofree char *ply = g_build_filename(folder, "points.ply", NULL);
	g_autofree char *json = g_build_filename(folder, "scan.json", NULL);
	g_autoptr(GPtrArray) folders = g_ptr_array_new();
	g_ptr_array_add(folders, folder);
	return write_points(ply, scan, ret_measured, error) &&
	       write_manifest(json, number, error) && site_add_staged(s, folders, error);
}

static scan_graph graph_of(uint32_t scans)
{
	scan_graph g = { .scans = g_array_new(FALSE, TRUE, sizeof(struct placed_scan)) };
	for (uint32_t k = 0; k < scans; k++) {
		struct placed_scan p = { .number = k + 1, .group = 1, .pose = POSE_IDENTITY };
		p.pose.translation_m[0] = k * SPACING_M;
		g_array_append_val(g.scans, p);
	}
	return g;
}

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
	scan_graph g = graph_of(scans);
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
		if (!add_scan(s, k, &f->measured, error))
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
	printf("model: %u scans of %u x %u along a street\n", scans, COLUMNS, ROWS);
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
