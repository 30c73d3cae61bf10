/* Filters beside straightforward ones, which do what their papers say pixel by pixel. */
#include "render/depth-inpaint.h"
#include "render/filter-planes.h"
#include "render/light.h"
#include "tests/filter-reference.h"
#include <stdlib.h>

/* ---- Gaussian, difference of Gaussians ---- */

static void blur(const struct filter_image *i, const double *from, double sigma, double *to)
{
	int radius = (int)ceil(3 * sigma);
	for (int y = 0; y < (int)i->height; y++)
		for (int x = 0; x < (int)i->width; x++) {
			double sum = 0, weights = 0;
			for (int dy = -radius; dy <= radius; dy++)
				for (int dx = -radius; dx <= radius; dx++) {
					int at_x = CLAMP(x + dx, 0, (int)i->width - 1),
					    at_y = CLAMP(y + dy, 0, (int)i->height - 1);
					double w = exp(-(dx * dx + dy * dy) / (2 * sigma * sigma));
					sum += w * from[at_y * (int)i->width + at_x];
					weights += w;
				}
			to[y * (int)i->width + x] = sum / weights;
		}
}

static void test_gaussian(gconstpointer on)
{
	if (!goes_on(on))
		return;
	struct filter_made m = filter_made_new(WIDTH, HEIGHT, "");
	struct filter_image *i = &m.job.image;
	g_autofree double(*wanted)[3] = g_malloc_n(filter_pixels(i), sizeof *wanted);
	g_autofree double *from = g_new(double, filter_pixels(i)),
			  *to = g_new(double, filter_pixels(i));
	for (int k = 0; k < 3; k++) {
		for (size_t at = 0; at < filter_pixels(i); at++)
			from[at] = i->rgba[at][k];
		blur(i, from, 2.5, to);
		for (size_t at = 0; at < filter_pixels(i); at++)
			wanted[at][k] = to[at];
	}
	filter_made_run(&m, "\"gaussian\",\"sigma_px\":2.5");
	assert_alike(i, (const double(*)[3])wanted, 0.51, 0, 0.3, "gaussian");
	filter_made_clear(&m);
}

/* D = G(sigma) - G(1.6 sigma), dark where it is below a threshold: section 3.2, with the soft border of Winnemoeller et al. 2006. */
static void check_dog(double sharpness, double threshold)
{
	struct filter_made m = filter_made_new(WIDTH, HEIGHT, "");
	struct filter_image *i = &m.job.image;
	size_t pixels = filter_pixels(i);
	g_autofree double(*wanted)[3] = g_malloc_n(pixels, sizeof *wanted);
	g_autofree double *light = g_new(double, pixels), *fine = g_new(double, pixels),
			  *coarse = g_new(double, pixels);
	for (size_t at = 0; at < pixels; at++) {
		i->depth_m[at] = 5; /* all is something solid */
		light[at] = (0.30078125 * i->rgba[at][0] + 0.5859375 * i->rgba[at][1] +
				    0.11328125 * i->rgba[at][2]) /
			    255;
	}
	blur(i, light, 1.2, fine);
	blur(i, light, 1.2 * 1.6, coarse);
	for (size_t at = 0; at < pixels; at++) {
		double d = sharpness > 0 ? (1 + sharpness) * fine[at] - sharpness * coarse[at]
					 : fine[at] - coarse[at];
		double line = d >= threshold ? 0 : -tanh(40 * (d - threshold));
		for (int k = 0; k < 3; k++)
			wanted[at][k] = i->rgba[at][k] + line * (16 - i->rgba[at][k]);
	}
	g_autofree char *step = g_strdup_printf("\"dog\",\"sigma_px\":1.2,\"contrast\":40,"
						"\"sharpness\":%g,\"threshold\":%g",
		sharpness, threshold);
	filter_made_run(&m, step);
	assert_alike(i, (const double(*)[3])wanted, 1, 0.001, 0.35, "difference of Gaussians");
	filter_made_clear(&m);
}

static void test_dog(gconstpointer on)
{
	if (!goes_on(on))
		return;
	check_dog(0, -0.01);
	check_dog(8, 0.5);
}

/* ---- bilateral: Winnemoeller et al. 2006, section 3.1, along rows and columns ---- */

static double lab_f(double t)
{
	return t > 216.0 / 24389 ? cbrt(t) : (24389.0 / 27 * t + 16) / 116;
}

static double lab_back(double f)
{
	return f * f * f > 216.0 / 24389 ? f * f * f : (116 * f - 16) * 27 / 24389;
}

static const double matrix[3][3] = { { 0.4124564, 0.3575761, 0.1804375 },
	{ 0.2126729, 0.7151522, 0.0721750 }, { 0.0193339, 0.1191920, 0.9503041 } };
