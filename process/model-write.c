#include "process/model-write.h"
#include "firmware-io/crc32c.h"
#include "process/chunk-order.h"
#include "process/model-coarse.h"
#include <json-glib/json-glib.h>
#include <string.h>

#define BATCH_CHUNKS 64u

struct waiting {
	struct part_point point;
	uint16_t scan;
};

struct model_writer {
	product_writer *file;
	model_coarse *coarse;
	double cell_m;
	unsigned block_shift;
	uint64_t count; /* of the points before the batch */
	/* Chunks that wait until there is work for all threads. Each has its own MODEL_CHUNK_POINTS places. */
	struct waiting *waiting;
	struct model_chunk batch[BATCH_CHUNKS];
	struct model_point *done;
	uint32_t batched; /* the last one may not be full yet */
	GArray *chunks;   /* of struct model_chunk, those that are written */
	GArray *pieces;   /* of struct model_piece */
	uint64_t block;   /* of the last point, with its leaf */
	uint32_t leaf;
	bool is_cut; /* the next point begins a piece */
};

model_writer *model_writer_new(const char *path, unsigned level, GError **error)
{
	g_autoptr(model_writer) w = g_new0(model_writer, 1);
	w->file = product_writer_new(path, error);
	w->coarse = w->file ? model_coarse_new(path, error) : NULL;
	if (!w->coarse ||
		!product_writer_begin(w->file, "points", sizeof(struct model_point), error))
		return NULL;
	w->cell_m = morton_cell_m(level);
	w->block_shift = model_cube_shift(MODEL_BLOCK_M, w->cell_m);
	w->is_cut = true;
	w->pieces = g_array_new(FALSE, FALSE, sizeof(struct model_piece));
	w->waiting = g_new(struct waiting, BATCH_CHUNKS * MODEL_CHUNK_POINTS);
	w->done = g_new(struct model_point, BATCH_CHUNKS * MODEL_CHUNK_POINTS);
	w->chunks = g_array_new(FALSE, FALSE, sizeof(struct model_chunk));
	return g_steal_pointer(&w);
}

void model_writer_free(model_writer *w)
{
	if (!w)
		return;
	product_writer_free(w->file);
	model_coarse_free(w->coarse);
	g_free(w->waiting);
	g_free(w->done);
	g_clear_pointer(&w->chunks, g_array_unref);
	g_clear_pointer(&w->pieces, g_array_unref);
	g_free(w);
}

/* ---- one chunk ---- */

static void place_points(
	const struct waiting *waiting, uint32_t count, double cell_m, double (*ret_m)[3])
{
	for (uint32_t i = 0; i < count; i++) {
		struct morton_place place = { .code = waiting[i].point.code };
		memcpy(place.within, waiting[i].point.within, sizeof place.within);
		morton_to_point(&place, cell_m, ret_m[i]);
	}
}

static void find_box(const double (*at_m)[3], struct model_chunk *c)
{
	double low[3] = { INFINITY, INFINITY, INFINITY };
	double high[3] = { -INFINITY, -INFINITY, -INFINITY };
	for (uint32_t i = 0; i < c->points; i++)
		for (int k = 0; k < 3; k++) {
			low[k] = fmin(low[k], at_m[i][k]);
			high[k] = fmax(high[k], at_m[i][k]);
		}
	for (int k = 0; k < 3; k++) {
		c->centre_m[k] = 0.5 * (low[k] + high[k]);
		/* Up by the rounding to float, so that the box holds the points as they are stored. */
		c->half_size_m[k] = nextafterf((float)(0.5 * (high[k] - low[k])), INFINITY);
	}
}

