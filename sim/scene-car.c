/* Cars of scene-props.h: a lofted body with wheel arches, a glazed cabin on pillars, wheels with
 * spokes. */
#include "sim/scene-props.h"

/* Along x from the tail to the nose; heights above the road. */
struct shape {
	float tail, nose, half_width, axle[2];
	float belt, bonnet, deck; /* heights of the waist, bonnet and boot */
	float cowl, roof_front, roof_back,
		rear; /* x: foot of the windscreen, roof, foot of the back window */
	float roof;
};

static const struct shape shapes[] = {
	[CAR_HATCHBACK] = { -1.85f, 2.0f, 0.84f, { -1.18f, 1.3f }, 0.94f, 0.86f, 0.95f, 0.95f, 0.2f,
		-1.25f, -1.8f, 1.46f },
	[CAR_SALOON] = { -2.25f, 2.2f, 0.87f, { -1.3f, 1.4f }, 0.92f, 0.84f, 0.94f, 0.95f, 0.15f,
		-0.95f, -1.65f, 1.42f },
	[CAR_VAN] = { -2.4f, 2.2f, 0.95f, { -1.4f, 1.45f }, 1.12f, 1.02f, 1.12f, 1.45f, 0.75f,
		-2.3f, -2.38f, 2.0f },
};

#define WHEEL_M 0.31f
#define SILL_M  0.24f

static float body_bottom(const struct shape *c, float x)
{
	float low = SILL_M, r = WHEEL_M + 0.07f;
	for (unsigned k = 0; k < 2; k++) {
		float off = fabsf(x - c->axle[k]);
		if (off < r)
			low = MAX(low, WHEEL_M + sqrtf(r * r - off * off));
	}
	return low;
}

static float body_top(const struct shape *c, float x)
{
	float t = x > c->cowl ? (x - c->cowl) / (c->nose - c->cowl) : 0;
	float u = x < c->rear ? (c->rear - x) / (c->rear - c->tail + 0.01f) : 0;
	float top = c->belt + (c->bonnet - c->belt) * MIN(1, t * 2) +
		    (c->deck - c->belt) * MIN(1, u * 2);
	return top - 0.16f * t * t * t * t - 0.06f * powf(u, 6);
}

enum { SIDE = 7, STATIONS = 73 };

/* Half a cross-section from the sill up over the shoulder to the middle, and the other half
 * mirrored. */
static void body_section(const struct shape *c, float x, bool closed, vec *ret_row)
{
	float end = fabsf(2 * (x - c->tail) / (c->nose - c->tail) - 1), e4 = end * end * end * end;
	float w = c->half_width * (1 - 0.16f * e4 * e4), low = body_bottom(c, x),
	      top = body_top(c, x);
	float y[SIDE] = { 0.95f, 0.99f, 1, 0.985f, 0.94f, 0.82f, 0 };
	float z[SIDE] = { low, MAX(low + 0.02f, 0.36f), MAX(low + 0.04f, 0.6f), top - 0.1f,
		top - 0.03f, top, top + 0.025f };
	for (unsigned i = 0; i < SIDE; i++) {
		float out = closed ? 0 : w * y[i];
		ret_row[i] = (vec){ x, -out, z[i] };
		ret_row[2 * SIDE - 1 - i] = (vec){ x, out, z[i] };
	}
}

static void draw_body(const struct pen *p, const struct shape *c)
{
	enum { C = 2 * SIDE };
	g_autofree vec *points = g_new(vec, STATIONS * C);
	for (unsigned i = 0; i < STATIONS; i++) {
		/* two at each end close it; their sections are squeezed towards the bumpers */
		float t = CLAMP((i - 1.0f) / (STATIONS - 3), 0, 1);
		body_section(c, c->tail + (c->nose - c->tail) * t, i == 0 || i == STATIONS - 1,
			points + i * C);
	}
	pen_skin(p, points, STATIONS, C);
}

static void pillar(const struct pen *p, vec a, vec b)
{
	for (int k = -1; k <= 1; k += 2)
		pen_rod(p, a * (vec){ 1, k, 1 }, b * (vec){ 1, k, 1 }, 0.036f, 0.03f, 6);
}

