#ifndef RENDER_PAGE_SIZE_H
#define RENDER_PAGE_SIZE_H
/* How large a picture is: in pixels, and on paper. */
#include <stdbool.h>
#include <stdint.h>

#define PAGE_DPI_NORMAL 150.0
#define PAGE_DPI_MIN    10.0
#define PAGE_DPI_MAX    2400.0

struct page_size {
	uint32_t width, height; /* pixels */
	double width_mm, height_mm;
	bool on_paper; /* asked for in millimetres */
};
/* "1600x1200" pixels; "297x210mm"; "A0" to "A8" (ISO 216), upright, or "A3-landscape". A pixel is 25.4 / dpi millimetres; of a size on
 * paper the number of pixels is the nearest whole one. false: it is none, or sides are not 1 to CAMERA_SIDE_MAX pixels; *ret is left
 * as it was. */
bool page_size_parse(const char *text, double dpi, struct page_size *ret);

#endif
