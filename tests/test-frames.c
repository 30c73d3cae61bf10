/* Frames to NV12, each kind against its definition written out in doubles; stamps; what is refused. */
#include "acquire/frames.h"
#include "acquire/stream.h"
#include "firmware-io/camera-format.h"
#include "firmware-io/stage.h"
#include <linux/videodev2.h>
#include <math.h>
#include <string.h>
#include <turbojpeg.h>

#define WIDTH  16u
#define HEIGHT 16u
#define PIXELS ((size_t)WIDTH * HEIGHT)

static struct camera_frame_info info_of(uint32_t fourcc, uint32_t flags)
{
	return (struct camera_frame_info){ .ticks = 7,
		.sequence = 3,
		.flags = flags,
		.fourcc = fourcc,
		.width = WIDTH,
		.height = HEIGHT,
		.controls = { 50, 100, 5500 } };
}

static void fill(uint8_t *bytes, size_t length)
{
	for (size_t i = 0; i < length; i++)
		bytes[i] = (uint8_t)g_test_rand_int_range(0, 256);
}

static void assert_near(const uint8_t *nv12, size_t i, double wanted, double within)
{
	g_assert_cmpfloat(fabs(nv12[i] - CLAMP(wanted, 0, 255)), <=, within);
}

/* Y, Cb, Cr in bytes from R, G, B in 0..1: kr and kb as BT.601 and BT.709 have them. */
static void yuv_of(const double rgb[3], double kr, double kb, bool full, double ret[3])
{
	double y = kr * rgb[0] + (1 - kr - kb) * rgb[1] + kb * rgb[2];
	ret[0] = full ? 255 * y : 16 + 219 * y;
	ret[1] = 128 + (full ? 255 : 224) * (rgb[2] - y) / (2 * (1 - kb));
	ret[2] = 128 + (full ? 255 : 224) * (rgb[0] - y) / (2 * (1 - kr));
}

static void test_yuyv(void)
{
	g_autoptr(frames) f = frames_new();
	uint8_t yuyv[2 * PIXELS];
	struct camera_frame_info info = info_of(V4L2_PIX_FMT_YUYV, 0), made;
	fill(yuyv, sizeof yuyv);
	const uint8_t *nv12 = frames_nv12(f, &info, yuyv, sizeof yuyv, &made);
	g_assert_nonnull(nv12);
	g_assert_cmpuint(made.fourcc, ==, CAMERA_FOURCC_NV12);
	g_assert_cmpuint(made.sequence, ==, 3);
	for (uint32_t y = 0; y < HEIGHT; y++)
		for (uint32_t x = 0; x < WIDTH; x++) {
			const uint8_t *four = yuyv + (y * WIDTH + (x & ~1u)) * 2,
				      *next = yuyv + ((y ^ 1) * WIDTH + (x & ~1u)) * 2;
			g_assert_cmpuint(nv12[y * WIDTH + x], ==, four[x % 2 ? 2 : 0]);
			for (int c = 0; c < 2; c++)
				assert_near(nv12, PIXELS + y / 2 * WIDTH + (x & ~1u) + (unsigned)c,
					(four[1 + 2 * c] + next[1 + 2 * c]) / 2.0, 0.5);
		}
}

static void test_nv12_as_it_is(void)
{
	g_autoptr(frames) f = frames_new();
	uint8_t bytes[PIXELS * 3 / 2];
	struct camera_frame_info info = info_of(V4L2_PIX_FMT_NV12, 0), made;
	g_assert_true(frames_nv12(f, &info, bytes, sizeof bytes, &made) == bytes);
}

