#include "process/scan-features.h"
#include "acquire/surface.h"
#include "firmware-io/files.h"
#include "process/features-cloud.h"
#include "process/model.h"
#include "process/scan-data.h"
#include "process/scan-geometry.h"
#include "process/scan-sources.h"
#include <json-glib/json-glib.h>
#include <math.h>
#include <string.h>

/* Scans that stay in memory with their features: the neighbours of scans next to each other are mostly the same. */
#define CACHED 5

static char *path_of(const site *s, uint32_t number)
{
	return g_strdup_printf("%s/features/%04u.features", site_path(s), number);
}

/* ---- what goes into each ---- */

static void append_number(GString *text, double value)
{
	char number[G_ASCII_DTOSTR_BUF_SIZE];
	g_string_append_printf(text, " %s", g_ascii_dtostr(number, sizeof number, value));
}

static void append_options(GString *text, const struct features_options *options)
{
	struct features_options o = features_defaults(options);
	const float all[] = { o.range_noise_m, o.radius_m, o.geometry_weight, o.colour_weight,
		o.intensity_weight, o.threshold, o.line_radius_m, o.line_error, o.dither_per_m2,
		o.tone_exponent };
	for (size_t i = 0; i < G_N_ELEMENTS(all); i++)
		append_number(text, all[i]);
}

/* "" where there is none. */
static char *geometry_checksum(const site *s, uint32_t number)
{
	g_autoptr(scan_geometry) g = scan_geometry_open(s, number, NULL);
	return g ? g_strdup_printf("%08x", product_checksum(g->file)) : g_strdup("");
}

static GArray *find_sources(const site *s, const scan_graph *graph,
	const struct features_options *options, GError **error)
{
	_Static_assert(FEATURES_NEIGHBOURS <= SCAN_SOURCE_NEIGHBOURS, "a source has room for them");
	g_autoptr(GString) method = g_string_new(NULL);
	g_string_printf(method, "%s %d", SCAN_FEATURES_KIND, SCAN_FEATURES_VERSION);
	append_options(method, options);
	struct scan_sources_desc desc = { FEATURES_NEIGHBOURS, FEATURES_REACH_M, method->str,
		geometry_checksum };
	return scan_sources_find(s, graph, &desc, error);
}

/* Why it must be made; NULL: it need not. What cannot be read is made again. */
static const char *why_due(const site *s, const struct scan_source *source)
{
	g_autofree char *path = path_of(s, source->number);
	if (!g_file_test(path, G_FILE_TEST_EXISTS))
		return "has no features";
	g_autoptr(scan_features) f = scan_features_open(s, source->number, NULL);
	if (!f)
		return "has features that cannot be read";
	JsonNode *key = json_object_get_member(product_manifest(f->file), "key");
	bool same = key && JSON_NODE_HOLDS_VALUE(key) &&
		    g_strcmp0(json_node_get_string(key), source->key) == 0;
	return same ? NULL : "or what its features come from has changed";
}

bool features_site_is_due(const site *s, const scan_graph *graph,
	const struct features_options *options, bool *ret_due, char **ret_why, GError **error)
{
	return scan_sources_is_due(
		s, find_sources(s, graph, options, error), why_due, ret_due, ret_why);
}

/* ---- making them ---- */

/* A scan in memory, with what is known of it alone. */
struct entry {
	scan_data *data;
	features *features; /* NULL for a cloud, as is the next */
	features_ridges *ridges;
};

static void entry_free(gpointer data)
{
	struct entry *e = data;
	scan_data_free(e->data);
	features_ridges_free(e->ridges);
	features_free(e->features);
	g_free(e);
}

struct maker {
	site *site;
	GArray *sources;
	const struct features_site_options *options;
	GPtrArray *cache; /* of struct entry, the last used last */
	uint32_t due, made, number;
};

