/* agent --sim HOST:PORT [--usb HOST:PORT]... [--camera /dev/videoN --format YUYV|NV12|MJPG] [--commands PIPE]: see agent.h. Says "ready" on stdout. */
#include "tests/kernel/agent.h"
#include "sim/kernel.h"
#include "sim/peer.h"
#include "sim/stage.h"
#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <gio/gio.h>
#include <glib-unix.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/timerfd.h>
#include <time.h>
#include <unistd.h>

#define TICK_MS 5 /* pulses are looked for, and the simulator is told the time */
#define SLOT_MS 8 /* a slot covers its sensor */

struct agent {
	char *sim, *camera, *format, *commands;
	char **usb;

	GMainLoop *loop;
	peer *peer;
	GByteArray *from;
	pins *pins;
	stage *stage;
	int timer;
	bool levels[PIN_COUNT]; /* as outputs and pulls stand */
	screen *screen;
	struct kernel_stage head;
	GByteArray *pulses; /* struct link_stage_pulse that are not yet sent */
	guint64 steps, slots, frames;
	guint leaving;     /* a slot */
	int64_t latest_ns; /* the longest from a slot's passing until its line was pulled */
};

int64_t guest_ns(void)
{
	struct timespec now;

	clock_gettime(CLOCK_MONOTONIC, &now);
	return now.tv_sec * INT64_C(1000000000) + now.tv_nsec;
}

static void tell(struct agent *a, uint32_t kind, const void *payload, gsize length)
{
	struct link_header header = { (uint32_t)length, kind, 0 };

	if (!a->peer)
		return;
	peer_send(a->peer, &header, sizeof header);
	if (length)
		peer_send(a->peer, payload, length);
}

/* The stage. */

static void set_timer(struct agent *a)
{
	int64_t at_ns = stage_next_ns(a->stage);
	struct itimerspec when = { 0 };

	if (at_ns != INT64_MAX)
		when.it_value =
			(struct timespec){ MAX(at_ns, 1) / 1000000000, MAX(at_ns, 1) % 1000000000 };
	timerfd_settime(a->timer, TFD_TIMER_ABSTIME, &when, NULL);
}

static void pull(struct agent *a, enum pin pin, bool level)
{
	if (a->levels[pin] == level)
		return;
	a->levels[pin] = level;
	pins_pull(a->pins, pin, level);
}

static gboolean leave_slot(gpointer data)
{
	struct agent *a = data;

	pull(a, PIN_INDEX, false);
	pull(a, PIN_HOME, false);
	a->leaving = 0;
	return G_SOURCE_REMOVE;
}

/* A slot is as wide as a few milliseconds of motion. The edge that lies at its angle is the first one clockwise, the last one the
 * other way round. */
static void pass_slot(struct agent *a, enum pin pin, int direction)
{
	pull(a, pin, true);
	if (direction < 0)
		pull(a, pin, false);
	g_clear_handle_id(&a->leaving, g_source_remove);
	a->leaving = g_timeout_add(SLOT_MS, leave_slot, a);
	a->slots++;
}

static void pass_slots(struct agent *a)
{
	int64_t due_ns;

	while ((due_ns = stage_next_ns(a->stage)) <= guest_ns()) {
		g_autoptr(GByteArray) batch = stage_run(a->stage, guest_ns());

		for (gsize at = 0; batch && at < batch->len;
			at += sizeof(struct link_stage_event)) {
			struct link_stage_event event;

			memcpy(&event, batch->data + at, sizeof event);
			if (event.kind == LINK_STAGE_INDEX || event.kind == LINK_STAGE_HOME)
				pass_slot(a, event.kind == LINK_STAGE_INDEX ? PIN_INDEX : PIN_HOME,
					event.direction);
			a->latest_ns = MAX(a->latest_ns, guest_ns() - due_ns);
		}
	}
}

static void run_stage(struct agent *a)
{
	pass_slots(a);
	set_timer(a);
}

static gboolean on_timer(int fd, GIOCondition condition, gpointer data)
{
	uint64_t times;

	(void)condition;
	if (read(fd, &times, sizeof times) > 0)
		run_stage(data);
	return G_SOURCE_CONTINUE;
}

static void step(struct agent *a, int64_t at_ns)
{
	int direction = a->levels[PIN_DIR] ? 1 : -1;
	struct link_stage_pulse pulse = { at_ns, direction, 0 };

	stage_pulse(a->stage, at_ns, direction);
	a->steps++;
	g_byte_array_append(a->pulses, (const guint8 *)&pulse, sizeof pulse);
	pass_slots(a);
}

static void changed(enum pin pin, bool level, int64_t at_ns, gpointer data)
{
	struct agent *a = data;

	a->levels[pin] = level;
	if (pin == PIN_STEP && level && a->levels[PIN_ENABLE] && a->levels[PIN_ESTOP] && a->stage)
		step(a, at_ns);
}

