#include "process/import-scan.h"
#include "acquire/panorama.h"
#include "acquire/scan.h"
#include "acquire/surface.h"
#include "firmware-io/files.h"
#include "process/pose-json.h"
#include <errno.h>
#include <fcntl.h>
#include <glib/gstdio.h>
#include <json-glib/json-glib.h>
#include <math.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#define BLOCK_RECORDS 32768

void imported_clear(struct imported *i)
{
	g_clear_pointer(&i->grid, g_free);
	g_clear_pointer(&i->note, g_free);
}

void staged_scan_free(struct staged_scan *s)
{
	if (!s)
		return;
	import_hash_free(s->hash);
	g_clear_pointer(&s->pictures, json_array_unref);
	imported_clear(&s->result);
	g_free(s->folder);
	g_free(s);
}

/* ---- reading ---- */

struct reading {
	struct staged_scan *staged;
	import_source *file;
	const struct import_format *format;
	import_reader *reader;
	const struct import_options *options;
	char *doing;
	struct point_record *block;
	const struct import_scan *scan;
	uint32_t begun; /* as the scan had it */
};

static bool go_on(const struct reading *r, GError **error)
{
	double fraction = r->format->fraction(r->reader);
	if (!r->options->progress ||
		r->options->progress(fraction, r->doing, r->options->user_data))
		return true;
	g_set_error_literal(error, G_IO_ERROR, G_IO_ERROR_CANCELLED, "stopped");
	return false;
}

/* A block of records, and what they count; *ret_count 0 at the end. */
static bool next_block(struct reading *r, uint64_t limit, size_t *ret_count, GError **error)
{
	struct staged_scan *s = r->staged;
	if (!go_on(r, error) ||
		!r->format->read(r->reader, r->block, BLOCK_RECORDS, ret_count, error))
		return false;
	if (r->scan->begun != r->begun) {
		r->begun = r->scan->begun;
		s->records = s->result.points = 0;
	}
	if (*ret_count > limit - s->records)
		return import_refuse(
			error, r->file, G_IO_ERROR_INVALID_DATA, "has more points than it tells");
	s->records += *ret_count;
	for (size_t i = 0; i < *ret_count; i++)
		s->result.points += r->block[i].cell == CELL_MEASURED;
	return true;
}

static size_t drop_cells_without_point(struct point_record *records, size_t count)
{
	size_t kept = 0;
	for (size_t i = 0; i < count; i++)
		if (records[i].cell == CELL_MEASURED)
			records[kept++] = records[i];
	return kept;
}

static points_writer *open_points(
	const struct staged_scan *s, uint32_t columns, uint32_t rows, GError **error)
{
	g_autofree char *path = g_build_filename(s->folder, "points.ply", NULL);
	return points_writer_new(path, columns, rows, error);
}

/* ---- the surface ---- */

static surface_writer *open_surface(const struct staged_scan *s, GError **error)
{
	g_autofree char *path = g_build_filename(s->folder, "surface.ply", NULL);
	return surface_writer_new(path, error);
}

/* Such a format has no cells without a point. */
static bool append_surface(struct reading *r, surface_writer *w, size_t count, GError **error)
{
	const struct surface_record *known = r->format->surface(r->reader);
	return surface_writer_append(w, known, count, error);
}

static bool finish_surface(struct staged_scan *s, surface_writer *w, GError **error)
{
	g_autofree char *path = g_build_filename(s->folder, "surface.ply", NULL);
	GStatBuf st;
	if (!surface_writer_finish(w, error))
		return false;
	if (g_stat(path, &st))
		return files_fail(error, path, "look at it");
	s->surface_bytes = (uint64_t)st.st_size;
	return true;
}

static bool read_cloud(struct reading *r, uint64_t limit, GError **error)
{
	g_autoptr(points_writer) w = open_points(r->staged, 0, 0, error);
	g_autoptr(surface_writer) s = NULL;
	if (!w || (r->format->surface && !(s = open_surface(r->staged, error))))
		return false;
	for (size_t count = 1; count;) {
		if (!next_block(r, limit, &count, error) ||
			(s && !append_surface(r, s, count, error)))
			return false;
		size_t kept = drop_cells_without_point(r->block, count);
		if (!points_writer_append(w, r->block, kept, error))
			return false;
	}
	return points_writer_finish(w, error) && (!s || finish_surface(r->staged, s, error));
}

/* ---- a grid: into a scratch file as it comes, from there turned ---- */

struct scratch {
	int fd;
	const char *folder;
};

