#include "process/edge-json.h"
#include "process/pose-json.h"
#include <json-glib/json-glib.h>
#include <math.h>

const char *edge_standing(const struct edge *e)
{
	if (e->decision == DECISION_REFUSED)
		return "refused by hand";
	if (e->outlier)
		return "contradicts its loops";
	if (e->decision == DECISION_ACCEPTED)
		return "accepted by hand";
	return e->verification.verdict == VERDICT_ACCEPTED ? "accepted" : "refused";
}

static void set_number(JsonObject *o, const char *key, double value)
{
	if (isfinite(value))
		json_object_set_double_member(o, key, value);
	else
		json_object_set_null_member(o, key);
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

JsonObject *edge_json(const struct edge *e)
{
	static const char *const origins[] = {
		[EDGE_AUTOMATIC] = "automatic", [EDGE_PICKED] = "picked", [EDGE_GIVEN] = "given"
	};
	JsonObject *o = json_object_new();
	json_object_set_int_member(o, "a", e->a);
	json_object_set_int_member(o, "b", e->b);
	json_object_set_string_member(o, "origin", origins[e->origin]);
	json_object_set_string_member(o, "standing", edge_standing(e));
	json_object_set_boolean_member(o, "used", edge_is_used(e));
	set_verification(o, &e->verification);
	set_number(o, "loop_mm", 1000 * e->loop_m);
	set_number(o, "loop_deg", e->loop_rad * 180 / G_PI);
	json_object_set_member(o, "pose", json_write_pose(&e->pose));
	return o;
}
