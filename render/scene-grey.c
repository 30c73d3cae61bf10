#include "render/scene-grey.h"
#include "process/segment-class.h"
#include <math.h>

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

struct scene_grey scene_grey_of(const model *m, const uint8_t *leaf_class)
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
		return (struct scene_grey){ .leaf_class = leaf_class };
	return (struct scene_grey){ least, (SCENE_GREY_LIGHT - SCENE_GREY_DARK) / (most - least),
		leaf_class };
}

/* Of red, green and blue, as parts of a grey that is as light (model_lightness): 0.299, 0.587 and 0.114 of them are 1 together. */
static const float hue_of_class[SEGMENT_CLASSES][3] = {
	[CLASS_OTHER] = { 1.05f, 0.98f, 0.97f },
	[CLASS_BUILDING] = { 1.1f, 0.98f, 0.84f },
	[CLASS_VEGETATION] = { 0.9f, 1.1f, 0.75f },
	[CLASS_TERRAIN] = { 1.04f, 1.02f, 0.79f },
	[CLASS_STRUCTURE] = { 0.98f, 1.f, 1.05f },
	[CLASS_WATER] = { 0.8f, 1.05f, 1.27f },
};

/* A sky, and the sun in the south-west. */
#define SKY 0.66f
static const float sun[3] = { -0.39f, -0.53f, 0.75f };

static float lit(const int16_t packed[2])
{
	float n[3];
	if (!packed || packed[0] == MODEL_NORMAL_NONE)
		return (1 + SKY) / 2;
	model_unpack_normal(packed, n);
	return SKY + (1 - SKY) * (sun[0] * n[0] + sun[1] * n[1] + sun[2] * n[2]);
}

void scene_grey_colour(const struct scene_grey *g, uint16_t intensity, uint32_t leaf,
	const int16_t normal[2], uint8_t ret_rgba[4])
{
	bool known = g->by > 0;
	float grey = known ? SCENE_GREY_DARK + ((float)intensity - g->least) * g->by
			   : SCENE_GREY_NONE * lit(normal);
	grey = CLAMP(grey, SCENE_GREY_DARK, SCENE_GREY_LIGHT);
	const float *hue = g->leaf_class ? hue_of_class[g->leaf_class[leaf]] : NULL;
	for (int k = 0; k < 3; k++)
		ret_rgba[k] = (uint8_t)fminf(grey * (hue ? hue[k] : 1) + 0.5f, 255);
	ret_rgba[3] = known ? 255 : 0;
}
