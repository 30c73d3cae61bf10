#ifndef ACQUIRE_TURN_H
#define ACQUIRE_TURN_H
/* Lidars that send measurements in small packets, not turn by turn: here they are put together to
 * scanlines, one a turn of the mirror, or several where something is missing in between. Angles go
 * clockwise, as those devices count them.
 *
 * They have no clock that is worth the name. What they keep is the beat of their measurements, so
 * the number of a measurement is the tick (DEVICES 5.3): those that are known to be missing are
 * counted too. Ticks come out in nanoseconds of that beat, so that lidars of any beat have one
 * clock. One owner; not thread-safe. */
#include "acquire/decoder.h"

#define TURN_TICKS_HZ 1e9
/* Beats are kept by what the maker found in the drawer. */
#define TURN_DRIFT_MAX_PPM 20000.0

struct turn {
	double sample_ns; /* the beat; 0 until it is known: then nothing is given out */
	double rate_hz; /* turns a second, of the last whole turn or as the device says; likewise */
	uint32_t epoch; /* of its lines */
	bool has_intensity;
	/* Its own. */
	uint64_t index; /* of the next measurement */
	uint64_t first; /* of the first one kept */
	uint32_t beams, room;
	bool whole; /* it began at the mark that begins turns */
	float *angle_rad;
	uint32_t *range_mm;
	uint16_t *intensity;
	int64_t arrival_ns;  /* of the last one */
	uint32_t last_whole; /* measurements of the last whole turn; 0: none yet */
};

void turn_clear(struct turn *t);

/* Measurements in a row. clockwise_rad 0..2 pi and a little beyond either end; intensity may be
 * NULL. marked is the place of the one with which a turn begins, or count and more: none. sent_ns
 * is how long after the last of them their last byte was out. */
struct turn_samples {
	const float *clockwise_rad;
	const uint32_t *range_mm;
	const uint16_t *intensity;
	uint32_t count, marked;
	double sent_ns;
	uint32_t after; /* so many more were measured by then, which are not yet told */
};
void turn_add(struct turn *t, decoder *d, const struct turn_samples *s, int64_t arrival_ns);

/* So many measurements are missing here. */
void turn_skip(struct turn *t, decoder *d, uint64_t missing);
/* Nobody knows how many are: counting begins anew. */
void turn_begin_epoch(struct turn *t, decoder *d);
/* The same, of a device that was stopped: the turn that it was in is dropped. */
void turn_restart(struct turn *t);

#endif
