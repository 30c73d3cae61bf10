#include "process/export-verify.h"
#include "acquire/panorama.h"
#include "firmware-io/files.h"
#include "process/export-walk.h"
#include <gio/gio.h>
#include <math.h>
#include <string.h>

#define BLOCK_RECORDS 8192u

struct comparing {
	const struct export_job *job;
	const struct import_format *format;
	const char *path;
	bool classes;
	double tolerance_m;
	import_reader *reader;
	const struct import_scan *scan;
	struct point_record block[BLOCK_RECORDS];
	size_t at, count;
	uint64_t points;
};

bool export_refuse_back(GError **error, const char *path, const char *format, ...)
{
	va_list args;
	va_start(args, format);
	g_autofree char *what = g_strdup_vprintf(format, args);
	va_end(args);
	g_set_error(error, G_IO_ERROR, G_IO_ERROR_FAILED, "%s: was read back, and %s", path, what);
	return false;
}

/* The next point of the file; NULL at the end of the scan. */
static bool next_record(struct comparing *c, const struct point_record **ret, GError **error)
{
	for (;;) {
		if (c->at == c->count) {
			c->at = 0;
			if (!c->format->read(c->reader, c->block, BLOCK_RECORDS, &c->count, error))
				return false;
			*ret = NULL;
			if (!c->count)
				return true;
		}
		*ret = &c->block[c->at++];
		if ((*ret)->cell == CELL_MEASURED)
			return true;
	}
}

static bool is_same(const struct comparing *c, const struct export_station *s,
	const struct export_point *p, const struct point_record *r)
{
	const double *o = c->scan->origin_m;
	double x = r->x_m + o[0] - p->at_m[0], y = r->y_m + o[1] - p->at_m[1],
	       z = r->z_m + o[2] - p->at_m[2];
	double most = fmax(fabs(x), fmax(fabs(y), fabs(z)));
	return most <= c->tolerance_m && (!s->survey.has_colour || !memcmp(r->rgb, p->rgb, 3)) &&
	       (!s->survey.has_intensity || r->intensity == p->intensity) &&
	       (!c->classes || r->classification == p->classification);
}

static bool compare_block(struct comparing *c, const struct export_station *s,
	const struct export_point *p, size_t count, GError **error)
{
	for (size_t i = 0; i < count; i++) {
		const struct point_record *r;
		if (!p[i].is_point)
			continue;
		if (!next_record(c, &r, error))
			return false;
		c->points++;
		if (!r || !is_same(c, s, &p[i], r))
			return export_refuse_back(error, c->path,
				"point %" G_GUINT64_FORMAT " of scan %u is %s", c->points,
				s->number, r ? "another one" : "missing");
	}
	return true;
}

static bool compare_station(struct comparing *c, const struct export_station *s, GError **error)
{
	g_autoptr(export_walk) w = export_walk_open(c->job, s, export_order_of(c->job, s), error);
	const struct export_point *p;
	for (size_t count = 1; w && count;)
		if (!export_walk_next(w, &p, &count, error) ||
			!compare_block(c, s, p, count, error))
			return false;
	return w;
}

static bool is_at_end(struct comparing *c, GError **error)
{
	const struct point_record *r;
	if (!next_record(c, &r, error))
		return false;
	return !r || export_refuse_back(error, c->path, "it has more points than were written");
}

static bool compare_pose(const struct comparing *c, const struct export_station *s, GError **error)
{
	struct pose none = POSE_IDENTITY, wanted = s->has_pose ? s->pose : none,
		    found = c->scan->has_pose ? c->scan->pose : none,
		    apart = pose_between(&wanted, &found);
	if (export_is_merged(c->job) ||
		(pose_angle_rad(&apart) < 1e-7 && pose_distance_m(&apart) < 2e-6))
		return true;
	return export_refuse_back(error, c->path, "scan %u stands elsewhere", s->number);
}