static bool go_on(struct maker *m, double fraction, GError **error)
{
	g_autofree char *doing = g_strdup_printf("features of scan %u", m->number);
	double done = m->due ? (m->made + fraction) / m->due : 1;
	if (!m->options || !m->options->progress ||
		m->options->progress(done, doing, m->options->user_data))
		return true;
	g_set_error(error, G_IO_ERROR, G_IO_ERROR_CANCELLED, "stopped at the features of scan %u",
		m->number);
	return false;
}

static const struct features_options *options_of(const struct maker *m)
{
	return m->options ? &m->options->features : NULL;
}

static struct entry *read_entry(struct maker *m, const struct scan_source *s, GError **error)
{
	g_autoptr(scan_data) d = scan_data_load(m->site, s->number, error);
	if (!d)
		return NULL;
	struct entry *e = g_new0(struct entry, 1);
	struct features_input input = { .grid = d->grid, .pose = s->pose };
	if (d->grid) {
		e->features = features_estimate(&input, options_of(m));
		e->ridges = features_ridges_new(&input, e->features, options_of(m));
	}
	e->data = g_steal_pointer(&d);
	return e;
}

/* Owned by the cache, until CACHED others were asked for. */
static struct entry *load(struct maker *m, const struct scan_source *s, GError **error)
{
	struct entry *e = NULL;
	for (guint i = 0; i < m->cache->len && !e; i++)
		if (((struct entry *)m->cache->pdata[i])->data->number == s->number)
			e = g_ptr_array_steal_index(m->cache, i);
	if (!e && m->cache->len == CACHED)
		g_ptr_array_remove_index(m->cache, 0);
	if (!e)
		e = read_entry(m, s, error);
	if (e)
		g_ptr_array_add(m->cache, e);
	return e;
}

static bool write_section(product_writer *w, const char *name, uint32_t bytes, const void *values,
	uint64_t count, GError **error)
{
	return product_writer_begin(w, name, bytes, error) &&
	       product_writer_append(w, values, count, error);
}

static bool write_file(
	struct maker *m, const struct scan_source *s, const features *f, GError **error)
{
	g_autofree char *path = path_of(m->site, s->number);
	g_autoptr(product_writer) w = product_writer_new(path, error);
	uint64_t count = (uint64_t)f->columns * f->rows;
	if (!w || !write_section(w, "degree", 1, f->degree, count, error) ||
		!write_section(w, "kind", 1, f->kind, count, error) ||
		!write_section(w, "flags", 1, f->flags, count, error) ||
		!write_section(w, "direction", 4, f->direction, count, error) ||
		!write_section(w, "line_error", 2, f->line_error, count, error) ||
		!write_section(w, "k1", 4, f->k1, count, error) ||
		!write_section(w, "k2", 4, f->k2, count, error) ||
		!write_section(w, "principal", 4, f->principal, count, error))
		return false;
	JsonObject *made_from = json_object_new();
	JsonArray *with = json_array_new();
	for (uint32_t i = 0; i < s->neighbour_count; i++)
		json_array_add_int_element(
			with, scan_sources_at(m->sources, s->neighbours[i])->number);
	json_object_set_int_member(made_from, "scan", s->number);
	json_object_set_array_member(made_from, "with", with);
	json_object_set_string_member(made_from, "key", s->key);
	struct features_options o = features_defaults(options_of(m));
	json_object_set_double_member(made_from, "dither_per_m2", o.dither_per_m2);
	json_object_set_double_member(made_from, "tone_exponent", o.tone_exponent);
	return product_writer_finish(
		w, SCAN_FEATURES_KIND, SCAN_FEATURES_VERSION, made_from, error);
}

