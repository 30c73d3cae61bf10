/* PLY into a site: text and binary of both byte orders, any order and type of properties, lists, grids; headers that lie are
 * refused with their place, and the site is as it was. */
#include "tests/import-made.h"
#include "tests/support.h"
#include <string.h>

#define POINTS 500

/* Numbers that any type here can hold, but for x, y and z. */
static double number_of(const char *name, uint32_t i)
{
	if (!strcmp(name, "x"))
		return i * 0.125 + 1;
	if (!strcmp(name, "y"))
		return i * -0.25;
	if (!strcmp(name, "z"))
		return 3 + i % 8 * 0.5;
	if (!strcmp(name, "label"))
		return i % 20;
	return i % 100;
}

static void append_number(GByteArray *b, const char *type, double value, bool big)
{
	uint8_t bytes[8];
	size_t n = 0;
#define AS(name, c_type)                                                                           \
	if (!strcmp(type, name)) {                                                                 \
		c_type v = (c_type)value;                                                          \
		memcpy(bytes, &v, n = sizeof v);                                                   \
	}
	AS("char", int8_t)
	AS("uchar", uint8_t)
	AS("int16", int16_t)
	AS("ushort", uint16_t)
	AS("int", int32_t)
	AS("uint32", uint32_t)
	AS("float", float)
	AS("double", double)
#undef AS
	g_assert_cmpuint(n, >, 0);
	for (size_t i = 0; big && i < n / 2; i++) {
		uint8_t t = bytes[i];
		bytes[i] = bytes[n - 1 - i];
		bytes[n - 1 - i] = t;
	}
	g_byte_array_append(b, bytes, (guint)n);
}

static void append_value(
	GByteArray *b, const char *format, const char *type, double value, bool last)
{
	if (strcmp(format, "ascii"))
		return append_number(b, type, value, !strcmp(format, "binary_big_endian"));
	g_autofree char *text = g_strdup_printf("%.17g%s", value, last ? "\n" : " ");
	g_byte_array_append(b, (void *)text, (guint)strlen(text));
}

/* properties: "TYPE NAME, TYPE NAME"; "list" as a type has two items of short behind a length of 8 bit. */
static GByteArray *ply_of(const char *format, const char *properties, bool faces)
{
	g_auto(GStrv) all = g_strsplit(properties, ", ", -1);
	g_autoptr(GString) h = g_string_new("ply\n");
	g_string_append_printf(h, "format %s 1.0\ncomment made here\n", format);
	if (faces)
		g_string_append(h, "element before 2\nproperty list uchar int stuff\n");
	g_string_append_printf(h, "element vertex %d\n", POINTS);
	for (char **p = all; *p; p++)
		g_string_append_printf(h, "property %s%s\n",
			g_str_has_prefix(*p, "list ") ? "list uchar int16 " : "",
			*p + (g_str_has_prefix(*p, "list ") ? 5 : 0));
	if (faces)
		g_string_append(h, "element face 1\nproperty list uchar uint32 vertex_indices\n");
	g_string_append(h, "end_header\n");
	GByteArray *b = g_byte_array_new();
	g_byte_array_append(b, (void *)h->str, (guint)h->len);
	for (int i = 0; i < 2 && faces; i++) {
		append_value(b, format, "uchar", i, i == 0);
		if (i)
			append_value(b, format, "int", -7, true);
	}
	for (uint32_t i = 0; i < POINTS; i++)
		for (char **p = all; *p; p++) {
			g_auto(GStrv) words = g_strsplit(*p, " ", 2);
			bool list = !strcmp(words[0], "list");
			for (int k = 0; k < (list ? 3 : 1); k++)
				append_value(b, format,
					!list    ? words[0]
					: k == 0 ? "uchar"
						 : "int16",
					list && k == 0 ? 2 : number_of(words[1], i),
					!p[1] && k == (list ? 2 : 0));
		}
	for (int k = 0; k < 4 && faces; k++)
		append_value(b, format, k ? "uint32" : "uchar", k ? k : 3, k == 3);
	return b;
}