static void draw_cabin(
	const struct pen *p, const struct pen *glass, const struct shape *c, bool van)
{
	float w = 0.86f * c->half_width, v = (van ? 0.82f : 0.68f) * c->half_width,
	      z = c->belt - 0.02f, r = c->roof;
	vec a = { c->cowl, w, z }, b = { c->roof_front, v, r - 0.04f },
	    d = { c->roof_back, v, r - 0.05f };
	vec e = { c->rear, w, z }, flip = { 1, -1, 1 };
	float middle = van ? 0.1f : 0.5f * (c->roof_front + c->roof_back) + 0.1f;
	vec m0 = { middle, w + 0.005f, z }, m1 = { middle, v + 0.005f, r - 0.04f };
	pen_quad(glass, a, a * flip, b * flip, b);
	vec sill = mix(e, d, van ? 0.45f : 0), head = mix(e, d, van ? 0.88f : 1);
	pen_quad(glass, sill, sill * flip, head * flip, head);
	if (van) { /* doors below the window, a rim over it and a bar between the leaves */
		pen_quad(p, e, e * flip, sill * flip, sill);
		pen_quad(p, head, head * flip, d * flip, d);
		vec middle_of = { 1, 0, 1 };
		pen_rod(p, sill * middle_of, head * middle_of, 0.05f, 0.05f, 6);
	}
	for (unsigned k = 0; k < 2; k++) {
		vec f = k ? flip : (vec){ 1, 1, 1 };
		pen_quad(glass, a * f, m0 * f, m1 * f, b * f);
		pen_quad(van ? p : glass, m0 * f, e * f, d * f, m1 * f);
	}
	pillar(p, a, b);
	pillar(p, e, d);
	pillar(p, m0, m1);
	pillar(p, b, d);
	enum { R = 8, C = 9 };
	vec roof[R * C];
	for (unsigned i = 0; i < R * C; i++) {
		float s = (i / C) / (R - 1.0f), t = 2.0f * (i % C) / (C - 1) - 1;
		roof[i] = mix(b, d, s) * (vec){ 1, t, 1 };
		roof[i][2] += 0.06f * (1 - t * t) * (0.5f + 2 * s * (1 - s));
	}
	pen_skin(p, roof, R, C);
}

static void draw_wheel(
	const struct pen *p, const struct palette *m, float x, float side, float half_width)
{
	struct pen q = pen_at(p, x, side * (half_width - 0.1f), WHEEL_M);
	vec up = q.at.z;
	q.at.z = q.at.y * side;
	q.at.y = up;
	float r = WHEEL_M;
	float tyre[][2] = { { 0, -0.12f }, { r - 0.03f, -0.12f }, { r, -0.08f }, { r, 0.06f },
		{ r - 0.03f, 0.095f }, { 0.21f, 0.1f }, { 0.2f, 0.06f }, { 0, 0.02f } };
	struct pen rubber = pen_with(&q, m->rubber), steel = pen_with(&q, m->steel);
	pen_lathe(&rubber, tyre, G_N_ELEMENTS(tyre), 28);
	for (unsigned i = 0; i < 5; i++) {
		float a = 2 * G_PI * i / 5;
		pen_rod(&steel, (vec){ 0, 0, 0.07f },
			(vec){ 0.2f * cosf(a), 0.2f * sinf(a), 0.075f }, 0.032f, 0.026f, 6);
	}
	static const float rim[][2] = { { 0.185f, 0.05f }, { 0.19f, 0.1f }, { 0.215f, 0.102f },
		{ 0.22f, 0.09f } };
	pen_lathe(&steel, rim, 4, 28);
	pen_ball(&steel, (vec){ 0, 0, 0.07f }, (vec){ 0.05f, 0.05f, 0.035f }, 10);
}

static void draw_seats(const struct pen *p, const struct shape *c)
{
	float floor = 0.3f;
	pen_box(p, (vec){ c->tail + 0.3f, -0.7f, floor },
		(vec){ c->cowl + 0.3f, 0.7f, floor + 0.04f });
	pen_box(p, (vec){ c->cowl - 0.35f, -0.68f, 0.6f }, (vec){ c->cowl, 0.68f, c->belt });
	for (unsigned i = 0; i < 4; i++) {
		float x = i < 2 ? 0.05f : -0.85f, y = i % 2 ? 0.36f : -0.36f;
		pen_box(p, (vec){ x - 0.1f, y - 0.25f, 0.4f }, (vec){ x + 0.4f, y + 0.25f, 0.58f });
		pen_ball(p, (vec){ x - 0.2f, y, 0.85f }, (vec){ 0.12f, 0.25f, 0.36f }, 10);
		pen_ball(p, (vec){ x - 0.25f, y, 1.2f }, (vec){ 0.06f, 0.13f, 0.09f }, 8);
	}
	/* the dark of the cabin under the waist */
	float w = 0.8f * c->half_width;
	pen_box(p, (vec){ c->rear + 0.12f, -w, c->belt - 0.1f },
		(vec){ c->cowl - 0.1f, w, c->belt + 0.035f });
	/* inner arches and floor keep the light from shining through */
	pen_box(p, (vec){ c->tail + 0.12f, -0.62f, 0.22f }, (vec){ c->nose - 0.15f, 0.62f, 0.34f });
}