static struct model_point point_of(
	const struct waiting *from, const double at_m[3], const double centre_m[3])
{
	const struct part_point *p = &from->point;
	struct model_point q = { .intensity = p->intensity,
		.scan = from->scan,
		.size = p->size,
		.classification = p->classification,
		.feature = p->feature,
		.plane_error = p->plane_error,
		.leaf = p->leaf,
		.k1 = p->k1,
		.k2 = p->k2,
		.kind = p->kind,
		.flags = p->flags,
		.spacing = p->spacing };
	for (int k = 0; k < 3; k++)
		q.position_m[k] = (float)(at_m[k] - centre_m[k]);
	memcpy(q.normal, p->normal, sizeof q.normal);
	memcpy(q.rgba, p->rgba, sizeof q.rgba);
	memcpy(q.direction, p->direction, sizeof q.direction);
	memcpy(q.principal, p->principal, sizeof q.principal);
	return q;
}

static void finish_chunk(const struct waiting *waiting, double cell_m, struct model_chunk *c,
	struct model_point *ret)
{
	double at_m[MODEL_CHUNK_POINTS][3];
	float spacing_m[MODEL_CHUNK_POINTS];
	uint16_t place[MODEL_CHUNK_POINTS];
	place_points(waiting, c->points, cell_m, at_m);
	find_box(at_m, c);
	/* The first point's place is the seed: a chunk whose points are the same is shuffled the same. */
	chunk_order(waiting[0].point.code, c->points, place);
	for (uint32_t i = 0; i < c->points; i++)
		spacing_m[i] = (float)MAX(waiting[i].point.spacing, 1) * 1e-4f;
	chunk_order_even((const double(*)[3])at_m, spacing_m, c->points, place);
	for (uint32_t i = 0; i < c->points; i++)
		ret[i] = point_of(&waiting[place[i]], at_m[place[i]], c->centre_m);
	c->crc32c = crc32c(0, ret, c->points * sizeof *ret);
}

/* ---- all of them ---- */

static bool write_batch(model_writer *w, GError **error)
{
#pragma omp parallel for schedule(dynamic, 1)
	for (uint32_t i = 0; i < w->batched; i++)
		finish_chunk(w->waiting + (size_t)i * MODEL_CHUNK_POINTS, w->cell_m, &w->batch[i],
			w->done + (size_t)i * MODEL_CHUNK_POINTS);
	for (uint32_t i = 0; i < w->batched; i++) {
		w->batch[i].first = w->count;
		w->count += w->batch[i].points;
		g_array_append_val(w->chunks, w->batch[i]);
		const struct model_point *done = w->done + (size_t)i * MODEL_CHUNK_POINTS;
		if (!model_coarse_add(w->coarse, &w->batch[i], done, error) ||
			!product_writer_append(w->file, done, w->batch[i].points, error))
			return false;
	}
	w->batched = 0;
	return true;
}

static void add_piece(model_writer *w, uint64_t code, uint32_t leaf)
{
	const struct model_piece *last =
		w->pieces->len ? &g_array_index(w->pieces, struct model_piece, w->pieces->len - 1)
			       : NULL;
	struct model_piece piece = { .code = last && last->leaf == leaf ? code : 0,
		.first_chunk = w->chunks->len + w->batched,
		.leaf = leaf };
	g_array_append_val(w->pieces, piece);
}

static bool begins_piece(model_writer *w, const struct part_point *p)
{
	uint64_t block = p->code >> w->block_shift;
	bool begins = w->is_cut || p->leaf != w->leaf ||
		      (block != w->block && model_block_begins_piece(block));
	w->is_cut = false;
	w->block = block;
	w->leaf = p->leaf;
	return begins;
}

bool model_writer_add(model_writer *w, const struct part_point *p, uint16_t scan, GError **error)
{
	bool begins = begins_piece(w, p);
	struct model_chunk *c = w->batched ? &w->batch[w->batched - 1] : NULL;
	if (begins || !c || c->points == MODEL_CHUNK_POINTS) {
		if (w->batched == BATCH_CHUNKS && !write_batch(w, error))
			return false;
		if (begins)
			add_piece(w, w->block << w->block_shift, p->leaf);
		c = &w->batch[w->batched++];
		*c = (struct model_chunk){ .leaf = p->leaf };
	}
	size_t at = (size_t)(w->batched - 1) * MODEL_CHUNK_POINTS + c->points++;
	w->waiting[at] = (struct waiting){ *p, scan };
	return true;
}

