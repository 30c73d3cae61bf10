/* Scenes that are larger than the memory they may take. */
#include "render/scene-pager.h"
#include "render/scene-units.h"
#include "tests/gles-here.h"
#include "tests/pictures-differ.h"
#include "tests/scene-made.h"
#include <gio/gio.h>
#include <glib/gstdio.h>
#include <stdio.h>
#include <unistd.h>

/* Of the smallest pager: less than a third of the yard's points. And one with room for what a narrow view has. */
enum { LEAST = 1, SOME = 40 << 20 };

/* Ground of 20 x 20 m with walls around, 1.7 million points; and leaves, whose chunks stand at the end of the file. */
static made made_yard(void)
{
	made m = made_new();
	struct made_plane p = { .corner_m = { 100, 200, 3 },
		.a_m = { 20, 0, 0 },
		.b_m = { 0, 20, 0 },
		.apart_m = 0.02,
		.order = MADE_JITTERED,
		.rgba = { 90, 80, 70, 255 },
		.dithered = true };
	static const double ends[5][2] = { { 100, 200 }, { 100, 220 }, { 120, 220 }, { 120, 200 },
		{ 100, 200 } };
	made_add_plane(&m, &p);
	for (int n = 0; n < 4; n++) {
		struct made_plane wall = p;
		double from[3] = { ends[n][0], ends[n][1], 6 },
		       to[3] = { ends[n + 1][0], ends[n + 1][1], 6 };
		float normal[3] = { (float)(to[1] - from[1]) / 20, (float)(from[0] - to[0]) / 20,
			0 };
		memcpy(wall.corner_m, from, sizeof from);
		wall.corner_m[2] = 3;
		for (int k = 0; k < 3; k++) {
			wall.a_m[k] = to[k] - from[k];
			wall.b_m[k] = k < 2 ? 0 : 3;
		}
		wall.rgba[0] = (uint8_t)(120 + 30 * n);
		wall.rgba[3] = n == 2 ? 0 : 255;
		made_add_plane(&m, &wall);
		made_add_edge(&m, from, to, normal, 0.02);
	}
	for (int n = 0; n < 3; n++)
		made_add_ball(
			&m, (const double[3]){ 104 + 6 * n, 210, 4.5 }, 0.8, 20000, MADE_LEAF + 1);
	return m;
}

/* All tests look at the same one; each has its own pager. */
static made shared;

static scene *open_paged(const model *m, uint64_t memory_bytes)
{
	g_autoptr(GError) error = NULL;
	scene *s = scene_paged(m, NULL, memory_bytes, &error);
	g_assert_no_error(error);
	return s;
}

static struct camera camera_at(double x, double y, double heading_deg)
{
	const double eye[3] = { x, y, 4.6 };
	return camera_towards(eye, heading_deg * G_PI / 180, -0.6, 40, 480, 360);
}

static struct camera camera_above(void)
{
	const double eye[3] = { 110, 185, 30 }, target[3] = { 110, 210, 3 };
	return camera_look_at(eye, target, 60, 240, 180);
}

static drawing *strokes(void)
{
	return made_drawing(
		MADE_SITE("{\"step\":\"points\"},"
			  "{\"step\":\"strokes\",\"points\":\"features\"},"
			  "{\"step\":\"lines\",\"points\":\"dithering\",\"scatter\":1}"));
}

static drawing *paint(void)
{
	return made_drawing(MADE_SITE("{\"step\":\"paint\"}"));
}

static void settle(scene *s, const struct camera *c)
{
	g_autoptr(GError) error = NULL;
	struct scene_look look = { .camera = c, .ink_px = 0.3f };
	g_assert_true(scene_pager_settle(s->pager, &look, &error));
	g_assert_no_error(error);
}

static struct picture_buffer draw_of(const scene *s, const drawing *d, const struct camera *c)
{
	frame *f = made_frame(s, d, c);
	struct picture_buffer p = made_picture(f);
	frame_free(f);
	return p;
}

/* A little memory, some of the points; once they are there the picture is the one of all of them. */
static void check_same(drawing *d)
{
	g_autoptr(scene) paged = open_paged(shared.model, SOME);
	uint32_t most = scene_pager_sums(paged->pager).units_most;
	g_assert_cmpuint((uint64_t)most * SCENE_UNIT_POINTS, <, shared.scene->count / 4 * 3);
	for (int n = 0; n < 8; n++) {
		struct camera c = camera_at(103 + n, 206 + n % 5, 30 * n);
		settle(paged, &c);
		struct scene_look look = { .camera = &c, .ink_px = 0.3f };
		struct scene_turned turned;
		scene_pager_turn(paged->pager, &look, &turned);
		g_assert_true(turned.is_whole);
		struct picture_buffer whole = draw_of(shared.scene, d, &c),
				      some = draw_of(paged, d, &c);
		made_assert_same(&whole, &some);
		picture_buffer_clear(&whole);
		picture_buffer_clear(&some);
		g_assert_cmpuint(scene_pager_sums(paged->pager).units, <=, most);
	}
}

