#include "sim/scene-tree.h"

/* What makes a kind of tree. Lengths in metres for a tree of full size. */
struct habit {
	float trunk_m, trunk_radius_m; /* up to the first limbs */
	float crown_m, crown_radius_m; /* height and half width */
	unsigned limbs;
	float rise;                /* slope of the limbs, -1 hangs, 1 straight up */
	float droop;               /* how twigs hang */
	unsigned clusters, leaves; /* bunches of leaves, and leaves of each */
	float cluster_m, leaf_m, leaf_slim;
	vec leaf, bark;
};

static const struct habit habits[] = {
	[TREE_ROUND] = { 2.8f, 0.2f, 6.2f, 3.3f, 9, 0.55f, 0.1f, 300, 62, 0.5f, 0.15f, 0.36f,
		{ 0.19f, 0.31f, 0.07f }, { 0.14f, 0.11f, 0.08f } },
	[TREE_SPREADING] = { 2.9f, 0.3f, 6.0f, 4.8f, 8, 0.4f, 0.15f, 380, 60, 0.55f, 0.17f, 0.4f,
		{ 0.22f, 0.31f, 0.08f }, { 0.25f, 0.22f, 0.16f } },
	[TREE_COLUMN] = { 2.3f, 0.2f, 10.5f, 1.3f, 16, 1.6f, -0.4f, 260, 52, 0.42f, 0.14f, 0.4f,
		{ 0.19f, 0.31f, 0.09f }, { 0.2f, 0.18f, 0.14f } },
	[TREE_CONIFER] = { 1.2f, 0.19f, 10.5f, 2.4f, 60, -0.15f, 0.15f, 420, 50, 0.4f, 0.17f, 0.1f,
		{ 0.085f, 0.18f, 0.085f }, { 0.13f, 0.09f, 0.07f } },
	[TREE_WILLOW] = { 2.4f, 0.32f, 6.0f, 4.0f, 10, 0.6f, 1.5f, 200, 50, 0.42f, 0.2f, 0.13f,
		{ 0.29f, 0.36f, 0.13f }, { 0.16f, 0.13f, 0.1f } },
	[TREE_BIRCH] = { 3.0f, 0.12f, 7.0f, 2.1f, 12, 0.8f, 0.5f, 240, 48, 0.46f, 0.11f, 0.42f,
		{ 0.29f, 0.38f, 0.10f }, { 0.6f, 0.58f, 0.54f } },
};

/* Half width of the crown at a share of its height, 0..1. */
static float crown_width(enum tree_kind kind, float t)
{
	switch (kind) {
	case TREE_CONIFER: return 1.02f - t;
	case TREE_COLUMN: return 0.55f + 0.6f * t - 1.1f * t * t;
	case TREE_SPREADING: return sqrtf(MAX(0, 1 - powf(fabsf(t - 0.35f) / 0.66f, 2.4f)));
	default: return sqrtf(MAX(0, 1 - powf(fabsf(t - 0.42f) / 0.6f, 2)));
	}
}

static vec roll_direction(struct dice *d)
{
	float z = roll_in(d, -1, 1), a = roll_in(d, 0, 2 * G_PI), level = sqrtf(1 - z * z);
	return (vec){ level * cosf(a), level * sinf(a), z };
}

/* A bunch of leaves round a twig's end. Their shading leans outwards from the crown, so that it
 * reads as a mass. */
static void draw_cluster(
	const struct pen *p, const struct habit *h, struct dice *d, vec at, vec out)
{
	for (unsigned i = 0; i < h->leaves; i++) {
		vec r = roll_direction(d), spot = at + r * (h->cluster_m * cbrtf(roll(d)));
		spot[2] -= h->droop * h->cluster_m * roll(d) * 1.6f;
		vec along = unit(r + out * 0.5f + (vec){ 0, 0, -0.3f - h->droop } +
				 roll_direction(d) * 0.5f);
		vec face = unit((vec){ 0, 0, 1 } + out * 0.5f + roll_direction(d) * 0.7f);
		float size = h->leaf_m * roll_in(d, 0.7f, 1.2f);
		vec across = unit(cross(along, face)) * (size * h->leaf_slim);
		pen_leaf(p, spot, along * size, across, unit(out + r * 0.7f) * 0.8f);
	}
}

