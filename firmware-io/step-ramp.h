#ifndef FIRMWARE_IO_STEP_RAMP_H
#define FIRMWARE_IO_STEP_RAMP_H
/* When each step of a stepper is due: a trapezoid of rate over time, from whatever motion it is in, with the instants of steps computed exactly
 * (t = sqrt(2 n / a) from rest; DEVICES 4.2) and not by adding intervals up. Steps are counted from power-on. Plain numbers, no clock: the
 * caller's nanoseconds. One owner. */
#include "firmware-io/stage.h"

#define STEP_RAMP_LEGS 5

struct step_ramp {
	struct step_leg {
		double begin_s, position, rate, acceleration; /* where it begins, from begun_ns */
	} legs[STEP_RAMP_LEGS + 1];                           /* and rest, for ever */
	int count, at; /* at: where the last step was found */
	int64_t begun_ns;
	double acceleration; /* of the move: what it stops with */
};

void step_ramp_rest(struct step_ramp *r, int64_t now_ns, int64_t position);
/* From the present motion: turns round, or stops first, if it must. */
void step_ramp_move(struct step_ramp *r, int64_t now_ns, const struct stage_move *move);
/* Ramps down to a whole step. */
void step_ramp_stop(struct step_ramp *r, int64_t now_ns);
/* What is still to come, later by so much: a step that was late must not be made up for by a shorter interval than the ramp allows. */
void step_ramp_delay(struct step_ramp *r, int64_t by_ns);

/* The step after `steps` of them: its instant, not before from_ns, and direction. False: it rests there, or was told to. */
bool step_ramp_next(
	struct step_ramp *r, int64_t steps, int64_t from_ns, int64_t *ret_ns, int *ret_direction);
double step_ramp_position(const struct step_ramp *r, int64_t now_ns);
double step_ramp_rate(const struct step_ramp *r, int64_t now_ns); /* steps a second, signed */

#endif
