#include "render/kiosk/light-ball.h"
#include <math.h>

#define DEGREE (G_PI / 180)

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

void light_ball_place(const struct camera *c, const struct style_light *light, double ret[2])
{
	double azimuth = (double)light->azimuth_deg * DEGREE,
	       elevation = (double)light->elevation_deg * DEGREE;
	double from[3] = { sin(azimuth) * cos(elevation), cos(azimuth) * cos(elevation),
		sin(elevation) };
	double right = dot(c->right, from), down = dot(c->down, from);
	double aside = hypot(right, down), turn = atan2(aside, -dot(c->forward, from));
	double away = fmin(turn / (G_PI / 2), LIGHT_BALL_MOST);
	ret[0] = aside > 1e-9 ? away * right / aside : 0;
	ret[1] = aside > 1e-9 ? away * down / aside : 0;
}

void light_ball_light(const struct camera *c, const double place[2], struct style_light *ret)
{
	double away = hypot(place[0], place[1]), turn = fmin(away, LIGHT_BALL_MOST) * G_PI / 2;
	double aside = away > 1e-9 ? sin(turn) / away : 0, from[3];
	for (int k = 0; k < 3; k++)
		from[k] = c->right[k] * place[0] * aside + c->down[k] * place[1] * aside -
			  c->forward[k] * cos(turn);
	double azimuth = atan2(from[0], from[1]);
	ret->azimuth_deg = (float)((azimuth < 0 ? azimuth + 2 * G_PI : azimuth) / DEGREE);
	ret->elevation_deg = (float)(asin(CLAMP(from[2], -1, 1)) / DEGREE);
}

void light_ball_draw(cairo_t *cr, const double place[2], double x, double y, double radius)
{
	double away = hypot(place[0], place[1]), turn = away * G_PI / 2;
	double part = away > 1e-9 ? sin(turn) / away * radius : 0;
	bool behind = turn > G_PI / 2;
	/* From behind only its edge is lit. */
	cairo_pattern_t *shade = cairo_pattern_create_radial(x + place[0] * part,
		y + place[1] * part, 0, x + place[0] * part * 0.4, y + place[1] * part * 0.4,
		radius * (behind ? 0.8 * (2 - away) + 0.2 : 1.3));
	cairo_pattern_add_color_stop_rgba(shade, 0, 1, 0.97, 0.86, 1);
	cairo_pattern_add_color_stop_rgba(shade, 0.45, 0.78, 0.74, 0.66, 1);
	cairo_pattern_add_color_stop_rgba(shade, 1, 0.16, 0.15, 0.14, 1);
	cairo_new_path(cr);
	cairo_arc(cr, x, y, radius, 0, 2 * G_PI);
	cairo_set_source(cr, shade);
	cairo_fill_preserve(cr);
	cairo_pattern_destroy(shade);
	cairo_set_source_rgba(cr, 1, 1, 1, 0.9);
	cairo_set_line_width(cr, 3);
	cairo_stroke(cr);
	/* The lamp itself. */
	double reach = away > 1e-9 ? fmin(away, 1.25) / away * radius : 0;
	cairo_arc(cr, x + place[0] * reach, y + place[1] * reach, 9, 0, 2 * G_PI);
	cairo_set_source_rgba(cr, 0.77, 0.34, 0.16, behind ? 0.6 : 1);
	cairo_fill_preserve(cr);
	cairo_set_source_rgba(cr, 1, 1, 1, 1);
	cairo_set_line_width(cr, 2.5);
	cairo_stroke(cr);
}
