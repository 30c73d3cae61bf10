#include "render/filter-planes.h"
#include "render/grain.h"
#include <math.h>

#define LAYERS_MOST 6

struct sketch {
	const struct filter_job *j;
	const struct pencil_step *step;
	const float *lightness;
	int layers;
	float way[LAYERS_MOST][2];
};

/* A long way between repeats of noise. */
#define PERIOD 1 << 20

/* 0..1: how much a row of strokes of a layer covers a pixel. Each has its own place beside where it would be in even rows, its own length
 * and pressure, and thins out towards its ends; it is as wide as it is dark there. */
static float row_at(const struct sketch *s, uint32_t salt, float along, float across, int number, float dark)
{
	const struct pencil_step *k = s->step;
	float px = s->j->px, spacing = k->spacing_px * px;
	uint32_t which = (uint32_t)number;
	float length = (90 + 160 * grain_unit(which, salt, 3)) * px;
	float part = along / length + grain_unit(which, salt, 5), whole = floorf(part),
	      within = part - whole;
	uint32_t piece = (uint32_t)(int32_t)whole;
	float middle = ((float)number + 0.5f + 0.6f * (grain_unit(which, piece, 11 + salt) - 0.5f)) *
		       spacing;
	float taper = grain_step(0, 0.25f, within) * grain_step(1, 0.7f, within);
	float press = 0.55f + 0.45f * grain_unit(which, piece, 7 + salt);
	float half = k->width_px * px / 2 * (0.4f + 0.6f * dark) * (0.4f + 0.6f * taper);
	return grain_step(half + 0.7f, half - 0.5f, fabsf(across - middle)) * taper * press;
}

/* What of the light a layer lets through. Two rows of strokes, one of which begins where the other ends. */
static float light_through(const struct sketch *s, int layer, float x, float y, float dark)
{
	const struct pencil_step *k = s->step;
	float px = s->j->px, spacing = k->spacing_px * px, light = 1;
	float along = x * s->way[layer][0] + y * s->way[layer][1],
	      across = y * s->way[layer][0] - x * s->way[layer][1];
	across += k->wobble_px * px *
		  grain_noise(along / (140 * px) + 4096, across / (90 * px) + 4096, PERIOD, PERIOD,
			  17 + (uint32_t)layer);
	for (uint32_t row = 0; row < 2; row++) {
		float shifted = across + 0.5f * (float)row * spacing;
		int number = (int)floorf(shifted / spacing);
		uint32_t salt = 2 * (uint32_t)layer + row;
		for (int n = number - 1; n <= number + 1; n++)
			light *= 1 - k->pressure * fminf(dark * 1.5f, 1) *
					     row_at(s, salt, along, shifted, n, dark);
	}
	return light;
}

static void sketch_rows(const void *data, uint32_t from, uint32_t end)
{
	const struct sketch *s = data;
	const struct filter_image *i = &s->j->image;
	const struct pencil_step *k = s->step;
	for (uint32_t y = from; y < end; y++)
		for (uint32_t x = 0; x < i->width; x++) {
			size_t at = (size_t)y * i->width + x;
			float light = 1, rgb[3], dark = 1 - s->lightness[at];
			/* Light tones stay bare; each layer begins where the one before is strong. */
			dark = dark * (0.45f + 0.55f * dark) * (float)s->layers * 1.15f;
			for (int n = 0; n < s->layers && dark > (float)n * 0.85f + 0.06f; n++)
				light *= light_through(s, n, (float)(x + i->left), (float)(y + i->top),
					fminf(dark - (float)n * 0.85f - 0.06f, 1));
			float ink = (1 - light) * (1 + 0.8f * filter_relief(s->j, x, y));
			ink = CLAMP(ink, 0, 1);
			for (int c = 0; c < 3; c++) {
				float own = (float)i->rgba[at][c] * 0.8f,
				      colour = (float)k->colour[c] +
					       k->own_colour * (own - (float)k->colour[c]);
				rgb[c] = (float)i->paper[c] + ink * (colour - (float)i->paper[c]);
			}
			filter_put(i->spare[at], rgb);
		}
}

void filter_pencil(struct filter_job *j, const struct step *s)
{
	static const float turn_deg[LAYERS_MOST] = { 0, 28, -33, 70, 12, -60 };
	float *lightness =
		filter_room_part(j->room, 0, filter_pixels(&j->image) * sizeof *lightness);
	struct sketch k = { .j = j,
		.step = &s->pencil,
		.lightness = lightness,
		.layers = (int)CLAMP(rintf(s->pencil.layers), 1, LAYERS_MOST) };
	for (int n = 0; n < k.layers; n++) {
		float angle = (s->pencil.angle_deg + turn_deg[n]) * (float)(G_PI / 180);
		k.way[n][0] = cosf(angle);
		k.way[n][1] = -sinf(angle);
	}
	filter_lightness_plane(j, lightness);
	filter_each_rows(j, sketch_rows, &k, j->image.height, 16);
	filter_swap(&j->image);
}
