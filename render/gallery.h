#ifndef RENDER_GALLERY_H
#define RENDER_GALLERY_H
/* Pictures of a site in several styles, and one HTML page that shows them: no script, no network, pictures beside it. */
#include "render/drawn-site.h"
#include "render/painter.h"

struct gallery_options {
	const char *
		folder; /* made when it is missing; STYLE.png, contact-sheet.png of all and index.html */
	const char *view;                    /* NULL: walk, or overview where the site has none */
	uint32_t width, height, supersample; /* 0: 800, 600, 2 */
	const char *title;                   /* of the page; NULL: a usual one */
	char *const *
		with; /* other files that the page shows (gallery-page.h), NULL-terminated; NULL: none */
	bool (*progress)(
		double fraction, const char *doing, gpointer user_data); /* returns false to stop */
	gpointer user_data;
};
/* names: of styles, NULL-terminated. A style that cannot be drawn ends it. G_IO_ERROR_CANCELLED when progress stopped it. */
bool gallery_write(const drawn_site *d, painter *p, char *const *names,
	const struct gallery_options *options, GError **error);

/* ---- what other pages of pictures have in common with it ---- */

/* name NULL: walk, or overview where the site has none. */
view *gallery_view(const drawn_site *d, const char *name, GError **error);
/* Of the style that is drawn; caller clears *ret. Width, height and supersample of the options count. */
bool gallery_picture(const drawn_site *d, painter *p, drawing *drawn, const view *v,
	const struct gallery_options *o, struct picture_buffer *ret, GError **error);

#endif
