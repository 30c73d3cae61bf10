/* PCD into a site: every number where it belongs, from every kind of body; headers that lie are refused with their place, and
 * the site is as it was. */
#include "tests/import-made.h"
#include "tests/support.h"
#include <string.h>

struct pcd_made {
	const char *data, *version;
	bool doubles, comments;
	uint32_t width, height;
	const char *viewpoint;
};

static void point_of(const struct pcd_made *d, uint32_t i, double ret[3])
{
	uint32_t c = i % d->width, r = i / d->width;
	ret[0] = c * 0.0078125 - 1.5 + (d->doubles ? 1e-12 : 0);
	ret[1] = r * 0.015625 - 3 + (d->doubles ? 512345.0 : 0);
	ret[2] = 2 + (c * r % 7) * 0.25;
}

static const char *const fields = "FIELDS x y z rgb intensity label _ normal\n";

static GString *header_of(const struct pcd_made *d)
{
	GString *s = g_string_new(d->comments ? "# .PCD file\n# made\n" : "");
	int bytes = d->doubles ? 8 : 4;
	g_string_append_printf(s, "VERSION %s\n%s", d->version, fields);
	g_string_append_printf(
		s, "SIZE %d %d %d 4 2 1 1 4\nTYPE F F F U U U U F\n", bytes, bytes, bytes);
	g_string_append_printf(s,
		"COUNT 1 1 1 1 1 1 3 3\nWIDTH %u\nHEIGHT %u\n%s%s%sPOINTS %u\nDATA %s\n", d->width,
		d->height, d->viewpoint ? "VIEWPOINT " : "", d->viewpoint ? d->viewpoint : "",
		d->viewpoint ? "\n" : "", d->width * d->height, d->data);
	return s;
}

static void append_point(GByteArray *into, const struct pcd_made *d, uint32_t i, int field)
{
	double p[3];
	point_of(d, i, p);
	float f[3] = { (float)p[0], (float)p[1], (float)p[2] }, normal[3] = { 0, 0, 1 };
	uint32_t rgb = 0x102030 + i % 200;
	uint16_t intensity = (uint16_t)(i % 1000);
	uint8_t label = (uint8_t)(i % 20), pad[3] = { 1, 2, 3 };
	if (field < 3)
		g_byte_array_append(into, d->doubles ? (void *)&p[field] : (void *)&f[field],
			d->doubles ? 8 : 4);
	if (field == 3)
		g_byte_array_append(into, (void *)&rgb, 4);
	if (field == 4)
		g_byte_array_append(into, (void *)&intensity, 2);
	if (field == 5)
		g_byte_array_append(into, &label, 1);
	if (field == 6)
		g_byte_array_append(into, pad, 3);
	if (field == 7)
		g_byte_array_append(into, (void *)normal, 12);
}

/* LZF of literals alone: as good as any to read. */
static void append_packed(GByteArray *into, const GByteArray *planes)
{
	g_autoptr(GByteArray) packed = g_byte_array_new();
	for (guint at = 0; at < planes->len; at += 32) {
		guint literals = MIN(planes->len - at, 32);
		uint8_t control = (uint8_t)(literals - 1);
		g_byte_array_append(packed, &control, 1);
		g_byte_array_append(packed, planes->data + at, literals);
	}
	uint32_t lengths[2] = { packed->len, planes->len };
	g_byte_array_append(into, (void *)lengths, sizeof lengths);
	g_byte_array_append(into, packed->data, packed->len);
}

static void append_text(GByteArray *into, const struct pcd_made *d, uint32_t i)
{
	double p[3];
	point_of(d, i, p);
	g_autofree char *line = g_strdup_printf("%.17g %.17g %.17g %u %u %u 1 2 3 0 nan 1\n", p[0],
		p[1], p[2], 0x102030 + i % 200, i % 1000, i % 20);
	g_byte_array_append(into, (void *)line, (guint)strlen(line));
}

