#ifndef RENDER_KIOSK_SITE_MAP_H
#define RENDER_KIOSK_SITE_MAP_H
/* The stations of a site from above, how they fit, and what stands around them. Main thread. */
#include "render/kiosk/kit.h"
#include "render/kiosk/site-state.h"

/* state must live as long as the widget shows it. */
GtkWidget *site_map_new(void);
void site_map_show(GtkWidget *map, const site_state *state); /* NULL: nothing */

#endif
