#ifndef ACQUIRE_PANORAMA_MEANS_H
#define ACQUIRE_PANORAMA_MEANS_H
/* A coarse panorama has several beams a cell, and each has the noise of a range. Those of them that
 * met the surface of the one nearest the centre become one point, their mean: the noise falls with
 * the root of their number, and with it the error of all that rests on ranges. Beams that met
 * another surface, or a slant so steep that they lie far apart, are left out, as all but the nearest
 * are without it. */
#include "acquire/panorama.h"

/* As panorama_add; those that met something are appended to beams, of struct panorama_beam, too. */
void panorama_add_and_keep(panorama *p, const double *azimuth_rad, const float *elevation_rad,
	const float *range_m, const uint16_t *intensity, size_t count, GArray *beams);
/* Once, with all beams that were kept, before panorama_fill. Their order does not matter. */
void panorama_set_means(panorama *p, const GArray *beams);

#endif