static GByteArray *pcd_of(const struct pcd_made *d)
{
	g_autoptr(GString) header = header_of(d);
	GByteArray *b = g_byte_array_new();
	uint32_t count = d->width * d->height;
	g_byte_array_append(b, (void *)header->str, (guint)header->len);
	g_autoptr(GByteArray) planes = g_byte_array_new();
	for (int field = 0; field < 8; field++)
		for (uint32_t i = 0; i < count; i++)
			append_point(planes, d, i, field);
	for (uint32_t i = 0; i < count; i++)
		for (int field = 0; field < 8 && !strcmp(d->data, "binary"); field++)
			append_point(b, d, i, field);
	for (uint32_t i = 0; i < count && !strcmp(d->data, "ascii"); i++)
		append_text(b, d, i);
	if (!strcmp(d->data, "binary_compressed"))
		append_packed(b, planes);
	return b;
}

static void check_point(const struct pcd_made *d, uint32_t i, const struct point_record *r,
	const double origin_m[3])
{
	double p[3], got[3] = { r->x_m, r->y_m, r->z_m };
	point_of(d, i, p);
	for (int k = 0; k < 3; k++)
		g_assert_cmpfloat(got[k] + origin_m[k], ==, d->doubles ? p[k] : (float)p[k]);
	uint32_t rgb = 0x102030 + i % 200;
	g_assert_cmpuint(r->rgb[0], ==, rgb >> 16);
	g_assert_cmpuint(r->rgb[1], ==, rgb >> 8 & 255);
	g_assert_cmpuint(r->rgb[2], ==, rgb & 255);
	g_assert_cmpuint(r->intensity, ==, i % 1000);
	g_assert_cmpuint(r->classification, ==, i % 20);
}

static void import_made(const struct pcd_made *d)
{
	struct place at = place_new();
	g_autoptr(GByteArray) b = pcd_of(d);
	g_autofree char *path = place_write(&at, "made.pcd", b->data, b->len);
	g_autoptr(GArray) scans = place_import(&at, path);
	g_assert_cmpuint(scans->len, ==, 1);
	g_autoptr(GError) error = NULL;
	g_autoptr(scan_data) s = scan_data_load(at.site, 1, &error);
	g_assert_no_error(error);
	g_assert_cmpint(s->kind, ==, SCAN_CLOUD);
	g_assert_cmpuint(s->points->count, ==, d->width * d->height);
	g_assert_cmpuint(s->points->have, ==,
		POINTS_HAVE_COLOUR | POINTS_HAVE_INTENSITY | POINTS_HAVE_CLASSIFICATION);
	g_autoptr(manifest) m = place_manifest(&at, 1);
	JsonArray *array = json_node_get_array(manifest_get_node(m, "points.origin_m"));
	double origin_m[3];
	for (guint k = 0; k < 3; k++)
		origin_m[k] = json_array_get_double_element(array, k);
	for (uint32_t i = 0; i < d->width * d->height; i++)
		check_point(d, i, &s->points->record[i], origin_m);
	place_clear(&at);
}

static void test_bodies(void)
{
	static const char *const bodies[] = { "ascii", "binary", "binary_compressed" };
	for (size_t i = 0; i < G_N_ELEMENTS(bodies); i++)
		for (int doubles = 0; doubles < 2; doubles++) {
			struct pcd_made d = { bodies[i], i ? "0.7" : ".7", doubles, i == 1, 1700, 1,
				"0 0 0 1 0 0 0" };
			import_made(&d);
		}
}

/* ---- a grid of a camera ---- */

