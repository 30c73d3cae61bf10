#include "sim/scene-palette.h"

#define ADD(...) site_material(s, (struct material){ __VA_ARGS__ })

static vec tone(struct dice *d, vec colour, float by)
{
	float light = roll_in(d, 1 - by, 1 + by), warm = roll_in(d, -by, by) * 0.4f;
	return colour * light * (vec){ 1 + warm, 1, 1 - warm };
}

static void choose_walls(struct site *s, struct palette *p)
{
	static const vec plasters[] = { { 0.74f, 0.66f, 0.50f }, { 0.78f, 0.74f, 0.66f },
		{ 0.68f, 0.48f, 0.34f }, { 0.62f, 0.64f, 0.56f }, { 0.76f, 0.60f, 0.36f },
		{ 0.70f, 0.56f, 0.50f }, { 0.56f, 0.62f, 0.66f } };
	unsigned first = (unsigned)roll_int(&s->dice, 0, 6);
	for (unsigned i = 0; i < 5; i++)
		p->plaster[i] = ADD(.colour = tone(&s->dice, plasters[(first + i) % 7], 0.1f),
			.grain_per_m = 30, .grain = 0.07f, .stain_per_m = 0.35f, .stain = 0.07f);
	for (unsigned i = 0; i < 2; i++)
		p->brick[i] =
			ADD(.colour = tone(&s->dice,
				    i ? (vec){ 0.50f, 0.36f, 0.22f } : (vec){ 0.42f, 0.17f, 0.10f },
				    0.12f),
				.joint_colour = { 0.52f, 0.48f, 0.42f }, .cell_u_m = 0.24f,
				.cell_v_m = 0.075f, .bond = 0.5f, .joint_m = 0.012f,
				.variety = 0.28f, .warmth = 0.1f, .grain_per_m = 40, .grain = 0.12f,
				.stain_per_m = 0.5f, .stain = 0.08f);
	p->ashlar = ADD(.colour = tone(&s->dice, (vec){ 0.62f, 0.56f, 0.45f }, 0.1f),
		.joint_colour = { 0.36f, 0.32f, 0.26f }, .cell_u_m = 0.72f, .cell_v_m = 0.34f,
		.bond = 0.5f, .joint_m = 0.012f, .variety = 0.12f, .warmth = 0.06f,
		.grain_per_m = 18, .grain = 0.1f, .stain_per_m = 0.5f, .stain = 0.1f);
	p->rustic = ADD(.colour = tone(&s->dice, (vec){ 0.54f, 0.50f, 0.43f }, 0.1f),
		.joint_colour = { 0.22f, 0.2f, 0.17f }, .cell_u_m = 0.95f, .cell_v_m = 0.45f,
		.bond = 0.5f, .joint_m = 0.03f, .variety = 0.12f, .warmth = 0.05f,
		.grain_per_m = 14, .grain = 0.16f, .stain_per_m = 0.6f, .stain = 0.1f);
	p->rubble = ADD(.colour = tone(&s->dice, (vec){ 0.46f, 0.42f, 0.35f }, 0.1f),
		.joint_colour = { 0.3f, 0.28f, 0.24f }, .cell_u_m = 0.46f, .cell_v_m = 0.26f,
		.bond = 0.43f, .joint_m = 0.02f, .variety = 0.25f, .warmth = 0.1f,
		.grain_per_m = 12, .grain = 0.2f, .stain_per_m = 0.7f, .stain = 0.14f);
	p->trim = ADD(.colour = tone(&s->dice, (vec){ 0.72f, 0.68f, 0.59f }, 0.08f),
		.grain_per_m = 24, .grain = 0.07f, .stain_per_m = 0.8f, .stain = 0.08f);
	p->trim_dark = ADD(.colour = tone(&s->dice, (vec){ 0.5f, 0.45f, 0.38f }, 0.1f),
		.grain_per_m = 20, .grain = 0.1f, .stain_per_m = 0.8f, .stain = 0.12f);
}

