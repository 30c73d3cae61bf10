#ifndef TESTS_VIDEO_MADE_H
#define TESTS_VIDEO_MADE_H
/* A V4L2 device in the test's own process, behind struct video_calls: it has a clock that only the test moves, exposes on its beat, and fails as it is
 * told. Buffers are kept as the kernel keeps them: one is queued, filled, or the program's, and using it otherwise ends the test. */
#include "firmware-io/video-device.h"
#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/mman.h>
#include <unistd.h>

#define MADE_CONTROLS 16
#define MADE_FORMATS  8

struct made_control {
	uint32_t id; /* 0: the end */
	int32_t min, max, step, value;
	int32_t sticks_at; /* reads so, whatever is set; INT32_MIN: as it is set */
	uint32_t inactive_while,
		active_at; /* nothing is set while this other control is not at that */
};

enum made_state { MADE_MINE, MADE_QUEUED, MADE_FULL };

static struct made_video {
	/* What it is. */
	bool multi;
	const char *path;
	uint32_t offered[MADE_FORMATS]; /* formats; 0 ends */
	uint32_t width, height, pad;    /* the size it has by itself; bytes behind each row */
	bool any_size;                  /* else only its own, and halves of it */
	uint32_t caps, quantization;
	uint32_t stamp_flags;
	int64_t interval_ns, exposure_ns, readout_ns;
	bool no_export;
	struct made_control controls[MADE_CONTROLS];
	uint32_t room; /* bytes of a frame that the bus has room for; 0: any */

	bool on_cable; /* a cable brings the picture, of this size: */
	uint32_t cable_width, cable_height;

	/* How it fails. */
	bool absent, no_right, in_use, silent;
	int dqbuf_errno;         /* the next DQBUF fails so, once */
	uint32_t error_frames;   /* so many next ones carry the flag */
	uint32_t short_frames;   /* so many are cut off */
	uint32_t absurd_frames;  /* so many say that they have more bytes than the buffer */
	uint32_t dropped_frames; /* so many are skipped, as the sequence tells */
	int stale_stamps;        /* stamps are of another clock */
	int cable_errno;         /* what is wrong with the cable; 0: nothing */
	unsigned cable_changes;  /* events that wait */

	/* As it stands. */
	int64_t now_ns, next_ns;
	bool streaming;
	uint32_t fourcc, set_width, set_height, sequence;
	enum made_state states[VIDEO_BUFFERS_MAX];
	uint8_t *buffers[VIDEO_BUFFERS_MAX];
	uint32_t queue[VIDEO_BUFFERS_MAX], queued, count, mapped;
	struct v4l2_buffer full[VIDEO_BUFFERS_MAX];
	uint32_t filled;
	int fd, open_fds;
	/* What was done. */
	unsigned opens, stream_ons, stream_offs, frees, exports;
	GString *controls_set; /* ids in the order in which they were set */
} made;

static inline uint32_t made_type(void)
{
	return made.multi ? V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE : V4L2_BUF_TYPE_VIDEO_CAPTURE;
}

static inline size_t made_row(void)
{
	return camera_format_row_bytes(camera_format_find(made.fourcc), made.set_width);
}

static inline size_t made_stride(void)
{
	return made_row() ? made_row() + made.pad : 0;
}

static inline size_t made_frame_bytes(void)
{
	return made_row() ? made_stride() * camera_format_rows(camera_format_find(made.fourcc),
						    made.set_height)
			  : (size_t)made.set_width * made.set_height;
}

static inline int made_fails(int code)
{
	errno = code;
	return -1;
}

static inline struct made_control *made_control(uint32_t id)
{
	for (size_t i = 0; i < MADE_CONTROLS && made.controls[i].id; i++)
		if (made.controls[i].id == id)
			return &made.controls[i];
	return NULL;
}

/* ---- frames ---- */

/* Bytes follow from the sequence, those of padding are 0xee. */
static inline uint8_t made_byte(uint32_t sequence, size_t i)
{
	return (uint8_t)(sequence * 31 + i * 7);
}

