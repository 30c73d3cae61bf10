#include "sim/kernel-frame.h"
#include <linux/videodev2.h>
#include <string.h>
#include <turbojpeg.h>

static void append_yuyv(GByteArray *frame, const guint8 *luma, guint width, guint height)
{
	const guint8 *chroma = luma + (gsize)width * height;
	guint at = frame->len;

	g_byte_array_set_size(frame, at + 2 * width * height);
	for (guint y = 0; y < height; y++)
		for (guint x = 0; x < width; x += 2, at += 4) {
			frame->data[at] = luma[(gsize)y * width + x];
			frame->data[at + 1] = chroma[(gsize)(y / 2) * width + x];
			frame->data[at + 2] = luma[(gsize)y * width + x + 1];
			frame->data[at + 3] = chroma[(gsize)(y / 2) * width + x + 1];
		}
}

static void append_jpeg(GByteArray *frame, const guint8 *luma, guint width, guint height)
{
	gsize quarter = (gsize)width / 2 * (height / 2), pixels = (gsize)width * height;
	g_autofree guint8 *chroma = g_malloc(2 * quarter);
	const guint8 *planes[3] = { luma, chroma, chroma + quarter };
	int strides[3] = { (int)width, (int)width / 2, (int)width / 2 };
	unsigned char *jpeg = NULL;
	unsigned long length = 0;
	tjhandle handle = tjInitCompress();

	for (gsize i = 0; i < quarter; i++) {
		chroma[i] = luma[pixels + 2 * i];
		chroma[quarter + i] = luma[pixels + 2 * i + 1];
	}
	if (tjCompressFromYUVPlanes(handle, planes, (int)width, strides, (int)height, TJSAMP_420,
		    &jpeg, &length, 90, 0) == 0)
		g_byte_array_append(frame, jpeg, (guint)length);
	tjFree(jpeg);
	tjDestroy(handle);
}

GByteArray *kernel_frame(
	const struct kernel_frame_format *format, const guint8 *payload, gsize length)
{
	GByteArray *frame = g_byte_array_new();
	const guint8 *pixels = payload + sizeof(struct link_frame);
	struct link_frame head;

	memcpy(&head, payload, sizeof head);
	g_byte_array_append(frame, payload, sizeof head);
	if (format->fourcc == V4L2_PIX_FMT_YUYV)
		append_yuyv(frame, pixels, head.width, head.height);
	else if (format->fourcc == V4L2_PIX_FMT_MJPEG)
		append_jpeg(frame, pixels, head.width, head.height);
	else
		g_byte_array_append(frame, pixels, (guint)(length - sizeof head));
	return frame;
}
