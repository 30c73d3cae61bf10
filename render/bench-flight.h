#ifndef RENDER_BENCH_FLIGHT_H
#define RENDER_BENCH_FLIGHT_H
/* A way of the camera through a site without stations: in waves over the ground, then up, until all of it is seen. */
#include "process/model.h"
#include "render/camera.h"

struct bench_flight {
	double low_m[3], high_m[3]; /* of all but few points */
	double seconds;             /* for all of the way */
};
struct bench_flight bench_flight_over(const model *m, double seconds);

/* at: 0..1 of the way. */
struct camera bench_flight_camera(
	const struct bench_flight *f, double at, uint32_t width, uint32_t height);

#endif
