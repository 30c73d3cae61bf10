/* LAS into a site: every coordinate exact, every field where it belongs; a header that lies is refused with its place, and
 * the site is as it was. */
#include "tests/import-made.h"
#include "tests/support.h"
#include <unistd.h>

/* ---- files made here, by the layout of the standard ---- */

struct las_made {
	int minor, format, record_bytes; /* 0: as the format needs */
	uint32_t count;
	bool narrow; /* colours of 8 bit */
	double scale, offset_m[3];
	uint32_t extended_bytes; /* behind the points, as an extended record (1.4) */
};

static const int header_bytes[] = { 227, 227, 227, 235, 375 };
static const int format_bytes[] = { 20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67 };
static const int colour_at[] = { 0, 0, 20, 28, 0, 28, 0, 30, 30, 0, 30 };

static void put(GByteArray *b, size_t at, const void *value, size_t bytes)
{
	memcpy(b->data + at, value, bytes);
}
#define PUT(b, at, type, value) put(b, at, &(type){ value }, sizeof(type))

/* What point i has. */
static int32_t raw_of(uint32_t i, int axis)
{
	static const int32_t corners[] = { G_MININT32, G_MAXINT32, 0, -1, 1 };
	return i < 5 ? corners[(i + (uint32_t)axis) % 5] : (int32_t)((i * 2654435761u) >> axis);
}

static uint16_t colour_of(const struct las_made *d, uint32_t i, int c)
{
	return (uint16_t)((i * 31 + (uint32_t)c * 77) % (d->narrow ? 256 : 65536));
}

static bool is_withheld(uint32_t i)
{
	return i % 7 == 3;
}

static void put_point(GByteArray *b, size_t at, const struct las_made *d, uint32_t i)
{
	bool extended = d->format >= 6;
	for (int axis = 0; axis < 3; axis++)
		PUT(b, at + 4 * (size_t)axis, int32_t, raw_of(i, axis));
	PUT(b, at + 12, uint16_t, (uint16_t)(i * 13));
	b->data[at + 14] = (uint8_t)(extended ? 0xf0 | (1 + i % 15) : 0xb8 | (1 + i % 5));
	if (extended) {
		b->data[at + 15] = is_withheld(i) ? 4 : 8;
		b->data[at + 16] = (uint8_t)(i % 256);
	} else {
		b->data[at + 15] = (uint8_t)(i % 32 | (is_withheld(i) ? 0x80 : 0x20));
	}
	for (int c = 0; c < 3 && colour_at[d->format]; c++)
		PUT(b, at + (size_t)colour_at[d->format] + 2 * (size_t)c, uint16_t,
			colour_of(d, i, c));
}

static int record_bytes(const struct las_made *d)
{
	return d->record_bytes ? d->record_bytes : format_bytes[d->format];
}

static GByteArray *las_of(const struct las_made *d)
{
	size_t header = (size_t)header_bytes[d->minor],
	       first = header + 54; /* one variable record */
	size_t end = first + (size_t)d->count * (size_t)record_bytes(d);
	GByteArray *b = g_byte_array_new();
	g_byte_array_set_size(b, (guint)(end + d->extended_bytes));
	memset(b->data, 0, b->len);
	memcpy(b->data, "LASF", 4);
	b->data[24] = 1;
	b->data[25] = (uint8_t)d->minor;
	PUT(b, 94, uint16_t, (uint16_t)header);
	PUT(b, 96, uint32_t, (uint32_t)first);
	PUT(b, 100, uint32_t, 1);
	b->data[104] = (uint8_t)d->format;
	PUT(b, 105, uint16_t, (uint16_t)record_bytes(d));
	if (d->format < 6)
		PUT(b, 107, uint32_t, d->count);
	for (int axis = 0; axis < 3; axis++) {
		PUT(b, 131 + 8 * (size_t)axis, double, d->scale);
		PUT(b, 155 + 8 * (size_t)axis, double, d->offset_m[axis]);
	}
	if (d->minor == 4) {
		PUT(b, 247, uint64_t, d->count);
		PUT(b, 235, uint64_t, end);
		PUT(b, 243, uint32_t, d->extended_bytes > 0);
	}
	for (uint32_t i = 0; i < d->count; i++)
		put_point(b, first + (size_t)i * (size_t)record_bytes(d), d, i);
	return b;
}

