#ifndef RENDER_FILTER_PLANES_H
#define RENDER_FILTER_PLANES_H
/* What several filters ask of a picture: Gaussian means, lightness, CIELab, what runs where. Rows without gaps; beyond the borders the last
 * pixels go on. Internal to filters. */
#include "render/filter.h"

#define FILTER_BLUR_RADIUS_MOST 192

/* Gaussian means of width x height x channels (at most 4) floats, or of the first three of four bytes, the last of which is 255 and stays so;
 * into another place; sigma below 0.1 copies. Weights reach to 3 sigma and sum up to 1. */
struct filter_blur {
	const void *from;
	void *to;
	bool is_bytes; /* channels is 4 then */
	uint32_t width, height, channels;
	/* Set by filter_blur_run. */
	uint32_t radius;
	const float *weight; /* [radius + 1], of the middle first */
};
void filter_blur_run(const struct filter_job *j, struct filter_blur *b, float sigma_px);
LANES_DECLARE(void, filter_blur_rows, (const void *blur, uint32_t from, uint32_t end));

/* 0..1 of sRGB as the eye weighs it. */
static inline float filter_lightness(const uint8_t rgba[4])
{
	return (float)(77 * rgba[0] + 150 * rgba[1] + 29 * rgba[2]) * (1.f / (256 * 255));
}
void filter_lightness_plane(const struct filter_job *j, float *to);
struct filter_lightness_job {
	const struct filter_image *image;
	float *to;
};
LANES_DECLARE(void, filter_lightness_rows, (const void *job, uint32_t from, uint32_t end));

/* What was written with what was there, for filter_finish_part. */
struct filter_mix_job {
	const struct filter_job *j;
	int32_t where;
	float times, less;
};
LANES_DECLARE(void, filter_mix_rows, (const void *job, uint32_t from, uint32_t end));

/* CIELab (D65) of each pixel, three floats; and back, which leaves what sRGB has not at its borders. */
void filter_to_lab(const struct filter_job *j, float (*to)[3]);
void filter_of_lab(const struct filter_job *j, const float (*from)[3], uint8_t (*to)[4]);

/* What runs where, at each pixel of a picture half as large (rounded up): means of 2 x 2 pixels, Sobel's derivatives of red, green and
 * blue summed up as a structure tensor, Gaussian means of it; then the direction of the lesser eigenvector, and (l1 - l2) / (l1 + l2). */
struct filter_flow {
	float along[2];   /* unit vector, x right and y down; 1 0 where nothing runs anywhere */
	float anisotropy; /* 0..1 */
};
struct filter_flow_plane {
	uint32_t width, height;
	struct filter_flow *at;
};
/* In parts 0 to 2 of the room. */
struct filter_flow_plane filter_flow_find(struct filter_job *j, float sigma_px);
/* Of a pixel of the whole picture. */
static inline const struct filter_flow *filter_flow_at(
	const struct filter_flow_plane *p, uint32_t x, uint32_t y)
{
	return &p->at[(size_t)(y / 2) * p->width + x / 2];
}

/* Between four pixels of a plane with so many channels, at a place in pixels' middles. */
static inline float filter_between(
	const float *plane, uint32_t width, uint32_t height, float x, float y)
{
	x = CLAMP(x, 0, (float)(width - 1));
	y = CLAMP(y, 0, (float)(height - 1));
	uint32_t left = (uint32_t)x, top = (uint32_t)y, right = MIN(left + 1, width - 1),
		 below = MIN(top + 1, height - 1);
	float u = x - (float)left, v = y - (float)top;
	const float *a = plane + (size_t)top * width, *b = plane + (size_t)below * width;
	float upper = a[left] + u * (a[right] - a[left]),
	      lower = b[left] + u * (b[right] - b[left]);
	return upper + v * (lower - upper);
}
static inline void filter_colour_between(
	const struct filter_image *i, float x, float y, float ret[3])
{
	x = CLAMP(x, 0, (float)(i->width - 1));
	y = CLAMP(y, 0, (float)(i->height - 1));
	uint32_t left = (uint32_t)x, top = (uint32_t)y, right = MIN(left + 1, i->width - 1),
		 below = MIN(top + 1, i->height - 1);
	float u = x - (float)left, v = y - (float)top;
	const uint8_t *a = i->rgba[(size_t)top * i->width + left],
		      *b = i->rgba[(size_t)top * i->width + right],
		      *c = i->rgba[(size_t)below * i->width + left],
		      *d = i->rgba[(size_t)below * i->width + right];
	for (int k = 0; k < 3; k++) {
		float upper = (float)a[k] + u * ((float)b[k] - (float)a[k]),
		      lower = (float)c[k] + u * ((float)d[k] - (float)c[k]);
		ret[k] = upper + v * (lower - upper);
	}
}

/* The paper's relief at a pixel, -1..1. */
static inline float filter_relief(const struct filter_job *j, uint32_t x, uint32_t y)
{
	const frame *f = j->f;
	uint32_t at_x = MIN(x + j->image.left, f->relief_width - 1),
		 at_y = MIN(y + j->image.top, f->relief_height - 1);
	return ((float)f->relief[(size_t)at_y * f->relief_width + at_x] - PAPER_TEXTURE_MEAN) *
	       (1 / 128.f);
}

static inline void filter_put(uint8_t to[4], const float rgb[3])
{
	for (int k = 0; k < 3; k++)
		to[k] = (uint8_t)(CLAMP(rgb[k], 0, 255) + 0.5f);
	to[3] = 255;
}

#endif
