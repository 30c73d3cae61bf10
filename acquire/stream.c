#include "acquire/stream.h"
#include "acquire/clock.h"
#include "acquire/driver.h"
#include "acquire/frames.h"
#include "acquire/manifest.h"
#include "acquire/marks.h"
#include <json-glib/json-glib.h>
#include <math.h>
#include <string.h>

/* Live, lines wait for the stage's pulses no longer than this many revolutions: some 25 s at 40 Hz, in
 * which a stage that only knows its index slots has passed the next one. */
#define PENDING_MAX 1024
/* A record is what somebody wrote. No clock runs for thirty years; beyond, sums of times overflow.
 */
#define TIME_MAX_NS INT64_C(1000000000000000000)

struct timed_event {
	struct stage_event event;
	int64_t ticks; /* unwrapped; with STAGE_EVENT_HOST_CLOCK the host's time in nanoseconds */
};

/* One power-on of the head, from its RECORD_SESSION to the next. */
struct session {
	struct calibration calibration;
	const struct driver *driver;
	device_clock *stage_clock, *camera_clock;
	GPtrArray
		*lidar_clocks; /* one each time the lidar was plugged in, or began to count anew */
	GArray *stage_events;  /* of struct timed_event, in the first pass */
	stage_track *track;
	placement *place;
	struct camera_controls locked; /* of the photos; zeros until settled */
};

struct pending {
	struct scanline line;
	int64_t ticks;     /* unwrapped */
	uint32_t values[]; /* ranges, angles where they are uneven, intensities */
};

struct stream {
	enum stream_mode mode;
	bool learning;
	struct stream_sink sink;
	GPtrArray *sessions;
	struct session *session;
	guint session_at, plug_at; /* which comes next in the second pass */
	device_clock *lidar_clock;
	decoder *decode;
	frames *frames;
	struct exposures stop; /* at which the stage stands; count 0: at none */
	bool has_stops;
	GQueue pending;
	int64_t asked_clock_ns; /* 0: not asked */
	int64_t lidar_delay_ns; /* what its stamps are late beyond what its clock knows */
	/* Of the last whole revolution. */
	bool follows;
	uint32_t last_counter, epoch;
	int64_t last_ticks, last_arrival_ns;
	double last_front_rad;
	uint32_t lost_before; /* revolutions lost since, waiting for an angle */
	GArray *losses;
	struct stream_report report;
};

static void session_free(gpointer data)
{
	struct session *s = data;
	device_clock_free(s->stage_clock);
	device_clock_free(s->camera_clock);
	g_ptr_array_unref(s->lidar_clocks);
	g_array_unref(s->stage_events);
	stage_track_free(s->track);
	placement_free(s->place);
	g_free(s);
}

stream *stream_new(enum stream_mode mode, const struct stream_sink *sink)
{
	stream *s = g_new0(stream, 1);
	s->mode = mode;
	s->learning = mode == STREAM_LEARN_FIRST;
	s->sink = *sink;
	s->sessions = g_ptr_array_new_with_free_func(session_free);
	s->losses = g_array_new(FALSE, FALSE, sizeof(struct stream_loss));
	s->frames = frames_new();
	return s;
}

static void drop_pending(stream *s)
{
	for (struct pending *p; (p = g_queue_pop_head(&s->pending));)
		g_free(p);
}

void stream_free(stream *s)
{
	if (!s)
		return;
	drop_pending(s);
	decoder_free(s->decode);
	frames_free(s->frames);
	g_ptr_array_unref(s->sessions);
	g_array_unref(s->losses);
	g_free(s);
}

/* ---- scanlines ---- */

static void note_losses(stream *s, double front_rad)
{
	if (s->lost_before) {
		struct stream_loss loss = { s->last_front_rad, front_rad, s->lost_before };
		g_array_append_val(s->losses, loss);
		s->lost_before = 0;
	}
	s->last_front_rad = front_rad;
}

