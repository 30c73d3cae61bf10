/* Tables of points in ASCII into a site: every number where it belongs, whatever holds the columns apart and whoever names them; what
 * is no table is refused with its line, and the site is as it was. */
#include "tests/import-made.h"
#include "tests/support.h"
#include <string.h>

struct wanted {
	double at_m[3];
	uint16_t intensity;
	uint8_t rgb[3], classification;
};

static const struct table {
	const char *name, *text;
	uint32_t have;
	guint count;
	struct wanted first, last;
	const char *note; /* words of it; NULL: none */
	uint64_t left_out;
} tables[] = {
	{ "xyz", "1 2 3\n-4.5 5e-1 +6\n", 0, 2, { { 1, 2, 3 } }, { { -4.5, 0.5, 6 } } },
	{ "no-end", "1 2 3\n4 5 6", 0, 2, { { 1, 2, 3 } }, { { 4, 5, 6 } } },
	{ "dos", "1 2 3\r\n\r\n4 5 6\r\n", 0, 2, { { 1, 2, 3 } }, { { 4, 5, 6 } } },
	{ "blanks", "  1\t 2   3 \n 4 5 6\t\n", 0, 2, { { 1, 2, 3 } }, { { 4, 5, 6 } } },
	{ "commas", "1,2,3\n4, 5 ,6\n", 0, 2, { { 1, 2, 3 } }, { { 4, 5, 6 } } },
	{ "tabs", "1\t2\t3\n4\t5\t6\n", 0, 2, { { 1, 2, 3 } }, { { 4, 5, 6 } } },
	{ "semicolons", "1;2;3\n4;5;6\n", 0, 2, { { 1, 2, 3 } }, { { 4, 5, 6 } } },
	{ "decimal-commas", "1,5;2,25;3\n4;5,5;-0,5\n", 0, 2, { { 1.5, 2.25, 3 } },
		{ { 4, 5.5, -0.5 } } },
	{ "decimal-commas-and-blanks", "1,5 2,25 3,0\n4,0 5,5 -0,5\n", 0, 2, { { 1.5, 2.25, 3 } },
		{ { 4, 5.5, -0.5 } } },
	{ "comments", "# made\n// by hand\n\n1 2 3\n# between\n4 5 6\n", 0, 2, { { 1, 2, 3 } },
		{ { 4, 5, 6 } } },
	{ "mark",
		"\xef\xbb\xbf"
		"1 2 3\n4 5 6\n",
		0, 2, { { 1, 2, 3 } }, { { 4, 5, 6 } } },
	{ "counted", "2\n1 2 3\n4 5 6\n", 0, 2, { { 1, 2, 3 } }, { { 4, 5, 6 } } },
	/* What one, 255 or 65535 is white is told by the largest. */
	{ "intensity-to-1", "1 2 3 0.5\n4 5 6 1\n", POINTS_HAVE_INTENSITY, 2,
		{ { 1, 2, 3 }, 32768 }, { { 4, 5, 6 }, 65535 } },
	{ "intensity-to-255", "1 2 3 51\n4 5 6 2\n", POINTS_HAVE_INTENSITY, 2,
		{ { 1, 2, 3 }, 13107 }, { { 4, 5, 6 }, 514 } },
	{ "intensity-to-65535", "1 2 3 51\n4 5 6 300\n", POINTS_HAVE_INTENSITY, 2,
		{ { 1, 2, 3 }, 51 }, { { 4, 5, 6 }, 300 } },
	{ "intensity-of-pts", "2\n1 2 3 -2048 1 2 3\n4 5 6 2047 4 5 6\n",
		POINTS_HAVE_INTENSITY | POINTS_HAVE_COLOUR, 2, { { 1, 2, 3 }, 0, { 1, 2, 3 } },
		{ { 4, 5, 6 }, 65535, { 4, 5, 6 } } },
	{ "colours", "1 2 3 10 20 30\n4 5 6 250 0 1\n", POINTS_HAVE_COLOUR, 2,
		{ { 1, 2, 3 }, 0, { 10, 20, 30 } }, { { 4, 5, 6 }, 0, { 250, 0, 1 } } },
	{ "colours-to-1", "1 2 3 0.2 0 1\n4 5 6 0.6 1 0.4\n", POINTS_HAVE_COLOUR, 2,
		{ { 1, 2, 3 }, 0, { 51, 0, 255 } }, { { 4, 5, 6 }, 0, { 153, 255, 102 } } },
	{ "intensity-behind-colours", "1 2 3 10 20 30 0.5\n4 5 6 250 0 1 1\n",
		POINTS_HAVE_INTENSITY | POINTS_HAVE_COLOUR, 2,
		{ { 1, 2, 3 }, 32768, { 10, 20, 30 } }, { { 4, 5, 6 }, 65535, { 250, 0, 1 } } },
	{ "normals", "1 2 3 0 0 1\n4 5 6 0.6 -0.8 0\n", 0, 2, { { 1, 2, 3 } }, { { 4, 5, 6 } },
		"columns 4 to 6 have no names" },
	{ "five", "1 2 3 9 8\n4 5 6 9 8\n", 0, 2, { { 1, 2, 3 } }, { { 4, 5, 6 } },
		"columns 4 to 5" },
	{ "named", "z,label,x,y,name,intensity\n3,6,1,2,oak tree,65535\n6,2,4,5,,0\n",
		POINTS_HAVE_INTENSITY | POINTS_HAVE_CLASSIFICATION, 2,
		{ { 1, 2, 3 }, 65535, { 0 }, 6 }, { { 4, 5, 6 }, 0, { 0 }, 2 } },
	{ "named-in-comment", "//X Y Z R G B Intensity\n2\n1 2 3 1 2 3 0.5\n4 5 6 255 5 6 1\n",
		POINTS_HAVE_INTENSITY | POINTS_HAVE_COLOUR, 2, { { 1, 2, 3 }, 32768, { 1, 2, 3 } },
		{ { 4, 5, 6 }, 65535, { 255, 5, 6 } } },
	{ "none", "nan 2 3\n1 2 3\n0 0 0\n4 5 inf\n4 5 6\n", 0, 2, { { 1, 2, 3 } }, { { 4, 5, 6 } },
		NULL, 3 },
};

