#ifndef RENDER_STIPPLE_H
#define RENDER_STIPPLE_H
/* Stippling without normals: which points a layer of the kind "stipple" draws as dots (Awano, Nishio & Kobori 2010, "Interactive
 * Stipple Rendering for Point Clouds"). It asks for the places of points alone, not for normals, kinds or features.
 *
 * Section 2.1: all points that are in view hide what is behind them (stipple-texture.h). What is seen of the layer's leaves is drawn but
 * for what the style's light takes away, by its amount:
 *
 * Section 2.2: of the points that are seen the nearest to the light in each texel of a level of a quadtree is left out
 * (stipple-quadtree.h). Where surface faces the light fewer points share a texel, so more of them are left out there.
 *
 * Section 2.3: a hidden-points texture is made for the light too. Texels around a point that hold its own depth are as many as its
 * surface is wide there: as part of those of a surface that faces the plane, which are the square of how far points are apart in
 * texels and all around (9, 25) at most, about the cosine of the angle that it is met at. Where that of the light less that of the
 * eye is above epsilon, points are left out, as a highlight. The paper divides by 9 and 25 whatever the points, which says nothing of
 * dense ones, whose counts are 1 to 3; and it does not tell the sign. Without one, points are left out beside the edges of shadows
 * too, where surface faces the eye and hardly the light.
 *
 * Section 3: what the light does not see stays whole: a shadow. The light's textures see all leaves that are stippled, in view or not.
 *
 * A point is seen or not, so dots come and go at once where they go behind others: when the camera turns around a thing by half a degree,
 * one or two in a hundred, on a ball all of them at its outline. To fade them by how much deeper what is beside them is was tried, and was worse:
 * depths beside a point jump from texel to texel, and in a band of a pass's step one dot in ten changed by more than 0.15. What the light
 * leaves out does not depend on the camera but by what is seen, and by the eye's counts. */
#include "render/stipple-plan.h"
#include "render/stroke-brush.h"

typedef struct stipple stipple;
stipple *stipple_new(void);
void stipple_free(stipple *s); /* NULL is fine */
/* Looks at a frame; what does not depend on the camera is kept while frame and layer are the same. */
void stipple_look(
	stipple *s, const frame *f, uint32_t layer, const struct chunk_view *views, uint32_t count);
/* The dots of a chunk that the frame looked at has in view, in the order of its points. Any thread. */
void stipple_draw(
	const stipple *s, const frame *f, const struct chunk_view *v, struct stroke_chain *to);

#endif
