/* Segments of imported scans: how large they are, and the classes that came with the points. */
#include "tests/import-made.h"
#include "tests/segmented-site.h"

/* ---- a room of 5 x 7 x 3 m, exactly, as PTX ---- */

#define ROOM_COLUMNS 720
#define ROOM_ROWS    280
static const double room_m[3] = { 5, 7, 3 };
#define ROOM_AREA_M2 (2 * (5.0 * 7 + 5 * 3 + 7 * 3))

/* One scan, without the cap right below the tripod and above it. */
static void write_room(GString *to, double x, double y)
{
	const double eye[3] = { x, y, 1.6 };
	g_string_append_printf(to,
		"%d\n%d\n%g %g %g\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n%g %g %g 1\n",
		ROOM_COLUMNS, ROOM_ROWS, eye[0], eye[1], eye[2], eye[0], eye[1], eye[2]);
	for (int column = 0; column < ROOM_COLUMNS; column++)
		for (int row = 0; row < ROOM_ROWS; row++) {
			double azimuth = (column + 0.5) * 2 * G_PI / ROOM_COLUMNS,
			       up = ((row + 0.5) / ROOM_ROWS - 0.5) * 0.94 * G_PI;
			double d[3] = { sin(azimuth) * cos(up), cos(azimuth) * cos(up), sin(up) },
			       far = INFINITY;
			for (int k = 0; k < 3; k++)
				far = fmin(far, ((d[k] > 0 ? room_m[k] : 0) - eye[k]) / d[k]);
			g_string_append_printf(
				to, "%.5f %.5f %.5f 0.5\n", far * d[0], far * d[1], far * d[2]);
		}
}

static double area_of_room(int scans, bool geometry)
{
	struct place at = place_new();
	g_autoptr(GString) text = g_string_new(NULL);
	g_autoptr(GError) error = NULL;
	for (int k = 0; k < scans; k++)
		write_room(text, 1.8 + 1.4 * k, 2.5 + 2.1 * k);
	g_autofree char *file = place_write(&at, "room.ptx", text->str, text->len);
	g_array_unref(place_import(&at, file));
	g_autoptr(scan_graph) g = scan_graph_new();
	g_autoptr(GArray) given = scan_graph_given(at.site, &error);
	g_assert_cmpuint(given->len, ==, scans);
	for (guint i = 0; i < given->len; i++) {
		const struct scan_given *in = &g_array_index(given, struct scan_given, i);
		struct placed_scan p = { .number = in->number, .group = 1, .pose = in->pose };
		g_array_append_val(g->scans, p);
	}
	uint32_t made;
	struct segment_site_result r;
	if (geometry)
		geometry_site(at.site, g, NULL, &made, &error);
	g_assert_no_error(error);
	segment_site(at.site, g, NULL, &r, &error);
	g_assert_no_error(error);
	check_leaves(at.site_path, g);
	g_autoptr(segments) tree = segments_load(at.site_path, &error);
	const struct segment *whole = segments_find(tree, SEGMENT_SITE),
			     *floor = segments_find(tree, segment_of_class(CLASS_TERRAIN));
	double area = whole->area_m2;
	g_test_message("%d scans: %.1f of %.1f m2, its floor %.1f of 35", scans, area, ROOM_AREA_M2,
		floor->area_m2);
	for (int k = 0; k < 3; k++)
		g_assert_cmpfloat(fabs(whole->high_m[k] - whole->low_m[k] - room_m[k]), <, 0.01);
	if (geometry)
		g_assert_cmpfloat(fabs(floor->area_m2 - 35), <, 3.5);
	place_clear(&at);
	return area;
}

/* Each surface counts once, however many scans saw it. */
static void test_area(void)
{
	double one = area_of_room(1, true), two = area_of_room(2, true);
	g_assert_cmpfloat(fabs(one - ROOM_AREA_M2), <, 0.1 * ROOM_AREA_M2);
	g_assert_cmpfloat(fabs(two - ROOM_AREA_M2), <, 0.1 * ROOM_AREA_M2);
	/* without normals, as if all faced the scanner */
	double least = area_of_room(1, false);
	g_assert_cmpfloat(least, >, 0.5 * ROOM_AREA_M2);
	g_assert_cmpfloat(least, <, ROOM_AREA_M2);
}

