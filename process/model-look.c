#include "process/model-look.h"
#include "firmware-io/files.h"
#include "process/build-progress.h"
#include "process/look-scan.h"
#include "process/model-write.h"
#include "process/morton.h"
#include "process/pose-json.h"
#include <errno.h>
#include <glib/gstdio.h>
#include <json-glib/json-glib.h>
#include <math.h>
#include <string.h>

/* Rises when the same inputs give another look. */
#define LOOK_METHOD 1
/* More scans are not seen in a second. */
#define SCANS_MOST 3
/* So many points of the model, about, are enough for a screen. */
#define POINTS_ENOUGH 1500000.0
/* Scans of the model that stand elsewhere by more than this do not fit the new ones any more. */
#define MOVED_M       0.05
#define MOVED_RAD     0.002
#define CHUNKS_A_TIME 64u

static char *path_of(const char *site_path)
{
	return g_build_filename(site_path, "model", "look.model", NULL);
}

/* ---- what is new ---- */

struct look {
	model_inputs *inputs;
	model *base;    /* NULL: there is none yet */
	GArray *fresh;  /* of guint: the inputs that are not in it */
	char *of, *key; /* of: checksum of the base, "" without one */
};

static void look_clear(struct look *l)
{
	g_clear_pointer(&l->inputs, model_inputs_free);
	g_clear_pointer(&l->base, model_free);
	g_clear_pointer(&l->fresh, g_array_unref);
	g_free(l->of);
	g_free(l->key);
}
typedef struct look look;
G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC(look, look_clear)

static char *checksum_of(const product *file)
{
	return file ? g_strdup_printf("%08x", product_checksum(file)) : g_strdup("");
}

/* NULL: none. */
static JsonArray *scans_of(const model *m)
{
	JsonNode *node =
		m ? json_object_get_member(product_manifest(model_file(m)), "made_from") : NULL;
	return node && JSON_NODE_HOLDS_ARRAY(node) ? json_node_get_array(node) : NULL;
}

/* Of a scan in the manifest of a model. */
struct stood {
	int64_t number;
	const char *fingerprint;
	struct pose pose;
};

static bool read_stood(JsonNode *node, struct stood *ret)
{
	double n[12];
	JsonObject *o = JSON_NODE_HOLDS_OBJECT(node) ? json_node_get_object(node) : NULL;
	if (!o || !json_read_numbers(json_object_get_member(o, "pose"), 12, n))
		return false;
	ret->number = json_object_get_int_member_with_default(o, "scan", -1);
	ret->fingerprint = json_object_get_string_member_with_default(o, "points", "");
	memcpy(ret->pose.rotation, n, sizeof ret->pose.rotation);
	memcpy(ret->pose.translation_m, n + 9, sizeof ret->pose.translation_m);
	return true;
}

static bool is_same(const struct stood *was, const struct model_input *now)
{
	struct pose between = pose_between(&was->pose, &now->pose);
	return strcmp(was->fingerprint, now->fingerprint) == 0 &&
	       pose_distance_m(&between) <= MOVED_M && pose_angle_rad(&between) <= MOVED_RAD;
}

/* false: a scan of the model is not what it was. */
static bool find_fresh(struct look *l)
{
	JsonArray *scans = scans_of(l->base);
	guint count = scans ? json_array_get_length(scans) : 0, found = 0;
	for (guint i = 0; i < l->inputs->scans->len; i++) {
		const struct model_input *input = model_inputs_at(l->inputs, i);
		bool is_in = false;
		for (guint k = 0; k < count && !is_in; k++) {
			struct stood was;
			if (!read_stood(json_array_get_element(scans, k), &was))
				return false;
			is_in = was.number == input->number;
			if (is_in && !is_same(&was, input))
				return false;
		}
		found += is_in;
		if (!is_in)
			g_array_append_val(l->fresh, i);
	}
	return found == count;
}

static bool can_be_seen_soon(const struct look *l)
{
	bool can = l->fresh->len >= 1 && l->fresh->len <= SCANS_MOST;
	for (guint i = 0; i < l->fresh->len; i++)
		can &= model_inputs_at(l->inputs, g_array_index(l->fresh, guint, i))->kind !=
		       SCAN_CLOUD;
	return can;
}

static char *key_of(const struct look *l)
{
	g_autoptr(GString) text = g_string_new(NULL);
	g_string_printf(text, "look %d %d %s", LOOK_METHOD, MODEL_METHOD, l->of);
	for (guint i = 0; i < l->fresh->len; i++) {
		const struct model_input *input =
			model_inputs_at(l->inputs, g_array_index(l->fresh, guint, i));
		g_autoptr(JsonNode) pose = json_write_pose(&input->pose);
		g_autofree char *stands = json_to_string(pose, FALSE);
		g_string_append_printf(
			text, "\n%u %s %s", input->number, input->fingerprint, stands);
	}
	return g_compute_checksum_for_string(G_CHECKSUM_SHA256, text->str, -1);
}

