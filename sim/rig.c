#include "sim/rig.h"
#include <poll.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#define SECOND INT64_C(1000000000)

struct thread_args {
	struct rig *rig;
	int fd;
};

static gpointer serve(gpointer data)
{
	g_autofree struct thread_args *args = data;

	args->rig->good = sim_head_serve(args->fd, &args->rig->options, &args->rig->error);
	return NULL;
}

static bool receive_exactly(struct rig *rig, void *bytes, gsize length)
{
	for (gsize got = 0; got < length;) {
		ssize_t n = recv(rig->fd, (char *)bytes + got, length - got, 0);

		if (n <= 0)
			return false;
		got += (gsize)n;
	}
	g_byte_array_append(rig->all, bytes, (guint)length);
	return true;
}

static void take_hello(struct rig *rig, const GByteArray *payload)
{
	g_assert_cmpuint(payload->len, >, sizeof rig->hello);
	memcpy(&rig->hello, payload->data, sizeof rig->hello);
	rig->certificate = g_strndup(
		(const char *)payload->data + sizeof rig->hello, payload->len - sizeof rig->hello);
}

static void take(struct rig *rig, const struct link_header *header, GByteArray *payload)
{
	switch (header->kind) {
	case LINK_HELLO: take_hello(rig, payload); break;
	case LINK_LIDAR_BYTES:
		g_string_append_len(rig->lidar, (const char *)payload->data, payload->len);
		rig->lidar_ns = header->host_ns;
		rig->deliveries++;
		break;
	case LINK_LIDAR_OPENED: rig->opened++; break;
	case LINK_LIDAR_GONE: rig->unplugged++; break;
	case LINK_CAMERA_GONE: rig->camera_gone++; break;
	case LINK_STAGE_EVENTS:
		g_assert_cmpuint(payload->len % sizeof(struct link_stage_event), ==, 0);
		g_array_append_vals(
			rig->events, payload->data, payload->len / sizeof(struct link_stage_event));
		break;
	case LINK_CAMERA_FRAME:
		g_ptr_array_add(rig->frames, g_byte_array_ref(payload));
		g_array_append_val(rig->frame_ns, header->host_ns);
		break;
	case LINK_NOW:
	case LINK_LIDAR_HALTED:
	case LINK_STAGE_SLIPPED: break;
	default: g_assert_not_reached();
	}
	g_assert_true(rig->hello.real_time || header->host_ns >= rig->now_ns);
	rig->now_ns = MAX(rig->now_ns, header->host_ns);
}

/* The kind of the message that came, or 0 when the head hung up. */
static enum link_kind receive(struct rig *rig)
{
	struct link_header header;

	if (!receive_exactly(rig, &header, sizeof header)) {
		rig->gone = true;
		return 0;
	}
	g_autoptr(GByteArray) payload = g_byte_array_new();

	g_byte_array_set_size(payload, header.length);
	g_assert_true(receive_exactly(rig, payload->data, header.length));
	take(rig, &header, payload);
	return (enum link_kind)header.kind;
}

static void free_frame(gpointer frame)
{
	g_byte_array_unref(frame);
}

struct rig *rig_start(const struct sim_head_options *options)
{
	struct rig *rig = g_new0(struct rig, 1);
	struct thread_args *args = g_new0(struct thread_args, 1);
	int pair[2];

	g_assert_cmpint(socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair), ==, 0);
	rig->fd = pair[0];
	rig->options = *options;
	rig->all = g_byte_array_new();
	rig->lidar = g_string_new(NULL);
	rig->events = g_array_new(FALSE, FALSE, sizeof(struct link_stage_event));
	rig->frames = g_ptr_array_new_with_free_func(free_frame);
	rig->frame_ns = g_array_new(FALSE, FALSE, sizeof(int64_t));
	*args = (struct thread_args){ rig, pair[1] };
	rig->thread = g_thread_new("head", serve, args);
	receive(rig);
	return rig;
}

void rig_stop(struct rig *rig)
{
	if (!rig->thread)
		return;
	shutdown(rig->fd, SHUT_RDWR);
	g_thread_join(g_steal_pointer(&rig->thread));
}

