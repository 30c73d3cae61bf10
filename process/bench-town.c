#include "process/bench-town.h"
#include "acquire/site.h"
#include "firmware-io/files.h"
#include "process/model-write.h"
#include "process/segments.h"
#include <json-glib/json-glib.h>
#include <string.h>

/* A block is a cube of the lattice, so that the curve goes through one after another. */
#define BLOCK_BITS 16
/* Blocks from the middle of the lattice to its end. */
#define BLOCKS_HALF (1 << (MORTON_AXIS_BITS - 1 - BLOCK_BITS))
#define LEVEL       0u
/* A leaf with so much of all points is below all blocks. */
#define GROUND 0.2

struct town {
	model *from;
	segments *tree;
	struct part_point *point; /* of one block, sorted */
	size_t count;
	double moved_m[3]; /* from the site that it was to the first block */
	uint64_t *block;   /* codes of the blocks, in order */
	uint32_t blocks, across, down;
};

static void town_clear(struct town *t)
{
	model_free(t->from);
	segments_free(t->tree);
	g_free(t->point);
	g_free(t->block);
}

/* ---- one block ---- */

static int by_value(const void *a, const void *b)
{
	const double *x = a, *y = b;
	return (*x > *y) - (*x < *y);
}

/* The middle of all chunks goes to the middle of a block; the ground near its lower end. */
static void find_move(struct town *t)
{
	uint64_t chunks;
	const struct model_chunk *c = model_chunks(t->from, &chunks);
	g_autofree double *at = g_new(double, chunks + 1);
	for (int k = 0; k < 3; k++) {
		for (uint64_t n = 0; n < chunks; n++)
			at[n] = c[n].centre_m[k];
		qsort(at, chunks, sizeof *at, by_value);
		t->moved_m[k] = k < 2 ? BENCH_TOWN_PITCH_M / 2 -
						(at[chunks / 50] + at[chunks - 1 - chunks / 50]) / 2
				      : BENCH_TOWN_PITCH_M / 8 - at[chunks / 50];
	}
}

static struct part_point packed(const struct model_point *p, const struct morton_place *place)
{
	struct part_point q = { .code = place->code,
		.leaf = p->leaf,
		.intensity = p->intensity,
		.size = p->size,
		.plane_error = p->plane_error,
		.classification = p->classification,
		.feature = p->feature,
		.k1 = p->k1,
		.k2 = p->k2,
		.kind = p->kind,
		.flags = p->flags,
		.spacing = p->spacing };
	memcpy(q.within, place->within, sizeof q.within);
	memcpy(q.normal, p->normal, sizeof q.normal);
	memcpy(q.rgba, p->rgba, sizeof q.rgba);
	memcpy(q.direction, p->direction, sizeof q.direction);
	memcpy(q.principal, p->principal, sizeof q.principal);
	return q;
}

static void take_chunk(struct town *t, const struct model_chunk *c)
{
	const struct model_point *p = model_points(t->from) + c->first;
	for (uint32_t i = 0; i < c->points; i++) {
		double at_m[3];
		struct morton_place place;
		bool inside = true;
		for (int k = 0; k < 3; k++) {
			at_m[k] = c->centre_m[k] + (double)p[i].position_m[k] + t->moved_m[k];
			inside &= at_m[k] >= 0 && at_m[k] < BENCH_TOWN_PITCH_M;
		}
		if (inside && morton_from_point(at_m, morton_cell_m(LEVEL), &place))
			t->point[t->count++] = packed(&p[i], &place);
	}
}

static void take_block(struct town *t)
{
	uint64_t chunks;
	const struct model_chunk *c = model_chunks(t->from, &chunks);
	find_move(t);
	t->point = g_new(struct part_point, model_count(t->from) + 1);
	for (uint64_t n = 0; n < chunks; n++)
		take_chunk(t, &c[n]);
	g_autofree struct part_point *before = t->point;
	t->point = part_points_sorted(before, t->count);
	/* Of the block's own cube; that of all blocks is added again. */
	for (size_t i = 0; i < t->count; i++)
		t->point[i].code &= ((uint64_t)1 << 3 * BLOCK_BITS) - 1;
}

/* ---- all blocks ---- */

static int by_code(const void *a, const void *b)
{
	const uint64_t *x = a, *y = b;
	return (*x > *y) - (*x < *y);
}

static uint64_t code_of(uint32_t x, uint32_t y)
{
	const uint64_t cube[3] = { x + BLOCKS_HALF, y + BLOCKS_HALF, BLOCKS_HALF };
	uint64_t code = 0;
	for (int k = 0; k < 3; k++)
		code |= morton_spread(cube[k] << BLOCK_BITS) << k;
	return code;
}

static bool lay_out(struct town *t, uint64_t wanted, GError **error)
{
	uint32_t blocks = t->count ? (uint32_t)((wanted + t->count - 1) / t->count) : UINT32_MAX;
	while ((uint64_t)t->across * t->across < blocks && t->across <= BLOCKS_HALF)
		t->across++;
	t->down = t->across ? (blocks + t->across - 1) / t->across : 0;
	if (!blocks || t->across > BLOCKS_HALF) {
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_ARGUMENT,
			"%s: a town of its blocks has at most %u a side",
			product_path(model_file(t->from)), BLOCKS_HALF);
		return false;
	}
	t->blocks = t->across * t->down;
	t->block = g_new(uint64_t, t->blocks);
	for (uint32_t n = 0; n < t->blocks; n++)
		t->block[n] = code_of(n % t->across, n / t->across);
	qsort(t->block, t->blocks, sizeof *t->block, by_code);
	return true;
}

