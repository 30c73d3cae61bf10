#ifndef RENDER_KIOSK_SLEEP_H
#define RENDER_KIOSK_SLEEP_H
/* The screen goes dark when nobody touches it, and the touch that wakes it presses nothing else. Main thread. */
#include "render/kiosk/kit.h"

/* Above all else in the overlay of the window; lives as long as the window. after_s 0: never. */
void sleep_add(GtkWidget *window, GtkWidget *overlay, double after_s);
/* From now on. */
void sleep_after(GtkWidget *window, double after_s);

#endif
