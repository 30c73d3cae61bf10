#ifndef PROCESS_SEGMENT_NAMES_H
#define PROCESS_SEGMENT_NAMES_H
/* Which names things keep when the segments of a site are found anew. A thing is found as "Tree 4", the fourth by size of its kind;
 * a kind is what stands below one node and is called the same but for the number.
 *
 * What has kept its number (segment-numbers.h) and is of the kind that it was has the name that it had. All others get the
 * next numbers of their kinds, in the order in which they were found: larger ones than any of the result of before. So a bush that
 * is a tree now, or a wall that is another building's, is called anew, and "Tree 4" is never another tree than the "Tree 4" of
 * before. Names without a number ("Ground", "Details") stay as they are. */
#include "process/segments.h"

/* now: has its numbers already (segments_renumber). */
void segment_names_keep(const segments *was, segments *now);

#endif
