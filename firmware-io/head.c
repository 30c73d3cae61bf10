#include "firmware-io/head.h"
#include "firmware-io/parts.h"
#include <string.h>

G_DEFINE_QUARK(wire - error - quark, wire_error)
G_DEFINE_QUARK(stage - error - quark, stage_error)

/* What opens a head whose URI begins so; whole: it takes all of the URI, not what follows the colon. */
static const struct {
	const char *scheme;
	head *(*open)(const char *rest, GError **error);
	bool whole;
} schemes[] = {
	{ "sim", head_open_sim },
	{ "replay", head_open_replay },
	{ "tim", head_open_parts, true },
	{ "scip", head_open_parts, true },
	{ "ld", head_open_parts, true },
	{ "rplidar", head_open_parts, true },
};

head *head_open(const char *uri, GError **error)
{
	const char *colon = strchr(uri, ':');
	for (size_t i = 0; colon && i < G_N_ELEMENTS(schemes); i++)
		if (strlen(schemes[i].scheme) == (size_t)(colon - uri) &&
			g_str_has_prefix(uri, schemes[i].scheme))
			return schemes[i].open(schemes[i].whole ? uri : colon + 1, error);
	g_set_error(error, WIRE_ERROR, WIRE_ERROR_BROKEN,
		"device '%s': is none of sim:SCENE, replay:FILE, tim:, scip:, scip:PORT, ld:PORT, "
		"rplidar:PORT",
		uri);
	return NULL;
}

int64_t head_now_ns(head *h)
{
	return h->ops->now_ns(h);
}

bool head_wait(head *h, int64_t deadline_ns, GError **error)
{
	if (h->record_error) {
		g_propagate_error(error, g_steal_pointer(&h->record_error));
		return false;
	}
	return h->ops->wait(h, deadline_ns, error);
}

void head_attach_record(head *h, record_writer *record)
{
	h->record = record;
}

void head_close(head *h)
{
	if (!h)
		return;
	g_clear_error(&h->record_error);
	g_clear_pointer(&h->lidar_protocol, g_free);
	g_clear_pointer(&h->calibration, g_free);
	h->ops->close(h);
}

void head_tap(head *h, enum record_kind kind, int64_t time_ns, const void *part1, size_t length1,
	const void *part2, size_t length2)
{
	if (h->record && !h->record_error)
		record_write(
			h->record, kind, time_ns, part1, length1, part2, length2, &h->record_error);
}

bool wire_open(wire *w, GError **error)
{
	if (!w->ops->open(w, error))
		return false;
	head_tap(w->head, RECORD_LIDAR_OPENED, head_now_ns(w->head), NULL, 0, NULL, 0);
	return true;
}

gssize wire_read(wire *w, void *bytes, size_t size, int64_t *ret_arrival_ns, GError **error)
{
	gssize n = w->ops->read(w, bytes, size, ret_arrival_ns, error);
	if (n > 0)
		head_tap(w->head, RECORD_LIDAR_IN, *ret_arrival_ns, bytes, n, NULL, 0);
	else if (n < 0)
		head_tap(w->head, RECORD_LIDAR_GONE, head_now_ns(w->head), NULL, 0, NULL, 0);
	return n;
}

bool wire_write(wire *w, const void *bytes, size_t length, GError **error)
{
	head_tap(w->head, RECORD_LIDAR_OUT, head_now_ns(w->head), bytes, length, NULL, 0);
	return w->ops->write(w, bytes, length, error);
}

void wire_close(wire *w)
{
	w->ops->close(w);
}

bool wire_set_line(wire *w, const struct wire_line *line, GError **error)
{
	return !w->ops->set_line || w->ops->set_line(w, line, error);
}

struct wire_counts wire_count(wire *w)
{
	struct wire_counts c = { 0 };
	if (w->ops->count)
		w->ops->count(w, &c);
	return c;
}

bool stage_start_move(stage *s, const struct stage_move *move, GError **error)
{
	return s->ops->move(s, move, error);
}

bool stage_stop(stage *s, GError **error)
{
	return s->ops->stop(s, error);
}

bool stage_reset(stage *s, GError **error)
{
	return !s->ops->reset || s->ops->reset(s, error);
}

void stage_show_emitting(stage *s, bool emitting)
{
	if (s->ops->emitting)
		s->ops->emitting(s, emitting);
}

gssize stage_read(
	stage *s, const struct stage_event **ret_events, int64_t *ret_arrival_ns, GError **error)
{
	gssize n = s->ops->read(s, ret_events, ret_arrival_ns, error);
	if (n > 0)
		head_tap(s->head, RECORD_STAGE, *ret_arrival_ns, *ret_events,
			n * sizeof **ret_events, NULL, 0);
	return n;
}

bool camera_set_controls(camera *c, const struct camera_controls *controls, GError **error)
{
	return c->ops->set_controls(c, controls, error);
}

void camera_get_controls(camera *c, struct camera_controls *controls)
{
	if (c->ops->get_controls)
		c->ops->get_controls(c, controls);
}

uint32_t camera_longest_exposure_100us(camera *c)
{
	uint32_t longest = c->ops->longest_exposure_100us ? c->ops->longest_exposure_100us(c) : 0;
	return MAX(longest, CAMERA_THIRTIETH_100US);
}

bool camera_queue(camera *c, GError **error)
{
	return c->ops->queue(c, error);
}

int camera_read(camera *c, struct camera_frame_info *ret_info, const uint8_t **ret_pixels,
	size_t *ret_bytes, int64_t *ret_arrival_ns, GError **error)
{
	int n = c->ops->read(c, ret_info, ret_pixels, ret_bytes, ret_arrival_ns, error);
	if (n > 0)
		head_tap(c->head, RECORD_FRAME, *ret_arrival_ns, ret_info, sizeof *ret_info,
			*ret_pixels, *ret_bytes);
	else if (n < 0 && !c->gone)
		head_tap(c->head, RECORD_CAMERA_GONE, head_now_ns(c->head), NULL, 0, NULL, 0);
	c->gone = n < 0;
	return n;
}
