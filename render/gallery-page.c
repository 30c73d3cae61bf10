#include "render/gallery-page.h"
#include <errno.h>
#include <string.h>
#include <unistd.h>

static const char look[] =
	":root{color-scheme:light dark}"
	"body{font:16px/1.5 system-ui,sans-serif;margin:0;background:#f6f3ec;color:#2b2723}"
	"main{max-width:1700px;margin:0 auto;padding:1.2rem 1.5rem}h1{font-weight:600;margin:.4rem "
	"0 1rem}"
	".wall{display:grid;grid-template-columns:repeat(auto-fill,minmax(min(100%,480px),1fr));"
	"gap:1.6rem}.wall+.wall{margin-top:2rem}a{color:inherit}"
	"figure{margin:0}figcaption{margin-top:.4rem}figcaption b{font-weight:600}"
	"figcaption span{display:block;font-size:.85rem;color:#6d645a}"
	"img,video{width:100%;height:auto;display:block;border-radius:3px;box-shadow:0 1px 6px "
	"rgba(0,0,0,.25);background:#fff}h2{font-weight:600;margin:2.5rem 0 .8rem}"
	"iframe{width:100%;height:85vh;border:0;border-radius:3px;box-shadow:0 1px 6px "
	"rgba(0,0,0,.25);background:#fff}"
	"@media(prefers-color-scheme:dark){body{background:#1d1b19;color:#ece6dc}figcaption "
	"span{color:#a89f93}}";

void gallery_page_begin(GString *html, const char *title, const char *css)
{
	g_autofree char *escaped = g_markup_escape_text(title, -1);
	g_string_append_printf(html,
		"<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><meta name=\"viewport\" "
		"content=\"width=device-width\"><title>%s</title><style>%s%s</style>\n"
		"<main><h1>%s</h1>\n",
		escaped, look, css, escaped);
}

void gallery_page_end(GString *html)
{
	g_string_append(html, "</main></html>\n");
}

/* ---- links ---- */

char *gallery_page_link(const char *folder, const char *path)
{
	g_autofree char *from = g_canonicalize_filename(folder, NULL),
			*to = g_canonicalize_filename(path, NULL);
	g_auto(GStrv) down = g_strsplit(from, "/", -1), up = g_strsplit(to, "/", -1);
	g_autoptr(GString) text = g_string_new(NULL);
	guint same = 0;
	while (down[same] && up[same] && up[same + 1] && strcmp(down[same], up[same]) == 0)
		same++;
	for (guint n = same; down[n]; n++)
		g_string_append(text, "../");
	for (guint n = same; up[n]; n++) {
		g_autofree char *part = g_uri_escape_string(up[n], NULL, FALSE);
		g_string_append_printf(text, "%s%s", n > same ? "/" : "", part);
	}
	return g_string_free(g_steal_pointer(&text), FALSE);
}

/* ---- what is shown ---- */

enum shown { SHOWN_LINK, SHOWN_FILM, SHOWN_PICTURE, SHOWN_PAGE };

static enum shown kind_of(const char *path)
{
	static const struct {
		const char *end;
		enum shown kind;
	} ends[] = { { ".mp4", SHOWN_FILM }, { ".webm", SHOWN_FILM }, { ".svg", SHOWN_PICTURE },
		{ ".png", SHOWN_PICTURE }, { ".jpg", SHOWN_PICTURE }, { ".html", SHOWN_PAGE } };
	for (size_t n = 0; n < G_N_ELEMENTS(ends); n++)
		if (g_str_has_suffix(path, ends[n].end))
			return ends[n].kind;
	return SHOWN_LINK;
}

/* Of panoramas/index.html its folder. */
static char *name_of(const char *path)
{
	g_autofree char *whole = g_canonicalize_filename(path, NULL),
			*folder = g_path_get_dirname(whole);
	return g_path_get_basename(g_str_has_suffix(whole, "/index.html") ? folder : whole);
}

static void show(GString *html, const char *folder, const char *path)
{
	g_autofree char *name = name_of(path), *text = g_markup_escape_text(name, -1),
			*link = gallery_page_link(folder, path);
	switch (kind_of(path)) {
	case SHOWN_FILM:
		g_string_append_printf(html,
			"<figure><video src=\"%s\" controls loop muted playsinline "
			"preload=\"metadata\"></video><figcaption><a "
			"href=\"%s\">%s</a></figcaption></figure>\n",
			link, link, text);
		break;
	case SHOWN_PICTURE:
		g_string_append_printf(html,
			"<figure><a href=\"%s\"><img src=\"%s\" alt=\"%s\" "
			"loading=\"lazy\"></a><figcaption>%s</figcaption></figure>\n",
			link, link, text, text);
		break;
	case SHOWN_PAGE:
		g_string_append_printf(html,
			"<h2><a href=\"%s\">%s</a></h2>\n<iframe src=\"%s\" title=\"%s\" "
			"loading=\"lazy\"></iframe>\n",
			link, text, link, text);
		break;
	case SHOWN_LINK:
		g_string_append_printf(
			html, "<figure><a href=\"%s\">%s</a></figure>\n", link, text);
		break;
	}
}

void gallery_page_show_first(GString *html, const char *folder, char *const *paths)
{
	bool any = false;
	for (char *const *path = paths; path && *path; path++) {
		if (kind_of(*path) == SHOWN_PAGE)
			continue;
		g_string_append(html, any ? "" : "<div class=\"wall\">\n");
		show(html, folder, *path);
		any = true;
	}
	g_string_append(html, any ? "</div>\n" : "");
}

void gallery_page_show_last(GString *html, const char *folder, char *const *paths)
{
	for (char *const *path = paths; path && *path; path++)
		if (kind_of(*path) == SHOWN_PAGE)
			show(html, folder, *path);
}

bool gallery_page_check(char *const *paths, GError **error)
{
	for (char *const *path = paths; path && *path; path++)
		if (access(*path, R_OK) != 0) {
			g_set_error(error, G_FILE_ERROR, g_file_error_from_errno(errno), "%s: %s",
				*path, g_strerror(errno));
			return false;
		}
	return true;
}
