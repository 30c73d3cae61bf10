#ifndef ACQUIRE_COLOUR_H
#define ACQUIRE_COLOUR_H
/* Colour of a panorama's cells from the photos of the same scan: each cell's point is projected
 * through the calibrated camera into the photos nearest in angle, and they are blended where two
 * meet. Cells without a range (sky) are projected as if far away. */
#include "acquire/calibration.h"
#include "acquire/panorama.h"
#include "firmware-io/camera.h"

struct photo {
	struct camera_frame_info info;
	const uint8_t *pixels; /* NV12, borrowed */
	double front_rad;      /* stage angle at mid-exposure */
};

/* Where a point in the head frame falls in the picture, by the pinhole model with OpenCV's
 * distortion. false: behind the camera or outside the picture. */
bool colour_project(const struct camera_calibration *camera, const double head_m[3], double *ret_u,
	double *ret_v);

/* Makes p->rgb. Cells that no photo shows stay black. Uses all cores. */
void colour_panorama(panorama *p, const struct photo *photos, uint32_t count,
	const struct calibration *calibration);

/* Colours the cells that this photo shows, whatever colour they had, and no other: for a preview
 * while photos come in. Makes p->rgb, black, when there is none. Uses all cores. */
void colour_one_photo(
	panorama *p, const struct photo *photo, const struct calibration *calibration);

#endif