static inline size_t made_paint(uint8_t *to, uint32_t sequence)
{
	size_t bytes = made_frame_bytes(), row = made_row();
	if (row == 0) { /* a JPEG, by its ends */
		bytes = 1000;
		for (size_t i = 0; i < bytes; i++)
			to[i] = made_byte(sequence, i);
		memcpy(to, "\xff\xd8", 2);
		memcpy(to + bytes - 2, "\xff\xd9", 2);
		return bytes;
	}
	for (size_t at = 0, i = 0; at < bytes; at++)
		to[at] = at % made_stride() < row ? made_byte(sequence, i++) : 0xee;
	return bytes;
}

static inline void made_fill(uint32_t index, int64_t begin_ns)
{
	size_t skip = made.multi ? 64 : 0, room = made_frame_bytes() + 64;
	size_t used = made_paint(made.buffers[index] + skip, made.sequence);
	bool soe =
		(made.stamp_flags & V4L2_BUF_FLAG_TSTAMP_SRC_MASK) == V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
	int64_t stamp_ns = begin_ns + (soe ? 0 : made.exposure_ns + made.readout_ns);
	if (made.stale_stamps)
		stamp_ns += INT64_C(1700000000) * 1000000000;
	if (made.short_frames > 0) {
		made.short_frames--;
		used -= 3;
	}
	struct v4l2_buffer b = { .index = index,
		.sequence = made.sequence,
		.flags = made.stamp_flags,
		.bytesused = (uint32_t)used,
		.timestamp = { stamp_ns / 1000000000, stamp_ns % 1000000000 / 1000 } };
	if (made.error_frames > 0) {
		made.error_frames--;
		b.flags |= V4L2_BUF_FLAG_ERROR;
	}
	if (made.absurd_frames > 0) {
		made.absurd_frames--;
		b.bytesused = (uint32_t)room + 4096;
	}
	made.states[index] = MADE_FULL;
	made.full[made.filled++] = b;
}

static inline void made_expose(void)
{
	int64_t begin_ns = made.next_ns - made.exposure_ns - made.readout_ns;
	if (made.dropped_frames > 0)
		made.dropped_frames--;
	else if (made.queued > 0) {
		uint32_t index = made.queue[0];
		memmove(made.queue, made.queue + 1, --made.queued * sizeof *made.queue);
		made_fill(index, begin_ns);
	}
	made.sequence++;
	made.next_ns += made.interval_ns;
}

/* Lets time pass, and exposures with it. */
static inline void made_pass(int64_t ns)
{
	int64_t until_ns = made.now_ns + ns;
	while (made.streaming && !made.silent && !made.absent && made.next_ns <= until_ns) {
		made.now_ns = made.next_ns;
		made_expose();
	}
	made.now_ns = until_ns;
	if (made.silent)
		made.next_ns = MAX(made.next_ns, made.now_ns + made.interval_ns);
}

/* ---- the calls ---- */

static inline int made_open(const char *path, int flags)
{
	g_assert_cmpstr(path, ==, made.path);
	g_assert_true(flags & O_NONBLOCK);
	if (made.absent || made.no_right)
		return made_fails(made.absent ? ENOENT : EACCES);
	made.opens++;
	made.open_fds++;
	return made.fd = eventfd(0, EFD_CLOEXEC);
}

static inline int made_close(int fd)
{
	made.open_fds--;
	if (fd == made.fd) {
		made.streaming = false;
		made.filled = made.queued = 0;
		made.fd = -1;
	}
	return close(fd);
}

static inline void *made_mmap(size_t length, int fd, off_t offset)
{
	g_assert_cmpint(fd, ==, made.fd);
	uint32_t index = (uint32_t)(offset / 0x1000);
	g_assert_cmpuint(index, <, made.count);
	made.mapped++;
	return made.buffers[index] = g_malloc0(length);
}

static inline int made_munmap(void *bytes, size_t length)
{
	(void)length;
	made.mapped--;
	g_free(bytes);
	return 0;
}

