#ifndef SIM_CLOCK_H
#define SIM_CLOCK_H
/* A device's own clock: a counter of a few bits that began at some value when the device got power,
 * runs a few ppm fast or slow against the host's and wraps. Times in ns are the host's
 * CLOCK_MONOTONIC, the simulator's true time. */
#include <stdint.h>

struct device_clock {
	int64_t origin_ns; /* when it showed start_ticks */
	uint64_t start_ticks;
	double tick_ns;   /* nominal */
	double drift_ppm; /* positive: it runs fast */
	unsigned bits;    /* it wraps at 2^bits */
};

uint32_t device_clock_ticks(const struct device_clock *c, int64_t at_ns);
/* As above and for moments between nanoseconds; not wrapped, so that tests can look at differences.
 */
double device_clock_ticks_exact(const struct device_clock *c, int64_t base_ns, double after_ns);
/* True nanoseconds that pass while the device counts `nominal_ns`. */
double device_clock_true_ns(const struct device_clock *c, double nominal_ns);

#endif
