#ifndef RENDER_KIOSK_THUMBNAIL_H
#define RENDER_KIOSK_THUMBNAIL_H
/* A small drawn picture of a site, kept in the person's cache until the site's model changes. Main thread; drawing is done on another,
 * one site at a time. */
#include <gtk/gtk.h>

#define THUMBNAIL_WIDTH  480
#define THUMBNAIL_HEIGHT 300

/* Into the picture, soon; nothing for a site without a model. */
void thumbnail_show(const char *site_path, GtkPicture *picture);

#endif
