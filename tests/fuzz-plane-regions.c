/* Any regions, rings and vertices, sound as a file, as plane regions: what is accepted can be read to its end, and nothing points outside.
 * The first four bytes of the input say how many regions, rings, vertices and points of the model there are; then what is in them, and in
 * the texels what is left. */
#include "process/plane-regions.h"
#include <glib/gstdio.h>
#include <json-glib/json-glib.h>
#include <math.h>
#include <string.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static char *path;

static void clear(void)
{
	g_unlink(path);
	g_free(path);
}

/* As much as there is of them; the rest is 0. */
static bool put(product_writer *w, const char *name, uint32_t bytes, uint64_t count,
	const uint8_t **data, size_t *size)
{
	g_autofree uint8_t *all = g_malloc0(count * bytes + 1);
	size_t take = MIN(*size, count * bytes);
	memcpy(all, *data, take);
	*data += take;
	*size -= take;
	return product_writer_begin(w, name, bytes, NULL) &&
	       product_writer_append(w, all, count, NULL);
}

static void write_file(const uint8_t *data, size_t size)
{
	g_autoptr(product_writer) w = product_writer_new(path, NULL);
	const uint8_t many[4] = { data[0] % 8, data[1] % 32, data[2], data[3] };
	data += 4;
	size -= 4;
	JsonObject *made = json_object_new();
	json_object_set_int_member(made, "points", many[3]);
	g_assert_true(put(w, "regions", sizeof(struct plane_region), many[0], &data, &size));
	g_assert_true(put(w, "rings", sizeof(struct plane_ring), many[1], &data, &size));
	g_assert_true(put(w, "vertices", sizeof(float[2]), many[2], &data, &size));
	g_assert_true(put(w, "explained", 1, (many[3] + 7) / 8, &data, &size));
	g_assert_true(put(w, "texels", 4, size / 4, &data, &size));
	g_assert_true(
		product_writer_finish(w, PLANE_REGIONS_KIND, PLANE_REGIONS_VERSION, made, NULL));
}

static double read_all(const plane_regions *r)
{
	double sum = 0;
	for (uint32_t n = 0; n < r->count; n++) {
		const struct plane_region *p = &r->region[n];
		for (uint32_t k = p->first_ring; k < p->first_ring + p->rings; k++)
			for (uint32_t i = 0; i < r->ring[k].count; i++)
				sum += (double)r->vertex[r->ring[k].first + i][0];
		for (uint64_t k = 0; k < (uint64_t)p->width * p->height; k++)
			sum += r->texel[p->first_texel + k][0];
	}
	for (uint64_t n = 0; n < r->points; n++)
		sum += plane_regions_explain(r, n);
	return sum;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	g_autoptr(GError) error = NULL;
	if (size < 4)
		return 0;
	if (!path) {
		path = g_strdup_printf("%s/fuzz-plane-regions.%d", g_get_tmp_dir(), getpid());
		atexit(clear);
	}
	write_file(data, size);
	g_autoptr(plane_regions) r = plane_regions_open(path, &error);
	g_assert_true((r == NULL) == (error != NULL));
	g_assert_true(!r || isfinite(read_all(r)));
	return 0;
}
