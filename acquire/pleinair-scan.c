/* pleinair scan SITE: records one scan. */
#include "acquire/cli.h"
#include "acquire/configuration.h"
#include "acquire/identify.h"
#include "acquire/picture.h"
#include "acquire/pump.h"
#include "acquire/scan.h"
#include <stdio.h>
#include <string.h>

#define COMMAND          "scan"
#define PREVIEW_EVERY_US G_USEC_PER_SEC
#define IS_SAFE                                                                                    \
	"release the emergency stop, close the cover and see that nobody is in danger; the next "  \
	"scan, or --resume, resets the stage and moves it"

static char *device, *preset_name, *preview;
static gboolean hdr, resume, salvage, discard, json;

static const GOptionEntry entries[] = {
	{ "device", 'd', 0, G_OPTION_ARG_STRING, &device,
		"The head: tim:, scip:, scip:PORT, ld:PORT, rplidar:PORT, sim:SCENE, replay:FILE, "
		"or auto",
		"URI" },
	{ "preset", 'p', 0, G_OPTION_ARG_STRING, &preset_name,
		"draft (750x198), standard (1500x396) or fine (3000x792)", "NAME" },
	{ "hdr", 0, 0, G_OPTION_ARG_NONE, &hdr,
		"Stop at each photo angle, and take three exposures there, 2 EV apart", NULL },
	{ "preview", 0, 0, G_OPTION_ARG_FILENAME, &preview,
		"Keep a picture of what has been seen so far in this PNG", "FILE" },
	{ "resume", 0, 0, G_OPTION_ARG_NONE, &resume,
		"Go on with the scan that was begun and not finished", NULL },
	{ "salvage", 0, 0, G_OPTION_ARG_NONE, &salvage,
		"With --resume: go on without what is damaged in the record", NULL },
	{ "discard", 0, 0, G_OPTION_ARG_NONE, &discard,
		"Remove the scan that was begun and not finished, and end", NULL },
	{ "json", 0, 0, G_OPTION_ARG_NONE, &json, "Print the result as JSON", NULL },
	{ NULL },
};

struct watching {
	struct cli_bar bar;
	int64_t preview_us;
};

static void save_preview(struct watching *w, const panorama *p)
{
	int64_t now_us = g_get_monotonic_time();
	g_autoptr(GError) error = NULL;
	if (!preview || now_us - w->preview_us < PREVIEW_EVERY_US)
		return;
	w->preview_us = now_us;
	if (picture_save(p, PICTURE_RANGE, preview, &error))
		return;
	/* A preview that cannot be written must not cost the scan. */
	cli_bar_end(&w->bar);
	g_printerr("pleinair scan: %s; the scan goes on without a preview\n", error->message);
	g_clear_pointer(&preview, g_free);
}

static bool show_progress(const struct run_progress *p, gpointer user_data)
{
	struct watching *w = user_data;
	cli_bar_update(&w->bar, p->fraction, p->doing);
	save_preview(w, p->preview);
	return cli_interrupted();
}

static void show_prediction(
	const struct prediction *p, const struct lidar_identity *lidar, gpointer user_data)
{
	g_autofree char *bytes = scan_size_text(p->bytes), *time = cli_duration(p->seconds);
	(void)user_data;
	if (!json)
		g_printerr("%s: %u beams at %g Hz; this takes %s, %.2f million points and %s\n",
			lidar->model, lidar->beams, lidar->scan_rate_hz, time,
			(double)p->points * 1e-6, bytes);
}

static void print_hdr(const struct scan_result *r)
{
	if (r->merged_photos > 0)
		printf("HDR: %u of the photos are of several exposures\n", r->merged_photos);
	else
		printf("no HDR: %s\n",
			r->photos ? "the camera does not change its exposure, so the photos are "
				    "plain ones"
				  : "there are no photos");
}

static void print_result(const site *s, const struct scan_result *r)
{
	double cells = (double)r->columns * r->rows;
	g_autofree char *path = site_scan_path(s, r->number),
			*folder = g_filename_display_name(path);
	if (!json) {
		printf("%s: %u x %u, %.1f %% measured, %.1f %% without return, %u photos\n", folder,
			r->columns, r->rows, 100 * r->counts.measured / cells,
			100 * r->counts.no_return / cells, r->photos);
		if (r->hdr)
			print_hdr(r);
		if (r->report.lost_revolutions || r->missing_columns)
			printf("%" G_GUINT64_FORMAT
			       " revolutions were lost; %u columns are still missing\n",
				r->report.lost_revolutions, r->missing_columns);
		return;
	}
	JsonObject *o = json_object_new();
	json_object_set_int_member(o, "scan", r->number);
	json_object_set_string_member(o, "folder", folder);
	json_object_set_int_member(o, "columns", r->columns);
	json_object_set_int_member(o, "rows", r->rows);
	json_object_set_int_member(o, "measured", (int64_t)r->counts.measured);
	json_object_set_int_member(o, "filled", (int64_t)r->counts.filled);
	json_object_set_int_member(o, "no_return", (int64_t)r->counts.no_return);
	json_object_set_int_member(o, "empty", (int64_t)r->counts.empty);
	json_object_set_int_member(o, "photos", r->photos);
	if (r->hdr)
		json_object_set_int_member(o, "hdr_photos", r->merged_photos);
	json_object_set_int_member(o, "sessions", r->report.sessions);
	json_object_set_int_member(o, "revolutions", (int64_t)r->report.revolutions);
	json_object_set_int_member(o, "lost_revolutions", (int64_t)r->report.lost_revolutions);
	json_object_set_int_member(o, "missing_columns", r->missing_columns);
	json_object_set_double_member(o, "clock_drift_ppm", r->report.drift_ppm);
	cli_print_json(o);
}

