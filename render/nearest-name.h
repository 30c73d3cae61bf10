#ifndef RENDER_NEAREST_NAME_H
#define RENDER_NEAREST_NAME_H
/* What somebody meant who wrote a name that there is none of. */
#include <glib.h>

/* The name that goes on with '_' where this one ends (a unit was forgotten), else the one that the fewest letters must be changed,
 * added, left out or swapped in (Damerau's distance), case not counting; the first of several. NULL where more than a third of the
 * letters would be. names: NULL-terminated; what is returned is one of them. */
const char *nearest_name(const char *name, const char *const *names);
/* "; did you mean 'pencil'?", or what there is, "; there is pencil, ink", or "" of no names; caller frees. */
char *nearest_name_hint(const char *name, const char *const *names);

#endif
