/* Stippling without normals: what is drawn of balls and of ground in the light, and that it asks for places alone. */
#include "render/vector-page.h"
#include "tests/strokes-made.h"
#include <omp.h>

#define STIPPLE(more) MADE_SITE("{\"step\":\"stipple\",\"opacity\":1" more "}")
#define SIDE          1024u

/* ---- places ---- */

/* Evenly, and without normals. */
static void add_ball(made *m, const double middle_m[3], double radius_m, uint32_t count)
{
	struct made_point p = { .rgba = { 90, 90, 90, 255 }, .leaf = MADE_LEAF };
	p.apart_m = (float)(radius_m * sqrt(4 * G_PI / count));
	for (uint32_t n = 0; n < count; n++) {
		double z = 1 - (2 * n + 1.) / count, r = sqrt(1 - z * z);
		double turn = n * G_PI * (3 - sqrt(5.));
		double unit[3] = { r * cos(turn), r * sin(turn), z };
		for (int k = 0; k < 3; k++)
			p.at_m[k] = middle_m[k] + radius_m * unit[k];
		g_array_append_val(m->points, p);
	}
}

static const double origin[3], eye[3] = { 0, -3, 0 };

/* Of radius 1 around the origin; never freed. */
static const scene *ball(void)
{
	static made m;
	if (!m.scene) {
		m = made_new();
		add_ball(&m, origin, 1, 60000);
		made_read(&m);
		files_remove_tree(m.folder, NULL);
	}
	return m.scene;
}

static const struct style_light from_right = { .amount = 1, .azimuth_deg = 90 };
static const double to_right[3] = { 1, 0, 0 };

typedef struct looked looked;
struct looked {
	drawing *drawing;
	frame *f;
	stroke_list *list;
};

static struct looked look_at(
	const scene *s, const char *steps, const struct style_light *light, const struct camera *c)
{
	struct looked l = { .drawing = made_drawing(steps) };
	if (light)
		l.drawing->whole.light = *light;
	l.f = made_frame(s, l.drawing, c);
	l.list = strokes_of(l.f, true);
	return l;
}

static struct looked look(const scene *s, const char *steps, const struct style_light *light)
{
	struct camera c = camera_look_at(eye, origin, 45, SIDE, SIDE);
	return look_at(s, steps, light, &c);
}

static void looked_clear(struct looked *l)
{
	stroke_lists_free(l->list, l->f->layers);
	frame_free(l->f);
	drawing_free(l->drawing);
}

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC(looked, looked_clear)

static void place_of(const scene *s, uint32_t point, double ret[3])
{
	uint32_t n = 0;
	while (point >= s->chunk[n].first + s->chunk[n].count)
		n++;
	scene_position(s, &s->chunk[n], point - s->chunk[n].first, ret);
}

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Which points are drawn, by more than half. */
static bool *drawn_of(const scene *s, const stroke_list *l)
{
	bool *drawn = g_new0(bool, s->count);
	for (uint32_t n = 0; n < l->count; n++) {
		g_assert_false(drawn[l->stroke[n].point]);
		drawn[l->stroke[n].point] = l->stroke[n].alpha > 0.5f;
	}
	return drawn;
}

/* ---- what is hidden ---- */

/* Of those that turn to the eye on a ball, by more than this cosine, and of those that turn away. */
static void count_sides(const scene *s, const stroke_list *l, double *ret_front, double *ret_back)
{
	uint32_t front = 0, fronts = 0, back = 0, backs = 0;
	g_autofree bool *drawn = drawn_of(s, l);
	for (uint32_t n = 0; n < s->count; n++) {
		double at[3], to_eye[3];
		place_of(s, n, at);
		for (int k = 0; k < 3; k++)
			to_eye[k] = eye[k] - at[k];
		double facing = dot(at, to_eye) / sqrt(dot(to_eye, to_eye));
		fronts += facing > 0.05;
		front += facing > 0.05 && drawn[n];
		backs += facing < -0.05;
		back += facing < -0.05 && drawn[n];
	}
	*ret_front = (double)front / fronts;
	*ret_back = (double)back / backs;
}

