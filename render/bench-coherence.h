#ifndef RENDER_BENCH_COHERENCE_H
#define RENDER_BENCH_COHERENCE_H
/* pleinair bench coherence: whether drawings of a site stay calm when the camera moves, and as dark as they should be (Benard et al.
 * 2011, "State-of-the-Art in Temporal Coherence of Non-Photorealistic Animations", has what can go wrong).
 *
 * The camera goes along a dolly (twice as near in 40 frames), an orbit (0.5 degrees a frame) and a pan (8 px a frame), each of 40
 * frames from one view; and it stands still while the light of the style goes round by 0.5 degrees a frame. Some pairs of neighbouring
 * frames are measured, spread over the path; density and tone in half of them at least. Frames are drawn by cpu at a pixel to a pixel, without supersampling, but for warp. Depths and cameras are known, so that motion is exact:
 *
 *     shown      a place in the picture, none of whose four nearest pixels the mask covers before it
 *     kept       of the strokes of a frame whose places in the site are shown in the next one, those that are drawn in it, of all layers; the
 *                worst pair (>= 99 %)
 *     step       the largest change of alpha from a frame to the next of any stroke whose place is shown in both; what is not drawn
 *                has alpha 0 (<= 0.15). And the part of the strokes of both whose change is larger than that
 *     density    of layers that cover areas (points: surface, dithering, all): sum of alpha of their strokes by the alpha that a
 *                stroke of such a point has when it has faded in, to what the layer wants there: of every covered pixel, by the
 *                lightness that plain coloured points have in it. Over cells of 32 px that are at least half covered and that the
 *                data do not limit, all layers together; least and most of all frames (0.9 to 1.1). And of single layers, also of
 *                those that cover little. Of hatching first strokes alone, by their lengths, and by how light it takes points for
 *                instead of their colours
 *     limited    part of the covered area in cells where the points of the layer that are to be seen, with all copies that they may
 *                give (step.h), are fewer than it wants
 *     cv         coefficient of variation of density over tiles of 64 px that are covered whole (99 %), not limited, and where 50
 *                strokes or more are wanted; mean of frames (<= 0.25). And with the limited tiles
 *     warp       how much of the picture changes: V(t) - V(t-1) at the same place of the site, V the luminance in linear light (Lai et al.
 *                2018), squared, by the variance of V; over what is covered in both frames at depths that agree to 2 %, which are those of
 *                the discs that show, not of the mask, which lies behind them. Both frames are drawn four times as fine, and means of 4 x 4 pixels are compared
 *                (<= 3.25 %, which is what kept and step let through: a hundredth of the strokes goes at once, and all others change by
 *                0.15). A picture that has nothing to do with the one before has 200 %; how strong its contrast is does not matter. On
 *                flat paper: its grain, and what teeth of strokes and filters take of it, are to stay where they are.
 *                And beside it the mean square of the pixels' own differences by the same of plain coloured points, where thin ink that
 *                moves by half a pixel counts like ink that comes and goes: points of a courtyard that are painted with black stripes of
 *                1 cm, which never change, have 23 there (and 1.1 % of the above), where figure-7d has 14
 *     tone       of layers with the tone of the colour, drawn alone on paper without grain: mean luminance of tiles of 64 px that
 *                are covered whole and that the data do not limit, by the paper's, less what the layer's tone curve makes of the
 *                lightness of plain coloured
 *                points (it ends at what strokes no closer than spacing_px can reach: frame_wanted_light); root of the mean square
 *                (<= 0.04). And with the limited tiles
 *     static     the same camera gives the same bytes again
 *
 * Of several layers the worst one counts. */
#include "render/bench-place.h"

#define BENCH_COHERENCE_PAIRS_MAX 39u

struct bench_coherence_options {
	struct bench_place_options place;
	char **styles;    /* NULL: figure-7a to d, figure-1-* */
	const char *view; /* NULL: walk */
	uint32_t pairs;   /* of each path */
	uint32_t width, height;
	bool json;
};
/* A bar that is missed is no failure. */
bool bench_coherence(const struct bench_coherence_options *options, GError **error);

#endif
