#include "sim/truth.h"
#include "sim/beam.h"
#include <errno.h>
#include <gio/gio.h>
#include <math.h>
#include <stdio.h>

struct truth {
	world *world;
	struct world_station station;
	double limit_m;
};

struct truth_log {
	FILE *file;
};

bool truth_station_of(
	const sim_options *o, const world *w, struct world_station *ret_station, GError **error)
{
	if (o->station > world_station_count(w)) {
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_ARGUMENT,
			"sim:%s: station=%" G_GUINT64_FORMAT " is not one of its %u stations",
			o->scene, o->station, world_station_count(w));
		return false;
	}
	world_get_station(w, (uint32_t)o->station, ret_station);
	return true;
}

truth *truth_new(const char *description, GError **error)
{
	g_autoptr(sim_options) o = options_parse(description, error);
	g_autoptr(truth) t = g_new0(truth, 1);

	struct world_variant variant = o ? options_variant(o) : (struct world_variant){ 0 };
	if (!o || !(t->world = world_new(o->scene, o->seed, &variant, error)) ||
		!truth_station_of(o, t->world, &t->station, error))
		return NULL;
	t->limit_m = o->limit_m;
	return g_steal_pointer(&t);
}

void truth_free(truth *t)
{
	if (!t)
		return;
	world_free(t->world);
	g_free(t);
}

const world *truth_world(const truth *t)
{
	return t->world;
}

const struct world_station *truth_station(const truth *t)
{
	return &t->station;
}

/* So many panes one behind the other are looked through, from just behind each. */
#define PANES      6
#define PANE_GAP_M 1e-3

/* The first surface that is no pane; ret_surface->range_m is from where the first look began. */
static bool cast_behind(const truth *t, const double direction[3], struct surface *ret_surface)
{
	double gone_m = 0;
	for (int pane = 0; pane <= PANES; pane++) {
		double from[3];
		for (int k = 0; k < 3; k++)
			from[k] = t->station.position_m[k] + gone_m * direction[k];
		if (!world_cast(t->world, from, direction, t->limit_m - gone_m, ret_surface))
			return false;
		ret_surface->range_m += gone_m;
		if (ret_surface->optics != WORLD_GLASS)
			return true;
		gone_m = ret_surface->range_m + PANE_GAP_M;
	}
	return false;
}

static struct truth_cell look(
	const truth *t, double azimuth_rad, double elevation_rad, bool is_behind)
{
	const double(*r)[3] = t->station.rotation;
	struct truth_cell cell = { 0 };
	double v[3], direction[3];
	struct surface s;

	beam_direction(azimuth_rad, elevation_rad, v);
	for (int k = 0; k < 3; k++)
		direction[k] = r[k][0] * v[0] + r[k][1] * v[1] + r[k][2] * v[2];
	bool is_met =
		is_behind ? cast_behind(t, direction, &s)
			  : world_cast(t->world, t->station.position_m, direction, t->limit_m, &s);
	if (!is_met)
		return cell;
	for (int k = 0; k < 3; k++)
		cell.normal[k] = (float)(r[0][k] * s.normal[0] + r[1][k] * s.normal[1] +
					 r[2][k] * s.normal[2]);
	cell.range_m = (float)s.range_m;
	cell.instance = s.instance;
	cell.class = s.class;
	cell.optics = s.optics;
	return cell;
}

struct truth_cell truth_look(const truth *t, double azimuth_rad, double elevation_rad)
{
	return look(t, azimuth_rad, elevation_rad, false);
}

void truth_look_around(const truth *t, const struct truth_panorama *p, struct truth_cell *ret_cells)
{
	double per_row = (p->elevation_max_rad - p->elevation_min_rad) / p->rows;

#pragma omp parallel for schedule(dynamic, 4)
	for (uint32_t row = 0; row < p->rows; row++)
		for (uint32_t column = 0; column < p->columns; column++)
			ret_cells[(gsize)row * p->columns + column] =
				look(t, (column + 0.5) * 2 * M_PI / p->columns,
					p->elevation_max_rad - (row + 0.5) * per_row, p->is_behind);
}

static bool fail(const char *path, GError **error)
{
	int number = errno;

	g_set_error(error, G_IO_ERROR, g_io_error_from_errno(number), "%s: %s", path,
		g_strerror(number));
	return false;
}

