#include "acquire/driver.h"
#include "acquire/marks.h"
#include "acquire/run-private.h"
#include <math.h>

#define SECOND_NS INT64_C(1000000000)
#define DEGREE    (G_PI / 180)
/* Gaps nearer than this are passed over in one go: stopping and running up again takes longer. */
#define JOIN_RAD (4 * DEGREE)
/* Times that the lidar may fail in one scan before it is given up. */
#define RECOVERIES_MAX 25
/* Revolutions with the device's own error mark before it is restarted. */
#define DEVICE_ERRORS_MAX 3

/* Just before home is the end of the second half. */
static coverage *face_coverage(run *r, const struct placed_line *placed)
{
	double half_turns = (placed->front_first_rad + placed->front_last_rad) / 2 / G_PI;
	return r->coverage[r->faces == 2 && remainder(floor(half_turns), 2) != 0];
}

static double columns_done(const run *r)
{
	double sum = 0;
	for (uint32_t i = 0; i < r->faces; i++)
		sum += coverage_fraction(r->coverage[i]) / r->faces;
	return sum;
}

static void take_line(
	const struct scanline *line, const struct placed_line *placed, gpointer user_data)
{
	run *r = user_data;
	(void)line;
	if (placed->turn_rad < 0 || !placement_is_usable(placed, r->options.preset->columns))
		return;
	coverage_add(face_coverage(r, placed), placed->azimuth_rad, placed->elevation_rad,
		placed->beams);
	panorama_add(r->preview, placed->azimuth_rad, placed->elevation_rad, placed->range_m,
		placed->intensity, placed->beams);
}

static void take_reply(const struct lidar_reply *reply, gpointer user_data)
{
	run *r = user_data;
	if (!r->recalling)
		pump_take_reply(&r->pump, reply);
}

void run_say(run *r, const char *what)
{
	g_free(r->doing);
	r->doing = g_strdup(what);
}

/* Homing, the pass and the photos take about these shares of the time: at stops they take more. */
static double fraction_done(run *r)
{
	double columns = columns_done(r);
	uint32_t wanted = photos_wanted(r->photos);
	double photos_done = wanted ? (double)photos_taken(r->photos) / wanted : columns;
	double share = r->options.hdr ? 0.5 : 0.25;
	double f = 0.05 * (columns > 0 || r->streaming) + (0.95 - share) * columns +
		   share * photos_done;
	return r->seen_fraction = fmax(r->seen_fraction, fmin(f, 1));
}

static bool report_progress(run *r, GError **error)
{
	if (!r->options.progress)
		return true;
	struct run_progress p = { .fraction = fraction_done(r),
		.column_fraction = columns_done(r),
		.photos_taken = photos_taken(r->photos),
		.photos_wanted = photos_wanted(r->photos),
		.doing = r->doing,
		.preview = r->preview };
	if (!r->options.progress(&p, r->options.user_data))
		return true;
	g_set_error(error, PUMP_ERROR, PUMP_ERROR_STOPPED, "the scan was stopped");
	return false;
}

/* A lidar that streams says something each turn; sixteen turns of silence, and at least a second,
 * are a stall. */
static bool check_lidar(run *r, GError **error)
{
	if (!r->streaming)
		return true;
	double rate = stream_lidar(r->pump.stream)->scan_rate_hz;
	int64_t patience_ns = (int64_t)(fmax(1.0, 16 / fmax(rate, 1)) * SECOND_NS);
	if (head_now_ns(r->pump.head) - r->pump.last_bytes_ns > patience_ns) {
		g_set_error(error, PUMP_ERROR, PUMP_ERROR_NO_ANSWER, "the lidar has fallen silent");
		return false;
	}
	if (stream_counts(r->pump.stream)->device_errors > r->device_errors + DEVICE_ERRORS_MAX) {
		g_set_error(error, PUMP_ERROR, PUMP_ERROR_REFUSED,
			"the lidar reports an error of its own");
		return false;
	}
	return true;
}

/* An operator at the scanner; of a head that is only looked at it means nothing. */
static bool check_button(run *r, GError **error)
{
	if (!r->pump.button || !r->scanning)
		return true;
	g_set_error_literal(error, PUMP_ERROR, PUMP_ERROR_STOPPED,
		"the scan was paused by the scanner's button");
	return false;
}

static bool serve_camera(run *r, GError **error)
{
	if (r->pump.camera_gone)
		return true;
	int64_t now_ns = head_now_ns(r->pump.head);
	if (r->metering)
		return r->controls_known || photos_meter(r->photos, now_ns, error);
	stage_track *track = stream_stage(r->pump.stream);
	return !r->steady || !stage_track_is_homed(track) || !stage_track_is_moving(track) ||
	       photos_watch(r->photos, stage_track_angle_rad(track, now_ns), now_ns, error);
}

