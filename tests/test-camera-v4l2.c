/* The camera behind V4L2, on a device of the test's own (video-made.h) that fails as it is told. */
#include "firmware-io/camera-v4l2.h"
#include "tests/video-made.h"

#define MS INT64_C(1000000)

static const struct camera_controls usual = { 50, 100, 5500 };

static camera *open_with(const char *keys)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *uri = g_strconcat("tim:?camera.node=/dev/video-made", keys, NULL);
	g_autoptr(parts) p = parts_read(uri, &error);
	g_assert_no_error(error);
	camera *c = camera_new_v4l2_on(NULL, p, &made_calls, &error);
	g_assert_no_error(error);
	return c;
}

static void end(camera *c)
{
	c->ops->close(c);
	g_assert_cmpuint(made.mapped, ==, 0);
	g_assert_cmpint(made.open_fds, ==, 0);
}

struct got {
	int result;
	struct camera_frame_info info;
	const uint8_t *pixels;
	size_t bytes;
	int64_t arrival_ns;
};

static struct got read_once(camera *c)
{
	struct got g = { 0 };
	g_autoptr(GError) error = NULL;
	g.result = c->ops->read(c, &g.info, &g.pixels, &g.bytes, &g.arrival_ns, &error);
	g_assert_true((g.result < 0) == (error != NULL));
	if (error)
		g_assert_error(error, WIRE_ERROR, WIRE_ERROR_GONE);
	return g;
}

/* Until something comes, or a time has passed. */
static struct got wait_for(camera *c, int64_t ns)
{
	struct got g = read_once(c);
	for (int64_t until_ns = made.now_ns + ns; g.result == 0 && made.now_ns < until_ns;) {
		made_pass(10 * MS);
		g = read_once(c);
	}
	return g;
}

/* Controls are set, and have settled. */
static camera *open_settled(const char *keys)
{
	camera *c = open_with(keys);
	g_assert_true(c->ops->set_controls(c, &usual, NULL));
	g_assert_cmpint(wait_for(c, 600 * MS).result, ==, 0); /* nothing was lent */
	return c;
}

static struct got lend_and_wait(camera *c)
{
	g_assert_true(c->ops->queue(c, NULL));
	return wait_for(c, 1000 * MS);
}

static void assert_pixels(const struct got *g, uint32_t sequence, size_t bytes)
{
	g_assert_cmpuint(g->bytes, ==, bytes);
	for (size_t i = 0; i < bytes; i++)
		g_assert_cmpuint(g->pixels[i], ==, made_byte(sequence, i));
}

/* ---- what is agreed on ---- */

static void test_uncompressed_is_preferred(void)
{
	made_webcam();
	camera *c = open_settled("&camera.width=64&camera.height=48");
	struct got g = lend_and_wait(c);
	g_assert_cmpint(g.result, ==, 1);
	g_assert_cmpuint(g.info.fourcc, ==, V4L2_PIX_FMT_YUYV);
	g_assert_cmpuint(g.info.width, ==, 64);
	g_assert_cmpuint(g.info.height, ==, 48);
	assert_pixels(&g, made.sequence - 1, 64 * 48 * 2);
	g_assert_cmpuint(made.frees, >, 0); /* before each S_FMT, or it is busy */
	end(c);
}

static void test_format_as_asked(void)
{
	made_webcam();
	camera *c = open_settled("&camera.format=MJPG");
	struct got g = lend_and_wait(c);
	g_assert_cmpuint(g.info.fourcc, ==, V4L2_PIX_FMT_MJPEG);
	g_assert_cmpuint(g.bytes, ==, 1000);
	end(c);
}

/* Only the compressed format comes in the size that was asked for: it is read back, not believed. */
static void test_nearest_size(void)
{
	made_webcam();
	camera *c = open_settled("&camera.width=50&camera.height=40");
	struct got g = lend_and_wait(c);
	g_assert_cmpuint(g.info.width, ==, 64);
	g_assert_cmpuint(g.info.height, ==, 48);
	end(c);
}

