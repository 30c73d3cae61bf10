#include "sim/kernel.h"
#include "sim/camera.h"
#include "sim/head-stage.h"
#include "sim/head.h"
#include "sim/kernel-frame.h"
#include "sim/options.h"
#include "sim/peer.h"
#include "sim/truth.h"
#include "sim/usbip.h"
#include <arpa/inet.h>
#include <errno.h>
#include <gio/gio.h>
#include <glib-unix.h>
#include <math.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#define FRAMES_WAITING_MAX (8u << 20) /* of the agent: a frame is lost beyond */

struct kernel {
	const struct kernel_options *wishes;
	char *description;
	sim_options *options;
	truth *truth; /* has built the world */
	const struct usb_gadget *gadget;
	GMainLoop *loop;
	int listening[2];

	GThread *thread; /* the head's; NULL: without power */
	peer *head;      /* the link to it */
	GByteArray *from_head, *from_agent;
	GPtrArray *plugs; /* struct plug */
	peer *agent;
	int64_t agent_ns; /* what its clock shows; below 0: not told */
	struct kernel_frame_format format;

	struct plug *attached; /* the one whose device the lidar is; others only ask */
	bool opening;          /* the lidar has not answered yet */
	GByteArray *unsaid;    /* for the lidar, until it has */
};

/* A client of USB/IP. */
struct plug {
	struct kernel *k;
	usbip *usb;
	peer *client;
};

static int64_t monotonic_ns(void)
{
	struct timespec now;

	clock_gettime(CLOCK_MONOTONIC, &now);
	return now.tv_sec * INT64_C(1000000000) + now.tv_nsec;
}

static int64_t time_ns(const struct kernel *k)
{
	return k->agent_ns < 0 ? monotonic_ns() : k->agent_ns;
}

static void send_message(peer *p, uint32_t kind, int64_t host_ns, const void *payload, gsize length)
{
	struct link_header header = { (uint32_t)length, kind, host_ns };
	g_autofree guint8 *message = g_malloc(sizeof header + length);

	memcpy(message, &header, sizeof header);
	if (length)
		memcpy(message + sizeof header, payload, length);
	peer_send(p, message, sizeof header + length);
}

static void tell_head(struct kernel *k, enum link_kind kind, const void *payload, gsize length)
{
	if (k->head)
		send_message(k->head, kind, 0, payload, length);
}

static void flush_plug(struct plug *plug)
{
	GByteArray *out = usbip_output(plug->usb);

	if (out->len == 0)
		return;
	peer_send(plug->client, out->data, out->len);
	g_byte_array_set_size(out, 0);
}

/* The lidar.  It is opened once its plug is imported, and anew whenever the host begins anew. */

static void open_lidar(struct kernel *k)
{
	if (k->opening)
		return;
	tell_head(k, LINK_LIDAR_CLOSE, NULL, 0);
	tell_head(k, LINK_LIDAR_OPEN, NULL, 0);
	k->opening = true;
}

static void lidar_opened(struct kernel *k)
{
	k->opening = false;
	if (!k->attached)
		return;
	usbip_admit(k->attached->usb, true);
	flush_plug(k->attached);
	if (k->unsaid->len > 0)
		tell_head(k, LINK_LIDAR_WRITE, k->unsaid->data, k->unsaid->len);
	g_byte_array_set_size(k->unsaid, 0);
}

/* What was heard of it is on its way before the plug is out. */
static void lidar_gone(struct kernel *k)
{
	k->opening = false;
	g_byte_array_set_size(k->unsaid, 0);
	if (!k->attached)
		return;
	usbip_admit(k->attached->usb, false);
	flush_plug(k->attached);
	peer_hang_up(k->attached->client);
	k->attached = NULL;
}

static bool start_head(struct kernel *k);

static void plug_import(gpointer data)
{
	struct plug *plug = data;

	if (plug->k->attached || !start_head(plug->k)) {
		usbip_admit(plug->usb, false);
		return;
	}
	plug->k->attached = plug;
	open_lidar(plug->k);
}

static void plug_begin(gpointer data)
{
	open_lidar(((struct plug *)data)->k);
}

static void plug_line(gpointer data, const struct usb_line *line)
{
	struct link_line now = { .baud = line->baud, .dtr = line->dtr };

	tell_head(((struct plug *)data)->k, LINK_LIDAR_LINE, &now, sizeof now);
}