/* ---- what must come out ---- */

static double wanted_m(const struct las_made *d, uint32_t i, int axis)
{
	volatile double product = raw_of(i, axis) * d->scale; /* not fused */
	return product + d->offset_m[axis];
}

static void assert_axis(
	const struct las_made *d, uint32_t i, int axis, double got_m, double origin_m)
{
	g_assert_cmpfloat(origin_m, ==, rint(origin_m));
	/* Exact where points are near the origin; some here are as far from it as 32 bits can be. */
	double largest_m = fmax(fabs(wanted_m(d, i, axis)), fabs(got_m));
	g_assert_cmpfloat(fabs(got_m + origin_m - wanted_m(d, i, axis)), <=, largest_m * 2.3e-16);
	g_assert_cmpfloat(
		rint((got_m + (origin_m - d->offset_m[axis])) / d->scale), ==, raw_of(i, axis));
}

static void assert_point(const struct las_made *d, uint32_t i, const struct point_record *r,
	const double origin_m[3])
{
	assert_axis(d, i, 0, r->x_m, origin_m[0]);
	assert_axis(d, i, 1, r->y_m, origin_m[1]);
	assert_axis(d, i, 2, r->z_m, origin_m[2]);
	g_assert_cmpuint(r->intensity, ==, (uint16_t)(i * 13));
	g_assert_cmpuint(r->classification, ==, i % (d->format >= 6 ? 256 : 32));
	g_assert_cmpuint(r->return_number, ==, 1 + i % (d->format >= 6 ? 15 : 5));
	g_assert_cmpuint(r->cell, ==, CELL_MEASURED);
	for (int c = 0; c < 3; c++) {
		double wanted =
			colour_at[d->format] ? colour_of(d, i, c) / (d->narrow ? 1 : 257.0) : 0;
		g_assert_cmpfloat(fabs(r->rgb[c] - wanted), <=, 0.5);
	}
}

static void get_origin(const struct place *at, uint32_t number, double ret[3])
{
	g_autoptr(manifest) m = place_manifest(at, number);
	JsonArray *array = json_node_get_array(manifest_get_node(m, "points.origin_m"));
	for (guint i = 0; i < 3; i++)
		ret[i] = json_array_get_double_element(array, i);
	manifest_assert_numbers(m, "given_pose.translation_m", ret[0], ret[1], ret[2]);
}

static void assert_imported(const struct las_made *d)
{
	struct place at = place_new();
	g_autoptr(GByteArray) bytes = las_of(d);
	g_autofree char *path = place_write(&at, "made.las", bytes->data, bytes->len);
	g_autoptr(GArray) scans = place_import(&at, path);
	g_autoptr(points) p = place_points(&at, 1);
	double origin_m[3];
	uint64_t k = 0;
	get_origin(&at, 1, origin_m);
	g_assert_cmpuint(p->columns, ==, 0);
	for (uint32_t i = 0; i < d->count; i++)
		if (!is_withheld(i))
			assert_point(d, i, &p->record[k++], origin_m);
	g_assert_cmpuint(k, ==, p->count);
	g_assert_cmpuint(g_array_index(scans, struct imported, 0).points, ==, k);
	g_assert_cmpuint(g_array_index(scans, struct imported, 0).left_out, ==, d->count - k);
	g_assert_cmpuint(
		p->have & POINTS_HAVE_COLOUR, ==, colour_at[d->format] ? POINTS_HAVE_COLOUR : 0);
	place_clear(&at);
}

