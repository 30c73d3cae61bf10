#include "sim/scene-roof.h"

void draw_tiled(const struct pen *p, vec a, vec b, vec c, vec d)
{
	vec up = unit(cross(b - a, mix(c, d, 0.5f) - a));
	if (up[2] < 0)
		up = -up;
	up *= 0.035f;
	unsigned n = (unsigned)MAX(1, lroundf(length(mix(c, d, 0.5f) - mix(a, b, 0.5f)) / 0.33f));
	for (unsigned i = 0; i < n; i++) {
		float t0 = (float)i / n, t1 = (float)(i + 1) / n;
		vec l0 = mix(a, d, t0), r0 = mix(b, c, t0), l1 = mix(a, d, t1), r1 = mix(b, c, t1);
		pen_quad(p, l0 + up, r0 + up, r1, l1);
		pen_quad(p, l0, r0, r0 + up, l0 + up);
	}
}

static void draw_ridge(const struct pen *p, vec a, vec b)
{
	unsigned n = (unsigned)MAX(1, lroundf(length(b - a) / 0.42f));
	for (unsigned i = 0; i < n; i++)
		pen_rod(p, mix(a, b, (i - 0.05f) / n), mix(a, b, (i + 1.05f) / n), 0.1f, 0.125f, 8);
}

static void draw_eaves(const struct pen *p, float x0, float x1, float y, float z)
{
	pen_rod(p, (vec){ x0, y, z }, (vec){ x1, y, z }, 0.07f, 0.07f, 8);
}

static void draw_gable(const struct pen *p, const struct roof *r, float x, float out)
{
	struct pen wall = pen_with(p, r->gable), board = pen_with(p, r->palette->frame_dark);
	vec foot = { x, 0, -0.05f }, far = { x, r->depth, -0.05f },
	    top = { x, 0.5f * r->depth, r->rise - 0.03f };
	pen_triangle(&wall, foot, far, top);
	for (unsigned k = 0; k < 2; k++) {
		vec low = k ? far + (vec){ 0, r->overhang, 0 } : foot - (vec){ 0, r->overhang, 0 };
		low[2] -= r->overhang * r->rise / (0.5f * r->depth);
		low[0] = top[0] = x + out;
		pen_quad(&board, low, top, top - (vec){ 0, 0, 0.22f }, low - (vec){ 0, 0, 0.22f });
	}
}

void draw_roof(const struct pen *p, const struct roof *r)
{
	struct pen q = pen_with(p, r->cover), gutter = pen_with(p, r->palette->steel);
	float over = r->overhang, drop = over * r->rise / (0.5f * r->depth), m = 0.5f * r->depth;
	float x0 = -over, x1 = r->length + over, y0 = -over, y1 = r->depth + over;
	vec left = { r->hip[0] > 0 ? r->hip[0] : x0, m, r->rise };
	vec right = { r->hip[1] > 0 ? r->length - r->hip[1] : x1, m, r->rise };
	vec a = { x0, y0, -drop }, b = { x1, y0, -drop }, c = { x1, y1, -drop },
	    d = { x0, y1, -drop };
	draw_tiled(&q, a, b, right, left);
	draw_tiled(&q, c, d, left, right);
	draw_ridge(&q, left, right);
	for (unsigned k = 0; k < 2; k++) {
		if (r->hip[k] <= 0) {
			draw_gable(p, r, k ? r->length : 0, k ? over : -over);
			continue;
		}
		vec low = k ? b : d, high = k ? c : a, top = k ? right : left;
		draw_tiled(&q, low, high, top, top);
		draw_ridge(&q, low, top);
		draw_ridge(&q, high, top);
		float out = k ? x1 + 0.05f : x0 - 0.05f;
		pen_rod(&gutter, (vec){ out, y0, -drop - 0.03f }, (vec){ out, y1, -drop - 0.03f },
			0.07f, 0.07f, 8);
	}
	draw_eaves(&gutter, x0, x1, y0 - 0.05f, -drop - 0.03f);
	draw_eaves(&gutter, x0, x1, y1 + 0.05f, -drop - 0.03f);
	struct pen under = pen_with(p, r->palette->frame_dark);
	pen_quad(&under, a - (vec){ 0, 0, 0.04f }, b - (vec){ 0, 0, 0.04f }, (vec){ x1, 0, -0.03f },
		(vec){ x0, 0, -0.03f });
}

