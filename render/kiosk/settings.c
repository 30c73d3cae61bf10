#include "render/kiosk/settings.h"
#include <glib.h>

static char *settings_path(void)
{
	return g_build_filename(g_get_user_config_dir(), "pleinair", "kiosk.conf", NULL);
}

static GKeyFile *load(void)
{
	g_autofree char *path = settings_path();
	GKeyFile *file = g_key_file_new();
	g_key_file_load_from_file(file, path, G_KEY_FILE_KEEP_COMMENTS, NULL);
	return file;
}

static void save(GKeyFile *file)
{
	g_autofree char *path = settings_path(), *folder = g_path_get_dirname(path);
	g_mkdir_with_parents(folder, 0700);
	g_key_file_save_to_file(file, path, NULL);
}

char *settings_string(const char *group, const char *key)
{
	g_autoptr(GKeyFile) file = load();
	return g_key_file_get_string(file, group, key, NULL);
}

double settings_number(const char *group, const char *key, double fallback)
{
	g_autoptr(GKeyFile) file = load();
	g_autoptr(GError) error = NULL;
	double value = g_key_file_get_double(file, group, key, &error);
	return error ? fallback : value;
}

bool settings_switch(const char *group, const char *key, bool fallback)
{
	g_autoptr(GKeyFile) file = load();
	g_autoptr(GError) error = NULL;
	bool value = g_key_file_get_boolean(file, group, key, &error);
	return error ? fallback : value;
}

void settings_keep_string(const char *group, const char *key, const char *value)
{
	g_autoptr(GKeyFile) file = load();
	if (value)
		g_key_file_set_string(file, group, key, value);
	else
		g_key_file_remove_key(file, group, key, NULL);
	save(file);
}

void settings_keep_number(const char *group, const char *key, double value)
{
	g_autoptr(GKeyFile) file = load();
	g_key_file_set_double(file, group, key, value);
	save(file);
}

void settings_keep_switch(const char *group, const char *key, bool value)
{
	g_autoptr(GKeyFile) file = load();
	g_key_file_set_boolean(file, group, key, value);
	save(file);
}