/* What the clock shows is told last: no pulse before it is still to come. */
static gboolean tick(gpointer data)
{
	struct agent *a = data;
	int64_t now_ns = guest_ns();

	pins_look(a->pins);
	if (!a->stage)
		return G_SOURCE_CONTINUE;
	run_stage(a);
	if (a->pulses->len)
		tell(a, LINK_STAGE_PULSES, a->pulses->data, a->pulses->len);
	g_byte_array_set_size(a->pulses, 0);
	tell(a, KERNEL_CLOCK, &now_ns, sizeof now_ns);
	return G_SOURCE_CONTINUE;
}

static void begin_stage(struct agent *a)
{
	struct stage_desc desc = { .steps_per_turn = a->head.steps_per_turn,
		.index_slots = a->head.index_slots,
		.initial_azimuth_rad = a->head.initial_azimuth_rad,
		.backlash_steps = a->head.backlash_steps,
		.clock = { .tick_ns = 1e3, .bits = 32 } };

	a->stage = stage_new(&desc, guest_ns());
	stage_begin_pulses(a->stage, guest_ns());
	tell(a, LINK_STAGE_BEGIN, NULL, 0);
}

/* The camera. */

static uint32_t fourcc(const struct agent *a)
{
	const char *f = a->format ? a->format : "YUYV";

	return (uint32_t)f[0] | (uint32_t)f[1] << 8 | (uint32_t)f[2] << 16 | (uint32_t)f[3] << 24;
}

static void begin_camera(struct agent *a)
{
	g_autoptr(GError) error = NULL;
	uint32_t format = fourcc(a);

	if (!a->camera || a->head.width == 0)
		return;
	a->screen = screen_new(
		a->camera, format, a->head.width, a->head.height, a->head.fps_1000, &error);
	if (!a->screen) {
		g_printerr("agent: %s\n", error->message);
		return;
	}
	tell(a, KERNEL_CAMERA, &format, sizeof format);
	tell(a, LINK_CAMERA_QUEUE, NULL, 0);
}

static void take_frame(struct agent *a, int64_t host_ns, const guint8 *payload, gsize length)
{
	g_autoptr(GError) error = NULL;
	struct link_frame head;

	if (length <= sizeof head)
		return;
	memcpy(&head, payload, sizeof head);
	struct screen_frame frame = { .bytes = payload + sizeof head,
		.length = length - sizeof head,
		.at_ns = host_ns,
		.sequence = head.sequence,
		.damaged = head.flags & LINK_FRAME_ERROR };

	if (a->screen && !screen_show(a->screen, &frame, &error))
		g_printerr("agent: %s\n", error->message);
	a->frames++;
	tell(a, LINK_CAMERA_QUEUE, NULL, 0);
}

/* The simulator. */

static void take_stage(struct agent *a, const guint8 *payload, gsize length)
{
	if (length != sizeof a->head)
		return;
	memcpy(&a->head, payload, sizeof a->head);
	begin_stage(a);
	begin_camera(a);
	printf("ready\n");
	fflush(stdout);
}

static void take(struct agent *a, const struct link_header *header, const guint8 *payload)
{
	double steps;

	switch (header->kind) {
	case KERNEL_STAGE: take_stage(a, payload, header->length); break;
	case LINK_STAGE_SLIPPED:
		memcpy(&steps, payload, sizeof steps);
		stage_slip(a->stage, guest_ns(), steps);
		break;
	case LINK_CAMERA_FRAME: take_frame(a, header->host_ns, payload, header->length); break;
	case LINK_CAMERA_GONE: g_clear_pointer(&a->screen, screen_free); break;
	default: break;
	}
}

static bool on_bytes(peer *p, const uint8_t *bytes, gsize length, gpointer data)
{
	struct agent *a = data;
	struct link_header header;
	gsize at = 0;

	(void)p;
	g_byte_array_append(a->from, bytes, (guint)length);
	while (a->from->len - at >= sizeof header) {
		memcpy(&header, a->from->data + at, sizeof header);
		if (a->from->len - at - sizeof header < header.length)
			break;
		take(a, &header, a->from->data + at + sizeof header);
		at += sizeof header + header.length;
	}
	g_byte_array_remove_range(a->from, 0, (guint)at);
	return true;
}

static void on_gone(peer *p, gpointer data)
{
	struct agent *a = data;

	(void)p;
	a->peer = NULL;
	g_printerr("agent: the simulator is gone\n");
	g_main_loop_quit(a->loop);
}

static const struct peer_calls calls = { on_bytes, on_gone };

/* Commands. */

static void tell_state(struct agent *a)
{
	g_printerr("agent: %" G_GUINT64_FORMAT " steps, azimuth %.3f deg, %" G_GUINT64_FORMAT
		   " slots (latest %.2f ms), %" G_GUINT64_FORMAT " frames; %.0f ms of CPU\n",
		a->steps, stage_azimuth_rad(a->stage, guest_ns(), 0) * 180 / G_PI, a->slots,
		a->latest_ns * 1e-6, a->frames, clock() * 1e3 / CLOCKS_PER_SEC);
	a->latest_ns = 0;
}

