#include "process/segment-sums.h"
#include <math.h>
#include <string.h>

#define AREA_VOXEL_M 0.15

struct leaf_sum *segment_sums_new(const segments *tree)
{
	struct leaf_sum *sum = g_new0(struct leaf_sum, SEGMENTS_MAX + 1);
	for (guint i = 0; i < tree->nodes->len; i++) {
		const struct segment *node = &g_array_index(tree->nodes, struct segment, i);
		struct leaf_sum *own = &sum[node->id];
		if (!segments_is_leaf(tree, node->id))
			continue;
		own->points = node->points;
		own->area_m2 = node->area_m2;
		memcpy(own->low_m, node->low_m, sizeof own->low_m);
		memcpy(own->high_m, node->high_m, sizeof own->high_m);
	}
	return sum;
}

void segment_sums_add(struct leaf_sum *to, const struct leaf_sum *from)
{
	for (int k = 0; k < 3; k++) {
		to->low_m[k] = to->points ? fmin(to->low_m[k], from->low_m[k]) : from->low_m[k];
		to->high_m[k] = to->points ? fmax(to->high_m[k], from->high_m[k]) : from->high_m[k];
	}
	to->points += from->points;
	to->area_m2 += from->area_m2;
}

void segment_sums_finish(segments *tree, const struct leaf_sum *sum)
{
	segments_clear_sums(tree);
	for (uint32_t id = SEGMENT_FIRST; id <= SEGMENTS_MAX; id++)
		if (sum[id].points && segments_find(tree, id))
			segments_count(tree, id, sum[id].points, sum[id].low_m, sum[id].high_m,
				sum[id].area_m2);
	for (bool more = true; more;) {
		more = false;
		for (guint i = tree->nodes->len; i--;) {
			const struct segment *node = &g_array_index(tree->nodes, struct segment, i);
			if (node->id < SEGMENT_FIRST || node->points ||
				!segments_is_leaf(tree, node->id))
				continue;
			segments_remove(tree, node->id);
			more = true;
		}
	}
}

bool segment_sums_measure(
	segment_state *s, const uint8_t *which, struct leaf_sum *sum, GError **error)
{
	voxels **surface = g_new0(voxels *, SEGMENTS_MAX + 1);
	bool good = true;
	for (uint32_t id = 0; id <= SEGMENTS_MAX; id++)
		if (which[id]) {
			sum[id] = (struct leaf_sum){ 0 };
			surface[id] = voxels_new(AREA_VOXEL_M);
		}
	for (guint i = 0; good && i < s->scans->scans->len; i++) {
		struct segmentation_scan scan;
		good = segment_scans_open(s->scans, i, &scan, error);
		for (uint64_t k = 0; good && k < s->label[i].count; k++) {
			struct voxel_point p;
			uint32_t leaf = s->label[i].leaf[k];
			if (!which[leaf])
				continue;
			segmentation_point(&scan, i, k, &p);
			struct leaf_sum one = { 1, { p.at_m[0], p.at_m[1], p.at_m[2] },
				{ p.at_m[0], p.at_m[1], p.at_m[2] }, 0 };
			segment_sums_add(&sum[leaf], &one);
			voxels_add(surface[leaf], &p);
		}
	}
	for (uint32_t id = 0; id <= SEGMENTS_MAX; id++) {
		for (uint32_t k = 0; surface[id] && k < surface[id]->count; k++)
			sum[id].area_m2 += surface[id]->voxel[k].area_m2;
		voxels_free(surface[id]);
	}
	g_free(surface);
	return good;
}
