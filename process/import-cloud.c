#include "process/import-cloud.h"
#include "acquire/panorama.h"
#include <gio/gio.h>
#include <math.h>
#include <string.h>
#include <unistd.h>

#define COORDINATE_MAX_M 1e9
/* Coordinates beyond are of a map, and get an origin. */
#define LOCAL_MAX_M 1000.0
/* No scanner reaches so far. */
#define SCANNER_REACH_M 10000.0
#define SAMPLES         4000u
#define REACH_MAX       8u

struct raw_point {
	double xyz_m[3]; /* NAN: none */
	float intensity, rgb[3];
	uint8_t classification, return_number, cell;
};

struct import_cloud {
	import_source *file;
	uint32_t has; /* a bit a role */
	enum cloud_type type[CLOUD_ROLES];
	struct raw_point *raw;
	uint64_t count, reserved, at;
	float intensity_min, intensity_max, colour_max;
	struct import_scan scan;
};

/* ---- columns ---- */

static const struct {
	const char *names;
	enum cloud_role role;
} roles[] = { { "x", CLOUD_X }, { "y", CLOUD_Y }, { "z", CLOUD_Z },
	{ "intensity scalar_intensity reflectance scalar_reflectance reflectivity "
	  "scalar_reflectivity remission",
		CLOUD_INTENSITY },
	{ "red diffuse_red r", CLOUD_RED }, { "green diffuse_green g", CLOUD_GREEN },
	{ "blue diffuse_blue b", CLOUD_BLUE }, { "rgb rgba", CLOUD_RGB },
	{ "classification scalar_classification class scalar_class label scalar_label",
		CLOUD_CLASS },
	{ "return_number scalar_return_number returnnumber scalar_returnnumber", CLOUD_RETURN },
	{ "cell", CLOUD_CELL } };

/* Whether it is one of the words, without regard to case. */
static bool is_among(const char *name, size_t length, const char *words)
{
	for (const char *at = words; *at;) {
		size_t word = strcspn(at, " ");
		if (word == length && g_ascii_strncasecmp(at, name, length) == 0)
			return true;
		at += word;
		at += *at == ' ';
	}
	return false;
}

enum cloud_role cloud_role_of(const char *name)
{
	size_t length = strlen(name);
	for (size_t i = 0; i < G_N_ELEMENTS(roles) && length; i++)
		if (is_among(name, length, roles[i].names))
			return roles[i].role;
	return CLOUD_NONE;
}

const uint8_t cloud_type_bytes[CLOUD_TYPES] = { 1, 1, 2, 2, 4, 4, 8, 8, 4, 8 };

#define GET(type)                                                                                  \
	{                                                                                          \
		type value;                                                                        \
		memcpy(&value, at, sizeof value);                                                  \
		return (double)value;                                                              \
	}
double cloud_type_get(enum cloud_type type, const void *at)
{
	switch (type) {
	case CLOUD_I8: GET(int8_t)
	case CLOUD_U8: GET(uint8_t)
	case CLOUD_I16: GET(int16_t)
	case CLOUD_U16: GET(uint16_t)
	case CLOUD_I32: GET(int32_t)
	case CLOUD_U32: GET(uint32_t)
	case CLOUD_I64: GET(int64_t)
	case CLOUD_U64: GET(uint64_t)
	case CLOUD_F32: GET(float)
	case CLOUD_F64: GET(double)
	default: return NAN;
	}
}

double cloud_role_get(enum cloud_role role, enum cloud_type type, const void *at)
{
	return cloud_type_get(role == CLOUD_RGB && type == CLOUD_F32 ? CLOUD_U32 : type, at);
}

import_cloud *import_cloud_new(import_source *file)
{
	import_cloud *c = g_new0(import_cloud, 1);
	c->file = file;
	c->intensity_min = INFINITY;
	c->intensity_max = -INFINITY;
	c->scan.order = IMPORT_ROW_BY_ROW;
	c->scan.pose = POSE_IDENTITY;
	return c;
}

