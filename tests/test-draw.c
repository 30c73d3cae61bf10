/* Whole frames on the processor: the same bytes whatever draws them; paper, coloured points, pipelines of segments, shaded depth. */
#include "render/light.h"
#include "tests/scene-made.h"
#include <omp.h>

#define WIDTH  320u
#define HEIGHT 240u

/* All that there is. */
#define EVERYTHING                                                                                 \
	"\"site\":{\"steps\":[{\"step\":\"points\",\"saturation\":0.7,\"contrast\":0.9},"          \
	"{\"step\":\"sprites\",\"points\":\"dithering\",\"tone\":\"colour\",\"length_px\":6},"     \
	"{\"step\":\"lines\",\"points\":\"surface\",\"colour\":\"point\",\"spacing_px\":20},"      \
	"{\"step\":\"strokes\"},{\"step\":\"edl\"}]},"                                             \
	"\"Tree\":{\"steps\":[{\"step\":\"strokes\",\"id\":\"a\",\"points\":\"all\","              \
	"\"blend\":\"paint\",\"colour\":\"point\",\"texture\":\"brush\"},"                         \
	"{\"step\":\"sprites\",\"points\":\"all\",\"blend\":\"paint\",\"ink\":\"#802010\"}]}"

static const double eye[3] = { 103, 196, 6 }, target[3] = { 103, 204, 4 };

static frame *frame_with(const scene *s, const char *nodes, drawing **ret_drawing)
{
	struct camera c = camera_look_at(eye, target, 60, WIDTH, HEIGHT);
	*ret_drawing = made_drawing(nodes);
	return made_frame(s, *ret_drawing, &c);
}

static const uint8_t *at(const struct picture_buffer *p, uint32_t x, uint32_t y)
{
	return p->rgba[(size_t)y * p->width + x];
}

/* ---- the same bytes ---- */

static void test_twice(void)
{
	g_autoptr(drawing) d = NULL, e = NULL;
	g_autoptr(frame) f = frame_with(made_shared_court(), EVERYTHING, &d),
			 g = frame_with(made_shared_court(), EVERYTHING, &e);
	struct picture_buffer a = made_picture(f), b = made_picture(f), c = made_picture(g);
	made_assert_same(&a, &b);
	made_assert_same(&a, &c);
	picture_buffer_clear(&a);
	picture_buffer_clear(&b);
	picture_buffer_clear(&c);
}

/* A frame that was moved is one that was made there. */
static void test_moved(void)
{
	static const double other[3] = { 101, 197, 5 };
	struct camera there = camera_look_at(other, target, 50, WIDTH, HEIGHT);
	g_autoptr(drawing) d = NULL;
	g_autoptr(frame) f = frame_with(made_shared_court(), EVERYTHING, &d);
	g_autoptr(frame) g = made_frame(made_shared_court(), d, &there);
	g_assert_true(frame_move(f, &there, NULL));
	struct picture_buffer a = made_picture(f), b = made_picture(g);
	made_assert_same(&a, &b);
	picture_buffer_clear(&a);
	picture_buffer_clear(&b);
}

/* fov_deg: how much of the court the picture's edges cut off. */
static void assert_same_by_all_threads(const char *nodes, double fov_deg)
{
	static const int threads[] = { 1, 2, 5 };
	int before = omp_get_max_threads();
	struct camera c = camera_look_at(eye, target, fov_deg, WIDTH, HEIGHT);
	g_autoptr(drawing) d = made_drawing(nodes);
	g_autoptr(frame) f = made_frame(made_shared_court(), d, &c);
	struct picture_buffer a = made_picture(f);
	for (size_t n = 0; n < 3 * G_N_ELEMENTS(threads); n++) {
		omp_set_num_threads(threads[n % G_N_ELEMENTS(threads)]);
		struct picture_buffer b = made_picture(f);
		made_assert_same(&a, &b);
		picture_buffer_clear(&b);
	}
	omp_set_num_threads(before);
	f->single_thread = true;
	struct picture_buffer b = made_picture(f);
	made_assert_same(&a, &b);
	picture_buffer_clear(&a);
	picture_buffer_clear(&b);
}

static void test_threads(void)
{
	assert_same_by_all_threads(EVERYTHING, 60);
}

