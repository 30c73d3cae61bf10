/* Colour from photos: the camera model against OpenCV's formulas written out, NV12 against the
 * definition of BT.601, and how photos meet. */
#include "acquire/colour.h"
#include <math.h>
#include <string.h>

#define DEGREE (G_PI / 180)
#define WIDTH  64u
#define HEIGHT 96u

/* ---- the model, as OpenCV's documentation of calib3d has it ---- */

static void reference(
	const struct camera_calibration *c, const double head_m[3], double *u, double *v)
{
	double p[3];
	for (int i = 0; i < 3; i++) {
		p[i] = 0;
		for (int j = 0; j < 3; j++)
			p[i] += c->rotation[i][j] * (head_m[j] - c->translation_m[j]);
	}
	double k1 = c->distortion[0], k2 = c->distortion[1], p1 = c->distortion[2],
	       p2 = c->distortion[3], k3 = c->distortion[4];
	double x1 = p[0] / p[2], y1 = p[1] / p[2], r = sqrt(x1 * x1 + y1 * y1);
	double radial = 1 + k1 * pow(r, 2) + k2 * pow(r, 4) + k3 * pow(r, 6);
	double x2 = x1 * radial + 2 * p1 * x1 * y1 + p2 * (r * r + 2 * x1 * x1);
	double y2 = y1 * radial + p1 * (r * r + 2 * y1 * y1) + 2 * p2 * x1 * y1;
	*u = c->fx * x2 + c->cx;
	*v = c->fy * y2 + c->cy;
}

/* Looks along the head's front, x right and y down in the picture; 64 pixels are 60 degrees. */
static struct calibration made_calibration(void)
{
	struct calibration c = { .has_camera = true };
	c.stage.steps_per_turn = 11886;
	c.camera = (struct camera_calibration){ .width = WIDTH,
		.height = HEIGHT,
		.fx = 55,
		.fy = 55,
		.cx = 31.5,
		.cy = 47.5,
		.rotation = { { 1, 0, 0 }, { 0, 0, -1 }, { 0, 1, 0 } },
		.clock_hz = 1e6,
		.clock_bits = 32 };
	return c;
}

static void test_project(void)
{
	struct camera_calibration c = made_calibration().camera;
	double tilt = 7 * DEGREE;
	const double rotation[3][3] = { { 1, 0, 0 }, { 0, sin(tilt), -cos(tilt) },
		{ 0, cos(tilt), sin(tilt) } };
	const double distortion[5] = { -0.11, 0.03, 0.002, -0.003, -0.004 };
	memcpy(c.rotation, rotation, sizeof rotation);
	memcpy(c.distortion, distortion, sizeof distortion);
	c.translation_m[1] = 0.05;
	c.translation_m[2] = 0.07;
	c.fx = 52;
	g_autoptr(GRand) r = g_rand_new_with_seed(5);
	int seen = 0;
	for (int i = 0; i < 20000; i++) {
		double point[3], u, v, ru, rv;
		for (int k = 0; k < 3; k++)
			point[k] = g_rand_double_range(r, -5, 5);
		bool inside = colour_project(&c, point, &u, &v);
		double depth = cos(tilt) * (point[1] - 0.05) + sin(tilt) * (point[2] - 0.07);
		g_assert_false(inside && depth <= 0);
		double far2 = point[0] * point[0] + point[1] * point[1] + point[2] * point[2];
		/* What lies so far aside that the distortion folds is test_fold's. */
		if (depth <= 0.6 * sqrt(far2))
			continue;
		reference(&c, point, &ru, &rv);
		bool in_picture = ru >= 0 && rv >= 0 && ru <= WIDTH - 1 && rv <= HEIGHT - 1;
		g_assert_true(inside == in_picture);
		seen += inside;
		if (!inside)
			continue;
		g_assert_cmpfloat(fabs(u - ru), <, 1e-9);
		g_assert_cmpfloat(fabs(v - rv), <, 1e-9);
	}
	g_assert_cmpint(seen, >, 500);
}

