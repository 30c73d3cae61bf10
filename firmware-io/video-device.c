#include "firmware-io/video-device.h"
#include "firmware-io/inbox.h"
#include "firmware-io/video-signal.h"
#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

/* One is with the caller, one is being filled, the others wait for a reader that is late. */
#define BUFFERS   5
#define TRIES     4
#define SHRINKS   3 /* whole, half and a quarter of the size */
#define SECOND_NS 1e9

static int kernel_open(const char *path, int flags)
{
	return open(path, flags);
}

static int kernel_ioctl(int fd, unsigned long request, void *argument)
{
	return ioctl(fd, request, argument);
}

static void *kernel_mmap(size_t length, int fd, off_t offset)
{
	return mmap(NULL, length, PROT_READ | PROT_WRITE, MAP_SHARED, fd, offset);
}

const struct video_calls video_calls_kernel = { .open = kernel_open,
	.close = close,
	.ioctl = kernel_ioctl,
	.mmap = kernel_mmap,
	.munmap = munmap,
	.now_ns = inbox_now_ns };

int video_call(const struct video_device *d, unsigned long request, void *argument)
{
	int result = -1;
	for (int i = 0; i < TRIES; i++) {
		result = d->calls->ioctl(d->fd, request, argument);
		if (result == 0 || (errno != EINTR && errno != ETIMEDOUT))
			break;
	}
	return result;
}

static bool is_multi(const struct video_device *d)
{
	return d->type == V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE;
}

static bool say(GError **error, enum wire_error code, const char *format, ...) G_GNUC_PRINTF(3, 4);
static bool say(GError **error, enum wire_error code, const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	g_autofree char *text = g_strdup_vprintf(format, arguments);
	va_end(arguments);
	g_set_error_literal(error, WIRE_ERROR, code, text);
	return false;
}

/* ---- opening ---- */

static bool open_node(struct video_device *d, GError **error)
{
	d->fd = d->calls->open(d->path, O_RDWR | O_NONBLOCK | O_CLOEXEC);
	if (d->fd >= 0)
		return true;
	switch (errno) {
	case ENOENT:
	case ENXIO:
	case ENODEV:
		return say(error, WIRE_ERROR_GONE,
			"the camera is not there: %s does not exist; check its plug", d->path);
	case EACCES:
	case EPERM:
		return say(error, WIRE_ERROR_GONE,
			"%s may not be opened: whoever scans must be in the group 'video'",
			d->path);
	case EBUSY: return say(error, WIRE_ERROR_GONE, "%s is in use by another program", d->path);
	default:
		return say(error, WIRE_ERROR_GONE, "%s cannot be opened: %s", d->path,
			g_strerror(errno));
	}
}

static bool find_type(struct video_device *d, GError **error)
{
	struct v4l2_capability c = { 0 };
	if (video_call(d, VIDIOC_QUERYCAP, &c) < 0)
		return errno == ENODEV ? say(error, WIRE_ERROR_GONE, "the camera was unplugged")
				       : say(error, WIRE_ERROR_BROKEN, "%s is no camera", d->path);
	uint32_t can = c.capabilities & V4L2_CAP_DEVICE_CAPS ? c.device_caps : c.capabilities;
	d->type = can & V4L2_CAP_VIDEO_CAPTURE          ? V4L2_BUF_TYPE_VIDEO_CAPTURE
		  : can & V4L2_CAP_VIDEO_CAPTURE_MPLANE ? V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE
							: 0;
	if (d->type && can & V4L2_CAP_STREAMING)
		return true;
	return say(error, WIRE_ERROR_BROKEN,
		"%s takes no pictures: a camera has several nodes, and another of them does",
		d->path);
}

/* ---- formats ---- */

