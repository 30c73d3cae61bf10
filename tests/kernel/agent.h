#ifndef TESTS_KERNEL_AGENT_H
#define TESTS_KERNEL_AGENT_H
/* The agent: a program in the guest that stands where the wires of a head's devices would be, between the
 * guest's kernel and the simulator outside (sim/kernel.h). It
 *
 *  - makes a GPIO chip of gpio-sim with the lines by name, sees every change of STEP, DIR and ENABLE by the
 *    kernel's tracepoint gpio:gpio_value (which loses none and costs no polling), keeps a stage that
 *    follows the pulses, lets its home and index slots pull their lines, and tells the simulator;
 *  - feeds a v4l2loopback device with the simulator's frames;
 *  - plugs USB/IP devices in, and in again when they are gone and come back.
 *
 * It takes commands, a line each, from a named pipe: `line NAME 0|1` pulls an input, `state` says how it is, `quit` pulls
 * all plugs and ends it. The lines estop,
 * interlock, button, home, index are inputs of the host; 1 is what `high` is on the pin. While estop is low
 * or ENABLE is low, the motor has no power and pulses turn nothing. */
#include <glib.h>
#include <stdbool.h>
#include <stdint.h>

int64_t guest_ns(void); /* CLOCK_MONOTONIC */

/* Pins. */
enum pin {
	PIN_STEP,
	PIN_DIR,
	PIN_ENABLE,
	PIN_HOME,
	PIN_INDEX,
	PIN_ESTOP,
	PIN_INTERLOCK,
	PIN_BUTTON,
	PIN_SYNC,
	PIN_LED_READY,
	PIN_LED_EMITTING,
	PIN_LED_FAULT,
	PIN_COUNT
};
int pin_by_name(const char *name); /* -1: there is none */

typedef struct pins pins;
/* A change of an output, in order. */
typedef void (*pins_func)(enum pin pin, bool level, int64_t at_ns, gpointer data);
/* The chip, labelled `label`. */
pins *pins_new(const char *label, pins_func changed, gpointer data, GError **error);
void pins_look(pins *p); /* tells of all that has changed since */
void pins_pull(pins *p, enum pin pin, bool level);
void pins_free(pins *p); /* the chip too; NULL is fine */

/* A camera. */
typedef struct screen screen;
/* fourcc as V4L2 has it. */
screen *screen_new(const char *node, uint32_t fourcc, uint32_t width, uint32_t height,
	uint32_t fps_1000, GError **error);
/* Shows a frame, by its number, whose exposure began at that time. */
struct screen_frame {
	const uint8_t *bytes;
	gsize length;
	int64_t at_ns;
	uint32_t sequence;
	bool damaged;
};
bool screen_show(screen *s, const struct screen_frame *frame, GError **error);
void screen_free(screen *s); /* NULL is fine */

/* Keeps the device of a USB/IP server plugged in, from a thread of its own, for good. */
void plug_keep(const char *host, uint16_t port);
/* Pulls them all, for good. */
void plug_pull(void);

#endif
