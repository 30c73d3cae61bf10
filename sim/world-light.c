#include "sim/world-trace.h"

void light_choose(struct light *l, struct dice *d)
{
	/* from the south, between morning and afternoon, so that what faces south is lit */
	float side = roll(d) < 0.5f ? -1 : 1, azimuth = G_PI + side * roll_in(d, 0.35f, 1.05f);
	float up = roll_in(d, 34, 52) * G_PI / 180;
	float low = (52 - up * 180 / G_PI) / 18;
	l->towards_sun = (vec){ sinf(azimuth) * cosf(up), cosf(azimuth) * cosf(up), sinf(up) };
	l->sun = (vec){ 0.84f, 0.78f - 0.05f * low, 0.66f - 0.1f * low };
	l->zenith = (vec){ 0.19f, 0.33f, 0.64f };
	l->horizon = (vec){ 0.70f, 0.79f, 0.89f };
	l->fill = (vec){ 0.05f, 0.046f, 0.04f };
	l->ground = (vec){ 0.22f, 0.2f, 0.17f };
	l->clouds = roll_in(d, 0.35f, 0.75f);
	l->haze_m = roll_in(d, 900, 1600);
}

static float cloud_cover(const struct light *l, vec d)
{
	float s = 1.6f / (d[2] + 0.18f), x = d[0] * s, y = d[1] * s, sum = 0, gain = 0.5f;
	for (uint32_t i = 0; i < 5; i++, gain *= 0.5f, x = x * 2.1f + 5, y = y * 2.1f + 3)
		sum += gain * noise_2d(x, y, i);
	return smooth_unit(clamp_unit((sum + l->clouds - 0.55f) * 1.8f)) * clamp_unit(d[2] * 7);
}

vec light_sky(const struct light *l, vec direction, bool clouds)
{
	float up = direction[2];
	if (up < 0)
		return mix(l->horizon, l->ground, clamp_unit(-up * 8));
	float t = 1 - up;
	vec sky = mix(l->zenith, l->horizon, t * t * t);
	float near = clamp_unit(dot(direction, l->towards_sun));
	near *= near;
	near *= near;
	sky += l->sun * (0.25f * near * near);
	if (!clouds)
		return sky;
	float cover = cloud_cover(l, direction);
	vec cloud = mix((vec){ 0.78f, 0.8f, 0.84f }, (vec){ 1.05f, 1.03f, 1.0f }, cover);
	return mix(sky, cloud, 0.85f * cover);
}

/* Whether the sun is before a surface, and how much of its light falls on it where nothing stands between; leaves let some through. */
static bool faces_sun(
	const struct world *w, const struct hit *h, struct ray *ret_shadow, vec *ret_light)
{
	vec s = w->site.light.towards_sun;
	float faces = dot(h->shading, s), side = dot(h->normal, s) < 0 ? -1 : 1;
	bool leaf = h->material->kind == MATERIAL_LEAF;
	if (leaf)
		faces = faces > 0 ? faces * 0.75f + 0.25f : 0.25f - 0.3f * faces;
	*ret_shadow = (struct ray){ h->place + h->normal * (side * 0.003f), s, 300 };
	*ret_light = w->site.light.sun * faces;
	return faces > 0 && (leaf || side > 0);
}

/* Light of the sun on surfaces, 0 in shadow. */
static void sunlight(const struct world *w, const struct hit *h, unsigned lanes,
	enum packet_kind kind, vec *ret_light)
{
	struct ray shadow[PACKET];
	unsigned lit = 0;
	for (unsigned i = 0; i < PACKET; i++)
		if (lanes >> i & 1 && faces_sun(w, h + i, shadow + i, ret_light + i))
			lit |= 1U << i;
	lit &= ~packet_blocked(w, shadow, lit, kind);
	for (unsigned i = 0; i < PACKET; i++)
		if (!(lit >> i & 1))
			ret_light[i] = (vec){ 0 };
}

