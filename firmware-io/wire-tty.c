/* A lidar on a serial line (termios). A thread listens, and stamps what comes as it comes. */
#include "firmware-io/inbox.h"
#include "firmware-io/parts.h"
#include <asm/termbits.h>
#include <errno.h>
#include <fcntl.h>
#include <grp.h>
#include <linux/serial.h>
#include <poll.h>
#include <pthread.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

/* The fastest line brings 100 kB a second. */
#define ROOM           (256u << 10)
#define WRITE_PATIENCE 1000 /* ms */
#define SPEED_AT_FIRST 115200

struct tty_wire {
	wire base;
	char *path;
	struct wire_line line;
	int fd, stop_fd;
	GThread *listener;
	inbox *inbox;
	struct serial_icounter_struct at_opening;
	bool counted; /* the driver counts errors */
};

static bool say_gone(GError **error, const char *format, ...) G_GNUC_PRINTF(2, 3);
static bool say_gone(GError **error, const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	g_autofree char *text = g_strdup_vprintf(format, arguments);
	va_end(arguments);
	g_set_error_literal(error, WIRE_ERROR, WIRE_ERROR_GONE, text);
	return false;
}

/* ---- the listener ---- */

static void listen_once(struct tty_wire *t, bool *ret_over)
{
	uint8_t bytes[4096];
	ssize_t n = read(t->fd, bytes, sizeof bytes);
	int64_t now_ns = inbox_now_ns();
	if (n > 0) {
		inbox_put(t->inbox, bytes, (size_t)n, now_ns);
		return;
	}
	if (n < 0 && (errno == EAGAIN || errno == EINTR))
		return;
	*ret_over = true;
	inbox_fail(t->inbox, g_error_new(WIRE_ERROR, WIRE_ERROR_GONE,
				     "the lidar was unplugged: %s is gone", t->path));
}

static gpointer listen_to(gpointer data)
{
	struct tty_wire *t = data;
	struct pollfd fds[] = { { .fd = t->fd, .events = POLLIN },
		{ .fd = t->stop_fd, .events = POLLIN } };
	/* Late stamps are a lidar in the wrong place. Where it is not allowed it goes without. */
	pthread_setschedparam(
		pthread_self(), SCHED_FIFO, &(struct sched_param){ .sched_priority = 50 });
	for (bool over = false; !over;) {
		if (poll(fds, G_N_ELEMENTS(fds), -1) < 0 && errno != EINTR)
			break;
		if (fds[1].revents)
			break;
		if (fds[0].revents)
			listen_once(t, &over);
	}
	return NULL;
}

/* ---- the line ---- */

/* Any speed, not only those that POSIX has names for (RPLIDARs run at 256000). */
static bool apply_line(struct tty_wire *t, GError **error)
{
	struct termios2 options;
	if (ioctl(t->fd, TCGETS2, &options) < 0) {
		g_set_error(error, WIRE_ERROR, WIRE_ERROR_BROKEN, "%s is no serial line", t->path);
		return false;
	}
	options.c_iflag = IGNBRK | IGNPAR;
	options.c_oflag = options.c_lflag = 0;
	options.c_cflag = CS8 | CREAD | CLOCAL | HUPCL | BOTHER | BOTHER << IBSHIFT;
	options.c_ispeed = options.c_ospeed = t->line.baud;
	options.c_cc[VMIN] = 1;
	options.c_cc[VTIME] = 0;
	if (ioctl(t->fd, TCSETS2, &options) < 0 || ioctl(t->fd, TCGETS2, &options) < 0)
		return say_gone(
			error, "%s does not take its settings: %s", t->path, g_strerror(errno));
	/* A divider can be a little off. */
	if (ABS((int64_t)options.c_ospeed - (int64_t)t->line.baud) * 100 >
		3 * (int64_t)t->line.baud) {
		g_set_error(error, WIRE_ERROR, WIRE_ERROR_BROKEN, "%s cannot go at %u baud",
			t->path, t->line.baud);
		return false;
	}
	int dtr = TIOCM_DTR;
	/* A pseudo-terminal has no such pin. */
	if (ioctl(t->fd, t->line.dtr ? TIOCMBIS : TIOCMBIC, &dtr) < 0 && errno == EIO)
		return say_gone(error, "the lidar was unplugged: %s is gone", t->path);
	return true;
}

/* Bytes are handed over as they come, not sixteen milliseconds later; where the driver has no such choice it needs none. */
static void hurry(struct tty_wire *t)
{
	struct serial_struct serial;
	if (ioctl(t->fd, TIOCGSERIAL, &serial) == 0) {
		serial.flags |= ASYNC_LOW_LATENCY;
		ioctl(t->fd, TIOCSSERIAL, &serial);
	}
	t->counted = ioctl(t->fd, TIOCGICOUNT, &t->at_opening) == 0;
}

static bool refuse_access(const struct tty_wire *t, GError **error)
{
	struct stat s;
	struct group *g = stat(t->path, &s) == 0 ? getgrgid(s.st_gid) : NULL;
	return say_gone(error,
		"%s may not be opened: whoever scans must be in the group '%s' (pleinair doctor "
		"tells more)",
		t->path, g ? g->gr_name : "dialout");
}

