#ifndef FIRMWARE_IO_STAGE_PINS_PRIVATE_H
#define FIRMWARE_IO_STAGE_PINS_PRIVATE_H
/* A stage on pins, as its two files see it: stage-pins.c is what its owner calls, stage-thread.c the thread that makes steps. */
#include "firmware-io/stage-index.h"
#include "firmware-io/stage-pins.h"
#include "firmware-io/step-ramp.h"

#define MILLISECOND_NS INT64_C(1000000)
#define DOZE_NS        (1000 * MILLISECOND_NS)
#define EVENTS         65536

/* Lines by what they are for; those of a machine that lacks one are not there. */
enum pin {
	PIN_STEP,
	PIN_DIR,
	PIN_ENABLE,
	PIN_LED_READY,
	PIN_LED_EMITTING,
	PIN_LED_FAULT,
	PIN_HOME,
	PIN_INDEX,
	PIN_ESTOP,
	PIN_INTERLOCK,
	PIN_BUTTON,
	PIN_SYNC,
	PIN_COUNT
};

enum order { ORDER_NONE, ORDER_MOVE, ORDER_STOP };

struct pins_stage {
	stage base;
	gpio_lines *lines;
	int line_of[PIN_COUNT]; /* of lines; below 0: not there */
	enum pin pin_of[PIN_COUNT];
	double rate_max, priority;
	bool counted; /* steps are made here, else index has them */
	GThread *thread;
	int order_fd, told_fd;

	GMutex lock; /* of all up to the next empty line */
	enum order order;
	struct stage_move wanted;
	bool emitting, quit, pressed, open, latched; /* latched: until stage_reset */
	struct stage_event *events;                  /* a ring */
	uint32_t first, waiting;
	bool told, deaf; /* deaf: the ring was full */
	struct stage_pins_counts counts;
	struct stage_event *lent;

	/* The thread's own. */
	struct step_ramp ramp;
	int64_t steps, last_step_ns, batch_ns, levels_ns, blink_ns;
	int64_t edge_ns[PIN_COUNT]; /* the last that counted */
	int direction;
	bool moving, enabled, gone;
	struct stage_index index;
	int64_t target_steps; /* of a motor that turns by itself */
	bool arrived;
};

/* Under the lock. */
void stage_thread_tell(
	struct pins_stage *s, enum stage_event_kind kind, int direction, int64_t time_ns);
/* The thread's; before it began, whoever makes it. */
void stage_thread_set_direction(struct pins_stage *s, int direction);
void stage_thread_look_at_levels(struct pins_stage *s, int64_t now_ns);
/* Data is the stage; runs until it shall quit. */
gpointer stage_thread_run(gpointer data);

#endif
