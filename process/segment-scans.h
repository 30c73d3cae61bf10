#ifndef PROCESS_SEGMENT_SCANS_H
#define PROCESS_SEGMENT_SCANS_H
/* The scans of a site as the segmentation reads them: which of them stand in one frame, and where. Not thread-safe. */
#include "process/scan-cache.h"
#include "process/scan-graph.h"
#include "process/segmentation.h"

/* Classes that came with imported points. */
enum segment_labels { LABELS_OF_LAS, LABELS_ALL, LABELS_NONE };

struct segment_scan {
	uint32_t number;
	int64_t frame; /* scans of the same stand in one; below 0: alone */
	struct pose pose;
	char *state; /* of its points, its geometry and its pose: another one when any of them is */
};

typedef struct segment_scans segment_scans;
struct segment_scans {
	const site *site;
	GArray *scans;              /* of struct segment_scan, by number */
	enum segment_labels labels; /* 0 until it is set */
	/* inside */
	scan_cache *cache;
	scan_geometry *geometry; /* of the scan that was opened last */
	uint8_t *label;
};
segment_scans *segment_scans_new(const site *s, const scan_graph *g, GError **error);
void segment_scans_free(segment_scans *s); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(segment_scans, segment_scans_free)
static inline const struct segment_scan *segment_scans_at(const segment_scans *s, guint i)
{
	return &g_array_index(s->scans, struct segment_scan, i);
}
/* What it gives holds until the next one is opened. */
bool segment_scans_open(segment_scans *s, guint i, struct segmentation_scan *ret, GError **error);

#endif
