/* What the XML of an E57 file says beside its points: poses, several scans; and XML as nobody would write it. */
#include "tests/e57-taken.h"

static const struct made_field fields[] = { DOUBLES };

static union made_value point(gconstpointer data, uint64_t i, unsigned field)
{
	double at_m[3];
	scene_point(i + GPOINTER_TO_UINT(data), at_m);
	return (union made_value)REAL(at_m[field]);
}

static const struct made_points hundred = { fields, 3, 100, .of = point };

/* ---- poses ---- */

#define POSE(w, x, y, z, tx, ty, tz)                                                               \
	"<pose type=\"Structure\"><rotation type=\"Structure\"><w type=\"Float\">" w               \
	"</w><x type=\"Float\">" x "</x><y type=\"Float\">" y "</y><z type=\"Float\">" z           \
	"</z></rotation><translation type=\"Structure\"><x type=\"Float\">" tx                     \
	"</x><y type=\"Float\">" ty "</y><z type=\"Float\">" tz "</z></translation></pose>"
#define QUARTER "0.70710678118654757"

/* A quarter turn to the left, then away. */
static void test_pose(void)
{
	g_autoptr(GError) error = NULL;
	struct taken t = taken_new(
		made_one(&hundred, POSE(QUARTER, "0", "0", QUARTER, "10.25", "-20.5", "3")));
	g_autoptr(scan_data) d = scan_data_peek(t.at.site, 1, &error);
	double at_m[3] = { 1, 2, 3 };
	g_assert_no_error(error);
	manifest_assert_numbers(t.m, "given_pose.translation_m", 10.25, -20.5, 3);
	pose_apply(&d->given_pose, at_m, at_m);
	g_assert_cmpfloat(fabs(at_m[0] - (10.25 - 2)), <, 1e-9);
	g_assert_cmpfloat(fabs(at_m[1] - (-20.5 + 1)), <, 1e-9);
	g_assert_cmpfloat(fabs(at_m[2] - 6), <, 1e-9);
	scene_point(0, at_m);
	assert_close(&t.p->record[0], at_m, 1e-9); /* the points stay the scanner's */
	taken_clear(&t);
}

/* About x, y and each other: (w x y z) of 120 degrees about the diagonal takes x to y, y to z, z to x. */
static void test_pose_diagonal(void)
{
	g_autoptr(GError) error = NULL;
	struct taken t = taken_new(
		made_one(&hundred, POSE("0.5002", "0.5002", "0.5002", "0.5002", "0", "0", "0")));
	g_autoptr(scan_data) d = scan_data_peek(t.at.site, 1, &error);
	double at_m[3] = { 1, 2, 3 };
	g_assert_no_error(error);
	pose_apply(&d->given_pose, at_m, at_m);
	g_assert_cmpfloat(fabs(at_m[0] - 3) + fabs(at_m[1] - 1) + fabs(at_m[2] - 2), <, 1e-9);
	taken_clear(&t);
}

static void assert_pose(const char *what, double x_m, bool is_given)
{
	struct taken t = taken_new(made_one(&hundred, what));
	g_assert_cmpint(manifest_has(t.m, "given_pose"), ==, is_given);
	if (is_given)
		manifest_assert_numbers(t.m, "given_pose.translation_m", x_m, 0, 0);
	taken_clear(&t);
}

static void test_poses_of_parts(void)
{
	assert_pose(NULL, 0, false);
	assert_pose(POSE("1", "0", "0", "0", "0", "0", "0"), 0, false);
	assert_pose("<pose type=\"Structure\"/>", 0, false);
	assert_pose("<pose type=\"Structure\"><translation><x type=\"Float\"> 1.5 </x>"
		    "<y type=\"Float\"/></translation></pose>",
		1.5, true);
}

