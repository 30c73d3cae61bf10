/* The simulator's head: three devices behind one link. What arrives is sorted into a queue per
 * device; each read takes from its queue, each wait fills them. */
#include "firmware-io/head.h"
#include "sim/link.h"
#include <errno.h>
#include <gio/gio.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <time.h>
#include <unistd.h>

/* A simulator that says nothing for this long of real time is taken for hung. */
#define ANSWER_TIMEOUT_MS 60000
/* Messages that nobody reads must not eat the memory. */
#define QUEUE_MESSAGES_MAX 65536

struct message {
	struct link_header header;
	uint8_t payload[];
};

struct sim_head {
	head base;
	wire lidar;
	stage stage;
	camera camera;
	GSubprocess *process; /* NULL when the simulator runs elsewhere */
	int fd;
	bool real_time;
	int64_t now_ns;
	GByteArray *received;                          /* bytes of messages not yet whole */
	GQueue lidar_queue, stage_queue, camera_queue; /* of struct message */
	size_t lidar_taken;   /* bytes of the first lidar message already read */
	struct message *lent; /* to the caller of a stage or camera read */
	bool lidar_answered, lidar_present, camera_gone;
	bool pressed, open, latched; /* as the simulated stage has it, as far as it was read */
	GArray *events;
};

static int64_t monotonic_ns(void)
{
	struct timespec t;
	clock_gettime(CLOCK_MONOTONIC, &t);
	return t.tv_sec * INT64_C(1000000000) + t.tv_nsec;
}

static int64_t sim_now_ns(head *h)
{
	struct sim_head *s = (struct sim_head *)h;
	return s->real_time ? monotonic_ns() : s->now_ns;
}

static bool lost(GError **error, const char *what)
{
	g_set_error(error, WIRE_ERROR, WIRE_ERROR_BROKEN, "the simulated head is lost: %s", what);
	return false;
}

static bool send_message(struct sim_head *s, enum link_kind kind, int64_t host_ns,
	const void *payload, size_t length, GError **error)
{
	struct link_header header = { .length = length, .kind = kind, .host_ns = host_ns };
	g_autofree uint8_t *bytes = g_malloc(sizeof header + length);
	memcpy(bytes, &header, sizeof header);
	if (length)
		memcpy(bytes + sizeof header, payload, length);
	for (size_t sent = 0; sent < sizeof header + length;) {
		ssize_t n = send(s->fd, bytes + sent, sizeof header + length - sent, MSG_NOSIGNAL);
		if (n < 0 && errno == EINTR)
			continue;
		if (n <= 0)
			return lost(error, "its power is off");
		sent += n;
	}
	return true;
}

static void enqueue(GQueue *queue, const struct link_header *header, const uint8_t *payload)
{
	struct message *m = g_malloc(sizeof *m + header->length);
	m->header = *header;
	memcpy(m->payload, payload, header->length);
	g_queue_push_tail(queue, m);
	if (g_queue_get_length(queue) > QUEUE_MESSAGES_MAX) {
		g_warning("the simulated head: nobody reads; the oldest message is dropped");
		g_free(g_queue_pop_head(queue));
	}
}

/* Takes one message in. true when it was LINK_NOW. */
static bool take_message(
	struct sim_head *s, const struct link_header *header, const uint8_t *payload)
{
	switch (header->kind) {
	case LINK_LIDAR_BYTES:
		if (header->length && s->lidar_present)
			enqueue(&s->lidar_queue, header, payload);
		break;
	case LINK_STAGE_EVENTS: enqueue(&s->stage_queue, header, payload); break;
	case LINK_CAMERA_FRAME: enqueue(&s->camera_queue, header, payload); break;
	case LINK_CAMERA_GONE: s->camera_gone = true; break;
	case LINK_LIDAR_GONE:
	case LINK_LIDAR_OPENED:
		s->lidar_answered = true;
		s->lidar_present = header->kind == LINK_LIDAR_OPENED;
		break;
	default: break;
	}
	s->now_ns = MAX(s->now_ns, header->host_ns);
	return header->kind == LINK_NOW;
}

