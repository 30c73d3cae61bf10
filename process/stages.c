#include "process/stages.h"
#include "process/build-model.h"
#include "process/model-look.h"
#include "process/plane-site.h"
#include "process/register-site.h"
#include "process/scan-features.h"
#include "process/scan-geometry.h"
#include "process/segment-site.h"
#include "process/site-lines.h"
#include <json-glib/json-glib.h>
#include <string.h>

static bool set_stopped(GError **error)
{
	g_set_error(error, G_IO_ERROR, G_IO_ERROR_CANCELLED, "stopped");
	return false;
}

/* ---- registration ---- */

static char *placed_summary(const scan_graph *g, JsonObject *figures)
{
	uint32_t placed = 0, groups = 0, used = 0, refused = 0;
	for (guint i = 0; i < g->scans->len; i++) {
		const struct placed_scan *p = &g_array_index(g->scans, struct placed_scan, i);
		placed += p->group > 0;
		groups = MAX(groups, p->group);
	}
	for (guint i = 0; i < g->edges->len; i++) {
		bool is_used = edge_is_used(&g_array_index(g->edges, struct edge, i));
		used += is_used;
		refused += !is_used;
	}
	json_object_set_int_member(figures, "scans", g->scans->len);
	json_object_set_int_member(figures, "placed", placed);
	json_object_set_int_member(figures, "groups", groups);
	json_object_set_int_member(figures, "pairs_accepted", used);
	json_object_set_int_member(figures, "pairs_refused", refused);
	g_autofree char *parts =
		groups > 1 ? g_strdup_printf(" in %u parts that nothing ties together", groups)
			   : g_strdup("");
	return g_strdup_printf("%u of %u scans are placed%s, by %u pair%s; %u %s refused", placed,
		g->scans->len, parts, used, used == 1 ? "" : "s", refused,
		refused == 1 ? "was" : "were");
}

static bool run_register(site *s, const struct stage_progress *progress, char **ret_summary,
	JsonObject *figures, GError **error)
{
	struct register_options options = { .progress = progress->update,
		.user_data = progress->user_data };
	bool stopped = false;
	g_autoptr(scan_graph) g = register_site(s, &options, &stopped, error);
	if (!g)
		return false;
	if (stopped)
		return set_stopped(error);
	*ret_summary = placed_summary(g, figures);
	return true;
}

/* ---- the first look ---- */

static bool look_is_due(const site *s, bool *ret_due, char **ret_why, GError **error)
{
	g_autoptr(scan_graph) g = scan_graph_load(s, error);
	return g && model_look_is_due(s, g, ret_due, ret_why, error);
}

static bool run_look(site *s, const struct stage_progress *progress, char **ret_summary,
	JsonObject *figures, GError **error)
{
	struct build_options options = { .progress = progress->update,
		.user_data = progress->user_data };
	struct look_result result = { 0 };
	g_autoptr(scan_graph) g = scan_graph_load(s, error);
	if (!g || !model_look_make(s, g, &options, &result, error))
		return false;
	json_object_set_int_member(figures, "points", (gint64)result.points);
	json_object_set_int_member(figures, "points_new", (gint64)result.points_new);
	json_object_set_int_member(figures, "scans", result.scans);
	json_object_set_int_member(figures, "scans_new", result.scans_new);
	*ret_summary = g_strdup_printf("%.2f million points of %u scans, %.2f million of them new",
		(double)result.points / 1e6, result.scans, (double)result.points_new / 1e6);
	return true;
}

/* ---- geometry ---- */

static bool geometry_is_due(const site *s, bool *ret_due, char **ret_why, GError **error)
{
	g_autoptr(scan_graph) g = scan_graph_load(s, error);
	return g && geometry_site_is_due(s, g, ret_due, ret_why, error);
}

static bool run_geometry(site *s, const struct stage_progress *progress, char **ret_summary,
	JsonObject *figures, GError **error)
{
	struct geometry_site_options options = { .progress = progress->update,
		.user_data = progress->user_data };
	uint32_t made = 0;
	g_autoptr(scan_graph) g = scan_graph_load(s, error);
	if (!g || !geometry_site(s, g, &options, &made, error))
		return false;
	json_object_set_int_member(figures, "scans_made", made);
	*ret_summary = g_strdup_printf("normals of %u scan%s", made, made == 1 ? "" : "s");
	return true;
}

/* ---- segments ---- */

static bool segments_are_due(const site *s, bool *ret_due, char **ret_why, GError **error)
{
	g_autoptr(scan_graph) g = scan_graph_load(s, error);
	return g && segment_site_is_due(s, g, ret_due, ret_why, error);
}

