#include "render/kiosk/take-words.h"
#include "render/kiosk/site-words.h"
#include <glib/gi18n.h>
#include <json-glib/json-glib.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

char *words_left(double seconds)
{
	if (!(seconds >= 0))
		return g_strdup("");
	if (seconds < 50)
		return g_strdup_printf(_("about %.0f s left"), fmax(5, 5 * ceil(seconds / 5)));
	if (seconds < 5400)
		return g_strdup_printf(_("about %.0f min left"), ceil(seconds / 60));
	return g_strdup_printf(_("about %.1f h left"), seconds / 3600);
}

static const char *word_of_kind(enum export_kind kind)
{
	switch (kind) {
	case EXPORT_PICTURE: return _("Picture");
	case EXPORT_DRAWING: return _("Drawing");
	case EXPORT_FILM: return _("Film");
	case EXPORT_REPORT: return _("Report");
	case EXPORT_POINTS: return _("Points");
	case EXPORT_FOLDER: return _("Folder");
	default: return _("File");
	}
}

static char *time_in_words(int64_t us, int64_t now_us)
{
	g_autoptr(GDateTime) then = g_date_time_new_from_unix_local(us / G_USEC_PER_SEC);
	g_autoptr(GDateTime) now = g_date_time_new_from_unix_local(now_us / G_USEC_PER_SEC);
	g_autofree char *clock = g_date_time_format(then, "%H:%M");
	if (g_date_time_get_year(then) == g_date_time_get_year(now) &&
		g_date_time_get_day_of_year(then) == g_date_time_get_day_of_year(now))
		return g_strdup_printf(_("today %s"), clock);
	return g_date_time_format(then, "%Y-%m-%d %H:%M");
}

char *words_export(const export_item *e, int64_t now_us)
{
	g_autofree char *size = g_format_size((guint64)e->bytes);
	g_autofree char *time = time_in_words(e->changed_us, now_us);
	if (e->kind != EXPORT_FOLDER)
		return g_strdup_printf("%s · %s · %s", word_of_kind(e->kind), size, time);
	g_autofree char *files =
		g_strdup_printf(ngettext("%u file", "%u files", e->files), e->files);
	return g_strdup_printf("%s · %s · %s", files, size, time);
}

char *words_view(const char *name)
{
	static const struct {
		const char *name, *words;
	} known[] = {
		{ "overview", N_("Overview") },
		{ "plan", N_("Plan") },
		{ "elevation-north", N_("Elevation from the north") },
		{ "elevation-south", N_("Elevation from the south") },
		{ "elevation-east", N_("Elevation from the east") },
		{ "elevation-west", N_("Elevation from the west") },
		{ "section-a", N_("Section along the building") },
		{ "section-b", N_("Section across the building") },
		{ "walk", N_("Standing in it") },
	};
	for (size_t i = 0; i < G_N_ELEMENTS(known); i++)
		if (!strcmp(known[i].name, name))
			return g_strdup(_(known[i].words));
	if (g_str_has_prefix(name, "plan:"))
		return g_strdup_printf(_("Plan at %s m"), name + strlen("plan:"));
	if (g_str_has_prefix(name, "station-"))
		return g_strdup_printf(_("From station %s"), name + strlen("station-"));
	return g_strdup(name);
}

char *words_drive(const drive *d)
{
	g_autofree char *free_size = g_format_size((guint64)d->free_bytes);
	g_autofree char *size = g_format_size((guint64)d->total_bytes);
	if (!d->is_writable)
		return g_strdup(_("Cannot be written to"));
	if (d->total_bytes <= 0)
		return g_strdup(_("Its room is not known"));
	return g_strdup_printf(_("%s free of %s"), free_size, size);
}

/* NULL: it is none of these. */
static JsonObject *object_of(JsonParser *parser, const char *json)
{
	return json && json_parser_load_from_data(parser, json, -1, NULL) &&
			       JSON_NODE_HOLDS_OBJECT(json_parser_get_root(parser))
		       ? json_node_get_object(json_parser_get_root(parser))
		       : NULL;
}

static JsonArray *array_of(JsonObject *o, const char *key)
{
	JsonNode *n = o ? json_object_get_member(o, key) : NULL;
	return n && JSON_NODE_HOLDS_ARRAY(n) ? json_node_get_array(n) : NULL;
}

char *words_copied(const char *json)
{
	g_autoptr(JsonParser) parser = json_parser_new();
	JsonObject *o = object_of(parser, json);
	if (!o || !json_object_has_member(o, "files") || !json_object_has_member(o, "bytes"))
		return NULL;
	int64_t files = json_object_get_int_member(o, "files");
	g_autofree char *size = g_format_size((guint64)json_object_get_int_member(o, "bytes"));
	return g_strdup_printf(ngettext("%d file, %s, verified by SHA-256",
				       "%d files, %s, all verified by SHA-256", (gulong)files),
		(int)files, size);
}

char *words_brought(const char *json)
{
	g_autoptr(JsonParser) parser = json_parser_new();
	JsonArray *scans = array_of(object_of(parser, json), "scans");
	double points = 0;
	if (!scans)
		return NULL;
	guint count = json_array_get_length(scans);
	for (guint i = 0; i < count; i++)
		points += (double)json_object_get_int_member_with_default(
			json_array_get_object_element(scans, i), "points", 0);
	g_autofree char *many = words_points(points);
	return g_strdup_printf(ngettext("%u scan, %s", "%u scans, %s", count), count, many);
}

static void add_line(GString *lines, const char *format, ...) G_GNUC_PRINTF(2, 3);
static void add_line(GString *lines, const char *format, ...)
{
	va_list args;
	if (lines->len)
		g_string_append_c(lines, '\n');
	va_start(args, format);
	g_string_append_vprintf(lines, format, args);
	va_end(args);
}

static void add_notes_of_scan(GString *lines, JsonObject *scan)
{
	const char *note = json_object_get_string_member_with_default(scan, "note", NULL);
	int64_t number = json_object_get_int_member_with_default(scan, "scan", 0);
	int64_t out = json_object_get_int_member_with_default(scan, "left_out", 0);
	if (note)
		add_line(lines, _("Scan %d: %s."), (int)number, note);
	if (out)
		add_line(lines,
			ngettext("Scan %d: %d point of the file is not to be used.",
				"Scan %d: %d points of the file are not to be used.", (gulong)out),
			(int)number, (int)out);
}

char *words_notes(const char *json)
{
	g_autoptr(JsonParser) parser = json_parser_new();
	g_autoptr(GString) lines = g_string_new(NULL);
	JsonObject *o = object_of(parser, json);
	JsonArray *notes = array_of(o, "notes"), *scans = array_of(o, "scans");
	for (guint i = 0; notes && i < json_array_get_length(notes); i++)
		add_line(lines, "%s.", json_array_get_string_element(notes, i));
	for (guint i = 0; scans && i < json_array_get_length(scans); i++)
		add_notes_of_scan(lines, json_array_get_object_element(scans, i));
	return lines->len ? g_string_free(g_steal_pointer(&lines), FALSE) : NULL;
}
