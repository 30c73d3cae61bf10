/* pleinair-acquired: owns the scanner, and records scans for whoever asks on the bus. */
#include "acquire/acquisition-service.h"
#include "acquire/cli.h"
#include "acquire/configuration.h"
#include "acquire/service.h"

#define COMMAND "acquired"
#define NAME    "org.pleinair.Acquisition1"

static char *device, *folder;
static gboolean on_system;

static const GOptionEntry entries[] = {
	{ "device", 'd', 0, G_OPTION_ARG_STRING, &device,
		"The head, as of pleinair scan; %n in it becomes the number of the scan", "URI" },
	{ "sites", 's', 0, G_OPTION_ARG_FILENAME, &folder,
		"The folder of sites; with --system no site may lie elsewhere", "FOLDER" },
	{ "system", 0, 0, G_OPTION_ARG_NONE, &on_system,
		"Serve on the system bus, as on the appliance", NULL },
	{ NULL },
};

static bool export_objects(GDBusConnection *c, gpointer user_data, GError **error)
{
	return acquisition_service_export(user_data, c, error);
}

static void begin(gpointer user_data)
{
	acquisition_service_begin(user_data);
}

static void end(gpointer user_data)
{
	acquisition_service_end(user_data, service_quit);
}

int main(int argc, char **argv)
{
	int status;
	if (!cli_parse(COMMAND, NULL, "Records scans for the programs that ask on the bus.",
		    "Without --device the head is the one that /etc/pleinair.conf names.", entries,
		    &argc, &argv, &status))
		return status;
	if (argc != 1)
		return cli_misuse(COMMAND, "'%s' is not an option", argv[1]);
	if (on_system && !folder)
		return cli_misuse(COMMAND, "--system goes with --sites");
	if (!device)
		device = configuration_device();
	struct acquisition_options options = { device, folder, !on_system };
	acquisition_service *s = acquisition_service_new(&options);
	struct service service = { .command = COMMAND,
		.name = NAME,
		.system = on_system,
		.export_objects = export_objects,
		.begin = begin,
		.end = end,
		.user_data = s };
	status = service_run(&service);
	acquisition_service_free(s);
	return status;
}
