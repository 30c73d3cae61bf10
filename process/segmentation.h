#ifndef PROCESS_SEGMENTATION_H
#define PROCESS_SEGMENTATION_H
/* Segments of all scans that stand in one frame (Xu & Chen 2004, section 3; Wegen et al. 2024, section 4.1). The points are read
 * three times, scan by scan, so that only one scan need be in memory; a scan in slabs, on all threads:
 *
 * 1. The ground (ground.h), from all points.
 * 2. Voxels of what is not ground; their shape, smooth regions, classes (classify.h), things: trees (single-trees.h), what hangs
 *    together (components.h), walls (smooth-regions.h).
 * 3. The leaf of each point: of the ground, or of its voxel; of its own class, where its file tells it or a person's model.
 *
 * The same input gives the same segments, on any number of threads. */
#include "process/scan-points.h"
#include "process/segments.h"
#include "process/voxels.h"
#include <glib.h>

/* Of a person, or of the file that the scan came from. */
#define LABEL_NONE 255

struct segmentation_scan {
	struct scan_points points;
	bool has_station;
	double station_m[3]; /* where the scanner stood */
	const uint8_t *
		label; /* enum segment_class of each cell or point, LABEL_NONE: not told; NULL: none */
};

struct segmentation_options {
	double gap_m; /* 0: by how far apart the points are, 0.15 m at least: the smallest gap between two things */
	uint32_t
		points_min; /* 0: 60; things with fewer points are put with others of their class */
	bool (*progress)(double fraction, const char *doing, gpointer user_data); /* false stops */
	gpointer user_data;
	/* What somebody else tells of a scan, given the height of each cell or point above the ground: fills labels as in
	 * segmentation_scan, which go before those. NULL: nobody. */
	bool (*tell)(gpointer teller, const struct segmentation_scan *scan, const float *height_m,
		uint8_t *ret_label, GError **error);
	gpointer teller;
};

struct segmentation_source {
	size_t scans;
	/* Scan i, which holds until the next one is asked for. */
	bool (*open)(gpointer user_data, size_t i, struct segmentation_scan *ret, GError **error);
	gpointer user_data;
};

/* A point as voxels take it; number: which scan of several it is of. */
void segmentation_point(
	const struct segmentation_scan *scan, uint32_t number, uint64_t i, struct voxel_point *ret);

typedef struct segmentation segmentation;
/* Adds its segments to `into`. */
segmentation *segmentation_new(const struct segmentation_source *source,
	const struct segmentation_options *options, segments *into, GError **error);
void segmentation_free(segmentation *s); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(segmentation, segmentation_free)
/* Leaf of each cell or point of a scan, the one of this index in the source; SEGMENT_NONE where there is no point. On all threads. */
void segmentation_label(const segmentation *s, size_t index, const struct segmentation_scan *scan,
	uint16_t *ret_leaf);
double segmentation_gap_m(const segmentation *s); /* that was used */

#endif
