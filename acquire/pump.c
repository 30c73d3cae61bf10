#include "acquire/pump.h"
#include "acquire/driver.h"
#include <string.h>

G_DEFINE_QUARK(pump - error - quark, pump_error)

/* Answers that nobody takes are old ones. */
#define REPLIES_MAX 64
#define SECOND_NS   INT64_C(1000000000)
/* One that only knows its index slots says nothing between two of them. */
#define SILENT_STAGE_NS (20 * SECOND_NS)

void pump_reply_free(pump_reply *r)
{
	if (!r)
		return;
	g_free(r->command);
	g_free(r->status);
	g_free(r->text);
	g_free(r);
}

void pump_clear(struct pump *p)
{
	for (pump_reply *r; (r = g_queue_pop_head(&p->replies));)
		pump_reply_free(r);
}

void pump_take_reply(struct pump *p, const struct lidar_reply *reply)
{
	pump_reply *r = g_new(pump_reply, 1);
	*r = (pump_reply){ reply->arrival_ns, g_strdup(reply->command), g_strdup(reply->status),
		g_strdup(reply->text) };
	g_queue_push_tail(&p->replies, r);
	if (g_queue_get_length(&p->replies) > REPLIES_MAX)
		pump_reply_free(g_queue_pop_head(&p->replies));
}

static bool feed(struct pump *p, enum record_kind kind, int64_t time_ns, const void *payload,
	size_t length, GError **error)
{
	struct record_entry e = {
		.kind = kind, .length = length, .time_ns = time_ns, .payload = payload
	};
	return stream_feed(p->stream, &e, error);
}

static bool lidar_is_gone(struct pump *p, GError *gone, GError **error)
{
	p->lidar_open = false;
	wire_close(p->head->lidar);
	bool for_now = g_error_matches(gone, WIRE_ERROR, WIRE_ERROR_GONE);
	if (for_now)
		g_set_error_literal(error, PUMP_ERROR, PUMP_ERROR_LIDAR_GONE, gone->message);
	else
		g_propagate_error(error, g_error_copy(gone));
	g_error_free(gone);
	return false;
}

bool pump_open_lidar(struct pump *p, GError **error)
{
	GError *gone = NULL;
	pump_clear(p);
	if (!wire_open(p->head->lidar, &gone))
		return lidar_is_gone(p, gone, error);
	p->lidar_open = true;
	p->heard = (struct sniff){ 0 };
	p->last_bytes_ns = head_now_ns(p->head);
	return feed(p, RECORD_LIDAR_OPENED, head_now_ns(p->head), NULL, 0, error);
}

bool pump_mark(struct pump *p, const char *text, GError **error)
{
	int64_t now_ns = head_now_ns(p->head);
	head_tap(p->head, RECORD_MARK, now_ns, text, strlen(text), NULL, 0);
	return feed(p, RECORD_MARK, now_ns, text, strlen(text), error);
}

static bool take_lidar(struct pump *p, GError **error)
{
	uint8_t bytes[32768];
	int64_t arrival_ns;
	GError *gone = NULL;
	gssize n = 0;
	while (p->lidar_open &&
		(n = wire_read(p->head->lidar, bytes, sizeof bytes, &arrival_ns, &gone)) > 0) {
		p->last_bytes_ns = arrival_ns;
		sniff_feed(&p->heard, bytes, (size_t)n);
		if (!feed(p, RECORD_LIDAR_IN, arrival_ns, bytes, n, error))
			return false;
	}
	return n < 0 ? lidar_is_gone(p, gone, error) : true;
}

/* Neither of them stands in the way: true. */
static bool is_safe(const struct pump *p, GError **error)
{
	if (p->pressed)
		g_set_error_literal(
			error, PUMP_ERROR, PUMP_ERROR_ESTOP, "the emergency stop is pressed");
	else if (p->open)
		g_set_error_literal(error, PUMP_ERROR, PUMP_ERROR_INTERLOCK,
			"the interlock is open: the cover is not closed");
	return !p->pressed && !p->open;
}

static void note_event(struct pump *p, const struct stage_event *e)
{
	switch (e->kind) {
	case STAGE_STOPPED: p->stage_stopped = true; break;
	case STAGE_FAULT: p->stage_fault = true; break;
	case STAGE_ESTOP_PRESSED: p->pressed = p->struck = true; break;
	case STAGE_ESTOP_RELEASED: p->pressed = false; break;
	case STAGE_INTERLOCK_OPENED: p->open = p->struck = true; break;
	case STAGE_INTERLOCK_CLOSED: p->open = false; break;
	case STAGE_BUTTON: p->button = true; break;
	default: break;
	}
}

static bool has_not_struck(struct pump *p, GError **error)
{
	if (!p->struck)
		return true;
	p->struck = false;
	if (is_safe(p, error)) /* opened and closed again meanwhile */
		g_set_error_literal(error, PUMP_ERROR, PUMP_ERROR_NOT_RESET,
			"the emergency stop or the interlock has stopped the scanner");
	return false;
}

static bool take_stage(struct pump *p, GError **error)
{
	const struct stage_event *events;
	int64_t arrival_ns;
	gssize n;
	while ((n = stage_read(p->head->stage, &events, &arrival_ns, error)) > 0) {
		for (gssize i = 0; i < n; i++)
			note_event(p, &events[i]);
		if (!feed(p, RECORD_STAGE, arrival_ns, events, n * sizeof *events, error))
			return false;
	}
	if (n == 0 && p->stage_fault) {
		p->stage_fault = false;
		g_set_error(error, PUMP_ERROR, PUMP_ERROR_STAGE,
			"the pan stage stopped by itself: is something in its way?");
		return false;
	}
	return n == 0 && has_not_struck(p, error);
}

