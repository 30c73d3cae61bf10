/* Product files: what is written reads back, whatever is damaged is told, and what was not finished leaves nothing behind. */
#include "firmware-io/crc32c.h"
#include "firmware-io/files.h"
#include "process/product-format.h"
#include "process/product.h"
#include "tests/simulated.h"
#include <glib/gstdio.h>
#include <json-glib/json-glib.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#define KIND "sample"

static char *sample_path(void)
{
	g_autofree char *folder = simulated_folder();
	return g_build_filename(folder, "a.sample", NULL);
}

/* Two sections: u16 counting up in pieces, an empty one of 24-byte elements. */
static bool write_sample(const char *path, uint32_t count, GError **error)
{
	g_autoptr(product_writer) w = product_writer_new(path, error);
	if (!w || !product_writer_begin(w, "numbers", 2, error))
		return false;
	for (uint32_t i = 0, piece = 1; i < count; i += piece, piece = piece * 3 % 70001) {
		g_autofree uint16_t *numbers = g_new(uint16_t, piece);
		piece = MIN(piece, count - i);
		for (uint32_t k = 0; k < piece; k++)
			numbers[k] = (uint16_t)((i + k) * 40503u);
		if (!product_writer_append(w, numbers, piece, error))
			return false;
	}
	JsonObject *made_from = json_object_new();
	json_object_set_string_member(made_from, "inputs", "abc \"quoted\" \xC3\xBC");
	return product_writer_begin(w, "nothing", 24, error) &&
	       product_writer_finish(w, KIND, 3, made_from, error);
}

static void test_round_trip(void)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *path = sample_path();
	static const uint32_t counts[] = { 0, 1, 31, 32, 33, 524288, 3000001 };
	for (size_t i = 0; i < G_N_ELEMENTS(counts); i++) {
		g_assert_true(write_sample(path, counts[i], &error));
		g_autoptr(product) p = product_open(path, KIND, 3, &error);
		g_assert_no_error(error);
		uint64_t n;
		const uint16_t *numbers = product_section(p, "numbers", 2, &n, &error);
		g_assert_cmpuint(n, ==, counts[i]);
		g_assert_cmpuint((uintptr_t)numbers % 64, ==, 0);
		for (uint64_t k = 0; k < n; k++)
			g_assert_true(numbers[k] == (uint16_t)(k * 40503u));
		g_assert_nonnull(product_section(p, "nothing", 24, &n, &error));
		g_assert_cmpuint(n, ==, 0);
		g_assert_cmpstr(json_object_get_string_member(product_manifest(p), "inputs"), ==,
			"abc \"quoted\" \xC3\xBC");
		g_assert_cmpint(json_object_get_int_member(product_manifest(p), "version"), ==, 3);
		g_assert_true(product_verify(p, &error));
		if (counts[i])
			product_forget(p, numbers, counts[i] * 2);
		g_assert_true(product_verify(p, &error)); /* what was forgotten can be read again */
	}
}

static void test_layout(void)
{
	g_autofree char *path = sample_path(), *bytes = NULL;
	size_t length;
	g_assert_true(write_sample(path, 100, NULL));
	g_assert_true((bytes = files_read(path, 1 << 20, &length, NULL)));
	struct product_header h;
	memcpy(&h, bytes, sizeof h);
	g_assert_cmpmem(bytes, 8, "PLPRODUC", 8);
	g_assert_cmpuint(h.sections, ==, 3);
	g_assert_cmpuint(h.file_bytes, ==, length);
	const struct product_entry *table = (const void *)(bytes + h.table_offset);
	for (uint32_t i = 0; i < h.sections; i++)
		g_assert_cmpuint(table[i].crc32c, ==,
			crc32c(0, bytes + table[i].offset,
				table[i].elements * table[i].element_bytes));
	g_assert_cmpstr(table[0].name, ==, "numbers");
	g_assert_cmpuint(table[0].offset, ==, 64);
	g_assert_cmpuint(table[1].offset, ==, 64 + 256);
	g_assert_cmpstr(table[2].name, ==, "manifest");
}

static void expect(const char *path, const char *kind, int version, int code, const char *says)
{
	g_autoptr(GError) error = NULL;
	g_assert_null(product_open(path, kind, version, &error));
	g_assert_error(error, PRODUCT_ERROR, code);
	g_assert_true(g_str_has_prefix(error->message, path));
	g_assert_nonnull(strstr(error->message, says));
}

static void test_wrong_file(void)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *path = sample_path();
	g_assert_null(product_open(path, KIND, 3, &error));
	g_assert_error(error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND);
	g_assert_true(write_sample(path, 100, NULL));
	expect(path, "other", 3, PRODUCT_ERROR_KIND, "'sample'");
	expect(path, KIND, 2, PRODUCT_ERROR_VERSION, "later version");
	g_autoptr(product) p = product_open(path, KIND, 4, NULL);
	g_assert_nonnull(p);
	uint64_t n;
	g_autoptr(GError) missing = NULL, size = NULL;
	g_assert_null(product_section(p, "colours", 2, &n, &missing));
	g_assert_error(missing, PRODUCT_ERROR, PRODUCT_ERROR_DAMAGED);
	g_assert_null(product_section(p, "numbers", 4, &n, &size));
	g_assert_error(size, PRODUCT_ERROR, PRODUCT_ERROR_DAMAGED);
	g_assert_true(files_write(path, "", 0, NULL));
	expect(path, KIND, 3, PRODUCT_ERROR_DAMAGED, "not a product");
}