static inline int64_t made_now_ns(void)
{
	return made.now_ns;
}

static inline int made_query_caps(struct v4l2_capability *c)
{
	/* The device as a whole can more than this node. */
	c->capabilities = made.caps | V4L2_CAP_DEVICE_CAPS | V4L2_CAP_VIDEO_CAPTURE |
			  V4L2_CAP_VIDEO_CAPTURE_MPLANE;
	c->device_caps = made.caps;
	return 0;
}

static inline int made_enum_format(struct v4l2_fmtdesc *f)
{
	if (f->type != made_type() || f->index >= MADE_FORMATS || made.offered[f->index] == 0)
		return made_fails(EINVAL);
	f->pixelformat = made.offered[f->index];
	return 0;
}

static inline void made_tell_format(struct v4l2_format *f)
{
	if (made.multi) {
		f->fmt.pix_mp.pixelformat = made.fourcc;
		f->fmt.pix_mp.width = made.set_width;
		f->fmt.pix_mp.height = made.set_height;
		f->fmt.pix_mp.num_planes = 1;
		f->fmt.pix_mp.quantization = (uint8_t)made.quantization;
		f->fmt.pix_mp.plane_fmt[0].bytesperline = (uint32_t)made_stride();
		f->fmt.pix_mp.plane_fmt[0].sizeimage = (uint32_t)made_frame_bytes();
		return;
	}
	f->fmt.pix.pixelformat = made.fourcc;
	f->fmt.pix.width = made.set_width;
	f->fmt.pix.height = made.set_height;
	f->fmt.pix.quantization = made.quantization;
	f->fmt.pix.bytesperline = (uint32_t)made_stride();
	f->fmt.pix.sizeimage = (uint32_t)made_frame_bytes();
}

static inline int made_set_format(struct v4l2_format *f)
{
	uint32_t fourcc = made.multi ? f->fmt.pix_mp.pixelformat : f->fmt.pix.pixelformat,
		 width = made.multi ? f->fmt.pix_mp.width : f->fmt.pix.width,
		 height = made.multi ? f->fmt.pix_mp.height : f->fmt.pix.height;
	g_assert_false(made.streaming);
	if (made.in_use || made.count > 0)
		return made_fails(EBUSY);
	made.fourcc = made.offered[0];
	for (int i = 0; i < MADE_FORMATS && made.offered[i]; i++)
		if (made.offered[i] == fourcc)
			made.fourcc = fourcc;
	bool half = width <= made.width / 2;
	made.set_width = made.any_size ? width : half ? made.width / 2 : made.width;
	made.set_height = made.any_size ? height : half ? made.height / 2 : made.height;
	made_tell_format(f);
	return 0;
}

static inline int made_request(struct v4l2_requestbuffers *r)
{
	g_assert_false(made.streaming);
	g_assert_cmpuint(r->memory, ==, V4L2_MEMORY_MMAP);
	made.frees += r->count == 0;
	made.count = r->count = MIN(r->count, 4); /* a driver gives what it can */
	made.queued = made.filled = 0;
	memset(made.states, 0, sizeof made.states);
	return 0;
}

static inline int made_query_buffer(struct v4l2_buffer *b)
{
	uint32_t length = (uint32_t)made_frame_bytes() + 64;
	if (b->index >= made.count)
		return made_fails(EINVAL);
	if (made.multi) {
		b->m.planes[0].length = length;
		b->m.planes[0].m.mem_offset = b->index * 0x1000;
	} else {
		b->length = length;
		b->m.offset = b->index * 0x1000;
	}
	return 0;
}

static inline int made_queue_buffer(const struct v4l2_buffer *b)
{
	if (made.absent)
		return made_fails(ENODEV);
	g_assert_cmpuint(b->index, <, made.count);
	g_assert_cmpint(made.states[b->index], ==, MADE_MINE);
	made.states[b->index] = MADE_QUEUED;
	made.queue[made.queued++] = b->index;
	return 0;
}

