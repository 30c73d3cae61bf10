#include "sim/scene-props.h"

void draw_lamp_post(const struct pen *p, const struct palette *m, float height)
{
	struct pen iron = pen_with(p, m->iron), bulb = pen_with(p, m->lamp),
		   pane = pen_with(p, m->glass);
	float h = height - 0.75f;
	float post[][2] = { { 0.2f, -0.2f }, { 0.2f, 0.08f }, { 0.16f, 0.12f }, { 0.14f, 0.5f },
		{ 0.16f, 0.55f }, { 0.09f, 0.65f }, { 0.07f, 1.1f }, { 0.085f, 1.13f },
		{ 0.06f, 1.18f }, { 0.042f, h - 0.2f }, { 0.07f, h - 0.16f }, { 0.04f, h - 0.1f },
		{ 0.04f, h - 0.03f }, { 0.11f, h }, { 0, h } };
	static const float cap[][2] = { { 0.27f, 0.52f }, { 0.2f, 0.6f }, { 0.1f, 0.66f },
		{ 0.05f, 0.74f }, { 0.03f, 0.8f }, { 0, 0.86f } };
	pen_lathe(&iron, post, G_N_ELEMENTS(post), 14);
	struct pen top = pen_at(&iron, 0, 0, h);
	pen_lathe(&top, cap, G_N_ELEMENTS(cap), 12);
	pen_rod(&top, (vec){ -0.3f, 0, -0.12f }, (vec){ 0.3f, 0, -0.12f }, 0.014f, 0.014f, 6);
	pen_ball(&bulb, (vec){ 0, 0, h + 0.26f }, (vec){ 0.09f, 0.09f, 0.14f }, 10);
	for (unsigned i = 0; i < 6; i++) {
		float a = i * G_PI / 3, b = a + G_PI / 3;
		vec low = { 0.12f * cosf(a), 0.12f * sinf(a), h },
		    next = { 0.12f * cosf(b), 0.12f * sinf(b), h };
		vec up = { 0.24f * cosf(a), 0.24f * sinf(a), h + 0.53f };
		vec beyond = { 0.24f * cosf(b), 0.24f * sinf(b), h + 0.53f };
		pen_rod(&iron, low, up, 0.012f, 0.012f, 4);
		pen_quad(&pane, low, next, beyond, up);
	}
}

void draw_lantern(const struct pen *p, const struct palette *m)
{
	struct pen iron = pen_with(p, m->iron), bulb = pen_with(p, m->lamp);
	vec arm[] = { { 0, 0, 0.3f }, { 0, -0.2f, 0.5f }, { 0, -0.45f, 0.52f },
		{ 0, -0.5f, 0.38f } };
	float radii[] = { 0.018f, 0.018f, 0.016f, 0.014f };
	pen_tube(&iron, arm, radii, 4, 6);
	pen_box(&iron, (vec){ -0.06f, -0.02f, 0.15f }, (vec){ 0.06f, 0.02f, 0.45f });
	static const float cap[][2] = { { 0.16f, 0.2f }, { 0.05f, 0.34f }, { 0, 0.4f } };
	static const float foot[][2] = { { 0, -0.2f }, { 0.08f, -0.17f }, { 0.1f, -0.14f },
		{ 0, -0.14f } };
	struct pen q = pen_at(&iron, 0, -0.5f, 0);
	pen_lathe(&q, cap, 3, 6);
	pen_lathe(&q, foot, 4, 6);
	for (unsigned i = 0; i < 6; i++) {
		float a = i * G_PI / 3;
		pen_rod(&q, (vec){ 0.09f * cosf(a), 0.09f * sinf(a), -0.15f },
			(vec){ 0.14f * cosf(a), 0.14f * sinf(a), 0.21f }, 0.008f, 0.008f, 4);
	}
	pen_ball(&bulb, (vec){ 0, -0.5f, 0.02f }, (vec){ 0.06f, 0.06f, 0.1f }, 8);
}

