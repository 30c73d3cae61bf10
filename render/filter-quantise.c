#include "render/filter-planes.h"
#include <math.h>
#include <string.h>

struct quantising {
	const struct filter_image *image;
	const struct quantise_step *step;
	float (*lab)[3];
	float *gradient; /* of lightness, 0..100 a pixel */
};

/* ---- lightness ---- */

/* Steps are sharp where lightness changes by so much from pixel to pixel. */
#define GRADIENT_SHARP 2.f
#define TANH_SOFT      0.6f
#define TANH_SHARP     14.f

static float step_of(const struct quantise_step *s, float lightness, float gradient)
{
	float wide = 100 / (s->levels - 1), nearest = rintf(lightness / wide) * wide;
	float sharp = 1 - s->softness * (1 - fminf(gradient / GRADIENT_SHARP, 1));
	float tanh_by = TANH_SOFT + sharp * sharp * (TANH_SHARP - TANH_SOFT);
	/* tanh reaches its ends at the steps' borders, so that they join. */
	float within = (lightness - nearest) / wide; /* -0.5 .. 0.5 */
	return nearest + wide / 2 * (within < 0 ? -1 : 1) *
				 (1 - tanhf(tanh_by * (0.5f - fabsf(within))) / tanhf(tanh_by / 2));
}

static void gradient_rows(const void *data, uint32_t from, uint32_t end)
{
	const struct quantising *q = data;
	const struct filter_image *i = q->image;
	for (uint32_t y = from; y < end; y++)
		for (uint32_t x = 0; x < i->width; x++) {
			size_t row = (size_t)y * i->width,
			       above = (size_t)(y ? y - 1 : 0) * i->width,
			       below = (size_t)MIN(y + 1, i->height - 1) * i->width;
			uint32_t left = x ? x - 1 : 0, right = MIN(x + 1, i->width - 1);
			float dx = q->lab[row + right][0] - q->lab[row + left][0],
			      dy = q->lab[below + x][0] - q->lab[above + x][0];
			q->gradient[row + x] = sqrtf(dx * dx + dy * dy) / 2;
		}
}

static void lightness_rows(const void *data, uint32_t from, uint32_t end)
{
	const struct quantising *q = data;
	for (size_t at = (size_t)from * q->image->width; at < (size_t)end * q->image->width; at++)
		q->lab[at][0] = step_of(q->step, q->lab[at][0], q->gradient[at]);
}

static void bare_rows(const void *data, uint32_t from, uint32_t end)
{
	const struct filter_image *i = ((const struct quantising *)data)->image;
	for (size_t at = (size_t)from * i->width; at < (size_t)end * i->width; at++)
		if (filter_is_bare(i, at))
			memcpy(i->spare[at], i->paper, 4);
}

/* ---- channels ---- */

static void channel_rows(const void *data, uint32_t from, uint32_t end)
{
	const struct quantising *q = data;
	const struct filter_image *i = q->image;
	uint8_t to[256];
	float last = q->step->levels - 1;
	for (int n = 0; n < 256; n++)
		to[n] = (uint8_t)(rintf((float)n / 255 * last) / last * 255 + 0.5f);
	for (size_t at = (size_t)from * i->width; at < (size_t)end * i->width; at++) {
		for (int k = 0; k < 3; k++)
			i->spare[at][k] = filter_is_bare(i, at) ? i->paper[k] : to[i->rgba[at][k]];
		i->spare[at][3] = 255;
	}
}

void filter_quantise(struct filter_job *j, const struct step *s)
{
	size_t pixels = filter_pixels(&j->image);
	struct quantise_step rounded = s->quantise;
	rounded.levels = rintf(rounded.levels);
	struct quantising q = { .image = &j->image, .step = &rounded };
	if (q.step->by == QUANTISE_CHANNELS) {
		filter_each_rows(j, channel_rows, &q, j->image.height, 64);
	} else {
		q.lab = filter_room_part(j->room, 0, pixels * sizeof *q.lab);
		q.gradient = filter_room_part(j->room, 1, pixels * sizeof *q.gradient);
		filter_to_lab(j, q.lab);
		filter_each_rows(j, gradient_rows, &q, j->image.height, 64);
		filter_each_rows(j, lightness_rows, &q, j->image.height, 64);
		filter_of_lab(j, (const float(*)[3])q.lab, j->image.spare);
		filter_each_rows(j, bare_rows, &q, j->image.height, 64);
	}
	filter_finish(j, s->quantise.where);
}
