/* pleinair calibrate: finds where lidar and camera sit on the head, or checks it. */
#include "acquire/cli.h"
#include "acquire/scan.h"
#include "firmware-io/files.h"
#include "process/certificate.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define COMMAND     "calibrate"
#define SCAN_SHARE  0.5 /* of the time, where the head scans first */
#define READ_SHARE  0.2 /* of the rest */
#define FACES_SHARE 0.5
/* What changed by more deviations than that has changed. */
#define CHANGED 2.0
/* Faces that lie further apart than noise explains, by so much, want a calibration. */
#define GOOD_M 0.002

static char *device, *output, *board, *site_folder;
static double square_mm = 40;
static gboolean check, json;

static const GOptionEntry entries[] = {
	{ "device", 'd', 0, G_OPTION_ARG_STRING, &device,
		"Scan with this head first: tim:, sim:SCENE, ...", "URI" },
	{ "output", 'o', 0, G_OPTION_ARG_FILENAME, &output, "Write the certificate here", "FILE" },
	{ "site", 's', 0, G_OPTION_ARG_FILENAME, &site_folder,
		"With --device: keep the scan in this site", "SITE" },
	{ "board", 'b', 0, G_OPTION_ARG_STRING, &board,
		"Checkerboards stand around: corners inside, across and down, as 9x6", "CxR" },
	{ "square-mm", 'q', 0, G_OPTION_ARG_DOUBLE, &square_mm, "The side of their squares (40)",
		"MM" },
	{ "check", 'c', 0, G_OPTION_ARG_NONE, &check,
		"Only tell whether the calibration still holds", NULL },
	{ "json", 0, 0, G_OPTION_ARG_NONE, &json, "Print the result as JSON", NULL },
	{ NULL },
};

struct work {
	struct cli_bar bar;
	double from, share; /* of the bar, for what runs now */
	const char *doing;
};

static bool go_on(double fraction, gpointer user_data)
{
	struct work *w = user_data;
	cli_bar_update(&w->bar, w->from + w->share * fraction, w->doing);
	return cli_interrupted();
}

static void begin(struct work *w, double share, const char *doing)
{
	w->from += w->share;
	w->share = share;
	w->doing = doing;
}

/* ---- the record ---- */

static bool is_record(const char *path)
{
	return g_file_test(path, G_FILE_TEST_IS_REGULAR);
}

/* A record itself, the folder of a scan (SITE/scans/0003 or SITE/0003), or a site, whose last scan counts. */
static char *find_record(const char *path, GError **error)
{
	g_autofree char *folder = g_path_get_dirname(path), *name = g_path_get_basename(path);
	g_autofree char *inside = g_build_filename(path, "raw.rec", NULL),
			*beside = g_build_filename(folder, "scans", name, "raw.rec", NULL);
	if (is_record(path))
		return g_strdup(path);
	if (is_record(inside) || is_record(beside))
		return g_strdup(is_record(inside) ? inside : beside);
	g_autoptr(site) s = site_open(path, error);
	g_autoptr(GArray) scans = s ? site_scans(s, error) : NULL;
	for (guint i = scans ? scans->len : 0; i-- > 0;) {
		g_autofree char *scan = site_scan_path(s, g_array_index(scans, uint32_t, i)),
				*record = g_build_filename(scan, "raw.rec", NULL);
		if (is_record(record))
			return g_steal_pointer(&record);
	}
	if (scans)
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND,
			"%s: there is no scan of a head of ours in it, which has a record", path);
	return NULL;
}

static bool show_scan(const struct run_progress *p, gpointer user_data)
{
	struct work *w = user_data;
	cli_bar_update(&w->bar, w->from + w->share * p->fraction, p->doing);
	return cli_interrupted();
}

/* Scans into the site; a partial scan is no use here. */
static char *scan_into(const char *folder, struct work *w, GError **error)
{
	g_autoptr(site) s = site_open_for_writing(folder, error);
	struct scan_options options = { .device = device,
		.preset = &preset_calibration,
		.progress = show_scan,
		.user_data = w };
	struct scan_result result;
	uint32_t partial = 0;
	if (!s)
		return NULL;
	bool good = scan_record(s, &options, &result, &partial, error);
	if (!good && partial)
		site_discard_partial(s, partial, NULL);
	if (!good)
		site_discard_new(s);
	g_autofree char *scan = good ? site_scan_path(s, result.number) : NULL;
	return good ? g_build_filename(scan, "raw.rec", NULL) : NULL;
}

/* ---- what is said ---- */

/* What the faces are apart beyond what noise makes. */
static double excess_m(double error_m, double noise_m)
{
	return sqrt(fmax(error_m * error_m - noise_m * noise_m, 0));
}

