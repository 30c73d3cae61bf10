#include "process/plane-site.h"
#include "process/segments.h"
#include <gio/gio.h>

static bool say_due(const char *why, bool *ret_due, char **ret_why)
{
	*ret_due = why != NULL;
	*ret_why = g_strdup(why);
	return true;
}

static const char *why_due(const site *s, const model *m, const uint8_t *leaf_class)
{
	g_autofree char *path = plane_regions_path(site_path(s));
	g_autoptr(GError) none = NULL;
	g_autoptr(plane_regions) r = plane_regions_open(path, &none);
	if (g_error_matches(none, G_IO_ERROR, G_IO_ERROR_NOT_FOUND))
		return "there are no planes yet";
	if (!r)
		return "the planes cannot be read";
	if (product_version(r->file) < PLANE_REGIONS_VERSION)
		return "planes are found otherwise now";
	if (!plane_regions_are_of(r, m))
		return "the model has changed";
	return r->classes == segments_classes_checksum(leaf_class)
		       ? NULL
		       : "what is a wall and what is ground has changed";
}

bool plane_site_is_due(const site *s, bool *ret_due, char **ret_why, GError **error)
{
	g_autofree uint8_t *leaf_class = NULL;
	g_autoptr(model) m = model_open(site_path(s), NULL);
	if (m && !segments_classes_load(site_path(s), &leaf_class, error))
		return false;
	return say_due(m ? why_due(s, m, leaf_class) : NULL, ret_due, ret_why);
}

static void sum_up(const plane_regions *r, struct plane_site_result *ret)
{
	*ret = (struct plane_site_result){ .planes = r->count, .points = r->points };
	for (uint32_t n = 0; n < r->count; n++) {
		ret->explained += r->region[n].points;
		ret->area_m2 += (double)r->region[n].area_m2;
	}
}

bool plane_site(
	const site *s, const struct plane_options *o, struct plane_site_result *ret, GError **error)
{
	struct plane_options options = *o;
	g_autofree char *path = plane_regions_path(site_path(s));
	g_autoptr(model) m = model_open(site_path(s), error);
	g_autofree uint8_t *leaf_class =
		NULL; /* NULL: nobody knows what is a wall, and all of it may be */
	if (!m || !segments_classes_load(site_path(s), &leaf_class, error))
		return false;
	options.leaf_class = leaf_class;
	g_autoptr(GError) wrong = NULL;
	g_autoptr(plane_regions) r = plane_regions_find(m, &options, &wrong);
	if (!r && !wrong)
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_CANCELLED, "stopped");
	else if (!r)
		g_propagate_error(error, g_steal_pointer(&wrong));
	if (!r || !plane_regions_save(r, m, path, error))
		return false;
	sum_up(r, ret);
	return true;
}
