#include "render/kiosk/theme.h"
#include "render/kiosk/settings.h"
#include <gio/gio.h>
#include <gtk/gtk.h>

static char *shared_file(const char *name)
{
	g_autofree char *self = g_file_read_link("/proc/self/exe", NULL);
	g_autofree char *folder = g_path_get_dirname(self ? self : ".");
	return g_build_filename(folder, "..", "share", "pleinair", "kiosk", name, NULL);
}

static char *text_of(const char *name)
{
	g_autofree char *path = shared_file(name);
	g_autoptr(GError) error = NULL;
	char *text = NULL;
	if (!g_file_get_contents(path, &text, NULL, &error))
		g_warning("%s", error->message);
	return text ? text : g_strdup("");
}

void theme_use(bool dark)
{
	static GtkCssProvider *used;
	g_autofree char *colours = text_of(dark ? "dark.css" : "light.css");
	g_autofree char *rules = text_of("kiosk.css");
	g_autofree char *all = g_strconcat(colours, rules, NULL);
	GdkDisplay *display = gdk_display_get_default();
	g_object_set(gtk_settings_get_default(), "gtk-application-prefer-dark-theme",
		(gboolean)dark, NULL);
	if (used)
		gtk_style_context_remove_provider_for_display(display, GTK_STYLE_PROVIDER(used));
	g_clear_object(&used);
	used = gtk_css_provider_new();
	gtk_css_provider_load_from_data(used, all, -1);
	gtk_style_context_add_provider_for_display(
		display, GTK_STYLE_PROVIDER(used), GTK_STYLE_PROVIDER_PRIORITY_APPLICATION);
}

bool theme_kept(bool fallback)
{
	return settings_switch("screen", "dark", fallback);
}

void theme_keep(bool dark)
{
	settings_keep_switch("screen", "dark", dark);
}
