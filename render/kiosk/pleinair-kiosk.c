/* pleinair kiosk: the touch screen, in a window or filling one, on a folder of sites. */
#include "acquire/cli.h"
#include "render/camera.h"
#include "render/drawn-site.h"
#include "render/kiosk/kiosk-probe.h"
#include "render/kiosk/kiosk.h"
#include "render/kiosk/language.h"
#include "render/kiosk/settings.h"
#include "render/kiosk/theme.h"
#include <errno.h>
#include <gio/gio.h>
#include <glib-unix.h>
#include <string.h>
#include <unistd.h>

#define COMMAND "kiosk"

static struct {
	char *device, *size, *backend, *theme, *memory;
	char **drives;
	gboolean fullscreen, system;
	double asleep_after_s;
} wishes = { .asleep_after_s = -1 };

#define ASLEEP_AFTER_S 600

static const GOptionEntry entries[] = {
	{ "device", 'd', 0, G_OPTION_ARG_STRING, &wishes.device,
		"The scanner, as of pleinair scan; %n in it becomes the number of the scan",
		"URI" },
	{ "fullscreen", 'f', 0, G_OPTION_ARG_NONE, &wishes.fullscreen, "Fill the screen", NULL },
	{ "size", 0, 0, G_OPTION_ARG_STRING, &wishes.size, "Of the window [1280x800]", "WxH" },
	{ "theme", 0, 0, G_OPTION_ARG_STRING, &wishes.theme,
		"light or dark [what was chosen last, else light]", "NAME" },
	{ "sleep", 0, 0, G_OPTION_ARG_DOUBLE, &wishes.asleep_after_s,
		"Darken after so long without a touch, 0: never [what was chosen last, else 600]",
		"SECONDS" },
	{ "backend", 0, 0, G_OPTION_ARG_STRING, &wishes.backend, "Draw with cpu or gles", "NAME" },
	{ "memory", 0, 0, G_OPTION_ARG_STRING, &wishes.memory,
		"That the points of a site may take, as 512M or 4G; two may be there at a time "
		"[what kiosk.conf says, else a quarter of the machine's]",
		"SIZE" },
	{ "drives", 0, 0, G_OPTION_ARG_FILENAME_ARRAY, &wishes.drives,
		"A folder whose folders are drives to copy to; may be repeated", "FOLDER" },
	{ "system", 0, 0, G_OPTION_ARG_NONE, &wishes.system,
		"Services are those of the system bus, as on the appliance", NULL },
	{ NULL },
};

struct run {
	struct kiosk_options options;
	struct services_options services;
	GMainLoop *loop;
};

static gboolean asked_to_end(gpointer user_data)
{
	struct run *r = user_data;
	g_main_loop_quit(r->loop);
	return G_SOURCE_CONTINUE;
}

/* Of kiosk.conf too: [drawing] memory=2G. */
static bool take_memory(GError **error)
{
	g_autofree char *kept = settings_string("drawing", "memory");
	g_autofree char *quarter = g_strdup_printf("%" G_GUINT64_FORMAT,
		(guint64)sysconf(_SC_PHYS_PAGES) * (guint64)sysconf(_SC_PAGESIZE) / 4);
	return drawn_site_set_memory(wishes.memory ? wishes.memory : kept ? kept : quarter, error);
}

