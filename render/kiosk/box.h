#ifndef RENDER_KIOSK_BOX_H
#define RENDER_KIOSK_BOX_H
/* What the box tells of itself, beside its disk and battery (status.h). Without GTK. */

/* The highest of the temperatures in a folder like /sys/class/thermal; NAN: there are none. */
double box_temperature_c(const char *folder);
/* Of the program: what git calls it. */
const char *box_version(void);

#endif
