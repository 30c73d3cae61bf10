#include "acquire/preset.h"
#include "acquire/exposures.h"
#include <math.h>
#include <string.h>

#define DEGREE (G_PI / 180)
/* Revolutions a column: above one, so that a column is met whatever the phase of the mirror. */
#define REVOLUTIONS_PER_COLUMN 1.06
#define SLOWEST_RATE_HZ        5.0
/* Of an entry of the record beside its payload, with its padding. */
#define ENTRY_BYTES          36.0
#define STAGE_BYTES_PER_STEP 8.0
#define STAGE_ENTRIES_PER_S  50.0
/* Bytes of a cell in the planes, compressed, as measured on simulated scans. */
#define PLANE_BYTES_PER_CELL  4.6
#define COLOUR_BYTES_PER_CELL 1.4
/* Waking the lidar and comparing clocks. */
#define PREPARE_SECONDS 1.5
/* At a stop the stage rings out, and each frame waits for the camera's beat. */
#define STOP_SECONDS  0.3
#define FRAME_SECONDS 0.15

const struct preset presets[] = {
	{ "draft", "Draft: a quick look", 750, 198, 18, 2 },
	{ "standard", "Standard", 1500, 396, 18, 3 },
	{ "fine", "Fine: every detail", 3000, 792, 18, 4 },
	{ NULL },
};

const struct preset preset_calibration = { "calibration", "Calibration: both faces", 1500, 396, 48,
	3, true };

const struct preset *preset_find(const char *name)
{
	for (const struct preset *p = presets; p->name; p++)
		if (strcmp(p->name, name) == 0)
			return p;
	return strcmp(name, preset_calibration.name) == 0 ? &preset_calibration : NULL;
}

struct stage_pace preset_pace(const struct preset *preset, double scan_rate_hz)
{
	/* A device that does not tell its rate turns at least as fast as the slowest. */
	double rate_hz = scan_rate_hz > 0 ? scan_rate_hz : SLOWEST_RATE_HZ;
	double scan = 2 * G_PI / preset->columns * rate_hz / REVOLUTIONS_PER_COLUMN;
	/* A draft by a fast mirror must not outrun the motor. */
	scan = fmin(scan, 30 * DEGREE);
	double acceleration = 40 * DEGREE;
	return (struct stage_pace){ .scan_rad_s = scan,
		.travel_rad_s = 45 * DEGREE,
		.photo_rad_s = 20 * DEGREE,
		.home_rad_s = 45 * DEGREE,
		.acceleration_rad_s2 = acceleration,
		.run_up_rad = scan * scan / (2 * acceleration) + 0.3 * scan,
		.look_rad_s = 10 * DEGREE,
		.look_rad = 40 * DEGREE };
}

/* A move from rest to rest. */
static double move_seconds(double angle, double rate, double acceleration)
{
	double ramp = rate * rate / acceleration;
	return angle < ramp ? 2 * sqrt(angle / acceleration) : angle / rate + rate / acceleration;
}

/* The stage's part of a scan without losses. After homing it rolls on while it ramps down, so it
 * has to come back before it can run up to the first column; the lidar streams already then, and
 * again on the way home. */
struct itinerary {
	double home_s, back_s, pass_s, photos_s, travel_s;
	double turned_rad;
};

/* Where both faces are wanted, the second half turn is passed over as the first was, and brings its photos. */
static struct itinerary plan(const struct stage_pace *pace, bool photos, bool both_faces)
{
	double a = pace->acceleration_rad_s2,
	       pass = (both_faces ? 2 : 1) * (G_PI + 2 * pace->run_up_rad),
	       roll = pace->home_rad_s * pace->home_rad_s / (2 * a), back = roll + pace->run_up_rad,
	       travel = photos || both_faces ? 2 * G_PI : G_PI;
	photos = photos && !both_faces;
	/* Home is half a turn away on average. */
	return (struct itinerary){ .home_s = move_seconds(G_PI + roll, pace->home_rad_s, a),
		.back_s = move_seconds(back, pace->travel_rad_s, a),
		.pass_s = move_seconds(pass, pace->scan_rad_s, a),
		.photos_s = photos ? move_seconds(G_PI, pace->photo_rad_s, a) : 0,
		.travel_s = move_seconds(pace->look_rad, pace->look_rad_s, a) +
			    move_seconds(travel - pace->look_rad, pace->travel_rad_s, a),
		.turned_rad = G_PI + roll + back + pass + (photos ? G_PI : 0) + travel };
}

/* From the end of the pass back to the first stop, then from stop to stop; and home from the last. */
static struct itinerary plan_stops(const struct stage_pace *pace, const struct preset *preset)
{
	double a = pace->acceleration_rad_s2, between = 2 * G_PI / preset->photos;
	struct itinerary i = plan(pace, true, preset->both_faces);
	double back = (preset->both_faces ? 2 : 1) * G_PI;
	i.photos_s = move_seconds(back, pace->travel_rad_s, a) +
		     preset->photos * (move_seconds(between, pace->travel_rad_s, a) + STOP_SECONDS +
					      EXPOSURES_MAX * FRAME_SECONDS);
	i.turned_rad += (preset->both_faces ? 2 * G_PI : 0) + back + G_PI;
	return i;
}

static double record_bytes(const struct itinerary *i, const struct preset *preset, bool hdr,
	const struct driver *driver, const struct lidar_identity *lidar,
	const struct calibration *c)
{
	double moving_s = i->home_s + i->back_s + i->pass_s + i->photos_s + i->travel_s,
	       streaming_s = driver->streams_always ? PREPARE_SECONDS + moving_s
						    : i->back_s + i->pass_s + i->travel_s,
	       turns = streaming_s * lidar->scan_rate_hz,
	       steps = i->turned_rad / (2 * G_PI) * c->stage.steps_per_turn,
	       frame = 1.5 * c->camera.width * c->camera.height;
	/* While the stage goes home a frame each second is for metering. */
	double frames = c->has_camera ? preset->photos * (hdr ? EXPOSURES_MAX : 1) + i->home_s : 0;
	return turns * (lidar->beams * driver->bytes_per_beam + ENTRY_BYTES) +
	       steps * STAGE_BYTES_PER_STEP + moving_s * STAGE_ENTRIES_PER_S * ENTRY_BYTES +
	       frames * frame;
}

struct prediction preset_predict(const struct preset *preset, bool hdr, const struct driver *driver,
	const struct lidar_identity *lidar, const struct calibration *calibration)
{
	struct stage_pace pace = preset_pace(preset, lidar->scan_rate_hz);
	struct itinerary i = hdr && calibration->has_camera
				     ? plan_stops(&pace, preset)
				     : plan(&pace, calibration->has_camera, preset->both_faces);
	double cells = (double)preset->columns * preset->rows,
	       cell_bytes =
		       PLANE_BYTES_PER_CELL + (calibration->has_camera ? COLOUR_BYTES_PER_CELL : 0);
	double row_beams = fmin(preset->rows, G_PI / 2 / fabs(lidar->angle_step_rad) + 1);
	return (struct prediction){ .seconds = PREPARE_SECONDS + i.home_s + i.back_s + i.pass_s +
					       i.photos_s + i.travel_s,
		.points = (uint64_t)(row_beams * preset->columns),
		.bytes = (uint64_t)(record_bytes(&i, preset, hdr, driver, lidar, calibration) +
				    cells * cell_bytes) };
}