static bool is_good(const struct two_face_result *r)
{
	return excess_m(r->error_before_m, r->noise_error_m) < GOOD_M;
}

static char *check_words(const struct two_face_result *r)
{
	return is_good(r) ? g_strdup_printf("the two faces of the lidar agree to %.1f mm, as well "
					    "as it measures: the calibration holds",
				    1e3 * r->error_before_m)
			  : g_strdup_printf("the two faces of the lidar are %.1f mm apart, where "
					    "its noise makes %.1f mm: calibrate the head",
				    1e3 * r->error_before_m, 1e3 * r->noise_error_m);
}

static bool has_changed(const struct two_face_value *v)
{
	return v->seen && fabs(v->value - v->before) > CHANGED * v->deviation;
}

static void print_faces(const struct two_face_result *r)
{
	for (int i = 0; i < TWO_FACE_MOUNT; i++) {
		const struct two_face_value *v = &r->value[i];
		double now = two_face_in_unit(i, v->value), then = two_face_in_unit(i, v->before),
		       deviation = two_face_in_unit(i, v->deviation);
		const char *name = two_face_name(i), *unit = two_face_unit(i);
		if (v->seen)
			printf("%-14s %9.4f %s, known to %.4f%s", name, now, unit, deviation,
				has_changed(v) ? "" : ": as it was\n");
		else
			printf("%-14s cannot be seen by the faces in this place (to %.3g %s): it "
			       "stays %.4f %s\n",
				name, deviation, unit, then, unit);
		if (has_changed(v))
			printf(": changed from %.4f\n", then);
	}
	printf("the two faces were %.2f mm apart, now %.2f mm; noise makes %.2f mm (%u patches)\n",
		1e3 * r->error_before_m, 1e3 * r->error_after_m, 1e3 * r->noise_error_m,
		r->patches);
	printf("a turn about the axis and the height on it show in no scan: they stay as they "
	       "were\n");
}

static void print_boards(const struct faces *f, const struct board_result *b)
{
	const struct camera_calibration *c = &b->camera, *was = &f->calibration.camera;
	if (!b->boards) {
		printf("camera: no checkerboard was seen in %u photos; it stays as it was\n",
			f->photos->len);
		return;
	}
	printf("camera: %u boards in %u views; corners were %.2f px off, now %.2f px\n", b->boards,
		b->views, b->first_rms_px, b->rms_px);
	printf("focal lengths  %9.3f %.3f px, known to %.3f %.3f (were %.3f %.3f)\n", c->fx, c->fy,
		b->deviation[BOARD_FX], b->deviation[BOARD_FY], was->fx, was->fy);
	printf("centre         %9.3f %.3f px, known to %.3f %.3f (was %.3f %.3f)\n", c->cx, c->cy,
		b->deviation[BOARD_CX], b->deviation[BOARD_CY], was->cx, was->cy);
	printf("place          %9.2f %.2f %.2f mm, known to %.2f %.2f %.2f\n",
		1e3 * c->translation_m[0], 1e3 * c->translation_m[1], 1e3 * c->translation_m[2],
		1e3 * b->deviation[BOARD_X], 1e3 * b->deviation[BOARD_Y],
		1e3 * b->deviation[BOARD_Z]);
	if (b->met)
		printf("range offset   %9.2f mm, known to %.2f, by the boards; so are the camera's "
		       "azimuth and height against the lidar\n",
			1e3 * b->range_offset_m, 1e3 * b->range_deviation_m);
	else
		printf("the lidar saw too little of the boards: the camera's azimuth and height "
		       "against it stay as they were\n");
}

static void print_json(const struct measured *m)
{
	g_autofree char *text = certificate_text(m, NULL), *words = check_words(m->lidar);
	JsonObject *o = json_object_new();
	if (output)
		json_object_set_string_member(o, "certificate", output);
	json_object_set_boolean_member(o, "holds", is_good(m->lidar));
	json_object_set_string_member(o, "sentence", words);
	json_object_set_double_member(o, "two_face_error_mm", 1e3 * m->lidar->error_before_m);
	json_object_set_double_member(o, "noise_mm", 1e3 * m->lidar->noise_error_m);
	if (!check && text)
		json_object_set_member(o, "calibration", json_from_string(text, NULL));
	cli_print_json(o);
}

static int report(const struct measured *m)
{
	g_autofree char *words = check_words(m->lidar);
	if (json)
		print_json(m);
	else if (!check)
		print_faces(m->lidar);
	else if (is_good(m->lidar))
		printf("%s\n", words);
	if (!json && m->boards)
		print_boards(m->faces, m->boards);
	if (!check || json || is_good(m->lidar))
		return cli_done(COMMAND);
	g_printerr("pleinair %s: %s\n", COMMAND, words);
	return CLI_FAILED;
}

