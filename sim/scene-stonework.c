/* Whole facades, and the stone work of scene-facade.h that is not an opening's. */
#include "sim/scene-facade.h"

float facade_height(const struct facade *f)
{
	float z = 0;
	for (unsigned i = 0; i < f->storeys; i++)
		z += f->storey[i].height;
	return z;
}

void draw_cornice(
	const struct pen *p, float x0, float x1, float z, float scale, float mitre, bool dentils)
{
	static const float shape[][2] = { { 0, -0.12f }, { 0.05f, -0.12f }, { 0.05f, -0.02f },
		{ 0.11f, 0.06f }, { 0.11f, 0.16f }, { 0.14f, 0.17f }, { 0.14f, 0.2f },
		{ 0.36f, 0.22f }, { 0.36f, 0.32f }, { 0.4f, 0.34f }, { 0.46f, 0.42f },
		{ 0.46f, 0.46f }, { 0, 0.48f } };
	float profile[G_N_ELEMENTS(shape)][2];
	for (unsigned i = 0; i < G_N_ELEMENTS(shape); i++) {
		profile[i][0] = shape[i][0] * scale;
		profile[i][1] = shape[i][1] * scale;
	}
	struct pen q = pen_at(p, 0, 0, z);
	pen_moulding(&q, profile, G_N_ELEMENTS(shape), x0, x1, mitre, mitre);
	float step = 0.3f * scale, wide = 0.15f * scale;
	for (float x = x0 + 0.2f; dentils && x + wide < x1 - 0.1f; x += step)
		pen_box(&q, (vec){ x, -0.3f * scale, 0.1f * scale },
			(vec){ x + wide, 0, 0.22f * scale });
}

void draw_course(const struct pen *p, float x0, float x1, float z, float mitre)
{
	static const float profile[][2] = { { 0, -0.1f }, { 0.04f, -0.1f }, { 0.04f, 0.02f },
		{ 0.09f, 0.06f }, { 0.09f, 0.12f }, { 0.11f, 0.14f }, { 0, 0.17f } };
	struct pen q = pen_at(p, 0, 0, z);
	pen_moulding(&q, profile, G_N_ELEMENTS(profile), x0, x1, mitre, mitre);
}

/* Long and short blocks at an end of the wall; inward is +1 or -1. */
static void draw_quoins(const struct pen *p, float x, float inward, float top)
{
	bool odd = false;
	for (float z = 0.1f; z + 0.42f < top; z += 0.44f, odd = !odd) {
		float far = x + inward * (odd ? 0.62f : 0.4f);
		pen_box(p, (vec){ MIN(x, far), -0.04f, z }, (vec){ MAX(x, far), 0.02f, z + 0.42f });
	}
}

static struct opening opening_of(const struct facade *f, unsigned level, unsigned bay, float z)
{
	const struct storey *t = &f->storey[level];
	float middle = f->length * (bay + 0.5f) / f->bays;
	struct opening o = { .x = middle - 0.5f * t->window_width,
		.z = z + t->sill,
		.width = t->window_width,
		.height = t->window_height,
		.arched = t->arched,
		.head = t->head };
	o.balcony = t->balconies && (bay + level) % t->balconies == 0;
	o.shutters = t->shutters && bay % t->shutters == 0;
	if (o.balcony) {
		o.height += o.z - z - 0.1f;
		o.z = z + 0.1f;
	}
	if (level == 0 && (f->doors >> bay & 1)) {
		o = (struct opening){ middle - 0.75f, z, 1.5f, MIN(2.9f, t->height - 0.5f),
			t->arched, true, t->head, false, false };
		if (o.head == HEAD_PLAIN)
			o.head = HEAD_HOOD;
	}
	if (level == 1 && (f->upper_doors >> bay & 1))
		o = (struct opening){ middle - 0.65f, z + UPPER_DOOR_M, 1.3f,
			MIN(2.5f, t->height - 0.6f), false, true, HEAD_LINTEL };
	if (level == 0 && (f->gates >> bay & 1))
		o = (struct opening){ middle - 1.5f, z - 0.25f, 3.0f, MIN(4.1f, t->height), true,
			true };
	return o;
}