/* Strokes beyond the edges of the picture, where threads leave discs. */
static void test_threads_at_edges(void)
{
	for (double fov_deg = 8; fov_deg < 60; fov_deg *= 2)
		assert_same_by_all_threads(
			MADE_SITE("{\"step\":\"strokes\",\"points\":\"all\",\"length_px\":90,"
				  "\"width_px\":20,\"spacing_px\":6}"),
			fov_deg);
}

/* With whatever vectors. */
static void assert_same_by_all_lanes(const char *nodes)
{
	g_autoptr(drawing) d = NULL;
	g_autoptr(frame) f = frame_with(made_shared_court(), nodes, &d);
	struct picture_buffer a = made_picture(f);
	for (enum lanes_path path = 0; path < lanes_path_widest(); path++) {
		f->lanes = path;
		struct picture_buffer b = made_picture(f);
		made_assert_same(&a, &b);
		picture_buffer_clear(&b);
	}
	picture_buffer_clear(&a);
}

static void test_lanes(void)
{
	assert_same_by_all_lanes(EVERYTHING);
}

/* Strokes whose textures are few texels and many, in one colour and in those of points, multiplied and laid over. */
static void test_lanes_of_strokes(void)
{
	static const int sizes[][2] = { { 24, 6 }, { 9, 3 }, { 30, 14 }, { 70, 9 } };
	static const char *const inks[] = { "\"colour\":\"ink\"", "\"colour\":\"point\"",
		"\"colour\":\"point\",\"blend\":\"paint\"" };
	for (size_t n = 0; n < G_N_ELEMENTS(sizes); n++)
		for (size_t k = 0; k < G_N_ELEMENTS(inks); k++)
			for (int angle_deg = 0; angle_deg < 180; angle_deg += 50) {
				double px = FRAME_STYLE_HEIGHT / HEIGHT;
				g_autofree char *nodes = g_strdup_printf(
					MADE_SITE("{\"step\":\"strokes\",\"points\":\"all\","
						  "\"direction\":\"screen\",\"angle_deg\":%d,"
						  "\"texture\":\"charcoal\",\"length_px\":%d,"
						  "\"width_px\":%d,\"spacing_px\":%d,%s}"),
					angle_deg, (int)(sizes[n][0] * px), (int)(sizes[n][1] * px),
					(int)(4 * px), inks[k]);
				assert_same_by_all_lanes(nodes);
			}
}

/* ---- order ---- */

/* The same points in chunks that come in another order. */
static made shuffled(const made *m)
{
	uint64_t count;
	const struct model_chunk *from = model_chunks(m->model, &count);
	g_autofree struct model_chunk *chunk = g_memdup2(from, count * sizeof *from);
	g_autofree struct model_point *p = g_new(struct model_point, model_count(m->model));
	uint64_t first = 0;
	for (uint64_t n = count; n > 1; n--) {
		uint64_t k = (uint64_t)g_rand_int_range(m->chance, 0, (int)n);
		struct model_chunk other = chunk[k];
		chunk[k] = chunk[n - 1];
		chunk[n - 1] = other;
	}
	for (uint64_t n = 0; n < count; n++) {
		memcpy(p + first, model_points(m->model) + chunk[n].first,
			chunk[n].points * sizeof *p);
		chunk[n].first = first;
		first += chunk[n].points;
	}
	made other = made_of_tables(p, first, chunk, count);
	made_open(&other);
	return other;
}

