#include "render/filter-planes.h"
#include "render/filter-solid.h"
#include "render/grain.h"
#include <math.h>

struct wash {
	const struct filter_job *j;
	const struct watercolour_step *step;
	uint8_t (*wobbled)[4];
	float *lightness; /* of what wobbled, smoothed a little */
	float *edge;
	const float *sway[2], *turbulence, *dispersion; /* noise; NULL: not wanted */
};

/* Depths that differ by these parts are a little of another thing, and all of it. */
#define SAME  0.02f
#define OTHER 0.05f

/* Colours stay on their things: what is carried from one to another flickers where these move against each other. */
static float carried(const struct filter_image *i, size_t at, float x, float y)
{
	size_t from = (size_t)(CLAMP(y, 0, (float)(i->height - 1)) + 0.5f) * i->width +
		      (size_t)(CLAMP(x, 0, (float)(i->width - 1)) + 0.5f);
	float here = i->depth_m[at], there = i->depth_m[from];
	if (here >= FILTER_FAR || there >= FILTER_FAR)
		return here >= FILTER_FAR && there >= FILTER_FAR;
	return grain_step(OTHER, SAME, fabsf(there - here) / here);
}

/* Borders that a wet brush leaves: colours from beside. */
static void wobble_rows(const void *data, uint32_t from, uint32_t end)
{
	const struct wash *w = data;
	const struct filter_image *i = &w->j->image;
	float reach = w->step->wobble_px * w->j->px;
	for (uint32_t y = from; y < end; y++)
		for (uint32_t x = 0; x < i->width; x++) {
			size_t at = (size_t)y * i->width + x;
			float by[2], rgb[3];
			for (uint32_t k = 0; k < 2; k++)
				by[k] = 1.6f * reach * w->sway[k][at];
			float part = carried(i, at, (float)x + by[0], (float)y + by[1]);
			filter_colour_between(
				i, (float)x + part * by[0], (float)y + part * by[1], rgb);
			filter_put(w->wobbled[at], rgb);
		}
}

static void lightness_rows(const void *data, uint32_t from, uint32_t end)
{
	const struct wash *w = data;
	for (size_t at = (size_t)from * w->j->image.width; at < (size_t)end * w->j->image.width;
		at++)
		w->edge[at] = filter_lightness(w->wobbled[at]);
}

/* How much lightness changes, in a pixel of the style. */
static float change_at(const struct wash *w, uint32_t x, uint32_t y)
{
	const struct filter_image *i = &w->j->image;
	size_t row = (size_t)y * i->width, above = (size_t)(y ? y - 1 : 0) * i->width,
	       below = (size_t)MIN(y + 1, i->height - 1) * i->width;
	float dx = w->lightness[row + MIN(x + 1, i->width - 1)] -
		   w->lightness[row + (x ? x - 1 : 0)],
	      dy = w->lightness[below + x] - w->lightness[above + x];
	return sqrtf(dx * dx + dy * dy) / 2 / w->j->px;
}

/* Most at edges, but for the steepest, which are no darker than that. */
#define CHANGE_MOST       0.10f
#define CHANGE_TO_DENSITY 7.f

static float density_at(const struct wash *w, uint32_t x, uint32_t y)
{
	const struct watercolour_step *s = w->step;
	size_t at = (size_t)y * w->j->image.width + x;
	float density = 1;
	if (s->darkening > 0)
		density +=
			s->darkening * CHANGE_TO_DENSITY * fminf(change_at(w, x, y), CHANGE_MOST);
	if (w->turbulence)
		density += s->turbulence * 0.9f * w->turbulence[at];
	if (w->dispersion)
		density += s->dispersion * 0.5f * w->dispersion[at];
	return density - s->grain * 0.35f * filter_relief(w->j, x, y);
}

/* C - (C - C^2)(d - 1): a layer of pigment d times as thick (Bousseau et al. 2006, section 2.2). */
static void paint_rows(const void *data, uint32_t from, uint32_t end)
{
	const struct wash *w = data;
	const struct filter_image *i = &w->j->image;
	for (uint32_t y = from; y < end; y++)
		for (uint32_t x = 0; x < i->width; x++) {
			size_t at = (size_t)y * i->width + x;
			float density = density_at(w, x, y), rgb[3];
			for (int k = 0; k < 3; k++) {
				float c = (float)w->wobbled[at][k] * (1.f / 255);
				rgb[k] = 255 * (c - (c - c * c) * (density - 1));
			}
			filter_put(i->spare[at], rgb);
		}
}

void filter_watercolour(struct filter_job *j, const struct step *s)
{
	const struct filter_image *i = &j->image;
	size_t pixels = filter_pixels(i);
	struct wash w = { .j = j,
		.step = &s->watercolour,
		.wobbled = filter_room_part(j->room, 0, pixels * 4),
		.lightness = filter_room_part(j->room, 1, pixels * sizeof(float)),
		.edge = filter_room_part(j->room, 2, pixels * sizeof(float)) };
	const struct watercolour_step *k = w.step;
	const float *calm_m = filter_calm_depth(j, 7);
	for (uint32_t n = 0; n < 2; n++)
		w.sway[n] = filter_noise(j, 3 + n, 18 * j->px, 11 + n, calm_m);
	if (k->turbulence > 0)
		w.turbulence = filter_noise(j, 5, k->turbulence_px * j->px, 31, calm_m);
	if (k->dispersion > 0)
		w.dispersion = filter_noise(j, 6, 5 * j->px, 57, calm_m);
	filter_each_rows(j, wobble_rows, &w, i->height, 16);
	filter_each_rows(j, lightness_rows, &w, i->height, 64);
	struct filter_blur b = { w.edge, w.lightness, false, i->width, i->height, 1, 0, NULL };
	filter_blur_run(j, &b, 1.2f * j->px);
	filter_each_rows(j, paint_rows, &w, i->height, 16);
	filter_swap(&j->image);
}