bool truth_write(const truth *t, const struct truth_panorama *p, const char *path, GError **error)
{
	gsize cells = (gsize)p->columns * p->rows;
	g_autofree struct truth_cell *cell = g_new(struct truth_cell, cells);
	uint32_t size[2] = { p->columns, p->rows };
	double edges[2] = { p->elevation_max_rad, p->elevation_min_rad };
	FILE *file = fopen(path, "wbe");

	if (!file)
		return fail(path, error);
	truth_look_around(t, p, cell);
	bool good = fwrite("PLTRUTH1", 8, 1, file) == 1 &&
		    fwrite(size, sizeof size, 1, file) == 1 &&
		    fwrite(edges, sizeof edges, 1, file) == 1 &&
		    fwrite(t->station.position_m, sizeof t->station.position_m, 1, file) == 1 &&
		    fwrite(t->station.rotation, sizeof t->station.rotation, 1, file) == 1 &&
		    fwrite(cell, sizeof *cell, cells, file) == cells;

	return (fclose(file) == 0 && good) || fail(path, error);
}

static void look_along_row(
	const truth *t, const struct truth_panorama *p, uint32_t row, float *ret_rgb)
{
	const double(*r)[3] = t->station.rotation;
	double per_row = (p->elevation_max_rad - p->elevation_min_rad) / p->rows;
	g_autofree double *direction = g_new(double, 3 * p->columns);

	for (uint32_t column = 0; column < p->columns; column++) {
		double v[3], *d = direction + 3 * column;

		beam_direction((column + 0.5) * 2 * M_PI / p->columns,
			p->elevation_max_rad - (row + 0.5) * per_row, v);
		for (int k = 0; k < 3; k++)
			d[k] = r[k][0] * v[0] + r[k][1] * v[1] + r[k][2] * v[2];
	}
	world_radiance(t->world, t->station.position_m, direction, p->columns, ret_rgb);
}

bool truth_write_light(
	const truth *t, const struct truth_panorama *p, const char *path, GError **error)
{
	gsize cells = (gsize)p->columns * p->rows;
	g_autofree float(*light)[3] = g_malloc_n(cells, sizeof *light);
	uint32_t size[2] = { p->columns, p->rows };
	FILE *file = fopen(path, "wbe");

	if (!file)
		return fail(path, error);
#pragma omp parallel for schedule(dynamic, 4)
	for (uint32_t row = 0; row < p->rows; row++)
		look_along_row(t, p, row, light[(gsize)row * p->columns]);
	bool good = fwrite("PLLIGHT1", 8, 1, file) == 1 &&
		    fwrite(size, sizeof size, 1, file) == 1 &&
		    fwrite(light, sizeof *light, cells, file) == cells;

	return (fclose(file) == 0 && good) || fail(path, error);
}

static void append_vector(GString *json, const double v[3])
{
	char text[3][G_ASCII_DTOSTR_BUF_SIZE];

	for (int k = 0; k < 3; k++)
		g_ascii_dtostr(text[k], sizeof text[k], v[k]);
	g_string_append_printf(json, "[%s,%s,%s]", text[0], text[1], text[2]);
}

char *truth_poses_json(const char *description, GError **error)
{
	g_autoptr(truth) t = truth_new(description, error);

	if (!t)
		return NULL;
	GString *json = g_string_new("[");

	for (uint32_t number = 1; number <= world_station_count(t->world); number++) {
		struct world_station station;

		world_get_station(t->world, number, &station);
		g_string_append_printf(json,
			"%s{\"station\":%u,\"position_m\":", number > 1 ? ",\n " : "", number);
		append_vector(json, station.position_m);
		g_string_append(json, ",\"rotation\":[");
		for (int k = 0; k < 3; k++) {
			g_string_append(json, k ? "," : "");
			append_vector(json, station.rotation[k]);
		}
		g_string_append(json, "]}");
	}
	g_string_append(json, "]\n");
	return g_string_free(json, FALSE);
}

truth_log *truth_log_new(const char *path, GError **error)
{
	FILE *file = fopen(path, "wbe");

	if (!file) {
		fail(path, error);
		return NULL;
	}
	truth_log *log = g_new0(truth_log, 1);

	log->file = file;
	return log;
}

/* A log that cannot be written is no reason to stop a scan, but its reader must not take half of it
 * for all. */
void truth_log_write(truth_log *log, const struct sim_truth_revolution *r)
{
	uint32_t numbers[2] = { r->revolution, r->beams };

	fwrite(numbers, sizeof numbers, 1, log->file);
	fwrite(&r->first_beam_host_ns, 8, 1, log->file);
	fwrite(&r->beam_period_ns, 8, 1, log->file);
	fwrite(r->azimuth_rad, sizeof(double), r->beams, log->file);
	fwrite(r->range_m, sizeof(double), r->beams, log->file);
	if (fflush(log->file) != 0)
		g_warning("the truth log is cut short: %s", g_strerror(errno));
}

void truth_log_free(truth_log *log)
{
	if (!log)
		return;
	fclose(log->file);
	g_free(log);
}