/* Strokes vary by the number of their point, which is another one in another order: these here do not vary. */
static void test_order(void)
{
	static const char nodes[] = MADE_SITE(
		"{\"step\":\"points\"},"
		"{\"step\":\"lines\",\"points\":\"all\",\"length_variation\":0,\"scatter\":0,"
		"\"angle_variation_deg\":0,\"opacity_variation\":0},"
		"{\"step\":\"lines\",\"id\":\"b\",\"points\":\"surface\",\"length_variation\":0,"
		"\"scatter\":0,"
		"\"angle_variation_deg\":0,\"opacity_variation\":0,\"colour\":\"point\"},"
		"{\"step\":\"sprites\",\"points\":\"all\",\"length_variation\":0,\"scatter\":0,"
		"\"opacity_variation\":0,\"blend\":\"paint\",\"colour\":\"point\"}");
	g_auto(made) m = made_court();
	made_read(&m);
	g_auto(made) other = shuffled(&m);
	g_autoptr(drawing) d = NULL, e = NULL;
	g_autoptr(frame) f = frame_with(m.scene, nodes, &d), g = frame_with(other.scene, nodes, &e);
	struct picture_buffer a = made_picture(f), b = made_picture(g);
	int most = 0;
	for (size_t i = 0; i < (size_t)WIDTH * HEIGHT; i++)
		for (int k = 0; k < 3; k++)
			most = MAX(most, abs(a.rgba[i][k] - b.rgba[i][k]));
	g_assert_cmpint(most, <=, 1);
	picture_buffer_clear(&a);
	picture_buffer_clear(&b);
}

/* ---- pipelines ---- */

/* The yard in red points, the tree in blue ones: each pixel is of one alone, also at the borders between them. */
static void test_segments(void)
{
	g_auto(made) m = made_court();
	for (guint n = 0; n < m.points->len; n++) {
		struct made_point *p = &g_array_index(m.points, struct made_point, n);
		memcpy(p->rgba, p->leaf == MADE_LEAF ? "\xff\0\0\xff" : "\0\0\xff\xff", 4);
	}
	made_read(&m);
	g_autoptr(drawing) d = NULL;
	g_autoptr(frame) f = frame_with(m.scene,
		"\"site\":{\"steps\":[{\"step\":\"points\"}]},"
		"\"Tree\":{\"steps\":[{\"step\":\"points\",\"size\":4}]}",
		&d);
	struct picture_buffer a = made_picture(f);
	int red = 0, blue = 0, white = 0;
	for (size_t i = 0; i < (size_t)WIDTH * HEIGHT; i++) {
		const uint8_t *p = a.rgba[i];
		red += p[0] == 255 && p[1] == 0 && p[2] == 0;
		blue += p[0] == 0 && p[1] == 0 && p[2] == 255;
		white += p[0] == 255 && p[1] == 255 && p[2] == 255;
	}
	g_assert_cmpint(red, >, 10000);
	g_assert_cmpint(blue, >, 700);
	g_assert_cmpint(red + blue + white, ==, WIDTH * HEIGHT);
	picture_buffer_clear(&a);
}

/* A segment without layers hides others and is not drawn. */
static void test_hidden_segment(void)
{
	g_autoptr(drawing) d = NULL, e = NULL;
	g_autoptr(frame) f = frame_with(made_shared_court(),
		"\"site\":{\"steps\":[{\"step\":\"sprites\",\"points\":\"all\",\"ink\":\"#000000\","
		"\"length_px\":20}]},\"Yard\":{\"steps\":[]}",
		&d);
	g_autoptr(frame) g = frame_with(made_shared_court(),
		"\"site\":{\"steps\":[{\"step\":\"sprites\",\"points\":\"all\",\"ink\":\"#000000\","
		"\"length_px\":20}]},\"Tree\":{\"steps\":[]}",
		&e);
	struct picture_buffer a = made_picture(f), b = made_picture(g);
	double at_tree[3] = { 102, 203, 4.2 }, px[2] = { 0 }, depth_m = 1;
	g_assert_true(camera_project(&f->camera, at_tree, px, &depth_m));
	size_t dark[2] = { 0 }, dark_there[2] = { 0 };
	for (uint32_t y = 0; y < HEIGHT; y++)
		for (uint32_t x = 0; x < WIDTH; x++) {
			bool there =
				hypot(x - px[0], y - px[1]) < 0.4 * f->camera.focal_px / depth_m;
			dark[0] += at(&a, x, y)[1] < 200;
			dark[1] += at(&b, x, y)[1] < 200;
			dark_there[0] += there && at(&a, x, y)[1] < 200;
			dark_there[1] += there && at(&b, x, y)[1] < 200;
		}
	g_assert_cmpuint(dark_there[0], >, 200);
	g_assert_cmpuint(dark[0], <, 4000);
	g_assert_cmpuint(dark[1], >, 5000);
	g_assert_cmpuint(dark_there[1], ==, 0);
	picture_buffer_clear(&a);
	picture_buffer_clear(&b);
}

