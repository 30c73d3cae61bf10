#ifndef PROCESS_REPORT_PRIVATE_H
#define PROCESS_REPORT_PRIVATE_H
/* What the parts of a report share. Only report*.c include it. */
#include "process/edge-json.h"
#include "process/report.h"
#include "process/scan-data.h"

struct report_scan {
	const struct placed_scan *placed;
	enum scan_kind kind;
	char *what, *when; /* "standard, PLEINAIR-SIM-200", "pump.ptx"; time or NULL */
	uint64_t points;
	uint32_t columns, rows; /* 0: a cloud */
	double yaw_deg, tilt_deg;
};

#define REPORT_BINS    60
#define REPORT_BIN_MAX 0.03 /* m: the histogram's ends */

struct report_edge {
	const struct edge *edge;
	char *map_png; /* base64; NULL: none */
	uint32_t map_columns, map_rows;
	uint64_t bins[REPORT_BINS], agreeing; /* signed distances of the agreeing cells */
};

/* One group of scans that are tied together, seen from above. */
struct report_plan {
	uint32_t group;
	double west_m, north_m, metres_per_pixel; /* of the upper left corner */
	uint32_t width, height;
	char *png; /* base64, what stands upright there */
};

struct report {
	const site *site;
	const scan_graph *graph;
	GArray *scans; /* of struct report_scan */
	GArray *edges; /* of struct report_edge */
	GArray *plans; /* of struct report_plan */
};

/* Grey (channels 1) or RGB (3) as base64 of a PNG; caller frees. */
char *report_encode(const uint8_t *pixels, uint32_t width, uint32_t height, int channels);

/* Draws a group's plan, scan by scan. */
typedef struct report_plotter report_plotter;
report_plotter *report_plotter_new(uint32_t group);
void report_plotter_add(report_plotter *p, const scan_data *d, const struct pose *pose);
struct report_plan report_plotter_finish(report_plotter *p);
void report_plotter_free(report_plotter *p); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(report_plotter, report_plotter_free)

/* Fills map and histogram. */
void report_draw_map(struct report_edge *e, const struct verify_map *map);

/* How the edge counts, as a class of the style sheet. */
const char *report_standing_class(const struct edge *e);
/* SVG of a plan with its stations and edges. */
void report_append_plan(GString *html, const report *r, const struct report_plan *plan);

#endif