/* What of a frame lies where, from what the driver says of its plane. */
static bool read_layout(struct video_device *d, const struct v4l2_format *f)
{
	struct video_format *to = &d->format;
	const struct v4l2_pix_format *p = &f->fmt.pix;
	const struct v4l2_pix_format_mplane *m = &f->fmt.pix_mp;
	bool multi = is_multi(d);
	uint32_t quantization = multi ? m->quantization : p->quantization,
		 encoding = multi ? m->ycbcr_enc : p->ycbcr_enc,
		 space = multi ? m->colorspace : p->colorspace;
	*to = (struct video_format){
		.format = camera_format_find(multi ? m->pixelformat : p->pixelformat),
		.width = multi ? m->width : p->width,
		.height = multi ? m->height : p->height,
		.full_range = quantization == V4L2_QUANTIZATION_FULL_RANGE ||
			      (!quantization && space == V4L2_COLORSPACE_JPEG),
		.bt709 = encoding == V4L2_YCBCR_ENC_709 ||
			 (!encoding && space == V4L2_COLORSPACE_REC709),
	};
	if (!to->format || (multi && m->num_planes != 1) || to->width < 2 || to->height < 2)
		return false;
	size_t tight = camera_format_row_bytes(to->format, to->width),
	       rows = camera_format_rows(to->format, to->height),
	       row = multi ? m->plane_fmt[0].bytesperline : p->bytesperline;
	if (rows == 0)
		return true;
	to->row_bytes = MAX(row, tight); /* 0 and nonsense where a driver does not fill it in */
	to->bytes = to->row_bytes * (rows - 1) + tight;
	return true;
}

/* Whoever had the device before may have left it with a part of its picture, or with a smaller one in the corner of ours; so may we, with a format
 * that was tried. Most cameras know nothing of this. */
static void take_whole_picture(const struct video_device *d)
{
	struct v4l2_selection s = { .type = d->type, .target = V4L2_SEL_TGT_CROP_DEFAULT };
	if (video_call(d, VIDIOC_G_SELECTION, &s) < 0)
		return;
	s.target = V4L2_SEL_TGT_CROP;
	video_call(d, VIDIOC_S_SELECTION, &s);
}

static void fill_whole_frame(const struct video_device *d)
{
	struct v4l2_selection s = { .type = d->type,
		.target = V4L2_SEL_TGT_COMPOSE,
		.r = { 0, 0, d->format.width, d->format.height } };
	video_call(d, VIDIOC_S_SELECTION, &s);
}

static bool set_format(struct video_device *d, const struct video_wish *w)
{
	struct v4l2_format f = { .type = d->type };
	struct v4l2_requestbuffers none = { .type = d->type, .memory = V4L2_MEMORY_MMAP };
	video_call(d, VIDIOC_REQBUFS, &none); /* or it is busy */
	take_whole_picture(d);
	if (video_call(d, VIDIOC_G_FMT, &f) < 0)
		return false;
	if (is_multi(d)) {
		f.fmt.pix_mp.pixelformat = w->fourcc;
		f.fmt.pix_mp.width = w->width ? w->width : f.fmt.pix_mp.width;
		f.fmt.pix_mp.height = w->height ? w->height : f.fmt.pix_mp.height;
		f.fmt.pix_mp.field = V4L2_FIELD_NONE;
		memset(f.fmt.pix_mp.plane_fmt, 0, sizeof f.fmt.pix_mp.plane_fmt);
	} else {
		f.fmt.pix.pixelformat = w->fourcc;
		f.fmt.pix.width = w->width ? w->width : f.fmt.pix.width;
		f.fmt.pix.height = w->height ? w->height : f.fmt.pix.height;
		f.fmt.pix.field = V4L2_FIELD_NONE;
		f.fmt.pix.bytesperline = f.fmt.pix.sizeimage = 0;
	}
	bool set = video_call(d, VIDIOC_S_FMT, &f) == 0;
	d->busy = !set && errno == EBUSY;
	if (!set || !read_layout(d, &f) || d->format.format->fourcc != w->fourcc)
		return false;
	fill_whole_frame(d);
	return true;
}

static bool is_offered(const struct video_device *d, uint32_t fourcc)
{
	struct v4l2_fmtdesc f = { .type = d->type };
	for (; video_call(d, VIDIOC_ENUM_FMT, &f) == 0; f.index++)
		if (f.pixelformat == fourcc)
			return true;
	return false;
}

static void add_attempt(struct video_device *d, uint32_t fourcc)
{
	struct video_wish made = { fourcc, d->format.width, d->format.height };
	for (guint i = 0; i < d->attempts->len; i++)
		if (memcmp(&g_array_index(d->attempts, struct video_wish, i), &made, sizeof made) ==
			0)
			return;
	g_array_append_val(d->attempts, made);
}

