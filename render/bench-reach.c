#include "render/bench-reach.h"
#include "render/bench-figure.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

#define PAPER  "Xu & Chen 2004, table 1, on a GPU"
#define DESIGN "pleinair's design"

#define SPRITES "4 million points drawn to 1600 x 1200, sprite style"
#define SPRITE_ROW(scene, number, fps)                                                             \
	{                                                                                          \
		.work = SPRITES, .what = "scene " scene ", camera " #number " of 3",               \
		.unit = "frames/s", .source = PAPER, .wanted = fps, .at_least = true,              \
		.bench = "render",                                                                 \
		.path = "scenes/scene=" scene                                                      \
			"/frames/style=figure-7a;backend=cpu;#" SPRITE_INDEX_##number "/fps",      \
		.peer = { {                                                                        \
			"VTK, unstyled",                                                           \
			"scenes/scene=" scene "/vtk/fps/#" SPRITE_INDEX_##number,                  \
		} },                                                                               \
	}
#define SPRITE_INDEX_1 "0"
#define SPRITE_INDEX_2 "1"
#define SPRITE_INDEX_3 "2"

#define FILTERS "Filters of a picture of 1920 x 1080"
#define FILTER_ROW(name, title, ms)                                                                \
	{                                                                                          \
		.work = FILTERS, .what = name, .unit = "ms", .source = DESIGN, .wanted = ms,       \
		.bench = "filters", .path = "filters/filter=" title "/ms",                         \
	}

#define NORMALS "Normals of a scan of 3000 x 792 cells, one thread"
#define NORMALS_ROW(name, of, most, member)                                                        \
	{                                                                                          \
		.work = NORMALS, .what = name, .unit = of, .source = DESIGN, .wanted = most,       \
		.bench = "process", .path = "normals/method=pleinair/" member,                     \
		.peer = {                                                                          \
			{ "PCL AVERAGE_3D_GRADIENT",                                               \
				"normals/method=PCL AVERAGE_3D_GRADIENT/" member, NULL },          \
			{ "PCL, 20 neighbours", "normals/method=PCL k = 20/" member, NULL },       \
			{ "Open3D, 20 neighbours", "normals/method=Open3D k = 20/" member, NULL }, \
			{ "CloudCompare, octree", "normals/method=CloudCompare octree/" member,    \
				NULL },                                                            \
		},                                                                                 \
	}

#define FINE "Fine alignment of two such scans, one thread, with all preparation"
#define FINE_ROW(name, of, most, list, member)                                                     \
	{                                                                                          \
		.work = FINE, .what = name, .unit = of, .source = DESIGN, .wanted = most,          \
		.bench = "process", .path = list "/method=pleinair/" member,                       \
		.peer = {                                                                          \
			{ "PCL GICP", list "/method=pcl_gicp/" member, NULL },                     \
			{ "Open3D GICP", list "/method=open3d_gicp/" member, NULL },               \
			{ "Open3D point to plane", list "/method=open3d_point_to_plane/" member,   \
				NULL },                                                            \
			{ "CloudCompare ICP", list "/method=cloudcompare_icp/" member, NULL },     \
		},                                                                                 \
	}

#define COARSE "Coarse alignment of two scans with no idea where they stand"

#define ACQUIRE "Acquisition: 40 revolutions a second of 1081 beams, in real time"

