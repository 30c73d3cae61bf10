#include "process/export-stations.h"
#include "acquire/scan.h"
#include "process/export-walk.h"
#include "process/pose-json.h"
#include "process/scan-graph.h"
#include <json-glib/json-glib.h>
#include <math.h>
#include <string.h>

/* A scan that may become a station of the file. */
struct candidate {
	scan_data *scan;
	manifest *about;
	uint32_t group;   /* 0: nothing ties it to others */
	struct pose pose; /* scan to site, of a group */
};

static void candidate_clear(gpointer data)
{
	struct candidate *c = data;
	scan_data_free(c->scan);
	manifest_free(c->about);
}

static void export_picture_free(gpointer data)
{
	struct export_picture *p = data;
	g_free(p->path);
	g_free(p->name);
	g_free(p->kind);
	g_free(p);
}

void export_station_free(gpointer data)
{
	struct export_station *s = data;
	g_free(s->name);
	g_free(s->guid);
	g_free(s->vendor);
	g_free(s->model_name);
	g_free(s->serial);
	g_free(s->firmware);
	g_free(s->source);
	g_ptr_array_unref(s->pictures);
	export_survey_clear(&s->survey);
	g_free(s);
}

static bool refuse(const struct export_job *j, GError **error, const char *format, ...)
	G_GNUC_PRINTF(3, 4);
static bool refuse(const struct export_job *j, GError **error, const char *format, ...)
{
	va_list args;
	va_start(args, format);
	g_autofree char *what = g_strdup_vprintf(format, args);
	va_end(args);
	g_set_error(
		error, G_IO_ERROR, G_IO_ERROR_INVALID_ARGUMENT, "%s: %s", site_path(j->site), what);
	return false;
}

static void note(struct export_job *j, const char *format, ...) G_GNUC_PRINTF(2, 3);
static void note(struct export_job *j, const char *format, ...)
{
	va_list args;
	va_start(args, format);
	g_ptr_array_add(j->notes, g_strdup_vprintf(format, args));
	va_end(args);
}

/* ---- which ---- */

static bool is_chosen(const struct export_options *o, uint32_t number)
{
	for (guint i = 0; i < o->scan_count; i++)
		if (o->scans[i] == number)
			return true;
	return !o->scans;
}

static bool add_candidate(
	struct export_job *j, const scan_graph *g, uint32_t number, GArray *into, GError **error)
{
	const struct placed_scan *placed = scan_graph_scan(g, number);
	g_autofree char *folder = site_scan_path(j->site, number),
			*path = g_build_filename(folder, "scan.json", NULL);
	struct candidate c = { .pose = POSE_IDENTITY };
	c.scan = scan_data_peek(j->site, number, error);
	c.about = c.scan ? manifest_load(path, SCAN_SCHEMA, error) : NULL;
	if (!c.about) {
		candidate_clear(&c);
		return false;
	}
	if (placed && placed->group) {
		c.group = placed->group;
		c.pose = placed->pose;
	}
	g_array_append_val(into, c);
	return true;
}

/* Scans that were never compared stand where their files say: but only among each other, for nobody has looked yet whether others
 * stand in the same frame. */
static void take_given_poses(const scan_graph *g, GArray *candidates)
{
	for (guint i = 0; i < candidates->len && !g->scans->len; i++) {
		struct candidate *c = &g_array_index(candidates, struct candidate, i);
		if (!c->scan->has_given_pose)
			continue;
		c->group = 1;
		c->pose = c->scan->given_pose;
	}
}

