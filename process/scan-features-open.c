#include "process/scan-features.h"

static bool differs(const scan_features *f, GError **error)
{
	g_set_error(error, PRODUCT_ERROR, PRODUCT_ERROR_DAMAGED,
		"%s: its sections differ in length", product_path(f->file));
	return false;
}

static bool take(
	scan_features *f, const char *name, uint32_t bytes, const void *ret, GError **error)
{
	uint64_t count;
	const void *section = product_section(f->file, name, bytes, &count, error);
	if (!section)
		return false;
	*(const void **)ret = section;
	if (f->degree == section)
		f->count = count;
	return count == f->count || differs(f, error);
}

scan_features *scan_features_open(const site *s, uint32_t number, GError **error)
{
	g_autoptr(scan_features) f = g_new0(scan_features, 1);
	g_autofree char *path = g_strdup_printf("%s/features/%04u.features", site_path(s), number);
	f->file = product_open(path, SCAN_FEATURES_KIND, SCAN_FEATURES_VERSION, error);
	if (!f->file || !take(f, "degree", 1, &f->degree, error) ||
		!take(f, "kind", 1, &f->kind, error) || !take(f, "flags", 1, &f->flags, error) ||
		!take(f, "direction", 4, &f->direction, error) ||
		!take(f, "line_error", 2, &f->line_error, error) ||
		!take(f, "k1", 4, &f->k1, error) || !take(f, "k2", 4, &f->k2, error) ||
		!take(f, "principal", 4, &f->principal, error))
		return NULL;
	return g_steal_pointer(&f);
}

void scan_features_free(scan_features *f)
{
	if (!f)
		return;
	product_free(f->file);
	g_free(f);
}
