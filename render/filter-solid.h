#ifndef RENDER_FILTER_SOLID_H
#define RENDER_FILTER_SOLID_H
/* What is known of a pixel beside its colour: whether it is of something solid, where it is in the site, and noise that sticks to that.
 * Internal to filters. */
#include "render/filter-planes.h"

/* 0..1: how sure a pixel is to be of something solid. Single points on bare paper are not, borders of things are: what draws lines
 * multiplies them by it, or every point gets a line around it (Wegen et al. 2024, section 5.3, "validity of pixel information"). */
#define FILTER_SOLID_BLOCK 4u
/* Of the surroundings that are asked, in blocks: 3 pixels of the style's, but no fewer than blocks need to be told apart. */
static inline float filter_solid_sigma(float px)
{
	float sigma = 3 * px / FILTER_SOLID_BLOCK;
	return sigma > 0.6f ? sigma : 0.6f;
}
struct filter_solid {
	uint32_t width, height; /* in blocks */
	float *part;
};
/* In a part of the room. */
struct filter_solid filter_solidity(struct filter_job *j, uint32_t part);
/* Of the pixels of a row, between the middles of blocks. */
void filter_solid_row(const struct filter_solid *s, uint32_t y, float *to, uint32_t pixels);

/* -1..1, standard deviation about 0.3, of each pixel: noise in the site, whose grain is about so many pixels wide on the screen from any
 * distance. Octaves of it come and go as one gets nearer (Benard, Bousseau & Thollot 2009, "Dynamic Solid Textures"). Where nothing is it
 * is noise of the picture. In a part of the room. */
const float *filter_noise(
	struct filter_job *j, uint32_t part, float grain_px, uint32_t seed, const float *calm_m);
/* What filter_noise takes, in part and part + 1 of the room. */
const float *filter_calm_depth(struct filter_job *j, uint32_t part);

/* Depths for noise: those of points jump a little from pixel to pixel, and finely grained noise with them. Means of 1/depth along rows and
 * columns, of pairs of pixels on either side that are about as far: planes stay as they are, and so do leaves. */
#define FILTER_CALM_REACH 3
#define FILTER_CALM_SAME  0.02f /* part of the depth */

/* Octaves of metres that there may be. */
#define FILTER_NOISE_LOWEST  -24
#define FILTER_NOISE_OCTAVES 48
struct filter_noise_job {
	const struct filter_job *j;
	float grain_px;
	uint32_t seed;
	const float *depth_m; /* calm */
	float *to;
	/* Where the eye is in the lattice of each octave: its cell, and where in it. */
	int32_t cell[3][FILTER_NOISE_OCTAVES];
	float within[3][FILTER_NOISE_OCTAVES];
};
LANES_DECLARE(void, filter_noise_rows, (const void *job, uint32_t from, uint32_t end));

/* Metres, of each pixel: a sum of waves in the site, each twice as long as the one before and as high as it is long, all in other
 * directions. The shortest are so many pixels long on the screen, and grow from nothing as one gets nearer; all that are longer stay as
 * they are, so that what is moved by a part of it hardly moves on what it lies on. 0 where nothing is. In a part of the room. */
const float *filter_waves(
	struct filter_job *j, uint32_t part, float shortest_px, const float *calm_m);

/* Lengths are powers of two metres. */
#define FILTER_WAVES_LOWEST -12
#define FILTER_WAVES        20
struct filter_waves_job {
	const struct filter_job *j;
	float shortest_px;
	const float *depth_m; /* calm */
	float *to;
	float length_m[FILTER_WAVES];
	float way[FILTER_WAVES][3]; /* of length 1, in the site */
	float at_eye[FILTER_WAVES]; /* how much of the wave is behind there, 0 .. 1 */
};
LANES_DECLARE(void, filter_waves_rows, (const void *job, uint32_t from, uint32_t end));

#endif