static bool scratch_open(struct scratch *s, GError **error)
{
	g_autofree char *path = g_build_filename(s->folder, "records", NULL);
	s->fd = open(path, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
	if (s->fd < 0)
		return files_fail(error, path, "make a scratch file");
	unlink(path);
	return true;
}

/* All cells, without a point so far: a record of zeros. What was put there is on the disk before long, so memory does not grow
 * with it. */
static struct point_record *scratch_map(struct scratch *s, uint64_t cells, GError **error)
{
	off_t bytes = (off_t)(cells * sizeof(struct point_record));
	if (ftruncate(s->fd, bytes))
		return files_fail(error, s->folder, "make a scratch file in it"), NULL;
	void *at = mmap(NULL, (size_t)bytes, PROT_READ | PROT_WRITE, MAP_SHARED, s->fd, 0);
	if (at == MAP_FAILED)
		return files_fail(error, s->folder, "map a scratch file in it"), NULL;
	return at;
}

static bool scratch_write(struct scratch *s, const struct point_record *records, uint64_t first,
	size_t count, GError **error)
{
	size_t length = count * sizeof *records;
	for (size_t put = 0; put < length;) {
		ssize_t n = pwrite(s->fd, (const char *)records + put, length - put,
			(off_t)(first * sizeof *records + put));
		if (n < 0 && errno != EINTR)
			return files_fail(error, s->folder, "write a scratch file in it");
		put += n > 0 ? (size_t)n : 0;
	}
	return true;
}

static bool scratch_read(
	gpointer user_data, uint64_t first, size_t count, struct point_record *into, GError **error)
{
	struct scratch *s = user_data;
	size_t length = count * sizeof *into;
	for (size_t got = 0; got < length;) {
		ssize_t n = pread(s->fd, (char *)into + got, length - got,
			(off_t)(first * sizeof *into + got));
		if (n == 0)
			errno = EIO;
		if (n == 0 || (n < 0 && errno != EINTR))
			return files_fail(error, s->folder, "read a scratch file in it");
		got += n > 0 ? (size_t)n : 0;
	}
	return true;
}

static bool copy_cloud(struct reading *r, struct scratch *scratch, GError **error)
{
	g_autoptr(points_writer) w = open_points(r->staged, 0, 0, error);
	for (uint64_t at = 0; w && at < r->staged->records;) {
		size_t count = (size_t)MIN(BLOCK_RECORDS, r->staged->records - at);
		if (!go_on(r, error) || !scratch_read(scratch, at, count, r->block, error))
			return false;
		at += count;
		if (!points_writer_append(
			    w, r->block, drop_cells_without_point(r->block, count), error))
			return false;
	}
	return w && points_writer_finish(w, error);
}

static bool step_turning(double fraction, gpointer user_data)
{
	(void)fraction;
	return go_on(user_data, NULL);
}

static bool turn_grid(
	struct reading *r, struct scratch *scratch, const struct import_scan *scan, GError **error)
{
	struct staged_scan *s = r->staged;
	struct grid_layout *l = &s->layout;
	struct grid_records records = { scratch_read, scratch };
	/* Scattered records were put where they belong, row by row. */
	enum import_order order = scan->order == IMPORT_SCATTERED ? IMPORT_ROW_BY_ROW : scan->order;
	if (!grid_layout_find(&records, order, scan->columns, scan->rows, l, error))
		return false;
	if (!l->is_grid) {
		s->no_grid = "no points are neighbours in it";
		return copy_cloud(r, scratch, error);
	}
	if (l->columns > PANORAMA_COLUMNS_MAX)
		return import_refuse(error, r->file, G_IO_ERROR_NOT_SUPPORTED,
			"has a grid of %u columns; at most %u are read", l->columns,
			PANORAMA_COLUMNS_MAX);
	g_autoptr(points_writer) w = open_points(s, l->columns, l->rows, error);
	if (!w || !grid_turn(&records, l, w, step_turning, r, error) ||
		!points_writer_finish(w, error))
		return false;
	s->result.columns = l->columns;
	s->result.rows = l->rows;
	s->result.grid = grid_layout_text(l);
	return true;
}

static bool read_into_scratch(
	struct reading *r, struct scratch *scratch, uint64_t limit, GError **error)
{
	for (size_t count = 1; count;)
		if (!next_block(r, limit, &count, error) ||
			!scratch_write(scratch, r->block, r->staged->records - count, count, error))
			return false;
	return true;
}

static bool scatter_into(
	struct reading *r, struct point_record *into, uint64_t cells, GError **error)
{
	for (size_t count = 1; count;) {
		if (!next_block(r, cells, &count, error))
			return false;
		const uint64_t *cell = r->format->cells(r->reader);
		for (size_t i = 0; i < count; i++) {
			g_assert(cell[i] < cells);
			into[cell[i]] = r->block[i];
		}
	}
	r->staged->records = cells;
	return true;
}

static bool scatter_into_scratch(
	struct reading *r, struct scratch *scratch, uint64_t cells, GError **error)
{
	struct point_record *into = scratch_map(scratch, cells, error);
	bool good = into && scatter_into(r, into, cells, error);
	if (into)
		munmap(into, cells * sizeof *into);
	return good;
}

static bool read_grid(struct reading *r, const struct import_scan *scan, GError **error)
{
	struct staged_scan *s = r->staged;
	struct scratch scratch = { -1, s->folder };
	uint64_t cells = (uint64_t)scan->columns * scan->rows;
	s->was_grid = true;
	s->columns_in_file = scan->columns;
	s->rows_in_file = scan->rows;
	bool good = scratch_open(&scratch, error) &&
		    (scan->order == IMPORT_SCATTERED ? scatter_into_scratch : read_into_scratch)(
			    r, &scratch, cells, error);
	if (good && s->records != cells)
		good = import_refuse(error, r->file, G_IO_ERROR_INVALID_DATA,
			"a grid of %u x %u has %" G_GUINT64_FORMAT
			" cells, and only %" G_GUINT64_FORMAT " are there",
			scan->columns, scan->rows, cells, s->records);
	/* What looked like a grid may have turned out to be none. */
	s->no_grid = scan->no_grid;
	good = good && (scan->columns ? turn_grid(r, &scratch, scan, error)
				      : copy_cloud(r, &scratch, error));
	if (scratch.fd >= 0)
		close(scratch.fd);
	if (good && s->no_grid)
		s->result.grid = g_strdup_printf("given up: %s", s->no_grid);
	return good;
}

/* ---- what comes with it ---- */

static bool save_pictures(const struct reading *r, GError **error)
{
	struct staged_scan *s = r->staged;
	s->pictures = json_array_new();
	return !r->format->save_pictures ||
	       r->format->save_pictures(r->reader, s->folder, s->pictures, error);
}

static bool finish(struct staged_scan *s, const struct import_scan *scan, GError **error)
{
	g_autofree char *path = g_build_filename(s->folder, "points.ply", NULL);
	g_autoptr(points) p = points_open(path, error);
	GStatBuf st;
	if (!p || g_stat(path, &st))
		return p && files_fail(error, path, "look at it");
	struct pose pose = import_given_pose(scan);
	s->scan = *scan;
	s->bytes = (uint64_t)st.st_size;
	s->records = p->count;
	s->result.have = p->have;
	s->result.left_out = scan->left_out;
	s->result.note = g_strdup(scan->note);
	s->scan.note = s->result.note; /* the reader's goes with the next scan */
	memcpy(s->result.position_m, pose.translation_m, sizeof s->result.position_m);
	s->hash = import_hash_begin(path);
	return true;
}

bool import_scan_points(struct staged_scan *s, import_source *file,
	const struct import_format *format, import_reader *reader, const struct import_scan *scan,
	const struct import_options *options, GError **error)
{
	g_autofree char *name = g_path_get_basename(import_source_path(file)),
			*shown = g_filename_display_name(name),
			*doing = g_strdup_printf("reading %s", shown);
	g_autofree struct point_record *block = g_new(struct point_record, BLOCK_RECORDS);
	struct reading r = { s, file, format, reader, options, doing, block, scan, scan->begun };
	bool good = scan->columns ? read_grid(&r, scan, error) : read_cloud(&r, scan->count, error);
	if (good && !scan->columns && scan->no_grid && !s->result.grid)
		s->result.grid = g_strdup_printf("given up: %s", scan->no_grid);
	if (!good || !save_pictures(&r, error))
		return false;
	if (s->result.points == 0)
		return import_refuse(error, file, G_IO_ERROR_INVALID_DATA, "has no points");
	return finish(s, scan, error);
}

/* ---- scan.json ---- */

struct pose import_given_pose(const struct import_scan *scan)
{
	struct pose own = POSE_IDENTITY, pose = scan->has_pose ? scan->pose : own;
	double at_m[3];
	pose_apply(&pose, scan->origin_m, at_m);
	memcpy(pose.translation_m, at_m, sizeof at_m);
	return pose;
}

static void set_source(manifest *m, const struct import_origin *o, uint32_t in_file)
{
	g_autofree char *name = g_path_get_basename(import_source_path(o->file)),
			*shown = g_filename_display_name(name);
	manifest_set_string(m, "source.file", shown);
	manifest_set_string(m, "source.format", o->format->name);
	manifest_set_int(m, "source.scan", in_file);
	manifest_set_int(m, "source.scans", o->scans);
	manifest_set_int(m, "source.bytes", (int64_t)import_source_size(o->file));
	manifest_set_string(m, "source.sha256", o->sha256);
}

/* So that an export can write the grid as the file had it. */
static void set_grid(manifest *m, const struct staged_scan *s)
{
	const struct grid_layout *l = &s->layout;
	bool kept = s->result.columns;
	g_autofree char *why = g_strdup_printf("no: %s", s->no_grid);
	manifest_set_string(m, "source.grid.kept", kept ? "yes" : why);
	manifest_set_int(m, "source.grid.first_size", s->columns_in_file);
	manifest_set_int(m, "source.grid.second_size", s->rows_in_file);
	if (!kept)
		return;
	manifest_set_string(m, "source.grid.first", l->rows_first ? "rows" : "columns");
	manifest_set_string(
		m, "source.grid.order", l->column_by_column ? "column by column" : "row by row");
	manifest_set_string(
		m, "source.grid.columns_run", l->anticlockwise ? "anticlockwise" : "clockwise");
	manifest_set_string(m, "source.grid.rows_run", l->upwards ? "up" : "down");
	manifest_set_string(m, "source.grid.told_by",
		l->told      ? "points"
		: l->assumed ? "habit"
			     : "format");
}

static void set_points(manifest *m, const struct staged_scan *s)
{
	manifest_set_int(m, "points.count", (int64_t)s->result.points);
	manifest_set_int(m, "points.columns", s->result.columns);
	manifest_set_int(m, "points.rows", s->result.rows);
	manifest_set_int(m, "points.left_out", (int64_t)s->result.left_out);
	manifest_set_node(m, "points.origin_m", json_write_numbers(s->scan.origin_m, 3));
}

static void add_file(JsonObject *files, const char *name, uint64_t bytes, const char *sha256)
{
	JsonObject *file = json_object_new();
	json_object_set_int_member(file, "bytes", (int64_t)bytes);
	json_object_set_string_member(file, "sha256", sha256);
	json_object_set_object_member(files, name, file);
}

static bool add_picture_files(JsonObject *files, const struct staged_scan *s, GError **error)
{
	for (guint i = 0; i < json_array_get_length(s->pictures); i++) {
		const char *name = json_object_get_string_member(
			json_array_get_object_element(s->pictures, i), "file");
		g_autofree char *path = g_build_filename(s->folder, name, NULL),
				*sha256 = import_hash_end(import_hash_begin(path), error);
		GStatBuf st;
		if (!sha256)
			return false;
		if (g_stat(path, &st))
			return files_fail(error, path, "look at it");
		add_file(files, name, (uint64_t)st.st_size, sha256);
	}
	return true;
}

static bool add_surface_file(JsonObject *files, const struct staged_scan *s, GError **error)
{
	g_autofree char *path = g_build_filename(s->folder, "surface.ply", NULL),
			*sha256 = import_hash_end(import_hash_begin(path), error);
	if (sha256)
		add_file(files, "surface.ply", s->surface_bytes, sha256);
	return sha256;
}

static bool set_files(manifest *m, const struct staged_scan *s, const char *sha256, GError **error)
{
	JsonObject *files = json_object_new();
	JsonNode *node = json_node_new(JSON_NODE_OBJECT);
	json_node_take_object(node, files);
	add_file(files, "points.ply", s->bytes, sha256);
	bool good = add_picture_files(files, s, error) &&
		    (!s->surface_bytes || add_surface_file(files, s, error));
	manifest_set_node(m, "files", node);
	return good;
}

static void set_pictures(manifest *m, const struct staged_scan *s)
{
	if (!json_array_get_length(s->pictures))
		return;
	JsonNode *node = json_node_new(JSON_NODE_ARRAY);
	json_node_set_array(node, s->pictures);
	manifest_set_node(m, "pictures", node);
}

static void set_times(manifest *m)
{
	g_autoptr(GDateTime) now = g_date_time_new_now_utc();
	g_autofree char *text = g_date_time_format(now, "%Y-%m-%dT%H:%M:%SZ");
	manifest_set_string(m, "created", text);
}

bool import_scan_describe(struct staged_scan *s, const struct import_origin *origin, GError **error)
{
	g_autofree char *path = g_build_filename(s->folder, "scan.json", NULL);
	g_autofree char *sha256 = import_hash_end(g_steal_pointer(&s->hash), error);
	g_autoptr(manifest) m = manifest_new(path);
	if (!sha256)
		return false;
	manifest_set_int(m, "schema", SCAN_SCHEMA);
	manifest_set_string(m, "state", "complete");
	manifest_set_string(m, "kind", "imported");
	manifest_set_int(m, "number", s->result.number);
	set_times(m);
	set_source(m, origin, s->result.in_file);
	if (s->was_grid)
		set_grid(m, s);
	set_points(m, s);
	if (s->scan.note)
		manifest_set_string(m, "source.note", s->scan.note);
	if (s->result.has_pose) {
		struct pose pose = import_given_pose(&s->scan);
		manifest_set_node(m, "given_pose", json_write_pose(&pose));
	}
	set_pictures(m, s);
	return set_files(m, s, sha256, error) && manifest_save(m, error);
}