static void assert_record(const struct point_record *r, const struct wanted *w)
{
	g_assert_cmpfloat(r->x_m, ==, w->at_m[0]);
	g_assert_cmpfloat(r->y_m, ==, w->at_m[1]);
	g_assert_cmpfloat(r->z_m, ==, w->at_m[2]);
	g_assert_cmpuint(r->intensity, ==, w->intensity);
	g_assert_cmpmem(r->rgb, 3, w->rgb, 3);
	g_assert_cmpuint(r->classification, ==, w->classification);
}

static void test_table(gconstpointer data)
{
	const struct table *t = data;
	struct place p = place_new();
	g_autofree char *path = place_write(&p, "table.xyz", t->text, strlen(t->text));
	g_autoptr(GArray) scans = place_import(&p, path);
	const struct imported *i = &g_array_index(scans, struct imported, 0);
	g_autoptr(points) all = place_points(&p, 1);
	g_assert_cmpuint(scans->len, ==, 1);
	g_assert_cmpuint(all->count, ==, t->count);
	g_assert_cmpuint(i->points, ==, t->count);
	g_assert_cmpuint(i->left_out, ==, t->left_out);
	g_assert_cmpuint(i->columns, ==, 0);
	g_assert_cmpuint(i->have, ==, t->have);
	g_assert_true(!i->note == !t->note);
	g_assert_true(!t->note || strstr(i->note, t->note));
	assert_record(&all->record[0], &t->first);
	assert_record(&all->record[t->count - 1], &t->last);
	place_clear(&p);
}

static const struct bad {
	const char *name, *text, *words;
} bads[] = {
	{ "short-line", "1 2 3\n4 5\n", "line 2: has 2 columns, and the points before have 3" },
	{ "short-line-of-commas", "1,2,3\n4,5\n", "line 2: has 2 columns" },
	{ "long-line", "1 2 3\n4 5 6 7\n", "line 2: has more than the 3 columns" },
	{ "word", "1 2 3\n4 tree 6\n", "line 2: column 2 is no number" },
	{ "glued", "1 2 3\n4 5x 6\n", "line 2: column 2 is no number" },
	{ "count", "3\n1 2 3\n4 5 6\n", "tells of 3 points, and there are 2" },
	{ "names", "x,y,z,intensity\n1,2,3\n",
		"line 2: has 3 columns, and the names before are of 4" },
	{ "far", "1 2 3\n4e9 5 6\n", "line 2: 4e+09 m is too far" },
	{ "nothing", "# only words\n\n", "has no points" },
	{ "no-point", "0 0 0\nnan 1 2\n", "no points but such" },
	{ "two", "1 2\n3 4\n", "line 1: a point is x y z" },
};

