#ifndef SIM_KERNEL_H
#define SIM_KERNEL_H
/* The simulated head for a host whose own kernel has drivers for its devices: a machine in QEMU, whose
 * guest reaches this one's loopback. The lidar is a USB device, served by USB/IP on a TCP port; any
 * vhci_hcd attaches it. The stage's pins and the camera are devices of the guest's kernel (gpio-sim,
 * v4l2loopback), and an agent in the guest (tests/kernel/agent.c) stands where their wires would be: it
 * is the client of the port after that one, sends each pulse that it saw, and gets frames.
 *
 * To the agent goes what the link (link.h) has for a stage and a camera, and of what stands below. The
 * head lives in the agent's time: it goes on when the agent says what its clock shows (KERNEL_CLOCK), so a guest that is
 * slow, or gets no processor for a while, misses nothing for it. Without an agent it is CLOCK_MONOTONIC of this machine.
 *
 * Beams are cast late, when the pulses of their time have come: SETTLE after it. So the lidar's answers
 * come that late too: set latency_ms to 55 or more, for what arrives must have been on its way. */
#include "sim/link.h"
#include <glib.h>
#include <stdbool.h>

#define KERNEL_SETTLE_MS 50

enum kernel_kind {
	/* To the agent. */
	KERNEL_STAGE = 128, /* struct kernel_stage: the first */

	/* LINK_CAMERA_FRAME has as host_ns when the exposure began. */

	/* From the agent. */
	KERNEL_CLOCK =
		160, /* int64_t: its CLOCK_MONOTONIC. Every pulse before it was told; some ten milliseconds after the last */
	KERNEL_CAMERA =
		192, /* uint32_t: a V4L2 fourcc, YUYV, NV12 or MJPG, that frames shall have */
};

struct kernel_stage {
	double steps_per_turn, initial_azimuth_rad, backlash_steps;
	uint32_t index_slots;
	uint32_t width, height; /* of the camera's frames, 0: none */
	uint32_t fps_1000;
	/* Of the lidar's mirror: when it looks straight ahead, and how long it takes for a turn. The SYNC
	 * line of a TiM. */
	int64_t ahead_ns;
	double turn_ns;
};

struct kernel_options {
	const char *description; /* of a head; its speed is 1 whatever it says */
	const char
		*plug; /* the name of a gadget (usb.h), or NULL: as the lidar's protocol has it */
	uint16_t port; /* of USB/IP; the next one is the agent's. 0: two that are free */
	void (*listens)(uint16_t usb_port, uint16_t agent_port, gpointer data); /* from now on */
	gpointer data;
};

/* Serves on the thread's default main context until `until` is readable (never: -1). Only 127.0.0.1 is
 * listened on. The head gets its power when the first client comes, and again when one
 * comes after a fault took it. */
bool kernel_serve(const struct kernel_options *options, int until, GError **error);

#endif
