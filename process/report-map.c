/* Where two scans agree and where they do not, cell by cell of the second. */
#include "process/report-private.h"
#include <math.h>
#include <png.h>
#include <string.h>

#define WIDTH_MAX     1200u
#define FULL_COLOUR_M 0.02f /* distances from here on have the full colour */

char *report_encode(const uint8_t *pixels, uint32_t width, uint32_t height, int channels)
{
	png_image image = { .version = PNG_IMAGE_VERSION,
		.width = width,
		.height = height,
		.format = channels == 1 ? PNG_FORMAT_GRAY : PNG_FORMAT_RGB };
	png_alloc_size_t length = PNG_IMAGE_PNG_SIZE_MAX(image);
	g_autofree uint8_t *png = g_malloc(length);
	if (!png_image_write_to_memory(&image, png, &length, 0, pixels, 0, NULL))
		return NULL;
	return g_base64_encode(png, length);
}

/* Blue: nearer than the other scan's surface; orange: behind it. */
static void tint(float distance_m, uint8_t rgb[3])
{
	static const float even[3] = { 226, 230, 222 }, near[3] = { 33, 102, 172 },
			   far[3] = { 214, 96, 20 };
	float t = fminf(fabsf(distance_m) / FULL_COLOUR_M, 1);
	const float *end = distance_m < 0 ? near : far;
	for (int k = 0; k < 3; k++)
		rgb[k] = (uint8_t)(even[k] + t * (end[k] - even[k]));
}

static void colour_cell(const struct verify_map *map, size_t i, uint8_t rgb[3])
{
	static const uint8_t flat[][3] = {
		[VERIFY_NONE] = { 24, 22, 20 },
		[VERIFY_OCCLUDED] = { 120, 112, 128 },
		[VERIFY_CONFLICT] = { 200, 0, 60 },
		[VERIFY_OUTSIDE] = { 60, 56, 54 },
	};
	if (map->cell[i] == VERIFY_AGREE)
		tint(map->distance_m[i], rgb);
	else
		memcpy(rgb, flat[map->cell[i]], 3);
}

/* A pixel stands for step * step cells and shows the one that matters most: conflict before agreement before the rest. */
static size_t telling_cell(
	const struct verify_map *map, uint32_t row, uint32_t column, uint32_t step)
{
	static const int weight[] = { [VERIFY_NONE] = 0,
		[VERIFY_OUTSIDE] = 1,
		[VERIFY_OCCLUDED] = 2,
		[VERIFY_AGREE] = 3,
		[VERIFY_CONFLICT] = 4 };
	size_t best = (size_t)row * map->columns + column;
	for (uint32_t r = row; r < MIN(row + step, map->rows); r++)
		for (uint32_t c = column; c < MIN(column + step, map->columns); c++) {
			size_t i = (size_t)r * map->columns + c;
			if (weight[map->cell[i]] > weight[map->cell[best]])
				best = i;
		}
	return best;
}

static void count_distances(struct report_edge *e, const struct verify_map *map)
{
	for (size_t i = 0; i < (size_t)map->columns * map->rows; i++) {
		if (map->cell[i] != VERIFY_AGREE)
			continue;
		double at = (map->distance_m[i] / REPORT_BIN_MAX + 1) / 2 * REPORT_BINS;
		e->bins[(int)CLAMP(at, 0, REPORT_BINS - 1)]++;
		e->agreeing++;
	}
}

void report_draw_map(struct report_edge *e, const struct verify_map *map)
{
	uint32_t step = (map->columns + WIDTH_MAX - 1) / WIDTH_MAX;
	e->map_columns = (map->columns + step - 1) / step;
	e->map_rows = (map->rows + step - 1) / step;
	g_autofree uint8_t *rgb = g_malloc((size_t)e->map_columns * e->map_rows * 3);
	for (uint32_t r = 0; r < e->map_rows; r++)
		for (uint32_t c = 0; c < e->map_columns; c++)
			colour_cell(map, telling_cell(map, r * step, c * step, step),
				rgb + 3 * ((size_t)r * e->map_columns + c));
	e->map_png = report_encode(rgb, e->map_columns, e->map_rows, 3);
	count_distances(e, map);
}
