/* A calibration range: a plain closed room with even walls, and checkerboards that stand round the first station, near enough for
 * a camera, each facing another way. */
#include "sim/scene-props.h"

#define HALF_X   13.0f
#define HALF_Y   9.2f
#define CEILING  4.6f
#define EYE      1.7f
#define BOARDS   10
#define COLUMNS  10 /* squares; of the corners inside there are 9 x 6 */
#define ROWS     7
#define SQUARE_M 0.06f
#define MARGIN_M 0.05f

/* Where a board's middle is seen from the station, and how its face is turned away from there. */
struct board {
	float azimuth_deg, up_m, out_m, aside_deg, back_deg, roll_deg;
};

static const struct board boards[BOARDS] = {
	{ 3, -1.0f, 1.6f, 24, -26, 4 },
	{ 39, 1.9f, 2.5f, -26, 30, -6 },
	{ 75, -0.05f, 1.55f, 34, 8, 8 },
	{ 111, -1.15f, 2.4f, -34, -20, -4 },
	{ 147, 1.25f, 1.6f, 20, 30, 6 },
	{ 183, 0.5f, 2.8f, -44, 6, -8 },
	{ 219, -0.8f, 1.6f, 26, -30, 3 },
	{ 255, 1.5f, 2.6f, -32, 26, -5 },
	{ 291, 0.35f, 1.55f, 36, 14, 6 },
	{ 327, -0.9f, 2.7f, -38, -16, -3 },
};

static vec turned(vec v, vec axis, float degrees)
{
	float a = degrees * (float)G_PI / 180, c = cosf(a), s = sinf(a);

	return v * c + cross(axis, v) * s + axis * (dot(axis, v) * (1 - c));
}

/* A pen whose x is the board's right, z its up, and -y its face. */
static struct pen pen_of_board(struct site *s, const struct board *b)
{
	float a = b->azimuth_deg * (float)G_PI / 180;
	struct pen p = site_pen(s, 0, 0, 0, 0);
	vec out = { sinf(a), cosf(a), 0 }, up = { 0, 0, 1 }, right = cross(out, up);

	right = turned(right, up, b->aside_deg);
	out = turned(out, up, b->aside_deg);
	up = turned(up, right, b->back_deg);
	out = turned(out, right, b->back_deg);
	p.at = (struct frame){ turned(right, out, b->roll_deg), out, turned(up, out, b->roll_deg),
		(vec){ sinf(a) * b->out_m, cosf(a) * b->out_m, EYE + b->up_m } };
	p.object = site_object(s, WORLD_STRUCTURE);
	return p;
}

static void draw_rectangle(const struct pen *p, float x0, float z0, float x1, float z1)
{
	pen_quad(p, (vec){ x0, 0, z0 }, (vec){ x1, 0, z0 }, (vec){ x1, 0, z1 }, (vec){ x0, 0, z1 });
}

static void draw_board(const struct pen *p, uint16_t white, uint16_t black)
{
	struct pen light = pen_with(p, white), dark = pen_with(p, black);
	float x = -0.5f * COLUMNS * SQUARE_M, z = -0.5f * ROWS * SQUARE_M;

	for (int i = 0; i < COLUMNS; i++)
		for (int k = 0; k < ROWS; k++)
			draw_rectangle((i + k) % 2 ? &light : &dark, x + i * SQUARE_M,
				z + k * SQUARE_M, x + (i + 1) * SQUARE_M, z + (k + 1) * SQUARE_M);
	draw_rectangle(&light, x - MARGIN_M, z - MARGIN_M, -x + MARGIN_M, z);
	draw_rectangle(&light, x - MARGIN_M, -z, -x + MARGIN_M, -z + MARGIN_M);
	draw_rectangle(&light, x - MARGIN_M, z, x, -z);
	draw_rectangle(&light, -x, z, -x + MARGIN_M, -z);
}

static void draw_room(struct site *s, const struct palette *m)
{
	struct pen walls = site_pen(s, 0, 0, 0, 0), floor = walls;

	floor.object = site_object(s, WORLD_TERRAIN);
	floor.material = m->floor_tiles;
	pen_quad(&floor, (vec){ -HALF_X, -HALF_Y, 0 }, (vec){ HALF_X, -HALF_Y, 0 },
		(vec){ HALF_X, HALF_Y, 0 }, (vec){ -HALF_X, HALF_Y, 0 });
	walls.object = site_object(s, WORLD_BUILDING);
	walls.material = m->plaster[0];
	pen_quad(&walls, (vec){ -HALF_X, -HALF_Y, CEILING }, (vec){ HALF_X, -HALF_Y, CEILING },
		(vec){ HALF_X, HALF_Y, CEILING }, (vec){ -HALF_X, HALF_Y, CEILING });
	for (int k = -1; k <= 1; k += 2) {
		pen_quad(&walls, (vec){ k * HALF_X, -HALF_Y, 0 }, (vec){ k * HALF_X, HALF_Y, 0 },
			(vec){ k * HALF_X, HALF_Y, CEILING },
			(vec){ k * HALF_X, -HALF_Y, CEILING });
		pen_quad(&walls, (vec){ -HALF_X, k * HALF_Y, 0 }, (vec){ HALF_X, k * HALF_Y, 0 },
			(vec){ HALF_X, k * HALF_Y, CEILING },
			(vec){ -HALF_X, k * HALF_Y, CEILING });
	}
	/* Piers, so that walls that face along the room are not all far off. */
	for (int i = -1; i <= 1; i += 2)
		for (int k = -1; k <= 1; k += 2)
			pen_box(&walls, (vec){ i * 3.2f - 0.3f, k * 8.6f - 0.6f, 0 },
				(vec){ i * 3.2f + 0.3f, k * 8.6f + 0.6f, CEILING });
}

void scene_range(struct site *s)
{
	static const float walk[][2] = { { 0, 0 }, { 6, 0 }, { 6, 5.7f }, { 0, 5.7f }, { -6, 5.7f },
		{ -6, 0 }, { -6, -5.7f }, { 0, -5.7f }, { 6, -5.7f }, { 11.3f, -5.7f },
		{ 11.3f, 0 }, { 11.3f, 5.7f } };
	uint16_t white, black;
	struct palette m;
	struct dice kept;

	palette_choose(s, &m);
	/* Printed: without grain. */
	white = site_material(s, (struct material){ .colour = { 0.8f, 0.8f, 0.8f } });
	black = site_material(s, (struct material){ .colour = { 0.03f, 0.03f, 0.03f } });
	s->bounds = (struct bounds){ { -HALF_X - 1, -HALF_Y - 1, -0.4f },
		{ HALF_X + 1, HALF_Y + 1, CEILING + 0.4f }, 1.1f };
	s->light.fill = (vec){ 0.6f, 0.59f, 0.57f };
	for (unsigned i = 0; i < G_N_ELEMENTS(walk); i++)
		site_walk_to(s, walk[i][0], walk[i][1]);
	draw_room(s, &m);
	for (int i = 0; i < BOARDS; i++) {
		struct pen p = pen_of_board(s, &boards[i]);

		draw_board(&p, white, black);
	}
	site_begin_loose(s, &kept);
	for (int i = 0; i < 3; i++) /* waiting for the surveyor */
		add_person(s, -9.5f + site_nudge(s, 1.2f), -2 + 2 * i + site_nudge(s, 0.7f),
			roll_in(&s->dice, 0, 6.28f), POSE_STAND);
	site_end_loose(s, &kept);
}
