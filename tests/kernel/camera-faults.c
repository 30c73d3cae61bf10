/* camera-faults WEBCAM CABLE: the camera behind V4L2 on two of the kernel's own test cameras (vivid): a webcam, and a multi-planar box that an HDMI cable
 * brings a picture to. Their pictures are known, and each is told to fail in the ways that it has. Prints TAP. */
#include "acquire/frames.h"
#include "firmware-io/camera-v4l2.h"
#include <fcntl.h>
#include <math.h>
#include <poll.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

#define WIDTH  320u
#define HEIGHT 180u
#define BARS   8

static const char *webcam, *cable;

/* ---- what the test camera is told ---- */

/* Opened for it alone: vivid comes back from "Disconnect" once nobody has it open. */
static int open_node(const char *node)
{
	int fd = open(node, O_RDWR | O_CLOEXEC);
	g_assert_cmpint(fd, >=, 0);
	return fd;
}

static struct v4l2_query_ext_ctrl find(int fd, const char *name)
{
	struct v4l2_query_ext_ctrl q = { .id = V4L2_CTRL_FLAG_NEXT_CTRL };
	while (ioctl(fd, VIDIOC_QUERY_EXT_CTRL, &q) == 0 && strcmp(q.name, name) != 0)
		q.id |= V4L2_CTRL_FLAG_NEXT_CTRL;
	g_assert_cmpstr(q.name, ==, name);
	return q;
}

static void set(const char *node, const char *name, int32_t value)
{
	int fd = open_node(node);
	struct v4l2_query_ext_ctrl q = find(fd, name);
	struct v4l2_ext_control one = { .id = q.id, .value = value };
	struct v4l2_ext_controls all = {
		.which = V4L2_CTRL_WHICH_CUR_VAL, .count = 1, .controls = &one
	};
	g_assert_cmpint(ioctl(fd, VIDIOC_S_EXT_CTRLS, &all), ==, 0);
	close(fd);
}

static void press(const char *name)
{
	set(webcam, name, 1);
}

/* The entry of a menu, by its words. */
static void choose(const char *node, const char *name, const char *entry)
{
	int fd = open_node(node);
	struct v4l2_query_ext_ctrl q = find(fd, name);
	struct v4l2_querymenu m = { .id = q.id };
	for (; m.index <= q.maximum; m.index++)
		if (ioctl(fd, VIDIOC_QUERYMENU, &m) == 0 &&
			strcmp((const char *)m.name, entry) == 0)
			break;
	g_assert_cmpstr((const char *)m.name, ==, entry);
	close(fd);
	set(node, name, (int32_t)m.index);
}

/* Its usual five frames a second would make a long test. */
static void hurry(const char *node)
{
	struct v4l2_streamparm p = { .type = V4L2_BUF_TYPE_VIDEO_CAPTURE };
	int fd = open_node(node);
	p.parm.capture.timeperframe = (struct v4l2_fract){ 1, 15 };
	g_assert_cmpint(ioctl(fd, VIDIOC_S_PARM, &p), ==, 0);
	close(fd);
}

/* ---- the camera ---- */

static camera *open_camera(const char *node, const char *keys)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *uri = g_strdup_printf("tim:?camera.node=%s%s", node, keys);
	g_autoptr(parts) p = parts_read(uri, &error);
	g_assert_no_error(error);
	camera *c = camera_new_v4l2(NULL, p, &error);
	g_assert_no_error(error);
	return c;
}

struct got {
	struct camera_frame_info info;
	const uint8_t *pixels;
	size_t bytes;
	int64_t arrival_ns;
	GString *said; /* sentences of reads that failed */
};

