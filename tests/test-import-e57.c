/* Points of E57 files of every codec into a site: coordinates, intensities, colours, classes. */
#include "tests/e57-taken.h"

/* ---- coordinates ---- */

struct kind {
	const char *path;
	struct made_field field[3];
	double most_mm; /* by which they may be off */
};
static const struct kind kinds[] = {
	{ "double", { DOUBLES }, 1e-9 },
	{ "single", { SINGLES }, 1e-3 },
	{ "scaled", { XYZ(MADE_SCALED, -200000, 200000, 1e-4, 0) }, 0.05001 },
	{ "scaled-moved", { XYZ(MADE_SCALED, 0, 400000, 1e-4, -20) }, 0.05001 },
	{ "scaled-down", { XYZ(MADE_SCALED, -300000, 300000, -1e-4, 0.5) }, 0.05001 },
	{ "integer", { XYZ(MADE_WHOLE, -20, 20, 0, 0) }, 500.001 },
};

static union made_value kind_value(gconstpointer data, uint64_t i, unsigned field)
{
	const struct kind *k = data;
	double at_m[3];
	scene_point(i, at_m);
	return made_real(&k->field[field], at_m[field]);
}

static void assert_kind(const struct kind *k, unsigned packets, unsigned apart, bool with_between)
{
	struct made_points made = { k->field, 3, 20000, kind_value, k, NULL, packets, apart,
		with_between };
	struct taken t = taken_new(made_one(&made, NULL));
	g_assert_cmpuint(t.p->count, ==, 20000);
	g_assert_cmpuint(t.p->columns, ==, 0);
	g_assert_cmpuint(t.p->have, ==, 0);
	for (uint64_t i = 0; i < t.p->count; i++) {
		double at_m[3];
		scene_point(i, at_m);
		assert_close(&t.p->record[i], at_m, k->most_mm);
	}
	manifest_assert_string(t.m, "source.format", "E57");
	taken_assert_note(&t, 0, NULL);
	g_assert_false(manifest_has(t.m, "given_pose"));
	taken_clear(&t);
}

/* Packets as they come, tiny ones, and streams that are ahead of others. */
static void test_kind(gconstpointer data)
{
	assert_kind(data, 1, 0, false);
	assert_kind(data, 300, 0, true);
	assert_kind(data, 20, 4, true);
	assert_kind(data, 7, 7, false); /* all of one, then all of another */
}

static union made_value angle(gconstpointer data, uint64_t i, unsigned field)
{
	(void)data;
	double of[] = { 2 + (double)(i % 100) / 10, 0.05 * (double)i,
		0.7 * sin(0.013 * (double)i) };
	return (union made_value)REAL(of[field]);
}

static void test_spherical(void)
{
	static const struct made_field fields[] = { { .name = "sphericalRange", MADE_FLOAT64 },
		{ .name = "sphericalAzimuth", MADE_FLOAT64 },
		{ .name = "sphericalElevation", MADE_FLOAT64 } };
	struct made_points made = { fields, 3, 1000, .of = angle };
	struct taken t = taken_new(made_one(&made, NULL));
	for (uint64_t i = 0; i < 1000; i++) {
		double at_m[3];
		scene_point(i, at_m);
		assert_close(&t.p->record[i], at_m, 1e-9);
	}
	taken_clear(&t);
}

/* ---- whole numbers of every width ---- */

static const unsigned widths[] = { 1, 2, 7, 8, 13, 31, 32, 33, 53, 56, 57, 58, 62, 63, 64 };

/* Both ends of the range, and numbers near zero, whose every bit a double keeps. */
static int64_t wide(const struct made_field *f, uint64_t i)
{
	int64_t near = (int64_t)(i * 2654435761u % 100003) - 50001;
	if (i % 5 == 0)
		return f->least;
	if (i % 5 == 1)
		return f->most;
	return near > f->least && near < f->most ? near : f->least + (int64_t)(i / 5 % 2);
}

static union made_value wide_value(gconstpointer data, uint64_t i, unsigned field)
{
	const struct made_field *f = data;
	if (field == 1)
		return (union made_value)WHOLE((int64_t)(i % 3 == 1) - 1);
	return (union made_value)WHOLE(field == 0 ? wide(f, i) : 77);
}

