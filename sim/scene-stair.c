/* The outside stair of scene-facade.h: a flight along a wall up to a landing that stands on an
 * arch, with a balustrade of stone. */
#include "sim/scene-facade.h"

#define TREAD_M  0.29f
#define STRING_M 0.12f /* how far the slope under the balusters stands over the steps' edges */
#define RAIL_M   0.62f /* from there to the rail */
#define HALF_M   0.13f /* half the thickness of the balustrade */

struct stair {
	struct pen stone, trim;
	float foot, base, rise, width;
	unsigned steps;
};

/* Height of the steps' edges, `along` from the foot. */
static float edge_line(const struct stair *t, float along)
{
	return t->base + t->rise * (along / TREAD_M + 0.5f);
}

static void draw_flight(const struct stair *t)
{
	for (unsigned i = 0; i + 1 < t->steps; i++) {
		float x = t->foot - TREAD_M * (i + 1), z = t->base + t->rise * (i + 1);
		pen_box(&t->stone, (vec){ x, -t->width, -1.2f },
			(vec){ x + TREAD_M, 0, z - 0.05f });
		pen_box(&t->trim, (vec){ x, -t->width, z - 0.05f },
			(vec){ x + TREAD_M + 0.025f, 0, z });
	}
	float run = TREAD_M * (t->steps - 1), top = STRING_M;
	vec side[] = { { t->foot - run, 0, -1.2f }, { t->foot, 0, -1.2f },
		{ t->foot, 0, edge_line(t, 0) + top },
		{ t->foot - run, 0, edge_line(t, run) + top } };
	pen_prism(&t->stone, side, 4, -t->width - HALF_M, -t->width + HALF_M);
	vec coping[] = { side[3], side[2], side[2] + (vec){ 0, 0, 0.06f },
		side[3] + (vec){ 0, 0, 0.06f } };
	pen_prism(&t->trim, coping, 4, -t->width - HALF_M - 0.03f, -t->width + HALF_M + 0.03f);
	vec lift = { 0, 0, RAIL_M + 0.06f }, thick = { 0, 0, 0.12f };
	vec rail[] = { side[3] + lift, side[2] + lift, side[2] + lift + thick,
		side[3] + lift + thick };
	pen_prism(&t->trim, rail, 4, -t->width - HALF_M, -t->width + HALF_M);
}

static void draw_baluster(const struct pen *p, float x, float y, float z)
{
	static const float profile[][2] = { { 0.06f, -0.06f }, { 0.06f, 0.04f }, { 0.03f, 0.06f },
		{ 0.045f, 0.12f }, { 0.068f, 0.2f }, { 0.055f, 0.29f }, { 0.03f, 0.42f },
		{ 0.03f, 0.52f }, { 0.05f, 0.55f }, { 0.055f, RAIL_M + 0.06f } };
	struct pen q = pen_at(p, x, y, z);
	pen_lathe(&q, profile, G_N_ELEMENTS(profile), 10);
}

static void draw_newel(const struct stair *t, float x, float y, float low, float high, bool ball)
{
	float r = HALF_M + 0.04f;
	pen_box(&t->trim, (vec){ x - r, y - r, low }, (vec){ x + r, y + r, high });
	r += 0.05f;
	pen_box(&t->trim, (vec){ x - r, y - r, high }, (vec){ x + r, y + r, high + 0.08f });
	if (ball)
		pen_ball(&t->trim, (vec){ x, y, high + 0.26f }, (vec){ 0.18f, 0.18f, 0.19f }, 20);
}

/* A level piece of the balustrade, in a pen whose x runs along it and whose z = 0 is the floor. */
static void draw_balustrade(const struct pen *p, float x0, float x1)
{
	unsigned n = (unsigned)MAX(1, lroundf((x1 - x0) / 0.25f));
	float low = STRING_M + 0.06f, high = low + RAIL_M;
	pen_box(p, (vec){ x0, -HALF_M, 0 }, (vec){ x1, HALF_M, low });
	pen_box(p, (vec){ x0, -HALF_M, high }, (vec){ x1, HALF_M, high + 0.12f });
	for (unsigned i = 0; i < n; i++)
		draw_baluster(p, x0 + (x1 - x0) * (i + 0.5f) / n, 0, low);
}

/* The landing from x0 to x1: a vault with a slab on it. */
static void draw_landing(const struct stair *t, float x0, float x1, float top)
{
	float w = t->width + HALF_M, r = 0.5f * (x1 - x0) - 0.32f, m = 0.5f * (x0 + x1);
	struct opening arch = { m - r, -1.2f, 2 * r, 0.72f * top + 1.2f, true, false };
	float spring = 0.72f * top - r;
	struct pen front = pen_at(&t->stone, 0, -w, 0);
	draw_wall(&front, x0, x1, -1.2f, top - 0.1f, &arch, 1);
	draw_arc(&front, m, spring, r, r + 0.01f, 0.001f, w, 0, (float)G_PI, 20);
	struct pen ring = pen_at(&t->trim, 0, -w, 0);
	draw_voussoirs(&ring, m, spring, r, r + 0.26f, -0.04f, 0.02f, 11);
	for (unsigned k = 0; k < 4; k++) {
		float x = k == 0 ? x0 : k == 1 ? x1 : k == 2 ? m - r : m + r;
		float high = k < 2 ? top - 0.1f : spring;
		pen_quad(&t->stone, (vec){ x, -w, -1.2f }, (vec){ x, 0, -1.2f },
			(vec){ x, 0, high }, (vec){ x, -w, high });
	}
	pen_box(&t->trim, (vec){ x0 - 0.05f, -w - 0.05f, top - 0.12f }, (vec){ x1, 0, top });
	float y = -t->width, low = top - 0.1f, high = top + STRING_M + RAIL_M + 0.24f;
	draw_newel(t, x0 + HALF_M, y, low, high, true);
	draw_newel(t, x1 - HALF_M, y, low, high, true);
	struct pen level = pen_at(&t->trim, 0, y, top), end = pen_at(&t->trim, x0 + HALF_M, 0, top);
	draw_balustrade(&level, x0 + 2 * HALF_M, x1 - 2 * HALF_M);
	end = pen_turned(&end, 0, 0, 0, (float)G_PI / 2);
	draw_balustrade(&end, 0, t->width - HALF_M);
}

void draw_outside_stair(struct site *s, const struct pen *p, const struct palette *m, float x,
	float landing, float top, float width)
{
	struct stair t = { pen_with(p, m->rubble), pen_with(p, m->trim), .width = width };
	t.steps = (unsigned)lroundf((top + 0.2f) / 0.17f);
	t.foot = x + landing + TREAD_M * (t.steps - 1);
	vec foot = frame_point(&p->at, (vec){ t.foot, -0.5f * width, 0 });
	t.base = site_ground(s, foot[0], foot[1]) - p->at.o[2];
	t.rise = (top - t.base) / t.steps;
	draw_flight(&t);
	for (unsigned i = 1; i + 2 < t.steps; i++) {
		float along = TREAD_M * (i + 0.5f);
		draw_baluster(
			&t.trim, t.foot - along, -width, edge_line(&t, along) + STRING_M + 0.06f);
	}
	draw_newel(&t, t.foot - 0.14f, -width, -1.2f, edge_line(&t, 0) + RAIL_M + 0.42f, true);
	draw_landing(&t, x, x + landing, top);
	for (float at = x; at < t.foot + 1.5f; at += 0.8f) {
		vec clear = frame_point(&p->at, (vec){ at, -0.5f * width, 0 });
		site_claim(s, clear[0], clear[1], 0.5f * width + 0.35f);
	}
}
