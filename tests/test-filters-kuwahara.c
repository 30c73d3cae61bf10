/* Kuwahara's filter and the anisotropic one beside straightforward ones. */
#include "render/filter-planes.h"
#include "tests/filter-reference.h"

/* ---- Kuwahara: Redmond & Dingliana 2007, section 3.1 ---- */

struct square {
	double mean[3], variance;
};

static struct square square_of(
	const struct filter_image *i, const uint8_t (*from)[4], int left, int top, int side)
{
	struct square s = { 0 };
	double squares = 0, count = side * side;
	for (int y = top; y < top + side; y++)
		for (int x = left; x < left + side; x++)
			for (int k = 0; k < 3; k++) {
				double v = pixel_at(i, from, x, y)[k];
				s.mean[k] += v / count;
				squares += v * v / count;
			}
	s.variance = squares;
	for (int k = 0; k < 3; k++)
		s.variance -= s.mean[k] * s.mean[k];
	return s;
}

/* The mean of the square of the least variance; of two that are as even, either one. */
static void check_kuwahara(int radius)
{
	struct filter_made m = filter_made_new(WIDTH, HEIGHT, "");
	struct filter_image *i = &m.job.image;
	g_autofree uint8_t(*before)[4] = copy_of(i);
	g_autofree char *step =
		g_strdup_printf("\"kuwahara\",\"radius_px\":%d,\"softness\":0", radius);
	filter_made_run(&m, step);
	for (int y = 0; y < (int)HEIGHT; y++)
		for (int x = 0; x < (int)WIDTH; x++) {
			struct square of[4];
			double least = 1e9;
			bool is_one = false;
			for (int n = 0; n < 4; n++) {
				of[n] = square_of(i, (const uint8_t(*)[4])before,
					n & 1 ? x : x - radius, n & 2 ? y : y - radius, radius + 1);
				least = MIN(least, of[n].variance);
			}
			const uint8_t *is = i->rgba[(size_t)y * WIDTH + (size_t)x];
			for (int n = 0; n < 4; n++) {
				bool same = of[n].variance <= least + 0.02;
				for (int k = 0; k < 3; k++)
					same &= fabs(is[k] - of[n].mean[k]) <= 0.51;
				is_one |= same;
			}
			g_assert_true(is_one);
			g_assert_cmpuint(is[3], ==, 255);
		}
	filter_made_clear(&m);
}

/* Soft: the mean of the four, weighted by the inverse fourth power of their variances. */
static void check_soft_kuwahara(int radius)
{
	struct filter_made m = filter_made_new(WIDTH, HEIGHT, "");
	struct filter_image *i = &m.job.image;
	g_autofree uint8_t(*before)[4] = copy_of(i);
	g_autofree double(*wanted)[3] = g_malloc0_n(filter_pixels(i), sizeof *wanted);
	for (int y = 0; y < (int)HEIGHT; y++)
		for (int x = 0; x < (int)WIDTH; x++) {
			double *to = wanted[(size_t)y * WIDTH + (size_t)x], weights = 0;
			for (int n = 0; n < 4; n++) {
				struct square s = square_of(i, (const uint8_t(*)[4])before,
					n & 1 ? x : x - radius, n & 2 ? y : y - radius, radius + 1);
				double w = pow(s.variance + KUWAHARA_EVEN, -4);
				weights += w;
				for (int k = 0; k < 3; k++)
					to[k] += w * s.mean[k];
			}
			for (int k = 0; k < 3; k++)
				to[k] /= weights;
		}
	g_autofree char *step = g_strdup_printf("\"kuwahara\",\"radius_px\":%d", radius);
	filter_made_run(&m, step);
	assert_alike(i, (const double(*)[3])wanted, 1.1, 0, 0.4, "soft Kuwahara");
	filter_made_clear(&m);
}

static void test_kuwahara(gconstpointer on)
{
	if (!goes_on(on))
		return;
	check_kuwahara(2); /* 3 x 3 */
	check_kuwahara(4); /* 5 x 5 */
	check_kuwahara(13);
	check_soft_kuwahara(2);
	check_soft_kuwahara(7);
}