void draw_dormer(
	struct site *s, const struct pen *p, const struct roof *r, float width, float height)
{
	struct facade f = {
		.palette = r->palette, .trim = r->palette->trim, .frame = r->palette->frame_light
	};
	struct pen wall = pen_with(p, r->gable), cover = pen_with(p, r->cover);
	struct opening o = {
		.x = -0.34f * width, .z = 0.2f, .width = 0.68f * width, .height = height - 0.35f
	};
	float h = 0.5f * width, deep = 3.2f, rise = 0.42f * width, e = 0.16f;
	draw_wall(&wall, -h, h, -0.4f, height, &o, 1);
	draw_opening(s, p, &f, &o);
	pen_triangle(
		&wall, (vec){ -h, 0, height }, (vec){ h, 0, height }, (vec){ 0, 0, height + rise });
	for (int k = -1; k <= 1; k += 2) {
		float x = k * h, out = k * (h + e), low = height - e * rise / h;
		pen_quad(&wall, (vec){ x, 0, -0.4f }, (vec){ x, deep, -0.4f },
			(vec){ x, deep, height }, (vec){ x, 0, height });
		draw_tiled(&cover, (vec){ out, -0.2f, low }, (vec){ out, deep, low },
			(vec){ 0, deep, height + rise }, (vec){ 0, -0.2f, height + rise });
		struct pen trim = pen_with(p, r->palette->trim);
		vec board[] = { { out, 0, low - 0.12f }, { out, 0, low }, { 0, 0, height + rise },
			{ 0, 0, height + rise - 0.14f } };
		pen_prism(&trim, board, 4, -0.22f, -0.16f);
	}
	draw_ridge(&cover, (vec){ 0, -0.2f, height + rise }, (vec){ 0, deep, height + rise });
	struct pen dark = pen_with(p, r->palette->inside);
	pen_quad(&dark, (vec){ -h, 1, 0 }, (vec){ h, 1, 0 }, (vec){ h, 1, height },
		(vec){ -h, 1, height });
}

void draw_chimney(
	const struct pen *p, const struct palette *m, float width, float depth, float height)
{
	static const float pot[][2] = { { 0.13f, 0 }, { 0.15f, 0.05f }, { 0.12f, 0.1f },
		{ 0.1f, 0.4f }, { 0.14f, 0.44f }, { 0.14f, 0.5f }, { 0.09f, 0.5f }, { 0.09f, 0.2f },
		{ 0, 0.2f } };
	struct pen brick = pen_with(p, m->brick[0]), stone = pen_with(p, m->trim_dark);
	float x = 0.5f * width, y = 0.5f * depth;
	pen_box(&brick, (vec){ -x, -y, -2.5f }, (vec){ x, y, height });
	pen_box(&stone, (vec){ -x - 0.05f, -y - 0.05f, height - 0.3f },
		(vec){ x + 0.05f, y + 0.05f, height - 0.2f });
	pen_box(&stone, (vec){ -x - 0.06f, -y - 0.06f, height },
		(vec){ x + 0.06f, y + 0.06f, height + 0.1f });
	unsigned n = (unsigned)MAX(1, lroundf(width / 0.42f));
	for (unsigned i = 0; i < n; i++) {
		struct pen q = pen_at(p, -x + width * (i + 0.5f) / n, 0, height + 0.1f);
		q.material = m->terracotta;
		pen_lathe(&q, pot, G_N_ELEMENTS(pot), 12);
	}
}

void furnish_roof(struct site *s, const struct pen *p, const struct roof *r, unsigned dormers,
	unsigned chimneys)
{
	float slope = r->rise / (0.5f * r->depth), span = r->length - r->hip[0] - r->hip[1];
	for (unsigned i = 0; i < dormers; i++) {
		float x = r->hip[0] + span * (i + 0.5f) / dormers, y = 0.16f * r->depth;
		struct pen q = pen_at(p, x, y, y * slope);
		draw_dormer(s, &q, r, MIN(1.5f, 0.6f * span / dormers), MIN(1.6f, 0.62f * r->rise));
	}
	for (unsigned i = 0; i < chimneys; i++) {
		float x = r->hip[0] + span * (i + roll_in(&s->dice, 0.2f, 0.8f)) / chimneys;
		float y = r->depth * roll_in(&s->dice, 0.46f, 0.6f);
		struct pen q = pen_at(p, x, y, r->rise);
		draw_chimney(&q, r->palette, roll_in(&s->dice, 0.6f, 1.4f), 0.55f,
			roll_in(&s->dice, 0.9f, 1.5f));
	}
}

void draw_spire(const struct pen *p, float half, float rise)
{
	vec top = { 0, 0, rise };
	float e = half + 0.25f;
	vec c[4] = { { -e, -e, -0.1f }, { e, -e, -0.1f }, { e, e, -0.1f }, { -e, e, -0.1f } };
	for (unsigned i = 0; i < 4; i++) {
		draw_tiled(p, c[i], c[(i + 1) % 4], top, top);
		draw_ridge(p, c[i], top);
	}
}