/* Distortion can fold the far outside back into the picture: that is no view of it. */
static void test_fold(void)
{
	static const double distortions[][5] = { { -0.05, 0.01 }, { -0.3 },
		{ -0.3, 0.05, 0, 0, -0.01 } };
	for (size_t i = 0; i < G_N_ELEMENTS(distortions); i++) {
		struct camera_calibration c = made_calibration().camera;
		memcpy(c.distortion, distortions[i], sizeof c.distortion);
		bool left = false;
		for (double degrees = 0; degrees < 89.9; degrees += 0.1) {
			double u, v, point[3] = { sin(degrees * DEGREE), cos(degrees * DEGREE), 0 };
			bool seen = colour_project(&c, point, &u, &v);
			g_assert_true(seen || degrees > 29);
			g_assert_false(seen && (left || degrees > 45));
			left |= !seen;
		}
	}
}

/* ---- photos ---- */

struct rgb {
	double r, g, b;
};

static uint8_t rounded(double x)
{
	return (uint8_t)lrint(CLAMP(x, 0, 255));
}

/* An even frame of one colour: BT.601, limited range, from the definition (Kr 0.299, Kb 0.114). */
static uint8_t *frame_of(struct rgb c)
{
	double y = 0.299 * c.r + 0.587 * c.g + 0.114 * c.b;
	uint8_t *pixels = g_malloc(WIDTH * HEIGHT * 3 / 2);
	memset(pixels, rounded(16 + y * 219 / 255), WIDTH * HEIGHT);
	for (size_t i = 0; i < WIDTH * HEIGHT / 4; i++) {
		uint8_t *chroma = pixels + WIDTH * HEIGHT + 2 * i;
		chroma[0] = rounded(128 + (c.b - y) / (2 * (1 - 0.114)) * 224 / 255);
		chroma[1] = rounded(128 + (c.r - y) / (2 * (1 - 0.299)) * 224 / 255);
	}
	return pixels;
}

static struct photo photo_of(const uint8_t *pixels, double front_deg)
{
	return (struct photo){ { .fourcc = CAMERA_FOURCC_NV12, .width = WIDTH, .height = HEIGHT },
		pixels, front_deg * DEGREE };
}

static panorama *grid(float range_m)
{
	struct panorama_desc desc = panorama_desc_for(360, 90);
	panorama *p = panorama_new(&desc, NULL);
	for (size_t i = 0; i < 360 * 90; i++) {
		p->range_m[i] = range_m;
		p->cell[i] = range_m > 0 ? CELL_MEASURED : CELL_NO_RETURN;
	}
	return p;
}

static const uint8_t *rgb_at(const panorama *p, uint32_t column)
{
	return p->rgb + 3 * panorama_index(p, 49, column);
}

static const struct rgb colours[] = { { 255, 0, 0 }, { 0, 255, 0 }, { 0, 0, 255 },
	{ 255, 255, 255 }, { 0, 0, 0 }, { 128, 128, 128 }, { 255, 255, 0 }, { 0, 255, 255 },
	{ 255, 0, 255 }, { 200, 120, 40 } };

static void test_nv12(void)
{
	struct calibration c = made_calibration();
	for (size_t i = 0; i < G_N_ELEMENTS(colours); i++) {
		g_autofree uint8_t *pixels = frame_of(colours[i]);
		g_autoptr(panorama) p = grid(10);
		struct photo photo = photo_of(pixels, 100);
		colour_panorama(p, &photo, 1, &c);
		const uint8_t *got = rgb_at(p, 100);
		g_test_message("%g %g %g: %u %u %u", colours[i].r, colours[i].g, colours[i].b,
			got[0], got[1], got[2]);
		g_assert_cmpfloat(fabs(got[0] - colours[i].r), <=, 2);
		g_assert_cmpfloat(fabs(got[1] - colours[i].g), <=, 2);
		g_assert_cmpfloat(fabs(got[2] - colours[i].b), <=, 2);
	}
}

/* A ramp across the photo comes out where the model says: geometry and sampling to a fifth of a
 * pixel. Luma pixels have their centres at whole numbers. */
