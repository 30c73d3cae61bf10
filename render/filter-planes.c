#include "render/filter-tables.h"
#include "render/light.h"
#include <math.h>
#include <string.h>

/* ---- Gaussian means ---- */

uint32_t filter_blur_weigh(float sigma_px, float ret[FILTER_BLUR_RADIUS_MOST + 1])
{
	float sum = 0;
	uint32_t radius = sigma_px < 0.1f ? 0 : (uint32_t)ceilf(3 * sigma_px);
	radius = MIN(radius, FILTER_BLUR_RADIUS_MOST);
	for (uint32_t k = 0; k <= radius; k++) {
		float away = (float)k / fmaxf(sigma_px, 0.1f);
		ret[k] = expf(-0.5f * away * away);
		sum += k ? 2 * ret[k] : ret[k];
	}
	for (uint32_t k = 0; k <= radius; k++)
		ret[k] /= sum;
	return radius;
}

void filter_blur_run(const struct filter_job *j, struct filter_blur *b, float sigma_px)
{
	float weight[FILTER_BLUR_RADIUS_MOST + 1];
	b->radius = filter_blur_weigh(sigma_px, weight);
	b->weight = weight;
	/* Each part of the rows begins with some that are the last ones of the part before. */
	uint32_t parts = 2 * frame_threads(j->f);
	filter_each_rows(j, LANES_OF(j->lanes, filter_blur_rows), b, b->height,
		MAX((b->height + parts - 1) / parts, 6 * b->radius + 32));
}

/* ---- lightness ---- */

struct converting {
	const struct filter_image *image;
	float (*lab)[3];
	const float (*from)[3];
	uint8_t (*to)[4];
};

void filter_lightness_plane(const struct filter_job *j, float *to)
{
	struct filter_lightness_job l = { &j->image, to };
	filter_each_rows(j, LANES_OF(j->lanes, filter_lightness_rows), &l, j->image.height, 64);
}

/* ---- CIELab ---- */

#define ROOTS 4096
static float root_of[ROOTS + 2]; /* f() of CIELab at n / ROOTS */

static float lab_f(float t)
{
	return t > 216.f / 24389 ? cbrtf(t) : (24389.f / 27 * t + 16) / 116;
}

static float lab_f_back(float f)
{
	float cube = f * f * f;
	return cube > 216.f / 24389 ? cube : (116 * f - 16) * 27 / 24389;
}

static void make_roots(void)
{
	static gsize made;
	if (!g_once_init_enter(&made))
		return;
	for (int n = 0; n < ROOTS + 2; n++)
		root_of[n] = lab_f((float)n / ROOTS);
	g_once_init_leave(&made, 1);
}

static inline float root_at(float t)
{
	float place = CLAMP(t, 0, 1) * ROOTS;
	int n = (int)place;
	return root_of[n] + (place - (float)n) * (root_of[n + 1] - root_of[n]);
}

static const float to_xyz[3][3] = { { 0.4124564f / 0.95047f, 0.3575761f / 0.95047f,
					    0.1804375f / 0.95047f },
	{ 0.2126729f, 0.7151522f, 0.0721750f },
	{ 0.0193339f / 1.08883f, 0.1191920f / 1.08883f, 0.9503041f / 1.08883f } };
static const float of_xyz[3][3] = { { 3.2404542f * 0.95047f, -1.5371385f, -0.4985314f * 1.08883f },
	{ -0.9692660f * 0.95047f, 1.8760108f, 0.0415560f * 1.08883f },
	{ 0.0556434f * 0.95047f, -0.2040259f, 1.0572252f * 1.08883f } };

static void to_lab_rows(const void *data, uint32_t from, uint32_t end)
{
	const struct converting *c = data;
	const float *light = light_of_bytes();
	size_t width = c->image->width;
	for (size_t at = from * width; at < end * width; at++) {
		const uint8_t *rgb = c->image->rgba[at];
		float f[3];
		for (int k = 0; k < 3; k++)
			f[k] = root_at(to_xyz[k][0] * light[rgb[0]] + to_xyz[k][1] * light[rgb[1]] +
				       to_xyz[k][2] * light[rgb[2]]);
		c->lab[at][0] = 116 * f[1] - 16;
		c->lab[at][1] = 500 * (f[0] - f[1]);
		c->lab[at][2] = 200 * (f[1] - f[2]);
	}
}

void filter_to_lab(const struct filter_job *j, float (*to)[3])
{
	struct converting c = { .image = &j->image, .lab = to };
	make_roots();
	filter_each_rows(j, to_lab_rows, &c, j->image.height, 64);
}

static void of_lab_rows(const void *data, uint32_t from, uint32_t end)
{
	const struct converting *c = data;
	const uint8_t *srgb = light_srgb_bytes();
	size_t width = c->image->width;
	for (size_t at = from * width; at < end * width; at++) {
		float y = (c->from[at][0] + 16) / 116;
		float xyz[3] = { lab_f_back(y + c->from[at][1] / 500), lab_f_back(y),
			lab_f_back(y - c->from[at][2] / 200) };
		for (int k = 0; k < 3; k++) {
			float light = of_xyz[k][0] * xyz[0] + of_xyz[k][1] * xyz[1] +
				      of_xyz[k][2] * xyz[2];
			c->to[at][k] = srgb[(int)(CLAMP(light, 0, 1) * (LIGHT_STEPS - 1) + 0.5f)];
		}
		c->to[at][3] = 255;
	}
}