static scan_data *import_bytes(struct place *at, const void *bytes, size_t length)
{
	*at = place_new();
	g_autofree char *path = place_write(at, "made.ply", bytes, length);
	g_autoptr(GArray) scans = place_import(at, path);
	g_assert_cmpuint(scans->len, ==, 1);
	g_autoptr(GError) error = NULL;
	scan_data *s = scan_data_load(at->site, 1, &error);
	g_assert_no_error(error);
	return s;
}

static const char *const sets[] = {
	"double x, double y, double z",
	"float x, float y, float z, uchar red, uchar green, uchar blue, uchar intensity",
	/* what PCL's own reader of clouds cannot bear */
	"uchar blue, double z, int16 odd, uchar green, float y, uchar alpha, uchar red, list some, "
	"double x, int label",
	"uint32 x_, char y_, float x, float y, float z, ushort intensity, float "
	"scalar_Classification",
};

static void check_set(const scan_data *s, const char *set)
{
	bool colour = strstr(set, "red"), intensity = strstr(set, "intensity"),
	     classes = strstr(set, "label") || strstr(set, "Classification");
	g_assert_cmpuint(s->points->count, ==, POINTS);
	g_assert_cmpuint(s->points->have, ==,
		(colour ? POINTS_HAVE_COLOUR : 0) | (intensity ? POINTS_HAVE_INTENSITY : 0) |
			(classes ? POINTS_HAVE_CLASSIFICATION : 0));
	for (uint32_t i = 0; i < POINTS; i++) {
		const struct point_record *r = &s->points->record[i];
		g_assert_cmpfloat(r->x_m, ==, number_of("x", i));
		g_assert_cmpfloat(r->y_m, ==, number_of("y", i));
		g_assert_cmpfloat(r->z_m, ==, number_of("z", i));
		for (int k = 0; k < 3; k++)
			g_assert_cmpuint(r->rgb[k], ==, colour ? i % 100 : 0);
		g_assert_cmpuint(r->intensity, ==, intensity ? i % 100 * 257 : 0);
		g_assert_cmpuint(r->classification, ==,
			strstr(set, "label") ? i % 20
			: classes            ? i % 100
					     : 0);
	}
}

static void test_properties(void)
{
	static const char *const formats[] = { "ascii", "binary_little_endian",
		"binary_big_endian" };
	for (size_t f = 0; f < G_N_ELEMENTS(formats); f++)
		for (size_t i = 0; i < G_N_ELEMENTS(sets); i++) {
			struct place at;
			g_autoptr(GByteArray) b = ply_of(formats[f], sets[i], i % 2);
			g_test_message("%s: %s", formats[f], sets[i]);
			g_autoptr(scan_data) s = import_bytes(&at, b->data, b->len);
			check_set(s, sets[i]);
			place_clear(&at);
		}
}

/* ---- intensity, colour, maps ---- */

static void check_intensity(const char *type, const char *low, const char *high,
	uint16_t wanted_low, uint16_t wanted_high)
{
	struct place at;
	g_autofree char *text =
		g_strdup_printf("ply\nformat ascii 1.0\nelement vertex 2\n"
				"property float x\nproperty float y\nproperty float z\n"
				"property %s intensity\nend_header\n1 2 3 %s\n4 5 6 %s\n",
			type, low, high);
	g_autoptr(scan_data) s = import_bytes(&at, text, strlen(text));
	g_assert_cmpuint(s->points->record[0].intensity, ==, wanted_low);
	g_assert_cmpuint(s->points->record[1].intensity, ==, wanted_high);
	place_clear(&at);
}

