/* A recorded head: replay:FILE plays the first session of a record, replay:FILE?session=N the Nth.
 * What the host writes is taken and forgotten; the lidar's answers come as they came then. Time
 * jumps from entry to entry. After the last entry the lidar is gone for good. */
#include "firmware-io/head.h"
#include <json-glib/json-glib.h>
#include <stdlib.h>
#include <string.h>

#define SESSION_BRACKETS_MAX 1000

struct replay_head {
	head base;
	wire lidar;
	stage stage;
	camera camera;
	record_reader *reader;
	int64_t now_ns;
	struct record_entry next; /* valid while !ended */
	size_t taken;             /* bytes of a lidar entry already read */
	bool offered;             /* the entry has been due for a whole turn */
	bool ended;
	bool lidar_gone, camera_gone;
};

static bool is_output(const struct record_entry *e)
{
	return e->kind == RECORD_LIDAR_OUT || e->kind == RECORD_MARK;
}

/* Goes to the next entry that the host would see. A new session ends the play. */
static bool advance(struct replay_head *r, GError **error)
{
	r->taken = 0;
	r->offered = false;
	do {
		switch (record_next(r->reader, &r->next, error)) {
		case RECORD_BAD: return false;
		case RECORD_CUT:
		case RECORD_AT_END: r->ended = true; return true;
		case RECORD_ENTRY: break;
		}
		r->ended = r->next.kind == RECORD_SESSION || r->next.kind == RECORD_END;
	} while (!r->ended && is_output(&r->next));
	return true;
}

static bool is_due(const struct replay_head *r, enum record_kind kind)
{
	return !r->ended && r->next.kind == kind && r->next.time_ns <= r->now_ns;
}

static int64_t replay_now_ns(head *h)
{
	return ((struct replay_head *)h)->now_ns;
}

static bool pass_over(struct replay_head *r, GError **error)
{
	if (r->next.kind == RECORD_LIDAR_GONE || r->next.kind == RECORD_LIDAR_OPENED)
		r->lidar_gone = r->next.kind == RECORD_LIDAR_GONE;
	return advance(r, error);
}

static bool replay_wait(head *h, int64_t deadline_ns, GError **error)
{
	struct replay_head *r = (struct replay_head *)h;
	bool due = !r->ended && r->next.time_ns <= r->now_ns;
	/* The reader of an entry may have had its turn before the entry became the next one: it
	 * gets another. What nobody reads then (a frame, when the program has no camera) must not
	 * stop the play. */
	if (due && !r->offered) {
		r->offered = true;
		return true;
	}
	if (due && !pass_over(r, error))
		return false;
	if (r->ended)
		r->lidar_gone = true;
	else
		r->offered = r->next.time_ns <= deadline_ns;
	r->now_ns = r->ended ? MAX(r->now_ns, deadline_ns)
			     : MAX(r->now_ns, MIN(r->next.time_ns, deadline_ns));
	return true;
}

static void replay_close(head *h)
{
	struct replay_head *r = (struct replay_head *)h;
	record_reader_free(r->reader);
	g_free(r);
}

static bool replay_lidar_open(wire *w, GError **error)
{
	struct replay_head *r = (struct replay_head *)w->head;
	if (r->ended) {
		g_set_error(error, WIRE_ERROR, WIRE_ERROR_GONE, "the record has ended");
		return false;
	}
	while (is_due(r, RECORD_LIDAR_GONE))
		if (!pass_over(r, error))
			return false;
	/* The record knows when it could be opened; an attempt before that failed then, too. */
	if (!r->ended && r->next.kind == RECORD_LIDAR_OPENED) {
		r->now_ns = MAX(r->now_ns, r->next.time_ns);
		if (!pass_over(r, error))
			return false;
	}
	if (r->lidar_gone)
		g_set_error(error, WIRE_ERROR, WIRE_ERROR_GONE, "the lidar was unplugged");
	return !r->lidar_gone;
}

static gssize replay_lidar_read(
	wire *w, void *bytes, size_t size, int64_t *ret_arrival_ns, GError **error)
{
	struct replay_head *r = (struct replay_head *)w->head;
	if (is_due(r, RECORD_LIDAR_GONE))
		r->lidar_gone = true;
	if (r->lidar_gone) {
		g_set_error(error, WIRE_ERROR, WIRE_ERROR_GONE,
			r->ended ? "the record has ended" : "the lidar was unplugged");
		return -1;
	}
	if (!is_due(r, RECORD_LIDAR_IN))
		return 0;
	size_t n = MIN(size, r->next.length - r->taken);
	memcpy(bytes, (const uint8_t *)r->next.payload + r->taken, n);
	*ret_arrival_ns = r->next.time_ns;
	r->taken += n;
	if (r->taken == r->next.length && !advance(r, error))
		return -1;
	return n;
}

static bool replay_lidar_write(wire *w, const void *bytes, size_t length, GError **error)
{
	(void)w, (void)bytes, (void)length, (void)error;
	return true;
}

static void replay_lidar_close(wire *w)
{
	(void)w;
}

static bool replay_stage_move(stage *s, const struct stage_move *move, GError **error)
{
	(void)s, (void)move, (void)error;
	return true;
}

static bool replay_stage_stop(stage *s, GError **error)
{
	(void)s, (void)error;
	return true;
}

