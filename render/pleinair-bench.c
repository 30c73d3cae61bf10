/* pleinair bench WHAT: measures speed and memory. */
#include "acquire/bench-acquire.h"
#include "acquire/cli.h"
#include "acquire/preset.h"
#include "process/bench-process.h"
#include <stdio.h>
#include <string.h>

#define COMMAND "bench"

static gboolean json;
static double seconds = 60;
static int beams = 1081, repeats = 5;
static char *site_path, *preset;

static const GOptionEntry entries[] = {
	{ "seconds", 0, 0, G_OPTION_ARG_DOUBLE, &seconds,
		"acquire: how long the lidar streams (default 60)", "S" },
	{ "beams", 0, 0, G_OPTION_ARG_INT, &beams,
		"acquire: beams of the simulated lidar, 6 k + 1 (default 1081)", "N" },
	{ "site", 0, 0, G_OPTION_ARG_FILENAME, &site_path,
		"process: a site to take scans from (default: a simulated one)", "SITE" },
	{ "preset", 0, 0, G_OPTION_ARG_STRING, &preset,
		"process: how finely to scan the simulated one (default fine)", "PRESET" },
	{ "repeats", 0, 0, G_OPTION_ARG_INT, &repeats,
		"process: how often each is measured; the median counts (default 5)", "N" },
	{ "json", 0, 0, G_OPTION_ARG_NONE, &json, "Print the figures as JSON", NULL },
	{ NULL },
};

static bool measure_acquire(GError **error)
{
	struct bench_acquire_options options = {
		.seconds = seconds, .beams = (uint32_t)beams, .json = json
	};
	return bench_acquire(&options, error);
}

static bool measure_process(GError **error)
{
	struct bench_process_options options = {
		.site = site_path, .preset = preset, .repeats = (uint32_t)repeats, .json = json
	};
	return bench_process(&options, error);
}

static const struct part {
	const char *name;
	bool (*measure)(GError **error);
} parts[] = {
	{ "acquire", measure_acquire }, /* the one without a name given */
	{ "process", measure_process },
	{ NULL },
};

static const struct part *find_part(const char *name)
{
	for (const struct part *p = parts; p->name; p++)
		if (!name || strcmp(p->name, name) == 0)
			return p;
	return NULL;
}

int main(int argc, char **argv)
{
	int status;
	g_autoptr(GError) error = NULL;
	if (!cli_parse(COMMAND, "[acquire | process]", "Measures speed and memory on this machine.",
		    "acquire: records a simulated lidar at its full rate in real time, and decodes "
		    "what was recorded.\nprocess: normals of a scan, beside those by PCL.\n",
		    entries, &argc, &argv, &status))
		return status;
	const struct part *part = argc > 2 ? NULL : find_part(argc == 2 ? argv[1] : NULL);
	if (!part)
		return cli_misuse(
			COMMAND, "there is no bench '%s': acquire, process", argv[argc - 1]);
	if (!(seconds >= 1 && seconds <= 3600) || beams < 100 || beams > 9000 || beams % 6 != 1)
		return cli_misuse(
			COMMAND, "seconds go from 1 to 3600, beams from 103 to 8995 in steps of 6");
	if (repeats < 1 || repeats > 1000)
		return cli_misuse(COMMAND, "repeats go from 1 to 1000");
	if (preset && !preset_find(preset))
		return cli_misuse(COMMAND, "there is no preset '%s'", preset);
	return part->measure(&error) ? cli_done(COMMAND) : cli_fail(COMMAND, error);
}
