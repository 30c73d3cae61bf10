#include "render/scene-foliage.h"
#include <math.h>

/* Points are counted so far around those of the first ranks, which stand evenly in the chunk (process/chunk-order.h). */
#define AROUND_M 0.3f
#define ASKED    64u

/* What beams were wide that met the leaves that are seen is so many times what these cover: LAYERS around^DENSER spacing_m^FINER. It holds
 * within a tenth for tiles of trees of two simulated courtyards and two bridges, so that there are as many strokes as are wanted (bench
 * coherence). Nothing else that a chunk tells says more: how thick leaves hang, how they lie, how many scans met them; nor does a look at
 * the chunk alone from all sides, for others stand before it. */
#define LAYERS 0.93f
#define DENSER 0.35f
#define FINER  0.4f
#define LEAST  0.8f
#define MOST   2.2f

/* A cloud's points tell the room around each, not their beams (process/part-point.c): however many they are, CLOUD spacing_m^-CLOUD_FINER
 * is seen of them. Fitted to a forest, and to trees of a town measured from the air. */
#define CLOUD       2.0f
#define CLOUD_FINER 0.085f

/* Where so large a part of a chunk's points has no direction, what looks like surface is leaves too. */
#define FOLIAGE 0.25f

static bool is_leaf(const scene *s, uint32_t point)
{
	return s->kind[point] == FEATURE_UNDIRECTED;
}

static uint32_t count_leaves(const scene *s, const struct scene_chunk *c)
{
	uint32_t ret = 0;
	for (uint32_t i = c->first; i < c->first + c->count; i++)
		ret += is_leaf(s, i);
	return ret;
}

/* ---- how many there are around ---- */

struct places {
	float at[3][MODEL_CHUNK_POINTS];
};

static void find_places(const scene *s, const struct scene_chunk *c, struct places *ret)
{
	for (int k = 0; k < 3; k++)
		for (uint32_t i = 0; i < c->count; i++)
			ret->at[k][i] = (float)s->place[c->first + i].q[k] * c->step_m[k];
}

static uint32_t count_around(const struct places *p, uint32_t count, uint32_t of)
{
	uint32_t found = 0;
	for (uint32_t i = 0; i < count; i++) {
		float square = 0;
		for (int k = 0; k < 3; k++)
			square += (p->at[k][i] - p->at[k][of]) * (p->at[k][i] - p->at[k][of]);
		found += square < AROUND_M * AROUND_M;
	}
	return found;
}

/* Of all that the part stands for, each leaf itself with them; the geometric mean. */
static float mean_around(const scene *s, const struct scene_chunk *c)
{
	struct places p;
	float logs = 0;
	uint32_t asked = 0;
	find_places(s, c, &p);
	for (uint32_t i = 0; i < c->count && asked < ASKED; i++)
		if (is_leaf(s, c->first + i)) {
			logs += logf((float)count_around(&p, c->count, i) / c->part);
			asked++;
		}
	return expf(logs / (float)asked);
}

/* ---- what they stand for ---- */

static bool is_cloud(const scene *s, const struct scene_chunk *c, const struct model_point *p)
{
	bool is = true;
	for (uint32_t i = 0; i < c->count; i++)
		is &= !is_leaf(s, c->first + i) || p[i].spacing == p[i].size;
	return is;
}

static float count_layers(
	const scene *s, const struct scene_chunk *c, const struct model_point *p, float spacing_m)
{
	if (is_cloud(s, c, p))
		return CLOUD * powf(spacing_m, -CLOUD_FINER);
	float layers = LAYERS * powf(mean_around(s, c), DENSER) * powf(spacing_m, FINER);
	return CLAMP(layers, LEAST, MOST);
}

/* What their beams were wide; the mean is returned, of all that the part stands for. */
static float narrow(
	scene *s, const struct scene_chunk *c, const struct model_point *p, uint32_t leaves)
{
	const float larger = SCENE_UNIT_M / (s->unit_m * sqrtf(c->part));
	double sum = 0;
	for (uint32_t i = 0; i < c->count; i++) {
		uint16_t *spacing = &s->place[c->first + i].spacing;
		if (!is_leaf(s, c->first + i))
			continue;
		if (p[i].size < UINT16_MAX) /* else it is what no model can say */
			*spacing = (uint16_t)CLAMP(p[i].size * larger + 0.5f, 1, *spacing);
		sum += *spacing;
	}
	return (float)(sum / leaves) * s->unit_m * sqrtf(c->part);
}

void scene_foliage_chunk(scene *s, const struct scene_chunk *c, const struct model_point *p)
{
	uint32_t leaves = count_leaves(s, c);
	if (!leaves)
		return;
	bool is_foliage = (float)leaves >= FOLIAGE * (float)c->count;
	float spacing_m = narrow(s, c, p, leaves),
	      shorter = 1 / sqrtf(count_layers(s, c, p, spacing_m));
	for (uint32_t i = c->first; i < c->first + c->count; i++)
		if (is_leaf(s, i) || (is_foliage && s->kind[i] < FEATURE_UNDIRECTED))
			s->place[i].spacing = (uint16_t)CLAMP(
				s->place[i].spacing * shorter + 0.5f, 1, UINT16_MAX);
}