/* Formats that come in the wanted size, or (exact is false) in the one nearest to it. */
static void try_size(
	struct video_device *d, const struct video_wish *wish, unsigned shrink, bool exact)
{
	size_t count;
	const struct camera_format *formats = camera_formats(&count);
	for (size_t i = 0; i < count; i++) {
		struct video_wish w = { formats[i].fourcc, (wish->width >> shrink) & ~1u,
			(wish->height >> shrink) & ~1u };
		if ((wish->fourcc && wish->fourcc != w.fourcc) || !is_offered(d, w.fourcc) ||
			!set_format(d, &w))
			continue;
		if (!exact || !wish->width ||
			(d->format.width == w.width && d->format.height == w.height))
			add_attempt(d, w.fourcc);
	}
}

static bool find_attempts(struct video_device *d, const struct video_wish *wish, GError **error)
{
	struct video_wish w = *wish;
	g_array_set_size(d->attempts, 0);
	d->attempt = 0;
	try_size(d, &w, 0, true);
	try_size(d, &w, 0, false);
	if (d->attempts->len == 0 && d->busy)
		return say(error, WIRE_ERROR_GONE, "%s is in use by another program", d->path);
	if (d->attempts->len == 0)
		return say(error, WIRE_ERROR_BROKEN,
			wish->fourcc ? "%s does not have the format that is set in [camera]"
				     : "%s has no format that can be used",
			d->path);
	const struct video_wish *best = &g_array_index(d->attempts, struct video_wish, 0);
	w.width = best->width;
	w.height = best->height;
	for (unsigned shrink = 1; shrink < SHRINKS; shrink++)
		try_size(d, &w, shrink, false);
	return true;
}

bool video_open(struct video_device *d, const struct video_calls *calls, const char *path,
	const struct video_wish *wish, GError **error)
{
	*d = (struct video_device){ .calls = calls,
		.path = path,
		.fd = -1,
		.attempts = g_array_new(FALSE, FALSE, sizeof(struct video_wish)) };
	if (open_node(d, error) && find_type(d, error) && video_follow_signal(d, error) &&
		find_attempts(d, wish, error))
		return true;
	video_close(d);
	return false;
}

/* ---- buffers ---- */

static void unmap(struct video_device *d)
{
	for (uint32_t i = 0; i < d->count; i++) {
		if (d->buffers[i].bytes)
			d->calls->munmap(d->buffers[i].bytes, d->buffers[i].length);
		if (d->buffers[i].dma_fd >= 0)
			d->calls->close(d->buffers[i].dma_fd);
	}
	d->count = 0;
}

static void stop(struct video_device *d)
{
	int type = (int)d->type;
	if (d->fd >= 0)
		video_call(d, VIDIOC_STREAMOFF, &type);
	d->streaming = false;
}

void video_close(struct video_device *d)
{
	if (d->streaming)
		stop(d);
	unmap(d);
	if (d->fd >= 0)
		d->calls->close(d->fd);
	d->fd = -1;
	g_clear_pointer(&d->attempts, g_array_unref);
}

static struct v4l2_buffer describe(
	const struct video_device *d, uint32_t index, struct v4l2_plane *planes)
{
	struct v4l2_buffer b = { .index = index, .type = d->type, .memory = V4L2_MEMORY_MMAP };
	if (is_multi(d)) {
		b.m.planes = planes;
		b.length = VIDEO_MAX_PLANES;
	}
	return b;
}

static bool map(struct video_device *d, uint32_t index)
{
	struct v4l2_plane planes[VIDEO_MAX_PLANES] = { 0 };
	struct v4l2_buffer b = describe(d, index, planes);
	struct video_buffer *to = &d->buffers[index];
	struct v4l2_exportbuffer e = {
		.type = d->type, .index = index, .flags = O_CLOEXEC | O_RDONLY
	};
	*to = (struct video_buffer){ .dma_fd = -1 };
	if (video_call(d, VIDIOC_QUERYBUF, &b) < 0)
		return false;
	to->length = is_multi(d) ? planes[0].length : b.length;
	off_t offset = is_multi(d) ? planes[0].m.mem_offset : b.m.offset;
	void *bytes = d->calls->mmap(to->length, d->fd, offset);
	if (bytes == MAP_FAILED)
		return false;
	to->bytes = bytes;
	if (video_call(d, VIDIOC_EXPBUF, &e) == 0)
		to->dma_fd = e.fd;
	return true;
}

