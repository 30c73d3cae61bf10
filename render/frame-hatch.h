#ifndef RENDER_FRAME_HATCH_H
#define RENDER_FRAME_HATCH_H
/* What a frame's layer of hatching is drawn by (step.h, struct hatching_step): tables of the X-Toon texture, by shade: row of depth times
 * 256 plus lightness. Made with the frame; const but for way. */
#include "render/pencil-box.h"
#include "render/scene.h"
#include "render/step.h"
#include "render/xtoon.h"

/* Strokes lie on surface that is seen aslant, or is bent, so they are shorter; there are more of them for it, up to this. */
#define HATCH_SHORTEST 0.35f
/* A point's second stroke fades in over so much of its chance: hatch_second (hatch-lanes.c). */
#define HATCH_CROSS_FADE 0.25f

/* Surface whose back is hidden begins to fade at this cosine, and strokes are the more instead, until so much is left of them: tones stay
 * where surface is seen aslant, and no stroke goes at once. */
#define HATCH_TURNED_AWAY 0.3f
#define HATCH_FACING      0.33f
/* Of leaves, which face any way and hang before each other, so many are wanted of those on surface. */
#define HATCH_LEAVES 0.92f
/* Where fewer than this part of all strokes are drawn they are fainter and fainter: what a light does to few is sudden. */
#define HATCH_FOOT 0.08f

struct frame_hatch {
	struct hatching_step step;
	uint32_t rows;
	float *chance;        /* 0..1 */
	float *wanted_per_px; /* points to a square pixel that give strokes, if these are whole */
	uint8_t (*rgba)[4];   /* sRGB, hues turned, but not yet of pencils */
	pencil_box pencils;
	float exposure;      /* scene_exposed() */
	float near_m, per_m; /* depth 0, and what a metre is of the way to depth 1 */
	double site_way[3];  /* the uniform direction, unit */
	float way[3];        /* as the camera sees it */
};

/* What is left of the opacity of strokes with this chance (section 3.5, "alpha modification"). */
static inline float frame_hatch_pressure(const struct hatching_step *step, float chance)
{
	float foot = chance * (1 / HATCH_FOOT);
	return (1 - step->pressure * (1 - chance)) * (foot < 1 ? foot : 1);
}

struct frame_layer;
/* Of a layer whose lengths and areas are known. Errors of xtoon_new. */
struct frame_hatch *frame_hatch_new(const struct frame_layer *l, const scene *s, GError **error);
void frame_hatch_free(struct frame_hatch *h); /* NULL is fine */
/* 0..1: how light a point of the scene is to it in the frame's light, but for highlights, which the eye decides too. */
struct frame;
float frame_hatch_brightness(const struct frame *f, const struct frame_hatch *h, uint32_t point);
/* Of a brightness 0..1 at a depth: where it is in the tables. */
uint32_t frame_hatch_shade(const struct frame_hatch *h, float brightness, float depth_m);
/* Of all shades. */
float frame_hatch_wanted_most(const struct frame_hatch *h);

#endif
