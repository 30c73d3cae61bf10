/* Lines by the first API of libgpiod. */
#include "firmware-io/gpio-lines.h"
#if GPIOD_API_VERSION == 1
#include "firmware-io/wire.h"
#include <errno.h>
#include <gpiod.h>
#include <string.h>
#include <sys/epoll.h>
#include <unistd.h>

#define CONSUMER "pleinair"
#define AT_ONCE  16 /* what the kernel keeps of a line */

struct lines_1 {
	gpio_lines base;
	struct gpiod_chip *chip;
	struct gpiod_line **lines;
	size_t count;
};

static bool refuse(GError **error, const char *chip, const char *line, const char *what)
{
	g_set_error(error, WIRE_ERROR, WIRE_ERROR_BROKEN, "the pan stage: %s%s%s of %s %s",
		line ? "line '" : "", line ? line : "", line ? "'" : "the pins", chip, what);
	return false;
}

static struct gpiod_line *find_line(struct gpiod_chip *chip, const char *name)
{
	char *end;
	struct gpiod_line *line = gpiod_chip_find_line(chip, name);
	guint64 number = g_ascii_strtoull(name, &end, 10);
	if (line || end == name || *end || number >= gpiod_chip_num_lines(chip))
		return line;
	return gpiod_chip_get_line(chip, (unsigned)number);
}

static bool request(struct lines_1 *l, const char *chip, size_t i, const struct gpio_line_desc *d,
	GError **error)
{
	int flags = d->active_low ? GPIOD_LINE_REQUEST_FLAG_ACTIVE_LOW : 0;
	l->lines[i] = find_line(l->chip, d->line);
	if (!l->lines[i])
		return refuse(error, chip, d->line, "is not there");
	int code = d->output ? gpiod_line_request_output_flags(l->lines[i], CONSUMER, flags, 0)
			     : gpiod_line_request_both_edges_events_flags(
				       l->lines[i], CONSUMER, flags);
	if (code < 0) {
		g_autofree char *why = g_strdup_printf(
			errno == EBUSY ? "is in use by another program" : "cannot be had: %s",
			g_strerror(errno));
		l->lines[i] = NULL;
		return refuse(error, chip, d->line, why);
	}
	struct epoll_event e = { .events = EPOLLIN, .data.u64 = i };
	return d->output ||
	       epoll_ctl(l->base.fd, EPOLL_CTL_ADD, gpiod_line_event_get_fd(l->lines[i]), &e) == 0;
}

static bool set_1(gpio_lines *base, size_t line, bool on)
{
	return gpiod_line_set_value(((struct lines_1 *)base)->lines[line], on) == 0;
}

static int get_1(gpio_lines *base, size_t line)
{
	return gpiod_line_get_value(((struct lines_1 *)base)->lines[line]);
}

static gssize read_line(struct lines_1 *l, size_t i, struct gpio_edge *edges, size_t room)
{
	struct gpiod_line_event events[AT_ONCE];
	int n = gpiod_line_event_read_multiple(l->lines[i], events, (unsigned)MIN(room, AT_ONCE));
	for (int k = 0; k < n; k++)
		edges[k] = (struct gpio_edge){ .line = i,
			.on = events[k].event_type == GPIOD_LINE_EVENT_RISING_EDGE,
			.time_ns =
				events[k].ts.tv_sec * INT64_C(1000000000) + events[k].ts.tv_nsec };
	return n;
}

static gssize read_1(gpio_lines *base, struct gpio_edge *edges, size_t room)
{
	struct lines_1 *l = (struct lines_1 *)base;
	struct epoll_event ready[16];
	int n = epoll_wait(base->fd, ready, G_N_ELEMENTS(ready), 0);
	size_t got = 0;
	for (int k = 0; k < n && got < room; k++) {
		gssize some = read_line(l, ready[k].data.u64, edges + got, room - got);
		if (some < 0)
			return -1;
		got += (size_t)some;
	}
	return n < 0 && errno != EINTR ? -1 : (gssize)got;
}

static void free_1(gpio_lines *base)
{
	struct lines_1 *l = (struct lines_1 *)base;
	for (size_t i = 0; i < l->count; i++)
		if (l->lines[i])
			gpiod_line_release(l->lines[i]);
	if (l->chip)
		gpiod_chip_close(l->chip);
	if (base->fd >= 0)
		close(base->fd);
	g_free(l->lines);
	g_free(l);
}

static const struct gpio_lines_ops ops_1 = {
	.set = set_1, .get = get_1, .read = read_1, .free = free_1
};

gpio_lines *gpio_lines_open(
	const char *chip, const struct gpio_line_desc *lines, size_t count, GError **error)
{
	struct lines_1 *l = g_new0(struct lines_1, 1);
	l->base = (gpio_lines){ &ops_1, epoll_create1(EPOLL_CLOEXEC) };
	l->lines = g_new0(struct gpiod_line *, count);
	l->count = count;
	l->chip = gpiod_chip_open_lookup(chip);
	bool good = l->chip ||
		    refuse(error, chip, NULL,
			    errno == EACCES || errno == EPERM
				    ? "may not be used: whoever scans must be in the group 'gpio'"
				    : "cannot be found");
	for (size_t i = 0; good && i < count; i++)
		good = request(l, chip, i, &lines[i], error);
	if (good)
		return &l->base;
	free_1(&l->base);
	return NULL;
}
#endif