static void test_no_pose(void)
{
	static const char *const poses[] = { POSE("2", "0", "0", "0", "0", "0", "0"),
		POSE("0", "0", "0", "0", "0", "0", "0"), POSE("nan", "0", "0", "0", "0", "0", "0"),
		POSE("1e200", "0", "0", "0", "0", "0", "0"),
		POSE("0.9", "0.1", "0", "0", "0", "0", "0") };
	for (size_t i = 0; i < G_N_ELEMENTS(poses); i++)
		taken_assert_refused(made_one(&hundred, poses[i]), G_IO_ERROR_INVALID_DATA,
			"the pose of scan 1 is no motion");
}

/* ---- several scans ---- */

#define GUID(g) "<guid type=\"String\">" g "</guid>"

#define CODEC(element)                                                                             \
	"<codecs type=\"Vector\"><vectorChild type=\"Structure\"><inputs "                         \
	"type=\"Vector\"/>" element "</vectorChild></codecs>"

/* With points, with none, without coordinates, with points again, without any vector. */
static void test_scans(void)
{
	static const struct made_field rows[] = { WHOLES("rowIndex", 0, 100) };
	const union made_value row[] = { WHOLE(7) };
	struct made m = made_begin();
	struct made_points second = hundred, none = hundred, other = { rows, 1, 1, .value = row };
	second.data = GUINT_TO_POINTER(1000);
	none.count = 0;
	unsigned of[] = { made_vector(&m, &hundred), made_vector(&m, &other),
		made_vector(&m, &second) };
	g_autofree char *a = made_scan_xml(
				&hundred, of[0], POSE("1", "0", "0", "0", "1", "0", "0")),
			*b = made_scan_xml(&none, of[0], NULL),
			*c = made_scan_xml(&other, of[1], NULL),
			*d = made_scan_xml(&second, of[2], NULL);
	g_autofree char *all = g_strconcat(a, b, c, d, "<vectorChild type=\"Structure\"/>", NULL);
	struct taken t = taken_new(made_xml(&m, all, NULL));
	double at_m[3];
	g_assert_cmpuint(t.scans->len, ==, 2);
	g_assert_true(taken_scan(&t, 0)->has_pose && taken_scan(&t, 1)->has_pose);
	taken_assert_note(&t, 0,
		"scan 2 of the file has no points; scan 3 of the file has no coordinates; scan 5 "
		"of");
	taken_assert_note(&t, 1, NULL);
	manifest_assert_numbers(t.m, "given_pose.translation_m", 1, 0, 0);
	g_autoptr(points) p = place_points(&t.at, 2);
	scene_point(1000, at_m);
	assert_close(&p->record[0], at_m, 1e-9);
	taken_clear(&t);
}

static void test_no_scans(void)
{
	struct made m = made_begin();
	taken_assert_refused(
		made_xml(&m, "", NULL), G_IO_ERROR_INVALID_DATA, "has no scan with points");
	struct made_points none = hundred;
	none.count = 0;
	taken_assert_refused(made_one(&none, NULL), G_IO_ERROR_INVALID_DATA,
		"has no scan with points: scan 1 of");
}

/* A scan whose points are all marked as none, and one packed by what is not of the standard, are told; the others come. */
static void test_scans_of_no_use(void)
{
	static const struct made_field marked[] = { DOUBLES,
		WHOLES("cartesianInvalidState", 0, 2) };
	const union made_value none[] = { REAL(1), REAL(2), REAL(3), WHOLE(2), REAL(4), REAL(5),
		REAL(6), WHOLE(1) };
	struct made m = made_begin();
	struct made_points nothing = { marked, 4, 2, .value = none };
	unsigned of[] = { made_vector(&m, &hundred), made_vector(&m, &nothing),
		made_vector(&m, &hundred), made_vector(&m, &hundred) };
	g_autofree char *a = made_scan_xml(&hundred, of[0], NULL),
			*b = made_scan_xml(&nothing, of[1], NULL),
			*c = made_scan_xml(&hundred, of[2], NULL),
			*d = made_scan_xml(&hundred, of[3], NULL);
	g_autoptr(GString) packed = g_string_new(c), usual = g_string_new(d);
	g_string_replace(packed, "<codecs type=\"Vector\"/>",
		CODEC("<ext:zipCodec type=\"Structure\"/>"), 0);
	g_string_replace(
		usual, "<codecs type=\"Vector\"/>", CODEC("<bitPackCodec type=\"Structure\"/>"), 0);
	g_autofree char *all = g_strconcat(a, b, packed->str, usual->str, NULL);
	struct taken t = taken_new(made_xml(&m, all, NULL));
	g_assert_cmpuint(t.scans->len, ==, 2);
	taken_assert_note(&t, 0, "scan 2 of the file has no points but such as it marks as none");
	taken_assert_note(&t, 0, "scan 3 of the file is packed by 'zipCodec', which is not read");
	taken_assert_note(&t, 1, NULL);
	taken_clear(&t);
}

