#include "process/bench-process.h"
#include "acquire/cli.h"
#include "acquire/scan.h"
#include "firmware-io/files.h"
#include "process/bench-fine.h"
#include "process/bench-sites.h"
#include "process/bench-truth.h"
#include "process/scan-data.h"
#include <stdio.h>
#include <string.h>
#include <time.h>

#define SMOOTH_CELLS 4 /* no edge this near */
#define SMOOTH_COS   0.9994f
#define LEAVES       2 /* vegetation's class in the truth */

static const struct section {
	const char *title, *key;
	bench_section run;
} sections[] = {
	{ "normals", "normals", bench_normals },
	{ NULL },
};

double bench_cpu_s(void)
{
	struct timespec t;
	clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* ---- the truth ---- */

static bool is_smooth(
	const range_grid *g, const struct bench_truth_cell *t, uint32_t row, uint32_t column)
{
	const struct bench_truth_cell *here = &t[(size_t)row * g->columns + column];
	if (here->class == LEAVES || row < SMOOTH_CELLS || row + SMOOTH_CELLS >= g->rows)
		return false;
	for (int down = -SMOOTH_CELLS; down <= SMOOTH_CELLS; down += 2)
		for (int right = -SMOOTH_CELLS; right <= SMOOTH_CELLS; right += 2) {
			uint32_t c = (column + g->columns + right) % g->columns;
			const struct bench_truth_cell *k =
				&t[(size_t)(row + down) * g->columns + c];
			float dot = k->normal[0] * here->normal[0] +
				    k->normal[1] * here->normal[1] + k->normal[2] * here->normal[2];
			if (k->instance != here->instance || dot < SMOOTH_COS ||
				fabsf(k->range_m - here->range_m) > 0.2f + 0.1f * here->range_m)
				return false;
		}
	return true;
}

static void take_truth(struct bench_known_scan *scan, const struct bench_truth_scan *t)
{
	size_t cells = range_grid_cells(scan->grid);
	scan->pose = t->pose;
	scan->elevation_max_rad = t->elevation_max_rad;
	scan->elevation_min_rad = t->elevation_min_rad;
	scan->truth = g_new0(struct bench_truth, cells);
	for (size_t i = 0; i < cells; i++) {
		scan->truth[i].range_m = t->cell[i].range_m;
		memcpy(scan->truth[i].normal, t->cell[i].normal, sizeof t->cell[i].normal);
		scan->truth[i].smooth = is_smooth(scan->grid, t->cell,
			(uint32_t)(i / scan->grid->columns), (uint32_t)(i % scan->grid->columns));
	}
}

range_grid *bench_exact_grid(const struct bench_known_scan *scan, GError **error)
{
	const range_grid *g = scan->grid;
	size_t cells = range_grid_cells(g);
	double row_rad = (scan->elevation_max_rad - scan->elevation_min_rad) / g->rows;
	g_autofree double *x = g_new0(double, cells), *y = g_new0(double, cells),
			  *z = g_new0(double, cells);
	g_autofree uint8_t *cell = g_new0(uint8_t, cells);
	for (size_t i = 0; i < cells; i++) {
		double range_m = scan->truth[i].range_m;
		double azimuth = ((double)(i % g->columns) + 0.5) * 2 * G_PI / g->columns;
		double elevation =
			scan->elevation_max_rad - ((double)(i / g->columns) + 0.5) * row_rad;
		cell[i] = CELL_NO_RETURN;
		if (!(range_m > 0) || g->cell[i] != CELL_MEASURED)
			continue;
		cell[i] = CELL_MEASURED;
		x[i] = range_m * cos(elevation) * sin(azimuth);
		y[i] = range_m * cos(elevation) * cos(azimuth);
		z[i] = range_m * sin(elevation);
	}
	struct range_grid_desc desc = { g->columns, g->rows, x, y, z, cell, NULL, NULL };
	return range_grid_new(&desc, error);
}

/* ---- the scans ---- */

/* Two scans without photos, unless all four are there or shall stay. */
static bool make_site(const char *path, const struct bench_process_options *o,
	const struct preset *preset, uint32_t scans, GError **error)
{
	struct bench_scene court = { .name = "court", .seed = o->seed };
	if (o->keep)
		return bench_scene_scan(&court, path, preset, error);
	g_autoptr(site) s = site_open_for_writing(path, error);
	for (uint32_t i = 0; s && i < scans; i++) {
		g_autofree char *description = bench_scene_station(&court, i + 1);
		g_autofree char *device = g_strconcat("sim:", description, "&camera=none", NULL);
		struct scan_options options = { .device = device, .preset = preset };
		struct scan_result result;
		uint32_t partial;
		if (!scan_record(s, &options, &result, &partial, error))
			return false;
	}
	return s;
}

static bool simulate(struct bench_data *data, const struct bench_process_options *o, GError **error)
{
	const struct preset *preset = preset_find(o->preset ? o->preset : "fine");
	struct bench_scene court = { .name = "court", .seed = o->seed };
	g_autofree char *truth = g_build_filename(data->folder, "truth", NULL),
			*name = g_strdup_printf(
				"court-%" G_GUINT64_FORMAT "-%s", (guint64)o->seed, preset->name),
			*path = g_build_filename(o->keep ? o->keep : data->folder, name, NULL);
	if ((o->keep && !files_make_folder(o->keep, error)) ||
		!make_site(path, o, preset, G_N_ELEMENTS(data->scan), error))
		return false;
	g_autoptr(site) s = site_open(path, error);
	for (uint32_t i = 0; s && i < G_N_ELEMENTS(data->scan); i++) {
		g_autofree char *description = bench_scene_station(&court, i + 1);
		g_autoptr(panorama) p = scan_load(s, i + 1, false, error);
		struct bench_truth_scan t;
		if (!p)
			return false;
		data->scan[i].grid = range_grid_from_panorama(p);
		if (!bench_truth_ask(description, data->scan[i].grid->columns,
			    data->scan[i].grid->rows, truth, &t, error))
			return false;
		take_truth(&data->scan[i], &t);
		g_free(t.cell);
	}
	return s;
}

static bool load_site(struct bench_data *data, const char *path, GError **error)
{
	g_autoptr(site) s = site_open(path, error);
	g_autoptr(GArray) numbers = s ? site_scans(s, error) : NULL;
	uint32_t found = 0;
	for (guint i = 0; numbers && i < numbers->len && found < G_N_ELEMENTS(data->scan); i++) {
		g_autoptr(scan_data) d =
			scan_data_load(s, g_array_index(numbers, uint32_t, i), error);
		if (!d)
			return false;
		if (d->grid)
			data->scan[found++].grid = g_steal_pointer(&d->grid);
	}
	if (numbers && !found)
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND, "%s: has no scan with a grid",
			path);
	return found;
}