static void clear(struct got *g)
{
	if (g->said)
		g_string_free(g->said, TRUE);
}
/* As a head made of parts does: asks for a frame, and waits at most a while each time. */
static struct got take(camera *c)
{
	struct got g = { .said = g_string_new(NULL) };
	g_assert_true(camera_queue(c, NULL));
	for (int turns = 0; turns < 300; turns++) {
		g_autoptr(GError) error = NULL;
		int result = c->ops->read(c, &g.info, &g.pixels, &g.bytes, &g.arrival_ns, &error);
		if (result > 0)
			return g;
		if (error && !strstr(g.said->str, error->message))
			g_string_append_printf(g.said, "%s\n", error->message);
		struct pollfd p = { .fd = c->ops->wait_fd(c), .events = POLLIN };
		poll(&p, 1, 50);
		if (p.revents & (POLLERR | POLLHUP))
			g_usleep(10000);
	}
	g_error("no frame came in fifteen seconds: %s", g.said->str);
}

static void take_and_forget(camera *c)
{
	struct got g = take(c);
	clear(&g);
}

static void end(camera *c)
{
	c->ops->close(c);
}

/* ---- tests ---- */

static uint8_t as_seen(const struct camera_format *f, uint8_t value)
{
	double linear = value / 255.0;
	/* Raw pixels are taken to be linear, and get the curve of sRGB; vivid's have it already. */
	return camera_format_is_raw(f) && value > 0
		       ? (uint8_t)lrint(255 * (1.055 * pow(linear, 1 / 2.4) - 0.055))
		       : value;
}

static void assert_bar(const struct camera_format *f, const uint8_t *nv12, uint32_t width,
	uint32_t height, int bar)
{
	static const uint8_t bars[BARS][3] = { { 191, 191, 191 }, { 191, 191, 0 }, { 0, 191, 191 },
		{ 0, 191, 0 }, { 191, 0, 191 }, { 191, 0, 0 }, { 0, 0, 191 }, { 0, 0, 0 } };
	uint32_t x = (width * (2 * bar + 1) / (2 * BARS)) & ~1u, row = height * 3 / 4 & ~1u;
	const uint8_t *chroma = nv12 + (size_t)width * height + row / 2 * width + x;
	double y = 255.0 / 219 * (nv12[row * width + x] - 16), cb = 255.0 / 224 * (chroma[0] - 128),
	       cr = 255.0 / 224 * (chroma[1] - 128);
	double rgb[3] = { y + 1.402 * cr, y - 0.344136 * cb - 0.714136 * cr, y + 1.772 * cb };
	g_test_message("bar %d: %.0f %.0f %.0f", bar, rgb[0], rgb[1], rgb[2]);
	for (int k = 0; k < 3; k++)
		g_assert_cmpfloat(fabs(CLAMP(rgb[k], 0, 255) - as_seen(f, bars[bar][k])), <=, 6);
}

/* So many formats at most that both know: the bars have their colours, wherever pixels and their chroma lie. */
static unsigned see_formats(const char *node, const char *size, unsigned most)
{
	size_t count;
	unsigned seen = 0;
	const struct camera_format *formats = camera_formats(&count);
	for (size_t i = 0; i < count && seen < most; i++) {
		g_autoptr(frames) f = frames_new();
		g_autoptr(GError) error = NULL;
		g_autofree char *code = camera_fourcc_text(formats[i].fourcc);
		g_autofree char *uri =
			g_strdup_printf("tim:?camera.node=%s%s&camera.format=%s", node, size, code);
		g_autoptr(parts) p = parts_read(uri, NULL);
		camera *c = camera_new_v4l2(NULL, p, &error);
		if (!c) {
			g_test_message("%s: %s", code, error->message);
			continue;
		}
		struct got g = take(c);
		struct camera_frame_info info;
		g_assert_cmpuint(g.info.fourcc, ==, formats[i].fourcc);
		const uint8_t *nv12 = frames_nv12(f, &g.info, g.pixels, g.bytes, &info);
		g_assert_nonnull(nv12);
		g_test_message("%s, %u x %u", code, info.width, info.height);
		for (int bar = 0; bar < BARS; bar++)
			assert_bar(&formats[i], nv12, info.width, info.height, bar);
		clear(&g);
		end(c);
		seen++;
	}
	return seen;
}