/* ---- classes that came with the points ---- */

#define PUT(b, at, type, value) memcpy((b)->data + (at), &(type){ value }, sizeof(type))

/* LAS 1.2, format 0: a level field of 80 x 80 points, 0.5 m apart, whose classes go around. */
static GByteArray *las_field(const uint8_t *classes, unsigned count)
{
	enum { SIDE = 80, HEADER = 227, RECORD = 20 };
	GByteArray *b = g_byte_array_new();
	g_byte_array_set_size(b, HEADER + RECORD * SIDE * SIDE);
	memset(b->data, 0, b->len);
	memcpy(b->data, "LASF", 4);
	b->data[24] = 1;
	b->data[25] = 2;
	PUT(b, 94, uint16_t, HEADER);
	PUT(b, 96, uint32_t, HEADER);
	PUT(b, 105, uint16_t, RECORD);
	PUT(b, 107, uint32_t, SIDE * SIDE);
	for (int axis = 0; axis < 3; axis++)
		PUT(b, 131 + 8 * axis, double, 0.001);
	for (int i = 0; i < SIDE * SIDE; i++) {
		size_t at = HEADER + (size_t)RECORD * (size_t)i;
		PUT(b, at, int32_t, 500 * (i % SIDE));
		PUT(b, at + 4, int32_t, 500 * (i / SIDE));
		b->data[at + 14] = 9;
		b->data[at + 15] = classes[(unsigned)i % count];
	}
	return b;
}

/* With labels, each point is of the class that its file tells, where that tells one; without, all of a field is ground. */
static void test_labels(void)
{
	static const uint8_t classes[] = { 2, 6, 5, 1, 9, 7, 12, 17, 0 };
	static const int wanted[] = { CLASS_TERRAIN, CLASS_BUILDING, CLASS_VEGETATION,
		CLASS_TERRAIN, CLASS_WATER, CLASS_OTHER, CLASS_TERRAIN, CLASS_STRUCTURE,
		CLASS_TERRAIN };
	struct place at = place_new();
	g_autoptr(GError) error = NULL;
	g_autoptr(GByteArray) las = las_field(classes, G_N_ELEMENTS(classes));
	g_autofree char *file = place_write(&at, "field.las", las->data, las->len);
	g_array_unref(place_import(&at, file));
	g_autoptr(scan_graph) g = scan_graph_new();
	struct placed_scan p = { .number = 1, .group = 1, .pose = POSE_IDENTITY };
	g_array_append_val(g->scans, p);
	uint32_t made;
	geometry_site(at.site, g, NULL, &made, &error);
	g_assert_no_error(error);
	for (int labels = 1; labels >= 0; labels--) {
		struct segment_site_result r;
		site_set(at.site, "segmentation.labels",
			json_node_init_boolean(json_node_alloc(), labels), &error);
		segment_site(at.site, g, NULL, &r, &error);
		g_assert_no_error(error);
		check_leaves(at.site_path, g);
		g_autoptr(segments) tree = segments_load(at.site_path, &error);
		g_autoptr(scan_segments) s = scan_segments_open(at.site, 1, &error);
		g_autoptr(points) cloud = place_points(&at, 1);
		for (uint64_t i = 0; i < s->count; i++) {
			size_t k = 0;
			while (classes[k] != cloud->record[i].classification)
				k++;
			g_assert_cmpint(segments_find(tree, s->leaf[i])->class, ==,
				labels ? wanted[k] : CLASS_TERRAIN);
		}
	}
	place_clear(&at);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/segment-imported/area", test_area);
	g_test_add_func("/segment-imported/labels", test_labels);
	return g_test_run();
}
