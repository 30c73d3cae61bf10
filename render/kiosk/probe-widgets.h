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

/* "NAME TYPE WORDS" of all that is sensitive and that keys should reach, lowest first; words as a screen reader says them. */
void probe_tell_controls(GString *answer);
/* Name of what keys go to, or of what it is in; "-" where that is nothing. */
const char *probe_focus(void);

#endif
