#ifndef RENDER_KIOSK_STATUS_H
#define RENDER_KIOSK_STATUS_H
/* The corner of the bar that tells how the box is: scanner, room on the disk, battery. A tap opens what is behind it. Main thread. */
#include "render/kiosk/kit.h"
#include "render/kiosk/services.h"

typedef struct status status;
status *status_new(services *s, const char *folder, GCallback pressed, gpointer user_data);
void status_free(status *s); /* NULL is fine; call before the widget goes */
GtkWidget *status_widget(status *s);

/* What there is to tell, also for the page on the box's health. */
struct box_state {
	double free_bytes, total_bytes; /* of the folder's disk; 0: not known */
	double battery_percent;         /* below 0: there is none */
	bool is_charging;
};
struct box_state box_state_now(const char *folder);
/* "12.3 GB"; caller frees. */
char *box_size_text(double bytes);

#endif