bool model_writer_take(model_writer *w, const model *from, const struct model_piece *piece,
	uint64_t end_chunk, bool *ret_taken, GError **error)
{
	uint64_t chunks, taken = 0;
	const struct model_chunk *c = model_chunks(from, &chunks) + piece->first_chunk;
	const struct model_point *first = model_points(from) + c->first;
	*ret_taken = true;
	for (uint64_t i = piece->first_chunk; *ret_taken && i < end_chunk; i++) {
		*ret_taken = model_verify_chunk(from, i, NULL);
		taken += c[i - piece->first_chunk].points;
	}
	if (!*ret_taken)
		return true;
	if (!write_batch(w, error) || !product_writer_append(w->file, first, taken, error))
		return false;
	add_piece(w, piece->code, piece->leaf);
	for (uint64_t i = piece->first_chunk; i < end_chunk; i++, c++) {
		struct model_chunk moved = *c;
		moved.first = w->count;
		w->count += moved.points;
		g_array_append_val(w->chunks, moved);
		if (!model_coarse_add(w->coarse, c, model_points(from) + c->first, error))
			return false;
	}
	w->is_cut = true;
	product_forget(model_file(from), first, taken * sizeof *first);
	return true;
}

bool model_writer_put(model_writer *w, const struct model_chunk *like,
	const struct model_point *point, uint32_t count, GError **error)
{
	struct model_chunk c = *like;
	c.points = count;
	c.crc32c = crc32c(0, point, count * sizeof *point);
	if (!write_batch(w, error) || !product_writer_append(w->file, point, count, error) ||
		!model_coarse_add(w->coarse, &c, point, error))
		return false;
	c.first = w->count;
	w->count += count;
	g_array_append_val(w->chunks, c);
	w->is_cut = true;
	return true;
}

uint64_t model_writer_count(const model_writer *w)
{
	uint64_t count = w->count;
	for (uint32_t i = 0; i < w->batched; i++)
		count += w->batch[i].points;
	return count;
}

static bool write_dropped(
	product_writer *file, model_part *const *part, size_t parts, GError **error)
{
	g_autofree uint64_t *end = g_new(uint64_t, parts + 1);
	uint64_t words = 0;
	if (!product_writer_begin(file, "dropped", sizeof(uint64_t), error))
		return false;
	for (size_t i = 0; i < parts; i++) {
		if (!product_writer_append(file, part[i]->dropped, part[i]->words, error))
			return false;
		end[i] = words += part[i]->words;
	}
	return product_writer_begin(file, "dropped_end", sizeof *end, error) &&
	       product_writer_append(file, end, parts, error);
}

bool model_writer_finish(model_writer *w, model_part *const *part, size_t parts,
	JsonObject *manifest_json, GError **error)
{
	g_autoptr(JsonObject) m = manifest_json;
	return write_batch(w, error) &&
	       product_writer_begin(w->file, "chunks", sizeof(struct model_chunk), error) &&
	       product_writer_append(w->file, w->chunks->data, w->chunks->len, error) &&
	       product_writer_begin(w->file, "pieces", sizeof(struct model_piece), error) &&
	       product_writer_append(w->file, w->pieces->data, w->pieces->len, error) &&
	       model_coarse_write(w->coarse, w->file,
		       (const struct model_chunk *)(void *)w->chunks->data, error) &&
	       write_dropped(w->file, part, parts, error) &&
	       product_writer_finish(
		       w->file, MODEL_KIND, MODEL_VERSION, g_steal_pointer(&m), error);
}
