#include "sim/lens.h"
#include <math.h>

struct lens lens_for_size(uint32_t width, uint32_t height, int distorted)
{
	return (struct lens){ .width = width,
		.height = height,
		.focal_px = height / 2.0 / tan(47.5 * M_PI / 180),
		.cx = (width - 1) / 2.0,
		.cy = (height - 1) / 2.0,
		.k1 = distorted ? -0.05 : 0,
		.k2 = distorted ? 0.01 : 0 };
}

/* Newton's method for r (1 + k1 r^2 + k2 r^4) = distorted; the left side rises for any sensible
 * lens. */
static double undistort_radius(const struct lens *lens, double distorted)
{
	double r = distorted;

	for (int i = 0; i < 20; i++) {
		double r2 = r * r;
		double error = r * (1 + r2 * (lens->k1 + r2 * lens->k2)) - distorted;

		r -= error / (1 + r2 * (3 * lens->k1 + r2 * 5 * lens->k2));
		if (fabs(error) < 1e-14)
			break;
	}
	return r;
}

void lens_ray(const struct lens *lens, double u, double v, double ret_direction[3])
{
	double x = (u - lens->cx) / lens->focal_px, y = (v - lens->cy) / lens->focal_px;
	double distorted = sqrt(x * x + y * y);
	double scale = distorted > 0 ? undistort_radius(lens, distorted) / distorted : 1;
	double norm = sqrt(1 + scale * scale * distorted * distorted);

	ret_direction[0] = scale * x / norm;
	ret_direction[1] = scale * y / norm;
	ret_direction[2] = 1 / norm;
}
