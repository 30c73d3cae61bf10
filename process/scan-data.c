#include "process/scan-data.h"
#include "acquire/scan.h"
#include "process/pose-json.h"
#include <json-glib/json-glib.h>
#include <string.h>

/* ---- scans that are kept ---- */

static struct {
	uint64_t bytes_most, bytes;
	GMutex mutex;
	GQueue scans; /* of scan_data, the last used last; the queue is one of the users of each */
} kept = { .scans = G_QUEUE_INIT };

void scan_data_keep(uint64_t bytes)
{
	kept.bytes_most = bytes;
}

static void free_it(scan_data *d)
{
	range_grid_free(d->grid);
	points_free(d->points);
	g_free(d->fingerprint);
	g_free(d->kept_of);
	g_free(d);
}

/* With the mutex held. */
static void let_go(scan_data *d)
{
	if (--d->users == 0)
		free_it(d);
}

void scan_data_free(scan_data *d)
{
	if (!d || !d->kept_of) {
		if (d)
			free_it(d);
		return;
	}
	g_mutex_lock(&kept.mutex);
	let_go(d);
	g_mutex_unlock(&kept.mutex);
}

static bool is_same(const scan_data *a, const scan_data *b, const char *of)
{
	return a->number == b->number && strcmp(a->fingerprint, b->fingerprint) == 0 &&
	       strcmp(a->kept_of, of) == 0;
}

/* The one that was peeked at; NULL: it is not there. */
static scan_data *find_kept(const site *s, const scan_data *like)
{
	scan_data *found = NULL;
	g_mutex_lock(&kept.mutex);
	for (GList *l = kept.scans.head; l && !found; l = l->next)
		if (is_same(l->data, like, site_path(s))) {
			found = l->data;
			found->users++;
			g_queue_unlink(&kept.scans, l);
			g_queue_push_tail_link(&kept.scans, l);
		}
	g_mutex_unlock(&kept.mutex);
	return found;
}

static uint64_t bytes_of(const scan_data *d)
{
	uint64_t cells = d->grid ? range_grid_cells(d->grid) : 0;
	return cells * (4 * sizeof(float) + 6) +
	       (d->points ? d->points->count * sizeof *d->points->record : 0);
}

static void keep(const site *s, scan_data *d)
{
	d->kept_bytes = bytes_of(d);
	if (d->kept_bytes > kept.bytes_most)
		return;
	g_mutex_lock(&kept.mutex);
	d->kept_of = g_strdup(site_path(s));
	d->users = 2; /* who asked, and the queue */
	g_queue_push_tail(&kept.scans, d);
	kept.bytes += d->kept_bytes;
	while (kept.bytes > kept.bytes_most) {
		scan_data *first = g_queue_pop_head(&kept.scans);
		kept.bytes -= first->kept_bytes;
		let_go(first);
	}
	g_mutex_unlock(&kept.mutex);
}

/* ---- manifests ---- */

static manifest *load_manifest(const char *folder, GError **error)
{
	g_autofree char *path = g_build_filename(folder, "scan.json", NULL);
	return manifest_load(path, SCAN_SCHEMA, error);
}

static bool is_imported(const manifest *m)
{
	return manifest_has(m, "kind") &&
	       g_strcmp0(manifest_get_string(m, "kind", NULL), "imported") == 0;
}

static bool refuse(GError **error, const manifest *m, const char *what)
{
	g_set_error(error, MANIFEST_ERROR, MANIFEST_ERROR_VALUE, "%s: %s", manifest_path(m), what);
	return false;
}

/* From the file's coordinates to the site's. */
static bool take_origin_off(const site *s, struct pose *pose, GError **error)
{
	double origin_m[3];
	JsonNode *node = manifest_get_node(site_manifest(s), "origin_m");
	if (!node)
		return true;
	if (!json_read_numbers(node, 3, origin_m))
		return refuse(error, site_manifest(s), "'origin_m' is not three numbers");
	for (int i = 0; i < 3; i++)
		pose->translation_m[i] -= origin_m[i];
	return true;
}

static bool read_given_pose(scan_data *d, const site *s, const manifest *m, GError **error)
{
	if (!manifest_has(m, "given_pose"))
		return true;
	d->has_given_pose = true;
	if (!json_read_pose(manifest_get_node(m, "given_pose"), &d->given_pose))
		return refuse(error, m, "'given_pose' is no rotation with a translation");
	return take_origin_off(s, &d->given_pose, error);
}

/* raw.rec does not count: the points do. */
static bool is_points_file(const char *name)
{
	return g_str_has_suffix(name, ".tiff") || g_str_has_suffix(name, ".ply");
}

static int by_name(gconstpointer a, gconstpointer b)
{
	return strcmp(a, b);
}

static const char *hash_of(JsonNode *file)
{
	JsonNode *hash = JSON_NODE_HOLDS_OBJECT(file)
				 ? json_object_get_member(json_node_get_object(file), "sha256")
				 : NULL;
	return hash && JSON_NODE_HOLDS_VALUE(hash) ? json_node_get_string(hash) : NULL;
}