/* A thing again, in a block; what cannot be numbered any more is what it was. */
static uint16_t leaf_again(struct town *t, uint32_t leaf, uint32_t block)
{
	const struct segment *was = segments_find(t->tree, leaf);
	if (!block || !was || leaf < SEGMENT_FIRST)
		return (uint16_t)leaf;
	g_autofree char *name = g_strdup_printf("%s, block %u", was->name, block + 1);
	uint32_t again = segments_add(t->tree, was->parent, name, "rules");
	return (uint16_t)(again ? again : leaf);
}

static bool write_leaf(struct town *t, model_writer *w, const struct part_point *p, size_t count,
	uint32_t block, uint16_t leaf, GError **error)
{
	for (size_t i = 0; i < count; i++) {
		struct part_point q = p[i];
		q.code |= t->block[block];
		q.leaf = leaf;
		if (!model_writer_add(w, &q, 1, error))
			return false;
	}
	return true;
}

static size_t end_of_leaf(const struct town *t, size_t from)
{
	size_t end = from;
	while (end < t->count && t->point[end].leaf == t->point[from].leaf)
		end++;
	return end;
}

/* What all blocks have together leaf by leaf, the rest block by block: leaves need not be in order. */
static bool write_points(struct town *t, model_writer *w, GError **error)
{
	for (size_t from = 0, end; from < t->count; from = end) {
		end = end_of_leaf(t, from);
		bool is_ground = (double)(end - from) > GROUND * (double)t->count;
		for (uint32_t n = 0; n < t->blocks; n++) {
			uint16_t leaf = t->point[from].leaf;
			if (!write_leaf(t, w, t->point + from, end - from, n,
				    is_ground ? leaf : leaf_again(t, leaf, n), error))
				return false;
		}
	}
	return true;
}

/* Scans stand in the first block. */
static JsonNode *moved_stations(const struct town *t)
{
	JsonObject *from = product_manifest(model_file(t->from));
	JsonNode *all = json_node_copy(json_object_get_member(from, "made_from"));
	JsonArray *scans = json_node_get_array(all), *copy = json_array_new();
	for (guint i = 0; i < json_array_get_length(scans); i++) {
		JsonObject *scan = json_array_get_object_element(scans, i), *to = json_object_new();
		JsonArray *pose = json_object_get_array_member(scan, "pose"),
			  *moved = json_array_new();
		for (guint k = 0; k < json_array_get_length(pose); k++)
			json_array_add_double_element(
				moved, json_array_get_double_element(pose, k) +
					       (k < 9 ? 0 : t->moved_m[k - 9]));
		json_object_set_int_member(to, "scan", json_object_get_int_member(scan, "scan"));
		json_object_set_array_member(to, "pose", moved);
		json_array_add_object_element(copy, to);
	}
	json_node_take_array(all, copy);
	return all;
}

static JsonObject *manifest_of(const struct town *t)
{
	static const char *const keys[] = { "dither_per_m2", "tone_exponent" };
	JsonObject *from = product_manifest(model_file(t->from)), *to = json_object_new();
	for (size_t k = 0; k < G_N_ELEMENTS(keys); k++)
		if (json_object_has_member(from, keys[k]))
			json_object_set_double_member(
				to, keys[k], json_object_get_double_member(from, keys[k]));
	json_object_set_member(to, "made_from", moved_stations(t));
	return to;
}

static bool write_model(struct town *t, const char *path, GError **error)
{
	g_autofree char *folder = g_build_filename(path, "model", NULL), *file = model_path(path);
	if (!files_make_folder(folder, error))
		return false;
	g_autoptr(model_writer) w = model_writer_new(file, LEVEL, error);
	return w && write_points(t, w, error) &&
	       model_writer_finish(w, NULL, 0, manifest_of(t), error);
}

bool bench_town_write(
	const char *from, const char *path, uint64_t wanted, struct bench_town *ret, GError **error)
{
	struct town t = { 0 };
	gint64 began_us = g_get_monotonic_time();
	g_autoptr(site) made = site_open_for_writing(path, error);
	t.from = made ? model_open(from, error) : NULL;
	t.tree = t.from ? segments_load(from, error) : NULL;
	bool good = t.tree;
	if (good)
		take_block(&t);
	g_autofree char *folder = g_build_filename(path, "segments", NULL);
	good = good && lay_out(&t, wanted, error) && write_model(&t, path, error) &&
	       files_make_folder(folder, error) && segments_save(t.tree, path, error);
	*ret = (struct bench_town){ .across = t.across,
		.down = t.down,
		.points = (uint64_t)t.count * t.blocks,
		.seconds = 1e-6 * (double)(g_get_monotonic_time() - began_us) };
	town_clear(&t);
	return good;
}
