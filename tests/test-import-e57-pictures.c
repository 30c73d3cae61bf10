/* Pictures of E57 files: which scan they come with, what is told of them; those that are none or damaged are told and left out. */
#include "tests/e57-taken.h"

static const struct made_field fields[] = { DOUBLES };

static union made_value point(gconstpointer data, uint64_t i, unsigned field)
{
	double at_m[3];
	scene_point(i + GPOINTER_TO_UINT(data), at_m);
	return (union made_value)REAL(at_m[field]);
}

static const struct made_points hundred = { fields, 3, 100, .of = point };

#define GUID(g) "<guid type=\"String\">" g "</guid>"

#define PICTURE(guid, kind, format, section, length)                                               \
	"<vectorChild type=\"Structure\"><name type=\"String\">" section "</name>" guid "<" kind   \
	"Representation type=\"Structure\"><" format "Image type=\"Blob\" fileOffset=\"%" section  \
	"\" length=\"" length "\"/><imageHeight type=\"Integer\">200</imageHeight>"                \
	"<imageWidth type=\"Integer\">400</imageWidth><pixelWidth "                                \
	"type=\"Float\">0.25</pixelWidth>"                                                         \
	"<pixelHeight type=\"Float\">0.5</pixelHeight><focalLength type=\"Float\">0.035"           \
	"</focalLength></" kind "Representation></vectorChild>"
#define OF_SCAN(guid) "<associatedData3DGuid type=\"String\">" guid "</associatedData3DGuid>"

static JsonObject *picture(const manifest *m, guint i)
{
	return json_array_get_object_element(
		json_node_get_array(manifest_get_node(m, "pictures")), i);
}

static void assert_picture(
	const struct taken *t, uint32_t scan, const char *name, const char *bytes, size_t length)
{
	g_autofree char *folder = site_scan_path(t->at.site, scan),
			*path = g_build_filename(folder, name, NULL), *got = NULL;
	gsize got_length;
	g_assert_true(g_file_get_contents(path, &got, &got_length, NULL));
	g_assert_cmpmem(got, got_length, bytes, length);
}

static GByteArray *file_with_pictures(const char *images, const char *bytes, size_t length)
{
	struct made m = made_begin();
	struct made_points second = hundred;
	second.data = GUINT_TO_POINTER(1000);
	unsigned a = made_vector(&m, &hundred), b = made_vector(&m, &second);
	made_blob(&m, bytes, length);
	made_blob(&m, "PNG", 3);
	g_autofree char *one = made_scan_xml(&hundred, a, GUID("{one}")),
			*two = made_scan_xml(&second, b, GUID("{two}")),
			*both = g_strconcat(one, two, NULL);
	return made_xml(&m, both, images);
}

static void test_pictures(void)
{
	g_autofree char *bytes = g_strnfill(5000, 'j');
	struct taken t = taken_new(file_with_pictures(
		PICTURE(OF_SCAN("{two}"), "spherical", "jpeg", "2", "5000")
			PICTURE(OF_SCAN("{other}"), "pinhole", "png", "3", "3")
				PICTURE("", "visualReference", "jpeg", "2", "17")
					PICTURE(OF_SCAN("{two}"), "panoramic", "png", "3", "3"),
		bytes, 5000));
	g_autoptr(manifest) second = place_manifest(&t.at, 2);
	assert_picture(&t, 1, "picture-01.png", "PNG", 3);
	assert_picture(&t, 1, "picture-02.jpg", bytes, 17);
	assert_picture(&t, 2, "picture-01.jpg", bytes, 5000);
	JsonObject *spherical = picture(second, 0), *pinhole = picture(t.m, 0);
	g_assert_cmpstr(json_object_get_string_member(spherical, "kind"), ==, "spherical");
	g_assert_cmpstr(json_object_get_string_member(spherical, "file"), ==, "picture-01.jpg");
	g_assert_cmpstr(json_object_get_string_member(spherical, "name"), ==, "2");
	g_assert_cmpint(json_object_get_int_member(spherical, "width"), ==, 400);
	g_assert_cmpint(json_object_get_int_member(spherical, "height"), ==, 200);
	g_assert_cmpfloat(json_object_get_double_member(spherical, "pixel_width_rad"), ==, 0.25);
	g_assert_cmpstr(json_object_get_string_member(pinhole, "kind"), ==, "pinhole");
	g_assert_cmpfloat(json_object_get_double_member(pinhole, "pixel_height_m"), ==, 0.5);
	g_assert_cmpfloat(json_object_get_double_member(pinhole, "focal_m"), ==, 0.035);
	g_assert_cmpstr(
		json_object_get_string_member(picture(t.m, 1), "kind"), ==, "visual reference");
	taken_assert_note(&t, 0, "picture 4 has no JPEG or PNG");
	taken_assert_note(&t, 1, NULL);
	taken_clear(&t);
}

