#ifndef PROCESS_SEGMENT_SITE_H
#define PROCESS_SEGMENT_SITE_H
/* The segments of a whole site: the tree (segments.h) and the labels of each scan (scan-segments.h). Scans that stand in one frame
 * are segmented together, those that are not placed each alone; all share one tree. What is the same as before keeps its number
 * (segment-numbers.h) and its name (segment-names.h). Then what a person changed is done to them once more (segment-edits.h).
 *
 * Made from the scans, where they stand, their geometry, and the site's own parameters, which stand in site.json:
 *
 *     "segmentation": { "gap_m": 0.15, "points_min": 60, "labels": true, "model": "trees.onnx", "confidence": 0.6 }
 *
 * all of which may be missing. labels: whether classes that came with imported points count, false: none, true: all, missing: those of
 * LAS files, for in others nobody knows what the numbers mean. model: a
 * semantic model of a person's own (segment-model.h), in the site's folder unless the path is absolute; what it is sure of to this
 * confidence goes before the rules and the labels. */
#include "process/scan-segments.h"

struct segment_site_options {
	bool (*progress)(
		double fraction, const char *doing, gpointer user_data); /* returns false to stop */
	gpointer user_data;
};

struct segment_site_result {
	uint32_t things; /* leaves with points */
	uint64_t points, class_points[SEGMENT_CLASSES];
	uint32_t changes_left_out; /* that speak of what is not there any more */
};

/* Finds what is out of date, makes the changes once more. Labels are written scan by scan, where they are others; the tree last: it
 * tells that all is there. Beside a few scans, holds two bytes a cell of all. */
bool segment_site(site *s, const scan_graph *g, const struct segment_site_options *options,
	struct segment_site_result *ret, GError **error);
/* Reads all labels once, to see that they are whole. */
bool segment_site_is_due(
	const site *s, const scan_graph *g, bool *ret_due, char **ret_why, GError **error);

#endif