static bool next_scan(struct comparing *c, GError **error)
{
	enum import_result got = c->format->next_scan(c->reader, &c->scan, error);
	c->at = c->count = 0;
	c->points = 0;
	return got == IMPORT_SCAN ||
	       (got == IMPORT_END && export_refuse_back(error, c->path, "a scan is missing"));
}

static bool compare_all(struct comparing *c, GError **error)
{
	const struct import_scan *more;
	for (guint i = 0; i < c->job->stations->len; i++) {
		const struct export_station *s = export_station_at(c->job, i);
		bool begins = i == 0 || !export_is_merged(c->job);
		if (begins && (!next_scan(c, error) || !compare_pose(c, s, error)))
			return false;
		bool ends = i + 1 == c->job->stations->len || !export_is_merged(c->job);
		if (!compare_station(c, s, error) || (ends && !is_at_end(c, error)))
			return false;
	}
	enum import_result got = c->format->next_scan(c->reader, &more, error);
	if (got == IMPORT_BAD)
		return false;
	return got == IMPORT_END ||
	       export_refuse_back(error, c->path, "it has more scans than were written");
}

bool export_verify_by_import(const struct export_job *j, const struct import_format *format,
	const char *path, bool classes, GError **error)
{
	g_autoptr(import_source) file = import_source_open(path, error);
	g_autofree struct comparing *c = g_new0(struct comparing, 1);
	*c = (struct comparing){ .job = j,
		.format = format,
		.path = path,
		.classes = classes,
		/* Doubles of map coordinates have steps of their own. */
		.tolerance_m = j->format->resolution_m(j) * 0.5 + 4e-9 };
	c->reader = file ? format->open(file, NULL, error) : NULL;
	bool good = c->reader && compare_all(c, error);
	if (c->reader)
		format->close(c->reader);
	return good;
}

/* ---- record for record ---- */

struct matching {
	const struct export_records *records;
	const char *path;
	FILE *file;
	uint64_t count;
};

static bool is_cut(const struct matching *m, GError **error)
{
	if (ferror(m->file))
		return files_fail(error, m->path, "be read back");
	return export_refuse_back(error, m->path, "it ends early");
}

static bool match_header(const struct matching *m, GError **error)
{
	size_t length = m->records->header_bytes;
	g_autofree uint8_t *found = g_malloc(length);
	if (fread(found, 1, length, m->file) != length)
		return is_cut(m, error);
	return !m->records->header || !memcmp(found, m->records->header, length) ||
	       export_refuse_back(error, m->path, "its header is another one");
}

static bool match_block(struct matching *m, const struct export_station *s,
	const struct export_point *p, size_t count, GError **error)
{
	uint8_t wanted[EXPORT_RECORD_MAX], found[EXPORT_RECORD_MAX];
	size_t length = m->records->record_bytes;
	for (size_t i = 0; i < count; i++) {
		if (!p[i].is_point && !m->records->cells_too)
			continue;
		m->count++;
		m->records->encode(m->records->user_data, s, &p[i], wanted);
		if (fread(found, 1, length, m->file) != length)
			return is_cut(m, error);
		if (memcmp(wanted, found, length))
			return export_refuse_back(error, m->path,
				"point %" G_GUINT64_FORMAT " is another one", m->count);
	}
	return true;
}

static bool match_all(struct matching *m, const struct export_job *j, GError **error)
{
	if (!match_header(m, error))
		return false;
	for (guint i = 0; i < j->stations->len; i++) {
		const struct export_station *s = export_station_at(j, i);
		g_autoptr(export_walk) w = export_walk_open(j, s, export_order_of(j, s), error);
		const struct export_point *p;
		for (size_t count = 1; w && count;)
			if (!export_walk_next(w, &p, &count, error) ||
				!match_block(m, s, p, count, error))
				return false;
		if (!w)
			return false;
	}
	return true;
}

bool export_verify_records(const struct export_job *j, const struct export_records *records,
	const char *path, GError **error)
{
	struct matching m = { .records = records, .path = path };
	m.file = fopen(path, "re");
	if (!m.file)
		return files_fail(error, path, "be read back");
	bool good = match_all(&m, j, error);
	fclose(m.file);
	return good;
}