/* Steps that a segment has none of cost nothing, and change nothing. */
static void test_nothing(void)
{
#define LINES "{\"step\":\"lines\",\"points\":\"all\",\"ink\":\"#000000\"}"
	static const char *const none[] = {
		"{\"step\":\"strokes\",\"points\":\"all\",\"opacity\":0}",
		"{\"step\":\"contours\",\"opacity\":0}",
		"{\"step\":\"contours\",\"outlines\":0,\"steps\":0,\"suggestive\":0}",
	};
	g_autoptr(drawing) d = NULL;
	g_autoptr(frame) f =
		frame_with(made_shared_court(), "\"site\":{\"steps\":[" LINES "]}", &d);
	struct picture_buffer a = made_picture(f);
	g_assert_cmpuint(f->layers, ==, 1);
	for (size_t n = 0; n < G_N_ELEMENTS(none); n++) {
		g_autofree char *nodes =
			g_strdup_printf("\"site\":{\"steps\":[%s," LINES "]}", none[n]);
		g_autoptr(drawing) e = NULL;
		g_autoptr(frame) g = frame_with(made_shared_court(), nodes, &e);
		g_assert_cmpuint(g->layers, ==, 1);
		struct picture_buffer b = made_picture(g);
		g_assert_cmpmem(a.rgba, sizeof(*a.rgba) * WIDTH * HEIGHT, b.rgba,
			sizeof(*b.rgba) * WIDTH * HEIGHT);
		picture_buffer_clear(&b);
	}
	/* One of the three is enough. */
	g_autoptr(drawing) e = NULL;
	g_autoptr(frame) g = frame_with(made_shared_court(),
		"\"site\":{\"steps\":[{\"step\":\"contours\",\"outlines\":0,\"suggestive\":0}"
		"," LINES "]}",
		&e);
	g_assert_cmpuint(g->layers, ==, 2);
	picture_buffer_clear(&a);
#undef LINES
}

/* A wall is drawn; a metre before its left half stands another one that is not. Dark pixels over that one. */
static size_t dark_over(double reach_m)
{
	g_auto(made) m = made_new();
	struct made_plane far = { .corner_m = { 100, 205, 3 },
		.a_m = { 6, 0, 0 },
		.b_m = { 0, 0, 3 },
		.apart_m = 0.02,
		.order = MADE_JITTERED,
		.rgba = { 20, 20, 20, 255 } };
	struct made_plane near = far;
	near.corner_m[1] -= 1;
	near.a_m[0] = 3;
	near.leaf = MADE_LEAF + 1;
	made_add_plane(&m, &far);
	made_add_plane(&m, &near);
	made_read(&m);
	char number[G_ASCII_DTOSTR_BUF_SIZE];
	g_autofree char *nodes = g_strdup_printf(
		"\"site\":{\"steps\":[{\"step\":\"lines\",\"points\":\"all\",\"angle_deg\":0,"
		"\"ink\":\"#000000\",\"length_px\":150,\"width_px\":9,\"degree\":0,\"opacity\":1,"
		"\"reach_m\":%s}]},"
		"\"Tree\":{\"steps\":[]}",
		g_ascii_dtostr(number, sizeof number, reach_m));
	g_autoptr(drawing) d = made_drawing(nodes);
	static const double from[3] = { 103, 200, 4.5 }, to[3] = { 103, 205, 4.5 };
	struct camera c = camera_look_at(from, to, 60, WIDTH, HEIGHT);
	g_autoptr(frame) f = made_frame(m.scene, d, &c);
	struct picture_buffer p = made_picture(f);
	size_t dark = 0;
	for (uint32_t y = 0; y < HEIGHT; y++)
		for (uint32_t x = 0; x < WIDTH / 2 - 2; x++)
			dark += at(&p, x, y)[1] < 220;
	picture_buffer_clear(&p);
	g_test_message("%zu dark pixels over what is nearer, reach %g m", dark, reach_m);
	return dark;
}

