#ifndef RENDER_SHEET_PLAN_H
#define RENDER_SHEET_PLAN_H
/* What a sheet of a filtered frame is drawn of and how its changes get depths: the same for both backends (draw-sheets.c, gles-sheets.c).
 * Where a style leaves numbers of depth inpainting to us (Wegen et al. 2024, section 6, leaves them open), they are chosen here. */
#include "render/chunk-view.h"
#include "render/frame.h"

/* Boxes begin at whole multiples of so many pixels of the whole picture: filters that look at several pixels at once look at the same
 * ones in a window of it. */
#define SHEET_BLOCK 16u
struct sheet_box {
	uint32_t left, top, right, bottom; /* ends are beyond */
};
struct sheet_plan {
	const struct chunk_view *views; /* of its segments, from near to far */
	uint32_t count;
	struct chunk_view *own;   /* where they are; NULL: all that the frame shows */
	const struct step *steps; /* its filters, and what else stands among them */
	uint32_t filters;
	struct sheet_box box; /* all that it draws, and that its filters look at */
	float spacing_px;     /* mean distance of neighbouring points, in the whole picture */
	/* Of depth inpainting; radius 0: there are no filters. */
	float threshold; /* 0..1 */
	int radius;      /* pixels */
};
/* all: the frame's, from near to far; kept where it is all of this sheet. */
struct sheet_plan sheet_plan_new(
	const frame *f, const struct chunk_view *all, uint32_t count, uint32_t sheet);
void sheet_plan_clear(struct sheet_plan *p);
/* The mean distance of neighbouring points in the whole picture. views: what the frame shows. */
float sheet_whole_spacing_px(const frame *f, const struct chunk_view *views, uint32_t count);
/* Pixels that strokes of a sheet reach from their middles. */
uint32_t sheet_ink_reach(const frame *f, uint32_t sheet);
/* Of depth inpainting, where the style leaves it to us; pixels. */
#define SHEET_RADIUS_MOST 12
/* Whether some sheet draws things that cover in part only what is behind them. */
bool sheets_have_soft(const frame *f);

/* How a depth of the mask becomes what it was before the mask pushed it back: (depth - offset_m) / per. */
struct sheet_depth {
	float offset_m, per;
};
static inline struct sheet_depth sheet_depth_of(const frame *f, uint32_t pipeline)
{
	const struct mask_step *m = &frame_pipeline(f, pipeline)->mask;
	return (struct sheet_depth){ m->offset_m, 1 + m->offset_relative };
}

/* Of the largest change of a channel from the paper, the least that covers what is behind it. */
#define SHEET_COVERS 80

#endif
