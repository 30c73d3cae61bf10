/* pleinair-sim: serves a simulated head to a host, or tells the truth about its world. */
#include "sim/certificate.h"
#include "sim/head.h"
#include "sim/kernel.h"
#include "sim/options.h"
#include "sim/truth.h"
#include <errno.h>
#include <gio/gio.h>
#include <locale.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

enum { DONE = 0, FAILED = 1, WRONG_USAGE = 2 };

typedef struct arguments {
	int fd;
	int port; /* of --kernel, or -1 */
	char *listen_path, *plug;
	gboolean poses, certificate, truth, light, is_behind;
	int columns, rows;
	char *output;
	char **descriptions;
} arguments;

static void arguments_clear(arguments *a)
{
	g_free(a->listen_path);
	g_free(a->plug);
	g_free(a->output);
	g_strfreev(a->descriptions);
}
G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC(arguments, arguments_clear)

static int complain(const char *what, GError *error)
{
	bool usage = g_error_matches(error, G_IO_ERROR, G_IO_ERROR_INVALID_ARGUMENT);

	fprintf(stderr, "pleinair-sim: %s%s\n", what, error ? error->message : "");
	g_clear_error(&error);
	return usage ? WRONG_USAGE : FAILED;
}

static int serve(int fd, const char *description, const world *w)
{
	const struct sim_head_options options = { .description = description, .world = w };
	GError *error = NULL;

	if (!sim_head_serve(fd, &options, &error))
		return complain("", error);
	return DONE;
}

static int listen_on(const char *path, const char *description)
{
	struct sockaddr_un address = { .sun_family = AF_UNIX };
	GError *error = NULL;
	g_autoptr(truth) t =
		truth_new(description, &error); /* builds the world once for all hosts */
	int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);

	if (!t)
		return complain("", error);
	if (strlen(path) >= sizeof address.sun_path)
		return complain("the path of the socket is too long", NULL);
	g_strlcpy(address.sun_path, path, sizeof address.sun_path);
	unlink(path);
	if (fd < 0 || bind(fd, (struct sockaddr *)&address, sizeof address) < 0 ||
		listen(fd, 1) < 0) {
		fprintf(stderr, "pleinair-sim: %s: %s\n", path, g_strerror(errno));
		return FAILED;
	}
	for (;;) {
		int connection = accept4(fd, NULL, NULL, SOCK_CLOEXEC);

		if (connection >= 0)
			serve(connection, description, truth_world(t)); /* says on stderr what was
							   wrong; the next may do better */
		else if (errno != EINTR)
			return complain("accepting a host failed", NULL);
	}
}

static void tell_ports(uint16_t usb_port, uint16_t agent_port, gpointer data)
{
	(void)data;
	printf("usbip=%u agent=%u\n", usb_port, agent_port);
	fflush(stdout);
}

static int serve_kernel(const arguments *a, const char *description)
{
	const struct kernel_options options = { .description = description,
		.plug = a->plug,
		.port = (uint16_t)a->port,
		.listens = tell_ports };
	GError *error = NULL;

	return kernel_serve(&options, -1, &error) ? DONE : complain("", error);
}

static int tell_poses(const char *description)
{
	GError *error = NULL;
	g_autofree char *json = truth_poses_json(description, &error);

	if (!json)
		return complain("", error);
	fputs(json, stdout);
	return fflush(stdout) == 0 ? DONE : FAILED;
}

static int tell_certificate(const char *description)
{
	GError *error = NULL;
	sim_options *options = options_parse(description, &error);
	g_autofree char *json = options ? certificate_json(options, &error) : NULL;

	options_free(options);
	if (!json)
		return complain("", error);
	puts(json);
	return fflush(stdout) == 0 ? DONE : FAILED;
}

static int tell_truth(const arguments *a, const char *description)
{
	GError *error = NULL;
	g_autoptr(truth) t = truth_new(description, &error);
	struct truth_panorama panorama = { (uint32_t)a->columns, (uint32_t)a->rows, 50 * M_PI / 180,
		-40 * M_PI / 180, a->is_behind };

	bool (*write)(const truth *, const struct truth_panorama *, const char *, GError **) =
		a->light ? truth_write_light : truth_write;
	if (!t || !write(t, &panorama, a->output, &error))
		return complain("", error);
	return DONE;
}

