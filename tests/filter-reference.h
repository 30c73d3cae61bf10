#ifndef TESTS_FILTER_REFERENCE_H
#define TESTS_FILTER_REFERENCE_H
/* For tests that hold filters beside straightforward ones, which do what their papers say pixel by pixel, on both backends. */
#include "tests/filter-made.h"

#define WIDTH  157u
#define HEIGHT 93u

/* Tests run twice: on the processor, and on whatever OpenGL ES there is. False: there is none. */
static inline bool goes_on(const char *on)
{
	if (strcmp(on, "cpu") == 0) {
		g_clear_pointer(&filter_made_gles, gles_draw_free);
		return true;
	}
	if (!filter_made_gles)
		filter_made_gles = gles_here_draw();
	return filter_made_gles != NULL;
}

static inline void add(const char *name, GTestDataFunc test)
{
	static const char *const on[] = { "cpu", "gles" };
	for (int n = 0; n < 2; n++) {
		g_autofree char *path = g_strdup_printf("/filters/%s/%s", on[n], name);
		g_test_add_data_func(path, on[n], test);
	}
}

static inline const uint8_t *pixel_at(
	const struct filter_image *i, const uint8_t (*from)[4], int x, int y)
{
	x = CLAMP(x, 0, (int)i->width - 1);
	y = CLAMP(y, 0, (int)i->height - 1);
	return from[(size_t)y * i->width + (size_t)x];
}

/* Of the reference's picture: the share of pixels that are off by more than least, and the mean difference. */
static inline void assert_alike(const struct filter_image *i, const double (*wanted)[3],
	double least, double share_most, double mean_most, const char *what)
{
	double mean = 0;
	size_t off = 0;
	for (size_t at = 0; at < filter_pixels(i); at++) {
		double most = 0;
		for (int k = 0; k < 3; k++) {
			double here = fabs((double)i->rgba[at][k] - wanted[at][k]);
			mean += here / 3;
			most = MAX(most, here);
		}
		off += most > least;
	}
	mean /= (double)filter_pixels(i);
	double share = (double)off / (double)filter_pixels(i);
	g_test_message(
		"%s: mean %.3f, %.4f %% off by more than %g", what, mean, 100 * share, least);
	g_assert_cmpfloat(mean, <=, mean_most);
	g_assert_cmpfloat(share, <=, share_most);
}

static inline int run_all(void)
{
	int status = g_test_run();
	gles_draw_free(filter_made_gles);
	gles_context_free(gles_here_context);
	return status;
}

#endif
