#include "render/depth-inpaint.h"
#include <stdlib.h>

static bool is_similar(const struct depth_inpainting *d, size_t at)
{
	int change = (int)depth_inpaint_grey(d->image->rgba[at]) - (int)d->image->grey_before[at];
	return (float)abs(change) <= d->threshold * 255;
}

static float depth_around(const struct depth_inpainting *d, int x, int y)
{
	const struct filter_image *i = d->image;
	int top = MAX(y - d->radius, 0), end = MIN(y + d->radius + 1, (int)i->height);
	double sum = 0;
	uint32_t count = 0;
	for (int at_y = top; at_y < end; at_y++) {
		const float *row = i->depth_m + (size_t)at_y * i->width;
		int reach = 0, down2 = (at_y - y) * (at_y - y);
		while ((reach + 1) * (reach + 1) + down2 <= d->radius * d->radius)
			reach++;
		for (int at_x = MAX(x - reach, 0); at_x < MIN(x + reach + 1, (int)i->width); at_x++)
			if (row[at_x] < FILTER_FAR) {
				sum += (double)row[at_x];
				count++;
			}
	}
	return count ? (float)(sum / count) : i->depth_m[(size_t)y * i->width + (size_t)x];
}

static void inpaint_rows(const void *data, uint32_t from, uint32_t end)
{
	const struct depth_inpainting *d = data;
	uint32_t width = d->image->width;
	for (uint32_t y = from; y < end; y++)
		for (uint32_t x = 0; x < width; x++) {
			size_t at = (size_t)y * width + x;
			d->to[at] = is_similar(d, at) ? d->image->depth_m[at]
						      : depth_around(d, (int)x, (int)y);
		}
}

void depth_inpaint(const struct filter_job *j, const struct depth_inpainting *d)
{
	filter_each_rows(j, inpaint_rows, d, d->image->height, 16);
}
