/* Fingers and keys. */
#include "tests/kiosk-rig-private.h"
#include <linux/input-event-codes.h>
#include <math.h>
#include <string.h>

enum { step_us = 16000, rest_steps = 6 };
static const double wait_s = 20;

void rig_send(rig *r, const char *lines, int count)
{
	g_autoptr(GError) error = NULL;
	if (!rig_line_ask(&r->touch, lines, count, NULL, &error))
		rig_fail(r, "%s; asked was: %s", error->message, lines);
}

void rig_say(rig *r, const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	g_autofree char *line = g_strdup_vprintf(format, arguments);
	va_end(arguments);
	g_autofree char *ended = g_strconcat(line, "\n", NULL);
	rig_send(r, ended, 1);
}

/* Down and up in one go, so that no slow machine makes a tap a hold. */
static void add_tap(GString *lines, double x, double y)
{
	g_string_append_printf(lines, "down 0 %.2f %.2f\nframe\nlater 40\nup 0\nframe\n", x, y);
}

void rig_tap_at(rig *r, double x, double y)
{
	g_autoptr(GString) lines = g_string_new(NULL);
	add_tap(lines, x, y);
	rig_send(r, lines->str, 5);
}

static void middle_of(rig *r, const char *name, double *x, double *y)
{
	struct rig_place place = rig_wait_for(r, name, wait_s);
	*x = place.x + place.width / 2;
	*y = place.y + place.height / 2;
}

void rig_tap(rig *r, const char *name)
{
	double x, y;
	middle_of(r, name, &x, &y);
	rig_tap_at(r, x, y);
}

void rig_double_tap(rig *r, const char *name)
{
	g_autoptr(GString) lines = g_string_new(NULL);
	double x, y;
	middle_of(r, name, &x, &y);
	add_tap(lines, x, y);
	g_string_append(lines, "later 80\n");
	add_tap(lines, x, y);
	rig_send(r, lines->str, 11);
}

void rig_hold(rig *r, const char *name, double seconds)
{
	double x, y;
	middle_of(r, name, &x, &y);
	g_autofree char *down = g_strdup_printf("down 0 %.2f %.2f\nframe\n", x, y);
	rig_send(r, down, 2);
	g_usleep(seconds * G_USEC_PER_SEC);
	rig_send(r, "up 0\nframe\n", 2);
}

/* ---- movements ---- */

/* Where a finger is when a share of the way is done. */
struct way {
	int fingers;
	double from_x, from_y, to_x, to_y;                 /* of the middle */
	double from_apart, to_apart, from_angle, to_angle; /* of two fingers */
};

static void add_fingers(GString *lines, const struct way *way, const char *verb, double share)
{
	double x = way->from_x + share * (way->to_x - way->from_x);
	double y = way->from_y + share * (way->to_y - way->from_y);
	double apart = way->from_apart + share * (way->to_apart - way->from_apart);
	double angle = way->from_angle + share * (way->to_angle - way->from_angle);
	for (int i = 0; i < way->fingers; i++) {
		double side = (i ? 0.5 : -0.5) * apart;
		g_string_append_printf(lines, "%s %d %.2f %.2f\n", verb, i, x + side * cos(angle),
			y + side * sin(angle));
	}
	g_string_append(lines, "frame\n");
}

static void send_fingers(rig *r, const struct way *way, const char *verb, double share)
{
	g_autoptr(GString) lines = g_string_new(NULL);
	add_fingers(lines, way, verb, share);
	rig_send(r, lines->str, way->fingers + 1);
}

/* Steps come at the pace of a real panel: GTK joins what comes within one frame. */
static void move_fingers(rig *r, const struct way *way, double seconds)
{
	int steps = MAX(4, (int)(seconds * G_USEC_PER_SEC / step_us));
	send_fingers(r, way, "down", 0);
	for (int i = 1; i <= steps + rest_steps; i++) {
		g_usleep(step_us);
		/* A finger at rest still trembles, by less than shows. */
		send_fingers(r, way, "move", MIN(1.0, (double)i / steps) - (i % 2) * 1e-4);
	}
	send_fingers(r, way, "move", 1);
	rig_send(r, way->fingers == 2 ? "up 0\nup 1\nframe\n" : "up 0\nframe\n", way->fingers + 1);
}

