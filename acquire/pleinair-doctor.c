/* pleinair doctor: says what is wrong with this machine as a scanner. */
#include "acquire/cli.h"
#include "acquire/doctor.h"
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define COMMAND "doctor"

static char *device;
static gboolean only_look, json;
static double stream_s;

static const GOptionEntry entries[] = {
	{ "device", 'd', 0, G_OPTION_ARG_STRING, &device,
		"Talk to this head, instead of the one that is set up", "URI" },
	{ "look", 0, 0, G_OPTION_ARG_NONE, &only_look, "Only look: talk to no device", NULL },
	{ "stream", 0, 0, G_OPTION_ARG_DOUBLE, &stream_s,
		"Let the lidar stream for so many seconds, and count what gets lost", "S" },
	{ "json", 0, 0, G_OPTION_ARG_NONE, &json, "Print the findings as JSON", NULL },
	{ NULL },
};

static void print_json(const GPtrArray *findings)
{
	JsonArray *all = json_array_new();
	for (guint i = 0; i < findings->len; i++) {
		const struct finding *f = findings->pdata[i];
		JsonObject *o = json_object_new();
		json_object_set_string_member(o, "state", finding_state_names[f->state]);
		json_object_set_string_member(o, "subject", f->subject);
		json_object_set_string_member(o, "sentence", f->sentence);
		if (f->advice)
			json_object_set_string_member(o, "advice", f->advice);
		json_array_add_object_element(all, o);
	}
	cli_print_json_array(all);
}

/* One line each: how it is, and what to do. */
static void print_lines(const GPtrArray *findings)
{
	static const char *const signs[] = {
		[FINDING_GOOD] = "good", [FINDING_NOTE] = "note", [FINDING_BAD] = "BAD "
	};
	static const char *const colours[] = {
		[FINDING_GOOD] = "\33[32m", [FINDING_NOTE] = "\33[33m", [FINDING_BAD] = "\33[31m"
	};
	bool terminal = isatty(STDOUT_FILENO);
	for (guint i = 0; i < findings->len; i++) {
		const struct finding *f = findings->pdata[i];
		bool advises = f->advice && *f->advice;
		const char *end =
			strchr(".?!", f->sentence[MAX(strlen(f->sentence), 1) - 1]) ? " " : ". ";
		printf("%s%s%s  %-13s %s%s%s\n", terminal ? colours[f->state] : "", signs[f->state],
			terminal ? "\33[0m" : "", f->subject, f->sentence, advises ? end : "",
			advises ? f->advice : "");
	}
}

static guint count(const GPtrArray *findings, enum finding_state state)
{
	guint n = 0;
	for (guint i = 0; i < findings->len; i++)
		n += ((const struct finding *)findings->pdata[i])->state == state;
	return n;
}

static bool show_progress(double fraction, gpointer user_data)
{
	cli_bar_update(user_data, fraction, "streaming");
	return !cli_interrupted();
}

int main(int argc, char **argv)
{
	int status;
	if (!cli_parse(COMMAND, "[FOLDER]",
		    "Looks at devices, rights, clocks, space and the kernel, and says what is "
		    "wrong and what to do.",
		    "FOLDER is where sites are kept. The exit status is 1 when something is "
		    "bad.\n\n"
		    "Examples:\n"
		    "  pleinair doctor\n"
		    "  pleinair doctor --device tim:\n",
		    entries, &argc, &argv, &status))
		return status;
	if (argc > 2)
		return cli_misuse(COMMAND, "one folder at a time");
	if (stream_s && !(stream_s >= 1 && stream_s <= 3600))
		return cli_misuse(COMMAND, "--stream goes from 1 to 3600 seconds");
	if (stream_s && only_look)
		return cli_misuse(COMMAND, "--stream talks to the lidar, --look does not");
	struct cli_bar bar = cli_bar_begin(COMMAND);
	cli_catch_interrupts();
	struct doctor_options options = { .folder = argc == 2 ? argv[1] : NULL,
		.device = device,
		.only_look = only_look,
		.stream_s = stream_s,
		.goes_on = show_progress,
		.user_data = &bar };
	g_autoptr(GPtrArray) findings = doctor_look(&options);
	cli_bar_end(&bar);
	guint bad = count(findings, FINDING_BAD), notes = count(findings, FINDING_NOTE);
	if (json) {
		print_json(findings);
	} else {
		print_lines(findings);
		if (bad)
			printf("%u bad, %u to note\n", bad, notes);
		else
			printf("nothing is bad, %u to note\n", notes);
	}
	status = cli_done(COMMAND);
	return status == CLI_DONE && bad ? CLI_FAILED : status;
}
