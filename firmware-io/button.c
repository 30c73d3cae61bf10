#include "firmware-io/button.h"
#include <glib-unix.h>
#include <string.h>

#define BOUNCE_NS INT64_C(30000000)
#define EDGES     16

struct button {
	gpio_lines *lines;
	guint source;
	int64_t edge_ns;
	void (*pressed)(gpointer user_data);
	gpointer user_data;
};

/* True: pressed, by the first of several edges that are close together. */
static bool take(struct button *b, const struct gpio_edge *e)
{
	bool first = b->edge_ns == 0 || e->time_ns - b->edge_ns >= BOUNCE_NS;
	b->edge_ns = e->time_ns;
	return first && e->on;
}

static gboolean look(gint fd, GIOCondition condition, gpointer user_data)
{
	struct button *b = user_data;
	struct gpio_edge edges[EDGES];
	bool pressed = false;
	(void)fd;
	(void)condition;
	gssize n = gpio_lines_read(b->lines, edges, EDGES);
	for (gssize i = 0; i < n; i++)
		pressed |= take(b, &edges[i]);
	if (n < 0) {
		b->source = 0;
		return G_SOURCE_REMOVE;
	}
	if (pressed)
		b->pressed(b->user_data); /* b may be gone */
	return G_SOURCE_CONTINUE;
}

button *button_new_on(const char *device, gpio_opener open, void (*pressed)(gpointer user_data),
	gpointer user_data, GError **error)
{
	if (g_str_has_prefix(device, "sim:") || g_str_has_prefix(device, "replay:"))
		return NULL;
	g_autoptr(parts) p = parts_read(device, error);
	const char *chip = p ? parts_text(p, "stage", "chip") : NULL,
		   *line = p ? parts_text(p, "stage", "button") : NULL,
		   *low = p ? parts_text(p, "stage", "active_low") : NULL;
	if (!chip || !line || strcmp(chip, "none") == 0)
		return NULL;
	g_auto(GStrv) lows = g_strsplit_set(low ? low : "", ", ;", -1);
	struct gpio_line_desc desc = { line, false,
		g_strv_contains((const char *const *)lows, "button") };
	gpio_lines *lines = open(chip, &desc, 1, error);
	if (!lines)
		return NULL;
	button *b = g_new0(button, 1);
	*b = (button){ .lines = lines, .pressed = pressed, .user_data = user_data };
	b->source = g_unix_fd_add(lines->fd, G_IO_IN, look, b);
	return b;
}

button *button_new(
	const char *device, void (*pressed)(gpointer user_data), gpointer user_data, GError **error)
{
	return button_new_on(device, gpio_lines_open, pressed, user_data, error);
}

void button_free(button *b)
{
	if (!b)
		return;
	g_clear_handle_id(&b->source, g_source_remove);
	gpio_lines_free(b->lines);
	g_free(b);
}
