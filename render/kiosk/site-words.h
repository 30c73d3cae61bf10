#ifndef RENDER_KIOSK_SITE_WORDS_H
#define RENDER_KIOSK_SITE_WORDS_H
/* Numbers as people on a site read them. All texts are the caller's to free. */
#include <glib.h>
#include <stdint.h>

char *words_duration(double seconds); /* "about 3 min"; below 0: "" */
char *words_date(gint64 unix_s);      /* "today 14:05", "12 Nov 2026" */
char *words_scans(guint scans, guint placed, guint partial);
char *words_points(double points); /* "2.4 million points" */

/* What a command or the scanner says that it does, in plain words of the person's language; as it is where there are none. Never NULL. */
const char *words_doing(const char *doing);
/* A service's sentence as one that stands for itself: translated where it is one of those that matter most, and with a capital; the caller's. */
char *words_sentence(const char *sentence);
/* The services' advice, translated. */
const char *words_advice(const char *advice);

#endif
