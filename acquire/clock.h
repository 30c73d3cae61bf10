#ifndef ACQUIRE_CLOCK_H
#define ACQUIRE_CLOCK_H
/* A device's clock against the host's. A telegram arrives later than it was sent, never earlier, so
 * of all pairs (device ticks, host arrival) those with the least delay lie on a line below all
 * others: the lower envelope gives the offset (plus the least delay) and, by its slope, the drift
 * (Olson 2010, passive synchronisation). The line is fitted to the pairs within a minute either
 * side of the instant that is asked for, as an edge of their lower convex hull.
 *
 * The least delay itself cannot be seen that way. A device that can be asked for its time (SCIP's
 * TM1) gives bounds on the offset by question and answer; otherwise the delay is what the caller
 * declares.
 *
 * Ticks wrap; they are unwrapped by the host's time between two of them, so gaps of any length are
 * counted right as long as the host's clock is good to half a wrap. No pair is ever dropped for
 * looking wrong. One owner; not thread-safe. */
#include <glib.h>
#include <stdbool.h>
#include <stdint.h>

typedef struct device_clock device_clock;

struct device_clock_desc {
	double ticks_hz;
	uint32_t wrap_bits;   /* 1..64 */
	uint64_t wrap_at;     /* instead of bits, where ticks run 0..wrap_at-1; 0: bits hold */
	int64_t delay_ns;     /* least delay from stamp to arrival, where no exchange tells it */
	double drift_max_ppm; /* 0: DEVICE_CLOCK_DRIFT_MAX_PPM; more for what has no crystal */
	bool truncates; /* ticks are cut off, not rounded: the true instant is half a tick later on
			   average */
};

/* A drift beyond this is a broken clock, not a warm one. */
#define DEVICE_CLOCK_DRIFT_MAX_PPM 300.0

device_clock *device_clock_new(const struct device_clock_desc *desc);
void device_clock_free(device_clock *c); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(device_clock, device_clock_free)

/* Unwraps; ticks must come in the order of their arrival, give or take half a wrap. */
int64_t device_clock_unwrap(device_clock *c, uint64_t ticks, int64_t arrival_ns);

/* A telegram stamped `unwrapped` arrived. */
void device_clock_add_arrival(device_clock *c, int64_t unwrapped, int64_t arrival_ns);
/* The device read its clock between these two host times. */
void device_clock_add_exchange(
	device_clock *c, int64_t sent_ns, int64_t unwrapped, int64_t received_ns);

/* Host time of a device instant. Meaningless before the first pair or exchange
 * (device_clock_is_known). */
bool device_clock_is_known(const device_clock *c);
int64_t device_clock_host_ns(device_clock *c, double unwrapped);
/* Rate of the device against the host, parts per million, over all pairs. */
double device_clock_drift_ppm(device_clock *c);

#endif
