#include "acquire/preset.h"
#include <math.h>
#include <string.h>

#define DEGREE (G_PI / 180)
/* Revolutions a column: above one, so that a column is met whatever the phase of the mirror. */
#define REVOLUTIONS_PER_COLUMN 1.06
/* Bytes of a beam on the wire: SCIP's three characters each for range and intensity, with sums;
 * CoLa is alike. */
#define WIRE_BYTES_PER_BEAM 6.2
/* Bytes of a cell in the planes, compressed, as measured on simulated and quiet real scans. */
#define PLANE_BYTES_PER_CELL 9.0

const struct preset presets[] = {
	{ "draft", "Draft: a quick look", 750, 198, 18, 2 },
	{ "standard", "Standard", 1500, 396, 18, 3 },
	{ "fine", "Fine: every detail", 3000, 792, 18, 4 },
	{ NULL },
};

const struct preset *preset_find(const char *name)
{
	for (const struct preset *p = presets; p->name; p++)
		if (strcmp(p->name, name) == 0)
			return p;
	return NULL;
}

struct stage_pace preset_pace(const struct preset *preset, double scan_rate_hz)
{
	double scan = 2 * G_PI / preset->columns * scan_rate_hz / REVOLUTIONS_PER_COLUMN;
	/* A draft by a fast mirror must not outrun the motor. */
	scan = fmin(scan, 30 * DEGREE);
	double acceleration = 40 * DEGREE;
	return (struct stage_pace){ .scan_rad_s = scan,
		.travel_rad_s = 45 * DEGREE,
		.photo_rad_s = 20 * DEGREE,
		.home_rad_s = 45 * DEGREE,
		.acceleration_rad_s2 = acceleration,
		.run_up_rad = scan * scan / (2 * acceleration) + 0.3 * scan };
}

/* A move from rest to rest. */
static double move_seconds(double angle, double rate, double acceleration)
{
	double ramp = rate * rate / acceleration;
	return angle < ramp ? 2 * sqrt(angle / acceleration) : angle / rate + rate / acceleration;
}

struct prediction preset_predict(const struct preset *preset, const struct lidar_identity *lidar,
	const struct calibration *calibration)
{
	struct stage_pace pace = preset_pace(preset, lidar->scan_rate_hz);
	double a = pace.acceleration_rad_s2, pass = G_PI + 2 * pace.run_up_rad;
	bool photos = calibration->has_camera;
	double seconds = move_seconds(G_PI, pace.home_rad_s, a) +
			 move_seconds(pass, pace.scan_rad_s, a) +
			 (photos ? move_seconds(G_PI, pace.photo_rad_s, a) : 0) +
			 move_seconds(2 * G_PI, pace.travel_rad_s, a) + 2;
	double turns = pass / pace.scan_rad_s * lidar->scan_rate_hz,
	       cells = (double)preset->columns * preset->rows;
	double frames = photos ? preset->photos * 1.5 * calibration->camera.width *
					 calibration->camera.height
			       : 0;
	double row_beams = fmin(preset->rows, G_PI / 2 / fabs(lidar->angle_step_rad) + 1);
	return (struct prediction){ .seconds = seconds,
		.points = (uint64_t)(row_beams * preset->columns),
		.bytes = (uint64_t)(turns * lidar->beams * WIRE_BYTES_PER_BEAM + frames +
				    cells * PLANE_BYTES_PER_CELL) };
}