static gssize replay_stage_read(
	stage *s, const struct stage_event **ret_events, int64_t *ret_arrival_ns, GError **error)
{
	struct replay_head *r = (struct replay_head *)s->head;
	if (!is_due(r, RECORD_STAGE))
		return 0;
	*ret_events = r->next.payload;
	*ret_arrival_ns = r->next.time_ns;
	gssize n = r->next.length / sizeof(struct stage_event);
	return advance(r, error) ? n : -1;
}

static bool replay_camera_set(camera *c, const struct camera_controls *controls, GError **error)
{
	(void)c, (void)controls, (void)error;
	return true;
}

static bool replay_camera_queue(camera *c, GError **error)
{
	(void)c, (void)error;
	return true;
}

static int replay_camera_read(camera *c, struct camera_frame_info *ret_info,
	const uint8_t **ret_pixels, size_t *ret_bytes, int64_t *ret_arrival_ns, GError **error)
{
	struct replay_head *r = (struct replay_head *)c->head;
	if (is_due(r, RECORD_CAMERA_GONE)) {
		r->camera_gone = true;
		if (!advance(r, error))
			return -1;
	}
	/* It was back at the latest when it brought a frame. */
	r->camera_gone = r->camera_gone && !is_due(r, RECORD_FRAME);
	if (r->camera_gone) {
		g_set_error(error, WIRE_ERROR, WIRE_ERROR_GONE, "the camera was unplugged");
		return -1;
	}
	if (!is_due(r, RECORD_FRAME) || r->next.length < sizeof *ret_info)
		return 0;
	memcpy(ret_info, r->next.payload, sizeof *ret_info);
	*ret_pixels = (const uint8_t *)r->next.payload + sizeof *ret_info;
	*ret_bytes = r->next.length - sizeof *ret_info;
	*ret_arrival_ns = r->next.time_ns;
	return advance(r, error) ? 1 : -1;
}

static const struct wire_ops lidar_ops = { .open = replay_lidar_open,
	.read = replay_lidar_read,
	.write = replay_lidar_write,
	.close = replay_lidar_close };
static const struct stage_ops stage_ops = {
	.move = replay_stage_move, .stop = replay_stage_stop, .read = replay_stage_read
};
static const struct camera_ops camera_ops = {
	.set_controls = replay_camera_set, .queue = replay_camera_queue, .read = replay_camera_read
};
static const struct head_ops replay_ops = {
	.now_ns = replay_now_ns, .wait = replay_wait, .close = replay_close
};

/* JsonParser calls itself for each level, as deep as the text goes. */
static bool is_nested_too_deeply(const char *text, size_t length)
{
	int opened = 0; /* at most as deep as that, whatever closes */
	for (size_t i = 0; i < length && opened <= SESSION_BRACKETS_MAX; i++)
		opened += text[i] == '{' || text[i] == '[';
	return opened > SESSION_BRACKETS_MAX;
}

/* Takes protocol and calibration from a session's header; false: it has none. */
static bool read_session(struct replay_head *r, const struct record_entry *e)
{
	g_autoptr(JsonParser) parser = json_parser_new();
	if (is_nested_too_deeply(e->payload, e->length) ||
		!json_parser_load_from_data(parser, e->payload, e->length, NULL))
		return false;
	JsonNode *root = json_parser_get_root(parser);
	JsonObject *o = root && JSON_NODE_HOLDS_OBJECT(root) ? json_node_get_object(root) : NULL;
	JsonNode *protocol = o ? json_object_get_member(o, "protocol") : NULL,
		 *calibration = o ? json_object_get_member(o, "calibration") : NULL;
	if (!calibration || !protocol || !JSON_NODE_HOLDS_VALUE(protocol) ||
		json_node_get_value_type(protocol) != G_TYPE_STRING)
		return false;
	r->base.lidar_protocol = json_node_dup_string(protocol);
	r->base.calibration = json_to_string(calibration, FALSE);
	return true;
}

/* Leaves r->next on the entry after the wanted session's header and fills in what the header says.
 */
static bool find_session(struct replay_head *r, const char *path, uint32_t wanted, GError **error)
{
	struct record_entry e;
	enum record_result result;
	uint32_t session = 0;
	while ((result = record_next(r->reader, &e, error)) == RECORD_ENTRY) {
		if (e.kind != RECORD_SESSION || ++session < wanted)
			continue;
		if (!read_session(r, &e))
			break;
		r->now_ns = e.time_ns;
		return advance(r, error);
	}
	if (result != RECORD_BAD)
		g_set_error(error, WIRE_ERROR, WIRE_ERROR_BROKEN,
			"%s: holds no session %u to replay", path, wanted);
	return false;
}

head *head_open_replay(const char *rest, GError **error)
{
	g_autofree char *path = g_strdup(rest);
	char *query = strstr(path, "?session=");
	uint32_t session = query ? strtoul(query + strlen("?session="), NULL, 10) : 1;
	if (query)
		*query = '\0';
	g_autoptr(record_reader) reader = record_open(path, error);
	if (!reader)
		return NULL;
	struct replay_head *r = g_new0(struct replay_head, 1);
	*r = (struct replay_head){ .base = { .ops = &replay_ops,
					   .lidar = &r->lidar,
					   .stage = &r->stage,
					   .camera = &r->camera },
		.lidar = { &lidar_ops, &r->base },
		.stage = { &stage_ops, &r->base },
		.camera = { &camera_ops, &r->base },
		.reader = g_steal_pointer(&reader) };
	if (find_session(r, path, MAX(session, 1), error))
		return &r->base;
	head_close(&r->base);
	return NULL;
}
