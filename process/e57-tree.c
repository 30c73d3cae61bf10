#include "process/e57-tree.h"
#include "process/e57-xml.h"
#include <gio/gio.h>
#include <math.h>
#include <string.h>

/* More have no room in a packet. */
#define FIELDS_MAX 32765u

struct reading {
	import_source *file;
	e57_tree *tree;
	GHashTable *by_guid; /* of scans, their index + 1 */
	uint64_t *pictures;  /* bytes of all so far */
};

#define refuse(error, r, ...) import_refuse(error, (r)->file, G_IO_ERROR_INVALID_DATA, __VA_ARGS__)

/* ---- elements ---- */

static bool is_named(const xmlNode *n, const char *name)
{
	return n->type == XML_ELEMENT_NODE && !strcmp((const char *)n->name, name);
}

/* Those of the standard are of the root's namespace, whatever its prefix is: an extension may use the same names for something else. */
static bool is_extension(const xmlNode *n)
{
	const xmlNode *root = xmlDocGetRootElement(n->doc);
	return n->ns && n->ns != root->ns &&
	       (!root->ns || !xmlStrEqual(n->ns->href, root->ns->href));
}

static const xmlNode *child(const xmlNode *n, const char *name)
{
	for (const xmlNode *c = n ? n->children : NULL; c; c = c->next)
		if (is_named(c, name) && !is_extension(c))
			return c;
	return NULL;
}

static char *text(const xmlNode *n)
{
	xmlChar *content = n ? xmlNodeGetContent(n) : NULL;
	char *ret = content && *content ? g_utf8_make_valid((const char *)content, -1) : NULL;
	xmlFree(content);
	return ret ? g_strstrip(ret) : NULL;
}

static char *attribute(const xmlNode *n, const char *name)
{
	xmlChar *value = xmlGetNoNsProp(n, (const xmlChar *)name);
	char *ret = value ? g_strdup((const char *)value) : NULL;
	xmlFree(value);
	return ret;
}

static bool type_is(const xmlNode *n, const char *type)
{
	g_autofree char *value = attribute(n, "type");
	return g_strcmp0(value, type) == 0;
}

/* ---- numbers ---- */

static bool read_double(const char *at, double *ret)
{
	char *end;
	*ret = g_ascii_strtod(at, &end);
	return end != at && !*end;
}

static bool number_of(const struct reading *r, const xmlNode *n, const char *name, double without,
	double *ret, GError **error)
{
	g_autofree char *value = attribute(n, name);
	*ret = without;
	if (!value || read_double(g_strstrip(value), ret))
		return true;
	return refuse(error, r, "line %ld of its XML: %s of '%s' is no number", xmlGetLineNo(n),
		name, n->name);
}

static bool integer_of(const struct reading *r, const xmlNode *n, const char *name, int64_t without,
	int64_t *ret, GError **error)
{
	g_autofree char *value = attribute(n, name);
	*ret = without;
	if (!value ||
		g_ascii_string_to_signed(g_strstrip(value), 10, INT64_MIN, INT64_MAX, ret, NULL))
		return true;
	return refuse(error, r, "line %ld of its XML: %s of '%s' is no whole number",
		xmlGetLineNo(n), name, n->name);
}

/* What stands in an element, by its type; an empty one is 0. false: no number. */
static bool value_of(const xmlNode *n, double *ret)
{
	g_autofree char *content = text(n);
	double scale = 1, offset = 0;
	*ret = 0;
	if (content && !read_double(content, ret))
		return false;
	if (type_is(n, "ScaledInteger")) {
		g_autofree char *scaled = attribute(n, "scale"), *moved = attribute(n, "offset");
		if ((scaled && !read_double(scaled, &scale)) ||
			(moved && !read_double(moved, &offset)))
			return false;
	}
	*ret = *ret * scale + offset;
	return isfinite(*ret);
}

static bool value_at(const xmlNode *n, const char *name, double *ret)
{
	const xmlNode *c = child(n, name);
	return c && value_of(c, ret);
}

static struct e57_limits limits_of(const xmlNode *n, const char *least, const char *most)
{
	struct e57_limits l = { 0 };
	l.given = value_at(n, least, &l.least) && value_at(n, most, &l.most) && l.most > l.least;
	return l;
}

/* ---- poses ---- */

