#include "render/bench-coherence-private.h"
#include "render/light.h"
#include <math.h>

#define TILE_COVERED 0.99

/* ---- toned layers alone ---- */

static bool is_toned(const struct step *s)
{
	if (step_is_hatching(s))
		return s->hatching.tone_by == TONE_TRUE;
	return step_is_ink(s) && s->ink.tone == TONE_COLOUR;
}

drawing *tone_drawing(drawing *d)
{
	uint32_t toned = 0;
	for (guint p = 0; p < d->pipelines->len; p++) {
		struct pipeline *line = &g_array_index(d->pipelines, struct pipeline, p);
		uint32_t kept = 0;
		for (uint32_t n = 0; n < line->layers; n++)
			if (is_toned(&line->steps[n]))
				line->steps[kept++] = line->steps[n];
		line->layers = kept;
		line->filters = 0;
		toned += kept;
	}
	d->whole.paper.grain = 0;
	if (toned)
		return d;
	drawing_free(d);
	return NULL;
}

/* ---- what light there should be ---- */

/* By pipeline and lightness: of the paper's light. */
struct targets {
	float curve[256];
};

/* Of hatching at the near end of its X-Toon. */
static float wanted_light(const struct frame_layer *l, const scene *s, int lightness)
{
	if (!l->hatch)
		return frame_wanted_light(l, s, (float)lightness / 255);
	float ink = light_luminance(l->ink_linear);
	return light_of_srgb(1 - l->hatch->chance[lightness] * (1 - light_to_srgb(ink)));
}

static struct targets *targets_of(const frame *f)
{
	struct targets *t = g_new(struct targets, 1 << MASK_PIPELINE_BITS);
	for (int p = 0; p < 1 << MASK_PIPELINE_BITS; p++)
		for (int n = 0; n < 256; n++)
			t[p].curve[n] = NAN;
	for (uint32_t l = 0; l < f->layers; l++) {
		struct targets *of = &t[f->layer[l].pipeline];
		for (int n = 0; n < 256; n++) {
			bool first = isnan(of->curve[n]);
			float curve = wanted_light(&f->layer[l], f->scene, n);
			of->curve[n] = first ? curve : of->curve[n] * curve;
		}
	}
	return t;
}

/* ---- tiles ---- */

struct tile {
	double light, curve;
	uint32_t covered;
};

static struct tile tile_of(const struct targets *t, const struct shot *s,
	const struct picture_buffer *p, const uint8_t *lightness, uint32_t x0, uint32_t y0)
{
	struct tile sum = { 0 };
	const float *light = light_of_bytes();
	for (uint32_t y = y0; y < y0 + TILE_PX; y++)
		for (uint32_t x = x0; x < x0 + TILE_PX; x++) {
			size_t at = (size_t)y * p->width + x;
			int32_t key = mask_key(s->mask, (int32_t)x, (int32_t)y);
			const struct targets *here = &t[key & ((1 << MASK_PIPELINE_BITS) - 1)];
			float rgb[3];
			if (key == MASK_EMPTY || isnan(here->curve[lightness[at]]))
				continue;
			for (int k = 0; k < 3; k++)
				rgb[k] = light[p->rgba[at][k]];
			sum.light += light_luminance(rgb);
			sum.curve += here->curve[lightness[at]];
			sum.covered++;
		}
	return sum;
}

static float paper_light(const frame *f)
{
	float rgb[3];
	for (int k = 0; k < 3; k++)
		rgb[k] = light_of_srgb((float)f->drawing->whole.paper.colour[k] / 255);
	return light_luminance(rgb);
}

bool tone_add(struct tone_sums *t, frame *f, const struct shot *s, const uint8_t *lightness,
	struct picture_buffer *picture, GError **error)
{
	if (!frame_move(f, &s->camera, error))
		return false;
	draw_frame(NULL, f, picture, NULL);
	g_autofree struct targets *targets = targets_of(f);
	double paper = paper_light(f);
	const uint32_t across = picture->width / TILE_PX;
	g_autofree bool *limited = g_new0(bool, across *(picture->height / TILE_PX) + 1);
	for (uint32_t l = 0; l < f->layers; l++)
		density_find_limited(f, s, l, lightness, limited);
	for (uint32_t y = 0; y + TILE_PX <= picture->height; y += TILE_PX)
		for (uint32_t x = 0; x + TILE_PX <= picture->width; x += TILE_PX) {
			struct tile one = tile_of(targets, s, picture, lightness, x, y);
			if (one.covered < TILE_COVERED * TILE_PX * TILE_PX)
				continue;
			double light = one.light / paper / one.covered,
			       curve = one.curve / one.covered;
			double error2 = (light - curve) * (light - curve);
			t->error2_all += error2;
			t->tiles_all++;
			if (limited[y / TILE_PX * across + x / TILE_PX])
				continue;
			t->error2 += error2;
			t->light += light;
			t->wanted += curve;
			t->tiles++;
		}
	return true;
}
