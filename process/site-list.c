#include "process/site-list.h"
#include "firmware-io/files.h"
#include "process/model.h"
#include "process/scan-graph.h"
#include <gio/gio.h>
#include <glib/gstdio.h>

static void listed_site_free(gpointer data)
{
	struct listed_site *l = data;
	g_free(l->path);
	g_free(l->name);
	g_free(l->created);
	g_free(l->error);
	g_free(l);
}

/* ---- one site ---- */

static void see_change(struct listed_site *l, const char *below)
{
	g_autofree char *path = g_build_filename(l->path, below, NULL);
	GStatBuf st;
	if (!g_stat(path, &st) && st.st_mtime > l->changed)
		l->changed = st.st_mtime;
}

static uint64_t size_of(const char *path)
{
	g_autoptr(GFile) file = g_file_new_for_path(path);
	guint64 bytes = 0;
	g_file_measure_disk_usage(file, G_FILE_MEASURE_APPARENT_SIZE | G_FILE_MEASURE_NO_XDEV, NULL,
		NULL, NULL, &bytes, NULL, NULL, NULL);
	return bytes;
}

static void count_placed(struct listed_site *l, const scan_graph *g)
{
	for (guint i = 0; i < g->scans->len; i++) {
		uint32_t group = g_array_index(g->scans, struct placed_scan, i).group;
		l->groups = MAX(l->groups, group);
		l->placed += group == 1;
	}
}

static void read_site(struct listed_site *l, GError **error)
{
	g_autoptr(site) s = site_open(l->path, error);
	if (!s)
		return;
	const char *name = manifest_get_string(site_manifest(s), "name", error);
	if (!name)
		return;
	g_free(l->name);
	l->name = g_strdup(name);
	const char *created = manifest_get_string(site_manifest(s), "created", error);
	l->created = g_strdup(created);
	g_autoptr(GArray) scans = created ? site_scans(s, error) : NULL;
	if (!scans || !site_find_partial(s, &l->partial, error))
		return;
	l->scans = scans->len;
	g_autoptr(scan_graph) graph = scan_graph_load(s, error);
	if (graph)
		count_placed(l, graph);
}

static struct listed_site *look_at(const char *folder, const char *name)
{
	struct listed_site *l = g_new0(struct listed_site, 1);
	g_autoptr(GError) error = NULL;
	l->path = g_build_filename(folder, name, NULL);
	l->name = g_strdup(name);
	g_autofree char *model_file = model_path(l->path);
	l->has_model = g_file_test(model_file, G_FILE_TEST_IS_REGULAR);
	see_change(l, "site.json");
	see_change(l, "scans");
	see_change(l, "poses");
	see_change(l, "model");
	read_site(l, &error);
	l->error = error ? g_strdup(error->message) : NULL;
	l->bytes = size_of(l->path);
	return l;
}

/* ---- all ---- */

static int newest_first(gconstpointer a, gconstpointer b)
{
	const struct listed_site *x = *(struct listed_site *const *)a,
				 *y = *(struct listed_site *const *)b;
	if (x->changed != y->changed)
		return x->changed < y->changed ? 1 : -1;
	return g_strcmp0(x->path, y->path);
}

GPtrArray *site_list(const char *folder, GError **error)
{
	g_autoptr(GPtrArray) sites = g_ptr_array_new_with_free_func(listed_site_free);
	g_autoptr(GPtrArray) names = NULL;
	if (!g_file_test(folder, G_FILE_TEST_EXISTS))
		return g_steal_pointer(&sites);
	names = files_names(folder, error);
	if (!names)
		return NULL;
	for (guint i = 0; i < names->len; i++) {
		if (*(const char *)names->pdata[i] == '.') /* hidden, as what was removed is */
			continue;
		g_autofree char *mark =
			g_build_filename(folder, names->pdata[i], "site.json", NULL);
		if (g_file_test(mark, G_FILE_TEST_EXISTS) &&
			g_utf8_validate(names->pdata[i], -1, NULL))
			g_ptr_array_add(sites, look_at(folder, names->pdata[i]));
	}
	g_ptr_array_sort(sites, newest_first);
	return g_steal_pointer(&sites);
}

static void add_text(GVariantBuilder *b, const char *key, const char *text)
{
	g_autofree char *valid = g_utf8_make_valid(text ? text : "", -1);
	g_variant_builder_add(b, "{sv}", key, g_variant_new_string(valid));
}

static void add_number(GVariantBuilder *b, const char *key, uint32_t n)
{
	g_variant_builder_add(b, "{sv}", key, g_variant_new_uint32(n));
}

GVariant *site_list_variant(const GPtrArray *sites)
{
	GVariantBuilder all;
	g_variant_builder_init(&all, G_VARIANT_TYPE("aa{sv}"));
	for (guint i = 0; i < sites->len; i++) {
		const struct listed_site *l = sites->pdata[i];
		GVariantBuilder b;
		g_variant_builder_init(&b, G_VARIANT_TYPE_VARDICT);
		add_text(&b, "path", l->path);
		add_text(&b, "name", l->name);
		add_text(&b, "created", l->created);
		g_variant_builder_add(&b, "{sv}", "changed", g_variant_new_int64(l->changed));
		add_number(&b, "scans", l->scans);
		add_number(&b, "placed", l->placed);
		add_number(&b, "groups", l->groups);
		add_number(&b, "partial", l->partial);
		g_variant_builder_add(&b, "{sv}", "model", g_variant_new_boolean(l->has_model));
		g_variant_builder_add(&b, "{sv}", "bytes", g_variant_new_uint64(l->bytes));
		if (l->error)
			add_text(&b, "error", l->error);
		g_variant_builder_add(&all, "a{sv}", &b);
	}
	return g_variant_builder_end(&all);
}
