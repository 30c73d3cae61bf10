#ifndef RENDER_POSTER_H
#define RENDER_POSTER_H
/* Pictures of any size in bounded memory: the camera's picture is drawn in windows (camera_window), one after the other, and handed on in
 * rows from above to below. A picture that fits into the memory is one window, which is all of it.
 *
 * Windows fit together, for what is drawn of a place depends on what is around it alone: which points become strokes is told point by
 * point, and what asks for the whole picture (which dots stippling draws, how far filters' changes look for depths) is told by the whole
 * picture's camera in all windows. Around what a window is for a margin is drawn, as wide as strokes and filters reach. So the picture is
 * the one that would be drawn at once, but for how places are rounded: floats of a window's places are finer. Of strokes few pixels
 * differ (test-poster.c says how few).
 *
 * One thread. */
#include "render/painter.h"

/* Of a window's planes; the points, their strokes and the rows that are handed on come beside it. A window is no smaller than its margin
 * all around it: of filters and broad strokes that look far, some styles' windows take several times as much in very large pictures. */
#define POSTER_BYTES ((size_t)1 << 30)

struct poster_desc {
	uint32_t reduce; /* so many pixels a side become one, of linear light; 0: 1 */
	size_t bytes;    /* 0: POSTER_BYTES */
	/* Rows of the reduced picture, which come from above to below; may fail. */
	bool (*take)(void *data, struct picture_buffer *rows, uint32_t from, GError **error);
	/* NULL, or asked after each window: so much of the picture is drawn (0..1). It may fail, and the rest is not drawn then. */
	bool (*going)(void *data, double part, GError **error);
	void *data;
};

/* The sides of the camera's picture must be multiples of reduce. The frame's camera is one of the windows afterwards. *ret_times, which may
 * be NULL, is the sum of all windows. */
bool poster_draw(painter *p, frame *f, const struct camera *c, const struct poster_desc *desc,
	struct draw_times *ret_times, GError **error);

/* Pixels around a window that what is in it may depend on; UINT32_MAX: all of the picture, for a network looks at it. It is drawn at once
 * then, and refused (G_IO_ERROR_INVALID_ARGUMENT) if it has more than POSTER_WHOLE_MOST pixels. */
#define POSTER_WHOLE_MOST ((uint64_t)1 << 26)
uint32_t poster_margin_px(const frame *f);

/* How a picture is cut: so many columns and rows of windows, all of about the same size. */
struct poster_grid {
	uint32_t columns, rows, margin_px;
};
/* No window is wider or higher than side_most, if margins leave room for that. */
struct poster_grid poster_grid_of(
	const frame *f, const struct camera *c, size_t bytes, uint32_t side_most);
/* Of one: what it is for, and all that is drawn, of the whole picture. Both begin at multiples of SHEET_BLOCK * reduce. */
struct poster_window {
	uint32_t left, top, right, bottom;
	struct camera camera;
};
struct poster_window poster_window_at(const struct camera *c, const struct poster_grid *g,
	uint32_t reduce, uint32_t column, uint32_t row);

#endif
