#include "render/scene-take.h"
#include "render/scene-cover.h"
#include "render/scene-foliage.h"
#include "render/scene-list.h"
#include "render/scene-planes.h"
#include <math.h>
#include <string.h>

#define STEPS     65535.f /* of a position in its box */
#define SPACING_M 65535   /* in units: that or more */

/* Of the spacing: discs of surface that was met aslant. */
#define LONGEST    2.5f
#define LEAF_SLANT 1.4f
/* No plane, but leaves: of the plane's error, 0.1 mm and of the point's size. */
#define LEAF_ERROR       200.f
#define LEAF_ERROR_SIZES 0.35f

/* ---- a chunk ---- */

void scene_place_chunk(const scene *s, struct scene_chunk *c, const struct model_chunk *from)
{
	for (int k = 0; k < 3; k++) {
		c->centre_m[k] = (float)(from->centre_m[k] - s->origin_m[k]);
		c->half_m[k] = from->half_size_m[k];
		c->step_m[k] = 2 * c->half_m[k] / STEPS;
	}
	c->count = from->points;
	c->leaf = from->leaf;
	c->part = 1;
}

/* fmaxf() and fminf() of numbers, without calls; of what is none the other. */
static inline float higher(float x, float y)
{
	return x > y ? x : y;
}

static inline float lower(float x, float y)
{
	return x < y ? x : y;
}

static uint16_t units(const scene *s, float m)
{
	return (uint16_t)fminf(fmaxf(m / s->unit_m + 0.5f, 1), SPACING_M);
}

/* The third nearest point of its chunk is about as far away as points that are strewn by chance stand apart. */
static float apart_m(const struct model_point *p, uint32_t count, uint32_t of)
{
	float least[3] = { INFINITY, INFINITY, INFINITY };
	for (uint32_t i = 0; i < count; i++) {
		float square = 0;
		for (int k = 0; k < 3; k++)
			square += (p[i].position_m[k] - p[of].position_m[k]) *
				  (p[i].position_m[k] - p[of].position_m[k]);
		for (int n = 0; n < 3 && i != of; n++)
			if (square < least[n]) {
				float other = least[n];
				least[n] = square;
				square = other;
			}
	}
	return sqrtf(isinf(least[2]) ? 0 : least[2]);
}

/* Points that the model cannot say of how far they stand apart. */
static void measure_far(scene *s, const struct scene_chunk *c, const struct model_point *p)
{
	for (uint32_t i = 0; i < c->count; i++) {
		float spacing_m = p[i].spacing * SCENE_UNIT_M;
		if (p[i].spacing == UINT16_MAX)
			spacing_m = fmaxf(spacing_m, apart_m(p, c->count, i) / sqrtf(c->part));
		s->place[c->first + i].spacing = units(s, spacing_m);
		s->disc[c->first + i] = MIN(s->place[c->first + i].spacing, SCENE_DISC_MOST);
	}
}

/* Surface that was met aslant has points far apart one way: the patch of each is long. Of leaves nobody knows how they stand. */
static void measure(scene *s, uint32_t at, const struct model_point *p, float larger)
{
	float size = higher(p->size, 1), spacing = higher(p->spacing, 1);
	if (p->kind == FEATURE_UNDIRECTED || p->plane_error == MODEL_ERROR_NONE ||
		p->plane_error > higher(LEAF_ERROR, LEAF_ERROR_SIZES * size))
		spacing = lower(spacing, LEAF_SLANT * size);
	size *= larger;
	spacing *= larger;
	float disc = CLAMP(higher(spacing * spacing / size, size), spacing, LONGEST * spacing);
	s->place[at].spacing = (uint16_t)lower(spacing + 0.5f, SPACING_M);
	s->disc[at] = (uint16_t)lower(disc + 0.5f, SCENE_DISC_MOST);
}

static void copy_point(scene *s, const struct scene_chunk *c, uint32_t at,
	const struct model_point *p, float larger, const struct scene_grey *grey)
{
	for (int k = 0; k < 3; k++) {
		float q = c->step_m[k] > 0 ? (p->position_m[k] + c->half_m[k]) / c->step_m[k] : 0;
		s->place[at].q[k] = (uint16_t)lower(higher(q + 0.5f, 0), STEPS);
	}
	measure(s, at, p, larger);
	memcpy(s->normal[at], p->normal, sizeof p->normal);
	memcpy(s->direction[at], p->kind < FEATURE_UNDIRECTED ? p->principal : p->direction,
		sizeof p->direction);
	if (p->rgba[3])
		memcpy(s->rgba[at], p->rgba, sizeof p->rgba);
	else
		scene_grey_colour(grey, p->intensity, c->leaf, p->normal, s->rgba[at]);
	s->kind[at] = MIN(p->kind, FEATURE_KINDS - 1);
	s->degree[at] = p->feature;
}

static void find_extremes(const scene *s, struct scene_chunk *c)
{
	c->spacing_least_m = INFINITY;
	c->spacing_most_m = c->disc_most_m = 0;
	for (uint32_t i = c->first; i < c->first + c->count; i++) {
		float spacing_m = s->place[i].spacing * s->unit_m;
		c->disc_most_m = higher(c->disc_most_m, s->disc[i] * s->unit_m);
		c->spacing_least_m = lower(c->spacing_least_m, spacing_m);
		c->spacing_most_m = higher(c->spacing_most_m, spacing_m);
	}
}

/* ---- all of it ---- */

struct scene_taker {
	scene_cover *cover;
	scene_lister *lister;
};

scene_taker *scene_taker_new(void)
{
	scene_taker *t = g_new(scene_taker, 1);
	t->cover = scene_cover_new();
	t->lister = scene_lister_new();
	return t;
}

void scene_taker_free(scene_taker *t)
{
	if (!t)
		return;
	scene_cover_free(t->cover);
	scene_lister_free(t->lister);
	g_free(t);
}

void scene_take(scene_taker *t, scene *s, struct scene_chunk *c, const struct model_point *p,
	const struct scene_grey *grey)
{
	float larger = 1 / sqrtf(c->part);
	for (uint32_t i = 0; i < c->count; i++)
		copy_point(s, c, c->first + i, p + i, larger, grey);
	if (s->unit_m > SCENE_UNIT_M)
		measure_far(s, c, p);
	scene_cover_chunk(t->cover, s, c);
	if (grey->leaf_class && grey->leaf_class[c->leaf] == CLASS_VEGETATION)
		scene_foliage_chunk(s, c, p);
	find_extremes(s, c);
	scene_list_chunk(t->lister, s, c);
}