static void quaternion_to_rotation(const double q[4], struct pose *ret)
{
	double w = q[0], x = q[1], y = q[2], z = q[3];
	double m[3][3] = { { 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y) },
		{ 2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x) },
		{ 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y) } };
	for (int i = 0; i < 9; i++)
		ret->rotation[i / 3][i % 3] = m[i / 3][i % 3];
}

static void set_if_given(const xmlNode *n, const char *const names[], int count, double *value)
{
	for (int i = 0; n && i < count; i++)
		value_at(n, names[i], &value[i]);
}

/* false: what is there is no motion. */
static bool pose_of(const xmlNode *n, bool *ret_has, struct pose *ret)
{
	static const char *const of_rotation[] = { "w", "x", "y", "z" };
	const xmlNode *pose = child(n, "pose");
	double q[4] = { 1, 0, 0, 0 };
	*ret = POSE_IDENTITY;
	*ret_has = pose;
	if (!pose)
		return true;
	set_if_given(child(pose, "rotation"), of_rotation, 4, q);
	set_if_given(child(pose, "translation"), of_rotation + 1, 3, ret->translation_m);
	double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
	if (!(fabs(length - 1) < 1e-3)) /* not a number neither */
		return false;
	for (int i = 0; i < 4; i++)
		q[i] /= length;
	quaternion_to_rotation(q, ret);
	return pose_is_rigid(ret, 1e-9);
}

/* ---- points ---- */

static void field_clear(gpointer data)
{
	g_free(((struct e57_field *)data)->name);
}

static bool read_whole(
	const struct reading *r, const xmlNode *n, struct e57_field *f, GError **error)
{
	f->kind = type_is(n, "ScaledInteger") ? E57_SCALED : E57_INTEGER;
	if (!integer_of(r, n, "minimum", INT64_MIN, &f->minimum, error) ||
		!integer_of(r, n, "maximum", INT64_MAX, &f->maximum, error))
		return false;
	if (f->kind == E57_SCALED && (!number_of(r, n, "scale", 1, &f->scale, error) ||
					     !number_of(r, n, "offset", 0, &f->offset, error)))
		return false;
	if (f->minimum > f->maximum || !isfinite(f->scale) || !isfinite(f->offset))
		return refuse(error, r, "line %ld of its XML: the range of '%s' cannot be",
			xmlGetLineNo(n), n->name);
	double a = (double)f->minimum * f->scale + f->offset,
	       b = (double)f->maximum * f->scale + f->offset;
	f->least = fmin(a, b);
	f->most = fmax(a, b);
	return true;
}

static bool read_float(
	const struct reading *r, const xmlNode *n, struct e57_field *f, GError **error)
{
	g_autofree char *precision = attribute(n, "precision");
	f->kind = g_strcmp0(precision, "single") ? E57_FLOAT64 : E57_FLOAT32;
	return number_of(r, n, "minimum", -INFINITY, &f->least, error) &&
	       number_of(r, n, "maximum", INFINITY, &f->most, error);
}

/* Streams are those of the leaves, depth first. */
static bool read_fields(
	const struct reading *r, const xmlNode *n, int depth, GArray *into, GError **error)
{
	for (const xmlNode *c = n->children; c; c = c->next) {
		if (c->type != XML_ELEMENT_NODE)
			continue;
		struct e57_field f = {
			.scale = 1, .kind = E57_STRING, .least = -INFINITY, .most = INFINITY
		};
		bool good = true;
		if (type_is(c, "Structure") || type_is(c, "Vector")) {
			if (depth > 8)
				return refuse(
					error, r, "line %ld of its XML: too deep", xmlGetLineNo(c));
			if (!read_fields(r, c, depth + 1, into, error))
				return false;
			continue;
		}
		if (type_is(c, "Integer") || type_is(c, "ScaledInteger"))
			good = read_whole(r, c, &f, error);
		else if (type_is(c, "Float"))
			good = read_float(r, c, &f, error);
		else if (!type_is(c, "String"))
			good = refuse(error, r,
				"line %ld of its XML: '%s' has no type that is known",
				xmlGetLineNo(c), c->name);
		if (!good)
			return false;
		if (into->len == FIELDS_MAX)
			return refuse(error, r,
				"line %ld of its XML: more fields than a packet has room for",
				xmlGetLineNo(c));
		f.name = g_strdup((const char *)c->name);
		f.is_extension = is_extension(c);
		g_array_append_val(into, f);
	}
	return true;
}

