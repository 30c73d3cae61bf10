#ifndef RENDER_KIOSK_KIT_H
#define RENDER_KIOSK_KIT_H
/* Widgets as all screens use them, in few words. A name is what tests and style sheets find a widget by; classes, apart by
 * blanks, are those of kiosk.css. Widgets are floating: who puts them somewhere owns them. Main thread. */
#include <glib/gi18n.h>
#include <gtk/gtk.h>
#include <stdbool.h>

GtkWidget *kit_classed(GtkWidget *w, const char *classes); /* returns w; NULL: none */
/* Aligned left, breaks lines between words. */
GtkWidget *kit_text(const char *text, const char *classes);
GtkWidget *kit_named_text(const char *name, const char *text, const char *classes);
/* So many letters wide at least and at most, so that a long sentence does not push aside what is beside it; least -1: as it comes. */
void kit_narrow(GtkWidget *label, int least, int most);
/* Never breaks; what does not fit ends in dots when ellipsis. */
GtkWidget *kit_line(const char *name, const char *text, const char *classes, bool ellipsis);
/* icon or text may be NULL; a button without text is told to screen readers by tip. */
GtkWidget *kit_button(const char *name, const char *icon, const char *text, const char *tip,
	const char *classes, GCallback clicked, gpointer user_data);
/* Children up to NULL. */
GtkWidget *kit_row(int spacing, ...) G_GNUC_NULL_TERMINATED;
GtkWidget *kit_column(int spacing, ...) G_GNUC_NULL_TERMINATED;
/* Beside each other; below each other on a screen that stands upright. */
GtkWidget *kit_sides(int spacing, ...) G_GNUC_NULL_TERMINATED;
/* Said once, before anything is built. */
void kit_set_upright(bool upright);
bool kit_is_upright(void);
GtkWidget *kit_scroll(GtkWidget *child); /* up and down */
GtkWidget *kit_space(void);              /* takes what is left */
GtkWidget *kit_grow(GtkWidget *w, bool across, bool down);
GtkWidget *kit_margin(GtkWidget *w, int px);
/* Removes all children of a box. */
void kit_empty(GtkWidget *box);
void kit_set_text(GtkWidget *label, const char *text); /* only when it is another one */
/* Exactly one of the classes good, doubt, bad, or none of them. */
void kit_set_verdict(GtkWidget *w, const char *verdict);
/* Which way an arrow points: right and down are 1, left and up -1; false: it is another key. */
bool kit_arrow_of_key(guint key, int *ret_right, int *ret_down);
int kit_zoom_of_key(guint key); /* 1: closer, -1: further away, 0: another key */

#endif
