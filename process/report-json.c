#include "process/pose-json.h"
#include "process/report-private.h"
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

static void set_verification(JsonObject *o, const struct verification *v)
{
	json_object_set_string_member(o, "verdict", verdict_names[v->verdict]);
	json_object_set_string_member(o, "reason", v->reason);
	set_number(o, "overlap", v->overlap);
	set_number(o, "agreement", v->agreement);
	set_number(o, "agree_sr", v->agree_sr);
	set_number(o, "occluded_sr", v->occluded_sr);
	set_number(o, "conflict_sr", v->conflict_sr);
	set_number(o, "outside_sr", v->outside_sr);
	set_number(o, "rms_mm", 1000 * v->rms_m);
	set_number(o, "under_6mm", v->under_6mm);
	set_number(o, "balance", v->balance);
	set_number(o, "deviation_mm", 1000 * v->deviation_m);
	set_number(o, "deviation_deg", v->deviation_rad * 180 / G_PI);
	set_number(o, "rival_score", v->rival_score);
}

static JsonObject *edge_object(const struct report_edge *facts)
{
	static const char *const origins[] = {
		[EDGE_AUTOMATIC] = "automatic", [EDGE_PICKED] = "picked", [EDGE_GIVEN] = "given"
	};
	const struct edge *e = facts->edge;
	JsonObject *o = json_object_new();
	json_object_set_int_member(o, "a", e->a);
	json_object_set_int_member(o, "b", e->b);
	json_object_set_string_member(o, "origin", origins[e->origin]);
	json_object_set_string_member(o, "standing", report_standing(e));
	json_object_set_boolean_member(o, "used", edge_is_used(e));
	set_verification(o, &e->verification);
	set_number(o, "loop_mm", 1000 * e->loop_m);
	set_number(o, "loop_deg", e->loop_rad * 180 / G_PI);
	json_object_set_member(o, "pose", json_write_pose(&e->pose));
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
			edges, edge_object(&g_array_index(r->edges, struct report_edge, i)));
	json_object_set_array_member(o, "scans", scans);
	json_object_set_array_member(o, "edges", edges);
	return o;
}
