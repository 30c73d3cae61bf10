#ifndef PROCESS_VERIFY_COMPARE_H
#define PROCESS_VERIFY_COMPARE_H
/* The surfaces of one scan in the view of another, at a given pose: which agree, which are hidden, which contradict. */
#include "process/pose.h"
#include "process/verify-view.h"

enum compared {
	COMPARED_NONE, /* no surface here, or none that can be told */
	COMPARED_AGREE,
	COMPARED_HIDDEN,  /* behind what the other saw */
	COMPARED_THROUGH, /* the other saw a surface farther away: it looked through here */
	COMPARED_VOID,    /* the other saw nothing at all there */
	COMPARED_MISSED,  /* a surface that faces the same way lies close by, but not here */
	COMPARED_OUTSIDE, /* the other did not look there */
	COMPARED_KINDS
};

struct comparison {
	double sr[COMPARED_KINDS]; /* solid angles, as the scan that is looked at from saw them */
	double squares, weights, under_6mm; /* of agreeing distances */
	double facing
		[3]
		[3]; /* sum of normal * normal^T of the agreeing surfaces, in the other's frame */
};

/* Adds to *ret. pose takes from's frame to into's. slack_m: what the pose may be wrong by. ret_kind and ret_distance_m may be
 * NULL, else one of each per cell of from. */
void verify_compare(const struct verify_view *from, const struct verify_view *into,
	const struct pose *pose, float slack_m, struct comparison *ret, uint8_t *ret_kind,
	float *ret_distance_m);

#endif