const struct bench_reach bench_reaches[] = {
	SPRITE_ROW("A", 1, 33),
	SPRITE_ROW("A", 2, 30),
	SPRITE_ROW("A", 3, 28),
	SPRITE_ROW("B", 1, 20),
	SPRITE_ROW("B", 2, 18),
	SPRITE_ROW("B", 3, 15),
	{ .work = "Visibility mask",
		.what = "points of the overview",
		.unit = "million points/s",
		.source = DESIGN,
		.wanted = 250,
		.at_least = true,
		.bench = "render",
		.path = "scenes/scene=B/mask_points_s_of_overview",
		.scale = 1e-6,
		.peer = { { "VTK, points drawn", "scenes/scene=B/vtk/points_s", NULL } } },
	{ .work = "Textured strokes of 24 x 6 px",
		.what = "submitted",
		.unit = "million/s",
		.source = DESIGN,
		.wanted = 6,
		.at_least = true,
		.bench = "render",
		.path = "strokes/submitted_s",
		.scale = 1e-6 },
	FILTER_ROW("Kuwahara, 5 x 5", "Kuwahara, 5 x 5", 10),
	FILTER_ROW("Gaussian, sigma 5", "Gaussian, sigma 5", 15),
	FILTER_ROW("anisotropic Kuwahara", "anisotropic Kuwahara, 5", 150),
	NORMALS_ROW("processor time", "s", 0.10, "cpu_s"),
	NORMALS_ROW("error on smooth surfaces, median", "degrees", 0.7, "smooth_median_deg"),
	NORMALS_ROW("cells without a normal", "%", 1, "none_percent"),
	FINE_ROW("processor time", "s", 0.20, "fine", "prepare_cpu_s+align_cpu_s"),
	FINE_ROW("error on true ranges", "degrees", 0.001, "fine_exact", "error_deg"),
	FINE_ROW("error on true ranges", "mm", 0.1, "fine_exact", "error_mm"),
	{ .work = COARSE,
		.what = "processor time of a pair, ours with fine alignment and its check",
		.unit = "s",
		.source = DESIGN,
		.wanted = 1,
		.bench = "register",
		.path = "rows/scene=all;kind=all/coarse_s+fine_s+verify_s",
		.count = "trials",
		.count_of = "pairs",
		.peer = { { "Open3D, FPFH and RANSAC", "others/method=open3d_fpfh_ransac/cpu_s",
				  "others/method=open3d_fpfh_ransac/pairs" },
			{ "PCL, FPFH and prerejective", "others/method=pcl_fpfh_prerejective/cpu_s",
				"others/method=pcl_fpfh_prerejective/pairs" } } },
	{ .work = COARSE,
		.what = "found, of those that overlap",
		.unit = "%",
		.source = DESIGN,
		.wanted = 99,
		.at_least = true,
		.bench = "register",
		.path = "overlap_found_percent",
		.count = "overlap",
		.count_of = "pairs",
		.peer = { { "Open3D, FPFH and RANSAC",
				  "others/method=open3d_fpfh_ransac/right_percent",
				  "others/method=open3d_fpfh_ransac/pairs" },
			{ "PCL, FPFH and prerejective",
				"others/method=pcl_fpfh_prerejective/right_percent",
				"others/method=pcl_fpfh_prerejective/pairs" } } },
	{ .work = COARSE,
		.what = "accepted although wrong",
		.unit = "pairs",
		.source = DESIGN ", of 1,000",
		.wanted = 0,
		.bench = "register",
		.path = "rows/scene=all;kind=all/accepted_though_wrong",
		.count = "trials",
		.count_of = "pairs" },
	{ .work = "From the last beam to a registered, styled picture",
		.what = "the fourth fine scan of a courtyard",
		.unit = "s",
		.source = DESIGN,
		.wanted = 5,
		.bench = "station",
		.path = "first_s" },
	{ .work = ACQUIRE,
		.what = "revolutions lost",
		.unit = "revolutions",
		.source = DESIGN,
		.wanted = 0,
		.bench = "acquire",
		.path = "revolutions_lost",
		.count = "revolutions",
		.count_of = "revolutions" },
	{ .work = ACQUIRE,
		.what = "of one core",
		.unit = "%",
		.source = DESIGN,
		.wanted = 10,
		.bench = "acquire",
		.path = "core_percent" },
	{ .work = ACQUIRE,
		.what = "memory at most",
		.unit = "MB",
		.source = DESIGN,
		.wanted = 64,
		.bench = "acquire",
		.path = "peak_mib",
		.scale = 1.048576 },
	{ NULL },
};

/* ---- what was measured ---- */

static void put_count(JsonObject *to, JsonObject *result, const char *path, const char *of)
{
	struct bench_figure f = { 0 };
	if (path)
		f = bench_figure_find(result, path);
	g_autofree char *text = f.there ? g_strdup_printf("%.0f %s", f.value, of) : NULL;
	if (text)
		json_object_set_string_member(to, "of", text);
}

/* True: it was measured. */
static bool put_figure(JsonObject *to, JsonObject *result, const char *path, double scale)
{
	struct bench_figure f = bench_figure_find(result, path);
	if (f.there)
		json_object_set_double_member(to, "measured", f.value * (scale != 0 ? scale : 1));
	else
		json_object_set_string_member(
			to, "why_not", f.why_not ? f.why_not : "it was not measured");
	return f.there;
}

static JsonArray *peers_of(const struct bench_reach *r, JsonObject *result)
{
	JsonArray *peers = json_array_new();
	for (int n = 0; n < BENCH_REACH_PEERS && r->peer[n].name; n++) {
		JsonObject *o = json_object_new();
		json_object_set_string_member(o, "name", r->peer[n].name);
		if (put_figure(o, result, r->peer[n].path, r->scale))
			put_count(o, result, r->peer[n].count, "pairs");
		json_array_add_object_element(peers, o);
	}
	return peers;
}