static void test_no_room_on_the_bus(void)
{
	made_webcam();
	made.room = 3000; /* 64 x 48 YUYV has 6144, MJPG 384 */
	camera *c = open_settled("");
	g_assert_cmpuint(lend_and_wait(c).info.fourcc, ==, V4L2_PIX_FMT_MJPEG);
	end(c);
	made_webcam();
	made.offered[0] = V4L2_PIX_FMT_YUYV;
	made.offered[1] = 0;
	made.room = 3000; /* then smaller ones */
	c = open_settled("");
	struct got g = lend_and_wait(c);
	g_assert_cmpuint(g.info.width, ==, 32);
	assert_pixels(&g, made.sequence - 1, 32 * 24 * 2);
	end(c);
	made.room = 10; /* nothing helps: it is as good as gone */
	c = open_with("");
	g_assert_cmpint(read_once(c).result, ==, -1);
	end(c);
}

/* Each raw kind, rows padded, single and multi planar (with an offset): what is handed out is tight. */
static void test_layouts(void)
{
	const uint32_t kinds[] = { V4L2_PIX_FMT_NV12, V4L2_PIX_FMT_SGRBG8, V4L2_PIX_FMT_SGRBG10,
		V4L2_PIX_FMT_SRGGB10P };
	for (size_t i = 0; i < 4 * G_N_ELEMENTS(kinds); i++) {
		made_webcam();
		made.multi = i & 1;
		made.pad = i & 2 ? 24 : 0;
		made.caps = V4L2_CAP_STREAMING |
			    (made.multi ? V4L2_CAP_VIDEO_CAPTURE_MPLANE : V4L2_CAP_VIDEO_CAPTURE);
		made.offered[0] = made.fourcc = kinds[i / 4];
		made.offered[1] = 0;
		made.quantization = i & 1 ? V4L2_QUANTIZATION_FULL_RANGE : 0;
		camera *c = open_settled("");
		struct got g = lend_and_wait(c);
		g_assert_cmpint(g.result, ==, 1);
		g_assert_cmpuint(g.info.fourcc, ==, kinds[i / 4]);
		assert_pixels(&g, made.sequence - 1,
			camera_format_bytes(camera_format_find(kinds[i / 4]), 64, 48));
		g_assert_true(!(g.info.flags & CAMERA_FULL_RANGE) == !(i & 1));
		end(c);
	}
}

static void test_dma_buf(void)
{
	made_webcam();
	camera *c = open_settled("");
	g_assert_cmpint(camera_v4l2_dma_buf(c), ==, -1); /* none is out */
	lend_and_wait(c);
	g_assert_cmpint(camera_v4l2_dma_buf(c), >=, 0);
	g_assert_cmpuint(made.exports, ==, 4);
	read_once(c);
	g_assert_cmpint(camera_v4l2_dma_buf(c), ==, -1);
	end(c);
	made_webcam();
	made.no_export = true;
	c = open_settled("");
	g_assert_cmpint(lend_and_wait(c).result, ==, 1);
	g_assert_cmpint(camera_v4l2_dma_buf(c), ==, -1);
	end(c);
}

/* ---- controls ---- */