static bool each_turn(gpointer user_data, GError **error)
{
	run *r = user_data;
	return check_button(r, error) && check_lidar(r, error) &&
	       (!stream_stage(r->pump.stream) || serve_camera(r, error)) &&
	       report_progress(r, error);
}

run *run_new(head *h, const struct run_options *options)
{
	run *r = g_new0(run, 1);
	const struct preset *preset = options->preset;
	struct panorama_desc fine = panorama_desc_for(preset->columns, preset->rows);
	struct panorama_desc coarse =
		panorama_desc_for(MIN(preset->columns, 1000), MIN(preset->rows, 264));
	struct stream_sink sink = { .line = take_line,
		.frame = run_take_frame,
		.reply = take_reply,
		.stop = run_take_stop,
		.user_data = r };
	r->options = *options;
	r->faces = preset->both_faces ? 2 : 1;
	for (uint32_t i = 0; i < r->faces; i++)
		r->coverage[i] = coverage_new(&fine);
	r->preview = panorama_new(&coarse, NULL);
	r->photos = photos_new(h->camera, preset->photos, options->hdr);
	r->pump = (struct pump){ .head = h,
		.stream = stream_new(STREAM_LIVE, &sink),
		.driver = driver_find(h->lidar_protocol),
		.each_turn = each_turn,
		.user_data = r };
	run_say(r, "starting");
	return r;
}

void run_free(run *r)
{
	if (!r)
		return;
	pump_clear(&r->pump);
	stream_free(r->pump.stream);
	coverage_free(r->coverage[0]);
	coverage_free(r->coverage[1]);
	panorama_free(r->preview);
	photos_free(r->photos);
	g_free(r->doing);
	g_free(r);
}

bool run_recall(run *r, const struct record_entry *entry, GError **error)
{
	r->recalling = true;
	bool good = stream_feed(r->pump.stream, entry, error);
	r->recalling = false;
	return good;
}

bool run_begin(run *r, const struct record_entry *session, GError **error)
{
	if (r->pump.driver)
		return stream_feed(r->pump.stream, session, error);
	g_set_error(error, PUMP_ERROR, PUMP_ERROR_REFUSED,
		"there is no driver for lidars that speak '%s'", r->pump.head->lidar_protocol);
	return false;
}

bool run_prepare(run *r, GError **error)
{
	if (!pump_open_lidar(&r->pump, error) || !pump_prepare_lidar(&r->pump, error))
		return false;
	r->pace = preset_pace(r->options.preset, run_lidar(r)->scan_rate_hz);
	return true;
}

const struct calibration *run_calibration(const run *r)
{
	return stream_calibration(r->pump.stream);
}

struct prediction run_predict(const run *r)
{
	return preset_predict(r->options.preset, r->options.hdr, r->pump.driver, run_lidar(r),
		run_calibration(r));
}

const struct lidar_identity *run_lidar(const run *r)
{
	return stream_lidar(r->pump.stream);
}

/* ---- the stage ---- */

static double steps_per_rad(const run *r)
{
	return stream_calibration(r->pump.stream)->stage.steps_per_turn / (2 * G_PI);
}

static struct stage_move move_to(const run *r, double angle_rad, double rate_rad_s)
{
	return (struct stage_move){ .target_steps = llround(stage_track_steps_at(
					    stream_stage(r->pump.stream), angle_rad)),
		.rate_steps_s = rate_rad_s * steps_per_rad(r),
		.acceleration_steps_s2 = r->pace.acceleration_rad_s2 * steps_per_rad(r) };
}

bool run_go(run *r, double angle_rad, double rate_rad_s, GError **error)
{
	struct stage_move move = move_to(r, angle_rad, rate_rad_s);
	r->steady = rate_rad_s <= fmax(r->pace.photo_rad_s, r->pace.scan_rad_s);
	return pump_move(&r->pump, &move, error);
}

/* Always clockwise, so that slack in the gear lies on the same side each time. The camera meters on
 * the way. */
static bool home(run *r, GError **error)
{
	struct stage_move move = move_to(r, 2.2 * G_PI, r->pace.home_rad_s);
	stage_track *track = stream_stage(r->pump.stream);
	run_say(r, "finding the home position");
	r->metering = true;
	if (!pump_start_move(&r->pump, &move, error))
		return false;
	while (!stage_track_is_homed(track) && !r->pump.stage_stopped)
		if (!pump_turn(&r->pump, head_now_ns(r->pump.head) + SECOND_NS / 4, error))
			return false;
	if (!stage_track_is_homed(track)) {
		g_set_error(error, PUMP_ERROR, PUMP_ERROR_STAGE,
			"the pan stage turned once round and did not find its home position");
		return false;
	}
	if (!r->pump.stage_stopped && !stage_stop(r->pump.head->stage, error))
		return false;
	while (!r->pump.stage_stopped)
		if (!pump_turn(&r->pump, head_now_ns(r->pump.head) + SECOND_NS / 4, error))
			return false;
	return run_lock_exposure(r, error);
}

