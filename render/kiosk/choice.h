#ifndef RENDER_KIOSK_CHOICE_H
#define RENDER_KIOSK_CHOICE_H
/* One of several: a button that shows what is chosen, and a sheet with all of them. The buttons there are named after this one and
 * their value: "take-style-points". Main thread. */
#include "render/kiosk/kiosk.h"

typedef struct choice choice;
/* The first value that is added is the chosen one. The button owns it. changed may be NULL; it comes for what people do. */
choice *choice_new(kiosk *k, const char *name, const char *title,
	void (*changed)(const char *value, gpointer user_data), gpointer user_data);
GtkWidget *choice_button(choice *c);
void choice_add(choice *c, const char *value, const char *words);
const char *choice_value(const choice *c); /* NULL: there is none yet */
/* One that was not added changes nothing. */
void choice_set(choice *c, const char *value);

#endif
