#include "process/site-lines.h"
#include "process/segments.h"
#include <json-glib/json-glib.h>
#include <math.h>
#include <string.h>

char *site_lines_path(const char *site_path)
{
	return g_build_filename(site_path, "model", "profile.lines", NULL);
}

/* ---- reading ---- */

static bool is_wrong(const product *file, const char *what, GError **error)
{
	g_set_error(
		error, PRODUCT_ERROR, PRODUCT_ERROR_DAMAGED, "%s: %s", product_path(file), what);
	return false;
}

static bool has_finite_places(const profile_lines *p)
{
	for (int k = 0; k < 3; k++)
		if (!isfinite(p->origin_m[k]))
			return false;
	for (guint n = 0; n < p->vertex->len; n++)
		for (int k = 0; k < 3; k++)
			if (!isfinite(g_array_index(p->vertex, struct profile_vertex, n).at_m[k]))
				return false;
	return true;
}

/* Each vertex is of one line at most. */
static bool share_out(const profile_lines *p)
{
	g_autofree uint8_t *is_taken = g_new0(uint8_t, p->vertex->len + 1);
	for (guint n = 0; n < p->line->len; n++) {
		const struct profile_line *l = &g_array_index(p->line, struct profile_line, n);
		if (l->count < 2 || (uint64_t)l->first + l->count > p->vertex->len)
			return false;
		for (uint32_t k = 0; k < l->count; k++)
			if (is_taken[l->first + k]++)
				return false;
	}
	return true;
}

static bool is_of_a_kind(const struct profile_line *l)
{
	return l->kind < PROFILE_KINDS && l->closed <= 1 && isfinite(l->length_m) &&
	       l->length_m >= 0 && l->confidence >= 0 && l->confidence <= 1;
}

static bool check(const product *file, const profile_lines *p, GError **error)
{
	if (!share_out(p))
		return is_wrong(file, "lines and vertices do not belong together", error);
	for (guint n = 0; n < p->line->len; n++)
		if (!is_of_a_kind(&g_array_index(p->line, struct profile_line, n)))
			return is_wrong(file, "a line is of no kind that there is", error);
	return has_finite_places(p) || is_wrong(file, "a line's place is not a number", error);
}

/* Mapped files may be damaged where nobody looked yet, so that sums are compared first. */
static profile_lines *read_file(const product *file, GError **error)
{
	uint64_t lines, vertices, numbers;
	if (!product_verify(file, error))
		return NULL;
	const void *line = product_section(
			   file, "lines", sizeof(struct profile_line), &lines, error),
		   *vertex = line ? product_section(file, "vertices", sizeof(struct profile_vertex),
					    &vertices, error)
				  : NULL;
	const double *origin_m =
		vertex ? product_section(file, "origin", sizeof(double), &numbers, error) : NULL;
	if (!origin_m)
		return NULL;
	if (numbers != 3 || lines > UINT32_MAX || vertices > UINT32_MAX) {
		is_wrong(file, "it has other sections than lines have", error);
		return NULL;
	}
	profile_lines *p = profile_lines_new();
	g_array_append_vals(p->line, line, (guint)lines);
	g_array_append_vals(p->vertex, vertex, (guint)vertices);
	memcpy(p->origin_m, origin_m, sizeof p->origin_m);
	return p;
}

profile_lines *site_lines_load_file(const char *path, GError **error)
{
	g_autoptr(product) file = product_open(path, SITE_LINES_KIND, SITE_LINES_VERSION, error);
	g_autoptr(profile_lines) p = file ? read_file(file, error) : NULL;
	return p && check(file, p, error) ? g_steal_pointer(&p) : NULL;
}

profile_lines *site_lines_load(const char *site_path, GError **error)
{
	g_autofree char *path = site_lines_path(site_path);
	return site_lines_load_file(path, error);
}

/* ---- what they are made from ---- */

static char *key_of(const product *model_file, const uint8_t *leaf_class)
{
	return g_strdup_printf("%s %d model %08x classes %08x", SITE_LINES_KIND, SITE_LINES_VERSION,
		product_checksum(model_file), segments_classes_checksum(leaf_class));
}

/* Why they must be made; NULL: they need not. What cannot be read is made again. */
static const char *why_due(const site *s, const char *key)
{
	g_autofree char *path = site_lines_path(site_path(s));
	g_autoptr(GError) damage = NULL;
	g_autoptr(product) file = product_open(path, SITE_LINES_KIND, SITE_LINES_VERSION, &damage);
	if (g_error_matches(damage, G_IO_ERROR, G_IO_ERROR_NOT_FOUND))
		return "the model has no lines yet";
	if (!file)
		return "the lines cannot be read";
	JsonNode *is = json_object_get_member(product_manifest(file), "key");
	bool same =
		is && JSON_NODE_HOLDS_VALUE(is) && g_strcmp0(json_node_get_string(is), key) == 0;
	return same ? NULL : "the model that the lines are of has changed";
}

bool site_lines_is_due(const site *s, bool *ret_due, char **ret_why, GError **error)
{
	g_autofree char *path = model_path(site_path(s)), *key = NULL;
	g_autofree uint8_t *leaf_class = NULL;
	g_autoptr(product) model_file = product_open(path, MODEL_KIND, MODEL_VERSION, NULL);
	const char *why = NULL;
	if (model_file) {
		if (!segments_classes_load(site_path(s), &leaf_class, error))
			return false;
		key = key_of(model_file, leaf_class);
		why = why_due(s, key);
	}
	*ret_due = why;
	*ret_why = g_strdup(why);
	return true;
}

/* ---- making them ---- */

static bool write_section(product_writer *w, const char *name, uint32_t bytes, const void *values,
	uint64_t count, GError **error)
{
	return product_writer_begin(w, name, bytes, error) &&
	       product_writer_append(w, values, count, error);
}

static bool write_file(const site *s, const profile_lines *p, const char *key, GError **error)
{
	g_autofree char *path = site_lines_path(site_path(s));
	g_autoptr(product_writer) w = product_writer_new(path, error);
	if (!w ||
		!write_section(w, "lines", sizeof(struct profile_line), p->line->data, p->line->len,
			error) ||
		!write_section(w, "vertices", sizeof(struct profile_vertex), p->vertex->data,
			p->vertex->len, error) ||
		!write_section(w, "origin", sizeof(double), p->origin_m, 3, error))
		return false;
	JsonObject *made_from = json_object_new();
	json_object_set_string_member(made_from, "key", key);
	return product_writer_finish(w, SITE_LINES_KIND, SITE_LINES_VERSION, made_from, error);
}

static bool pass_on(double fraction, gpointer user_data)
{
	const struct site_lines_options *o = user_data;
	return !o->progress || o->progress(fraction, "profile lines", o->user_data);
}

profile_lines *site_lines_make(site *s, const struct site_lines_options *options, GError **error)
{
	struct site_lines_options own = options ? *options : (struct site_lines_options){ 0 };
	g_autofree uint8_t *leaf_class = NULL;
	g_autoptr(model) m = model_open(site_path(s), error);
	if (!m || !segments_classes_load(site_path(s), &leaf_class, error))
		return NULL;
	const struct profile_options find = {
		.leaf_class = leaf_class, .progress = pass_on, .user_data = &own
	};
	g_autoptr(profile_lines) p = profile_lines_find(m, &find);
	if (!p) {
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_CANCELLED,
			"stopped while profile lines were looked for");
		return NULL;
	}
	g_autofree char *key = key_of(model_file(m), leaf_class);
	return write_file(s, p, key, error) ? g_steal_pointer(&p) : NULL;
}
