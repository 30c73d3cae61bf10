#ifndef RENDER_KIOSK_KEYBOARD_H
#define RENDER_KIOSK_KEYBOARD_H
/* Letters to press, for boxes that have no keyboard. Main thread. */
#include "render/kiosk/kit.h"

/* Types into the entry. Keys are named "key-a", "key-shift", "key-space", "key-erase". */
GtkWidget *keyboard_new(GtkEditable *entry);

#endif
