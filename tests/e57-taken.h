#ifndef TESTS_E57_TAKEN_H
#define TESTS_E57_TAKEN_H
/* E57 files made by tests, imported into a site of their own. */
#include "tests/e57-made.h"
#include "tests/import-made.h"

struct taken {
	struct place at;
	char *path;
	GArray *scans; /* of struct imported */
	points *p;     /* of the first */
	manifest *m;
};

/* Frees the file. */
static inline struct taken taken_new(GByteArray *file)
{
	struct taken t = { .at = place_new() };
	t.path = place_write(&t.at, "made.e57", file->data, file->len);
	g_byte_array_unref(file);
	t.scans = place_import(&t.at, t.path);
	t.p = place_points(&t.at, 1);
	t.m = place_manifest(&t.at, 1);
	return t;
}

static inline void taken_clear(struct taken *t)
{
	points_free(t->p);
	manifest_free(t->m);
	g_array_unref(t->scans);
	g_free(t->path);
	place_clear(&t->at);
}

static inline const struct imported *taken_scan(const struct taken *t, guint i)
{
	return &g_array_index(t->scans, struct imported, i);
}

/* NULL: there must be no note. */
static inline void taken_assert_note(const struct taken *t, guint i, const char *words)
{
	const char *note = taken_scan(t, i)->note;
	if (!words)
		g_assert_cmpstr(note, ==, NULL);
	else if (!note || !strstr(note, words))
		g_error("\"%s\" has not \"%s\"", note ? note : "no note", words);
}

/* Frees the file, which must be refused. */
static inline void taken_assert_refused(GByteArray *file, int code, const char *words)
{
	struct place at = place_new();
	g_autofree char *path = place_write(&at, "made.e57", file->data, file->len);
	g_byte_array_unref(file);
	place_assert_refused(&at, path, code, words);
	place_clear(&at);
}

static inline GByteArray *made_xml(struct made *m, const char *scans, const char *images)
{
	g_autofree char *xml = made_root_xml(scans, images);
	return made_end(m, xml, strlen(xml));
}

/* mm */
static inline void assert_close(const struct point_record *r, const double at_m[3], double most_mm)
{
	g_assert_cmpint(r->cell, ==, CELL_MEASURED);
	g_assert_cmpfloat(fabs(r->x_m - at_m[0]) * 1000, <=, most_mm);
	g_assert_cmpfloat(fabs(r->y_m - at_m[1]) * 1000, <=, most_mm);
	g_assert_cmpfloat(fabs(r->z_m - at_m[2]) * 1000, <=, most_mm);
}

/* Where point i of a scan without a grid is. */
static inline void scene_point(uint64_t i, double ret_m[3])
{
	double range_m = 2 + (double)(i % 100) / 10, azimuth_rad = 0.05 * (double)i,
	       elevation_rad = 0.7 * sin(0.013 * (double)i);
	ret_m[0] = range_m * cos(elevation_rad) * cos(azimuth_rad);
	ret_m[1] = range_m * cos(elevation_rad) * sin(azimuth_rad);
	ret_m[2] = range_m * sin(elevation_rad);
}

#define XYZ(kind_, least_, most_, scale_, offset_)                                                 \
	{ "cartesianX", kind_, least_, most_, scale_, offset_, NULL },                             \
		{ "cartesianY", kind_, least_, most_, scale_, offset_, NULL },                     \
	{                                                                                          \
		"cartesianZ", kind_, least_, most_, scale_, offset_, NULL                          \
	}
#define DOUBLES XYZ(MADE_FLOAT64, 0, 0, 0, 0)
#define SINGLES XYZ(MADE_FLOAT32, 0, 0, 0, 0)
#define WHOLES(name, least, most)                                                                  \
	{                                                                                          \
		name, MADE_WHOLE, least, most, 0, 0, NULL                                          \
	}

/* The value that the field has for it, rounded as the field does. */
static inline union made_value made_real(const struct made_field *f, double value)
{
	if (f->kind == MADE_WHOLE)
		return (union made_value)WHOLE((int64_t)rint(value));
	if (f->kind == MADE_SCALED)
		return (union made_value)WHOLE((int64_t)rint((value - f->offset) / f->scale));
	return (union made_value)REAL(value);
}

#endif
