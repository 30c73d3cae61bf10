#ifndef RENDER_KIOSK_JOURNAL_H
#define RENDER_KIOSK_JOURNAL_H
/* What happened, in words, with its time: the last lines in memory, all in a file that starts anew when it has grown long. */
#include <glib.h>
#include <stdbool.h>

#define JOURNAL_LINES 300

typedef struct journal journal;
/* path NULL: in memory only. A file that cannot be written is no error: then too. */
journal *journal_new(const char *path);
void journal_free(journal *j); /* NULL is fine */
void journal_add(journal *j, const char *sentence);
/* Of char *, "2026-11-23 14:05:10  Sentence.", the newest last. The journal's own. */
GPtrArray *journal_lines(const journal *j);

#endif
