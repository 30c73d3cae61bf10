#ifndef ACQUIRE_DRIVER_H
#define ACQUIRE_DRIVER_H
/* A driver speaks a lidar's protocol: it starts and stops the device; the decoder of the same name
 * reads what comes. The table has a row per protocol; adding a lidar is adding a decoder and a row.
 */
#include "acquire/clock.h"
#include "acquire/decoder.h"
#include "acquire/placement.h"

struct pump;

struct driver {
	const char *protocol;
	struct device_clock_desc clock;
	enum stamp_instant stamp;
	double bytes_per_beam; /* on the wire, with intensity: for predictions */
	bool streams_always;   /* start and stop change nothing of that */
	/* Wakes the device from whatever state it is in, identifies it and compares clocks. Says
	 * what is wrong in words. */
	bool (*prepare)(struct pump *p, GError **error);
	/* Ranges begin to flow. */
	bool (*start)(struct pump *p, GError **error);
	/* Ranges stop, the laser is off where the device can do that. */
	bool (*stop)(struct pump *p, GError **error);
	/* If the reply tells the device's clock: its ticks. May be NULL. */
	bool (*clock_reply)(const struct lidar_reply *reply, uint64_t *ret_ticks);
	/* If the bytes that were sent ask for the clock. May be NULL with clock_reply. */
	bool (*asks_clock)(const void *bytes, size_t length);
};
extern const struct driver driver_scip, driver_cola, driver_ld, driver_rplidar;

/* NULL when there is none. */
const struct driver *driver_find(const char *protocol);

#endif
