#ifndef RENDER_KIOSK_PROBE_WIDGETS_H
#define RENDER_KIOSK_PROBE_WIDGETS_H
/* Named widgets as kiosk-probe tells of them. In the main thread. */
#include <gtk/gtk.h>

/* The topmost mapped widget of that name, NULL where there is none; the window owns it. */
GtkWidget *probe_widget(const char *name);
/* "x y width height reachable sensitive" of a mapped widget. */
void probe_tell_place(GtkWidget *widget, GString *answer);
/* A line each of all that are mapped and have a name, lowest first. */
void probe_tell_all(GString *answer);
/* What a person reads there; "" where nothing is. The caller frees it. */
char *probe_text(GtkWidget *widget);

#endif