void rig_drag(rig *r, double from_x, double from_y, double to_x, double to_y, double seconds)
{
	struct way way = {
		.fingers = 1, .from_x = from_x, .from_y = from_y, .to_x = to_x, .to_y = to_y
	};
	move_fingers(r, &way, seconds);
}

void rig_pinch(rig *r, double x, double y, double from, double to, double seconds)
{
	struct way way = { .fingers = 2,
		.from_x = x,
		.from_y = y,
		.to_x = x,
		.to_y = y,
		.from_apart = from,
		.to_apart = to };
	move_fingers(r, &way, seconds);
}

void rig_twist(rig *r, double x, double y, double distance, double angle, double seconds)
{
	struct way way = { .fingers = 2,
		.from_x = x,
		.from_y = y,
		.to_x = x,
		.to_y = y,
		.from_apart = distance,
		.to_apart = distance,
		.to_angle = angle };
	move_fingers(r, &way, seconds);
}

void rig_two_finger_pan(
	rig *r, double from_x, double from_y, double to_x, double to_y, double seconds)
{
	struct way way = { .fingers = 2,
		.from_x = from_x,
		.from_y = from_y,
		.to_x = to_x,
		.to_y = to_y,
		.from_apart = 120,
		.to_apart = 120 };
	move_fingers(r, &way, seconds);
}

/* How far one drag goes along one axis: the way to the middle of the list, but less than is safely inside it. Nowhere where the place is
 * in the list already. */
static double drag_towards(double list, double list_size, double place, double size)
{
	double longest = 0.35 * list_size;
	if (place >= list && place + size <= list + list_size)
		return 0;
	return CLAMP(list + list_size / 2 - (place + size / 2), -longest, longest);
}

void rig_scroll_to(rig *r, const char *list, const char *name)
{
	enum { drags_at_most = 60 };
	struct rig_place place;
	for (int i = 0; i < drags_at_most; i++) {
		struct rig_place frame = rig_wait_for(r, list, wait_s);
		if (!rig_find(r, name, &place))
			rig_fail(r, "'%s' is not in '%s'", name, list);
		/* What was flung goes on for a while. */
		if (place.reachable) {
			g_usleep(400000);
			if (rig_find(r, name, &place) && place.reachable)
				return;
			continue;
		}
		double x = frame.x + frame.width / 2, y = frame.y + frame.height / 2;
		double right = drag_towards(frame.x, frame.width, place.x, place.width);
		double down = drag_towards(frame.y, frame.height, place.y, place.height);
		rig_drag(r, x - right / 2, y - down / 2, x + right / 2, y + down / 2, 0.15);
	}
	rig_fail(r, "'%s' cannot be scrolled to in '%s'", name, list);
}

/* ---- keys ---- */

/* The rows of a US keyboard, from the code of their first key on. */
static const struct key_row {
	unsigned first;
	const char *plain, *shifted;
} key_rows[] = {
	{ KEY_1, "1234567890-=\b\t", "!@#$%^&*()_+" },
	{ KEY_Q, "qwertyuiop[]\n", "QWERTYUIOP{}" },
	{ KEY_A, "asdfghjkl;'`", "ASDFGHJKL:\"~" },
	{ KEY_BACKSLASH, "\\zxcvbnm,./", "|ZXCVBNM<>?" },
	{ KEY_SPACE, " ", "" },
};

static unsigned code_of(rig *r, char letter, bool *shift)
{
	for (size_t i = 0; i < G_N_ELEMENTS(key_rows); i++) {
		const char *plain = strchr(key_rows[i].plain, letter);
		const char *shifted = strchr(key_rows[i].shifted, letter);
		*shift = !plain;
		if (plain)
			return key_rows[i].first + (plain - key_rows[i].plain);
		if (shifted)
			return key_rows[i].first + (shifted - key_rows[i].shifted);
	}
	rig_fail(r, "no key types '%c'", letter);
}

void rig_key(rig *r, unsigned code)
{
	g_autofree char *lines =
		g_strdup_printf("key %u 1\nlater 10\nkey %u 0\nlater 10\n", code, code);
	rig_send(r, lines, 4);
}

void rig_type(rig *r, const char *text)
{
	for (; *text; text++) {
		bool shift;
		unsigned code = code_of(r, *text, &shift);
		if (shift)
			rig_say(r, "key %d 1", KEY_LEFTSHIFT);
		rig_key(r, code);
		if (shift)
			rig_say(r, "key %d 0", KEY_LEFTSHIFT);
	}
}