static void plug_write(gpointer data, const uint8_t *bytes, gsize length)
{
	struct kernel *k = ((struct plug *)data)->k;

	if (k->opening)
		g_byte_array_append(k->unsaid, bytes, (guint)length);
	else
		tell_head(k, LINK_LIDAR_WRITE, bytes, length);
}

static const struct usbip_behind behind_plug = { plug_import, plug_begin, plug_line, plug_write };

static bool plug_bytes(peer *p, const uint8_t *bytes, gsize length, gpointer data)
{
	struct plug *plug = data;
	bool goes_on = usbip_receive(plug->usb, time_ns(plug->k), bytes, length);

	(void)p;
	flush_plug(plug);
	return goes_on;
}

static void plug_gone(peer *p, gpointer data)
{
	struct plug *plug = data;
	struct kernel *k = plug->k;

	(void)p;
	if (k->attached == plug) {
		k->attached = NULL;
		k->opening = false;
		tell_head(k, LINK_LIDAR_CLOSE, NULL, 0);
	}
	g_ptr_array_remove_fast(k->plugs, plug);
}

static void plug_free(gpointer data)
{
	struct plug *plug = data;

	usbip_free(plug->usb);
	g_free(plug);
}

static const struct peer_calls plug_calls = { plug_bytes, plug_gone };

static gboolean accept_plug(int fd, GIOCondition condition, gpointer data)
{
	struct kernel *k = data;
	int connection = accept4(fd, NULL, NULL, SOCK_CLOEXEC);

	(void)condition;
	if (connection < 0)
		return G_SOURCE_CONTINUE;
	struct plug *plug = g_new0(struct plug, 1);

	plug->k = k;
	plug->usb = usbip_new(k->gadget, &behind_plug, plug);
	plug->client = peer_new(connection, &plug_calls, plug);
	g_ptr_array_add(k->plugs, plug);
	return G_SOURCE_CONTINUE;
}

/* The messages that are whole; false: one is nonsense. */
static bool take_messages(GByteArray *from, gsize longest,
	void (*take)(struct kernel *k, const struct link_header *header, const guint8 *payload),
	struct kernel *k)
{
	struct link_header header;
	gsize at = 0;

	while (from->len - at >= sizeof header) {
		memcpy(&header, from->data + at, sizeof header);
		if (header.length > longest)
			return false;
		if (from->len - at - sizeof header < header.length)
			break;
		take(k, &header, from->data + at + sizeof header);
		at += sizeof header + header.length;
	}
	g_byte_array_remove_range(from, 0, (guint)at);
	return true;
}

/* The agent. */

/* When the exposure began, which a kernel's driver stamps frames with. */
static int64_t exposure_ns(
	const struct kernel *k, const struct link_header *header, const guint8 *payload)
{
	struct link_frame frame;

	memcpy(&frame, payload, sizeof frame);
	return header->host_ns - camera_transfer_ns(k->options) -
	       frame.exposure_100us * INT64_C(100000);
}

static void pass_frame(struct kernel *k, const struct link_header *header, const guint8 *payload)
{
	if (!k->agent || header->length < sizeof(struct link_frame))
		return;
	g_autoptr(GByteArray) frame = kernel_frame(&k->format, payload, header->length);

	if (peer_waiting(k->agent) < FRAMES_WAITING_MAX)
		send_message(k->agent, LINK_CAMERA_FRAME, exposure_ns(k, header, payload),
			frame->data, frame->len);
}

static void greet_agent(struct kernel *k)
{
	struct stage_desc desc = sim_head_stage(k->options, 0);
	struct kernel_stage hello = { .steps_per_turn = desc.steps_per_turn,
		.initial_azimuth_rad = desc.initial_azimuth_rad,
		.backlash_steps = desc.backlash_steps,
		.index_slots = desc.index_slots,
		.width = k->options->camera_width,
		.height = k->options->camera_height,
		.fps_1000 = (uint32_t)lrint(k->options->fps * 1000) };

	send_message(k->agent, KERNEL_STAGE, 0, &hello, sizeof hello);
}

static void take_from_agent(
	struct kernel *k, const struct link_header *header, const guint8 *payload)
{
	uint32_t fourcc;

