#ifndef RENDER_KIOSK_HOLD_BUTTON_H
#define RENDER_KIOSK_HOLD_BUTTON_H
/* A button that must be held, so that nobody presses it by chance: it fills while it is, and says so when it is only tapped. Held by key
 * too. Main thread. */
#include "render/kiosk/kit.h"

#define HOLD_SECONDS 1.0

GtkWidget *hold_button_new(const char *name, const char *text, const char *classes,
	void (*held)(gpointer user_data), gpointer user_data);

#endif