static void obey(struct agent *a, char *line)
{
	g_auto(GStrv) words = g_strsplit(g_strstrip(line), " ", -1);
	guint count = g_strv_length(words);
	int pin = count == 3 && strcmp(words[0], "line") == 0 ? pin_by_name(words[1]) : -1;

	if (pin >= 0)
		pull(a, (enum pin)pin, words[2][0] == '1');
	else if (count == 1 && strcmp(words[0], "state") == 0)
		tell_state(a);
	else if (count == 1 && strcmp(words[0], "quit") == 0)
		g_main_loop_quit(a->loop);
	else if (count > 0 && *words[0])
		g_printerr("agent: '%s' is no command\n", line);
}

static gboolean on_command(int fd, GIOCondition condition, gpointer data)
{
	char text[1024];
	ssize_t got = read(fd, text, sizeof text - 1);

	(void)condition;
	if (got <= 0)
		return G_SOURCE_CONTINUE;
	text[got] = '\0';
	g_auto(GStrv) lines = g_strsplit(text, "\n", -1);

	for (char **line = lines; *line; line++)
		obey(data, *line);
	return G_SOURCE_CONTINUE;
}

static bool parse_address(const char *text, struct sockaddr_in *ret_address)
{
	g_auto(GStrv) parts = g_strsplit(text, ":", 2);

	*ret_address = (struct sockaddr_in){ .sin_family = AF_INET };
	if (g_strv_length(parts) != 2 || inet_aton(parts[0], &ret_address->sin_addr) == 0)
		return false;
	ret_address->sin_port = htons((uint16_t)atoi(parts[1]));
	return true;
}

static bool reach(struct agent *a)
{
	struct sockaddr_in address;
	int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);

	if (!parse_address(a->sim, &address) ||
		connect(fd, (struct sockaddr *)&address, sizeof address) < 0) {
		g_printerr("agent: %s: %s\n", a->sim, g_strerror(errno));
		return false;
	}
	a->peer = peer_new(fd, &calls, a);
	return true;
}

static void listen_to_commands(struct agent *a)
{
	if (!a->commands)
		return;
	mkfifo(a->commands, 0600);
	int fd = open(a->commands,
		O_RDWR | O_NONBLOCK | O_CLOEXEC); /* for writing too: it never ends then */

	if (fd >= 0)
		g_unix_fd_add(fd, G_IO_IN, on_command, a);
}

static void plug_all(struct agent *a)
{
	struct sockaddr_in address;

	for (char **usb = a->usb; usb && *usb; usb++)
		if (parse_address(*usb, &address))
			plug_keep(inet_ntoa(address.sin_addr), ntohs(address.sin_port));
}

static bool parse(int *argc, char ***argv, struct agent *a, GError **error)
{
	const GOptionEntry entries[] = { { "sim", 0, 0, G_OPTION_ARG_STRING, &a->sim,
						 "The simulator's port for an agent", "HOST:PORT" },
		{ "usb", 0, 0, G_OPTION_ARG_STRING_ARRAY, &a->usb, "A device to plug in",
			"HOST:PORT" },
		{ "camera", 0, 0, G_OPTION_ARG_STRING, &a->camera, "A device of v4l2loopback",
			"NODE" },
		{ "format", 0, 0, G_OPTION_ARG_STRING, &a->format, "... and what it gives",
			"YUYV|NV12|MJPG" },
		{ "commands", 0, 0, G_OPTION_ARG_STRING, &a->commands, "A named pipe to make",
			"PATH" },
		G_OPTION_ENTRY_NULL };
	g_autoptr(GOptionContext) context = g_option_context_new(NULL);

	g_option_context_add_main_entries(context, entries, NULL);
	return g_option_context_parse(context, argc, argv, error);
}

int main(int argc, char **argv)
{
	struct agent a = { .from = g_byte_array_new(),
		.pulses = g_byte_array_new(),
		.timer = timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC) };
	struct sched_param first = { .sched_priority = 60 };
	g_autoptr(GError) error = NULL;

	if (!parse(&argc, &argv, &a, &error) || (a.format && strlen(a.format) != 4)) {
		g_printerr("agent: %s\n", error ? error->message : "a format has four letters");
		return 2;
	}
	a.loop = g_main_loop_new(NULL, FALSE);
	plug_all(&a);
	/* What wires do takes no time: before anything that the host does. */
	sched_setscheduler(0, SCHED_FIFO, &first);
	mlockall(MCL_CURRENT);
	if (a.sim) {
		a.pins = pins_new("pleinair", changed, &a, &error);
		if (!a.pins) {
			g_printerr("agent: %s\n", error->message);
			return 1;
		}
		pull(&a, PIN_ESTOP, true);
		pull(&a, PIN_INTERLOCK, true);
		g_unix_fd_add(a.timer, G_IO_IN, on_timer, &a);
		if (!reach(&a))
			return 1;
		g_timeout_add_full(G_PRIORITY_HIGH, TICK_MS, tick, &a, NULL);
	}
	listen_to_commands(&a);
	g_main_loop_run(a.loop);
	plug_pull();
	pins_free(a.pins);
	return 1;
}
