#ifndef RENDER_BENCH_BARS_H
#define RENDER_BENCH_BARS_H
/* One row of what is to reach (bench-reach.h) as a plot: a bar for our figure, one for each peer, and a line across at what is wanted. */
#include <json-glib/json-glib.h>
#include <stdbool.h>

/* Appends an SVG element, which stands in a page of HTML or alone. What is not reached has a hatched bar; that it was or was not is
 * written, too. Where the largest is more than twenty times the smallest the scale is of powers of ten, and says so. number: of the
 * plot on its page, for names within it. */
void bench_bars_append(GString *to, JsonObject *row, guint number);

#endif