/* *ret_can: whether there is something new that can be looked at. */
static bool look_find(
	const site *s, const scan_graph *g, struct look *ret, bool *ret_can, GError **error)
{
	ret->inputs = model_inputs_new(s, g, error);
	if (!ret->inputs)
		return false;
	ret->fresh = g_array_new(FALSE, FALSE, sizeof(guint));
	ret->base = model_open(site_path(s), NULL);
	ret->of = checksum_of(ret->base ? model_file(ret->base) : NULL);
	*ret_can = find_fresh(ret) && can_be_seen_soon(ret);
	ret->key = *ret_can ? key_of(ret) : NULL;
	return true;
}

/* ---- the file ---- */

/* The one with this key; NULL: there is none. */
static model *open_look(const site *s, const char *key)
{
	g_autofree char *path = path_of(site_path(s));
	g_autoptr(model) m = model_open_file(path, NULL);
	JsonObject *made = m ? product_manifest(model_file(m)) : NULL;
	if (!m || strcmp(json_object_get_string_member_with_default(made, "key", ""), key) != 0)
		return NULL;
	return g_steal_pointer(&m);
}

model *model_look_open(const site *s, bool *ret_is_look, GError **error)
{
	g_autofree char *path = path_of(site_path(s));
	g_auto(look) l = { 0 };
	bool can = false;
	*ret_is_look = false;
	if (g_file_test(path, G_FILE_TEST_EXISTS)) {
		g_autoptr(scan_graph) g = scan_graph_load(s, NULL);
		g_autoptr(model) m =
			g && look_find(s, g, &l, &can, NULL) && can ? open_look(s, l.key) : NULL;
		*ret_is_look = m != NULL;
		if (m)
			return g_steal_pointer(&m);
	}
	return model_open(site_path(s), error);
}

bool model_look_remove(const char *site_path, GError **error)
{
	g_autofree char *path = path_of(site_path);
	return g_unlink(path) == 0 || errno == ENOENT || files_fail(error, path, "remove");
}

bool model_look_is_due(
	const site *s, const scan_graph *g, bool *ret_due, char **ret_why, GError **error)
{
	g_auto(look) l = { 0 };
	bool can;
	*ret_due = false;
	*ret_why = NULL;
	if (!look_find(s, g, &l, &can, error))
		return false;
	g_autoptr(model) there = can ? open_look(s, l.key) : NULL;
	*ret_due = can && !there;
	if (*ret_due)
		*ret_why = g_strdup_printf("scan %u is new",
			model_inputs_at(l.inputs, g_array_index(l.fresh, guint, 0))->number);
	return true;
}

/* ---- points of the model ---- */

struct maker {
	const struct look *look;
	const struct build_progress *progress;
	GPtrArray *scans; /* of look_scan */
	model_writer *to;
	double share; /* of the points that tell no feature, how many are taken */
};

static bool is_feature(const struct model_point *p)
{
	return p->kind == FEATURE_DITHER || p->kind == FEATURE_DIRECTED;
}

static uint16_t larger(uint16_t length, double share)
{
	return (uint16_t)fmin(length / sqrt(share), UINT16_MAX);
}

static bool is_seen_better(
	const struct maker *m, const struct model_chunk *c, const struct model_point *p)
{
	bool is = false;
	double at_m[3];
	for (int k = 0; k < 3; k++)
		at_m[k] = c->centre_m[k] + (double)p->position_m[k];
	for (guint i = 0; i < m->scans->len; i++)
		is |= look_scan_saw_better(m->scans->pdata[i], p, at_m);
	return is;
}

/* The first of its points stand for all; those of edges and tones are all taken, for they are not in the way of each other. Their number. */
static uint32_t thin_chunk(const struct maker *m, const struct model_chunk *c,
	const struct model_point *p, struct model_point *ret)
{
	const uint32_t first = (uint32_t)ceil(c->points * m->share);
	uint32_t taken = 0;
	for (uint32_t i = 0; i < c->points; i++) {
		if (is_seen_better(m, c, &p[i]) || (i >= first && !is_feature(&p[i])))
			continue;
		struct model_point *q = &ret[taken++];
		*q = p[i];
		if (!is_feature(q)) {
			q->size = larger(q->size, m->share);
			q->spacing = larger(q->spacing, m->share);
		}
	}
	return taken;
}

static bool put_chunks(struct maker *m, const struct model_chunk *c, uint32_t count,
	struct model_point *room, GError **error)
{
	const struct model_point *from = model_points(m->look->base);
	uint32_t taken[CHUNKS_A_TIME];
#pragma omp parallel for schedule(dynamic, 1)
	for (uint32_t i = 0; i < count; i++)
		taken[i] = thin_chunk(
			m, &c[i], from + c[i].first, room + (size_t)i * MODEL_CHUNK_POINTS);
	for (uint32_t i = 0; i < count; i++)
		if (taken[i] && !model_writer_put(m->to, &c[i],
					room + (size_t)i * MODEL_CHUNK_POINTS, taken[i], error))
			return false;
	return true;
}

