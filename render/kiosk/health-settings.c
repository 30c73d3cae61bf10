#include "render/kiosk/choice.h"
#include "render/kiosk/health.h"
#include "render/kiosk/language.h"
#include "render/kiosk/settings.h"
#include "render/kiosk/theme.h"
#include <gio/gio.h>
#include <stdlib.h>
#include <string.h>

/* What the surroundings say. */
#define SYSTEM "system"

static void language_pressed(const char *value, gpointer user_data)
{
	language_choose(strcmp(value, SYSTEM) ? value : NULL);
	kiosk_start_over(user_data);
}

static choice *choose_language(kiosk *k)
{
	choice *c = choice_new(k, "settings-language", _("Language"), language_pressed, k);
	g_autofree char *chosen = language_chosen();
	choice_add(c, SYSTEM, _("Automatic"));
	for (const struct language *l = languages; l->code; l++)
		choice_add(c, l->code, l->name);
	choice_set(c, chosen ? chosen : SYSTEM);
	return c;
}

static void theme_pressed(const char *value, gpointer user_data)
{
	bool dark = !strcmp(value, "dark");
	kiosk_set_dark(user_data, dark);
	theme_keep(dark);
}

/* In the bar too it can be changed. */
static void theme_changed(GObject *settings, GParamSpec *what, gpointer button)
{
	gboolean dark = FALSE;
	(void)what;
	g_object_get(settings, "gtk-application-prefer-dark-theme", &dark, NULL);
	choice_set(g_object_get_data(button, "theme-choice"), dark ? "dark" : "light");
}

static choice *choose_theme(kiosk *k)
{
	choice *c = choice_new(k, "settings-theme", _("Colours"), theme_pressed, k);
	choice_add(c, "light", _("Bright"));
	choice_add(c, "dark", _("Dark"));
	choice_set(c, kiosk_options_of(k)->dark ? "dark" : "light");
	g_object_set_data(G_OBJECT(choice_button(c)), "theme-choice", c);
	g_signal_connect_object(gtk_settings_get_default(),
		"notify::gtk-application-prefer-dark-theme", G_CALLBACK(theme_changed),
		choice_button(c), 0);
	return c;
}

static void sleep_pressed(const char *value, gpointer user_data)
{
	double seconds = atof(value);
	kiosk_set_asleep_after(user_data, seconds);
	settings_keep_number("screen", "asleep_after_s", seconds);
}

static choice *choose_sleep(kiosk *k)
{
	static const unsigned minutes[] = { 2, 5, 10, 30, 0 };
	choice *c = choice_new(k, "settings-sleep", _("Screen goes dark"), sleep_pressed, k);
	g_autofree char *now = g_strdup_printf("%.0f", kiosk_options_of(k)->asleep_after_s);
	for (size_t i = 0; i < G_N_ELEMENTS(minutes); i++) {
		g_autofree char *value = g_strdup_printf("%u", minutes[i] * 60);
		g_autofree char *words = minutes[i] ? g_strdup_printf(_("After %u min"), minutes[i])
						    : g_strdup(_("Never"));
		choice_add(c, value, words);
	}
	choice_set(c, now);
	return c;
}

/* weston turns the screen, and is started anew for that: systemd/kiosk-screen reads what was chosen. Scans and jobs go on meanwhile. */
static void turned_pressed(const char *value, gpointer user_data)
{
	settings_keep_string("screen", "turned", value);
	kiosk_close(user_data);
}

static choice *choose_turned(kiosk *k)
{
	static const struct {
		const char *value, *words; /* value: a transform of weston.ini(5) */
	} ways[] = { { "normal", N_("Not turned") }, { "rotate-90", N_("To the right") },
		{ "rotate-180", N_("Upside down") }, { "rotate-270", N_("To the left") } };
	choice *c = choice_new(k, "settings-turned", _("Picture is turned"), turned_pressed, k);
	g_autofree char *now = settings_string("screen", "turned");
	for (size_t i = 0; i < G_N_ELEMENTS(ways); i++)
		choice_add(c, ways[i].value, _(ways[i].words));
	choice_set(c, now ? now : "normal");
	return c;
}

static GtkWidget *labelled(const char *label, choice *c)
{
	return kit_column(
		4, kit_line("settings-title", label, "soft small", true), choice_button(c), NULL);
}

GtkWidget *health_settings_new(kiosk *k)
{
	GtkWidget *row = kit_row(12, labelled(_("Language"), choose_language(k)),
		labelled(_("Colours"), choose_theme(k)),
		labelled(_("Screen goes dark"), choose_sleep(k)), NULL);
	if (kiosk_options_of(k)->owns_screen)
		gtk_box_append(GTK_BOX(row), labelled(_("Picture is turned"), choose_turned(k)));
	gtk_box_set_homogeneous(GTK_BOX(row), TRUE);
	return kit_classed(kit_column(10, kit_text(_("Settings"), "head"), row, NULL), "card");
}