static void print_discarded(uint32_t number)
{
	JsonObject *o = json_object_new();
	if (number)
		json_object_set_int_member(o, "discarded", number);
	else
		json_object_set_null_member(o, "discarded");
	cli_print_json(o);
}

static int discard_partial(site *s)
{
	uint32_t number;
	g_autoptr(GError) error = NULL;
	if (!site_find_partial(s, &number, &error) ||
		(number && !site_discard_partial(s, number, &error)))
		return cli_fail(COMMAND, error);
	if (json)
		print_discarded(number);
	else if (number)
		printf("scan %04u was discarded\n", number);
	else
		printf("there is no partial scan\n");
	return cli_done(COMMAND);
}

/* After a scan that did not come to its end: what can be done now. */
static void say_how_to_go_on(const site *s, uint32_t partial)
{
	g_printerr("pleinair scan: scan %04u is kept as far as it got: 'pleinair scan %s "
		   "--resume' goes on with it, "
		   "'--discard' removes it\n",
		partial, site_path(s));
}

/* A partial scan that stayed as it was because its record is damaged. */
static int refuse_damaged(const site *s, const GError *error)
{
	g_printerr("pleinair scan: %s; 'pleinair scan %s --resume --salvage' goes on without what "
		   "is damaged\n",
		error->message, site_path(s));
	return CLI_FAILED;
}

static int record(site *s, head *h, const struct preset *preset)
{
	g_autoptr(GError) error = NULL;
	struct watching w = { .bar = cli_bar_begin(COMMAND) };
	struct scan_result result;
	uint32_t partial;
	struct scan_options options = { .device = device,
		.head = h,
		.preset = preset,
		.hdr = hdr,
		.resume = resume,
		.salvage = salvage,
		.progress = show_progress,
		.predicted = show_prediction,
		.user_data = &w };
	bool good = scan_record(s, &options, &result, &partial, &error);
	cli_bar_end(&w.bar);
	if (good) {
		print_result(s, &result);
		return cli_done(COMMAND);
	}
	if (resume && !partial && g_error_matches(error, RECORD_ERROR, RECORD_ERROR_DAMAGED))
		return refuse_damaged(s, error);
	cli_fail(COMMAND, error);
	if (pump_error_is_safety(error))
		g_printerr("pleinair scan: %s\n", IS_SAFE);
	if (partial)
		say_how_to_go_on(s, partial);
	else
		site_discard_new(s);
	return CLI_FAILED;
}

/* None was named: the one that is plugged in. */
static bool find_device(GError **error)
{
	device = identify_find(error);
	if (device && !json)
		g_printerr("pleinair scan: found %s\n", device);
	return device;
}

int main(int argc, char **argv)
{
	int status;
	g_autoptr(GError) error = NULL;
	if (!cli_parse(COMMAND, "SITE",
		    "Records one scan into a site, which is made when it is not there.",
		    "Examples:\n"
		    "  pleinair scan oak --device 'sim:court?seed=7&station=2' --preset draft\n"
		    "  pleinair scan oak --resume\n",
		    entries, &argc, &argv, &status))
		return status;
	if (argc != 2 || !*argv[1])
		return cli_misuse(COMMAND, argc <= 2 ? "which site?" : "one site at a time");
	if (discard && (resume || salvage || hdr))
		return cli_misuse(COMMAND, "--discard goes alone");
	if (hdr && resume)
		return cli_misuse(COMMAND,
			"--hdr is for a new scan: one that is resumed goes on as it was begun");
	if (salvage && !resume)
		return cli_misuse(COMMAND, "--salvage goes with --resume");
	const struct preset *preset = preset_find(preset_name ? preset_name : "standard");
	if (!preset)
		return cli_misuse(
			COMMAND, "there is no preset '%s': draft, standard or fine", preset_name);
	/* A scan that is resumed has its own. */
	if (!device && !resume && !discard)
		device = configuration_device();
	if (!resume && !discard && (!device || strcmp(device, "auto") == 0) && !find_device(&error))
		return cli_fail(COMMAND, error);
	/* A head that is not there must not leave a new, empty site behind. */
	g_autoptr(head) h = resume || discard ? NULL : head_open(device, &error);
	if (error)
		return cli_fail(COMMAND, error);
	/* Only a new scan makes a site. */
	g_autoptr(site) s = resume || discard ? site_open_existing(argv[1], &error)
					      : site_open_for_writing(argv[1], &error);
	if (!s)
		return cli_fail(COMMAND, error);
	if (discard)
		return discard_partial(s);
	if (!device && !(device = scan_partial_device(s, &error)))
		return cli_fail(COMMAND, error);
	cli_catch_interrupts();
	return record(s, g_steal_pointer(&h), preset);
}
