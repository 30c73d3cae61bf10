#ifndef PROCESS_BUILD_MODEL_H
#define PROCESS_BUILD_MODEL_H
/* Builds SITE/model/points.model from the placed scans and their geometry, in bounded memory. Where scans overlap, the sample
 * that was measured best stays: by range and incidence; filled cells never count. What each scan gives is kept beside the model
 * (SITE/model/parts/), so that a site with one scan more builds only what changed: the new scan's part, the overlaps with scans in
 * its reach, and the pieces of the model where a point came or went. The rest of the model is copied.
 *
 * 1. Overlaps (model-overlaps.h, overlap.h): which points of each scan another one has better, pair by pair.
 * 2. Parts (model-part.h, morton.h): the points of each scan, sorted along the Morton curve.
 * 3. Merge (model-stale.h, model-merge.h, model-thin.h, model-write.h, chunk-order.h): all parts into one stream, without what is
 *    dropped, that into chunks, for each piece (model-piece.h) that is out of date.
 *
 * The same inputs give the same bytes, on any number of threads, in whatever order scans were added. Scans without geometry are
 * taken as they are: their points have no normals, and incidence does not count. */
#include "acquire/site.h"
#include "process/scan-graph.h"

struct build_options {
	uint64_t memory_bytes; /* 0: 1 GiB; about what the process may take at most for this */
	bool (*progress)(
		double fraction, const char *doing, gpointer user_data); /* returns false to stop */
	gpointer user_data;
};
struct build_result {
	uint64_t points,
		redundant; /* in the model; left out because another scan has them better */
	uint64_t
		points_taken_over; /* of those in the model: with pieces of the one before, unchanged */
	uint32_t scans, scans_rebuilt; /* in the model; of these, whose part was made anew */
	uint32_t
		scans_left_out; /* placed, but in groups of scans that nothing ties to the others */
	double seconds;
};
/* G_IO_ERROR_CANCELLED when progress stopped it; what was done so far is used the next time. */
bool build_model(site *s, const scan_graph *g, const struct build_options *options,
	struct build_result *ret, GError **error);
/* *ret_why: a few words, NULL when it is not; caller frees. */
bool build_model_is_due(
	const site *s, const scan_graph *g, bool *ret_due, char **ret_why, GError **error);

#endif
