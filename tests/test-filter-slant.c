/* Ground that is seen aslant, and whose points are discs of several pixels that do not quite lie in one plane: what filters that ask for
 * depths make of the steps between them, and of a step that is one. */
#include "tests/filter-reference.h"

#define DISC_PX 16
/* Of 1/depth, from a pixel to the next one below it. */
#define SLANT 0.008
/* Where something stands before the ground, a part nearer. */
#define POST_LEFT  90u
#define POST_RIGHT 120u
#define POST       0.5

/* Discs are so many times as far from the plane as it falls from a pixel to the next. */
static void make_ground(struct filter_made *m, double depth_m, double rough)
{
	struct filter_image *i = &m->job.image;
	g_autoptr(GRand) r = g_rand_new_with_seed(11);
	double above[16][16];
	for (int n = 0; n < 256; n++)
		above[n / 16][n % 16] = g_rand_double_range(r, -rough, rough);
	for (uint32_t y = 0; y < i->height; y++)
		for (uint32_t x = 0; x < i->width; x++) {
			size_t at = (size_t)y * i->width + x;
			double by = 1 + SLANT * ((double)y - i->height / 2.0 +
							above[y / DISC_PX][x / DISC_PX]);
			bool is_post = x >= POST_LEFT && x < POST_RIGHT;
			i->depth_m[at] = (float)(depth_m * (is_post ? POST : 1 / by));
			memset(i->rgba[at], 200, 3);
			i->normal[at][0] = i->normal[at][1] = 0;
			i->normal[at][2] = -1;
			i->leaf[at] = 1;
		}
}

/* Parts of the ground, far from the post, and of what is beside and on its border, that become darker by a tenth. */
struct darkened {
	double ground, border;
};
static struct darkened darkened_by(const char *step, double apart_px, double rough)
{
	struct filter_made m = filter_made_new(WIDTH, HEIGHT, "");
	const struct filter_image *i = &m.job.image;
	make_ground(&m, (double)frame_apart_px(m.frame, 1) / apart_px, rough);
	filter_made_run(&m, step);
	uint32_t ground = 0, dark = 0, border = 0;
	for (uint32_t y = 4; y < i->height - 4; y++) {
		for (uint32_t x = 4; x < POST_LEFT - 8; x++, ground++)
			dark += i->rgba[(size_t)y * i->width + x][0] < 180;
		uint8_t least = 255;
		for (uint32_t x = POST_LEFT - 3; x < POST_LEFT + 3; x++)
			least = MIN(least, i->rgba[(size_t)y * i->width + x][0]);
		border += least < 180;
	}
	struct darkened ret = { (double)dark / ground, (double)border / (i->height - 8) };
	g_test_message("%s, points %.1f px apart: %.3f of the ground, %.3f of the post's border",
		step, apart_px, ret.ground, ret.border);
	filter_made_clear(&m);
	return ret;
}

static void test_steps(gconstpointer on, const char *step, double rough)
{
	if (!goes_on(on))
		return;
	/* Discs of single points. */
	struct darkened d = darkened_by(step, DISC_PX, rough);
	g_assert_cmpfloat(d.ground, <, 0.01);
	g_assert_cmpfloat(d.border, ==, 1);
	/* The same picture from so far away that there are many points to a pixel: those are steps. */
	d = darkened_by(step, 0.1, rough);
	g_assert_cmpfloat(d.ground, >, 0.04);
	g_assert_cmpfloat(d.border, ==, 1);
}

static void test_edl(gconstpointer on)
{
	test_steps(on, "\"edl\"", 3);
}

static void test_edges(gconstpointer on)
{
	test_steps(on, "\"edges\",\"bend_deg\":0,\"opacity\":1,\"depth\":0.02", 4);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	add("slant/edl", test_edl);
	add("slant/edges", test_edges);
	return run_all();
}