/* Strokes lie over what is nearer by less than they reach, from points that are seen themselves. */
static void test_reach(void)
{
	/* Some pixels of its border are open. */
	g_assert_cmpuint(dark_over(0), <, 10);
	g_assert_cmpuint(dark_over(0.5), <, 10);
	g_assert_cmpuint(dark_over(1.5), >, 300);
	g_assert_cmpuint(dark_over(1.5), <, HEIGHT * 20);
}

/* ---- paper ---- */

static struct picture_buffer paper_alone(const char *paper, uint32_t width, uint32_t height)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *text = g_strdup_printf(
		"{\"schema\":1,\"paper\":{%s},\"segments\":{\"site\":{\"steps\":[{\"step\":"
		"\"strokes\"},{\"step\":\"points\"},{\"step\":\"edl\"}]}}}",
		paper);
	g_autoptr(style) s = style_parse(text, -1, "paper.json", &error);
	g_assert_no_error(error);
	g_autoptr(drawing) d = drawing_new(s, NULL, NULL, &error);
	g_assert_no_error(error);
	static const double sky[3] = { 103, 100, 60 };
	struct camera c = camera_look_at(eye, sky, 60, width, height);
	g_autoptr(frame) f = made_frame(made_shared_court(), d, &c);
	return made_picture(f);
}

static void test_paper(void)
{
	struct picture_buffer p = paper_alone("\"colour\":\"#f7e3c8\",\"grain\":0", WIDTH, HEIGHT);
	for (size_t i = 0; i < (size_t)WIDTH * HEIGHT; i++)
		g_assert_cmpmem(p.rgba[i], 4, "\xf7\xe3\xc8\xff", 4);
	picture_buffer_clear(&p);
}

/* It shades a colour that is not the lightest evenly up and down: the mean of the light stays. */
static void test_grain(void)
{
	struct picture_buffer p = paper_alone(
		"\"colour\":\"#a0a0a0\",\"texture\":\"rough\",\"grain\":0.8", 512, 1200);
	double sum = 0, squares = 0, flat = (double)light_of_srgb(160 / 255.f);
	size_t count = (size_t)512 * 512;
	for (size_t i = 0; i < count; i++) {
		double light = (double)light_of_srgb((float)p.rgba[i][1] / 255);
		sum += light;
		squares += light * light;
	}
	double mean = sum / (double)count, deviation = sqrt(squares / (double)count - mean * mean);
	g_test_message("mean %.4f of %.4f, deviation %.4f", mean, flat, deviation);
	g_assert_cmpfloat(fabs(mean / flat - 1), <, 0.01);
	g_assert_cmpfloat(deviation, >, 0.01 * flat);
	picture_buffer_clear(&p);
}

/* ---- reducing ---- */

static void test_reduced(void)
{
	g_autoptr(GRand) chance = g_rand_new_with_seed(3);
	for (uint32_t factor = 1; factor <= 4; factor++) {
		struct picture_buffer p = picture_buffer_new(24 * factor, 7 * factor);
		for (size_t i = 0; i < (size_t)p.width * p.height; i++)
			for (int k = 0; k < 4; k++)
				p.rgba[i][k] =
					k == 3 ? 255 : (uint8_t)g_rand_int_range(chance, 0, 256);
		struct picture_buffer r = picture_buffer_reduced(&p, factor);
		g_assert_cmpuint(r.width, ==, 24);
		g_assert_cmpuint(r.height, ==, 7);
		for (uint32_t y = 0; y < 7; y++)
			for (uint32_t x = 0; x < 24; x++)
				for (int k = 0; k < 4; k++) {
					double sum = 0;
					for (uint32_t n = 0; n < factor * factor; n++)
						sum += (double)light_of_srgb(
							(float)at(&p, x * factor + n % factor,
								y * factor + n / factor)[k] /
							255);
					double srgb =
						255 * (double)light_to_srgb(
							      (float)(sum / (factor * factor)));
					g_assert_cmpfloat(fabs(at(&r, x, y)[k] - srgb), <=, 1.01);
				}
		picture_buffer_clear(&p);
		picture_buffer_clear(&r);
	}
}