void import_cloud_free(import_cloud *c)
{
	if (!c)
		return;
	g_free(c->raw);
	g_free(c);
}

static bool has(const import_cloud *c, enum cloud_role role)
{
	return c->has & (1u << role);
}

bool import_cloud_column(import_cloud *c, enum cloud_role role, enum cloud_type type,
	const char *name, GError **error)
{
	if (role == CLOUD_NONE)
		return true;
	if (has(c, role))
		return import_refuse(error, c->file, G_IO_ERROR_INVALID_DATA,
			"its header has two columns for what '%s' is", name);
	c->has |= 1u << role;
	c->type[role] = type;
	return true;
}

/* ---- points ---- */

static uint64_t physical_bytes(void)
{
	long pages = sysconf(_SC_PHYS_PAGES), bytes = sysconf(_SC_PAGESIZE);
	return pages > 0 && bytes > 0 ? (uint64_t)pages * (uint64_t)bytes : G_MAXUINT64;
}

static bool refuse_size(const import_cloud *c, uint64_t count, uint64_t bytes, GError **error)
{
	return import_refuse(error, c->file, G_IO_ERROR_NOT_SUPPORTED,
		"to read its %" G_GUINT64_FORMAT
		" points takes %.1f GB of memory, and this machine has %.1f GB",
		count, (double)bytes / 1e9, (double)physical_bytes() / 1e9);
}

bool import_cloud_reserve(import_cloud *c, uint64_t count, uint64_t other_bytes, GError **error)
{
	uint64_t bytes = count < G_MAXUINT64 / 256 ? count * sizeof *c->raw : G_MAXUINT64 / 2;
	bytes += MIN(other_bytes, G_MAXUINT64 / 2);
	if (!has(c, CLOUD_X) || !has(c, CLOUD_Y) || !has(c, CLOUD_Z))
		return import_refuse(
			error, c->file, G_IO_ERROR_INVALID_DATA, "its points have no x, y and z");
	if (count == 0)
		return import_refuse(error, c->file, G_IO_ERROR_INVALID_DATA, "has no points");
	if (bytes > physical_bytes() / 4 * 3 || !(c->raw = g_try_malloc(count * sizeof *c->raw)))
		return refuse_size(c, count, bytes, error);
	c->reserved = count;
	return true;
}

static uint8_t byte_of(double value)
{
	return value >= 0 && value <= 255 ? (uint8_t)value : 0;
}

static void take_colour(import_cloud *c, struct raw_point *p, const double value[CLOUD_ROLES])
{
	static const enum cloud_role rgb[3] = { CLOUD_RED, CLOUD_GREEN, CLOUD_BLUE };
	double v = has(c, CLOUD_RGB) ? value[CLOUD_RGB] : 0;
	uint32_t packed = v >= G_MININT32 && v <= G_MAXUINT32 ? (uint32_t)(int64_t)v : 0;
	for (int i = 0; i < 3; i++) {
		p->rgb[i] = (float)(packed >> (16 - 8 * i) & 255);
		if (has(c, rgb[i]))
			p->rgb[i] = isfinite(value[rgb[i]]) ? (float)value[rgb[i]] : 0;
		if (p->rgb[i] > c->colour_max)
			c->colour_max = p->rgb[i];
	}
}

static void take_intensity(import_cloud *c, struct raw_point *p, double value)
{
	p->intensity = (float)value;
	if (!isfinite(p->intensity))
		p->intensity = NAN;
	c->intensity_min = fminf(c->intensity_min, p->intensity);
	c->intensity_max = fmaxf(c->intensity_max, p->intensity);
}