/* x of that width, y of one bit, z of none. */
static void assert_width(unsigned bits)
{
	uint64_t span = bits < 64 ? (UINT64_C(1) << bits) - 1 : UINT64_MAX;
	int64_t least = (int64_t)(-(span / 2) - 1);
	double scale = 1000 / ldexp(1, (int)bits);
	const struct made_field fields[] = { { "cartesianX", MADE_SCALED, least,
						     (int64_t)((uint64_t)least + span), scale, 0,
						     NULL },
		WHOLES("cartesianY", -1, 0), WHOLES("cartesianZ", 77, 77) };
	struct made_points made = { fields, 3, 3000, wide_value, fields, NULL, 13, 1, true };
	struct taken t = taken_new(made_one(&made, NULL));
	g_assert_cmpuint(made_width(&fields[0]), ==, bits);
	g_assert_cmpuint(t.p->count, ==, 3000);
	for (uint64_t i = 0; i < 3000; i++) {
		double x_m = (double)wide(&fields[0], i) * scale;
		g_assert_cmpfloat(fabs(t.p->record[i].x_m - x_m), <=, fabs(x_m) * 1e-15);
		g_assert_cmpfloat(t.p->record[i].y_m, ==, i % 3 == 1 ? 0 : -1);
		g_assert_cmpfloat(t.p->record[i].z_m, ==, 77);
	}
	taken_clear(&t);
}

static void test_widths(void)
{
	for (size_t i = 0; i < G_N_ELEMENTS(widths); i++)
		assert_width(widths[i]);
}

/* A wall: what the first look needs of it has no bits at all. */
static void test_constant_x(void)
{
	static const struct made_field fields[] = { WHOLES("cartesianX", 3, 3),
		WHOLES("cartesianY", -512, 511), WHOLES("cartesianZ", 1, 1) };
	g_autofree union made_value *value = g_new0(union made_value, 3 * 500);
	for (int i = 0; i < 500; i++)
		value[3 * i + 1].whole = i - 250;
	for (int i = 0; i < 1500; i++)
		value[i].whole = i % 3 == 1 ? value[i].whole : fields[i % 3].least;
	struct made_points made = { fields, 3, 500, .value = value };
	struct taken t = taken_new(made_one(&made, NULL));
	g_assert_cmpuint(t.p->count, ==, 500);
	g_assert_cmpfloat(t.p->record[499].y_m, ==, 249);
	g_assert_cmpfloat(t.p->record[499].x_m, ==, 3);
	taken_clear(&t);
}

/* ---- what is passed over ---- */

static const struct made_field many[] = { { "ext:remark", MADE_STRING, 0, 0, 0, 0, NULL },
	{ "ext:cartesianX", MADE_FLOAT64, 0, 0, 0, 0, NULL }, DOUBLES,
	{ "ext:inner", MADE_WHOLE, 0, 99, 0, 0, "ext:outer" },
	{ "ext:classification", MADE_WHOLE, 0, 255, 0, 0, NULL },
	{ "timeStamp", MADE_FLOAT64, 0, 0, 0, 0, NULL }, WHOLES("returnCount", 1, 1),
	{ "label", MADE_STRING, 0, 0, 0, 0, "ext:labels" } };

static union made_value many_value(gconstpointer data, uint64_t i, unsigned field)
{
	double at_m[3];
	scene_point(i, at_m);
	switch (field) {
	case 0:
	case 9: return (union made_value){ .text = i % 2 ? data : "short" };
	case 5: return (union made_value)WHOLE((int64_t)(i % 100));
	case 6: return (union made_value)WHOLE((int64_t)(i % 256));
	case 8: return (union made_value)WHOLE(1);
	case 1:
	case 7: return (union made_value)REAL(12345678.9 * (double)i);
	default: return (union made_value)REAL(at_m[field - 2]);
	}
}

static void test_passed_over(void)
{
	g_autofree char *lengthy = g_strnfill(300, 'x');
	struct made_points made = { many, G_N_ELEMENTS(many), 700, many_value, lengthy, NULL, 9, 1,
		true };
	struct taken t = taken_new(made_one(&made, NULL));
	g_assert_cmpuint(t.p->count, ==, 700);
	g_assert_cmpuint(t.p->have, ==, POINTS_HAVE_CLASSIFICATION);
	for (uint64_t i = 0; i < 700; i++) {
		double at_m[3];
		scene_point(i, at_m);
		assert_close(&t.p->record[i], at_m, 1e-9);
		g_assert_cmpuint(t.p->record[i].classification, ==, i % 256);
	}
	taken_clear(&t);
}

/* ---- intensities and colours ---- */

