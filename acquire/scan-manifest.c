#include "acquire/scan-manifest.h"
#include "acquire/planes.h"
#include "acquire/scan.h"
#include "firmware-io/files.h"
#include "firmware-io/sha256.h"
#include <errno.h>
#include <fcntl.h>
#include <json-glib/json-glib.h>
#include <math.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define DEGREE             (G_PI / 180)
#define GRID_TOLERANCE_RAD 1e-9

static bool refuse(GError **error, const manifest *m, const char *format, ...) G_GNUC_PRINTF(3, 4);

static bool refuse(GError **error, const manifest *m, const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	g_autofree char *what = g_strdup_vprintf(format, arguments);
	va_end(arguments);
	g_set_error(error, G_FILE_ERROR, G_FILE_ERROR_INVAL, "%s: %s", manifest_path(m), what);
	return false;
}

static char *now_text(void)
{
	g_autoptr(GDateTime) now = g_date_time_new_now_utc();
	return g_date_time_format(now, "%Y-%m-%dT%H:%M:%SZ");
}

manifest *scan_manifest_begin(const struct preset *preset, bool hdr, const char *device)
{
	g_autofree char *started = now_text();
	struct panorama_desc grid = panorama_desc_for(preset->columns, preset->rows);
	manifest *m = manifest_new("scan.json");
	manifest_set_int(m, "schema", SCAN_SCHEMA);
	manifest_set_string(m, "state", "partial");
	manifest_set_string(m, "preset", preset->name);
	if (hdr)
		manifest_set_int(m, "hdr.exposures", EXPOSURES_MAX);
	manifest_set_string(m, "device", device);
	manifest_set_string(m, "started", started);
	manifest_set_int(m, "panorama.columns", grid.columns);
	manifest_set_int(m, "panorama.rows", grid.rows);
	manifest_set_number(m, "panorama.elevation_min_deg", grid.elevation_min_rad / DEGREE);
	manifest_set_number(m, "panorama.elevation_max_deg", grid.elevation_max_rad / DEGREE);
	return m;
}

char *scan_session_text(const char *device, const head *h)
{
	g_autofree char *now = now_text();
	g_autoptr(JsonObject) o = json_object_new();
	json_object_set_string_member(o, "device", device);
	json_object_set_string_member(o, "protocol", h->lidar_protocol);
	json_object_set_string_member(o, "time", now);
	json_object_set_member(o, "calibration", json_from_string(h->calibration, NULL));
	g_autoptr(JsonNode) node = json_node_alloc();
	json_node_init_object(node, o);
	return json_to_string(node, FALSE);
}

static void set_lidar(manifest *m, const struct develop_result *d)
{
	manifest_set_string(m, "lidar.protocol", d->protocol);
	manifest_set_string(m, "lidar.model", d->lidar.model);
	manifest_set_string(m, "lidar.serial", d->lidar.serial);
	manifest_set_string(m, "lidar.firmware", d->lidar.firmware);
	manifest_set_number(m, "lidar.scan_rate_hz", d->lidar.scan_rate_hz);
	manifest_set_int(m, "lidar.beams", d->lidar.beams);
	manifest_set_number(m, "lidar.beam_step_deg", fabs(d->lidar.angle_step_rad) / DEGREE);
	manifest_set_number(m, "lidar.clock_drift_ppm", d->report.drift_ppm);
	if (d->delay_known)
		manifest_set_number(m, "lidar.delay_us", 1e6 * d->delay.delay_s);
}

static void set_report(manifest *m, const struct develop_result *d)
{
	manifest_set_int(m, "sessions", d->report.sessions);
	manifest_set_int(m, "photos", d->photos);
	if (scan_manifest_is_hdr(m))
		manifest_set_int(m, "hdr.photos", d->merged_photos);
	manifest_set_int(m, "revolutions.recorded", d->report.revolutions);
	manifest_set_int(m, "revolutions.lost", d->report.lost_revolutions);
	manifest_set_int(m, "revolutions.distrusted", d->report.device_errors);
	manifest_set_int(m, "revolutions.counter_jumps", d->report.counter_jumps);
	manifest_set_int(m, "revolutions.bad_telegrams", d->report.bad_telegrams);
	manifest_set_int(m, "revolutions.stage_slips", d->report.suspect_intervals);
	JsonArray *losses = json_array_new();
	for (guint i = 0; d->losses && i < d->losses->len; i++) {
		const struct stream_loss *l = &g_array_index(d->losses, struct stream_loss, i);
		JsonObject *o = json_object_new();
		json_object_set_double_member(o, "from_deg", l->from_rad / DEGREE);
		json_object_set_double_member(o, "to_deg", l->to_rad / DEGREE);
		json_object_set_int_member(o, "revolutions", l->revolutions);
		json_array_add_object_element(losses, o);
	}
	JsonNode *node = json_node_new(JSON_NODE_ARRAY);
	json_node_take_array(node, losses);
	manifest_set_node(m, "losses", node);
}

