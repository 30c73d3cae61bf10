#include "render/scene-take.h"
#include "render/scene-cover.h"
#include "render/scene-foliage.h"
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

/* Cells of a chunk's box along each axis, for the shares of kinds around a point. */
#define CELLS 8
/* Ridges of feature points at an edge are so many points wide. */
#define RIDGE_WIDTH 2.f

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
	memset(c->list_spacing_most_m, 0, sizeof c->list_spacing_most_m);
	for (uint32_t i = c->first; i < c->first + c->count; i++) {
		float spacing_m = s->place[i].spacing * s->unit_m;
		c->disc_most_m = higher(c->disc_most_m, s->disc[i] * s->unit_m);
		c->spacing_least_m = lower(c->spacing_least_m, spacing_m);
		c->spacing_most_m = higher(c->spacing_most_m, spacing_m);
	}
}

static void list_kinds(scene *s, struct scene_chunk *c)
{
	uint32_t at = 0;
	for (int kind = 0; kind < FEATURE_KINDS; kind++) {
		for (uint32_t i = 0; i < c->count; i++)
			if (s->kind[c->first + i] == kind)
				s->list[c->first + at++] = (uint16_t)i;
		c->kind_end[kind] = at;
	}
}

/* ---- how far points of the same kind stand apart ---- */

struct shares {
	uint16_t of_kind[FEATURE_KINDS][CELLS + 2][CELLS + 2][CELLS + 2]; /* with an empty margin */
	uint32_t around[FEATURE_KINDS][CELLS][CELLS][CELLS];
};

static int cell_of(uint16_t q)
{
	return q * CELLS >> 16;
}

static void count_kinds(const scene *s, const struct scene_chunk *c, struct shares *h)
{
	memset(h->of_kind, 0, sizeof h->of_kind);
	for (uint32_t i = c->first; i < c->first + c->count; i++)
		h->of_kind[s->kind[i]][cell_of(s->place[i].q[2]) + 1][cell_of(s->place[i].q[1]) + 1]
			  [cell_of(s->place[i].q[0]) + 1]++;
}

/* Along each axis in turn. */
static void add_up_kind(
	const uint16_t of[CELLS + 2][CELLS + 2][CELLS + 2], uint32_t ret[CELLS][CELLS][CELLS])
{
	uint32_t along[CELLS + 2][CELLS + 2][CELLS], across[CELLS + 2][CELLS][CELLS];
	for (int z = 0; z < CELLS + 2; z++)
		for (int y = 0; y < CELLS + 2; y++)
			for (int x = 0; x < CELLS; x++)
				along[z][y][x] = of[z][y][x] + of[z][y][x + 1] + of[z][y][x + 2];
	for (int z = 0; z < CELLS + 2; z++)
		for (int y = 0; y < CELLS; y++)
			for (int x = 0; x < CELLS; x++)
				across[z][y][x] =
					along[z][y][x] + along[z][y + 1][x] + along[z][y + 2][x];
	for (int z = 0; z < CELLS; z++)
		for (int y = 0; y < CELLS; y++)
			for (int x = 0; x < CELLS; x++)
				ret[z][y][x] =
					across[z][y][x] + across[z + 1][y][x] + across[z + 2][y][x];
}

static void add_up(const struct scene_chunk *c, struct shares *h)
{
	for (int kind = 0; kind < FEATURE_KINDS; kind++)
		if (c->kind_end[kind] > (kind ? c->kind_end[kind - 1] : 0))
			add_up_kind(h->of_kind[kind], h->around[kind]);
		else
			memset(h->around[kind], 0, sizeof h->around[kind]);
}

/* Part of the points around that are drawn with the point: those of its own kind, or all on surface. */
static float share_at(const scene *s, const struct shares *h, uint32_t i)
{
	int z = cell_of(s->place[i].q[2]), y = cell_of(s->place[i].q[1]),
	    x = cell_of(s->place[i].q[0]);
	const uint32_t surface = 1 << FEATURE_NONE | 1 << FEATURE_DITHER, own = 1u << s->kind[i];
	uint32_t all = 0, with = 0;
	for (int kind = 0; kind < FEATURE_KINDS; kind++) {
		uint32_t around = h->around[kind][z][y][x];
		all += around;
		with += (own & surface ? surface : own) >> kind & 1 ? around : 0;
	}
	return (float)with / (float)MAX(all, 1);
}

static float list_spacing_m(
	const scene *s, const struct scene_chunk *c, const struct shares *h, uint32_t i)
{
	float spacing_m = s->place[i].spacing * s->unit_m;
	/* Along the edge, where part of the points are farther apart than on surface. */
	if (s->kind[i] == FEATURE_DIRECTED)
		return spacing_m / (RIDGE_WIDTH * sqrtf(c->part));
	return spacing_m / sqrtf(fmaxf(share_at(s, h, i), 1e-3f));
}

static void space_list(scene *s, struct scene_chunk *c, struct shares *h)
{
	count_kinds(s, c, h);
	add_up(c, h);
	for (uint32_t k = c->first; k < c->first + c->count; k++) {
		uint32_t point = c->first + s->list[k];
		float *most_m = &c->list_spacing_most_m[s->kind[point]];
		s->list_spacing[k] = units(s, list_spacing_m(s, c, h, point));
		*most_m = fmaxf(*most_m, s->list_spacing[k] * s->unit_m);
	}
}

/* ---- all of it ---- */

struct scene_taker {
	scene_cover *cover;
	struct shares shares;
};

scene_taker *scene_taker_new(void)
{
	scene_taker *t = g_new(scene_taker, 1);
	t->cover = scene_cover_new();
	return t;
}

void scene_taker_free(scene_taker *t)
{
	if (!t)
		return;
	scene_cover_free(t->cover);
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
	list_kinds(s, c);
	space_list(s, c, &t->shares);
}
