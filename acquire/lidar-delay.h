#ifndef ACQUIRE_LIDAR_DELAY_H
#define ACQUIRE_LIDAR_DELAY_H
/* How late the lidar's beams are placed against the stage: the least delay of its stamps, which no
 * arrival time tells (clock.h), turns the whole panorama by delay * pace. It shows where the stage
 * went back over places that it scanned going forth: there the same surfaces lie apart by the
 * delay times the difference of the two paces (DEVICES 5: "CW/CCW pan difference"). Slack in the
 * gear shifts them by a constant, so both are found together, by least squares over the beams of
 * the way back, in inverse range, which is linear across a plane. They are told apart by the
 * different paces of the way back (preset.h). One owner. */
#include "acquire/panorama.h"
#include "acquire/placement.h"
#include "acquire/scanline.h"

typedef struct lidar_delay lidar_delay;
lidar_delay *lidar_delay_new(void);
void lidar_delay_free(lidar_delay *d); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(lidar_delay, lidar_delay_free)

/* A line as it was placed; those of the way back are kept, of the way forth the pace is. */
void lidar_delay_add(lidar_delay *d, const struct scanline *line, const struct placed_line *placed);

struct lidar_delay_result {
	double delay_s;     /* to be taken off the stamps; may be below 0 */
	double deviation_s; /* 1 sigma */
	double slack_rad;   /* how far the head lags behind its motor on the way back */
	uint32_t lines;     /* that told it */
};
/* p was made of the lines that went forth. false: too few beams of the way back see even surfaces
 * that the panorama holds, or they do not tell the delay to a fifth of a millisecond. */
bool lidar_delay_estimate(const lidar_delay *d, const panorama *p, struct lidar_delay_result *ret);

#endif
