#include "process/edge-json.h"
#include "process/pose-json.h"
#include "process/report-private.h"
#include <json-glib/json-glib.h>
#include <math.h>

/* A number that is not finite is null in JSON. */
static void set_number(JsonObject *o, const char *key, double value)
{
	if (isfinite(value))
		json_object_set_double_member(o, key, value);
	else
		json_object_set_null_member(o, key);
}

static JsonObject *scan_object(const struct report_scan *s)
{
	const struct placed_scan *p = s->placed;
	JsonObject *o = json_object_new();
	json_object_set_int_member(o, "number", p->number);
	json_object_set_string_member(o, "what", s->what ? s->what : "");
	if (s->when)
		json_object_set_string_member(o, "when", s->when);
	json_object_set_int_member(o, "points", (gint64)s->points);
	json_object_set_int_member(o, "columns", s->columns);
	json_object_set_int_member(o, "rows", s->rows);
	json_object_set_boolean_member(o, "placed", p->group > 0);
	if (!p->group)
		return o;
	json_object_set_int_member(o, "group", p->group);
	json_object_set_member(o, "pose", json_write_pose(&p->pose));
	set_number(o, "yaw_deg", s->yaw_deg);
	set_number(o, "tilt_deg", s->tilt_deg);
	set_number(o, "deviation_mm", 1000 * p->deviation_m);
	set_number(o, "deviation_deg", p->deviation_rad * 180 / G_PI);
	return o;
}

JsonObject *report_json(const report *r)
{
	JsonObject *o = json_object_new();
	JsonArray *scans = json_array_new(), *edges = json_array_new();
	json_object_set_string_member(
		o, "site", manifest_get_string(site_manifest(r->site), "name", NULL));
	json_object_set_int_member(o, "revision", r->graph->revision);
	if (r->graph->change)
		json_object_set_string_member(o, "change", r->graph->change);
	json_object_set_int_member(o, "groups", r->plans->len);
	for (guint i = 0; i < r->scans->len; i++)
		json_array_add_object_element(
			scans, scan_object(&g_array_index(r->scans, struct report_scan, i)));
	for (guint i = 0; i < r->edges->len; i++)
		json_array_add_object_element(
			edges, edge_json(g_array_index(r->edges, struct report_edge, i).edge));
	json_object_set_array_member(o, "scans", scans);
	json_object_set_array_member(o, "edges", edges);
	return o;
}
