/* A file into a site: all its scans or none. */
#include "acquire/scan.h"
#include "firmware-io/files.h"
#include "process/import-scan.h"
#include <json-glib/json-glib.h>
#include <math.h>

/* Sites nearer to zero keep the coordinates of the file. */
#define LOCAL_MAX_M 1000.0

struct importing {
	site *site;
	const struct import_options *options;
	import_source *file;
	const struct import_format *format;
	import_reader *reader;
	import_hash *hash;
	char *sha256;
	GHashTable *present; /* scans of this very file that the site has: in_file to number */
	GPtrArray *staged;   /* of struct staged_scan */
	uint32_t scans;      /* met in the file */
};

/* ---- what the site has ---- */

static bool is_of_this_size(const manifest *m, const struct importing *i)
{
	int64_t bytes;
	return g_strcmp0(manifest_has(m, "kind") ? manifest_get_string(m, "kind", NULL) : NULL,
		       "imported") == 0 &&
	       manifest_get_int(m, "source.bytes", 0, G_MAXINT64, &bytes, NULL) &&
	       (uint64_t)bytes == import_source_size(i->file);
}

static bool note_present(struct importing *i, const manifest *m, uint32_t number, GError **error)
{
	int64_t in_file;
	if (!i->sha256)
		i->sha256 = import_hash_end(g_steal_pointer(&i->hash), error);
	if (!i->sha256)
		return false;
	if (g_strcmp0(manifest_get_string(m, "source.sha256", NULL), i->sha256) == 0 &&
		manifest_get_int(m, "source.scan", 1, G_MAXINT32, &in_file, NULL))
		g_hash_table_insert(
			i->present, GINT_TO_POINTER((int)in_file), GUINT_TO_POINTER(number));
	return true;
}

/* The file is hashed before it is read only when one of its size is there: else it cannot be the same. */
static bool find_present(struct importing *i, GError **error)
{
	g_autoptr(GArray) numbers = site_scans(i->site, error);
	for (guint k = 0; numbers && k < numbers->len && !i->options->again; k++) {
		uint32_t number = g_array_index(numbers, uint32_t, k);
		g_autofree char *folder = site_scan_path(i->site, number),
				*path = g_build_filename(folder, "scan.json", NULL);
		/* One that cannot be read is not of this file's concern. */
		g_autoptr(manifest) m = manifest_load(path, SCAN_SCHEMA, NULL);
		if (m && is_of_this_size(m, i) && !note_present(i, m, number, error))
			return false;
	}
	return numbers;
}

static bool refuse_present(const struct importing *i, GError **error)
{
	uint32_t lowest = G_MAXUINT32;
	GHashTableIter iter;
	gpointer number;
	g_hash_table_iter_init(&iter, i->present);
	while (g_hash_table_iter_next(&iter, NULL, &number))
		lowest = MIN(lowest, GPOINTER_TO_UINT(number));
	return import_refuse(error, i->file, G_IO_ERROR_EXISTS,
		"is in this site already, as scan %04u%s; --again imports it once more", lowest,
		g_hash_table_size(i->present) > 1 ? " and others" : "");
}

/* ---- reading ---- */

static bool pass_over(struct importing *i, GError **error)
{
	struct point_record block[256];
	for (size_t count = 1; count;)
		if (!i->format->read(i->reader, block, G_N_ELEMENTS(block), &count, error))
			return false;
	return true;
}

static bool stage_scan(struct importing *i, const struct import_scan *scan, GError **error)
{
	i->scans++;
	if (g_hash_table_contains(i->present, GINT_TO_POINTER((int)i->scans)))
		return pass_over(i, error);
	struct staged_scan *s = g_new0(struct staged_scan, 1);
	g_ptr_array_add(i->staged, s);
	s->result.in_file = i->scans;
	s->folder = site_stage_scan(i->site, &s->result.number, error);
	return s->folder &&
	       import_scan_points(s, i->file, i->format, i->reader, scan, i->options, error);
}

static bool read_all(struct importing *i, GError **error)
{
	const struct import_scan *scan;
	enum import_result got;
	i->reader = i->format->open(i->file, i->options, error);
	if (!i->reader)
		return false;
	while ((got = i->format->next_scan(i->reader, &scan, error)) == IMPORT_SCAN)
		if (!stage_scan(i, scan, error))
			return false;
	if (got == IMPORT_BAD)
		return false;
	return i->staged->len || refuse_present(i, error);
}

/* ---- poses ---- */