static void clear(struct bench_data *data)
{
	for (size_t i = 0; i < G_N_ELEMENTS(data->scan); i++) {
		range_grid_free(data->scan[i].grid);
		g_free(data->scan[i].truth);
	}
}

/* ---- what comes out ---- */

static const char *number(double value, int digits, char into[static 32])
{
	if (isnan(value))
		return "-";
	g_snprintf(into, 32, "%.*f", digits, value);
	return into;
}

static void print_table(const struct section *s, GArray *lines)
{
	printf("%s, one thread\n  %-26s %8s %8s %18s %18s %9s\n", s->title, "", "CPU s", "Mpt/s",
		"smooth med / p90", "all med / p90", "none %");
	printf("  %-26s %8s %8s %18s %18s %9s\n", "(reach)", "<= 0.10", "", "<= 0.70 /      -", "",
		"<= 1");
	for (guint i = 0; i < lines->len; i++) {
		const struct bench_line *l = &g_array_index(lines, struct bench_line, i);
		char b[7][32];
		if (l->why_not) {
			printf("  %-26s %s\n", l->method, l->why_not);
			continue;
		}
		printf("  %-26s %8s %8s %8s /%7s %8s /%7s %9s\n", l->method,
			number(l->cpu_s, 3, b[0]), number(l->points / l->cpu_s * 1e-6, 2, b[1]),
			number(l->median_deg, 2, b[2]), number(l->p90_deg, 2, b[3]),
			number(l->all_median_deg, 2, b[4]), number(l->all_p90_deg, 2, b[5]),
			number(l->none_percent, 2, b[6]));
	}
}

