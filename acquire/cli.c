#include "acquire/cli.h"
#include <errno.h>
#include <fcntl.h>
#include <locale.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

#define BAR_AFTER_US     (1 * G_USEC_PER_SEC)
#define BAR_EVERY_US     (G_USEC_PER_SEC / 10)
#define TELL_EVERY_US    (G_USEC_PER_SEC / 10)
#define ETA_AFTER_US     (3 * G_USEC_PER_SEC)
#define PACE_MEMORY_S    10.0
#define BAR_CELLS        24
#define LINE_COLUMNS_MIN 50

int cli_done(const char *command)
{
	if (fflush(stdout) == 0 && !ferror(stdout))
		return CLI_DONE;
	g_printerr("pleinair %s: the result cannot be written: %s\n", command, g_strerror(errno));
	return CLI_FAILED;
}

int cli_fail(const char *command, const GError *error)
{
	g_printerr("pleinair %s: %s\n", command, error ? error->message : "failed");
	return CLI_FAILED;
}

int cli_misuse(const char *command, const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	g_autofree char *text = g_strdup_vprintf(format, arguments);
	va_end(arguments);
	g_printerr("pleinair %s: %s (see pleinair %s --help)\n", command, text, command);
	return CLI_WRONG_USAGE;
}

bool cli_parse(const char *command, const char *parameters, const char *summary,
	const char *description, const GOptionEntry *entries, int *argc, char ***argv,
	int *ret_status)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(GOptionContext) context = g_option_context_new(parameters);
	g_autofree char *name = g_strdup_printf("pleinair %s", command);
	g_set_prgname(name);
	signal(SIGXFSZ, SIG_IGN); /* a limit on the size of files is an error like a full disk */
	setlocale(LC_ALL, "");
	setlocale(LC_NUMERIC, "C"); /* in URIs and JSON a point is a point */
	g_option_context_add_main_entries(context, entries, NULL);
	g_option_context_set_summary(context, summary);
	g_option_context_set_description(context, description);
	if (g_option_context_parse(context, argc, argv, &error))
		return true;
	*ret_status = cli_misuse(command, "%s", error->message);
	return false;
}

static void print_document(JsonNode *root)
{
	g_autofree char *text = json_to_string(root, TRUE);
	printf("%s\n", text);
	json_node_unref(root);
}

void cli_print_json(JsonObject *object)
{
	JsonNode *root = json_node_new(JSON_NODE_OBJECT);
	json_node_take_object(root, object);
	print_document(root);
}

void cli_print_json_array(JsonArray *array)
{
	JsonNode *root = json_node_new(JSON_NODE_ARRAY);
	json_node_take_array(root, array);
	print_document(root);
}

char *cli_duration(double seconds)
{
	long s = lround(fmax(seconds, 0));
	if (s < 60)
		return g_strdup_printf("%ld s", s);
	if (s < 3600)
		return g_strdup_printf("%ld min %02ld s", s / 60, s % 60);
	return g_strdup_printf("%ld h %02ld min", s / 3600, s / 60 % 60);
}

static int progress_fd(void)
{
	const char *text = g_getenv("PLEINAIR_PROGRESS_FD");
	int fd = text ? atoi(text) : -1, flags = fd > STDERR_FILENO ? fcntl(fd, F_GETFL) : -1;
	if (flags < 0)
		return -1;
	fcntl(fd, F_SETFL, flags | O_NONBLOCK);
	return fd;
}

static void tell(struct cli_bar *bar, double fraction, const char *doing, int64_t now_us)
{
	if (bar->fd < 0 || now_us - bar->told_us < TELL_EVERY_US)
		return;
	bar->told_us = now_us;
	g_autofree char *line =
		g_strdup_printf("%.4f %s\n", CLAMP(fraction, 0.0, 1.0), doing ? doing : "");
	if (write(bar->fd, line, strlen(line)) < 0 && errno != EAGAIN)
		bar->fd = -1;
}

struct cli_bar cli_bar_begin(const char *command)
{
	return (struct cli_bar){ .command = command,
		.started_us = g_get_monotonic_time(),
		.terminal = isatty(STDERR_FILENO),
		.fd = progress_fd() };
}

static int line_columns(void)
{
	struct winsize size = { 0 };
	return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col >= LINE_COLUMNS_MIN
		       ? size.ws_col
		       : 80;
}

/* Nothing is said while too little is known. */
static char *time_left(struct cli_bar *bar, double fraction, int64_t now_us)
{
	double passed_s =
		(double)(now_us - (bar->shown_us ? bar->shown_us : bar->started_us)) * 1e-6;
	double share = 1 - exp(-passed_s / PACE_MEMORY_S);
	if (bar->pace == 0)
		share = 1;
	bar->pace += ((fraction - bar->shown_fraction) / passed_s - bar->pace) * share;
	bar->shown_fraction = fraction;
	if (bar->pace <= 0 || now_us - bar->started_us < ETA_AFTER_US)
		return g_strdup("...");
	g_autofree char *duration = cli_duration((1 - fraction) / bar->pace);
	return g_strconcat(duration, " left", NULL);
}

void cli_bar_update(struct cli_bar *bar, double fraction, const char *doing)
{
	int64_t now_us = g_get_monotonic_time(), spent_us = now_us - bar->started_us;
	tell(bar, fraction, doing, now_us);
	if (!bar->terminal || spent_us < BAR_AFTER_US || now_us - bar->shown_us < BAR_EVERY_US)
		return;
	fraction = CLAMP(fraction, 0.0, 1.0);
	int full = (int)(fraction * BAR_CELLS);
	g_autofree char *left = time_left(bar, fraction, now_us);
	g_autofree char *line = g_strdup_printf("[%.*s%.*s] %3.0f %%  %s  %s", full,
		"========================", BAR_CELLS - full, "                        ",
		fraction * 100, left, doing);
	fprintf(stderr, "\r\033[K%.*s", line_columns() - 1, line);
	fflush(stderr);
	bar->shown_us = now_us;
	bar->visible = true;
}

void cli_bar_end(struct cli_bar *bar)
{
	if (bar->visible)
		fputs("\r\033[K", stderr);
	bar->visible = false;
}

static volatile sig_atomic_t interrupted;

static void interrupt(int number)
{
	interrupted = 1;
	signal(number, SIG_DFL);
}

void cli_catch_interrupts(void)
{
	signal(SIGINT, interrupt);
	signal(SIGTERM, interrupt);
	signal(SIGPIPE, SIG_IGN);
}

bool cli_interrupted(void)
{
	return interrupted != 0;
}
