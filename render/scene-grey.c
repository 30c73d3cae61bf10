#include "render/scene-grey.h"

#define SAMPLE MODEL_TONES_SAMPLE
/* Left out at either end: of what shines, and of what hardly came back. */
#define PART 0.02

/* The intensity that a part of the points is below. */
static uint32_t below(const uint32_t *count, uint64_t all, double part)
{
	uint64_t sum = 0;
	for (uint32_t n = 0; n <= UINT16_MAX; n++)
		if ((double)(sum += count[n]) > part * (double)all)
			return n;
	return UINT16_MAX;
}

static void count_points(const model *m, uint32_t *count)
{
	uint64_t chunks;
	const struct model_chunk *chunk = model_chunks(m, &chunks);
	for (uint64_t n = 0; n < chunks; n++)
		for (uint32_t i = 0; i < MIN(chunk[n].points, SAMPLE); i++) {
			const struct model_point *p = &model_points(m)[chunk[n].first + i];
			if (!p->rgba[3])
				count[p->intensity]++;
		}
}

struct scene_grey scene_grey_of(const model *m)
{
	const struct model_tones *tones = model_in_short(m).tones;
	g_autofree uint32_t *own = tones ? NULL : g_new0(uint32_t, UINT16_MAX + 1);
	const uint32_t *count = tones ? tones->sample : own;
	uint64_t all = 0;
	if (own)
		count_points(m, own);
	for (uint32_t n = 0; n <= UINT16_MAX; n++)
		all += count[n];
	float least = (float)below(count, all, PART), most = (float)below(count, all, 1 - PART);
	if (!all || !(most > least))
		return (struct scene_grey){ 0 };
	return (struct scene_grey){ least, (SCENE_GREY_LIGHT - SCENE_GREY_DARK) / (most - least) };
}
