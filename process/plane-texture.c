#include "process/plane-texture.h"
#include <math.h>
#include <string.h>

#define TEXELS_MOST 4e6f
#define LEVELS_MOST 24
/* Of one point that stands as far from others as most: what a texel needs, not to take on what is around it. */
#define ENOUGH 0.25f

/* Colour and weight. */
typedef float sum[4];

struct level {
	uint32_t width, height;
	sum *at;
};

static float of_srgb(float s)
{
	return s <= 0.04045f ? s / 12.92f : powf((s + 0.055f) / 1.055f, 2.4f);
}

static uint8_t to_srgb(float l)
{
	float s = l <= 0.0031308f ? l * 12.92f : 1.055f * powf(l, 1 / 2.4f) - 0.055f;
	return (uint8_t)lrintf(fminf(fmaxf(s, 0), 1) * 255);
}

static struct level level_new(uint32_t width, uint32_t height)
{
	return (struct level){ width, height, g_new0(sum, (size_t)width * height) };
}

/* ---- points into texels ---- */

static void add_at(struct level *l, int x, int y, float weight, const float colour[3])
{
	if (x < 0 || y < 0 || x >= (int)l->width || y >= (int)l->height || !(weight > 0))
		return;
	float *to = l->at[(size_t)y * l->width + (uint32_t)x];
	for (int k = 0; k < 3; k++)
		to[k] += weight * colour[k];
	to[3] += weight;
}

static void add_spot(const struct plane_draft *d, struct level *l, const struct plane_spot *s,
	const float colour[3])
{
	float x = (s->at[0] - d->r.low_m[0]) / d->r.texel_m - 0.5f,
	      y = (s->at[1] - d->r.low_m[1]) / d->r.texel_m - 0.5f;
	float left = floorf(x), low = floorf(y), part[2] = { x - left, y - low };
	float close = d->r.texel_m / fmaxf(s->spacing_m, 1e-4f), weight = close * close;
	for (int k = 0; k < 4; k++)
		add_at(l, (int)left + (k & 1), (int)low + (k >> 1),
			weight * (k & 1 ? part[0] : 1 - part[0]) * (k >> 1 ? part[1] : 1 - part[1]),
			colour);
}

static bool is_coloured(const struct plane_spot *spot, uint32_t count)
{
	uint32_t coloured = 0, all = 0;
	for (uint32_t n = 0; n < count; n++)
		if (!spot[n].is_beside) {
			coloured += spot[n].rgba[3] > 0;
			all++;
		}
	return 2 * coloured > all;
}

static void add_spots(const struct plane_draft *d, struct level *l, const struct plane_spot *spot,
	uint32_t count, bool coloured)
{
	float linear[256];
	for (int n = 0; n < 256; n++)
		linear[n] = of_srgb((float)n / 255);
	for (uint32_t n = 0; n < count; n++) {
		float grey = (float)spot[n].intensity / 65535, colour[3] = { grey, grey, grey };
		for (int k = 0; k < 3 && coloured; k++)
			colour[k] = linear[spot[n].rgba[k]];
		if (!spot[n].is_beside && (!coloured || spot[n].rgba[3]))
			add_spot(d, l, &spot[n], colour);
	}
}

/* ---- pull and push ---- */

/* Weights above this say no more than this does. */
static void settle(struct level *l, float enough)
{
	for (size_t n = 0; n < (size_t)l->width * l->height; n++) {
		float *at = l->at[n], weight = at[3];
		for (int k = 0; k < 3 && weight > 0; k++)
			at[k] /= weight;
		at[3] = fminf(weight / enough, 1);
	}
}

static struct level pull(const struct level *fine)
{
	struct level l = level_new((fine->width + 1) / 2, (fine->height + 1) / 2);
	for (uint32_t y = 0; y < fine->height; y++)
		for (uint32_t x = 0; x < fine->width; x++) {
			const float *from = fine->at[(size_t)y * fine->width + x];
			add_at(&l, (int)x / 2, (int)y / 2, from[3], from);
		}
	settle(&l, 1);
	return l;
}

