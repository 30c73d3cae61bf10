#ifndef PROCESS_SCAN_SOURCES_H
#define PROCESS_SCAN_SOURCES_H
/* What the products of single scans (geometry, features) are made from: each scan, and the scans with a grid of its group that
 * stand nearest. A key over all of it tells whether a product is up to date, without a look at the points. */
#include "process/scan-data.h"
#include "process/scan-graph.h"

#define SCAN_SOURCE_NEIGHBOURS 6

struct scan_source {
	uint32_t number, group;
	enum scan_kind kind;
	struct pose pose;
	char *fingerprint;
	uint32_t neighbours[SCAN_SOURCE_NEIGHBOURS],
		neighbour_count; /* indices of sources, nearest first */
	char *key;
};

struct scan_sources_desc {
	uint32_t neighbours; /* at most SCAN_SOURCE_NEIGHBOURS */
	double reach_m;
	const char *method; /* kind, version and parameters: begins each key */
	char *(*state)(const site *s,
		uint32_t number); /* of what else of the scan goes in; caller frees; NULL */
};
/* Of struct scan_source, by number. Poses count to half a millimetre and 2e-5. */
GArray *scan_sources_find(const site *s, const scan_graph *graph,
	const struct scan_sources_desc *desc, GError **error);
static inline struct scan_source *scan_sources_at(GArray *sources, guint i)
{
	return &g_array_index(sources, struct scan_source, i);
}

/* A few words on why the product of a source must be made; NULL: it need not. */
typedef const char *(*scan_source_why)(const site *s, const struct scan_source *source);
/* Whether any is due, and of the first that is "scan 3 has no normals" (caller frees; NULL: none is; ret_why may be NULL). Takes the
 * sources; false when there are none, for an error is told of already. */
bool scan_sources_is_due(
	const site *s, GArray *sources, scan_source_why why, bool *ret_due, char **ret_why);

#endif
