#ifndef RENDER_VIEW_PARALLEL_H
#define RENDER_VIEW_PARALLEL_H
/* Views by parallel rays, as architects draw: plans, elevations and sections of a site (view.h). They are framed for the picture that
 * sources are of, and know what they are to show, so that a page can have them at a scale (page-scale.h).
 *
 *     plan                     from above, all of it, the site's y axis up
 *     plan:HEIGHT              cut so many metres above the ground, looking down on what is below
 *     elevation-north          all of it as it is seen from the north (south, east, west), the nearest of the directions that
 *                              walls face
 *     section-a, section-b     cut upright through the middle along the longer way of the walls, and across it
 *     section:X1,Y1:X2,Y2      cut upright along that line, looking to its left: who goes from the first place to the second has
 *                              what is drawn at the left hand, and the first place is at the left of the picture
 *     section:X1,Y1:X2,Y2:D    no farther than D metres from there
 *
 * In the first two and last three what lies on the cut is drawn as cut, but in "plan". */
#include "render/view-sources.h"
#include "render/view.h"

#define VIEW_PLAN_CUT_M 1.2 /* above the ground, where nobody says */

/* Whether it is one of these forms, be it right or wrong. */
bool view_parallel_is(const char *spec);
/* Errors are G_IO_ERROR_INVALID_ARGUMENT: numbers that are none. There must be boxes. */
view *view_parallel_find(const struct view_sources *s, const char *spec, GError **error);
/* Adds the names of those that every site has. */
void view_parallel_add_names(GPtrArray *names);

#endif