static bool place(stream *s, const struct scanline *line, int64_t ticks, bool force)
{
	int64_t first_ns, last_ns;
	int64_t stamp_ns = device_clock_host_ns(s->lidar_clock, (double)ticks) - s->lidar_delay_ns;
	placement_sweep(line, s->session->driver->stamp, stamp_ns, &first_ns, &last_ns);
	stage_track *track = s->session->track;
	bool known = !stage_track_is_moving(track) || stage_track_known_until_ns(track) >= last_ns;
	if (!known && !force)
		return false;
	/* Where the record was cut in the middle of a move nobody knows how far the stage went on.
	 */
	if (!known || !stage_track_is_homed(track)) {
		s->report.unplaced++;
		return true;
	}
	struct placed_line placed;
	placement_place(s->session->place, line, track, first_ns, last_ns, &placed);
	note_losses(s, placed.front_first_rad);
	if (line->device_error)
		s->report.device_errors++;
	else if (s->sink.line)
		s->sink.line(line, &placed, s->sink.user_data);
	return true;
}

static void place_pending(stream *s)
{
	for (struct pending *p; (p = g_queue_peek_head(&s->pending));) {
		if (!place(s, &p->line, p->ticks, g_queue_get_length(&s->pending) > PENDING_MAX))
			return;
		g_free(g_queue_pop_head(&s->pending));
	}
}

static void keep_pending(stream *s, const struct scanline *line, int64_t ticks)
{
	size_t n = line->beams;
	struct pending *p = g_malloc(sizeof *p + n * (2 * sizeof(uint32_t) + sizeof(uint16_t)));
	uint32_t *to = p->values;
	p->line = *line;
	p->ticks = ticks;
	p->line.range_mm = memcpy(to, line->range_mm, n * sizeof *to);
	to += n;
	if (line->angle_rad) {
		p->line.angle_rad = memcpy(to, line->angle_rad, n * sizeof *line->angle_rad);
		to += n;
	}
	if (line->intensity)
		p->line.intensity = memcpy(to, line->intensity, n * sizeof *line->intensity);
	g_queue_push_tail(&s->pending, p);
}

/* Time decides how many turns are missing; the counter tells a jump from a loss. */
static void count_losses(stream *s, const struct scanline *line, int64_t ticks)
{
	if (s->follows) {
		double period = s->session->driver->clock.ticks_hz / line->scan_rate_hz;
		int64_t turns = llround((double)(ticks - s->last_ticks) / period);
		uint16_t counted = (uint16_t)(line->counter - s->last_counter);
		bool jumped = line->counter != s->last_counter && counted != turns;
		s->report.counter_jumps += jumped;
		if (turns > 1) {
			s->lost_before += (uint32_t)MIN(turns - 1, 1000000);
			s->report.lost_revolutions += turns - 1;
		}
	}
	s->follows = true;
	s->last_counter = line->counter;
	s->last_ticks = ticks;
}

static void next_lidar_clock(stream *s)
{
	place_pending(s);
	drop_pending(s);
	if (s->learning || s->mode == STREAM_LIVE)
		g_ptr_array_add(
			s->session->lidar_clocks, device_clock_new(&s->session->driver->clock));
	if (s->plug_at < s->session->lidar_clocks->len)
		s->lidar_clock = s->session->lidar_clocks->pdata[s->plug_at++];
}

/* The device counts from somewhere else: what is missing in between, only the host can tell. */
static void begin_epoch(stream *s, const struct scanline *line)
{
	int64_t turns = llround(
		(double)(line->arrival_ns - s->last_arrival_ns) * 1e-9 * line->scan_rate_hz);
	if (s->follows && !s->learning && turns > 1) {
		s->lost_before += (uint32_t)MIN(turns - 1, 1000000);
		s->report.lost_revolutions += turns - 1;
	}
	s->follows = false;
	s->epoch = line->epoch;
	next_lidar_clock(s);
}

static void take_line(const struct scanline *line, gpointer user_data)
{
	stream *s = user_data;
	if (line->beams == 0 || line->scan_rate_hz <= 0 || !s->lidar_clock) {
		s->report.unplaced++;
		return;
	}
	if (line->epoch != s->epoch)
		begin_epoch(s, line);
	s->last_arrival_ns = line->arrival_ns;
	int64_t sent = device_clock_unwrap(s->lidar_clock, line->sent_ticks, line->arrival_ns);
	int64_t ticks = sent - (int64_t)((line->sent_ticks - line->ticks) & 0xffffffff);
	if (s->learning || s->mode == STREAM_LIVE)
		device_clock_add_arrival(s->lidar_clock, sent, line->arrival_ns);
	if (s->learning)
		return;
	s->report.revolutions++;
	count_losses(s, line, ticks);
	if (s->mode == STREAM_LIVE)
		keep_pending(s, line, ticks);
	else
		place(s, line, ticks, true);
}

