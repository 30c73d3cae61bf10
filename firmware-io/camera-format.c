#include "firmware-io/camera-format.h"
#include <linux/videodev2.h>

/* Shorter than any picture's tables. */
#define JPEG_BYTES_MIN 125

static const struct camera_format formats[] = {
	{ V4L2_PIX_FMT_YUYV, CAMERA_YUYV, 0, 0 },
	{ V4L2_PIX_FMT_NV12, CAMERA_NV12, 0, 0 },
	{ V4L2_PIX_FMT_SRGGB10, CAMERA_BAYER_10, 0, 0 },
	{ V4L2_PIX_FMT_SGRBG10, CAMERA_BAYER_10, 1, 0 },
	{ V4L2_PIX_FMT_SGBRG10, CAMERA_BAYER_10, 0, 1 },
	{ V4L2_PIX_FMT_SBGGR10, CAMERA_BAYER_10, 1, 1 },
	{ V4L2_PIX_FMT_SRGGB10P, CAMERA_BAYER_10P, 0, 0 },
	{ V4L2_PIX_FMT_SGRBG10P, CAMERA_BAYER_10P, 1, 0 },
	{ V4L2_PIX_FMT_SGBRG10P, CAMERA_BAYER_10P, 0, 1 },
	{ V4L2_PIX_FMT_SBGGR10P, CAMERA_BAYER_10P, 1, 1 },
	{ V4L2_PIX_FMT_SRGGB8, CAMERA_BAYER_8, 0, 0 },
	{ V4L2_PIX_FMT_SGRBG8, CAMERA_BAYER_8, 1, 0 },
	{ V4L2_PIX_FMT_SGBRG8, CAMERA_BAYER_8, 0, 1 },
	{ V4L2_PIX_FMT_SBGGR8, CAMERA_BAYER_8, 1, 1 },
	{ V4L2_PIX_FMT_MJPEG, CAMERA_MJPEG, 0, 0 },
};

const struct camera_format *camera_formats(size_t *ret_count)
{
	*ret_count = G_N_ELEMENTS(formats);
	return formats;
}

const struct camera_format *camera_format_find(uint32_t fourcc)
{
	for (size_t i = 0; i < G_N_ELEMENTS(formats); i++)
		if (formats[i].fourcc == fourcc)
			return &formats[i];
	return NULL;
}

bool camera_format_is_raw(const struct camera_format *f)
{
	return f->layout == CAMERA_BAYER_8 || f->layout == CAMERA_BAYER_10 ||
	       f->layout == CAMERA_BAYER_10P;
}

size_t camera_format_row_bytes(const struct camera_format *f, uint32_t width)
{
	switch (f->layout) {
	case CAMERA_YUYV:
	case CAMERA_BAYER_10: return (size_t)width * 2;
	case CAMERA_NV12:
	case CAMERA_BAYER_8: return width;
	case CAMERA_BAYER_10P: return ((size_t)width * 5 + 3) / 4;
	case CAMERA_MJPEG: break;
	}
	return 0;
}

uint32_t camera_format_rows(const struct camera_format *f, uint32_t height)
{
	return f->layout == CAMERA_NV12    ? height + height / 2
	       : f->layout == CAMERA_MJPEG ? 0
					   : height;
}

bool camera_format_is_whole_jpeg(const uint8_t *bytes, size_t length)
{
	if (length < JPEG_BYTES_MIN || bytes[0] != 0xff || bytes[1] != 0xd8)
		return false;
	unsigned tail = (unsigned)bytes[length - 2] << 8 | bytes[length - 1];
	return tail == 0xffd9 || tail == 0xd900 || tail == 0x0000;
}

char *camera_fourcc_text(uint32_t fourcc)
{
	char text[5] = { 0 };
	for (int i = 0; i < 4; i++)
		text[i] = (char)(fourcc >> (8 * i) & 0x7f);
	return g_strchomp(g_strdup(text));
}