static void test_camera(void)
{
	struct place at = place_new();
	g_autoptr(GByteArray) b = g_byte_array_new();
	static const char header[] =
		"VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n"
		"WIDTH 64\nHEIGHT 48\nVIEWPOINT 10 20 30 1 0 0 0\nPOINTS 3072\n"
		"DATA binary\n";
	g_byte_array_append(b, (void *)header, sizeof header - 1);
	for (int i = 0; i < 3072; i++) {
		float x = (float)(i % 64 - 32) / 60, y = (float)(i / 64 - 24) / 60, z = 2;
		float p[3] = { x * z, y * z, z };
		if (i % 50 == 7)
			p[0] = p[1] = p[2] = NAN;
		g_byte_array_append(b, (void *)p, sizeof p);
	}
	g_autofree char *path = place_write(&at, "camera.pcd", b->data, b->len);
	g_autoptr(GArray) scans = place_import(&at, path);
	g_autoptr(GError) error = NULL;
	g_autoptr(scan_data) s = scan_data_load(at.site, 1, &error);
	g_assert_no_error(error);
	g_assert_cmpint(s->kind, ==, SCAN_ORDERED);
	g_assert_cmpuint(s->points->columns, ==, 64);
	g_assert_cmpuint(s->points->rows, ==, 48);
	for (int i = 0; i < 3072; i++) {
		const struct point_record *r = &s->points->record[i];
		g_assert_cmpuint(r->cell == CELL_MEASURED, ==, i % 50 != 7);
		if (i % 50 == 7)
			continue;
		g_assert_cmpfloat(r->x_m, ==, (float)(i % 64 - 32) / 60 * 2);    /* right */
		g_assert_cmpfloat(r->y_m, ==, 2);                                /* forward */
		g_assert_cmpfloat(r->z_m, ==, -((float)(i / 64 - 24) / 60 * 2)); /* up */
	}
	g_autoptr(manifest) m = place_manifest(&at, 1);
	g_assert_nonnull(strstr(manifest_get_string(m, "source.note", NULL), "camera"));
	/* From the turned frame to where the sensor stood: up is the file's -y. */
	double up[3] = { 0, 0, 1 }, there[3];
	g_assert_true(s->has_given_pose);
	pose_rotate(&s->given_pose, up, there);
	g_assert_cmpfloat(fabs(there[1] + 1), <, 1e-12);
	manifest_assert_numbers(m, "given_pose.translation_m", 10, 20, 30);
	place_clear(&at);
}

static void test_office(void)
{
	const char *path = shared_path("data/office/office1.pcd");
	if (!path) {
		g_test_skip("no office beside the checkout");
		return;
	}
	struct place at = place_new();
	g_autoptr(GArray) scans = place_import(&at, path);
	g_autoptr(GError) error = NULL;
	g_autoptr(scan_data) s = scan_data_load(at.site, 1, &error);
	g_assert_no_error(error);
	g_assert_cmpint(s->kind, ==, SCAN_ORDERED);
	g_assert_cmpuint(range_grid_count(s->grid), ==, 254456);
	g_assert_cmpuint(s->grid->columns, ==, 640);
	g_assert_nonnull(s->grid->rgb);
	g_assert_false(s->has_given_pose);
	place_clear(&at);
}

/* ---- refused ---- */

#define GOOD "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2\nHEIGHT 1\n"

