#ifndef RENDER_KIOSK_TAKE_MADE_H
#define RENDER_KIOSK_TAKE_MADE_H
/* What was made of a site, the newest first: to look at, and to remove. What is removed can be brought back until the screen is
 * left. Main thread. */
#include "render/kiosk/kiosk.h"

typedef struct take_made take_made;
/* The box owns it. */
take_made *take_made_new(kiosk *k, const char *site);
GtkWidget *take_made_box(take_made *m);
/* Looks at the folder again. */
void take_made_refresh(take_made *m);

#endif