static const double white[3] = { 0.95047, 1, 1.08883 };

static void to_lab(const uint8_t rgb[4], double ret[3])
{
	double f[3];
	for (int k = 0; k < 3; k++) {
		double sum = 0;
		for (int n = 0; n < 3; n++)
			sum += matrix[k][n] * (double)light_of_srgb((float)rgb[n] / 255);
		f[k] = lab_f(sum / white[k]);
	}
	ret[0] = 116 * f[1] - 16;
	ret[1] = 500 * (f[0] - f[1]);
	ret[2] = 200 * (f[1] - f[2]);
}

static void of_lab(const double lab[3], double ret[3])
{
	static const double back[3][3] = { { 3.2404542, -1.5371385, -0.4985314 },
		{ -0.9692660, 1.8760108, 0.0415560 }, { 0.0556434, -0.2040259, 1.0572252 } };
	double y = (lab[0] + 16) / 116;
	double xyz[3] = { white[0] * lab_back(y + lab[1] / 500), lab_back(y),
		white[2] * lab_back(y - lab[2] / 200) };
	for (int k = 0; k < 3; k++) {
		double sum = 0;
		for (int n = 0; n < 3; n++)
			sum += back[k][n] * xyz[n];
		ret[k] = 255 * (double)light_to_srgb((float)CLAMP(sum, 0, 1));
	}
}

static void bilateral_pass(const struct filter_image *i, const double (*from)[3], bool down,
	double sigma, double tone, double (*to)[3])
{
	int radius = (int)ceil(2 * sigma);
	for (int y = 0; y < (int)i->height; y++)
		for (int x = 0; x < (int)i->width; x++) {
			const double *here = from[y * (int)i->width + x];
			double sum[3] = { 0 }, weights = 0;
			for (int n = -radius; n <= radius; n++) {
				int at_x = CLAMP(down ? x : x + n, 0, (int)i->width - 1),
				    at_y = CLAMP(down ? y + n : y, 0, (int)i->height - 1);
				const double *there = from[at_y * (int)i->width + at_x];
				double away2 = 0;
				for (int k = 0; k < 3; k++)
					away2 += (there[k] - here[k]) * (there[k] - here[k]);
				double w = exp(
					-n * n / (2 * sigma * sigma) - away2 / (2 * tone * tone));
				for (int k = 0; k < 3; k++)
					sum[k] += w * there[k];
				weights += w;
			}
			for (int k = 0; k < 3; k++)
				to[y * (int)i->width + x][k] = sum[k] / weights;
		}
}

static void test_bilateral(gconstpointer on)
{
	if (!goes_on(on))
		return;
	struct filter_made m = filter_made_new(WIDTH, HEIGHT, "");
	struct filter_image *i = &m.job.image;
	size_t pixels = filter_pixels(i);
	g_autofree double(*one)[3] = g_malloc_n(pixels, sizeof *one),
		   (*other)[3] = g_malloc_n(pixels, sizeof *other);
	for (size_t at = 0; at < pixels; at++)
		to_lab(i->rgba[at], one[at]);
	for (int n = 0; n < 2; n++) {
		bilateral_pass(i, (const double(*)[3])one, false, 2.5, 6, other);
		bilateral_pass(i, (const double(*)[3])other, true, 2.5, 6, one);
	}
	for (size_t at = 0; at < pixels; at++)
		of_lab(one[at], other[at]);
	filter_made_run(&m, "\"bilateral\",\"sigma_px\":2.5,\"sigma_tone\":6,\"passes\":2");
	assert_alike(i, (const double(*)[3])other, 1.5, 0.001, 0.4, "bilateral");
	filter_made_clear(&m);
}

/* ---- structure tensor ---- */

/* In the memory of the room. */
static void flow_on_gles(struct gles_filter_job *j, const void *data)
{
	const struct filter_flow_plane *to = data;
	gles_flow_find(j, 4);
	gles_buffer_read(j->d->c, &j->d->filters.plane[2],
		(size_t)to->width * to->height * sizeof *to->at, to->at, &j->error);
}