static void set_counts(manifest *m, const panorama *p)
{
	struct panorama_counts n = panorama_count(p);
	manifest_set_int(m, "panorama.measured", (int64_t)n.measured);
	manifest_set_int(m, "panorama.filled", (int64_t)n.filled);
	manifest_set_int(m, "panorama.no_return", (int64_t)n.no_return);
	manifest_set_int(m, "panorama.empty", (int64_t)n.empty);
}

/* ---- files ---- */

static char *hash_file(const char *path, int64_t *ret_bytes, GError **error)
{
	int fd = files_open_plain(path, NULL, error);
	if (fd < 0)
		return NULL;
	g_autoptr(GMappedFile) file = g_mapped_file_new_from_fd(fd, FALSE, error);
	close(fd);
	if (!file)
		return g_prefix_error(error, "%s: ", path), NULL;
	*ret_bytes = (int64_t)g_mapped_file_get_length(file);
	return sha256_of(g_mapped_file_get_contents(file), g_mapped_file_get_length(file));
}

/* raw.rec, then the planes that are there. */
static GPtrArray *file_names(const char *folder)
{
	GPtrArray *names = g_ptr_array_new();
	g_ptr_array_add(names, (gpointer) "raw.rec");
	for (const char *const *name = planes_names; *name; name++) {
		g_autofree char *path = g_build_filename(folder, *name, NULL);
		if (g_file_test(path, G_FILE_TEST_EXISTS))
			g_ptr_array_add(names, (gpointer)*name);
	}
	return names;
}

static bool set_files(manifest *m, const char *folder, GError **error)
{
	g_autoptr(GPtrArray) names = file_names(folder);
	g_autofree char **sums = g_new0(char *, names->len);
	g_autofree int64_t *bytes = g_new0(int64_t, names->len);
	g_autofree GError **errors = g_new0(GError *, names->len);
	bool good = true;
#pragma omp parallel for schedule(dynamic, 1)
	for (guint i = 0; i < names->len; i++) {
		g_autofree char *path = g_build_filename(folder, names->pdata[i], NULL);
		sums[i] = hash_file(path, &bytes[i], &errors[i]);
	}
	JsonObject *files = json_object_new();
	for (guint i = 0; i < names->len; i++) {
		if (errors[i] && good)
			g_propagate_error(error, g_error_copy(errors[i]));
		good = good && !errors[i];
		JsonObject *o = json_object_new();
		json_object_set_int_member(o, "bytes", bytes[i]);
		json_object_set_string_member(o, "sha256", sums[i] ? sums[i] : "");
		json_object_set_object_member(files, names->pdata[i], o);
		g_free(sums[i]);
		g_clear_error(&errors[i]);
	}
	JsonNode *node = json_node_new(JSON_NODE_OBJECT);
	json_node_take_object(node, files);
	manifest_set_node(m, "files", node);
	return good;
}

bool scan_manifest_finish(manifest *m, const char *folder, const panorama *p,
	const struct develop_result *d, GError **error)
{
	g_autofree char *finished = now_text();
	set_lidar(m, d);
	set_report(m, d);
	set_counts(m, p);
	manifest_set_string(m, "calibration_serial", d->calibration.serial);
	/* Developing again does not change when the scan was made. */
	if (!manifest_has(m, "finished"))
		manifest_set_string(m, "finished", finished);
	manifest_set_string(m, "state", "complete");
	return set_files(m, folder, error);
}

/* ---- reading ---- */

const struct preset *scan_manifest_preset(const manifest *m, GError **error)
{
	const char *name = manifest_get_string(m, "preset", error);
	const struct preset *p = name ? preset_find(name) : NULL;
	if (name && !p)
		refuse(error, m, "there is no preset '%s'", name);
	return p;
}

bool scan_manifest_is_hdr(const manifest *m)
{
	return manifest_has(m, "hdr.exposures");
}

/* Nothing sums up scan.json itself, but the preset says what its grid must be. */
static bool fits_preset(const manifest *m, const struct panorama_desc *grid, GError **error)
{
	const char *name = manifest_get_string(m, "preset", error);
	const struct preset *p = name ? preset_find(name) : NULL;
	if (!p)
		return name;
	struct panorama_desc wanted = panorama_desc_for(p->columns, p->rows);
	if (grid->columns == wanted.columns && grid->rows == wanted.rows &&
		fabs(grid->elevation_min_rad - wanted.elevation_min_rad) < GRID_TOLERANCE_RAD &&
		fabs(grid->elevation_max_rad - wanted.elevation_max_rad) < GRID_TOLERANCE_RAD)
		return true;
	return refuse(error, m,
		"'panorama' is a grid of %u x %u from %g to %g degrees; that of preset '%s' is "
		"another",
		grid->columns, grid->rows, grid->elevation_min_rad / DEGREE,
		grid->elevation_max_rad / DEGREE, name);
}

