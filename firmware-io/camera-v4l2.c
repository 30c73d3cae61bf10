#include "firmware-io/camera-v4l2.h"
#include "firmware-io/video-controls.h"
#include <errno.h>
#include <string.h>

#define SECOND_NS      INT64_C(1000000000)
#define AGAIN_NS       SECOND_NS       /* how often one that is gone is looked for */
#define SILENCE_MIN_NS (2 * SECOND_NS) /* DEVICES 3.5 */
#define SILENCE_FRAMES 3
/* A stamp of the host's clock lies in the past, but not far. */
#define STAMP_AGE_MAX_NS (10 * SECOND_NS)
#define SETTLE_FRAMES    2 /* besides those that are under way */
#define FRAME_BYTES_MAX  (RECORD_PAYLOAD_MAX - 4096)
#define NOT_HELD         UINT32_MAX

struct v4l2_camera {
	camera base;
	const struct video_calls *calls;
	char *path;
	struct video_wish wish;
	struct video_device device;
	struct video_controls controls;
	bool trust; /* stamps that the driver copies from who feeds it */
	int64_t readout_ns;

	bool closed, wanted_known, told_gone, told_clock;
	struct camera_controls wanted, in_force;
	GString *told; /* remarks that were made */
	int64_t again_ns, last_frame_ns;
	unsigned failures; /* since the last good frame */
	uint32_t settling; /* frames that are yet to be let go */
	uint32_t lent;
	int64_t lent_ns; /* the first of those loans */
	uint32_t held;   /* buffer of the frame that was handed out */
	uint8_t *tight;  /* its pixels without padding */

	bool counted;
	uint32_t last_sequence; /* the driver's */
	uint32_t sequence;      /* ours, which goes on when the device starts anew */
	struct camera_v4l2_counts counts;
};

static int64_t now_ns(const struct v4l2_camera *c)
{
	return c->calls->now_ns();
}

/* ---- controls ---- */

static void say_remarks(struct v4l2_camera *c)
{
	const char *text = c->controls.remark->str;
	if (strcmp(text, c->told->str) == 0)
		return;
	g_message("the camera %s: %s", c->path, text);
	g_string_assign(c->told, text);
}

static void apply_controls(struct v4l2_camera *c)
{
	if (!c->wanted_known)
		return;
	video_controls_apply(&c->device, &c->controls, &c->wanted, &c->in_force);
	c->settling = c->device.count + SETTLE_FRAMES;
	say_remarks(c);
}

static bool v4l2_set_controls(camera *base, const struct camera_controls *controls, GError **error)
{
	struct v4l2_camera *c = (struct v4l2_camera *)base;
	(void)error;
	if (c->wanted_known && memcmp(&c->wanted, controls, sizeof *controls) == 0)
		return true;
	c->wanted = *controls;
	c->wanted_known = true;
	if (c->closed)
		c->in_force = *controls; /* until it says better */
	else
		apply_controls(c);
	return true;
}

static void v4l2_get_controls(camera *base, struct camera_controls *ret)
{
	const struct v4l2_camera *c = (struct v4l2_camera *)base;
	if (c->wanted_known)
		*ret = c->in_force;
}

/* Frames keep their beat, however long an exposure is asked for (video-controls.c). */
static uint32_t v4l2_longest_exposure_100us(camera *base)
{
	const struct v4l2_camera *c = (struct v4l2_camera *)base;
	int64_t room_ns = c->device.format.interval_ns - c->readout_ns;
	return (uint32_t)CLAMP(room_ns / 100000, 0, INT32_MAX);
}

/* ---- opening, and what fails ---- */

static void close_device(struct v4l2_camera *c)
{
	if (!c->closed)
		video_close(&c->device);
	c->closed = true;
	c->held = NOT_HELD;
	c->counted = false;
	c->again_ns = now_ns(c) + AGAIN_NS;
}

