#ifndef FIRMWARE_IO_STAGE_H
#define FIRMWARE_IO_STAGE_H
/* The pan stage turns the head about the vertical. It is moved by steps, counted from where it
 * stood at power-on, and tells of every step pulse and of every index and home slot that passed its
 * sensors, each by the stage's own clock. Positive is clockwise seen from above. Reading never
 * blocks. One owner, one thread. */
#include <glib.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct head;
typedef struct stage stage;

enum stage_event_kind {
	STAGE_STEP, /* at this instant the rotor is a whole number of steps from where it began */
	STAGE_INDEX,
	STAGE_HOME,
	STAGE_STOPPED, /* the move is over */
	STAGE_FAULT,   /* the drive stopped by itself */
	/* What guards people (DEVICES 4.4). A stage that has these inputs tells how they stand when it is opened. */
	STAGE_ESTOP_PRESSED, /* motor power is cut, by hardware; no move until stage_reset */
	STAGE_ESTOP_RELEASED,
	STAGE_INTERLOCK_OPENED, /* it ramps down by itself, and starts no move */
	STAGE_INTERLOCK_CLOSED,
	STAGE_BUTTON, /* pressed, by an operator */
	STAGE_SYNC,   /* the lidar's mirror passed its index: SYNC line of a TiM */
	STAGE_EVENT_KINDS
};

/* Ticks are microseconds of the host's own clock, its low 32 bits: nothing has to be found out about it. */
#define STAGE_EVENT_HOST_CLOCK 1u

/* As it stands in a record. */
struct stage_event {
	uint32_t ticks;   /* of the stage's clock: it wraps */
	int8_t direction; /* +1, -1 */
	uint8_t kind;     /* enum stage_event_kind */
	uint16_t flags;   /* STAGE_EVENT_HOST_CLOCK */
};

/* Why a move or a reset is refused for safety, each with a sentence; other errors are the wire's. */
#define STAGE_ERROR (stage_error_quark())
GQuark stage_error_quark(void);
enum stage_error {
	STAGE_ERROR_ESTOP,     /* the emergency stop is pressed */
	STAGE_ERROR_INTERLOCK, /* the interlock is open */
	STAGE_ERROR_NOT_RESET, /* neither, but one of them was: stage_reset first */
};

struct stage_move {
	int64_t target_steps;
	double rate_steps_s, acceleration_steps_s2; /* both > 0 */
};

struct stage_ops {
	/* Starts a move, or replaces the one under way. Returns at once; STAGE_STOPPED says when it
	 * is over. */
	bool (*move)(stage *s, const struct stage_move *move, GError **error);
	/* Ramps down; STAGE_STOPPED follows. */
	bool (*stop)(stage *s, GError **error);
	/* Events since the last call, in order, with the time of their arrival: count > 0, 0 for
	 * none, -1 with an error. The array is the stage's own, until the next call. */
	gssize (*read)(stage *s, const struct stage_event **ret_events, int64_t *ret_arrival_ns,
		GError **error);
	/* An operator says that it is safe to go on: after an emergency stop, once its contact is closed again, moves are taken again. The
	 * stage has to be homed anew. Fails, in words, while the contact is open. NULL: has no such input. */
	bool (*reset)(stage *s, GError **error);
	/* The lidar's laser is on, or may be: what the light says. NULL: has none. */
	void (*emitting)(stage *s, bool emitting);
	/* For a head made of parts (parts.h): a descriptor that is readable while read has something, and what frees it. NULL elsewhere. */
	int (*wait_fd)(stage *s);
	void (*close)(stage *s);
};

struct stage {
	const struct stage_ops *ops;
	struct head *head;
};

bool stage_start_move(stage *s, const struct stage_move *move, GError **error);
bool stage_stop(stage *s, GError **error);
bool stage_reset(stage *s, GError **error); /* true where there is nothing to reset */
void stage_show_emitting(stage *s, bool emitting);
gssize stage_read(
	stage *s, const struct stage_event **ret_events, int64_t *ret_arrival_ns, GError **error);

#endif
