#include "process/model-inputs.h"
#include <json-glib/json-glib.h>
#include <string.h>

static void clear_input(gpointer data)
{
	struct model_input *input = data;
	g_free(input->fingerprint);
	g_free(input->geometry);
	g_free(input->features);
	g_free(input->key);
	g_free(input->segments);
	g_free(input->part_key);
}

void model_inputs_free(model_inputs *m)
{
	if (!m)
		return;
	g_array_unref(m->scans);
	g_free(m);
}

static char *key_of(const struct model_input *input)
{
	g_autoptr(GString) text = g_string_new(NULL);
	g_string_printf(text, "%d %u %s %s", MODEL_METHOD, input->number, input->fingerprint,
		input->geometry);
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 4; j++) {
			char number[G_ASCII_DTOSTR_BUF_SIZE];
			g_ascii_dtostr(number, sizeof number,
				j < 3 ? input->pose.rotation[i][j] : input->pose.translation_m[i]);
			g_string_append_printf(text, " %s", number);
		}
	return g_compute_checksum_for_string(G_CHECKSUM_SHA256, text->str, -1);
}

/* *ret_rings: of a cloud that was seen from one place. */
static bool geometry_checksum(
	const site *s, uint32_t number, char **ret, uint32_t *ret_rings, GError **error)
{
	g_autoptr(GError) missing = NULL;
	g_autoptr(scan_geometry) g = scan_geometry_open(s, number, &missing);
	if (!g && !g_error_matches(missing, G_IO_ERROR, G_IO_ERROR_NOT_FOUND)) {
		g_propagate_error(error, g_steal_pointer(&missing));
		return false;
	}
	*ret = g ? g_strdup_printf("%08x", product_checksum(g->file)) : g_strdup("");
	*ret_rings = g ? g->rings : 0;
	return true;
}

static bool segments_checksum(const site *s, uint32_t number, char **ret, GError **error)
{
	g_autoptr(GError) missing = NULL;
	g_autoptr(scan_segments) g = scan_segments_open(s, number, &missing);
	if (!g && !g_error_matches(missing, G_IO_ERROR, G_IO_ERROR_NOT_FOUND)) {
		g_propagate_error(error, g_steal_pointer(&missing));
		return false;
	}
	*ret = g ? g_strdup_printf("%08x", product_checksum(g->file)) : g_strdup("");
	return true;
}

static char *part_key_of(const struct model_input *input)
{
	g_autofree char *text =
		g_strdup_printf("%s %s %s", input->key, input->segments, input->features);
	return g_compute_checksum_for_string(G_CHECKSUM_SHA256, text, -1);
}

static bool features_checksum(const site *s, uint32_t number, char **ret, GError **error)
{
	g_autoptr(GError) missing = NULL;
	g_autoptr(scan_features) f = scan_features_open(s, number, &missing);
	if (!f && !g_error_matches(missing, G_IO_ERROR, G_IO_ERROR_NOT_FOUND)) {
		g_propagate_error(error, g_steal_pointer(&missing));
		return false;
	}
	*ret = f ? g_strdup_printf("%08x", product_checksum(f->file)) : g_strdup("");
	return true;
}

static bool read_input(const site *s, const struct placed_scan *placed, struct model_input *ret,
	bool *ret_given, GError **error)
{
	g_autoptr(scan_data) d = scan_data_peek(s, placed->number, error);
	if (!d)
		return false;
	uint32_t rings;
	*ret_given = d->has_given_pose;
	*ret = (struct model_input){ .number = placed->number,
		.kind = d->kind,
		.pose = placed->pose,
		.fingerprint = g_strdup(d->fingerprint) };
	if (!geometry_checksum(s, placed->number, &ret->geometry, &rings, error) ||
		!segments_checksum(s, placed->number, &ret->segments, error) ||
		!features_checksum(s, placed->number, &ret->features, error))
		return clear_input(ret), false;
	ret->is_station = ret->kind != SCAN_CLOUD || rings;
	ret->key = key_of(ret);
	ret->part_key = part_key_of(ret);
	return true;
}

/* false: these features do not say. */
static bool read_tone(model_inputs *m, const scan_features *f)
{
	JsonObject *made = product_manifest(f->file);
	double density = json_object_get_double_member_with_default(made, "dither_per_m2", 0);
	double exponent = json_object_get_double_member_with_default(made, "tone_exponent", 0);
	if (!(density > 0) || !(exponent > 0))
		return false;
	m->dither_per_m2 = density;
	m->tone_exponent = exponent;
	return true;
}

