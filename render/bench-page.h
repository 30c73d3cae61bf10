#ifndef RENDER_BENCH_PAGE_H
#define RENDER_BENCH_PAGE_H
/* What all benches measured as a page: HTML that is XML, too, whole in one file, without a script: the machine, what is to reach with its
 * plots, then all that each bench said. */
#include <json-glib/json-glib.h>

/* Of the document of bench-all.h; caller frees. */
char *bench_page_of(JsonObject *document);

#endif
