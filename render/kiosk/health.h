#ifndef RENDER_KIOSK_HEALTH_H
#define RENDER_KIOSK_HEALTH_H
/* The parts of the screen that tells how the box is; each is a widget that cares for itself until it is destroyed. Main thread. */
#include "render/kiosk/kiosk.h"

/* The scanner's devices, what is wrong with them, and which ones they are. */
GtkWidget *health_devices_new(kiosk *k);
/* What is wrong with this machine as a scanner: what pleinair doctor says. */
GtkWidget *health_doctor_new(kiosk *k);
/* Whether the head's calibration still holds, by the last scan. */
GtkWidget *health_check_new(kiosk *k);
/* Room, battery, temperature, services, version. */
GtkWidget *health_box_new(kiosk *k);
/* Language, colours, sleep. */
GtkWidget *health_settings_new(kiosk *k);
/* What happened, the newest first. */
GtkWidget *health_log_new(kiosk *k);

#endif
