#ifndef PROCESS_VERIFY_COMPARE_H
#define PROCESS_VERIFY_COMPARE_H
/* The surfaces of one scan in the view of another, at a given pose: which agree, which are hidden, which contradict. */
#include "process/pose.h"
#include "process/verify-view.h"

enum compared {
	COMPARED_NONE, /* no surface, foliage, an edge: nothing that can be told */
	COMPARED_AGREE,
	COMPARED_HIDDEN,  /* behind what the other saw */
	COMPARED_THROUGH, /* the other saw a surface farther away: it looked through here */
	COMPARED_VOID, /* the other saw nothing at all there, as it does of glass, water and black things */
	COMPARED_MISSED,  /* a surface that faces the same way lies close by, but not here */
	COMPARED_OUTSIDE, /* the other did not look there */
	COMPARED_KINDS
};

/* Least squares for the twist (pose_perturb's, in the frame of `into`) that would bring what agrees to rest. */
struct pull {
	double matrix[6][6], right[6]; /* the upper half is filled */
};

struct comparison {
	double sr[COMPARED_KINDS]; /* solid angles, as the scan that is looked at from saw them */
	double together_sr; /* of the conflicts, those that lie together, as a thing seen through does */
	double thing_sr; /* large things beside the scanner that were seen through, left out of the conflicts */
	double thing_together_sr; /* of these, what lies together */
	double even_sr, squares,
		under_6mm; /* of agreeing surfaces that are even: sums weighted by solid angle */
	double facing
		[3]
		[3]; /* sum of normal * normal^T of the agreeing surfaces, in the other's frame */
};

struct comparing {
	float slack_m,
		slack_rad; /* 1 sigma of what the pose may be wrong by; the second counts with the range */
	uint32_t stride; /* of the rows and columns that are looked at */
	/* NULL, or with one element a cell of `from`; only with stride 1. */
	uint8_t *ret_kind;
	struct pull *ret_pull; /* is added to */
	float *ret_distance_m; /* of what agrees, positive: nearer to the other scanner; else 0 */
};

/* Adds to *ret. pose takes from's frame to into's. */
void verify_compare(const struct verify_view *from, const struct verify_view *into,
	const struct pose *pose, const struct comparing *how, struct comparison *ret);

#endif
