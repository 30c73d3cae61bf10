#ifndef RENDER_KIOSK_LIGHT_BALL_H
#define RENDER_KIOSK_LIGHT_BALL_H
/* A ball that shows from where a drawing is lit: the place on it that faces the light follows the finger. In its middle the light comes
 * from behind the person, at its edge (1 away from the middle) from the side, and beyond that from behind the site. Pure functions. */
#include "render/camera.h"
#include "render/style.h"
#include <cairo.h>

#define LIGHT_BALL_MOST 1.9 /* from the middle: nearly from straight behind */

/* x to the right and y down, as on the screen. */
void light_ball_place(const struct camera *c, const struct style_light *light, double ret[2]);
/* Sets where the light comes from. */
void light_ball_light(const struct camera *c, const double place[2], struct style_light *ret);
void light_ball_draw(cairo_t *cr, const double place[2], double x, double y, double radius);

#endif
