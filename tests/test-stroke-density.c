/* How dense strokes are, where points are many and where they are too few, and how dark they make the paper. */
#include "render/bench-reproject.h"
#include "render/light.h"
#include "tests/strokes-made.h"

/* A plane at y = 0 with its middle in the origin, seen from y < 0. */
static void add_wall(made *m, int side, double apart_m, uint8_t grey, bool dithered)
{
	double half = side * apart_m / 2;
	struct made_plane p = { .corner_m = { -half, 0, -half },
		.a_m = { 2 * half, 0, 0 },
		.b_m = { 0, 0, 2 * half },
		.apart_m = apart_m,
		.order = MADE_JITTERED,
		.rgba = { grey, grey, grey, 255 },
		.dithered = dithered };
	made_add_plane(m, &p);
}

/* Towards the origin, at a slant; away such that a metre there has so many pixels. */
static struct camera before_wall(double slant_deg, double px_per_m, uint32_t width)
{
	static const double origin[3] = { 0, 0, 0 };
	double fov_deg = 50, focal_px = HEIGHT / 2. / tan(fov_deg / 2 * G_PI / 180);
	double away_m = focal_px / px_per_m, a = slant_deg * G_PI / 180;
	double eye[3] = { -away_m * sin(a), -away_m * cos(a), 0 };
	return camera_look_at(eye, origin, fov_deg, width, HEIGHT);
}

/* Whether a place on the screen shows the wall, farther from its border than so many metres. */
static bool is_wall(const struct camera *c, double half_m, double px, double py)
{
	double ray[3], place[2] = { px, py };
	camera_ray(c, place, ray);
	double scale = -c->eye_m[1] / ray[1];
	return scale > 0 && fabs(c->eye_m[0] + scale * ray[0]) < half_m &&
	       fabs(c->eye_m[2] + scale * ray[2]) < half_m;
}

/* ---- density ---- */

#define TILE 32

typedef struct tiles tiles;
struct tiles {
	uint32_t columns, rows;
	double *strokes, *px;
};

static void tiles_clear(struct tiles *t)
{
	g_free(t->strokes);
	g_free(t->px);
}
G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC(tiles, tiles_clear)
static struct tiles tiles_of(const frame *f, const stroke_list *l, double half_m)
{
	const struct camera *c = &f->camera;
	struct tiles t = { c->width / TILE, c->height / TILE };
	t.strokes = g_new0(double, t.columns *t.rows);
	t.px = g_new0(double, t.columns *t.rows);
	for (uint32_t n = 0; n < l->count; n++) {
		const struct stroke *s = &l->stroke[n];
		double x = (double)s->x_px, y = (double)s->y_px;
		if (x >= 0 && y >= 0 && x < t.columns * TILE && y < t.rows * TILE &&
			is_wall(c, half_m, x, y))
			t.strokes[(uint32_t)y / TILE * t.columns + (uint32_t)x / TILE] +=
				(double)s->alpha;
	}
	for (uint32_t y = 0; y < t.rows * TILE; y++)
		for (uint32_t x = 0; x < t.columns * TILE; x++)
			t.px[y / TILE * t.columns + x / TILE] +=
				is_wall(c, half_m, x + 0.5, y + 0.5);
	return t;
}

/* Strokes to a pixel, and how much whole tiles differ. */
static double density_of(const struct tiles *t, double *ret_variation)
{
	double strokes = 0, px = 0, sum = 0, squares = 0;
	int whole = 0;
	for (uint32_t n = 0; n < t->columns * t->rows; n++) {
		strokes += t->strokes[n];
		px += t->px[n];
		if (t->px[n] < TILE * TILE)
			continue;
		sum += t->strokes[n];
		squares += t->strokes[n] * t->strokes[n];
		whole++;
	}
	double mean = sum / MAX(whole, 1);
	*ret_variation = whole > 1 ? sqrt(fmax(squares / whole - mean * mean, 0)) / mean : 0;
	g_assert_cmpfloat(px, >, 3000);
	return strokes / px;
}

