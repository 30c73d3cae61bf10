/* Plane surfaces in place of their points: nothing is less covered, as deep as the plane is, with clean edges, by both cameras and where they
 * cut; in scenes that are read in parts; the same on both backends, with any vectors and on any number of threads. */
#include "render/scene-pager.h"
#include "render/scene-planes.h"
#include "tests/gles-here.h"
#include "tests/pictures-differ.h"
#include "tests/planes-made.h"

#define WIDTH  400u
#define HEIGHT 300u
#define PLANES "{\"step\":\"mask\",\"planes\":true},"
#define POINTS "{\"step\":\"points\"}"

static made room;

static struct camera camera_of(double x_m, double y_m, double z_m)
{
	double eye[3] = { x_m, y_m, z_m }, target[3] = { 102, 203, 4.3 };
	return camera_look_at(eye, target, 60, WIDTH, HEIGHT);
}

/* Before the wall, aslant along it, from above, amid the ground. */
#define CAMERAS 4
static struct camera camera_at(int n)
{
	static const double eye[CAMERAS][3] = { { 102, 198.5, 4.6 }, { 99.6, 202, 4.2 },
		{ 104, 199, 9 }, { 102.5, 201, 3.5 } };
	return camera_of(eye[n][0], eye[n][1], eye[n][2]);
}

static visibility_mask *mask_of(const frame *f)
{
	uint32_t count;
	g_autofree struct chunk_view *views = chunk_views_new(f, &count);
	return visibility_mask_new(f, views, count);
}

/* ---- the mask ---- */

static bool is_covered(const visibility_mask *m, int x, int y)
{
	return x < 0 || y < 0 || x >= (int)m->width || y >= (int)m->height ||
	       mask_key(m, x, y) < MASK_EMPTY;
}

static bool is_amid(const visibility_mask *m, int x, int y, int around)
{
	for (int down = -around; down <= around; down++)
		for (int right = -around; right <= around; right++)
			if (!is_covered(m, x + right, y + down))
				return false;
	return true;
}

/* Discs reach beyond surfaces, by a pixel or two at their edges; inside of them nothing opens. */
static void test_coverage(void)
{
	g_autoptr(drawing) with = made_drawing(MADE_SITE(PLANES POINTS)),
			   without = made_drawing(MADE_SITE(POINTS));
	for (int n = 0; n < CAMERAS; n++) {
		struct camera c = camera_at(n);
		g_autoptr(frame) f = made_frame(room.scene, with, &c);
		g_autoptr(frame) g = made_frame(room.scene, without, &c);
		g_autoptr(visibility_mask) planes = mask_of(f), discs = mask_of(g);
		uint32_t lost = 0, inside = 0, covered = 0;
		g_assert_nonnull(planes->planes);
		g_assert_null(discs->planes);
		for (int y = 0; y < (int)HEIGHT; y++)
			for (int x = 0; x < (int)WIDTH; x++) {
				covered += is_covered(discs, x, y);
				if (!is_covered(discs, x, y) || is_covered(planes, x, y))
					continue;
				lost++;
				inside += is_amid(discs, x, y, 3);
			}
		g_test_message("camera %d: %u of %u pixels are bare, %u of them inside", n, lost,
			covered, inside);
		g_assert_cmpuint(inside, ==, 0);
		g_assert_cmpuint(lost, <, covered / 100);
	}
}

/* Where rays meet the wall and the ground, pushed back by what the mask is told and no farther than their noise. */
static void test_depth(void)
{
	g_autoptr(drawing) d = made_drawing(MADE_SITE("{\"step\":\"mask\",\"planes\":true,\"offset_"
						      "m\":0,\"offset_relative\":0}," POINTS));
	struct camera pinhole = camera_at(0), above = camera_at(2),
		      parallel = camera_parallel(&above, 5, 20);
	const struct camera *both[] = { &pinhole, &parallel };
	for (int n = 0; n < 2; n++) {
		g_autoptr(frame) f = made_frame(room.scene, d, both[n]);
		g_autoptr(visibility_mask) m = mask_of(f);
		static const double places[][3] = { { 100.4, 203, 5.5 }, { 103.4, 203, 3.3 },
			{ 102, 201.5, 3 }, { 103, 203, 4.4 } };
		for (size_t k = 0; k < G_N_ELEMENTS(places); k++) {
			double px[2] = { 0 }, depth_m = 0;
			g_assert_true(camera_project(both[n], places[k], px, &depth_m));
			double seen_m = (double)mask_depth(mask_key(m, (int)px[0], (int)px[1]));
			g_test_message("camera %d place %zu: %.4f m deep, seen %.4f m", n, k,
				depth_m, seen_m);
			g_assert_cmpfloat(seen_m, >, depth_m - 0.02);
			g_assert_cmpfloat(seen_m, <, depth_m + 0.07);
		}
	}
}