/* Takes all whole messages that have been received; true when LINK_NOW was among them. */
static bool take_received(struct sim_head *s, bool *ret_closed, GError **error)
{
	size_t at = 0;
	struct link_header header;
	*ret_closed = false;
	while (!*ret_closed && s->received->len - at >= sizeof header) {
		memcpy(&header, s->received->data + at, sizeof header);
		if (header.length > LINK_PAYLOAD_MAX)
			return lost(error, "it sent a message of an impossible size");
		if (s->received->len - at - sizeof header < header.length)
			break;
		*ret_closed = take_message(s, &header, s->received->data + at + sizeof header);
		at += sizeof header + header.length;
	}
	g_byte_array_remove_range(s->received, 0, at);
	return true;
}

/* Reads once from the socket; waits up to timeout_ms for it. ret_got = false on time-out. */
static bool receive(struct sim_head *s, int timeout_ms, bool *ret_got, GError **error)
{
	uint8_t bytes[65536];
	struct pollfd p = { .fd = s->fd, .events = POLLIN };
	int ready;
	*ret_got = false;
	/* A signal (Ctrl-C) is the caller's business, at the end of the turn. */
	do
		ready = poll(&p, 1, timeout_ms);
	while (ready < 0 && errno == EINTR);
	if (ready == 0)
		return true;
	ssize_t n = recv(s->fd, bytes, sizeof bytes, 0);
	if (n <= 0)
		return lost(error, "its power is off");
	g_byte_array_append(s->received, bytes, n);
	*ret_got = true;
	return true;
}

static bool anything_queued(const struct sim_head *s)
{
	return s->lidar_queue.length || s->stage_queue.length || s->camera_queue.length;
}

static bool wait_virtual(struct sim_head *s, int64_t deadline_ns, GError **error)
{
	if (anything_queued(s))
		return true;
	if (!send_message(s, LINK_WAIT, deadline_ns, NULL, 0, error))
		return false;
	for (bool closed = false, got; !closed;) {
		if (!receive(s, ANSWER_TIMEOUT_MS, &got, error))
			return false;
		if (!got)
			return lost(error, "it has not answered for a minute");
		if (!take_received(s, &closed, error))
			return false;
	}
	return true;
}

static bool wait_real(struct sim_head *s, int64_t deadline_ns, GError **error)
{
	bool got, closed;
	while (!anything_queued(s) && monotonic_ns() < deadline_ns) {
		int64_t left_ms = (deadline_ns - monotonic_ns() + 999999) / 1000000;
		if (!receive(s, CLAMP(left_ms, 0, 1000), &got, error))
			return false;
		if (got && !take_received(s, &closed, error))
			return false;
		if (s->lidar_answered)
			break;
	}
	return true;
}

static bool sim_wait(head *h, int64_t deadline_ns, GError **error)
{
	struct sim_head *s = (struct sim_head *)h;
	return s->real_time ? wait_real(s, deadline_ns, error)
			    : wait_virtual(s, deadline_ns, error);
}

static void clear_queue(GQueue *queue)
{
	for (struct message *m; (m = g_queue_pop_head(queue));)
		g_free(m);
}

static void sim_close(head *h)
{
	struct sim_head *s = (struct sim_head *)h;
	if (s->fd >= 0)
		close(s->fd);
	if (s->process)
		g_subprocess_wait(s->process, NULL, NULL);
	g_clear_object(&s->process);
	clear_queue(&s->lidar_queue);
	clear_queue(&s->stage_queue);
	clear_queue(&s->camera_queue);
	g_free(s->lent);
	g_array_unref(s->events);
	g_byte_array_unref(s->received);
	g_free(s);
}

static bool lidar_open(wire *w, GError **error)
{
	struct sim_head *s = (struct sim_head *)w->head;
	int64_t deadline_ns = sim_now_ns(w->head) + 2 * INT64_C(1000000000);
	s->lidar_answered = false;
	s->lidar_taken = 0;
	clear_queue(&s->lidar_queue);
	if (!send_message(s, LINK_LIDAR_OPEN, 0, NULL, 0, error))
		return false;
	while (!s->lidar_answered && sim_now_ns(w->head) < deadline_ns)
		if (!sim_wait(w->head, deadline_ns, error))
			return false;
	if (s->lidar_present)
		return true;
	g_set_error(error, WIRE_ERROR, WIRE_ERROR_GONE,
		"the lidar is not there: check its plug and its power");
	return false;
}

