#ifndef FIRMWARE_IO_CAMERA_FORMAT_H
#define FIRMWARE_IO_CAMERA_FORMAT_H
/* The formats of frames that cameras are asked for, and how many bytes one of them has without padding. Named by their V4L2 codes: what they hold is
 * in the kernel's "Image Formats" (userspace-api/media/v4l/pixfmt). Rows are preferred from first to last: uncompressed before Bayer, whose
 * colours are guessed, before MJPEG, whose colours are blurred. */
#include <glib.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum camera_layout {
	CAMERA_YUYV,
	CAMERA_NV12,
	CAMERA_BAYER_8,
	CAMERA_BAYER_10P, /* four pixels in five bytes */
	CAMERA_BAYER_10,  /* in the low bits of two bytes, little-endian */
	CAMERA_MJPEG,
};

struct camera_format {
	uint32_t fourcc;
	enum camera_layout layout;
	uint8_t red_x, red_y; /* of a Bayer pattern: where in each two by two the red pixel is */
};

/* All there are, in the order in which they are preferred. */
const struct camera_format *camera_formats(size_t *ret_count);
const struct camera_format *camera_format_find(uint32_t fourcc); /* NULL: not one of them */
bool camera_format_is_raw(const struct camera_format *f);        /* no YUV in it */

/* Zeros for MJPEG, whose frames have any length. */
size_t camera_format_row_bytes(const struct camera_format *f, uint32_t width);
uint32_t camera_format_rows(const struct camera_format *f, uint32_t height);
static inline size_t camera_format_bytes(
	const struct camera_format *f, uint32_t width, uint32_t height)
{
	return camera_format_row_bytes(f, width) * camera_format_rows(f, height);
}

/* Starts and ends as a JPEG does; cameras write endings of their own, which decoders take (DEVICES 3.2). */
bool camera_format_is_whole_jpeg(const uint8_t *bytes, size_t length);

/* "YUYV"; caller frees. */
char *camera_fourcc_text(uint32_t fourcc);

#endif