/* A window of a picture shows what the picture has there. */
static void test_window(void)
{
	enum { LEFT = 160, TOP = 96, SIDE = 128, AROUND = 8 };
	g_autoptr(drawing) d = made_drawing(MADE_SITE(PLANES POINTS));
	for (int n = 0; n < CAMERAS; n++) {
		struct camera c = camera_at(n), part = camera_window(&c, LEFT, TOP, SIDE, SIDE);
		g_autoptr(frame) f = made_frame(room.scene, d, &c);
		struct picture_buffer whole = made_picture(f);
		g_assert_true(frame_move(f, &part, NULL));
		struct picture_buffer window = made_picture(f);
		uint32_t off = 0;
		for (uint32_t y = AROUND; y < SIDE - AROUND; y++)
			for (uint32_t x = AROUND; x < SIDE - AROUND; x++)
				off += memcmp(window.rgba[y * SIDE + x],
					       whole.rgba[(y + TOP) * WIDTH + x + LEFT], 4) != 0;
		g_test_message("camera %d: %u pixels differ", n, off);
		g_assert_cmpuint(off, <, 30);
		picture_buffer_clear(&whole);
		picture_buffer_clear(&window);
	}
}

/* A section through the room has nothing before its cut, and the wall behind it. */
static void test_cut(void)
{
	g_autoptr(drawing) d = made_drawing(MADE_SITE(PLANES POINTS));
	double eye[3] = { 102, 201.5, 4.5 }, target[3] = { 102, 203, 4.5 };
	struct camera before = camera_look_at(eye, target, 60, WIDTH, HEIGHT);
	for (int behind = 0; behind < 2; behind++) {
		struct camera c = camera_parallel(&before, 4, behind ? 1 : 3);
		c.is_cut = true;
		g_autoptr(frame) f = made_frame(room.scene, d, &c);
		g_autoptr(visibility_mask) m = mask_of(f);
		/* Beside the window; the wall is 1.5 m away. */
		int32_t key = mask_key(m, WIDTH / 2 + 90, HEIGHT / 2);
		if (behind)
			g_assert_cmpint(key, >=, MASK_EMPTY);
		else
			g_assert_cmpfloat(fabs((double)mask_depth(key) - c.near_m - 1.5), <, 0.12);
	}
}

/* ---- pictures ---- */

static void assert_colour(const struct picture_buffer *p, const struct camera *c,
	const double at_m[3], const uint8_t rgba[4])
{
	double px[2] = { 0 }, depth_m = 0;
	g_assert_true(camera_project(c, at_m, px, &depth_m));
	const uint8_t *at = p->rgba[(size_t)px[1] * p->width + (size_t)px[0]];
	for (int k = 0; k < 3; k++)
		g_assert_cmpint(abs(at[k] - rgba[k]), <=, 2);
}

static void test_colours(void)
{
	g_autoptr(drawing) d = made_drawing(MADE_SITE(PLANES POINTS));
	static const double on_wall[3] = { 103, 203, 4.6 }, on_ground[3] = { 102, 201, 3 };
	for (int n = 0; n < 3; n++) {
		struct camera c = camera_at(n);
		g_autoptr(frame) f = made_frame(room.scene, d, &c);
		struct picture_buffer p = made_picture(f);
		assert_colour(&p, &c, on_wall, room_wall_rgba);
		if (n != 1)
			assert_colour(&p, &c, on_ground, room_ground_rgba);
		picture_buffer_clear(&p);
		made_assert_same_on_any(f);
	}
}

/* Along a row the wall begins and ends once beside the window: no dots, no teeth. */
static void test_edges(void)
{
	g_autoptr(drawing) d = made_drawing(MADE_SITE(PLANES POINTS));
	double eye[3] = { 102, 198, 4.5 }, target[3] = { 102, 203, 4.5 };
	struct camera c = camera_look_at(eye, target, 60, WIDTH, HEIGHT);
	g_autoptr(frame) f = made_frame(room.scene, d, &c);
	g_autoptr(visibility_mask) m = mask_of(f);
	int least = WIDTH, most = 0;
	for (double z_m = 5.3; z_m < 5.9; z_m += 0.02) {
		double at_m[3] = { 100, 203, z_m }, px[2] = { 0 }, depth_m = 0;
		g_assert_true(camera_project(&c, at_m, px, &depth_m));
		int left = 0;
		while (!is_covered(m, left, (int)px[1]))
			left++;
		least = MIN(least, left);
		most = MAX(most, left);
	}
	g_assert_cmpint(most - least, <=, 2);
}

/* Nothing of a style that does not ask for them is another with them. */
static void test_unasked(void)
{
	made bare = made_room();
	const scene *s = made_read(&bare);
	g_assert_null(s->planes);
	static const char *const nodes[] = { MADE_SITE(POINTS),
		MADE_SITE(POINTS
			",{\"step\":\"strokes\",\"points\":\"all\",\"spacing_px\":6,\"scatter\":1},"
			"{\"step\":\"paint\"}") };
	for (size_t n = 0; n < G_N_ELEMENTS(nodes); n++) {
		g_autoptr(drawing) d = made_drawing(nodes[n]);
		struct camera c = camera_at(0);
		g_autoptr(frame) f = made_frame(room.scene, d, &c);
		g_autoptr(frame) g = made_frame(s, d, &c);
		struct picture_buffer p = made_picture(f), q = made_picture(g);
		made_assert_same(&p, &q);
		picture_buffer_clear(&p);
		picture_buffer_clear(&q);
	}
	made_clear(&bare);
}

