#ifndef PROCESS_LINE_FIT_H
#define PROCESS_LINE_FIT_H
/* The straight line that places are nearest to, by least squares of their distances, from sums over them. Plain values. */
#include <stdbool.h>

struct straight {
	double at[3];    /* any place on it */
	double along[3]; /* unit; the sign is free */
};

struct line_sums {
	double weight, sum[3], product[6]; /* xx xy xz yy yz zz */
};
void line_sums_add(struct line_sums *s, const double at[3], double weight);
/* The mean place and the direction in which the places spread most. ret_off_m: root mean square distance from it; may be NULL. false: all
 * are at one place. Sums are of places some metres around the origin; farther away they are not exact enough. */
bool line_sums_fit(const struct line_sums *s, struct straight *ret, double *ret_off_m);

/* Where the place is along it, and how far beside. */
double straight_along(const struct straight *l, const double at[3]);
double straight_off(const struct straight *l, const double at[3]);
void straight_place(const struct straight *l, double along_m, double ret[3]);
/* Where the lines through p and q, along and way, unit vectors, come nearest to each other: how far along each from there. false: they are
 * too parallel, and the square of their angle's sine is no more than the least. */
bool straight_nearest(const double p[3], const double along[3], const double q[3],
	const double way[3], double sine2_least, double ret[2]);

#endif
