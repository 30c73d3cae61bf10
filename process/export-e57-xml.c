#include "process/export-e57.h"
#include <math.h>
#include <string.h>

#ifndef PLEINAIR_VERSION
#define PLEINAIR_VERSION "0.1"
#endif
/* Seconds from 1970 to the beginning of GPS time, less the leap seconds since (18 from 2017 on). */
#define GPS_BEGAN_S (315964800.0 - 18)

struct e57_xml {
	const struct export_job *job;
	GString *text, *pictures;
};

/* ---- elements ---- */

static void put_text(GString *t, const char *name, const char *value)
{
	if (!value)
		return;
	g_autofree char *valid = g_utf8_make_valid(value, -1),
			*safe = g_markup_escape_text(valid, -1);
	g_string_append_printf(t, "<%s type=\"String\">%s</%s>\n", name, safe, name);
}

static void put_double(GString *t, const char *name, double value)
{
	char number[G_ASCII_DTOSTR_BUF_SIZE];
	g_string_append_printf(t, "<%s type=\"Float\">%s</%s>\n", name,
		g_ascii_dtostr(number, sizeof number, value), name);
}

static void put_integer(GString *t, const char *name, int64_t value)
{
	g_string_append_printf(
		t, "<%s type=\"Integer\">%" G_GINT64_FORMAT "</%s>\n", name, value, name);
}

static void open_structure(GString *t, const char *name)
{
	g_string_append_printf(t, "<%s type=\"Structure\">\n", name);
}

static void close_structure(GString *t, const char *name)
{
	g_string_append_printf(t, "</%s>\n", name);
}

static void put_time(GString *t, const char *name, double unix_s)
{
	if (!isfinite(unix_s))
		return;
	open_structure(t, name);
	put_double(t, "dateTimeValue", unix_s - GPS_BEGAN_S);
	put_integer(t, "isAtomicClockReferenced", 0);
	close_structure(t, name);
}

/* ---- poses ---- */

static double part_of(double squares)
{
	return sqrt(fmax(squares, 0)) / 2;
}

/* w is not negative. */
static void quaternion_of(const struct pose *p, double q[4])
{
	const double(*r)[3] = p->rotation;
	q[0] = part_of(1 + r[0][0] + r[1][1] + r[2][2]);
	q[1] = copysign(part_of(1 + r[0][0] - r[1][1] - r[2][2]), r[2][1] - r[1][2]);
	q[2] = copysign(part_of(1 - r[0][0] + r[1][1] - r[2][2]), r[0][2] - r[2][0]);
	q[3] = copysign(part_of(1 - r[0][0] - r[1][1] + r[2][2]), r[1][0] - r[0][1]);
	double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
	for (int i = 0; i < 4; i++)
		q[i] /= length;
}

static void put_pose(GString *t, const struct pose *p)
{
	static const char *const names[] = { "w", "x", "y", "z" };
	double q[4];
	quaternion_of(p, q);
	open_structure(t, "pose");
	open_structure(t, "rotation");
	for (int i = 0; i < 4; i++)
		put_double(t, names[i], q[i]);
	close_structure(t, "rotation");
	open_structure(t, "translation");
	for (int i = 0; i < 3; i++)
		put_double(t, names[i + 1], p->translation_m[i]);
	close_structure(t, "translation");
	close_structure(t, "pose");
}

/* ---- stations ---- */

static void put_bounds(GString *t, const struct export_station *s)
{
	static const char *const names[] = { "xMinimum", "xMaximum", "yMinimum", "yMaximum",
		"zMinimum", "zMaximum" };
	const struct export_survey *of = &s->survey;
	open_structure(t, "cartesianBounds");
	for (int i = 0; i < 3; i++) {
		put_double(t, names[2 * i], of->low_m[i]);
		put_double(t, names[2 * i + 1], of->high_m[i]);
	}
	close_structure(t, "cartesianBounds");
	open_structure(t, "indexBounds");
	put_integer(t, "rowMinimum", 0);
	put_integer(t, "rowMaximum", s->rows ? s->rows - 1 : 0);
	put_integer(t, "columnMinimum", 0);
	put_integer(t, "columnMaximum", s->columns ? s->columns - 1 : 0);
	put_integer(t, "returnMinimum", 0);
	put_integer(t, "returnMaximum", of->return_most ? of->return_most - 1 : 0);
	close_structure(t, "indexBounds");
}

static void put_limits(GString *t, const struct export_station *s)
{
	static const char *const names[] = { "colorRedMinimum", "colorRedMaximum",
		"colorGreenMinimum", "colorGreenMaximum", "colorBlueMinimum", "colorBlueMaximum" };
	if (s->survey.has_intensity) {
		open_structure(t, "intensityLimits");
		put_integer(t, "intensityMinimum", 0);
		put_integer(t, "intensityMaximum", UINT16_MAX);
		close_structure(t, "intensityLimits");
	}
	if (!s->survey.has_colour)
		return;
	open_structure(t, "colorLimits");
	for (size_t i = 0; i < G_N_ELEMENTS(names); i++)
		put_integer(t, names[i], i % 2 ? UINT8_MAX : 0);
	close_structure(t, "colorLimits");
}