/* Figure 12: each pass leaves less of the back; as many as are needed leave next to none, and all of the front. */
static void test_hidden(void)
{
	static const char *const steps[] = { STIPPLE(",\"passes\":1"), STIPPLE(",\"passes\":2"),
		STIPPLE(",\"passes\":3"), STIPPLE("") };
	double before = 1;
	for (size_t n = 0; n < G_N_ELEMENTS(steps); n++) {
		double front, back;
		g_auto(looked) l = look(ball(), steps[n], NULL);
		count_sides(ball(), l.list, &front, &back);
		g_test_message("%s: %.2f %% of the front, %.2f %% of the back", steps[n],
			100 * front, 100 * back);
		g_assert_cmpfloat(front, >, 0.99);
		g_assert_cmpfloat(back, <=, before);
		before = back;
	}
	g_assert_cmpfloat(before, <, 0.002);
}

/* What is drawn otherwise hides too: a wall before the ball. */
static void test_hidden_by_others(void)
{
	g_auto(made) m = made_new();
	struct made_plane wall = { .corner_m = { -1.5, -1.5, -1.5 },
		.a_m = { 3, 0, 0 },
		.b_m = { 0, 0, 3 },
		.apart_m = 0.01,
		.order = MADE_JITTERED,
		.leaf = MADE_LEAF + 1,
		.no_normal = true };
	add_ball(&m, origin, 0.8, 30000);
	made_add_plane(&m, &wall);
	const scene *s = made_read(&m);
	g_auto(looked) l = look(s,
		STIPPLE("") ",\"Tree\":{\"steps\":[{\"step\":\"lines\",\"points\":\"all\"}]}",
		NULL);
	g_assert_cmpuint(l.f->layers, ==, 2);
	for (uint32_t n = 0; n < l.f->layers; n++)
		if (l.f->layer[n].stipple)
			g_assert_cmpuint(l.list[n].count, <, 30000 / 200);
		else
			g_assert_cmpuint(l.list[n].count, >, 1000);
}

/* ---- the light ---- */

static uint32_t number_of(const char *more, const struct style_light *light)
{
	g_autofree char *steps = g_strdup_printf(STIPPLE("%s"), more);
	g_auto(looked) l = look(ball(), steps, light);
	return l.list->count;
}

/* One is left out at level 0, and at most one for each texel of any other. */
static void test_level(void)
{
	uint32_t all = number_of("", NULL), before = all;
	for (int level = 0; level <= 10; level++) {
		g_autofree char *more = g_strdup_printf(",\"level\":%d,\"epsilon\":0", level);
		uint32_t count = number_of(more, &from_right);
		g_assert_cmpuint(count, <=, before);
		g_assert_cmpuint(all - count, >=, 1);
		g_assert_cmpuint(all - count, <=, 1u << (2 * level));
		before = count;
	}
	g_assert_cmpuint(before, <, all * 7 / 10);
}

/* What part is drawn of what turns to eye and light, by the cosine to the light. */
static double part_drawn(const scene *s, const stroke_list *l, double least, double most)
{
	uint32_t all = 0, some = 0;
	g_autofree bool *drawn = drawn_of(s, l);
	for (uint32_t n = 0; n < s->count; n++) {
		double at[3];
		place_of(s, n, at);
		double along = dot(at, to_right);
		if (at[1] > -0.45 || along < least || along >= most)
			continue;
		all++;
		some += drawn[n];
	}
	g_assert_cmpuint(all, >, 500);
	return (double)some / all;
}

static void test_lighter_in_light(void)
{
	g_auto(looked) l = look(ball(), STIPPLE(",\"level\":7,\"epsilon\":0"), &from_right);
	double before = 0;
	for (int n = 0; n < 4; n++) {
		double part = part_drawn(ball(), l.list, 0.7 - 0.2 * n, 0.8 - 0.2 * n);
		g_test_message("cosine %.2f: %.3f drawn", 0.75 - 0.2 * n, part);
		g_assert_cmpfloat(part, >, before);
		before = part;
	}
	g_assert_cmpfloat(part_drawn(ball(), l.list, -0.9, -0.2), >, 0.99);
}