static inline int made_dequeue_buffer(struct v4l2_buffer *b)
{
	int code = made.absent ? ENODEV : made.dqbuf_errno;
	made.dqbuf_errno = 0;
	if (code)
		return made_fails(code);
	if (!made.streaming)
		return made_fails(EINVAL);
	if (made.filled == 0)
		return made_fails(EAGAIN);
	struct v4l2_buffer f = made.full[0];
	memmove(made.full, made.full + 1, --made.filled * sizeof *made.full);
	made.states[f.index] = MADE_MINE;
	if (made.multi) {
		f.m.planes = b->m.planes;
		f.m.planes[0].bytesused = f.bytesused + 64;
		f.m.planes[0].data_offset = 64;
		f.bytesused = 0;
	}
	*b = f;
	return 0;
}

static inline int made_stream(bool on)
{
	if (made.absent)
		return made_fails(ENODEV);
	if (on && made.room && made_frame_bytes() / (made_row() ? 1 : 8) > made.room)
		return made_fails(ENOSPC);
	made.streaming = on;
	*(on ? &made.stream_ons : &made.stream_offs) += 1;
	if (on) {
		made.next_ns = made.now_ns + made.interval_ns;
		made.sequence = 0;
		return 0;
	}
	made.queued = made.filled = 0;
	memset(made.states, 0, sizeof made.states);
	return 0;
}

static inline int made_query_control(struct v4l2_queryctrl *q)
{
	const struct made_control *c = made_control(q->id);
	if (!c)
		return made_fails(EINVAL);
	q->minimum = c->min;
	q->maximum = c->max;
	q->step = c->step;
	return 0;
}

static inline int made_control_value(struct v4l2_control *v, bool set)
{
	struct made_control *c = made_control(v->id);
	if (!c)
		return made_fails(EINVAL);
	if (!set) {
		v->value = c->sticks_at == INT32_MIN ? c->value : c->sticks_at;
		return 0;
	}
	const struct made_control *by = c->inactive_while ? made_control(c->inactive_while) : NULL;
	g_string_append_printf(made.controls_set, "%x ", v->id);
	if (by && by->value != (int32_t)c->active_at)
		return made_fails(EBUSY);
	if (v->value < c->min || v->value > c->max)
		return made_fails(ERANGE);
	c->value = c->min + (v->value - c->min) / c->step * c->step;
	return 0;
}

static inline int made_export(struct v4l2_exportbuffer *e)
{
	if (made.no_export)
		return made_fails(ENOTTY);
	made.exports++;
	made.open_fds++;
	e->fd = eventfd(e->index, EFD_CLOEXEC);
	return 0;
}

static inline int made_interval(struct v4l2_streamparm *p)
{
	p->parm.capture.timeperframe =
		(struct v4l2_fract){ (uint32_t)(made.interval_ns / 1000), 1000000 };
	return 0;
}

static inline int made_subscribe(const struct v4l2_event_subscription *s)
{
	g_assert_cmpuint(s->type, ==, V4L2_EVENT_SOURCE_CHANGE);
	return made.on_cable ? 0 : made_fails(EINVAL);
}

static inline int made_event(struct v4l2_event *e)
{
	if (made.cable_changes == 0)
		return made_fails(ENOENT);
	made.cable_changes--;
	*e = (struct v4l2_event){ .type = V4L2_EVENT_SOURCE_CHANGE };
	e->u.src_change.changes = V4L2_EVENT_SRC_CH_RESOLUTION;
	return 0;
}

static inline int made_timings(struct v4l2_dv_timings *t, bool set)
{
	if (!made.on_cable || made.cable_errno)
		return made_fails(made.on_cable ? made.cable_errno : ENOTTY);
	if (set) {
		g_assert_cmpuint(made.count, ==, 0);
		made.width = t->bt.width;
		made.height = t->bt.height;
	}
	t->bt.width = made.cable_width;
	t->bt.height = made.cable_height;
	return 0;
}

