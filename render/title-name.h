#ifndef RENDER_TITLE_NAME_H
#define RENDER_TITLE_NAME_H
#include <glib.h>

/* A file's name of a title, of so many letters at most: "Oak in red!" -> "oak-in-red"; of what has no letters the fallback. Caller
 * frees. */
char *title_name(const char *title, gsize letters_most, const char *fallback);

#endif