/* As many as the style says, at any distance and slant, wherever points are dense enough. */
static void test_density(void)
{
	static const double px_per_m[] = { 150, 60, 25 }, slants_deg[] = { 0, 40, 70 };
	g_auto(made) m = made_new();
	add_wall(&m, 600, 0.01, 100, false);
	const scene *s = made_read(&m);
	g_autoptr(drawing) d = made_drawing(MADE_SITE(
		"{\"step\":\"sprites\",\"points\":\"surface\",\"spacing_px\":16," STEADY "}"));
	for (int i = 0; i < 3; i++)
		for (int k = 0; k < 3; k++) {
			struct camera c = before_wall(slants_deg[k], px_per_m[i], 400);
			g_autoptr(frame) f = made_frame(s, d, &c);
			stroke_list *l = strokes_of(f, true);
			double variation;
			g_auto(tiles) t = tiles_of(f, l, 2.95);
			double density = density_of(&t, &variation) * 16;
			g_test_message("%g px a metre, %g degrees: %.3f of what is wanted, tiles "
				       "differ by %.3f",
				px_per_m[i], slants_deg[k], density, variation);
			g_assert_cmpfloat(fabs(density - 1), <=, 0.05);
			g_assert_cmpfloat(variation, <=, 0.12);
			stroke_lists_free(l, f->layers);
		}
}

/* Points of all kinds of surface together, or in one queue, are no denser than points of one; and where they are too few, copies of some
 * stand for those that give none. */
static void test_kinds(void)
{
	static const char *const layers[] = { "\"points\":\"surface\"", "\"points\":\"all\"",
		"\"points\":\"dithering\",\"tone\":\"colour\"" };
	static const double apart_m[] = { 0.01, 0.1 };
	for (int sparse = 0; sparse < 2; sparse++) {
		g_auto(made) m = made_new();
		add_wall(&m, sparse ? 60 : 600, apart_m[sparse], 100, true);
		for (guint i = 0; i < m.points->len; i++)
			if (g_rand_int_range(m.chance, 0, 4) == 0)
				g_array_index(m.points, struct made_point, i).kind =
					FEATURE_UNDIRECTED;
		const scene *s = made_read(&m);
		for (size_t n = 0; n < G_N_ELEMENTS(layers); n++) {
			g_autofree char *node = g_strdup_printf(
				MADE_SITE("{\"step\":\"sprites\",%s,\"spacing_px\":16," STEADY "}"),
				layers[n]);
			g_autoptr(drawing) d = made_drawing(node);
			struct camera c = before_wall(0, 60, 400);
			g_autoptr(frame) f = made_frame(s, d, &c);
			stroke_list *l = strokes_of(f, false);
			double variation;
			g_auto(tiles) t = tiles_of(f, l, 2.8);
			double wanted = (double)(f->layer[0].wanted_per_px[100] * STROKE_FADE_MEAN),
			       density = density_of(&t, &variation) / wanted;
			g_test_message("%s, %g m apart: %.3f of what is wanted", layers[n],
				apart_m[sparse], density);
			g_assert_cmpfloat(fabs(density - 1), <=, 0.07);
			stroke_lists_free(l, f->layers);
		}
	}
}

/* ---- copies ---- */

struct spot {
	uint32_t point, copy;
	double at_m[3];
};

static void free_spots(gpointer spots)
{
	g_array_unref(spots);
}

/* Strokes of the only layer, by points and copies, where they are in the site. */
static GArray *spots_of(const frame *f)
{
	GArray *spots = g_array_new(FALSE, FALSE, sizeof(struct spot));
	stroke_list *l = strokes_of(f, false);
	for (uint32_t n = 0; n < l->count; n++) {
		const struct stroke *s = &l->stroke[n];
		struct spot spot = { .point = s->point, .copy = s->copy };
		double px[2] = { (double)s->x_px, (double)s->y_px };
		camera_place(&f->camera, px, 1 / (double)s->q, spot.at_m);
		g_array_append_val(spots, spot);
	}
	stroke_lists_free(l, f->layers);
	return spots;
}

static guint spot_hash(gconstpointer spot)
{
	const struct spot *s = spot;
	return s->point * 31 + s->copy;
}

static gboolean spot_equal(gconstpointer a, gconstpointer b)
{
	const struct spot *x = a, *y = b;
	return x->point == y->point && x->copy == y->copy;
}

/* Every one of them is another, and none is farther from its point than its patch goes. */
static GHashTable *know_spots(const frame *f, GArray *spots, uint32_t *ret_copies)
{
	GHashTable *known = g_hash_table_new(spot_hash, spot_equal);
	*ret_copies = 0;
	for (guint n = 0; n < spots->len; n++) {
		struct spot *s = &g_array_index(spots, struct spot, n);
		const struct scene_chunk *c = &f->scene->chunk[0];
		double point_m[3];
		while (s->point >= c->first + c->count)
			c++;
		scene_position(f->scene, c, s->point - c->first, point_m);
		double reach_m = f->scene->disc[s->point] * 1e-4 *
				 (double)stroke_reach(1, s->copy) * G_SQRT2;
		g_assert_cmpfloat(hypot(s->at_m[0] - point_m[0], s->at_m[2] - point_m[2]), <=,
			reach_m + 1e-4);
		g_assert_cmpfloat(fabs(s->at_m[1]), <, 1e-3);
		g_assert_true(g_hash_table_add(known, s));
		*ret_copies += s->copy > 0;
	}
	return known;
}