/* false: *ret_status is the exit status. */
static bool take_wishes(struct run *r, int *ret_status)
{
	uint32_t width = 1280, height = 800;
	g_autoptr(GError) error = NULL;
	*ret_status = CLI_WRONG_USAGE;
	if (wishes.size && !camera_size_parse(wishes.size, &width, &height)) {
		cli_misuse(COMMAND, "--size %s: give width and height, as 1280x800", wishes.size);
		return false;
	}
	if (wishes.theme && strcmp(wishes.theme, "light") && strcmp(wishes.theme, "dark")) {
		cli_misuse(COMMAND, "--theme %s: there are light and dark", wishes.theme);
		return false;
	}
	if (!backend_wish_parse(wishes.backend, &r->options.backend, &error)) {
		cli_misuse(COMMAND, "%s", error->message);
		return false;
	}
	if (!take_memory(&error)) {
		cli_misuse(COMMAND, "%s", error->message);
		return false;
	}
	r->options.width = (int)width;
	r->options.height = (int)height;
	r->options.fullscreen = wishes.fullscreen;
	r->options.asleep_after_s =
		wishes.asleep_after_s >= 0
			? wishes.asleep_after_s
			: settings_number("screen", "asleep_after_s", ASLEEP_AFTER_S);
	r->options.drives = wishes.drives;
	r->options.dark = wishes.theme ? !strcmp(wishes.theme, "dark") : theme_kept(false);
	r->services.system = wishes.system;
	r->options.owns_screen = wishes.system && wishes.fullscreen;
	r->services.device = wishes.device;
	return true;
}

static char *make_folder(const char *given, GError **error)
{
	g_autofree char *path = given ? g_canonicalize_filename(given, NULL)
				      : g_build_filename(g_get_home_dir(), "pleinair", NULL);
	if (!g_mkdir_with_parents(path, 0777))
		return g_steal_pointer(&path);
	int why = errno;
	g_set_error(
		error, G_FILE_ERROR, g_file_error_from_errno(why), "%s: %s", path, g_strerror(why));
	return NULL;
}

static void window_is_gone(gpointer user_data)
{
	struct run *r = user_data;
	g_main_loop_quit(r->loop);
}

static int run(struct run *r, const char *folder)
{
	g_autoptr(GError) error = NULL;
	r->options.folder = r->services.folder = folder;
	services *s = services_new(&r->services, &error);
	if (!s)
		return cli_fail(COMMAND, error);
	g_autoptr(GMainLoop) loop = r->loop = g_main_loop_new(NULL, FALSE);
	g_unix_signal_add(SIGTERM, asked_to_end, r);
	g_unix_signal_add(SIGINT, asked_to_end, r);
	kiosk *k = kiosk_new(s, &r->options, window_is_gone, r);
	g_main_loop_run(loop);
	kiosk_probe_stop();
	kiosk_free(k);
	return CLI_DONE;
}

/* Without a GPU, GTK's cairo renderer costs half of what its GL one does on a software GL, and starts sooner. */
static void choose_renderer(void)
{
	g_autoptr(GDir) dir = g_dir_open("/dev/dri", 0, NULL);
	const char *name;
	while (dir && (name = g_dir_read_name(dir)))
		if (g_str_has_prefix(name, "renderD"))
			return;
	g_setenv("GSK_RENDERER", "cairo", FALSE);
}

int main(int argc, char **argv)
{
	struct run r = { 0 };
	int status;
	g_autoptr(GError) error = NULL;
	choose_renderer();
	/* cli_parse has set it, with the C locale's numbers. */
	gtk_disable_setlocale();
	if (!cli_parse(COMMAND, "[FOLDER]", "Shows the sites in a folder on a touch screen.",
		    "Without FOLDER: ~/pleinair.", entries, &argc, &argv, &status))
		return status;
	language_start();
	if (argc > 2)
		return cli_misuse(COMMAND, "give one folder, or none");
	if (!take_wishes(&r, &status))
		return status;
	if (!gtk_init_check()) {
		g_set_error_literal(&error, G_IO_ERROR, G_IO_ERROR_FAILED,
			"there is no display: set WAYLAND_DISPLAY or DISPLAY, or run it on the "
			"box's own screen");
		return cli_fail(COMMAND, error);
	}
	if (!kiosk_probe_start(&error))
		return cli_fail(COMMAND, error);
	g_autofree char *folder = make_folder(argc > 1 ? argv[1] : NULL, &error);
	if (!folder)
		return cli_fail(COMMAND, error);
	return run(&r, folder);
}
