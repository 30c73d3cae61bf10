#include "render/kiosk/box.h"
#include <glib.h>
#include <math.h>

double box_temperature_c(const char *folder)
{
	g_autoptr(GDir) dir = g_dir_open(folder, 0, NULL);
	const char *name;
	double highest = NAN;
	while (dir && (name = g_dir_read_name(dir))) {
		g_autofree char *path = g_build_filename(folder, name, "temp", NULL), *text = NULL;
		if (!g_str_has_prefix(name, "thermal_zone") ||
			!g_file_get_contents(path, &text, NULL, NULL))
			continue;
		double celsius = g_ascii_strtod(text, NULL) / 1000;
		/* Sensors that are not wired tell 0, or nonsense. */
		if (celsius > 0 && celsius < 150)
			highest = fmax(celsius, isnan(highest) ? celsius : highest);
	}
	return highest;
}

const char *box_version(void)
{
	return PLEINAIR_VERSION;
}
