#ifndef RENDER_KIOSK_PRESET_CHOOSER_H
#define RENDER_KIOSK_PRESET_CHOOSER_H
/* How to scan: a button for each preset, a switch for HDR photos where there is a camera, and what it will take. Main thread. */
#include "render/kiosk/kit.h"
#include "render/kiosk/services.h"

/* Asks the service for its presets whenever it is shown; without it, nothing can be chosen. Buttons are named "preset-draft", ..., "preset-hdr". */
GtkWidget *preset_chooser_new(services *s);
/* NULL: none. */
const char *preset_chooser_preset(GtkWidget *chooser);
bool preset_chooser_hdr(GtkWidget *chooser);

#endif