static gssize lidar_read(wire *w, void *bytes, size_t size, int64_t *ret_arrival_ns, GError **error)
{
	struct sim_head *s = (struct sim_head *)w->head;
	struct message *m = g_queue_peek_head(&s->lidar_queue);
	if (!m && !s->lidar_present) {
		g_set_error(error, WIRE_ERROR, WIRE_ERROR_GONE, "the lidar was unplugged");
		return -1;
	}
	if (!m)
		return 0;
	size_t n = MIN(size, m->header.length - s->lidar_taken);
	memcpy(bytes, m->payload + s->lidar_taken, n);
	*ret_arrival_ns = m->header.host_ns;
	s->lidar_taken += n;
	if (s->lidar_taken == m->header.length) {
		g_free(g_queue_pop_head(&s->lidar_queue));
		s->lidar_taken = 0;
	}
	return n;
}

static bool lidar_write(wire *w, const void *bytes, size_t length, GError **error)
{
	return send_message((struct sim_head *)w->head, LINK_LIDAR_WRITE, 0, bytes, length, error);
}

/* What has come and will not be read must go, or no wait would ever sleep again. */
static void lidar_close(wire *w)
{
	struct sim_head *s = (struct sim_head *)w->head;
	clear_queue(&s->lidar_queue);
	s->lidar_taken = 0;
	s->lidar_present = false;
	send_message((struct sim_head *)w->head, LINK_LIDAR_CLOSE, 0, NULL, 0, NULL);
}

static bool lidar_set_line(wire *w, const struct wire_line *line, GError **error)
{
	struct link_line m = { line->baud, line->dtr };
	return send_message((struct sim_head *)w->head, LINK_LIDAR_LINE, 0, &m, sizeof m, error);
}

static const struct wire_ops lidar_ops = { .open = lidar_open,
	.read = lidar_read,
	.write = lidar_write,
	.close = lidar_close,
	.set_line = lidar_set_line };

static bool refuse(GError **error, enum stage_error code, const char *text)
{
	g_set_error_literal(error, STAGE_ERROR, code, text);
	return false;
}

static bool stage_move_sim(stage *st, const struct stage_move *move, GError **error)
{
	struct sim_head *s = (struct sim_head *)st->head;
	if (s->pressed)
		return refuse(error, STAGE_ERROR_ESTOP, "the emergency stop is pressed");
	if (s->open)
		return refuse(error, STAGE_ERROR_INTERLOCK, "the interlock is open");
	if (s->latched)
		return refuse(error, STAGE_ERROR_NOT_RESET,
			"the stage was stopped for safety, and was not reset since");
	struct link_stage_move m = { move->target_steps, move->rate_steps_s,
		move->acceleration_steps_s2 };
	return send_message((struct sim_head *)st->head, LINK_STAGE_MOVE, 0, &m, sizeof m, error);
}

static bool stage_stop_sim(stage *st, GError **error)
{
	return send_message((struct sim_head *)st->head, LINK_STAGE_STOP, 0, NULL, 0, error);
}

static bool stage_reset_sim(stage *st, GError **error)
{
	struct sim_head *s = (struct sim_head *)st->head;
	if (s->pressed)
		return refuse(error, STAGE_ERROR_ESTOP,
			"the emergency stop is still pressed: release it first");
	if (s->open)
		return refuse(error, STAGE_ERROR_INTERLOCK,
			"the interlock is still open: close it first");
	s->latched = false;
	return send_message(s, LINK_STAGE_RESET, 0, NULL, 0, error);
}

static void note_guards(struct sim_head *s, enum stage_event_kind kind)
{
	if (kind == STAGE_ESTOP_PRESSED || kind == STAGE_ESTOP_RELEASED)
		s->pressed = kind == STAGE_ESTOP_PRESSED;
	if (kind == STAGE_INTERLOCK_OPENED || kind == STAGE_INTERLOCK_CLOSED)
		s->open = kind == STAGE_INTERLOCK_OPENED;
	s->latched |= s->pressed || s->open;
}

