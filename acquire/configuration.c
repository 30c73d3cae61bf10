#include "acquire/configuration.h"
#include <glib.h>

#define FILE_NAME "/etc/pleinair.conf"

char *configuration_device(void)
{
	g_autoptr(GKeyFile) file = g_key_file_new();
	const char *conf = g_getenv("PLEINAIR_CONF");
	return g_key_file_load_from_file(file, conf ? conf : FILE_NAME, G_KEY_FILE_NONE, NULL)
		       ? g_key_file_get_string(file, "head", "device", NULL)
		       : NULL;
}
