#ifndef PROCESS_PROFILE_PIECES_H
#define PROCESS_PROFILE_PIECES_H
/* Straight pieces of edges: what profile lines are made of (profile-lines.h). */
#include "process/line-fit.h"
#include "process/profile-around.h"
#include "process/profile-lines.h"

struct profile_piece {
	struct straight line; /* from the origin of the lines */
	double from_m, to_m;  /* along it */
	float spacing_m;      /* of the points on it, the mean */
	float seen_m;         /* of an edge: how long the section is that it was found by */
	double seen_at[3];    /* and where the middle of that is */
	float support;        /* 0..1: part of its length that feature points are on */
	float degree;         /* 0..1: of these, the mean */
	bool is_directed;     /* of directional points */
	bool is_guessed;      /* of an edge: nobody knows where its faces were seen from */
	uint16_t leaf;
	uint8_t kind;     /* enum profile_kind */
	float face[2][3]; /* unit normals of the faces beside it; 0 0 0: none */
};
static inline double profile_piece_length(const struct profile_piece *p)
{
	return p->to_m - p->from_m;
}
/* The longer first; and creases, then ends, before what else there is: where faces meet is known the best. For g_array_sort(). */
int profile_piece_by_length(const void *a, const void *b);
int profile_piece_by_worth(const void *a, const void *b);
/* How far a place may lie beside the line of a piece that nobody could tell it from one on it. */
static inline double profile_piece_off_m(double spacing_m)
{
	return 0.03 + 0.7 * spacing_m;
}

/* All that grow in the feature points of a model, in the order in which they were found: the surest first. Lengths are divided by unit_m
 * (profile-around.h). Array of struct profile_piece; NULL: progress stopped it, which goes to PROFILE_GROWN_PART. */
#define PROFILE_GROWN_PART 0.1
GArray *profile_pieces_grow(const model *m, const double origin_m[3], double unit_m,
	const struct profile_options *options);

/* A section can be looked at in more than one way, and what all find is surer than what one does (profile-agree.h). */
struct profile_look {
	bool is_narrow_flat; /* profile-view.h */
	uint8_t left_out;    /* of the four shares of the points, from 1; 0: none */
};

/* Looks at the faces around a piece that grew, and adds the edges that they make: where two cut each other, and where one ends; the piece
 * itself where there are none and its points are directional. Of a long piece the same of its halves, where the faces beside it are bent, or it is an edge
 * and is not found again. What is_known (may be NULL) says of the part beside the piece is left out. Any
 * number of threads. */
void profile_piece_settle(const profile_around *all, const struct profile_piece *seed,
	const struct profile_look *look,
	bool (*is_known)(const struct profile_piece *p, const void *user_data),
	const void *user_data, GArray *ret);
/* What runs along beside an edge that is known, a moulding's say, whose own feature points tell its direction less well: all edges around it, as long as
 * most of it and no longer. The rest is as with profile_piece_settle(). */
void profile_piece_look_beside(const profile_around *all, const struct profile_piece *edge,
	const struct profile_look *look,
	bool (*is_known)(const struct profile_piece *p, const void *user_data),
	const void *user_data, GArray *ret);

#endif