static bool offset_of(
	const struct reading *r, const xmlNode *n, uint64_t *ret_logical, GError **error)
{
	int64_t physical;
	if (!integer_of(r, n, "fileOffset", -1, &physical, error))
		return false;
	if (physical < (int64_t)E57_HEADER_BYTES ||
		(uint64_t)physical >= import_source_size(r->file))
		return refuse(error, r,
			"line %ld of its XML: '%s' lies at byte %" G_GINT64_FORMAT
			" of a file of %" G_GUINT64_FORMAT,
			xmlGetLineNo(n), n->name, physical, import_source_size(r->file));
	*ret_logical = e57_logical((uint64_t)physical);
	return true;
}

/* The first codec that is not of the standard, which has but one; NULL: none. */
static char *strange_codec(const xmlNode *codecs)
{
	for (const xmlNode *some = codecs ? codecs->children : NULL; some; some = some->next)
		for (const xmlNode *c = some->children; c; c = c->next)
			if (c->type == XML_ELEMENT_NODE &&
				(is_extension(c) ||
					(!is_named(c, "inputs") && !is_named(c, "bitPackCodec"))))
				return g_strdup((const char *)c->name);
	return NULL;
}

static bool read_points(
	const struct reading *r, const xmlNode *n, struct e57_scan *s, GError **error)
{
	const xmlNode *vector = child(n, "points"), *prototype = child(vector, "prototype");
	int64_t count;
	if (!vector || !type_is(vector, "CompressedVector") || !prototype)
		return true;
	if (!integer_of(r, vector, "recordCount", 0, &count, error) ||
		!read_fields(r, prototype, 0, s->fields, error))
		return false;
	if (count < 0)
		return refuse(error, r,
			"line %ld of its XML: %" G_GINT64_FORMAT " records cannot be",
			xmlGetLineNo(vector), count);
	s->count = (uint64_t)count;
	s->has_points = count > 0;
	s->codec = strange_codec(child(vector, "codecs"));
	return !s->has_points || offset_of(r, vector, &s->section, error);
}

static void scan_free(gpointer data)
{
	struct e57_scan *s = data;
	g_free(s->guid);
	g_free(s->name);
	g_free(s->codec);
	g_array_unref(s->fields);
	g_free(s);
}

static bool read_scan(const struct reading *r, const xmlNode *n, GError **error)
{
	static const char *const colours[3][2] = { { "colorRedMinimum", "colorRedMaximum" },
		{ "colorGreenMinimum", "colorGreenMaximum" },
		{ "colorBlueMinimum", "colorBlueMaximum" } };
	struct e57_scan *s = g_new0(struct e57_scan, 1);
	s->fields = g_array_new(false, true, sizeof(struct e57_field));
	g_array_set_clear_func(s->fields, field_clear);
	g_ptr_array_add(r->tree->scans, s);
	s->guid = text(child(n, "guid"));
	s->name = text(child(n, "name"));
	if (s->guid)
		g_hash_table_insert(r->by_guid, s->guid, GUINT_TO_POINTER(r->tree->scans->len));
	if (!pose_of(n, &s->has_pose, &s->pose))
		return refuse(error, r, "line %ld of its XML: the pose of scan %u is no motion",
			xmlGetLineNo(n), r->tree->scans->len);
	s->intensity =
		limits_of(child(n, "intensityLimits"), "intensityMinimum", "intensityMaximum");
	for (int i = 0; i < 3; i++)
		s->colour[i] = limits_of(child(n, "colorLimits"), colours[i][0], colours[i][1]);
	s->rows = limits_of(child(n, "indexBounds"), "rowMinimum", "rowMaximum");
	s->columns = limits_of(child(n, "indexBounds"), "columnMinimum", "columnMaximum");
	return read_points(r, n, s, error);
}

/* ---- pictures ---- */

static void image_free(gpointer data)
{
	struct e57_image *i = data;
	g_free(i->name);
	g_free(i);
}

static const struct representation {
	const char *element, *kind;
} representations[] = { { "sphericalRepresentation", "spherical" },
	{ "pinholeRepresentation", "pinhole" }, { "cylindricalRepresentation", "cylindrical" },
	{ "visualReferenceRepresentation", "visual reference" } };

