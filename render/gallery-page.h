#ifndef RENDER_GALLERY_PAGE_H
#define RENDER_GALLERY_PAGE_H
/* What pages of pictures have in common: how they look, and the films, drawings and reports that are shown beside the pictures. No
 * script, no network. */
#include <glib.h>
#include <stdbool.h>

/* From the doctype to the title as a heading; css: of the page alone. */
void gallery_page_begin(GString *html, const char *title, const char *css);
void gallery_page_end(GString *html);

/* Files that a page in a folder shows, by what their names end in: films (mp4, webm) play, pictures (svg, png, jpg) stand there, and of
 * anything else there is a link; these come before the page's own pictures. Pages (html) are shown whole, behind them. paths: NULL or NULL-terminated. They are linked from
 * where they lie, so that the folder can be moved together with them. */
void gallery_page_show_first(GString *html, const char *folder, char *const *paths);
void gallery_page_show_last(GString *html, const char *folder, char *const *paths);
/* Each is a file that can be read; else G_FILE_ERROR, with its path. */
bool gallery_page_check(char *const *paths, GError **error);

/* How a page in a folder names a file: "../report.html"; caller frees. */
char *gallery_page_link(const char *folder, const char *path);

#endif