/* Until the bus has room for it. */
static bool start(struct v4l2_camera *c, GError **error)
{
	for (;;) {
		if (!video_prepare(&c->device, error))
			return false;
		apply_controls(c);
		enum video_result result = video_start(&c->device);
		if (result == VIDEO_OK)
			return true;
		if (result == VIDEO_NO_ROOM && video_next_attempt(&c->device))
			continue;
		g_set_error(error, WIRE_ERROR, WIRE_ERROR_GONE,
			result == VIDEO_NO_ROOM ? "the camera %s finds no room on the USB, however "
						  "small its frames: give it a port of its own"
						: "the camera %s does not start",
			c->path);
		return false;
	}
}

static void say_format(const struct v4l2_camera *c)
{
	const struct video_format *f = &c->device.format;
	g_autofree char *code = camera_fourcc_text(f->format->fourcc);
	g_debug("the camera %s: %s, %u x %u", c->path, code, f->width, f->height);
	if (c->wish.width && (f->width != c->wish.width || f->height != c->wish.height))
		g_message("the camera %s makes frames of %u x %u, not of %u x %u", c->path,
			f->width, f->height, c->wish.width, c->wish.height);
	else if (c->device.attempt > 0)
		g_message("the camera %s: the USB has no room for more than %s, %u x %u", c->path,
			code, f->width, f->height);
}

static bool open_device(struct v4l2_camera *c, GError **error)
{
	if (!video_open(&c->device, c->calls, c->path, &c->wish, error))
		return false;
	if (!start(c, error)) {
		video_close(&c->device);
		return false;
	}
	const struct video_format *f = &c->device.format;
	if (f->bytes > FRAME_BYTES_MAX) {
		g_set_error(error, WIRE_ERROR, WIRE_ERROR_BROKEN,
			"the camera %s makes frames of %u x %u, too large for a record: [camera] "
			"can ask for a smaller width and height",
			c->path, f->width, f->height);
		video_close(&c->device);
		return false;
	}
	c->closed = false;
	c->settling = MAX(c->settling, SETTLE_FRAMES); /* the first ones are often half dark */
	c->last_frame_ns = now_ns(c);
	c->counts.openings++;
	g_free(c->tight);
	c->tight = camera_format_row_bytes(f->format, f->width) < f->row_bytes
			   ? g_malloc(camera_format_bytes(f->format, f->width, f->height))
			   : NULL;
	say_format(c);
	return true;
}

static int say_gone(struct v4l2_camera *c, GError **error, const char *text)
{
	if (!c->told_gone)
		g_message("%s; it is used again once it is back", text);
	c->told_gone = true;
	g_set_error_literal(error, WIRE_ERROR, WIRE_ERROR_GONE, text);
	return -1;
}

static int lose(struct v4l2_camera *c, GError **error, const char *why)
{
	g_autofree char *text = g_strdup_printf("the camera %s %s", c->path, why);
	close_device(c);
	return say_gone(c, error, text);
}

/* Looks for it, if it is time to: 0 when it is back. */
static int look_again(struct v4l2_camera *c, GError **error)
{
	g_autoptr(GError) failed = NULL;
	if (now_ns(c) < c->again_ns) {
		g_set_error(error, WIRE_ERROR, WIRE_ERROR_GONE, "the camera %s is gone", c->path);
		return -1;
	}
	c->again_ns = now_ns(c) + AGAIN_NS;
	if (!open_device(c, &failed))
		return say_gone(c, error, failed->message);
	if (c->told_gone)
		g_message("the camera %s is back", c->path);
	c->told_gone = false;
	return 0;
}

/* Something that a fresh start may cure; what was held is the driver's again. */
static int recover(struct v4l2_camera *c, GError **error, const char *why)
{
	c->held = NOT_HELD;
	c->last_frame_ns = now_ns(c);
	c->settling = MAX(c->settling, SETTLE_FRAMES);
	c->counted = false;
	c->counts.restarts++;
	unsigned failures = c->failures++;
	if (failures == 0 && video_restart(&c->device) == VIDEO_OK)
		return 0;
	if (failures > 1)
		return lose(c, error, why);
	c->failures = 2;
	close_device(c);
	c->again_ns = 0;
	return look_again(c, error);
}

