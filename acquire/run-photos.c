#include "acquire/colour.h"
#include "acquire/marks.h"
#include "acquire/run-private.h"
#include <math.h>

#define SECOND_NS INT64_C(1000000000)
#define DEGREE    (G_PI / 180)
/* From here on the stage is steady enough to stop, or to be photographed from. */
#define REACH_RAD (6 * DEGREE)
/* How often the angles are gone over for photos that did not come. */
#define ROUNDS          3
#define ROUNDS_AT_STOPS 2
/* Stage and mast ring a little after a stop. */
#define CALM_NS (SECOND_NS / 4)
/* For all frames of a stop. */
#define STOP_PATIENCE_NS (8 * SECOND_NS)

/* ---- frames ---- */

/* The last one counts. */
static void colour_preview(
	run *r, const struct camera_frame_info *info, const uint8_t *pixels, double front_rad)
{
	const struct calibration *calibration = run_calibration(r);
	if (calibration && calibration->has_camera)
		colour_one_photo(
			r->preview, &(struct photo){ *info, pixels, front_rad }, calibration);
}

void run_take_frame(const struct camera_frame_info *info, const uint8_t *pixels, double front_rad,
	bool locked, gpointer user_data)
{
	run *r = user_data;
	photos_take(r->photos, info, pixels, front_rad, locked);
	if (locked)
		colour_preview(r, info, pixels, front_rad);
	/* Photos of a scan that is resumed tell the exposure that it was made with. */
	if (r->recalling && locked)
		r->controls_known = photos_use_controls(r->photos, &info->controls, NULL);
}

void run_take_stop(const struct exposures *exposures, gpointer user_data)
{
	run *r = user_data;
	photos_stop(r->photos, exposures);
}

/* ---- exposures ---- */

static bool try_exposures(run *r, GError **error)
{
	if (photos_wanted(r->photos) == 0)
		return true;
	if (!photos_try_exposures(r->photos, &r->exposures, error))
		return false;
	if (r->exposures.count == 1)
		g_message("the camera does not change its exposure: the photos are plain ones, "
			  "taken at the stops");
	return true;
}

bool run_lock_exposure(run *r, GError **error)
{
	r->metering = false;
	struct camera_controls controls = photos_controls(r->photos);
	if (!(r->controls_known ? photos_use_controls(r->photos, &controls, error)
				: photos_settle_exposure(r->photos, error)))
		return false;
	controls = photos_controls(r->photos);
	g_autofree char *text = mark_lock_text(&controls);
	return pump_mark(&r->pump, text, error) && (!r->options.hdr || try_exposures(r, error));
}

/* ---- in passing ---- */

static double front_now(const run *r)
{
	return stage_track_angle_rad(stream_stage(r->pump.stream), head_now_ns(r->pump.head));
}

/* Those that the pass did not bring: first on from where the stage stands, then from the start. */
static bool take_in_passing(run *r, GError **error)
{
	for (int tries = 0; tries < ROUNDS && !r->pump.camera_gone; tries++) {
		double first, next;
		if (!photos_next(r->photos, 0, &first))
			return true;
		if (tries == 0 && photos_next(r->photos, front_now(r) + REACH_RAD, &next))
			first = next;
		if (!run_go(r, first - REACH_RAD, r->pace.travel_rad_s, error) ||
			!run_go(r, 2 * G_PI, r->pace.photo_rad_s, error))
			return false;
	}
	return true;
}

/* ---- at stops ---- */

/* From behind, so that the gear's slack lies on the side where it was before. */
static bool go_to_stop(run *r, double front_rad, GError **error)
{
	return (front_now(r) <= front_rad - REACH_RAD ||
		       run_go(r, front_rad - REACH_RAD, r->pace.travel_rad_s, error)) &&
	       run_go(r, front_rad, r->pace.travel_rad_s, error);
}

static bool mark_stop(run *r, const struct exposures *e, GError **error)
{
	g_autofree char *text = mark_stop_text(e);
	return pump_mark(&r->pump, text, error);
}

/* What is lost, or comes with other controls, is asked for again. */
static bool expose_all(run *r, GError **error)
{
	int64_t end_ns = head_now_ns(r->pump.head) + STOP_PATIENCE_NS, now_ns;
	for (int lacks; (lacks = photos_lacks(r->photos)) >= 0 && !r->pump.camera_gone;) {
		if ((now_ns = head_now_ns(r->pump.head)) >= end_ns)
			return true;
		if (!photos_expose(r->photos, (uint32_t)lacks, now_ns, error))
			return false;
		while (photos_is_waiting(r->photos, head_now_ns(r->pump.head)) &&
			!r->pump.camera_gone)
			if (!pump_turn(&r->pump, head_now_ns(r->pump.head) + SECOND_NS / 4, error))
				return false;
	}
	return true;
}

/* The second mark comes before the stage moves: what is late then belongs to no stop. */
static bool stop_at(run *r, double front_rad, GError **error)
{
	return go_to_stop(r, front_rad, error) && pump_for(&r->pump, CALM_NS, error) &&
	       mark_stop(r, &r->exposures, error) && expose_all(r, error) &&
	       mark_stop(r, &(struct exposures){ 0 }, error);
}

static bool take_at_stops(run *r, GError **error)
{
	for (int round = 0; round < ROUNDS_AT_STOPS; round++) {
		double next = 0;
		while (!r->pump.camera_gone && photos_next(r->photos, next, &next)) {
			if (!stop_at(r, next, error))
				return false;
			next += DEGREE;
		}
	}
	return true;
}

bool run_take_photos(run *r, GError **error)
{
	run_say(r, r->exposures.count > 1 ? "taking photos in several exposures" : "taking photos");
	return r->options.hdr ? take_at_stops(r, error) : take_in_passing(r, error);
}