static gssize stage_read_sim(
	stage *st, const struct stage_event **ret_events, int64_t *ret_arrival_ns, GError **error)
{
	struct sim_head *s = (struct sim_head *)st->head;
	static const enum stage_event_kind kinds[] = { [LINK_STAGE_STEP] = STAGE_STEP,
		[LINK_STAGE_INDEX] = STAGE_INDEX,
		[LINK_STAGE_HOME] = STAGE_HOME,
		[LINK_STAGE_STOPPED] = STAGE_STOPPED,
		[LINK_STAGE_FAULT] = STAGE_FAULT,
		[LINK_STAGE_ESTOP_PRESSED] = STAGE_ESTOP_PRESSED,
		[LINK_STAGE_ESTOP_RELEASED] = STAGE_ESTOP_RELEASED,
		[LINK_STAGE_INTERLOCK_OPENED] = STAGE_INTERLOCK_OPENED,
		[LINK_STAGE_INTERLOCK_CLOSED] = STAGE_INTERLOCK_CLOSED };
	(void)error;
	g_autofree struct message *m = g_queue_pop_head(&s->stage_queue);
	if (!m)
		return 0;
	g_array_set_size(s->events, 0);
	for (size_t at = 0; at + sizeof(struct link_stage_event) <= m->header.length;
		at += sizeof(struct link_stage_event)) {
		struct link_stage_event e;
		memcpy(&e, m->payload + at, sizeof e);
		if (e.kind >= G_N_ELEMENTS(kinds))
			continue;
		struct stage_event event = {
			.ticks = e.ticks_us, .direction = e.direction, .kind = kinds[e.kind]
		};
		note_guards(s, event.kind);
		g_array_append_val(s->events, event);
	}
	*ret_events = (const struct stage_event *)(void *)s->events->data;
	*ret_arrival_ns = m->header.host_ns;
	return s->events->len;
}

static const struct stage_ops stage_sim_ops = { .move = stage_move_sim,
	.stop = stage_stop_sim,
	.read = stage_read_sim,
	.reset = stage_reset_sim };

static bool camera_set_sim(camera *c, const struct camera_controls *controls, GError **error)
{
	struct link_camera_controls m = { controls->exposure_100us, controls->gain_percent,
		controls->white_balance_k };
	return send_message(
		(struct sim_head *)c->head, LINK_CAMERA_CONTROLS, 0, &m, sizeof m, error);
}

static bool camera_queue_sim(camera *c, GError **error)
{
	return send_message((struct sim_head *)c->head, LINK_CAMERA_QUEUE, 0, NULL, 0, error);
}

static int camera_read_sim(camera *c, struct camera_frame_info *ret_info,
	const uint8_t **ret_pixels, size_t *ret_bytes, int64_t *ret_arrival_ns, GError **error)
{
	struct sim_head *s = (struct sim_head *)c->head;
	struct link_frame f;
	g_free(s->lent);
	s->lent = g_queue_pop_head(&s->camera_queue);
	if (!s->lent && s->camera_gone) {
		g_set_error(error, WIRE_ERROR, WIRE_ERROR_GONE, "the camera was unplugged");
		return -1;
	}
	if (!s->lent || s->lent->header.length < sizeof f)
		return 0;
	memcpy(&f, s->lent->payload, sizeof f);
	*ret_info = (struct camera_frame_info){ .ticks = f.ticks_us,
		.sequence = f.sequence,
		.flags = f.flags,
		.fourcc = CAMERA_FOURCC_NV12,
		.width = f.width,
		.height = f.height,
		.controls = { f.exposure_100us, f.gain_percent, f.white_balance_k } };
	*ret_pixels = s->lent->payload + sizeof f;
	*ret_bytes = s->lent->header.length - sizeof f;
	*ret_arrival_ns = s->lent->header.host_ns;
	return 1;
}

static const struct camera_ops camera_sim_ops = {
	.set_controls = camera_set_sim, .queue = camera_queue_sim, .read = camera_read_sim
};

static const struct head_ops sim_ops = {
	.now_ns = sim_now_ns, .wait = sim_wait, .close = sim_close
};

/* The simulator speaks first. */
static bool read_hello(struct sim_head *s, GError **error)
{
	struct link_header header;
	struct link_hello hello;
	bool got;
	for (;;) {
		if (s->received->len >= sizeof header) {
			memcpy(&header, s->received->data, sizeof header);
			if (header.kind != LINK_HELLO || header.length < sizeof hello ||
				header.length > LINK_PAYLOAD_MAX)
				return lost(error, "it does not speak the link's protocol");
			if (s->received->len >= sizeof header + header.length)
				break;
		}
		if (!receive(s, ANSWER_TIMEOUT_MS, &got, error))
			return false;
		if (!got)
			return lost(error, "it has not answered for a minute");
	}
	memcpy(&hello, s->received->data + sizeof header, sizeof hello);
	if (hello.version != LINK_VERSION)
		return lost(
			error, "its link is of another version; build both from the same source");
	s->real_time = hello.real_time;
	s->now_ns = header.host_ns;
	s->base.lidar_protocol = g_strndup(hello.lidar_protocol, sizeof hello.lidar_protocol);
	s->base.calibration =
		g_strndup((const char *)s->received->data + sizeof header + sizeof hello,
			header.length - sizeof hello);
	g_byte_array_remove_range(s->received, 0, sizeof header + header.length);
	return true;
}

