#ifndef PROCESS_NEXT_STATION_H
#define PROCESS_NEXT_STATION_H
/* Where the next scan would see most that no scan has seen, and still enough of what is known to be aligned: a greedy next best view
 * over a plan of occupancy (Gonzalez-Banos & Latombe 2002 score candidates the same way, new area against known surroundings).
 *
 * The plan has a cell for each CELL_M; of each it knows at which heights points lie. A cell stops sight where points stand at the
 * height of the head, is floor where they lie at about the height where a tripod stood near it, and is unknown without points. */
#include <glib.h>
#include <stdbool.h>
#include <stdint.h>

#define NEXT_STATION_CELL_M  0.25
#define NEXT_STATION_RANGE_M 15.0 /* what lies further away is not counted as seen */

typedef struct station_plan station_plan;
/* low, high: the part of the site that is looked at, in metres. A plan is never larger than 1024 cells a side, its cells grow instead. */
station_plan *station_plan_new(const double low_m[3], const double high_m[3]);
void station_plan_free(station_plan *p); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(station_plan, station_plan_free)
/* Points outside are left out. Any part of a scan's points will do that is even over its surfaces, one to a cell's surface and more. */
void station_plan_add(station_plan *p, const double position_m[3]);

struct next_station {
	double x_m, y_m;    /* where to set the tripod up */
	double new_m2;      /* of plan that a scan there would see first */
	double known_share; /* 0..1: of what it would see, how much is known */
};
/* station_m: where the heads stood, 3 of each. false: no place promises enough that is new (NEXT_STATION_LEAST_M2). */
#define NEXT_STATION_LEAST_M2 6.0
bool next_station_find(
	const station_plan *p, const double *station_m, size_t stations, struct next_station *ret);

#endif
