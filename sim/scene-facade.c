#include "sim/scene-facade.h"

#define REVEAL_M 0.2f

static float arch_spring(const struct opening *o)
{
	return o->z + o->height - (o->arched ? 0.5f * o->width : 0);
}

/* What is left of a band above an arch, as strips down to the curve. */
static void fill_over_arch(const struct pen *p, const struct opening *o, float top)
{
	enum { N = 16 };
	float r = 0.5f * o->width, x = o->x + r, z = arch_spring(o);
	for (unsigned i = 0; i < N; i++) {
		float a = G_PI * i / N, b = G_PI * (i + 1) / N;
		float xa = x - r * cosf(a), xb = x - r * cosf(b);
		float za = z + r * sinf(a), zb = z + r * sinf(b);
		pen_quad(p, (vec){ xa, 0, za }, (vec){ xb, 0, zb }, (vec){ xb, 0, top },
			(vec){ xa, 0, top });
	}
}

static void wall_piece(const struct pen *p, float x0, float x1, float z0, float z1)
{
	if (x1 - x0 > 1e-4f && z1 - z0 > 1e-4f)
		pen_quad(p, (vec){ x0, 0, z0 }, (vec){ x1, 0, z0 }, (vec){ x1, 0, z1 },
			(vec){ x0, 0, z1 });
}

void draw_wall(const struct pen *p, float x0, float x1, float z0, float z1,
	const struct opening *openings, unsigned n)
{
	float x = x0;
	for (unsigned i = 0; i < n; i++) {
		const struct opening *o = &openings[i];
		wall_piece(p, x, o->x, z0, z1);
		wall_piece(p, o->x, o->x + o->width, z0, o->z);
		if (o->arched)
			fill_over_arch(p, o, z1);
		else
			wall_piece(p, o->x, o->x + o->width, o->z + o->height, z1);
		x = o->x + o->width;
	}
	wall_piece(p, x, x1, z0, z1);
}

static vec on_arc(float x, float z, float r, float y, float angle)
{
	return (vec){ x + r * cosf(angle), y, z + r * sinf(angle) };
}

void draw_arc(const struct pen *p, float x, float z, float inner, float outer, float y0, float y1,
	float a0, float a1, unsigned n)
{
	for (unsigned i = 0; i < n; i++) {
		float a = a0 + (a1 - a0) * i / n, b = a0 + (a1 - a0) * (i + 1) / n;
		pen_quad(p, on_arc(x, z, inner, y0, a), on_arc(x, z, inner, y0, b),
			on_arc(x, z, outer, y0, b), on_arc(x, z, outer, y0, a));
		pen_quad(p, on_arc(x, z, inner, y0, a), on_arc(x, z, inner, y0, b),
			on_arc(x, z, inner, y1, b), on_arc(x, z, inner, y1, a));
		pen_quad(p, on_arc(x, z, outer, y0, a), on_arc(x, z, outer, y0, b),
			on_arc(x, z, outer, y1, b), on_arc(x, z, outer, y1, a));
	}
}

void draw_voussoirs(const struct pen *p, float x, float z, float inner, float outer, float y0,
	float y1, unsigned n)
{
	for (unsigned i = 0; i < n; i++) {
		float a = G_PI * i / n, b = G_PI * (i + 1) / n, gap = 0.006f / inner;
		bool key = n % 2 && i == n / 2;
		float out = key ? 0.05f : i % 2 ? 0.012f : 0;
		draw_arc(p, x, z, inner, outer + (key ? 0.12f : 0), y0 - out, y1, a + gap, b - gap,
			2);
		for (unsigned k = 0; k < 2; k++) {
			float e = k ? b - gap : a + gap;
			pen_quad(p, on_arc(x, z, inner, y0 - out, e),
				on_arc(x, z, outer, y0 - out, e), on_arc(x, z, outer, y1, e),
				on_arc(x, z, inner, y1, e));
		}
	}
}

static void draw_reveals(const struct pen *p, const struct opening *o)
{
	float x0 = o->x, x1 = o->x + o->width, z0 = o->z, z1 = arch_spring(o), y = REVEAL_M + 0.1f;
	for (unsigned k = 0; k < 2; k++) {
		float x = k ? x1 : x0;
		pen_quad(p, (vec){ x, 0, z0 }, (vec){ x, y, z0 }, (vec){ x, y, z1 },
			(vec){ x, 0, z1 });
	}
	pen_quad(p, (vec){ x0, 0, z0 }, (vec){ x1, 0, z0 }, (vec){ x1, y, z0 }, (vec){ x0, y, z0 });
	if (o->arched) {
		float r = 0.5f * o->width;
		draw_arc(p, x0 + r, z1, r, r + 0.01f, 0.002f, y, 0, G_PI, 16);
	} else {
		pen_quad(p, (vec){ x0, 0, z1 }, (vec){ x1, 0, z1 }, (vec){ x1, y, z1 },
			(vec){ x0, y, z1 });
	}
}