static bool take_camera(struct pump *p, GError **error)
{
	struct camera_frame_info info;
	const uint8_t *pixels;
	size_t bytes;
	int64_t arrival_ns;
	int n = 0;
	g_autoptr(GError) gone = NULL;
	while (p->head->camera && (n = camera_read(p->head->camera, &info, &pixels, &bytes,
					   &arrival_ns, &gone)) > 0) {
		g_autofree uint8_t *payload = g_malloc(sizeof info + bytes);
		memcpy(payload, &info, sizeof info);
		memcpy(payload + sizeof info, pixels, bytes);
		if (!feed(p, RECORD_FRAME, arrival_ns, payload, sizeof info + bytes, error))
			return false;
	}
	/* A scan without colour is better than none; and a camera can come back. */
	p->camera_gone = n < 0;
	return true;
}

bool pump_turn(struct pump *p, int64_t deadline_ns, GError **error)
{
	/* The stage goes last: its pulses let waiting lines be placed. */
	return head_wait(p->head, deadline_ns, error) && take_lidar(p, error) &&
	       take_camera(p, error) && take_stage(p, error) &&
	       (!p->each_turn || p->each_turn(p->user_data, error));
}

bool pump_for(struct pump *p, int64_t duration_ns, GError **error)
{
	int64_t deadline_ns = head_now_ns(p->head) + duration_ns;
	while (head_now_ns(p->head) < deadline_ns)
		if (!pump_turn(p, deadline_ns, error))
			return false;
	return true;
}

bool pump_send(struct pump *p, const void *bytes, size_t length, GError **error)
{
	GError *gone = NULL;
	if (!feed(p, RECORD_LIDAR_OUT, head_now_ns(p->head), bytes, length, error))
		return false;
	return wire_write(p->head->lidar, bytes, length, &gone) || lidar_is_gone(p, gone, error);
}

pump_reply *pump_answer(struct pump *p, const char *command, int64_t timeout_ns, GError **error)
{
	int64_t deadline_ns = head_now_ns(p->head) + timeout_ns;
	for (;;) {
		for (pump_reply *r; (r = g_queue_pop_head(&p->replies));) {
			if (g_str_has_prefix(r->command, command))
				return r;
			pump_reply_free(r);
		}
		if (head_now_ns(p->head) >= deadline_ns)
			break;
		if (!pump_turn(p, deadline_ns, error))
			return NULL;
	}
	g_set_error(
		error, PUMP_ERROR, PUMP_ERROR_NO_ANSWER, "the lidar does not answer '%s'", command);
	return NULL;
}

bool pump_prepare_lidar(struct pump *p, GError **error)
{
	if (!p->driver->prepare(p, error))
		return false;
	stage_show_emitting(p->head->stage, false);
	return true;
}

bool pump_start_lidar(struct pump *p, GError **error)
{
	if (!is_safe(p, error))
		return false;
	stage_show_emitting(p->head->stage, true);
	return p->driver->start(p, error);
}

bool pump_stop_lidar(struct pump *p, GError **error)
{
	if (!p->driver->stop(p, error))
		return false;
	stage_show_emitting(p->head->stage, false);
	return true;
}

bool pump_error_is_safety(const GError *e)
{
	return g_error_matches(e, PUMP_ERROR, PUMP_ERROR_ESTOP) ||
	       g_error_matches(e, PUMP_ERROR, PUMP_ERROR_INTERLOCK) ||
	       g_error_matches(e, PUMP_ERROR, PUMP_ERROR_NOT_RESET);
}

/* Takes what the stage says. */
static bool is_refused(GError *refused, GError **error)
{
	static const enum pump_error codes[] = { [STAGE_ERROR_ESTOP] = PUMP_ERROR_ESTOP,
		[STAGE_ERROR_INTERLOCK] = PUMP_ERROR_INTERLOCK,
		[STAGE_ERROR_NOT_RESET] = PUMP_ERROR_NOT_RESET };
	if (refused->domain == STAGE_ERROR) {
		refused->code = (int)codes[refused->code];
		refused->domain = PUMP_ERROR;
	}
	g_propagate_error(error, refused);
	return false;
}

bool pump_reset_stage(stage *s, GError **error)
{
	GError *refused = NULL;
	return stage_reset(s, &refused) || is_refused(refused, error);
}

bool pump_start_move(struct pump *p, const struct stage_move *move, GError **error)
{
	GError *refused = NULL;
	p->stage_stopped = false;
	return stage_start_move(p->head->stage, move, &refused) || is_refused(refused, error);
}

bool pump_move(struct pump *p, const struct stage_move *move, GError **error)
{
	if (!pump_start_move(p, move, error))
		return false;
	int64_t silent_since_ns = head_now_ns(p->head), known_ns = INT64_MIN;
	while (!p->stage_stopped) {
		if (!pump_turn(p, head_now_ns(p->head) + SECOND_NS / 4, error))
			return false;
		stage_track *track = stream_stage(p->stream);
		int64_t now_known_ns = track ? stage_track_known_until_ns(track) : 0;
		if (now_known_ns != known_ns)
			silent_since_ns = head_now_ns(p->head);
		known_ns = now_known_ns;
		if (head_now_ns(p->head) - silent_since_ns > SILENT_STAGE_NS) {
			g_set_error(error, PUMP_ERROR, PUMP_ERROR_STAGE,
				"the pan stage does not move: check its motor supply");
			return false;
		}
	}
	return true;
}
