#ifndef SIM_SCENE_FACADE_H
#define SIM_SCENE_FACADE_H
/* Walls with openings and the stone work about them.
 *
 * A facade is drawn in the frame of its pen: x runs along the wall from its left end, z up from the
 * floor, and the viewer is on the side of -y. Behind it, towards +y, are dim rooms that can be seen
 * through the panes. */
#include "sim/scene-palette.h"

enum head { HEAD_PLAIN, HEAD_LINTEL, HEAD_HOOD, HEAD_PEDIMENT, HEAD_KEYSTONE };

#define UPPER_DOOR_M 0.17f /* what covers the course below */

struct opening {
	float x, z, width, height; /* left lower corner; the height is to the crown of an arch */
	bool arched, door;
	enum head head;
	bool shutters, balcony;
};

struct storey {
	float height, window_width, window_height, sill;
	bool arched;
	enum head head;
	unsigned balconies, shutters; /* every how many-th window has them, 0 none */
};

struct facade {
	const struct palette *palette;
	uint16_t wall, ground_wall, trim, frame, shutter; /* materials */
	float length, room_m;
	unsigned bays, storeys;
	struct storey storey[5];
	unsigned doors;       /* bits: bays of the ground floor that have doors */
	unsigned upper_doors; /* bits: bays of the first floor with a door, UPPER_DOOR_M up */
	unsigned blank;       /* bits: bays that stay blank on the ground floor */
	unsigned gates;       /* bits: bays of the ground floor with a wide arched gate */
	float flank;          /* blank wall beyond both ends, where other wings abut */
	bool quoins, dentils, open_ground; /* open: the ground floor is drawn by somebody else */
	float mitre;                       /* of cornice and courses, see pen_moulding() */
};

float facade_height(const struct facade *f);
void draw_facade(struct site *s, const struct pen *p, const struct facade *f);

/* The parts, for those who draw by hand. */
void draw_wall(const struct pen *p, float x0, float x1, float z0, float z1,
	const struct opening *openings, unsigned n);
void draw_opening(
	struct site *s, const struct pen *p, const struct facade *f, const struct opening *o);
/* The same with no curtains, for who looks at it from inside a hall. */
void draw_window(const struct pen *p, const struct facade *f, const struct opening *o);
/* A flat ring piece in the x-z plane from angle a0 to a1 (0 is +x, counted towards z), y0 in front.
 */
void draw_arc(const struct pen *p, float x, float z, float inner, float outer, float y0, float y1,
	float a0, float a1, unsigned n);
/* The same as wedge stones with joints: every other one stands out a little. */
void draw_voussoirs(const struct pen *p, float x, float z, float inner, float outer, float y0,
	float y1, unsigned n);
void draw_cornice(
	const struct pen *p, float x0, float x1, float z, float scale, float mitre, bool dentils);
void draw_course(const struct pen *p, float x0, float x1, float z, float mitre);
/* Column with base and capital, its foot at the pen's origin. */
void draw_column(const struct pen *p, float height, float radius);
/* Four webs of a cross vault over 2*half_x by 2*half_y, springing at the pen's z = 0; pointed or
 * round. */
void draw_groin(
	const struct pen *p, float half_x, float half_y, float rise, bool pointed, float rib);
/* Its diagonals and the arches at two sides, as round ribs. */
void draw_groin_ribs(
	const struct pen *p, float half_x, float half_y, float rise, bool pointed, float radius);
/* n steps up towards +y, their top edge at y = 0; side walls on request. */
void draw_steps(const struct pen *p, float width, unsigned n, float rise, float tread);
/* A flight along a wall with its foot to the right, up to a landing from x to x + landing, whose
 * floor is at z = top; claims the ground it stands on. */
void draw_outside_stair(struct site *s, const struct pen *p, const struct palette *m, float x,
	float landing, float top, float width);
/* A straight rail on posts or balusters from a to b, which stand on the ground. */
void draw_railing(const struct pen *p, vec a, vec b, float height, float spacing);

#endif