static void test_controls(void)
{
	made_webcam();
	camera *c = open_with("&camera.focus=33");
	struct camera_controls in_force = { 0 };
	g_assert_true(c->ops->set_controls(c, &(struct camera_controls){ 68, 850, 5503 }, NULL));
	c->ops->get_controls(c, &in_force);
	g_assert_cmpuint(in_force.exposure_100us, ==, 68);
	g_assert_cmpuint(in_force.white_balance_k, ==, 5500); /* it goes by tens */
	g_assert_cmpint(made_control(V4L2_CID_EXPOSURE_AUTO)->value, ==, V4L2_EXPOSURE_MANUAL);
	g_assert_cmpint(made_control(V4L2_CID_EXPOSURE_AUTO_PRIORITY)->value, ==, 0);
	g_assert_cmpint(made_control(V4L2_CID_BACKLIGHT_COMPENSATION)->value, ==, 0);
	g_assert_cmpint(made_control(V4L2_CID_FOCUS_AUTO)->value, ==, 0);
	g_assert_cmpint(made_control(V4L2_CID_FOCUS_ABSOLUTE)->value, ==, 35);
	/* 850 % is the middle of 100 to 1600; a step of the gain is 5.9 %. */
	g_assert_cmpint(made_control(V4L2_CID_GAIN)->value, ==, 128);
	g_assert_cmpuint(in_force.gain_percent, ==, 853);
	g_assert_null(camera_v4l2_remark(c));
	/* As long as from one frame to the next: its beat stays. */
	g_assert_cmpuint(camera_longest_exposure_100us(c), ==, 500);
	wait_for(c, 600 * MS);
	struct got g = lend_and_wait(c);
	g_assert_cmpint(memcmp(&g.info.controls, &in_force, sizeof in_force), ==, 0);
	end(c);
}

/* Frames that were under way, and two more, are let go. */
static void test_frames_before_they_settle(void)
{
	made_webcam();
	camera *c = open_settled("");
	uint32_t from = made.sequence;
	g_assert_true(c->ops->set_controls(c, &(struct camera_controls){ 60, 100, 5500 }, NULL));
	struct got g = lend_and_wait(c);
	g_assert_cmpint(g.result, ==, 1);
	assert_pixels(&g, from + 4 + 2, 64 * 48 * 2);
	/* The same again changes nothing. */
	from = made.sequence;
	g_assert_true(c->ops->set_controls(c, &(struct camera_controls){ 60, 100, 5500 }, NULL));
	g = lend_and_wait(c);
	assert_pixels(&g, from, 64 * 48 * 2);
	end(c);
}

static void test_controls_that_do_not_stick(void)
{
	made_webcam();
	made_control(V4L2_CID_EXPOSURE_ABSOLUTE)->sticks_at = 120;
	made_control(V4L2_CID_AUTO_WHITE_BALANCE)->sticks_at = 1;
	camera *c = open_settled("");
	struct camera_controls in_force;
	c->ops->get_controls(c, &in_force);
	g_assert_cmpuint(in_force.exposure_100us, ==, 120); /* what it says, not what was asked */
	g_assert_cmpuint(lend_and_wait(c).info.controls.exposure_100us, ==, 120);
	g_assert_cmpstr(camera_v4l2_remark(c), ==,
		"it changes its white balance by itself; it does not keep its exposure");
	end(c);
}

static void test_controls_that_are_missing(void)
{
	made_webcam();
	memset(made.controls, 0, sizeof made.controls);
	camera *c = open_settled("");
	struct got g = lend_and_wait(c);
	g_assert_cmpint(g.result, ==, 1);
	g_assert_cmpuint(g.info.controls.exposure_100us, ==, 0);
	g_assert_cmpuint(g.info.controls.gain_percent, ==, 100);
	g_assert_cmpuint(g.info.controls.white_balance_k, ==, 0);
	g_assert_cmpstr(camera_v4l2_remark(c), ==,
		"it has no control of its exposure; it has no control of its gain; it has no "
		"control of its white balance");
	end(c);
}

/* ---- loans and stamps ---- */

