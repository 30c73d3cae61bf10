#ifndef PROCESS_PICKS_H
#define PROCESS_PICKS_H
/* Points that a person picked in both of two scans, and the motion that takes the one to the other: least squares (Arun,
 * Huang and Blostein 1987; Xu & Chen 2004, section 3). */
#include "process/pose.h"
#include <glib.h>
#include <stddef.h>

struct pick {
	double a_m[3], b_m[3]; /* the same point in each scan's frame */
};
struct picks_fit {
	struct pose pose;   /* takes b to a */
	double rms_m;       /* of the pairs that are no blunders */
	double *residual_m; /* of each pair; caller frees */
	bool *blunder;      /* pairs that do not fit the rest, left out of the pose; caller frees */
	size_t blunders;
};
void picks_fit_clear(struct picks_fit *fit);

#define PICKS_ERROR (picks_error_quark())
GQuark picks_error_quark(void);
enum picks_error {
	PICKS_ERROR_FEW,        /* fewer than three */
	PICKS_ERROR_DEGENERATE, /* on a line, or all at one place */
	PICKS_ERROR_DISAGREE,   /* no more than half of them agree with each other, or no three */
};
bool picks_fit(const struct pick *picks, size_t count, struct picks_fit *ret, GError **error);

#endif
