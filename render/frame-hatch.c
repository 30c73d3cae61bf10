#include "render/frame-hatch.h"
#include "render/frame.h"
#include "render/light.h"
#include "render/stroke.h"
#include <math.h>
#include <string.h>

/* How much more than by chance round dots cover that fill their squares. */
#define DOTS_EVENLY 0.2f

/* ---- how many ---- */

/* Of the mean strokes of one point. */
static float area_px(const struct frame_layer *l, const struct hatching_step *step, float chance)
{
	return l->stroke_area_px * frame_hatch_pressure(step, chance) * (1 + step->cross * chance);
}

static float luminance_of(const uint8_t rgb[3])
{
	float linear[3];
	for (int k = 0; k < 3; k++)
		linear[k] = light_of_srgb((float)rgb[k] / 255);
	return light_luminance(linear);
}

/* FRAME_EVENLY, but that opaque dots lie beside each other rather than on each other (measured on walls, with the most they come to). */
static float evenly(const struct frame_layer *l, const struct hatching_step *step)
{
	float round = fminf(step->ink.width_px / step->ink.length_px, 1);
	float box = l->ink.length_px * l->ink.width_px * step->ink.opacity;
	float full = fminf(l->stroke_area_px / fmaxf(box, 1e-3f), 1);
	return l->ink.reach_m > 0 ? FRAME_AMONG_LEAVES : FRAME_EVENLY + DOTS_EVENLY * round * full;
}

/* Strokes that let through what is wanted of white paper's light. */
static float number_for(
	const struct frame_layer *l, const struct hatching_step *step, float chance, float ink)
{
	float wanted = light_of_srgb(1 - chance * (1 - light_to_srgb(ink)));
	float bare = (wanted - ink) / fmaxf(1 - ink, 1e-3f);
	return -logf(CLAMP(bare, 1e-3f, 1)) /
	       fmaxf(evenly(l, step) * area_px(l, step, chance), 1e-3f);
}

static void want(struct frame_hatch *h, const struct frame_layer *l)
{
	float most = frame_most_per_px(l) * h->step.density;
	for (uint32_t n = 0; n < h->rows * XTOON_COLUMNS; n++) {
		float number = h->chance[n] * most;
		if (h->step.tone_by == TONE_TRUE)
			number = fminf(number_for(l, &h->step, h->chance[n],
					       h->step.colouring == COLOURING_POINT
						       ? 0
						       : luminance_of(h->rgba[n])),
				most);
		h->wanted_per_px[n] = number / STROKE_FADE_MEAN;
	}
}

float frame_hatch_wanted_most(const struct frame_hatch *h)
{
	float most = 0;
	for (uint32_t n = 0; n < h->rows * XTOON_COLUMNS; n++)
		most = fmaxf(most, h->wanted_per_px[n]);
	return most / (HATCH_SHORTEST * HATCH_FACING);
}

/* ---- colours ---- */

/* Those that are not of points are turned here, once. */
static void colour(struct frame_hatch *h, const xtoon *x)
{
	const struct hatching_step *step = &h->step;
	static const pencil_box none = { 0 };
	for (uint32_t n = 0; n < h->rows * XTOON_COLUMNS; n++) {
		float rgb[3];
		const uint8_t *from = step->colouring == COLOURING_INK ? step->ink.ink : x->rgba[n];
		for (int k = 0; k < 3; k++)
			rgb[k] = (float)from[k] / 255;
		if (step->colouring <= COLOURING_XTOON)
			pencil_box_draw(&none, step->hue_shift_deg, 0, rgb);
		for (int k = 0; k < 3; k++)
			h->rgba[n][k] = (uint8_t)(255 * rgb[k] + 0.5f);
		h->rgba[n][3] = x->rgba[n][3];
		h->chance[n] = (float)x->rgba[n][3] / 255;
	}
}

float frame_hatch_brightness(const struct frame *f, const struct frame_hatch *h, uint32_t point)
{
	const scene *s = f->scene;
	const uint8_t *rgba = s->rgba[point];
	float own = (float)scene_lightness(rgba) / 255, normal[3], along = 0;
	float stretched = (own - s->darkest) / (s->lightest - s->darkest);
	own += h->step.ink.tone_levels * (CLAMP(stretched, 0, 1) - own);
	model_unpack_normal(s->normal[point], normal);
	for (int k = 0; k < 3; k++)
		along += normal[k] * (float)f->light.site_from[k];
	return (1 - h->step.own_tone * (1 - (rgba[3] ? own : 1))) *
	       (1 - f->light.amount * (0.5f - 0.5f * along));
}

uint32_t frame_hatch_shade(const struct frame_hatch *h, float brightness, float depth_m)
{
	float row = CLAMP((depth_m - h->near_m) * h->per_m, 0, 1);
	return (uint32_t)(row * (float)(h->rows - 1) + 0.5f) * XTOON_COLUMNS +
	       (uint32_t)(CLAMP(brightness, 0, 1) * 255 + 0.5f);
}

/* ---- where ---- */

static float size_of(const scene *s)
{
	float low[3] = { INFINITY, INFINITY, INFINITY },
	      high[3] = { -INFINITY, -INFINITY, -INFINITY };
	float size2 = 0;
	for (uint32_t n = 0; n < s->chunks; n++)
		for (int k = 0; k < 3; k++) {
			const struct scene_chunk *c = &s->chunk[n];
			low[k] = fminf(low[k], c->centre_m[k] - c->half_m[k]);
			high[k] = fmaxf(high[k], c->centre_m[k] + c->half_m[k]);
		}
	for (int k = 0; k < 3 && s->chunks; k++)
		size2 += (high[k] - low[k]) * (high[k] - low[k]);
	return sqrtf(size2);
}

static void set_depths(struct frame_hatch *h, const scene *s)
{
	float far_m = h->step.far_m > 0 ? h->step.far_m : h->step.near_m + size_of(s);
	h->near_m = h->step.near_m;
	h->per_m = 1 / fmaxf(far_m - h->near_m, 1e-3f);
}

static void set_way(struct frame_hatch *h)
{
	double azimuth = h->step.line_azimuth_deg * (G_PI / 180),
	       elevation = h->step.line_elevation_deg * (G_PI / 180);
	h->site_way[0] = sin(azimuth) * cos(elevation);
	h->site_way[1] = cos(azimuth) * cos(elevation);
	h->site_way[2] = sin(elevation);
}

/* ---- all ---- */

struct frame_hatch *frame_hatch_new(const struct frame_layer *l, const scene *s, GError **error)
{
	const struct hatching_step *step = &l->step->hatching;
	g_autoptr(xtoon) x = xtoon_new(step->xtoon, step->ink.ink, error);
	if (!x)
		return NULL;
	struct frame_hatch *h = g_new0(struct frame_hatch, 1);
	size_t shades = (size_t)x->rows * XTOON_COLUMNS;
	h->step = *step;
	h->rows = x->rows;
	h->exposure = scene_exposure_of(s, step->exposure);
	h->chance = g_new(float, shades);
	h->wanted_per_px = g_new(float, shades);
	h->rgba = g_malloc(shades * sizeof *h->rgba);
	h->pencils = pencil_box_of(step->pencils);
	colour(h, x);
	want(h, l);
	set_depths(h, s);
	set_way(h);
	return h;
}

void frame_hatch_free(struct frame_hatch *h)
{
	if (!h)
		return;
	g_free(h->chance);
	g_free(h->wanted_per_px);
	g_free(h->rgba);
	g_free(h);
}