static void test_only_what_began_after(void)
{
	made_webcam();
	camera *c = open_settled("");
	for (int i = 0; i < 20; i++) {
		made_pass(7 * MS * i % (50 * MS));
		read_once(c);
		int64_t lent_ns = made.now_ns;
		struct got g = lend_and_wait(c);
		g_assert_cmpint(g.result, ==, 1);
		g_assert_cmpuint(g.info.flags & (CAMERA_HOST_CLOCK | CAMERA_STAMP_END), ==,
			CAMERA_HOST_CLOCK);
		int64_t stamp_us =
			(int64_t)g.info.ticks + (made.now_ns / 1000 & ~INT64_C(0xffffffff));
		g_assert_cmpint(stamp_us * 1000, >=, lent_ns);
		g_assert_cmpint(stamp_us * 1000, <=, lent_ns + 50 * MS);
		g_assert_cmpint(wait_for(c, 200 * MS).result, ==, 0); /* one loan, one frame */
	}
	end(c);
}

static void test_stamps_of_the_end(void)
{
	made_webcam();
	made.stamp_flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_EOF;
	camera *c = open_settled("&camera.readout_us=8000");
	read_once(c);
	int64_t lent_ns = made.now_ns;
	struct got g = lend_and_wait(c);
	g_assert_true(g.info.flags & CAMERA_STAMP_END);
	int64_t stamp_us = (int64_t)g.info.ticks + (made.now_ns / 1000 & ~INT64_C(0xffffffff));
	g_assert_cmpint(stamp_us * 1000 - 13 * MS, >=, lent_ns);
	end(c);
}

static void test_other_clocks(void)
{
	made_webcam();
	made.stamp_flags = V4L2_BUF_FLAG_TIMESTAMP_COPY;
	for (int trusts = 0; trusts < 2; trusts++) {
		camera *c = open_settled(trusts ? "&camera.timestamps=trust" : "");
		struct got g = lend_and_wait(c);
		g_assert_cmpint(g.result, ==, 1);
		g_assert_true(g.info.flags & CAMERA_STAMP_END);
		g_assert_cmpint(camera_v4l2_count(c).host_stamps, ==, trusts);
		if (!trusts)
			g_assert_cmpuint(g.info.ticks, ==, (uint32_t)(g.arrival_ns / 1000));
		end(c);
	}
	/* Says that it stamps by our clock, and does not. */
	made_webcam();
	made.stale_stamps = 1;
	camera *c = open_settled("&camera.timestamps=trust");
	struct got g = lend_and_wait(c);
	g_assert_false(camera_v4l2_count(c).host_stamps);
	g_assert_cmpuint(g.info.ticks, ==, (uint32_t)(g.arrival_ns / 1000));
	end(c);
}

/* ---- what goes wrong ---- */

static void test_bad_frames(void)
{
	made_webcam();
	camera *c = open_settled("");
	uint32_t from = made.sequence;
	made.error_frames = 2;
	made.short_frames = 1; /* the first of those that are in error anyway */
	struct got g = lend_and_wait(c);
	assert_pixels(&g, from + 2, 64 * 48 * 2); /* the loan is kept for the first good one */
	made.absurd_frames = 1;
	made.short_frames = 1;
	g_assert_cmpint(lend_and_wait(c).result, ==, 1);
	made.short_frames = 2;
	g_assert_cmpint(lend_and_wait(c).result, ==, 1);
	struct camera_v4l2_counts n = camera_v4l2_count(c);
	g_assert_cmpuint(n.damaged, ==, 3);
	g_assert_cmpuint(n.cut, ==, 2);
	g_assert_cmpuint(n.handed, ==, 3);
	g_assert_cmpuint(n.restarts, ==, 0);
	end(c);
}

static void test_truncated_mjpeg(void)
{
	made_webcam();
	camera *c = open_settled("&camera.format=MJPG");
	uint32_t from = made.sequence;
	made.short_frames = 3;
	struct got g = lend_and_wait(c);
	g_assert_cmpuint(g.pixels[2], ==, made_byte(from + 3, 2));
	g_assert_cmpuint(camera_v4l2_count(c).cut, ==, 3);
	end(c);
}

