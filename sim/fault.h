#ifndef SIM_FAULT_H
#define SIM_FAULT_H
/* A fault is a place on the turn where something goes wrong, so that a test can say where and a
 * person can read it:
 *
 *     KIND@COLUMN[xCOUNT][:PARAM]      drop@12x3   unplug@400:2.5   split@40:7
 *
 * COLUMN counts 3000 to a turn, clockwise from home. A fault fires once, when the front of the head
 * first passes its column while the lidar streams, and not before the home slot was seen; those of
 * the camera also when the lidar is silent. Kinds:
 *
 *     drop xN        N revolutions are never sent; the device's counters go on. What strikes
 *                    telegrams strikes portions of some milliseconds of serial lidars
 *     stall :S       the lidar is silent for S seconds; without S until its port is opened anew
 *     garble xN      N telegrams with flipped, inserted or missing bytes
 *     split :N       from here on, bytes come in pieces of N (default 7)
 *     merge xN       N telegrams come together with the one after
 *     jump :N        the scan counter jumps by N (default 5) though nothing is lost; CoLa only
 *     error          a hardware error until the device is reset (SCIP, RPLIDAR) or rebooted (CoLa);
 *                    LD: silence until its port is opened anew
 *     unplug :S      the lidar is gone in the middle of a telegram, back after S seconds (default 2)
 *     power          the link closes
 *     stagefault     the drive stops by itself
 *     slip :N        the motor loses N steps (default 16; negative gains)
 *     badframe xN    N frames with the error flag and damaged pixels
 *     frameloss :N   N exposures (default 1) never come
 *     cameragone     the camera is unplugged for good
 *     epstall        the USB endpoint halts until the host clears it; only behind a kernel
 *     codes xN :B    in N revolutions, a stretch of B beams (default 100) holds error codes
 *     estop :S       the emergency stop is pressed, and released after S seconds (default 2)
 *     interlock :S   the interlock opens, and closes after S seconds (default 2) */
#include <glib.h>
#include <stdbool.h>
#include <stdint.h>

#define FAULT_COLUMNS 3000

enum fault_kind {
	FAULT_DROP,
	FAULT_STALL,
	FAULT_GARBLE,
	FAULT_SPLIT,
	FAULT_MERGE,
	FAULT_JUMP,
	FAULT_ERROR,
	FAULT_UNPLUG,
	FAULT_POWER,
	FAULT_STAGE,
	FAULT_SLIP,
	FAULT_BADFRAME,
	FAULT_FRAMELOSS,
	FAULT_CAMERAGONE,
	FAULT_CODES,
	FAULT_EPSTALL,
	FAULT_ESTOP,
	FAULT_INTERLOCK,
	FAULT_KINDS
};

struct fault {
	enum fault_kind kind;
	uint32_t column;
	uint32_t count;
	double param; /* the default where none was given; NAN for a stall without end */
	bool fired;
};

/* Appends the faults of a list; the error is a sentence without a prefix, ending where the list's
 * name would follow. */
bool fault_parse(const char *list, GArray *faults, GError **error);
bool fault_is_of_camera(enum fault_kind kind);
/* The next fault that fires as the front goes from one column to another (not wrapped), or NULL;
 * marks it fired. */
const struct fault *fault_take(GArray *faults, double from_column, double to_column, bool camera);

#endif