/* A light of half the amount takes half of the ink away; none takes nothing. */
static void test_amount(void)
{
	struct style_light half = from_right, none = from_right;
	half.amount = 0.5f;
	none.amount = 0;
	g_auto(looked) l = look(ball(), STIPPLE(""), &half);
	g_assert_cmpuint(l.list->count, ==, number_of("", NULL));
	g_assert_cmpuint(l.list->count, ==, number_of("", &none));
	uint32_t whole = 0;
	for (uint32_t n = 0; n < l.list->count; n++) {
		float alpha = l.list->stroke[n].alpha;
		g_assert_true(alpha == 0.5f || alpha == 1);
		whole += alpha == 1;
	}
	g_assert_cmpuint(whole, ==, number_of("", &from_right));
}

/* Less leaves more out, and what it leaves out faces the light more than the eye. */
static void test_epsilon(void)
{
	static const char *const steps[] = { STIPPLE(",\"level\":0,\"epsilon\":0"),
		STIPPLE(",\"level\":0,\"epsilon\":0.5"), STIPPLE(",\"level\":0,\"epsilon\":0.3"),
		STIPPLE(",\"level\":0,\"epsilon\":0.2"), STIPPLE(",\"level\":0,\"epsilon\":0.1") };
	g_autofree bool *before = NULL;
	for (size_t n = 0; n < G_N_ELEMENTS(steps); n++) {
		g_auto(looked) l = look(ball(), steps[n], &from_right);
		bool *drawn = drawn_of(ball(), l.list);
		double more = 0;
		uint32_t fewer = 0;
		for (uint32_t i = 0; n && i < ball()->count; i++) {
			double at[3];
			place_of(ball(), i, at);
			g_assert_true(before[i] || !drawn[i]);
			fewer += before[i] && !drawn[i];
			more += before[i] && !drawn[i] ? at[0] + at[1] : 0;
		}
		g_test_message("%s: %u drawn, %u fewer, cosines differ by %.2f", steps[n],
			l.list->count, fewer, fewer ? more / fewer : 0);
		if (n) {
			g_assert_cmpuint(fewer, >, 50);
			g_assert_cmpfloat(more / fewer, >, 0);
		}
		g_free(before);
		before = drawn;
	}
}

/* Figure 15. A ball floats above the ground, and the sun stands above it: below the ball the ground stays dark, and around it not. */
static void test_shadow(void)
{
	static const double above[3] = { 0, 0, 1 }, from[3] = { 0, -6, 5 };
	static const struct style_light high = { .amount = 1, .elevation_deg = 90 };
	g_auto(made) m = made_new();
	struct made_plane ground = { .corner_m = { -2, -2, -1 },
		.a_m = { 4, 0, 0 },
		.b_m = { 0, 4, 0 },
		.apart_m = 0.015,
		.order = MADE_JITTERED,
		.no_normal = true };
	add_ball(&m, above, 0.6, 20000);
	made_add_plane(&m, &ground);
	const scene *s = made_read(&m);
	struct camera c = camera_look_at(from, origin, 40, SIDE, SIDE);
	g_auto(looked) l = look_at(s, STIPPLE(",\"level\":10,\"epsilon\":0.3"), &high, &c);
	g_autofree bool *drawn = drawn_of(s, l.list);
	uint32_t dark = 0, darks = 0, bare = 0, bares = 0;
	for (uint32_t n = 0; n < s->count; n++) {
		double at[3];
		place_of(s, n, at);
		double away = hypot(at[0], at[1]);
		if (at[2] > -0.9)
			continue;
		darks += away < 0.55;
		dark += away < 0.55 && drawn[n];
		bares += away > 0.7;
		bare += away > 0.7 && drawn[n];
	}
	g_test_message("of the shadow %.3f, of the ground in the light %.3f", (double)dark / darks,
		(double)bare / bares);
	g_assert_cmpfloat((double)dark / darks, >, 0.97);
	g_assert_cmpfloat((double)bare / bares, <, 0.2);
}

/* A lamp beside the ball sees less of it than the sun does: more of it stays dark. */
static void test_lamp(void)
{
	uint32_t sun = number_of(",\"level\":10", &from_right),
		 lamp = number_of(",\"level\":10,\"light_distance\":1.2", &from_right),
		 far = number_of(",\"level\":10,\"light_distance\":100", &from_right);
	g_test_message("%u in the sun, %u by a lamp, %u by one far away", sun, lamp, far);
	g_assert_cmpuint(lamp, >, sun + sun / 20);
	g_assert_cmpfloat(fabs((double)far - sun), <, 0.02 * sun);
}

/* ---- places alone ---- */