static void test_gaps(void)
{
	made_webcam();
	camera *c = open_settled("");
	struct got before = lend_and_wait(c);
	made.dropped_frames = 3;
	struct got after = lend_and_wait(c);
	g_assert_cmpuint(camera_v4l2_count(c).lost, ==, 3);
	g_assert_cmpuint(after.info.sequence - before.info.sequence, >=, 4);
	end(c);
}

static void test_errors_are_cured(void)
{
	const int codes[] = { EIO, EPIPE, EINVAL };
	for (size_t i = 0; i < G_N_ELEMENTS(codes); i++) {
		made_webcam();
		camera *c = open_settled("");
		struct got before = lend_and_wait(c);
		made.dqbuf_errno = codes[i];
		struct got g = lend_and_wait(c);
		g_assert_cmpint(g.result, ==, 1);
		g_assert_cmpuint(
			g.info.sequence, >, before.info.sequence); /* the driver's began anew */
		g_assert_cmpuint(camera_v4l2_count(c).restarts, ==, 1);
		g_assert_cmpuint(made.opens, ==, 1);
		end(c);
	}
	/* A signal came between: nothing happened. */
	made_webcam();
	camera *c = open_settled("");
	made.dqbuf_errno = EINTR;
	g_assert_cmpint(lend_and_wait(c).result, ==, 1);
	g_assert_cmpuint(camera_v4l2_count(c).restarts, ==, 0);
	end(c);
}

/* Silence: the stream is started again, then the device, then it is given up and looked for. */
static void test_silence(void)
{
	made_webcam();
	camera *c = open_settled("");
	c->ops->queue(c, NULL);
	unsigned ons = made.stream_ons;
	made.silent = true;
	g_assert_cmpint(wait_for(c, 1900 * MS).result, ==, 0);
	g_assert_cmpuint(made.stream_ons, ==, ons);
	g_assert_cmpint(wait_for(c, 400 * MS).result, ==, 0);
	g_assert_cmpuint(made.stream_ons, ==, ons + 1);
	g_assert_cmpuint(made.opens, ==, 1);
	g_assert_cmpint(wait_for(c, 2200 * MS).result, ==, 0);
	g_assert_cmpuint(made.opens, ==, 2);
	g_assert_cmpint(wait_for(c, 2200 * MS).result, ==, -1);
	g_assert_cmpint(c->ops->wait_fd(c), ==, -1);
	g_assert_cmpuint(camera_v4l2_count(c).silences, ==, 3);
	/* It comes to, and the loan is served. */
	made.silent = false;
	made_pass(1100 * MS);
	g_assert_cmpint(read_once(c).result, ==, 0);
	g_assert_cmpint(wait_for(c, 1000 * MS).result, ==, 1);
	end(c);
}

static void test_slow_exposure_is_no_silence(void)
{
	made_webcam();
	made.interval_ns = 2500 * MS;
	camera *c = open_with("");
	g_assert_cmpint(wait_for(c, 7400 * MS).result, ==, 0);
	g_assert_cmpuint(camera_v4l2_count(c).silences, ==, 0);
	g_assert_cmpuint(camera_v4l2_count(c).frames, ==, 2);
	end(c);
}

static void test_unplugged(void)
{
	made_webcam();
	camera *c = open_settled("");
	struct got before = lend_and_wait(c);
	made.absent = true;
	made_pass(60 * MS);
	g_assert_cmpint(read_once(c).result, ==, -1);
	g_assert_cmpint(c->ops->wait_fd(c), ==, -1);
	g_assert_cmpint(made.open_fds, ==, 0);
	for (int i = 0; i < 30; i++) {
		made_pass(100 * MS);
		g_assert_cmpint(read_once(c).result, ==, -1);
	}
	/* Meanwhile nothing that is asked of it fails. */
	g_assert_true(c->ops->set_controls(c, &(struct camera_controls){ 77, 100, 6000 }, NULL));
	g_assert_true(c->ops->queue(c, NULL));
	/* Another device behind the same name, with its own mind about exposure. */
	made.absent = false;
	made_control(V4L2_CID_EXPOSURE_AUTO)->value = 3;
	made_pass(1100 * MS);
	g_assert_cmpint(read_once(c).result, ==, 0);
	g_assert_cmpint(c->ops->wait_fd(c), >=, 0);
	struct got g = wait_for(c, 1000 * MS);
	g_assert_cmpint(g.result, ==, 1);
	g_assert_cmpuint(g.info.controls.exposure_100us, ==, 77);
	g_assert_cmpuint(g.info.sequence, >, before.info.sequence);
	g_assert_cmpuint(camera_v4l2_count(c).openings, ==, 2);
	end(c);
}

