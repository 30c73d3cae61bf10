#ifndef RENDER_BENCH_FILTERS_H
#define RENDER_BENCH_FILTERS_H
/* pleinair bench filters: how long filters of pictures take, beside what two papers say.
 *
 *     each filter alone, at 1920 x 1080, on a picture of the site
 *     Redmond & Dingliana 2007, table 1: whole frames of a scene at three sizes, on a GeForce 7950 GX2
 *     Wegen et al. 2024, table 2: whole frames of 2.5 to 82 million points at 1920 x 1080, on a GeForce RTX 3090; as much of it as there
 *     is memory for */
#include "render/backend-choice.h"
#include "render/bench-place.h"

struct bench_filters_options {
	struct bench_place_options place;
	uint32_t repeats;
	enum backend_wish backend;
	double million_points_most; /* of the last table */
	bool json;
};
/* A time that is missed is no failure. */
bool bench_filters(const struct bench_filters_options *options, GError **error);

#endif
