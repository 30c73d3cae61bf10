#ifndef PROCESS_PROFILE_JOIN_H
#define PROCESS_PROFILE_JOIN_H
/* Joins pieces of edges: what is there twice is one, and pieces one behind the other are one. One owner, one thread; the order in which
 * pieces come counts: the surest first. */
#include "process/profile-pieces.h"

typedef struct profile_joiner profile_joiner;
profile_joiner *profile_joiner_new(const struct profile_options *options);
void profile_joiner_free(profile_joiner *j); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(profile_joiner, profile_joiner_free)
void profile_joiner_add(profile_joiner *j, const struct profile_piece *piece);
/* Whether edges that are there already account for a piece, which grew in feature points, or is an edge. Any number of threads between
 * adds. */
bool profile_joiner_explains(
	const profile_joiner *j, const struct profile_piece *piece, bool is_edge);
/* All that stays, as it is now: of struct profile_piece; caller unrefs. */
GArray *profile_joiner_pieces(const profile_joiner *j);

#endif