/* What is even stays what it is, of every byte. */
static void test_reduced_even(void)
{
	for (int byte = 0; byte < 256; byte++) {
		struct picture_buffer p = picture_buffer_new(4, 4);
		memset(p.rgba, byte, 64);
		struct picture_buffer r = picture_buffer_reduced(&p, 2);
		for (int n = 0; n < 4; n++)
			g_assert_cmpint(abs(r.rgba[n][0] - byte), <=, byte < 10 ? 1 : 0);
		picture_buffer_clear(&p);
		picture_buffer_clear(&r);
	}
}

/* ---- shaded depth ---- */

/* Two walls that face the camera, the left one nearer: the farther one is darker along the step, the nearer one is not. */
static void test_step_edge(void)
{
	g_auto(made) m = made_new();
	struct made_plane p = { .corner_m = { -4, 0, -3 },
		.a_m = { 4, 0, 0 },
		.b_m = { 0, 0, 6 },
		.apart_m = 0.02,
		.rgba = { 200, 200, 200, 255 } };
	made_add_plane(&m, &p);
	p.corner_m[0] = -0.5;
	p.corner_m[1] = 1.5;
	p.a_m[0] = 5;
	made_add_plane(&m, &p);
	made_read(&m);
	static const double before[3] = { 0, -4, 0 }, origin[3] = { 0, 0, 0 };
	struct camera c = camera_look_at(before, origin, 50, WIDTH, HEIGHT);
	g_autoptr(drawing) plain = made_drawing(MADE_SITE("{\"step\":\"points\"}")),
			   shaded = made_drawing(MADE_SITE(
				   "{\"step\":\"points\"},{\"step\":\"edl\",\"radius_px\":10}"));
	g_autoptr(frame) f = made_frame(m.scene, plain, &c), g = made_frame(m.scene, shaded, &c);
	struct picture_buffer a = made_picture(f), b = made_picture(g);
	for (uint32_t y = 60; y < 180; y++) {
		/* The nearer wall and what is far from the step on either side. */
		for (uint32_t x = 60; x < 158; x++)
			g_assert_cmpint(abs(at(&a, x, y)[0] - at(&b, x, y)[0]), <=, 1);
		for (uint32_t x = 164; x < 240; x++)
			g_assert_cmpint(abs(at(&a, x, y)[0] - at(&b, x, y)[0]), <=, 1);
		g_assert_cmpint(at(&b, 160, y)[0], <, at(&a, 160, y)[0] - 40);
	}
	picture_buffer_clear(&a);
	picture_buffer_clear(&b);
}

/* ---- odd sizes ---- */

static void test_sizes(void)
{
	static const uint32_t sizes[][2] = { { 1, 1 }, { 3, 2000 }, { 2000, 3 }, { 33, 31 },
		{ 7, 65 } };
	g_autoptr(drawing) d = made_drawing(EVERYTHING);
	for (size_t n = 0; n < G_N_ELEMENTS(sizes); n++) {
		struct camera c = camera_look_at(eye, target, 60, sizes[n][0], sizes[n][1]);
		g_autoptr(frame) f = made_frame(made_shared_court(), d, &c);
		struct picture_buffer p = made_picture(f);
		for (size_t i = 0; i < (size_t)p.width * p.height; i++)
			g_assert_cmpuint(p.rgba[i][3], ==, 255);
		picture_buffer_clear(&p);
	}
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/draw/twice", test_twice);
	g_test_add_func("/draw/moved", test_moved);
	g_test_add_func("/draw/threads", test_threads);
	g_test_add_func("/draw/threads-at-edges", test_threads_at_edges);
	g_test_add_func("/draw/lanes", test_lanes);
	g_test_add_func("/draw/lanes-of-strokes", test_lanes_of_strokes);
	g_test_add_func("/draw/order", test_order);
	g_test_add_func("/draw/segments", test_segments);
	g_test_add_func("/draw/hidden-segment", test_hidden_segment);
	g_test_add_func("/draw/nothing", test_nothing);
	g_test_add_func("/draw/reach", test_reach);
	g_test_add_func("/draw/paper", test_paper);
	g_test_add_func("/draw/grain", test_grain);
	g_test_add_func("/draw/reduced", test_reduced);
	g_test_add_func("/draw/reduced-even", test_reduced_even);
	g_test_add_func("/draw/step-edge", test_step_edge);
	g_test_add_func("/draw/sizes", test_sizes);
	return g_test_run();
}