static void test_intensity(void)
{
	check_intensity("float", "0.5", "1", 32768, 65535);
	check_intensity("float", "51", "255", 13107, 65535);
	check_intensity("float", "1000", "65535", 1000, 65535);
	check_intensity("float", "-20", "10", 0, 65535);
	check_intensity("float", "0", "100000", 0, 65535);
	check_intensity("uchar", "0", "1", 0, 257);
	check_intensity("float", "nan", "1", 0, 65535);
	check_intensity("float", "0", "0", 0, 0);
}

static void test_map(void)
{
	struct place at;
	static const char text[] =
		"ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\n"
		"property double z\nproperty float red\nproperty float green\nproperty float blue\n"
		"end_header\n512345.678 5412345.125 432.1 1 0.5 0\nnan 1 2 0 0 0\n"
		"512346.25 5412345.5 433 0 0 1\n";
	g_autoptr(scan_data) s = import_bytes(&at, text, sizeof text - 1);
	g_assert_cmpuint(s->points->count, ==, 2);
	const struct point_record *r = s->points->record;
	g_assert_cmpfloat(r[0].x_m + 512346, ==, 512345.678);
	g_assert_cmpfloat(r[0].y_m, ==, 0.125);
	g_assert_cmpfloat(r[1].x_m, ==, 0.25);
	g_assert_cmpuint(r[0].rgb[0], ==, 255);
	g_assert_cmpuint(r[0].rgb[1], ==, 128);
	g_assert_cmpuint(r[1].rgb[2], ==, 255);
	g_autoptr(manifest) m = place_manifest(&at, 1);
	manifest_assert_numbers(m, "points.origin_m", 512346, 5412345, 0);
	place_clear(&at);
}

/* ---- grids ---- */

/* A wall seen from the origin: 30 columns clockwise, 20 rows from the top. */
static void wall(GString *s, int i)
{
	double a = (i % 30 - 15) * 0.02, e = (10 - i / 30) * 0.02;
	g_string_append_printf(s, "%.9f %.9f %.9f\n", 5 * tan(a), 5.0, 5 / cos(a) * tan(e));
}

static void check_wall(const char *text, size_t length, int missing)
{
	struct place at;
	g_autoptr(scan_data) s = import_bytes(&at, text, length);
	g_assert_cmpint(s->kind, ==, SCAN_ORDERED);
	g_assert_cmpuint(s->points->columns, ==, 30);
	g_assert_cmpuint(s->points->rows, ==, 20);
	for (int i = 0; i < 600; i++) {
		const struct point_record *r = &s->points->record[i];
		bool gone = missing && i % missing == 3;
		g_assert_cmpuint(r->cell == CELL_MEASURED, ==, !gone);
		if (!gone)
			g_assert_cmpfloat(fabs(r->x_m - 5 * tan((i % 30 - 15) * 0.02)), <, 1e-8);
	}
	place_clear(&at);
}

#define XYZ "property double x\nproperty double y\nproperty double z\n"

static void test_grid(void)
{
	g_autoptr(GString) s =
		g_string_new("ply\nformat ascii 1.0\nobj_info num_cols 30\n"
			     "obj_info num_rows 20\nelement vertex 600\n" XYZ "end_header\n");
	for (int i = 0; i < 600; i++)
		if (i % 11 == 3)
			g_string_append(s, "0 0 0\n");
		else
			wall(s, i);
	check_wall(s->str, s->len, 11);
}

static void test_range_grid(void)
{
	g_autoptr(GString) s = g_string_new(NULL), cells = g_string_new(NULL);
	int there = 0;
	for (int i = 0; i < 600; i++)
		there += i % 7 != 3;
	g_string_append_printf(s,
		"ply\nformat ascii 1.0\nobj_info num_cols 30\nobj_info num_rows "
		"20\nelement vertex %d\n" XYZ
		"element range_grid 600\nproperty list uchar int vertex_indices\n"
		"end_header\n",
		there);
	for (int i = 0, k = 0; i < 600; i++)
		if (i % 7 == 3) {
			g_string_append(cells, "0\n");
		} else {
			wall(s, i);
			g_string_append_printf(cells, "1 %d\n", k++);
		}
	g_string_append(s, cells->str);
	check_wall(s->str, s->len, 7);
}