/* Whatever else is said of the points. */
static void test_places_alone(void)
{
	g_auto(made) m = made_new();
	add_ball(&m, origin, 1, 20000);
	made_read(&m);
	g_auto(looked) a = look(m.scene, STIPPLE(""), &from_right);
	for (uint32_t n = 0; n < m.scene->count; n++) {
		m.scene->normal[n][0] = (int16_t)(n * 7919);
		m.scene->normal[n][1] = (int16_t)(n * 104729);
		memcpy(m.scene->direction[n], m.scene->normal[n], sizeof *m.scene->direction);
		m.scene->kind[n] = (uint8_t)(n % FEATURE_KINDS);
		m.scene->degree[n] = (uint8_t)(n * 31);
		memset(m.scene->rgba[n], (int)(n % 256), 4);
		m.scene->list[n] = 0;
	}
	g_auto(looked) b = look(m.scene, STIPPLE(""), &from_right);
	g_assert_cmpuint(a.list->count, >, 2000);
	g_assert_cmpmem(a.list->stroke, a.list->count * sizeof *a.list->stroke, b.list->stroke,
		b.list->count * sizeof *b.list->stroke);
}

/* Of many points the first ones of each chunk, which lie all over it. */
static void test_most_points(void)
{
	g_auto(looked) l = look(ball(), STIPPLE(",\"most_points\":15"), NULL);
	double front, back;
	count_sides(ball(), l.list, &front, &back);
	g_test_message("%.3f of the front, %.4f of the back", front, back);
	g_assert_cmpfloat(fabs(front - 0.25), <, 0.01);
	g_assert_cmpfloat(back, <, 0.01);
	for (uint32_t n = 0; n < l.list->count; n++) {
		uint32_t chunk = 0, point = l.list->stroke[n].point;
		while (point >= ball()->chunk[chunk].first + ball()->chunk[chunk].count)
			chunk++;
		g_assert_cmpuint(
			point - ball()->chunk[chunk].first, <=, ball()->chunk[chunk].count / 4);
	}
}

/* Dots grow up to what may be, where points are farther apart. */
static void test_grow(void)
{
	g_auto(looked) l = look(ball(), STIPPLE(",\"length_px\":2,\"grow\":1.4"), NULL);
	float least = INFINITY, most = 0, px = (float)(SIDE / FRAME_STYLE_HEIGHT);
	for (uint32_t n = 0; n < l.list->count; n++) {
		least = fminf(least, l.list->stroke[n].half_length_px);
		most = fmaxf(most, l.list->stroke[n].half_length_px);
	}
	g_assert_cmpfloat(least, >, px * 1.05f);
	g_assert_cmpfloat(most, <, px * 1.41f);
}

/* ---- pictures ---- */

static void compare_pictures(const frame *f, const struct picture_buffer *a)
{
	struct picture_buffer b = made_picture(f);
	made_assert_same(a, &b);
	picture_buffer_clear(&b);
}

/* The same bytes with any number of threads and all vectors, and where a frame was moved away and back. */
static void test_same_bytes(void)
{
	static const int threads[] = { 1, 2, 5 };
	static const double other[3] = { 2, -3, 1 };
	int before = omp_get_max_threads();
	g_auto(looked) l = look(ball(),
		STIPPLE(",\"tooth\":0.3,\"light_distance\":3},{\"step\":\"points\"},{\"step\":"
			"\"stipple\",\"id\":\"b\",\"most_points\":20"),
		&from_right);
	struct picture_buffer a = made_picture(l.f);
	for (size_t n = 0; n < G_N_ELEMENTS(threads); n++) {
		omp_set_num_threads(threads[n]);
		compare_pictures(l.f, &a);
	}
	omp_set_num_threads(before);
	for (enum lanes_path path = 0; path <= lanes_path_widest(); path++) {
		l.f->lanes = path;
		compare_pictures(l.f, &a);
	}
	l.f->single_thread = true;
	compare_pictures(l.f, &a);
	struct camera c = l.f->camera, there = camera_look_at(other, origin, 40, SIDE, SIDE);
	draw_room *room = draw_room_new();
	struct picture_buffer p = picture_buffer_new(SIDE, SIDE);
	for (int n = 0; n < 3; n++) {
		frame_move(l.f, n == 1 ? &there : &c, NULL);
		draw_frame(room, l.f, &p, NULL);
	}
	made_assert_same(&a, &p);
	draw_room_free(room);
	picture_buffer_clear(&p);
	picture_buffer_clear(&a);
}