static JsonObject *row_of(const struct bench_reach *r, JsonObject *result)
{
	JsonObject *o = json_object_new();
	json_object_set_string_member(o, "work", r->work);
	json_object_set_string_member(o, "what", r->what);
	json_object_set_string_member(o, "unit", r->unit);
	json_object_set_double_member(o, "wanted", r->wanted);
	json_object_set_boolean_member(o, "at_least", r->at_least);
	json_object_set_string_member(o, "source", r->source);
	json_object_set_string_member(o, "bench", r->bench);
	if (put_figure(o, result, r->path, r->scale)) {
		double measured = json_object_get_double_member(o, "measured");
		json_object_set_boolean_member(
			o, "reached", r->at_least ? measured >= r->wanted : measured <= r->wanted);
		put_count(o, result, r->count, r->count_of);
	}
	json_object_set_array_member(o, "peers", peers_of(r, result));
	return o;
}

JsonArray *bench_reach_of(JsonObject *results)
{
	JsonArray *all = json_array_new();
	for (const struct bench_reach *r = bench_reaches; r->work; r++) {
		JsonNode *node = json_object_get_member(results, r->bench);
		json_array_add_object_element(all,
			row_of(r, node && JSON_NODE_HOLDS_OBJECT(node) ? json_node_get_object(node)
								       : NULL));
	}
	return all;
}

/* ---- in words ---- */

static const char *member_or_null(JsonObject *o, const char *name)
{
	return json_object_get_string_member_with_default(o, name, NULL);
}

static char *number_or_dash(JsonObject *o)
{
	return json_object_has_member(o, "measured")
		       ? bench_reach_number(json_object_get_double_member(o, "measured"))
		       : g_strdup("-");
}

char *bench_reach_number(double value)
{
	double size = fabs(value);
	if (size == 0)
		return g_strdup("0");
	int digits = size >= 100 ? 0 : size >= 10 ? 1 : size >= 1 ? 2 : 2 - (int)floor(log10(size));
	char *text = g_strdup_printf("%.*f", MIN(digits, 7), value);
	/* 0.10 is 0.1. */
	if (strchr(text, '.'))
		for (char *end = text + strlen(text) - 1; *end == '0' || *end == '.'; end--) {
			bool dot = *end == '.';
			*end = '\0';
			if (dot)
				break;
		}
	return text;
}

char *bench_reach_wish(JsonObject *row)
{
	g_autofree char *wanted = bench_reach_number(json_object_get_double_member(row, "wanted"));
	return g_strdup_printf("%s %s %s",
		json_object_get_boolean_member(row, "at_least") ? "at least" : "at most", wanted,
		json_object_get_string_member(row, "unit"));
}

char *bench_reach_sum(JsonArray *reach)
{
	guint all = json_array_get_length(reach), reached = 0, measured = 0;
	for (guint n = 0; n < all; n++) {
		JsonObject *row = json_array_get_object_element(reach, n);
		measured += json_object_has_member(row, "measured");
		reached += json_object_get_boolean_member_with_default(row, "reached", FALSE);
	}
	GString *text = g_string_new(NULL);
	g_string_printf(
		text, "%u of %u figures are reached, %u are not", reached, all, measured - reached);
	if (measured < all)
		g_string_append_printf(text, ", %u were not measured", all - measured);
	return g_string_free(text, FALSE);
}

static void print_peers(JsonObject *row)
{
	JsonArray *peers = json_object_get_array_member(row, "peers");
	for (guint n = 0; n < json_array_get_length(peers); n++) {
		JsonObject *peer = json_array_get_object_element(peers, n);
		const char *name = json_object_get_string_member(peer, "name"),
			   *why_not = member_or_null(peer, "why_not"),
			   *of = member_or_null(peer, "of");
		g_autofree char *value = number_or_dash(peer);
		printf("     %10s  %s%s%s%s%s%s\n", value, name, why_not ? ": " : "",
			why_not ? why_not : "", of ? " (" : "", of ? of : "", of ? ")" : "");
	}
}

static void print_row(JsonObject *row)
{
	const char *why_not = member_or_null(row, "why_not"), *of = member_or_null(row, "of");
	bool reached = json_object_get_boolean_member_with_default(row, "reached", FALSE);
	g_autofree char *wish = bench_reach_wish(row), *value = number_or_dash(row);
	printf("%4s %10s  %s: wanted %s%s%s%s%s%s\n",
		why_not   ? "-"
		: reached ? "yes"
			  : "NO",
		value, json_object_get_string_member(row, "what"), wish, of ? " (of " : "",
		of ? of : "", of ? ")" : "", why_not ? "; " : "", why_not ? why_not : "");
	print_peers(row);
}

void bench_reach_print(JsonArray *reach)
{
	const char *work = "";
	g_autofree char *sum = bench_reach_sum(reach);
	puts("what is to reach");
	for (guint n = 0; n < json_array_get_length(reach); n++) {
		JsonObject *row = json_array_get_object_element(reach, n);
		if (strcmp(work, json_object_get_string_member(row, "work")) != 0)
			puts(work = json_object_get_string_member(row, "work"));
		print_row(row);
	}
	puts(sum);
}