void rig_free(struct rig *rig)
{
	rig_stop(rig);
	close(rig->fd);
	g_clear_error(&rig->error);
	g_free(rig->certificate);
	g_byte_array_unref(rig->all);
	g_string_free(rig->lidar, TRUE);
	g_array_unref(rig->events);
	g_ptr_array_unref(rig->frames);
	g_array_unref(rig->frame_ns);
	g_free(rig);
}

static void transmit(
	struct rig *rig, enum link_kind kind, int64_t host_ns, const void *payload, gsize length)
{
	struct link_header header = { (uint32_t)length, (uint32_t)kind, host_ns };

	send(rig->fd, &header, sizeof header, MSG_NOSIGNAL);
	if (length > 0)
		send(rig->fd, payload, length, MSG_NOSIGNAL);
}

void rig_send(struct rig *rig, enum link_kind kind, const void *payload, gsize length)
{
	transmit(rig, kind, 0, payload, length);
}

/* In real time the host sleeps by itself, and time is what the clock says. */
static bool wait_in_real_time(struct rig *rig, int64_t deadline_ns)
{
	struct pollfd waiting = { .fd = rig->fd, .events = POLLIN };
	int64_t left_ns = MAX(deadline_ns - g_get_monotonic_time() * 1000, 0);
	struct timespec timeout = { left_ns / SECOND, left_ns % SECOND };

	if (ppoll(&waiting, 1, &timeout, NULL) > 0)
		return receive(rig) != 0;
	rig->now_ns = MAX(rig->now_ns, deadline_ns);
	return true;
}

bool rig_wait(struct rig *rig, int64_t deadline_ns)
{
	enum link_kind kind;

	if (rig->hello.real_time)
		return wait_in_real_time(rig, deadline_ns);

	transmit(rig, LINK_WAIT, deadline_ns, NULL, 0);
	do
		kind = receive(rig);
	while (kind != LINK_NOW && kind != 0);
	return kind != 0;
}

void rig_run(struct rig *rig, double seconds)
{
	int64_t until_ns = rig->now_ns + (int64_t)(seconds * SECOND);

	while (rig->now_ns < until_ns && rig_wait(rig, until_ns))
		;
}

void rig_say(struct rig *rig, const char *text)
{
	rig_send(rig, LINK_LIDAR_WRITE, text, strlen(text));
}

bool rig_open(struct rig *rig)
{
	guint opened = rig->opened;

	rig_send(rig, LINK_LIDAR_OPEN, NULL, 0);
	rig_run(rig, 0.01);
	return rig->opened > opened;
}

char *rig_ask(struct rig *rig, const char *text)
{
	g_string_set_size(rig->lidar, 0);
	rig_say(rig, text);
	rig_run(rig, 0.02);
	return g_strdup(rig->lidar->str);
}

void rig_move(struct rig *rig, int64_t target, double rate, double acceleration)
{
	struct link_stage_move move = { target, rate, acceleration };

	rig_send(rig, LINK_STAGE_MOVE, &move, sizeof move);
}

guint rig_count(const struct rig *rig, enum link_stage_kind kind)
{
	guint count = 0;

	for (guint i = 0; i < rig->events->len; i++)
		count += g_array_index(rig->events, struct link_stage_event, i).kind == kind;
	return count;
}

int64_t rig_home(struct rig *rig)
{
	int64_t count = 0;

	rig_move(rig, 20000, 3000, 20000);
	while (rig_count(rig, LINK_STAGE_HOME) == 0)
		g_assert_true(rig_wait(rig, rig->now_ns + SECOND));
	for (guint i = 0; i < rig->events->len; i++) {
		const struct link_stage_event *e =
			&g_array_index(rig->events, struct link_stage_event, i);

		count += e->kind == LINK_STAGE_STEP ? e->direction : 0;
		if (e->kind == LINK_STAGE_HOME)
			break;
	}
	rig_send(rig, LINK_STAGE_STOP, NULL, 0);
	while (rig_count(rig, LINK_STAGE_STOPPED) == 0)
		g_assert_true(rig_wait(rig, rig->now_ns + SECOND));
	g_array_set_size(rig->events, 0);
	return count;
}