/* Few of the points are there: the planes are whole. */
static void test_paged(void)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(scene) s = scene_new_within(room.model, NULL, 1, &error);
	g_assert_no_error(error);
	g_assert_nonnull(s->pager);
	g_assert_nonnull(s->planes);
	g_autoptr(drawing) d = made_drawing(MADE_SITE(PLANES POINTS));
	struct camera c = camera_at(0);
	g_assert_true(scene_pager_settle_for(s, &c, 1, &error));
	g_autoptr(frame) f = made_frame(s, d, &c);
	g_autoptr(frame) whole = made_frame(room.scene, d, &c);
	struct picture_buffer p = made_picture(f), q = made_picture(whole);
	struct difference away = differ(&p, &q);
	g_test_message("mean %.3f, %.2f %% within", away.mean, 100 * away.within);
	g_assert_cmpfloat(away.mean, <, 1);
	picture_buffer_clear(&p);
	picture_buffer_clear(&q);
}

/* ---- both backends ---- */

static const struct look {
	const char *name, *nodes;
} looks[] = {
	{ "points", MADE_SITE(PLANES POINTS) },
	{ "adjusted", MADE_SITE(PLANES "{\"step\":\"points\",\"brightness\":1.2,\"contrast\":1.3},"
				       "{\"step\":\"edl\"}") },
	{ "strokes", MADE_SITE(PLANES POINTS ",{\"step\":\"strokes\",\"points\":\"all\","
					     "\"spacing_px\":12}") },
	{ "backs", MADE_SITE("{\"step\":\"mask\",\"planes\":true,\"backs\":\"hidden\"}," POINTS) },
	{ "filtered", MADE_SITE(PLANES POINTS ",{\"step\":\"gaussian\"}") },
	{ "edges", MADE_SITE(PLANES POINTS) ",\"picture\":{\"steps\":[{\"step\":\"edges\"}]}" },
	{ "mixed", MADE_SITE(POINTS) ",\"building\":{\"change\":{\"mask\":{\"planes\":true}}}" },
};

static void compare(gles_draw *g, const drawing *d, const struct camera *c, const char *name)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(frame) f = made_frame(room.scene, d, c);
	struct style_light light = { .amount = 0.7f, .azimuth_deg = 200, .elevation_deg = 30 };
	if (strcmp(name, "adjusted") == 0)
		frame_set_light(f, &light);
	struct picture_buffer cpu = made_picture(f), gles = picture_buffer_new(WIDTH, HEIGHT);
	g_assert_true(gles_draw_frame(g, f, &gles, NULL, &error));
	struct difference away = differ(&cpu, &gles);
	g_test_message("%s: mean %.3f, %.3f %% within", name, away.mean, 100 * away.within);
	if (away.mean > 0.5 || away.within < 0.999)
		save_all(&cpu, &gles, name);
	g_assert_cmpfloat(away.mean, <=, 0.5);
	g_assert_cmpfloat(away.within, >=, 0.999);
	picture_buffer_clear(&cpu);
	picture_buffer_clear(&gles);
}

static void test_parity(gconstpointer data)
{
	const struct look *look = data;
	g_autoptr(gles_draw) g = gles_here_draw();
	if (!g)
		return;
	g_autoptr(drawing) d = made_drawing(look->nodes);
	for (int n = 0; n < CAMERAS; n++) {
		struct camera c = camera_at(n);
		compare(g, d, &c, look->name);
	}
	struct camera c = camera_at(0), cut = camera_parallel(&c, 5, 20);
	cut.is_cut = true;
	compare(g, d, &cut, look->name);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	room = made_room();
	made_read_planes(&room);
	g_assert_nonnull(room.scene->planes);
	g_test_add_func("/plane-surfaces/coverage", test_coverage);
	g_test_add_func("/plane-surfaces/depth", test_depth);
	g_test_add_func("/plane-surfaces/window", test_window);
	g_test_add_func("/plane-surfaces/cut", test_cut);
	g_test_add_func("/plane-surfaces/colours", test_colours);
	g_test_add_func("/plane-surfaces/edges", test_edges);
	g_test_add_func("/plane-surfaces/unasked", test_unasked);
	g_test_add_func("/plane-surfaces/paged", test_paged);
	for (size_t n = 0; n < G_N_ELEMENTS(looks); n++) {
		g_autofree char *path = g_strdup_printf("/plane-surfaces/parity/%s", looks[n].name);
		g_test_add_data_func(path, &looks[n], test_parity);
	}
	int failed = g_test_run();
	made_clear(&room);
	return failed;
}
