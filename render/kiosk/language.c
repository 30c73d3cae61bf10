#include "render/kiosk/language.h"
#include "render/kiosk/settings.h"
#include <glib.h>
#include <libintl.h>
#include <locale.h>

#define DOMAIN "pleinair"

const struct language languages[] = {
	{ "en", "English" },
	{ "de", "Deutsch" },
	{ NULL },
};

/* What LANGUAGE was at the start: NULL, nothing. */
static char *surroundings_language;

static char *catalogues(void)
{
	g_autofree char *self = g_file_read_link("/proc/self/exe", NULL);
	g_autofree char *folder = g_path_get_dirname(self ? self : ".");
	return g_build_filename(folder, "..", "share", "locale", NULL);
}

/* gettext translates nothing in the locale "C". Boxes have few locales: any other one does, for LANGUAGE tells the language. */
static void leave_plain_c(void)
{
	static const char *const others[] = { "C.UTF-8", "en_US.UTF-8", "de_DE.UTF-8" };
	const char *now = setlocale(LC_MESSAGES, NULL);
	if (g_strcmp0(now, "C") && g_strcmp0(now, "POSIX"))
		return;
	for (size_t i = 0; i < G_N_ELEMENTS(others); i++)
		if (setlocale(LC_MESSAGES, others[i]))
			return;
}

static void use(const char *code)
{
	if (code) {
		leave_plain_c();
		g_setenv("LANGUAGE", code, TRUE);
	} else if (surroundings_language)
		g_setenv("LANGUAGE", surroundings_language, TRUE);
	else
		g_unsetenv("LANGUAGE");
	/* gettext remembers what LANGUAGE was until its domain is named again. */
	textdomain(DOMAIN);
}

void language_start(void)
{
	g_autofree char *folder = catalogues(), *chosen = language_chosen();
	surroundings_language = g_strdup(g_getenv("LANGUAGE"));
	bindtextdomain(DOMAIN, folder);
	bind_textdomain_codeset(DOMAIN, "UTF-8");
	textdomain(DOMAIN);
	if (chosen)
		use(chosen);
}

void language_choose(const char *code)
{
	settings_keep_string("screen", "language", code);
	use(code);
}

char *language_chosen(void)
{
	return settings_string("screen", "language");
}
