/* pleinair copy SITE: takes a site, or what was made of it, to another disk. */
#include "acquire/cli.h"
#include "process/copy.h"
#include <stdio.h>
#include <string.h>

#define COMMAND "copy"

static char *to, *what_name;
static gboolean json;

static const GOptionEntry entries[] = {
	{ "to", 't', 0, G_OPTION_ARG_FILENAME, &to,
		"Where the copy goes: a folder, as a drive's; it becomes FOLDER/NAME OF THE SITE",
		"FOLDER" },
	{ "what", 'w', 0, G_OPTION_ARG_STRING, &what_name,
		"site (all of it), scans, exports or pictures [site]", "WHAT" },
	{ "json", 0, 0, G_OPTION_ARG_NONE, &json, "Print the result as JSON", NULL },
	{ NULL },
};

static bool show_progress(double fraction, const char *doing, gpointer user_data)
{
	cli_bar_update(user_data, fraction, doing);
	return cli_interrupted();
}

static void print_result(const struct copy_result *r)
{
	g_autofree char *size = g_format_size(r->bytes),
			*folder = g_filename_display_name(r->folder);
	if (!json) {
		printf("%s: %u files, %s, all read back and compared; %u were new\n", folder,
			r->files, size, r->written);
		return;
	}
	JsonObject *o = json_object_new();
	json_object_set_string_member(o, "to", folder);
	json_object_set_int_member(o, "files", r->files);
	json_object_set_int_member(o, "written", r->written);
	json_object_set_int_member(o, "bytes", (int64_t)r->bytes);
	json_object_set_boolean_member(o, "verified", TRUE);
	cli_print_json(o);
}

static int find_what(void)
{
	for (int i = 0; i < COPY_WHATS; i++)
		if (!strcmp(what_name ? what_name : copy_what_names[COPY_SITE], copy_what_names[i]))
			return i;
	return -1;
}

int main(int argc, char **argv)
{
	int status;
	g_autoptr(GError) error = NULL;
	struct copy_result result;
	if (!cli_parse(COMMAND, "SITE",
		    "Copies a site to another disk, and compares each file after it was written.",
		    "A copy that was cut off goes on where it was. SHA256SUMS beside the copy "
		    "lists "
		    "its files, as sha256sum -c reads it.\n\n"
		    "Example:\n"
		    "  pleinair copy oak --to /media/stick --what exports\n",
		    entries, &argc, &argv, &status))
		return status;
	int what = find_what();
	if (argc != 2 || !*argv[1])
		return cli_misuse(COMMAND, argc <= 2 ? "which site?" : "one site at a time");
	if (!to)
		return cli_misuse(COMMAND, "where to? --to FOLDER");
	if (what < 0)
		return cli_misuse(COMMAND,
			"there is no '%s' to copy: site, scans, exports or pictures", what_name);
	cli_catch_interrupts();
	struct cli_bar bar = cli_bar_begin(COMMAND);
	struct copy_options options = { (enum copy_what)what, show_progress, &bar };
	bool good = copy_site(argv[1], to, &options, &result, &error);
	cli_bar_end(&bar);
	if (!good)
		return cli_fail(COMMAND, error);
	print_result(&result);
	g_free(result.folder);
	return cli_done(COMMAND);
}