/* No failure of its own: what it gets has another size from here on. */
static int follow_change(struct v4l2_camera *c, GError **error)
{
	c->counts.changes++;
	close_device(c);
	c->again_ns = 0;
	if (look_again(c, error) < 0)
		return -1;
	g_message("the camera %s brings pictures of %u x %u from now on", c->path,
		c->device.format.width, c->device.format.height);
	return 0;
}

static int react(struct v4l2_camera *c, enum video_result result, GError **error)
{
	switch (result) {
	case VIDEO_GONE: return lose(c, error, "was unplugged");
	case VIDEO_CHANGED: return follow_change(c, error);
	case VIDEO_BROKEN: return recover(c, error, "fails again and again");
	default: return 0;
	}
}

static int check_silence(struct v4l2_camera *c, GError **error)
{
	int64_t patience_ns = SILENCE_FRAMES * c->device.format.interval_ns +
			      c->in_force.exposure_100us * INT64_C(100000);
	if (now_ns(c) - c->last_frame_ns <= MAX(patience_ns, SILENCE_MIN_NS))
		return 0;
	c->counts.silences++;
	return recover(c, error, "sends no pictures");
}

/* ---- frames ---- */

static void count_frame(struct v4l2_camera *c, const struct video_frame *f)
{
	uint32_t passed = c->counted ? f->sequence - c->last_sequence : 1;
	/* A driver that begins anew has lost nothing that is known. */
	if (passed == 0 || passed > INT32_MAX)
		passed = 1;
	c->counts.frames++;
	c->counts.lost += passed - 1;
	c->sequence += c->counts.frames == 1 ? 0 : passed;
	c->counted = true;
	c->last_sequence = f->sequence;
	c->last_frame_ns = now_ns(c);
}

static bool is_whole(const struct v4l2_camera *c, const struct video_frame *f)
{
	const struct video_format *format = &c->device.format;
	return format->format->layout == CAMERA_MJPEG
		       ? camera_format_is_whole_jpeg(f->bytes, f->length) &&
				 f->length <= FRAME_BYTES_MAX
		       : f->length >= format->bytes;
}

/* When, and of what: CAMERA_STAMP_END or 0. */
static int64_t stamp(struct v4l2_camera *c, const struct video_frame *f, uint32_t *ret_flags)
{
	uint32_t clock = f->flags & V4L2_BUF_FLAG_TIMESTAMP_MASK;
	int64_t now = now_ns(c);
	bool possible = f->stamp_ns <= now && f->stamp_ns > now - STAMP_AGE_MAX_NS;
	c->counts.host_stamps =
		possible && (clock == V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC || c->trust);
	if (!c->counts.host_stamps) {
		if (!c->told_clock)
			g_message("the camera %s does not tell when its frames were taken: they "
				  "are taken to be as old as their arrival, and colours may be "
				  "a little beside",
				c->path);
		c->told_clock = true;
		*ret_flags = CAMERA_STAMP_END;
		return now;
	}
	*ret_flags = (f->flags & V4L2_BUF_FLAG_TSTAMP_SRC_MASK) == V4L2_BUF_FLAG_TSTAMP_SRC_SOE
			     ? 0
			     : CAMERA_STAMP_END;
	return f->stamp_ns;
}

static int64_t exposure_ns(const struct v4l2_camera *c)
{
	return c->in_force.exposure_100us * INT64_C(100000);
}

static const uint8_t *without_padding(
	struct v4l2_camera *c, const struct video_frame *f, size_t *ret_bytes)
{
	const struct video_format *v = &c->device.format;
	if (v->format->layout == CAMERA_MJPEG) {
		*ret_bytes = f->length;
		return f->bytes;
	}
	size_t row = camera_format_row_bytes(v->format, v->width);
	*ret_bytes = camera_format_bytes(v->format, v->width, v->height);
	if (!c->tight)
		return f->bytes;
	for (size_t i = 0; i < *ret_bytes / row; i++)
		memcpy(c->tight + i * row, f->bytes + i * v->row_bytes, row);
	return c->tight;
}

