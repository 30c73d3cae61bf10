#include "process/bench-cloudcompare.h"
#include "process/bench-open3d.h"
#include "process/bench-process.h"
#include "process/geometry.h"
#include <stdlib.h>

/* A cell whose range is not that of the truth is a mixed one, or one with another edge: no normal is right there. */
#define TRUE_WITHIN_M 0.1f
#define TRUE_WITHIN   0.02f
#define WHILE_S       2.0

static int by_float(const void *a, const void *b)
{
	float x = *(const float *)a, y = *(const float *)b;
	return (x > y) - (x < y);
}

static double quantile(GArray *values, double at)
{
	if (!values->len)
		return NAN;
	g_array_sort(values, by_float);
	return g_array_index(values, float, (guint)(at * (values->len - 1)));
}

/* Directions count, not signs: PCL's are turned towards the origin as ours are, but a wrong side is no worse for being one. */
static float angle_deg(const float a[3], const float b[3])
{
	double cross[3] = { a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
		a[0] * b[1] - a[1] * b[0] };
	double dot = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
	return (float)(atan2(sqrt(cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2]),
			       fabs(dot)) *
		       180 / G_PI);
}

static void score(
	const struct bench_known_scan *scan, const float *const normal[3], struct bench_line *line)
{
	const range_grid *g = scan->grid;
	size_t none = 0, measured = range_grid_count(g);
	g_autoptr(GArray) all = g_array_new(FALSE, FALSE, sizeof(float));
	g_autoptr(GArray) smooth = g_array_new(FALSE, FALSE, sizeof(float));
	for (size_t i = 0; i < range_grid_cells(g); i++) {
		float n[3] = { normal[0][i], normal[1][i], normal[2][i] };
		const struct bench_truth *t = scan->truth ? &scan->truth[i] : NULL;
		if (!(g->range_m[i] > 0))
			continue;
		if (n[0] == 0 && n[1] == 0 && n[2] == 0) {
			none++;
			continue;
		}
		if (!t || fabsf(t->range_m - g->range_m[i]) >
				  TRUE_WITHIN_M + TRUE_WITHIN * g->range_m[i])
			continue;
		float angle = angle_deg(n, t->normal);
		g_array_append_val(all, angle);
		if (t->smooth)
			g_array_append_val(smooth, angle);
	}
	line->points = (double)measured;
	line->none_percent = 100.0 * (double)none / (double)measured;
	line->median_deg = quantile(smooth, 0.5);
	line->p90_deg = quantile(smooth, 0.9);
	line->all_median_deg = quantile(all, 0.5);
	line->all_p90_deg = quantile(all, 0.9);
}

/* Whatever else the machine does only adds to it: the least counts, of as many as fit into a while. */
struct timing {
	uint32_t done;
	double least_s, all_s;
};

static bool goes_on(const struct timing *t, uint32_t repeats)
{
	return t->done < repeats || t->all_s < WHILE_S;
}

static void add_time(struct timing *t, double cpu_s)
{
	t->least_s = t->done++ ? fmin(t->least_s, cpu_s) : cpu_s;
	t->all_s += cpu_s;
}

static void measure_ours(const struct bench_data *data, GArray *lines)
{
	struct bench_line line = { .method = "pleinair" };
	struct timing timing = { 0 };
	g_autoptr(geometry) g = NULL;
	struct geometry_options options = { .single_thread = true };
	while (goes_on(&timing, data->repeats)) {
		g_clear_pointer(&g, geometry_free);
		double start_s = bench_cpu_s();
		g = geometry_estimate(data->scan[0].grid, &options);
		add_time(&timing, bench_cpu_s() - start_s);
	}
	const float *normal[3] = { g->normal_x, g->normal_y, g->normal_z };
	score(&data->scan[0], normal, &line);
	line.cpu_s = timing.least_s;
	g_array_append_val(lines, line);
}

static bool measure_pcl(const struct bench_data *data, enum bench_pcl method, const char *name,
	GArray *lines, GError **error)
{
	struct bench_line line = { .method = name };
	struct timing timing = { 0 };
	size_t cells = range_grid_cells(data->scan[0].grid);
	g_autofree float *planes = g_new(float, 3 * cells);
	float *const normal[3] = { planes, planes + cells, planes + 2 * cells };
	do {
		double cpu_s;
		if (!bench_pcl_normals(data->scan[0].grid, method, normal, &cpu_s, error))
			return false;
		add_time(&timing, cpu_s);
	} while (method != BENCH_PCL_NEIGHBOURS && /* it takes seconds */
		 goes_on(&timing, data->repeats));
	score(&data->scan[0], (const float *const *)normal, &line);
	line.cpu_s = timing.least_s;
	g_array_append_val(lines, line);
	return true;
}

/* ---- programs of others ---- */

static const struct other {
	const char *title, *why_not;
	bool (*is_there)(void);
	bool (*run)(const char *folder, const range_grid *g, float *const ret_normal[3],
		double *ret_cpu_s, GError **error);
} others[] = {
	{ "Open3D k = 20", BENCH_OPEN3D_WHY_NOT, bench_open3d_is_there, bench_open3d_normals },
	{ "CloudCompare octree", BENCH_CLOUDCOMPARE_WHY_NOT, bench_cloudcompare_is_there,
		bench_cloudcompare_normals },
};

/* Once, since they take seconds. */
static void measure_other(const struct bench_data *data, const struct other *o, GArray *lines)
{
	struct bench_line line = { .method = o->title };
	g_autoptr(GError) error = NULL;
	size_t cells = range_grid_cells(data->scan[0].grid);
	g_autofree float *planes = g_new(float, 3 * cells);
	float *const normal[3] = { planes, planes + cells, planes + 2 * cells };
	if (!o->is_there())
		line.why_not = g_strdup(o->why_not);
	else if (!o->run(data->folder, data->scan[0].grid, normal, &line.cpu_s, &error))
		line.why_not = g_strdup(error->message);
	else
		score(&data->scan[0], (const float *const *)normal, &line);
	g_array_append_val(lines, line);
}

static bool measure_pcls(const struct bench_data *data, GArray *lines, GError **error)
{
	return measure_pcl(data, BENCH_PCL_GRADIENT, "PCL AVERAGE_3D_GRADIENT", lines, error) &&
	       measure_pcl(data, BENCH_PCL_COVARIANCE, "PCL COVARIANCE_MATRIX", lines, error) &&
	       measure_pcl(
		       data, BENCH_PCL_DEPTH_CHANGE, "PCL AVERAGE_DEPTH_CHANGE", lines, error) &&
	       measure_pcl(data, BENCH_PCL_NEIGHBOURS, "PCL k = 20", lines, error);
}

bool bench_normals(const struct bench_data *data, GArray *lines, GError **error)
{
	measure_ours(data, lines);
	if (!measure_pcls(data, lines, error))
		return false;
	for (size_t n = 0; n < G_N_ELEMENTS(others); n++)
		measure_other(data, &others[n], lines);
	return true;
}