static void test_formats(void)
{
	static const int formats[] = { 0, 1, 2, 3, 6, 7, 8 };
	for (size_t k = 0; k < G_N_ELEMENTS(formats); k++)
		for (int minor = formats[k] >= 6 ? 4 : 2; minor <= 4; minor++) {
			struct las_made d = { minor, formats[k], 0, 3000, false, 0.001,
				{ 650000, 6280000, -12 }, 0 };
			assert_imported(&d);
			d.narrow = true;
			d.record_bytes = format_bytes[d.format] + 5; /* bytes of somebody's own */
			d.extended_bytes = minor == 4 ? 500 : 0;
			assert_imported(&d);
		}
}

/* Scales and offsets that are no round numbers, and local coordinates. */
static void test_scales(void)
{
	static const struct las_made made[] = {
		{ 2, 3, 0, 3000, false, 0.0001, { 131999.984125, 549718.375, -0.3410000219345093 },
			0 },
		{ 2, 1, 0, 3000, false, 0.01, { 0, 0, 0 }, 0 },
		{ 4, 7, 0, 3000, false, 1e-7, { 0.1, 0.2, 0.3 }, 0 },
		{ 4, 6, 0, 3000, false, 1 / 3.0 * 1e-3, { 1e6 / 7, 4e6 / 7, 3 / 7.0 }, 0 },
	};
	for (size_t k = 0; k < G_N_ELEMENTS(made); k++)
		assert_imported(&made[k]);
}

/* More than a block of records. */
static void test_blocks(void)
{
	struct las_made d = { 2, 2, 0, 100000, true, 0.01, { 500000, 0, 0 }, 0 };
	assert_imported(&d);
}

/* ---- what is refused ---- */

struct change {
	const char *path;
	int minor, format;
	size_t at, bytes; /* of the value to put in; 8 with is_real: a double */
	uint64_t value;
	bool is_real;
	double real;
	int code;
	const char *words;
};
#define BAD  G_IO_ERROR_INVALID_DATA
#define NONE G_IO_ERROR_NOT_SUPPORTED
static const struct change changes[] = {
	{ "version-2", 2, 3, 24, 1, 2, .code = NONE, .words = "is LAS 2.2" },
	{ "version-1.5", 2, 3, 25, 1, 5, .code = NONE, .words = "is LAS 1.5" },
	{ "header-short", 4, 7, 94, 2, 227, .code = BAD, .words = "byte 94" },
	{ "header-0", 2, 3, 94, 2, 0, .code = BAD, .words = "byte 94" },
	{ "offset-in-header", 2, 3, 96, 4, 226, .code = BAD, .words = "byte 96" },
	{ "offset-beyond", 2, 3, 96, 4, 0xffffffff, .code = BAD, .words = "byte 96" },
	{ "offset-a-record-on", 2, 3, 96, 4, 227 + 54 + 34, .code = BAD,
		.words = "tells of 100 points" },
	{ "offset-a-record-back", 2, 3, 96, 4, 227 + 54 - 34, .code = BAD,
		.words = "room for 1 more" },
	{ "laz", 2, 3, 104, 1, 0x83, .code = NONE, .words = "is LAZ" },
	{ "laz-6", 4, 6, 104, 1, 0x86, .code = NONE, .words = "laszip" },
	{ "waveform-4", 3, 3, 104, 1, 4, .code = NONE, .words = "format 4, with waveforms" },
	{ "waveform-5", 3, 3, 104, 1, 5, .code = NONE, .words = "format 5, with waveforms" },
	{ "waveform-9", 4, 7, 104, 1, 9, .code = NONE, .words = "format 9, with waveforms" },
	{ "waveform-10", 4, 7, 104, 1, 10, .code = NONE, .words = "format 10, with waveforms" },
	{ "format-11", 4, 7, 104, 1, 11, .code = BAD, .words = "byte 104" },
	{ "record-0", 2, 3, 105, 2, 0, .code = BAD, .words = "byte 105" },
	{ "record-short", 2, 3, 105, 2, 33, .code = BAD, .words = "byte 105" },
	{ "record-long", 2, 3, 105, 2, 65535, .code = BAD, .words = "tells of 100 points" },
	{ "count-0", 2, 3, 107, 4, 0, .code = BAD, .words = "no points" },
	{ "count-1-more", 2, 3, 107, 4, 101, .code = BAD, .words = "tells of 101 points" },
	{ "count-1-less", 2, 3, 107, 4, 99, .code = BAD, .words = "room for 1 more" },
	{ "count-huge", 2, 3, 107, 4, 0xffffffff, .code = BAD,
		.words = "tells of 4294967295 points" },
	{ "count-64-overflow", 4, 7, 247, 8, UINT64_MAX, .code = BAD,
		.words = "18446744073709551615" },
	{ "count-64-wraps", 4, 7, 247, 8, (UINT64_C(1) << 62) + 100, .code = BAD,
		.words = "4611686018427388004" },
	{ "counts-differ", 4, 3, 107, 4, 99, .code = BAD, .words = "do not agree" },
	{ "scale-0", 2, 3, 131, 8, .is_real = true, .real = 0, .code = BAD, .words = "byte 131" },
	{ "scale-negative", 2, 3, 139, 8, .is_real = true, .real = -0.01, .code = BAD,
		.words = "byte 139" },
	{ "scale-nan", 2, 3, 147, 8, .is_real = true, .real = NAN, .code = BAD,
		.words = "byte 147" },
	{ "scale-infinite", 2, 3, 147, 8, .is_real = true, .real = INFINITY, .code = BAD,
		.words = "byte 147" },
	{ "scale-huge", 2, 3, 131, 8, .is_real = true, .real = 1e300, .code = BAD,
		.words = "too far" },
	{ "offset-nan", 2, 3, 155, 8, .is_real = true, .real = NAN, .code = BAD,
		.words = "byte 155" },
	{ "offset-huge", 2, 3, 171, 8, .is_real = true, .real = 1e300, .code = BAD,
		.words = "byte 171" },
	{ "extended-inside", 4, 7, 235, 8, 400, .code = BAD, .words = "beyond byte 400" },
};

