/* pleinair-jobsd: does what takes long, for the programs that ask on the bus. */
#include "acquire/cli.h"
#include "acquire/service.h"
#include "process/jobs-service.h"

#define COMMAND "jobsd"
#define NAME    "org.pleinair.Jobs1"

static char *folder, *state_path;
static char **drives;
static gboolean on_system;

static const GOptionEntry entries[] = {
	{ "sites", 's', 0, G_OPTION_ARG_FILENAME, &folder,
		"The folder of sites (default ~/pleinair); with --system none may lie elsewhere",
		"FOLDER" },
	{ "state", 0, 0, G_OPTION_ARG_FILENAME, &state_path,
		"Remember jobs in this file, also when the machine goes off", "FILE" },
	{ "drives", 0, 0, G_OPTION_ARG_FILENAME_ARRAY, &drives,
		"With --system: where drives are mounted (default /media and /run/media); may be "
		"repeated",
		"FOLDER" },
	{ "system", 0, 0, G_OPTION_ARG_NONE, &on_system,
		"Serve on the system bus, as on the appliance", NULL },
	{ NULL },
};

static bool export_objects(GDBusConnection *c, gpointer user_data, GError **error)
{
	return jobs_service_export(user_data, c, error);
}

static void begin(gpointer user_data)
{
	jobs_service_begin(user_data);
}

static void end(gpointer user_data)
{
	jobs_service_end(user_data, service_quit);
}

int main(int argc, char **argv)
{
	int status;
	if (!cli_parse(COMMAND, NULL,
		    "Does what takes long, one job after another, for the programs that ask on the "
		    "bus.",
		    NULL, entries, &argc, &argv, &status))
		return status;
	if (argc != 1)
		return cli_misuse(COMMAND, "'%s' is not an option", argv[1]);
	if (on_system && !folder)
		return cli_misuse(COMMAND, "--system goes with --sites");
	const char *const usual[] = { "/media", "/run/media", NULL };
	g_autofree char *home = g_build_filename(g_get_home_dir(), "pleinair", NULL);
	g_autofree char *self = g_file_read_link("/proc/self/exe", NULL);
	g_autofree char *programs = self ? g_path_get_dirname(self) : NULL;
	struct jobs_service_options options = {
		.folder = folder ? folder : home, .state_path = state_path, .programs = programs
	};
	if (on_system)
		options.limits =
			(struct job_limits){ folder, drives ? (const char *const *)drives : usual };
	jobs_service *s = jobs_service_new(&options);
	struct service service = { .command = COMMAND,
		.name = NAME,
		.system = on_system,
		.export_objects = export_objects,
		.begin = begin,
		.end = end,
		.user_data = s };
	status = service_run(&service);
	jobs_service_free(s);
	return status;
}
