#ifndef RENDER_KIOSK_PRESET_CHOOSER_H
#define RENDER_KIOSK_PRESET_CHOOSER_H
/* How finely to scan: a button for each preset, with what it will take. Main thread. */
#include "render/kiosk/kit.h"
#include "render/kiosk/services.h"

/* Asks the service for its presets whenever it is shown; without it, nothing can be chosen. Buttons are named "preset-draft", ... */
GtkWidget *preset_chooser_new(services *s);
/* NULL: none. */
const char *preset_chooser_preset(GtkWidget *chooser);

#endif
