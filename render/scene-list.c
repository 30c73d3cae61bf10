#include "render/scene-list.h"
#include <math.h>
#include <string.h>

/* Cells of a chunk's box along each axis, for the shares of kinds around a point. */
#define CELLS 8

struct scene_lister {
	uint16_t of_kind[FEATURE_KINDS][CELLS + 2][CELLS + 2][CELLS + 2]; /* with an empty margin */
	uint32_t around[FEATURE_KINDS][CELLS][CELLS][CELLS];
	/* Of each point: its entry, and the step of its key. */
	uint32_t entry[MODEL_CHUNK_POINTS], step[MODEL_CHUNK_POINTS];
};

scene_lister *scene_lister_new(void)
{
	return g_new(scene_lister, 1);
}

void scene_lister_free(scene_lister *l)
{
	g_free(l);
}

/* ---- how far points of the same kind stand apart ---- */

static int cell_of(uint16_t q)
{
	return q * CELLS >> 16;
}

static void count_kinds(const scene *s, const struct scene_chunk *c, scene_lister *l)
{
	memset(l->of_kind, 0, sizeof l->of_kind);
	for (uint32_t i = c->first; i < c->first + c->count; i++) {
		const uint16_t *q = s->place[i].q;
		l->of_kind[s->kind[i]][cell_of(q[2]) + 1][cell_of(q[1]) + 1][cell_of(q[0]) + 1]++;
	}
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

static void add_up(const struct scene_chunk *c, scene_lister *l)
{
	for (int kind = 0; kind < FEATURE_KINDS; kind++)
		if (c->kind_end[kind] > (kind ? c->kind_end[kind - 1] : 0))
			add_up_kind(l->of_kind[kind], l->around[kind]);
		else
			memset(l->around[kind], 0, sizeof l->around[kind]);
}

/* Part of the points around that are drawn with the point: those of its own kind, or all on surface. */
static float share_at(const scene *s, const scene_lister *l, uint32_t i)
{
	const uint16_t *q = s->place[i].q;
	const uint32_t surface = 1 << FEATURE_NONE | 1 << FEATURE_DITHER, own = 1u << s->kind[i];
	uint32_t all = 0, with = 0;
	for (int kind = 0; kind < FEATURE_KINDS; kind++) {
		uint32_t around = l->around[kind][cell_of(q[2])][cell_of(q[1])][cell_of(q[0])];
		all += around;
		with += (own & surface ? surface : own) >> kind & 1 ? around : 0;
	}
	return (float)with / (float)MAX(all, 1);
}

/* The entry's part of it that comes nearest. */
static uint32_t farther_of(float times)
{
	union {
		float value;
		uint32_t bits;
	} is = { fmaxf(times, 1) };
	uint32_t steps = (is.bits - SCENE_LIST_NEAR + SCENE_LIST_STEP / 2) / SCENE_LIST_STEP;
	return MIN(steps, UINT8_MAX) << 2 * SCENE_LIST_BITS;
}

/* ---- in order ---- */

/* Twice the exponent of a float: steps of half an octave. */
static int32_t step_of(float key)
{
	union {
		float value;
		int32_t bits;
	} is = { key };
	return is.bits >> 22;
}

static float key_of(const scene *s, const struct scene_chunk *c, int kind, uint32_t entry)
{
	uint32_t many = c->kind_end[kind] - (kind ? c->kind_end[kind - 1] : 0);
	float rank = ((float)scene_list_rank(entry) + 0.5f) / (float)many;
	float spacing_m = scene_list_spacing_m(s, c, kind, entry);
	if (kind == FEATURE_DIRECTED)
		return rank / spacing_m;
	if (kind == FEATURE_DITHER)
		spacing_m = fmaxf(spacing_m, scene_dither_m(s, c));
	return rank / (spacing_m * spacing_m);
}

uint32_t scene_list_begin(const struct scene_chunk *c, int kind, uint32_t tone)
{
	if (tone)
		return c->list_ends->end[kind][tone - 1][SCENE_LIST_STEPS - 1];
	return kind ? c->kind_end[kind - 1] : 0;
}

uint32_t scene_list_end(const struct scene_chunk *c, int kind, uint32_t tone, float key)
{
	/* And what floats are rounded by. */
	int32_t below = c->list_ends->last[kind][tone] - step_of(key * 1.001f);
	if (below < 0 || !(key >= 0))
		below = 0;
	return c->list_ends->end[kind][tone][MAX(SCENE_LIST_STEPS - 1 - below, 0)];
}

static uint32_t tone_of(const scene *s, const struct scene_chunk *c, uint32_t i)
{
	return scene_list_tone(s->kind[c->first + i], scene_lightness(s->rgba[c->first + i]));
}

static void make_entries(const scene *s, struct scene_chunk *c, scene_lister *l)
{
	uint32_t rank[FEATURE_KINDS] = { 0 };
	for (uint32_t i = 0; i < c->count; i++) {
		int kind = s->kind[c->first + i];
		float times = 1;
		if (kind != FEATURE_DIRECTED)
			times = 1 / sqrtf(fmaxf(share_at(s, l, c->first + i), 1e-3f));
		l->entry[i] = i | rank[kind]++ << SCENE_LIST_BITS | farther_of(times);
		float *most_m = &c->list_spacing_most_m[kind];
		*most_m = fmaxf(*most_m, scene_list_spacing_m(s, c, kind, l->entry[i]));
		l->step[i] = (uint32_t)step_of(key_of(s, c, kind, l->entry[i]));
		int32_t *last = &c->list_ends->last[kind][tone_of(s, c, i)];
		*last = MAX(*last, (int32_t)l->step[i]);
	}
}

/* Kind by kind and tone by tone. All that is farther below is together in the first step. */
static void put_in_order(scene *s, struct scene_chunk *c, scene_lister *l)
{
	uint32_t count[FEATURE_KINDS * SCENE_LIST_TONES * SCENE_LIST_STEPS] = { 0 }, at = 0;
	uint16_t *end = &c->list_ends->end[0][0][0];
	for (uint32_t i = 0; i < c->count; i++) {
		uint32_t kind = s->kind[c->first + i], tone = tone_of(s, c, i);
		int32_t below = c->list_ends->last[kind][tone] - (int32_t)l->step[i];
		l->step[i] = (kind * SCENE_LIST_TONES + tone) * SCENE_LIST_STEPS +
			     (uint32_t)MAX(SCENE_LIST_STEPS - 1 - below, 0);
		count[l->step[i]]++;
	}
	for (uint32_t n = 0; n < G_N_ELEMENTS(count); n++) {
		uint32_t first = at;
		at += count[n];
		count[n] = first;
		end[n] = (uint16_t)at;
	}
	for (uint32_t i = 0; i < c->count; i++)
		s->list[c->first + count[l->step[i]]++] = l->entry[i];
}

void scene_list_chunk(scene_lister *l, scene *s, struct scene_chunk *c)
{
	memset(c->kind_end, 0, sizeof c->kind_end);
	memset(c->list_spacing_most_m, 0, sizeof c->list_spacing_most_m);
	memset(c->list_ends, 0, sizeof *c->list_ends);
	for (uint32_t i = c->first; i < c->first + c->count; i++)
		for (int kind = s->kind[i]; kind < FEATURE_KINDS; kind++)
			c->kind_end[kind]++;
	count_kinds(s, c, l);
	add_up(c, l);
	make_entries(s, c, l);
	put_in_order(s, c, l);
}