/* What cannot be a picture is told, and the points come without it. */
static void test_no_pictures(void)
{
	static const struct {
		const char *xml, *note;
	} bad[] = {
		{ PICTURE("", "pinhole", "jpeg", "0", "100"),
			"there is no picture of 100 bytes here" },
		{ PICTURE("", "pinhole", "jpeg", "2", "0"), "picture 1 has no JPEG or PNG" },
		{ PICTURE("", "pinhole", "jpeg", "2", "-5"), "picture 1 has no JPEG or PNG" },
		{ PICTURE("", "pinhole", "jpeg", "2", "99999999999999999999"),
			"picture 1 has no JPEG or PNG" },
		{ PICTURE("", "pinhole", "jpeg", "2", "6000"),
			"there is no picture of 6000 bytes here" },
		{ PICTURE("", "pinhole", "jpeg", "3", "21"),
			"there is no picture of 21 bytes here" },
		{ PICTURE("", "pinhole", "png", "9", "10"), "picture 1 lies outside the file" },
		{ PICTURE("", "pinhole", "png", "2", "999999"), "picture 1 lies outside the file" },
	};
	for (size_t i = 0; i < G_N_ELEMENTS(bad); i++) {
		struct taken t = taken_new(file_with_pictures(bad[i].xml, "jpg", 3));
		g_assert_cmpuint(t.p->count, ==, 100);
		g_assert_false(manifest_has(t.m, "pictures"));
		taken_assert_note(&t, 0, bad[i].note);
		taken_clear(&t);
	}
}

/* One that many name: as often as the file is large, and each is told by its number in the file. */
static void test_numbers(void)
{
	g_autofree char *bytes = g_strnfill(9000, 'j');
	struct taken t = taken_new(file_with_pictures(
		PICTURE("", "pinhole", "jpeg", "2", "9000") PICTURE("", "pinhole", "jpeg", "0", "9")
			PICTURE("", "pinhole", "jpeg", "2", "9000") PICTURE("", "pinhole", "gif",
				"2", "9") PICTURE("", "pinhole", "png", "3", "30"),
		bytes, 9000));
	assert_picture(&t, 1, "picture-01.jpg", bytes, 9000);
	taken_assert_note(&t, 0,
		"picture 3 was left out: with those before it is more than the file; picture 4 has "
		"no JPEG");
	taken_assert_note(&t, 0, "picture 2 was left out: ");
	taken_assert_note(&t, 0, "picture 5 was left out: ");
	taken_clear(&t);
}

/* One bit of it in the file: the rest is good. */
static void test_damaged_picture(void)
{
	g_autofree char *bytes = g_strnfill(5000, 'j');
	GByteArray *file = file_with_pictures(PICTURE("", "pinhole", "jpeg", "2", "5000")
						      PICTURE("", "pinhole", "png", "3", "3"),
		bytes, 5000);
	size_t at = 0;
	while (memcmp(file->data + at, "jjjjjjjj", 8) != 0)
		at++;
	file->data[at + 2500] ^= 4;
	struct taken t = taken_new(file);
	taken_assert_note(&t, 0, "picture 1 was left out: ");
	taken_assert_note(&t, 0, "the page of 1024 bytes that begins here is damaged");
	assert_picture(&t, 1, "picture-01.png", "PNG", 3);
	g_assert_cmpstr(
		json_object_get_string_member(picture(t.m, 0), "file"), ==, "picture-01.png");
	taken_clear(&t);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/import-e57-pictures/of-scans", test_pictures);
	g_test_add_func("/import-e57-pictures/none", test_no_pictures);
	g_test_add_func("/import-e57-pictures/numbers", test_numbers);
	g_test_add_func("/import-e57-pictures/damaged", test_damaged_picture);
	return g_test_run();
}
