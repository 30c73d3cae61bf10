#ifndef RENDER_DRAW_LANES_H
#define RENDER_DRAW_LANES_H
/* Bands of a picture, eight pixels at a time. Internal to draw.c. */
#include "render/bands.h"
#include "render/draw.h"

/* Bands whose coloured points are drawn together: fewer of the points are in several of these. */
#define POINTS_BANDS 2

/* One thread's planes of a band. */
struct draw_desk {
	void *memory;
	float *canvas[3];
	struct band_ink ink;  /* between layers all is bare */
	bool is_laid;         /* and its sums are 0 */
	float paper[3];       /* its linear colour */
	float *relief;        /* -1 .. 1, of the paper */
	struct band together; /* POINTS_BANDS of them, or one */
	/* Of coloured points in these. */
	bool has_points;
	void *points_memory;
	float *light[3], *weight;
};

struct draw_job {
	const frame *f;
	const visibility_mask *mask;
	const struct chunk_view *views;
	uint32_t count;
	const band_lists *lists;              /* NULL: no strokes */
	const struct stroke_blocks *of_layer; /* that they are of */
	struct picture_buffer *to;
	/* Of pictures that are filtered: paper without its grain; or what filters made, which lies where paper, points and shading do else,
	 * and may be to. */
	bool flat;
	const struct picture_buffer *ground;
	uint32_t first_row, end_row; /* all is left as it is above and below; 0 0: the whole */
};

/* The bands of d->together. */
LANES_DECLARE(void, draw_together, (const struct draw_job *j, struct draw_desk *d));

#endif