/* What stands in rows and columns is not always what was seen from one place. */
static void test_no_grid(void)
{
	struct place at;
	g_autoptr(GString) s =
		g_string_new("ply\nformat ascii 1.0\nobj_info num_cols 30\n"
			     "obj_info num_rows 20\nelement vertex 600\n" XYZ "end_header\n");
	g_autoptr(GRand) rand = g_rand_new_with_seed(1);
	for (int i = 0; i < 600; i++)
		g_string_append_printf(s, "%f %f %f\n", g_rand_double_range(rand, -1, 1),
			g_rand_double_range(rand, -1, 1), g_rand_double_range(rand, -1, 1));
	g_autoptr(scan_data) d = import_bytes(&at, s->str, s->len);
	g_assert_cmpint(d->kind, ==, SCAN_CLOUD);
	place_clear(&at);
}

/* points.ply of a site is itself a PLY that can be imported. */
static void test_own(void)
{
	struct place at, again;
	g_autoptr(GByteArray) b = ply_of("binary_little_endian", sets[1], false);
	g_autoptr(scan_data) s = import_bytes(&at, b->data, b->len);
	g_autofree char *folder = site_scan_path(at.site, 1),
			*path = g_build_filename(folder, "points.ply", NULL), *own = NULL;
	gsize length;
	g_assert_true(g_file_get_contents(path, &own, &length, NULL));
	g_autoptr(scan_data) t = import_bytes(&again, own, length);
	g_assert_cmpuint(t->points->count, ==, s->points->count);
	for (size_t i = 0; i < s->points->count; i++) {
		struct point_record a = s->points->record[i], c = t->points->record[i];
		g_assert_cmpfloat(a.x_m, ==, c.x_m);
		g_assert_cmpuint(a.rgb[1], ==, c.rgb[1]);
	}
	place_clear(&at);
	place_clear(&again);
}

static void test_real(void)
{
	const char *path = shared_path("data/labelled/b9_training.ply"),
		   *sweep = shared_path("data/vlp-pair/source.ply");
	if (!path || !sweep) {
		g_test_skip("no PLY beside the checkout");
		return;
	}
	struct place at = place_new();
	g_autoptr(GArray) scans = place_import(&at, path), more = place_import(&at, sweep);
	g_assert_cmpuint(g_array_index(scans, struct imported, 0).points, ==, 22300);
	g_assert_cmpuint(g_array_index(scans, struct imported, 0).have, ==,
		POINTS_HAVE_COLOUR | POINTS_HAVE_CLASSIFICATION);
	/* Beams without a return stand at 0 0 0 in it. */
	g_assert_cmpuint(g_array_index(more, struct imported, 0).points, ==, 64685);
	g_assert_cmpuint(g_array_index(more, struct imported, 0).left_out, ==, 5107);
	place_clear(&at);
}

/* ---- refused ---- */

#define TEXT   "ply\nformat ascii 1.0\nelement vertex 2\n" XYZ
#define BINARY "ply\nformat binary_little_endian 1.0\nelement vertex 1\n" XYZ