static bool find_tone(const site *s, model_inputs *m, GError **error)
{
	const struct features_options defaults = features_defaults(NULL);
	bool is_found = false;
	m->dither_per_m2 = defaults.dither_per_m2;
	m->tone_exponent = defaults.tone_exponent;
	for (guint i = 0; i < m->scans->len && !is_found; i++) {
		const struct model_input *input = model_inputs_at(m, i);
		if (!input->features[0])
			continue;
		g_autoptr(scan_features) f = scan_features_open(s, input->number, error);
		if (!f)
			return false;
		is_found = read_tone(m, f);
	}
	return true;
}

struct group {
	uint32_t scans;
	bool is_given; /* one of its scans came with its pose */
};

static uint32_t largest(const GArray *groups)
{
	uint32_t best = 0;
	for (guint i = 1; i < groups->len; i++)
		if (g_array_index(groups, struct group, i).scans >
			g_array_index(groups, struct group, best).scans)
			best = i;
	return best;
}

static void keep_one_frame(model_inputs *m, const GArray *groups, const GArray *group_of)
{
	uint32_t main_group = largest(groups);
	for (guint i = m->scans->len; i--;) {
		uint32_t g = g_array_index(group_of, uint32_t, i);
		if (g == main_group ||
			(g_array_index(groups, struct group, g).is_given &&
				g_array_index(groups, struct group, main_group).is_given))
			continue;
		g_array_remove_index(m->scans, i);
		m->left_out++;
	}
}

model_inputs *model_inputs_new(const site *s, const scan_graph *graph, GError **error)
{
	g_autoptr(model_inputs) m = g_new0(model_inputs, 1);
	g_autoptr(GArray) groups = g_array_new(FALSE, TRUE, sizeof(struct group));
	g_autoptr(GArray) group_of = g_array_new(FALSE, FALSE, sizeof(uint32_t));
	m->scans = g_array_new(FALSE, TRUE, sizeof(struct model_input));
	g_array_set_clear_func(m->scans, clear_input);
	for (guint i = 0; i < graph->scans->len; i++) {
		const struct placed_scan *p = &g_array_index(graph->scans, struct placed_scan, i);
		struct model_input input;
		bool is_given;
		if (!p->group)
			continue;
		if (!read_input(s, p, &input, &is_given, error))
			return NULL;
		if (groups->len <= p->group)
			g_array_set_size(groups, p->group + 1);
		struct group *g = &g_array_index(groups, struct group, p->group);
		g->scans++;
		g->is_given |= is_given;
		g_array_append_val(m->scans, input);
		g_array_append_val(group_of, p->group);
	}
	if (m->scans->len)
		keep_one_frame(m, groups, group_of);
	return find_tone(s, m, error) ? g_steal_pointer(&m) : NULL;
}

static bool check_count(const product *file, uint64_t has, const scan_data *data, GError **error)
{
	uint64_t count = data->grid ? range_grid_cells(data->grid) : data->points->count;
	if (has == count)
		return true;
	g_set_error(error, PRODUCT_ERROR, PRODUCT_ERROR_DAMAGED,
		"%s: is of %" G_GUINT64_FORMAT " points, but the scan has %" G_GUINT64_FORMAT,
		product_path(file), has, count);
	return false;
}

bool model_input_geometry(const site *s, const struct model_input *input, const scan_data *data,
	scan_geometry **ret, GError **error)
{
	*ret = NULL;
	if (!input->geometry[0])
		return true;
	g_autoptr(scan_geometry) g = scan_geometry_open(s, input->number, error);
	if (!g)
		return false;
	if (!check_count(g->file, g->count, data, error))
		return false;
	*ret = g_steal_pointer(&g);
	return true;
}

bool model_input_segments(const site *s, const struct model_input *input, const scan_data *data,
	scan_segments **ret, GError **error)
{
	*ret = NULL;
	if (!input->segments[0])
		return true;
	g_autoptr(scan_segments) g = scan_segments_open(s, input->number, error);
	if (!g || !check_count(g->file, g->count, data, error))
		return false;
	*ret = g_steal_pointer(&g);
	return true;
}

