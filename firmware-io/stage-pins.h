#ifndef FIRMWARE_IO_STAGE_PINS_H
#define FIRMWARE_IO_STAGE_PINS_H
/* A pan stage on pins (DEVICES 4): STEP, DIR and ENABLE of a stepper's driver out, home and index slots, emergency stop, interlock, button and
 * the lidar's SYNC in, lights out.
 *
 * A thread of its own waits for the next step by an absolute deadline, for edges and for orders, whichever is first. It goes before all else
 * where it may (SCHED_FIFO), allocates nothing, and waits for nothing else. What it has to tell waits in a queue of fixed room; a queue that
 * is full means that nobody cares any more: the stage stops and says STAGE_FAULT.
 *
 * Safety (DEVICES 4.4). The contact of the emergency stop is closed while all is well, and cuts the motor's power by itself; here it is watched, by
 * its edge and, since edges can be lost, every 10 ms: when it opens no more steps are made, ENABLE is taken away, and moves are refused until it
 * is closed again and stage_reset was called. When the interlock opens the stage ramps down; moves are refused until it is closed and
 * stage_reset was called. Both are so from the start if they are open then.
 *
 * counted=no: the motor turns by itself while ENABLE is on, in the direction of DIR, and where it is comes from the slots alone. Steps are told
 * evenly between two slots, once the second is reached; a move ends at the first slot at or beyond its target, and
 * one that is told to stop at the next slot; STEP is not needed, rates are the motor's own. When the emergency stop or the interlock opens, ENABLE is taken away at once. */
#include "firmware-io/gpio-lines.h"
#include "firmware-io/parts.h"

/* What is worth knowing of how it went. */
struct stage_pins_counts {
	uint64_t steps,
		late_steps; /* later than a quarter of their interval: the rest of the move was put off by as much */
	int64_t latest_ns;
	bool has_priority; /* SCHED_FIFO */
};

typedef gpio_lines *(*gpio_opener)(
	const char *chip, const struct gpio_line_desc *lines, size_t count, GError **error);
/* As stage_new_pins (parts.h), on lines of somebody else's: for tests. */
stage *stage_new_pins_on(head *h, const parts *p, gpio_opener open, GError **error);
struct stage_pins_counts stage_pins_count(stage *s);

#endif
