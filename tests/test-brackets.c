/* Frames of several exposures as one photo: of known light, what is merged is what was there, through the one tone curve. */
#include "acquire/brackets.h"
#include "acquire/marks.h"
#include <math.h>
#include <string.h>

#define WIDTH  256u
#define HEIGHT 64u
#define BLOCKS (WIDTH * HEIGHT / 4)

/* ---- a camera of the test's own, as the definitions of sRGB and BT.601 have it ---- */

struct light {
	double rgb[3];
};

static double srgb(double v)
{
	return v <= 0.0031308 ? 12.92 * v : 1.055 * pow(v, 1 / 2.4) - 0.055;
}

static uint8_t rounded(double v)
{
	return (uint8_t)lrint(CLAMP(v, 0, 255));
}

/* Each block of 2 x 2 pixels has one light, so that chroma loses nothing. noise: of linear light, in parts of white. */
static uint8_t *expose(const struct light *lights, double exposure, double noise)
{
	uint8_t *nv12 = g_malloc(WIDTH * HEIGHT * 3 / 2), *chroma = nv12 + WIDTH * HEIGHT;
	for (uint32_t block = 0; block < BLOCKS; block++) {
		double c[3], add = noise * (g_test_rand_double() + g_test_rand_double() - 1);
		for (int k = 0; k < 3; k++)
			c[k] = 255 * srgb(CLAMP(lights[block].rgb[k] * exposure + add, 0, 1));
		double y = 0.299 * c[0] + 0.587 * c[1] + 0.114 * c[2];
		uint32_t u = 2 * (block % (WIDTH / 2)), v = 2 * (block / (WIDTH / 2));
		for (uint32_t k = 0; k < 4; k++)
			nv12[(v + k / 2) * WIDTH + u + k % 2] = rounded(16 + y * 219 / 255);
		chroma[v / 2 * WIDTH + u] = rounded(128 + (c[2] - y) / 1.772 * 224 / 255);
		chroma[v / 2 * WIDTH + u + 1] = rounded(128 + (c[0] - y) / 1.402 * 224 / 255);
	}
	return nv12;
}

static void colour_at(const uint8_t *nv12, uint32_t block, double ret[3])
{
	uint32_t u = 2 * (block % (WIDTH / 2)), v = 2 * (block / (WIDTH / 2));
	const uint8_t *chroma = nv12 + WIDTH * HEIGHT + v / 2 * WIDTH + u;
	double y = (nv12[v * WIDTH + u] - 16) * 255.0 / 219, cb = (chroma[0] - 128) * 255.0 / 224,
	       cr = (chroma[1] - 128) * 255.0 / 224;
	ret[0] = y + 1.402 * cr;
	ret[1] = y - 0.344136 * cb - 0.714136 * cr;
	ret[2] = y + 1.772 * cb;
}

/* From 1/1000 to four times what is white in the base exposure, of any hue. */
static struct light *made_lights(void)
{
	struct light *lights = g_new(struct light, BLOCKS);
	for (uint32_t i = 0; i < BLOCKS; i++) {
		double most = 4 * pow(2, -12.0 * i / BLOCKS);
		for (int k = 0; k < 3; k++)
			lights[i].rgb[k] = most * (i % 3 ? g_test_rand_double_range(0.3, 1) : 1);
	}
	return lights;
}

struct error {
	double mean, worst;
};

/* In steps of eight bits, against light through the curve. */
static struct error error_of(const uint8_t *nv12, const struct light *lights, double dimmer)
{
	struct error e = { 0 };
	for (uint32_t i = 0; i < BLOCKS; i++) {
		double got[3];
		colour_at(nv12, i, got);
		for (int k = 0; k < 3; k++) {
			double wanted = 255 * srgb(brackets_tone(lights[i].rgb[k] * dimmer)),
			       off = fabs(CLAMP(got[k], 0, 255) - wanted);
			e.mean += off / (3 * BLOCKS);
			e.worst = fmax(e.worst, off);
		}
	}
	return e;
}

/* ---- merging ---- */

static const struct ratios {
	const char *path;
	uint32_t count;
	double light[EXPOSURES_MAX]; /* the base first */
	double mean, worst;
} ratios[] = {
	{ "/brackets/merge/two-ev", 3, { 1, 0.25, 4 }, 0.8, 4 },
	/* As drivers round: the true ratio counts. */
	{ "/brackets/merge/odd-ratios", 3, { 1, 0.2, 3.7 }, 0.8, 4 },
	{ "/brackets/merge/order-does-not-matter", 3, { 4, 1, 16 }, 0.8, 4 },
	{ "/brackets/merge/without-lighter", 2, { 1, 0.25 }, 0.8, 4 },
};

static void test_merge(gconstpointer data)
{
	const struct ratios *r = data;
	g_autofree struct light *lights = made_lights();
	struct bracket_frame frames[EXPOSURES_MAX];
	g_autofree uint8_t *nv12 = g_malloc(WIDTH * HEIGHT * 3 / 2);
	for (uint32_t i = 0; i < r->count; i++)
		frames[i] = (struct bracket_frame){ expose(lights, r->light[i] / r->light[0], 0),
			r->light[i] };
	brackets_merge(frames, r->count, r->light[0], WIDTH, HEIGHT, nv12);
	struct error e = error_of(nv12, lights, 1);
	g_test_message("off by %.2f, at worst by %.1f", e.mean, e.worst);
	g_assert_cmpfloat(e.mean, <, r->mean);
	g_assert_cmpfloat(e.worst, <, r->worst);
	for (uint32_t i = 0; i < r->count; i++)
		g_free((gpointer)frames[i].pixels);
}

