#ifndef ACQUIRE_PRESET_H
#define ACQUIRE_PRESET_H
/* A preset is how finely a scan is made. What it will take is predicted from the lidar that is
 * connected. */
#include "acquire/calibration.h"
#include "acquire/decoder.h"
#include "acquire/driver.h"
#include <stdbool.h>
#include <stdint.h>

struct preset {
	const char *name, *title;
	uint32_t columns, rows;
	uint32_t photos;      /* a turn */
	uint32_t rescans_max; /* times that lost columns are gone back for */
	bool both_faces; /* each direction is seen twice: a whole turn is passed over, not half */
};

/* Ends with a row without a name: draft, standard, fine. */
extern const struct preset presets[];
/* What pleinair calibrate scans with; not among those that people choose from. */
extern const struct preset preset_calibration;
/* NULL when there is none of this name. */
const struct preset *preset_find(const char *name);

/* How the stage is driven, in angles a second. */
struct stage_pace {
	double scan_rad_s; /* at which each column is met by a little over one revolution */
	double travel_rad_s, photo_rad_s, home_rad_s;
	double acceleration_rad_s2;
	double run_up_rad; /* before the first column, to be at speed there */
	/* How slowly the way home begins, and for how long: what comes late shifts the two parts of
	 * it differently, slack in the gear alike (lidar-delay.h). */
	double look_rad_s, look_rad;
};
struct stage_pace preset_pace(const struct preset *preset, double scan_rate_hz);

struct prediction {
	double seconds;
	uint64_t points; /* of the panorama that a beam can reach, at most */
	uint64_t bytes;  /* record and planes */
};
/* The half turn of the lidar pass, the photo half, homing and travel; no losses. hdr: photos at stops, with several exposures. */
struct prediction preset_predict(const struct preset *preset, bool hdr, const struct driver *driver,
	const struct lidar_identity *lidar, const struct calibration *calibration);

#endif
