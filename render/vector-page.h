#ifndef RENDER_VECTOR_PAGE_H
#define RENDER_VECTOR_PAGE_H
/* A page of a drawing as shapes, in millimetres from its left upper corner: the strokes that the cpu backend draws of a frame
 * (draw.h), in the same places, sizes, directions and tones, and below them, as a picture, what has no strokes.
 *
 * Light is linear where the painter draws; who shows a page mixes sRGB. So a shape's opacity is such that one of them on white is as
 * light as the painter's, and inside a layer shapes lie over each other as ink that is never darker than itself; layers multiply what is
 * below. Thousands of strokes are one path: opacities and widths have steps, between which strokes are spread by chance so that means
 * stay, and shapes of a path do not overlap (vector-coats.h).
 *
 * A page is small enough to be edited: where the mask hides a stroke or shows it for less than a quarter of a millimetre is not told, and
 * outlines have the corners that they cannot do without; and of very dense hatching some strokes are left out, and the others are
 * broader and stronger. Of the court (5.6 million points) from "walk" on A3, SVG: figure-7d 7.4 MB, ballpoint 8.9, gouache 4.8,
 * impressionist 7.4, pencil and coloured-crayons 17, wax-crayons 19.5 (19.8, 34 and 26 were all of their strokes shown). Means of
 * tiles of 23 pixels are within 8.2 of 255 (RMS, pencil, rsvg-convert; 5.8 impressionist) of the picture's.
 *
 * One owner; const once it is made. */
#include "render/draw.h"
#include "render/page-legend.h"
#include "render/vector-shape.h"

enum vector_blend {
	VECTOR_MULTIPLY,  /* the layer as a whole darkens what is below */
	VECTOR_EACH_DARK, /* and each path what is below it: inks of many colours */
	VECTOR_COVER,     /* paint */
};

/* Shapes of one look; at most VECTOR_PATH_SHAPES of them, for those who edit. */
#define VECTOR_PATH_SHAPES 1000u
struct vector_path {
	float width_mm; /* of lines; of dots the diameter */
	uint8_t rgb[3];
	float opacity;
	GArray *corner; /* of float[2], mm: as in struct vector_shape, one shape behind the other */
	GArray *end;    /* of uint32_t: of each shape's corners */
};
/* What is of one segment. */
struct vector_group {
	uint32_t segment;
	char *name;
	GPtrArray *paths; /* of struct vector_path */
};
struct vector_layer {
	char *name; /* "edges: Buildings, Structures" */
	enum vector_form form;
	enum vector_blend blend;
	GPtrArray *groups; /* of struct vector_group, by segment */
	uint32_t
		strokes; /* that the painter has in it; those that something hides, or that are too faint, have no shape */
	uint32_t shown; /* of these have shapes */
};

typedef struct vector_page vector_page;
struct vector_page {
	double width_mm, height_mm;
	char *title;
	bool has_paper; /* true at first; else there are strokes alone */
	uint8_t paper[3];
	struct picture_buffer ground; /* rgba NULL: paper alone */
	GPtrArray *layers;            /* of struct vector_layer, as they lie on each other */
	const page_legend *legend;    /* NULL: none; the caller's */
};
/* The frame fills the page. tree: names; NULL: there are none. room and ret_times as draw_choose. */
vector_page *vector_page_new(draw_room *room, const frame *f, const segments *tree, double width_mm,
	double height_mm, const char *title, struct draw_times *ret_times);
/* Where hatching would have more corners, its edges are coarser; and where that is not enough some of its strokes, by chance, have no shapes, and the others have their ink too. */
#define VECTOR_PAGE_CORNERS 2250000u
vector_page *vector_page_new_thinned(draw_room *room, const frame *f, const segments *tree,
	double width_mm, double height_mm, const char *title, uint32_t corners_most,
	struct draw_times *ret_times);
void vector_page_free(vector_page *p); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(vector_page, vector_page_free)

/* Whether anything but strokes and even paper is in the frame, so that a ground is needed (draw_below_strokes). */
bool vector_page_wants_ground(const frame *f);

/* Errors are those of files.h, or cairo's. Both give the same bytes for the same page. */
bool vector_page_save_svg(const vector_page *p, const char *path, GError **error);
bool vector_page_save_pdf(const vector_page *p, const char *path, GError **error);
/* On any surface, whose units are millimetres: a cairo_t. */
void vector_page_paint(const vector_page *p, void *cairo);

#endif