static bool find_candidates(struct export_job *j, GArray *into, GError **error)
{
	g_autoptr(scan_graph) g = scan_graph_load(j->site, error);
	g_autoptr(GArray) numbers = g ? site_scans(j->site, error) : NULL;
	for (guint i = 0; numbers && i < numbers->len; i++) {
		uint32_t number = g_array_index(numbers, uint32_t, i);
		if (is_chosen(j->options, number) && !add_candidate(j, g, number, into, error))
			return false;
	}
	if (!numbers)
		return false;
	take_given_poses(g, into);
	for (guint i = 0; i < j->options->scan_count; i++) {
		bool found = false;
		for (guint k = 0; k < into->len; k++)
			found |= g_array_index(into, struct candidate, k).scan->number ==
				 j->options->scans[i];
		if (!found)
			return refuse(j, error, "has no scan %u", j->options->scans[i]);
	}
	return into->len || refuse(j, error, "has no scans yet");
}

static struct candidate *candidate_at(GArray *candidates, guint i)
{
	return &g_array_index(candidates, struct candidate, i);
}

/* The group with most of the scans; of equals the first. 0: no group. */
static uint32_t main_group(GArray *candidates)
{
	uint32_t best = 0;
	guint most = 0;
	for (guint i = 0; i < candidates->len; i++) {
		uint32_t group = candidate_at(candidates, i)->group;
		guint count = 0;
		for (guint k = 0; k < candidates->len; k++)
			count += candidate_at(candidates, k)->group == group;
		if (group && (count > most || (count == most && group < best))) {
			best = group;
			most = count;
		}
	}
	return best;
}

static bool keep_one_group(struct export_job *j, GArray *candidates, GError **error)
{
	uint32_t group = main_group(candidates);
	if (!group && candidates->len > 1)
		return refuse(j, error,
			"its scans are not aligned yet, so nobody knows where they stand to each "
			"other: "
			"'pleinair process' aligns them, and --raw exports them as they are");
	for (guint i = candidates->len; i-- > 0;) {
		struct candidate *c = candidate_at(candidates, i);
		if (c->group == group)
			continue;
		note(j, "scan %u is not aligned with the others and was left out", c->scan->number);
		g_array_remove_index(candidates, i);
	}
	return true;
}

static bool keep_grids(struct export_job *j, GArray *candidates, GError **error)
{
	for (guint i = candidates->len; i-- > 0;) {
		struct candidate *c = candidate_at(candidates, i);
		if (c->scan->kind != SCAN_CLOUD)
			continue;
		note(j, "scan %u has no rows and columns, which %s is made of, and was left out",
			c->scan->number, j->format->name);
		g_array_remove_index(candidates, i);
	}
	return candidates->len ||
	       refuse(j, error,
		       "has no scan with rows and columns, which %s is made of: export "
		       "it as E57 or LAS",
		       j->format->name);
}

static bool choose(struct export_job *j, GArray *candidates, GError **error)
{
	if (!find_candidates(j, candidates, error) ||
		(j->format->grids_only && !keep_grids(j, candidates, error)))
		return false;
	if (!j->options->raw)
		return keep_one_group(j, candidates, error);
	if (j->format->merged && candidates->len > 1)
		return refuse(j, error,
			"a raw export to %s would put all %u scans onto one another: choose one "
			"with "
			"--scans, or export to E57",
			j->format->name, candidates->len);
	return true;
}

/* ---- what is known of them ---- */

static char *text_of(const manifest *m, const char *key)
{
	return manifest_has(m, key) ? g_strdup(manifest_get_string(m, key, NULL)) : NULL;
}

static double time_of(const manifest *m, const char *key)
{
	g_autofree char *text = text_of(m, key);
	g_autoptr(GDateTime) time = text ? g_date_time_new_from_iso8601(text, NULL) : NULL;
	return time ? (double)g_date_time_to_unix(time) : NAN;
}

static char *vendor_of(const manifest *m, const char *model_name)
{
	static const char *const vendors[][2] = { { "cola", "SICK" }, { "scip", "Hokuyo" },
		{ "ld", "LDROBOT" }, { "rplidar", "Slamtec" } };
	g_autofree char *protocol = text_of(m, "lidar.protocol");
	if (model_name && g_str_has_prefix(model_name, "PLEINAIR"))
		return g_strdup("pleinair");
	for (size_t i = 0; i < G_N_ELEMENTS(vendors); i++)
		if (g_strcmp0(protocol, vendors[i][0]) == 0)
			return g_strdup(vendors[i][1]);
	return NULL;
}