void import_cloud_add(import_cloud *c, const double value[CLOUD_ROLES])
{
	g_assert(c->count < c->reserved);
	struct raw_point *p = &c->raw[c->count++];
	*p = (struct raw_point){ { value[CLOUD_X], value[CLOUD_Y], value[CLOUD_Z] } };
	bool zero = p->xyz_m[0] == 0 && p->xyz_m[1] == 0 && p->xyz_m[2] == 0;
	bool finite = isfinite(p->xyz_m[0]) && isfinite(p->xyz_m[1]) && isfinite(p->xyz_m[2]);
	if (has(c, CLOUD_CELL))
		p->cell = byte_of(value[CLOUD_CELL]);
	if (zero || !finite) {
		p->xyz_m[0] = NAN;
		return;
	}
	if (has(c, CLOUD_INTENSITY))
		take_intensity(c, p, value[CLOUD_INTENSITY]);
	if (has(c, CLOUD_RGB) || has(c, CLOUD_RED))
		take_colour(c, p, value);
	p->classification = has(c, CLOUD_CLASS) ? byte_of(value[CLOUD_CLASS]) : 0;
	p->return_number = has(c, CLOUD_RETURN) ? byte_of(value[CLOUD_RETURN]) : 1;
}

void import_cloud_set_grid(import_cloud *c, uint32_t columns, uint32_t rows)
{
	c->scan.columns = columns;
	c->scan.rows = rows;
}

bool import_cloud_spread(
	import_cloud *c, const int64_t *index, uint32_t columns, uint32_t rows, GError **error)
{
	uint64_t cells = (uint64_t)columns * rows;
	struct raw_point *spread = g_try_malloc(cells * sizeof *spread);
	if (!spread)
		return refuse_size(c, cells, cells * sizeof *spread, error);
	for (uint64_t i = 0; i < cells; i++) {
		spread[i] = (struct raw_point){ { NAN } };
		if (index[i] >= 0 && (uint64_t)index[i] < c->count)
			spread[i] = c->raw[index[i]];
	}
	g_free(c->raw);
	c->raw = spread;
	c->count = c->reserved = cells;
	import_cloud_set_grid(c, columns, rows);
	return true;
}

void import_cloud_set_pose(import_cloud *c, const struct pose *pose)
{
	const double *at_m = pose->translation_m;
	c->scan.has_pose = at_m[0] != 0 || at_m[1] != 0 || at_m[2] != 0;
	if (c->scan.has_pose)
		c->scan.pose = *pose;
}

/* ---- what kind of grid ---- */

static bool is_there(const struct raw_point *p)
{
	return !isnan(p->xyz_m[0]);
}

/* Cosine of the angle between two points as seen from the origin; 2: one of them is none. */
static double cosine_between(const import_cloud *c, uint64_t i, uint64_t j)
{
	const double *a = c->raw[i].xyz_m, *b = c->raw[j].xyz_m;
	if (!is_there(&c->raw[i]) || !is_there(&c->raw[j]))
		return 2;
	double dot = 0, aa = 0, bb = 0;
	for (int k = 0; k < 3; k++) {
		dot += a[k] * b[k];
		aa += a[k] * a[k];
		bb += b[k] * b[k];
	}
	return dot / sqrt(aa * bb);
}

