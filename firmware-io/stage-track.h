#ifndef FIRMWARE_IO_STAGE_TRACK_H
#define FIRMWARE_IO_STAGE_TRACK_H
/* The stage's angle at any instant, from its step pulses and its home and index slots.
 *
 * Between two pulses the rotor is taken to move evenly: it has inertia, and a microstep is 0.03
 * degrees. The home slot, passed clockwise, is angle 0; angles do not wrap, so a second turn goes
 * on from 2 pi. Index slots are evenly spaced; each is compared with where the first one said it
 * should be, and a disagreement of over one full step (16 microsteps) marks the time since the last
 * good slot as suspect: steps were lost there (DEVICES 4.3). The count is then put right by the
 * slot. More than half the way between two slots would be put right by the wrong one: that comes
 * out when home is passed again, and then all since the last time is suspect.
 *
 * Times must not fall. Const between calls of stage_track_feed: any number of readers then. */
#include "firmware-io/stage.h"

typedef struct stage_track stage_track;

struct stage_suspect {
	int64_t from_ns, to_ns;
	double error_rad; /* steps that were lost, as an angle */
};

stage_track *stage_track_new(double steps_per_turn, uint32_t index_slots);
void stage_track_free(stage_track *t); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(stage_track, stage_track_free)

void stage_track_feed(stage_track *t, const struct stage_event *event, int64_t time_ns);

/* Home has been passed: angles are known, also of the time before. */
bool stage_track_is_homed(const stage_track *t);
/* Angle from home at that instant, clockwise; the rotor rests before the first and after the last
 * pulse. */
double stage_track_angle_rad(const stage_track *t, int64_t time_ns);
/* Time of the last pulse or stop: angles up to here are final. */
int64_t stage_track_known_until_ns(const stage_track *t);
/* Steps from power-on at which the rotor stands at this angle. */
double stage_track_steps_at(const stage_track *t, double angle_rad);
bool stage_track_is_moving(const stage_track *t);
bool stage_track_is_suspect(const stage_track *t, int64_t time_ns);
/* Caller frees; of struct stage_suspect. */
GArray *stage_track_suspects(const stage_track *t);

#endif