void draw_bench(const struct pen *p, const struct palette *m)
{
	struct pen wood = pen_with(p, m->wood), iron = pen_with(p, m->iron);
	float half = 0.9f;
	for (unsigned i = 0; i < 5; i++) {
		float y = -0.24f + 0.095f * i;
		pen_box(&wood, (vec){ -half, y, 0.42f }, (vec){ half, y + 0.075f, 0.45f });
	}
	for (unsigned i = 0; i < 4; i++) {
		float z = 0.52f + 0.1f * i, y = 0.24f + 0.025f * i;
		pen_box(&wood, (vec){ -half, y, z }, (vec){ half, y + 0.03f, z + 0.075f });
	}
	for (int k = -1; k <= 1; k++) {
		float x = k * (half - 0.15f);
		vec back[] = { { x, 0.2f, -0.05f }, { x, 0.22f, 0.4f }, { x, 0.36f, 0.92f } };
		vec front[] = { { x, -0.26f, -0.05f }, { x, -0.2f, 0.4f }, { x, 0.22f, 0.4f } };
		vec arm[] = { { x, -0.2f, 0.4f }, { x, -0.24f, 0.62f }, { x, 0.0f, 0.66f },
			{ x, 0.28f, 0.64f } };
		float radii[] = { 0.022f, 0.022f, 0.022f, 0.022f };
		pen_tube(&iron, back, radii, 3, 6);
		pen_tube(&iron, front, radii, 3, 6);
		if (k)
			pen_tube(&iron, arm, radii, 4, 6);
	}
}

void draw_bollard(const struct pen *p, const struct palette *m)
{
	static const float profile[][2] = { { 0.14f, -0.1f }, { 0.14f, 0.08f }, { 0.1f, 0.12f },
		{ 0.09f, 0.7f }, { 0.12f, 0.73f }, { 0.12f, 0.78f }, { 0.08f, 0.8f },
		{ 0.1f, 0.86f }, { 0.09f, 0.93f }, { 0.05f, 0.97f }, { 0, 0.98f } };
	struct pen iron = pen_with(p, m->iron);
	pen_lathe(&iron, profile, G_N_ELEMENTS(profile), 14);
}

void draw_fountain(const struct pen *p, const struct palette *m, float radius)
{
	struct pen stone = pen_with(p, m->trim), water = pen_with(p, m->water);
	float r = radius;
	float basin[][2] = { { r + 0.35f, -0.2f }, { r + 0.35f, 0.12f }, { r + 0.08f, 0.12f },
		{ r + 0.08f, 0.2f }, { r + 0.02f, 0.26f }, { r + 0.02f, 0.5f },
		{ r + 0.12f, 0.56f }, { r + 0.12f, 0.64f }, { r - 0.16f, 0.64f },
		{ r - 0.16f, 0.1f }, { 0, 0.1f } };
	float k = 0.36f * r;
	float stem[][2] = { { 0.42f, 0.1f }, { 0.42f, 0.5f }, { 0.3f, 0.56f }, { 0.2f, 0.8f },
		{ 0.26f, 0.95f }, { 0.17f, 1.05f }, { 0.17f, 1.25f }, { k, 1.45f },
		{ k + 0.05f, 1.52f }, { k + 0.05f, 1.57f }, { k - 0.06f, 1.57f }, { 0.18f, 1.46f },
		{ 0.14f, 1.6f }, { 0.1f, 1.9f }, { 0.16f, 2.0f }, { 0.3f, 2.1f }, { 0.32f, 2.16f },
		{ 0.1f, 2.14f }, { 0.07f, 2.3f }, { 0.12f, 2.4f }, { 0, 2.5f } };
	pen_lathe(&stone, basin, G_N_ELEMENTS(basin), 48);
	pen_lathe(&stone, stem, G_N_ELEMENTS(stem), 24);
	for (unsigned i = 0; i < 48; i++) {
		float a = 2 * G_PI * i / 48, b = 2 * G_PI * (i + 1) / 48, w = r - 0.1f;
		pen_triangle(&water, (vec){ 0, 0, 0.5f }, (vec){ w * cosf(a), w * sinf(a), 0.5f },
			(vec){ w * cosf(b), w * sinf(b), 0.5f });
	}
}