/* Up to the knee a photo that had but one exposure comes out as it went in. */
static void test_alone(void)
{
	g_autofree struct light *lights = made_lights();
	for (uint32_t i = 0; i < BLOCKS; i++)
		for (int k = 0; k < 3; k++)
			lights[i].rgb[k] *= BRACKETS_KNEE / BRACKETS_WHITE;
	g_autofree uint8_t *in = expose(lights, 1, 0), *out = g_malloc(WIDTH * HEIGHT * 3 / 2);
	struct bracket_frame frame = { in, 50 };
	brackets_merge(&frame, 1, 50, WIDTH, HEIGHT, out);
	int worst = 0;
	for (uint32_t i = 0; i < WIDTH * HEIGHT * 3 / 2; i++)
		worst = MAX(worst, abs(in[i] - out[i]));
	g_assert_cmpint(worst, <=, 2);
}

/* All white: the shortest says so, and it comes out white; all black likewise. Frames that contradict each other give a colour, too. */
static void test_ends(void)
{
	g_autofree struct light *lights = g_new0(struct light, BLOCKS);
	g_autofree uint8_t *black = expose(lights, 1, 0), *out = g_malloc(WIDTH * HEIGHT * 3 / 2);
	for (uint32_t i = 0; i < BLOCKS; i++)
		lights[i] = (struct light){ { 50, 50, 50 } };
	g_autofree uint8_t *white = expose(lights, 1, 0);
	struct bracket_frame whites[] = { { white, 1 }, { white, 0.25 }, { white, 4 } },
			     blacks[] = { { black, 1 }, { black, 0.25 }, { black, 4 } },
			     mixed[] = { { white, 1 }, { black, 0.25 }, { white, 4 } };
	brackets_merge(whites, 3, 1, WIDTH, HEIGHT, out);
	g_assert_cmpuint(out[0], ==, 235);
	brackets_merge(blacks, 3, 1, WIDTH, HEIGHT, out);
	g_assert_cmpuint(out[0], ==, 16);
	brackets_merge(mixed, 3, 1, WIDTH, HEIGHT, out);
	g_assert_cmpuint(out[0], ==, 16);
}

/* Sensors are noisy in the dark; the longer exposure is less so. */
static void test_noise(void)
{
	g_autofree struct light *lights = g_new0(struct light, BLOCKS);
	for (uint32_t i = 0; i < BLOCKS; i++)
		lights[i] = (struct light){ { 0.02, 0.02, 0.02 } };
	g_autofree uint8_t *base = expose(lights, 1, 0.01), *darker = expose(lights, 0.25, 0.01),
			   *lighter = expose(lights, 4, 0.01),
			   *out = g_malloc(WIDTH * HEIGHT * 3 / 2);
	struct bracket_frame frames[] = { { base, 1 }, { darker, 0.25 }, { lighter, 4 } };
	brackets_merge(frames, 1, 1, WIDTH, HEIGHT, out);
	double alone = error_of(out, lights, 1).mean;
	brackets_merge(frames, 3, 1, WIDTH, HEIGHT, out);
	double three = error_of(out, lights, 1).mean;
	g_test_message("off by %.2f of one frame, by %.2f of three", alone, three);
	g_assert_cmpfloat(three, <, alone / 2.5);
}

/* Identity, then a shoulder that never falls nor breaks, to white. */
static void test_tone(void)
{
	double last = 0, slope = 1;
	for (double x = 0.001; x < BRACKETS_WHITE; x += 0.001) {
		double y = brackets_tone(x), now = (y - last) / 0.001;
		if (x <= BRACKETS_KNEE)
			g_assert_cmpfloat(fabs(y - x), <, 1e-12);
		g_assert_cmpfloat(now, >, 0.01);
		g_assert_cmpfloat(fabs(now - slope), <, 0.01);
		last = y;
		slope = now;
	}
	g_assert_cmpfloat(fabs(brackets_tone(BRACKETS_WHITE) - 1), <, 1e-12);
	g_assert_cmpfloat(brackets_tone(100), <=, 1);
	/* Two stops above white are 25 steps of eight bits and more. */
	g_assert_cmpfloat(255 * (1 - srgb(brackets_tone(1))), >, 25);
}

static void test_speed(void)
{
	const uint32_t width = 1920, height = 1080;
	const size_t bytes = width * height * 3 / 2;
	g_autofree uint8_t *out = g_malloc(bytes);
	struct bracket_frame frames[3] = { { NULL, 1 }, { NULL, 0.25 }, { NULL, 4 } };
	for (int i = 0; i < 3; i++) {
		uint8_t *pixels = g_malloc(bytes);
		for (size_t k = 0; k < bytes; k++)
			pixels[k] = (uint8_t)(16 + (k * 2654435761u >> 13) % 220);
		frames[i].pixels = pixels;
	}
	int64_t best_us = INT64_MAX;
	for (int i = 0; i < 10; i++) {
		int64_t begun_us = g_get_monotonic_time();
		brackets_merge(frames, 3, 1, width, height, out);
		best_us = MIN(best_us, g_get_monotonic_time() - begun_us);
	}
	g_test_message("%u x %u: %.1f ms", width, height, (double)best_us * 1e-3);
	g_assert_cmpint(best_us, <, 2 * G_USEC_PER_SEC);
	for (int i = 0; i < 3; i++)
		g_free((gpointer)frames[i].pixels);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	for (size_t i = 0; i < G_N_ELEMENTS(ratios); i++)
		g_test_add_data_func(ratios[i].path, &ratios[i], test_merge);
	g_test_add_func("/brackets/merge/alone", test_alone);
	g_test_add_func("/brackets/merge/ends", test_ends);
	g_test_add_func("/brackets/merge/noise", test_noise);
	g_test_add_func("/brackets/tone", test_tone);
	g_test_add_func("/brackets/speed", test_speed);
	return g_test_run();
}