/* NULL, or why there is none that can be used. All together are not more than the file: else one could stand for thousands. */
static const char *read_blob(const struct reading *r, const xmlNode *of, struct e57_image *i)
{
	const xmlNode *jpeg = child(of, "jpegImage"), *blob = jpeg ? jpeg : child(of, "pngImage");
	uint64_t size = import_source_size(r->file);
	int64_t bytes = 0;
	if (!blob || !integer_of(r, blob, "length", 0, &bytes, NULL) || bytes <= 0)
		return "has no JPEG or PNG";
	if ((uint64_t)bytes > size || !offset_of(r, blob, &i->section, NULL))
		return "lies outside the file";
	if ((uint64_t)bytes > size - *r->pictures)
		return "was left out: with those before it is more than the file";
	*r->pictures += (uint64_t)bytes;
	i->bytes = (uint64_t)bytes;
	i->extension = jpeg ? "jpg" : "png";
	return NULL;
}

static void read_camera(const xmlNode *of, struct e57_image *i)
{
	double width = 0, height = 0;
	value_at(of, "imageWidth", &width);
	value_at(of, "imageHeight", &height);
	i->width = width >= 0 && width < 1e6 ? (int64_t)width : 0;
	i->height = height >= 0 && height < 1e6 ? (int64_t)height : 0;
	value_at(of, "pixelWidth", &i->pixel_width);
	value_at(of, "pixelHeight", &i->pixel_height);
	value_at(of, "focalLength", &i->focal_m);
}

static void read_image(const struct reading *r, const xmlNode *n, unsigned number)
{
	struct e57_image *i = g_new0(struct e57_image, 1);
	g_autofree char *guid = text(child(n, "associatedData3DGuid"));
	const char *why = "has no JPEG or PNG";
	i->number = number;
	i->name = text(child(n, "name"));
	i->scan = GPOINTER_TO_UINT(guid ? g_hash_table_lookup(r->by_guid, guid) : NULL) - 1;
	i->has_pose = pose_of(n, &i->has_pose, &i->pose) && i->has_pose;
	for (size_t k = 0; k < G_N_ELEMENTS(representations) && !i->kind; k++) {
		const xmlNode *of = child(n, representations[k].element);
		if (!of || (why = read_blob(r, of, i)))
			continue;
		i->kind = representations[k].kind;
		read_camera(of, i);
	}
	if (i->kind) {
		g_ptr_array_add(r->tree->images, i);
		return;
	}
	image_free(i);
	g_ptr_array_add(r->tree->passed_over, g_strdup_printf("picture %u %s", number, why));
}

/* ---- the whole ---- */

static bool read_vectors(const struct reading *r, const xmlNode *root, GError **error)
{
	const xmlNode *scans = child(root, "data3D"), *images = child(root, "images2D");
	unsigned number = 0;
	for (const xmlNode *c = scans ? scans->children : NULL; c; c = c->next)
		if (c->type == XML_ELEMENT_NODE && !read_scan(r, c, error))
			return false;
	for (const xmlNode *c = images ? images->children : NULL; c; c = c->next)
		if (c->type == XML_ELEMENT_NODE)
			read_image(r, c, ++number);
	return true;
}

static bool read_root(const struct reading *r, const xmlDoc *doc, GError **error)
{
	const xmlNode *root = xmlDocGetRootElement(doc);
	if (!is_named(root, "e57Root"))
		return refuse(error, r, "line %ld of its XML: '%s' should be e57Root",
			xmlGetLineNo(root), root->name);
	return read_vectors(r, root, error);
}

e57_tree *e57_tree_read(e57_pages *pages, import_source *file, GError **error)
{
	e57_tree *t = g_new0(e57_tree, 1);
	t->scans = g_ptr_array_new_with_free_func(scan_free);
	t->images = g_ptr_array_new_with_free_func(image_free);
	t->passed_over = g_ptr_array_new_with_free_func(g_free);
	g_autoptr(GHashTable) by_guid = g_hash_table_new(g_str_hash, g_str_equal);
	uint64_t pictures = 0;
	struct reading r = { file, t, by_guid, &pictures };
	xmlDoc *doc = e57_xml_read(pages, file, error);
	bool good = doc && read_root(&r, doc, error);
	xmlFreeDoc(doc);
	if (good)
		return t;
	e57_tree_free(t);
	return NULL;
}

void e57_tree_free(e57_tree *t)
{
	if (!t)
		return;
	g_ptr_array_unref(t->scans);
	g_ptr_array_unref(t->images);
	g_ptr_array_unref(t->passed_over);
	g_free(t);
}