void draw_well(const struct pen *p, const struct palette *m)
{
	static const float ring[][2] = { { 1, -0.2f }, { 1, 0.72f }, { 1.08f, 0.76f },
		{ 1.08f, 0.9f }, { 0.72f, 0.9f }, { 0.72f, -1 }, { 0, -1 } };
	struct pen stone = pen_with(p, m->rubble), iron = pen_with(p, m->iron),
		   wood = pen_with(p, m->wood);
	pen_lathe(&stone, ring, G_N_ELEMENTS(ring), 32);
	for (int k = -1; k <= 1; k += 2)
		pen_rod(&iron, (vec){ k * 0.9f, 0, 0.85f }, (vec){ k * 0.9f, 0, 2.2f }, 0.035f,
			0.03f, 8);
	vec arch[9];
	float radii[9];
	for (unsigned i = 0; i < 9; i++) {
		float a = G_PI * i / 8;
		arch[i] = (vec){ 0.9f * cosf(a), 0, 2.2f + 0.6f * sinf(a) };
		radii[i] = 0.03f;
	}
	pen_tube(&iron, arch, radii, 9, 8);
	pen_rod(&wood, (vec){ -0.9f, 0, 1.75f }, (vec){ 0.9f, 0, 1.75f }, 0.07f, 0.07f, 10);
	pen_rod(&iron, (vec){ 0.1f, 0, 1.75f }, (vec){ 0.1f, 0, 1.15f }, 0.012f, 0.012f, 5);
	static const float bucket[][2] = { { 0, 0.88f }, { 0.12f, 0.88f }, { 0.16f, 1.15f },
		{ 0.14f, 1.15f }, { 0.1f, 0.92f } };
	struct pen pail = pen_at(&wood, 0.1f, 0, 0);
	pen_lathe(&pail, bucket, G_N_ELEMENTS(bucket), 14);
	pen_ball(&iron, (vec){ 0, 0, 2.88f }, (vec){ 0.08f, 0.08f, 0.1f }, 8);
}

void draw_urn(const struct pen *p, float height)
{
	float h = height;
	float profile[][2] = { { 0.3f * h, -0.05f }, { 0.3f * h, 0.1f * h },
		{ 0.14f * h, 0.18f * h }, { 0.11f * h, 0.28f * h }, { 0.3f * h, 0.42f * h },
		{ 0.38f * h, 0.65f * h }, { 0.36f * h, 0.8f * h }, { 0.44f * h, 0.94f * h },
		{ 0.44f * h, h }, { 0.36f * h, h }, { 0.32f * h, 0.88f * h }, { 0, 0.88f * h } };
	pen_lathe(p, profile, G_N_ELEMENTS(profile), 20);
}

void draw_table(const struct pen *p, const struct palette *m, float radius)
{
	struct pen top = pen_with(p, m->wood), iron = pen_with(p, m->iron);
	float r = radius;
	float disc[][2] = { { 0, 0.7f }, { r, 0.7f }, { r + 0.01f, 0.72f }, { r, 0.74f },
		{ 0, 0.74f } };
	static const float foot[][2] = { { 0.26f, 0 }, { 0.24f, 0.03f }, { 0.05f, 0.06f },
		{ 0.035f, 0.1f }, { 0.035f, 0.62f }, { 0.12f, 0.7f } };
	pen_lathe(&top, disc, G_N_ELEMENTS(disc), 26);
	pen_lathe(&iron, foot, G_N_ELEMENTS(foot), 12);
}

void draw_chair(const struct pen *p, const struct palette *m)
{
	struct pen wood = pen_with(p, m->wood);
	static const float seat[][2] = { { 0, 0.44f }, { 0.2f, 0.44f }, { 0.205f, 0.455f },
		{ 0.2f, 0.47f }, { 0, 0.47f } };
	pen_lathe(&wood, seat, G_N_ELEMENTS(seat), 16);
	for (int i = -1; i <= 1; i += 2) {
		vec back[] = { { i * 0.19f, 0.24f, 0 }, { i * 0.17f, 0.17f, 0.45f },
			{ i * 0.15f, 0.24f, 0.9f } };
		float radii[] = { 0.017f, 0.018f, 0.015f };
		pen_tube(&wood, back, radii, 3, 6);
		pen_rod(&wood, (vec){ i * 0.18f, -0.18f, 0 }, (vec){ i * 0.14f, -0.14f, 0.45f },
			0.016f, 0.018f, 6);
		pen_rod(&wood, (vec){ i * 0.18f, -0.18f, 0.2f }, (vec){ i * 0.18f, 0.22f, 0.2f },
			0.01f, 0.01f, 5);
	}
	for (unsigned k = 0; k < 3; k++)
		pen_rod(&wood, (vec){ -0.16f, 0.2f + 0.02f * k, 0.6f + 0.13f * k },
			(vec){ 0.16f, 0.2f + 0.02f * k, 0.6f + 0.13f * k }, 0.014f, 0.014f, 6);
}

