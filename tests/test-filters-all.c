/* What goes for every filter: the same bytes whatever draws it, pictures of any size, and no pop when the focus moves. */
#include "tests/filter-made.h"
#include <stdlib.h>

#define WIDTH  157u
#define HEIGHT 93u

static const char *const all_steps[] = { "\"kuwahara\",\"passes\":2",
	"\"kuwahara\",\"radius_px\":12,\"softness\":0", "\"anisotropic-kuwahara\"", "\"bilateral\"",
	"\"gaussian\"", "\"gaps\"", "\"quantise\"", "\"quantise\",\"by\":\"channels\"",
	"\"quantise\",\"by\":\"channels\",\"softness\":0,\"smooth_px\":0", "\"dog\"",
	"\"dog\",\"flow_px\":3", "\"edges\",\"wobble_px\":1", "\"watercolour\"", "\"flow\"",
	"\"oil\"", "\"pencil\"", "\"grade\",\"segments\":0.5,\"hue_shift_deg\":40", "\"warp\"",
	"\"occlusion\"", "\"edl\"" };

/* The same bytes for any vectors and any number of threads; and in one pixel, a row, a column. */
static void test_bytes(void)
{
	for (size_t n = 0; n < G_N_ELEMENTS(all_steps); n++) {
		struct filter_made m = filter_made_new(WIDTH, HEIGHT, "");
		struct filter_image *i = &m.job.image;
		g_autofree uint8_t(*first)[4] = NULL;
		for (int path = 0; path <= (int)lanes_path_widest(); path++)
			for (int single = 0; single < 2; single++) {
				filter_made_fill(i, 5);
				m.job.lanes = (enum lanes_path)path;
				m.frame->single_thread = single;
				filter_made_run(&m, all_steps[n]);
				if (!first)
					first = copy_of(i);
				if (memcmp(first, i->rgba, filter_pixels(i) * 4) != 0)
					g_error("%s: other bytes by vectors %d, threads %s",
						all_steps[n], path, single ? "one" : "all");
			}
		filter_made_clear(&m);
		static const uint32_t sizes[][2] = { { 1, 1 }, { 40, 1 }, { 1, 40 }, { 9, 2 } };
		for (size_t k = 0; k < G_N_ELEMENTS(sizes); k++) {
			struct filter_made small = filter_made_new(sizes[k][0], sizes[k][1], "");
			filter_made_run(&small, all_steps[n]);
			for (size_t at = 0; at < filter_pixels(&small.job.image); at++)
				g_assert_cmpuint(small.job.image.rgba[at][3], ==, 255);
			filter_made_clear(&small);
		}
	}
}

/* What is away from the focus is filtered, what is in it is as it was; between them it comes bit by bit, and a focus that moves by a
 * pixel changes no pixel by much: no pop. */
static void test_focus(void)
{
	struct filter_made m =
		filter_made_new(WIDTH, HEIGHT, "\"focus\":{\"filters\":1,\"on\":\"picture\"},");
	struct filter_image *i = &m.job.image;
	g_autofree uint8_t(*before)[4] = copy_of(i), (*last)[4] = NULL;
	i->away = m.memory[5];
	for (int moved = 0; moved < 30; moved++) {
		filter_made_fill(i, 5);
		for (size_t at = 0; at < filter_pixels(i); at++) {
			double away = (hypot((double)(at % WIDTH) - 60 - moved,
					       (double)(at / WIDTH) - 45) -
					      15) /
				      40;
			i->away[at] = (float)CLAMP(away, 0, 1);
		}
		filter_made_run(&m, "\"kuwahara\",\"radius_px\":4,\"passes\":3,\"where\":\"away\"");
		size_t same = 0, other = 0, near = 0;
		for (size_t at = 0; at < filter_pixels(i); at++) {
			bool is_same = memcmp(before[at], i->rgba[at], 4) == 0;
			near += i->away[at] <= 0;
			same += is_same && i->away[at] <= 0;
			other += !is_same && i->away[at] >= 1;
			if (!last)
				continue;
			for (int k = 0; k < 3; k++)
				g_assert_cmpint(abs(i->rgba[at][k] - last[at][k]), <=, 24);
		}
		g_assert_cmpuint(same, ==, near);
		g_assert_cmpuint(other, >, 1000);
		g_free(last);
		last = copy_of(i);
	}
	filter_made_clear(&m);
}

/* Of 255: the mean over channels, and the part of pixels that are off by more than 4. */
#define MEAN_MOST 0.05
#define OFF_MOST  0.002

static void assert_alike(const struct filter_image *i, const uint8_t (*cpu)[4], const char *step)
{
	double mean = 0, off = 0;
	int worst = 0;
	for (size_t at = 0; at < filter_pixels(i); at++) {
		int most = 0;
		for (int k = 0; k < 3; k++) {
			int here = abs(i->rgba[at][k] - cpu[at][k]);
			mean += here;
			most = MAX(most, here);
		}
		off += most > 4;
		worst = MAX(worst, most);
		g_assert_cmpuint(i->rgba[at][3], ==, 255);
	}
	mean /= 3.0 * (double)filter_pixels(i);
	off /= (double)filter_pixels(i);
	g_test_message("%s: mean %.4f, %.4f %% off by more than 4, at most %d", step, mean,
		100 * off, worst);
	g_assert_cmpfloat(mean, <=, MEAN_MOST);
	g_assert_cmpfloat(off, <=, OFF_MOST);
}

/* Both backends, with a focus and without one, in pictures of odd sizes. */
static void test_gles(void)
{
	static const uint32_t sizes[][2] = { { WIDTH, HEIGHT }, { 1, 1 }, { 40, 1 }, { 1, 40 } };
	g_autoptr(gles_draw) d = gles_here_draw();
	for (size_t n = 0; d && n < G_N_ELEMENTS(all_steps); n++)
		for (size_t k = 0; k < G_N_ELEMENTS(sizes); k++)
			for (int focus = 0; focus < 2; focus++) {
				struct filter_made m = filter_made_new(sizes[k][0], sizes[k][1],
					focus ? "\"focus\":{\"filters\":0.8,\"on\":\"picture\"},"
					      : "");
				struct filter_image *i = &m.job.image;
				g_autofree uint8_t(*before)[4] = copy_of(i);
				g_autofree float *depth_m =
					g_memdup2(i->depth_m, filter_pixels(i) * sizeof(float));
				if (focus)
					i->away = m.memory[5];
				for (size_t at = 0; focus && at < filter_pixels(i); at++)
					i->away[at] =
						(float)(at % sizes[k][0]) / (float)sizes[k][0];
				m.job.image.left = 3;
				m.job.image.top = 5;
				m.job.spacing_px = 2.5f;
				m.job.time_s = 1.3;
				filter_made_run(&m, all_steps[n]);
				g_autofree uint8_t(*cpu)[4] = copy_of(i);
				memcpy(i->rgba, before, filter_pixels(i) * 4);
				memcpy(i->depth_m, depth_m, filter_pixels(i) * sizeof(float));
				filter_made_gles = d;
				filter_made_run(&m, all_steps[n]);
				filter_made_gles = NULL;
				assert_alike(i, (const uint8_t(*)[4])cpu, all_steps[n]);
				filter_made_clear(&m);
			}
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/filters/bytes", test_bytes);
	g_test_add_func("/filters/focus", test_focus);
	g_test_add_func("/filters/gles", test_gles);
	int status = g_test_run();
	gles_context_free(gles_here_context);
	return status;
}