static void put_station(GString *t, const struct export_station *s)
{
	g_autofree char *description =
		s->source ? g_strdup_printf("imported from %s", s->source) : NULL;
	put_text(t, "guid", s->guid);
	put_text(t, "name", s->name);
	put_text(t, "description", description);
	put_text(t, "sensorVendor", s->vendor);
	put_text(t, "sensorModel", s->model_name);
	put_text(t, "sensorSerialNumber", s->serial);
	put_text(t, "sensorFirmwareVersion", s->firmware);
	put_time(t, "acquisitionStart", s->started_s);
	put_time(t, "acquisitionEnd", s->finished_s);
	if (s->has_pose)
		put_pose(t, &s->pose);
	put_bounds(t, s);
	put_limits(t, s);
}

void e57_xml_begin_points(e57_xml *x, const struct export_station *s, uint64_t offset)
{
	open_structure(x->text, "vectorChild");
	put_station(x->text, s);
	g_string_append_printf(x->text,
		"<points type=\"CompressedVector\" fileOffset=\"%" G_GUINT64_FORMAT
		"\" recordCount=\"%" G_GUINT64_FORMAT "\">\n",
		offset, s->survey.points);
	open_structure(x->text, "prototype");
}

void e57_xml_field(e57_xml *x, const char *name, int64_t least, int64_t most, double step_m)
{
	char number[G_ASCII_DTOSTR_BUF_SIZE];
	g_string_append_printf(x->text,
		"<%s type=\"%s\" minimum=\"%" G_GINT64_FORMAT "\" maximum=\"%" G_GINT64_FORMAT "\"",
		name, step_m > 0 ? "ScaledInteger" : "Integer", least, most);
	if (step_m > 0)
		g_string_append_printf(
			x->text, " scale=\"%s\"", g_ascii_dtostr(number, sizeof number, step_m));
	g_string_append(x->text, "/>\n");
}

void e57_xml_end_points(e57_xml *x)
{
	close_structure(x->text, "prototype");
	g_string_append(x->text, "<codecs type=\"Vector\" "
				 "allowHeterogeneousChildren=\"1\"/>\n</points>\n</vectorChild>\n");
}

/* ---- pictures ---- */

static void put_camera(GString *t, const struct e57_xml_picture *p)
{
	if (p->width > 0)
		put_integer(t, "imageWidth", p->width);
	if (p->height > 0)
		put_integer(t, "imageHeight", p->height);
	if (p->pixel_width > 0)
		put_double(t, "pixelWidth", p->pixel_width);
	if (p->pixel_height > 0)
		put_double(t, "pixelHeight", p->pixel_height);
	if (p->focal_m > 0)
		put_double(t, "focalLength", p->focal_m);
	if (!strcmp(p->kind, "pinhole")) {
		put_double(t, "principalPointX", (double)p->width / 2);
		put_double(t, "principalPointY", (double)p->height / 2);
	}
}

void e57_xml_picture(e57_xml *x, const struct export_station *s, const struct e57_xml_picture *p)
{
	GString *t = x->pictures;
	g_autofree char *element = !strcmp(p->kind, "visual reference")
					   ? g_strdup("visualReferenceRepresentation")
					   : g_strconcat(p->kind, "Representation", NULL);
	const char *blob = p->is_png ? "pngImage" : "jpegImage";
	open_structure(t, "vectorChild");
	put_text(t, "guid", p->guid);
	put_text(t, "name", p->name);
	put_text(t, "associatedData3DGuid", s->guid);
	if (p->has_pose)
		put_pose(t, &p->pose);
	open_structure(t, element);
	g_string_append_printf(t,
		"<%s type=\"Blob\" fileOffset=\"%" G_GUINT64_FORMAT "\" length=\"%" G_GUINT64_FORMAT
		"\"/>\n",
		blob, p->offset, p->bytes);
	put_camera(t, p);
	close_structure(t, element);
	close_structure(t, "vectorChild");
}

/* ---- the whole ---- */

static void put_root(GString *t, const struct export_job *j)
{
	g_autofree char *guid = export_guid(j, 0, "file");
	g_string_append(t, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
			   "<e57Root type=\"Structure\" xmlns=\"" E57_NAMESPACE
			   "\" xmlns:" E57_CLASS_PREFIX "=\"" E57_CLASS_NAMESPACE "\">\n");
	put_text(t, "formatName", "ASTM E57 3D Imaging Data File");
	put_text(t, "guid", guid);
	put_integer(t, "versionMajor", 1);
	put_integer(t, "versionMinor", 0);
	put_text(t, "e57LibraryVersion", "pleinair " PLEINAIR_VERSION);
	put_time(t, "creationDateTime", (double)(g_get_real_time() / G_USEC_PER_SEC));
	put_text(t, "coordinateMetadata", "");
	g_string_append(t, "<data3D type=\"Vector\" allowHeterogeneousChildren=\"1\">\n");
}

e57_xml *e57_xml_new(const struct export_job *j)
{
	e57_xml *x = g_new0(e57_xml, 1);
	x->job = j;
	x->text = g_string_new(NULL);
	x->pictures = g_string_new(NULL);
	put_root(x->text, j);
	return x;
}

const char *e57_xml_end(e57_xml *x, size_t *ret_length)
{
	g_string_append_printf(x->text,
		"</data3D>\n<images2D type=\"Vector\" "
		"allowHeterogeneousChildren=\"1\">\n%s</images2D>\n"
		"</e57Root>\n",
		x->pictures->str);
	*ret_length = x->text->len;
	return x->text->str;
}

void e57_xml_free(e57_xml *x)
{
	if (!x)
		return;
	g_string_free(x->text, true);
	g_string_free(x->pictures, true);
	g_free(x);
}
