/* The light and the focus of a style: what they do to strokes and colours, against the same things drawn without them. */
#include "tests/strokes-made.h"

/* ---- a floor and a wall ---- */

typedef struct room room;
struct room {
	made made;
	drawing *drawing;
	frame *frame;
};

static const double room_eye_m[3] = { 3, -6, 3 };

static void add_side(
	made *m, const double corner_m[3], const double b_m[3], uint8_t grey, bool dithered)
{
	struct made_plane p = { .a_m = { 6, 0, 0 },
		.apart_m = 0.02,
		.order = MADE_JITTERED,
		.rgba = { grey, grey, grey, 255 },
		.dithered = dithered };
	memcpy(p.corner_m, corner_m, sizeof p.corner_m);
	memcpy(p.b_m, b_m, sizeof p.b_m);
	made_add_plane(m, &p);
}

/* The floor faces up, the wall behind it to the south. Only queues have dithering points: of other greys there are other ones. */
static room room_of(uint8_t floor_grey, uint8_t wall_grey, const char *nodes)
{
	static const double floor_m[3] = { 0, 0, 0 }, north[3] = { 0, 6, 0 };
	static const double wall_m[3] = { 0, 6, 0 }, up[3] = { 0, 0, 4 };
	static const double target_m[3] = { 3, 4, 1 };
	room r = { made_new(), made_drawing(nodes), NULL };
	struct camera c = camera_look_at(room_eye_m, target_m, 50, 400, HEIGHT);
	bool dithered = strstr(nodes, "dithering");
	add_side(&r.made, floor_m, north, floor_grey, dithered);
	add_side(&r.made, wall_m, up, wall_grey, dithered);
	r.frame = made_frame(made_read(&r.made), r.drawing, &c);
	return r;
}

static void room_clear(room *r)
{
	frame_free(r->frame);
	drawing_free(r->drawing);
	made_clear(&r->made);
}
G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC(room, room_clear)

/* Of the wall; else of the floor. */
static bool is_wall(const scene *s, uint32_t point)
{
	float n[3];
	model_unpack_normal(s->normal[point], n);
	return n[1] < -0.5f * fabsf(n[2]);
}

struct shares {
	double wall, ground;
};

/* What strokes cover of the picture, on either: sums of alpha * area. */
static struct shares shares_of(const frame *f)
{
	struct shares sum = { 0, 0 };
	stroke_list *l = strokes_of(f, true);
	for (uint32_t i = 0; i < l->count; i++) {
		const struct stroke *one = &l->stroke[i];
		*(is_wall(f->scene, one->point) ? &sum.wall : &sum.ground) +=
			(double)(4 * one->alpha * one->half_length_px * one->half_width_px);
	}
	stroke_lists_free(l, f->layers);
	return sum;
}

static void assert_alike(double a, double b)
{
	g_assert_cmpfloat(fabs(a - b), <=, 0.03 * MAX(a, b) + 1);
}

#define TONES(points)                                                                              \
	MADE_SITE("{\"step\":\"lines\",\"points\":\"" points "\",\"tone\":\"colour\","             \
		  "\"spacing_px\":8,\"length_px\":20,\"width_px\":3,\"scatter\":0," STEADY "}")
#define EVEN                                                                                       \
	MADE_SITE("{\"step\":\"sprites\",\"points\":\"surface\",\"spacing_px\":12,"                \
		  "\"length_px\":8,\"scatter\":0," STEADY "}")
#define PAINT                                                                                      \
	MADE_SITE("{\"step\":\"sprites\",\"points\":\"surface\",\"colour\":\"point\","             \
		  "\"blend\":\"paint\",\"spacing_px\":12,\"length_px\":8," STEADY "}")
#define POINTS MADE_SITE("{\"step\":\"points\"}")

/* ---- light ---- */

/* From the south, at this elevation: the wall has its cosine, the floor its sine. */
static void light_from_south(frame *f, double amount, double elevation_deg)
{
	struct style_light light = { (float)amount, 180, (float)elevation_deg };
	frame_set_light(f, &light);
}

/* As dense as on things that are so much darker. */
static void test_tone(gconstpointer nodes)
{
	g_auto(room) lit = room_of(180, 180, nodes);
	light_from_south(lit.frame, 0.8, 30);
	int wall = (int)(180 * (1 - 0.8 * (0.5 - 0.5 * cos(G_PI / 6))));
	int ground = (int)(180 * (1 - 0.8 * (0.5 - 0.5 * sin(G_PI / 6))));
	g_auto(room) dark = room_of((uint8_t)ground, (uint8_t)wall, nodes);
	struct shares a = shares_of(lit.frame), b = shares_of(dark.frame);
	g_test_message("wall %.0f, %.0f; ground %.0f, %.0f", a.wall, b.wall, a.ground, b.ground);
	g_assert_cmpfloat(a.wall, >, 100);
	assert_alike(a.wall, b.wall);
	assert_alike(a.ground, b.ground);
}

