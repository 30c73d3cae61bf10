#ifndef RENDER_VIEW_FIND_H
#define RENDER_VIEW_FIND_H
/* From what people write to a view. Beside those that were saved, every site has
 *
 *     overview    a bird's: down at 25 to 35 degrees on the bulk of the points, from the side that
 *                 most of them are seen from
 *     plan, plan:HEIGHT, elevation-north, section-a and others   by parallel rays, as view-parallel.h tells
 *     walk        a person's, VIEW_PERSON_M above the ground, from where a scanner stood towards the
 *                 middle of the site, or a little past what hides it
 *     station-K   a scanner's, the K-th of those that the model is of (in the order of their numbers),
 *                 towards where it sees most at middle distance
 *
 * They depend on the model alone: the same model gives the same views. And there is
 * "X,Y,Z:X,Y,Z[:FOV]": eye and target in metres of the site, the vertical field of view in degrees. */
#include "render/view-sources.h"
#include "render/view.h"

#define VIEW_FOV_DEG  55.0 /* where nobody says */
#define VIEW_PERSON_M 1.65

/* A saved view of that name, else a built-in one, else eye and target. Errors of a saved view are
 * view_load's; a name that there is none of is G_IO_ERROR_NOT_FOUND, with all that there are in the
 * sentence; eye and target that are none are G_IO_ERROR_INVALID_ARGUMENT. */
bool view_find(const struct view_sources *s, const char *spec, view **ret, GError **error);

/* The built-in views that these sources have, in the order above, without those that need numbers but for one
 * plan:HEIGHT; caller frees. */
GPtrArray *view_built_in_names(const struct view_sources *s);
/* NULL: there is none of that name. */
view *view_built_in(const struct view_sources *s, const char *name);

#endif