static void test_where(void)
{
	struct calibration c = made_calibration();
	c.stage.azimuth_zero_rad = 20 * DEGREE;
	g_autofree uint8_t *pixels = frame_of((struct rgb){ 0, 0, 0 });
	for (uint32_t y = 0; y < HEIGHT; y++)
		for (uint32_t x = 0; x < WIDTH; x++)
			pixels[y * WIDTH + x] = (uint8_t)(30 + 3 * x);
	g_autoptr(panorama) p = grid(10);
	struct photo photo = photo_of(pixels, 100);
	colour_panorama(p, &photo, 1, &c);
	int seen = 0;
	for (uint32_t column = 0; column < 360; column++) {
		double off =
			remainder(panorama_azimuth_rad(p, 49, column) - 120 * DEGREE, 2 * G_PI);
		double u = c.camera.fx * tan(off) + c.camera.cx;
		const uint8_t *got = rgb_at(p, column);
		bool inside = cos(off) > 0 && u >= 0 && u <= WIDTH - 1;
		double grey = (30 + 3 * u - 16) * 255 / 219;
		/* Cells that the photo does not show stay black. */
		g_assert_cmpfloat(fabs(got[1] - (inside ? fmin(grey, 255) : 0)), <, 1.2);
		seen += inside;
	}
	g_assert_cmpint(seen, ==, 60);
}

/* A chroma sample lies in the middle of its four pixels, not at the first of them. */
static void test_where_chroma(void)
{
	struct calibration c = made_calibration();
	g_autofree uint8_t *pixels = frame_of((struct rgb){ 128, 128, 128 });
	for (uint32_t y = 0; y < HEIGHT / 2; y++)
		for (uint32_t x = 0; x < WIDTH / 2; x++)
			pixels[WIDTH * HEIGHT + y * WIDTH + 2 * x + 1] = (uint8_t)(66 + 4 * x);
	g_autoptr(panorama) p = grid(10);
	struct photo photo = photo_of(pixels, 100.5);
	colour_panorama(p, &photo, 1, &c);
	for (uint32_t column = 75; column < 126; column++) {
		double u = c.camera.fx * tan((column - 100.0) * DEGREE) + c.camera.cx;
		double cr = 66 + 4 * (u - 0.5) / 2 - 128;
		double red = 128 + cr * 255 / 224 * 2 * (1 - 0.299);
		g_assert_cmpfloat(fabs(rgb_at(p, column)[0] - CLAMP(red, 0, 255)), <, 1.1);
	}
}

/* Between two photos the weights sum to one: red and green of the same strength keep their sum, and
 * each has its own middle to itself. */
static void test_blend(void)
{
	struct calibration c = made_calibration();
	g_autofree uint8_t *red = frame_of((struct rgb){ 200, 0, 0 }),
			   *green = frame_of((struct rgb){ 0, 200, 0 });
	struct photo photos[9];
	for (int i = 0; i < 9; i++)
		photos[i] = photo_of(i % 2 ? green : red, 20 + 40 * i);
	g_autoptr(panorama) p = grid(10);
	colour_panorama(p, photos, 9, &c);
	for (uint32_t column = 20; column <= 300; column++) {
		const uint8_t *got = rgb_at(p, column), *before = rgb_at(p, column - 1);
		g_assert_cmpint(ABS(got[0] + got[1] - 200), <=, 6);
		g_assert_cmpint(got[2], <=, 3);
		/* No step at the seams. */
		g_assert_cmpint(ABS(got[0] - before[0]), <, 40);
		if (fabs(remainder(column + 0.5 - 20, 40)) < 13)
			g_assert_cmpint(MIN(got[0], got[1]), <=, 3);
	}
	g_assert_cmpint(rgb_at(p, 20)[0], >=, 198);
	g_assert_cmpint(rgb_at(p, 60)[1], >=, 198);
}

/* A scan that was resumed or that went back for photos has several of the same angle. That must not
 * make the seams any harder. */
static void test_repeated_photos(void)
{
	struct calibration c = made_calibration();
	g_autofree uint8_t *red = frame_of((struct rgb){ 200, 0, 0 }),
			   *green = frame_of((struct rgb){ 0, 200, 0 });
	struct photo photos[32];
	for (int i = 0; i < 32; i++)
		photos[i] = photo_of(i % 2 ? green : red, 20 + 40 * (i % 8) + 0.1 * (i / 8));
	g_autoptr(panorama) p = grid(10);
	colour_panorama(p, photos, 32, &c);
	for (uint32_t column = 20; column <= 300; column++) {
		const uint8_t *got = rgb_at(p, column), *before = rgb_at(p, column - 1);
		g_assert_cmpint(ABS(got[0] - before[0]), <, 40);
	}
}

