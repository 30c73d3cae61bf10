#include "render/gallery.h"
#include "render/gallery-page.h"
#include "render/scene-pager.h"
#include "render/sweep-sheet.h"
#include <errno.h>
#include <gio/gio.h>

static struct gallery_options filled_in(const struct gallery_options *o)
{
	struct gallery_options r = *o;
	r.width = r.width ? r.width : 800;
	r.height = r.height ? r.height : 600;
	r.supersample = r.supersample ? r.supersample : 2;
	return r;
}

view *gallery_view(const drawn_site *d, const char *name, GError **error)
{
	view *v = NULL;
	if (!name)
		v = view_built_in(&d->sources, "walk");
	if (!v && !view_find(&d->sources, name ? name : "overview", &v, error))
		return NULL;
	return v;
}

bool gallery_picture(const drawn_site *d, painter *p, drawing *drawn, const view *v,
	const struct gallery_options *o, struct picture_buffer *ret, GError **error)
{
	struct camera c = view_camera(v, o->width, o->height);
	c = camera_scaled(&c, o->supersample);
	g_autoptr(frame) f = frame_new(d->scene, drawn, &c, error);
	if (!f || !scene_pager_settle_for(d->scene, &c, f->ink_px, error))
		return false;
	struct picture_buffer large = picture_buffer_new(c.width, c.height);
	bool good = painter_draw(p, f, &large, NULL, error);
	if (good)
		*ret = picture_buffer_reduced(&large, o->supersample);
	picture_buffer_clear(&large);
	return good;
}

static bool draw_style(const drawn_site *d, painter *p, const char *name, const view *v,
	const struct gallery_options *o, sheet *all, guint cell, GError **error)
{
	struct picture_buffer small = { 0 };
	g_autoptr(drawing) drawn = drawn_site_style(d, name, error);
	if (!drawn || !gallery_picture(d, p, drawn, v, o, &small, error))
		return false;
	g_autofree char *file = g_strdup_printf("%s.png", name);
	g_autofree char *path = g_build_filename(o->folder, file, NULL);
	bool good = picture_buffer_save(&small, path, error);
	sheet_put(all, cell, 0, &small);
	sheet_label(all, cell, name);
	picture_buffer_clear(&small);
	return good;
}

static bool append_style(GString *html, const drawn_site *d, const char *name, GError **error)
{
	g_autoptr(style) s = style_find(name, d->folder, error);
	if (!s)
		return false;
	g_autofree char *title = g_markup_escape_text(s->title, -1),
			*source = g_markup_escape_text(s->source, -1),
			*text = g_markup_escape_text(s->description, -1),
			*file = g_uri_escape_string(name, NULL, FALSE);
	g_string_append_printf(html,
		"<figure><a href=\"%s.png\"><img src=\"%s.png\" alt=\"%s\" loading=\"lazy\"></a>"
		"<figcaption><b>%s</b> &middot; "
		"%s<span>%s</span><span>%s</span></figcaption></figure>\n",
		file, file, title, title, file, text, source);
	return true;
}

static char *title_of(const drawn_site *d, const struct gallery_options *o)
{
	const char *name = manifest_get_string(site_manifest(d->site), "name", NULL);
	return o->title ? g_strdup(o->title)
			: g_strdup_printf("%s in all styles", name ? name : "site");
}

static bool write_page(const drawn_site *d, char *const *names, const char *title,
	const struct gallery_options *o, GError **error)
{
	g_autofree char *path = g_build_filename(o->folder, "index.html", NULL);
	g_autoptr(GString) html = g_string_new(NULL);
	gallery_page_begin(html, title, "");
	gallery_page_show_first(html, o->folder, o->with);
	g_string_append(html, "<p><a href=\"contact-sheet.png\">All styles on one sheet</a></p>\n"
			      "<div class=\"wall\">\n");
	for (char *const *name = names; *name; name++)
		if (!append_style(html, d, *name, error))
			return false;
	g_string_append(html, "</div>\n");
	gallery_page_show_last(html, o->folder, o->with);
	gallery_page_end(html);
	return g_file_set_contents(path, html->str, (gssize)html->len, error);
}

static bool go_on(
	const struct gallery_options *o, double fraction, const char *name, GError **error)
{
	if (!o->progress || o->progress(fraction, name, o->user_data))
		return true;
	g_set_error(error, G_IO_ERROR, G_IO_ERROR_CANCELLED, "stopped before %s", name);
	return false;
}

bool gallery_write(const drawn_site *d, painter *p, char *const *names,
	const struct gallery_options *options, GError **error)
{
	struct gallery_options o = filled_in(options);
	g_autoptr(view) v = gallery_view(d, o.view, error);
	guint count = g_strv_length((char **)names);
	if (!v || !gallery_page_check(o.with, error))
		return false;
	if (g_mkdir_with_parents(o.folder, 0777) != 0) {
		g_set_error(error, G_FILE_ERROR, g_file_error_from_errno(errno), "%s: %s", o.folder,
			g_strerror(errno));
		return false;
	}
	g_autofree char *title = title_of(d, &o),
			*path = g_build_filename(o.folder, "contact-sheet.png", NULL);
	g_autoptr(sheet) all = sheet_new(title, v->title, count, 1, o.width, o.height);
	for (guint n = 0; n < count; n++)
		if (!go_on(&o, (double)n / count, names[n], error) ||
			!draw_style(d, p, names[n], v, &o, all, n, error))
			return false;
	return sheet_save(all, path, error) && write_page(d, names, title, &o, error);
}
