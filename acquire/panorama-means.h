#ifndef ACQUIRE_PANORAMA_MEANS_H
#define ACQUIRE_PANORAMA_MEANS_H
/* A coarse panorama has several beams a cell, and each has the noise of a range. Those of them that
 * met the surface of the one nearest the centre become one point, their mean: the noise falls with
 * the root of their number, and with it the error of all that rests on ranges. Beams that met
 * another surface, or a slant so steep that they lie far apart, are left out, as all but the nearest
 * were before.
 *
 * Keeps all beams, 16 bytes each, until it is freed. One owner; not thread-safe. */
#include "acquire/panorama.h"

typedef struct panorama_means panorama_means;
panorama_means *panorama_means_new(void);
void panorama_means_free(panorama_means *m); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(panorama_means, panorama_means_free)

/* The beams that panorama_add was given, all of one panorama. */
void panorama_means_add(panorama_means *m, const panorama *p, const double *azimuth_rad,
	const float *elevation_rad, const float *range_m, const uint16_t *intensity, size_t beams);
/* Once, after all beams and before panorama_fill. The order of the beams does not matter. */
void panorama_means_apply(const panorama_means *m, panorama *p);

#endif