/* Nothing where it is fully light, half of it where the light grazes. */
static void test_omitted(void)
{
	g_auto(room) r = room_of(180, 180, EVEN);
	struct shares before = shares_of(r.frame);
	light_from_south(r.frame, 1, 0);
	struct shares lit = shares_of(r.frame);
	g_assert_cmpfloat(before.wall, >, 100);
	g_assert_cmpfloat(lit.wall, <=, 0.01 * before.wall);
	assert_alike(lit.ground, before.ground * 0.5);
	light_from_south(r.frame, 1, 30);
	lit = shares_of(r.frame);
	assert_alike(lit.ground, before.ground * (0.5 - 0.5 * sin(G_PI / 6)));
}

static void test_paint(void)
{
	g_auto(room) r = room_of(200, 200, PAINT);
	light_from_south(r.frame, 0.5, 0);
	stroke_list *l = strokes_of(r.frame, true);
	g_assert_cmpuint(l->count, >, 100);
	for (uint32_t i = 0; i < l->count; i++)
		g_assert_cmpint(abs(l->stroke[i].rgb[1] -
					(is_wall(r.frame->scene, l->stroke[i].point) ? 200 : 150)),
			<=, 1);
	stroke_lists_free(l, r.frame->layers);
}

/* Of the pixel that shows a place. */
static const uint8_t *pixel_of(const frame *f, const struct picture_buffer *p, const double at_m[3])
{
	const struct camera *c = &f->camera;
	double v[3] = { 0 };
	for (int k = 0; k < 3; k++) {
		double away = at_m[k] - c->eye_m[k];
		v[0] += c->right[k] * away;
		v[1] += c->down[k] * away;
		v[2] += c->forward[k] * away;
	}
	uint32_t x = (uint32_t)(c->width / 2.0 + c->focal_px * v[0] / v[2]),
		 y = (uint32_t)(c->height / 2.0 + c->focal_px * v[1] / v[2]);
	g_assert_cmpuint(x, <, p->width);
	g_assert_cmpuint(y, <, p->height);
	return p->rgba[y * p->width + x];
}

static const double on_wall_m[3] = { 3, 6, 2 }, on_floor_m[3] = { 3, 3, 0 };

static void test_points(void)
{
	g_auto(room) r = room_of(200, 200, POINTS);
	light_from_south(r.frame, 0.5, 0);
	struct picture_buffer p = made_picture(r.frame);
	g_assert_cmpint(abs(pixel_of(r.frame, &p, on_wall_m)[0] - 200), <=, 2);
	g_assert_cmpint(abs(pixel_of(r.frame, &p, on_floor_m)[0] - 150), <=, 2);
	picture_buffer_clear(&p);
}

/* Of each point: 0 where it gives no stroke. */
static float *alphas_of(const frame *f)
{
	float *alpha = g_new0(float, f->scene->count);
	stroke_list *l = strokes_of(f, true);
	for (uint32_t i = 0; i < l->count; i++)
		if (!l->stroke[i].copy)
			alpha[l->stroke[i].point] = l->stroke[i].alpha;
	stroke_lists_free(l, f->layers);
	return alpha;
}

/* A light that grows only takes strokes from what it is on, and only adds to what it is not on: none comes for another. */
static void test_light_moves(void)
{
	g_auto(room) r = room_of(180, 180, TONES("surface"));
	light_from_south(r.frame, 0.8, 5);
	g_autofree float *before = alphas_of(r.frame);
	for (int deg = 10; deg <= 80; deg += 5) {
		light_from_south(r.frame, 0.8, deg);
		g_autofree float *now = alphas_of(r.frame);
		for (uint32_t i = 0; i < r.frame->scene->count; i++)
			if (is_wall(r.frame->scene, i))
				g_assert_cmpfloat(now[i], >=, before[i] - 1e-4f);
			else
				g_assert_cmpfloat(now[i], <=, before[i] + 1e-4f);
		memcpy(before, now, r.frame->scene->count * sizeof *before);
	}
}

/* ---- focus ---- */

/* At the middle of the wall; what is 3 m away from it is far. */
static void focus_on_wall(frame *f, double amount, double abstraction)
{
	struct style_focus focus = { .amount = (float)amount,
		.abstraction = (float)abstraction,
		.radius_m = 1,
		.falloff_m = 2,
		.x_m = 3,
		.y_m = 6,
		.z_m = 2 };
	frame_set_focus(f, &focus);
}

static double away_m(const scene *s, uint32_t point)
{
	double at_m[3] = { 0 };
	for (uint32_t n = 0; n < s->chunks; n++)
		if (point - s->chunk[n].first < s->chunk[n].count)
			scene_position(s, &s->chunk[n], point - s->chunk[n].first, at_m);
	return sqrt((at_m[0] - 3) * (at_m[0] - 3) + (at_m[1] - 6) * (at_m[1] - 6) +
		    (at_m[2] - 2) * (at_m[2] - 2));
}

