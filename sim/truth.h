#ifndef SIM_TRUTH_H
#define SIM_TRUTH_H
/* What really stands where, for tests: the first surface in any direction from a station of a
 * simulated site, and logs of what the lidar should have read. Angles are the scanner's: azimuth
 * clockwise from home, elevation from its horizon.
 *
 * Panorama file (little-endian): the 8 bytes "PLTRUTH1", u32 columns, u32 rows, f64 elevation of
 * the upper and of the lower edge in rad, f64 position[3] and f64 rotation[9] of the station (world
 * = rotation * scanner + position), then struct truth_cell, row by row from the top, each row
 * clockwise from home; a cell is what its centre sees.
 *
 * Revolution log, per revolution: u32 revolution, u32 beams, i64 first_beam_host_ns, f64
 * beam_period_ns, f64 azimuth_rad[beams], f64 range_m[beams], as in struct sim_truth_revolution. */
#include "sim/head.h"
#include "sim/options.h"
#include "sim/world.h"

struct truth_cell {
	float range_m;   /* of the first surface, a pane of glass too; 0: none */
	float normal[3]; /* in the scanner's frame, towards it */
	uint16_t instance;
	uint8_t class;  /* enum world_class */
	uint8_t optics; /* enum world_optics */
};

struct truth_panorama {
	uint32_t columns, rows;
	double elevation_max_rad, elevation_min_rad;
	bool is_behind; /* of panes: not they are told of, but what stands behind them */
};

typedef struct truth truth;
/* From a description as of a head: its scene, seed, station and limit_m count. */
truth *truth_new(const char *description, GError **error);
void truth_free(truth *t); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(truth, truth_free)

const world *truth_world(const truth *t);
const struct world_station *truth_station(const truth *t);
struct truth_cell truth_look(const truth *t, double azimuth_rad, double elevation_rad);
/* Fills columns * rows cells, on all threads. */
void truth_look_around(
	const truth *t, const struct truth_panorama *panorama, struct truth_cell *ret_cells);
bool truth_write(
	const truth *t, const struct truth_panorama *panorama, const char *path, GError **error);
/* What a camera should see there, without noise: the 8 bytes "PLLIGHT1", u32 columns, u32 rows, then float[3] a cell, linear RGB as
 * world_radiance gives it, of what the cell's centre sees. */
bool truth_write_light(
	const truth *t, const struct truth_panorama *panorama, const char *path, GError **error);
/* [{"station":1,"position_m":[x,y,z],"rotation":[[..],[..],[..]]}, ...] */
char *truth_poses_json(const char *description, GError **error);

/* The station that options name, which the scene may not have. */
bool truth_station_of(const sim_options *options, const world *w, struct world_station *ret_station,
	GError **error);

typedef struct truth_log truth_log;
truth_log *truth_log_new(const char *path, GError **error);
void truth_log_write(truth_log *log, const struct sim_truth_revolution *revolution);
void truth_log_free(truth_log *log); /* NULL is fine */

#endif