vec light_ambient(const struct world *w, vec place, vec normal)
{
	const struct probes *g = &w->probes;
	vec at = (place + normal * g->cell_m - g->low) / g->cell_m, sum[4] = { { 0 } };
	int i[3];
	float t[3];
	for (int k = 0; k < 3; k++) {
		float x = at[k] < 0 ? 0 : at[k] > g->n[k] - 1.01f ? g->n[k] - 1.01f : at[k];
		i[k] = (int)x;
		t[k] = x - (float)i[k];
	}
	const vec(*cell)[4] = g->light + ((gsize)i[2] * g->n[1] + i[1]) * g->n[0] + i[0];
	for (int c = 0; c < 8; c++) {
		const vec *p = cell[((c >> 2) * g->n[1] + (c >> 1 & 1)) * g->n[0] + (c & 1)];
		float weight = (c & 1 ? t[0] : 1 - t[0]) * (c & 2 ? t[1] : 1 - t[1]) *
			       (c & 4 ? t[2] : 1 - t[2]);
		for (int k = 0; k < 4; k++)
			sum[k] += p[k] * weight;
	}
	vec light = sum[0] + sum[1] * normal[0] + sum[2] * normal[1] + sum[3] * normal[2];
	for (int k = 0; k < 3; k++)
		light[k] = light[k] < 0.01f ? 0.01f : light[k];
	return light;
}

/* Diffuse light that comes to a probe along rays: of the sun, and what the last pass gathered; of the sky where nothing is. */
static void probe_light(
	const struct world *w, const struct ray *r, unsigned lanes, bool again, vec *ret_light)
{
	struct hit h[PACKET];
	vec sun[PACKET];
	unsigned hits = packet_solid(w, r, lanes, PACKET_PROBE, h);
	sunlight(w, h, hits, PACKET_PROBE, sun);
	for (unsigned i = 0; i < PACKET; i++) {
		if (!(hits >> i & 1)) {
			if (lanes >> i & 1)
				ret_light[i] = light_sky(&w->site.light, r[i].direction, false);
			continue;
		}
		const struct material *m = h[i].material;
		vec albedo = material_albedo(m, h[i].place, h[i].normal, 0.5f, h[i].face);
		vec ambient = again ? light_ambient(w, h[i].place, h[i].normal)
				    : w->site.light.zenith * 0.35f + w->site.light.fill;
		ret_light[i] = albedo * (sun[i] + ambient + m->emission);
	}
}

static vec probe_direction(unsigned i, unsigned rays)
{
	float z = 1 - (2 * (float)i + 1) / rays, a = 2.399963f * (float)i;
	float level = sqrtf(1 - z * z);
	return (vec){ level * cosf(a), level * sinf(a), z };
}

static void gather_probe(const struct world *w, vec place, bool again, unsigned rays, vec *light)
{
	vec sum[4] = { { 0 } };
	for (unsigned first = 0; first < rays; first += PACKET) {
		unsigned count = MIN(PACKET, rays - first);
		struct ray r[PACKET];
		vec in[PACKET];
		for (unsigned i = 0; i < count; i++)
			r[i] = (struct ray){ place, probe_direction(first + i, rays), 300 };
		probe_light(w, r, (1U << count) - 1, again, in);
		for (unsigned i = 0; i < count; i++) {
			sum[0] += in[i];
			for (int k = 0; k < 3; k++)
				sum[k + 1] += in[i] * r[i].direction[k];
		}
	}
	/* a uniform sphere of radiance 1 gives 1 for every normal; cosine lobes weigh the first
	 * order 2/3, times 3 */
	light[0] = sum[0] / (float)rays + w->site.light.fill;
	for (int k = 1; k < 4; k++)
		light[k] = sum[k] * (2.0f / rays);
}

