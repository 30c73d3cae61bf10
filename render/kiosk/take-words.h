#ifndef RENDER_KIOSK_TAKE_WORDS_H
#define RENDER_KIOSK_TAKE_WORDS_H
/* What is made and copied, in words. Without GTK; all strings are the caller's to free. */
#include "render/kiosk/drives.h"
#include "render/kiosk/exports.h"

/* "about 3 min left"; "" while nobody knows (below 0). */
char *words_left(double seconds);
/* "Picture · 1.2 MB · today 14:05". now_us: since 1970. */
char *words_export(const export_item *e, int64_t now_us);
/* "Overview", "From scan 3": of views that every site has; others as they are named. */
char *words_view(const char *name);
/* "12.3 GB free of 32.0 GB"; or what is wrong with it. */
char *words_drive(const drive *d);
/* Of the JSON document of a copy: "214 files, 1.3 GB, all verified by SHA-256". NULL: it is none. */
char *words_copied(const char *json);
/* Of that of an import: "3 scans, 2.4 million points". NULL: it is none. */
char *words_brought(const char *json);
/* What the document of an import or export wants known besides, a line each; NULL: nothing. */
char *words_notes(const char *json);

#endif
