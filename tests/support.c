#include "tests/support.h"
#include <glib.h>

static char *shared_folder(void)
{
	const char *shared = g_getenv("PLEINAIR_SHARED"), *source = g_getenv("PLEINAIR_SOURCE");
	return shared ? g_strdup(shared)
		      : g_build_filename(source ? source : ".", "..", "shared", NULL);
}

const char *shared_path(const char *relative)
{
	g_autofree char *folder = shared_folder();
	g_autofree char *path = g_build_filename(folder, relative, NULL);
	return g_file_test(path, G_FILE_TEST_EXISTS) ? g_intern_string(path) : NULL;
}
