#ifndef PROCESS_PROFILE_LINES_H
#define PROCESS_PROFILE_LINES_H
/* Profile lines: the feature points of a model linked along edges into few, long, smooth curves in space, which is what Xu & Chen 2004
 * wish for in section 9 ("sparser, longer and smoother profile lines").
 *
 * 1. Pieces (profile-pieces.h): straight rows grow through the feature points, from directional ones along their lines, from others in
 *    whatever direction most lie in a row.
 * 2. Edges (profile-faces.h, profile-edges.c): all points around a piece, taken together along it, are a section through the faces beside
 *    it, told apart as each station sees them (profile-view.h). Where two faces cut each other there is an edge, and where one ends. It goes
 *    as far as its faces do, with feature points beside it.
 * 3. Joining (profile-join.h): the longest come first; what they explain is left out. What lies on one line is one. Edges that came out
 *    longer than what they were found by are looked at again, by all of their length, for that tells their direction the better; those
 *    that are not found again keep about what they were found by. Beside long ones of buildings one looks for others: mouldings run along
 *    each other, and what is often interrupted grows in short and crooked pieces only.
 * 4. Where a face ends, all beams along the end tell at last where exactly, and what they do not tell of is none; nor is a crease one of whose
 *    faces is no wider than a row of beams (profile-rim.h).
 * 5. All of that more than once, each time by other beams or taking steep faces for likelier or not; what looks agree on stays
 *    (profile-agree.h).
 * 6. Each is looked at closely from one end to the other, and what points do not bear out is left out (profile-extent.h).
 * 7. What runs through another edge is cut off there (profile-cross.h).
 * 8. Chaining (profile-chain.h): what follows each other is a curve, and ends that nearly meet in a corner meet.
 *
 * The same model gives the same bytes on any number of threads. */
#include "process/model.h"
#include "process/segment-class.h"

enum profile_kind {
	PROFILE_CREASE, /* two faces meet */
	PROFILE_END,    /* a face ends, and what lies behind is farther away or was not seen */
	PROFILE_MARK,   /* colours differ on one face */
	PROFILE_THIN,   /* a pole, a rail, a twig: no face is known */
	PROFILE_KINDS
};

struct profile_vertex {
	float at_m[3]; /* from the origin of the lines */
	int16_t face
		[2]
		[2]; /* normals of the faces beside it, packed (model.h); none: MODEL_NORMAL_NONE */
};
_Static_assert(sizeof(struct profile_vertex) == 20, "the file's own layout");

struct profile_line {
	uint32_t first, count; /* of its vertices, at least two */
	float length_m;
	float confidence; /* 0..1: how much of its length points bear out, and how well */
	uint16_t leaf;    /* of most of its points */
	uint8_t kind;     /* enum profile_kind */
	uint8_t closed;   /* 1: the last vertex is the first */
};
_Static_assert(sizeof(struct profile_line) == 20, "the file's own layout");

/* Const after it was made. */
typedef struct profile_lines profile_lines;
struct profile_lines {
	double origin_m[3];
	GArray *line;   /* of struct profile_line, the longest first */
	GArray *vertex; /* of struct profile_vertex */
};
profile_lines *profile_lines_new(void);    /* none */
void profile_lines_free(profile_lines *p); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(profile_lines, profile_lines_free)

/* Zero is the default of each. */
struct profile_options {
	float length_least_m; /* 0.2, more where points are sparse: shorter lines are left out */
	const uint8_t
		*leaf_class; /* enum segment_class of every number of a leaf; NULL: not known */
	bool single_thread;
	/* 0..1 of the work; returns false to stop, and NULL is returned then. */
	bool (*progress)(double fraction, gpointer user_data);
	gpointer user_data;
};
profile_lines *profile_lines_find(const model *m, const struct profile_options *options);

#endif