static GByteArray *made_for(const struct change *c)
{
	struct las_made d = { c->minor, c->format, 0, 100, false, 0.001, { 500000, 4000000, 0 },
		c->minor == 4 ? 500 : 0 };
	return las_of(&d);
}

static void test_change(gconstpointer data)
{
	const struct change *c = data;
	struct place at = place_new();
	g_autoptr(GByteArray) bytes = made_for(c);
	g_autofree char *good = place_write(&at, "good.las", bytes->data, bytes->len);
	g_autoptr(GArray) scans = place_import(&at, good);
	put(bytes, c->at, c->is_real ? (const void *)&c->real : (const void *)&c->value, c->bytes);
	g_autofree char *path = place_write(&at, "bad.las", bytes->data, bytes->len);
	place_assert_refused(&at, path, c->code, c->words);
	place_clear(&at);
}

static void test_cut(void)
{
	struct las_made d = { 2, 3, 0, 40, false, 0.001, { 500000, 4000000, 0 }, 0 };
	struct place at = place_new();
	g_autoptr(GByteArray) bytes = las_of(&d);
	g_autofree char *path = place_write(&at, "cut.las", bytes->data, bytes->len);
	for (size_t cut = bytes->len - 1; cut > 0; cut--) { /* to write it anew would sync it */
		g_assert_cmpint(truncate(path, (off_t)cut), ==, 0);
		place_assert_refused(&at, path, G_IO_ERROR_INVALID_DATA, "");
	}
	place_clear(&at);
}