static void test_same(void)
{
	g_autoptr(drawing) strokes_of = strokes(), paint_of = paint();
	check_same(strokes_of);
	check_same(paint_of);
}

/* By how much tiles are of other light, of 255. */
static double darkness_apart(const struct picture_buffer *a, const struct picture_buffer *b)
{
	double sum[2] = { 0 }, differ = 0;
	enum { TILE = 20 };
	for (uint32_t y = 0; y < a->height; y += TILE)
		for (uint32_t x = 0; x < a->width; x += TILE) {
			sum[0] = sum[1] = 0;
			for (uint32_t i = 0; i < TILE * TILE; i++) {
				uint32_t at = (y + i / TILE) * a->width + x + i % TILE;
				sum[0] += a->rgba[at][1];
				sum[1] += b->rgba[at][1];
			}
			differ += fabs(sum[0] - sum[1]) / (TILE * TILE);
		}
	return differ / (a->height / TILE * (a->width / TILE));
}

/* Before anything came it is drawn with the tops: as dark, as dense, without holes. */
static void test_coarse(void)
{
	g_autoptr(scene) paged = open_paged(shared.model, LEAST);
	g_autoptr(drawing) d = made_drawing(MADE_SITE("{\"step\":\"points\"}"));
	struct camera c = camera_above();
	struct scene_look look = { .camera = &c, .ink_px = 0.3f, .is_moving = true };
	struct scene_turned turned;
	scene_pager_turn(paged->pager, &look, &turned);
	g_assert_cmpuint(turned.missing, >, 0);
	struct picture_buffer whole = draw_of(shared.scene, d, &c), coarse = draw_of(paged, d, &c);
	double coarse_away = darkness_apart(&whole, &coarse);
	g_test_message("%.2f of 255 away", coarse_away);
	g_assert_cmpfloat(coarse_away, <, 12);
	picture_buffer_clear(&whole);
	picture_buffer_clear(&coarse);
}

/* Nothing of a frame changes until the next turn, whatever comes; and what is wanted comes, while the camera moves. */
static void test_moving(void)
{
	g_autoptr(scene) paged = open_paged(shared.model, LEAST);
	g_autoptr(drawing) d = strokes();
	struct scene_turned turned = { 0 };
	uint32_t most = scene_pager_sums(paged->pager).units_most;
	for (int n = 0; n < 30; n++) {
		struct camera c = camera_at(104 + 0.4 * n, 204 + 0.2 * n, 6 * n);
		struct scene_look look = { .camera = &c, .ink_px = 0.3f, .is_moving = true };
		scene_pager_turn(paged->pager, &look, &turned);
		struct picture_buffer one = draw_of(paged, d, &c);
		if (n % 10 == 0) {
			struct picture_buffer again = draw_of(paged, d, &c);
			made_assert_same(&one, &again);
			picture_buffer_clear(&again);
		}
		picture_buffer_clear(&one);
		g_assert_cmpuint(scene_pager_sums(paged->pager).units, <=, most);
	}
	g_assert_cmpuint(scene_pager_sums(paged->pager).nodes_read, >, 10);
}

/* From a quiet turn on nothing is read until that is let, and then soon enough for the next frame. */
static void test_quiet(void)
{
	g_autoptr(scene) paged = open_paged(shared.model, SOME);
	scene_pager *p = paged->pager;
	struct camera c = camera_above();
	struct scene_look look = {
		.camera = &c, .ink_px = 0.3f, .is_moving = true, .is_quiet = true
	};
	struct scene_turned turned;
	uint64_t before;
	int turns = 0;
	do {
		/* What was being read may still come: of each thread one node. */
		before = scene_pager_sums(p).nodes_read;
		scene_pager_turn(p, &look, &turned);
		g_usleep(20000);
		uint64_t read = scene_pager_sums(p).nodes_read;
		g_assert_cmpuint(read - before, <=, turns ? g_get_num_processors() : 0);
		gint64 began_us = g_get_monotonic_time();
		scene_pager_let_read(p);
		g_test_message("%" G_GUINT64_FORMAT " nodes, %u missing, %.1f ms",
			scene_pager_sums(p).nodes_read - read, turned.missing,
			1e-3 * (double)(g_get_monotonic_time() - began_us));
		if (turned.missing)
			g_assert_cmpuint(scene_pager_sums(p).nodes_read, >, before);
	} while (turned.missing && ++turns < 1000);
	g_assert_cmpuint(turned.missing, ==, 0);
	/* It was no quiet turn: there is nothing to let. */
	look.is_quiet = false;
	scene_pager_turn(p, &look, &turned);
	scene_pager_let_read(p);
	g_assert_cmpuint(turned.missing, ==, 0);
}