/* Floor, back wall and some partitions of the rooms behind a storey. */
static void draw_rooms(const struct pen *p, const struct facade *f, float z, float height)
{
	struct pen wall = pen_with(p, f->palette->inside),
		   floor = pen_with(p, f->palette->inside_floor);
	float y0 = 0.32f, y1 = f->room_m, x1 = f->length;
	pen_quad(&floor, (vec){ 0, 0.05f, z }, (vec){ x1, 0.05f, z }, (vec){ x1, y1, z },
		(vec){ 0, y1, z });
	pen_quad(&wall, (vec){ 0, y1, z }, (vec){ x1, y1, z }, (vec){ x1, y1, z + height },
		(vec){ 0, y1, z + height });
	pen_quad(&wall, (vec){ 0, y0, z + height - 0.02f }, (vec){ x1, y0, z + height - 0.02f },
		(vec){ x1, y1, z + height - 0.02f }, (vec){ 0, y1, z + height - 0.02f });
	for (unsigned i = 2; i < f->bays; i += 2) {
		float x = x1 * i / f->bays;
		pen_quad(&wall, (vec){ x, y0, z }, (vec){ x, y1, z }, (vec){ x, y1, z + height },
			(vec){ x, y0, z + height });
	}
}

static void draw_storey(
	struct site *s, const struct pen *p, const struct facade *f, unsigned level, float z)
{
	struct opening o[24];
	unsigned n = 0;
	const struct storey *t = &f->storey[level];
	struct pen wall = pen_with(p, level ? f->wall : f->ground_wall);
	for (unsigned i = 0; i < MIN(f->bays, 24); i++)
		if (level || !(f->blank >> i & 1))
			o[n++] = opening_of(f, level, i, z);
	draw_wall(
		&wall, -f->flank, f->length + f->flank, level ? z : z - 1.6f, z + t->height, o, n);
	for (unsigned i = 0; i < n; i++)
		draw_opening(s, p, f, &o[i]);
	draw_rooms(p, f, z, t->height);
}

/* Interrupted by doors and gates. */
static void draw_plinth(const struct pen *p, const struct facade *f)
{
	float x = 0;
	for (unsigned i = 0; i <= f->bays; i++) {
		bool door = i < f->bays && (f->doors >> i & 1),
		     gate = i < f->bays && (f->gates >> i & 1);
		float half = gate ? 1.7f : 0.92f, at = f->length * (i + 0.5f) / f->bays;
		float end = i == f->bays ? f->length : at - half;
		if (!door && !gate && i < f->bays)
			continue;
		pen_box(p, (vec){ x, -0.07f, -1.6f }, (vec){ end, 0.02f, 0.38f });
		pen_box(p, (vec){ x, -0.1f, 0.32f }, (vec){ end, 0.02f, 0.4f });
		x = at + half;
	}
}

void draw_facade(struct site *s, const struct pen *p, const struct facade *f)
{
	struct pen trim = pen_with(p, f->trim);
	float z = 0;
	for (unsigned i = 0; i < f->storeys; i++) {
		if (i || !f->open_ground)
			draw_storey(s, p, f, i, z);
		z += f->storey[i].height;
		if (i + 1 < f->storeys)
			draw_course(&trim, -f->flank, f->length + f->flank, z, f->mitre);
	}
	draw_cornice(
		&trim, -f->flank, f->length + f->flank, z - 0.36f, 0.75f, f->mitre, f->dentils);
	if (f->quoins) {
		draw_quoins(&trim, 0, 1, z - 0.4f);
		draw_quoins(&trim, f->length, -1, z - 0.4f);
	}
	if (!f->open_ground)
		draw_plinth(&trim, f);
}

