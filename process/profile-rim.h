#ifndef PROCESS_PROFILE_RIM_H
#define PROCESS_PROFILE_RIM_H
/* Where a face ends, as all beams along its end tell it at once: between the last that met it and the first that did not.
 *
 * Beams of a scan lie in rows and columns as far apart as all of them are, so beside each point at the end of a face it is known where
 * the next beam went: an interval that the end lies in, from every point along it and every station. One straight line runs through them
 * all. Directions of beams are exact and ranges are not, so places are where beams cut the plane, not where their ranges have them. */
#include "process/profile-pieces.h"

enum profile_rim {
	PROFILE_RIM_UNKNOWN, /* no station that is known tells of it; it stayed as it was */
	PROFILE_RIM_NONE,    /* beams tell of no end there, or are too far apart to tell where */
	PROFILE_RIM_FITTED   /* it was moved */
};
/* Of a PROFILE_END; and of a PROFILE_CREASE one of whose faces no station sees more than a row of beams of: where the other face ends is
 * known the better, and it becomes a PROFILE_END. */
enum profile_rim profile_rim_fit(const profile_around *all, struct profile_piece *p);

#endif