static void gather_pass(struct world *w, bool again, unsigned rays)
{
	struct probes *g = &w->probes;
	gsize layer = (gsize)g->n[0] * g->n[1], all = layer * g->n[2];
	vec(*next)[4] = g_malloc(all * sizeof(*next));
#pragma omp parallel for schedule(dynamic, 64)
	for (gsize i = 0; i < all; i++) {
		vec at = { i % g->n[0], i / g->n[0] % g->n[1], i / layer };
		gather_probe(w, g->low + at * g->cell_m, again, rays, next[i]);
	}
	g_free(g->light);
	g->light = next;
}

void light_gather(struct world *w)
{
	struct bounds b = w->site.bounds;
	w->probes = (struct probes){ .low = b.low, .cell_m = b.cell_m };
	for (int k = 0; k < 3; k++)
		w->probes.n[k] = 2 + (int)((b.high[k] - b.low[k]) / b.cell_m);
	gather_pass(w, false, 14);
	gather_pass(w, true, 18);
}

/* Corners and what lies under ledges: how far one short ray gets. It always leans the same way,
 * upwards from walls and away from the sun on the ground, so that the shade has no grain. */
#define REACH_M 1.0f
static struct ray leaning(const struct world *w, const struct hit *h)
{
	vec n = h->normal, s = w->site.light.towards_sun;
	float level = 1 - n[2] * n[2];
	vec lean = (vec){ -s[0], -s[1], 0 } * (1 - level) + (vec){ 0, 0, 1 } * level;
	return (struct ray){ h->place + n * 0.003f, unit(n + lean * 0.9f), REACH_M };
}

/* 1 at lanes that are not asked for. */
static void openness(const struct world *w, const struct hit *h, unsigned lanes, float *ret)
{
	struct ray r[PACKET];
	for (unsigned i = 0; i < PACKET; i++)
		if (lanes >> i & 1)
			r[i] = leaning(w, h + i);
	packet_distance(w, r, lanes, ret);
	for (unsigned i = 0; i < PACKET; i++)
		ret[i] = lanes >> i & 1 ? 0.45f + 0.6f * (ret[i] / REACH_M) : 1;
}

static vec haze(const struct light *l, vec colour, float range_m)
{
	return mix(colour, l->horizon * 0.9f, 1 - expf(-range_m / l->haze_m));
}

/* open: how much of the light around comes to the place. */
static vec shade_one(
	const struct world *w, const struct ray *r, const struct hit *h, vec sun, float open)
{
	const struct material *m = h->material;
	vec albedo = material_albedo(m, h->place, h->normal, hit_footprint(r, h), h->face);
	vec ambient = light_ambient(w, h->place, h->shading) * open;
	if (m->kind == MATERIAL_LEAF && dot(h->shading, r->direction) > 0)
		ambient *= 0.6f; /* from within the crown or below it */
	vec colour = albedo * (sun + ambient + m->emission);
	if (m->gloss > 0) {
		float c = 1 - clamp_unit(-dot(r->direction, h->shading));
		vec away = r->direction - h->shading * (2 * dot(r->direction, h->shading));
		float share = m->gloss + (1 - m->gloss) * c * c * c * c * c;
		colour = mix(colour, light_ambient(w, h->place, away), share);
	}
	return haze(&w->site.light, colour, h->range_m);
}

/* fine: with the shade of corners, which mirrored and dim places do without. */
static void shade(const struct world *w, const struct ray *r, const struct hit *h, unsigned lanes,
	bool fine, vec *ret_light)
{
	vec sun[PACKET];
	float open[PACKET];
	unsigned near = 0;
	for (unsigned i = 0; i < PACKET; i++)
		if (fine && lanes >> i & 1 && h[i].range_m < 60 &&
			h[i].material->kind != MATERIAL_LEAF)
			near |= 1U << i;
	sunlight(w, h, lanes, PACKET_LOOK, sun);
	openness(w, h, near, open);
	for (unsigned i = 0; i < PACKET; i++)
		if (lanes >> i & 1)
			ret_light[i] = shade_one(w, r + i, h + i, sun[i], open[i]);
}