static bool open_port(struct tty_wire *t, GError **error)
{
	t->fd = open(t->path, O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
	if (t->fd >= 0 && ioctl(t->fd, TIOCEXCL) == 0)
		return true;
	switch (errno) {
	case ENOENT:
	case ENXIO:
	case ENODEV:
		return say_gone(error,
			"the lidar is not there: %s does not exist; check its plug and its power",
			t->path);
	case EACCES:
	case EPERM: return refuse_access(t, error);
	case EBUSY: return say_gone(error, "%s is in use by another program", t->path);
	case ENOTTY:
		g_set_error(error, WIRE_ERROR, WIRE_ERROR_BROKEN, "%s is no serial line", t->path);
		return false;
	default: return say_gone(error, "%s cannot be opened: %s", t->path, g_strerror(errno));
	}
}

static void tty_close(wire *w)
{
	struct tty_wire *t = (struct tty_wire *)w;
	uint64_t one = 1;
	if (t->listener && write(t->stop_fd, &one, sizeof one) == sizeof one)
		g_thread_join(g_steal_pointer(&t->listener));
	if (t->stop_fd >= 0)
		close(t->stop_fd);
	if (t->fd >= 0) {
		ioctl(t->fd, TIOCNXCL);
		close(t->fd);
	}
	t->fd = t->stop_fd = -1;
	inbox_clear(t->inbox);
}

static bool tty_open(wire *w, GError **error)
{
	struct tty_wire *t = (struct tty_wire *)w;
	tty_close(w);
	if (!open_port(t, error) || !apply_line(t, error)) {
		tty_close(w);
		return false;
	}
	hurry(t);
	ioctl(t->fd, TCFLSH, TCIOFLUSH);
	t->stop_fd = eventfd(0, EFD_CLOEXEC);
	t->listener = g_thread_new("tty-listener", listen_to, t);
	return true;
}

static gssize tty_read(wire *w, void *bytes, size_t size, int64_t *ret_arrival_ns, GError **error)
{
	return inbox_take(((struct tty_wire *)w)->inbox, bytes, size, ret_arrival_ns, error);
}

static bool tty_write(wire *w, const void *bytes, size_t length, GError **error)
{
	struct tty_wire *t = (struct tty_wire *)w;
	struct pollfd p = { .fd = t->fd, .events = POLLOUT };
	for (size_t sent = 0; sent < length;) {
		ssize_t n = write(t->fd, (const uint8_t *)bytes + sent, length - sent);
		if (n > 0)
			sent += (size_t)n;
		else if (n < 0 && errno == EAGAIN && poll(&p, 1, WRITE_PATIENCE) > 0 &&
			 !(p.revents & (POLLERR | POLLHUP)))
			continue;
		else if (n < 0 && errno == EINTR)
			continue;
		else
			return say_gone(error, "the lidar takes no commands: %s %s", t->path,
				errno == EAGAIN ? "does not take bytes" : "is gone");
	}
	return true;
}

static bool tty_set_line(wire *w, const struct wire_line *line, GError **error)
{
	struct tty_wire *t = (struct tty_wire *)w;
	t->line = *line;
	return t->fd < 0 || apply_line(t, error);
}

static void tty_count(wire *w, struct wire_counts *ret)
{
	struct tty_wire *t = (struct tty_wire *)w;
	struct serial_icounter_struct now;
	inbox_count(t->inbox, ret);
	if (!t->counted || t->fd < 0 || ioctl(t->fd, TIOCGICOUNT, &now) < 0)
		return;
	ret->framing_errors = (uint64_t)(now.frame - t->at_opening.frame) +
			      (uint64_t)(now.brk - t->at_opening.brk);
	ret->overruns = (uint64_t)(now.overrun - t->at_opening.overrun) +
			(uint64_t)(now.buf_overrun - t->at_opening.buf_overrun);
}

static int tty_wait_fd(wire *w)
{
	return inbox_fd(((struct tty_wire *)w)->inbox);
}

static void tty_free(wire *w)
{
	struct tty_wire *t = (struct tty_wire *)w;
	tty_close(w);
	inbox_free(t->inbox);
	g_free(t->path);
	g_free(t);
}

static const struct wire_ops tty_ops = { .open = tty_open,
	.read = tty_read,
	.write = tty_write,
	.close = tty_close,
	.set_line = tty_set_line,
	.count = tty_count,
	.wait_fd = tty_wait_fd,
	.free = tty_free };

wire *wire_new_tty(head *h, const parts *p, const char *scheme, GError **error)
{
	if (!*parts_rest(p)) {
		g_set_error(error, WIRE_ERROR, WIRE_ERROR_BROKEN,
			"device '%s:': on which port? For example %s:/dev/ttyUSB0", scheme, scheme);
		return NULL;
	}
	struct tty_wire *t = g_new0(struct tty_wire, 1);
	*t = (struct tty_wire){ .base = { &tty_ops, h },
		.path = g_strdup(parts_rest(p)),
		.line = { .baud = SPEED_AT_FIRST, .dtr = true },
		.fd = -1,
		.stop_fd = -1,
		.inbox = inbox_new(ROOM) };
	return &t->base;
}