/* The same points for every scan: a small file must not fill a disk. */
static void test_same_points(void)
{
	struct made m = made_begin();
	unsigned section = made_vector(&m, &hundred);
	g_autofree char *a = made_scan_xml(&hundred, section, NULL);
	g_autoptr(GString) all = g_string_new(NULL);
	for (int i = 0; i < 30; i++)
		g_string_append(all, a);
	taken_assert_refused(made_xml(&m, all->str, NULL), G_IO_ERROR_INVALID_DATA,
		"stand among those of others");
}

/* ---- XML ---- */

/* Of one scan of a hundred points, as section 0. */
static GByteArray *file_of_xml(const char *xml, size_t length)
{
	struct made m = made_begin();
	made_vector(&m, &hundred);
	return made_end(&m, xml, length);
}

static char *plain_xml(void)
{
	g_autofree char *scan = made_scan_xml(&hundred, 0, GUID("<![CDATA[{a&b}]]>"));
	return made_root_xml(scan, NULL);
}

/* Frees text. */
static char *replaced(char *text, const char *from, const char *to)
{
	GString *s = g_string_new(text);
	g_free(text);
	g_assert_cmpuint(g_string_replace(s, from, to, 0), >, 0);
	return g_string_free(s, false);
}

static void assert_read(const char *xml, size_t length)
{
	struct taken t = taken_new(file_of_xml(xml, length));
	double at_m[3];
	g_assert_cmpuint(t.p->count, ==, 100);
	scene_point(99, at_m);
	assert_close(&t.p->record[99], at_m, 1e-9);
	taken_assert_note(&t, 0, NULL);
	taken_clear(&t);
}

static void test_spellings(void)
{
	g_autofree char *plain = plain_xml();
	g_autofree char *with_mark = g_strconcat("\xef\xbb\xbf", plain, NULL);
	g_autofree char *comments =
		replaced(plain_xml(), "<data3D", "<!-- < & = > -->\n<?x y?><data3D");
	g_autofree char *inside =
		replaced(plain_xml(), "<prototype", "<!-- a --><?x y?>text<prototype");
	g_autofree char *crlf = replaced(plain_xml(), "\n", "\r\n");
	g_autofree char *apostrophes = replaced(plain_xml(), "\"", "'");
	g_autofree char *bare = replaced(plain_xml(), " xmlns=\"" MADE_NAMESPACE "\"", "");
	g_autofree char *filler = g_strnfill(12000000, '\n');
	g_autofree char *with_filler = g_strconcat("<data3D", filler, NULL);
	g_autofree char *lengthy = replaced(plain_xml(), "<data3D", with_filler);
	assert_read(lengthy, strlen(lengthy)); /* many scans make so much */
	assert_read(plain, strlen(plain));
	assert_read(plain, strlen(plain) + 1); /* a zero behind it */
	assert_read(with_mark, strlen(with_mark));
	assert_read(comments, strlen(comments));
	assert_read(inside, strlen(inside));
	assert_read(crlf, strlen(crlf));
	assert_read(apostrophes, strlen(apostrophes));
	assert_read(bare, strlen(bare));
}

