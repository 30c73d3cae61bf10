#ifndef RENDER_FILTER_TABLES_H
#define RENDER_FILTER_TABLES_H
/* What filters make of a step and a frame before they go through pixels: the same for both backends. Internal to filters. */
#include "render/filter-anisotropic.h"
#include "render/filter-bilateral.h"
#include "render/filter-solid.h"

/* Weights of filter_blur, of the pixel itself and those so far away; the return value is how far. */
uint32_t filter_blur_weigh(float sigma_px, float ret[FILTER_BLUR_RADIUS_MOST + 1]);

/* Where the eye is in the lattices of noise, and in waves. */
void filter_noise_look(struct filter_noise_job *n, const frame *f);
void filter_waves_look(struct filter_waves_job *w, const frame *f);

/* All taps, of struct anisotropic_tap, for p->reach and p->pitch; p->first says whose they are. The caller unrefs it, as long as p->tap
 * is wanted. */
GArray *anisotropic_taps(struct anisotropic_pass *p, float radius);
uint32_t anisotropic_reach(float radius);

/* Weights of the bilateral filter; how far. */
uint32_t bilateral_weigh(float sigma_px, float ret[BILATERAL_RADIUS_MOST + 1]);

/* Grading: hues turned about the grey axis; gamma, brightness and contrast, 0..1. */
struct grade_tables {
	float turn[3][3];
	float curve[256];
};
void grade_tables_make(const struct grade_step *s, struct grade_tables *ret);

/* Swaying, in pixels of the picture. */
struct warp_wave {
	float wave[2], way[2], amplitude, phase;
};
struct warp_wave warp_wave_of(const struct warp_step *s, float px, double time_s);

/* Where occlusion looks, of pixels that lie in turns. */
#define OCCLUSION_RING          12
#define OCCLUSION_TURNS         16
#define OCCLUSION_REACH_MOST_PX 120.f /* of the style's: no farther */
void occlusion_ways(float ret[OCCLUSION_TURNS][OCCLUSION_RING][2]);

/* Layers of a pencil: planes across a direction of the site. */
#define PENCIL_LAYERS_MOST 6
#define PENCIL_SWAY_PX     60.f /* the shortest waves of a hand */
struct pencil_layer {
	float across[3]; /* as the camera sees it */
	/* Where the eye is, in planes of each octave. */
	float eye[FILTER_NOISE_OCTAVES];
	int32_t eye_whole[FILTER_NOISE_OCTAVES];
};
/* How many there are. */
int pencil_layers(
	const struct pencil_step *s, const frame *f, struct pencil_layer ret[PENCIL_LAYERS_MOST]);

/* Of difference of Gaussians along the flow: how smooth that is. */
static inline float dog_tensor_px(const struct dog_step *s)
{
	return 2 * s->sigma_px + 1;
}

/* Of edges: places on straight lines through a pixel, to one side; cosines of bends that begin to be lines, and are lines. */
#define EDGES_WAYS  8
#define EDGES_REACH 7
void edges_ways(int ret[EDGES_WAYS][EDGES_REACH][2]);
void edges_bends(const struct edges_step *s, float ret[2]);
/* From which straightness on edges are lines. */
#define EDGES_STRAIGHT_SOME 0.22f
#define EDGES_STRAIGHT_ALL  0.40f
#define EDGES_ONE_SIDE      1.6f /* so much counts what is on one side alone */
#define EDGES_SOFT_PX       0.7f /* of their borders */

/* Pixels that gaps are closed by. */
int gaps_radius(const struct gaps_step *s, float px, float spacing_px);
#define GAPS_RADIUS_MOST_PX 12.f /* of the style's, where nobody says */
/* Of a wide circle not every pixel is asked: in large pictures it has a hundred thousand. */
static inline int gaps_step_px(int radius)
{
	return 1 + (radius - 1) / 24;
}
/* Pixels of the squares of Kuwahara's filter. */
int kuwahara_radius(const struct kuwahara_step *s, float px);

#endif
