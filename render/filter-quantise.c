#include "render/filter-planes.h"
#include <math.h>
#include <string.h>

struct quantising {
	const struct filter_image *image;
	struct quantise_step step;
	float (*lab)[3];
	float *lightness;    /* 0..100, smoothed */
	const float *colour; /* 4 a pixel, smoothed; NULL: they are not */
};

/* Steps are sharp where lightness changes by so much from pixel to pixel. */
#define GRADIENT_SHARP 3.f
#define TANH_SOFT      0.6f
#define TANH_SHARP     14.f

/* Of numbers from 0 to whole; sharp: 0..1. */
static float step_of(const struct quantise_step *s, float x, float whole, float sharp)
{
	float wide = whole / (s->levels - 1), nearest = rintf(x / wide) * wide;
	float tanh_by = TANH_SOFT + sharp * sharp * (TANH_SHARP - TANH_SOFT);
	/* tanh reaches its ends at the steps' borders, so that they join. */
	float within = (x - nearest) / wide; /* -0.5 .. 0.5 */
	return nearest + wide / 2 * (within < 0 ? -1 : 1) *
				 (1 - tanhf(tanh_by * (0.5f - fabsf(within))) / tanhf(tanh_by / 2));
}

/* ---- lightness ---- */

static float gradient_at(const struct quantising *q, uint32_t x, uint32_t y)
{
	const struct filter_image *i = q->image;
	const float *row = q->lightness + (size_t)y * i->width, *above = row - (y ? i->width : 0),
		    *below = row + (y + 1 < i->height ? i->width : 0);
	float dx = row[MIN(x + 1, i->width - 1)] - row[x ? x - 1 : 0], dy = below[x] - above[x];
	return sqrtf(dx * dx + dy * dy) / 2;
}

static void lightness_rows(const void *data, uint32_t from, uint32_t end)
{
	const struct quantising *q = data;
	for (uint32_t y = from; y < end; y++)
		for (uint32_t x = 0; x < q->image->width; x++) {
			size_t at = (size_t)y * q->image->width + x;
			float smooth = q->lightness[at],
			      part = fminf(gradient_at(q, x, y) / GRADIENT_SHARP, 1);
			q->lab[at][0] +=
				step_of(&q->step, smooth, 100, 1 - q->step.softness * (1 - part)) -
				smooth;
		}
}

static void take_rows(const void *data, uint32_t from, uint32_t end)
{
	const struct quantising *q = data;
	for (size_t at = (size_t)from * q->image->width; at < (size_t)end * q->image->width; at++)
		q->lightness[at] = q->lab[at][0];
}

static void bare_rows(const void *data, uint32_t from, uint32_t end)
{
	const struct filter_image *i = ((const struct quantising *)data)->image;
	for (size_t at = (size_t)from * i->width; at < (size_t)end * i->width; at++)
		if (filter_is_bare(i, at))
			memcpy(i->spare[at], i->paper, 4);
}

static void by_lightness(struct filter_job *j, struct quantising *q)
{
	size_t pixels = filter_pixels(&j->image);
	q->lab = filter_room_part(j->room, 0, pixels * sizeof *q->lab);
	float *own = filter_room_part(j->room, 1, pixels * sizeof *own),
	      *smooth = filter_room_part(j->room, 2, pixels * sizeof *smooth);
	filter_to_lab(j, q->lab);
	q->lightness = own;
	filter_each_rows(j, take_rows, q, j->image.height, 64);
	struct filter_blur b = { own, smooth, false, j->image.width, j->image.height, 1, 0, NULL };
	filter_blur_run(j, &b, q->step.smooth_px * j->px);
	q->lightness = smooth;
	filter_each_rows(j, lightness_rows, q, j->image.height, 64);
	filter_of_lab(j, (const float(*)[3])q->lab, j->image.spare);
	filter_each_rows(j, bare_rows, q, j->image.height, 64);
}

/* ---- channels ---- */

/* Of bytes and what lies between them. */
#define BETWEEN 4

static void channel_rows(const void *data, uint32_t from, uint32_t end)
{
	const struct quantising *q = data;
	const struct filter_image *i = q->image;
	float to[255 * BETWEEN + 1], last = q->step.levels - 1;
	for (int n = 0; n <= 255 * BETWEEN; n++) {
		float v = (float)n / (255 * BETWEEN);
		to[n] = q->step.softness > 0 ? 255 * step_of(&q->step, v, 1, 1 - q->step.softness)
					     : floorf(rintf(v * last) / last * 255 + 0.5f);
	}
	for (size_t at = (size_t)from * i->width; at < (size_t)end * i->width; at++) {
		float rgb[3];
		for (int k = 0; k < 3; k++) {
			float own = i->rgba[at][k],
			      smooth = q->colour ? q->colour[4 * at + (size_t)k] : own;
			rgb[k] = own + to[(int)(smooth * BETWEEN + 0.5f)] - smooth;
		}
		if (filter_is_bare(i, at))
			memcpy(i->spare[at], i->paper, 4);
		else
			filter_put(i->spare[at], rgb);
	}
}

struct widening {
	const struct filter_image *image;
	float *to;
};

static void widen_rows(const void *data, uint32_t from, uint32_t end)
{
	const struct widening *w = data;
	size_t line = 4 * (size_t)w->image->width;
	const uint8_t *bytes = (const uint8_t *)w->image->rgba;
	for (size_t n = from * line; n < end * line; n++)
		w->to[n] = bytes[n];
}

static void by_channels(struct filter_job *j, struct quantising *q)
{
	if (q->step.smooth_px > 0) {
		const struct filter_image *i = &j->image;
		float *own = filter_room_part(j->room, 0, filter_pixels(i) * 4 * sizeof *own),
		      *smooth = filter_room_part(j->room, 1, filter_pixels(i) * 4 * sizeof *smooth);
		struct widening w = { i, own };
		filter_each_rows(j, widen_rows, &w, i->height, 64);
		struct filter_blur b = { own, smooth, false, i->width, i->height, 4, 0, NULL };
		filter_blur_run(j, &b, q->step.smooth_px * j->px);
		q->colour = smooth;
	}
	filter_each_rows(j, channel_rows, q, j->image.height, 64);
}

void filter_quantise(struct filter_job *j, const struct step *s)
{
	struct quantising q = { .image = &j->image, .step = s->quantise };
	q.step.levels = rintf(q.step.levels);
	if (q.step.by == QUANTISE_CHANNELS)
		by_channels(j, &q);
	else
		by_lightness(j, &q);
	filter_finish(j, s->quantise.where);
}