static void take_reply(const struct lidar_reply *reply, gpointer user_data)
{
	stream *s = user_data;
	uint64_t ticks;
	if (s->asked_clock_ns && s->session->driver->clock_reply &&
		s->session->driver->clock_reply(reply, &ticks)) {
		int64_t unwrapped = device_clock_unwrap(s->lidar_clock, ticks, reply->arrival_ns);
		if (s->learning || s->mode == STREAM_LIVE)
			device_clock_add_exchange(
				s->lidar_clock, s->asked_clock_ns, unwrapped, reply->arrival_ns);
		s->asked_clock_ns = 0;
	}
	if (!s->learning && s->sink.reply)
		s->sink.reply(reply, s->sink.user_data);
}

/* ---- sessions ---- */

static void reset_decoder(stream *s)
{
	struct decoder_sink sink = { .scanline = take_line, .reply = take_reply, .user_data = s };
	if (s->decode) {
		const struct decoder_counts *counts = decoder_get_counts(s->decode);
		s->report.bad_telegrams += s->learning ? 0 : counts->bad_sums + counts->malformed;
	}
	decoder_free(s->decode);
	s->decode = decoder_new(s->session->driver->protocol, &sink);
	s->follows = false;
	s->epoch = 0;
	s->asked_clock_ns = 0;
}

static struct session *session_new(const struct record_entry *e, GError **error)
{
	g_autofree char *name = g_strdup_printf("entry %u (session)", e->sequence);
	g_autoptr(manifest) m = manifest_parse(e->payload, e->length, name, 0, error);
	const char *protocol = m ? manifest_get_string(m, "protocol", error) : NULL;
	JsonNode *node = m ? manifest_get_node(m, "calibration") : NULL;
	g_autofree char *text = node ? json_to_string(node, FALSE) : g_strdup("{}");
	struct session s = { 0 };
	if (!protocol || !calibration_parse(text, name, &s.calibration, error))
		return NULL;
	s.driver = driver_find(protocol);
	if (!s.driver) {
		g_set_error(error, G_FILE_ERROR, G_FILE_ERROR_INVAL,
			"%s: there is no lidar protocol '%s'", name, protocol);
		return NULL;
	}
	const struct stage_calibration *st = &s.calibration.stage;
	const struct camera_calibration *ca = &s.calibration.camera;
	s.stage_clock = device_clock_new(&(struct device_clock_desc){
		.ticks_hz = st->clock_hz, .wrap_bits = st->clock_bits });
	if (s.calibration.has_camera)
		s.camera_clock =
			device_clock_new(&(struct device_clock_desc){ .ticks_hz = ca->clock_hz,
				.wrap_bits = ca->clock_bits,
				.delay_ns = (int64_t)(ca->delay_us * 1000) });
	s.lidar_clocks = g_ptr_array_new_with_free_func((GDestroyNotify)device_clock_free);
	s.stage_events = g_array_new(FALSE, FALSE, sizeof(struct timed_event));
	s.track = stage_track_new(st->steps_per_turn, st->index_slots);
	s.place = placement_new(&s.calibration);
	return g_memdup2(&s, sizeof s);
}

static void set_stop(stream *s, const struct exposures *stop)
{
	if (s->stop.count == 0 && stop->count == 0)
		return;
	s->stop = *stop;
	s->has_stops = true;
	if (!s->learning && s->sink.stop)
		s->sink.stop(stop, s->sink.user_data);
}

static bool begin_session(stream *s, const struct record_entry *e, GError **error)
{
	place_pending(s);
	drop_pending(s);
	set_stop(s, &(struct exposures){ 0 });
	if (s->learning || s->mode == STREAM_LIVE) {
		struct session *fresh = session_new(e, error);
		if (!fresh)
			return false;
		g_ptr_array_add(s->sessions, fresh);
	}
	if (s->session_at >= s->sessions->len)
		return true;
	s->session = s->sessions->pdata[s->session_at++];
	s->plug_at = 0;
	s->lidar_clock = NULL;
	s->report.sessions++;
	reset_decoder(s);
	return true;
}

