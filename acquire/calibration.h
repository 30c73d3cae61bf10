#ifndef ACQUIRE_CALIBRATION_H
#define ACQUIRE_CALIBRATION_H
/* A head's calibration: where its lidar and its camera sit on the pan axis (DEVICES 5.1). It comes
 * with the head as JSON and is kept in every record and scan.json, so that a scan can be computed
 * again.
 *
 * Frames. The scanner frame stands still: x to the right of the home azimuth, y along it, z up,
 * origin on the pan axis at the height of the lidar. The head frame turns with the stage: y to the
 * front, x right, z up; at stage angle A (clockwise) front is (sin A, cos A, 0). A beam at device
 * angle a has theta = beam_zero + beam_direction * a, and lies in the head frame at  rotation * (0,
 * (r + r0) cos theta, (r + r0) sin theta) + translation. */
#include <glib.h>
#include <stdbool.h>
#include <stdint.h>

struct lidar_calibration {
	double beam_zero_rad;
	double beam_direction; /* +1, -1 */
	double range_offset_m; /* added to every range */
	double rotation[3][3]; /* from three small angles about x, y, z in degrees: R = Rz Ry Rx */
	double translation_m[3];
};

struct stage_calibration {
	double steps_per_turn;
	uint32_t index_slots;
	double azimuth_zero_rad; /* azimuth of the home slot in the scanner frame */
	double clock_hz;
	uint32_t clock_bits;
};

struct camera_calibration {
	uint32_t width, height;  /* even */
	double fx, fy, cx, cy;   /* pixels; centres at whole numbers, as OpenCV has it */
	double distortion[5];    /* k1 k2 p1 p2 k3 */
	double rotation[3][3];   /* head frame to camera: x right, y down, z forward */
	double translation_m[3]; /* the camera's centre in the head frame */
	double clock_hz;
	uint32_t clock_bits;
	double readout_us;
	double delay_us; /* least time from the end of an exposure to its frame's arrival; 0 when not given */
};

struct calibration {
	char serial[64];
	struct lidar_calibration lidar;
	struct stage_calibration stage;
	bool has_camera;
	struct camera_calibration camera;
};

/* R = Rz Ry Rx of angles about x, y and z in degrees. */
void calibration_rotation(const double degrees[3], double ret[3][3]);

/* text is the certificate's JSON; name says where it is from, for messages. Refuses what is missing
 * or absurd by key. */
bool calibration_parse(const char *text, const char *name, struct calibration *ret, GError **error);

#endif
