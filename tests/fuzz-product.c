/* Any bytes as a product file, and as a model: opening tells, and what opens can be read to its last byte. The last byte of the
 * input says whether checksums are mended first; without that few inputs would get past them. */
#include "firmware-io/crc32c.h"
#include "process/model.h"
#include "process/product-format.h"
#include "process/site-lines.h"
#include <float.h>
#include <math.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void mend_sections(uint8_t *bytes, size_t size, uint8_t *table, uint32_t sections)
{
	struct product_entry e;
	for (uint32_t i = 0; i < sections; i++) {
		memcpy(&e, table + i * sizeof e, sizeof e);
		uint64_t length;
		if (!__builtin_mul_overflow(e.elements, e.element_bytes, &length) &&
			e.offset <= size && length <= size - e.offset)
			e.crc32c = crc32c(0, bytes + e.offset, length);
		memcpy(table + i * sizeof e, &e, sizeof e);
	}
}

static void mend(uint8_t *bytes, size_t size)
{
	struct product_header h;
	if (size < sizeof h)
		return;
	memcpy(&h, bytes, sizeof h);
	h.file_bytes = size;
	if (h.table_offset <= size) {
		size_t length = (size - h.table_offset) / sizeof(struct product_entry) *
				sizeof(struct product_entry);
		h.sections = (uint32_t)(length / sizeof(struct product_entry));
		mend_sections(bytes, size, bytes + h.table_offset, h.sections);
		h.table_crc32c = crc32c(0, bytes + h.table_offset, length);
	}
	h.header_crc32c = crc32c(0, &h, offsetof(struct product_header, header_crc32c));
	memcpy(bytes, &h, sizeof h);
}

static uint32_t sum_model(const model *m)
{
	uint64_t count;
	const struct model_chunk *chunks = model_chunks(m, &count);
	uint32_t sum = crc32c(0, chunks, count * sizeof *chunks);
	for (uint64_t i = 0; i < count; i++)
		sum = crc32c(sum, model_points(m) + chunks[i].first,
			chunks[i].points * sizeof(struct model_point));
	return sum;
}

/* Whatever is taken for lines can be followed from end to end. */
static void check_lines(const char *path)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(profile_lines) p = site_lines_load_file(path, &error);
	float sum = 0;
	g_assert_true((p == NULL) == (error != NULL));
	for (guint n = 0; p && n < p->line->len; n++) {
		const struct profile_line *l = &g_array_index(p->line, struct profile_line, n);
		g_assert_cmpuint(l->kind, <, PROFILE_KINDS);
		for (uint32_t k = 0; k < l->count; k++)
			sum += g_array_index(p->vertex, struct profile_vertex, l->first + k)
				       .at_m[0] /
			       FLT_MAX;
	}
	g_assert_true(isfinite(sum));
}

static void check(const char *path)
{
	g_autoptr(GError) error = NULL, bad = NULL;
	g_autoptr(product) p = product_open(path, MODEL_KIND, MODEL_VERSION, &error);
	g_assert_true((p == NULL) == (error != NULL));
	g_assert_true(!p || product_verify(p, &bad) == (bad == NULL));
	g_clear_error(&bad);
	g_autoptr(GError) no_model = NULL;
	g_autoptr(model) m = model_open_file(path, &no_model);
	g_assert_true((m == NULL) == (no_model != NULL));
	g_assert_true(p || !m);
	if (m) {
		g_assert_cmpuint(sum_model(m), <=, G_MAXUINT32);
		g_assert_true(model_verify(m, &bad) == (bad == NULL));
	}
	check_lines(path);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	if (size < 1)
		return 0;
	g_autofree uint8_t *bytes = g_memdup2(data, size);
	if (bytes[--size] & 1)
		mend(bytes, size);
	int fd = memfd_create("product", MFD_CLOEXEC);
	g_autofree char *path = g_strdup_printf("/proc/self/fd/%d", fd);
	g_assert_cmpint(write(fd, bytes, size), ==, (ssize_t)size);
	check(path);
	close(fd);
	return 0;
}