static void plug_lidar(stream *s)
{
	next_lidar_clock(s);
	reset_decoder(s);
}

/* ---- the other devices ---- */

/* Gives the track the events that have been kept, at the times that are known for them now. */
static void feed_track(struct session *session)
{
	for (guint i = 0; i < session->stage_events->len; i++) {
		const struct timed_event *t =
			&g_array_index(session->stage_events, struct timed_event, i);
		bool exact = t->event.flags & STAGE_EVENT_HOST_CLOCK;
		stage_track_feed(session->track, &t->event,
			exact ? t->ticks
			      : device_clock_host_ns(session->stage_clock, (double)t->ticks));
	}
	g_array_set_size(session->stage_events, 0);
}

/* Emergency stop, interlock, button and SYNC tell nothing of where the stage is. */
static bool is_motion(const struct stage_event *e)
{
	return e->kind <= STAGE_FAULT;
}

/* The low 32 bits of a microsecond near the arrival, whole again. */
static int64_t whole_host_ns(uint32_t low_us, int64_t arrival_ns)
{
	int64_t arrival_us = arrival_ns / 1000;
	return MAX(arrival_us + (int32_t)(low_us - (uint32_t)arrival_us), 0) * 1000;
}

static void keep_stage_event(
	struct session *session, const struct stage_event *event, int64_t arrival_ns)
{
	bool exact = event->flags & STAGE_EVENT_HOST_CLOCK;
	struct timed_event t = { *event,
		exact ? whole_host_ns(event->ticks, arrival_ns)
		      : device_clock_unwrap(session->stage_clock, event->ticks, arrival_ns) };
	g_array_append_val(session->stage_events, t);
}

/* The last of a batch waited least: only it says something of the delay, and it has to before the
 * others are timed. */
static void learn_stage_clock(struct session *session, guint first, int64_t arrival_ns)
{
	for (guint i = session->stage_events->len; i > first; i--) {
		const struct timed_event *t =
			&g_array_index(session->stage_events, struct timed_event, i - 1);
		if (t->event.flags & STAGE_EVENT_HOST_CLOCK)
			continue;
		device_clock_add_arrival(session->stage_clock, t->ticks, arrival_ns);
		return;
	}
}

static void take_stage(stream *s, const struct record_entry *e)
{
	const struct stage_event *events = e->payload;
	size_t n = e->length / sizeof *events;
	struct session *session = s->session;
	if (s->mode == STREAM_LEARN_FIRST && !s->learning)
		return; /* the second time the track is whole already */
	g_array_set_size(session->stage_events, s->learning ? session->stage_events->len : 0);
	guint first = session->stage_events->len;
	for (size_t i = 0; i < n; i++)
		if (is_motion(&events[i]))
			keep_stage_event(session, &events[i], e->time_ns);
	learn_stage_clock(session, first, e->time_ns);
	if (!s->learning)
		feed_track(session);
	place_pending(s);
}

/* The host's time of a frame's stamp. Where that is of the camera's own clock something is learnt of it: a frame cannot leave before its
 * exposure ends. */
static int64_t frame_stamp_ns(
	stream *s, const struct camera_frame_info *info, const struct record_entry *e)
{
	if (info->flags & CAMERA_HOST_CLOCK)
		return frames_host_ns(info->ticks, e->time_ns);
	device_clock *clock = s->session->camera_clock;
	int64_t ticks = device_clock_unwrap(clock, info->ticks, e->time_ns);
	int64_t least_ns = info->flags & CAMERA_STAMP_END
				   ? 0
				   : info->controls.exposure_100us * INT64_C(100000);
	if (s->learning || s->mode == STREAM_LIVE)
		device_clock_add_arrival(clock, ticks, e->time_ns - least_ns);
	return s->learning ? 0 : device_clock_host_ns(clock, (double)ticks);
}