/* Every element of the standard has a prefix, and an extension has none. */
static void test_prefix(void)
{
	char *xml = replaced(plain_xml(), "</", "\1");
	xml = replaced(xml, "<?", "\2");
	xml = replaced(xml, "<!", "\3");
	xml = replaced(xml, "<", "<e:");
	xml = replaced(xml, "\1", "</e:");
	xml = replaced(xml, "\2", "<?");
	xml = replaced(xml, "\3", "<!");
	xml = replaced(xml, "xmlns=", "xmlns:e=");
	xml = replaced(
		xml, "<e:data3D", "<data3D xmlns=\"urn:other\"><vectorChild/></data3D><e:data3D");
	assert_read(xml, strlen(xml));
	g_free(xml);
}

#define LAUGH(n, m)                                                                                \
	"<!ENTITY l" n " \"&l" m ";&l" m ";&l" m ";&l" m ";&l" m ";&l" m ";&l" m ";&l" m ";\">"
#define LAUGHS                                                                                     \
	"<!DOCTYPE e57Root [<!ENTITY l0 \"ha\">" LAUGH("1", "0") LAUGH("2", "1") LAUGH("3", "2")   \
		LAUGH("4", "3") LAUGH("5", "4") LAUGH("6", "5") LAUGH("7", "6") LAUGH("8", "7")    \
			LAUGH("9", "8") "]>"

static void refuse_xml(const char *from, const char *to, const char *words)
{
	g_autofree char *xml = replaced(plain_xml(), from, to);
	gint64 start = g_get_monotonic_time();
	taken_assert_refused(file_of_xml(xml, strlen(xml)), G_IO_ERROR_INVALID_DATA, words);
	g_assert_cmpint(g_get_monotonic_time() - start, <, 20 * G_USEC_PER_SEC);
}

static void test_bad_xml(void)
{
	static const struct {
		const char *from, *to, *words;
	} bad[] = {
		{ "<e57Root", LAUGHS "<e57Root", "has a document type" },
		{ "<e57Root", "<!DOCTYPE e57Root SYSTEM \"file:///etc/passwd\"><e57Root",
			"has a document type" },
		{ "e57Root", "e58Root", "line 3 of its XML: 'e58Root' should be e57Root" },
		{ "</e57Root>", "", "of its XML: " },
		{ "</data3D>", "</data4D>", "of its XML: " },
		{ "<?xml", "?xml", "line 1 of its XML: " },
		{ "{a&b}", "\xff\xfe", "of its XML: " },
		{ "</formatName>", "</format\xf0me>", "of its XML: " },
		{ "fileOffset=\"%0\"", "", "'points' lies at byte -1 of a file of" },
		{ "fileOffset=\"%0\"", "fileOffset=\"x\"",
			"fileOffset of 'points' is no whole number" },
		{ "fileOffset=\"%0\"", "fileOffset=\"47\"", "'points' lies at byte 47" },
		{ "fileOffset=\"%0\"", "fileOffset=\"9223372036854775807\"",
			"'points' lies at byte 9223" },
		{ "fileOffset=\"%0\"", "fileOffset=\"9223372036854775808\"", "is no whole number" },
		{ "fileOffset=\"%0\"", "fileOffset=\"56\"", "byte 56: there are no points here" },
		{ "recordCount=\"100\"", "recordCount=\"-1\"", "-1 records cannot be" },
		{ "recordCount=\"100\"", "recordCount=\"\"",
			"recordCount of 'points' is no whole" },
		{ "recordCount=\"100\"", "recordCount=\"101\"",
			"the points end here, after 100 of 101" },
		{ "recordCount=\"100\"", "recordCount=\"9223372036854775807\"",
			"9223372036854775807 points cannot stand in" },
		{ "<cartesianX ", "<cartesianX/><cartesianX ",
			"'cartesianX' has no type that is known" },
		{ "<cartesianX type=\"Float\"",
			"<cartesianX type=\"Integer\" minimum=\"5\" maximum=\"4\"",
			"the range of 'cartesianX' cannot be" },
		{ "<cartesianX type=\"Float\"", "<cartesianX type=\"ScaledInteger\" scale=\"nan\"",
			"the range of 'cartesianX' cannot be" },
		{ "<cartesianX type=\"Float\"", "<cartesianX type=\"ScaledInteger\" scale=\"x\"",
			"scale of 'cartesianX' is no number" },
		{ "<cartesianX type=\"Float\"", "<cartesianX minimum=\"1.5\" type=\"Integer\"",
			"minimum of 'cartesianX' is no whole number" },
		{ "<cartesianZ type",
			"<extra type=\"Integer\" minimum=\"1\" maximum=\"1\"/><cartesianZ type",
			"a packet of 3 streams, and the points have 4 fields" },
		{ "precision=\"double\"", "precision=\"triple\" x=\"1\" x=\"2\"", "of its XML: " },
	};
	for (size_t i = 0; i < G_N_ELEMENTS(bad); i++)
		refuse_xml(bad[i].from, bad[i].to, bad[i].words);
}

