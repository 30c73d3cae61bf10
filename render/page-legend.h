#ifndef RENDER_PAGE_LEGEND_H
#define RENDER_PAGE_LEGEND_H
/* What stands at the edge of a page that has a scale: its title, when the site was made, "1:50", a scale bar, and which way the north
 * is. In millimetres from the page's left upper corner. One owner; const once made. */
#include "render/draw.h"

struct page_legend_desc {
	double width_mm, height_mm; /* of the page */
	double scale;               /* 50: a metre is 20 mm */
	const char *title, *date;   /* NULL: none */
	double north_rad;           /* clockwise from the page's top; NAN: it is no plan */
	uint8_t paper[4];           /* what it is legible on */
};

enum legend_anchor { LEGEND_LEFT, LEGEND_MIDDLE, LEGEND_RIGHT };
struct legend_text {
	double x_mm, y_mm, size_mm; /* of the baseline */
	enum legend_anchor anchor;
	char *text;
};
/* Filled. */
struct legend_shape {
	uint32_t corners;
	double corner[4][2];
};
typedef struct page_legend page_legend;
struct page_legend {
	GArray *texts, *shapes;
	uint8_t ink[3];
};
page_legend *page_legend_new(const struct page_legend_desc *desc);
void page_legend_free(page_legend *l); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(page_legend, page_legend_free)

/* What a page with one has room for: how far from all edges, and how high above the lower one. */
void page_legend_edges(
	double width_mm, double height_mm, double *ret_edge_mm, double *ret_strip_mm);

/* On any surface whose units are millimetres: a cairo_t. */
void page_legend_paint(const page_legend *l, void *cairo);
/* Into the rows of a picture from that one on, of so many pixels a millimetre. */
void page_legend_print(
	const page_legend *l, struct picture_buffer *to, uint32_t from, double px_per_mm);

#endif
