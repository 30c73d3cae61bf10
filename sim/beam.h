#ifndef SIM_BEAM_H
#define SIM_BEAM_H
/* What a laser range finder makes of the world along a beam.
 *
 * A beam is not a line: the axis and four rays at its edge (1/e^2) are cast. Rays that meet the
 * surface which the axis meets count as one sample at the axis' range, so a smooth surface is
 * measured without bias at any incidence; others keep their own range. Samples within 0.4 m of each
 * other melt into one echo, the mean weighted by received power (mixed pixels at edges and in
 * foliage); of several echoes the strongest wins. Power falls with the square of the range and the
 * cosine of the incidence (Lambert); weak echoes are noisier than asked for and are missed with a
 * probability.
 *
 * Glass mirrors the beam away but for incidence within 8 degrees; what stands behind the pane is
 * seen through it, at half the power for each pane. Water gives a faint echo straight down and none
 * otherwise.
 *
 * Angles: theta is measured in the beam's plane from the horizon in front over the zenith, so that
 * a device angle a is theta = a + pi/2; azimuth turns the front clockwise from home. Where the lidar sits askew (mount.h), beams
 * go from elsewhere and elsewhere; ranges are from where it sits. */
#include "sim/mount.h"
#include "sim/world.h"

enum echo_outcome {
	ECHO_GOOD,
	ECHO_NONE,     /* nothing within the limit */
	ECHO_WEAK,     /* something, too faint this time */
	ECHO_MIRRORED, /* glass or water sent the beam elsewhere */
};

struct beam_optics {
	struct lidar_mount mount;
	const world *world;
	struct world_station station;
	double half_divergence_rad; /* 0: the axis alone */
	double noise_m;             /* 1 sigma where the echo is strong enough */
	double limit_m;
	bool dropouts;
	bool threaded; /* measure on all threads: pays for whole fans on a machine that has nothing
			  else to do */
	uint64_t seed;
};

struct echo {
	double range_m;      /* with noise; 0 unless good */
	double true_range_m; /* of the axis, what an ideal device would read; 0 = no echo */
	float strength;  /* reflectivity x cosine of incidence x transmission, about 0..1, before
			    range */
	uint8_t outcome; /* enum echo_outcome */
};

/* The beams of one turn of the mirror, and room to work on them. */
struct beam_fan {
	uint32_t revolution;
	uint32_t beams;
	double first_theta_rad, theta_step_rad;
	double *theta_rad; /* of each beam, where they are not evenly apart; else NULL */
	double *azimuth_rad;
	struct echo *echoes;
	struct beam_touch *axis;
};

static inline double beam_theta_rad(const struct beam_fan *fan, uint32_t i)
{
	return fan->theta_rad ? fan->theta_rad[i] : fan->first_theta_rad + i * fan->theta_step_rad;
}

struct beam_fan *beam_fan_new(uint32_t beams);
void beam_fan_free(struct beam_fan *fan); /* NULL is fine */

/* Measures the beams from..to-1. Lower ones must have been measured before. */
void beam_measure(
	const struct beam_optics *optics, struct beam_fan *fan, uint32_t from, uint32_t to);

/* The direction of a beam of an aligned head in the scanner's frame (x right of home, y towards home, z up). */
void beam_direction(double azimuth_rad, double theta_rad, double ret_direction[3]);

#endif
