/* pleinair bench WHAT: measures speed and memory. */
#include "acquire/bench-acquire.h"
#include "acquire/cli.h"
#include <stdio.h>

#define COMMAND "bench"

static gboolean json;
static double seconds = 60;
static int beams = 1081;

static const GOptionEntry entries[] = {
	{ "seconds", 0, 0, G_OPTION_ARG_DOUBLE, &seconds,
		"acquire: how long the lidar streams (default 60)", "S" },
	{ "beams", 0, 0, G_OPTION_ARG_INT, &beams,
		"acquire: beams of the simulated lidar, 6 k + 1 (default 1081)", "N" },
	{ "json", 0, 0, G_OPTION_ARG_NONE, &json, "Print the figures as JSON", NULL },
	{ NULL },
};

int main(int argc, char **argv)
{
	int status;
	g_autoptr(GError) error = NULL;
	if (!cli_parse(COMMAND, "[acquire]", "Measures speed and memory on this machine.",
		    "acquire: records a simulated lidar at its full rate in real time, and decodes "
		    "what was recorded.\n",
		    entries, &argc, &argv, &status))
		return status;
	if (argc > 2 || (argc == 2 && !g_str_equal(argv[1], "acquire")))
		return cli_misuse(COMMAND, "there is no bench '%s': acquire", argv[argc - 1]);
	if (!(seconds >= 1 && seconds <= 3600) || beams < 100 || beams > 9000 || beams % 6 != 1)
		return cli_misuse(
			COMMAND, "seconds go from 1 to 3600, beams from 103 to 8995 in steps of 6");
	struct bench_acquire_options options = {
		.seconds = seconds, .beams = (uint32_t)beams, .json = json
	};
	return bench_acquire(&options, &error) ? cli_done(COMMAND) : cli_fail(COMMAND, error);
}
