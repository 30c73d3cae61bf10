#ifndef RENDER_SWEEP_DRAW_H
#define RENDER_SWEEP_DRAW_H
/* Sweeps drawn: of each its pictures, NAME-1.png and so on (NAME-SITE-1.png of several sites), and the contact sheet NAME.png; and
 * index.html, which shows all sheets. One thread. */
#include "render/gallery.h"
#include "render/sweep.h"

/* sites: of drawn_site *, loaded; sweeps: of sweep *. What a sweep asks for is looked at before anything is drawn, and its files are
 * written when all of its pictures are there: an error leaves whole sheets behind, and a page of them. options->view: of sweeps that name
 * none. G_IO_ERROR_CANCELLED when progress stopped it. */
bool sweeps_draw(const GPtrArray *sites, painter *p, const GPtrArray *sweeps,
	const struct gallery_options *options, GError **error);

/* The same of sites by their folders, NULL-terminated, which have different names. */
bool sweeps_draw_sites(char **paths, const GPtrArray *sweeps, const struct gallery_options *options,
	GError **error);

/* The page, from the sweeps that are drawn: the first so many. */
bool sweeps_write_page(const GPtrArray *sites, const GPtrArray *sweeps, guint drawn,
	const struct gallery_options *options, GError **error);
/* For links and files: NAME-SITE-1.png; caller frees. */
char *sweep_file(const GPtrArray *sites, const sweep *s, const drawn_site *d, guint i);
char *drawn_site_file_name(const drawn_site *d); /* of its folder; caller frees */

#endif
