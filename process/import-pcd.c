#include "process/import-pcd.h"
#include <string.h>

struct pcd {
	import_source *file;
	struct pcd_header header;
	import_cloud *cloud;
	enum cloud_role *role; /* a field */
	bool begun;
};

static const struct pcd_field *field(const struct pcd *r, guint i)
{
	return &g_array_index(r->header.fields, struct pcd_field, i);
}

static bool is_text(const struct pcd *r)
{
	return r->header.data == PCD_TEXT;
}

/* ---- points ---- */

static void take_point(gpointer user_data, const uint8_t *point)
{
	const struct pcd *r = user_data;
	double value[CLOUD_ROLES];
	for (guint i = 0; i < r->header.fields->len; i++)
		if (r->role[i] != CLOUD_NONE)
			value[r->role[i]] = cloud_role_get(
				r->role[i], field(r, i)->type, point + field(r, i)->offset);
	import_cloud_add(r->cloud, value);
}

static bool read_line(struct pcd *r, struct import_text *t, GError **error)
{
	double value[CLOUD_ROLES], number;
	for (guint i = 0; i < r->header.fields->len; i++) {
		const struct pcd_field *f = field(r, i);
		bool bits = r->role[i] == CLOUD_RGB && f->type == CLOUD_F32;
		for (uint32_t k = 0; k < f->count; k++)
			if (!import_text_number(t, f->type, &number, error))
				return false;
		float packed = (float)number;
		value[r->role[i]] = bits ? cloud_role_get(CLOUD_RGB, CLOUD_F32, &packed) : number;
	}
	import_cloud_add(r->cloud, value);
	return import_text_end_line(t, error);
}

static bool read_text(struct pcd *r, GError **error)
{
	size_t length;
	g_autofree uint8_t *bytes = import_load(r->file, r->header.bytes, &length, error);
	if (!bytes)
		return false;
	const char *start = (const char *)bytes;
	struct import_text t = { r->file, start, start + length, r->header.lines + 1 };
	uint64_t count = (uint64_t)r->header.width * r->header.height;
	while (*t.at == '\n' || *t.at == '\r')
		t.line += *t.at++ == '\n';
	for (uint64_t i = 0; i < count; i++) {
		if (t.at >= t.end)
			return import_text_refuse(&t, error,
				"the file ends here, after %" G_GUINT64_FORMAT
				" of %" G_GUINT64_FORMAT " points",
				i, count);
		if (!read_line(r, &t, error))
			return false;
	}
	return t.at >= t.end || import_text_refuse(&t, error, "here the file should end");
}

static bool read_binary(struct pcd *r, GError **error)
{
	g_autoptr(GError) pcl = NULL;
	size_t length;
	g_autofree uint8_t *body = import_load(r->file, r->header.bytes, &length, error);
	if (!body)
		return false;
	if (pcd_read_binary(&r->header, body, take_point, r, &pcl))
		return true;
	return import_refuse(error, r->file, pcl->code, "%s", pcl->message);
}

static enum import_result pcd_next_scan(
	import_reader *reader, const struct import_scan **ret, GError **error)
{
	struct pcd *r = (struct pcd *)reader;
	if (r->begun)
		return IMPORT_END;
	r->begun = true;
	if (!(is_text(r) ? read_text : read_binary)(r, error))
		return IMPORT_BAD;
	if (r->header.height > 1 && r->header.width > 1)
		import_cloud_set_grid(r->cloud, r->header.width, r->header.height);
	import_cloud_set_pose(r->cloud, &r->header.viewpoint);
	if (!import_cloud_finish(r->cloud, error))
		return IMPORT_BAD;
	*ret = import_cloud_scan(r->cloud);
	return IMPORT_SCAN;
}

/* ---- the format ---- */

/* Comments, then the version or, where that is missing, the fields. */
static bool pcd_probe(const uint8_t *start, size_t length)
{
	static const char *const first[] = { "VERSION", "FIELDS", "COLUMNS" };
	g_autofree char *text = g_strndup((const char *)start, length);
	const char *at = text;
	while (*at == '#' || *at == '\n' || *at == '\r') {
		at = strchr(at, '\n');
		if (!at)
			return false;
		at++;
	}
	for (size_t i = 0; i < G_N_ELEMENTS(first); i++)
		if (g_str_has_prefix(at, first[i]) && strchr(" \t", at[strlen(first[i])]) &&
			at[strlen(first[i])])
			return true;
	return false;
}

static void pcd_close(import_reader *reader)
{
	struct pcd *r = (struct pcd *)reader;
	if (!r)
		return;
	pcd_header_clear(&r->header);
	import_cloud_free(r->cloud);
	g_free(r->role);
	g_free(r);
}

static bool set_columns(struct pcd *r, GError **error)
{
	const struct pcd_header *h = &r->header;
	uint64_t count = (uint64_t)h->width * h->height, body = count * h->point_bytes;
	r->role = g_new0(enum cloud_role, h->fields->len);
	for (guint i = 0; i < h->fields->len; i++) {
		enum cloud_role role = cloud_role_of(field(r, i)->name);
		r->role[i] = field(r, i)->count == 1 && role != CLOUD_CELL ? role : CLOUD_NONE;
		if (!import_cloud_column(
			    r->cloud, r->role[i], field(r, i)->type, field(r, i)->name, error))
			return false;
	}
	/* The file; PCL's cloud; when compressed its unpacked planes, too. */
	return import_cloud_reserve(r->cloud, count,
		import_source_size(r->file) +
			(is_text(r) ? 0 : body * (h->data == PCD_COMPRESSED ? 2 : 1)),
		error);
}

static import_reader *pcd_open(
	import_source *file, const struct import_options *options, GError **error)
{
	(void)options;
	struct pcd *r = g_new0(struct pcd, 1);
	r->file = file;
	r->cloud = import_cloud_new(file);
	if (pcd_header_read(file, &r->header, error) && set_columns(r, error))
		return (import_reader *)r;
	pcd_close((import_reader *)r);
	return NULL;
}

static bool pcd_read(import_reader *reader, struct point_record *into, size_t max,
	size_t *ret_count, GError **error)
{
	(void)error;
	*ret_count = import_cloud_read(((struct pcd *)reader)->cloud, into, max);
	return true;
}

static double pcd_fraction(const import_reader *reader)
{
	return import_cloud_fraction(((const struct pcd *)reader)->cloud);
}

const struct import_format import_pcd = { "PCD", "pcd", pcd_probe, pcd_open, pcd_next_scan,
	pcd_read, pcd_fraction, pcd_close };
