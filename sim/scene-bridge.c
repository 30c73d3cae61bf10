#include "sim/scene-tree.h"

void scene_bridge(struct site *s)
{
	uint16_t wall = site_material(s, (struct material){ .colour = { 0.7f, 0.65f, 0.55f },
						 .joint_colour = { 0.5f, 0.45f, 0.4f },
						 .cell_u_m = 0.6f,
						 .cell_v_m = 0.3f,
						 .bond = 0.5f,
						 .joint_m = 0.01f,
						 .variety = 0.1f });
	struct pen p = site_stand(s, WORLD_TERRAIN, 0, 0, 0), q = pen_with(&p, wall);
	s->bounds = (struct bounds){ { -21, -16, -1 }, { 21, 16, 18 }, 2 };
	pen_quad(&q, (vec){ -60, -60, 0 }, (vec){ 60, -60, 0 }, (vec){ 60, 60, 0 },
		(vec){ -60, 60, 0 });
	for (int i = 0; i < 10; i++)
		site_walk_to(s, -14 + 7 * (float)(i % 5), i < 5 ? -5 : 5);
	uint32_t tree = tree_model(s, TREE_ROUND);
	for (int i = 0; i < 4; i++) {
		q = site_stand(s, WORLD_BUILDING, 0, 0, i * G_PI / 2);
		q.material = wall;
		pen_box(&q, (vec){ -25, 18, -1 }, (vec){ 25, 25, 8 + roll_in(&s->dice, 0, 4) });
		plant(s, tree, -15 + 10 * (float)i, 0, 1);
	}
	s->ground = NULL;
}
