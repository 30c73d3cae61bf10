#ifndef PROCESS_BENCH_PROCESS_H
#define PROCESS_BENCH_PROCESS_H
/* pleinair bench process: what processing costs, and how good it is, beside what PCL, Open3D and CloudCompare make of the same data. One thread.
 *
 * Each section is a row of `sections` in bench-process.c: it measures on the scan at hand and adds lines. To add one, write a
 * function like bench_normals and its row. */
#include "process/range-grid.h"
#include <glib.h>
#include <stdbool.h>

struct bench_process_options {
	const char *
		site; /* NULL: a courtyard is simulated and scanned, fine, into a folder that is removed */
	const char *preset; /* of the simulated scan; NULL: fine */
	uint64_t seed;      /* of the simulated courtyard */
	/* Folder where the simulated scans stay, with two more of that place, and are taken from the next time; NULL: they do not. */
	const char *keep;
	uint32_t repeats; /* the least time counts; 0: 5 */
	bool json;
};
bool bench_process(const struct bench_process_options *options, GError **error);

/* ---- for sections ---- */

/* What really stands in a cell. */
struct bench_truth {
	float range_m; /* 0: nothing */
	float normal[3];
	bool smooth; /* no edge within four cells, and no leaves */
};
struct bench_known_scan {
	range_grid *grid;
	struct bench_truth *truth;                   /* per cell; NULL: not known */
	struct pose pose;                            /* scanner to world, when truth is known */
	double elevation_max_rad, elevation_min_rad; /* of the grid's edges, likewise */
};
struct bench_data {
	struct bench_known_scan scan
		[2]; /* two stations; of a site its first two scans, the second's grid NULL when there is one */
	uint32_t repeats;
	const char *folder; /* for files on the way */
};
/* A line of the table. NAN: does not apply. */
struct bench_line {
	const char *method;
	char *why_not;              /* NULL: it was measured; freed with the line */
	double cpu_s, points;       /* points that it took cpu_s for */
	double median_deg, p90_deg; /* of smooth surfaces */
	double all_median_deg, all_p90_deg;
	double none_percent;
};
typedef bool (*bench_section)(
	const struct bench_data *data, GArray *lines, GError **error); /* of struct bench_line */
double bench_cpu_s(void);                                              /* of this thread */
bool bench_normals(const struct bench_data *data, GArray *lines, GError **error);
/* The scan as a scanner without noise has it: the true range in the middle of each cell that was measured. Caller frees. */
range_grid *bench_exact_grid(const struct bench_known_scan *scan, GError **error);

/* PCL's ways to normals, in bench-process_pcl.cpp. */
enum bench_pcl {
	BENCH_PCL_COVARIANCE,
	BENCH_PCL_GRADIENT,
	BENCH_PCL_DEPTH_CHANGE,
	BENCH_PCL_NEIGHBOURS
};
/* Planes of the grid's cells, 0 0 0: none. *ret_cpu_s: of computing alone, not of filling in PCL's cloud. */
bool bench_pcl_normals(const range_grid *g, enum bench_pcl method, float *const ret_normal[3],
	double *ret_cpu_s, GError **error);

#endif
