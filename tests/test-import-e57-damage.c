/* E57 files that are cut short, have a bit wrong or lie: each is refused with its place, and the site is as it was; only a picture may
 * be lost alone. */
#include "tests/e57-taken.h"
#include <unistd.h>

static const struct made_field fields[] = { DOUBLES };

static union made_value point(gconstpointer data, uint64_t i, unsigned field)
{
	double at_m[3];
	(void)data;
	scene_point(i, at_m);
	return (union made_value)REAL(at_m[field]);
}

static const struct made_points hundred = { fields, 3, 100, .of = point, .packets = 3 };

/* The section at 48, its first packet at 80, a picture of 2500 bytes behind it. */
static GByteArray *whole_file(void)
{
	struct made m = made_begin();
	g_autofree char *bytes = g_strnfill(2500, 'j');
	unsigned section = made_vector(&m, &hundred);
	made_blob(&m, bytes, 2500);
	g_autofree char *scan = made_scan_xml(&hundred, section, NULL);
	return made_xml(&m, scan,
		"<vectorChild type=\"Structure\"><pinholeRepresentation><pngImage type=\"Blob\" "
		"fileOffset=\"%1\" length=\"2500\"/></pinholeRepresentation></vectorChild>");
}

/* ---- cut short ---- */

static void assert_cut(const struct place *at, const char *path, size_t length, const char *words)
{
	g_assert_cmpint(truncate(path, (off_t)length), ==, 0);
	place_assert_refused(at, path, G_IO_ERROR_INVALID_DATA, words);
}

static void assert_cuts(GByteArray *file, const char *words)
{
	struct place at = place_new();
	g_autofree char *path = place_write(&at, "cut.e57", file->data, file->len);
	for (size_t cut = file->len; cut-- > 0;)
		if (cut % 1024 == 0 || cut % 1024 == 1020 || cut % (file->len / 50) == 0 ||
			cut < 60)
			assert_cut(&at, path, cut, cut < 48 ? "" : words);
	g_byte_array_unref(file);
	place_clear(&at);
}

static void test_cut(void)
{
	assert_cuts(whole_file(), "is cut short: its header tells of 6144 bytes, and it has");
	/* Also where the header does not know how long it is. */
	GByteArray *file = whole_file();
	made_set(file->data + 16, 0, 8);
	made_seal(file);
	assert_cuts(file, "byte ");
}

/* ---- a bit ---- */

static void assert_flip(size_t page, size_t at, const char *words)
{
	GByteArray *file = whole_file();
	file->data[page * 1024 + at] ^= (uint8_t)(1 << page % 8);
	taken_assert_refused(file, G_IO_ERROR_INVALID_DATA, words);
}

/* What stands in the page, and the checksum itself. */
static void test_bits(void)
{
	g_autoptr(GByteArray) file = whole_file();
	for (size_t page = 0; page < file->len / 1024; page++) {
		g_autofree char *words = g_strdup_printf(
			"byte %zu: the page of 1024 bytes that begins here is damaged",
			page * 1024);
		if (memchr(file->data + page * 1024, 'j', 1020) && page > 2)
			continue; /* of the picture, which test_picture has */
		assert_flip(page, 100, words);
		assert_flip(page, 1019, words);
		assert_flip(page, 1020, words);
		assert_flip(page, 1023, words);
	}
}

/* A page that is only picture. */
static void test_picture(void)
{
	GByteArray *file = whole_file();
	size_t page = 0;
	while (file->data[page * 1024] != 'j' || file->data[page * 1024 + 1019] != 'j')
		page++;
	file->data[page * 1024 + 77] ^= 1;
	g_autofree char *words = g_strdup_printf("byte %zu: the page", page * 1024);
	struct taken t = taken_new(file);
	g_assert_cmpuint(t.p->count, ==, 100);
	taken_assert_note(&t, 0, "picture 1 was left out: ");
	taken_assert_note(&t, 0, words);
	taken_clear(&t);
}

/* ---- lies, with checksums that are right ---- */

