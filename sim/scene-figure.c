/* People of scene-props.h: rounded bodies in clothes, some in coats or skirts, with hats and bags.
 */
#include "sim/scene-props.h"

struct dress {
	uint16_t skin, hair, top, legs, shoes;
	bool skirt, coat, hat, bag;
};

static const vec clothes[] = { { 0.35f, 0.06f, 0.06f }, { 0.06f, 0.1f, 0.24f },
	{ 0.5f, 0.45f, 0.36f }, { 0.07f, 0.07f, 0.08f }, { 0.12f, 0.25f, 0.16f },
	{ 0.6f, 0.58f, 0.54f }, { 0.5f, 0.3f, 0.08f }, { 0.22f, 0.34f, 0.46f },
	{ 0.42f, 0.16f, 0.22f }, { 0.16f, 0.14f, 0.13f }, { 0.3f, 0.3f, 0.32f },
	{ 0.55f, 0.42f, 0.3f } };

static vec choose_cloth(struct dice *d)
{
	return clothes[roll_int(d, 0, G_N_ELEMENTS(clothes) - 1)] * roll_in(d, 0.8f, 1.2f);
}

static struct dress choose_dress(struct site *s)
{
	struct dice *d = &s->dice;
	static const vec skins[] = { { 0.6f, 0.4f, 0.3f }, { 0.4f, 0.25f, 0.17f },
		{ 0.18f, 0.1f, 0.07f } };
	static const vec hairs[] = { { 0.05f, 0.035f, 0.025f }, { 0.2f, 0.11f, 0.05f },
		{ 0.4f, 0.3f, 0.15f }, { 0.4f, 0.4f, 0.4f } };
	return (struct dress){ palette_cloth(s, skins[roll_int(d, 0, 2)]),
		palette_cloth(s, hairs[roll_int(d, 0, 3)]), palette_cloth(s, choose_cloth(d)),
		palette_cloth(s, choose_cloth(d) * 0.6f),
		palette_cloth(s, (vec){ 0.06f, 0.045f, 0.035f }), roll(d) < 0.3f, roll(d) < 0.35f,
		roll(d) < 0.3f, roll(d) < 0.4f };
}

/* Elliptic rings: height, half width, half depth, how far forward. */
static void draw_rings(const struct pen *p, const float (*ring)[4], unsigned n)
{
	enum { C = 19 };
	g_autofree vec *points = g_new(vec, n * C);
	for (unsigned i = 0; i < n; i++)
		for (unsigned k = 0; k < C; k++) {
			float a = 2 * G_PI * (k % (C - 1)) / (C - 1);
			points[i * C + k] = (vec){ ring[i][1] * cosf(a),
				ring[i][2] * sinf(a) - ring[i][3], ring[i][0] };
		}
	pen_skin(p, points, n, C);
}

static void draw_leg(const struct pen *p, const struct dress *w, vec hip, vec knee, vec ankle)
{
	struct pen cloth = pen_with(p, w->legs), shoe = pen_with(p, w->shoes);
	vec path[] = { hip, mix(hip, knee, 0.5f), knee, mix(knee, ankle, 0.35f), ankle };
	float radii[] = { 0.09f, 0.08f, 0.06f, 0.058f, 0.042f };
	pen_tube(&cloth, path, radii, 5, 10);
	pen_ball(&shoe, ankle + (vec){ 0, -0.06f, -0.035f }, (vec){ 0.045f, 0.13f, 0.05f }, 10);
}

static void draw_arm(const struct pen *p, const struct dress *w, vec shoulder, vec elbow, vec wrist)
{
	struct pen cloth = pen_with(p, w->top), skin = pen_with(p, w->skin);
	vec path[] = { shoulder, mix(shoulder, elbow, 0.4f), elbow, wrist };
	float radii[] = { 0.056f, 0.052f, 0.043f, 0.036f };
	pen_tube(&cloth, path, radii, 4, 9);
	pen_ball(&skin, wrist + unit(wrist - elbow) * 0.06f, (vec){ 0.035f, 0.045f, 0.075f }, 8);
}

static void draw_head(const struct pen *p, const struct dress *w)
{
	struct pen skin = pen_with(p, w->skin), hair = pen_with(p, w->hair),
		   hat = pen_with(p, w->top);
	pen_rod(&skin, (vec){ 0, 0.01f, 1.42f }, (vec){ 0, 0, 1.56f }, 0.055f, 0.052f, 10);
	pen_ball(&skin, (vec){ 0, -0.01f, 1.62f }, (vec){ 0.076f, 0.095f, 0.118f }, 16);
	pen_ball(&skin, (vec){ 0, -0.105f, 1.61f }, (vec){ 0.014f, 0.022f, 0.026f }, 6);
	pen_ball(&hair, (vec){ 0, 0.018f, 1.655f }, (vec){ 0.084f, 0.098f, 0.1f }, 16);
	if (w->skirt)
		pen_ball(&hair, (vec){ 0, 0.06f, 1.56f }, (vec){ 0.08f, 0.06f, 0.13f }, 12);
	if (!w->hat)
		return;
	static const float brim[][2] = { { 0, 1.66f }, { 0.19f, 1.675f }, { 0.19f, 1.69f },
		{ 0.1f, 1.7f }, { 0.095f, 1.77f }, { 0.06f, 1.795f }, { 0, 1.79f } };
	pen_lathe(&hat, brim, G_N_ELEMENTS(brim), 18);
}