static bool run_segments(site *s, const struct stage_progress *progress, char **ret_summary,
	JsonObject *figures, GError **error)
{
	struct segment_site_options options = { .progress = progress->update,
		.user_data = progress->user_data };
	struct segment_site_result result = { 0 };
	g_autoptr(scan_graph) g = scan_graph_load(s, error);
	if (!g || !segment_site(s, g, &options, &result, error))
		return false;
	g_autoptr(GString) shares = g_string_new(NULL);
	json_object_set_int_member(figures, "segments", result.things);
	for (int c = 0; c < SEGMENT_CLASSES; c++) {
		double share = (double)result.class_points[c] / (double)MAX(result.points, 1);
		json_object_set_int_member(
			figures, segment_classes[c].name, (gint64)result.class_points[c]);
		if (result.class_points[c])
			g_string_append_printf(shares, ", %.*f %% %s", share < 0.1, 100 * share,
				segment_classes[c].name);
	}
	*ret_summary = g_strdup_printf("%u segments%s", result.things, shares->str);
	return true;
}

/* ---- features ---- */

static bool features_are_due(const site *s, bool *ret_due, char **ret_why, GError **error)
{
	g_autoptr(scan_graph) g = scan_graph_load(s, error);
	return g && features_site_is_due(s, g, NULL, ret_due, ret_why, error);
}

static bool run_features(site *s, const struct stage_progress *progress, char **ret_summary,
	JsonObject *figures, GError **error)
{
	struct features_site_options options = { .progress = progress->update,
		.user_data = progress->user_data };
	uint32_t made = 0;
	g_autoptr(scan_graph) g = scan_graph_load(s, error);
	if (!g || !features_site(s, g, &options, &made, error))
		return false;
	json_object_set_int_member(figures, "scans_made", made);
	*ret_summary = g_strdup_printf("features of %u scan%s", made, made == 1 ? "" : "s");
	return true;
}

/* ---- model ---- */

static bool model_is_due(const site *s, bool *ret_due, char **ret_why, GError **error)
{
	g_autoptr(scan_graph) g = scan_graph_load(s, error);
	return g && build_model_is_due(s, g, ret_due, ret_why, error);
}

static bool run_model(site *s, const struct stage_progress *progress, char **ret_summary,
	JsonObject *figures, GError **error)
{
	struct build_options options = { .progress = progress->update,
		.user_data = progress->user_data };
	struct build_result result = { 0 };
	g_autoptr(scan_graph) g = scan_graph_load(s, error);
	if (!g || !build_model(s, g, &options, &result, error))
		return false;
	json_object_set_int_member(figures, "points", (gint64)result.points);
	json_object_set_int_member(figures, "redundant", (gint64)result.redundant);
	json_object_set_int_member(figures, "points_taken_over", (gint64)result.points_taken_over);
	json_object_set_int_member(figures, "scans", result.scans);
	json_object_set_int_member(figures, "scans_rebuilt", result.scans_rebuilt);
	*ret_summary = g_strdup_printf("%.2f million points; %.2f million were seen better from "
				       "elsewhere",
		(double)result.points / 1e6, (double)result.redundant / 1e6);
	return true;
}

/* ---- lines ---- */

static bool run_lines(site *s, const struct stage_progress *progress, char **ret_summary,
	JsonObject *figures, GError **error)
{
	struct site_lines_options options = { .progress = progress->update,
		.user_data = progress->user_data };
	double all_m = 0;
	g_autoptr(profile_lines) p = site_lines_make(s, &options, error);
	if (!p)
		return false;
	for (guint n = 0; n < p->line->len; n++)
		all_m += (double)g_array_index(p->line, struct profile_line, n).length_m;
	json_object_set_int_member(figures, "lines", p->line->len);
	json_object_set_double_member(figures, "length_m", all_m);
	*ret_summary = g_strdup_printf("%u lines, %.0f m of edges", p->line->len, all_m);
	return true;
}

/* ---- planes ---- */

static bool say_planes(double fraction, gpointer user_data)
{
	const struct stage_progress *progress = user_data;
	return !progress->update ||
	       progress->update(fraction, "finding planes", progress->user_data);
}

static bool run_planes(site *s, const struct stage_progress *progress, char **ret_summary,
	JsonObject *figures, GError **error)
{
	struct plane_options options = { .progress = say_planes, .user_data = (gpointer)progress };
	struct plane_site_result result;
	if (!plane_site(s, &options, &result, error))
		return false;
	json_object_set_int_member(figures, "planes", result.planes);
	json_object_set_double_member(figures, "area_m2", result.area_m2);
	json_object_set_int_member(figures, "points_explained", (gint64)result.explained);
	*ret_summary = g_strdup_printf("%u planes of %.0f m2; %.0f %% of the points lie on them",
		result.planes, result.area_m2,
		100 * (double)result.explained / (double)MAX(result.points, 1));
	return true;
}

const struct stage stages[] = {
	{ "register", "registration", false, register_site_is_due, run_register },
	{ "look", "a first look", true, look_is_due, run_look },
	{ "geometry", "geometry", false, geometry_is_due, run_geometry },
	{ "segments", "segments", false, segments_are_due, run_segments },
	{ "features", "features", false, features_are_due, run_features },
	{ "model", "model", false, model_is_due, run_model },
	{ "lines", "profile lines", false, site_lines_is_due, run_lines },
	{ "planes", "planes", false, plane_site_is_due, run_planes },
	{ NULL },
};

const struct stage *stage_find(const char *name)
{
	for (const struct stage *stage = stages; stage->name; stage++)
		if (strcmp(stage->name, name) == 0)
			return stage;
	return NULL;
}
