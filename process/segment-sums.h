#ifndef PROCESS_SEGMENT_SUMS_H
#define PROCESS_SEGMENT_SUMS_H
/* What is in each leaf while segments are changed: the sums of the tree come from these. */
#include "process/segment-state.h"

struct leaf_sum {
	uint64_t points;
	double low_m[3], high_m[3], area_m2;
};
/* By number, SEGMENTS_MAX + 1 of them; caller frees. */
struct leaf_sum *segment_sums_new(const segments *tree);
void segment_sums_add(struct leaf_sum *to, const struct leaf_sum *from);
/* Looks at all points of these leaves (a byte each) again. */
bool segment_sums_measure(
	segment_state *s, const uint8_t *which, struct leaf_sum *sum, GError **error);
/* Writes them into the tree; nodes that have nothing left in them go. */
void segment_sums_finish(segments *tree, const struct leaf_sum *sum);

#endif