/* The scan itself is asked for last, so that it stays; and all of them fit into the cache. */
static bool make_grid(struct maker *m, const struct scan_source *s, GError **error)
{
	_Static_assert(FEATURES_NEIGHBOURS + 1 <= CACHED,
		"a scan and its neighbours are in memory together");
	struct features_view views[FEATURES_NEIGHBOURS + 1];
	struct features_input own = { 0 };
	features *f = NULL;
	for (uint32_t i = 0; i <= s->neighbour_count; i++) {
		const struct scan_source *of =
			i < s->neighbour_count ? scan_sources_at(m->sources, s->neighbours[i]) : s;
		struct entry *e = load(m, of, error);
		if (!e || !go_on(m, (i + 1.0) / (s->neighbour_count + 2.0), error))
			return false;
		own = (struct features_input){ .grid = e->data->grid, .pose = of->pose };
		views[i] = (struct features_view){ own, e->ridges };
		f = e->features;
	}
	features_fit_lines(f, &own, views, s->neighbour_count + 1, options_of(m));
	return write_file(m, s, f, error);
}

static bool cloud_progress(double fraction, gpointer user_data)
{
	return go_on(user_data, fraction, NULL);
}

/* Those of the file, where it told more than points. */
static bool take_curvatures(
	const site *of, uint32_t number, features *f, uint64_t count, GError **error)
{
	g_autoptr(scan_surface) known = NULL;
	if (!surface_open_of_scan(of, number, count, &known, error))
		return false;
	for (uint64_t i = 0; known && i < count; i++) {
		const struct surface_record *r = &known->record[i];
		if (!isfinite(r->k1) || !isfinite(r->k2))
			continue;
		f->k1[i] = r->k1;
		f->k2[i] = r->k2;
		model_pack_normal(r->direction, f->principal[i]);
	}
	return true;
}

static bool make_cloud(struct maker *m, const struct scan_source *s, GError **error)
{
	struct entry *e = load(m, s, error);
	g_autoptr(scan_geometry) g = e ? scan_geometry_open(m->site, s->number, error) : NULL;
	if (!g)
		return false;
	if (g->count != e->data->points->count) {
		g_set_error(error, PRODUCT_ERROR, PRODUCT_ERROR_DAMAGED,
			"%s: is of %" G_GUINT64_FORMAT
			" points, but the scan has %" G_GUINT64_FORMAT,
			product_path(g->file), g->count, e->data->points->count);
		return false;
	}
	struct features_cloud_input of = { cloud_view_of(e->data->points), g->normal,
		g->plane_error_m, g->point_size_m, e->data->points };
	g_autoptr(features) f = features_of_cloud(&of, options_of(m), cloud_progress, m);
	if (f && !take_curvatures(m->site, s->number, f, e->data->points->count, error))
		return false;
	return f ? write_file(m, s, f, error) : go_on(m, 0, error);
}

static bool make(struct maker *m, const struct scan_source *s, GError **error)
{
	m->number = s->number;
	return go_on(m, 0, error) &&
	       (s->kind == SCAN_CLOUD ? make_cloud(m, s, error) : make_grid(m, s, error));
}

bool features_site(site *s, const scan_graph *graph, const struct features_site_options *options,
	uint32_t *ret_made, GError **error)
{
	g_autoptr(GArray) sources =
		find_sources(s, graph, options ? &options->features : NULL, error);
	g_autoptr(GPtrArray) cache = g_ptr_array_new_with_free_func(entry_free);
	g_autofree char *folder = g_build_filename(site_path(s), "features", NULL);
	if (ret_made)
		*ret_made = 0;
	if (!sources || !files_make_folder(folder, error))
		return false;
	struct maker m = { .site = s, .sources = sources, .options = options, .cache = cache };
	g_autofree bool *due = g_new0(bool, sources->len + 1);
	for (guint i = 0; i < sources->len; i++)
		m.due += due[i] = why_due(s, scan_sources_at(sources, i));
	for (guint i = 0; i < sources->len; i++) {
		if (!due[i])
			continue;
		if (!make(&m, scan_sources_at(sources, i), error))
			return false;
		m.made++;
		if (ret_made)
			*ret_made = m.made;
	}
	return true;
}