/* A plain colour, as a camera would write it in another range or by another matrix, comes out as BT.601 has it. */
static void test_ranges_and_matrices(void)
{
	g_autoptr(frames) f = frames_new();
	for (unsigned i = 0; i < 400; i++) {
		double rgb[3], yuv[3], wanted[3];
		bool full = i & 1, bt709 = i & 2;
		uint8_t bytes[PIXELS * 3 / 2];
		struct camera_frame_info made,
			info = info_of(V4L2_PIX_FMT_NV12,
				(full ? CAMERA_FULL_RANGE : 0) | (bt709 ? CAMERA_BT709 : 0));
		for (int k = 0; k < 3; k++)
			rgb[k] = g_test_rand_double();
		yuv_of(rgb, bt709 ? 0.2126 : 0.299, bt709 ? 0.0722 : 0.114, full, yuv);
		yuv_of(rgb, 0.299, 0.114, false, wanted);
		for (size_t p = 0; p < sizeof bytes; p++)
			bytes[p] = (uint8_t)lrint(yuv[p < PIXELS ? 0 : 1 + p % 2]);
		const uint8_t *nv12 = frames_nv12(f, &info, bytes, sizeof bytes, &made);
		g_assert_nonnull(nv12);
		g_assert_cmpuint(made.flags & (CAMERA_FULL_RANGE | CAMERA_BT709), ==, 0);
		for (size_t p = 0; p < sizeof bytes; p++)
			assert_near(nv12, p, wanted[p < PIXELS ? 0 : 1 + p % 2], 2);
	}
}

/* ---- Bayer ---- */

static unsigned channel_at(const struct camera_format *f, uint32_t x, uint32_t y)
{
	bool rx = (x & 1) == f->red_x, ry = (y & 1) == f->red_y;
	return rx && ry ? 0 : rx || ry ? 1 : 2;
}

static void write_pixel(
	const struct camera_format *f, uint8_t *bytes, uint32_t x, uint32_t y, unsigned ten)
{
	uint8_t *row = bytes + y * camera_format_row_bytes(f, WIDTH);
	if (f->layout == CAMERA_BAYER_8)
		row[x] = (uint8_t)(ten >> 2);
	else if (f->layout == CAMERA_BAYER_10) {
		row[2 * x] = (uint8_t)ten;
		row[2 * x + 1] = (uint8_t)(ten >> 8);
	} else {
		row[x / 4 * 5 + x % 4] = (uint8_t)(ten >> 2);
		row[x / 4 * 5 + 4] |= (uint8_t)((ten & 3) << 2 * (x % 4));
	}
}

static double srgb(double v)
{
	return v <= 0.0031308 ? 12.92 * v : 1.055 * pow(v, 1 / 2.4) - 0.055;
}

/* The mean of a channel's pixels in the three by three about a pixel: what bilinear means on this pattern. Outside is mirrored. */
static double mean_near(
	const struct camera_format *f, const unsigned *ten, int x, int y, unsigned of)
{
	double sum = 0;
	int n = 0;
	if (channel_at(f, (uint32_t)x, (uint32_t)y) == of)
		return ten[y * (int)WIDTH + x];
	for (int j = y - 1; j <= y + 1; j++)
		for (int i = x - 1; i <= x + 1; i++) {
			int mx = i < 0             ? -i
				 : i >= (int)WIDTH ? 2 * (int)WIDTH - 2 - i
						   : i,
			    my = j < 0              ? -j
				 : j >= (int)HEIGHT ? 2 * (int)HEIGHT - 2 - j
						    : j;
			if (channel_at(f, (uint32_t)mx, (uint32_t)my) != of)
				continue;
			sum += ten[my * (int)WIDTH + mx];
			n++;
		}
	return sum / n;
}