static void add_sky(const struct world *w, const struct ray *r, unsigned lanes, vec *ret_light)
{
	for (unsigned i = 0; i < PACKET; i++)
		if (lanes >> i & 1)
			ret_light[i] = light_sky(&w->site.light, r[i].direction, true);
}

/* What stands in the world without its panes, at lanes that look at it; ret_hit where the bits that come back say so. */
static unsigned shade_solid(const struct world *w, const struct ray *r, unsigned lanes,
	struct hit *ret_hit, vec *ret_light)
{
	unsigned hits = packet_solid(w, r, lanes, PACKET_LOOK, ret_hit);
	shade(w, r, ret_hit, hits, false, ret_light);
	add_sky(w, r, lanes & ~hits, ret_light);
	return hits;
}

static vec ripple(const struct hit *h)
{
	vec p = h->place, n = h->normal;
	float fade = 0.035f / (1 + 0.02f * h->range_m);
	n[0] += fade *
		(noise_2d(p[0] * 2.2f, p[1] * 3.1f, 5) + noise_2d(p[0] * 7, p[1] * 9, 6) * 0.6f);
	n[1] += fade *
		(noise_2d(p[0] * 2.2f, p[1] * 3.1f, 7) + noise_2d(p[0] * 7, p[1] * 9, 8) * 0.6f);
	return unit(n);
}

/* What a pane or the water mirrors. */
static struct ray mirrored(const struct ray *r, const struct hit *h, vec normal)
{
	vec away = unit(r->direction - normal * (2 * dot(r->direction, normal)));
	return (struct ray){ h->place + h->normal * 0.003f, away, 400 };
}

static vec surface_normal(const struct hit *h)
{
	return h->material->kind == MATERIAL_WATER ? ripple(h) : h->normal;
}

/* behind: light from beyond the pane, or from the bed of the water `deep` metres further. */
static vec through(const struct world *w, const struct ray *r, const struct hit *h, vec behind,
	float deep, vec mirror)
{
	bool water = h->material->kind == MATERIAL_WATER;
	float c = 1 - clamp_unit(-dot(r->direction, surface_normal(h))), f0 = water ? 0.03f : 0.08f;
	float share = f0 + (1 - f0) * c * c * c * c * c;
	vec tint = material_albedo(h->material, h->place, h->normal, 1, 0);
	vec body = tint * (light_ambient(w, h->place, h->normal) + w->site.light.sun * 0.4f);
	vec inner = water ? mix(body, behind * tint * 2, expf(-1.5f * deep)) : behind * 0.85f;
	return mix(inner, mirror, share);
}

static void look_through(const struct world *w, const struct ray *r, const struct hit *h,
	unsigned lanes, vec *ret_light)
{
	struct ray back[PACKET];
	struct hit behind[PACKET], seen[PACKET];
	vec mirror[PACKET];
	for (unsigned i = 0; i < PACKET; i++)
		if (lanes >> i & 1)
			back[i] = mirrored(r + i, h + i, surface_normal(h + i));
	unsigned solid = shade_solid(w, r, lanes, behind, ret_light);
	shade_solid(w, back, lanes, seen, mirror);
	for (unsigned i = 0; i < PACKET; i++) {
		float deep = solid >> i & 1 ? behind[i].range_m - h[i].range_m : 50;
		if (lanes >> i & 1)
			ret_light[i] = through(w, r + i, h + i, ret_light[i], deep, mirror[i]);
	}
}

void light_along(const struct world *w, const struct ray *r, unsigned count, vec *ret_light)
{
	struct hit first[PACKET];
	unsigned lanes = (1U << count) - 1, hits = packet_all(w, r, lanes, first), clear = 0;
	for (unsigned i = 0; i < PACKET; i++)
		if (hits >> i & 1 && hit_is_clear(first + i))
			clear |= 1U << i;
	add_sky(w, r, lanes & ~hits, ret_light);
	shade(w, r, first, hits & ~clear, true, ret_light);
	if (clear)
		look_through(w, r, first, clear, ret_light);
}
