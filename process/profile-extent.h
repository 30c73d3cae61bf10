#ifndef PROCESS_PROFILE_EXTENT_H
#define PROCESS_PROFILE_EXTENT_H
/* How far an edge goes along its line: as far as points beside it bear it out. */
#include "process/profile-faces.h"

/* A face in the site's frame: normal . place = off_m. */
struct profile_plane {
	float normal[3];
	double off_m;
	float noise_m;
};
/* One of a section as a plane. */
struct profile_plane profile_plane_of(
	const struct profile_frame *f, const struct profile_face *face);

/* Sets from_m and to_m of an edge that was just found, as far as its faces, and feature points beside it, go along with it, and its support.
 * plane: two of a crease, one of a face's end; side: of the latter, 1 or -1 (profile_beside()). false: too little bears it out, or it
 * is too short. */
bool profile_extent_find(const profile_around *all, struct profile_piece *p,
	const struct profile_plane *plane, int side);

/* Adds what is left of an edge whose place is final, when it is looked at closely from one end to the other: ends go back to where points
 * tell of it, and where for a while they tell of none it is cut in two. Parts that are shorter than length_least_m are left out. Of marks
 * stays what edges of colour, of intensity or of what was scanned bear out; of what is thin, all. */
void profile_extent_cut(const profile_around *all, const struct profile_piece *p,
	double length_least_m, GArray *ret);

#endif