static void bar(const struct pen *p, float x0, float x1, float z0, float z1, float deep)
{
	pen_box(p, (vec){ x0, REVEAL_M - deep, z0 }, (vec){ x1, REVEAL_M + 0.04f, z1 });
}

/* Frame, mullions and glazing bars; finer bars where the window is tall. */
static void draw_sash(const struct pen *p, const struct opening *o, float z0)
{
	float x0 = o->x, x1 = o->x + o->width, z1 = arch_spring(o), w = 0.065f;
	float transom = o->arched ? z1 : z0 + 0.7f * (z1 - z0), middle = 0.5f * (x0 + x1);
	bar(p, x0, x0 + w, z0, z1, 0.03f);
	bar(p, x1 - w, x1, z0, z1, 0.03f);
	bar(p, x0 + w, x1 - w, z0, z0 + w, 0.03f);
	if (!o->arched)
		bar(p, x0 + w, x1 - w, z1 - w, z1, 0.03f);
	bar(p, x0 + w, x1 - w, transom - 0.04f, transom + 0.04f, 0.04f);
	bar(p, middle - 0.04f, middle + 0.04f, z0 + w,
		o->arched ? z1 + 0.5f * o->width - w : z1 - w, 0.05f);
	unsigned rows = (unsigned)MAX(2, lroundf((transom - z0) / 0.42f));
	for (unsigned i = 1; i < rows; i++) {
		float z = z0 + (transom - z0) * i / rows;
		bar(p, x0 + w, x1 - w, z - 0.014f, z + 0.014f, 0.005f);
	}
	if (o->arched) {
		float r = 0.5f * o->width;
		draw_arc(p, middle, z1, r - w, r, REVEAL_M - 0.03f, REVEAL_M + 0.04f, 0, G_PI, 14);
		draw_arc(p, middle, z1, 0.48f * r, 0.48f * r + 0.03f, REVEAL_M, REVEAL_M + 0.03f, 0,
			G_PI, 10);
	}
}

static void draw_pane(const struct pen *p, const struct opening *o, float z0)
{
	float x0 = o->x, x1 = o->x + o->width, z1 = arch_spring(o), y = REVEAL_M + 0.02f;
	pen_quad(p, (vec){ x0, y, z0 }, (vec){ x1, y, z0 }, (vec){ x1, y, z1 }, (vec){ x0, y, z1 });
	float r = 0.5f * o->width, x = x0 + r;
	for (unsigned i = 0; o->arched && i < 14; i++)
		pen_triangle(p, (vec){ x, y, z1 }, on_arc(x, z1, r, y, G_PI * i / 14),
			on_arc(x, z1, r, y, G_PI * (i + 1) / 14));
}

/* Drapes gathered to the sides, or a blind, behind some of the panes. */
static void draw_curtain(struct site *s, const struct pen *p, const struct opening *o)
{
	enum { N = 13 };
	float top = arch_spring(o) - 0.02f, y = REVEAL_M + 0.16f, w = o->width;
	if (roll(&s->dice) < 0.35f) {
		float low = top - (top - o->z) * roll_in(&s->dice, 0.25f, 0.7f);
		pen_quad(p, (vec){ o->x, y, low }, (vec){ o->x + w, y, low },
			(vec){ o->x + w, y, top }, (vec){ o->x, y, top });
		return;
	}
	for (unsigned side = 0; side < 2; side++) {
		vec points[2 * N];
		for (unsigned i = 0; i < N; i++) {
			float t = 0.3f * w * i / (N - 1), x = side ? o->x + w - t : o->x + t;
			float fold = y + 0.03f * sinf(i * 1.9f);
			points[i] = (vec){ x, fold, o->z - 0.1f };
			points[N + i] = (vec){ x, fold, top };
		}
		pen_skin(p, points, 2, N);
	}
}

