#ifndef SIM_RPLIDAR_FRAMES_H
#define SIM_RPLIDAR_FRAMES_H
/* What an RPLIDAR says, byte by byte: descriptors, answers and the six kinds of measurements.
 * Angles are the encoder's, in turns. */
#include "sim/beam.h"
#include "sim/lidar-make.h"
#include <glib.h>

void rplidar_put_descriptor(GByteArray *out, uint8_t type, uint32_t length, bool loops);
void rplidar_put_number(GByteArray *out, uint64_t value, int bytes);
uint8_t rplidar_type_of(enum sim_format format);

struct rplidar_portion {
	const struct echo *echoes; /* one more than there are beams */
	const double *turns;       /* of the encoder, likewise */
	const double *turned_rad;  /* the beam against it */
	uint32_t beams;
	bool first;        /* of the stream */
	uint64_t stamp_us; /* of the first beam */
	double beat_us;
};
/* Appends the frames of a portion. */
void rplidar_put_portion(GByteArray *out, enum sim_format format, const struct rplidar_portion *p);

/* How far the beam that reads a range is turned back, as triangulating lidars have it; 0 of others. */
double rplidar_turned_rad(enum sim_format format, double range_m);

#endif