static void take_frame(stream *s, const struct record_entry *e)
{
	struct camera_frame_info info, made;
	if (!s->session->camera_clock || e->length < sizeof info)
		return;
	memcpy(&info, e->payload, sizeof info);
	int64_t stamp_ns = frame_stamp_ns(s, &info, e);
	if (s->learning)
		return;
	const struct camera_calibration *c = &s->session->calibration.camera;
	const uint8_t *pixels =
		info.width == c->width && info.height == c->height
			? frames_nv12(s->frames, &info, (const uint8_t *)e->payload + sizeof info,
				  e->length - sizeof info, &made)
			: NULL;
	if (!pixels) {
		s->report.bad_frames++;
		return;
	}
	double front = stage_track_angle_rad(
		s->session->track, stamp_ns + frames_middle_ns(&info, c->readout_us));
	bool locked = memcmp(&info.controls, &s->session->locked, sizeof info.controls) == 0;
	if (s->has_stops && s->mode == STREAM_LEARN_FIRST && s->stop.count == 0)
		locked = false; /* came too late, while the stage went on */
	if (s->sink.frame)
		s->sink.frame(&made, pixels, front, locked, s->sink.user_data);
}

static void take_mark(stream *s, const struct record_entry *e)
{
	struct mark mark = mark_read(e->payload, e->length);
	if (mark.pauses)
		s->follows = false;
	if (mark.locks)
		s->session->locked = mark.locked;
	if (mark.stops)
		set_stop(s, &mark.stop);
}

static void take_output(stream *s, const struct record_entry *e)
{
	if (s->session->driver->asks_clock && s->session->driver->asks_clock(e->payload, e->length))
		s->asked_clock_ns = e->time_ns;
}

bool stream_feed(stream *s, const struct record_entry *e, GError **error)
{
	if (e->time_ns < 0 || e->time_ns > TIME_MAX_NS) {
		g_set_error(error, G_FILE_ERROR, G_FILE_ERROR_INVAL,
			"entry %u: its time cannot be: %" G_GINT64_FORMAT " ns", e->sequence,
			e->time_ns);
		return false;
	}
	if (e->kind == RECORD_SESSION)
		return begin_session(s, e, error);
	if (!s->session)
		return true;
	switch (e->kind) {
	case RECORD_LIDAR_OPENED: plug_lidar(s); break;
	case RECORD_LIDAR_IN:
		decoder_feed(s->decode, e->payload, e->length, e->time_ns);
		place_pending(s);
		break;
	case RECORD_LIDAR_OUT: take_output(s, e); break;
	case RECORD_STAGE: take_stage(s, e); break;
	case RECORD_FRAME: take_frame(s, e); break;
	case RECORD_MARK: take_mark(s, e); break;
	case RECORD_END: s->report.ended = true; break;
	default: break;
	}
	return true;
}

void stream_rewind(stream *s)
{
	for (guint i = 0; i < s->sessions->len; i++)
		feed_track(s->sessions->pdata[i]);
	s->learning = false;
	s->stop = (struct exposures){ 0 };
	s->session = NULL;
	s->session_at = 0;
	/* Or what it refused would be counted once more. */
	g_clear_pointer(&s->decode, decoder_free);
	s->report = (struct stream_report){ 0 };
	s->lost_before = 0;
	g_array_set_size(s->losses, 0);
}

void stream_advance_lidar(stream *s, int64_t delay_ns)
{
	s->lidar_delay_ns = delay_ns;
}

struct stream_report stream_get_report(const stream *s)
{
	struct stream_report r = s->report;
	if (s->decode) {
		const struct decoder_counts *counts = decoder_get_counts(s->decode);
		r.bad_telegrams += counts->bad_sums + counts->malformed;
	}
	if (s->lidar_clock)
		r.drift_ppm = device_clock_drift_ppm(s->lidar_clock);
	for (guint i = 0; i < s->sessions->len; i++) {
		g_autoptr(GArray) suspects =
			stage_track_suspects(((struct session *)s->sessions->pdata[i])->track);
		r.suspect_intervals += suspects->len;
	}
	return r;
}

const struct stream_report *stream_counts(const stream *s)
{
	return &s->report;
}

GArray *stream_losses(const stream *s)
{
	return g_array_copy(s->losses);
}

const struct calibration *stream_calibration(const stream *s)
{
	return s->session ? &s->session->calibration : NULL;
}

const char *stream_protocol(const stream *s)
{
	return s->session ? s->session->driver->protocol : "";
}

const struct lidar_identity *stream_lidar(const stream *s)
{
	return s->decode ? decoder_identity(s->decode) : NULL;
}

stage_track *stream_stage(const stream *s)
{
	return s->session ? s->session->track : NULL;
}