static char *fingerprint_of(const manifest *m, GError **error)
{
	JsonNode *node = manifest_get_node(m, "files");
	JsonObject *files =
		node && JSON_NODE_HOLDS_OBJECT(node) ? json_node_get_object(node) : NULL;
	if (!files) {
		refuse(error, m, "'files' is missing");
		return NULL;
	}
	g_autoptr(GChecksum) sum = g_checksum_new(G_CHECKSUM_SHA256);
	g_autoptr(GList) names = g_list_sort(json_object_get_members(files), by_name);
	for (GList *name = names; name; name = name->next) {
		if (!is_points_file(name->data))
			continue;
		const char *hash = hash_of(json_object_get_member(files, name->data));
		if (!hash) {
			refuse(error, m, "'files' has an entry without its sha256");
			return NULL;
		}
		g_checksum_update(sum, name->data, -1);
		g_checksum_update(sum, (const guchar *)hash, -1);
	}
	return g_strdup(g_checksum_get_string(sum));
}

static bool read_kind(scan_data *d, const manifest *m, GError **error)
{
	int64_t columns, rows;
	d->kind = SCAN_RECORDED;
	if (!is_imported(m))
		return true;
	if (!manifest_get_int(m, "points.columns", 0, PANORAMA_COLUMNS_MAX, &columns, error) ||
		!manifest_get_int(m, "points.rows", 0, G_MAXINT32, &rows, error))
		return false;
	d->kind = columns && rows ? SCAN_ORDERED : SCAN_CLOUD;
	d->is_las = g_strcmp0(manifest_get_string(m, "source.format", NULL), "LAS") == 0;
	return true;
}

static scan_data *peek(const site *s, uint32_t number, manifest **ret_manifest, GError **error)
{
	g_autoptr(scan_data) d = g_new0(scan_data, 1);
	g_autofree char *folder = site_scan_path(s, number);
	g_autoptr(manifest) m = load_manifest(folder, error);
	d->number = number;
	if (!m || !read_kind(d, m, error) || !read_given_pose(d, s, m, error) ||
		!(d->fingerprint = fingerprint_of(m, error)))
		return NULL;
	*ret_manifest = g_steal_pointer(&m);
	return g_steal_pointer(&d);
}

scan_data *scan_data_peek(const site *s, uint32_t number, GError **error)
{
	g_autoptr(manifest) m = NULL;
	return peek(s, number, &m, error);
}

/* ---- with the points ---- */

static range_grid *grid_of_points(const points *p, GError **error)
{
	size_t n = p->count;
	g_autofree double *x = g_new(double, n), *y = g_new(double, n), *z = g_new(double, n);
	g_autofree uint8_t *cell = g_new(uint8_t, n), *rgb = g_new(uint8_t, 3 * n);
	g_autofree uint16_t *intensity = g_new(uint16_t, n);
	for (size_t i = 0; i < n; i++) {
		const struct point_record *r = &p->record[i];
		x[i] = r->x_m;
		y[i] = r->y_m;
		z[i] = r->z_m;
		cell[i] = r->cell;
		intensity[i] = r->intensity;
		memcpy(rgb + 3 * i, r->rgb, 3);
	}
	struct range_grid_desc desc = { p->columns, p->rows, x, y, z, cell,
		p->have & POINTS_HAVE_INTENSITY ? intensity : NULL,
		p->have & POINTS_HAVE_COLOUR ? rgb : NULL };
	return range_grid_new(&desc, error);
}

/* Of so many records, spread over all; with fewer there is nothing to tell. */
#define COLOUR_SAMPLES 4096u
#define COLOUR_LEAST   64u
/* No photograph has so much that is 0, 0, 0. */
#define BLACK_MOST 0.25

/* Whether colours are there but nobody photographed anything: files give 0, 0, 0 to what has none, or use colours as the numbers of
 * things. */
static bool are_codes(const points *p)
{
	uint64_t step = p->count / COLOUR_SAMPLES + 1;
	uint32_t looked = 0, black = 0;
	for (uint64_t i = 0; i < p->count; i += step) {
		const struct point_record *r = &p->record[i];
		if (r->cell != CELL_MEASURED)
			continue;
		looked++;
		black += !(r->rgb[0] | r->rgb[1] | r->rgb[2]);
	}
	return looked >= COLOUR_LEAST && black > BLACK_MOST * looked;
}

static bool load_points(scan_data *d, const char *folder, const manifest *m, GError **error)
{
	g_autofree char *path = g_build_filename(folder, "points.ply", NULL);
	d->points = points_open(path, error);
	if (!d->points)
		return false;
	if (are_codes(d->points))
		d->points->have &= ~POINTS_HAVE_COLOUR;
	bool ordered = d->points->columns && d->points->rows;
	if (ordered != (d->kind == SCAN_ORDERED))
		return refuse(error, m, "'points' tells of another grid than points.ply has");
	if (!ordered)
		return true;
	d->grid = grid_of_points(d->points, error);
	if (!d->grid)
		g_prefix_error(error, "%s: ", path);
	return d->grid;
}

static bool load_panorama(scan_data *d, const site *s, GError **error)
{
	g_autoptr(panorama) p = scan_load(s, d->number, false, error);
	if (p)
		d->grid = range_grid_from_panorama(p);
	return p;
}

scan_data *scan_data_load(const site *s, uint32_t number, GError **error)
{
	g_autoptr(manifest) m = NULL;
	g_autoptr(scan_data) d = peek(s, number, &m, error);
	g_autofree char *folder = site_scan_path(s, number);
	scan_data *there = d && kept.bytes_most ? find_kept(s, d) : NULL;
	if (there)
		return there;
	if (!d || !(d->kind == SCAN_RECORDED ? load_panorama(d, s, error)
					     : load_points(d, folder, m, error)))
		return NULL;
	if (kept.bytes_most)
		keep(s, d);
	return g_steal_pointer(&d);
}
