#ifndef SIM_MOUNT_H
#define SIM_MOUNT_H
/* How lidar and camera really sit on the head, which is not quite where the drawing has them: options say by how much
 * (lidar_turn_deg and the like). What the head tells of itself is another matter (certificate.h).
 *
 * The head's frame turns with the stage: x right, y front, z up, origin on the axis. */
#include "sim/lens.h"
#include "sim/options.h"

struct lidar_mount {
	double rotation[3][3];   /* a beam goes along rotation * (0, cos theta, sin theta) ... */
	double translation_m[3]; /* ... from here */
	double beam_zero_rad;    /* what theta is more than the lidar thinks */
	double range_offset_m;   /* what ranges are more than it says */
	double home_rad;         /* azimuth of the home slot in the scanner's frame */
};
struct camera_mount {
	double rotation[3][3]; /* camera = rotation * (head - translation) */
	double translation_m[3];
};

extern const double camera_pitch_rad;
extern const struct lidar_mount lidar_mount_drawn;
struct camera_mount camera_mount_drawn(void);

struct lidar_mount lidar_mount_of(const sim_options *o);
struct camera_mount camera_mount_of(const sim_options *o);
/* As drawn, and as it is. */
struct lens lens_drawn(const sim_options *o);
struct lens lens_of(const sim_options *o);

#endif
