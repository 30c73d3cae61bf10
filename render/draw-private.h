#ifndef RENDER_DRAW_PRIVATE_H
#define RENDER_DRAW_PRIVATE_H
/* What the files of the cpu backend share: draw.c, draw-sheets.c. */
#include "render/draw-lanes.h"
#include "render/filter.h"

struct draw_room {
	visibility_mask *mask, *joined; /* of a sheet or the frame; of all sheets */
	stroke_room *strokes;
	const struct stroke_blocks *of_layer; /* its strokes */
	band_lists lists;
	/* Of each thread, for bands of a picture so wide. */
	uint32_t desks, pitch;
	struct draw_desk *desk;
	filter_room filters, pictures; /* what filters use; what they work on */
};

/* Draws the bands of j->to. */
void draw_bands(draw_room *r, const struct draw_job *j);
/* Seconds since the last one. */
double draw_lap(int64_t *since_us);

/* A frame with filters (Wegen et al. 2024, section 3): each sheet, a picture of its segments alone, is drawn and filtered; what filters
 * changed gets depths from around it (listing 1); then they become one picture, the nearest at each pixel, which the filters of the
 * picture work on; and strokes that lie over are drawn, unless over is false. */
void draw_sheets(draw_room *r, const frame *f, bool over, struct picture_buffer *to,
	struct draw_times *ret_times);

#endif
