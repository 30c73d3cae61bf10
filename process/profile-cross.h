#ifndef PROCESS_PROFILE_CROSS_H
#define PROCESS_PROFILE_CROSS_H
/* Edges of surfaces meet; they do not run through each other. Where pieces do, one of them was found in what is too fine for its scan: bolts,
 * flanges, ribs. On facades they do cross: battens, glazing bars, joints. */
#include "process/profile-pieces.h"

/* Cuts every piece that is not of a building off where one before it crosses it, and keeps the longer part; leaves it out where that is too
 * short. pieces: of struct profile_piece, the surest first. */
void profile_cross_cut(GArray *pieces, const struct profile_options *options);

#endif