bool model_input_features(const site *s, const struct model_input *input, const scan_data *data,
	scan_features **ret, GError **error)
{
	*ret = NULL;
	if (!input->features[0])
		return true;
	g_autoptr(scan_features) f = scan_features_open(s, input->number, error);
	if (!f || !check_count(f->file, f->count, data, error))
		return false;
	*ret = g_steal_pointer(&f);
	return true;
}

/* ---- manifest ---- */

static JsonArray *pose_to_json(const struct pose *p)
{
	JsonArray *a = json_array_new();
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			json_array_add_double_element(a, p->rotation[i][j]);
	for (int i = 0; i < 3; i++)
		json_array_add_double_element(a, p->translation_m[i]);
	return a;
}

JsonNode *model_inputs_to_json(const model_inputs *m)
{
	JsonArray *scans = json_array_new();
	for (guint i = 0; i < m->scans->len; i++) {
		const struct model_input *input = model_inputs_at(m, i);
		JsonObject *o = json_object_new();
		json_object_set_int_member(o, "scan", input->number);
		json_object_set_string_member(o, "points", input->fingerprint);
		json_object_set_string_member(o, "geometry", input->geometry);
		json_object_set_string_member(o, "segments", input->segments);
		json_object_set_string_member(o, "features", input->features);
		json_object_set_array_member(o, "pose", pose_to_json(&input->pose));
		json_object_set_boolean_member(o, "is_station", input->is_station);
		json_object_set_string_member(o, "key", input->part_key);
		json_array_add_object_element(scans, o);
	}
	JsonNode *node = json_node_new(JSON_NODE_ARRAY);
	json_node_take_array(node, scans);
	return node;
}

static const char *string_in(JsonObject *o, const char *key)
{
	JsonNode *node = json_object_get_member(o, key);
	bool is_value = node && JSON_NODE_HOLDS_VALUE(node);
	return is_value ? json_node_get_string(node) : NULL;
}

static JsonObject *find_scan(JsonArray *scans, uint32_t number)
{
	for (guint i = 0; i < json_array_get_length(scans); i++) {
		JsonNode *node = json_array_get_element(scans, i);
		JsonNode *scan =
			JSON_NODE_HOLDS_OBJECT(node)
				? json_object_get_member(json_node_get_object(node), "scan")
				: NULL;
		if (scan && JSON_NODE_HOLDS_VALUE(scan) && json_node_get_int(scan) == number)
			return json_node_get_object(node);
	}
	return NULL;
}

static char *scan_difference(const struct model_input *input, JsonObject *was)
{
	if (!was)
		return g_strdup_printf("scan %u is new", input->number);
	if (g_strcmp0(string_in(was, "key"), input->part_key) == 0)
		return NULL;
	if (g_strcmp0(string_in(was, "points"), input->fingerprint))
		return g_strdup_printf("scan %u has other points", input->number);
	if (g_strcmp0(string_in(was, "geometry"), input->geometry))
		return g_strdup_printf("scan %u has new geometry", input->number);
	if (g_strcmp0(string_in(was, "segments"), input->segments))
		return g_strdup_printf("scan %u has new segments", input->number);
	if (g_strcmp0(string_in(was, "features"), input->features))
		return g_strdup_printf("scan %u has new features", input->number);
	JsonNode *then = json_object_get_member(was, "pose");
	g_autoptr(JsonNode) now = json_node_new(JSON_NODE_ARRAY);
	json_node_take_array(now, pose_to_json(&input->pose));
	if (!then || !json_node_equal(then, now))
		return g_strdup_printf("scan %u stands elsewhere", input->number);
	return g_strdup("models are made in another way now");
}

char *model_inputs_difference(const model_inputs *m, JsonNode *json)
{
	if (!json || !JSON_NODE_HOLDS_ARRAY(json))
		return g_strdup("the model does not say what it was made from");
	JsonArray *scans = json_node_get_array(json);
	for (guint i = 0; i < m->scans->len; i++) {
		const struct model_input *input = model_inputs_at(m, i);
		char *difference = scan_difference(input, find_scan(scans, input->number));
		if (difference)
			return difference;
	}
	return json_array_get_length(scans) == m->scans->len
		       ? NULL
		       : g_strdup("a scan is not in it any more");
}