/* A limb that bends from a to b, rising first. */
static void draw_limb(const struct pen *p, vec a, vec b, float radius, float sag, struct dice *d)
{
	vec path[5];
	float radii[5];
	for (unsigned i = 0; i < 5; i++) {
		float t = i / 4.0f;
		path[i] = mix(a, b, t) + (vec){ 0, 0, sag * 4 * t * (1 - t) };
		if (i && i < 4)
			path[i] += roll_direction(d) * (0.05f * length(b - a));
		radii[i] = radius * (1 - 0.8f * t);
	}
	pen_tube(p, path, radii, 5, radius > 0.04f ? 7 : 4);
}

static void draw_trunk(const struct pen *p, const struct habit *h, struct dice *d, vec *ret_axis)
{
	enum { N = 8 };
	float radii[N];
	float top = h->trunk_m + h->crown_m * 0.82f;
	vec sway = { 0 };
	for (unsigned i = 0; i < N; i++) {
		float t = (i ? i - 0.6f : -0.1f) / (N - 1.6f);
		sway += roll_direction(d) * (vec){ 0.13f, 0.13f, 0 } * (t > 0 ? 1.0f : 0.0f);
		ret_axis[i] = (vec){ sway[0], sway[1], t * top };
		float flare = t < 0.03f ? 1.55f : t < 0.1f ? 1.12f : 1;
		radii[i] = h->trunk_radius_m * flare * (1 - 0.88f * MAX(t, 0)) + 0.012f;
	}
	pen_tube(p, ret_axis, radii, N, 14);
}

static vec along_axis(const vec *axis, float z)
{
	unsigned i = 1;
	while (i < 7 && axis[i][2] < z)
		i++;
	float t = (z - axis[i - 1][2]) / (axis[i][2] - axis[i - 1][2]);
	return mix(axis[i - 1], axis[i], clamp_unit(t));
}

/* Clusters sit in the outer part of the crown, in lumps; a limb's twig leads to each. */
static vec choose_cluster(
	enum tree_kind kind, const struct habit *h, struct dice *d, vec axis, float t)
{
	float a = roll_in(d, 0, 2 * G_PI);
	uint32_t seed = (uint32_t)d->seed;
	float lump = 0.78f + 0.3f * noise_3d(cosf(a) * 1.7f, sinf(a) * 1.7f, t * 4, seed);
	float r =
		h->crown_radius_m * crown_width(kind, t) * lump * powf(roll_in(d, 0.12f, 1), 0.45f);
	return (vec){ axis[0] + r * cosf(a), axis[1] + r * sinf(a), h->trunk_m + t * h->crown_m };
}

static void draw_crown(struct site *s, const struct pen *wood, const struct pen *leaf,
	enum tree_kind kind, const struct habit *h, const vec *axis)
{
	struct dice *d = &s->dice;
	vec middle = { 0, 0, h->trunk_m + 0.4f * h->crown_m };
	for (unsigned i = 0; i < h->clusters; i++) {
		float t = kind == TREE_CONIFER ? powf(roll(d), 1.5f) : roll_in(d, 0.02f, 1);
		float z = h->trunk_m + t * h->crown_m;
		vec tip = choose_cluster(kind, h, d, along_axis(axis, z), t);
		float level = hypotf(tip[0], tip[1]);
		vec root = along_axis(axis, MAX(h->trunk_m * 0.92f, z - level * h->rise));
		vec out = kind == TREE_CONIFER || kind == TREE_COLUMN
				  ? unit((vec){ tip[0], tip[1], 0.5f })
				  : unit(tip - middle);
		if (i % 3 == 0)
			draw_limb(wood, root, tip, i % 9 ? 0.022f : 0.3f * h->trunk_radius_m,
				0.06f * level, d);
		draw_cluster(leaf, h, d, tip, out);
		if (h->droop > 1) /* strands that hang down in bunches */
			for (float down = 0.7f; tip[2] - down > 1.7f && down < 3.2f; down += 0.75f)
				draw_cluster(
					leaf, h, d, tip - (vec){ 0, 0, down } + out * 0.1f, out);
	}
}