/* ---- passes ---- */

static bool start_lidar(run *r, GError **error)
{
	if (!pump_start_lidar(&r->pump, error))
		return false;
	r->pump.last_bytes_ns = head_now_ns(r->pump.head);
	r->device_errors = stream_counts(r->pump.stream)->device_errors;
	r->streaming = true;
	return true;
}

/* Coverage counts azimuths, the stage turns from home. */
static bool pass(run *r, uint32_t face, const struct front_interval *f, GError **error)
{
	double zero = run_calibration(r)->stage.azimuth_zero_rad - face * G_PI;
	double ahead = f->from_rad - zero - r->pace.run_up_rad;
	double beyond = f->to_rad - zero + r->pace.run_up_rad;
	/* From behind, so that the gear's slack is taken up before the first column. */
	return run_go(r, ahead, r->pace.travel_rad_s, error) &&
	       run_go(r, beyond, r->pace.scan_rad_s, error);
}

/* The beams of an interval in which the stage slipped lie in wrong places: they do not count. */
static void forget_suspects(run *r)
{
	stage_track *track = stream_stage(r->pump.stream);
	double zero = run_calibration(r)->stage.azimuth_zero_rad;
	g_autoptr(GArray) suspects = stage_track_suspects(track);
	for (; r->suspects < suspects->len; r->suspects++) {
		const struct stage_suspect *s =
			&g_array_index(suspects, struct stage_suspect, r->suspects);
		double a = stage_track_angle_rad(track, s->from_ns),
		       b = stage_track_angle_rad(track, s->to_ns);
		double slack = fabs(s->error_rad);
		for (uint32_t k = 0; k < r->faces; k++)
			coverage_clear(r->coverage[k], zero + fmin(a, b) - slack,
				zero + fmax(a, b) + slack);
	}
}

static bool pass_over_missing(run *r, GError **error)
{
	for (uint32_t face = 0; face < r->faces; face++) {
		g_autoptr(GArray) missing = coverage_missing(r->coverage[face], JOIN_RAD);
		for (guint i = 0; i < missing->len; i++)
			if (!pass(r, face, &g_array_index(missing, struct front_interval, i),
				    error))
				return false;
	}
	return true;
}

/* What a lidar may come back from; all else ends the run. */
static bool can_recover(const GError *e)
{
	return g_error_matches(e, PUMP_ERROR, PUMP_ERROR_LIDAR_GONE) ||
	       g_error_matches(e, PUMP_ERROR, PUMP_ERROR_NO_ANSWER) ||
	       g_error_matches(e, PUMP_ERROR, PUMP_ERROR_REFUSED);
}

static bool revive(run *r, GError **error)
{
	return (r->pump.lidar_open || pump_open_lidar(&r->pump, error)) &&
	       pump_prepare_lidar(&r->pump, error) && start_lidar(r, error);
}

/* Ramps the stage down and waits for it, whatever else is wrong; what the lidar says meanwhile does not matter. */
static bool halt(run *r, GError **error)
{
	int64_t deadline_ns = head_now_ns(r->pump.head) + 3 * SECOND_NS;
	r->pump.stage_stopped = false;
	if (!stage_stop(r->pump.head->stage, error))
		return false;
	while (!r->pump.stage_stopped && stage_track_is_moving(stream_stage(r->pump.stream)) &&
		head_now_ns(r->pump.head) < deadline_ns) {
		g_autoptr(GError) failed = NULL;
		if (pump_turn(&r->pump, head_now_ns(r->pump.head) + SECOND_NS / 4, &failed) ||
			can_recover(failed))
			continue;
		g_propagate_error(error, g_steal_pointer(&failed));
		return false;
	}
	return true;
}

/* Stops the stage and tries to get the lidar back: by talking to it, then by plugging anew, until
 * patience ends. */
