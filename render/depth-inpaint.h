#ifndef RENDER_DEPTH_INPAINT_H
#define RENDER_DEPTH_INPAINT_H
/* Depth inpainting (Wegen et al. 2024, section 3.1 and listing 1): what filters drew beside things becomes part of them. */
#include "render/filter.h"

/* Lightness as the listing compares it, of 0..255. */
static inline uint8_t depth_inpaint_grey(const uint8_t rgba[4])
{
	return (uint8_t)((77 * rgba[0] + 150 * rgba[1] + 29 * rgba[2] + 128) >> 8);
}

struct depth_inpainting {
	const struct filter_image *image; /* as filters left it, with grey_before */
	float threshold;                  /* 0..1 */
	int radius;                       /* pixels */
	float *to;                        /* becomes the depth of each pixel */
};
/* A pixel whose lightness changed by no more than the threshold keeps its depth. Another one gets the mean depth of the pixels of the
 * circle around it where something is; where nothing is in all of it, which the listing leaves open, it keeps its own too. */
void depth_inpaint(const struct filter_job *j, const struct depth_inpainting *d);

#endif
