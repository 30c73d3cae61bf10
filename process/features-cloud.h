#ifndef PROCESS_FEATURES_CLOUD_H
#define PROCESS_FEATURES_CLOUD_H
/* Features of points without a grid (features.h tells what they are). What stands around a point in the picture of a scan is
 * here what stands around it in space, as far as four times its point size.
 *
 * The edge filter is how much the error of the planes varies among these, against the errors themselves where they are least,
 * and whether they stand on one side alone, as at a border. For colour and intensity it is the slope across them against what
 * varies anyhow. Curvature is how the normals around change, as for grids; positive where the surface bulges the way the point's own
 * normal looks; at a crease, of how the planes of so few points round it. Dithering points are chosen along a space-filling curve, each time that enough darkness times area has come
 * together. */
#include "acquire/points.h"
#include "process/cloud.h"
#include "process/features.h"

struct features_cloud_input {
	struct cloud_view view;
	const int16_t (
		*normal)[2]; /* packed (model.h); as of cloud_geometry, and so the next two */
	const float *plane_error_m, *point_size_m; /* NAN: none */
	const points *look; /* colour and intensity of the points; NULL: none */
};
/* One row of as many columns as there are points. NULL when progress (may be NULL) stopped it. */
features *features_of_cloud(const struct features_cloud_input *of,
	const struct features_options *options,
	bool (*progress)(double fraction, gpointer user_data), gpointer user_data);

#endif
