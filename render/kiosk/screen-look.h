#ifndef RENDER_KIOSK_SCREEN_LOOK_H
#define RENDER_KIOSK_SCREEN_LOOK_H
/* Pictures one at a time, as large as the window. */
#include "render/kiosk/kiosk.h"

/* Opens the screen at the picture of that index; paths end with NULL, and there is one at least. */
void screen_look_open(kiosk *k, const char *const *paths, unsigned index);

#endif
