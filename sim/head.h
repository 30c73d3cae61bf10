#ifndef SIM_HEAD_H
#define SIM_HEAD_H
/* The simulated head: a lidar, a pan stage and a camera in one world, each with its own clock,
 * served over a link.
 *
 * It is described by the part of a device URI that follows "sim:", for example
 *     court?seed=7&station=2&noise_mm=12&speed=max&fault=unplug@400,drop@12
 * Unknown keys, values out of range and faults that do not parse are refused with a sentence that
 * names them. */
#include "sim/world.h"
#include <glib.h>
#include <stdbool.h>
#include <stdint.h>

/* Where the truth of a scan goes, for tests. Called on the simulator's thread once per revolution,
 * before its bytes are sent; the arrays hold one value per beam, in the order sent, and live only
 * during the call. */
struct sim_truth_revolution {
	uint32_t revolution; /* counts all turns of the mirror since power-on; only those sent are
				told of. Of a lidar that sends in small packets: those packets */
	uint32_t beams;
	gint64 first_beam_host_ns; /* true time */
	double beam_period_ns;     /* true time between beams */
	const double *azimuth_rad; /* of the beam's plane at the beam's instant, from the home edge,
				      clockwise, 0..2 pi */
	const double
		*theta_rad;    /* in the beam's plane, from the horizon in front over the zenith */
	const double *range_m; /* what an ideal device would read on the beam's axis (behind glass,
				* if it sees through it); 0 = no echo. A faint echo may be missed
				* all the same. */
};
typedef void (*sim_truth_func)(const struct sim_truth_revolution *revolution, gpointer user_data);

struct sim_head_options {
	const char *description; /* SCENE?key=value&... */
	const world *world;   /* of that scene and seed, to save the time of building it, or NULL */
	sim_truth_func truth; /* may be NULL */
	gpointer truth_data;
	int64_t settle_ns; /* so long after an instant it is known how the stage moved then: beams are
			      cast that late. 0 unless pulses from elsewhere drive it */
};

/* Serves one host on a connected stream socket until it hangs up (true) or a fault script cuts the
 * power (true), or the link breaks or the description is wrong (false). Blocks; run it in a thread
 * or a process of its own. Closes fd. */
bool sim_head_serve(int fd, const struct sim_head_options *options, GError **error);

#endif