static inline int made_ioctl(int fd, unsigned long request, void *a)
{
	int type;
	g_assert_cmpint(fd, ==, made.fd);
	switch (request) {
	case VIDIOC_QUERYCAP: return made_query_caps(a);
	case VIDIOC_ENUM_FMT: return made_enum_format(a);
	case VIDIOC_G_FMT: made_tell_format(a); return 0;
	case VIDIOC_S_FMT: return made_set_format(a);
	case VIDIOC_REQBUFS: return made_request(a);
	case VIDIOC_QUERYBUF: return made_query_buffer(a);
	case VIDIOC_EXPBUF: return made_export(a);
	case VIDIOC_QBUF: return made_queue_buffer(a);
	case VIDIOC_DQBUF: return made_dequeue_buffer(a);
	case VIDIOC_STREAMON:
	case VIDIOC_STREAMOFF:
		memcpy(&type, a, sizeof type);
		g_assert_cmpint(type, ==, (int)made_type());
		return made_stream(request == VIDIOC_STREAMON);
	case VIDIOC_QUERYCTRL: return made_query_control(a);
	case VIDIOC_S_CTRL: return made_control_value(a, true);
	case VIDIOC_G_CTRL: return made_control_value(a, false);
	case VIDIOC_SUBSCRIBE_EVENT: return made_subscribe(a);
	case VIDIOC_DQEVENT: return made_event(a);
	case VIDIOC_QUERY_DV_TIMINGS: return made_timings(a, false);
	case VIDIOC_S_DV_TIMINGS: return made_timings(a, true);
	case VIDIOC_G_PARM: return made_interval(a);
	default: return made_fails(ENOTTY);
	}
}

static const struct video_calls made_calls = { made_open, made_close, made_ioctl, made_mmap,
	made_munmap, made_now_ns };

/* A webcam as they are: all controls, stamps by the kernel at the start of exposure, 20 frames a second. */
static inline void made_webcam(void)
{
	if (made.controls_set)
		g_string_free(made.controls_set, TRUE);
	made = (struct made_video){ .path = "/dev/video-made",
		.offered = { V4L2_PIX_FMT_MJPEG, V4L2_PIX_FMT_YUYV },
		.width = 64,
		.height = 48,
		.caps = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING,
		.stamp_flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_SOE,
		.interval_ns = 50000000,
		.exposure_ns = 5000000,
		.readout_ns = 8000000,
		.now_ns = INT64_C(7000000000000),
		.fd = -1,
		.controls_set = g_string_new(NULL),
		.controls = {
			{ V4L2_CID_EXPOSURE_AUTO, 0, 3, 1, 3, INT32_MIN, 0, 0 },
			{ V4L2_CID_EXPOSURE_ABSOLUTE, 3, 2047, 1, 250, INT32_MIN,
				V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_MANUAL },
			{ V4L2_CID_EXPOSURE_AUTO_PRIORITY, 0, 1, 1, 1, INT32_MIN, 0, 0 },
			{ V4L2_CID_AUTO_WHITE_BALANCE, 0, 1, 1, 1, INT32_MIN, 0, 0 },
			{ V4L2_CID_WHITE_BALANCE_TEMPERATURE, 2000, 6500, 10, 4000, INT32_MIN,
				V4L2_CID_AUTO_WHITE_BALANCE, 0 },
			{ V4L2_CID_GAIN, 0, 255, 1, 64, INT32_MIN, 0, 0 },
			{ V4L2_CID_FOCUS_AUTO, 0, 1, 1, 1, INT32_MIN, 0, 0 },
			{ V4L2_CID_FOCUS_ABSOLUTE, 0, 250, 5, 100, INT32_MIN, V4L2_CID_FOCUS_AUTO,
				0 },
			{ V4L2_CID_BACKLIGHT_COMPENSATION, 0, 2, 1, 1, INT32_MIN, 0, 0 },
		} };
	made.fourcc = made.offered[0];
	made.set_width = made.width;
	made.set_height = made.height;
}

#endif