	switch (header->kind) {
	case KERNEL_CLOCK:
		if (header->length != sizeof k->agent_ns)
			break;
		memcpy(&k->agent_ns, payload, sizeof k->agent_ns);
		tell_head(k, LINK_TIME, payload, header->length);
		break;
	case KERNEL_CAMERA:
		memcpy(&fourcc, payload, MIN(sizeof fourcc, header->length));
		if (header->length == sizeof fourcc)
			k->format.fourcc = fourcc;
		break;
	default: tell_head(k, (enum link_kind)header->kind, payload, header->length);
	}
}

static bool agent_bytes(peer *p, const uint8_t *bytes, gsize length, gpointer data)
{
	struct kernel *k = data;

	(void)p;
	g_byte_array_append(k->from_agent, bytes, (guint)length);
	return take_messages(k->from_agent, 65536, take_from_agent, k);
}

static void agent_gone(peer *p, gpointer data)
{
	struct kernel *k = data;

	g_byte_array_set_size(k->from_agent, 0);
	if (k->agent != p)
		return;
	k->agent = NULL;
	k->agent_ns = -1;
	tell_head(k, LINK_TIME, &k->agent_ns, sizeof k->agent_ns);
}

static const struct peer_calls agent_calls = { agent_bytes, agent_gone };

static gboolean accept_agent(int fd, GIOCondition condition, gpointer data)
{
	struct kernel *k = data;
	int connection = accept4(fd, NULL, NULL, SOCK_CLOEXEC);

	(void)condition;
	if (connection < 0)
		return G_SOURCE_CONTINUE;
	if (k->agent || !start_head(k)) {
		close(connection);
		return G_SOURCE_CONTINUE;
	}
	k->agent = peer_new(connection, &agent_calls, k);
	greet_agent(k);
	return G_SOURCE_CONTINUE;
}

/* The head, in a thread of its own behind a link. */

struct head_call {
	int fd;
	const char *description;
	const world *world;
};

static gpointer run_head(gpointer data)
{
	g_autofree struct head_call *call = data;
	struct sim_head_options options = { .description = call->description,
		.world = call->world,
		.settle_ns = KERNEL_SETTLE_MS * INT64_C(1000000) };
	g_autoptr(GError) error = NULL;

	if (!sim_head_serve(call->fd, &options, &error))
		g_printerr("pleinair-sim: %s\n", error->message);
	return NULL;
}

static void take_from_head(
	struct kernel *k, const struct link_header *header, const guint8 *payload)
{
	switch (header->kind) {
	case LINK_LIDAR_OPENED: lidar_opened(k); break;
	case LINK_LIDAR_GONE: lidar_gone(k); break;
	case LINK_LIDAR_BYTES:
		if (k->attached)
			usbip_deliver(k->attached->usb, payload, header->length);
		break;
	case LINK_LIDAR_HALTED:
		if (k->attached)
			usbip_halt(k->attached->usb);
		break;
	case LINK_CAMERA_FRAME: pass_frame(k, header, payload); break;
	case LINK_CAMERA_GONE:
	case LINK_STAGE_SLIPPED:
		if (k->agent)
			send_message(
				k->agent, header->kind, header->host_ns, payload, header->length);
		break;
	default: break; /* what the stage itself tells is the agent's to know */
	}
	if (k->attached)
		flush_plug(k->attached);
}

static bool head_bytes(peer *p, const uint8_t *bytes, gsize length, gpointer data)
{
	struct kernel *k = data;

	(void)p;
	g_byte_array_append(k->from_head, bytes, (guint)length);
	return take_messages(k->from_head, LINK_PAYLOAD_MAX, take_from_head, k);
}

/* Its power is off: so is everybody's. */
static void head_gone(peer *p, gpointer data)
{
	struct kernel *k = data;

	(void)p;
	k->head = NULL;
	g_byte_array_set_size(k->from_head, 0);
	g_thread_join(g_steal_pointer(&k->thread));
	lidar_gone(k);
	if (k->agent)
		peer_hang_up(g_steal_pointer(&k->agent));
	k->agent_ns = -1;
}

static const struct peer_calls head_calls = { head_bytes, head_gone };

static bool start_head(struct kernel *k)
{
	int pair[2];

	if (k->head)
		return true;
	if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair) < 0)
		return false;
	struct head_call *call = g_new(struct head_call, 1);

	*call = (struct head_call){ pair[1], k->description, truth_world(k->truth) };
	k->head = peer_new(pair[0], &head_calls, k);
	k->thread = g_thread_new("head", run_head, call);
	return true;
}

