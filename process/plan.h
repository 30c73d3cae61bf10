#ifndef PROCESS_PLAN_H
#define PROCESS_PLAN_H
/* A plan of what a scan saw, from above: upright surfaces as short oriented edges that face where they were seen from, and
 * the height of the ground. Two plans are matched by votes: every pair of edges that face the same way and stand at the same
 * height votes for the shift that lays one on the other, for every heading. Const after it is made. */
#include "process/coarse-view.h"
#include "process/pose.h"

#define PLAN_CELL_M 0.5f /* of the ground's heights */

struct plan_edge {
	float x_m, y_m;
	float heading_rad; /* of the normal, counter-clockwise from +x, 0..2 pi */
	float low_m, high_m;
	float weight; /* height that was seen, with a limit */
};

struct plan_ground {
	float x_m, y_m, z_m;
};

struct plan {
	struct pose
		level; /* takes the scanner frame to the plan's: +z up, the scanner at the origin */
	struct plan_edge *edge; /* by rising heading */
	size_t edges;
	struct plan_ground *ground; /* one for each cell that has any */
	size_t grounds;
	float half_m;     /* the heights reach this far from the origin */
	uint32_t columns; /* cells in both directions */
	float *height_m;  /* lowest surface that faces up; NAN: none */
	float ground_m;   /* the ground about the scanner */
};

struct plan *plan_new(const struct coarse_view *v, const struct pose *level);
void plan_free(struct plan *p); /* NULL is fine */

struct plan_shift {
	float turn_rad, x_m, y_m,
		z_m; /* takes b's plan to a's: a turn about z, counter-clockwise, then a shift */
	float votes;
};

/* The best shifts in falling order of votes, at most max. z is from the ground. */
size_t plan_match(const struct plan *a, const struct plan *b, double distance_max_m,
	struct plan_shift *ret, size_t max);

/* How much higher a's ground lies, where both saw it, under a given turn and shift. */
float plan_rise(const struct plan *a, const struct plan *b, const struct plan_shift *shift);

struct pose plan_shift_pose(const struct plan *a, const struct plan *b, const struct plan_shift *s);

#endif