static const char *const size = "&camera.width=320&camera.height=180";

static void test_formats(void)
{
	unsigned seen = see_formats(webcam, size, UINT_MAX);
	g_test_message("%u formats", seen);
	g_assert_cmpuint(seen, >=, 6); /* YUYV, NV12, four of Bayer */
}

/* Frames come on their beat, stamped by the host's clock; what is locked is read back. */
static void test_beat(void)
{
	camera *c = open_camera(webcam, size);
	struct camera_controls controls = { 50, 100, 5500 };
	int64_t first_us = 0, at_us = 0;
	uint32_t first = 0, last = 0;
	camera_set_controls(c, &controls, NULL);
	for (int i = 0; i < 12; i++) {
		struct got g = take(c);
		g_assert_cmpuint(g.info.width, ==, WIDTH);
		g_assert_cmpuint(g.info.height, ==, HEIGHT);
		int64_t before_us = at_us;
		at_us = frames_host_ns(g.info.ticks, g.arrival_ns) / 1000;
		g_assert_cmpint(g.arrival_ns / 1000, >=, at_us);
		g_assert_cmpint(at_us, >, before_us);
		first_us = i == 0 ? at_us : first_us;
		first = i == 0 ? g.info.sequence : first;
		last = g.info.sequence;
		clear(&g);
	}
	/* Each is stamped when the only processor comes to it. */
	double beat_ms = 1e-3 * (double)(at_us - first_us) / (last - first);
	g_test_message("a frame each %.2f ms", beat_ms);
	g_assert_cmpfloat_with_epsilon(beat_ms, 66.667, 3);
	struct camera_v4l2_counts n = camera_v4l2_count(c);
	g_assert_true(n.host_stamps);
	g_assert_cmpuint(n.damaged + n.cut + n.restarts, ==, 0);
	g_test_message("remark: %s", camera_v4l2_remark(c));
	end(c);
}

static void test_damaged(void)
{
	camera *c = open_camera(webcam, size);
	take_and_forget(c);
	for (int i = 0; i < 3; i++) {
		press("Inject V4L2_BUF_FLAG_ERROR");
		take_and_forget(c);
		take_and_forget(c);
	}
	struct camera_v4l2_counts n = camera_v4l2_count(c);
	g_assert_cmpuint(n.damaged, ==, 3);
	g_assert_cmpuint(n.handed, ==, 7);
	g_assert_cmpuint(n.restarts, ==, 0);
	end(c);
}

static void test_dropped(void)
{
	camera *c = open_camera(webcam, size);
	take_and_forget(c);
	set(webcam, "Percentage of Dropped Buffers", 60);
	for (int i = 0; i < 10; i++)
		take_and_forget(c);
	set(webcam, "Percentage of Dropped Buffers", 0);
	struct camera_v4l2_counts n = camera_v4l2_count(c);
	g_test_message("%" G_GUINT64_FORMAT " of %" G_GUINT64_FORMAT " were lost", n.lost,
		n.lost + n.frames);
	g_assert_cmpuint(n.lost, >=, 1);
	g_assert_cmpuint(n.damaged + n.restarts, ==, 0);
	end(c);
}

/* The stream breaks; it is started again, and where that fails too, the whole device. */
static void test_broken(void)
{
	static const struct {
		const char *faults[3];
		unsigned openings;
	} broken[] = { { { "Inject Fatal Streaming Error" }, 1 },
		{ { "Inject VIDIOC_STREAMON Error", "Inject Fatal Streaming Error" }, 2 },
		{ { "Inject VIDIOC_QBUF Error" }, 1 } };
	for (size_t i = 0; i < G_N_ELEMENTS(broken); i++) {
		camera *c = open_camera(webcam, size);
		take_and_forget(c);
		for (int k = 0; k < 3 && broken[i].faults[k]; k++)
			press(broken[i].faults[k]);
		take_and_forget(c);
		take_and_forget(c);
		struct camera_v4l2_counts n = camera_v4l2_count(c);
		g_test_message("%s: restarts %" G_GUINT64_FORMAT ", openings %" G_GUINT64_FORMAT,
			broken[i].faults[0], n.restarts, n.openings);
		g_assert_cmpuint(n.restarts, ==, 1);
		g_assert_cmpuint(n.openings, ==, broken[i].openings);
		end(c);
	}
}