static int listen_on(uint16_t port, uint16_t *ret_port, GError **error)
{
	struct sockaddr_in address = { .sin_family = AF_INET,
		.sin_port = htons(port),
		.sin_addr.s_addr = htonl(INADDR_LOOPBACK) };
	socklen_t length = sizeof address;
	int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0), again = 1;

	setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &again, sizeof again);
	if (fd >= 0 && bind(fd, (struct sockaddr *)&address, length) == 0 && listen(fd, 4) == 0 &&
		getsockname(fd, (struct sockaddr *)&address, &length) == 0) {
		*ret_port = ntohs(address.sin_port);
		return fd;
	}
	int number = errno;

	g_set_error(error, G_IO_ERROR, g_io_error_from_errno(number), "port %u of 127.0.0.1: %s",
		port, g_strerror(number));
	if (fd >= 0)
		close(fd);
	return -1;
}

static bool begin(struct kernel *k, GError **error)
{
	uint16_t usb_port = k->wishes->port, agent_port;
	const char *wish = k->wishes->description;

	k->description = g_strconcat(wish, strchr(wish, '?') ? "&" : "?", "speed=1", NULL);
	k->options = options_parse(k->description, error);
	if (!k->options || !(k->truth = truth_new(k->description, error)))
		return false;
	k->gadget = k->wishes->plug ? usb_gadget_by_name(k->wishes->plug)
				    : usb_gadget_of(k->options->lidar->protocol);
	if (!k->gadget) {
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_ARGUMENT,
			"there is no plug %s; there are sick, hokuyo, cp2102", k->wishes->plug);
		return false;
	}
	k->listening[0] = listen_on(usb_port, &usb_port, error);
	if (k->listening[0] < 0)
		return false;
	k->listening[1] = listen_on(k->wishes->port ? usb_port + 1 : 0, &agent_port, error);
	if (k->listening[1] < 0)
		return false;
	k->wishes->listens(usb_port, agent_port, k->wishes->data);
	return true;
}

static gboolean stop(int fd, GIOCondition condition, gpointer data)
{
	(void)fd, (void)condition;
	g_main_loop_quit(data);
	return G_SOURCE_REMOVE;
}

/* Hanging up on everybody ends in their gone(). */
static void end(struct kernel *k)
{
	for (guint i = 0; i < k->plugs->len; i++)
		peer_hang_up(((struct plug *)k->plugs->pdata[i])->client);
	if (k->agent)
		peer_hang_up(k->agent);
	if (k->head)
		peer_hang_up(k->head);
	while (k->plugs->len > 0 || k->agent || k->head)
		g_main_context_iteration(NULL, TRUE);
}

static void clear(struct kernel *k)
{
	for (int i = 0; i < 2; i++)
		if (k->listening[i] >= 0)
			close(k->listening[i]);
	g_main_loop_unref(k->loop);
	g_ptr_array_unref(k->plugs);
	g_byte_array_unref(k->from_head);
	g_byte_array_unref(k->from_agent);
	g_byte_array_unref(k->unsaid);
	truth_free(k->truth);
	options_free(k->options);
	g_free(k->description);
}

bool kernel_serve(const struct kernel_options *options, int until, GError **error)
{
	struct kernel k = { .wishes = options,
		.loop = g_main_loop_new(NULL, FALSE),
		.listening = { -1, -1 },
		.agent_ns = -1,
		.from_head = g_byte_array_new(),
		.from_agent = g_byte_array_new(),
		.unsaid = g_byte_array_new(),
		.plugs = g_ptr_array_new_with_free_func(plug_free) };
	bool good = begin(&k, error);

	if (good) {
		guint sources[3] = { g_unix_fd_add(k.listening[0], G_IO_IN, accept_plug, &k),
			g_unix_fd_add(k.listening[1], G_IO_IN, accept_agent, &k),
			until >= 0 ? g_unix_fd_add(until, G_IO_IN | G_IO_HUP, stop, k.loop) : 0 };

		g_main_loop_run(k.loop);
		g_source_remove(sources[0]);
		g_source_remove(sources[1]);
		end(&k);
	}
	clear(&k);
	return good;
}