static const struct {
	const char *text, *words;
} bad[] = {
	{ GOOD "POINTS 2\nDATA ascii\n1 2 3\n", "its header tells of 2 points" },
	{ GOOD "POINTS 2\nDATA ascii\n1 2 3\n4 5         \n", "line 11: has too few numbers" },
	{ GOOD "POINTS 2\nDATA ascii\n1 2 3 4\n4 5 6\n", "line 10: has too many numbers" },
	{ GOOD "POINTS 2\nDATA ascii\n1 2 3\n4 five 6\n", "line 11: 'five 6" },
	{ GOOD "POINTS 2\nDATA ascii\n1 2 3\n4 5 6\n7 8 9\n", "line 12: here the file should end" },
	{ GOOD "POINTS 2\nDATA ascii\nnan nan nan\n0 0 0\n", "none of its points" },
	{ GOOD "POINTS 2\nDATA ascii\n1e300 2 3\n4 5 6\n", "too far" },
	{ GOOD "POINTS 3\nDATA ascii\n1 2 3\n4 5 6\n", "line 8: POINTS is 3" },
	{ GOOD "POINTS 2\nDATA binary\n1 2 3\n", "24 bytes of points, and 6" },
	{ GOOD "POINTS 2\nDATA zip\n1 2 3\n", "line 9: DATA 'zip'" },
	{ GOOD "WIDTH 2\nPOINTS 2\nDATA ascii\n", "line 8: there is a second WIDTH" },
	{ GOOD "POINTS 2\nVIEWPOINT 0 0 0 0 0 0 0\nDATA ascii\n1 2 3\n4 5 6\n", "quaternion" },
	{ GOOD "POINTS 2\nVIEWPOINT 0 0 0 1\nDATA ascii\n1 2 3\n4 5 6\n",
		"line 9: VIEWPOINT has 4" },
	{ GOOD "POINTS 2\n", "line 9: the header has no end" },
	{ "VERSION .7\nFIELDS x y z\nSIZE 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2\nHEIGHT 1\nDATA "
	  "ascii\n",
		"line 3: SIZE has 2" },
	{ "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F X\nWIDTH 2\nHEIGHT 1\nDATA ascii\n",
		"line 4: there are no numbers of TYPE X" },
	{ "VERSION .7\nFIELDS x y z\nCOUNT 1 1 0\nWIDTH 2\nHEIGHT 1\nDATA ascii\n",
		"line 3: COUNT '0'" },
	{ "VERSION .7\nFIELDS x y z\nCOUNT 1 1 60000\nWIDTH 2\nHEIGHT 1\nDATA ascii\n",
		"line 2: a point has" },
	{ "VERSION .7\nFIELDS x y\nWIDTH 1\nHEIGHT 1\nDATA ascii\n1 2\n", "no x, y and z" },
	{ "VERSION .7\nFIELDS x y z x\nWIDTH 1\nHEIGHT 1\nDATA ascii\n1 2 3 4\n", "two columns" },
	{ "VERSION .7\nFIELDS x y z\nWIDTH 0\nHEIGHT 1\nDATA ascii\n1 2 3\n", "line 3: WIDTH '0'" },
	{ "VERSION .7\nFIELDS x y z\nWIDTH 2000000000\nHEIGHT 2000000000\nDATA binary\n1 2 3\n",
		"more than are read" },
	{ "VERSION .7\nFIELDS x y z\nWIDTH 2147483647\nHEIGHT 1\nDATA binary\n1 2 3\n",
		"bytes of points" },
	{ "VERSION .7\nFIELDS x y z\nWIDTH 1\nHEIGHT 1\nDATA binary_compressed\n\x0c",
		"cut short" },
	{ "VERSION .7\nFIELDS x y z\nWIDTH 1\nHEIGHT 1\nDATA binary_compressed\nAAAAAAAAAAAA",
		"compressed bytes" },
	{ "VERSION .7\nFIELDS x y z\nPLANET 4\nDATA ascii\n", "line 3: 'PLANET'" },
};

static void test_refused(void)
{
	struct place at = place_new();
	for (size_t i = 0; i < G_N_ELEMENTS(bad); i++) {
		g_autofree char *path =
			place_write(&at, "bad.pcd", bad[i].text, strlen(bad[i].text));
		g_test_message("%s", bad[i].words);
		place_assert_refused(&at, path, G_IO_ERROR_INVALID_DATA, bad[i].words);
	}
	place_clear(&at);
}

/* What PCL's unpacking meets: references to before the beginning, runs beyond the end. */
static void test_damaged_compression(void)
{
	struct place at = place_new();
	static const uint8_t bodies[][12] = { { 0xff, 0xff, 0xff, 0xff }, { 31, 1, 2, 3 },
		{ 0, 7, 0xe0, 0xff, 0xff }, { 0xe0, 0, 0 } };
	for (size_t i = 0; i < G_N_ELEMENTS(bodies); i++) {
		g_autoptr(GByteArray) b = g_byte_array_new();
		static const char header[] =
			"VERSION .7\nFIELDS x y z\nWIDTH 1\nHEIGHT 1\nPOINTS 1\n"
			"DATA binary_compressed\n";
		uint32_t lengths[2] = { 5, 12 };
		g_byte_array_append(b, (void *)header, sizeof header - 1);
		g_byte_array_append(b, (void *)lengths, sizeof lengths);
		g_byte_array_append(b, bodies[i], 5);
		g_autofree char *path = place_write(&at, "bad.pcd", b->data, b->len);
		place_assert_refused(&at, path, G_IO_ERROR_INVALID_DATA, "");
	}
	place_clear(&at);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/import-pcd/bodies", test_bodies);
	g_test_add_func("/import-pcd/camera", test_camera);
	g_test_add_func("/import-pcd/office", test_office);
	g_test_add_func("/import-pcd/refused", test_refused);
	g_test_add_func("/import-pcd/damaged-compression", test_damaged_compression);
	return g_test_run();
}