static bool put_model(struct maker *m, GError **error)
{
	uint64_t chunks = 0;
	const struct model_chunk *chunk =
		m->look->base ? model_chunks(m->look->base, &chunks) : NULL;
	g_autofree struct model_point *room =
		g_new(struct model_point, CHUNKS_A_TIME * MODEL_CHUNK_POINTS);
	for (uint64_t i = 0; i < chunks; i += CHUNKS_A_TIME)
		if (!build_progress_step(m->progress, 0.6 + 0.3 * (double)i / (double)chunks,
			    "looking at the model", error) ||
			!put_chunks(m, chunk + i, (uint32_t)MIN(CHUNKS_A_TIME, chunks - i), room,
				error))
			return false;
	return true;
}

/* ---- all of it ---- */

static void free_scan(gpointer data)
{
	look_scan_free(data);
}

static bool take_scans(struct maker *m, const site *s, double cell_m, GError **error)
{
	const GArray *fresh = m->look->fresh;
	for (guint i = 0; i < fresh->len; i++) {
		const struct model_input *input =
			model_inputs_at(m->look->inputs, g_array_index(fresh, guint, i));
		g_autofree char *doing = g_strdup_printf("looking at scan %u", input->number);
		if (!build_progress_step(m->progress, 0.6 * i / fresh->len, doing, error))
			return false;
		look_scan *scan = look_scan_new(s, input, cell_m, error);
		if (!scan)
			return false;
		g_ptr_array_add(m->scans, scan);
	}
	return true;
}

static bool put_scans(struct maker *m, GError **error)
{
	for (guint i = 0; i < m->scans->len; i++) {
		const guint at = g_array_index(m->look->fresh, guint, i);
		size_t count;
		const struct part_point *p = look_scan_points(m->scans->pdata[i], &count);
		const uint16_t number = (uint16_t)model_inputs_at(m->look->inputs, at)->number;
		for (size_t k = 0; k < count; k++)
			if (!model_writer_add(m->to, &p[k], number, error))
				return false;
	}
	return true;
}

static JsonObject *manifest_of(const struct look *l, unsigned level, uint64_t count)
{
	JsonObject *made = json_object_new();
	json_object_set_int_member(made, "method", MODEL_METHOD);
	json_object_set_double_member(made, "lattice_m", morton_cell_m(level));
	json_object_set_double_member(made, "dither_per_m2", l->inputs->dither_per_m2);
	json_object_set_double_member(made, "tone_exponent", l->inputs->tone_exponent);
	json_object_set_member(made, "made_from", model_inputs_to_json(l->inputs));
	json_object_set_string_member(made, "key", l->key);
	json_object_set_int_member(made, "points", (gint64)count);
	return made;
}

/* Of the lattice that the base is on. */
static unsigned level_of(const model *base)
{
	JsonObject *made = base ? product_manifest(model_file(base)) : NULL;
	double cell_m = made ? json_object_get_double_member_with_default(made, "lattice_m", 0) : 0;
	unsigned level = 0;
	while (level < MORTON_LEVEL_MAX && morton_cell_m(level) < cell_m)
		level++;
	return level;
}

static bool make(struct maker *m, const site *s, struct look_result *ret, GError **error)
{
	const struct look *l = m->look;
	const unsigned level = level_of(l->base);
	g_autofree char *path = path_of(site_path(s)), *folder = g_path_get_dirname(path);
	if (!take_scans(m, s, morton_cell_m(level), error) || !files_make_folder(folder, error))
		return false;
	g_autoptr(model_writer) w = m->to = model_writer_new(path, level, error);
	if (!w || !put_model(m, error))
		return false;
	const uint64_t before = model_writer_count(w);
	if (!build_progress_step(m->progress, 0.9, "looking at the new points", error) ||
		!put_scans(m, error))
		return false;
	ret->points = model_writer_count(w);
	ret->points_new = ret->points - before;
	return model_writer_finish(w, NULL, 0, manifest_of(l, level, ret->points), error);
}

bool model_look_make(site *s, const scan_graph *g, const struct build_options *options,
	struct look_result *ret, GError **error)
{
	static const struct build_options defaults;
	const struct build_progress progress = { options ? options : &defaults, 0, 1 };
	g_auto(look) l = { 0 };
	bool can;
	*ret = (struct look_result){ 0 };
	if (!look_find(s, g, &l, &can, error))
		return false;
	ret->scans = l.inputs->scans->len;
	ret->scans_new = l.fresh->len;
	if (!can)
		return true;
	g_autoptr(GPtrArray) scans = g_ptr_array_new_with_free_func(free_scan);
	struct maker m = { .look = &l, .progress = &progress, .scans = scans, .share = 1 };
	if (l.base && model_count(l.base) > 0)
		m.share = fmin(1, POINTS_ENOUGH / (double)model_count(l.base));
	return make(&m, s, ret, error);
}
