#include "render/kiosk/site-words.h"
#include <glib/gi18n.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

char *words_duration(double seconds)
{
	if (!(seconds >= 0) || !isfinite(seconds))
		return g_strdup("");
	if (seconds < 90)
		return g_strdup_printf(_("%.0f s"), ceil(seconds / 5) * 5);
	if (seconds < 5400)
		return g_strdup_printf(_("%.0f min"), ceil(seconds / 60));
	return g_strdup_printf(_("%.1f h"), seconds / 3600);
}

char *words_date(gint64 unix_s)
{
	g_autoptr(GDateTime) then = g_date_time_new_from_unix_local(unix_s);
	g_autoptr(GDateTime) now = g_date_time_new_now_local();
	if (!then)
		return g_strdup("");
	bool today = g_date_time_get_year(then) == g_date_time_get_year(now) &&
		     g_date_time_get_day_of_year(then) == g_date_time_get_day_of_year(now);
	return g_date_time_format(then, today ? _("today %H:%M") : "%-d %b %Y");
}

char *words_scans(guint scans, guint placed, guint partial)
{
	if (!scans)
		return g_strdup(partial ? _("One scan to finish") : _("No scans yet"));
	g_autofree char *n = g_strdup_printf(ngettext("%u scan", "%u scans", scans), scans);
	if (placed >= scans || scans == 1)
		return g_steal_pointer(&n);
	return g_strdup_printf(_("%s, %u placed"), n, placed);
}

char *words_points(double points)
{
	if (points >= 1e6)
		return g_strdup_printf(_("%.1f million points"), points / 1e6);
	if (points >= 1e3)
		return g_strdup_printf(_("%.0f thousand points"), points / 1e3);
	return g_strdup_printf(ngettext("%u point", "%u points", (gulong)points), (guint)points);
}

const char *words_doing(const char *doing)
{
	/* Up to a colon: what stands after it is for those who read logs. */
	static const struct {
		const char *begin, *plain;
	} all[] = {
		{ "register:", N_("The scans are put together") },
		{ "look:", N_("A first look is taken") },
		{ "geometry:", N_("Surfaces are measured") },
		{ "segments:", N_("Things are told apart") },
		{ "features:", N_("Edges are found") },
		{ "model:", N_("The model is put together") },
		{ "reading the model", N_("The model is read") },
		{ "drawing", N_("Drawing") },
		{ "copying and comparing", N_("Copying, and comparing what was copied") },
		{ "starting", N_("Starting") },
		{ "finding the home position", N_("Finding the home position") },
		{ "scanning", N_("Scanning") },
		{ "going back for", N_("Going back for columns that were missed") },
		{ "taking photos in several exposures", N_("Taking HDR photos") },
		{ "taking photos", N_("Taking photos") },
		{ "going home", N_("Going home") },
	};
	for (size_t i = 0; doing && i < G_N_ELEMENTS(all); i++)
		if (g_str_has_prefix(doing, all[i].begin))
			return _(all[i].plain);
	return doing ? doing : "";
}

char *words_sentence(const char *sentence)
{
	/* Said where a person stands at the scanner: acquire/pump.c, recorder.h. */
	static const char *const said[] = { N_("the emergency stop is pressed"),
		N_("the interlock is open: the cover is not closed"),
		N_("the emergency stop or the interlock has stopped the scanner"),
		N_("the scanner was stopped for safety, and nobody has said since that it is "
		   "safe: reset it"),
		N_("the lidar was unplugged"), N_("the lidar has fallen silent") };
	const char *words = sentence ? sentence : "";
	for (size_t i = 0; i < G_N_ELEMENTS(said); i++)
		if (strcmp(words, said[i]) == 0)
			words = _(said[i]);
	/* Names of files and devices stay as they are. */
	size_t letters = strspn(words, "abcdefghijklmnopqrstuvwxyz");
	char *own = g_strdup(words);
	if (words[letters] == ' ' || words[letters] == 0)
		*own = g_ascii_toupper(*own);
	return own;
}

const char *words_advice(const char *advice)
{
	/* That of an empty text is a catalogue's head. */
	return advice && *advice ? _(advice) : "";
}
