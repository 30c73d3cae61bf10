#ifndef PROCESS_FEATURE_SCORE_H
#define PROCESS_FEATURE_SCORE_H
/* Features of a scan of a simulated site held against what really stands there: for the bench and for tests.
 *
 * A cell's truth is what its centre sees; its point is up to half a cell off that, so all is asked within a cell or two.
 * - A depth edge: a measured cell next to one (of four) whose surface lies more than 0.1 m, and 4 sigma of noise, off the plane of
 *   its own, and it off that one's; or next to the sky.
 * - A crease: two surfaces that touch, more than 30 degrees apart, both at least 3 cells and 6 cm wide away from it, neither a plant
 *   nor glass.
 * - A false feature: a feature point such that within 2 cells there is no depth step of 3 sigma, no two normals more than 12 degrees
 *   apart, no plant, no border of instances, and no step in colour (0.06 of the display's scale within 3 x 3 cells).
 * - A straight crease: no edge within 3 cells but creases of the same direction, which is that of the cut of both true planes.
 * - A straight silhouette: near sides of depth edges within 12 cells lie on a line in the picture, on one face of one thing; its
 *   direction is that of the cut of the plane that it is seen in with the true face. No other edge within 3 cells.
 * - Leaves: plants where the nine normals around do not agree (a trunk's do). */
#include "process/features.h"

struct feature_truth {
	float range_m; /* 0: sky */
	float normal[3];
	float rgb[3]; /* linear, 1: a white wall in the sun */
	uint16_t instance;
	bool is_plant, is_glass;
};

/* Feature points at straight edges, the directed ones of them, and how far off these are. */
struct feature_lines {
	uint64_t straight, directed;
	double p50_deg, p90_deg;
};

#define FEATURE_BANDS 8
struct feature_score {
	uint64_t edges, edges_found; /* depth edges and creases, but of plants */
	uint64_t depth_edges, depth_found, creases, creases_found, plant_edges, plant_found;
	uint64_t points, false_points;                                         /* feature points */
	struct feature_lines straight, straight_creases, straight_silhouettes; /* both; each */
	uint64_t leaves, leaves_directed; /* feature points on leaves */
	/* Of dithering points: bands of range from 5 m on, each wider than the last by a third; per area of surface times darkness. */
	double band_m[FEATURE_BANDS + 1], density_per_m2[FEATURE_BANDS], band_m2[FEATURE_BANDS];
};
/* truth: of each cell. noise_m: 1 sigma of a range. */
void feature_score_make(const features *f, const range_grid *g, const struct feature_truth *truth,
	float noise_m, const struct features_options *options, struct feature_score *ret);
/* What a cell is: smooth and even; an edge that counts; 0: neither. Caller frees. */
enum feature_truth_mark {
	FEATURE_TRUTH_DEPTH = 1,
	FEATURE_TRUTH_CREASE,
	FEATURE_TRUTH_SMOOTH,
	FEATURE_TRUTH_PLANT, /* a depth edge of a plant */
};
uint8_t *feature_truth_marks(const range_grid *g, const struct feature_truth *truth, float noise_m);

#endif