static uint16_t bark_material(struct site *s, vec colour)
{
	return site_material(s, (struct material){ .colour = colour,
					.grain_per_m = 28,
					.grain = 0.45f,
					.grain_stretch = 5,
					.stain_per_m = 2,
					.stain = 0.2f,
					.reflectivity = 0.35f });
}

static uint16_t leaf_material(struct site *s, vec colour)
{
	return site_material(s, (struct material){ .colour = colour,
					.kind = MATERIAL_LEAF,
					.variety = 0.3f,
					.warmth = 0.16f,
					.reflectivity = 0.6f });
}

uint32_t tree_model(struct site *s, enum tree_kind kind)
{
	uint32_t model;
	struct habit h = habits[kind];
	struct pen wood = site_model(s, &model);
	struct dice *d = &s->dice;
	vec axis[8];
	h.crown_m *= roll_in(d, 0.88f, 1.12f);
	h.crown_radius_m *= roll_in(d, 0.9f, 1.12f);
	h.leaf *= (vec){ roll_in(d, 0.85f, 1.25f), roll_in(d, 0.9f, 1.1f), 1 };
	wood.material = bark_material(s, h.bark);
	struct pen leaf = pen_with(&wood, leaf_material(s, h.leaf));
	draw_trunk(&wood, &h, d, axis);
	draw_crown(s, &wood, &leaf, kind, &h, axis);
	return model;
}

uint32_t shrub_model(struct site *s)
{
	uint32_t model;
	struct habit h = { .cluster_m = 0.28f, .leaf_m = 0.09f, .leaf_slim = 0.42f, .leaves = 34 };
	struct pen p = site_model(s, &model);
	p.material = leaf_material(s, (vec){ 0.12f, 0.24f, 0.07f });
	for (unsigned i = 0; i < 80; i++) {
		vec out = roll_direction(&s->dice);
		out[2] = fabsf(out[2]);
		vec at = out * (vec){ 0.8f, 0.8f, 0.85f } * roll_in(&s->dice, 0.75f, 1);
		draw_cluster(&p, &h, &s->dice, at + (vec){ 0, 0, 0.12f }, out);
	}
	return model;
}

uint32_t tuft_model(struct site *s)
{
	uint32_t model;
	struct pen p = site_model(s, &model);
	p.material = leaf_material(s, (vec){ 0.25f, 0.36f, 0.1f });
	for (unsigned i = 0; i < 60; i++) {
		float a = roll_in(&s->dice, 0, 2 * G_PI), r = 0.3f * sqrtf(roll(&s->dice));
		vec out = { cosf(a), sinf(a), 0 };
		vec along = (vec){ 0, 0, roll_in(&s->dice, 0.12f, 0.32f) } +
			    out * roll_in(&s->dice, 0, 0.14f);
		pen_leaf(&p, out * r - (vec){ 0, 0, 0.03f }, along, cross(along, out) * 0.04f,
			(vec){ 0, 0, 1 });
	}
	return model;
}

void plant(struct site *s, uint32_t model, float x, float y, float scale)
{
	struct pen p = site_stand(s, WORLD_VEGETATION, x, y, roll_in(&s->dice, 0, 2 * G_PI));
	struct pen q = pen_scaled(&p, scale);
	q.at.z *= roll_in(&s->dice, 0.92f, 1.08f);
	site_place(s, model, &q);
}
