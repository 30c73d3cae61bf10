#include "firmware-io/files.h"
#include "process/pose-json.h"
#include "process/scan-graph.h"
#include <json-glib/json-glib.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#define SCHEMA 1

static const char *const origin_names[] = { "automatic", "picked", "given" };
static const char *const decision_names[] = { "none", "accepted", "refused" };

static const struct {
	const char *name;
	size_t offset;
} figures[] = {
	{ "agree_sr", offsetof(struct verification, agree_sr) },
	{ "occluded_sr", offsetof(struct verification, occluded_sr) },
	{ "conflict_sr", offsetof(struct verification, conflict_sr) },
	{ "outside_sr", offsetof(struct verification, outside_sr) },
	{ "missed_sr", offsetof(struct verification, missed_sr) },
	{ "void_sr", offsetof(struct verification, void_sr) },
	{ "overlap", offsetof(struct verification, overlap) },
	{ "agreement", offsetof(struct verification, agreement) },
	{ "rms_m", offsetof(struct verification, rms_m) },
	{ "under_6mm", offsetof(struct verification, under_6mm) },
	{ "balance", offsetof(struct verification, balance) },
	{ "rest_m", offsetof(struct verification, rest_m) },
	{ "rest_rad", offsetof(struct verification, rest_rad) },
	{ "deviation_m", offsetof(struct verification, deviation_m) },
	{ "deviation_rad", offsetof(struct verification, deviation_rad) },
	{ "rival_score", offsetof(struct verification, rival_score) },
};

/* ---- writing ---- */

/* By row from the diagonal on. */
static JsonNode *write_covariance(const double m[6][6])
{
	double number[21];
	int n = 0;
	for (int i = 0; i < 6; i++)
		for (int j = i; j < 6; j++)
			number[n++] = m[i][j];
	return json_write_numbers(number, 21);
}

static void set_number(JsonObject *o, const char *key, double value)
{
	json_object_set_double_member(o, key, isfinite(value) ? value : 0);
}

static JsonObject *write_verification(const struct verification *v)
{
	JsonObject *o = json_object_new();
	json_object_set_string_member(o, "verdict", verdict_names[v->verdict]);
	json_object_set_string_member(o, "reason", v->reason);
	for (size_t i = 0; i < G_N_ELEMENTS(figures); i++)
		set_number(
			o, figures[i].name, *(const double *)((const char *)v + figures[i].offset));
	return o;
}

static JsonObject *write_edge(const struct edge *e)
{
	JsonObject *o = json_object_new();
	json_object_set_int_member(o, "a", e->a);
	json_object_set_int_member(o, "b", e->b);
	json_object_set_string_member(o, "origin", origin_names[e->origin]);
	json_object_set_string_member(o, "decision", decision_names[e->decision]);
	json_object_set_member(o, "pose", json_write_pose(&e->pose));
	json_object_set_member(o, "covariance", write_covariance(e->covariance));
	json_object_set_object_member(o, "verification", write_verification(&e->verification));
	json_object_set_boolean_member(o, "outlier", e->outlier);
	set_number(o, "loop_m", e->loop_m);
	set_number(o, "loop_rad", e->loop_rad);
	if (e->inputs)
		json_object_set_string_member(o, "inputs", e->inputs);
	return o;
}

static JsonObject *write_scan(const struct placed_scan *p)
{
	JsonObject *o = json_object_new();
	json_object_set_int_member(o, "number", p->number);
	json_object_set_int_member(o, "group", p->group);
	json_object_set_member(o, "pose", json_write_pose(&p->pose));
	set_number(o, "deviation_m", p->deviation_m);
	set_number(o, "deviation_rad", p->deviation_rad);
	return o;
}

static JsonNode *array_node(JsonArray *array)
{
	JsonNode *node = json_node_new(JSON_NODE_ARRAY);
	json_node_take_array(node, array);
	return node;
}

static void write_content(const scan_graph *g, manifest *m)
{
	JsonArray *edges = json_array_new(), *scans = json_array_new();
	for (guint i = 0; i < g->edges->len; i++)
		json_array_add_object_element(
			edges, write_edge(&g_array_index(g->edges, struct edge, i)));
	for (guint i = 0; i < g->scans->len; i++)
		json_array_add_object_element(
			scans, write_scan(&g_array_index(g->scans, struct placed_scan, i)));
	if (g->inputs)
		manifest_set_string(m, "inputs", g->inputs);
	manifest_set_node(m, "edges", array_node(edges));
	manifest_set_node(m, "scans", array_node(scans));
}

static manifest *write_graph(const scan_graph *g, const char *path)
{
	manifest *m = manifest_new(path);
	manifest_set_int(m, "schema", SCHEMA);
	manifest_set_int(m, "revision", g->revision);
	manifest_set_int(m, "parent", g->parent);
	manifest_set_string(m, "change", g->change ? g->change : "");
	manifest_set_string(m, "time", g->time ? g->time : "");
	write_content(g, m);
	return m;
}