/* Made of the site's id and the number, so that a second export has the same. */
static char *guid_of(const struct export_job *j, uint32_t number, const char *what)
{
	g_autofree char *text = g_strdup_printf("%s %u %s", j->site_id, number, what),
			*hash = g_compute_checksum_for_string(G_CHECKSUM_SHA256, text, -1);
	hash[12] = '8'; /* of a kind of its own (RFC 9562) */
	hash[16] = 'a';
	return g_ascii_strup(hash, 32);
}

char *export_guid(const struct export_job *j, uint32_t number, const char *what)
{
	g_autofree char *h = guid_of(j, number, what);
	return g_strdup_printf("{%.8s-%.4s-%.4s-%.4s-%.12s}", h, h + 8, h + 12, h + 16, h + 20);
}

static double number_of(JsonObject *o, const char *name)
{
	JsonNode *n = json_object_get_member(o, name);
	return n && JSON_NODE_HOLDS_VALUE(n) ? json_node_get_double(n) : 0;
}

static char *string_of(JsonObject *o, const char *name)
{
	JsonNode *n = json_object_get_member(o, name);
	return n && JSON_NODE_HOLDS_VALUE(n) ? g_strdup(json_node_get_string(n)) : NULL;
}

/* So that a pose which stood in the coordinates of a file stands in those of the new one. */
static struct pose moved_with(const struct candidate *c, const struct export_station *s,
	const double origin_m[3], const struct pose *pose)
{
	struct pose in_site = *pose;
	if (!c->scan->has_given_pose)
		return pose_compose(&s->pose, pose);
	for (int i = 0; i < 3; i++)
		in_site.translation_m[i] -= origin_m[i];
	struct pose back = pose_inverse(&c->scan->given_pose), own = pose_compose(&back, &in_site);
	return pose_compose(&s->pose, &own);
}

static void add_picture(
	struct export_job *j, const struct candidate *c, struct export_station *s, JsonObject *o)
{
	g_autofree char *file = string_of(o, "file"), *folder = site_scan_path(j->site, s->number);
	if (!file || strchr(file, '/'))
		return;
	struct export_picture *p = g_new0(struct export_picture, 1);
	struct pose pose;
	p->path = g_build_filename(folder, file, NULL);
	p->name = string_of(o, "name");
	p->kind = string_of(o, "kind");
	p->width = (int64_t)number_of(o, "width");
	p->height = (int64_t)number_of(o, "height");
	bool metres = json_object_has_member(o, "pixel_width_m");
	p->pixel_width = number_of(o, metres ? "pixel_width_m" : "pixel_width_rad");
	p->pixel_height = number_of(o, metres ? "pixel_height_m" : "pixel_height_rad");
	p->focal_m = number_of(o, "focal_m");
	p->has_pose = json_read_pose(json_object_get_member(o, "pose"), &pose);
	if (p->has_pose)
		p->pose = moved_with(c, s, j->origin_m, &pose);
	g_ptr_array_add(s->pictures, p);
}

static void add_pictures(struct export_job *j, const struct candidate *c, struct export_station *s)
{
	JsonNode *node = manifest_get_node(c->about, "pictures");
	JsonArray *array = node && JSON_NODE_HOLDS_ARRAY(node) ? json_node_get_array(node) : NULL;
	for (guint i = 0; array && i < json_array_get_length(array); i++) {
		JsonNode *one = json_array_get_element(array, i);
		if (JSON_NODE_HOLDS_OBJECT(one))
			add_picture(j, c, s, json_node_get_object(one));
	}
}