static const float *clamped(const struct level *l, int x, int y)
{
	x = CLAMP(x, 0, (int)l->width - 1);
	y = CLAMP(y, 0, (int)l->height - 1);
	return l->at[(size_t)y * l->width + (uint32_t)x];
}

/* Between the middles of the coarse texels. */
static void between(const struct level *coarse, uint32_t x, uint32_t y, float ret[3])
{
	int at[2] = { (int)x / 2, (int)y / 2 }, beside[2] = { x & 1 ? 1 : -1, y & 1 ? 1 : -1 };
	for (int k = 0; k < 3; k++)
		ret[k] = 9.f / 16 * clamped(coarse, at[0], at[1])[k] +
			 3.f / 16 * clamped(coarse, at[0] + beside[0], at[1])[k] +
			 3.f / 16 * clamped(coarse, at[0], at[1] + beside[1])[k] +
			 1.f / 16 * clamped(coarse, at[0] + beside[0], at[1] + beside[1])[k];
}

static void push(const struct level *coarse, struct level *fine)
{
	for (uint32_t y = 0; y < fine->height; y++)
		for (uint32_t x = 0; x < fine->width; x++) {
			float *at = fine->at[(size_t)y * fine->width + x], around[3];
			if (at[3] >= 1)
				continue;
			between(coarse, x, y, around);
			for (int k = 0; k < 3; k++)
				at[k] = around[k] + at[3] * (at[k] - around[k]);
			at[3] = 1;
		}
}

static void fill(struct level *finest)
{
	struct level level[LEVELS_MOST] = { *finest };
	int count = 1;
	while (count < LEVELS_MOST && (level[count - 1].width > 1 || level[count - 1].height > 1)) {
		level[count] = pull(&level[count - 1]);
		count++;
	}
	for (int n = count - 2; n >= 0; n--)
		push(&level[n + 1], &level[n]);
	for (int n = 1; n < count; n++)
		g_free(level[n].at);
}

/* ---- all ---- */

static void enclose(struct plane_draft *d, float texel_m, float margin_m)
{
	float low[2] = { INFINITY, INFINITY }, high[2] = { -INFINITY, -INFINITY };
	for (guint n = 0; n < d->vertex->len; n++)
		for (int k = 0; k < 2; k++) {
			float at = ((float(*)[2])(void *)d->vertex->data)[n][k];
			low[k] = fminf(low[k], at - margin_m);
			high[k] = fmaxf(high[k], at + margin_m);
		}
	float area_m2 = (high[0] - low[0]) * (high[1] - low[1]);
	d->r.texel_m = fmaxf(texel_m, sqrtf(area_m2 / TEXELS_MOST));
	for (int k = 0; k < 2; k++)
		d->r.low_m[k] = low[k];
	d->r.width = (uint32_t)ceilf((high[0] - low[0]) / d->r.texel_m) + 1;
	d->r.height = (uint32_t)ceilf((high[1] - low[1]) / d->r.texel_m) + 1;
}

void plane_texture(struct plane_draft *d, const struct plane_spot *spot, uint32_t count,
	float texel_m, float margin_m)
{
	bool coloured = is_coloured(spot, count);
	enclose(d, texel_m, margin_m);
	float close = d->r.texel_m / fmaxf(d->spacing_m, 1e-4f);
	struct level l = level_new(d->r.width, d->r.height);
	size_t texels = (size_t)l.width * l.height;
	add_spots(d, &l, spot, count, coloured);
	settle(&l, ENOUGH * close * close);
	fill(&l);
	d->texel = g_malloc(texels * sizeof *d->texel);
	for (size_t n = 0; n < texels; n++) {
		uint32_t grey = (uint32_t)lrintf(l.at[n][0] * 65535);
		for (int k = 0; k < 3 && coloured; k++)
			d->texel[n][k] = to_srgb(l.at[n][k]);
		if (!coloured) {
			d->texel[n][0] = (uint8_t)(grey & 255);
			d->texel[n][1] = (uint8_t)(grey >> 8);
			d->texel[n][2] = 0;
		}
		d->texel[n][3] = coloured ? 255 : 0;
	}
	g_free(l.at);
}