void draw_column(const struct pen *p, float height, float radius)
{
	float r = radius, h = height, base = 1.1f * r, cap = h - 1.1f * r;
	float profile[][2] = { { 1.32f * r, base * 0.45f }, { 1.4f * r, base * 0.55f },
		{ 1.4f * r, base * 0.65f }, { 1.32f * r, base * 0.75f }, { 1.12f * r, base * 0.8f },
		{ 1.12f * r, base * 0.86f }, { 1.22f * r, base * 0.92f }, { 1.22f * r, base },
		{ 1.02f * r, base * 1.08f }, { r, base * 1.3f }, { r, 0.4f * h },
		{ 0.95f * r, 0.7f * h }, { 0.86f * r, cap - 0.5f * r },
		{ 0.98f * r, cap - 0.45f * r }, { 0.98f * r, cap - 0.35f * r },
		{ 0.88f * r, cap - 0.3f * r }, { 0.9f * r, cap }, { 1.02f * r, cap + 0.25f * r },
		{ 1.3f * r, cap + 0.6f * r }, { 1.3f * r, cap + 0.7f * r } };
	pen_lathe(p, profile, G_N_ELEMENTS(profile), 28);
	pen_box(p, (vec){ -1.45f * r, -1.45f * r, -0.3f },
		(vec){ 1.45f * r, 1.45f * r, base * 0.45f });
	pen_box(p, (vec){ -1.4f * r, -1.4f * r, h - 0.4f * r }, (vec){ 1.4f * r, 1.4f * r, h });
}

static float vault_height(float t, bool pointed)
{
	t = MIN(fabsf(t), 1);
	if (!pointed)
		return sqrtf(1 - t * t);
	/* arc of radius 1.25 half spans about the far side */
	float r = 1.3f, full = sqrtf(r * r - (r - 1) * (r - 1));
	return sqrtf(MAX(0, r * r - (r - 1 + t) * (r - 1 + t))) / full;
}

static void draw_web(const struct pen *p, vec half, float rise, bool pointed, unsigned side)
{
	enum { S = 9, T = 17 };
	vec points[S * T];
	for (unsigned i = 0; i < S; i++)
		for (unsigned k = 0; k < T; k++) {
			float u = i / (S - 1.0f), v = (2.0f * k / (T - 1) - 1) * u;
			float x = side & 1 ? v : u, y = side & 1 ? u : v;
			if (side & 2)
				x = -x, y = -y;
			points[i * T + k] =
				(vec){ x * half[0], y * half[1], rise * vault_height(v, pointed) };
		}
	pen_skin(p, points, S, T);
}

void draw_groin_ribs(
	const struct pen *p, float half_x, float half_y, float rise, bool pointed, float radius)
{
	enum { N = 21 };
	for (unsigned k = 0; k < 4; k++) {
		vec path[N];
		float radii[N];
		for (unsigned i = 0; i < N; i++) {
			float t = 2.0f * i / (N - 1) - 1;
			/* two diagonals, and the arches at two of the sides */
			float x = k == 2 ? 1 : t, y = k == 0 ? t : k == 1 ? -t : k == 2 ? t : 1;
			path[i] = (vec){ x * half_x, y * half_y, rise * vault_height(t, pointed) };
			radii[i] = radius;
		}
		pen_tube(p, path, radii, N, 8);
	}
}

void draw_groin(
	const struct pen *p, float half_x, float half_y, float rise, bool pointed, float rib)
{
	for (unsigned side = 0; side < 4; side++)
		draw_web(p, (vec){ half_x, half_y }, rise, pointed, side);
	if (rib > 0)
		draw_groin_ribs(p, half_x, half_y, rise, pointed, rib);
}

void draw_steps(const struct pen *p, float width, unsigned n, float rise, float tread)
{
	for (unsigned i = 0; i < n; i++) {
		float top = -rise * i, edge = -tread * (i + 1);
		pen_box(p, (vec){ -0.5f * width - 0.3f * i, edge, top - rise - 0.3f },
			(vec){ 0.5f * width + 0.3f * i, 0, top - 0.045f });
		pen_box(p, (vec){ -0.5f * width - 0.3f * i - 0.02f, edge - 0.025f, top - 0.045f },
			(vec){ 0.5f * width + 0.3f * i + 0.02f, 0, top });
	}
}

void draw_railing(const struct pen *p, vec a, vec b, float height, float spacing)
{
	vec up = { 0, 0, height };
	float far = length(b - a);
	unsigned n = (unsigned)MAX(1, lroundf(far / spacing));
	pen_rod(p, a + up, b + up, 0.025f, 0.025f, 8);
	pen_rod(p, a + up * 0.12f, b + up * 0.12f, 0.015f, 0.015f, 6);
	for (unsigned i = 0; i <= n; i++) {
		vec foot = mix(a, b, (float)i / n);
		float r = i % 10 && i != n ? 0.009f : 0.022f;
		pen_rod(p, foot, foot + up, r, r, r > 0.02f ? 6 : 4);
	}
}
