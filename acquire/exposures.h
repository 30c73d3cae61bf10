#ifndef ACQUIRE_EXPOSURES_H
#define ACQUIRE_EXPOSURES_H
/* The exposures of a photo stop: the one that the scan was locked to, the base, and around it others that are known to be darker and lighter (DEVICES
 * 3.9). A frame belongs to the one whose controls it says itself that it has. */
#include "firmware-io/camera.h"

#define EXPOSURES_MAX 3

struct exposures {
	uint32_t count; /* 0: no stop; 1: plain photos */
	struct camera_controls controls
		[EXPOSURES_MAX]; /* the base first, then the darker and the lighter one, where there are any */
};

/* The base, 2 EV less and 2 EV more: by time, and by gain where time comes to its end (longest_100us). What comes out as one that is there already
 * is left out. */
struct exposures exposures_around(const struct camera_controls *base, uint32_t longest_100us);
/* Adds one that a camera says is in force, to a base; not where it says nothing of its exposure, or the same as before. */
void exposures_add(struct exposures *e, const struct camera_controls *in_force);
/* Which of them; -1: none. */
int exposures_find(const struct exposures *e, const struct camera_controls *controls);
/* Light that a frame gathers, as if it had so many 100 us at a gain of 100 %. */
double exposures_light(const struct camera_controls *controls);

#endif