static void test_tensor(gconstpointer on)
{
	if (!goes_on(on))
		return;
	struct filter_made m = filter_made_new(WIDTH, HEIGHT, "");
	const struct filter_image *i = &m.job.image;
	m.job.room = &m.room;
	struct filter_flow_plane flow = filter_flow_find(&m.job, 4);
	if (filter_made_gles) {
		g_autoptr(GError) error = NULL;
		memset(flow.at, 0, (size_t)flow.width * flow.height * sizeof *flow.at);
		gles_filter_picture(filter_made_gles, &m.job, flow_on_gles, &flow, &error);
		g_assert_no_error(error);
	}
	int width = ((int)WIDTH + 1) / 2, height = ((int)HEIGHT + 1) / 2;
	size_t half_pixels = (size_t)width * (size_t)height;
	g_assert_cmpuint(flow.width, ==, (guint)width);
	struct filter_image half = { .width = (uint32_t)width, .height = (uint32_t)height };
	double *v[3], *t[3], *smooth[3];
	for (int k = 0; k < 3; k++) {
		v[k] = g_new(double, half_pixels);
		t[k] = g_new0(double, half_pixels);
		smooth[k] = g_new(double, half_pixels);
	}
	for (int k = 0; k < 3; k++)
		for (int y = 0; y < height; y++)
			for (int x = 0; x < width; x++) {
				double sum = 0;
				for (int n = 0; n < 4; n++)
					sum += pixel_at(i, (const uint8_t(*)[4])i->rgba,
						2 * x + n % 2, 2 * y + n / 2)[k];
				v[k][y * width + x] = sum / 1020;
			}
	for (int y = 0; y < height; y++)
		for (int x = 0; x < width; x++)
			for (int k = 0; k < 3; k++) {
				static const int sobel[3] = { 1, 2, 1 };
				double gx = 0, gy = 0;
				for (int n = -1; n <= 1; n++) {
					int up = CLAMP(y - 1, 0, height - 1),
					    low = CLAMP(y + 1, 0, height - 1),
					    left = CLAMP(x - 1, 0, width - 1),
					    right = CLAMP(x + 1, 0, width - 1),
					    at_x = CLAMP(x + n, 0, width - 1),
					    at_y = CLAMP(y + n, 0, height - 1);
					gx += sobel[n + 1] *
					      (v[k][at_y * width + right] -
						      v[k][at_y * width + left]) /
					      4;
					gy += sobel[n + 1] *
					      (v[k][low * width + at_x] - v[k][up * width + at_x]) /
					      4;
				}
				t[0][y * width + x] += gx * gx;
				t[1][y * width + x] += gx * gy;
				t[2][y * width + x] += gy * gy;
			}
	for (int k = 0; k < 3; k++)
		blur(&half, t[k], 2, smooth[k]);
	double off_most = 0;
	for (size_t at = 0; at < half_pixels; at++) {
		double xx = smooth[0][at], xy = smooth[1][at], yy = smooth[2][at];
		double l1 = (xx + yy + sqrt((xx - yy) * (xx - yy) + 4 * xy * xy)) / 2,
		       l2 = xx + yy - l1;
		double anisotropy = l1 + l2 > 0 ? (l1 - l2) / (l1 + l2) : 0;
		g_assert_cmpfloat(fabs(anisotropy - (double)flow.at[at].anisotropy), <=, 2e-3);
		if (anisotropy < 0.05)
			continue;                                      /* nothing runs anywhere */
		double turn = 0.5 * atan2(2 * xy, xx - yy) + G_PI / 2; /* across the gradient */
		double across = flow.at[at].along[0] * sin(turn) - flow.at[at].along[1] * cos(turn);
		off_most = MAX(off_most, fabs(across));
	}
	g_test_message("directions are off by %.5f at most", off_most);
	g_assert_cmpfloat(off_most, <=, 0.01);
	for (int k = 0; k < 3; k++) {
		g_free(v[k]);
		g_free(t[k]);
		g_free(smooth[k]);
	}
	filter_made_clear(&m);
}

/* ---- steps of tone ---- */

static void test_quantise(gconstpointer on)
{
	if (!goes_on(on))
		return;
	struct filter_made m = filter_made_new(WIDTH, HEIGHT, "");
	struct filter_image *i = &m.job.image;
	g_autofree double(*wanted)[3] = g_malloc_n(filter_pixels(i), sizeof *wanted);
	for (size_t at = 0; at < filter_pixels(i); at++)
		for (int k = 0; k < 3; k++)
			wanted[at][k] = round(round(i->rgba[at][k] / 255.0 * 4) / 4 * 255);
	filter_made_run(
		&m, "\"quantise\",\"by\":\"channels\",\"levels\":5,\"softness\":0,\"smooth_px\":0");
	assert_alike(i, (const double(*)[3])wanted, 1, 0, 0.6, "posterised");
	/* Of lightness: as many steps as were asked for, when they are hard. */
	filter_made_fill(i, 8);
	filter_made_run(&m, "\"quantise\",\"levels\":6,\"softness\":0,\"smooth_px\":0");
	size_t near = 0, all = 0;
	for (size_t at = 0; at < filter_pixels(i); at++) {
		double lab[3], step = 20;
		to_lab(i->rgba[at], lab);
		bool inside = true; /* of what sRGB has */
		for (int k = 0; k < 3; k++)
			inside &= i->rgba[at][k] > 2 && i->rgba[at][k] < 253;
		all += inside;
		near += inside && fabs(lab[0] - round(lab[0] / step) * step) < 2.5;
	}
	g_assert_cmpfloat((double)near, >=, 0.8 * (double)all);
	filter_made_clear(&m);
}