static void test_bad(gconstpointer data)
{
	const struct bad *b = data;
	struct place p = place_new();
	g_autofree char *path = place_write(&p, "table.xyz", b->text, strlen(b->text));
	place_assert_refused(&p, path, G_IO_ERROR_INVALID_DATA, b->words);
	place_clear(&p);
}

/* Coordinates of a map keep every digit. */
static void test_map(void)
{
	static const char text[] = "512345.0625 5412345.125 412.5\n512346.0625 5412340.125 410.5\n";
	struct place p = place_new();
	g_autofree char *path = place_write(&p, "map.xyz", text, strlen(text));
	g_autoptr(GArray) scans = place_import(&p, path);
	g_autoptr(points) all = place_points(&p, 1);
	g_autoptr(manifest) m = place_manifest(&p, 1);
	manifest_assert_numbers(m, "points.origin_m", 512345, 5412345, 412);
	g_assert_cmpfloat(all->record[0].x_m, ==, 0.0625);
	g_assert_cmpfloat(all->record[1].y_m, ==, -4.875);
	g_assert_cmpuint(scans->len, ==, 1);
	place_clear(&p);
}

/* Longer than what is read at a time: no line is lost at a border, none comes twice. */
static void test_large(void)
{
	g_autoptr(GString) text = g_string_new("# a large one\n");
	guint count = 200000;
	for (guint i = 0; i < count; i++)
		g_string_append_printf(
			text, "%u.25 %.3f %u%s\n", i + 1, i * 0.001, i % 7, i % 3 ? "" : " ");
	struct place p = place_new();
	g_autofree char *path = place_write(&p, "large.txt", text->str, text->len);
	g_autoptr(GArray) scans = place_import(&p, path);
	g_autoptr(points) all = place_points(&p, 1);
	g_assert_cmpuint(all->count, ==, count);
	for (guint i = 0; i < count; i++) {
		g_assert_cmpfloat(all->record[i].x_m, ==, i + 1.25);
		g_assert_cmpfloat(all->record[i].z_m, ==, i % 7);
	}
	g_assert_cmpuint(scans->len, ==, 1);
	place_clear(&p);
}

/* Files of other formats are none of this one's. */
static void test_probe(void)
{
	static const char *const others[] = { "3\n4\n0 0 0\n", "ply\nformat ascii 1.0\n",
		"# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\n", "OFF\n8 6 0\n1 2 3\n",
		"v 1 2 3\nv 2 3 4\n", "solid x\nfacet normal 0 0 1\n", "hello 1 2 3\n",
		"1 2\n3 4\n", "" };
	static const char *const tables_of[] = { "1 2 3\n", "x y z\n1 2 3\n", "5\n1 2 3\n",
		"#\n\n1;2;3\n" };
	for (gsize i = 0; i < G_N_ELEMENTS(others); i++)
		g_assert_false(import_ascii.probe((const uint8_t *)others[i], strlen(others[i])));
	for (gsize i = 0; i < G_N_ELEMENTS(tables_of); i++)
		g_assert_true(
			import_ascii.probe((const uint8_t *)tables_of[i], strlen(tables_of[i])));
	g_assert_false(import_ascii.probe((const uint8_t *)"1 2 3\n\0", 7));
}

static void test_real(void)
{
	const char *path = shared_path("data/outdoor-pairs/car_cloud400.csv");
	if (!path)
		return g_test_skip("there is no shared/data/outdoor-pairs");
	struct place p = place_new();
	g_autoptr(GArray) scans = place_import(&p, path);
	g_autoptr(points) all = place_points(&p, 1);
	g_assert_cmpuint(all->count, ==, 24989);
	g_assert_cmpfloat(all->record[0].x_m, ==, -3.5376);
	g_assert_cmpfloat(all->record[0].z_m, ==, -1.37678);
	g_assert_cmpuint(g_array_index(scans, struct imported, 0).left_out, ==, 0);
	place_clear(&p);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	for (gsize i = 0; i < G_N_ELEMENTS(tables); i++) {
		g_autofree char *name = g_strconcat("/import-ascii/table/", tables[i].name, NULL);
		g_test_add_data_func(name, &tables[i], test_table);
	}
	for (gsize i = 0; i < G_N_ELEMENTS(bads); i++) {
		g_autofree char *name = g_strconcat("/import-ascii/bad/", bads[i].name, NULL);
		g_test_add_data_func(name, &bads[i], test_bad);
	}
	g_test_add_func("/import-ascii/map", test_map);
	g_test_add_func("/import-ascii/large", test_large);
	g_test_add_func("/import-ascii/probe", test_probe);
	g_test_add_func("/import-ascii/real", test_real);
	return g_test_run();
}
