#ifndef PROCESS_PROFILE_AROUND_H
#define PROCESS_PROFILE_AROUND_H
/* The points of a model around a straight line. It keeps a copy of what it needs of them, 24 bytes a point. Const after it was made; any
 * number of threads may ask.
 *
 * How lines are found is told in metres, of points as far apart as those of a scanner that stands before what it sees. Points of sparser models
 * are looked at as in a smaller model: all lengths, places and stations are divided by unit_m, and what comes out is multiplied in the
 * end. Noise goes with how far apart points are, for who is farther away sees both worse. */
#include "process/features.h"
#include "process/model.h"
#include <glib.h>

/* Of a line: its place, two directions across, and its own; right-handed, unit, from the origin of the lines. */
struct profile_frame {
	double at[3];
	float axis[3][3];
};

/* A point as the frame has it: across, across, along. */
struct profile_near {
	float u, v, t;
	float normal[3];          /* 0 0 0: none */
	float spacing_m, error_m; /* error_m: of the plane fit around it; NAN: none */
	uint8_t flags;            /* enum feature_flag */
	bool is_feature;
	uint16_t scan; /* its number */
};

typedef struct profile_around profile_around;
/* 1, or more where even the closest quarter of the points are farther apart. */
double profile_unit_m(const model *m);
profile_around *profile_around_new(const model *m, const double origin_m[3], double unit_m);
void profile_around_free(profile_around *a); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(profile_around, profile_around_free)
/* Where a scanner stood, from the origin, and which way up; how far apart its beams are, in rows as in columns; 0: its points do not
 * tell. */
struct profile_station {
	uint16_t scan;
	double at_m[3], up[3], beam_rad;
};
/* false: the model does not say, or says that nobody knows. */
bool profile_around_station(const profile_around *a, uint16_t scan, struct profile_station *ret);
/* All within radius_m of the line between two places along it. ret is emptied first. step: of layers across, PROFILE_AROUND_LAYER_M or so
 * along it, one in so many; 1: all. */
#define PROFILE_AROUND_LAYER_M 0.0625f
void profile_around_look(const profile_around *a, const struct profile_frame *f, double from_m,
	double to_m, float radius_m, uint32_t step, GArray *ret);

#endif