static bool recover(run *r, const GError *cause, GError **error)
{
	double patience_s = r->options.wait_for_lidar_s > 0 ? r->options.wait_for_lidar_s : 60;
	int64_t deadline_ns = head_now_ns(r->pump.head) + (int64_t)(patience_s * SECOND_NS);
	g_autofree char *words = g_strdup_printf("waiting: %s", cause->message);
	run_say(r, words);
	r->streaming = false;
	if (++r->recoveries > RECOVERIES_MAX) {
		g_set_error(error, PUMP_ERROR, PUMP_ERROR_NO_ANSWER, "%s, time and again",
			cause->message);
		return false;
	}
	if (!halt(r, error))
		return false;
	for (;;) {
		g_autoptr(GError) failed = NULL;
		if (revive(r, &failed))
			return true;
		if (!can_recover(failed) || head_now_ns(r->pump.head) >= deadline_ns) {
			g_propagate_error(error, g_steal_pointer(&failed));
			return false;
		}
		if (r->pump.lidar_open)
			wire_close(r->pump.head->lidar);
		r->pump.lidar_open = false;
		if (!pump_for(&r->pump, SECOND_NS, error))
			return false;
	}
}

static void say_pass(run *r, uint32_t turn)
{
	g_autofree char *words =
		g_strdup_printf("going back for %u columns", run_missing_columns(r));
	run_say(r, turn ? words : "scanning");
}

/* The scan is whole by then: what the lidar may come back from costs nothing any more. Takes the
 * error. */
static bool forgive(GError *failed, GError **error)
{
	if (failed && !can_recover(failed)) {
		g_propagate_error(error, failed);
		return false;
	}
	g_clear_error(&failed);
	return true;
}

/* All that was wanted is there: a lidar that does not answer any more is woken once, which stops it too, and a scan is not lost for it. */
static bool quieten_lidar(run *r, GError **error)
{
	g_autoptr(GError) deaf = NULL, lost = NULL;
	if (pump_stop_lidar(&r->pump, &deaf))
		return true;
	if (can_recover(deaf) && r->pump.lidar_open && pump_prepare_lidar(&r->pump, &lost))
		return true;
	GError *why = lost ? g_steal_pointer(&lost) : g_steal_pointer(&deaf);
	return forgive(why, error);
}

static bool scan_columns(run *r, GError **error)
{
	if (run_missing_columns(r) == 0)
		return true;
	if (!start_lidar(r, error))
		return false;
	for (uint32_t turn = 0;
		turn <= r->options.preset->rescans_max && run_missing_columns(r) > 0;) {
		g_autoptr(GError) failed = NULL;
		say_pass(r, turn);
		bool passed = pass_over_missing(r, &failed);
		forget_suspects(r);
		turn += passed;
		if (passed)
			continue;
		if (can_recover(failed) && recover(r, failed, error))
			continue;
		if (error && !*error)
			g_propagate_error(error, g_steal_pointer(&failed));
		return false;
	}
	r->streaming = false;
	return quieten_lidar(r, error);
}

static bool look_back(run *r, GError **error)
{
	GError *failed = NULL;
	stage_track *track = stream_stage(r->pump.stream);
	double here = stage_track_angle_rad(track, stage_track_known_until_ns(track));
	g_autofree char *pause = mark_pause_text();
	if (!pump_mark(&r->pump, pause, error))
		return false;
	if (start_lidar(r, &failed) &&
		run_go(r, fmax(here - r->pace.look_rad, 0), r->pace.look_rad_s, &failed) &&
		run_go(r, 0, r->pace.travel_rad_s, &failed))
		pump_stop_lidar(&r->pump, &failed);
	r->streaming = false;
	return forgive(failed, error);
}

/* On the way the lidar looks at everything once more, backwards, first slowly: that tells how late
 * its stamps are (lidar-delay.h). */
static bool go_home(run *r, GError **error)
{
	run_say(r, "going home");
	return (!r->pump.lidar_open || look_back(r, error)) &&
	       run_go(r, 0, r->pace.travel_rad_s, error);
}

/* Whatever ended it: the stage comes to rest, and the laser is told to stop, as far as they still listen. */
static void leave_safe(run *r)
{
	r->pump.each_turn = NULL; /* which would only say again what ends it */
	halt(r, NULL);
	if (r->pump.lidar_open)
		pump_stop_lidar(&r->pump, NULL);
	r->streaming = false;
}

bool run_scan(run *r, GError **error)
{
	r->pump.button = false;
	r->scanning = true;
	bool good = home(r, error) && scan_columns(r, error) && run_take_photos(r, error) &&
		    go_home(r, error);
	r->scanning = false;
	if (!good)
		leave_safe(r);
	return good;
}

const panorama *run_preview(const run *r)
{
	return r->preview;
}

uint32_t run_missing_columns(const run *r)
{
	uint32_t missing = 0;
	for (uint32_t i = 0; i < r->faces; i++)
		missing += coverage_missing_columns(r->coverage[i]);
	return missing;
}

struct stream_report run_report(const run *r)
{
	return stream_get_report(r->pump.stream);
}

struct camera_controls run_camera_controls(const run *r)
{
	return photos_controls(r->photos);
}
