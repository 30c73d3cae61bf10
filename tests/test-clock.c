/* The clock model against clocks whose truth is known: offset, drift, wraps, jitter, spikes. */
#include "acquire/clock.h"
#include <glib.h>
#include <math.h>

#define SECOND_NS INT64_C(1000000000)

/* A device: ticks = (host - offset) * (1 + drift) * hz, wrapped. */
struct device {
	double hz, drift_ppm, start_s;
	uint64_t wrap;
	bool truncates;
};

static uint64_t ticks_at(const struct device *d, int64_t host_ns)
{
	double t = (d->start_s + (double)host_ns * 1e-9 * (1 + d->drift_ppm * 1e-6)) * d->hz;
	return (uint64_t)(d->truncates ? floor(t) : rint(t)) % d->wrap;
}

/* Delay of a telegram: a floor, an exponential tail, now and then a spike of 30 ms. */
static int64_t delay_ns(GRand *r, double floor_ms)
{
	double ms = floor_ms - log(1 - g_rand_double(r)) * 1.0 +
		    (g_rand_int_range(r, 0, 100) == 0 ? 30 : 0);
	return (int64_t)(ms * 1e6);
}

struct outcome {
	double mean_ms, worst_ms, drift_ppm;
	bool backwards;
};

/* Streams for duration_s at rate_hz, then asks for the host time of every stamp. */
static struct outcome stream(const struct device *d, const struct device_clock_desc *desc,
	double rate_hz, double duration_s, double floor_ms, bool exchanges, uint32_t seed)
{
	g_autoptr(device_clock) c = device_clock_new(desc);
	g_autoptr(GRand) r = g_rand_new_with_seed(seed);
	int64_t now_ns = 77 * SECOND_NS;
	for (int i = 0; exchanges && i < 24; i++) {
		int64_t there = now_ns + delay_ns(r, 0.3) / 4, back = there + delay_ns(r, 0.3) / 4;
		int64_t unwrapped = device_clock_unwrap(c, ticks_at(d, there), back);
		device_clock_add_exchange(c, now_ns, unwrapped, back);
		now_ns = back + 3000000 + i * 570000;
	}
	int n = (int)(duration_s * rate_hz);
	g_autofree int64_t *truth = g_new(int64_t, n), *unwrapped = g_new(int64_t, n);
	for (int i = 0; i < n; i++) {
		truth[i] = now_ns + (int64_t)(i / rate_hz * 1e9);
		int64_t arrival = truth[i] + delay_ns(r, floor_ms);
		unwrapped[i] = device_clock_unwrap(c, ticks_at(d, truth[i]), arrival);
		device_clock_add_arrival(c, unwrapped[i], arrival);
	}
	struct outcome o = { .drift_ppm = device_clock_drift_ppm(c) };
	int64_t last = INT64_MIN;
	for (int i = 0; i < n; i++) {
		int64_t host = device_clock_host_ns(c, (double)unwrapped[i]);
		double error_ms = (double)(host - truth[i]) * 1e-6;
		o.mean_ms += error_ms / n;
		o.worst_ms = fmax(o.worst_ms, fabs(error_ms));
		o.backwards |= host <= last;
		last = host;
	}
	return o;
}

