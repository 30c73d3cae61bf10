#include "tests/kernel/agent.h"
#include <errno.h>
#include <fcntl.h>
#include <gio/gio.h>
#include <linux/videodev2.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#define BUFFERS 2

struct screen {
	int fd;
	void *buffers[BUFFERS];
	gsize lengths[BUFFERS];
	guint next; /* buffers that were not yet lent to the device; then they come back in turn */
};

static int call(int fd, unsigned long request, void *argument)
{
	int done;

	do
		done = ioctl(fd, request, argument);
	while (done < 0 && errno == EINTR);
	return done;
}

static bool fail(const char *what, GError **error)
{
	int number = errno;

	g_set_error(error, G_IO_ERROR, g_io_error_from_errno(number), "camera: %s: %s", what,
		g_strerror(number));
	return false;
}

static bool set_format(screen *s, uint32_t fourcc, uint32_t width, uint32_t height,
	uint32_t fps_1000, GError **error)
{
	struct v4l2_format format = { .type = V4L2_BUF_TYPE_VIDEO_OUTPUT,
		.fmt.pix = { .width = width,
			.height = height,
			.pixelformat = fourcc,
			.field = V4L2_FIELD_NONE,
			.bytesperline = fourcc == V4L2_PIX_FMT_YUYV   ? 2 * width
					: fourcc == V4L2_PIX_FMT_NV12 ? width
								      : 0,
			.sizeimage = fourcc == V4L2_PIX_FMT_NV12 ? width * height * 3 / 2
								 : 2 * width * height,
			.colorspace = V4L2_COLORSPACE_SRGB } };
	struct v4l2_streamparm pace = { .type = V4L2_BUF_TYPE_VIDEO_OUTPUT,
		.parm.output.timeperframe = { 1000, fps_1000 } };

	if (call(s->fd, VIDIOC_S_FMT, &format) < 0)
		return fail("format", error);
	call(s->fd, VIDIOC_S_PARM, &pace);
	return true;
}

static bool map_buffers(screen *s, GError **error)
{
	struct v4l2_requestbuffers wanted = {
		.count = BUFFERS, .type = V4L2_BUF_TYPE_VIDEO_OUTPUT, .memory = V4L2_MEMORY_MMAP
	};

	if (call(s->fd, VIDIOC_REQBUFS, &wanted) < 0 || wanted.count < BUFFERS)
		return fail("buffers", error);
	for (guint i = 0; i < BUFFERS; i++) {
		struct v4l2_buffer b = {
			.index = i, .type = V4L2_BUF_TYPE_VIDEO_OUTPUT, .memory = V4L2_MEMORY_MMAP
		};

		if (call(s->fd, VIDIOC_QUERYBUF, &b) < 0)
			return fail("a buffer", error);
		s->lengths[i] = b.length;
		s->buffers[i] =
			mmap(NULL, b.length, PROT_READ | PROT_WRITE, MAP_SHARED, s->fd, b.m.offset);
		if (s->buffers[i] == MAP_FAILED)
			return fail("a buffer's memory", error);
	}
	int type = V4L2_BUF_TYPE_VIDEO_OUTPUT;

	return call(s->fd, VIDIOC_STREAMON, &type) == 0 || fail("streaming", error);
}

screen *screen_new(const char *node, uint32_t fourcc, uint32_t width, uint32_t height,
	uint32_t fps_1000, GError **error)
{
	screen *s = g_new0(screen, 1);

	s->fd = open(node, O_RDWR | O_CLOEXEC);
	if (s->fd < 0)
		fail(node, error);
	else if (set_format(s, fourcc, width, height, fps_1000, error) && map_buffers(s, error))
		return s;
	screen_free(s);
	return NULL;
}

bool screen_show(screen *s, const struct screen_frame *frame, GError **error)
{
	struct v4l2_buffer b = {
		.index = s->next, .type = V4L2_BUF_TYPE_VIDEO_OUTPUT, .memory = V4L2_MEMORY_MMAP
	};

	if (s->next >= BUFFERS && call(s->fd, VIDIOC_DQBUF, &b) < 0)
		return fail("a buffer back", error);
	s->next += s->next < BUFFERS;
	b.bytesused = (uint32_t)MIN(frame->length, s->lengths[b.index]);
	memcpy(s->buffers[b.index], frame->bytes, b.bytesused);
	b.flags = V4L2_BUF_FLAG_TIMESTAMP_COPY | (frame->damaged ? V4L2_BUF_FLAG_ERROR : 0);
	b.sequence = frame->sequence;
	b.field = V4L2_FIELD_NONE;
	b.timestamp.tv_sec = frame->at_ns / 1000000000;
	b.timestamp.tv_usec = frame->at_ns / 1000 % 1000000;
	return call(s->fd, VIDIOC_QBUF, &b) == 0 || fail("a frame", error);
}

void screen_free(screen *s)
{
	if (!s)
		return;
	for (guint i = 0; i < BUFFERS; i++)
		if (s->buffers[i] && s->buffers[i] != MAP_FAILED)
			munmap(s->buffers[i], s->lengths[i]);
	if (s->fd >= 0)
		close(s->fd);
	g_free(s);
}