/* ---- anisotropic Kuwahara: Kyprianidis et al. 2010, without tables ---- */

static void sector_weights(double x, double y, double radius, double ret[8])
{
	double zeta = 2 / radius, eta = (zeta + cos(0.58)) / (sin(0.58) * sin(0.58)), sum = 0;
	for (int half = 0; half < 2; half++) {
		double vxx = zeta - eta * x * x, vyy = zeta - eta * y * y;
		double z[4] = { MAX(0, y + vxx), MAX(0, -x + vyy), MAX(0, -y + vxx),
			MAX(0, x + vyy) };
		for (int k = 0; k < 4; k++)
			sum += ret[2 * k + half] = z[k] * z[k];
		double next = G_SQRT2 / 2 * (x - y);
		y = G_SQRT2 / 2 * (x + y);
		x = next;
	}
	for (int k = 0; k < 8; k++)
		ret[k] *= exp(-3.125 * (x * x + y * y)) / MAX(sum, 1e-9);
}

static void anisotropic_at(const struct filter_image *i, const uint8_t (*from)[4],
	const struct filter_flow *flow, int x, int y, double radius, double ret[3])
{
	double along = radius * (1 + flow->anisotropy), across = radius / (1 + flow->anisotropy);
	double mean[8][3] = { { 0 } }, squares[8] = { 0 }, weights[8] = { 0 };
	int reach = (int)ceil(2 * radius);
	for (int dy = -reach; dy <= reach; dy++)
		for (int dx = -reach; dx <= reach; dx++) {
			double u = (dx * flow->along[0] + dy * flow->along[1]) / along,
			       v = (dy * flow->along[0] - dx * flow->along[1]) / across, w[8];
			if (u * u + v * v > 1)
				continue;
			sector_weights(u, v, radius, w);
			const uint8_t *rgb = pixel_at(i, from, x + dx, y + dy);
			for (int k = 0; k < 8; k++) {
				weights[k] += w[k];
				for (int c = 0; c < 3; c++) {
					mean[k][c] += w[k] * rgb[c] / 255.0;
					squares[k] += w[k] * rgb[c] * rgb[c] / 255.0 / 255.0;
				}
			}
		}
	double sum = 0;
	ret[0] = ret[1] = ret[2] = 0;
	for (int k = 0; k < 8; k++) {
		double variance = squares[k] / weights[k];
		for (int c = 0; c < 3; c++) {
			mean[k][c] /= weights[k];
			variance -= mean[k][c] * mean[k][c];
		}
		double w = 1 / (1 + pow(1000 * fabs(variance), 4));
		for (int c = 0; c < 3; c++)
			ret[c] += w * mean[k][c];
		sum += w;
	}
	for (int c = 0; c < 3; c++)
		ret[c] *= 255 / sum;
}

static void test_anisotropic(gconstpointer on)
{
	if (!goes_on(on))
		return;
	struct filter_made m = filter_made_new(WIDTH, HEIGHT, "");
	struct filter_image *i = &m.job.image;
	g_autofree uint8_t(*before)[4] = copy_of(i);
	g_autofree double(*wanted)[3] = g_malloc_n(filter_pixels(i), sizeof *wanted);
	m.job.room = &m.room;
	struct filter_flow_plane flow = filter_flow_find(&m.job, 2);
	for (uint32_t y = 0; y < HEIGHT; y++)
		for (uint32_t x = 0; x < WIDTH; x++)
			anisotropic_at(i, (const uint8_t(*)[4])before, filter_flow_at(&flow, x, y),
				(int)x, (int)y, 5, wanted[y * WIDTH + x]);
	filter_made_run(&m, "\"anisotropic-kuwahara\",\"radius_px\":5");
	/* Directions and lengths of ellipses are rounded to steps. */
	assert_alike(i, (const double(*)[3])wanted, 8, 0.01, 0.8, "anisotropic Kuwahara");
	filter_made_clear(&m);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	add("kuwahara", test_kuwahara);
	add("anisotropic", test_anisotropic);
	return run_all();
}
