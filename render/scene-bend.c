#include "render/scene-bend.h"
#include <math.h>

#define HOLLOW 128u

uint8_t scene_bend_pack(float per_m)
{
	float size = fabsf(per_m) * SCENE_BEND_LEAST;
	if (!(size >= 1))
		return 0;
	float step = 1.5f + SCENE_BEND_STEPS * log2f(size);
	return (uint8_t)((uint32_t)fminf(step, HOLLOW - 1) | (per_m < 0 ? HOLLOW : 0));
}

const float *scene_bend_table(void)
{
	static float table[256];
	static gsize made;
	if (g_once_init_enter(&made)) {
		for (uint32_t n = 0; n < 256; n++) {
			uint32_t step = n & (HOLLOW - 1);
			float size = exp2f(((float)step - 1) / SCENE_BEND_STEPS) / SCENE_BEND_LEAST;
			table[n] = step == 0 ? 0 : n & HOLLOW ? -size : size;
		}
		g_once_init_leave(&made, 1);
	}
	return table;
}

const uint8_t *scene_bend_halves(void)
{
	static uint8_t table[UINT16_MAX + 1];
	static gsize made;
	if (g_once_init_enter(&made)) {
		for (uint32_t n = 0; n <= UINT16_MAX; n++)
			table[n] = scene_bend_pack(model_unpack_half((uint16_t)n));
		g_once_init_leave(&made, 1);
	}
	return table;
}

static void read_chunk(const model *m, const struct model_chunk *chunk, uint8_t (*ret)[2])
{
	const struct model_point *p = model_points(m) + chunk->first;
	const uint8_t *of_half = scene_bend_halves();
	for (uint32_t i = 0; i < chunk->points; i++) {
		ret[i][0] = of_half[p[i].k1];
		ret[i][1] = of_half[p[i].k2];
	}
	product_forget(model_file(m), p, chunk->points * sizeof *p);
}

static void read_all(const scene *s, struct scene_bend_plane *b)
{
	uint64_t chunks;
	const struct model_chunk *chunk = model_chunks(b->model, &chunks);
	b->k = g_malloc((s->count + 16u) * sizeof *b->k); /* vectors read beyond the end */
#pragma omp parallel for schedule(dynamic, 8)
	for (uint64_t n = 0; n < chunks; n++)
		read_chunk(b->model, &chunk[n], b->k + chunk[n].first);
}

const uint8_t (*scene_bend(const scene *s))[2]
{
	struct scene_bend_plane *b = s->bend;
	if (!b)
		return NULL;
	if (!b->model) /* a pager fills it */
		return b->k;
	if (g_once_init_enter(&b->made)) {
		read_all(s, b);
		g_once_init_leave(&b->made, 1);
	}
	return b->k;
}

const uint8_t (*scene_bend_of_chunk(const scene *s, uint32_t chunk, uint8_t (*room)[2]))[2]
{
	struct scene_bend_plane *b = s->bend;
	uint64_t chunks;
	if (!b)
		return NULL;
	if (!b->model || g_atomic_pointer_get(&b->made))
		return (const uint8_t(*)[2])b->k + s->chunk[chunk].first;
	read_chunk(b->model, &model_chunks(b->model, &chunks)[chunk], room);
	return (const uint8_t(*)[2])room;
}

void scene_bend_free(struct scene_bend_plane *b)
{
	if (b)
		g_free(b->k);
	g_free(b);
}
