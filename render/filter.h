#ifndef RENDER_FILTER_H
#define RENDER_FILTER_H
/* Filters of pictures, on the processor: each row of step_kinds that is a filter has a function here. They see a box of a picture, with
 * what is known of each of its pixels; beyond its borders the last pixels go on. What a filter makes depends on its input alone, on no
 * number of threads, and is the same bytes for the same picture. */
#include "render/frame.h"

#define FILTER_FAR 3.0e38f /* depth where nothing is */

/* Of each pixel, row by row without gaps. */
struct filter_image {
	uint32_t width, height;
	uint32_t left, top;  /* where it is in what the camera draws */
	uint8_t (*rgba)[4];  /* sRGB, the last 255 */
	uint8_t (*spare)[4]; /* as large: what a filter writes before they are swapped */
	float *depth_m; /* along the optical axis, 32 bits: as exact, for how far it is, near and far away */
	/* NULL: no filter of these asks for them. */
	float (*normal)[3]; /* as the camera sees it; 0 0 0: none */
	uint16_t *leaf;     /* of the segment tree; 0 where nothing is */
	/* NULL: there is no focus. 0..1: how far from it. */
	float *away;
	uint8_t *
		grey_before; /* before filters (depth-inpaint.h), moved with what filters move; NULL in the picture of all */
	const uint8_t *paper; /* [4], sRGB, the last 255 */
};

/* Memory that filters leave to each other. */
#define FILTER_ROOM_PARTS 16
typedef struct filter_room filter_room;
struct filter_room {
	void *memory[FILTER_ROOM_PARTS];
	size_t bytes[FILTER_ROOM_PARTS];
};
/* One of the parts, of any content. */
void *filter_room_part(filter_room *r, uint32_t part, size_t bytes);
void filter_room_clear(filter_room *r);

/* What filters need to know of the picture. */
struct filter_job {
	const frame *f;
	struct filter_image image;
	filter_room *room;
	enum lanes_path lanes;
	float px; /* pixels to one of the style's */
	float spacing_px; /* mean distance of neighbouring points, of the nearer ones of a chunk; 0: not known */
	double time_s;
};
/* Does nothing more when f->stop is set. */
void filter_apply(struct filter_job *j, const struct step *s);

/* Whether any of these filters asks for normals and segments. */
bool filter_wants_surface(const struct step *filters, uint32_t count);
/* Pixels of the picture around a box that these filters may draw in, or look at. */
uint32_t filter_reach(const struct step *filters, uint32_t count, float px);

/* How many pixels away what these filters make of a pixel may depend on, in pictures in which all is full of things. UINT32_MAX: on all
 * of the picture. */
uint32_t filter_looks(const struct step *filters, uint32_t count, float px);

/* ---- for filters ---- */

typedef void filter_run(struct filter_job *j, const struct step *s);
filter_run filter_kuwahara, filter_anisotropic, filter_bilateral, filter_gaussian, filter_gaps,
	filter_quantise, filter_dog, filter_edges, filter_watercolour, filter_flow, filter_oil,
	filter_pencil, filter_grade, filter_warp, filter_occlusion, filter_edl, filter_neural;

/* Where it is in the whole picture, also where the camera draws a window of that: for what repeats from place to place. */
static inline uint32_t filter_whole_left(const struct filter_job *j)
{
	return j->image.left + j->f->camera.whole.left;
}
static inline uint32_t filter_whole_top(const struct filter_job *j)
{
	return j->image.top + j->f->camera.whole.top;
}

static inline size_t filter_pixels(const struct filter_image *i)
{
	return (size_t)i->width * i->height;
}
static inline void filter_swap(struct filter_image *i)
{
	uint8_t(*was)[4] = i->rgba;
	i->rgba = i->spare;
	i->spare = was;
}
/* Nothing is there, and nothing was drawn: filters that change colours leave it. */
static inline bool filter_is_bare(const struct filter_image *i, size_t at)
{
	return i->depth_m[at] >= FILTER_FAR && i->rgba[at][0] == i->paper[0] &&
	       i->rgba[at][1] == i->paper[1] && i->rgba[at][2] == i->paper[2];
}
/* 0..1: how much a filter acts at a pixel. */
static inline float filter_weight(const struct filter_job *j, int32_t where, size_t at)
{
	const float *away = j->image.away;
	if (where == WHERE_ALL || !away)
		return 1;
	float part = where == WHERE_AWAY ? away[at] : 1 - away[at];
	return 1 + j->f->focus.filters * (part - 1);
}
static inline bool filter_is_weighted(const struct filter_job *j, int32_t where)
{
	return where != WHERE_ALL && j->image.away && j->f->focus.filters > 0;
}
/* What was written, mixed with what was there, by where the filter acts; then they are swapped. */
void filter_finish(struct filter_job *j, int32_t where);
/* The same with a weight of 0..1 that is so often it, less so much. */
void filter_finish_part(struct filter_job *j, int32_t where, float times, float less);
/* Rows in parts, on all processors. */
typedef void filter_rows(const void *data, uint32_t from, uint32_t end);
void filter_each_rows(const struct filter_job *j, filter_rows *run, const void *data,
	uint32_t height, uint32_t at_once);

#endif