static void check_bayer(frames *all, const struct camera_format *f)
{
	unsigned ten[PIXELS], most = f->layout == CAMERA_BAYER_8 ? 1020 : 1023;
	uint8_t bytes[2 * PIXELS] = { 0 };
	struct camera_frame_info info = info_of(f->fourcc, 0), made;
	for (uint32_t y = 0; y < HEIGHT; y++)
		for (uint32_t x = 0; x < WIDTH; x++) {
			/* No darker than where the curve is steep: rounding shows there. */
			unsigned v = (unsigned)g_test_rand_int_range(100, 1024);
			ten[y * WIDTH + x] = f->layout == CAMERA_BAYER_8 ? v & ~3u : v;
			write_pixel(f, bytes, x, y, v);
		}
	const uint8_t *nv12 =
		frames_nv12(all, &info, bytes, camera_format_bytes(f, WIDTH, HEIGHT), &made);
	g_assert_nonnull(nv12);
	for (int y = 0; y < (int)HEIGHT; y += 2)
		for (int x = 0; x < (int)WIDTH; x += 2) {
			double cb = 0, cr = 0;
			for (int k = 0; k < 4; k++) {
				double rgb[3], yuv[3];
				for (unsigned c = 0; c < 3; c++)
					rgb[c] = srgb(
						mean_near(f, ten, x + k % 2, y + k / 2, c) / most);
				yuv_of(rgb, 0.299, 0.114, false, yuv);
				assert_near(nv12, (size_t)((y + k / 2) * (int)WIDTH + x + k % 2),
					yuv[0], 2);
				cb += yuv[1] / 4;
				cr += yuv[2] / 4;
			}
			size_t at = PIXELS + (size_t)(y / 2 * (int)WIDTH + x);
			assert_near(nv12, at, cb, 2);
			assert_near(nv12, at + 1, cr, 2);
		}
}

static void test_bayer(void)
{
	g_autoptr(frames) f = frames_new();
	size_t count, checked = 0;
	const struct camera_format *formats = camera_formats(&count);
	for (size_t i = 0; i < count; i++)
		if (camera_format_is_raw(&formats[i])) {
			check_bayer(f, &formats[i]);
			checked++;
		}
	g_assert_cmpuint(checked, ==, 12);
}

/* ---- MJPEG ---- */

/* A smooth picture of RGB, as compressors like it. */
static GBytes *jpeg_of(uint8_t rgb[3 * PIXELS], int subsampling)
{
	tjhandle t = tjInitCompress();
	unsigned char *bytes = NULL;
	unsigned long length = 0;
	for (uint32_t y = 0; y < HEIGHT; y++)
		for (uint32_t x = 0; x < WIDTH; x++) {
			uint8_t *p = rgb + 3 * (y * WIDTH + x);
			p[0] = (uint8_t)(40 + 8 * x);
			p[1] = (uint8_t)(60 + 7 * y);
			p[2] = (uint8_t)(220 - 5 * x - 3 * y);
		}
	g_assert_cmpint(tjCompress2(t, rgb, WIDTH, 0, HEIGHT, TJPF_RGB, &bytes, &length,
				subsampling, 100, TJFLAG_ACCURATEDCT),
		==, 0);
	GBytes *kept = g_bytes_new(bytes, length);
	tjFree(bytes);
	tjDestroy(t);
	return kept;
}

static void test_mjpeg(void)
{
	const int kinds[] = { TJSAMP_444, TJSAMP_422, TJSAMP_420, TJSAMP_440, TJSAMP_GRAY };
	g_autoptr(frames) f = frames_new();
	struct camera_frame_info info = info_of(V4L2_PIX_FMT_MJPEG, 0), made;
	for (size_t i = 0; i < G_N_ELEMENTS(kinds); i++) {
		uint8_t rgb[3 * PIXELS];
		g_autoptr(GBytes) jpeg = jpeg_of(rgb, kinds[i]);
		gsize length;
		const uint8_t *bytes = g_bytes_get_data(jpeg, &length),
			      *nv12 = frames_nv12(f, &info, bytes, length, &made);
		g_assert_nonnull(nv12);
		for (uint32_t p = 0; p < PIXELS; p++) {
			double v[3] = { rgb[3 * p] / 255.0, rgb[3 * p + 1] / 255.0,
				rgb[3 * p + 2] / 255.0 },
			       yuv[3];
			yuv_of(v, 0.299, 0.114, false, yuv);
			uint32_t x = p % WIDTH, y = p / WIDTH;
			assert_near(nv12, p, yuv[0], 3);
			for (uint32_t c = 0; c < 2; c++)
				assert_near(nv12, PIXELS + y / 2 * WIDTH + (x & ~1u) + c,
					kinds[i] == TJSAMP_GRAY ? 128 : yuv[1 + c], 8);
		}
	}
}

