#ifndef FIRMWARE_IO_BUTTON_H
#define FIRMWARE_IO_BUTTON_H
/* The scanner's button while no head is open: pins belong to one holder at a time, so it has to be freed before a head is opened. Presses
 * during a scan are the stage's (STAGE_BUTTON). Of the thread's default main context. */
#include "firmware-io/stage-pins.h"

typedef struct button button;

/* device is a head's URI, on which machine's pins the button is (parts.h). NULL without an error: there is no such button. */
button *button_new(const char *device, void (*pressed)(gpointer user_data), gpointer user_data,
	GError **error);
/* On lines of somebody else's: for tests. */
button *button_new_on(const char *device, gpio_opener open, void (*pressed)(gpointer user_data),
	gpointer user_data, GError **error);
void button_free(button *b); /* NULL is fine; also from within pressed */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(button, button_free)

#endif