static void test_plugged_in_later(void)
{
	made_webcam();
	made.absent = true;
	camera *c = open_with("");
	g_assert_nonnull(c);
	g_assert_cmpint(read_once(c).result, ==, -1);
	made.absent = false;
	made_pass(1100 * MS);
	g_assert_cmpint(read_once(c).result, ==, 0);
	g_assert_cmpint(lend_and_wait(c).result, ==, 1);
	end(c);
	/* Used by somebody else. */
	made_webcam();
	made.in_use = true;
	c = open_with("");
	g_assert_cmpint(read_once(c).result, ==, -1);
	made.in_use = false;
	made_pass(1100 * MS);
	g_assert_cmpint(read_once(c).result, ==, 0);
	end(c);
}

/* A box behind an HDMI cable: the size is the cable's, may change at any time, and the cable may be pulled. */
static void test_cable(void)
{
	made_webcam();
	made.on_cable = true;
	made.cable_width = 96;
	made.cable_height = 54;
	camera *c = open_settled("");
	g_assert_cmpuint(lend_and_wait(c).info.width, ==, 96);
	c->ops->queue(c, NULL);
	made.cable_width = 128;
	made.cable_changes = 3; /* as it takes to settle */
	struct got g = wait_for(c, 1000 * MS);
	g_assert_cmpint(g.result, ==, 1);
	g_assert_cmpuint(g.info.width, ==, 128);
	assert_pixels(&g, made.sequence - 1, 128 * 54 * 2);
	struct camera_v4l2_counts n = camera_v4l2_count(c);
	g_assert_cmpuint(n.changes, ==, 1);
	g_assert_cmpuint(n.restarts, ==, 0);
	static const struct {
		int code;
		const char *words;
	} wrong[] = { { ENOLINK, "gets no picture" }, { ENOLCK, "does not hold still" },
		{ ERANGE, "a size or rate" } };
	for (size_t i = 0; i < G_N_ELEMENTS(wrong); i++) {
		g_autoptr(GError) error = NULL;
		made.cable_errno = wrong[i].code;
		made.cable_changes = 1;
		g_assert_cmpint(
			c->ops->read(c, &g.info, &g.pixels, &g.bytes, &g.arrival_ns, &error), ==,
			-1);
		g_assert_error(error, WIRE_ERROR, WIRE_ERROR_GONE);
		g_assert_nonnull(strstr(error->message, wrong[i].words));
		/* It comes back by itself. */
		made.cable_errno = 0;
		made_pass(1100 * MS);
		g_assert_cmpint(read_once(c).result, ==, 0);
		g_assert_cmpint(lend_and_wait(c).result, ==, 1);
	}
	end(c);
}

