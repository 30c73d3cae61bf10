#include "render/bench-flight.h"
#include <glib.h>
#include <math.h>
#include <stdlib.h>

/* Of the way: over the ground, then up. */
#define RISES_FROM 0.75
#define EYE_M      5.0
#define FOV_DEG    60.0
#define WAVES      2
#define SPEED_M_S  10.0

static int by_value(const void *a, const void *b)
{
	const double *x = a, *y = b;
	return (*x > *y) - (*x < *y);
}

struct bench_flight bench_flight_over(const model *m, double seconds)
{
	uint64_t chunks;
	const struct model_chunk *c = model_chunks(m, &chunks);
	struct bench_flight f = { .seconds = seconds };
	g_autofree double *at = g_new(double, chunks + 1);
	for (int k = 0; k < 3; k++) {
		for (uint64_t n = 0; n < chunks; n++)
			at[n] = c[n].centre_m[k];
		qsort(at, chunks, sizeof *at, by_value);
		f.low_m[k] = at[chunks / 50];
		f.high_m[k] = at[chunks - 1 - chunks / 50];
	}
	return f;
}

static void place_on_ground(const struct bench_flight *f, double at, double ret_m[3])
{
	double length_m = f->high_m[0] - f->low_m[0], wide_m = f->high_m[1] - f->low_m[1];
	double whole_m = SPEED_M_S * f->seconds * RISES_FROM;
	double part = fmin(whole_m / fmax(length_m, 1), 0.9);
	ret_m[0] = f->low_m[0] + length_m * (0.05 + part * at);
	ret_m[1] = f->low_m[1] + wide_m * (0.5 + 0.08 * sin(at * WAVES * 2 * G_PI));
	ret_m[2] = f->low_m[2] + EYE_M;
}

struct camera bench_flight_camera(
	const struct bench_flight *f, double at, uint32_t width, uint32_t height)
{
	double ground = fmin(at / RISES_FROM, 1),
	       up = fmax((at - RISES_FROM) / (1 - RISES_FROM), 0), eye_m[3], next_m[3];
	place_on_ground(f, ground, eye_m);
	place_on_ground(f, ground + 0.01, next_m);
	double heading = atan2(next_m[0] - eye_m[0], next_m[1] - eye_m[1]) +
			 0.6 * sin(at * WAVES * 2 * G_PI) * (1 - up);
	double side_m = fmax(f->high_m[0] - f->low_m[0], f->high_m[1] - f->low_m[1]);
	double rise = up * up * (3 - 2 * up), elevation = -0.05 - rise * 0.7;
	eye_m[2] += rise * side_m * 0.8;
	for (int k = 0; k < 2; k++) {
		double middle_m = (f->low_m[k] + f->high_m[k]) / 2,
		       back_m = (k ? cos(heading) : sin(heading)) * side_m * 0.9;
		eye_m[k] += rise * (middle_m - back_m - eye_m[k]);
	}
	return camera_towards(eye_m, heading, elevation, FOV_DEG, width, height);
}