static void test_all_withheld(void)
{
	struct las_made d = { 2, 3, 0, 40, false, 0.001, { 0, 0, 0 }, 0 };
	struct place at = place_new();
	g_autoptr(GByteArray) bytes = las_of(&d);
	for (uint32_t i = 0; i < 40; i++)
		bytes->data[227 + 54 + i * 34 + 15] |= 0x80;
	g_autofree char *path = place_write(&at, "withheld.las", bytes->data, bytes->len);
	place_assert_refused(&at, path, G_IO_ERROR_INVALID_DATA, "withheld");
	place_clear(&at);
}

/* ---- real files ---- */

static const struct real {
	const char *path;
	uint64_t count;
	uint32_t classes[32];
	bool colour;
} reals[] = {
	{ "data/aerial-colour/autzen_trim.las", 110000, { 0 }, true },
	{ "data/aerial-town/ign-77050-627755.las", 84524,
		{ [2] = 21172, [3] = 226, [4] = 1227, [5] = 30392, [6] = 29447 }, false },
	{ "data/aerial-town/ign-77050-627760.las", 56035, { 0 }, false },
	{ "data/aerial-water/ahn3.las", 260807,
		{ [1] = 4434, [2] = 48804, [9] = 175418, [26] = 32151 }, false },
	{ "data/forest/lpine1-every-3rd.las", 514734, { 0 }, false },
};

static double real_at(const char *bytes, size_t at)
{
	double value;
	memcpy(&value, bytes + at, sizeof value);
	return value;
}

/* Every point: back on the file's own scale it is the number in the file, and plain arithmetic gives the same double. */
static void test_real(gconstpointer data)
{
	const struct real *real = data;
	const char *path = shared_path(real->path);
	if (!path)
		return g_test_skip("shared/data does not have it");
	struct place at = place_new();
	g_autoptr(GArray) scans = place_import(&at, path);
	g_autoptr(points) p = place_points(&at, 1);
	g_autofree char *bytes = NULL;
	uint32_t classes[256] = { 0 }, first;
	uint16_t length;
	double origin_m[3];
	g_assert_true(g_file_get_contents(path, &bytes, NULL, NULL));
	memcpy(&first, bytes + 96, 4);
	memcpy(&length, bytes + 105, 2);
	get_origin(&at, 1, origin_m);
	g_assert_cmpuint(p->count, ==, real->count);
	g_assert_cmpuint(p->have & POINTS_HAVE_COLOUR, ==, real->colour ? POINTS_HAVE_COLOUR : 0);
	for (uint64_t i = 0; i < p->count; i++) {
		const struct point_record *r = &p->record[i];
		const double got[3] = { r->x_m, r->y_m, r->z_m };
		int32_t raw[3];
		memcpy(raw, bytes + first + i * length, 12);
		for (size_t axis = 0; axis < 3; axis++) {
			double scale = real_at(bytes, 131 + 8 * axis),
			       offset_m = real_at(bytes, 155 + 8 * axis);
			volatile double product = raw[axis] * scale;
			g_assert_cmpfloat(got[axis] + origin_m[axis], ==, product + offset_m);
			g_assert_cmpfloat(rint((got[axis] + origin_m[axis] - offset_m) / scale), ==,
				raw[axis]);
		}
		classes[r->classification]++;
	}
	for (int k = 0; k < 32; k++)
		if (real->classes[k])
			g_assert_cmpuint(classes[k], ==, real->classes[k]);
	place_clear(&at);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/import-las/formats", test_formats);
	g_test_add_func("/import-las/scales", test_scales);
	g_test_add_func("/import-las/blocks", test_blocks);
	for (size_t i = 0; i < G_N_ELEMENTS(changes); i++) {
		g_autofree char *path = g_strconcat("/import-las/bad/", changes[i].path, NULL);
		g_test_add_data_func(path, &changes[i], test_change);
	}
	g_test_add_func("/import-las/cut", test_cut);
	g_test_add_func("/import-las/all-withheld", test_all_withheld);
	for (size_t i = 0; i < G_N_ELEMENTS(reals); i++)
		commands_add("/import-las/real", i, &reals[i], test_real);
	return g_test_run();
}
