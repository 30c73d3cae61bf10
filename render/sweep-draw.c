#include "render/sweep-draw.h"
#include "render/gallery-page.h"
#include "render/sweep-sheet.h"
#include <errno.h>
#include <gio/gio.h>
#include <string.h>

struct run {
	const GPtrArray *sites, *sweeps;
	painter *painter;
	const struct gallery_options *options;
	GHashTable *views; /* site and name -> view */
	guint done, all;   /* pictures */
};

/* ---- what is to be drawn ---- */

/* Of those that there are; caller unrefs. */
static GPtrArray *sites_of(const struct run *r, const sweep *s)
{
	GPtrArray *some = g_ptr_array_new();
	for (guint k = 0; k < r->sites->len; k++) {
		g_autofree char *name = drawn_site_file_name(r->sites->pdata[k]);
		if (sweep_has_site(s, name))
			g_ptr_array_add(some, r->sites->pdata[k]);
	}
	return some;
}

/* Eye and target have commas, so they stand in quotes; caller frees. */
static char *view_name(const struct run *r, const sweep *s, guint i)
{
	const char *name = sweep_value(s, "view", i);
	if (!name || !strcmp(name, "-"))
		return g_strdup(r->options->view);
	gsize length = strlen(name);
	bool quoted = length > 1 && *name == '"' && name[length - 1] == '"';
	return quoted ? g_strndup(name + 1, length - 2) : g_strdup(name);
}

/* Each is looked for once; it stays the run's. */
static const view *find_view(
	struct run *r, const sweep *s, guint i, const drawn_site *d, GError **error)
{
	g_autofree char *name = view_name(r, s, i);
	g_autofree char *key = g_strdup_printf("%p %s", (const void *)d, name ? name : "");
	view *v = g_hash_table_lookup(r->views, key);
	if (!v && (v = gallery_view(d, name, error)))
		g_hash_table_insert(r->views, g_steal_pointer(&key), v);
	return v;
}

static drawing *make_drawing(const sweep *s, guint i, const drawn_site *d, GError **error)
{
	g_autoptr(style) made = sweep_style(s, i, d->folder, error);
	return made ? drawing_new(made, d->tree, NULL, error) : NULL;
}

/* Whether all that it needs is there. */
static bool check(struct run *r, const sweep *s, GError **error)
{
	g_autoptr(GPtrArray) sites = sites_of(r, s);
	for (guint k = 0; k < sites->len; k++)
		for (guint i = 0; i < s->count; i++) {
			g_autoptr(drawing) drawn = make_drawing(s, i, sites->pdata[k], error);
			if (!drawn || !find_view(r, s, i, sites->pdata[k], error))
				return false;
		}
	r->all += sites->len * s->count;
	if (!sites->len)
		g_set_error(error, STYLE_ERROR, STYLE_ERROR_FIELD, "%s: none of the sites is '%s'",
			s->title, sweep_value(s, "site", 0));
	return sites->len;
}

/* Two of one title have names of their own all the same. */
static void tell_apart(const GPtrArray *sweeps)
{
	for (guint k = 1; k < sweeps->len; k++)
		for (guint j = 0; j < k; j++) {
			sweep *s = sweeps->pdata[k];
			if (strcmp(s->name, ((const sweep *)sweeps->pdata[j])->name))
				continue;
			char *other = g_strdup_printf("%s-%u", s->name, k + 1);
			g_free(s->name);
			s->name = other;
		}
}

/* ---- one sweep ---- */

static bool go_on(struct run *r, const sweep *s, guint i, GError **error)
{
	const struct gallery_options *o = r->options;
	g_autofree char *label = sweep_label(s, i);
	g_autofree char *doing = g_strdup_printf("%s: %s", s->title, label);
	if (!o->progress || o->progress((double)r->done++ / r->all, doing, o->user_data))
		return true;
	g_set_error(error, G_IO_ERROR, G_IO_ERROR_CANCELLED, "stopped before %s", doing);
	return false;
}

