#ifndef RENDER_BENCH_COHERENCE_PRIVATE_H
#define RENDER_BENCH_COHERENCE_PRIVATE_H
/* The measures of pleinair bench coherence (bench-coherence.h tells what they are). */
#include "render/bench-coherence.h"
#include "render/bench-reproject.h"
#include "render/draw.h"

#define CELL_PX 32u
#define TILE_PX 64u

enum { PATH_DOLLY, PATH_ORBIT, PATH_PAN, PATH_LIGHT, PATHS };

/* ---- a frame of one style, as it was drawn ---- */

struct shot {
	struct camera camera;
	const visibility_mask *mask;
	visibility_mask *own_mask; /* NULL: that of another shot */
	float *depth_m;            /* of each pixel (reproject_depths); NULL: nobody asks */
	struct chunk_view *views;
	uint32_t view_count;
	stroke_list *lists; /* NULL: there is no shot */
	uint32_t layers;
	float *luminance;   /* of each pixel, in linear light */
	uint8_t *lightness; /* of each pixel, as layers take it of a colour */
};
/* f is moved to the camera. shared NULL: it makes a mask of its own, else that one must live as long. */
bool shot_take(struct shot *ret, frame *f, const struct camera *c, const visibility_mask *shared,
	bool wants_depths, struct picture_buffer *picture, GError **error);
void shot_clear(struct shot *s);

/* The same frame drawn finer, for what is held against the frame before pixel by pixel. */
#define FINE 4u /* of its pixels in one, along each side */

struct fine_shot {
	struct camera camera;
	float *depth_m;   /* of each pixel (reproject_depths); NULL: nobody asks */
	float *luminance; /* NULL: there is no shot */
};
/* c: of the frame itself. */
bool fine_shot_take(struct fine_shot *ret, frame *f, const struct camera *c, bool wants_depths,
	struct picture_buffer *picture, GError **error);
void fine_shot_clear(struct fine_shot *s);

/* ---- strokes of two frames ---- */

struct stroke_tally {
	uint64_t shown,
		kept; /* strokes of the first one that are shown in the second; drawn there */
	uint64_t compared, jumped; /* of both; by more than STEP_MOST */
	float step_most;
};
#define STEP_MOST 0.15f
/* Adds one layer. scratch: two planes of a float for each point, all 0, and so again afterwards. */
void stroke_tally_add(struct stroke_tally *t, const struct shot *before, const struct shot *now,
	uint32_t layer, float *const scratch[2]);

/* How dark a stroke is in both. */
void stroke_tally_compare(struct stroke_tally *t, float before, float now);
/* Of a layer of profile lines: the same of their links, each held against the line at the same place. */
void line_tally_add(
	struct stroke_tally *t, const struct shot *before, const struct shot *now, uint32_t layer);

/* ---- density ---- */

bool density_has(const struct frame_layer *l); /* whether it covers areas */

struct density {
	double strokes, wanted; /* where there are data enough */
	double relative;        /* of these; NAN: nowhere */
	double limited_share;   /* of the covered area */
	double cv, cv_all;      /* NAN: too few tiles */
};
/* Sets what belongs to a tile of TILE_PX, row by row and only whole ones, where the layer's points, with all copies that they may give,
 * are fewer than it wants. */
void density_find_limited(const frame *f, const struct shot *s, uint32_t layer,
	const uint8_t *lightness, bool *limited);
/* lightness: of plain coloured points; of hatching how light it takes them for. */
struct density density_of(
	const frame *f, const struct shot *s, uint32_t layer, const uint8_t *lightness);

/* ---- tone ---- */

/* Only the layers with the tone of the colour, and hatching that is as dark as its X-Toon says, on paper without grain. NULL: there are none; d is taken. */
drawing *tone_drawing(drawing *d);

struct tone_sums {
	double error2; /* squared differences to the curve */
	double light, wanted;
	uint64_t tiles;
	double error2_all; /* also where the data limit them */
	uint64_t tiles_all;
};
/* Draws f, of a tone_drawing, with the camera of the shot, whose mask is of the drawing with all layers. */
bool tone_add(struct tone_sums *t, frame *f, const struct shot *s, const uint8_t *lightness,
	struct picture_buffer *picture, GError **error);

/* ---- what comes out ---- */

struct coherence_row {
	const char *style, *path; /* style: its file's name without .json */
	/* NAN where the style has nothing of the kind. */
	double kept_least, kept, step_most, jumped_share;
	double density_least, density_most, limited_share, cv, cv_all;
	double layer_least, layer_most; /* density of single layers */
	double warp, warp_pixels, tone, tone_all, tone_bias, tone_drift;
	bool is_static;
};
void coherence_print_heading(const struct bench_coherence_options *o);
/* Adds how many bars there are, and how many of them are missed. */
void coherence_print(const struct coherence_row *r, uint32_t *bars, uint32_t *missed);
JsonObject *coherence_to_json(const struct coherence_row *r);

/* Standard deviation by mean; NAN of fewer than two. */
double coefficient_of_variation(const double *value, uint32_t count);

#endif