/* Whether this frame is what a loan waits for; if so info is filled in. */
static bool serves(
	struct v4l2_camera *c, const struct video_frame *f, struct camera_frame_info *ret)
{
	const struct video_format *v = &c->device.format;
	uint32_t of_stamp;
	count_frame(c, f);
	c->counts.damaged += f->damaged;
	bool whole = !f->damaged && is_whole(c, f);
	c->counts.cut += !f->damaged && !whole;
	if (c->settling > 0) {
		c->settling--;
		return false;
	}
	if (!whole)
		return false;
	c->failures = 0;
	int64_t stamp_ns = stamp(c, f, &of_stamp), began_ns = stamp_ns;
	if (of_stamp == CAMERA_STAMP_END)
		began_ns -= exposure_ns(c) + c->readout_ns;
	if (c->lent == 0 || began_ns < c->lent_ns)
		return false;
	*ret = (struct camera_frame_info){ .ticks = (uint32_t)(stamp_ns / 1000),
		.sequence = c->sequence,
		.flags = CAMERA_HOST_CLOCK | of_stamp | (v->full_range ? CAMERA_FULL_RANGE : 0) |
			 (v->bt709 ? CAMERA_BT709 : 0),
		.fourcc = v->format->fourcc,
		.width = v->width,
		.height = v->height,
		.controls = c->in_force };
	return true;
}

static int hand_out(struct v4l2_camera *c, const struct video_frame *f, const uint8_t **ret_pixels,
	size_t *ret_bytes, int64_t *ret_arrival_ns)
{
	c->held = f->index;
	c->lent--;
	c->counts.handed++;
	*ret_pixels = without_padding(c, f, ret_bytes);
	*ret_arrival_ns = now_ns(c);
	return 1;
}

static bool v4l2_queue(camera *base, GError **error)
{
	struct v4l2_camera *c = (struct v4l2_camera *)base;
	(void)error;
	if (c->lent == 0)
		c->lent_ns = now_ns(c);
	c->lent = MIN(c->lent + 1, VIDEO_BUFFERS_MAX);
	return true;
}

static int v4l2_read(camera *base, struct camera_frame_info *ret_info, const uint8_t **ret_pixels,
	size_t *ret_bytes, int64_t *ret_arrival_ns, GError **error)
{
	struct v4l2_camera *c = (struct v4l2_camera *)base;
	struct video_frame f;
	enum video_result result = VIDEO_OK;
	if (c->closed)
		return look_again(c, error);
	if (c->held != NOT_HELD)
		result = video_give_back(&c->device, c->held);
	c->held = NOT_HELD;
	while (result == VIDEO_OK && (result = video_take(&c->device, &f)) == VIDEO_OK) {
		if (serves(c, &f, ret_info))
			return hand_out(c, &f, ret_pixels, ret_bytes, ret_arrival_ns);
		result = video_give_back(&c->device, f.index);
	}
	return result == VIDEO_NOTHING ? check_silence(c, error) : react(c, result, error);
}

static int v4l2_wait_fd(camera *base)
{
	const struct v4l2_camera *c = (struct v4l2_camera *)base;
	return c->closed ? -1 : c->device.fd;
}

static void v4l2_close(camera *base)
{
	struct v4l2_camera *c = (struct v4l2_camera *)base;
	if (!c->closed)
		video_close(&c->device);
	g_string_free(c->controls.remark, TRUE);
	g_string_free(c->told, TRUE);
	g_free(c->tight);
	g_free(c->path);
	g_free(c);
}

static const struct camera_ops v4l2_ops = { .set_controls = v4l2_set_controls,
	.get_controls = v4l2_get_controls,
	.longest_exposure_100us = v4l2_longest_exposure_100us,
	.queue = v4l2_queue,
	.read = v4l2_read,
	.wait_fd = v4l2_wait_fd,
	.close = v4l2_close };

struct camera_v4l2_counts camera_v4l2_count(const camera *base)
{
	return ((const struct v4l2_camera *)base)->counts;
}

const char *camera_v4l2_remark(const camera *base)
{
	const struct v4l2_camera *c = (const struct v4l2_camera *)base;
	return c->told->len ? c->told->str : NULL;
}