/* Points too far apart for what is wanted: strokes are as dense all the same, and they lie on the wall from wherever they are seen. */
static void test_copies(void)
{
	g_auto(made) m = made_new();
	add_wall(&m, 60, 0.1, 100, false);
	const scene *s = made_read(&m);
	g_autoptr(drawing) d = made_drawing(MADE_SITE(
		"{\"step\":\"sprites\",\"points\":\"surface\",\"spacing_px\":16," STEADY "}"));
	g_autoptr(GHashTable) known = NULL;
	g_autoptr(GPtrArray) kept = g_ptr_array_new_with_free_func(free_spots);
	for (int slant = 0; slant <= 60; slant += 30) {
		struct camera c = before_wall(slant, 60, 400);
		g_autoptr(frame) f = made_frame(s, d, &c);
		stroke_list *l = strokes_of(f, false);
		double variation, moved_m = 0;
		g_auto(tiles) t = tiles_of(f, l, 2.8);
		double density = density_of(&t, &variation) * 16;
		stroke_lists_free(l, f->layers);
		GArray *spots = spots_of(f);
		g_ptr_array_add(kept, spots);
		uint32_t copies, again = 0;
		g_autoptr(GHashTable) these = know_spots(f, spots, &copies);
		for (guint n = 0; known && n < spots->len; n++) {
			const struct spot *now = &g_array_index(spots, struct spot, n),
					  *before = g_hash_table_lookup(known, now);
			for (int k = 0; before && k < 3; k++)
				moved_m = fmax(moved_m, fabs(now->at_m[k] - before->at_m[k]));
			again += before != NULL;
		}
		g_test_message(
			"%d degrees: %.3f of what is wanted, tiles differ by %.3f; %u copies "
			"of %u strokes; %u again, off by %.5f m",
			slant, density, variation, copies, spots->len, again, moved_m);
		g_assert_cmpfloat(fabs(density - 1), <=, 0.1);
		g_assert_cmpfloat(variation, <=, 0.2);
		g_assert_cmpuint(copies, >, spots->len / 2);
		g_assert_true(!known || again > spots->len / 2);
		g_assert_cmpfloat(moved_m, <, 1e-3);
		g_clear_pointer(&known, g_hash_table_unref);
		known = g_steal_pointer(&these);
	}
}

/* Standing on ground. */
static struct camera on_ground(double azimuth_deg, uint32_t width)
{
	double a = azimuth_deg * G_PI / 180, eye[3] = { 0, 0, 2 };
	double ahead[3] = { sin(a), cos(a), 1.7 };
	return camera_look_at(eye, ahead, 50, width, HEIGHT);
}

/* What is seen at the border of a picture is what a wider one shows there, from wherever its strokes were moved, far aside as well, where a
 * stroke that moves ahead moves along the picture, too. */
static void test_border(void)
{
	g_auto(made) m = made_new();
	struct made_plane ground = { .corner_m = { -8, -8, 0 },
		.a_m = { 16, 0, 0 },
		.b_m = { 0, 16, 0 },
		.apart_m = 0.1,
		.order = MADE_JITTERED,
		.rgba = { 100, 100, 100, 255 } };
	made_add_plane(&m, &ground);
	const scene *s = made_read(&m);
	g_autoptr(drawing) d = made_drawing(MADE_SITE(
		"{\"step\":\"sprites\",\"points\":\"surface\",\"spacing_px\":6," STEADY "}"));
	for (int azimuth = 0; azimuth < 90; azimuth += 9) {
		struct camera c = on_ground(azimuth, 3 * HEIGHT);
		struct camera wide = on_ground(azimuth, 6 * HEIGHT);
		g_autoptr(frame) f = made_frame(s, d, &c), g = made_frame(s, d, &wide);
		g_autoptr(GArray) spots = spots_of(f), more = spots_of(g);
		g_autoptr(GHashTable) known = g_hash_table_new(spot_hash, spot_equal);
		uint32_t inside = 0, missing = 0;
		for (guint n = 0; n < spots->len; n++)
			g_hash_table_add(known, &g_array_index(spots, struct spot, n));
		for (guint n = 0; n < more->len; n++) {
			const struct spot *spot = &g_array_index(more, struct spot, n);
			double px[2], depth_m;
			if (!camera_project(&c, spot->at_m, px, &depth_m) || px[0] < 0 ||
				px[0] >= c.width || px[1] < 0 || px[1] >= c.height)
				continue;
			inside++;
			missing += !g_hash_table_contains(known, spot);
		}
		g_test_message("%d degrees: %u of %u missing", azimuth, missing, inside);
		g_assert_cmpuint(inside, >, 3000);
		g_assert_cmpuint(missing, ==, 0);
	}
}

