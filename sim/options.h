#ifndef SIM_OPTIONS_H
#define SIM_OPTIONS_H
/* What a device URI says about a simulated head after "sim:", as in court?seed=7&lidar=cola. Each
 * key is a row of a table in options.c, which holds its range and its sentence in the manual;
 * options_help() prints it. */
#include "sim/lidar-make.h"
#include "sim/world.h"
#include <glib.h>
#include <stdbool.h>
#include <stdint.h>

/* Numbers that stay NAN, and clocks that stay UINT64_MAX, were not given and come from the seed. */
typedef struct sim_options {
	char *scene;
	uint64_t seed;
	uint64_t station; /* from 1 */
	uint64_t moved;   /* these three as struct world_variant has them */
	bool symmetric, repeated;
	double speed; /* 0: as fast as possible; else times real time */

	const struct lidar_make *lidar;
	uint64_t ares;          /* steps per turn of a SCIP lidar, a multiple of 8 */
	uint64_t beams;         /* of a CoLa lidar: 271, 541 or 811 over 270 degrees */
	char *ident;            /* what a CoLa lidar says that it is, or NULL */
	bool narrow;            /* it has intensities of eight bits alone */
	enum sim_format format; /* of an RPLIDAR's measurements */
	uint64_t health;        /* of an RPLIDAR: 0 well, 1 warning, 2 broken for good */
	bool stuck;             /* the mirror of a serial lidar does not turn */
	uint64_t baud;          /* of its line; 0: as its make has it */
	double sample_us;       /* of a serial lidar: from one measurement to the next */
	uint32_t portion;       /* measurements that it sends together; 0: a whole sweep */
	double rate_hz;
	double limit_m;
	double noise_mm;
	double divergence_mrad; /* full angle */
	bool dropouts;          /* weak echoes are missed now and then */
	double drift_ppm;
	uint64_t clock_start; /* ticks of the lidar's clock at power-on: ms for SCIP, us for CoLa */
	double latency_ms, jitter_ms;
	uint64_t packet; /* bytes that come together; 0: a whole telegram */

	double steps_per_turn;
	double home_deg; /* how far the head stands clockwise of home at power-on */
	double backlash_steps;
	double stage_ppm;
	uint64_t stage_clock_start;

	uint32_t camera_width, camera_height; /* 0: no camera */
	double fps;
	uint64_t edge_rays;
	bool distortion;
	double camera_ppm;
	uint64_t camera_clock_start;

	/* How the head was put together, against its drawing (mount.h). */
	double lidar_turn_deg[3], lidar_shift_mm[3], beam_zero_deg, range_offset_mm;
	double camera_turn_deg[3], camera_shift_mm[3], focal_percent, centre_px[2];
	double home_azimuth_deg;
	char *certificate; /* "true", a file, or NULL: as drawn */

	GArray *faults; /* struct fault */
	char *truth;    /* a file for the truth of each revolution, or NULL */
} sim_options;

sim_options *options_parse(const char *description, GError **error);
void options_free(sim_options *options); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(sim_options, options_free)

struct world_variant options_variant(const sim_options *o);
char *options_help(void); /* one line per key */

#endif