/* Cut anywhere, and with the endings that cameras put there. */
static void test_mjpeg_cut(void)
{
	g_autoptr(frames) f = frames_new();
	struct camera_frame_info info = info_of(V4L2_PIX_FMT_MJPEG, 0), made;
	uint8_t rgb[3 * PIXELS];
	g_autoptr(GBytes) jpeg = jpeg_of(rgb, TJSAMP_422);
	gsize length;
	const uint8_t *whole = g_bytes_get_data(jpeg, &length);
	g_autofree uint8_t *bytes = g_malloc0(length + 2);
	memcpy(bytes, whole, length);
	g_assert_nonnull(frames_nv12(f, &info, bytes, length + 2, &made)); /* ends 0000 */
	g_assert_nonnull(frames_nv12(f, &info, bytes, length + 1, &made)); /* ends d900 */
	for (gsize cut = 0; cut < length; cut++) {
		g_assert_null(frames_nv12(f, &info, bytes, cut, &made));
		g_autofree uint8_t *padded = g_malloc0(length + 2);
		memcpy(padded, whole, cut);
		if (cut < length - 2)
			g_assert_null(frames_nv12(f, &info, padded, length, &made));
	}
	info.width += 2; /* not what the picture is */
	g_assert_null(frames_nv12(f, &info, bytes, length, &made));
}

/* ---- what is refused; stamps ---- */

static void test_refused(void)
{
	g_autoptr(frames) f = frames_new();
	uint8_t bytes[2 * PIXELS + 2] = { 0 };
	struct camera_frame_info made, good = info_of(V4L2_PIX_FMT_YUYV, 0), bad;
	g_assert_nonnull(frames_nv12(f, &good, bytes, 2 * PIXELS, &made));
	g_assert_null(frames_nv12(f, &good, bytes, 2 * PIXELS - 1, &made));
	g_assert_null(frames_nv12(f, &good, bytes, 2 * PIXELS + 1, &made));
	bad = good;
	bad.flags = CAMERA_FRAME_ERROR;
	g_assert_null(frames_nv12(f, &bad, bytes, 2 * PIXELS, &made));
	bad = good;
	bad.fourcc = V4L2_PIX_FMT_RGB24;
	g_assert_null(frames_nv12(f, &bad, bytes, 2 * PIXELS, &made));
	bad = good;
	bad.width = 15;
	g_assert_null(frames_nv12(f, &bad, bytes, (size_t)15 * HEIGHT * 2, &made));
	bad.width = bad.height = 0;
	g_assert_null(frames_nv12(f, &bad, bytes, 0, &made));
}

static void test_stamps(void)
{
	const int64_t wrap_us = INT64_C(1) << 32;
	for (int i = 0; i < 1000; i++) {
		int64_t stamp_us = (int64_t)(g_test_rand_double() * 1e13),
			late_ns = g_test_rand_int_range(-1000000, 2000000000);
		int64_t arrival_ns = MAX(stamp_us * 1000 + late_ns, 0);
		if (i < 4) /* about the wrap itself */
			stamp_us = 3 * wrap_us - i, arrival_ns = (3 * wrap_us + 2) * 1000;
		g_assert_cmpint(
			frames_host_ns((uint32_t)stamp_us, arrival_ns), ==, stamp_us * 1000);
	}
	struct camera_frame_info info = info_of(0, CAMERA_HOST_CLOCK);
	g_assert_cmpint(frames_middle_ns(&info, 8000), ==, 2500000);
	info.flags |= CAMERA_STAMP_END;
	g_assert_cmpint(frames_middle_ns(&info, 8000), ==, -8000000 - 2500000);
}