/* The camera stands 7 cm above the lidar: a near cell is seen further down in the picture than the
 * sky in the same direction. */
static void test_sky(void)
{
	struct calibration c = made_calibration();
	c.camera.translation_m[2] = 0.07;
	g_autofree uint8_t *pixels = frame_of((struct rgb){ 0, 0, 0 });
	for (uint32_t y = 0; y < HEIGHT; y++)
		memset(pixels + y * WIDTH, (int)(30 + 2 * y), WIDTH);
	static const struct {
		float range_m;
		double down_px;
	} rows[] = { { 0, 0 }, { 1, 55 * 0.07 }, { 2, 55 * 0.035 } };
	for (size_t i = 0; i < G_N_ELEMENTS(rows); i++) {
		g_autoptr(panorama) p = grid(rows[i].range_m);
		struct photo photo = photo_of(pixels, 100.5);
		colour_panorama(p, &photo, 1, &c);
		double v = 47.5 + rows[i].down_px;
		g_assert_cmpfloat(fabs(rgb_at(p, 100)[1] - (30 + 2 * v - 16) * 255 / 219), <, 1.5);
	}
}

/* For the preview: what one photo shows, and nothing else, is the same as if it were the only one. */
static void test_one_photo(void)
{
	static const double turned[][3] = { { 0, 0, 0 }, { 30, 0, 15 }, { -75, 0, 0 },
		{ 0, 40, -100 } };
	static const float ranges_m[] = { 0, 0.1f, 0.4f, 0.6f, 20 };
	g_autofree uint8_t *pixels = frame_of((struct rgb){ 200, 120, 40 });
	int pictures = 0;
	for (size_t i = 0; i < G_N_ELEMENTS(turned) * G_N_ELEMENTS(ranges_m); i++) {
		struct calibration c = made_calibration();
		double straight[3][3], by[3][3];
		memcpy(straight, c.camera.rotation, sizeof straight);
		calibration_rotation(turned[i / G_N_ELEMENTS(ranges_m)], by);
		for (int k = 0; k < 9; k++)
			c.camera.rotation[k / 3][k % 3] = straight[k / 3][0] * by[0][k % 3] +
							  straight[k / 3][1] * by[1][k % 3] +
							  straight[k / 3][2] * by[2][k % 3];
		c.camera.translation_m[0] = 0.05;
		c.camera.translation_m[2] = 0.12;
		c.stage.azimuth_zero_rad = 20 * DEGREE;
		g_autoptr(panorama) p = grid(ranges_m[i % G_N_ELEMENTS(ranges_m)]);
		g_autoptr(panorama) wanted = grid(ranges_m[i % G_N_ELEMENTS(ranges_m)]);
		struct photo photo = photo_of(pixels, 350);
		colour_panorama(wanted, &photo, 1, &c);
		colour_one_photo(p, &photo, &c);
		g_assert_cmpmem(p->rgb, 3 * 360 * 90, wanted->rgb, 3 * 360 * 90);
		/* What is there and is not shown stays. */
		photo.front_rad += G_PI;
		colour_one_photo(p, &photo, &c);
		size_t shown = 0;
		for (size_t k = 0; k < 360 * 90; k++) {
			shown += wanted->rgb[3 * k] > 0;
			g_assert_cmpuint(p->rgb[3 * k], >=, wanted->rgb[3 * k]);
		}
		pictures += shown > 100;
	}
	g_assert_cmpint(pictures, >=, 12);
}

static void test_no_photos(void)
{
	struct calibration c = made_calibration();
	g_autoptr(panorama) p = grid(10);
	colour_panorama(p, NULL, 0, &c);
	g_assert_null(p->rgb);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/colour/project", test_project);
	g_test_add_func("/colour/fold", test_fold);
	g_test_add_func("/colour/nv12", test_nv12);
	g_test_add_func("/colour/where", test_where);
	g_test_add_func("/colour/where-chroma", test_where_chroma);
	g_test_add_func("/colour/blend", test_blend);
	g_test_add_func("/colour/repeated-photos", test_repeated_photos);
	g_test_add_func("/colour/sky", test_sky);
	g_test_add_func("/colour/one-photo", test_one_photo);
	g_test_add_func("/colour/no-photos", test_no_photos);
	return g_test_run();
}
