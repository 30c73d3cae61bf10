#include "render/frame-want.h"
#include "render/light.h"
#include "render/stroke.h"
#include <float.h>
#include <math.h>
#include <string.h>

/* How suddenly tones that are too dark for a layer's strokes become the darkest that these can be. */
#define BEND 6.f

float frame_most_per_px(const struct frame_layer *l)
{
	return fminf(1 / (l->ink.spacing_px * l->ink.spacing_px), FRAME_DENSEST_PER_PX);
}

float frame_light_of(const struct frame_layer *l, float strokes_per_px)
{
	float ink = light_luminance(l->ink_linear);
	return ink + (1 - ink) * expf(-frame_evenly(l) * strokes_per_px * l->stroke_area_px);
}

/* As good as wanted where that is well below most, and never above it: all that is more becomes more. */
static float within(float wanted, float most)
{
	return wanted / powf(1 + powf(wanted / most, BEND), 1 / BEND);
}

float frame_wanted_light(const struct frame_layer *l, const scene *s, float lightness)
{
	const struct ink_step *ink = &l->ink;
	float most = fmaxf(1 - light_to_srgb(frame_light_of(l, frame_most_per_px(l))), 1e-3f);
	float stretched = (lightness - s->darkest) / (s->lightest - s->darkest);
	lightness += ink->tone_levels * (CLAMP(stretched, 0, 1) - lightness);
	float dark = fmaxf(ink->tone_white - lightness, 0) / fmaxf(ink->tone_white, 1e-3f);
	float wanted = ink->tone_strength * powf(dark, ink->tone_gamma);
	return light_of_srgb(1 - within(wanted, most));
}

/* The inverse of frame_light_of(). */
static float per_px(const struct frame_layer *l, float light)
{
	float ink = light_luminance(l->ink_linear);
	float bare = (light - ink) / fmaxf(1 - ink, 1e-3f);
	float number =
		-logf(CLAMP(bare, 1e-4f, 1)) / fmaxf(frame_evenly(l) * l->stroke_area_px, 1e-3f);
	return fminf(number, frame_most_per_px(l));
}

void frame_want(struct frame_layer *l, const scene *s)
{
	for (int n = 0; n < 256; n++) {
		float number = l->ink.tone == TONE_COLOUR
				       ? per_px(l, frame_wanted_light(l, s, (float)n / 255))
				       : frame_most_per_px(l);
		l->dithering_per_m2[n] =
			fmaxf(s->dither_per_m2 * powf(1 - (float)n / 255, s->tone_exponent), 1e-3f);
		l->wanted_per_px[n] = number / STROKE_FADE_MEAN;
	}
}

static void want_of_kind(struct frame_layer *l, const scene *s, float lit, int kind, int lightness)
{
	uint32_t tone = scene_list_tone(kind, lightness);
	float here = l->wanted_per_px[(int)((1 - lit) * (float)lightness)];
	if (l->is_queue && kind == FEATURE_DITHER)
		here *= s->dither_per_m2 / l->dithering_per_m2[lightness];
	l->wanted_most[kind] = MAX(l->wanted_most[kind], here);
	l->wanted_of_tone[kind][tone] = MAX(l->wanted_of_tone[kind][tone], here);
	if (l->is_queue && kind != FEATURE_DITHER)
		l->before_of_tone[kind][tone] =
			MIN(l->before_of_tone[kind][tone], l->dithering_per_m2[lightness]);
}

void frame_want_at_most(struct frame_layer *l, const scene *s, float lit)
{
	memset(l->wanted_most, 0, sizeof l->wanted_most);
	memset(l->wanted_of_tone, 0, sizeof l->wanted_of_tone);
	if (frame_layer_is_whole(l)) {
		l->wanted_most[FEATURE_NONE] = l->hatch   ? frame_hatch_wanted_most(l->hatch)
					       : l->paint ? l->wanted_per_px[0] / PAINT_NARROWEST
							  : l->wanted_per_px[0];
		return;
	}
	for (int kind = 0; kind < FEATURE_KINDS; kind++) {
		for (int tone = 0; tone < SCENE_LIST_TONES; tone++)
			l->before_of_tone[kind][tone] =
				l->is_queue && kind != FEATURE_DITHER ? FLT_MAX : 0;
		for (int lightness = 0; lightness < 256; lightness++)
			want_of_kind(l, s, lit, kind, lightness);
	}
}