/* Already on opening: it is looked for again, and that goes well. */
static void test_broken_from_the_start(void)
{
	static const char *const faults[] = { "Inject VIDIOC_REQBUFS Error",
		"Inject VIDIOC_STREAMON Error" };
	for (size_t i = 0; i < G_N_ELEMENTS(faults); i++) {
		press(faults[i]);
		camera *c = open_camera(webcam, size);
		struct got g = take(c);
		g_test_message("%s: %s", faults[i], g.said->str);
		clear(&g);
		end(c);
	}
}

static void test_unplugged(void)
{
	camera *c = open_camera(webcam, size);
	struct got before = take(c);
	press("Disconnect");
	struct got g = take(c);
	g_test_message("%s", g.said->str);
	g_assert_nonnull(strstr(g.said->str, "was unplugged"));
	g_assert_cmpuint(g.info.sequence, >, before.info.sequence);
	g_assert_cmpuint(camera_v4l2_count(c).openings, ==, 2);
	clear(&before);
	clear(&g);
	end(c);
}

/* Multi-planar; the cable brings another size, then nothing, then something again. */
static void test_cable(void)
{
	choose(cable, "DV Timings Signal Mode", "Selected DV Timings");
	choose(cable, "DV Timings", "640x480p59");
	g_assert_cmpuint(see_formats(cable, "", 2), ==, 2); /* they are large: YUYV, NV12 */
	camera *c = open_camera(cable, "");
	struct got g = take(c);
	g_assert_cmpuint(g.info.width, ==, 640);
	clear(&g);
	choose(cable, "DV Timings", "720x480p59");
	g = take(c);
	g_assert_cmpuint(g.info.width, ==, 720);
	g_assert_cmpuint(camera_v4l2_count(c).changes, >=, 1);
	clear(&g);
	static const struct {
		const char *mode, *words;
	} wrong[] = { { "No Signal", "gets no picture" }, { "No Lock", "does not hold still" },
		{ "Out of Range", "a size or rate" } };
	for (size_t i = 0; i < G_N_ELEMENTS(wrong); i++) {
		g_autoptr(GError) error = NULL;
		choose(cable, "DV Timings Signal Mode", wrong[i].mode);
		g_assert_cmpint(
			c->ops->read(c, &g.info, &g.pixels, &g.bytes, &g.arrival_ns, &error), ==,
			-1);
		g_test_message("%s: %s", wrong[i].mode, error->message);
		g_assert_nonnull(strstr(error->message, wrong[i].words));
		choose(cable, "DV Timings Signal Mode", "Selected DV Timings");
		take_and_forget(c);
	}
	end(c);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	if (argc != 3) {
		g_printerr("usage: camera-faults WEBCAM CABLE\n");
		return 2;
	}
	webcam = argv[1];
	cable = argv[2];
	hurry(webcam);
	for (int i = 1; i < 3; i++) {
		choose(argv[i], "OSD Text Mode", "None");
		/* Its frames are there before their end, as it stamps it. */
		choose(argv[i], "Timestamp Source", "Start of Exposure");
	}
	g_test_add_func("/vivid/formats", test_formats);
	g_test_add_func("/vivid/beat", test_beat);
	g_test_add_func("/vivid/damaged", test_damaged);
	g_test_add_func("/vivid/dropped", test_dropped);
	g_test_add_func("/vivid/broken", test_broken);
	g_test_add_func("/vivid/broken-from-the-start", test_broken_from_the_start);
	g_test_add_func("/vivid/unplugged", test_unplugged);
	g_test_add_func("/vivid/cable", test_cable);
	return g_test_run();
}