static void draw_lights(
	struct site *s, const struct pen *p, const struct palette *m, const struct shape *c)
{
	struct pen white = pen_with(p, m->frame_light), dark = pen_with(p, m->rubber);
	struct pen red = pen_with(p, palette_paint(s, (vec){ 0.45f, 0.02f, 0.02f }));
	float w = c->half_width;
	for (int k = -1; k <= 1; k += 2) {
		pen_ball(&white, (vec){ c->nose - 0.06f, k * 0.72f * w, 0.64f },
			(vec){ 0.09f, 0.17f, 0.08f }, 12);
		pen_ball(&red, (vec){ c->tail + 0.05f, k * 0.74f * w, 0.76f },
			(vec){ 0.07f, 0.12f, 0.11f }, 10);
		struct pen body = *p;
		pen_ball(&body, (vec){ c->cowl - 0.2f, k * (w + 0.09f), c->belt + 0.06f },
			(vec){ 0.06f, 0.11f, 0.075f }, 10);
		for (unsigned i = 0; i < 2; i++) { /* door seams and handles */
			float x = i ? -0.75f : 0.3f + 0.0f;
			pen_box(&dark, (vec){ x - 0.28f, k * w * 0.99f - 0.012f, 0.78f },
				(vec){ x - 0.14f, k * w * 0.99f + 0.012f, 0.81f });
		}
		for (unsigned i = 0; i < 3; i++) {
			float x = 0.85f - 0.88f * i;
			pen_rod(&dark, (vec){ x, k * w * 0.992f, 0.3f },
				(vec){ x, k * w * 1.001f, 0.6f }, 0.005f, 0.005f, 4);
			pen_rod(&dark, (vec){ x, k * w * 1.001f, 0.6f },
				(vec){ x, k * w * 0.986f, c->belt - 0.1f }, 0.005f, 0.005f, 4);
		}
	}
	pen_box(&dark, (vec){ c->nose - 0.1f, -0.4f, 0.42f },
		(vec){ c->nose + 0.015f, 0.4f, 0.54f });
	pen_box(&white, (vec){ c->nose - 0.1f, -0.26f, 0.33f },
		(vec){ c->nose + 0.02f, 0.26f, 0.42f });
	pen_box(&white, (vec){ c->tail - 0.02f, -0.26f, 0.52f },
		(vec){ c->tail + 0.1f, 0.26f, 0.62f });
	pen_box(&dark, (vec){ c->tail - 0.04f, -0.72f * w, 0.3f },
		(vec){ c->tail + 0.2f, 0.72f * w, 0.42f });
	pen_box(&dark, (vec){ c->nose - 0.2f, -0.7f * w, 0.24f },
		(vec){ c->nose + 0.02f, 0.7f * w, 0.32f });
}

void draw_car(struct site *s, const struct pen *p, const struct palette *m, enum car_kind kind)
{
	static const vec paints[] = { { 0.36f, 0.03f, 0.03f }, { 0.05f, 0.1f, 0.25f },
		{ 0.55f, 0.56f, 0.57f }, { 0.06f, 0.06f, 0.065f }, { 0.7f, 0.69f, 0.66f },
		{ 0.1f, 0.2f, 0.14f }, { 0.3f, 0.42f, 0.46f } };
	const struct shape *c = &shapes[kind];
	vec colour = paints[roll_int(&s->dice, 0, G_N_ELEMENTS(paints) - 1)];
	struct pen body = pen_with(p, palette_paint(s, colour)), glass = pen_with(p, m->glass);
	struct pen seat = pen_with(p, palette_cloth(s, (vec){ 0.06f, 0.06f, 0.065f }));
	draw_body(&body, c);
	draw_cabin(&body, &glass, c, kind == CAR_VAN);
	draw_seats(&seat, c);
	draw_lights(s, &body, m, c);
	for (unsigned i = 0; i < 4; i++)
		draw_wheel(p, m, c->axle[i / 2], i % 2 ? 1 : -1, c->half_width);
}

void add_car(struct site *s, const struct palette *m, float x, float y, float clockwise_rad)
{
	struct pen p = site_stand(s, WORLD_VEHICLE, x, y, clockwise_rad);
	draw_car(s, &p, m, (enum car_kind)roll_int(&s->dice, 0, 2));
}
