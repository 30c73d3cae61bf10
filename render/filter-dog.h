#ifndef RENDER_FILTER_DOG_H
#define RENDER_FILTER_DOG_H
/* Lines of differences of Gaussians, rows at a time. Internal to filter-dog.c. */
#include "render/filter-solid.h"

struct dog_pass {
	const struct filter_job *j;
	const struct dog_step *step;
	const float *fine, *coarse; /* Gaussian means */
	const float *difference;    /* along the flow, instead of them */
	struct filter_solid solid;
};
/* Of two means. */
#define DOG_COMBINED(s, fine, coarse)                                                              \
	((s)->sharpness > 0 ? (1 + (s)->sharpness) * (fine) - (s)->sharpness * (coarse)            \
			    : (fine) - (coarse))
/* Draws them into the picture's spare. */
LANES_DECLARE(void, filter_dog_rows, (const void *pass, uint32_t from, uint32_t end));

#endif