static bool read_size(struct export_station *s, const struct candidate *c, GError **error)
{
	int64_t columns, rows, count = 0;
	bool recorded = s->kind == SCAN_RECORDED;
	if (!manifest_get_int(c->about, recorded ? "panorama.columns" : "points.columns", 0,
		    PANORAMA_COLUMNS_MAX, &columns, error) ||
		!manifest_get_int(c->about, recorded ? "panorama.rows" : "points.rows", 0,
			G_MAXINT32, &rows, error) ||
		(!recorded &&
			!manifest_get_int(c->about, "points.count", 0, G_MAXINT64, &count, error)))
		return false;
	s->columns = (uint32_t)columns;
	s->rows = (uint32_t)rows;
	s->cells = s->kind == SCAN_CLOUD ? (uint64_t)count : (uint64_t)columns * (uint64_t)rows;
	return true;
}

static void set_pose(
	const struct export_job *j, const struct candidate *c, struct export_station *s)
{
	bool raw = j->options->raw;
	s->has_pose = raw ? c->scan->has_given_pose : c->group > 0;
	s->pose = raw && s->has_pose ? c->scan->given_pose : raw ? POSE_IDENTITY : c->pose;
	for (int i = 0; i < 3 && s->has_pose && j->format->has_map; i++)
		s->pose.translation_m[i] += j->origin_m[i];
}

static bool add_station(struct export_job *j, const struct candidate *c, GError **error)
{
	struct export_station *s = g_new0(struct export_station, 1);
	const manifest *m = c->about;
	g_ptr_array_add(j->stations, s);
	s->number = c->scan->number;
	s->kind = c->scan->kind;
	s->pictures = g_ptr_array_new_with_free_func(export_picture_free);
	s->guid = export_guid(j, s->number, "scan");
	s->model_name = text_of(m, "lidar.model");
	s->vendor = vendor_of(m, s->model_name);
	s->serial = text_of(m, "lidar.serial");
	s->firmware = text_of(m, "lidar.firmware");
	s->source = text_of(m, "source.file");
	s->name = g_strdup_printf("%s %04u", j->site_name, s->number);
	s->started_s = time_of(m, "started");
	s->finished_s = time_of(m, "finished");
	set_pose(j, c, s);
	add_pictures(j, c, s);
	return read_size(s, c, error);
}

/* ---- the site ---- */

static bool read_site(struct export_job *j, GError **error)
{
	const manifest *m = site_manifest(j->site);
	JsonNode *node = manifest_get_node(m, "origin_m");
	if (node && !json_read_numbers(node, 3, j->origin_m)) {
		g_set_error(error, MANIFEST_ERROR, MANIFEST_ERROR_VALUE,
			"%s: 'origin_m' is not three numbers", manifest_path(m));
		return false;
	}
	j->site_name = manifest_get_string(m, "name", error);
	j->site_id = j->site_name ? manifest_get_string(m, "id", error) : NULL;
	return j->site_id;
}

static bool is_on_map(const struct export_job *j)
{
	return j->origin_m[0] != 0 || j->origin_m[1] != 0 || j->origin_m[2] != 0;
}

bool export_find_stations(struct export_job *j, GError **error)
{
	g_autoptr(GArray) candidates = g_array_new(false, true, sizeof(struct candidate));
	g_array_set_clear_func(candidates, candidate_clear);
	if (!read_site(j, error) || !choose(j, candidates, error))
		return false;
	for (guint i = 0; i < candidates->len; i++)
		if (!add_station(j, candidate_at(candidates, i), error))
			return false;
	j->one_grid = j->format->keeps_one_grid && j->stations->len == 1 &&
		      export_station_at(j, 0)->columns > 0;
	if (is_on_map(j) && !j->format->has_map)
		note(j, "coordinates are the site's own: to those of the map add %.0f %.0f %.0f m",
			j->origin_m[0], j->origin_m[1], j->origin_m[2]);
	return true;
}
