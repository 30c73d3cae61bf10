#ifndef RENDER_KIOSK_LOOKING_H
#define RENDER_KIOSK_LOOKING_H
/* How a person looks at a site on the screen, and what fingers change of it: around a thing from outside, around oneself from where a
 * scanner stood, or at a plan, elevation or section, which fingers move and scale but do not turn. The thing under the finger follows
 * the finger. Plain values, pure functions, no display. */
#include "render/view.h"

enum looking_mode {
	LOOKING_AROUND,   /* the focus stays, the eye goes round it */
	LOOKING_FROM,     /* the eye stays, the head turns */
	LOOKING_PARALLEL, /* by parallel rays: a drawing that lies there */
};

struct looking {
	enum looking_mode mode;
	double focus_m[3];
	double heading_rad, elevation_rad; /* of the eye's axis, as camera.h has them */
	double distance_m;                 /* from eye to focus */
	double fov_deg;
	/* LOOKING_PARALLEL: as struct view has them. The eye is where the view begins. */
	double height_m, depth_m, cut_m;
	bool is_cut;
};

/* LOOKING_PARALLEL of a parallel view, else LOOKING_AROUND. */
struct looking looking_of_view(const struct view *v);
/* To be kept: all that a picture of this width by height shows is what a parallel one is to show. */
view *looking_view(const struct looking *l, const char *name, const char *title, double aspect);
/* From an eye, as LOOKING_FROM. The focus lies distance_m ahead. */
struct looking looking_from(const double eye_m[3], double heading_rad, double elevation_rad,
	double distance_m, double fov_deg);
void looking_eye(const struct looking *l, double ret_m[3]);
struct camera looking_camera(const struct looking *l, uint32_t width, uint32_t height);

/* A finger moved by so many pixels of a picture of this height: the eye goes round, or the head turns, or the drawing goes along. */
void looking_drag(struct looking *l, double right_px, double down_px, double height_px);
/* Two fingers: the place under them stays under them. */
void looking_pan(struct looking *l, double right_px, double down_px, double height_px);
/* Above 1: nearer, about a place of the picture (from its middle, in px). LOOKING_FROM narrows the lens instead, a drawing grows. */
void looking_zoom(
	struct looking *l, double factor, double right_px, double down_px, double height_px);
/* Two fingers turn, clockwise on the screen; drawings stay as they lie. */
void looking_twist(struct looking *l, double angle_rad);
/* Goes to where this place is in the middle, and so much nearer (1: as far as now). */
struct looking looking_at(const struct looking *l, const double place_m[3], double nearer);
/* Part 0..1 of the way from one to the other, easing at both ends; turns the shorter way. Between perspective and parallel rays it is in
 * perspective, from where as much is to be seen. */
struct looking looking_between(const struct looking *a, const struct looking *b, double part);

#endif