static bool draw_value(struct run *r, const sweep *s, guint i, const drawn_site *d,
	struct picture_buffer *ret, GError **error)
{
	g_autoptr(drawing) drawn = make_drawing(s, i, d, error);
	const view *v = drawn ? find_view(r, s, i, d, error) : NULL;
	return v && gallery_picture(d, r->painter, drawn, v, r->options, ret, error);
}

/* pictures: count of the first site, count of the next. */
static bool draw_all(struct run *r, const sweep *s, const GPtrArray *sites,
	struct picture_buffer *pictures, GError **error)
{
	for (guint k = 0; k < sites->len; k++)
		for (guint i = 0; i < s->count; i++)
			if (!go_on(r, s, i, error) || !draw_value(r, s, i, sites->pdata[k],
							      &pictures[k * s->count + i], error))
				return false;
	return true;
}

static bool save_pictures(const struct run *r, const sweep *s, const GPtrArray *sites,
	const struct picture_buffer *pictures, GError **error)
{
	for (guint n = 0; n < sites->len * s->count; n++) {
		g_autofree char *file =
			sweep_file(r->sites, s, sites->pdata[n / s->count], n % s->count);
		g_autofree char *path = g_build_filename(r->options->folder, file, NULL);
		if (!picture_buffer_save(&pictures[n], path, error))
			return false;
	}
	return true;
}

static bool save_sheet(const struct run *r, const sweep *s, const GPtrArray *sites,
	const struct picture_buffer *pictures, GError **error)
{
	g_autofree char *fixed = sweep_fixed(s), *file = g_strconcat(s->name, ".png", NULL),
			*path = g_build_filename(r->options->folder, file, NULL);
	g_autoptr(sheet) to = sheet_new(
		s->title, fixed, s->count, sites->len, pictures[0].width, pictures[0].height);
	for (guint i = 0; i < s->count; i++) {
		g_autofree char *label = sweep_label(s, i);
		for (guint k = 0; k < sites->len; k++)
			sheet_put(to, i, k, &pictures[k * s->count + i]);
		sheet_label(to, i, label);
	}
	return sheet_save(to, path, error);
}

static bool draw_sweep(struct run *r, const sweep *s, GError **error)
{
	g_autoptr(GPtrArray) sites = sites_of(r, s);
	guint count = sites->len * s->count;
	g_autofree struct picture_buffer *pictures = g_new0(struct picture_buffer, count);
	bool good = draw_all(r, s, sites, pictures, error) &&
		    save_pictures(r, s, sites, pictures, error) &&
		    save_sheet(r, s, sites, pictures, error);
	for (guint n = 0; n < count; n++)
		picture_buffer_clear(&pictures[n]);
	return good;
}

/* ---- all ---- */

static bool draw_each(struct run *r, GError **error)
{
	const char *folder = r->options->folder;
	for (guint k = 0; k < r->sweeps->len; k++)
		if (!check(r, r->sweeps->pdata[k], error))
			return false;
	if (!gallery_page_check(r->options->with, error))
		return false;
	if (g_mkdir_with_parents(folder, 0777) != 0) {
		g_set_error(error, G_FILE_ERROR, g_file_error_from_errno(errno), "%s: %s", folder,
			g_strerror(errno));
		return false;
	}
	for (guint k = 0; k < r->sweeps->len; k++)
		if (!draw_sweep(r, r->sweeps->pdata[k], error) ||
			!sweeps_write_page(r->sites, r->sweeps, k + 1, r->options, error))
			return false;
	return true;
}

bool sweeps_draw(const GPtrArray *sites, painter *p, const GPtrArray *sweeps,
	const struct gallery_options *options, GError **error)
{
	g_autoptr(GHashTable) views =
		g_hash_table_new_full(g_str_hash, g_str_equal, g_free, (GDestroyNotify)view_free);
	struct run r = { sites, sweeps, p, options, views, 0, 0 };
	tell_apart(sweeps);
	return draw_each(&r, error);
}