/* ---- tone ---- */

static double mean_light(const frame *f, double half_m)
{
	struct picture_buffer p = made_picture(f);
	double sum = 0;
	uint32_t count = 0;
	for (uint32_t y = 0; y < p.height; y++)
		for (uint32_t x = 0; x < p.width; x++) {
			if (!is_wall(&f->camera, half_m, x + 0.5, y + 0.5))
				continue;
			sum += (double)light_of_srgb(
				(float)p.rgba[(size_t)y * p.width + x][1] / 255);
			count++;
		}
	picture_buffer_clear(&p);
	g_assert_cmpuint(count, >, 5000);
	return sum / count;
}

static const struct medium {
	const char *name, *step;
} media[] = {
	{ "sprites", "{\"step\":\"sprites\",\"length_px\":14,\"spacing_px\":3.6" },
	{ "lines", "{\"step\":\"lines\",\"length_px\":40,\"width_px\":4.8,\"spacing_px\":5" },
	{ "thin-lines", "{\"step\":\"lines\",\"length_px\":40,\"width_px\":1.6,\"spacing_px\":4" },
	{ "strokes", "{\"step\":\"strokes\",\"length_px\":60,\"width_px\":12,\"spacing_px\":5" },
};

/* In black of one strength, as it comes, and with strokes twice as large as the style has them. */
static const struct way {
	const char *ink;
	double coarser;
} ways[] = { { STEADY ",\"ink\":\"#000000\"", 1 }, { "\"degree\":0", 1 }, { "\"degree\":0", 2 } };

static double light_with(const scene *s, const struct medium *medium, const struct way *way)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *nodes =
		g_strdup_printf(MADE_SITE("%s,\"points\":\"dithering\",\"tone\":\"colour\",%s}"),
			medium->step, way->ink);
	g_autoptr(drawing) d = made_drawing(nodes);
	struct camera c = before_wall(0, 60, 300);
	g_autoptr(frame) f = frame_new_coarse(s, d, &c, way->coarser, &error);
	g_assert_no_error(error);
	return mean_light(f, 1.9);
}

/* The light of walls of all greys against what step.h promises: 1 - strength * dark ^ gamma of the paper's lightness. */
static void test_tone(void)
{
	double squares[G_N_ELEMENTS(media)][G_N_ELEMENTS(ways)] = { { 0 } };
	int count = 0;
	for (int grey = 0; grey <= 250; grey += 25, count++) {
		g_auto(made) m = made_new();
		add_wall(&m, 420, 0.01, (uint8_t)grey, true);
		const scene *s = made_read(&m);
		float dark = fmaxf(0.95f - (float)grey / 255, 0) / 0.95f;
		double wanted = (double)light_of_srgb(1 - 0.8f * dark);
		for (size_t n = 0; n < G_N_ELEMENTS(media); n++)
			for (size_t k = 0; k < G_N_ELEMENTS(ways); k++) {
				double light = light_with(s, &media[n], &ways[k]);
				squares[n][k] += (light - wanted) * (light - wanted);
				g_test_message("grey %.2f, %s: %.3f of %.3f", grey / 255.,
					media[n].name, light, wanted);
			}
	}
	for (size_t n = 0; n < G_N_ELEMENTS(media); n++)
		for (size_t k = 0; k < G_N_ELEMENTS(ways); k++) {
			g_test_message("%s x%.0f: %.4f RMS", media[n].name, ways[k].coarser,
				sqrt(squares[n][k] / count));
			g_assert_cmpfloat(sqrt(squares[n][k] / count), <=, 0.04);
		}
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/stroke/density", test_density);
	g_test_add_func("/stroke/kinds", test_kinds);
	g_test_add_func("/stroke/copies", test_copies);
	g_test_add_func("/stroke/border", test_border);
	g_test_add_func("/stroke/tone", test_tone);
	return g_test_run();
}