static int by_value(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

/* Median angle between cells that are so far apart in the file, over cells spread evenly; NAN: too few. */
static double median_angle(const import_cloud *c, uint64_t apart, bool same_row)
{
	g_autofree double *angle = g_new(double, SAMPLES);
	size_t count = 0;
	for (uint64_t k = 0; k < SAMPLES; k++) {
		double spread = (double)k * 0.6180339887498949;
		uint64_t i = (uint64_t)((spread - floor(spread)) * (double)c->count);
		if (i + apart >= c->count ||
			(same_row && i % c->scan.columns + apart >= c->scan.columns))
			continue;
		double cosine = cosine_between(c, i, i + apart);
		if (cosine <= 1.5)
			angle[count++] = acos(CLAMP(cosine, -1, 1));
	}
	qsort(angle, count, sizeof *angle, by_value);
	return count < 20 ? NAN : angle[count / 2];
}

/* Beams that were coarser than their grid leave rows or columns empty: the nearest neighbours that there are. */
static double nearest_angle(const import_cloud *c, uint64_t step, bool same_row)
{
	double angle = NAN;
	for (uint64_t reach = 1; reach <= REACH_MAX && isnan(angle); reach++)
		angle = median_angle(c, reach * step, same_row);
	return angle;
}

/* Neighbours of a grid that was looked at from the origin are next to each other there. */
static bool seen_from_origin(const import_cloud *c)
{
	uint64_t far = c->count / 3 + c->scan.columns / 3 + 1;
	double across = nearest_angle(c, 1, true), down = nearest_angle(c, c->scan.columns, false),
	       anywhere = median_angle(c, far, false);
	return across < anywhere / 4 && down < anywhere / 4;
}

struct correlation {
	double n, a, b, aa, bb, ab;
};

static void correlate(struct correlation *k, double a, double b)
{
	k->n++;
	k->a += a;
	k->b += b;
	k->aa += a * a;
	k->bb += b * b;
	k->ab += a * b;
}

static double coefficient(const struct correlation *k)
{
	double up = k->ab - k->a * k->b / k->n;
	return up / sqrt((k->aa - k->a * k->a / k->n) * (k->bb - k->b * k->b / k->n));
}

/* All before it, and its columns go with x, its rows with y. */
static bool seen_by_camera(const import_cloud *c)
{
	struct correlation across = { 0 }, down = { 0 };
	for (uint64_t i = 0; i < c->count; i++) {
		const double *p = c->raw[i].xyz_m;
		if (!is_there(&c->raw[i]))
			continue;
		if (!(p[2] > 0))
			return false;
		correlate(&across, (double)(i % c->scan.columns), p[0] / p[2]);
		correlate(&down, (double)(i / c->scan.columns), p[1] / p[2]);
	}
	return across.n > 20 && coefficient(&across) > 0.9 && coefficient(&down) > 0.9;
}

/* A scanner's x is the camera's x, its y (forward) the camera's z, its z (up) the camera's -y. */
static void turn_camera(import_cloud *c)
{
	static const struct pose back = { { { 1, 0, 0 }, { 0, 0, -1 }, { 0, 1, 0 } }, { 0 } };
	for (uint64_t i = 0; i < c->count; i++) {
		double *p = c->raw[i].xyz_m, y = p[1];
		p[1] = p[2];
		p[2] = -y;
	}
	if (c->scan.has_pose)
		c->scan.pose = pose_compose(&c->scan.pose, &back);
	c->scan.note =
		"a camera's axes (x right, y down, z forward) became a scanner's (x right, y "
		"forward, z up)";
}

/* ---- records ---- */

static bool look_over(import_cloud *c, bool *ret_map, GError **error)
{
	uint64_t measured = 0;
	*ret_map = false;
	for (uint64_t i = 0; i < c->count; i++) {
		const struct raw_point *p = &c->raw[i];
		if (!is_there(p))
			continue;
		for (int k = 0; k < 3; k++) {
			if (!(fabs(p->xyz_m[k]) <= COORDINATE_MAX_M))
				return import_refuse(error, c->file, G_IO_ERROR_INVALID_DATA,
					"point %" G_GUINT64_FORMAT
					": %g m is too far to be a point",
					i + 1, p->xyz_m[k]);
			*ret_map |= fabs(p->xyz_m[k]) > SCANNER_REACH_M;
		}
		measured++;
	}
	return measured || import_refuse(error, c->file, G_IO_ERROR_INVALID_DATA,
				   "none of its points has finite coordinates other than 0 0 0");
}

/* Whole metres at the first point, along the axes where coordinates are a map's: the others stay as exact as they are. */
static void set_origin(import_cloud *c)
{
	uint64_t i = 0;
	while (!is_there(&c->raw[i]))
		i++;
	for (int k = 0; k < 3; k++) {
		double at_m = c->raw[i].xyz_m[k];
		if (fabs(at_m) <= LOCAL_MAX_M)
			continue;
		c->scan.origin_m[k] = rint(at_m);
		c->scan.has_pose = true;
	}
}

bool import_cloud_finish(import_cloud *c, GError **error)
{
	struct import_scan *s = &c->scan;
	bool map;
	if (!look_over(c, &map, error))
		return false;
	if (s->columns && (map || !seen_from_origin(c)))
		s->columns = s->rows = 0;
	if (s->columns && seen_by_camera(c))
		turn_camera(c);
	if (!s->columns)
		set_origin(c);
	s->count = c->count;
	s->have = (has(c, CLOUD_INTENSITY) ? POINTS_HAVE_INTENSITY : 0) |
		  (has(c, CLOUD_RGB) || has(c, CLOUD_RED) ? POINTS_HAVE_COLOUR : 0) |
		  (has(c, CLOUD_CLASS) ? POINTS_HAVE_CLASSIFICATION : 0);
	return true;
}

const struct import_scan *import_cloud_scan(const import_cloud *c)
{
	return &c->scan;
}

static uint16_t intensity_of(const import_cloud *c, float value)
{
	double low = 0, high = 65535;
	if (!isfinite(value))
		return 0;
	if (c->type[CLOUD_INTENSITY] == CLOUD_U8)
		high = 255;
	else if (c->intensity_min < 0 || c->intensity_max > 65535)
		low = c->intensity_min, high = c->intensity_max;
	else if (c->intensity_max <= 1)
		high = 1;
	else if (c->intensity_max <= 255)
		high = 255;
	double share = high > low ? (value - low) / (high - low) : 0;
	return (uint16_t)(CLAMP(share, 0, 1) * 65535 + 0.5);
}

static uint8_t colour_of(const import_cloud *c, float value)
{
	bool whole = has(c, CLOUD_RGB) || c->type[CLOUD_RED] == CLOUD_U8;
	double full = whole || (c->colour_max > 1 && c->colour_max <= 255) ? 255
		      : c->colour_max <= 1                                 ? 1
									   : 65535;
	return (uint8_t)(CLAMP(value / full, 0, 1) * 255 + 0.5);
}

static struct point_record record_of(const import_cloud *c, const struct raw_point *p)
{
	struct point_record r = { .cell = CELL_MEASURED,
		.classification = p->classification,
		.return_number = MAX(p->return_number, 1) };
	if (!is_there(p)) {
		r.cell = p->cell == CELL_NO_RETURN ? CELL_NO_RETURN : CELL_EMPTY;
		r.return_number = 1;
		return r;
	}
	r.x_m = p->xyz_m[0] - c->scan.origin_m[0];
	r.y_m = p->xyz_m[1] - c->scan.origin_m[1];
	r.z_m = p->xyz_m[2] - c->scan.origin_m[2];
	if (c->scan.have & POINTS_HAVE_INTENSITY)
		r.intensity = intensity_of(c, p->intensity);
	for (int i = 0; i < 3 && c->scan.have & POINTS_HAVE_COLOUR; i++)
		r.rgb[i] = colour_of(c, p->rgb[i]);
	return r;
}

size_t import_cloud_read(import_cloud *c, struct point_record *into, size_t max)
{
	size_t count = 0;
	for (; count < max && c->at < c->count; c->at++) {
		const struct raw_point *p = &c->raw[c->at];
		if (c->scan.columns || is_there(p))
			into[count++] = record_of(c, p);
		else
			c->scan.left_out++;
	}
	return count;
}

double import_cloud_fraction(const import_cloud *c)
{
	return c->count ? (double)c->at / (double)c->count : 0;
}
