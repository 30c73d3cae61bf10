#ifndef PROCESS_ALIGN_SCANS_H
#define PROCESS_ALIGN_SCANS_H
/* Pairs of a site's scans, whatever they came from, as edges of its graph. Two grids are aligned as pair.h does; where either
 * is a cloud, both are aligned as clouds (cloud-align.h). */
#include "process/scan-data.h"
#include "process/scan-graph.h"

/* All that aligning needs of one scan. Made once; const after, for any number of threads. Keeps nothing of the scan_data. */
typedef struct align_scan align_scan;
/* NULL and an error: the scan was loaded without its points. */
align_scan *align_scan_new(const scan_data *d, GError **error);
/* known: what pair.h found of it before; NULL: nothing. */
align_scan *align_scan_new_known(
	const scan_data *d, const struct pair_alikes *known, GError **error);
/* Of a grid; false: it is a cloud. */
bool align_scan_alikes(const align_scan *s, struct pair_alikes *ret);
void align_scan_free(align_scan *s); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(align_scan, align_scan_free)
uint32_t align_scan_number(const align_scan *s);
const char *align_scan_fingerprint(const align_scan *s);
bool align_scan_is_cloud(const align_scan *s);
uint64_t align_scan_bytes(const align_scan *s); /* memory, about */

/* Fills all of *ret but decision and what the graph's solution tells; a's number must be below b's. Always gives a verdict.
 *
 * start (takes b to a), as picked pairs give it; NULL: no idea. The edge's pose is then the one near the start, also when
 * another fits better: that one is its rival, and the verdict says so. Where nothing fits near the start, the start itself.
 *
 * false and an error: no memory. */
bool align_scans(const align_scan *a, const align_scan *b, const struct pose *start,
	enum edge_origin origin, struct edge *ret, GError **error);

/* Only the check of a pose (takes b to a) that came with the files; origin is EDGE_GIVEN. The pose stays as it is; how far a
 * refinement would take it is in the covariance. */
bool align_scans_check(const align_scan *a, const align_scan *b, const struct pose *given,
	struct edge *ret, GError **error);

/* What an edge was computed from: both scans, and how. Differs when it should be computed again. Caller frees. */
char *align_inputs(const char *fingerprint_a, const char *fingerprint_b, enum edge_origin origin);

#endif
