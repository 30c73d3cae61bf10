#ifndef RENDER_SCENE_LIST_H
#define RENDER_SCENE_LIST_H
/* The points of a chunk, kind by kind, as layers are drawn from them: each with its rank among its kind, and how much farther apart those
 * of its kind are around it than all points, which is what it is drawn by where they are drawn alone.
 *
 * A point is drawn where its rank is below what is wanted of its patch, so and so much of (pixels to its spacing)^2; along edges, of pixels
 * to its spacing (Xu & Chen 2004, section 7.4). What is wanted of surface is more the darker it is. So those of each kind stand by their
 * tones, and those of each tone in the order of rank / spacing^2, or of rank / spacing, by steps of half an octave: what may be drawn of
 * them at all is a first part of them, and little more, however much spacings differ in the chunk. In a step they are in the order of
 * ranks. */
#include "render/scene.h"

/* An entry: index in the chunk, rank among its kind, how much farther apart. */
#define SCENE_LIST_BITS 12
_Static_assert(MODEL_CHUNK_POINTS <= 1u << SCENE_LIST_BITS, "an index and a rank in a word");
static inline uint32_t scene_list_index(uint32_t entry)
{
	return entry & ((1u << SCENE_LIST_BITS) - 1);
}
static inline uint32_t scene_list_rank(uint32_t entry)
{
	return entry >> SCENE_LIST_BITS & ((1u << SCENE_LIST_BITS) - 1);
}
/* 1 to 32, in steps that are 1/51 of a power of two, which a float's bits are read as. */
#define SCENE_LIST_NEAR 0x3f800000u
#define SCENE_LIST_STEP ((1u << 23) / 51)
static inline float scene_list_farther(uint32_t entry)
{
	union {
		uint32_t bits;
		float value;
	} ret = { SCENE_LIST_NEAR + (entry >> 2 * SCENE_LIST_BITS) * SCENE_LIST_STEP };
	return ret.value;
}

/* Ridges of feature points at an edge are so many points wide; where there is but a part of the points, they are farther apart on surface,
 * but not along edges. What farther is multiplied by of FEATURE_DIRECTED. */
#define SCENE_LIST_RIDGE 2.f
static inline float scene_list_along(const struct scene_chunk *c)
{
	return 1 / (SCENE_LIST_RIDGE * sqrtf(c->part));
}

/* Between neighbours of its kind. */
static inline float scene_list_spacing_m(
	const scene *s, const struct scene_chunk *c, int kind, uint32_t entry)
{
	float all_m = s->place[c->first + scene_list_index(entry)].spacing * s->unit_m;
	float along = kind == FEATURE_DIRECTED ? scene_list_along(c) : 1;
	return all_m * scene_list_farther(entry) * along;
}

/* Dithering points alone: black ones are so far apart, and others count as no closer. */
static inline float scene_dither_m(const scene *s, const struct scene_chunk *c)
{
	return 1 / sqrtf(s->dither_per_m2 * c->part);
}

/* Of points of this kind and scene_lightness(); edges are drawn whatever their tone is. */
static inline uint32_t scene_list_tone(int kind, int lightness)
{
	return kind == FEATURE_DIRECTED ? 0 : (uint32_t)lightness * SCENE_LIST_TONES >> 8;
}

/* Where those of this kind and tone begin in the chunk's part of the list. */
uint32_t scene_list_begin(const struct scene_chunk *c, int kind, uint32_t tone);
/* And where those of them end that have a lower key than that, and some more. The key is rank / spacing^2, of FEATURE_DIRECTED rank /
 * spacing, both of its kind, where ranks are 0 to 1; dithering points are at least scene_dither_m() apart. */
uint32_t scene_list_end(const struct scene_chunk *c, int kind, uint32_t tone, float key);

/* What a thread needs to list a chunk. */
typedef struct scene_lister scene_lister;
scene_lister *scene_lister_new(void);
void scene_lister_free(scene_lister *l); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(scene_lister, scene_lister_free)
/* The points of a chunk that are there, with kinds and spacings. */
void scene_list_chunk(scene_lister *l, scene *s, struct scene_chunk *c);

#endif