/* ---- in a record ---- */

#define SECOND_NS INT64_C(1000000000)
#define LOCKED                                                                                     \
	"{\"camera\": {\"exposure_100us\": 50, \"gain_percent\": 100, \"white_balance_k\": 5500}}"

struct seen {
	unsigned frames, locked;
	double front_rad;
	struct camera_frame_info info;
};

static void see_frame(const struct camera_frame_info *info, const uint8_t *pixels, double front_rad,
	bool locked, gpointer user_data)
{
	struct seen *seen = user_data;
	g_assert_nonnull(pixels);
	seen->frames++;
	seen->locked += locked;
	seen->front_rad = front_rad;
	seen->info = *info;
}

static void feed(
	stream *s, enum record_kind kind, int64_t time_ns, const void *payload, size_t length)
{
	g_autoptr(GError) error = NULL;
	/* Payloads of a record are aligned. */
	g_autofree void *copy = g_memdup2(payload, length);
	struct record_entry e = {
		.kind = kind, .length = (uint32_t)length, .time_ns = time_ns, .payload = copy
	};
	stream_feed(s, &e, &error);
	g_assert_no_error(error);
}

/* A stage of 3600 steps goes a hundred steps a second, from its home slot at 1 s. */
static void feed_stage(stream *s)
{
	for (int i = 0; i <= 200; i++) {
		uint32_t ticks = (uint32_t)(1000000 + i * 10000);
		struct stage_event events[2] = { { ticks, 1, STAGE_STEP, 0 },
			{ ticks, 1, i == 0 ? STAGE_HOME : STAGE_STEP, 0 } };
		feed(s, RECORD_STAGE, ticks * INT64_C(1000), events,
			(i == 0 ? 2 : 1) * sizeof *events);
	}
}

static void feed_session(stream *s, const char *of_camera)
{
	g_autofree char *text = g_strdup_printf(
		"{\"device\":\"x:\",\"protocol\":\"scip\",\"time\":\"2026-11-21T03:18:12Z\","
		"\"calibration\":{\"serial\":\"t\",\"lidar\":{\"beam_zero_deg\":90,"
		"\"beam_direction\":1,\"range_offset_m\":0,\"rotation_deg\":[0,0,0],"
		"\"translation_m\":[0,0,0]},\"stage\":{\"steps_per_turn\":3600,\"index_slots\":1,"
		"\"azimuth_zero_deg\":0,\"clock_hz\":1000000,\"clock_bits\":32},\"camera\":%s}}",
		of_camera);
	feed(s, RECORD_SESSION, SECOND_NS / 2, text, strlen(text));
}

static void feed_frame(
	stream *s, const struct camera_frame_info *info, size_t bytes, int64_t time_ns)
{
	g_autofree uint8_t *payload = g_malloc0(sizeof *info + bytes);
	memcpy(payload, info, sizeof *info);
	feed(s, RECORD_FRAME, time_ns, payload, sizeof *info + bytes);
}

#define CAMERA                                                                                     \
	"{\"width\":16,\"height\":16,\"fx\":20,\"fy\":20,\"cx\":8,\"cy\":6,"                       \
	"\"distortion\":[0,0,0,0,0],\"rotation\":[[1,0,0],[0,0,-1],[0,1,0]],"                      \
	"\"translation_m\":[0,0,0],\"clock_hz\":1000000,\"clock_bits\":32,\"readout_us\":20000}"