struct patch {
	const char *path;
	size_t at;
	unsigned bytes;
	uint64_t value;
	const char *words; /* NULL: nothing is wrong with it */
	int code;          /* 0: invalid data */
};
static const struct patch patches[] = {
	{ "minor", 12, 4, 7, NULL, 0 },
	{ "length-less", 16, 8, 100, NULL, 0 },
	{ "index-offset", 72, 8, UINT64_MAX, NULL, 0 },
	{ "packet-flags", 81, 1, 255, NULL, 0 },
	{ "signature", 0, 1, 'a', "does not begin with ASTM-E57", 0 },
	{ "major", 8, 4, 2, "is E57 version 2; version 1 is read", G_IO_ERROR_NOT_SUPPORTED },
	{ "length", 16, 8, 6145, "is cut short: its header tells of 6145 bytes", 0 },
	{ "length-most", 16, 8, UINT64_MAX, "tells of 18446744073709551615 bytes", 0 },
	{ "xml-at-0", 24, 8, 0, "byte 9 of its XML is 0", 0 },
	{ "xml-at-end", 24, 8, 6144, "byte 24: its XML of ", 0 },
	{ "xml-at-most", 24, 8, UINT64_MAX, "cannot begin at byte 18446744073709551615", 0 },
	{ "xml-none", 32, 8, 0, "byte 32: an XML of 0 bytes cannot be", 0 },
	{ "xml-short", 32, 8, 300, "of its XML: ", 0 },
	{ "xml-long", 32, 8, 7000, "byte 24: its XML of 7000 bytes cannot begin", 0 },
	{ "xml-most", 32, 8, UINT64_MAX, "byte 32: an XML of 18446744073709551615 bytes", 0 },
	{ "pages", 40, 8, 512, "byte 40: pages of 512 bytes cannot be", 0 },
	{ "section-id", 48, 1, 0, "byte 48: there are no points here", 0 },
	{ "section-none", 56, 8, 0, "byte 48: points of 0 bytes", 0 },
	{ "section-short", 56, 8, 31, "byte 48: points of 31 bytes", 0 },
	{ "section-header", 56, 8, 32, "byte 48: 100 points cannot stand in 0 bytes", 0 },
	{ "section-less", 56, 8, 1666, "byte 48: 100 points cannot stand in 1634 bytes", 0 },
	{ "section-few", 56, 8, 2450, "a packet of kind 1 and 816 bytes cannot be here", 0 },
	{ "section-rest", 56, 8, 9000, "byte 48: points of 9000 bytes, and the file has", 0 },
	{ "section-most", 56, 8, UINT64_MAX, "byte 48: points of 18446744073709551615", 0 },
	{ "data-at-0", 64, 8, 0, "byte 48: its first points cannot begin at byte 0", 0 },
	{ "data-in-header", 64, 8, 79, "byte 48: its first points cannot begin at byte 79", 0 },
	{ "data-beyond", 64, 8, 8000, "byte 48: its first points cannot begin at byte 8000", 0 },
	{ "data-most", 64, 8, UINT64_MAX, "cannot begin at byte 18446744073709551615", 0 },
	{ "data-moved", 64, 8, 84, "byte 84: ", 0 },
	{ "packet-kind", 80, 1, 3, "byte 80: a packet of kind 3 and ", 0 },
	{ "packet-empty", 80, 1, 2, "the points end here, after 66 of 100", 0 },
	{ "packet-index", 80, 1, 0, "the points end here, after 66 of 100", 0 },
	{ "packet-short", 82, 2, 3, "byte 80: a packet of kind 1 and 4 bytes cannot be here", 0 },
	{ "packet-head", 82, 2, 7, "byte 80: a packet of 3 streams, and the points have 3", 0 },
	{ "packet-less", 82, 2, 99, "byte 80: the streams of a packet are longer than it is, 100",
		0 },
	{ "packet-most", 82, 2, 65535, "a packet of kind 1 and 65536 bytes cannot be here", 0 },
	{ "streams-none", 84, 2, 0, "byte 80: a packet of 0 streams", 0 },
	{ "streams-more", 84, 2, 4, "byte 80: a packet of 4 streams", 0 },
	{ "streams-most", 84, 2, 65535, "byte 80: a packet of 65535 streams", 0 },
	{ "stream-most", 86, 2, 65535, "byte 80: the streams of a packet are longer", 0 },
	{ "stream-none", 86, 2, 0, "the points end here, after 66 of 100", 0 },
};

static void test_patch(gconstpointer data)
{
	const struct patch *p = data;
	GByteArray *file = whole_file();
	made_set(file->data + p->at, p->value, p->bytes);
	made_seal(file);
	if (p->words)
		return taken_assert_refused(
			file, p->code ? p->code : G_IO_ERROR_INVALID_DATA, p->words);
	struct taken t = taken_new(file);
	g_assert_cmpuint(t.p->count, ==, 100);
	taken_clear(&t);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/import-e57-damage/cut", test_cut);
	g_test_add_func("/import-e57-damage/bits", test_bits);
	g_test_add_func("/import-e57-damage/picture", test_picture);
	for (size_t i = 0; i < G_N_ELEMENTS(patches); i++) {
		g_autofree char *path =
			g_strconcat("/import-e57-damage/lie/", patches[i].path, NULL);
		g_test_add_data_func(path, &patches[i], test_patch);
	}
	return g_test_run();
}