bool scan_graph_save_file(const scan_graph *g, const char *path, GError **error)
{
	g_autoptr(manifest) m = write_graph(g, path);
	return manifest_save(m, error);
}

bool scan_graph_equal(const scan_graph *a, const scan_graph *b)
{
	g_autoptr(manifest) p = manifest_new("a");
	g_autoptr(manifest) q = manifest_new("b");
	write_content(a, p);
	write_content(b, q);
	g_autofree char *text = manifest_to_text(p), *other = manifest_to_text(q);
	return strcmp(text, other) == 0;
}

/* ---- reading ---- */

/* What is read just now, for messages: "scans" or "edges", and which of them. */
struct reading {
	const manifest *m;
	const char *list;
	guint index;
	GError **error;
};

static bool refuse(const struct reading *r, const char *what)
{
	g_set_error(r->error, MANIFEST_ERROR, MANIFEST_ERROR_VALUE, "%s: '%s', entry %u: %s",
		manifest_path(r->m), r->list, r->index + 1, what);
	return false;
}

static bool refuse_key(const struct reading *r, const char *key, const char *what)
{
	g_autofree char *text = g_strdup_printf("'%s' %s", key, what);
	return refuse(r, text);
}

static bool read_number(const struct reading *r, JsonObject *o, const char *key, double *ret)
{
	JsonNode *node = json_object_get_member(o, key);
	GType type = node && JSON_NODE_HOLDS_VALUE(node) ? json_node_get_value_type(node) : 0;
	if (type != G_TYPE_INT64 && type != G_TYPE_DOUBLE)
		return refuse_key(r, key, "is missing or no number");
	*ret = json_node_get_double(node);
	return isfinite(*ret) || refuse_key(r, key, "is too large");
}

static bool read_scan_number(
	const struct reading *r, JsonObject *o, const char *key, uint32_t min, uint32_t *ret)
{
	double value;
	if (!read_number(r, o, key, &value))
		return false;
	if (!(value >= min && value <= SITE_SCANS_MAX) || value != floor(value))
		return refuse_key(r, key, "is no number of a scan");
	*ret = (uint32_t)value;
	return true;
}

static const char *string_of(JsonObject *o, const char *key)
{
	JsonNode *node = json_object_get_member(o, key);
	bool good = node && JSON_NODE_HOLDS_VALUE(node) &&
		    json_node_get_value_type(node) == G_TYPE_STRING;
	return good ? json_node_get_string(node) : NULL;
}

static bool read_choice(const struct reading *r, JsonObject *o, const char *key,
	const char *const *names, size_t count, unsigned *ret)
{
	const char *text = string_of(o, key);
	for (*ret = 0; text && *ret < count; ++*ret)
		if (strcmp(text, names[*ret]) == 0)
			return true;
	return refuse_key(r, key, "is none of those that there are");
}

static bool read_covariance(const struct reading *r, JsonObject *o, double ret[6][6])
{
	double number[21];
	int n = 0;
	if (!json_read_numbers(json_object_get_member(o, "covariance"), 21, number))
		return refuse_key(r, "covariance", "is not 21 numbers");
	for (int i = 0; i < 6; i++)
		for (int j = i; j < 6; j++)
			ret[i][j] = ret[j][i] = number[n++];
	for (int i = 0; i < 6; i++)
		if (ret[i][i] < 0)
			return refuse_key(r, "covariance", "has a negative variance");
	return true;
}

static bool read_verification(const struct reading *r, JsonObject *edge, struct verification *v)
{
	JsonNode *node = json_object_get_member(edge, "verification");
	unsigned verdict;
	if (!node || !JSON_NODE_HOLDS_OBJECT(node))
		return refuse_key(r, "verification", "is missing");
	JsonObject *o = json_node_get_object(node);
	if (!read_choice(r, o, "verdict", verdict_names, VERDICTS, &verdict))
		return false;
	v->verdict = verdict;
	const char *reason = string_of(o, "reason");
	g_strlcpy(v->reason, reason ? reason : "", sizeof v->reason);
	for (size_t i = 0; i < G_N_ELEMENTS(figures); i++)
		if (!read_number(r, o, figures[i].name, (double *)((char *)v + figures[i].offset)))
			return false;
	return true;
}

static bool read_outlier(const struct reading *r, JsonObject *o, bool *ret)
{
	JsonNode *node = json_object_get_member(o, "outlier");
	if (!node || !JSON_NODE_HOLDS_VALUE(node) ||
		json_node_get_value_type(node) != G_TYPE_BOOLEAN)
		return refuse_key(r, "outlier", "is missing or neither true nor false");
	*ret = json_node_get_boolean(node);
	return true;
}

