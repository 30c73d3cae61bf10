#ifndef RENDER_VIEW_BOXES_H
#define RENDER_VIEW_BOXES_H
/* A model's points in boxes, for views of it (view-sources.h): its chunks; or, where these are so few that each is a large part of what
 * there is to be seen, such as a pump that was imported, smaller boxes with some of their points, and which way these face. And along what the walls run. */
#include "process/model.h"
#include <glib.h>

typedef struct view_boxes view_boxes;
struct view_boxes {
	const struct model_chunk *box; /* of each centre, half size and number of points */
	/* The mean of its points' normals, each of length 1 or 0; NULL: nobody looked. */
	const float (*facing)[3];
	uint64_t count;
	double solid_points; /* a box with fewer hides nothing */
	/* A heading that walls face, and with it those at right angles: of most of the upright surface, 0 .. pi / 2; 0 where there is
	 * none. */
	double walls_rad;
	GArray *own[2]; /* what box and facing point to; NULL: the model has them */
};
/* The model must live longer. NULL: it has no points, or none that are anywhere. */
view_boxes *view_boxes_new(const model *m);
void view_boxes_free(view_boxes *b); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(view_boxes, view_boxes_free)

#endif