static void test_focus_fades(void)
{
	g_auto(room) r = room_of(120, 120, EVEN);
	g_autofree float *before = alphas_of(r.frame);
	focus_on_wall(r.frame, 1, 0);
	g_autofree float *now = alphas_of(r.frame);
	uint32_t within = 0, between = 0;
	for (uint32_t i = 0; i < r.frame->scene->count; i++) {
		if (before[i] <= 0)
			continue;
		double away = away_m(r.frame->scene, i), part = CLAMP((away - 1) / 2, 0, 1);
		double left = (double)before[i] * (1 - part * part * (3 - 2 * part));
		within += away < 1;
		between += away > 1 && away < 3;
		g_assert_cmpfloat(fabs((double)now[i] - left), <=, 1.01 / 255);
	}
	g_assert_cmpuint(within, >, 50);
	g_assert_cmpuint(between, >, 50);
}

static struct shares far_of(const frame *f, double *ret_length_px)
{
	struct shares sum = { 0, 0 };
	stroke_list *l = strokes_of(f, true);
	*ret_length_px = 0;
	for (uint32_t i = 0; i < l->count; i++) {
		const struct stroke *s = &l->stroke[i];
		if (away_m(f->scene, s->point) < 3.1)
			continue;
		sum.ground += (double)s->alpha;
		*ret_length_px += (double)(s->alpha * s->half_length_px);
	}
	*ret_length_px /= sum.ground;
	stroke_lists_free(l, f->layers);
	return sum;
}

/* Far away: a quarter of the strokes, twice as large. */
static void test_focus_abstracts(void)
{
	g_auto(room) r = room_of(120, 120, EVEN);
	double before_px, now_px;
	struct shares before = far_of(r.frame, &before_px);
	focus_on_wall(r.frame, 0, 1);
	struct shares now = far_of(r.frame, &now_px);
	g_assert_cmpfloat(before.ground, >, 400);
	assert_alike(now.ground * 4, before.ground);
	assert_alike(now_px * 200, before_px * 400);
}

/* Coloured points become paper. */
static void test_focus_points(void)
{
	static const double edge_m[3] = { 0.6, 0.6, 0 };
	g_auto(room) r = room_of(100, 100, POINTS);
	focus_on_wall(r.frame, 1, 0);
	struct picture_buffer p = made_picture(r.frame);
	g_assert_cmpint(abs(pixel_of(r.frame, &p, on_wall_m)[0] - 100), <=, 2);
	g_assert_cmpint(pixel_of(r.frame, &p, edge_m)[0], ==, 255);
	picture_buffer_clear(&p);
}

/* A focus that moves by 2 cm changes no stroke by much. */
static void test_focus_moves(void)
{
	g_auto(room) r = room_of(120, 120, EVEN);
	struct style_focus focus = { 1, 1, 1, 2, 3, 6, 2 };
	frame_set_focus(r.frame, &focus);
	g_autofree float *before = alphas_of(r.frame);
	for (int n = 1; n < 20; n++) {
		focus.x_m = 3 - 0.02f * (float)n;
		frame_set_focus(r.frame, &focus);
		g_autofree float *now = alphas_of(r.frame);
		for (uint32_t i = 0; i < r.frame->scene->count; i++)
			g_assert_cmpfloat(fabsf(now[i] - before[i]), <=, 0.1f);
		memcpy(before, now, r.frame->scene->count * sizeof *before);
	}
}

/* ---- both ---- */

/* With whatever vectors. */
static void test_lanes(gconstpointer nodes)
{
	g_auto(room) r = room_of(120, 160, nodes);
	light_from_south(r.frame, 0.7, 20);
	focus_on_wall(r.frame, 0.7, 1);
	struct picture_buffer a = made_picture(r.frame);
	for (enum lanes_path path = 0; path < lanes_path_widest(); path++) {
		r.frame->lanes = path;
		struct picture_buffer b = made_picture(r.frame);
		made_assert_same(&a, &b);
		picture_buffer_clear(&b);
	}
	picture_buffer_clear(&a);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_data_func("/light/tone", TONES("surface"), test_tone);
	g_test_add_data_func("/light/tone-all", TONES("all"), test_tone);
	g_test_add_data_func("/light/tone-queue", TONES("dithering"), test_tone);
	g_test_add_func("/light/omitted", test_omitted);
	g_test_add_func("/light/paint", test_paint);
	g_test_add_func("/light/points", test_points);
	g_test_add_func("/light/moves", test_light_moves);
	g_test_add_func("/focus/fades", test_focus_fades);
	g_test_add_func("/focus/abstracts", test_focus_abstracts);
	g_test_add_func("/focus/points", test_focus_points);
	g_test_add_func("/focus/moves", test_focus_moves);
	g_test_add_data_func("/light-focus/lanes/tones", TONES("all"), test_lanes);
	g_test_add_data_func("/light-focus/lanes/even", EVEN, test_lanes);
	g_test_add_data_func("/light-focus/lanes/paint", PAINT, test_lanes);
	g_test_add_data_func("/light-focus/lanes/points", POINTS, test_lanes);
	return g_test_run();
}
