#ifndef RENDER_BENCH_HATCHING_H
#define RENDER_BENCH_HATCHING_H
/* pleinair bench hatching: how long drawings take that two papers give times of, of closed things of as many points as theirs
 * (bench-statue.h), from a camera that has all of it in view:
 *
 *     Wagner et al. 2022, section 4: 3.5, 5.7 and 11 million points at 2947 x 1661, in 30, 60 and 100 ms on a Radeon RX 5700 XT
 *     Awano et al. 2010, section 3: 72,027 to 542,199 points at 1024 x 1024; here 30 frames a second are wanted */
#include "render/backend-choice.h"

struct bench_hatching_options {
	uint32_t repeats;
	enum backend_wish backend;
	char **styles; /* NULL: pencil, charcoal, coloured-crayons; of the small things, stipple-diffuse, stipple-highlight, stippling */
	bool json;
};
/* A time that is missed is no failure. */
bool bench_hatching(const struct bench_hatching_options *options, GError **error);

#endif
