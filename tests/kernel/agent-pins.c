#include "tests/kernel/agent.h"
#include <errno.h>
#include <fcntl.h>
#include <gio/gio.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mount.h>
#include <sys/stat.h>
#include <unistd.h>

#define CONFIG  "/sys/kernel/config"
#define TRACING "/sys/kernel/tracing"
#define BANK    CONFIG "/gpio-sim/head/bank0"

static const char *const names[PIN_COUNT] = { "step", "dir", "enable", "home", "index", "estop",
	"interlock", "button", "sync", "led_ready", "led_emitting", "led_fault" };

struct pins {
	pins_func changed;
	gpointer data;
	guint base; /* of the chip's lines, among all */
	int pulls[PIN_COUNT];
	int trace;
	GString *text;
};

int pin_by_name(const char *name)
{
	for (int i = 0; i < PIN_COUNT; i++)
		if (strcmp(names[i], name) == 0)
			return i;
	return -1;
}

static bool put(const char *path, const char *text, GError **error)
{
	int fd = open(path, O_WRONLY | O_CLOEXEC | O_TRUNC);
	bool good = fd >= 0 && write(fd, text, strlen(text)) == (ssize_t)strlen(text);
	int number = errno;

	if (fd >= 0)
		close(fd);
	if (!good)
		g_set_error(error, G_IO_ERROR, g_io_error_from_errno(number), "%s: %s", path,
			g_strerror(number));
	return good;
}

static char *get(const char *path)
{
	char *text = NULL;

	if (g_file_get_contents(path, &text, NULL, NULL))
		g_strstrip(text);
	return text;
}

static void mount_if_missing(const char *type, const char *path, const char *shows)
{
	g_autofree char *inside = g_build_filename(path, shows, NULL);

	if (!g_file_test(inside, G_FILE_TEST_EXISTS))
		mount(type, path, type, 0, NULL);
}

static bool make_chip(const char *label, GError **error)
{
	g_autofree char *lines = g_strdup_printf("%d", PIN_COUNT);

	mkdir(CONFIG "/gpio-sim/head", 0755);
	mkdir(BANK, 0755);
	if (!put(BANK "/num_lines", lines, error) || !put(BANK "/label", label, error))
		return false;
	for (int i = 0; i < PIN_COUNT; i++) {
		g_autofree char *line = g_strdup_printf(BANK "/line%d", i),
				*name = g_strconcat(line, "/name", NULL);

		mkdir(line, 0755);
		if (!put(name, names[i], error))
			return false;
	}
	return put(CONFIG "/gpio-sim/head/live", "1", error);
}

/* The numbers that the trace calls the lines by. */
static bool find_base(pins *p, const char *label, GError **error)
{
	GDir *dir = g_dir_open("/sys/class/gpio", 0, error);

	if (!dir)
		return false;
	bool found = false;

	for (const char *entry; !found && (entry = g_dir_read_name(dir));) {
		g_autofree char *path = g_strdup_printf("/sys/class/gpio/%s/label", entry),
				*text = get(path);

		found = text && strcmp(text, label) == 0 &&
			sscanf(entry, "gpiochip%u", &p->base) == 1;
	}
	g_dir_close(dir);
	if (!found)
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND,
			"/sys/class/gpio has no chip %s", label);
	return found;
}

static bool open_pulls(pins *p, GError **error)
{
	g_autofree char *device = get(CONFIG "/gpio-sim/head/dev_name"),
			*chip = get(BANK "/chip_name");

	for (int i = 0; i < PIN_COUNT; i++) {
		g_autofree char *path = g_strdup_printf(
			"/sys/devices/platform/%s/%s/sim_gpio%d/pull", device, chip, i);

		p->pulls[i] = open(path, O_WRONLY | O_CLOEXEC);
		if (p->pulls[i] < 0) {
			g_set_error(error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND, "%s: %s", path,
				g_strerror(errno));
			return false;
		}
	}
	return true;
}

/* "  name-123 [000] d..1. 12.345678: gpio_value: 509 set 1" */
static void take_line(pins *p, const char *line)
{
	const char *event = strstr(line, ": gpio_value: ");
	unsigned number;
	int level;

	if (!event || sscanf(event, ": gpio_value: %u set %d", &number, &level) != 2)
		return;
	const char *from = event;

	while (from > line && from[-1] != ' ')
		from--;
	char *point;
	int64_t at_ns = strtoll(from, &point, 10) * INT64_C(1000000000);

	if (*point == '.')
		at_ns += strtoll(point + 1, NULL, 10) * 1000;
	if (number >= p->base && number < p->base + PIN_COUNT)
		p->changed((enum pin)(number - p->base), level != 0, at_ns, p->data);
}

static bool drain(pins *p)
{
	char bytes[4096], *begin, *end;
	ssize_t got = read(p->trace, bytes, sizeof bytes);

	if (got <= 0)
		return false;
	g_string_append_len(p->text, bytes, got);
	for (begin = p->text->str; (end = strchr(begin, '\n')); begin = end + 1) {
		*end = '\0';
		take_line(p, begin);
	}
	g_string_erase(p->text, 0, begin - p->text->str);
	return true;
}

/* Being woken by each pulse would leave no time for whoever makes them. The trace keeps the times. */
void pins_look(pins *p)
{
	while (drain(p))
		;
}

static bool watch(pins *p, GError **error)
{
	/* Of a pulse, only its beginning. */
	g_autofree char *filter =
		g_strdup_printf("get==0 && (gpio!=%u || value==1)", p->base + PIN_STEP);

	if (!put(TRACING "/trace_clock", "mono", error) ||
		!put(TRACING "/events/gpio/gpio_value/filter", filter, error) ||
		!put(TRACING "/events/gpio/gpio_value/enable", "1", error))
		return false;
	p->trace = open(TRACING "/trace_pipe", O_RDONLY | O_NONBLOCK | O_CLOEXEC);
	if (p->trace < 0) {
		g_set_error(
			error, G_IO_ERROR, G_IO_ERROR_FAILED, "trace_pipe: %s", g_strerror(errno));
		return false;
	}
	return true;
}

pins *pins_new(const char *label, pins_func changed, gpointer data, GError **error)
{
	pins *p = g_new0(pins, 1);

	p->changed = changed;
	p->data = data;
	p->text = g_string_new(NULL);
	p->trace = -1;
	for (int i = 0; i < PIN_COUNT; i++)
		p->pulls[i] = -1;
	mount_if_missing("configfs", CONFIG, "gpio-sim");
	mount_if_missing("tracefs", TRACING, "trace_pipe");
	if (make_chip(label, error) && find_base(p, label, error) && open_pulls(p, error) &&
		watch(p, error))
		return p;
	pins_free(p);
	return NULL;
}

void pins_pull(pins *p, enum pin pin, bool level)
{
	const char *text = level ? "pull-up" : "pull-down";

	if (pwrite(p->pulls[pin], text, strlen(text), 0) < 0)
		g_warning("%s: %s", names[pin], g_strerror(errno));
}

void pins_free(pins *p)
{
	if (!p)
		return;
	for (int i = 0; i < PIN_COUNT; i++)
		if (p->pulls[i] >= 0)
			close(p->pulls[i]);
	if (p->trace >= 0)
		close(p->trace);
	put(TRACING "/events/gpio/gpio_value/enable", "0", NULL);
	put(CONFIG "/gpio-sim/head/live", "0", NULL);
	g_string_free(p->text, TRUE);
	g_free(p);
}