/* ---- the whole ---- */

static bool save(const struct measured *m, GError **error)
{
	g_autofree char *kept = NULL;
	if (!output)
		return true;
	if (!certificate_save(m, output, &kept, error))
		return false;
	if (!json)
		g_printerr("%s is written%s%s; [head] certificate in /etc/pleinair.conf says which "
			   "is in use\n",
			output, kept ? "; the one before is " : "", kept ? kept : "");
	return true;
}

static int calibrate(const char *record, const struct board_desc *desc, struct work *w)
{
	g_autoptr(GError) error = NULL;
	double rest = 1 - w->from - w->share;
	struct two_face_result lidar;
	struct board_result boards = { 0 };
	begin(w, READ_SHARE * rest, "reading the record");
	g_autoptr(faces) f = faces_read(record, go_on, w, &error);
	begin(w, FACES_SHARE * rest, "comparing the two faces");
	go_on(0, w);
	bool good = f && two_face_solve(f, &lidar, &error);
	begin(w, (1 - READ_SHARE - FACES_SHARE) * rest, "looking for checkerboards");
	good = good && (!desc || board_camera_solve(f, desc, &lidar, go_on, w, &boards, &error));
	cli_bar_end(&w->bar);
	struct measured m = { f, &lidar, desc && boards.boards ? &boards : NULL, record };
	if (!good || !save(&m, &error))
		return cli_fail(COMMAND, error);
	if (desc && !m.boards && !json)
		print_boards(f, &boards);
	return report(&m);
}

static bool parse_board(struct board_desc *ret)
{
	char *end = NULL;
	guint64 columns = g_ascii_strtoull(board, &end, 10),
		rows = *end == 'x' ? g_ascii_strtoull(end + 1, &end, 10) : 0;
	*ret = (struct board_desc){ (uint32_t)columns, (uint32_t)rows, square_mm * 1e-3 };
	return *end == '\0' && columns >= 3 && rows >= 3 && columns * rows <= BOARD_CORNERS_MAX &&
	       (columns + rows) % 2 == 1 && square_mm >= 1 && square_mm <= 1000;
}

/* What is scanned only for this stands beside the certificate until it is done. */
static int scan_and_calibrate(const struct board_desc *desc, struct work *w)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *near = g_path_get_dirname(output ? output : "."),
			*own = g_build_filename(near, ".calibrate-XXXXXX", NULL);
	if (!site_folder && !g_mkdtemp(own))
		return cli_misuse(COMMAND,
			"%s cannot be written: --site SITE says where the scan goes", near);
	w->share = SCAN_SHARE;
	g_autofree char *record = scan_into(site_folder ? site_folder : own, w, &error);
	int status = record ? calibrate(record, desc, w)
			    : (cli_bar_end(&w->bar), cli_fail(COMMAND, error));
	if (!site_folder)
		files_remove_tree(own, NULL);
	return status;
}

int main(int argc, char **argv)
{
	int status;
	struct board_desc desc;
	g_autoptr(GError) error = NULL;
	if (!cli_parse(COMMAND, "[RECORD|SITE|SITE/SCAN]",
		    "Finds where lidar and camera sit on the head, and writes its certificate.",
		    "The lidar by what the front and the back of its fan see of the same walls, "
		    "the camera\n"
		    "by checkerboards. With --check it only tells whether the certificate still "
		    "holds.\n\n"
		    "Examples:\n"
		    "  pleinair calibrate --device 'sim:range?edge_rays=9' --board 9x6 --square-mm "
		    "60 -o head.json\n"
		    "  pleinair calibrate oak --check\n",
		    entries, &argc, &argv, &status))
		return status;
	if (argc > 2 || (argc == 2) == (device != NULL))
		return cli_misuse(COMMAND, "a record, a scan or a site, or --device");
	if (site_folder && !device)
		return cli_misuse(COMMAND, "--site goes with --device");
	if (check && (output || board))
		return cli_misuse(COMMAND, "--check writes nothing and needs no board");
	if (board && !parse_board(&desc))
		return cli_misuse(COMMAND,
			"--board %s: corners inside as 9x6, one number even and one odd, and "
			"squares of 1 to 1000 mm",
			board);
	cli_catch_interrupts();
	struct work w = { .bar = cli_bar_begin(COMMAND), .doing = "starting" };
	if (device)
		return scan_and_calibrate(board ? &desc : NULL, &w);
	g_autofree char *record = find_record(argv[1], &error);
	return record ? calibrate(record, board ? &desc : NULL, &w) : cli_fail(COMMAND, error);
}
