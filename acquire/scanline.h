#ifndef ACQUIRE_SCANLINE_H
#define ACQUIRE_SCANLINE_H
/* A scanline is one turn of the lidar's mirror as the device reported it, or an unbroken part of one:
 * ranges and intensities by beam, with the device's own counters and clock. Angles are in the device's plane: 0 straight
 * ahead, counter-clockwise positive. Nothing here is corrected or placed; that is the business of
 * clock.h and placement.h. */
#include <stdbool.h>
#include <stdint.h>

struct scanline {
	int64_t arrival_ns; /* host time at which its last byte arrived */
	uint64_t ticks; /* the device's clock at the instant the protocol stamps, as sent: it wraps
			 */
	uint64_t sent_ticks; /* the device's clock when it began to send (CoLa); equals ticks where
				it does not say */
	uint32_t epoch;    /* where it differs from the line before, ticks began anew in between */
	uint32_t counter;  /* the device's scan counter, as sent: it wraps; 0 where there is none */
	bool device_error; /* the device says that it does not trust itself */
	double first_angle_rad, angle_step_rad;
	/* Of a device whose beams are not evenly apart: the angle of each, -2 pi..2 pi, in the order of
	 * time; those above are 0 then. NULL: even. */
	const float *angle_rad;
	double beam_s; /* from beam to beam, nominal; 0: as angle_step_rad and scan_rate_hz say */
	double scan_rate_hz; /* turns of the mirror a second, nominal */
	uint32_t beams;
	const uint32_t
		*range_mm; /* 0 = no return; below range_min_mm an error code of the device */
	const uint16_t *intensity; /* 0..65535 in the device's own scale; NULL when not sent */
	uint32_t range_min_mm;     /* the smallest number that is a range */
};

/* Beam i hit something and the number is a range. */
static inline bool scanline_has_range(const struct scanline *s, uint32_t i)
{
	return s->range_mm[i] >= s->range_min_mm;
}

#endif
