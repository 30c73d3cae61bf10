/* Lines by the second API of libgpiod. */
#include "firmware-io/gpio-lines.h"
#if GPIOD_API_VERSION == 2
#include "firmware-io/wire.h"
#include <errno.h>
#include <gpiod.h>
#include <string.h>
#include <unistd.h>

#define CONSUMER "pleinair"
#define AT_ONCE  64

struct lines_2 {
	gpio_lines base; /* fd is the request's */
	struct gpiod_chip *chip;
	struct gpiod_line_request *request;
	struct gpiod_edge_event_buffer *buffer;
	unsigned *offsets;
	size_t count;
};

static bool refuse(GError **error, const char *chip, const char *line, const char *what)
{
	g_set_error(error, WIRE_ERROR, WIRE_ERROR_BROKEN, "the pan stage: %s%s%s of %s %s",
		line ? "line '" : "", line ? line : "", line ? "'" : "the pins", chip, what);
	return false;
}

/* By its path, its name in /dev, or its label. */
static struct gpiod_chip *open_chip(const char *name)
{
	g_autofree char *path = *name == '/' ? g_strdup(name) : g_strconcat("/dev/", name, NULL);
	struct gpiod_chip *chip = gpiod_chip_open(path);
	g_autoptr(GDir) dir = chip ? NULL : g_dir_open("/dev", 0, NULL);
	int why = errno;
	for (const char *entry; !chip && dir && (entry = g_dir_read_name(dir));) {
		if (!g_str_has_prefix(entry, "gpiochip"))
			continue;
		g_autofree char *other = g_strconcat("/dev/", entry, NULL);
		chip = gpiod_chip_open(other);
		struct gpiod_chip_info *info = chip ? gpiod_chip_get_info(chip) : NULL;
		bool found = info && strcmp(gpiod_chip_info_get_label(info), name) == 0;
		if (info)
			gpiod_chip_info_free(info);
		if (chip && !found)
			gpiod_chip_close(g_steal_pointer(&chip));
	}
	errno = why;
	return chip;
}

static int find_offset(struct gpiod_chip *chip, const char *name)
{
	char *end;
	int offset = gpiod_chip_get_line_offset_from_name(chip, name);
	guint64 number = g_ascii_strtoull(name, &end, 10);
	return offset >= 0                                    ? offset
	       : end != name && !*end && number < G_MAXUINT16 ? (int)number
							      : -1;
}

static bool add_line(struct lines_2 *l, struct gpiod_line_config *config, size_t i,
	const struct gpio_line_desc *d)
{
	struct gpiod_line_settings *s = gpiod_line_settings_new();
	gpiod_line_settings_set_active_low(s, d->active_low);
	gpiod_line_settings_set_direction(
		s, d->output ? GPIOD_LINE_DIRECTION_OUTPUT : GPIOD_LINE_DIRECTION_INPUT);
	if (d->output)
		gpiod_line_settings_set_output_value(s, GPIOD_LINE_VALUE_INACTIVE);
	else
		gpiod_line_settings_set_edge_detection(s, GPIOD_LINE_EDGE_BOTH);
	gpiod_line_settings_set_event_clock(s, GPIOD_LINE_CLOCK_MONOTONIC);
	bool good = gpiod_line_config_add_line_settings(config, &l->offsets[i], 1, s) == 0;
	gpiod_line_settings_free(s);
	return good;
}

static bool request(
	struct lines_2 *l, const char *chip, const struct gpio_line_desc *lines, GError **error)
{
	struct gpiod_line_config *config = gpiod_line_config_new();
	struct gpiod_request_config *request = gpiod_request_config_new();
	bool good = true;
	gpiod_request_config_set_consumer(request, CONSUMER);
	for (size_t i = 0; good && i < l->count; i++) {
		int offset = find_offset(l->chip, lines[i].line);
		l->offsets[i] = (unsigned)offset;
		good = offset >= 0 && add_line(l, config, i, &lines[i]);
		if (!good)
			refuse(error, chip, lines[i].line, "is not there");
	}
	l->request = good ? gpiod_chip_request_lines(l->chip, request, config) : NULL;
	if (good && !l->request)
		good = refuse(error, chip, NULL,
			errno == EBUSY ? "are in use by another program" : g_strerror(errno));
	gpiod_request_config_free(request);
	gpiod_line_config_free(config);
	return good;
}

static bool set_2(gpio_lines *base, size_t line, bool on)
{
	struct lines_2 *l = (struct lines_2 *)base;
	return gpiod_line_request_set_value(l->request, l->offsets[line],
		       on ? GPIOD_LINE_VALUE_ACTIVE : GPIOD_LINE_VALUE_INACTIVE) == 0;
}

static int get_2(gpio_lines *base, size_t line)
{
	struct lines_2 *l = (struct lines_2 *)base;
	enum gpiod_line_value v = gpiod_line_request_get_value(l->request, l->offsets[line]);
	return v == GPIOD_LINE_VALUE_ERROR ? -1 : v == GPIOD_LINE_VALUE_ACTIVE;
}

static size_t line_of(const struct lines_2 *l, unsigned offset)
{
	for (size_t i = 0; i < l->count; i++)
		if (l->offsets[i] == offset)
			return i;
	return 0;
}

static gssize read_2(gpio_lines *base, struct gpio_edge *edges, size_t room)
{
	struct lines_2 *l = (struct lines_2 *)base;
	int waiting = gpiod_line_request_wait_edge_events(l->request, 0);
	if (waiting <= 0)
		return waiting;
	int n = gpiod_line_request_read_edge_events(l->request, l->buffer, MIN(room, AT_ONCE));
	for (int k = 0; k < n; k++) {
		struct gpiod_edge_event *e =
			gpiod_edge_event_buffer_get_event(l->buffer, (unsigned long)k);
		edges[k] = (struct gpio_edge){ .line = line_of(
						       l, gpiod_edge_event_get_line_offset(e)),
			.on = gpiod_edge_event_get_event_type(e) == GPIOD_EDGE_EVENT_RISING_EDGE,
			.time_ns = (int64_t)gpiod_edge_event_get_timestamp_ns(e) };
	}
	return n;
}

static void free_2(gpio_lines *base)
{
	struct lines_2 *l = (struct lines_2 *)base;
	if (l->request)
		gpiod_line_request_release(l->request);
	if (l->buffer)
		gpiod_edge_event_buffer_free(l->buffer);
	if (l->chip)
		gpiod_chip_close(l->chip);
	g_free(l->offsets);
	g_free(l);
}

static const struct gpio_lines_ops ops_2 = {
	.set = set_2, .get = get_2, .read = read_2, .free = free_2
};

gpio_lines *gpio_lines_open(
	const char *chip, const struct gpio_line_desc *lines, size_t count, GError **error)
{
	struct lines_2 *l = g_new0(struct lines_2, 1);
	l->base = (gpio_lines){ &ops_2, -1 };
	l->offsets = g_new0(unsigned, count);
	l->count = count;
	l->buffer = gpiod_edge_event_buffer_new(AT_ONCE);
	l->chip = open_chip(chip);
	bool good = l->chip ? request(l, chip, lines, error)
			    : refuse(error, chip, NULL,
				      errno == EACCES || errno == EPERM
					      ? "may not be used: whoever scans must be in the "
						"group 'gpio'"
					      : "cannot be found");
	if (!good) {
		free_2(&l->base);
		return NULL;
	}
	l->base.fd = gpiod_line_request_get_fd(l->request);
	return &l->base;
}
#endif