static void choose_roofs(struct site *s, struct palette *p)
{
	p->tiles = ADD(.colour = tone(&s->dice, (vec){ 0.44f, 0.19f, 0.11f }, 0.12f),
		.joint_colour = { 0.16f, 0.08f, 0.05f }, .cell_u_m = 0.22f, .cell_v_m = 0.33f,
		.bond = 0.5f, .joint_m = 0.02f, .variety = 0.28f, .warmth = 0.1f, .grain_per_m = 9,
		.grain = 0.15f, .stain_per_m = 0.4f, .stain = 0.16f);
	p->slate = ADD(.colour = tone(&s->dice, (vec){ 0.2f, 0.22f, 0.25f }, 0.1f),
		.joint_colour = { 0.09f, 0.1f, 0.11f }, .cell_u_m = 0.3f, .cell_v_m = 0.28f,
		.bond = 0.5f, .joint_m = 0.014f, .variety = 0.25f, .warmth = 0.06f,
		.grain_per_m = 9, .grain = 0.1f, .stain_per_m = 0.4f, .stain = 0.12f);
	p->copper = ADD(.colour = { 0.3f, 0.5f, 0.42f }, .joint_colour = { 0.2f, 0.36f, 0.3f },
		.cell_u_m = 0.5f, .cell_v_m = 9, .joint_m = 0.05f, .stain_per_m = 0.7f,
		.stain = 0.15f);
}

static void choose_fittings(struct site *s, struct palette *p)
{
	static const vec doors[] = { { 0.10f, 0.16f, 0.12f }, { 0.26f, 0.09f, 0.06f },
		{ 0.10f, 0.14f, 0.22f }, { 0.24f, 0.15f, 0.08f } };
	for (unsigned i = 0; i < 4; i++)
		p->door[i] = ADD(.colour = tone(&s->dice, doors[i], 0.15f), .grain_per_m = 60,
			.grain = 0.12f, .grain_stretch = 12, .gloss = 0.02f, .reflectivity = 0.35f);
	p->frame_light = ADD(.colour = tone(&s->dice, (vec){ 0.78f, 0.77f, 0.72f }, 0.06f));
	p->frame_dark = ADD(.colour = tone(&s->dice, (vec){ 0.16f, 0.12f, 0.09f }, 0.2f));
	p->plank = ADD(.colour = { 0.3f, 0.21f, 0.13f }, .joint_colour = { 0.08f, 0.06f, 0.04f },
		.cell_u_m = 0.16f, .cell_v_m = 7, .joint_m = 0.01f, .variety = 0.2f,
		.grain_per_m = 30, .grain = 0.2f, .grain_stretch = 10);
	p->wood = ADD(.colour = { 0.36f, 0.23f, 0.13f }, .grain_per_m = 22, .grain = 0.2f,
		.grain_stretch = 3, .stain_per_m = 1.2f, .stain = 0.08f);
	p->glass = ADD(.kind = MATERIAL_GLASS, .colour = { 0.05f, 0.06f, 0.06f },
		.reflectivity = 0.1f);
	p->water = ADD(.kind = MATERIAL_WATER, .colour = { 0.055f, 0.085f, 0.07f },
		.reflectivity = 0.02f);
	p->inside = ADD(.colour = { 0.45f, 0.40f, 0.33f }, .emission = 0.05f, .stain_per_m = 0.8f,
		.stain = 0.3f);
	p->inside_floor = ADD(.colour = { 0.25f, 0.17f, 0.1f }, .emission = 0.03f);
	p->curtain =
		ADD(.colour = tone(&s->dice, (vec){ 0.7f, 0.66f, 0.58f }, 0.1f), .emission = 0.22f);
	p->iron = ADD(.colour = { 0.035f, 0.04f, 0.042f }, .gloss = 0.04f, .reflectivity = 0.25f);
	p->steel = ADD(.colour = { 0.4f, 0.41f, 0.42f }, .gloss = 0.3f, .reflectivity = 0.5f);
	p->brass = ADD(.colour = { 0.5f, 0.36f, 0.12f }, .gloss = 0.3f, .reflectivity = 0.5f);
	p->lamp = ADD(.colour = { 0.85f, 0.8f, 0.66f }, .emission = 0.55f, .reflectivity = 0.6f);
	p->terracotta = ADD(.colour = { 0.45f, 0.2f, 0.11f }, .stain_per_m = 3, .stain = 0.15f);
	p->rubber = ADD(.colour = { 0.025f, 0.025f, 0.027f }, .reflectivity = 0.06f);
}