int camera_v4l2_dma_buf(const camera *base)
{
	const struct v4l2_camera *c = (const struct v4l2_camera *)base;
	return c->held == NOT_HELD ? -1 : c->device.buffers[c->held].dma_fd;
}

/* ---- setting up ---- */

static bool read_fourcc(const parts *p, uint32_t *ret, GError **error)
{
	const char *text = parts_text(p, "camera", "format");
	size_t count;
	const struct camera_format *formats = camera_formats(&count);
	*ret = 0;
	if (!text || strcmp(text, "auto") == 0)
		return true;
	for (size_t i = 0; i < count; i++) {
		g_autofree char *code = camera_fourcc_text(formats[i].fourcc);
		if (strcmp(code, text) == 0) {
			*ret = formats[i].fourcc;
			return true;
		}
	}
	g_set_error(error, WIRE_ERROR, WIRE_ERROR_BROKEN,
		"[camera] format=%s is none that can be used: see pleinair.conf(5)", text);
	return false;
}

static bool read_trust(const parts *p, bool *ret, GError **error)
{
	const char *text = parts_text(p, "camera", "timestamps");
	*ret = g_strcmp0(text, "trust") == 0;
	if (!text || *ret || strcmp(text, "check") == 0)
		return true;
	g_set_error(error, WIRE_ERROR, WIRE_ERROR_BROKEN,
		"[camera] timestamps=%s is neither 'check' nor 'trust'", text);
	return false;
}

static bool read_keys(struct v4l2_camera *c, const parts *p, GError **error)
{
	double width, height, readout_us, focus;
	if (!parts_number(p, "camera", "width", 0, CAMERA_SIDE_MAX, 0, &width, error) ||
		!parts_number(p, "camera", "height", 0, CAMERA_SIDE_MAX, 0, &height, error) ||
		!parts_number(p, "camera", "readout_us", 0, 1e6, 0, &readout_us, error) ||
		!parts_number(p, "camera", "focus", -1, INT32_MAX, -1, &focus, error) ||
		!read_fourcc(p, &c->wish.fourcc, error) || !read_trust(p, &c->trust, error))
		return false;
	if ((width == 0) != (height == 0)) {
		g_set_error(error, WIRE_ERROR, WIRE_ERROR_BROKEN,
			"[camera] needs both width and height, or neither");
		return false;
	}
	c->wish.width = (uint32_t)width & ~1u;
	c->wish.height = (uint32_t)height & ~1u;
	c->readout_ns = (int64_t)(readout_us * 1000);
	c->controls.focus = (int32_t)focus;
	return true;
}

/* One that is not there now may be plugged in later; one that is no camera is a mistake. */
static bool open_first(struct v4l2_camera *c, GError **error)
{
	g_autoptr(GError) failed = NULL;
	if (open_device(c, &failed))
		return true;
	if (!g_error_matches(failed, WIRE_ERROR, WIRE_ERROR_GONE)) {
		g_propagate_error(error, g_steal_pointer(&failed));
		return false;
	}
	say_gone(c, NULL, failed->message);
	return true;
}

camera *camera_new_v4l2_on(head *h, const parts *p, const struct video_calls *calls, GError **error)
{
	const char *node = parts_text(p, "camera", "node");
	if (!node || strcmp(node, "none") == 0)
		return NULL;
	struct v4l2_camera *c = g_new0(struct v4l2_camera, 1);
	*c = (struct v4l2_camera){ .base = { &v4l2_ops, h },
		.calls = calls,
		.path = *node == '/' ? g_strdup(node) : g_strconcat("/dev/", node, NULL),
		.closed = true,
		.held = NOT_HELD,
		.told = g_string_new(NULL),
		.controls = { .remark = g_string_new(NULL) } };
	if (read_keys(c, p, error) && open_first(c, error))
		return &c->base;
	v4l2_close(&c->base);
	return NULL;
}

camera *camera_new_v4l2(head *h, const parts *p, GError **error)
{
	return camera_new_v4l2_on(h, p, &video_calls_kernel, error);
}