/* The angle is that of the middle of the exposure, however late a frame comes, and whatever its stamp is of. */
static void test_in_a_record(void)
{
	struct seen seen = { 0 };
	struct stream_sink sink = { .frame = see_frame, .user_data = &seen };
	g_autoptr(stream) s = stream_new(STREAM_LIVE, &sink);
	feed_session(s, CAMERA);
	feed(s, RECORD_MARK, SECOND_NS, LOCKED, strlen(LOCKED));
	feed_stage(s);
	struct camera_frame_info info = info_of(V4L2_PIX_FMT_YUYV, CAMERA_HOST_CLOCK);
	const double per_second = 100 * 2 * G_PI / 3600;
	double start_rad = 0;
	for (int i = 0; i < 3; i++) {
		bool of_end = i == 2;
		info.ticks = 1500000 + (of_end ? 20000 + 5000 : 0);
		info.flags = CAMERA_HOST_CLOCK | (of_end ? CAMERA_STAMP_END : 0);
		feed_frame(s, &info, 2 * PIXELS, (i == 0 ? 2 : 3) * SECOND_NS);
		g_assert_cmpuint(seen.frames, ==, (unsigned)i + 1);
		start_rad = i == 0 ? seen.front_rad : start_rad;
		g_assert_cmpfloat_with_epsilon(seen.front_rad, start_rad, 1e-9);
	}
	info.ticks += 300000;
	feed_frame(s, &info, 2 * PIXELS, 3 * SECOND_NS);
	g_assert_cmpfloat_with_epsilon(seen.front_rad - start_rad, 0.3 * per_second, 1e-4);
	g_assert_cmpuint(seen.info.fourcc, ==, CAMERA_FOURCC_NV12);
	g_assert_cmpuint(seen.locked, ==, 4);
	info.controls.exposure_100us++;
	feed_frame(s, &info, 2 * PIXELS, 3 * SECOND_NS);
	g_assert_cmpuint(seen.locked, ==, 4);
	/* Too short, of another size, and no picture at all. */
	feed_frame(s, &info, 2 * PIXELS - 1, 3 * SECOND_NS);
	info.width = 14;
	feed_frame(s, &info, 2 * 14 * HEIGHT, 3 * SECOND_NS);
	info.width = 16;
	info.fourcc = V4L2_PIX_FMT_MJPEG;
	feed_frame(s, &info, 2 * PIXELS, 3 * SECOND_NS);
	g_assert_cmpuint(seen.frames, ==, 5);
	g_assert_cmpuint(stream_get_report(s).bad_frames, ==, 3);
}

/* Where the head's certificate knows nothing of a camera its frames are kept, and not used. */
static void test_camera_not_known(void)
{
	struct seen seen = { 0 };
	struct stream_sink sink = { .frame = see_frame, .user_data = &seen };
	g_autoptr(stream) s = stream_new(STREAM_LIVE, &sink);
	feed_session(s, "null");
	feed_stage(s);
	struct camera_frame_info info = info_of(V4L2_PIX_FMT_YUYV, CAMERA_HOST_CLOCK);
	feed_frame(s, &info, 2 * PIXELS, 2 * SECOND_NS);
	g_assert_cmpuint(seen.frames, ==, 0);
	g_assert_cmpuint(stream_get_report(s).bad_frames, ==, 0);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/frames/yuyv", test_yuyv);
	g_test_add_func("/frames/nv12-as-it-is", test_nv12_as_it_is);
	g_test_add_func("/frames/ranges-and-matrices", test_ranges_and_matrices);
	g_test_add_func("/frames/bayer", test_bayer);
	g_test_add_func("/frames/mjpeg", test_mjpeg);
	g_test_add_func("/frames/mjpeg-cut", test_mjpeg_cut);
	g_test_add_func("/frames/refused", test_refused);
	g_test_add_func("/frames/stamps", test_stamps);
	g_test_add_func("/frames/in-a-record", test_in_a_record);
	g_test_add_func("/frames/camera-not-known", test_camera_not_known);
	return g_test_run();
}
