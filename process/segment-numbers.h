#ifndef PROCESS_SEGMENT_NUMBERS_H
#define PROCESS_SEGMENT_NUMBERS_H
/* Which numbers things keep when the segments of a site are found anew. What is compared is a tree of before and the one that was
 * found now, by the points of the scans that both have, cell by cell: how many points a node of the one and a node of the other
 * have in common, over how many either has (intersection over union; poses do not matter for it).
 *
 * One node keeps the number of one:
 *
 * 1. What is left over of a class ("Ground", "Undergrowth") that of the same class, whatever it has in common with it; it is never
 *    compared with a thing.
 * 2. A thing that of a thing, a part that of a part, whatever their classes: that with the largest share in common first, a third
 *    at least, which is half of what the two have on average. So whatever has more than half in common keeps its number.
 * 3. What is left then, a part that of a thing or the other way round, in the same order.
 *
 * All others get numbers that none ever had (segments.h). When the tree of before was made from the same (equal keys), things are
 * the same by the order in which they were found, and nothing is compared.
 *
 * Plain counting: the same input gives the same numbers. One owner, one thread. */
#include "process/segments.h"

typedef struct segment_numbers segment_numbers;
/* Both trees must stay while it is used. */
segment_numbers *segment_numbers_new(const segments *was, const segments *now);
void segment_numbers_free(segment_numbers *n); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(segment_numbers, segment_numbers_free)
/* The leaves of one scan's cells; SEGMENT_NONE and leaves that a tree does not have count for nothing. */
void segment_numbers_count(
	segment_numbers *n, const uint16_t *was, const uint16_t *now, uint64_t count);
/* The number that each node of now becomes, for segments_renumber; SEGMENTS_MAX + 1 of them. *next: the first number that none ever
 * had, and what it is after that. false: there are too many. */
bool segment_numbers_find(const segment_numbers *n, uint32_t *next, uint16_t *ret_becomes);

#endif
