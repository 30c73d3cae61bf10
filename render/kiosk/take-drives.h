#ifndef RENDER_KIOSK_TAKE_DRIVES_H
#define RENDER_KIOSK_TAKE_DRIVES_H
/* The drives that are plugged in, what can be copied to them, and what became of it. Main thread. */
#include "render/kiosk/take-jobs.h"

typedef struct take_drives take_drives;
/* The box owns it. */
take_drives *take_drives_new(kiosk *k, const char *site, take_jobs *jobs);
GtkWidget *take_drives_box(take_drives *d);
/* Asks what to copy to the first drive; without one says what to do. */
void take_drives_ask(take_drives *d);

#endif