/* Two panelled leaves under a fanlight. */
static void draw_door(
	const struct pen *p, const struct facade *f, const struct opening *o, uint16_t leaf)
{
	struct pen wood = pen_with(p, leaf), knob = pen_with(p, f->palette->brass);
	float x0 = o->x, x1 = o->x + o->width, m = 0.5f * (x0 + x1), y = REVEAL_M;
	float top = o->arched ? arch_spring(o) : o->z + o->height - 0.5f;
	pen_box(&wood, (vec){ x0, y, o->z }, (vec){ x1, y + 0.06f, top });
	for (unsigned side = 0; side < 2; side++)
		for (unsigned k = 0; k < 3; k++) {
			float a = (side ? m : x0) + 0.1f, b = (side ? x1 : m) - 0.1f;
			float z0 = o->z + 0.15f + (top - o->z - 0.15f) * k / 3;
			float z1 = o->z + (top - o->z - 0.15f) * (k + 1) / 3;
			pen_box(&wood, (vec){ a, y - 0.025f, z0 }, (vec){ b, y, z1 });
			pen_box(&wood, (vec){ a + 0.06f, y - 0.04f, z0 + 0.06f },
				(vec){ b - 0.06f, y, z1 - 0.06f });
		}
	pen_box(&wood, (vec){ m - 0.03f, y - 0.05f, o->z }, (vec){ m + 0.03f, y, top });
	pen_ball(&knob, (vec){ m + 0.1f, y - 0.08f, o->z + 1.05f }, (vec){ 0.035f, 0.035f, 0.035f },
		8);
}

static void draw_glazing(
	struct site *s, const struct pen *p, const struct facade *f, const struct opening *o)
{
	struct pen frame = pen_with(p, f->frame), glass = pen_with(p, f->palette->glass);
	float z0 = o->z;
	if (o->door) {
		draw_door(p, f, o, f->palette->door[roll_int(&s->dice, 0, 3)]);
		z0 = o->arched ? arch_spring(o) : o->z + o->height - 0.5f;
	}
	draw_sash(&frame, o, z0);
	draw_pane(&glass, o, z0);
	struct pen curtain = pen_with(p, f->palette->curtain);
	if (!o->door && roll(&s->dice) < 0.55f)
		draw_curtain(s, &curtain, o);
}

static void draw_hood(const struct pen *p, const struct opening *o, float z, bool pediment)
{
	static const float profile[][2] = { { 0, 0 }, { 0.04f, 0 }, { 0.06f, 0.05f },
		{ 0.15f, 0.09f }, { 0.15f, 0.14f }, { 0.18f, 0.16f }, { 0, 0.18f } };
	struct pen q = pen_at(p, 0, 0, z);
	float x0 = o->x - 0.22f, x1 = o->x + o->width + 0.22f, m = 0.5f * (x0 + x1);
	pen_moulding(&q, profile, G_N_ELEMENTS(profile), x0, x1, 1, 1);
	pen_box(&q, (vec){ x0 + 0.08f, -0.1f, -0.3f }, (vec){ x0 + 0.2f, 0, 0 });
	pen_box(&q, (vec){ x1 - 0.2f, -0.1f, -0.3f }, (vec){ x1 - 0.08f, 0, 0 });
	if (!pediment)
		return;
	float rise = 0.24f * (x1 - x0);
	vec gable[] = { { x0 - 0.1f, 0, 0.17f }, { x1 + 0.1f, 0, 0.17f }, { m, 0, 0.17f + rise } };
	pen_prism(&q, gable, 3, -0.06f, 0);
	vec left[] = { gable[0] - (vec){ 0.06f, 0, 0 }, gable[2], gable[2] + (vec){ 0, 0, 0.1f },
		gable[0] + (vec){ -0.06f, 0, 0.07f } };
	vec right[] = { gable[1] + (vec){ 0.06f, 0, 0 }, gable[2], gable[2] + (vec){ 0, 0, 0.1f },
		gable[1] + (vec){ 0.06f, 0, 0.07f } };
	pen_prism(&q, left, 4, -0.18f, 0);
	pen_prism(&q, right, 4, -0.18f, 0);
}

/* Architrave, sill and head. */
static void draw_surround(const struct pen *p, const struct opening *o)
{
	float x0 = o->x, x1 = o->x + o->width, z0 = o->z, z1 = arch_spring(o), r = 0.5f * o->width;
	float w = 0.15f, out = -0.05f;
	pen_box(p, (vec){ x0 - w, out, z0 }, (vec){ x0, 0.02f, z1 });
	pen_box(p, (vec){ x1, out, z0 }, (vec){ x1 + w, 0.02f, z1 });
	pen_box(p, (vec){ x0 - w, out - 0.02f, z0 }, (vec){ x0 - w + 0.05f, 0, z1 });
	pen_box(p, (vec){ x1 + w - 0.05f, out - 0.02f, z0 }, (vec){ x1 + w, 0, z1 });
	if (!o->door)
		pen_box(p, (vec){ x0 - w - 0.06f, -0.14f, z0 - 0.1f },
			(vec){ x1 + w + 0.06f, REVEAL_M, z0 });
	if (o->arched) {
		draw_arc(p, x0 + r, z1, r, r + w, out, 0.02f, 0, G_PI, 16);
		draw_arc(p, x0 + r, z1, r + w - 0.05f, r + w, out - 0.02f, 0, 0, G_PI, 16);
		pen_box(p, (vec){ x0 + r - 0.11f, -0.12f, z1 + r - 0.04f },
			(vec){ x0 + r + 0.11f, 0, z1 + r + w + 0.1f });
		return;
	}
	pen_box(p, (vec){ x0 - w, out, z1 }, (vec){ x1 + w, 0.02f, z1 + w });
	if (o->head == HEAD_LINTEL)
		pen_box(p, (vec){ x0 - w, out - 0.03f, z1 + w },
			(vec){ x1 + w, 0, z1 + w + 0.07f });
	if (o->head == HEAD_KEYSTONE) {
		vec key[] = { { x0 + r - 0.1f, 0, z1 }, { x0 + r + 0.1f, 0, z1 },
			{ x0 + r + 0.15f, 0, z1 + 0.32f }, { x0 + r - 0.15f, 0, z1 + 0.32f } };
		pen_prism(p, key, 4, -0.11f, 0);
	}
	if (o->head == HEAD_HOOD || o->head == HEAD_PEDIMENT)
		draw_hood(p, o, z1 + w + 0.16f, o->head == HEAD_PEDIMENT);
}

