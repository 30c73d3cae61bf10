#include "firmware-io/files.h"
#include "render/gallery-page.h"
#include "render/sweep-draw.h"
#include <string.h>

static const char css[] = "section{margin:0 0 3.5rem}section h2{margin:0}p{margin:.2rem 0 .8rem;"
			  "max-width:62rem}nav{columns:16rem;margin:0 0 2.5rem}nav a{display:block}"
			  "section div{font-size:.85rem;margin-top:.5rem}";

char *drawn_site_file_name(const drawn_site *d)
{
	g_autofree char *path = g_canonicalize_filename(d->folder, NULL);
	return g_path_get_basename(path);
}

char *sweep_file(const GPtrArray *sites, const sweep *s, const drawn_site *d, guint i)
{
	g_autofree char *of = drawn_site_file_name(d);
	return sites->len > 1 ? g_strdup_printf("%s-%s-%u.png", s->name, of, i + 1)
			      : g_strdup_printf("%s-%u.png", s->name, i + 1);
}

/* "at full size: length_px 8, length_px 16". */
static void append_links(GString *html, const GPtrArray *sites, const sweep *s, const drawn_site *d)
{
	g_autofree char *of = drawn_site_file_name(d), *name = g_markup_escape_text(of, -1);
	g_string_append_printf(html, "<div>%s at full size: ", name);
	for (guint i = 0; i < s->count; i++) {
		g_autofree char *label = sweep_label(s, i), *text = g_markup_escape_text(label, -1),
				*file = sweep_file(sites, s, d, i),
				*link = g_uri_escape_string(file, NULL, FALSE);
		g_string_append_printf(
			html, "%s<a href=\"%s\">%s</a>", i ? " &middot; " : "", link, text);
	}
	g_string_append(html, "</div>\n");
}

static void append_sheet(GString *html, const GPtrArray *sites, const sweep *s)
{
	g_autofree char *title = g_markup_escape_text(s->title, -1),
			*caption = g_markup_escape_text(s->caption, -1);
	g_string_append_printf(html,
		"<section id=\"%s\"><h2>%s</h2><p>%s</p>\n<a href=\"%s.png\"><img src=\"%s.png\" "
		"alt=\"%s\" loading=\"lazy\"></a>\n",
		s->name, title, caption, s->name, s->name, title);
	for (guint k = 0; k < sites->len; k++) {
		const drawn_site *d = sites->pdata[k];
		g_autofree char *of = drawn_site_file_name(d);
		if (sweep_has_site(s, of))
			append_links(html, sites, s, d);
	}
	g_string_append(html, "</section>\n");
}

static void append_contents(GString *html, const GPtrArray *sweeps, guint drawn)
{
	g_string_append(html, "<nav>");
	for (guint k = 0; k < drawn; k++) {
		const sweep *s = sweeps->pdata[k];
		g_autofree char *title = g_markup_escape_text(s->title, -1);
		g_string_append_printf(html, "<a href=\"#%s\">%s</a>", s->name, title);
	}
	g_string_append(html, "</nav>\n");
}

bool sweeps_write_page(const GPtrArray *sites, const GPtrArray *sweeps, guint drawn,
	const struct gallery_options *o, GError **error)
{
	g_autofree char *path = g_build_filename(o->folder, "index.html", NULL);
	g_autoptr(GString) html = g_string_new(NULL);
	gallery_page_begin(html, o->title ? o->title : "What parameters do", css);
	append_contents(html, sweeps, drawn);
	gallery_page_show_first(html, o->folder, o->with);
	for (guint k = 0; k < drawn; k++)
		append_sheet(html, sites, sweeps->pdata[k]);
	gallery_page_show_last(html, o->folder, o->with);
	gallery_page_end(html);
	return files_write(path, html->str, html->len, error);
}
