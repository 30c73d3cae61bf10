#include "process/bench-street.h"
#include "acquire/panorama.h"
#include "acquire/points.h"
#include "firmware-io/files.h"
#include <math.h>
#include <string.h>

#define COLUMNS   BENCH_STREET_COLUMNS
#define ROWS      BENCH_STREET_ROWS
#define SPACING_M 8.0
#define HALF_M    7.0 /* of the street's width */
#define HEIGHT_M  1.7 /* of the scanner */
#define REACH_M   60.0
#define NOISE_M   0.006

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

bool bench_street_add(site *s, uint32_t scan, uint64_t *ret_measured, GError **error)
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

scan_graph bench_street_graph(uint32_t scans)
{
	scan_graph g = { .scans = g_array_new(FALSE, TRUE, sizeof(struct placed_scan)) };
	for (uint32_t k = 0; k < scans; k++) {
		struct placed_scan p = { .number = k + 1, .group = 1, .pose = POSE_IDENTITY };
		p.pose.translation_m[0] = k * SPACING_M;
		g_array_append_val(g.scans, p);
	}
	return g;
}