/* ---- depth inpainting: Wegen et al. 2024, listing 1 ---- */

static float listing_1(const struct filter_image *i, const uint8_t *grey, int x, int y,
	float mask_threshold, int kernel_size)
{
	size_t at = (size_t)y * i->width + (size_t)x;
	int after = (77 * i->rgba[at][0] + 150 * i->rgba[at][1] + 29 * i->rgba[at][2] + 128) >> 8;
	if (abs(after - grey[at]) / 255.0f <= mask_threshold)
		return i->depth_m[at];
	double counter = 0, final = 0;
	for (int dy = -kernel_size; dy <= kernel_size; dy++)
		for (int dx = -kernel_size; dx <= kernel_size; dx++) {
			if (dx * dx + dy * dy > kernel_size * kernel_size || x + dx < 0 ||
				y + dy < 0 || x + dx >= (int)i->width || y + dy >= (int)i->height)
				continue;
			float neighbour =
				i->depth_m[(size_t)(y + dy) * i->width + (size_t)(x + dx)];
			if (neighbour >= FILTER_FAR)
				continue; /* the far plane */
			final += neighbour;
			counter++;
		}
	return counter > 0 ? (float)(final / counter) : i->depth_m[at];
}

/* What depth_inpaint() does, of the grey that is given. */
static void inpaint_on_gles(struct gles_filter_job *j, const void *data)
{
	const struct depth_inpainting *d = data;
	size_t pixels = filter_pixels(d->image);
	g_autofree float *grey = g_new(float, pixels);
	for (size_t at = 0; at < pixels; at++)
		grey[at] = d->image->grey_before[at];
	gles_buffer_put(j->d->c, j->image.grey, grey, (int64_t)(pixels * sizeof *grey), "a picture",
		&j->error);
	gles_inpaint(j, d->threshold, d->radius, 0);
	gles_buffer_read(
		j->d->c, &j->d->filters.plane[0], pixels * sizeof *d->to, d->to, &j->error);
}

static void test_inpaint(gconstpointer on)
{
	if (!goes_on(on))
		return;
	struct filter_made m = filter_made_new(WIDTH, HEIGHT, "");
	struct filter_image *i = &m.job.image;
	g_autofree uint8_t *grey = g_new(uint8_t, filter_pixels(i));
	g_autofree float *depth_m = g_new(float, filter_pixels(i));
	for (size_t at = 0; at < filter_pixels(i); at++)
		grey[at] = depth_inpaint_grey(i->rgba[at]);
	i->grey_before = grey;
	filter_made_run(&m, "\"gaussian\",\"sigma_px\":3");
	size_t changed = 0, given = 0;
	static const int radius[] = { 1, 4, 7 };
	for (int n = 0; n < 3; n++) {
		struct depth_inpainting d = { .image = i,
			.threshold = 0.02f + 0.03f * (float)n,
			.radius = radius[n],
			.to = depth_m };
		g_autoptr(GError) error = NULL;
		if (filter_made_gles)
			gles_filter_picture(filter_made_gles, &m.job, inpaint_on_gles, &d, &error);
		else
			depth_inpaint(&m.job, &d);
		g_assert_no_error(error);
		for (int y = 0; y < (int)HEIGHT; y++)
			for (int x = 0; x < (int)WIDTH; x++) {
				size_t at = (size_t)y * WIDTH + (size_t)x;
				float wanted = listing_1(i, grey, x, y, d.threshold, d.radius);
				g_assert_cmpfloat(fabsf(depth_m[at] - wanted), <=, 1e-5f * wanted);
				changed += depth_m[at] != i->depth_m[at];
				given += i->depth_m[at] >= FILTER_FAR && depth_m[at] < FILTER_FAR;
			}
	}
	g_assert_cmpuint(changed, >, 100);
	g_assert_cmpuint(given, >, 10);
	filter_made_clear(&m);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	add("gaussian", test_gaussian);
	add("dog", test_dog);
	add("bilateral", test_bilateral);
	add("tensor", test_tensor);
	add("quantise", test_quantise);
	add("inpaint", test_inpaint);
	return run_all();
}
