#ifndef PROCESS_TWO_FACE_H
#define PROCESS_TWO_FACE_H
/* Where the lidar sits on the pan axis, from one scan without any target (DEVICES 5.1): what the front half of its fan measured
 * must lie on what the back half measured half a turn later. The place is cut into patches of a few degrees; where one is even,
 * its beams of either face are a plane, and how far the two planes are apart, along their normal, is a residual. Gauss-Newton over
 * all patches, those that disagree with the others (people, cars) weighing less (Huber), the plane itself being eliminated.
 *
 * Unknown are the beam zero, the tilt of the fan out of the vertical (about the head's front), where the lidar sits across and
 * along the front, and the range offset. Not to be seen in a turning head's own scan are a turn about the axis, which is the home
 * azimuth by another name, and the height on the axis; both stay as the certificate has them. The range offset moves both faces
 * alike, so it shows only in the second order: mostly not at all. How late the lidar's stamps are (acquire/lidar-delay.h), which
 * turns all lines by delay * pace, and the slack of the gear are found along with these, from the lines of the way back: otherwise
 * those of a plain scan would take a delay for a tilt.
 *
 * What is not seen is told: each unknown comes with its standard deviation, from the information matrix and the scatter of the
 * residuals; one whose deviation is over a bound keeps its value. Pure, one thread. After Alismail and Browning (Journal of Field
 * Robotics 2015) and Sheehan, Harrison, Newman (IJRR 2012). */
#include "process/faces.h"

enum two_face_unknown {
	TWO_FACE_BEAM_ZERO, /* rad */
	TWO_FACE_TILT,
	TWO_FACE_X, /* m */
	TWO_FACE_Y,
	TWO_FACE_RANGE,
	TWO_FACE_MOUNT, /* so many of the lidar's mount, then what is found along with them */
	TWO_FACE_DELAY = TWO_FACE_MOUNT, /* s */
	TWO_FACE_SLACK,                  /* rad */
	TWO_FACE_UNKNOWNS
};

struct two_face_value {
	double before, value, deviation;
	bool seen; /* else value is what it was before */
};

struct two_face_result {
	struct two_face_value value[TWO_FACE_UNKNOWNS];
	struct lidar_calibration lidar; /* with what was found */
	/* How far the faces lie apart, in the mean (root of the mean square, strays left out): as the certificate has the
	 * lidar, as it was found, and what the noise of the ranges alone would make. */
	double error_before_m, error_after_m, noise_error_m;
	uint32_t patches;
	/* The direction among the mount's unknowns that shows least (angles at 5 m), and its deviation. */
	double weakest[TWO_FACE_MOUNT], weakest_deviation_m;
};

/* The same fan again, as a certificate turns it: angles in degrees about x, y, z. */
void two_face_angles(const double rotation[3][3], double ret_deg[3]);

/* false: too little is seen by both faces, said in one sentence. */
bool two_face_solve(const struct faces *f, struct two_face_result *ret, GError **error);

/* "beam zero", and its value in the unit that people read, with that unit: "degrees", "mm", "ms". */
const char *two_face_name(enum two_face_unknown unknown);
double two_face_in_unit(enum two_face_unknown unknown, double value);
const char *two_face_unit(enum two_face_unknown unknown);

#endif