static void test_words(void)
{
	static const struct {
		const char *keys, *words;
		uint32_t caps, format;
	} bad[] = {
		{ "", "takes no pictures", V4L2_CAP_STREAMING | V4L2_CAP_META_CAPTURE, 0 },
		{ "", "takes no pictures", V4L2_CAP_VIDEO_CAPTURE, 0 },
		{ "", "has no format", 0, V4L2_PIX_FMT_RGB24 },
		{ "&camera.format=NV12", "does not have the format that is set", 0, 0 },
		{ "&camera.format=RGB3", "format=RGB3 is none", 0, 0 },
		{ "&camera.timestamps=maybe", "neither 'check' nor 'trust'", 0, 0 },
		{ "&camera.width=640", "both width and height", 0, 0 },
		{ "&camera.width=wide", "not a number", 0, 0 },
	};
	for (size_t i = 0; i < G_N_ELEMENTS(bad); i++) {
		g_autoptr(GError) error = NULL;
		g_autofree char *uri =
			g_strconcat("tim:?camera.node=/dev/video-made", bad[i].keys, NULL);
		g_autoptr(parts) p = parts_read(uri, NULL);
		made_webcam();
		made.caps = bad[i].caps ? bad[i].caps : made.caps;
		if (bad[i].format) {
			made.offered[0] = bad[i].format;
			made.offered[1] = 0;
			made.fourcc = V4L2_PIX_FMT_YUYV;
		}
		g_assert_null(camera_new_v4l2_on(NULL, p, &made_calls, &error));
		g_assert_error(error, WIRE_ERROR, WIRE_ERROR_BROKEN);
		g_assert_nonnull(strstr(error->message, bad[i].words));
		g_assert_cmpint(made.open_fds, ==, 0);
	}
	/* None is set up: that is no error. */
	g_autoptr(GError) error = NULL;
	g_autoptr(parts) none = parts_read("tim:?camera.node=none", NULL);
	g_assert_null(camera_new_v4l2(NULL, none, &error));
	g_assert_no_error(error);
	/* The kernel's own calls, on what is no camera. */
	g_autoptr(parts) null = parts_read("tim:?camera.node=/dev/null", NULL);
	g_assert_null(camera_new_v4l2(NULL, null, &error));
	g_assert_nonnull(strstr(error->message, "/dev/null is no camera"));
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/camera-v4l2/uncompressed-is-preferred", test_uncompressed_is_preferred);
	g_test_add_func("/camera-v4l2/format-as-asked", test_format_as_asked);
	g_test_add_func("/camera-v4l2/nearest-size", test_nearest_size);
	g_test_add_func("/camera-v4l2/no-room-on-the-bus", test_no_room_on_the_bus);
	g_test_add_func("/camera-v4l2/layouts", test_layouts);
	g_test_add_func("/camera-v4l2/dma-buf", test_dma_buf);
	g_test_add_func("/camera-v4l2/controls", test_controls);
	g_test_add_func("/camera-v4l2/frames-before-they-settle", test_frames_before_they_settle);
	g_test_add_func("/camera-v4l2/controls-that-do-not-stick", test_controls_that_do_not_stick);
	g_test_add_func("/camera-v4l2/controls-that-are-missing", test_controls_that_are_missing);
	g_test_add_func("/camera-v4l2/only-what-began-after", test_only_what_began_after);
	g_test_add_func("/camera-v4l2/stamps-of-the-end", test_stamps_of_the_end);
	g_test_add_func("/camera-v4l2/other-clocks", test_other_clocks);
	g_test_add_func("/camera-v4l2/bad-frames", test_bad_frames);
	g_test_add_func("/camera-v4l2/truncated-mjpeg", test_truncated_mjpeg);
	g_test_add_func("/camera-v4l2/cable", test_cable);
	g_test_add_func("/camera-v4l2/gaps", test_gaps);
	g_test_add_func("/camera-v4l2/errors-are-cured", test_errors_are_cured);
	g_test_add_func("/camera-v4l2/silence", test_silence);
	g_test_add_func(
		"/camera-v4l2/slow-exposure-is-no-silence", test_slow_exposure_is_no_silence);
	g_test_add_func("/camera-v4l2/unplugged", test_unplugged);
	g_test_add_func("/camera-v4l2/plugged-in-later", test_plugged_in_later);
	g_test_add_func("/camera-v4l2/words", test_words);
	return g_test_run();
}
