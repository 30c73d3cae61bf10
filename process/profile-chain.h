#ifndef PROCESS_PROFILE_CHAIN_H
#define PROCESS_PROFILE_CHAIN_H
/* Lines of pieces of edges that nothing is twice in. Pieces that follow each other are one line; those of a round edge pass each other a
 * little, as tangents do, and are cut off where they meet. Such a line is round: a parabola from the middle of each piece to that of the
 * next. Free ends that nearly meet in a corner meet there. */
#include "process/profile-pieces.h"

/* pieces: of struct profile_piece; the same in the same order give the same lines. */
profile_lines *profile_chain(
	GArray *pieces, const double origin_m[3], const struct profile_options *options);

#endif
