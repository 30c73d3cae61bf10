#ifndef PROCESS_PROFILE_VIEW_H
#define PROCESS_PROFILE_VIEW_H
/* A section across an edge as one station sees it: faces side by side, in the order in which its beams sweep over them.
 *
 * Seen along the edge a beam is a ray in the plane of the section, and what it meets is one face after another. Beams tell directions
 * well, and waver in range alone. The inverse of the depth of a plane is linear in where a beam crosses a picture plane, and wavers
 * there as much at a slant as head-on. So parts of the sweep, each a plane, are found by least squares, exactly, by a dynamic programme
 * over where they begin and end; each part costs what telling it apart costs (Schwarz 1978). Beams that met two faces at once are of none.
 *
 * Pure; any number of threads. */
#include "process/profile-around.h"

#define PROFILE_VIEW_PARTS 16

struct profile_part {
	float normal[3]; /* in the frame, towards the station */
	float off_m;     /* normal . place = off_m */
	float noise_m;   /* of its points, off the plane, 1 sigma */
	uint32_t points;
	float along_information; /* of its slope along the piece: 1 / sigma^2 */
};
/* Where one part ends and the next begins. */
struct profile_border {
	bool is_crease; /* they meet, at at[0]; else at[0] and at[1] are the last of the one, the first of the other */
	float at[2][2];    /* across */
	bool is_shadow[2]; /* of each: it ends because the other is in front of it */
};
struct profile_view {
	uint32_t parts;
	struct profile_part part[PROFILE_VIEW_PARTS];
	struct profile_border border[PROFILE_VIEW_PARTS]; /* n: between part n and n + 1 */
};

struct profile_viewer {
	double from[3];      /* the station, in the frame */
	bool is_guessed;     /* none is known */
	bool is_narrow_flat; /* what is told by two rows of beams is taken for no steep face, but for the end of what is beside it */
	float radius_m, spacing_m;
};
/* which: of the points of near those that the station saw. part_of, of each of near: gets its part for those of which, or stays as it is. */
void profile_view_look(const GArray *near, const uint32_t *which, uint32_t count,
	const struct profile_viewer *viewer, uint8_t *part_of, struct profile_view *ret);

#endif
