/* pleinair COMMAND ...: runs pleinair-COMMAND, which stands beside this program, in its libexec
 * folder or on the PATH. */
#include "acquire/cli.h"
#include "acquire/large-pages.h"
#include "acquire/version.h"
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static const struct {
	const char *name, *summary;
	bool runs_all_day;
} commands[] = {
	{ "scan", "record one scan into a site" },
	{ "import", "import scans of other scanners into a site" },
	{ "process", "register the scans of a site and build its point model" },
	{ "align", "align two scans from picked pairs, or decide about a pair" },
	{ "segments", "show the things of a site, and change them" },
	{ "report", "write how well the scans of a site fit, as a page" },
	{ "panoramas", "write a site's panoramas as pictures and a page" },
	{ "pictures", "write what was computed of a site's scans as pictures and a page" },
	{ "render", "draw a site in a style" },
	{ "styles", "list the styles that a site can be drawn in" },
	{ "export", "write the points of a site for other programs" },
	{ "copy", "copy a site to a drive, and compare" },
	{ "calibrate", "find where lidar and camera sit on the head, or check it" },
	{ "kiosk", "show sites on a touch screen, and scan", true },
	{ "doctor", "check devices, rights, clocks and space" },
	{ "bench", "measure speed and memory" },
};

static char *find_program(const char *command)
{
	g_autofree char *name = g_strconcat("pleinair-", command, NULL);
	g_autofree char *self = g_file_read_link("/proc/self/exe", NULL);
	g_autofree char *folder = g_path_get_dirname(self ? self : ".");
	g_autofree char *beside = g_build_filename(folder, name, NULL);
	g_autofree char *libexec =
		g_build_filename(folder, "..", "libexec", "pleinair", name, NULL);
	if (strchr(command, '/'))
		return NULL;
	if (g_file_test(beside, G_FILE_TEST_IS_EXECUTABLE))
		return g_steal_pointer(&beside);
	if (g_file_test(libexec, G_FILE_TEST_IS_EXECUTABLE))
		return g_steal_pointer(&libexec);
	return g_find_program_in_path(name);
}

/* Or -1. */
static int known(const char *command)
{
	for (int i = 0; i < (int)G_N_ELEMENTS(commands); i++)
		if (g_str_equal(commands[i].name, command))
			return i;
	return -1;
}

static void print_help(FILE *out)
{
	fputs("Usage: pleinair COMMAND ...\n\n"
	      "Records scans of a place and shows them.\n\n"
	      "Commands:\n",
		out);
	for (size_t i = 0; i < G_N_ELEMENTS(commands); i++)
		fprintf(out, "  %-12s %s\n", commands[i].name, commands[i].summary);
	fputs("\n'pleinair COMMAND --help' tells the options of a command; 'man pleinair' tells "
	      "more.\n",
		out);
}

int main(int argc, char **argv)
{
	if (argc < 2) {
		print_help(stderr);
		return CLI_WRONG_USAGE;
	}
	if (g_str_equal(argv[1], "--help") || g_str_equal(argv[1], "-h") ||
		g_str_equal(argv[1], "help")) {
		print_help(stdout);
		return CLI_DONE;
	}
	if (g_str_equal(argv[1], "--version")) {
		puts("pleinair " PLEINAIR_VERSION);
		return CLI_DONE;
	}
	g_autofree char *program = find_program(argv[1]);
	int command = known(argv[1]);
	if (program) {
		/* Read before main(), by GNU's OpenMP: its threads that wait sleep. They would spin, and two that draw a frame by turns with those
		 * that read points were put on one core now and then, which made a frame of 60 ms one of 140. */
		g_setenv("OMP_WAIT_POLICY", "passive", FALSE);
		if (command >= 0 && !commands[command].runs_all_day)
			g_setenv(LARGE_PAGES_VARIABLE, LARGE_PAGES_VALUE, FALSE);
		execv(program, argv + 1);
		g_printerr("pleinair: %s: %s\n", program, g_strerror(errno));
		return CLI_FAILED;
	}
	if (command >= 0) {
		g_printerr("pleinair: pleinair-%s is not there, neither beside this program nor "
			   "among those installed; 'make' builds it\n",
			argv[1]);
		return CLI_FAILED;
	}
	g_printerr("pleinair: there is no command '%s'; pleinair --help lists them\n", argv[1]);
	return CLI_WRONG_USAGE;
}