static void refuse_many(const char *at, const char *piece, unsigned count, const char *words)
{
	g_autoptr(GString) all = g_string_new(NULL);
	for (unsigned i = 0; i < count; i++)
		g_string_append_printf(all, piece, i, i);
	g_string_append(all, at);
	refuse_xml(at, all->str, words);
}

#define DEEP                                                                                       \
	"<a type='Structure'><a type='Vector'><a type='Structure'><a type='Structure'><a "         \
	"type='Structure'>"
#define CLOSE "</a></a></a></a></a>"

/* What would take very long, or very much. */
static void test_heavy_xml(void)
{
	refuse_many("<data3D", "<a/>", 2000001, "more than 2000000 tags and");
	refuse_many("<data3D", "<a b=''/>", 1000001, "more than 2000000 tags and");
	refuse_many("type=\"CompressedVector\"", "a%u='' ", 200000, "more than 1000 attributes");
	refuse_many("<data3D", "<a>", 100000, "of its XML: ");
	g_autofree char *deep = g_strdup_printf("%s%s%s%s<cartesianX", DEEP, DEEP, CLOSE, CLOSE);
	refuse_xml("<cartesianX", deep, "too deep");
	refuse_many("<cartesianX", "<a%u type='Float'/>", 70000, "more fields than a packet");
	refuse_many("<cartesianX", "<a%u type='String'/>", 32000, "the points have 32003 fields");
	g_autofree char *wide = g_convert("<e57Root/>", -1, "UTF-16LE", "UTF-8", NULL, NULL, NULL);
	taken_assert_refused(file_of_xml(wide, 20), G_IO_ERROR_INVALID_DATA, "it should be UTF-8");
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/import-e57-xml/pose", test_pose);
	g_test_add_func("/import-e57-xml/pose-diagonal", test_pose_diagonal);
	g_test_add_func("/import-e57-xml/poses-of-parts", test_poses_of_parts);
	g_test_add_func("/import-e57-xml/no-pose", test_no_pose);
	g_test_add_func("/import-e57-xml/scans", test_scans);
	g_test_add_func("/import-e57-xml/no-scans", test_no_scans);
	g_test_add_func("/import-e57-xml/scans-of-no-use", test_scans_of_no_use);
	g_test_add_func("/import-e57-xml/same-points", test_same_points);
	g_test_add_func("/import-e57-xml/spellings", test_spellings);
	g_test_add_func("/import-e57-xml/prefix", test_prefix);
	g_test_add_func("/import-e57-xml/bad", test_bad_xml);
	g_test_add_func("/import-e57-xml/heavy", test_heavy_xml);
	return g_test_run();
}
