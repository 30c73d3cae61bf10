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

/* Light of the sun on a surface, 0 in shadow; leaves let some through. */
static vec sunlight(const struct world *w, const struct hit *h)
{
	vec s = w->site.light.towards_sun;
	float faces = dot(h->shading, s), side = dot(h->normal, s) < 0 ? -1 : 1;
	bool leaf = h->material->kind == MATERIAL_LEAF;
	if (leaf)
		faces = faces > 0 ? faces * 0.75f + 0.25f : 0.25f - 0.3f * faces;
	if (faces <= 0 || (!leaf && side < 0))
		return (vec){ 0 };
	struct ray r = { h->place + h->normal * (side * 0.003f), s, 300 };
	return trace_blocked(w, &r) ? (vec){ 0 } : w->site.light.sun * faces;
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

/* Diffuse light that leaves a hit towards a probe: the sun, and what the last pass gathered. */
static vec probe_bounce(const struct world *w, const struct ray *r, const struct hit *h, bool again)
{
	vec albedo = material_albedo(h->material, h->place, h->normal, 0.5f, h->face);
	vec ambient = again ? light_ambient(w, h->place, h->normal)
			    : w->site.light.zenith * 0.35f + w->site.light.fill;
	(void)r;
	return albedo * (sunlight(w, h) + ambient + h->material->emission);
}

static void gather_probe(const struct world *w, vec place, bool again, unsigned rays, vec *light)
{
	vec sum[4] = { { 0 } };
	for (unsigned i = 0; i < rays; i++) {
		float z = 1 - (2 * (float)i + 1) / rays, a = 2.399963f * (float)i;
		float level = sqrtf(1 - z * z);
		struct ray r = { place, { level * cosf(a), level * sinf(a), z }, 300 };
		struct hit h;
		vec in = trace_solid(w, &r, false, &h)
				 ? probe_bounce(w, &r, &h, again)
				 : light_sky(&w->site.light, r.direction, false);
		sum[0] += in;
		for (int k = 0; k < 3; k++)
			sum[k + 1] += in * r.direction[k];
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
static float openness(const struct world *w, const struct hit *h)
{
	const float reach_m = 1.0f;
	vec n = h->normal, s = w->site.light.towards_sun;
	float level = 1 - n[2] * n[2];
	vec lean = (vec){ -s[0], -s[1], 0 } * (1 - level) + (vec){ 0, 0, 1 } * level;
	struct ray r = { h->place + n * 0.003f, unit(n + lean * 0.9f), reach_m };
	float free = trace_distance(w, &r) / reach_m;
	return 0.45f + 0.6f * free;
}

static vec haze(const struct light *l, vec colour, float range_m)
{
	return mix(colour, l->horizon * 0.9f, 1 - expf(-range_m / l->haze_m));
}

static vec shade(const struct world *w, const struct ray *r, const struct hit *h, bool fine)
{
	const struct material *m = h->material;
	const struct light *l = &w->site.light;
	vec albedo = material_albedo(m, h->place, h->normal, hit_footprint(r, h), h->face);
	vec ambient = light_ambient(w, h->place, h->shading);
	if (fine && h->range_m < 60 && m->kind != MATERIAL_LEAF)
		ambient *= openness(w, h);
	else if (m->kind == MATERIAL_LEAF && dot(h->shading, r->direction) > 0)
		ambient *= 0.6f; /* from within the crown or below it */
	vec colour = albedo * (sunlight(w, h) + ambient + m->emission);
	if (m->gloss > 0) {
		float c = 1 - clamp_unit(-dot(r->direction, h->shading));
		vec away = r->direction - h->shading * (2 * dot(r->direction, h->shading));
		float share = m->gloss + (1 - m->gloss) * c * c * c * c * c;
		colour = mix(colour, light_ambient(w, h->place, away), share);
	}
	return haze(l, colour, h->range_m);
}

static vec mirrored(const struct world *w, const struct ray *r, const struct hit *h, vec normal)
{
	vec away = unit(r->direction - normal * (2 * dot(r->direction, normal)));
	struct ray back = { h->place + h->normal * 0.003f, away, 400 };
	struct hit seen;
	return trace_solid(w, &back, true, &seen) ? shade(w, &back, &seen, false)
						  : light_sky(&w->site.light, away, true);
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

/* behind: light from beyond the pane, or from the bed of the water `deep` metres further. */
static vec through(
	const struct world *w, const struct ray *r, const struct hit *h, vec behind, float deep)
{
	bool water = h->material->kind == MATERIAL_WATER;
	vec normal = water ? ripple(h) : h->normal;
	float c = 1 - clamp_unit(-dot(r->direction, normal)), f0 = water ? 0.03f : 0.08f;
	float share = f0 + (1 - f0) * c * c * c * c * c;
	vec tint = material_albedo(h->material, h->place, h->normal, 1, 0);
	vec body = tint * (light_ambient(w, h->place, h->normal) + w->site.light.sun * 0.4f);
	vec inner = water ? mix(body, behind * tint * 2, expf(-1.5f * deep)) : behind * 0.85f;
	return mix(inner, mirrored(w, r, h, normal), share);
}

vec light_along(const struct world *w, const struct ray *r)
{
	const struct light *l = &w->site.light;
	struct hit first, behind;
	if (!trace_all(w, r, true, &first))
		return light_sky(l, r->direction, true);
	if (!hit_is_clear(&first))
		return shade(w, r, &first, true);
	bool any = trace_solid(w, r, true, &behind);
	vec light = any ? shade(w, r, &behind, false) : light_sky(l, r->direction, true);
	return through(w, r, &first, light, any ? behind.range_m - first.range_m : 50);
}