void filter_of_lab(const struct filter_job *j, const float (*from)[3], uint8_t (*to)[4])
{
	struct converting c = { .image = &j->image, .from = from, .to = to };
	filter_each_rows(j, of_lab_rows, &c, j->image.height, 64);
}

/* ---- what runs where ---- */

struct looking {
	const struct filter_image *image;
	uint32_t width, height; /* half as large */
	float *half;            /* 3 a pixel */
	float *tensor;          /* 3 a pixel: xx xy yy */
	const float *mean;
	struct filter_flow *flow;
};

static void halve_rows(const void *data, uint32_t from, uint32_t end)
{
	const struct looking *l = data;
	const struct filter_image *i = l->image;
	for (uint32_t y = from; y < end; y++) {
		const uint8_t(*upper)[4] = i->rgba + (size_t)(2 * y) * i->width,
		      (*lower)[4] = i->rgba + (size_t)MIN(2 * y + 1, i->height - 1) * i->width;
		float *to = l->half + (size_t)y * l->width * 3;
		for (uint32_t x = 0; x < l->width; x++, to += 3) {
			uint32_t left = 2 * x, right = MIN(left + 1, i->width - 1);
			for (int k = 0; k < 3; k++)
				to[k] = (float)(upper[left][k] + upper[right][k] + lower[left][k] +
						lower[right][k]) *
					(1 / 1020.f);
		}
	}
}

static void tensor_rows(const void *data, uint32_t from, uint32_t end)
{
	const struct looking *l = data;
	for (uint32_t y = from; y < end; y++) {
		const float *row[3] = { l->half + (size_t)(y ? y - 1 : 0) * l->width * 3,
			l->half + (size_t)y * l->width * 3,
			l->half + (size_t)MIN(y + 1, l->height - 1) * l->width * 3 };
		float *to = l->tensor + (size_t)y * l->width * 3;
		for (uint32_t x = 0; x < l->width; x++, to += 3) {
			size_t a = 3 * (size_t)(x ? x - 1 : 0), b = 3 * (size_t)x,
			       c = 3 * (size_t)MIN(x + 1, l->width - 1);
			float xx = 0, xy = 0, yy = 0;
			for (int k = 0; k < 3; k++) {
				float right = row[0][c + k] + 2 * row[1][c + k] + row[2][c + k] -
					      row[0][a + k] - 2 * row[1][a + k] - row[2][a + k];
				float down = row[2][a + k] + 2 * row[2][b + k] + row[2][c + k] -
					     row[0][a + k] - 2 * row[0][b + k] - row[0][c + k];
				xx += right * right;
				xy += right * down;
				yy += down * down;
			}
			to[0] = xx / 16;
			to[1] = xy / 16;
			to[2] = yy / 16;
		}
	}
}

static struct filter_flow flow_of(const float tensor[3])
{
	float mean = (tensor[0] + tensor[2]) / 2, half = (tensor[0] - tensor[2]) / 2,
	      apart = sqrtf(half * half + tensor[1] * tensor[1]);
	/* The lesser eigenvector is across the greater one, (l1 - yy, xy) or (xy, l1 - xx). */
	float x = half > 0 ? -tensor[1] : apart - half, y = half > 0 ? apart + half : -tensor[1];
	float length = sqrtf(x * x + y * y);
	struct filter_flow f = { { 1, 0 }, mean > 1e-9f ? apart / mean : 0 };
	if (length > 1e-12f) {
		f.along[0] = x / length;
		f.along[1] = y / length;
	}
	return f;
}

static void flow_rows(const void *data, uint32_t from, uint32_t end)
{
	const struct looking *l = data;
	for (size_t at = (size_t)from * l->width; at < (size_t)end * l->width; at++)
		l->flow[at] = flow_of(l->mean + 3 * at);
}

struct filter_flow_plane filter_flow_find(struct filter_job *j, float sigma_px)
{
	struct looking l = { .image = &j->image,
		.width = (j->image.width + 1) / 2,
		.height = (j->image.height + 1) / 2 };
	size_t bytes = (size_t)l.width * l.height * 3 * sizeof(float);
	l.half = filter_room_part(j->room, 0, bytes);
	l.tensor = filter_room_part(j->room, 1, bytes);
	l.flow = filter_room_part(j->room, 2, bytes);
	filter_each_rows(j, halve_rows, &l, l.height, 32);
	filter_each_rows(j, tensor_rows, &l, l.height, 32);
	struct filter_blur b = { l.tensor, l.half, false, l.width, l.height, 3, 0, NULL };
	filter_blur_run(j, &b, sigma_px * j->px / 2);
	l.mean = l.half;
	filter_each_rows(j, flow_rows, &l, l.height, 32);
	return (struct filter_flow_plane){ l.width, l.height, l.flow };
}
