#ifndef PROCESS_PROFILE_AGREE_H
#define PROCESS_PROFILE_AGREE_H
/* What several looks at the same edges agree on. Where a scan has two or three rows of beams on a sill there is more than one way to tell its
 * faces apart, and a little decides which; the edges that come of the wrong one are elsewhere at each look. */
#include "process/profile-pieces.h"

#define PROFILE_AGREE_LOOKS 8 /* at most */

/* found: of each look its pieces, of struct profile_piece. Returns those that more than one other look shows, on the mean along them, less
 * what no other shows at their ends; where looks tell of one edge differently, and none shows both, the one that more of them show. What several looks
 * show is there several times. Those that the most looks show come first. Caller unrefs. */
GArray *profile_agree(GArray *const *found, uint32_t looks, bool single_thread);

#endif
