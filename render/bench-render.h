#ifndef RENDER_BENCH_RENDER_H
#define RENDER_BENCH_RENDER_H
/* pleinair bench render: what drawing costs, beside the frame rates of Xu & Chen 2004 (table 1: 1600 x 1200, a GeForce FX 5800) and,
 * where it is installed, VTK.
 *
 * Two scenes with as many points as the paper's: the first part of every chunk of the site's model (bench-subset.h). Of each, three
 * cameras with about as many points in view as in the paper (bench-frames.h), each drawn in sprites (figure-7a), in strokes
 * (figure-7d), in paint (impressionist; the paper has none, and its rates are of the other two) and as plain coloured points, which is
 * what VTK draws. One picture is a pixel to a pixel, without supersampling. Of the repeats the one that took least counts, with all its stages.
 *
 *     Nc      points in chunks that are in view
 *     N1      of these the mask is drawn of: discs by the rank test, in the picture
 *     N2      strokes that are drawn
 *     mask    in figure-7a, points in view by the seconds of the mask: in the overview, with nearly all points in view, as those of
 *             others that the bar stands beside were measured; and of the three cameras together
 *     strokes 24 x 6 px, textured, of all points, 2 px apart at most, in the third frame of the last scene. Submitted are those that
 *             are dense enough, drawn those of them that are not hidden; by the seconds of choosing, binning and drawing
 *     bytes   a point: how much more memory the process holds after a few frames than before scene_new, without the picture
 *     VTK     the same points and cameras, 3 px, no shading: the first frame with all it prepares, then the mean of two frames */
#include "render/bench-place.h"

struct bench_render_options {
	struct bench_place_options place;
	uint32_t repeats, width, height;
	bool cpu_only; /* else what there is of OpenGL ES draws the same, also one in software */
	bool json;
};
/* A figure that is not what it is meant to be is no failure. */
bool bench_render(const struct bench_render_options *options, GError **error);

#endif