static const struct {
	const char *text, *words;
} bad[] = {
	{ "ply\n", "line 2: the header has no end" },
	{ "ply\nelement vertex 1\n", "line 2: the format must stand here" },
	{ "ply\nformat ascii 2.0\n", "line 2: the format" },
	{ "ply\nformat binary_middle_endian 1.0\n", "line 2: there is no format" },
	{ TEXT, "line 7: the header has no end" },
	{ "ply\nformat ascii 1.0\nelement vertex -1\n" XYZ "end_header\n",
		"line 3: an element is" },
	{ "ply\nformat ascii 1.0\nelement vertex 18446744073709551615\n" XYZ "end_header\n1 2 3\n",
		"there is room for 1" },
	{ "ply\nformat ascii 1.0\nelement vertex 0\n" XYZ "end_header\n", "has no points" },
	{ "ply\nformat ascii 1.0\nelement vortex 1\n" XYZ "end_header\n1 2 3\n",
		"no element 'vertex'" },
	{ "ply\nformat ascii 1.0\nelement x 99999999\nelement vertex 1\n" XYZ "end_header\n1 2 3\n",
		"have no properties" },
	{ "ply\nformat ascii 1.0\nproperty float x\n", "line 3: a property stands before" },
	{ TEXT "property float y\nend_header\n", "line 7: vertex has a second property 'y'" },
	{ TEXT "property half w\nend_header\n", "line 7: there is no type 'half'" },
	{ TEXT "property list float int w\nend_header\n", "line 7: the length of a list" },
	{ TEXT "property list uchar int\nend_header\n", "line 7: a property is" },
	{ TEXT "property int w w\nend_header\n", "line 7: a property is" },
	{ TEXT "element vertex 3\nend_header\n", "line 7: there is a second element" },
	{ TEXT "elephant\nend_header\n", "line 7: 'elephant'" },
	{ TEXT "end_header\n1 2 3\n", "tells of 2 elements 'vertex'" },
	{ TEXT "end_header\n1 2 3\n4 5      \n", "line 9: has too few numbers" },
	{ TEXT "end_header\n1 2 3 4\n4 5 6\n", "line 8: has too many numbers" },
	{ TEXT "end_header\n1 2 3\n4 5x 6\n", "line 9: '5x 6" },
	{ TEXT "end_header\n1 2 3\n4 5 6\n7 8 9\n", "line 10: here the file should end" },
	{ TEXT "property uchar red\nend_header\n1 2 3 256\n4 5 6 7\n",
		"line 9: 256 is no whole number" },
	{ TEXT "property list uchar int w\nend_header\n1 2 3 200 1\n4 5 6 1 1\n",
		"line 9: has too few" },
	{ BINARY "end_header\n12345678", "there is room for 0" },
	{ BINARY "end_header\n1234567812345678123456781", "has 1 bytes more" },
	{ BINARY "property list uint float w\nend_header\n123456781234567812345678\xff\xff\xff\xff",
		"do not end where the file does" },
	{ "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float "
	  "y\nend_header\n1 2\n",
		"no x, y and z" },
	{ TEXT "property float red\nproperty float r\nend_header\n1 2 3 4 5\n1 2 3 4 5\n",
		"two columns" },
	{ TEXT "end_header\nnan nan nan\n0 0 0\n", "none of its points" },
	{ TEXT "end_header\n1 2 3\n1e12 5 6\n", "point 2: 1e+12 m is too far" },
};

static void test_refused(void)
{
	struct place at = place_new();
	for (size_t i = 0; i < G_N_ELEMENTS(bad); i++) {
		g_autofree char *path =
			place_write(&at, "bad.ply", bad[i].text, strlen(bad[i].text));
		g_test_message("%s", bad[i].words);
		place_assert_refused(&at, path, G_IO_ERROR_INVALID_DATA, bad[i].words);
	}
	place_clear(&at);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/import-ply/properties", test_properties);
	g_test_add_func("/import-ply/intensity", test_intensity);
	g_test_add_func("/import-ply/map", test_map);
	g_test_add_func("/import-ply/grid", test_grid);
	g_test_add_func("/import-ply/range-grid", test_range_grid);
	g_test_add_func("/import-ply/no-grid", test_no_grid);
	g_test_add_func("/import-ply/own", test_own);
	g_test_add_func("/import-ply/real", test_real);
	g_test_add_func("/import-ply/refused", test_refused);
	return g_test_run();
}
