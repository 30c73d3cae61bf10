#include "render/bench-subset.h"
#include "firmware-io/crc32c.h"
#include <json-glib/json-glib.h>
#include <math.h>
#include <string.h>

struct subset {
	const model *from;
	double part;
	product_writer *file;
	GArray *chunks; /* of struct model_chunk */
	uint64_t count;
};

static uint16_t larger(uint16_t units, double factor)
{
	return (uint16_t)fmin(units * factor + 0.5, UINT16_MAX);
}

static bool take_chunk(struct subset *s, const struct model_chunk *from, GError **error)
{
	static struct model_point point[MODEL_CHUNK_POINTS];
	struct model_chunk c = *from;
	double factor = 1 / sqrt(s->part);
	c.points = MAX((uint32_t)(from->points * s->part + 0.5), 1);
	c.first = s->count;
	memcpy(point, model_points(s->from) + from->first, c.points * sizeof *point);
	for (uint32_t i = 0; i < c.points; i++) {
		point[i].size = larger(point[i].size, factor);
		point[i].spacing = larger(point[i].spacing, factor);
	}
	c.crc32c = crc32c(0, point, c.points * sizeof *point);
	s->count += c.points;
	g_array_append_val(s->chunks, c);
	return product_writer_append(s->file, point, c.points, error);
}

static bool take_chunks(struct subset *s, GError **error)
{
	uint64_t count;
	const struct model_chunk *chunk = model_chunks(s->from, &count);
	for (uint64_t n = 0; n < count; n++)
		if (!take_chunk(s, &chunk[n], error))
			return false;
	return true;
}

/* What a scene asks the manifest for. */
static JsonObject *manifest_of(const struct subset *s)
{
	static const char *const keys[] = { "dither_per_m2", "tone_exponent" };
	JsonObject *from = product_manifest(model_file(s->from)), *to = json_object_new();
	for (int k = 0; k < 2; k++)
		if (json_object_has_member(from, keys[k]))
			json_object_set_double_member(to, keys[k],
				json_object_get_double_member(from, keys[k]) * (k ? 1 : s->part));
	return to;
}

bool bench_subset_write(const model *from, uint64_t points, const char *path, GError **error)
{
	g_autoptr(GArray) chunks = g_array_new(FALSE, FALSE, sizeof(struct model_chunk));
	g_autoptr(product_writer) file = product_writer_new(path, error);
	struct subset s = { from, (double)points / (double)model_count(from), file, chunks };
	return file && product_writer_begin(file, "points", sizeof(struct model_point), error) &&
	       take_chunks(&s, error) &&
	       product_writer_begin(file, "chunks", sizeof(struct model_chunk), error) &&
	       product_writer_append(file, chunks->data, chunks->len, error) &&
	       product_writer_finish(file, MODEL_KIND, MODEL_VERSION, manifest_of(&s), error);
}