static void draw_trunk(const struct pen *p, const struct dress *w, bool sits)
{
	struct pen cloth = pen_with(p, w->top), lower = pen_with(p, w->legs);
	static const float torso[][4] = { { 0.8f, 0.15f, 0.11f, 0 }, { 0.86f, 0.172f, 0.125f, 0 },
		{ 0.95f, 0.168f, 0.12f, 0 }, { 1.06f, 0.15f, 0.108f, 0.01f },
		{ 1.18f, 0.172f, 0.12f, 0.02f }, { 1.3f, 0.195f, 0.122f, 0.015f },
		{ 1.38f, 0.2f, 0.105f, 0 }, { 1.43f, 0.15f, 0.085f, -0.005f },
		{ 1.47f, 0.07f, 0.065f, -0.01f } };
	static const float skirt[][4] = { { 0.48f, 0.26f, 0.22f, 0 }, { 0.7f, 0.215f, 0.17f, 0 },
		{ 0.9f, 0.178f, 0.13f, 0 }, { 1.02f, 0.152f, 0.11f, 0.01f } };
	static const float coat[][4] = { { 0.52f, 0.23f, 0.18f, 0 }, { 0.8f, 0.2f, 0.155f, 0 },
		{ 1, 0.178f, 0.13f, 0 }, { 1.2f, 0.19f, 0.135f, 0.02f },
		{ 1.36f, 0.208f, 0.118f, 0 } };
	draw_rings(&cloth, torso, G_N_ELEMENTS(torso));
	if (!sits && w->skirt)
		draw_rings(&lower, skirt, G_N_ELEMENTS(skirt));
	else if (!sits && w->coat)
		draw_rings(&cloth, coat, G_N_ELEMENTS(coat));
}

static void draw_limbs(const struct pen *p, const struct dress *w, enum pose pose, float swing)
{
	for (int k = -1; k <= 1; k += 2) {
		float x = k * 0.1f, step = pose == POSE_WALK ? k * swing : 0.02f * k;
		vec hip = { x * 0.9f, 0, 0.86f }, knee = { x, -step * 0.9f - 0.02f, 0.49f };
		vec ankle = { x, -step * 1.35f + (step < 0 ? 0.06f : 0),
			step < -0.1f ? 0.14f : 0.085f };
		if (pose == POSE_SIT) {
			knee = (vec){ x * 1.2f, -0.42f, 0.9f };
			ankle = (vec){ x * 1.2f, -0.46f, 0.47f };
		}
		draw_leg(p, w, hip, knee, ankle);
		vec shoulder = { k * 0.2f, 0.01f, 1.375f },
		    elbow = { k * 0.255f, 0.03f + step * 0.6f, 1.1f };
		vec wrist = { k * 0.24f, -0.06f + step * 1.3f, 0.87f };
		if (pose == POSE_SIT || (pose == POSE_STAND && k > 0 && w->bag)) {
			elbow = (vec){ k * 0.25f, 0, 1.12f };
			wrist = (vec){ k * 0.15f, -0.24f, 1.06f };
		}
		draw_arm(p, w, shoulder, elbow, wrist);
	}
}

void draw_person(struct site *s, const struct pen *p, enum pose pose)
{
	struct dress w = choose_dress(s);
	bool child = pose == POSE_WALK && roll(&s->dice) < 0.15f;
	struct pen q = pen_scaled(
		p, child ? roll_in(&s->dice, 0.62f, 0.8f) : roll_in(&s->dice, 0.92f, 1.08f));
	float build = roll_in(&s->dice, 0.9f, 1.18f); /* slim to stout */
	q.at.x *= build;
	q.at.y *= build;
	if (pose == POSE_SIT)
		q = pen_at(&q, 0, 0.08f, -0.36f);
	draw_limbs(&q, &w, pose, roll_in(&s->dice, 0.16f, 0.26f));
	draw_trunk(&q, &w, pose == POSE_SIT);
	draw_head(&q, &w);
	if (!w.bag || pose == POSE_SIT)
		return;
	struct pen bag = pen_with(&q, w.shoes);
	pen_ball(&bag, (vec){ -0.25f, 0.03f, 0.85f }, (vec){ 0.06f, 0.15f, 0.13f }, 12);
	vec strap[] = { { -0.24f, 0.03f, 0.95f }, { -0.17f, 0.13f, 1.25f },
		{ -0.1f, 0.02f, 1.44f } };
	float radii[] = { 0.01f, 0.01f, 0.01f };
	pen_tube(&bag, strap, radii, 3, 5);
}

void add_person(struct site *s, float x, float y, float clockwise_rad, enum pose pose)
{
	struct pen p = site_stand(s, WORLD_PERSON, x, y, clockwise_rad);
	draw_person(s, &p, pose);
}