struct light {
	const char *path;
	struct made_field field; /* of intensity; colours have the same range */
	const char *limits;      /* least and most, as elements are written; NULL: none */
	double value[4];
	double share[4]; /* of the brightest */
	const char *note;
};
static const struct light lights[] = {
	{ "integer", WHOLES("", 0, 65535), NULL, { 0, 1000, 65535, 7 },
		{ 0, 1000 / 65535.0, 1, 7 / 65535.0 }, NULL },
	{ "integer-signed", WHOLES("", -2048, 2047), NULL, { -2048, 0, 2047, 1 },
		{ 0, 2048 / 4095.0, 1, 2049 / 4095.0 }, NULL },
	{ "float-unit", { "", MADE_FLOAT32, 0, 0, 0, 0, NULL }, NULL, { 0, 0.5, 1, 0.25 },
		{ 0, 0.5, 1, 0.25 }, NULL },
	{ "float-byte", { "", MADE_FLOAT64, 0, 0, 0, 0, NULL }, NULL, { 0, 51, 204, 102 },
		{ 0, 0.2, 0.8, 0.4 }, NULL },
	{ "float-word", { "", MADE_FLOAT64, 0, 0, 0, 0, NULL }, NULL, { 0, 65535, 13107, 26214 },
		{ 0, 1, 0.2, 0.4 }, NULL },
	{ "float-beyond", { "", MADE_FLOAT64, 0, 0, 0, 0, NULL }, NULL, { -50, 150, 50, 0 },
		{ 0, 1, 0.5, 0.25 }, "scaled from -50 to 150" },
	{ "float-limits", { "", MADE_FLOAT32, 0, 0, 0, 0, NULL }, "10|20", { 10, 12, 20, 15 },
		{ 0, 0.2, 1, 0.5 }, NULL },
	{ "float-limits-rounded", { "", MADE_FLOAT32, 0, 0, 0, 0, NULL }, "0|0.1",
		{ 0, 0.1, 0.05, 0.02 }, { 0, 1, 0.5, 0.2 }, NULL },
	{ "scaled-limits", { "", MADE_SCALED, 0, 1000, 0.001, 0, NULL }, "0|0.5",
		{ 0, 0.5, 0.1, 0.25 }, { 0, 1, 0.2, 0.5 }, NULL },
	{ "limits-lie", WHOLES("", 0, 4095), "0|1", { 0, 4000, 1000, 400 }, { 0, 1, 0.25, 0.1 },
		"scaled from 0 to 4000" },
	{ "limits-turned", WHOLES("", 0, 4095), "5|1", { 0, 4095, 819, 1638 }, { 0, 1, 0.2, 0.4 },
		NULL },
	{ "limits-no-number", WHOLES("", 0, 4095), "a|b", { 0, 4095, 819, 1638 },
		{ 0, 1, 0.2, 0.4 }, NULL },
	{ "limits-far", { "", MADE_FLOAT64, 0, 0, 0, 0, NULL }, "-1e308|1.7e308",
		{ 0, 51, 204, 102 }, { 0, 0, 0, 0 }, NULL },
	{ "all-far-below", { "", MADE_FLOAT64, 0, 0, 0, 0, NULL }, NULL,
		{ -1e30, -1e30, -1e30, -1e30 }, { 0, 0, 0, 0 }, "scaled from -1e+30" },
	{ "limits-infinite", { "", MADE_FLOAT64, 0, 0, 0, 0, NULL }, "-1e999|1e999",
		{ 0, 51, 204, 102 }, { 0, 0.2, 0.8, 0.4 }, NULL },
};

static union made_value light_value(gconstpointer data, uint64_t i, unsigned field)
{
	const struct light *l = data;
	double at_m[3];
	scene_point(i, at_m);
	if (field < 3)
		return (union made_value)REAL(at_m[field]);
	return field == 4 ? (union made_value)WHOLE(i >= 4) : made_real(&l->field, l->value[i % 4]);
}

static char *light_limits(const struct light *l)
{
	g_auto(GStrv) both = g_strsplit(l->limits ? l->limits : "|", "|", 2);
	return l->limits ? g_strdup_printf("<intensityLimits type=\"Structure\"><intensityMinimum "
					   "type=\"Float\">%s</intensityMinimum><intensityMaximum "
					   "type=\"Float\">%s</intensityMaximum></intensityLimits>",
				   both[0], both[1])
			 : NULL;
}

/* Points 4 to 7 say that they have none. */
static void test_intensity(gconstpointer data)
{
	const struct light *l = data;
	struct made_field fields[] = { DOUBLES, l->field, WHOLES("isIntensityInvalid", 0, 1) };
	g_autofree char *limits = light_limits(l);
	fields[3].name = "intensity";
	struct made_points made = { fields, 5, 8, .of = light_value, l };
	struct taken t = taken_new(made_one(&made, limits));
	g_assert_cmpuint(t.p->have & ~POINTS_HAVE_INTENSITY, ==, 0);
	for (int i = 0; i < 8; i++)
		g_assert_cmpfloat(
			fabs(t.p->record[i].intensity - (i < 4 ? l->share[i] * 65535 : 0)), <=,
			0.51);
	taken_assert_note(&t, 0, l->note);
	taken_clear(&t);
}

