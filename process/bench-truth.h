#ifndef PROCESS_BENCH_TRUTH_H
#define PROCESS_BENCH_TRUTH_H
/* What a simulated scan really sees, as pleinair-sim --truth says it (sim/truth.h has the file). */
#include "process/pose.h"
#include <glib.h>
#include <stdbool.h>
#include <stdint.h>

/* As sim/world.h numbers them; the first six are those of segment-class.h. */
enum bench_truth_class {
	BENCH_TRUTH_NOTHING,
	BENCH_TRUTH_BUILDING,
	BENCH_TRUTH_VEGETATION,
	BENCH_TRUTH_CLASSES = 9
};
extern const char *const bench_truth_names[BENCH_TRUTH_CLASSES];
/* Of optics: a pane, which a beam may pass; water, which answers a beam from straight above alone. */
#define BENCH_TRUTH_GLASS 1
#define BENCH_TRUTH_WATER 2

struct bench_truth_cell {
	float range_m, normal[3]; /* of what the middle of the cell meets first; 0: nothing */
	uint16_t instance;
	uint8_t class, optics;
};
struct bench_truth_scan {
	struct pose pose; /* scanner to world */
	double elevation_max_rad, elevation_min_rad;
	uint32_t columns, rows;
	struct bench_truth_cell *cell; /* row by row; caller frees */
};
/* path: of a file that is written on the way. The simulator is the one beside this program, or that of PATH. */
bool bench_truth_ask(const char *description, uint32_t columns, uint32_t rows, const char *path,
	struct bench_truth_scan *ret, GError **error);
/* Where a pane is, what stands behind it. */
bool bench_truth_ask_behind(const char *description, uint32_t columns, uint32_t rows,
	const char *path, struct bench_truth_scan *ret, GError **error);
/* The radiance of each cell, red, green, blue, linear, 1: a white wall in the sun; caller frees. */
float *bench_truth_light(
	const char *description, uint32_t columns, uint32_t rows, const char *path, GError **error);

#endif
