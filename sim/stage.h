#ifndef SIM_STAGE_H
#define SIM_STAGE_H
/* The pan stage: a stepper motor with a gear, run along trapezoid velocity profiles. The rotor
 * moves smoothly (that is what microsteps are for); a step pulse is reported each time it passes a
 * whole step, counted from where it stood at power-on. Stops end on a whole step. The head turns
 * with the rotor, less the steps that a slip lost and the gear's backlash; slots on the head, one
 * of them home, report their passing at azimuth k * 360 / index_slots, in either direction.
 *
 * Times are true nanoseconds and must not go backwards from call to call; angles at past moments
 * can be asked for about two seconds back. One owner; not thread-safe, but const functions may be
 * called in parallel. */
#include "sim/clock.h"
#include "sim/link.h"
#include <glib.h>
#include <stdbool.h>

struct stage_desc {
	double steps_per_turn;
	uint32_t index_slots; /* slot 0 is home and has a sensor of its own besides */
	double initial_azimuth_rad;
	double backlash_steps;
	struct device_clock clock;
};

typedef struct stage stage;
stage *stage_new(const struct stage_desc *desc, int64_t now_ns);
void stage_free(stage *s); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(stage, stage_free)

/* False for a rate or an acceleration that is not a positive number, or a target beyond 2^31 steps.
 */
bool stage_move(stage *s, int64_t now_ns, const struct link_stage_move *move);
void stage_halt(stage *s, int64_t now_ns);
void stage_fail(stage *s, int64_t now_ns); /* the drive stops dead and says so */
/* Emergency stop: stops dead. Interlock: ramps down. Each ends by itself after the time; moves are ignored from then on until both
 * have ended and stage_unlatch came. */
void stage_press(stage *s, int64_t now_ns, double seconds);
void stage_open(stage *s, int64_t now_ns, double seconds);
void stage_unlatch(stage *s);
void stage_slip(stage *s, int64_t now_ns, double steps); /* lost against the direction of motion */

/* Another way to drive it: by the pulses of a driver's STEP pin, as they are told of. At a pulse the
 * rotor is at that whole step; between two it moves evenly, from rest for 40 ms. Where the pulses
 * come at an even pace it is taken to go on so for a step or 10 ms, whichever is more, so that slots
 * pass when they should; if no pulse comes then, it is back where the last one took it. A pulse that is told of late changes
 * the past since the one before. No events but slots are reported. */
void stage_begin_pulses(stage *s, int64_t now_ns); /* it stands as at power-on */
void stage_pulse(stage *s, int64_t at_ns, int direction);

/* Of the head, clockwise from home, not wrapped. */
double stage_azimuth_rad(const stage *s, int64_t base_ns, double after_ns);
bool stage_is_homed(const stage *s); /* the home slot was seen */

/* When something happens next: a pulse, a slot, the time to report. INT64_MAX at rest. stage_run()
 * lets it happen and gives a batch of struct link_stage_event when it is time to report, else NULL.
 */
int64_t stage_next_ns(const stage *s);
GByteArray *stage_run(stage *s, int64_t now_ns);

#endif
