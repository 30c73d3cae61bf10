#include "process/model-write.h"
#include "firmware-io/crc32c.h"
#include "process/chunk-order.h"
#include <string.h>

#define BATCH_CHUNKS 64u

struct waiting {
	struct part_point point;
	uint16_t scan;
};

struct model_writer {
	product_writer *file;
	double cell_m;
	uint64_t count; /* of the points before the batch */
	/* Chunks that wait until there is work for all threads. Each has its own MODEL_CHUNK_POINTS places. */
	struct waiting *waiting;
	struct model_chunk batch[BATCH_CHUNKS];
	struct model_point *done;
	uint32_t batched; /* the last one may not be full yet */
	GArray *chunks;   /* of struct model_chunk, those that are written */
};

model_writer *model_writer_new(const char *path, unsigned level, GError **error)
{
	g_autoptr(model_writer) w = g_new0(model_writer, 1);
	w->file = product_writer_new(path, error);
	if (!w->file || !product_writer_begin(w->file, "points", sizeof(struct model_point), error))
		return NULL;
	w->cell_m = morton_cell_m(level);
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
	g_free(w->waiting);
	g_free(w->done);
	if (w->chunks)
		g_array_unref(w->chunks);
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
		.leaf = p->leaf };
	for (int k = 0; k < 3; k++)
		q.position_m[k] = (float)(at_m[k] - centre_m[k]);
	memcpy(q.normal, p->normal, sizeof q.normal);
	memcpy(q.rgba, p->rgba, sizeof q.rgba);
	return q;
}

static void finish_chunk(const struct waiting *waiting, double cell_m, struct model_chunk *c,
	struct model_point *ret)
{
	double at_m[MODEL_CHUNK_POINTS][3];
	uint16_t place[MODEL_CHUNK_POINTS];
	place_points(waiting, c->points, cell_m, at_m);
	find_box(at_m, c);
	/* The first point's place is the seed: a chunk whose points are the same is shuffled the same. */
	chunk_order(waiting[0].point.code, c->points, place);
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
		if (!product_writer_append(w->file, w->done + (size_t)i * MODEL_CHUNK_POINTS,
			    w->batch[i].points, error))
			return false;
	}
	w->batched = 0;
	return true;
}

bool model_writer_add(model_writer *w, const struct part_point *p, uint16_t scan, GError **error)
{
	struct model_chunk *c = w->batched ? &w->batch[w->batched - 1] : NULL;
	if (!c || c->points == MODEL_CHUNK_POINTS || c->leaf != p->leaf) {
		if (w->batched == BATCH_CHUNKS && !write_batch(w, error))
			return false;
		c = &w->batch[w->batched++];
		*c = (struct model_chunk){ .leaf = p->leaf };
	}
	size_t at = (size_t)(w->batched - 1) * MODEL_CHUNK_POINTS + c->points++;
	w->waiting[at] = (struct waiting){ *p, scan };
	return true;
}

uint64_t model_writer_count(const model_writer *w)
{
	uint64_t count = w->count;
	for (uint32_t i = 0; i < w->batched; i++)
		count += w->batch[i].points;
	return count;
}

bool model_writer_finish(model_writer *w, JsonObject *manifest_json, GError **error)
{
	g_autoptr(JsonObject) m = manifest_json;
	return write_batch(w, error) &&
	       product_writer_begin(w->file, "chunks", sizeof(struct model_chunk), error) &&
	       product_writer_append(w->file, w->chunks->data, w->chunks->len, error) &&
	       product_writer_finish(
		       w->file, MODEL_KIND, MODEL_VERSION, g_steal_pointer(&m), error);
}