void draw_parasol(const struct pen *p, const struct palette *m, uint16_t cloth)
{
	struct pen wood = pen_with(p, m->wood), top = pen_with(p, cloth),
		   white = pen_with(p, m->curtain);
	pen_rod(&wood, (vec){ 0, 0, 0 }, (vec){ 0, 0, 2.75f }, 0.025f, 0.025f, 8);
	vec peak = { 0, 0, 2.72f };
	for (unsigned i = 0; i < 8; i++) {
		float a = i * G_PI / 4, b = a + G_PI / 4, r = 1.5f;
		vec l = { r * cosf(a), r * sinf(a), 2.28f },
		    n = { r * cosf(b), r * sinf(b), 2.28f };
		const struct pen *q = i % 2 ? &white : &top;
		pen_triangle(q, peak, l, n);
		pen_quad(q, l, n, n - (vec){ 0, 0, 0.16f }, l - (vec){ 0, 0, 0.16f });
		pen_rod(&wood, (vec){ 0, 0, 2.1f }, mix(peak, l, 0.6f), 0.01f, 0.01f, 4);
	}
}

static void draw_ring(const struct pen *p, vec centre, float radius, float thick)
{
	vec path[25];
	float radii[25];
	for (unsigned i = 0; i < 25; i++) {
		float a = 2 * G_PI * i / 24;
		path[i] = centre + (vec){ radius * cosf(a), 0, radius * sinf(a) };
		radii[i] = thick;
	}
	pen_tube(p, path, radii, 25, 6);
}

void draw_bicycle(const struct pen *p, const struct palette *m)
{
	struct pen tyre = pen_with(p, m->rubber), frame = pen_with(p, m->shop[1]),
		   steel = pen_with(p, m->steel);
	vec hub[2] = { { -0.52f, 0, 0.34f }, { 0.52f, 0, 0.34f } };
	vec seat = { -0.22f, 0, 0.88f }, pedal = { -0.08f, 0, 0.3f }, head = { 0.36f, 0, 0.84f };
	for (unsigned k = 0; k < 2; k++) {
		draw_ring(&tyre, hub[k], 0.32f, 0.018f);
		for (unsigned i = 0; i < 12; i++) {
			float a = i * G_PI / 6;
			pen_rod(&steel, hub[k],
				hub[k] + (vec){ 0.31f * cosf(a), 0, 0.31f * sinf(a) }, 0.003f,
				0.003f, 3);
		}
	}
	vec bars[][2] = { { hub[0], pedal }, { hub[0], seat }, { pedal, seat }, { pedal, head },
		{ seat - (vec){ 0, 0, 0.06f }, head },
		{ head + (vec){ -0.03f, 0, 0.1f }, hub[1] } };
	for (unsigned i = 0; i < G_N_ELEMENTS(bars); i++)
		pen_rod(&frame, bars[i][0], bars[i][1], 0.016f, 0.016f, 6);
	pen_rod(&steel, head + (vec){ -0.03f, -0.26f, 0.15f }, head + (vec){ -0.03f, 0.26f, 0.15f },
		0.012f, 0.012f, 6);
	pen_ball(&tyre, seat + (vec){ 0, 0, 0.05f }, (vec){ 0.13f, 0.07f, 0.03f }, 10);
	draw_ring(&steel, pedal, 0.09f, 0.008f);
}

void draw_sign(const struct pen *p, const struct palette *m, uint16_t face, bool round)
{
	struct pen post = pen_with(p, m->steel), plate = pen_with(p, face),
		   rim = pen_with(p, m->frame_light);
	pen_rod(&post, (vec){ 0, 0, -0.2f }, (vec){ 0, 0, 2.75f }, 0.03f, 0.03f, 8);
	if (!round) {
		pen_box(&rim, (vec){ -0.31f, -0.05f, 2.14f }, (vec){ 0.31f, -0.03f, 2.76f });
		pen_box(&plate, (vec){ -0.27f, -0.056f, 2.18f }, (vec){ 0.27f, -0.045f, 2.72f });
		return;
	}
	struct pen flat = pen_at(&plate, 0, -0.045f, 2.45f);
	flat.at.z = flat.at.y;
	flat.at.y = -(vec){ 0, 0, 1 };
	static const float disc[][2] = { { 0, -0.01f }, { 0.32f, -0.01f }, { 0.32f, 0.01f },
		{ 0, 0.01f } };
	static const float inner[][2] = { { 0, -0.014f }, { 0.24f, -0.014f }, { 0.24f, 0 } };
	pen_lathe(&flat, disc, 4, 24);
	flat.material = m->frame_light;
	pen_lathe(&flat, inner, 3, 24);
}