static void choose_ground(struct site *s, struct palette *p)
{
	p->setts = ADD(.colour = tone(&s->dice, (vec){ 0.36f, 0.34f, 0.31f }, 0.1f),
		.joint_colour = { 0.17f, 0.155f, 0.13f }, .cell_u_m = 0.2f, .cell_v_m = 0.14f,
		.bond = 0.5f, .joint_m = 0.018f, .variety = 0.28f, .warmth = 0.06f,
		.grain_per_m = 22, .grain = 0.12f, .stain_per_m = 0.22f, .stain = 0.12f);
	p->flags = ADD(.colour = tone(&s->dice, (vec){ 0.5f, 0.47f, 0.41f }, 0.08f),
		.joint_colour = { 0.24f, 0.22f, 0.18f }, .cell_u_m = 0.9f, .cell_v_m = 0.6f,
		.bond = 0.5f, .joint_m = 0.015f, .variety = 0.14f, .warmth = 0.05f,
		.grain_per_m = 20, .grain = 0.08f, .stain_per_m = 0.3f, .stain = 0.1f);
	p->gravel = ADD(.colour = { 0.52f, 0.45f, 0.34f }, .grain_per_m = 34, .grain = 0.3f,
		.stain_per_m = 0.4f, .stain = 0.1f);
	p->asphalt = ADD(.colour = { 0.14f, 0.14f, 0.145f }, .grain_per_m = 45, .grain = 0.25f,
		.stain_per_m = 0.3f, .stain = 0.14f);
	p->marking = ADD(.colour = { 0.7f, 0.7f, 0.68f }, .stain_per_m = 1.7f, .stain = 0.14f,
		.reflectivity = 0.9f);
	p->kerb = ADD(.colour = { 0.48f, 0.46f, 0.42f }, .joint_colour = { 0.22f, 0.2f, 0.18f },
		.cell_u_m = 1, .cell_v_m = 50, .joint_m = 0.012f, .variety = 0.12f,
		.grain_per_m = 20, .grain = 0.1f);
	p->grass =
		ADD(.colour = tone(&s->dice, (vec){ 0.17f, 0.27f, 0.07f }, 0.1f), .grain_per_m = 26,
			.grain = 0.4f, .stain_per_m = 0.6f, .stain = 0.16f, .reflectivity = 0.55f);
	p->soil = ADD(.colour = { 0.2f, 0.14f, 0.09f }, .grain_per_m = 22, .grain = 0.35f,
		.stain_per_m = 1, .stain = 0.2f);
	p->floor_tiles = ADD(.colour = tone(&s->dice, (vec){ 0.5f, 0.42f, 0.33f }, 0.1f),
		.joint_colour = { 0.2f, 0.17f, 0.14f }, .cell_u_m = 0.6f, .cell_v_m = 0.6f,
		.joint_m = 0.012f, .variety = 0.22f, .warmth = 0.08f, .grain_per_m = 14,
		.grain = 0.06f, .stain_per_m = 0.4f, .stain = 0.06f, .gloss = 0.03f);
	static const vec shops[] = { { 0.13f, 0.26f, 0.22f }, { 0.42f, 0.1f, 0.09f },
		{ 0.12f, 0.17f, 0.3f } };
	for (unsigned i = 0; i < 3; i++)
		p->shop[i] = ADD(.colour = tone(&s->dice, shops[i], 0.15f), .gloss = 0.03f);
}

void palette_choose(struct site *s, struct palette *ret_palette)
{
	choose_walls(s, ret_palette);
	choose_roofs(s, ret_palette);
	choose_fittings(s, ret_palette);
	choose_ground(s, ret_palette);
}

uint16_t palette_cloth(struct site *s, vec colour)
{
	return ADD(.colour = colour, .grain_per_m = 60, .grain = 0.12f, .stain_per_m = 5,
		.stain = 0.05f);
}

uint16_t palette_paint(struct site *s, vec colour)
{
	return ADD(.colour = colour, .gloss = 0.06f, .reflectivity = 0.2f + 0.5f * colour[0]);
}
