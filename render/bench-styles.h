#ifndef RENDER_BENCH_STYLES_H
#define RENDER_BENCH_STYLES_H
/* pleinair bench styles: how long frames of a large site take in each style, of a camera that moves, from among the points and from where
 * all of them are seen. DESIGN, "Speed": 100 million points, any style, 1080p, 60 frames a second on a GPU.
 *
 * 111 million points on an NVIDIA H200 (driver 580; four of its 132 processors shade and blend) beside 16 cores: of 47 styles and two
 * places half have 60 and more, the median 60.4, from 25 (ballpoint, among the points) to 119 (eye-dome, above them). A frame's stages took
 * 11 ms there, finding the chunks in view 6. */
#include "render/backend-choice.h"
#include "render/bench-place.h"

struct bench_styles_options {
	struct bench_place_options place;
	double million_points; /* of a town that is made of the place; 0: the place itself */
	uint32_t width, height, repeats;
	enum backend_wish backend;
	char **styles; /* NULL: all that are shipped */
	bool json;
};
/* A time that is missed is no failure. */
bool bench_styles(const struct bench_styles_options *options, GError **error);

#endif
