#include "render/sweep-draw.h"
#include <string.h>

/* Their files have the names of their folders. */
static bool check_names(const GPtrArray *sites, GError **error)
{
	for (guint k = 1; k < sites->len; k++)
		for (guint j = 0; j < k; j++) {
			g_autofree char *a = drawn_site_file_name(sites->pdata[j]),
					*b = drawn_site_file_name(sites->pdata[k]);
			if (strcmp(a, b) == 0) {
				g_set_error(error, STYLE_ERROR, STYLE_ERROR_FIELD,
					"two of the sites are named '%s'", a);
				return false;
			}
		}
	return true;
}

static GPtrArray *load_sites(char **paths, const struct gallery_options *o, GError **error)
{
	g_autoptr(GPtrArray) sites =
		g_ptr_array_new_with_free_func((GDestroyNotify)drawn_site_free);
	for (; *paths; paths++) {
		drawn_site *d = drawn_site_new(*paths, (double)o->width / o->height, error);
		if (d)
			g_ptr_array_add(sites, d);
		if (!d || !drawn_site_load(d, error))
			return NULL;
	}
	return g_steal_pointer(&sites);
}

bool sweeps_draw_sites(
	char **paths, const GPtrArray *sweeps, const struct gallery_options *o, GError **error)
{
	g_autoptr(GPtrArray) sites = load_sites(paths, o, error);
	g_autoptr(painter) p = sites ? painter_new(BACKEND_WISH_AUTO, error) : NULL;
	return p && check_names(sites, error) && sweeps_draw(sites, p, sweeps, o, error);
}
