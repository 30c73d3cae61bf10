#ifndef ACQUIRE_ADVICE_H
#define ACQUIRE_ADVICE_H
/* What a person on a site does about an error of a scan. */
#include <glib.h>

/* One or two sentences; "" when there is nothing to do but read the error. */
const char *advice_for(const GError *error);

#endif
