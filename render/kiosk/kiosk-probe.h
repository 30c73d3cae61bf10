#ifndef RENDER_KIOSK_KIOSK_PROBE_H
#define RENDER_KIOSK_KIOSK_PROBE_H
/* Tests ask the kiosk where its widgets are and what they say, so that they tap "export" and not pixels. Only where
 * $PLEINAIR_KIOSK_PROBE names a socket is it served; otherwise all of this does nothing. A widget takes part by having a name
 * (gtk_widget_set_name).
 *
 * One line a question over the unix socket, answered in lines and then "ok", or "error: " and why:
 *
 *   find NAME    x y width height reachable sensitive of the widget: pixels of its window, the last two 0 or 1. Reachable: a
 *                finger at its middle reaches it, nothing lies over it and it is not scrolled away
 *   list         a line each: NAME TYPE and the same six, of all that have a name and are mapped
 *   text NAME    what it says: of a label or entry its text, of a slider its value, else what it tells a screen reader, else
 *                all labels inside it; one line, a line end is \n in it
 *   state        KEY=VALUE lines of kiosk_probe_set, and first-frame: when it was painted, by g_get_monotonic_time()
 *   controls     NAME TYPE WORDS a line, of all that is sensitive and that keys should reach; words: as a screen reader says them
 *   focus        NAME of what keys go to, or of what that is in; - where it is nothing
 *   frames       how many frames all windows have painted
 *
 * Of several widgets of one name the topmost that is mapped is meant. Windows beside the main one are told in their own
 * coordinates. All of it in the main thread, by the main loop: an answer also says that the loop is alive. */
#include <glib.h>
#include <stdbool.h>

/* After gtk_init. False where the socket cannot be made; true where none is asked for. */
bool kiosk_probe_start(GError **error);
/* No more answers, nothing kept. */
void kiosk_probe_stop(void);
/* What "state" tells of KEY from now on; a NULL format takes it back. A key is one word. */
void kiosk_probe_set(const char *key, const char *format, ...) G_GNUC_PRINTF(2, 3);

#endif