static void add_number(JsonObject *j, const char *key, double value)
{
	if (!isnan(value))
		json_object_set_double_member(j, key, value);
}

static JsonArray *json_of(GArray *lines)
{
	JsonArray *array = json_array_new();
	for (guint i = 0; i < lines->len; i++) {
		const struct bench_line *l = &g_array_index(lines, struct bench_line, i);
		JsonObject *j = json_object_new();
		json_object_set_string_member(j, "method", l->method);
		json_array_add_object_element(array, j);
		if (l->why_not) {
			json_object_set_string_member(j, "why_not", l->why_not);
			continue;
		}
		add_number(j, "cpu_s", l->cpu_s);
		add_number(j, "points", l->points);
		add_number(j, "smooth_median_deg", l->median_deg);
		add_number(j, "smooth_p90_deg", l->p90_deg);
		add_number(j, "all_median_deg", l->all_median_deg);
		add_number(j, "all_p90_deg", l->all_p90_deg);
		add_number(j, "none_percent", l->none_percent);
	}
	return array;
}

/* On the scans as they are, then on what a scanner without noise would have: there the method alone shows. */
static bool measure_fine(const struct bench_data *data, JsonObject *json, GError **error)
{
	const struct bench_known_scan *s = data->scan;
	if (!s[0].truth || !s[1].truth)
		return true;
	g_autoptr(range_grid) a = bench_exact_grid(&s[0], error);
	g_autoptr(range_grid) b = a ? bench_exact_grid(&s[1], error) : NULL;
	struct pose pose = pose_between(&s[0].pose, &s[1].pose);
	const struct bench_fine_input scanned = { s[0].grid, s[1].grid, pose },
				      exact = { a, b, pose };
	JsonArray *list[2] = { json ? json_array_new() : NULL, json ? json_array_new() : NULL };
	if (json) {
		json_object_set_array_member(json, "fine", list[0]);
		json_object_set_array_member(json, "fine_exact", list[1]);
	}
	if (!b)
		return false;
	if (!json)
		puts("fine alignment, one thread, from 0.5 m and 3 degrees off (reach: <= 0.20 s "
		     "in all; on true ranges "
		     "0.001 degrees, 0.1 mm)");
	if (!bench_fine(&scanned, data->folder, data->repeats, list[0], error))
		return false;
	if (!json)
		puts("the same on true ranges");
	return bench_fine(&exact, data->folder, data->repeats, list[1], error);
}

static void clear_line(gpointer line)
{
	g_free(((struct bench_line *)line)->why_not);
}

static bool measure(const struct bench_data *data, JsonObject *json, GError **error)
{
	for (const struct section *s = sections; s->run; s++) {
		g_autoptr(GArray) lines = g_array_new(FALSE, FALSE, sizeof(struct bench_line));
		g_array_set_clear_func(lines, clear_line);
		if (!s->run(data, lines, error))
			return false;
		if (json)
			json_object_set_array_member(json, s->key, json_of(lines));
		else
			print_table(s, lines);
	}
	return measure_fine(data, json, error);
}

bool bench_process(const struct bench_process_options *o, GError **error)
{
	g_autofree char *folder = g_dir_make_tmp("pleinair-bench-XXXXXX", error);
	struct bench_data data = { .repeats = o->repeats ? o->repeats : 5, .folder = folder };
	if (!folder)
		return false;
	JsonObject *json = o->json ? json_object_new() : NULL;
	bool good = o->site ? load_site(&data, o->site, error) : simulate(&data, o, error);
	if (good && json) {
		json_object_set_int_member(json, "columns", data.scan[0].grid->columns);
		json_object_set_int_member(json, "rows", data.scan[0].grid->rows);
	} else if (good) {
		printf("process: %u x %u cells, %zu measured\n", data.scan[0].grid->columns,
			data.scan[0].grid->rows, range_grid_count(data.scan[0].grid));
	}
	good = good && measure(&data, json, error);
	good = files_remove_tree(folder, good ? error : NULL) && good;
	clear(&data);
	if (good && json)
		cli_print_json(json);
	else if (json)
		json_object_unref(json);
	return good;
}