bool scan_manifest_grid(const manifest *m, struct panorama_desc *ret, GError **error)
{
	int64_t columns, rows;
	double low, high;
	if (!manifest_get_int(m, "panorama.columns", 4, PANORAMA_COLUMNS_MAX, &columns, error) ||
		!manifest_get_int(m, "panorama.rows", 1, PANORAMA_ROWS_MAX, &rows, error) ||
		!manifest_get_number(m, "panorama.elevation_min_deg", -90.1, 90, &low, error) ||
		!manifest_get_number(m, "panorama.elevation_max_deg", -90, 90.1, &high, error))
		return false;
	if (high <= low || columns * rows > PANORAMA_CELLS_MAX)
		return refuse(error, m, "'panorama' describes a grid that cannot be");
	*ret = (struct panorama_desc){ columns, rows, low * DEGREE, high * DEGREE };
	return fits_preset(m, ret, error);
}

/* The object that says what NAME in the folder is like. */
static JsonObject *file_entry(const manifest *m, const char *name, GError **error)
{
	JsonNode *files = manifest_get_node(m, "files");
	JsonNode *node = files && JSON_NODE_HOLDS_OBJECT(files)
				 ? json_object_get_member(json_node_get_object(files), name)
				 : NULL;
	if (node && JSON_NODE_HOLDS_OBJECT(node))
		return json_node_get_object(node);
	refuse(error, m, "'files' does not tell size and SHA-256 of %s", name);
	return NULL;
}

/* -1 when it is none; the getters of JsonObject complain on the log where a value is of another
 * kind. */
static int64_t wanted_bytes(JsonObject *entry)
{
	JsonNode *node = json_object_get_member(entry, "bytes");
	return node && JSON_NODE_HOLDS_VALUE(node) && json_node_get_value_type(node) == G_TYPE_INT64
		       ? json_node_get_int(node)
		       : -1;
}

static const char *wanted_sum(JsonObject *entry)
{
	JsonNode *node = json_object_get_member(entry, "sha256");
	return node && JSON_NODE_HOLDS_VALUE(node) &&
			       json_node_get_value_type(node) == G_TYPE_STRING
		       ? json_node_get_string(node)
		       : "";
}

bool scan_manifest_verify_file(
	const manifest *m, const char *folder, const char *name, GError **error)
{
	g_autofree char *path = g_build_filename(folder, name, NULL);
	JsonObject *entry = file_entry(m, name, error);
	int64_t bytes = 0;
	g_autofree char *sum = entry ? hash_file(path, &bytes, error) : NULL;
	if (!sum)
		return false;
	if (bytes != wanted_bytes(entry))
		g_set_error(error, G_FILE_ERROR, G_FILE_ERROR_INVAL,
			"%s: has %" G_GINT64_FORMAT " bytes, scan.json says %" G_GINT64_FORMAT,
			path, bytes, wanted_bytes(entry));
	else if (strcmp(sum, wanted_sum(entry)) != 0)
		g_set_error(error, G_FILE_ERROR, G_FILE_ERROR_INVAL,
			"%s: is not as it was written: its SHA-256 differs from that in scan.json",
			path);
	else
		return true;
	return false;
}

/* raw.rec and all planes must be listed; colour.tiff where there is colour. */
static bool check_names(const manifest *m, const char *folder, GError **error)
{
	JsonNode *files = manifest_get_node(m, "files");
	if (!files || !JSON_NODE_HOLDS_OBJECT(files))
		return refuse(error, m, "'files' is missing");
	if (!file_entry(m, "raw.rec", error))
		return false;
	for (const char *const *name = planes_names; *name; name++) {
		bool optional = !name[1];
		g_autofree char *path = g_build_filename(folder, *name, NULL);
		if ((!optional || g_file_test(path, G_FILE_TEST_EXISTS)) &&
			!file_entry(m, *name, error))
			return false;
	}
	return true;
}

bool scan_manifest_verify_planes(const manifest *m, const char *folder, GError **error)
{
	if (!check_names(m, folder, error))
		return false;
	JsonObject *files = json_node_get_object(manifest_get_node(m, "files"));
	for (const char *const *name = planes_names; *name; name++)
		if (json_object_has_member(files, *name) &&
			!scan_manifest_verify_file(m, folder, *name, error))
			return false;
	return true;
}

bool scan_manifest_verify(const manifest *m, const char *folder, GError **error)
{
	if (!check_names(m, folder, error))
		return false;
	JsonObject *files = json_node_get_object(manifest_get_node(m, "files"));
	g_autoptr(GList) names = json_object_get_members(files);
	for (GList *name = names; name; name = name->next) {
		const char *text = name->data;
		if (!*text || *text == '.' || strchr(text, '/'))
			return refuse(error, m, "'files' names no file of the scan: '%s'", text);
		if (!scan_manifest_verify_file(m, folder, name->data, error))
			return false;
	}
	return true;
}
