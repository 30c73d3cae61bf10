#ifndef SIM_LIDAR_MAKE_H
#define SIM_LIDAR_MAKE_H
/* The lidars that there are to simulate: a row each, by the name that the option lidar= has. */
#include <stdbool.h>
#include <stdint.h>

/* How an RPLIDAR sends its measurements. */
enum sim_format {
	SIM_AS_MADE,
	SIM_STANDARD,
	SIM_EXPRESS,
	SIM_ULTRA,
	SIM_DENSE,
	SIM_ULTRA_DENSE,
	SIM_HQ,
	SIM_FORMATS,
};

enum sim_motor {
	SIM_MOTOR_ALWAYS, /* turns with power */
	SIM_MOTOR_DTR,    /* while DTR is not asserted */
	SIM_MOTOR_PWM,    /* as SET_MOTOR_PWM says */
	SIM_MOTOR_RPM,    /* as HQ_MOTOR_SPEED says */
};

struct lidar_make {
	const char *name, *protocol;
	double rate_hz, limit_m;
	/* Of those on a serial line: */
	uint32_t baud; /* 0: it is not */
	double sample_us;
	enum sim_format format;
	uint8_t model;
	enum sim_motor motor;
	bool absent; /* nothing is there at all */
};

#define LIDAR_MAKES                                                                                \
	"scip, cola, ld06, ld19, stl27l, rplidar-a1, -a2, -a3, -c1, -s1, -s2, -s3 or none"

const struct lidar_make *lidar_make_find(const char *name); /* NULL: there is none */

/* Bytes and measurements of one frame. */
uint32_t lidar_frame_bytes(const struct lidar_make *make, enum sim_format format);
uint32_t lidar_frame_samples(const struct lidar_make *make, enum sim_format format);

/* The beat that a line can carry, and how many measurements come together: whole frames, for some
 * milliseconds, as a serial bridge gathers them. */
void lidar_make_portion(const struct lidar_make *make, enum sim_format format, uint32_t baud,
	double *ret_sample_us, uint32_t *ret_portion);

#endif