/* The same view is the same picture, whatever was looked at before, when not all of it fits. */
static void test_overview(void)
{
	struct picture_buffer first = { 0 };
	struct camera c = camera_above();
	g_autoptr(drawing) d = strokes();
	for (int n = 0; n < 2; n++) {
		g_autoptr(scene) paged = open_paged(shared.model, LEAST);
		if (n) {
			struct camera other = camera_at(110, 210, 90);
			settle(paged, &other);
		}
		settle(paged, &c);
		struct picture_buffer p = draw_of(paged, d, &c);
		if (n) {
			made_assert_same(&first, &p);
			struct picture_buffer whole = draw_of(shared.scene, d, &c);
			g_assert_cmpfloat(darkness_apart(&whole, &p), <, 4);
			picture_buffer_clear(&whole);
			picture_buffer_clear(&p);
		} else
			first = p;
	}
	picture_buffer_clear(&first);
}

/* Many small things leave room in pieces that are of no use to large ones; looking around comes to an end all the same. */
static void test_pieces(void)
{
	g_auto(made) m = made_new();
	for (int n = 0; n < 400; n++)
		made_add_ball(&m, (const double[3]){ n % 20, n / 20, 3 }, 0.4, 500 + n * 11,
			(uint16_t)(MADE_LEAF + n));
	made_read(&m);
	g_autoptr(scene) paged = open_paged(m.model, LEAST);
	g_assert_cmpuint((uint64_t)scene_pager_sums(paged->pager).units_most * SCENE_UNIT_POINTS, <,
		m.scene->count / 2);
	for (int n = 0; n < 40; n++) {
		const double eye[3] = { 10 + n % 7 - 3, -1 + n % 5, 3.5 + n % 3 };
		struct camera c = camera_towards(eye, n * 0.4, -0.2, n % 2 ? 70 : 25, 480, 360);
		settle(paged, &c);
	}
}

/* A GPU's copies follow what comes and goes. */
static void check_gles(drawing *d)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(scene) paged = open_paged(shared.model, LEAST);
	gles_draw *gles = gles_here_draw();
	for (int n = 0; gles && n < 5; n++) {
		struct camera c = n == 2 ? camera_above() : camera_at(104 + n, 206, 70 * n);
		settle(paged, &c);
		frame *f = made_frame(paged, d, &c);
		struct picture_buffer cpu = made_picture(f),
				      other = picture_buffer_new(c.width, c.height);
		g_assert_true(gles_draw_frame(gles, f, &other, NULL, &error));
		g_assert_no_error(error);
		struct difference found = differ(&cpu, &other);
		g_test_message(
			"view %d: mean %.3f, %.3f %% near", n, found.mean, 100 * found.within);
		if (found.mean > 2)
			save_all(&cpu, &other, "paged");
		g_assert_cmpfloat(found.mean, <=, 2);
		picture_buffer_clear(&cpu);
		picture_buffer_clear(&other);
		frame_free(f);
	}
	gles_draw_free(gles);
}

static void test_gles(void)
{
	g_autoptr(drawing) strokes_of = strokes(), paint_of = paint();
	check_gles(strokes_of);
	check_gles(paint_of);
}

/* What fits is not paged. */
static void test_fits(void)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(scene) all = scene_new_within(shared.model, NULL, (uint64_t)1 << 30, &error);
	g_assert_no_error(error);
	g_assert_null(all->pager);
	g_autoptr(scene) some = scene_new_within(shared.model, NULL, (uint64_t)24 << 20, &error);
	g_assert_no_error(error);
	g_assert_nonnull(some->pager);
	g_assert_cmpuint(scene_bytes(some), <=, (uint64_t)25 << 20);
}

/* ---- what the disk does ---- */

/* To be spoilt. */
static made copy_of_yard(void)
{
	g_autoptr(GError) error = NULL;
	made m = made_new();
	made_find_folder(&m);
	g_autoptr(GFile) from = g_file_new_for_path(shared.path), to = g_file_new_for_path(m.path);
	g_file_copy(from, to, G_FILE_COPY_NONE, NULL, NULL, NULL, &error);
	g_assert_no_error(error);
	m.model = model_open_file(m.path, &error);
	g_assert_no_error(error);
	return m;
}

static void damage(const char *path, goffset at)
{
	FILE *f = g_fopen(path, "r+b");
	g_assert_nonnull(f);
	g_assert_cmpint(fseek(f, at, SEEK_SET), ==, 0);
	int was = fgetc(f);
	g_assert_cmpint(fseek(f, at, SEEK_SET), ==, 0);
	g_assert_cmpint(fputc(was ^ 0xff, f), !=, EOF);
	fclose(f);
}