struct paint {
	const char *path;
	struct made_field field;
	const char *limit; /* of all; NULL: none told */
	double value[4], wanted[4];
	const char *note;
};
static const struct paint paints[] = {
	{ "bytes", WHOLES("", 0, 255), NULL, { 0, 1, 254, 255 }, { 0, 1, 254, 255 }, NULL },
	{ "dark-bytes", WHOLES("", 0, 255), NULL, { 0, 2, 3, 11 }, { 0, 2, 3, 11 }, NULL },
	{ "nearly-black", WHOLES("", 0, 255), NULL, { 0, 1, 1, 0 }, { 0, 1, 1, 0 }, NULL },
	{ "dark-bytes-of-words", WHOLES("", 0, 255), "255", { 0, 1, 1, 0 }, { 0, 1, 1, 0 }, NULL },
	{ "words", WHOLES("", 0, 65535), "65535", { 0, 257, 65535, 25700 }, { 0, 1, 255, 100 },
		NULL },
	{ "words-untold", WHOLES("", 0, 65535), NULL, { 0, 257, 65535, 25700 }, { 0, 1, 255, 100 },
		NULL },
	{ "float", { "", MADE_FLOAT32, 0, 0, 0, 0, NULL }, "1", { 0, 1, 0.2, 0.4 },
		{ 0, 255, 51, 102 }, NULL },
	{ "limits-lie", WHOLES("", 0, 255), "1", { 0, 255, 51, 102 }, { 0, 255, 51, 102 },
		"colours go beyond" },
};

static union made_value paint_value(gconstpointer data, uint64_t i, unsigned field)
{
	const struct paint *l = data;
	double at_m[3];
	scene_point(i, at_m);
	if (field < 3)
		return (union made_value)REAL(at_m[field]);
	return field == 6 ? (union made_value)WHOLE(i >= 4)
			  : made_real(&l->field, l->value[(i + field) % 4]);
}

static char *paint_limits(const char *limit)
{
	static const char *const names[] = { "Red", "Green", "Blue" };
	GString *xml = g_string_new(limit ? "<colorLimits type=\"Structure\">" : "");
	for (int i = 0; i < 3 && limit; i++)
		g_string_append_printf(xml,
			"<color%sMinimum type=\"Integer\"/><color%sMaximum "
			"type=\"Integer\">%s</color%sMaximum>",
			names[i], names[i], limit, names[i]);
	g_string_append(xml, limit ? "</colorLimits>" : "");
	return g_string_free(xml, false);
}

static void test_colour(gconstpointer data)
{
	const struct paint *l = data;
	struct made_field fields[] = { DOUBLES, l->field, l->field, l->field,
		WHOLES("isColorInvalid", 0, 1) };
	g_autofree char *limits = paint_limits(l->limit);
	fields[3].name = "colorRed";
	fields[4].name = "colorGreen";
	fields[5].name = "colorBlue";
	struct made_points made = { fields, 7, 8, .of = paint_value, l };
	struct taken t = taken_new(made_one(&made, limits));
	g_assert_cmpuint(t.p->have, ==, POINTS_HAVE_COLOUR);
	for (unsigned i = 0; i < 8; i++)
		for (unsigned k = 0; k < 3; k++)
			g_assert_cmpuint(t.p->record[i].rgb[k], ==,
				i < 4 ? (unsigned)l->wanted[(i + k + 3) % 4] : 0);
	taken_assert_note(&t, 0, l->note);
	taken_clear(&t);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	for (size_t i = 0; i < G_N_ELEMENTS(kinds); i++) {
		g_autofree char *path = g_strconcat("/import-e57/kind/", kinds[i].path, NULL);
		g_test_add_data_func(path, &kinds[i], test_kind);
	}
	g_test_add_func("/import-e57/spherical", test_spherical);
	g_test_add_func("/import-e57/widths", test_widths);
	g_test_add_func("/import-e57/constant-x", test_constant_x);
	g_test_add_func("/import-e57/passed-over", test_passed_over);
	for (size_t i = 0; i < G_N_ELEMENTS(lights); i++) {
		g_autofree char *path = g_strconcat("/import-e57/intensity/", lights[i].path, NULL);
		g_test_add_data_func(path, &lights[i], test_intensity);
	}
	for (size_t i = 0; i < G_N_ELEMENTS(paints); i++) {
		g_autofree char *path = g_strconcat("/import-e57/colour/", paints[i].path, NULL);
		g_test_add_data_func(path, &paints[i], test_colour);
	}
	return g_test_run();
}