static void replace(const char *path, const void *bytes, size_t length)
{
	FILE *f = fopen(path, "wb");
	g_assert_nonnull(f);
	g_assert_cmpuint(fwrite(bytes, 1, length, f), ==, length);
	g_assert_cmpint(fclose(f), ==, 0);
}

/* Every bit of the file, turned: either the file does not open, or its verification fails, or the bit was padding. */
static void test_every_bit(void)
{
	g_autofree char *path = sample_path(), *bytes = NULL;
	size_t length, harmless = 0;
	g_assert_true(write_sample(path, 50, NULL));
	g_assert_true((bytes = files_read(path, 1 << 20, &length, NULL)));
	for (size_t bit = 0; bit < length * 8; bit += 3) {
		bytes[bit / 8] ^= (char)(1 << bit % 8);
		replace(path, bytes, length);
		g_autoptr(product) p = product_open(path, KIND, 3, NULL);
		harmless += p && product_verify(p, NULL);
		bytes[bit / 8] ^= (char)(1 << bit % 8);
	}
	/* 24 bytes of the header, up to 63 after each of three sections. */
	g_assert_cmpuint(harmless, <=, (24 + 3 * 63) * 8 / 3 + 1);
}

static void test_every_length(void)
{
	g_autofree char *path = sample_path(), *bytes = NULL;
	size_t length;
	g_assert_true(write_sample(path, 50, NULL));
	g_assert_true((bytes = files_read(path, 1 << 20, &length, NULL)));
	for (size_t cut = 0; cut < length; cut++) {
		replace(path, bytes, cut);
		expect(path, KIND, 3, PRODUCT_ERROR_DAMAGED, path);
	}
}

/* A writer that is given up, or cannot write, leaves the file that was there, and nothing beside it. */
static void test_unfinished(void)
{
	g_autofree char *path = sample_path(), *folder = g_path_get_dirname(path);
	g_assert_true(write_sample(path, 100, NULL));
	product_writer *w = product_writer_new(path, NULL);
	g_assert_true(product_writer_begin(w, "x", 1, NULL));
	g_assert_true(product_writer_append(w, "abc", 3, NULL));
	product_writer_free(w);
	g_autoptr(GPtrArray) names = files_names(folder, NULL);
	g_assert_cmpuint(names->len, ==, 1);
	g_autoptr(product) p = product_open(path, KIND, 3, NULL);
	g_assert_true(product_verify(p, NULL));
}

static void test_full_disk(void)
{
	g_autoptr(GError) error = NULL, again = NULL;
	g_autofree char *folder = simulated_folder();
	g_autofree char *beside = g_build_filename(folder, ".full.new", NULL);
	g_autofree char *path = g_build_filename(folder, "full", NULL);
	static const uint8_t zeros[1 << 21];
	g_autoptr(product_writer) no = product_writer_new("/nowhere/at/all", &error);
	g_assert_null(no);
	g_assert_error(error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND);
	g_clear_error(&error);
	if (symlink("/dev/full", beside))
		g_assert_not_reached();
	g_assert_null(product_writer_new(path, &error)); /* links are not followed */
	g_assert_nonnull(error);
	g_clear_error(&error);
	g_assert_cmpint(g_unlink(beside), ==, 0);
	g_autoptr(product_writer) w = product_writer_new(path, NULL);
	g_assert_true(product_writer_begin(w, "x", 1, NULL));
	struct rlimit all, small = { 1 << 20, 1 << 20 };
	getrlimit(RLIMIT_FSIZE, &all);
	small.rlim_max = all.rlim_max;
	signal(SIGXFSZ, SIG_IGN);
	setrlimit(RLIMIT_FSIZE, &small);
	g_assert_false(product_writer_append(w, zeros, sizeof zeros, &error));
	g_assert_false(product_writer_finish(w, KIND, 1, json_object_new(), &again));
	setrlimit(RLIMIT_FSIZE, &all);
	g_assert_error(error, G_IO_ERROR, G_IO_ERROR_FAILED);
	g_assert_nonnull(again);
	g_assert_false(g_file_test(path, G_FILE_TEST_EXISTS));
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/product/round-trip", test_round_trip);
	g_test_add_func("/product/layout", test_layout);
	g_test_add_func("/product/wrong-file", test_wrong_file);
	g_test_add_func("/product/every-bit", test_every_bit);
	g_test_add_func("/product/every-length", test_every_length);
	g_test_add_func("/product/unfinished", test_unfinished);
	g_test_add_func("/product/full-disk", test_full_disk);
	return g_test_run();
}