/* A sentence, and the rest is drawn. */
static void test_damaged(void)
{
	g_auto(made) m = copy_of_yard();
	g_autoptr(scene) paged = open_paged(m.model, LEAST);
	g_autoptr(GError) error = NULL;
	g_autoptr(drawing) d = strokes();
	struct camera c = camera_at(110, 210, 0);
	struct scene_look look = { .camera = &c, .ink_px = 0.3f };
	uint64_t chunks;
	const struct model_chunk *chunk = model_chunks(m.model, &chunks);
	for (uint64_t n = 0; n < chunks; n++)
		damage(m.path, 64 + (goffset)((chunk[n].first + chunk[n].points - 1) * 48 + 20));
	g_assert_false(scene_pager_settle(paged->pager, &look, &error));
	g_assert_error(error, PRODUCT_ERROR, PRODUCT_ERROR_DAMAGED);
	g_assert_nonnull(strstr(error->message, "its points are damaged"));
	struct picture_buffer p = draw_of(paged, d, &c);
	picture_buffer_clear(&p);
}

/* Cut short while it is mapped. */
static void test_cut(void)
{
	g_auto(made) m = copy_of_yard();
	g_autoptr(scene) paged = open_paged(m.model, LEAST);
	g_autoptr(GError) error = NULL;
	struct camera c = camera_at(110, 210, 0);
	struct scene_look look = { .camera = &c, .ink_px = 0.3f };
	uint64_t chunks;
	const struct model_chunk *chunk = model_chunks(m.model, &chunks);
	g_assert_cmpint(truncate(m.path, (off_t)(64 + chunk[2].first * 48)), ==, 0);
	g_assert_false(scene_pager_settle(paged->pager, &look, &error));
	g_assert_error(error, PRODUCT_ERROR, PRODUCT_ERROR_DAMAGED);
	g_assert_nonnull(strstr(error->message, "shorter"));
}

/* ---- units ---- */

static void test_units(void)
{
	enum { COUNT = 800, BLOCKS = 200 };
	scene_units *u = scene_units_new(COUNT + 3);
	g_autoptr(GRand) chance = g_rand_new_with_seed(1);
	uint32_t block[BLOCKS], taken = 0;
	uint8_t order[BLOCKS], owner[COUNT] = { 0 };
	for (int n = 0; n < BLOCKS; n++)
		block[n] = SCENE_UNITS_NONE;
	g_assert_cmpuint(scene_units_count(u), ==, COUNT);
	for (int step = 0; step < 20000; step++) {
		int n = g_rand_int_range(chance, 0, BLOCKS);
		bool take = block[n] == SCENE_UNITS_NONE;
		if (take) {
			order[n] = (uint8_t)g_rand_int_range(chance, 0, SCENE_UNIT_ORDERS);
			block[n] = scene_units_take(u, order[n]);
			if (block[n] == SCENE_UNITS_NONE)
				continue;
			taken += 1u << order[n];
		}
		for (uint32_t i = block[n]; i < block[n] + (1u << order[n]); i++) {
			g_assert_cmpuint(owner[i], ==, !take);
			owner[i] = take;
		}
		if (!take) {
			scene_units_give(u, block[n], order[n]);
			taken -= 1u << order[n];
			block[n] = SCENE_UNITS_NONE;
		}
		g_assert_cmpuint(scene_units_left(u), ==, COUNT - taken);
	}
	for (int n = 0; n < BLOCKS; n++)
		if (block[n] != SCENE_UNITS_NONE)
			scene_units_give(u, block[n], order[n]);
	/* All are whole again. */
	for (int n = 0; n < COUNT / 8; n++)
		g_assert_cmpuint(scene_units_take(u, 3), !=, SCENE_UNITS_NONE);
	g_assert_cmpuint(scene_units_take(u, 0), ==, SCENE_UNITS_NONE);
	scene_units_free(u);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	shared = made_yard();
	made_read(&shared);
	g_test_add_func("/scene-pager/units", test_units);
	g_test_add_func("/scene-pager/same", test_same);
	g_test_add_func("/scene-pager/coarse", test_coarse);
	g_test_add_func("/scene-pager/moving", test_moving);
	g_test_add_func("/scene-pager/quiet", test_quiet);
	g_test_add_func("/scene-pager/overview", test_overview);
	g_test_add_func("/scene-pager/pieces", test_pieces);
	g_test_add_func("/scene-pager/gles", test_gles);
	g_test_add_func("/scene-pager/fits", test_fits);
	g_test_add_func("/scene-pager/damaged", test_damaged);
	g_test_add_func("/scene-pager/cut", test_cut);
	int status = g_test_run();
	made_clear(&shared);
	return status;
}