/* Of a file with several scans, the one with the identity stands where it says as well as the others. */
static void settle_poses(struct importing *i)
{
	bool any = false;
	for (guint k = 0; k < i->staged->len; k++)
		any |= ((struct staged_scan *)i->staged->pdata[k])->scan.has_pose;
	for (guint k = 0; k < i->staged->len; k++) {
		struct staged_scan *s = i->staged->pdata[k];
		const double *o = s->scan.origin_m;
		s->result.has_pose = any || o[0] != 0 || o[1] != 0 || o[2] != 0;
	}
}

/* The first pose that is given says where the site's own zero is. *ret_set: it does now. */
static bool set_site_origin(struct importing *i, bool *ret_set, GError **error)
{
	const struct imported *first = NULL;
	for (guint k = 0; k < i->staged->len && !first; k++) {
		const struct imported *r = &((struct staged_scan *)i->staged->pdata[k])->result;
		first = r->has_pose ? r : NULL;
	}
	*ret_set = false;
	if (!first || manifest_has(site_manifest(i->site), "origin_m"))
		return true;
	const double *p = first->position_m;
	bool local =
		fabs(p[0]) <= LOCAL_MAX_M && fabs(p[1]) <= LOCAL_MAX_M && fabs(p[2]) <= LOCAL_MAX_M;
	JsonArray *array = json_array_new();
	for (int k = 0; k < 3; k++)
		json_array_add_double_element(array, local ? 0 : rint(p[k]));
	JsonNode *node = json_node_new(JSON_NODE_ARRAY);
	json_node_take_array(node, array);
	return *ret_set = site_set(i->site, "origin_m", node, error);
}

/* ---- the end ---- */

static bool describe(struct importing *i, GError **error)
{
	if (!i->sha256)
		i->sha256 = import_hash_end(g_steal_pointer(&i->hash), error);
	struct import_origin origin = { i->file, i->format, i->sha256, i->scans };
	for (guint k = 0; i->sha256 && k < i->staged->len; k++)
		if (!import_scan_describe(i->staged->pdata[k], &origin, error))
			return false;
	return i->sha256;
}

static bool add(struct importing *i, GError **error)
{
	g_autoptr(GPtrArray) folders = g_ptr_array_new();
	bool origin_set;
	for (guint k = 0; k < i->staged->len; k++)
		g_ptr_array_add(folders, ((struct staged_scan *)i->staged->pdata[k])->folder);
	if (!set_site_origin(i, &origin_set, error))
		return false;
	if (site_add_staged(i->site, folders, error))
		return true;
	if (origin_set)
		site_set(i->site, "origin_m", NULL, NULL);
	return false;
}

static GArray *results(struct importing *i)
{
	GArray *array = g_array_new(false, false, sizeof(struct imported));
	g_array_set_clear_func(array, (GDestroyNotify)imported_clear);
	for (guint k = 0; k < i->staged->len; k++) {
		struct staged_scan *s = i->staged->pdata[k];
		g_array_append_val(array, s->result);
		s->result.grid = s->result.note = NULL;
	}
	return array;
}

static void remove_staged(struct importing *i)
{
	for (guint k = 0; k < i->staged->len; k++) {
		struct staged_scan *s = i->staged->pdata[k];
		g_clear_pointer(&s->hash, import_hash_free);
		if (s->folder)
			files_remove_tree(s->folder, NULL); /* else the next writer does */
	}
}

static void importing_clear(struct importing *i)
{
	if (i->reader)
		i->format->close(i->reader);
	import_hash_free(i->hash);
	import_source_free(i->file);
	g_hash_table_unref(i->present);
	g_ptr_array_unref(i->staged);
	g_free(i->sha256);
}

GArray *import_file(site *s, const char *path, const struct import_options *options, GError **error)
{
	struct importing i = { .site = s,
		.options = options,
		.present = g_hash_table_new(NULL, NULL),
		.staged = g_ptr_array_new_with_free_func((GDestroyNotify)staged_scan_free) };
	GArray *array = NULL;
	i.file = import_source_open(path, error);
	i.format = i.file ? import_format_of(i.file, error) : NULL;
	if (i.format) {
		i.hash = import_hash_begin(path);
		bool read = find_present(&i, error) && read_all(&i, error);
		if (read)
			settle_poses(&i);
		if (read && describe(&i, error) && add(&i, error))
			array = results(&i);
		else
			remove_staged(&i);
	}
	importing_clear(&i);
	return array;
}
