#include "render/page-size.h"
#include "render/camera.h"
#include <math.h>
#include <string.h>

#define MM_PER_INCH 25.4
#define ISO_MOST    8

/* ISO 216: each is half of the one before, cut down to whole millimetres. */
static void iso_a(int number, double *width_mm, double *height_mm)
{
	int width = 841, height = 1189;
	for (int n = 0; n < number; n++) {
		int half = height / 2;
		height = width;
		width = half;
	}
	*width_mm = width;
	*height_mm = height;
}

static bool read_iso(const char *text, double *width_mm, double *height_mm)
{
	if (g_ascii_toupper(text[0]) != 'A' || text[1] < '0' || text[1] > '0' + ISO_MOST)
		return false;
	iso_a(text[1] - '0', width_mm, height_mm);
	if (strcmp(text + 2, "-landscape") == 0) {
		double width = *width_mm;
		*width_mm = *height_mm;
		*height_mm = width;
		return true;
	}
	return !text[2] || strcmp(text + 2, "-portrait") == 0;
}

static bool read_side(const char **at, char behind, double *ret_mm)
{
	char *end;
	if (!g_ascii_isdigit(**at))
		return false;
	*ret_mm = g_ascii_strtod(*at, &end);
	*at = end + 1;
	return *end == behind && isfinite(*ret_mm);
}

static bool read_mm(const char *text, double *width_mm, double *height_mm)
{
	return read_side(&text, 'x', width_mm) && read_side(&text, 'm', height_mm) &&
	       strcmp(text, "m") == 0;
}

static bool to_pixels(double mm, double dpi, uint32_t *ret)
{
	double pixels = round(mm / MM_PER_INCH * dpi);
	if (!(pixels >= 1 && pixels <= CAMERA_SIDE_MAX))
		return false;
	*ret = (uint32_t)pixels;
	return true;
}

bool page_size_parse(const char *text, double dpi, struct page_size *ret)
{
	struct page_size p = { 0 };
	if (camera_size_parse(text, &p.width, &p.height)) {
		p.width_mm = p.width * MM_PER_INCH / dpi;
		p.height_mm = p.height * MM_PER_INCH / dpi;
	} else {
		p.on_paper = true;
		if (!read_iso(text, &p.width_mm, &p.height_mm) &&
			!read_mm(text, &p.width_mm, &p.height_mm))
			return false;
		if (!to_pixels(p.width_mm, dpi, &p.width) ||
			!to_pixels(p.height_mm, dpi, &p.height))
			return false;
	}
	*ret = p;
	return true;
}