static bool parse(int *argc, char ***argv, arguments *a, GError **error)
{
	g_autofree char *help = options_help();
	const GOptionEntry entries[] = { { "fd", 0, 0, G_OPTION_ARG_INT, &a->fd,
						 "Serve one host on an inherited socket", "N" },
		{ "listen", 0, 0, G_OPTION_ARG_FILENAME, &a->listen_path,
			"Serve one host after another on a Unix socket", "PATH" },
		{ "kernel", 0, 0, G_OPTION_ARG_INT, &a->port,
			"Serve a kernel's drivers: the lidar by USB/IP on TCP port N of 127.0.0.1",
			"N" },
		{ "plug", 0, 0, G_OPTION_ARG_STRING, &a->plug,
			"... as sick, hokuyo or cp2102 (as the lidar's protocol has it)", "NAME" },
		{ "truth-poses", 0, 0, G_OPTION_ARG_NONE, &a->poses,
			"Print where the scene's stations stand, as JSON", NULL },
		{ "certificate", 0, 0, G_OPTION_ARG_NONE, &a->certificate,
			"Print what the head tells of itself, as JSON", NULL },
		{ "truth", 0, 0, G_OPTION_ARG_NONE, &a->truth,
			"Write what the station sees, per cell of a panorama", NULL },
		{ "behind-panes", 0, 0, G_OPTION_ARG_NONE, &a->is_behind,
			"... with what stands behind panes in their place", NULL },
		{ "light", 0, 0, G_OPTION_ARG_NONE, &a->light,
			"Write what a camera should see, likewise", NULL },
		{ "columns", 0, 0, G_OPTION_ARG_INT, &a->columns, "... of so many columns (3000)",
			"N" },
		{ "rows", 0, 0, G_OPTION_ARG_INT, &a->rows, "... and rows (792)", "N" },
		{ "output", 'o', 0, G_OPTION_ARG_FILENAME, &a->output, "... to this file", "FILE" },
		{ G_OPTION_REMAINING, 0, 0, G_OPTION_ARG_STRING_ARRAY, &a->descriptions, NULL,
			"SCENE?key=value&..." },
		G_OPTION_ENTRY_NULL };
	g_autoptr(GOptionContext) context = g_option_context_new(NULL);

	g_option_context_add_main_entries(context, entries, NULL);
	g_option_context_set_summary(context, "A simulated scanner head: lidar, stage and camera.");
	g_option_context_set_description(context, help);
	return g_option_context_parse(context, argc, argv, error);
}

static bool makes_sense(const arguments *a)
{
	int ways = (a->fd >= 0) + (a->port >= 0) + (a->listen_path != NULL) + a->poses +
		   a->certificate + a->truth + a->light;

	return ways == 1 && a->port < 65535 && (a->port >= 0 || !a->plug) && a->descriptions &&
	       g_strv_length(a->descriptions) == 1 &&
	       (a->truth || a->light) == (a->output != NULL) && (a->truth || !a->is_behind) &&
	       a->columns >= 1 && a->columns <= 100000 && a->rows >= 1 && a->rows <= 100000;
}

static int run(const arguments *a, const char *description)
{
	if (a->poses)
		return tell_poses(description);
	if (a->certificate)
		return tell_certificate(description);
	if (a->truth || a->light)
		return tell_truth(a, description);
	if (a->port >= 0)
		return serve_kernel(a, description);
	if (a->listen_path)
		return listen_on(a->listen_path, description);
	return serve(a->fd, description, NULL);
}

/* Fans are measured in bursts of a millisecond; between them GNU's OpenMP would spin, at the cost
 * of the host that wants the same processors. It reads its wishes before main(), so start again. */
static void wait_in_peace(char **argv)
{
	if (g_getenv("OMP_WAIT_POLICY") || g_getenv("GOMP_SPINCOUNT"))
		return;
	g_setenv("OMP_WAIT_POLICY", "passive", TRUE);
	execv("/proc/self/exe", argv); /* where that fails it only costs time */
}

int main(int argc, char **argv)
{
	wait_in_peace(argv);
	g_auto(arguments) a = { .fd = -1, .port = -1, .columns = 3000, .rows = 792 };
	GError *error = NULL;

	setlocale(LC_CTYPE, "");
	if (!parse(&argc, &argv, &a, &error)) {
		complain("", error);
		return WRONG_USAGE;
	}
	if (!makes_sense(&a)) {
		complain("give one of --fd, --listen, --kernel, --truth-poses, --certificate, "
			 "--truth, --light "
			 "(with -o) "
			 "and one description; --help tells more",
			NULL);
		return WRONG_USAGE;
	}
	return run(&a, a.descriptions[0]);
}