/* A picture of a single row is no reason for a plane as wide as the world. */
static void test_wide(void)
{
	struct camera c = camera_look_at(eye, origin, 1, CAMERA_SIDE_MAX, 1);
	g_auto(looked) l = look_at(ball(), STIPPLE(""), &from_right, &c);
	for (uint32_t n = 0; n < l.list->count; n++)
		g_assert_cmpfloat(fabsf(l.list->stroke[n].y_px - 0.5f), <, 40);
}

/* As dark at any size. */
static void test_sizes(void)
{
	double mean[2];
	for (int n = 0; n < 2; n++) {
		struct camera c = camera_look_at(eye, origin, 45, SIDE >> n, SIDE >> n);
		g_auto(looked) l = look_at(ball(), STIPPLE(",\"length_px\":4"), &from_right, &c);
		struct picture_buffer p = made_picture(l.f);
		double sum = 0;
		for (uint32_t i = 0; i < p.width * p.height; i++)
			sum += 255 - p.rgba[i][0];
		mean[n] = sum / (p.width * p.height);
		picture_buffer_clear(&p);
	}
	g_test_message("dark by %.2f and %.2f", mean[0], mean[1]);
	g_assert_cmpfloat(fabs(mean[0] / mean[1] - 1), <, 0.1);
}

/* When the camera goes round by half a degree nearly all that is drawn is drawn again. */
static void test_orbit(void)
{
	g_autofree bool *before = NULL;
	uint64_t all = 0, again = 0;
	for (int n = 0; n < 8; n++) {
		double a = n * 0.5 * G_PI / 180, from[3] = { 3 * sin(a), -3 * cos(a), 0 };
		struct camera c = camera_look_at(from, origin, 45, SIDE, SIDE);
		g_auto(looked) l = look_at(ball(), STIPPLE(",\"level\":8"), &from_right, &c);
		bool *drawn = drawn_of(ball(), l.list);
		for (uint32_t i = 0; before && i < ball()->count; i++) {
			all += before[i];
			again += before[i] && drawn[i];
		}
		g_free(before);
		before = drawn;
	}
	g_test_message("%.4f drawn again", (double)again / (double)all);
	g_assert_cmpfloat((double)again, >, 0.95 * (double)all);
}

/* As shapes too: a circle for each dot that is not under others. */
static void test_page(void)
{
	g_auto(looked) l = look(ball(), STIPPLE(",\"most_points\":4"), &from_right);
	draw_room *room = draw_room_new();
	struct draw_times t;
	g_autoptr(vector_page) page = vector_page_new(room, l.f, NULL, 200, 200, "Ball", &t);
	g_assert_cmpuint(t.strokes, >, 300);
	g_assert_cmpuint(page->layers->len, ==, 1);
	const struct vector_layer *layer = page->layers->pdata[0];
	g_assert_cmpint(layer->form, ==, VECTOR_DOTS);
	g_assert_cmpuint(layer->strokes, ==, l.list->count);
	g_assert_cmpuint(layer->shown, >, 300);
	draw_room_free(room);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/stipple/hidden", test_hidden);
	g_test_add_func("/stipple/hidden-by-others", test_hidden_by_others);
	g_test_add_func("/stipple/level", test_level);
	g_test_add_func("/stipple/lighter-in-light", test_lighter_in_light);
	g_test_add_func("/stipple/amount", test_amount);
	g_test_add_func("/stipple/epsilon", test_epsilon);
	g_test_add_func("/stipple/shadow", test_shadow);
	g_test_add_func("/stipple/lamp", test_lamp);
	g_test_add_func("/stipple/places-alone", test_places_alone);
	g_test_add_func("/stipple/most-points", test_most_points);
	g_test_add_func("/stipple/grow", test_grow);
	g_test_add_func("/stipple/same-bytes", test_same_bytes);
	g_test_add_func("/stipple/wide", test_wide);
	g_test_add_func("/stipple/sizes", test_sizes);
	g_test_add_func("/stipple/orbit", test_orbit);
	g_test_add_func("/stipple/page", test_page);
	return g_test_run();
}
