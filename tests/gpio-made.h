#ifndef TESTS_GPIO_MADE_H
#define TESTS_GPIO_MADE_H
/* A GPIO chip in the test's own process: what the stage sets is kept with its instants, and inputs are moved as the test likes. Lines are named
 * as the keys of [stage]. */
#include "firmware-io/gpio-lines.h"
#include "firmware-io/inbox.h"
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

#define GPIO_MADE_LINES 16

struct made_change {
	size_t line;
	bool on;
	int64_t time_ns;
};

struct made_chip {
	gpio_lines base;
	GMutex lock;
	size_t count;
	char *names[GPIO_MADE_LINES];
	bool levels[GPIO_MADE_LINES];
	GArray *changes; /* of struct made_change: of outputs */
	GArray *edges;   /* of struct gpio_edge, that nobody has read */
	bool gone;
	/* Called with the lock held for each pulse of STEP. */
	void (*stepped)(struct made_chip *c, int direction, int64_t time_ns);
	void *data;
};

/* The one that was opened last; inputs that are off from the start are listed before, by name. */
static struct made_chip *made_chip;
static const char *made_off[4];
static void (*made_stepped)(struct made_chip *c, int direction, int64_t time_ns);
static void *made_data;

static inline int made_line(const struct made_chip *c, const char *name)
{
	for (size_t i = 0; i < c->count; i++)
		if (strcmp(c->names[i], name) == 0)
			return (int)i;
	return -1;
}

static inline bool made_set(gpio_lines *l, size_t line, bool on)
{
	struct made_chip *c = (struct made_chip *)l;
	g_mutex_lock(&c->lock);
	struct made_change change = { line, on, inbox_now_ns() };
	bool good = !c->gone;
	if (good && c->levels[line] != on)
		g_array_append_val(c->changes, change);
	bool pulse = good && on && !c->levels[line] && strcmp(c->names[line], "step") == 0;
	c->levels[line] = on;
	if (pulse && c->stepped)
		c->stepped(c, c->levels[made_line(c, "dir")] ? 1 : -1, change.time_ns);
	g_mutex_unlock(&c->lock);
	return good;
}

static inline int made_get(gpio_lines *l, size_t line)
{
	struct made_chip *c = (struct made_chip *)l;
	g_mutex_lock(&c->lock);
	int level = c->gone ? -1 : c->levels[line];
	g_mutex_unlock(&c->lock);
	return level;
}

static inline gssize made_read(gpio_lines *l, struct gpio_edge *edges, size_t room)
{
	struct made_chip *c = (struct made_chip *)l;
	uint64_t any;
	g_mutex_lock(&c->lock);
	size_t n = MIN(room, c->edges->len);
	if (n > 0)
		memcpy(edges, c->edges->data, n * sizeof *edges);
	g_array_remove_range(c->edges, 0, (guint)n);
	if (c->edges->len == 0 && read(l->fd, &any, sizeof any) < 0)
		n += 0; /* nothing waited */
	gssize got = c->gone ? -1 : (gssize)n;
	g_mutex_unlock(&c->lock);
	return got;
}

static inline void made_free(gpio_lines *l)
{
	struct made_chip *c = (struct made_chip *)l;
	for (size_t i = 0; i < c->count; i++)
		g_free(c->names[i]);
	g_array_unref(c->changes);
	g_array_unref(c->edges);
	close(l->fd);
	g_mutex_clear(&c->lock);
	if (made_chip == c)
		made_chip = NULL;
	g_free(c);
}

/* With the lock held. */
static inline void made_pull_locked(struct made_chip *c, const char *name, bool on)
{
	int line = made_line(c, name);
	uint64_t one = 1;
	if (line < 0 || c->levels[line] == on)
		return;
	struct gpio_edge e = { (size_t)line, on, inbox_now_ns() };
	c->levels[line] = on;
	g_array_append_val(c->edges, e);
	g_assert_cmpint(write(c->base.fd, &one, sizeof one), ==, sizeof one);
}

static inline void made_pull(const char *name, bool on)
{
	g_mutex_lock(&made_chip->lock);
	made_pull_locked(made_chip, name, on);
	g_mutex_unlock(&made_chip->lock);
}

/* A level whose edge got lost. */
static inline void made_pull_silently(const char *name, bool on)
{
	g_mutex_lock(&made_chip->lock);
	made_chip->levels[made_line(made_chip, name)] = on;
	g_mutex_unlock(&made_chip->lock);
}

static inline bool made_level(const char *name)
{
	g_mutex_lock(&made_chip->lock);
	bool level = made_chip->levels[made_line(made_chip, name)];
	g_mutex_unlock(&made_chip->lock);
	return level;
}

static inline gpio_lines *made_open(
	const char *chip, const struct gpio_line_desc *lines, size_t count, GError **error)
{
	static const struct gpio_lines_ops ops = { made_set, made_get, made_read, made_free };
	struct made_chip *c = g_new0(struct made_chip, 1);
	(void)chip;
	(void)error;
	c->base = (gpio_lines){ &ops, eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK) };
	g_mutex_init(&c->lock);
	c->count = count;
	c->changes = g_array_new(FALSE, FALSE, sizeof(struct made_change));
	c->edges = g_array_new(FALSE, FALSE, sizeof(struct gpio_edge));
	c->stepped = made_stepped;
	c->data = made_data;
	for (size_t i = 0; i < count; i++) {
		c->names[i] = g_strdup(lines[i].line);
		/* Contacts that guard people are closed while all is well. */
		c->levels[i] = strcmp(lines[i].line, "estop") == 0 ||
			       strcmp(lines[i].line, "interlock") == 0;
		for (size_t k = 0; k < G_N_ELEMENTS(made_off); k++)
			if (g_strcmp0(lines[i].line, made_off[k]) == 0)
				c->levels[i] = false;
	}
	made_chip = c;
	return &c->base;
}

#endif