static const struct scene {
	const char *path;
	struct device device;
	struct device_clock_desc desc;
	double rate_hz, duration_s, floor_ms;
	bool exchanges;
	double mean_max_ms, worst_max_ms, drift_max_ppm;
} scenes[] = {
	{ "/clock/scip-200ppm", { 1000, 200, 4000, 1 << 24, true },
		{ .ticks_hz = 1000, .wrap_bits = 24, .truncates = true }, 40, 60, 21, true, 0.25,
		0.9, 12 },
	{ "/clock/scip-wraps", { 1000, -50, 16770, 1 << 24, true },
		{ .ticks_hz = 1000, .wrap_bits = 24, .truncates = true }, 40, 60, 21, true, 0.25,
		0.9, 12 },
	{ "/clock/tim-200ppm", { 1e6, -200, 10, UINT64_C(1) << 32, false },
		{ .ticks_hz = 1e6, .wrap_bits = 32, .delay_ns = 1000000 }, 15, 120, 1.0, false, 0.1,
		0.3, 6 },
	{ "/clock/tim-wraps", { 1e6, 120, 4290, UINT64_C(1) << 32, false },
		{ .ticks_hz = 1e6, .wrap_bits = 32, .delay_ns = 1000000 }, 15, 120, 1.0, false, 0.1,
		0.3, 6 },
	{ "/clock/ten-minutes", { 1e6, 80, 10, UINT64_C(1) << 32, false },
		{ .ticks_hz = 1e6, .wrap_bits = 32, .delay_ns = 1000000 }, 15, 600, 1.0, false, 0.1,
		0.3, 2 },
};

static void test_scene(gconstpointer data)
{
	const struct scene *s = data;
	for (uint32_t seed = 1; seed <= 5; seed++) {
		struct outcome o = stream(&s->device, &s->desc, s->rate_hz, s->duration_s,
			s->floor_ms, s->exchanges, seed);
		g_test_message("mean %+.3f ms, worst %.3f ms, drift %+.2f ppm (true %+.2f)",
			o.mean_ms, o.worst_ms, o.drift_ppm, s->device.drift_ppm);
		g_assert_cmpfloat(fabs(o.mean_ms), <, s->mean_max_ms);
		g_assert_cmpfloat(o.worst_ms, <, s->worst_max_ms);
		g_assert_cmpfloat(fabs(o.drift_ppm - s->device.drift_ppm), <, s->drift_max_ppm);
		g_assert_false(o.backwards);
	}
}

/* Hours of silence, many wraps: counted right by the host's clock. */
static void test_silence(void)
{
	struct device d = { 1e6, 30, 0, UINT64_C(1) << 32, false };
	g_autoptr(device_clock) c = device_clock_new(
		&(struct device_clock_desc){ .ticks_hz = 1e6, .wrap_bits = 32, .delay_ns = 0 });
	int64_t first = device_clock_unwrap(c, ticks_at(&d, 0), 0);
	int64_t later_ns = 10 * 3600 * SECOND_NS;
	int64_t second = device_clock_unwrap(c, ticks_at(&d, later_ns), later_ns);
	double elapsed = (double)(second - first) * 1e-6;
	g_assert_cmpfloat(fabs(elapsed - 36000 * (1 + 30e-6)), <, 0.001);
}

/* Live, the estimate must not jump while pairs come in: between two refits it moves by far less
 * than a column. */
static void test_live(void)
{
	struct device d = { 1e6, 150, 100, UINT64_C(1) << 32, false };
	g_autoptr(device_clock) c = device_clock_new(&(struct device_clock_desc){
		.ticks_hz = 1e6, .wrap_bits = 32, .delay_ns = 1000000 });
	g_autoptr(GRand) r = g_rand_new_with_seed(3);
	for (int i = 0; i < 15 * 60; i++) {
		int64_t truth = SECOND_NS + (int64_t)(i / 15.0 * 1e9),
			arrival = truth + delay_ns(r, 1.0);
		int64_t ticks = device_clock_unwrap(c, ticks_at(&d, truth), arrival);
		device_clock_add_arrival(c, ticks, arrival);
		double error_ms = (double)(device_clock_host_ns(c, (double)ticks) - truth) * 1e-6;
		g_assert_cmpfloat(fabs(error_ms), <, i < 15 * 5 ? 4.0 : 1.5);
	}
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	for (size_t i = 0; i < G_N_ELEMENTS(scenes); i++)
		g_test_add_data_func(scenes[i].path, &scenes[i], test_scene);
	g_test_add_func("/clock/silence", test_silence);
	g_test_add_func("/clock/live", test_live);
	return g_test_run();
}
