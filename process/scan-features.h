#ifndef PROCESS_SCAN_FEATURES_H
#define PROCESS_SCAN_FEATURES_H
/* The features of each scan as a product of the site: SITE/features/0003.features (product.h), with one element per cell of the
 * scan's grid, or per point of a cloud (pleinair-features(5)):
 *
 *     degree      uint8, * 255      kind  uint8, enum feature_kind      flags  uint8, enum feature_flag
 *     direction   2 * int16, octahedral, in the scan's own frame (model_pack_normal); the sign is free
 *     line_error  uint16, 0.1 mm
 *     k1, k2      float, 1/m        principal  2 * int16, as direction
 *
 * Grids by features.h, with the lines through the feature points of the scans of their group that stand near; scans that are not
 * placed alone; clouds by features-cloud.h, from their geometry, which must be there. The manifest's "key" is a hash of all that
 * went in: fingerprints of the scans, the geometry's checksum, relative poses (to half a millimetre and 2e-5), parameters, versions.
 * "dither_per_m2" and "tone_exponent" (features_options) are there to read, for who draws the dithering points.
 * Segments are not among the key, so that what people change there makes nothing anew: edges are found from the points alone. */
#include "process/features.h"
#include "process/product.h"
#include "process/scan-graph.h"

#define SCAN_FEATURES_KIND    "features"
#define SCAN_FEATURES_VERSION 5
/* Further away scanners see little of the same, and not as well. */
#define FEATURES_NEIGHBOURS 4
#define FEATURES_REACH_M    30.0

typedef struct scan_features scan_features;
struct scan_features {
	product *file;
	uint64_t count; /* cells, or points */
	const uint8_t *degree, *kind, *flags;
	const int16_t (*direction)[2], (*principal)[2];
	const uint16_t *line_error;
	const float *k1, *k2;
};
scan_features *scan_features_open(const site *s, uint32_t number, GError **error);
void scan_features_free(scan_features *f); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(scan_features, scan_features_free)

struct features_site_options {
	struct features_options features;
	bool (*progress)(
		double fraction, const char *doing, gpointer user_data); /* returns false to stop */
	gpointer user_data;
};
/* Makes what is missing or out of date, scan by scan, with a few scans in memory at a time (a fine one has 110 MB, and 90 more while
 * it is estimated); each is whole on disk when the next begins. G_IO_ERROR_CANCELLED when progress stopped it. options may be NULL. */
bool features_site(site *s, const scan_graph *g, const struct features_site_options *options,
	uint32_t *ret_made, GError **error);
bool features_site_is_due(const site *s, const scan_graph *g,
	const struct features_options *options, bool *ret_due, char **ret_why, GError **error);

#endif
