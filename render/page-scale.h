#ifndef RENDER_PAGE_SCALE_H
#define RENDER_PAGE_SCALE_H
/* Scales of pages: 50 is 1:50, a metre on the site is 20 mm on paper. */
#include "render/page-size.h"
#include "render/view.h"

#define PAGE_SCALE_MIN 0.01
#define PAGE_SCALE_MAX 1e6

/* "1:50", "50:1", 0.01 to 1e6. false: it is none. */
bool page_scale_parse(const char *text, double *ret);
char *page_scale_text(double scale); /* caller frees */

/* The largest that a parallel view fits on the page at, of 1:1, 2, 5, 10, 20 and so on (ISO 5455); has_legend: beside a legend (page-legend.h). */
double page_scale_fitting(const view *v, const struct page_size *size, bool has_legend);
/* Makes a parallel view as high as the page at this scale is, to the pixel, with what it shows in the middle of the room that there is.
 * Where it is no parallel view, or does not fit: one sentence that tells what would (G_IO_ERROR_INVALID_ARGUMENT). */
bool page_scale_set(
	view *v, const struct page_size *size, bool has_legend, double scale, GError **error);
/* The longest of 1, 2, 5, 10 and so on that is no longer. */
double page_scale_round_length(double metres);

#endif
