#ifndef PROCESS_PLANE_OUTLINE_H
#define PROCESS_PLANE_OUTLINE_H
/* Where points cover their plane: their patches are joined where they reach each other, and end where these end, but no more than half a spacing and
 * PLANE_GROWN_M beyond the last point (a closing by the distance to the nearest one). Slits are closed where points are that lie near the
 * plane, but not on it: joints, frames. Internal to process/plane-*. */
#include <glib.h>
#include <stdbool.h>
#include <stdint.h>

#define PLANE_GROWN_M 0.02f

/* A point of the model on a plane. */
struct plane_spot {
	float at[2];              /* u v, m */
	float reach_m, spacing_m; /* how far its patch covers, the long way; more than 0 */
	uint8_t rgba[4];
	uint16_t intensity;
	bool is_beside; /* not quite on it: slits alone are closed there */
};

/* Appends places along the border, close together, to place (float[2]), ring by ring, outlines and holes; and to end (uint32_t) where
 * each ring ends in it. Parts and holes that are smaller than these are left out. *ret_step_m: how close. G_IO_ERROR when memory is
 * short. */
bool plane_outline(const struct plane_spot *spot, uint32_t count, double part_least_m2,
	double hole_least_m2, GArray *place, GArray *end, float *ret_step_m, GError **error);

#endif
