#ifndef RENDER_KIOSK_SCREENS_H
#define RENDER_KIOSK_SCREENS_H
/* The screens: each a widget that cares for itself until it is destroyed. folder is the site's path. */
#include "render/kiosk/kiosk.h"

/* Cards of all sites, and a new one. */
GtkWidget *screen_sites_new(kiosk *k);
/* Stations and how they fit, the drawn model, the next scan. */
GtkWidget *screen_site_new(kiosk *k, const char *folder);
/* The scan that is under way, of whatever site. */
GtkWidget *screen_scan_new(kiosk *k);
/* Two scans side by side: verdict, picked pairs, accept, refuse. a, b 0: the first pair that needs it. */
GtkWidget *screen_align_new(kiosk *k, const char *folder, uint32_t a, uint32_t b);
GtkWidget *screen_draw_new(kiosk *k, const char *folder);
/* Pictures, vector drawings, videos, and scans onto a drive. */
GtkWidget *screen_take_new(kiosk *k, const char *folder);
/* Files of other scanners and programs, from drives. */
GtkWidget *screen_bring_new(kiosk *k, const char *folder);
GtkWidget *screen_health_new(kiosk *k);

#endif
