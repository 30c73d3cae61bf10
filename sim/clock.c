#include "sim/clock.h"
#include <math.h>

double device_clock_ticks_exact(const struct device_clock *c, int64_t base_ns, double after_ns)
{
	double since_ns = (double)(base_ns - c->origin_ns) + after_ns;

	return (double)c->start_ticks + since_ns * (1 + c->drift_ppm * 1e-6) / c->tick_ns;
}

uint32_t device_clock_ticks(const struct device_clock *c, int64_t at_ns)
{
	uint64_t ticks = (uint64_t)(int64_t)floor(device_clock_ticks_exact(c, at_ns, 0));

	return (uint32_t)(ticks & ((UINT64_C(1) << c->bits) - 1));
}

double device_clock_true_ns(const struct device_clock *c, double nominal_ns)
{
	return nominal_ns / (1 + c->drift_ppm * 1e-6);
}