head *head_open_link(int fd, GError **error)
{
	struct sim_head *s = g_new0(struct sim_head, 1);
	*s = (struct sim_head){ .base = { .ops = &sim_ops,
					.lidar = &s->lidar,
					.stage = &s->stage,
					.camera = &s->camera },
		.lidar = { &lidar_ops, &s->base },
		.stage = { &stage_sim_ops, &s->base },
		.camera = { &camera_sim_ops, &s->base },
		.fd = fd,
		.received = g_byte_array_new(),
		.events = g_array_new(FALSE, FALSE, sizeof(struct stage_event)) };
	if (read_hello(s, error))
		return &s->base;
	head_close(&s->base);
	return NULL;
}

/* pleinair-sim stands beside the program that runs, or on the PATH. */
static char *find_simulator(void)
{
	g_autofree char *self = g_file_read_link("/proc/self/exe", NULL);
	g_autofree char *folder = g_path_get_dirname(self ? self : ".");
	g_autofree char *beside = g_build_filename(folder, "pleinair-sim", NULL);
	if (g_file_test(beside, G_FILE_TEST_IS_EXECUTABLE))
		return g_steal_pointer(&beside);
	return g_find_program_in_path("pleinair-sim");
}

/* A description that it does not like, the simulator says on stderr and leaves. */
static void add_complaint(GSubprocess *process, GError **error)
{
	g_autofree char *said = NULL;
	if (!g_subprocess_communicate_utf8(process, NULL, NULL, NULL, &said, NULL) || !said ||
		!*g_strstrip(said))
		return;
	g_clear_error(error);
	const char *text =
		g_str_has_prefix(said, "pleinair-sim: ") ? said + strlen("pleinair-sim: ") : said;
	g_set_error_literal(error, WIRE_ERROR, WIRE_ERROR_BROKEN, text);
}

/* A simulator that listens already (pleinair-sim --listen). */
static head *head_open_socket(const char *path, GError **error)
{
	struct sockaddr_un address = { .sun_family = AF_UNIX };
	int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
	g_strlcpy(address.sun_path, path, sizeof address.sun_path);
	if (fd >= 0 && strlen(path) < sizeof address.sun_path &&
		connect(fd, (struct sockaddr *)&address, sizeof address) == 0)
		return head_open_link(fd, error);
	g_set_error(error, WIRE_ERROR, WIRE_ERROR_GONE,
		"device 'sim:%s': no simulator listens there: %s", path, g_strerror(errno));
	if (fd >= 0)
		close(fd);
	return NULL;
}

/* Ctrl-C on the terminal is for the scan, which then ends in order; the simulator ends when its
 * link closes. */
static void leave_terminal_group(gpointer unused)
{
	(void)unused;
	setpgid(0, 0);
}

head *head_open_sim(const char *description, GError **error)
{
	int ends[2];
	if (description[0] == '/')
		return head_open_socket(description, error);
	g_autofree char *program = find_simulator();
	if (!program) {
		g_set_error(error, WIRE_ERROR, WIRE_ERROR_BROKEN,
			"device 'sim:': the program pleinair-sim is not installed");
		return NULL;
	}
	if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) < 0) {
		g_set_error(error, WIRE_ERROR, WIRE_ERROR_BROKEN, "device 'sim:': no socket: %s",
			g_strerror(errno));
		return NULL;
	}
	g_autoptr(GSubprocessLauncher) launcher =
		g_subprocess_launcher_new(G_SUBPROCESS_FLAGS_STDERR_PIPE);
	g_subprocess_launcher_set_child_setup(launcher, leave_terminal_group, NULL, NULL);
	g_subprocess_launcher_take_fd(launcher, ends[1], 3);
	g_autoptr(GSubprocess) process = g_subprocess_launcher_spawn(
		launcher, error, program, "--fd", "3", description, NULL);
	g_clear_object(&launcher); /* closes our copy of the simulator's end */
	if (!process) {
		close(ends[0]);
		return NULL;
	}
	head *h = head_open_link(ends[0], error);
	if (h)
		((struct sim_head *)h)->process = g_steal_pointer(&process);
	else
		add_complaint(process, error);
	return h;
}
