#ifndef TESTS_LINE_PLACES_H
#define TESTS_LINE_PLACES_H
/* Where vertices of profile lines are, and how far from what tests know to be an edge. */
#include "process/profile-lines.h"
#include <math.h>

static inline void vertex_at(const profile_lines *lines, uint32_t v, double ret[3])
{
	for (int k = 0; k < 3; k++)
		ret[k] = lines->origin_m[k] +
			 (double)g_array_index(lines->vertex, struct profile_vertex, v).at_m[k];
}

static inline double off_segment(const double at[3], const double a[3], const double b[3])
{
	double along = 0, length2 = 0, square = 0;
	for (int k = 0; k < 3; k++) {
		along += (at[k] - a[k]) * (b[k] - a[k]);
		length2 += (b[k] - a[k]) * (b[k] - a[k]);
	}
	along = CLAMP(along / length2, 0, 1);
	for (int k = 0; k < 3; k++) {
		double off = at[k] - a[k] - along * (b[k] - a[k]);
		square += off * off;
	}
	return sqrt(square);
}

#endif