enum video_result video_give_back(struct video_device *d, uint32_t index)
{
	struct v4l2_plane planes[VIDEO_MAX_PLANES] = { 0 };
	struct v4l2_buffer b = describe(d, index, planes);
	if (is_multi(d))
		b.length = 1;
	return video_call(d, VIDIOC_QBUF, &b) == 0 ? VIDEO_OK
	       : errno == ENODEV                   ? VIDEO_GONE
						   : VIDEO_BROKEN;
}

static enum video_result give_all(struct video_device *d)
{
	enum video_result result = VIDEO_OK;
	for (uint32_t i = 0; i < d->count && result == VIDEO_OK; i++)
		result = video_give_back(d, i);
	return result;
}

static void read_interval(struct video_device *d)
{
	struct v4l2_streamparm p = { .type = d->type };
	const struct v4l2_fract *t = &p.parm.capture.timeperframe;
	if (video_call(d, VIDIOC_G_PARM, &p) == 0 && t->denominator)
		d->format.interval_ns =
			(int64_t)(SECOND_NS * (double)t->numerator / (double)t->denominator);
}

bool video_prepare(struct video_device *d, GError **error)
{
	struct v4l2_requestbuffers r = {
		.count = BUFFERS, .type = d->type, .memory = V4L2_MEMORY_MMAP
	};
	unmap(d);
	if (!set_format(d, &g_array_index(d->attempts, struct video_wish, d->attempt)) ||
		video_call(d, VIDIOC_REQBUFS, &r) < 0 || r.count < 2)
		return say(error, WIRE_ERROR_GONE, "%s does not take its settings: %s", d->path,
			errno == EBUSY ? "another program uses it" : g_strerror(errno));
	uint32_t count = MIN(r.count, VIDEO_BUFFERS_MAX);
	for (d->count = 0; d->count < count; d->count++)
		if (!map(d, d->count)) {
			d->count++; /* what it has of this one is to be given up too */
			return say(error, WIRE_ERROR_GONE, "%s gives no memory for frames: %s",
				d->path, g_strerror(errno));
		}
	read_interval(d);
	if (give_all(d) == VIDEO_OK)
		return true;
	return say(error, WIRE_ERROR_GONE, "%s takes no buffers: %s", d->path, g_strerror(errno));
}

/* ---- streaming ---- */

enum video_result video_start(struct video_device *d)
{
	int type = (int)d->type;
	d->streaming = video_call(d, VIDIOC_STREAMON, &type) == 0;
	return d->streaming      ? VIDEO_OK
	       : errno == ENOSPC ? VIDEO_NO_ROOM
	       : errno == ENODEV ? VIDEO_GONE
				 : VIDEO_BROKEN;
}

bool video_next_attempt(struct video_device *d)
{
	if (d->attempt + 1 >= d->attempts->len)
		return false;
	d->attempt++;
	return true;
}

enum video_result video_restart(struct video_device *d)
{
	stop(d);
	enum video_result result = give_all(d);
	return result == VIDEO_OK ? video_start(d) : result;
}

enum video_result video_take(struct video_device *d, struct video_frame *ret)
{
	struct v4l2_plane planes[VIDEO_MAX_PLANES] = { 0 };
	struct v4l2_buffer b = describe(d, 0, planes);
	if (video_signal_has_changed(d))
		return VIDEO_CHANGED;
	if (video_call(d, VIDIOC_DQBUF, &b) < 0)
		return errno == EAGAIN   ? VIDEO_NOTHING
		       : errno == ENODEV ? VIDEO_GONE
					 : VIDEO_BROKEN;
	if (b.index >= d->count)
		return VIDEO_BROKEN;
	const struct video_buffer *buffer = &d->buffers[b.index];
	size_t used = is_multi(d) ? planes[0].bytesused : b.bytesused,
	       skip = is_multi(d) ? planes[0].data_offset : 0;
	bool absurd = used > buffer->length || skip > used;
	*ret = (struct video_frame){ .index = b.index,
		.bytes = buffer->bytes + (absurd ? 0 : skip),
		.length = absurd ? 0 : used - skip,
		.flags = b.flags,
		.sequence = b.sequence,
		.stamp_ns = b.timestamp.tv_sec * INT64_C(1000000000) +
			    b.timestamp.tv_usec * INT64_C(1000),
		.damaged = absurd || b.flags & V4L2_BUF_FLAG_ERROR };
	return VIDEO_OK;
}
