/* What the program shows, and waiting for it. */
#include "tests/kiosk-rig-private.h"
#include <glib/gstdio.h>
#include <stdio.h>
#include <string.h>

enum { poll_us = 30000, still_wanted = 2 };

/* NULL where the program says that there is no such thing. */
static char *ask(rig *r, const char *question, const char *name)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *line =
		g_strdup_printf("%s%s%s\n", question, name ? " " : "", name ? name : "");
	g_autoptr(GString) text = g_string_new(NULL);
	if (!r->probe.connection)
		rig_fail(r, "the program does not run, and was asked '%s'", g_strchomp(line));
	if (rig_line_ask(&r->probe, line, 1, text, &error))
		return g_string_free(g_steal_pointer(&text), FALSE);
	if (!g_error_matches(error, G_IO_ERROR, G_IO_ERROR_FAILED)) {
		rig_line_close(&r->probe);
		rig_fail(r, "'%s': %s", g_strchomp(line), error->message);
	}
	return NULL;
}

bool rig_find(rig *r, const char *name, struct rig_place *place)
{
	g_autofree char *said = ask(r, "find", name);
	int reachable, sensitive;
	if (!said)
		return false;
	if (sscanf(said, "%lf %lf %lf %lf %d %d", &place->x, &place->y, &place->width,
		    &place->height, &reachable, &sensitive) != 6)
		rig_fail(r, "'%s' is said to be at '%s'", name, said);
	place->reachable = reachable;
	place->sensitive = sensitive;
	return true;
}

static bool same_place(const struct rig_place *a, const struct rig_place *b)
{
	return a->x == b->x && a->y == b->y && a->width == b->width && a->height == b->height;
}

static gint64 limit_of(double seconds)
{
	return g_get_monotonic_time() + seconds * G_USEC_PER_SEC;
}

struct rig_place rig_wait_for(rig *r, const char *name, double seconds)
{
	struct rig_place last = { 0 }, place;
	int still = 0;
	for (gint64 limit_us = limit_of(seconds); g_get_monotonic_time() < limit_us;
		g_usleep(poll_us)) {
		bool ready = rig_find(r, name, &place) && place.reachable && place.sensitive;
		still = ready && same_place(&place, &last) ? still + 1 : 0;
		if (still == still_wanted)
			return place;
		last = ready ? place : (struct rig_place){ 0 };
	}
	rig_fail(r, "'%s' could not be touched within %g s", name, seconds);
}

void rig_wait_gone(rig *r, const char *name, double seconds)
{
	struct rig_place place;
	for (gint64 limit_us = limit_of(seconds); g_get_monotonic_time() < limit_us;
		g_usleep(poll_us))
		if (!rig_find(r, name, &place))
			return;
	rig_fail(r, "'%s' was still there after %g s", name, seconds);
}

char *rig_text(rig *r, const char *name)
{
	char *text = ask(r, "text", name);
	if (!text)
		rig_fail(r, "'%s' is not shown, and so says nothing", name);
	text[strcspn(text, "\n")] = '\0';
	return text;
}

char *rig_state(rig *r, const char *key)
{
	g_autofree char *said = ask(r, "state", NULL);
	g_auto(GStrv) lines = g_strsplit(said, "\n", -1);
	size_t length = strlen(key);
	for (char **line = lines; *line; line++)
		if (strncmp(*line, key, length) == 0 && (*line)[length] == '=')
			return g_strdup(*line + length + 1);
	return NULL;
}

void rig_wait_state(rig *r, const char *key, const char *value, double seconds)
{
	g_autofree char *now = NULL;
	for (gint64 limit_us = limit_of(seconds); g_get_monotonic_time() < limit_us;
		g_usleep(poll_us)) {
		g_free(now);
		now = rig_state(r, key);
		if (g_strcmp0(now, value) == 0)
			return;
	}
	rig_fail(r, "%s is '%s', not '%s', after %g s", key, now ? now : "unknown", value, seconds);
}

static void wait_says(rig *r, const char *name, const char *text, bool whole, double seconds)
{
	g_autofree char *now = NULL;
	for (gint64 limit_us = limit_of(seconds); g_get_monotonic_time() < limit_us;
		g_usleep(poll_us)) {
		g_free(now);
		now = ask(r, "text", name);
		if (now && (whole ? strcmp(g_strchomp(now), text) == 0 : strstr(now, text) != NULL))
			return;
	}
	rig_fail(r, "'%s' says '%s', not '%s', after %g s", name, now ? now : "nothing", text,
		seconds);
}

void rig_wait_text(rig *r, const char *name, const char *text, double seconds)
{
	wait_says(r, name, text, true, seconds);
}

void rig_wait_words(rig *r, const char *name, const char *part, double seconds)
{
	wait_says(r, name, part, false, seconds);
}

char *rig_list(rig *r)
{
	return ask(r, "list", NULL);
}

char *rig_controls(rig *r)
{
	return ask(r, "controls", NULL);
}

char *rig_focus(rig *r)
{
	return g_strstrip(ask(r, "focus", NULL));
}

guint64 rig_frames(rig *r)
{
	g_autofree char *said = ask(r, "frames", NULL);
	return g_ascii_strtoull(said, NULL, 10);
}

static void wait_painted(rig *r)
{
	enum { quiet_wanted = 4, polls_at_most = 34 };
	guint64 last = rig_frames(r);
	for (int i = 0, quiet = 0; quiet < quiet_wanted && i < polls_at_most; i++) {
		g_usleep(poll_us);
		guint64 now = rig_frames(r);
		quiet = now == last ? quiet + 1 : 0;
		last = now;
	}
}

void rig_shot(rig *r, const char *path)
{
	g_autofree char *full = g_canonicalize_filename(path, NULL);
	wait_painted(r);
	rig_say(r, "shot %s", full);
}

void rig_keep_shot(rig *r, const char *name)
{
	const char *folder = g_getenv("PLEINAIR_SHOTS");
	if (!folder)
		return;
	g_mkdir_with_parents(folder, 0755);
	g_autofree char *path = g_strdup_printf("%s/%s.png", folder, name);
	rig_shot(r, path);
}
