#ifndef SIM_LENS_H
#define SIM_LENS_H
/* A pinhole camera with radial distortion, in OpenCV's model: a point (x, y, z) of the camera's
 * frame (x right, y down, z forward) falls on u = fx x' (1 + k1 r^2 + k2 r^4) + cx with x' = x/z,
 * r^2 = x'^2 + y'^2, and v likewise. Pixel centres are whole numbers. */
#include <stdint.h>

struct lens {
	uint32_t width, height;
	double focal_px, cx, cy, k1, k2;
};

/* 95 degrees from top to bottom, like the camera of the head. */
struct lens lens_for_size(uint32_t width, uint32_t height, int distorted);
/* The unit direction that falls on a pixel. */
void lens_ray(const struct lens *lens, double u, double v, double ret_direction[3]);

#endif
