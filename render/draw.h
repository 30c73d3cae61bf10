#ifndef RENDER_DRAW_H
#define RENDER_DRAW_H
/* The cpu backend: draws a frame in C, on all processors. The reference that others are compared with: the same frame gives the same
 * bytes on any number of threads. */
#include "render/stroke.h"

struct draw_times {
	double cull_s, mask_s, choose_s, bin_s, draw_s, all_s;
	double filter_s, composite_s; /* filters of pictures; what makes one picture of several */
	uint32_t points_in_view, strokes;       /* in chunks that are in view; drawn */
	uint32_t chunks_in_view, chunks_hidden; /* of these, not drawn since others hide them */
};
/* Memory that one frame leaves to the next of the same size. One thread at a time. */
typedef struct draw_room draw_room;
draw_room *draw_room_new(void);
void draw_room_free(draw_room *r); /* NULL is fine */
/* Into a picture of the camera's size, whose memory is the caller's. room and ret_times may be NULL. */
void draw_frame(
	draw_room *room, const frame *f, struct picture_buffer *to, struct draw_times *ret_times);

/* A frame in two parts, for who makes shapes of strokes: the strokes of each layer, chosen as draw_frame does it, and the mask that hides
 * parts of them. Both are the room's, until it is asked for anything again. */
struct draw_chosen {
	const visibility_mask *mask;
	const struct stroke_blocks *of_layer;
};
struct draw_chosen draw_choose(draw_room *room, const frame *f, struct draw_times *ret_times);
/* And all that lies below them: paper, coloured points, shading. Of a frame with filters: the strokes that are drawn over what filters
 * made, and below them all else. */
void draw_below_strokes(draw_room *room, const frame *f, struct picture_buffer *to);

struct picture_buffer picture_buffer_new(uint32_t width, uint32_t height);
void picture_buffer_clear(struct picture_buffer *p);
/* Means of factor x factor pixels, in linear light; sizes are multiples of it. */
struct picture_buffer picture_buffer_reduced(const struct picture_buffer *p, uint32_t factor);
bool picture_buffer_save(const struct picture_buffer *p, const char *path, GError **error);

#endif
