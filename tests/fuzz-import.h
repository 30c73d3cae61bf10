#ifndef TESTS_FUZZ_IMPORT_H
#define TESTS_FUZZ_IMPORT_H
/* Any bytes given to a reader: it ends, keeps its promises, and never says that a file is bad without a sentence. */
#include "acquire/panorama.h"
#include "process/import-grid.h"
#include "process/import.h"
#include <glib/gstdio.h>
#include <json-glib/json-glib.h>
#include <math.h>
#include <string.h>

#define FUZZ_BLOCK 100

static inline bool fuzz_record_at(
	gpointer user_data, uint64_t first, size_t count, struct point_record *into, GError **error)
{
	const GArray *all = user_data;
	(void)error;
	g_assert_cmpuint(first + count, <=, all->len);
	memcpy(into, &g_array_index(all, struct point_record, first), count * sizeof *into);
	return true;
}

static inline void fuzz_check_record(const struct point_record *r)
{
	g_assert_true(isfinite(r->x_m) && isfinite(r->y_m) && isfinite(r->z_m));
	g_assert_true(r->cell == CELL_MEASURED || (r->x_m == 0 && r->y_m == 0 && r->z_m == 0));
}

static inline void fuzz_grid(const struct import_scan *scan, GArray *all)
{
	struct grid_records records = { fuzz_record_at, all };
	struct grid_layout l;
	/* Scattered ones are checked as they come. */
	if (!scan->columns || scan->order == IMPORT_SCATTERED)
		return;
	g_assert_cmpuint(all->len, ==, scan->count);
	g_assert_true(grid_layout_find(&records, scan->order, scan->columns, scan->rows, &l, NULL));
	g_assert_cmpuint((uint64_t)l.columns * l.rows, ==, scan->count);
}

static inline gpointer fuzz_cell(const struct import_scan *scan, uint64_t cell)
{
	g_assert_cmpuint(cell, <, (uint64_t)scan->columns * scan->rows);
	return GSIZE_TO_POINTER(cell);
}

/* Empties it; how many files it had. */
static inline guint fuzz_remove(const char *folder)
{
	g_autoptr(GDir) dir = g_dir_open(folder, 0, NULL);
	guint count = 0;
	g_assert_nonnull(dir);
	for (const char *name; (name = g_dir_read_name(dir)); count++) {
		g_autofree char *path = g_build_filename(folder, name, NULL);
		g_assert_cmpint(g_unlink(path), ==, 0);
	}
	g_assert_cmpint(g_rmdir(folder), ==, 0);
	return count;
}

/* Those that it tells of are there, and nothing else is. */
static inline bool fuzz_pictures(const struct import_format *f, import_reader *r, GError **error)
{
	if (!f->save_pictures)
		return true;
	g_autofree char *folder = g_dir_make_tmp("pleinair-fuzz-XXXXXX", NULL);
	g_autoptr(JsonArray) pictures = json_array_new();
	g_assert_nonnull(folder);
	bool good = f->save_pictures(r, folder, pictures, error);
	guint count = fuzz_remove(folder);
	g_assert_true(!good || count == json_array_get_length(pictures));
	return good;
}

/* false: the file is bad. */
static inline bool fuzz_scan(const struct import_format *f, import_reader *r,
	const struct import_scan *scan, GError **error)
{
	struct point_record block[FUZZ_BLOCK];
	g_autoptr(GArray) all = g_array_new(false, false, sizeof *block);
	g_autoptr(GHashTable) cells = g_hash_table_new(NULL, NULL);
	uint32_t begun = scan->begun;
	for (size_t count = 1; count;) {
		if (!f->read(r, block, FUZZ_BLOCK, &count, error))
			return false;
		if (scan->begun != begun)
			g_array_set_size(all, 0);
		begun = scan->begun;
		g_assert_cmpuint(begun, <=, 1);
		g_assert_cmpuint(count, <=, FUZZ_BLOCK);
		for (size_t i = 0; i < count; i++)
			fuzz_check_record(&block[i]);
		for (size_t i = 0; i < count && scan->order == IMPORT_SCATTERED && scan->columns;
			i++)
			g_assert_true(g_hash_table_add(cells, fuzz_cell(scan, f->cells(r)[i])));
		g_array_append_vals(all, block, (guint)count);
		double fraction = f->fraction(r);
		g_assert_true(fraction >= 0 && fraction <= 1);
	}
	g_assert_cmpuint(all->len, <=, scan->count);
	for (int i = 0; i < 3; i++)
		g_assert_cmpfloat(scan->origin_m[i], ==, rint(scan->origin_m[i]));
	g_assert_true(pose_is_rigid(&scan->pose, 1e-9) || !scan->has_pose);
	fuzz_grid(scan, all);
	if (!fuzz_pictures(f, r, error))
		return false;
	g_assert_true(!scan->note || g_utf8_validate(scan->note, -1, NULL));
	return true;
}

/* Frees the file. */
static inline void fuzz_import_file(const struct import_format *f, import_source *source)
{
	g_autoptr(import_source) file = source;
	g_autofree char *path = g_strconcat(import_source_path(file), ": ", NULL);
	struct import_options options = { .mesh.points = 300 };
	g_autoptr(GError) error = NULL;
	import_reader *r = f->open(file, &options, &error);
	const struct import_scan *scan;
	enum import_result got = r ? IMPORT_SCAN : IMPORT_BAD;
	while (r && (got = f->next_scan(r, &scan, &error)) == IMPORT_SCAN)
		if (!fuzz_scan(f, r, scan, &error)) {
			got = IMPORT_BAD;
			break;
		}
	g_assert_true((got == IMPORT_BAD) == (error != NULL));
	if (error)
		g_assert_true(g_str_has_prefix(error->message, path) &&
			      g_utf8_validate(error->message, -1, NULL) &&
			      !strchr(error->message, '\n'));
	if (r)
		f->close(r);
}

static inline void fuzz_import(const struct import_format *f, const uint8_t *data, size_t size)
{
	fuzz_import_file(f, import_source_from_bytes(data, size, "x"));
	f->probe(data, MIN(size, IMPORT_PROBE_BYTES));
}

#endif