static bool read_edge(const struct reading *r, JsonObject *o, struct edge *e)
{
	unsigned origin, decision;
	if (!read_scan_number(r, o, "a", 1, &e->a) || !read_scan_number(r, o, "b", 1, &e->b) ||
		!read_choice(r, o, "origin", origin_names, G_N_ELEMENTS(origin_names), &origin) ||
		!read_choice(r, o, "decision", decision_names, G_N_ELEMENTS(decision_names),
			&decision) ||
		!read_covariance(r, o, e->covariance) ||
		!read_verification(r, o, &e->verification) || !read_outlier(r, o, &e->outlier) ||
		!read_number(r, o, "loop_m", &e->loop_m) ||
		!read_number(r, o, "loop_rad", &e->loop_rad))
		return false;
	e->origin = origin;
	e->decision = decision;
	if (e->a >= e->b)
		return refuse(r, "'a' must be below 'b'");
	if (!json_read_pose(json_object_get_member(o, "pose"), &e->pose))
		return refuse(r, "'pose' is no rotation with a translation");
	e->inputs = g_strdup(string_of(o, "inputs"));
	return true;
}

static bool read_placed(const struct reading *r, JsonObject *o, struct placed_scan *p)
{
	if (!read_scan_number(r, o, "number", 1, &p->number) ||
		!read_scan_number(r, o, "group", 0, &p->group) ||
		!read_number(r, o, "deviation_m", &p->deviation_m) ||
		!read_number(r, o, "deviation_rad", &p->deviation_rad))
		return false;
	return json_read_pose(json_object_get_member(o, "pose"), &p->pose) ||
	       refuse(r, "'pose' is no rotation with a translation");
}

static JsonArray *list_of(const struct reading *r)
{
	JsonNode *node = manifest_get_node(r->m, r->list);
	if (node && JSON_NODE_HOLDS_ARRAY(node))
		return json_node_get_array(node);
	g_set_error(r->error, MANIFEST_ERROR, MANIFEST_ERROR_VALUE,
		"%s: '%s' is missing or no list", manifest_path(r->m), r->list);
	return NULL;
}

static JsonObject *entry_of(const struct reading *r, JsonArray *list)
{
	JsonNode *node = json_array_get_element(list, r->index);
	if (JSON_NODE_HOLDS_OBJECT(node))
		return json_node_get_object(node);
	refuse(r, "is no object");
	return NULL;
}

static bool read_edges(scan_graph *g, const manifest *m, GError **error)
{
	struct reading r = { m, "edges", 0, error };
	JsonArray *list = list_of(&r);
	for (; list && r.index < json_array_get_length(list); r.index++) {
		struct edge e = { 0 };
		JsonObject *o = entry_of(&r, list);
		if (!o || !read_edge(&r, o, &e))
			return false;
		if (scan_graph_edge(g, e.a, e.b)) {
			edge_clear(&e);
			return refuse(&r, "is there twice");
		}
		scan_graph_set_edge(g, &e);
	}
	return list != NULL;
}

static bool read_scans(scan_graph *g, const manifest *m, GError **error)
{
	struct reading r = { m, "scans", 0, error };
	JsonArray *list = list_of(&r);
	uint32_t before = 0;
	for (; list && r.index < json_array_get_length(list); r.index++) {
		struct placed_scan p = { 0 };
		JsonObject *o = entry_of(&r, list);
		if (!o || !read_placed(&r, o, &p))
			return false;
		if (p.number <= before)
			return refuse(&r, "'number' is not above the one before");
		before = p.number;
		g_array_append_val(g->scans, p);
	}
	return list != NULL;
}

static scan_graph *read_graph(const manifest *m, GError **error)
{
	g_autoptr(scan_graph) g = scan_graph_new();
	int64_t revision, parent;
	if (!manifest_get_int(m, "revision", 0, SITE_SCANS_MAX, &revision, error) ||
		!manifest_get_int(m, "parent", 0, SITE_SCANS_MAX, &parent, error))
		return NULL;
	const char *change = manifest_get_string(m, "change", error);
	const char *time = change ? manifest_get_string(m, "time", error) : NULL;
	if (!time)
		return NULL;
	g->revision = (uint32_t)revision;
	g->parent = (uint32_t)parent;
	g->change = g_strdup(change);
	g->time = g_strdup(time);
	if (manifest_has(m, "inputs"))
		g->inputs = g_strdup(manifest_get_string(m, "inputs", NULL));
	if (!read_edges(g, m, error) || !read_scans(g, m, error))
		return NULL;
	return g_steal_pointer(&g);
}

scan_graph *scan_graph_load_file(const char *path, GError **error)
{
	g_autoptr(manifest) m = manifest_load(path, SCHEMA, error);
	return m ? read_graph(m, error) : NULL;
}

scan_graph *scan_graph_parse(const char *text, size_t length, const char *path, GError **error)
{
	g_autoptr(manifest) m = manifest_parse(text, length, path, SCHEMA, error);
	return m ? read_graph(m, error) : NULL;
}