/* A pair of louvred leaves folded back against the wall. */
static void draw_shutters(const struct pen *p, const struct opening *o)
{
	float w = 0.5f * o->width, z0 = o->z, z1 = o->z + o->height;
	for (unsigned side = 0; side < 2; side++) {
		float x0 = side ? o->x + o->width + 0.16f : o->x - 0.16f - w, x1 = x0 + w;
		pen_box(p, (vec){ x0, -0.05f, z0 }, (vec){ x0 + 0.06f, -0.012f, z1 });
		pen_box(p, (vec){ x1 - 0.06f, -0.05f, z0 }, (vec){ x1, -0.012f, z1 });
		for (float z = z0; z < z1 - 0.05f; z += 0.075f)
			pen_quad(p, (vec){ x0, -0.048f, z }, (vec){ x1, -0.048f, z },
				(vec){ x1, -0.014f, z + 0.085f }, (vec){ x0, -0.014f, z + 0.085f });
		pen_box(p, (vec){ x0, -0.052f, z1 - 0.08f }, (vec){ x1, -0.012f, z1 });
		pen_box(p, (vec){ x0, -0.052f, z0 }, (vec){ x1, -0.012f, z0 + 0.08f });
	}
}

/* A slab on brackets with an iron rail. */
static void draw_balcony(const struct pen *p, const struct facade *f, const struct opening *o)
{
	struct pen stone = pen_with(p, f->trim), iron = pen_with(p, f->palette->iron);
	float x0 = o->x - 0.4f, x1 = o->x + o->width + 0.4f, z = o->z - 0.02f, y = -0.85f;
	pen_box(&stone, (vec){ x0, y, z - 0.14f }, (vec){ x1, 0, z });
	pen_box(&stone, (vec){ x0 - 0.04f, y - 0.04f, z - 0.05f }, (vec){ x1 + 0.04f, 0, z });
	for (unsigned k = 0; k < 2; k++) {
		float x = k ? x1 - 0.3f : x0 + 0.12f;
		vec side[] = { { 0, 0, z - 0.14f }, { 0, 0, z - 0.6f }, { 0.16f, 0, z - 0.55f },
			{ 0.6f, 0, z - 0.14f } };
		struct pen bracket = pen_turned(&stone, x, 0, 0, G_PI / 2);
		pen_prism(&bracket, side, 4, 0, 0.18f);
	}
	draw_railing(&iron, (vec){ x0, 0, z }, (vec){ x0, y + 0.05f, z }, 1, 0.12f);
	draw_railing(&iron, (vec){ x1, 0, z }, (vec){ x1, y + 0.05f, z }, 1, 0.12f);
	draw_railing(&iron, (vec){ x0, y + 0.05f, z }, (vec){ x1, y + 0.05f, z }, 1, 0.12f);
}

void draw_opening(
	struct site *s, const struct pen *p, const struct facade *f, const struct opening *o)
{
	struct pen trim = pen_with(p, f->trim), shutter = pen_with(p, f->shutter);
	draw_reveals(&trim, o);
	draw_glazing(s, p, f, o);
	draw_surround(&trim, o);
	if (o->shutters)
		draw_shutters(&shutter, o);
	if (o->balcony)
		draw_balcony(p, f, o);
}

void draw_window(const struct pen *p, const struct facade *f, const struct opening *o)
{
	struct pen trim = pen_with(p, f->trim), frame = pen_with(p, f->frame),
		   glass = pen_with(p, f->palette->glass);
	draw_reveals(&trim, o);
	draw_sash(&frame, o, o->z);
	draw_pane(&glass, o, o->z);
	draw_surround(&trim, o);
}
