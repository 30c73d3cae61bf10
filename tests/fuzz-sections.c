/* Any sections, sound as a file, as the features or the segments of a scan: what is accepted has all its arrays, each as long as the
 * others, and can be read to the end. The first byte of the input tells what it is, 'f' or 's'; then three for each section: which
 * name, how long an element is, how many there are. */
#include "firmware-io/crc32c.h"
#include "firmware-io/files.h"
#include "process/scan-features.h"
#include "process/scan-segments.h"
#include <glib/gstdio.h>
#include <json-glib/json-glib.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static const char *const names[] = { "degree", "kind", "flags", "direction", "line_error", "k1",
	"k2", "principal", "automatic", "leaf", "other" };

/* A site's folder, made once. */
static char *folder;
static site *place;

static void clear(void)
{
	site_free(place);
	files_remove_tree(folder, NULL);
	g_free(folder);
}

static void make_site(void)
{
	g_autoptr(GError) error = NULL;
	folder = g_strdup_printf("%s/fuzz-sections.%d", g_get_tmp_dir(), getpid());
	atexit(clear);
	place = site_open_for_writing(folder, &error);
	g_assert_no_error(error);
	for (int k = 0; k < 2; k++) {
		g_autofree char *inside =
			g_build_filename(folder, k ? "features" : "segments", NULL);
		g_assert_cmpint(g_mkdir_with_parents(inside, 0700), ==, 0);
	}
}

/* false: not a file that one can write. */
static bool write_sections(const char *path, const char *kind, int version, const uint8_t *data,
	size_t size, GError **error)
{
	static const uint8_t bytes[255 * 16];
	g_autoptr(product_writer) w = product_writer_new(path, error);
	uint32_t written = 0;
	g_assert_nonnull(w);
	for (size_t i = 0; i + 3 <= size; i += 3) {
		const unsigned name = data[i] % G_N_ELEMENTS(names);
		if (written >> name & 1) /* a file has each once */
			continue;
		written |= 1u << name;
		if (!product_writer_begin(w, names[name], 1 + data[i + 1] % 16, error) ||
			!product_writer_append(w, bytes, data[i + 2], error))
			return false;
	}
	return product_writer_finish(w, kind, version, json_object_new(), error);
}

static uint32_t read_features(const scan_features *f)
{
	const uint64_t n = f->count;
	uint32_t sum = crc32c(0, f->degree, n);
	sum = crc32c(sum, f->kind, n);
	sum = crc32c(sum, f->flags, n);
	sum = crc32c(sum, f->direction, n * sizeof *f->direction);
	sum = crc32c(sum, f->principal, n * sizeof *f->principal);
	sum = crc32c(sum, f->line_error, n * sizeof *f->line_error);
	sum = crc32c(sum, f->k1, n * sizeof *f->k1);
	return crc32c(sum, f->k2, n * sizeof *f->k2);
}

static void check_features(void)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(scan_features) f = scan_features_open(place, 1, &error);
	g_assert_true((f == NULL) == (error != NULL));
	if (f)
		read_features(f);
}

static void check_segments(void)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(scan_segments) s = scan_segments_open(place, 1, &error);
	g_assert_true((s == NULL) == (error != NULL));
	if (!s)
		return;
	g_assert_cmpuint(scan_segments_checksum(s->automatic, s->count), ==,
		scan_segments_automatic_checksum(s));
	g_assert_cmpuint(
		scan_segments_checksum(s->leaf, s->count), ==, scan_segments_leaf_checksum(s));
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	g_autoptr(GError) error = NULL;
	if (!place)
		make_site();
	if (!size)
		return 0;
	const bool is_features = *data == 'f';
	g_autofree char *path = g_build_filename(folder, is_features ? "features" : "segments",
		is_features ? "0001.features" : "0001.segments", NULL);
	if (!write_sections(path, is_features ? SCAN_FEATURES_KIND : SCAN_SEGMENTS_KIND,
		    is_features ? SCAN_FEATURES_VERSION : SCAN_SEGMENTS_VERSION, data + 1, size - 1,
		    &error))
		return 0;
	if (is_features)
		check_features();
	else
		check_segments();
	return 0;
}
