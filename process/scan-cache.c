#include "process/scan-cache.h"

struct scan_cache {
	const site *site;
	guint most;
	GPtrArray *scans; /* of scan_data, the last used last */
};

static void free_data(gpointer data)
{
	scan_data_free(data);
}

scan_cache *scan_cache_new(const site *s, guint scans)
{
	scan_cache *c = g_new(scan_cache, 1);
	*c = (scan_cache){ s, scans, g_ptr_array_new_with_free_func(free_data) };
	return c;
}

void scan_cache_free(scan_cache *c)
{
	if (!c)
		return;
	g_ptr_array_unref(c->scans);
	g_free(c);
}

const scan_data *scan_cache_load(scan_cache *c, uint32_t number, GError **error)
{
	scan_data *d = NULL;
	for (guint i = 0; i < c->scans->len && !d; i++)
		if (((scan_data *)c->scans->pdata[i])->number == number)
			d = g_ptr_array_steal_index(c->scans, i);
	if (!d && c->scans->len == c->most)
		g_ptr_array_remove_index(c->scans, 0);
	if (!d)
		d = scan_data_load(c->site, number, error);
	if (d)
		g_ptr_array_add(c->scans, d);
	return d;
}
