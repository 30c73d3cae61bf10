/* Which points become strokes, along what, and whether they stay from frame to frame. */
#include "render/gles-shaders.h"
#include "tests/strokes-made.h"

/* ---- from frame to frame ---- */

/* Ground and a wall behind it, with an edge between them: from before it nothing of them is hidden. */
static void add_corner(made *m)
{
	struct made_plane ground = { .corner_m = { -3, -4, -1.5 },
		.a_m = { 6, 0, 0 },
		.b_m = { 0, 4, 0 },
		.apart_m = 0.012,
		.order = MADE_JITTERED,
		.rgba = { 70, 80, 60, 255 },
		.dithered = true };
	struct made_plane wall = { .corner_m = { -3, 0, -1.5 },
		.a_m = { 6, 0, 0 },
		.b_m = { 0, 0, 3 },
		.apart_m = 0.012,
		.order = MADE_JITTERED,
		.rgba = { 110, 100, 90, 255 },
		.dithered = true };
	static const double left[3] = { -3, 0, -1.5 }, right[3] = { 3, 0, -1.5 };
	static const float south[3] = { 0, -1, 0 };
	made_add_plane(m, &ground);
	made_add_plane(m, &wall);
	made_add_edge(m, left, right, south, 0.012);
}

static struct camera dolly_at(double part)
{
	static const double target[3] = { 0, 0, -0.5 };
	double near = exp2(-part);
	double eye[3] = { 1.2 * near, -6 * near, -0.5 + 1.5 * near };
	return camera_look_at(eye, target, 50, 400, HEIGHT);
}

static struct camera orbit_at(double part)
{
	static const double target[3] = { 0, 0, -0.5 };
	double a = (part * 20 - 50) * G_PI / 180;
	double eye[3] = { 5 * sin(a), -5 * cos(a), 0.8 };
	return camera_look_at(eye, target, 50, 400, HEIGHT);
}

static struct camera pan_at(double part)
{
	struct camera c = dolly_at(0);
	return camera_turned(&c, (part - 0.5) * 40 * atan(8 * HEIGHT / 1080. / c.focal_px));
}

static const struct way {
	const char *name;
	struct camera (*at)(double part);
} ways[] = { { "dolly", dolly_at }, { "orbit", orbit_at }, { "pan", pan_at } };

#define COPIES 16

/* Of each layer, point and copy: what it was drawn with; 0: it was not. */
static float **alphas_of(const frame *f)
{
	float **alpha = g_new0(float *, f->layers + 1);
	stroke_list *l = strokes_of(f, true);
	for (uint32_t n = 0; n < f->layers; n++) {
		alpha[n] = g_new0(float, (size_t)f->scene->count *COPIES);
		for (uint32_t i = 0; i < l[n].count; i++) {
			const struct stroke *one = &l[n].stroke[i];
			float *at = &alpha[n][(size_t)one->point * COPIES + one->copy];
			g_assert_cmpuint(one->copy, <, COPIES);
			g_assert_cmpfloat(*at, ==, 0);
			*at = one->alpha;
		}
	}
	stroke_lists_free(l, f->layers);
	return alpha;
}

static void alphas_free(float **alpha, uint32_t layers)
{
	for (uint32_t n = 0; n < layers; n++)
		g_free(alpha[n]);
	g_free(alpha);
}

struct change {
	size_t drawn, survived, jumped;
	double step_most;
};

/* How far from their points strokes may be. */
#define MOVED_PX 20

static bool is_inside(const struct camera *c, const double at[3])
{
	double px[2], depth_m;
	return camera_project(c, at, px, &depth_m) && px[0] >= MOVED_PX && px[1] >= MOVED_PX &&
	       px[0] < c->width - MOVED_PX && px[1] < c->height - MOVED_PX;
}

static void compare(const frame *f, const struct camera *was, float *const *before,
	float *const *now, struct change *ret)
{
	const scene *s = f->scene;
	for (uint32_t n = 0; n < s->chunks; n++)
		for (uint32_t i = 0; i < s->chunk[n].count; i++) {
			double at[3];
			uint32_t point = s->chunk[n].first + i;
			scene_position(s, &s->chunk[n], i, at);
			if (!is_inside(was, at) || !is_inside(&f->camera, at))
				continue;
			for (uint32_t l = 0; l < f->layers * COPIES; l++) {
				size_t one = (size_t)point * COPIES + l % COPIES;
				float a = before[l / COPIES][one], b = now[l / COPIES][one],
				      step = fabsf(a - b);
				ret->drawn += a > 0.02f;
				ret->survived += a > 0.02f && b > 0;
				ret->jumped += step > 0.15f;
				ret->step_most = fmax(ret->step_most, (double)step);
			}
		}
}

#define FRAMES 40

/* Nothing is hidden here: what was drawn stays, and comes and goes softly. */
static void test_stays(gconstpointer data)
{
	const struct way *w = data;
	g_auto(made) m = made_new();
	add_corner(&m);
	const scene *s = made_read(&m);
	g_autoptr(drawing) d = made_drawing(
		MADE_SITE("{\"step\":\"lines\",\"points\":\"dithering\",\"tone\":\"colour\","
			  "\"spacing_px\":20," STEADY "},"
			  "{\"step\":\"sprites\",\"points\":\"surface\",\"spacing_px\":24," STEADY
			  "},{\"step\":\"strokes\",\"spacing_px\":36," STEADY "}"));
	struct camera c = w->at(0);
	struct change change = { 0 };
	g_autoptr(frame) f = made_frame(s, d, &c);
	float **before = alphas_of(f);
	for (int n = 1; n <= FRAMES; n++) {
		struct camera next = w->at((double)n / FRAMES);
		g_assert_true(frame_move(f, &next, NULL));
		float **now = alphas_of(f);
		compare(f, &c, before, now, &change);
		alphas_free(before, f->layers);
		before = now;
		c = next;
	}
	alphas_free(before, f->layers);
	g_test_message("%s: %zu drawn, %.5f survive, steps up to %.3f, %zu above 0.15", w->name,
		change.drawn, (double)change.survived / (double)change.drawn, change.step_most,
		change.jumped);
	g_assert_cmpuint(change.drawn, >, 100000);
	g_assert_cmpfloat((double)change.survived, >=, 0.9995 * (double)change.drawn);
	g_assert_cmpfloat(change.step_most, <=, 0.15);
}

/* ---- which points ---- */

enum {
	NONE = 1 << FEATURE_NONE,
	DITHER = 1 << FEATURE_DITHER,
	UNDIRECTED = 1 << FEATURE_UNDIRECTED,
	DIRECTED = 1 << FEATURE_DIRECTED
};

static const struct choice {
	const char *points, *tone;
	unsigned kinds;
} choices[] = {
	{ "all", "even", NONE | DITHER | UNDIRECTED | DIRECTED },
	{ "surface", "even", NONE | DITHER },
	{ "features", "even", UNDIRECTED | DIRECTED },
	{ "directional", "even", DIRECTED },
	{ "non-directional", "even", UNDIRECTED },
	{ "dithering", "even", DITHER },
	{ "dithering", "colour", NONE | DITHER | UNDIRECTED | DIRECTED },
	{ "features", "colour", UNDIRECTED | DIRECTED },
};

static void test_kinds(gconstpointer data)
{
	const struct choice *choice = data;
	g_auto(made) m = made_court();
	const scene *s = made_read(&m);
	g_autofree char *nodes =
		g_strdup_printf(MADE_SITE("{\"step\":\"lines\",\"points\":\"%s\",\"tone\":\"%s\","
					  "\"spacing_px\":4}"),
			choice->points, choice->tone);
	g_autoptr(drawing) d = made_drawing(nodes);
	static const double eye[3] = { 103, 195, 6 }, target[3] = { 103, 204, 4 };
	struct camera c = camera_look_at(eye, target, 60, 400, HEIGHT);
	g_autoptr(frame) f = made_frame(s, d, &c);
	stroke_list *l = strokes_of(f, true);
	unsigned kinds = 0;
	for (uint32_t n = 0; n < l->count; n++) {
		g_assert_cmpfloat(l->stroke[n].alpha, >, 0);
		g_assert_cmpfloat(l->stroke[n].alpha, <=, 1);
		kinds |= 1u << s->kind[l->stroke[n].point];
	}
	g_assert_cmphex(kinds, ==, choice->kinds);
	stroke_lists_free(l, f->layers);
}

/* ---- by lists ---- */

static int compare_packed(gconstpointer a, gconstpointer b)
{
	return memcmp(a, b, sizeof(struct stroke_packed));
}

/* In an order of their own. */
static GArray *packed_strokes(const frame *f)
{
	GArray *ret = g_array_new(FALSE, FALSE, sizeof(struct stroke_packed));
	stroke_list *l = strokes_of(f, true);
	for (uint32_t n = 0; n < l->count; n++) {
		struct stroke_packed one = stroke_pack(&l->stroke[n]);
		g_array_append_val(ret, one);
	}
	g_array_sort(ret, compare_packed);
	stroke_lists_free(l, f->layers);
	return ret;
}

/* So that what is asked for by a key is all that there is. */
static void spoil_lists(const scene *s)
{
	for (uint32_t n = 0; n < s->chunks; n++) {
		struct scene_chunk *c = &s->chunk[n];
		for (int kind = 0; kind < FEATURE_KINDS; kind++)
			for (int tone = 0; tone < SCENE_LIST_TONES; tone++)
				for (int step = 0; step < SCENE_LIST_STEPS; step++)
					c->list_ends->end[kind][tone][step] =
						c->list_ends->end[kind][tone][SCENE_LIST_STEPS - 1];
	}
}

/* Lists leave out nothing that is drawn, from near or far. */
static void test_lists(gconstpointer data)
{
	const struct choice *choice = data;
	g_autofree char *nodes =
		g_strdup_printf(MADE_SITE("{\"step\":\"lines\",\"points\":\"%s\",\"tone\":\"%s\","
					  "\"spacing_px\":3}"),
			choice->points, choice->tone);
	g_autoptr(drawing) d = made_drawing(nodes);
	for (double away_m = 4; away_m < 300; away_m *= 2) {
		g_auto(made) m = made_court();
		const scene *s = made_read(&m);
		double eye[3] = { 103, 204 - away_m, 6 }, target[3] = { 103, 204, 4 };
		struct camera c = camera_look_at(eye, target, 60, 400, HEIGHT);
		g_autoptr(frame) f = made_frame(s, d, &c);
		g_autoptr(GArray) some = packed_strokes(f);
		spoil_lists(s);
		g_autoptr(GArray) all = packed_strokes(f);
		g_assert_cmpmem(some->data, some->len * sizeof(struct stroke_packed), all->data,
			all->len * sizeof(struct stroke_packed));
		g_assert_cmpuint(all->len, >, 0);
	}
}

/* ---- along what ---- */

/* Points whose lines go anywhere, around the origin. */
static void add_lines(made *m, int count)
{
	for (int n = 0; n < count; n++) {
		struct made_point p = { .rgba = { 1, 2, 3, 255 },
			.kind = FEATURE_DIRECTED,
			.degree = 255,
			.leaf = MADE_LEAF,
			.apart_m = 2 };
		for (int k = 0; k < 3; k++) {
			p.at_m[k] = g_rand_double_range(m->chance, -2, 2);
			p.direction[k] = (float)g_rand_double_range(m->chance, -1, 1);
			p.normal[k] = (float)g_rand_double_range(m->chance, -1, 1);
		}
		g_array_append_val(m->points, p);
	}
}

static uint32_t chunk_with(const scene *s, uint32_t point)
{
	uint32_t n = 0;
	while (point >= s->chunk[n].first + s->chunk[n].count)
		n++;
	return n;
}

/* Degrees between the stroke and a millimetre of its line as it is projected; -1: the line points at the eye. */
static double off_line_deg(const frame *f, const struct stroke *s)
{
	const struct scene_chunk *c = &f->scene->chunk[chunk_with(f->scene, s->point)];
	double at[3], from[2] = { 0 }, to[2] = { 0 }, depth_m = 1;
	float line[3];
	scene_position(f->scene, c, s->point - c->first, at);
	model_unpack_normal(f->scene->direction[s->point], line);
	g_assert_true(camera_project(&f->camera, at, from, &depth_m));
	for (int k = 0; k < 3; k++)
		at[k] += 1e-4 * (double)line[k];
	g_assert_true(camera_project(&f->camera, at, to, &depth_m));
	double x = to[0] - from[0], y = to[1] - from[1];
	if (hypot(x, y) < 0.05 * 1e-4 * f->camera.focal_px / depth_m)
		return -1;
	double cross = x * (double)s->along[1] - y * (double)s->along[0];
	double dot = x * (double)s->along[0] + y * (double)s->along[1];
	return atan2(fabs(cross), fabs(dot)) * 180 / G_PI;
}

static void test_directions(void)
{
	g_auto(made) m = made_new();
	add_lines(&m, 4000);
	const scene *s = made_read(&m);
	g_autoptr(drawing) d = made_drawing(
		MADE_SITE("{\"step\":\"strokes\",\"angle_variation_deg\":0},"
			  "{\"step\":\"lines\",\"points\":\"directional\",\"direction\":\"edge\","
			  "\"angle_variation_deg\":0}"));
	static const double eye[3] = { 0.3, -6, 1 }, target[3] = { 0, 0, 0 };
	struct camera c = camera_look_at(eye, target, 70, 400, HEIGHT);
	g_autoptr(frame) f = made_frame(s, d, &c);
	stroke_list *l = strokes_of(f, false);
	double worst = 0;
	for (uint32_t k = 0; k < 2; k++) {
		g_assert_cmpuint(l[k].count, >, 500);
		for (uint32_t n = 0; n < l[k].count; n++)
			worst = fmax(worst, off_line_deg(f, &l[k].stroke[n]));
	}
	g_test_message("%u strokes, up to %.3f degrees off", l[0].count, worst);
	g_assert_cmpfloat(worst, <=, 0.5);
	stroke_lists_free(l, f->layers);
}

/* At an angle of the style, counterclockwise from the right. */
static void test_screen_angle(void)
{
	g_auto(made) m = made_court();
	const scene *s = made_read(&m);
	g_autoptr(drawing) d = made_drawing(MADE_SITE(
		"{\"step\":\"lines\",\"points\":\"all\",\"direction\":\"screen\",\"angle_deg\":30,"
		"\"angle_variation_deg\":0,\"length_variation\":0,\"length_px\":20,\"grow\":1}"));
	static const double eye[3] = { 103, 195, 6 }, target[3] = { 103, 204, 4 };
	struct camera c = camera_look_at(eye, target, 60, 400, HEIGHT);
	g_autoptr(frame) f = made_frame(s, d, &c);
	stroke_list *l = strokes_of(f, true);
	g_assert_cmpuint(l->count, >, 100);
	for (uint32_t n = 0; n < l->count; n++) {
		g_assert_cmpfloat(
			fabs((double)(l->stroke[n].along[0] * l->stroke[n].half_length_px) -
				2.5 * cos(G_PI / 6)),
			<, 1e-3);
		g_assert_cmpfloat(
			fabs((double)(l->stroke[n].along[1] * l->stroke[n].half_length_px) +
				2.5 * sin(G_PI / 6)),
			<, 1e-3);
	}
	stroke_lists_free(l, f->layers);
}

/* ---- in nine words ---- */

static void assert_packed_well(const struct stroke *s)
{
	struct stroke_packed packed = stroke_pack(s);
	struct stroke is = stroke_unpack(&packed);
	g_assert_true(is.x_px == s->x_px && is.y_px == s->y_px && is.q == s->q);
	g_assert_true(fabsf(is.half_length_px / s->half_length_px - 1) <= 1 / 4096.f);
	g_assert_true(fabsf(is.half_width_px / s->half_width_px - 1) <= 1 / 4096.f);
	g_assert_true(fabsf(is.alpha - s->alpha) <= 0.5f / STROKE_ALPHA);
	for (int k = 0; k < 2; k++) {
		g_assert_true(fabsf(is.along[k] - s->along[k]) <= 0.51f / STROKE_ALONG);
		g_assert_true(fabsf(is.slope[k] - s->slope[k]) <= fabsf(s->slope[k]) * (1 / 256.f));
	}
	g_assert_cmpmem(is.rgb, 3, s->rgb, 3);
	g_assert_true(is.copy == s->copy && is.point == s->point && is.lay == s->lay &&
		      is.aslant == s->aslant);
}

static float any_between(GRand *chance, double low, double high)
{
	return (float)g_rand_double_range(chance, low, high);
}

static void test_pack(void)
{
	g_autoptr(GRand) chance = g_rand_new_with_seed(15);
	struct stroke ends = { .along = { -1, 1 },
		.half_length_px = 0.001f,
		.half_width_px = 4e6f,
		.alpha = 1,
		.slope = { -0.f, 1e9f },
		.rgb = { 255, 0, 255 },
		.copy = 255,
		.point = UINT32_MAX,
		.lay = 255,
		.aslant = 255 };
	assert_packed_well(&ends);
	for (int n = 0; n < 100000; n++) {
		float turn = any_between(chance, 0, 2 * G_PI);
		uint32_t bytes = g_rand_int(chance);
		struct stroke s = { .x_px = any_between(chance, -1e5, 1e5),
			.y_px = any_between(chance, -1, 1),
			.along = { cosf(turn), sinf(turn) },
			.half_length_px = exp2f(any_between(chance, -9.9, 20)),
			.half_width_px = exp2f(any_between(chance, -9.9, 20)),
			.alpha = any_between(chance, 0, 1),
			.q = exp2f(any_between(chance, -20, 20)),
			.slope = { any_between(chance, -1, 1), exp2f(any_between(chance, -30, 9)) },
			.rgb = { (uint8_t)bytes, (uint8_t)(bytes >> 8), 7 },
			.copy = (uint8_t)(bytes >> 16),
			.point = g_rand_int(chance),
			.lay = (uint8_t)(bytes >> 24),
			.aslant = (uint8_t)(bytes >> 4) };
		assert_packed_well(&s);
	}
	/* What is too short for it is as short as it can be; no length of 0 divides anything. */
	struct stroke none = { .along = { 1, 0 }, .q = 1 };
	struct stroke_packed packed = stroke_pack(&none);
	g_assert_cmpfloat(stroke_unpack(&packed).half_width_px, ==, 1 / 1024.f);
}

/* ---- rows that they touch ---- */

static void assert_span(const struct stroke_block *b, uint32_t n, uint32_t height)
{
	struct stroke s = stroke_unpack(&b->stroke[n]);
	float reach = fabsf(s.along[1]) * s.half_length_px + fabsf(s.along[0]) * s.half_width_px;
	int top = b->span[n].top - STROKE_SPAN_ABOVE, end = b->span[n].end - STROKE_SPAN_ABOVE;
	if (s.y_px + reach < 0 || s.y_px - reach > (float)height)
		return;
	g_assert_true((float)top <= fmaxf(s.y_px - reach, -STROKE_SPAN_ABOVE));
	g_assert_true((float)end > s.y_px + reach);
	g_assert_true((float)(end - top) < 2 * reach + 5);
}

/* Of the highest picture there may be, down to its last row. */
static void test_spans(void)
{
	static const double eye[3] = { 103, 202, 4 }, target[3] = { 103, 204, 4 };
	g_auto(made) m = made_court();
	g_autoptr(drawing) d =
		made_drawing(MADE_SITE("{\"step\":\"strokes\",\"points\":\"all\",\"length_px\":4,"
				       "\"angle_deg\":30,\"spacing_px\":1}"));
	struct camera c = camera_look_at(eye, target, 60, 20000, CAMERA_SIDE_MAX);
	g_autoptr(frame) f = made_frame(made_read(&m), d, &c);
	g_autoptr(stroke_room) room = stroke_room_new();
	uint32_t count, low = 0;
	g_autofree struct chunk_view *views = chunk_views_new(f, &count);
	const struct stroke_blocks *all = stroke_room_fill(room, f, NULL, views, count);
	for (uint32_t k = 0; k < all->blocks; k++)
		for (uint32_t n = 0; n < all->block[k]->count; n++) {
			assert_span(all->block[k], n, CAMERA_SIDE_MAX);
			low += all->block[k]->span[n].end > CAMERA_SIDE_MAX - 400;
		}
	g_test_message("%u strokes, %u of them at the lower end", all->count, low);
	g_assert_cmpuint(low, >, 0);
}

/* ---- what has no direction, no normal, no size ---- */

static bool is_sound(const struct stroke *s)
{
	return isfinite(s->x_px) && isfinite(s->y_px) && isfinite(s->along[0]) &&
	       isfinite(s->along[1]) && isfinite(s->half_length_px) && isfinite(s->half_width_px) &&
	       isfinite(s->alpha) && isfinite(s->q) && isfinite(s->slope[0]) &&
	       isfinite(s->slope[1]) && s->alpha > 0 && s->alpha <= 1;
}

/* Lines that point at the eye, or have no direction; surfaces seen from the side, or without a normal; points at the near plane. */
static void add_odd(made *m, const double eye[3])
{
	for (int n = 0; n < 3000; n++) {
		struct made_point p = { .kind = (uint8_t)(n % FEATURE_KINDS),
			.leaf = MADE_LEAF,
			.rgba = { 0, 0, 0, n % 3 ? 255 : 0 },
			.apart_m = 1 };
		double away = n % 7 ? g_rand_double_range(m->chance, 0.1, 3) : 0.1;
		p.at_m[0] = eye[0] + g_rand_double_range(m->chance, -1, 1) * away;
		p.at_m[1] = eye[1] + away;
		p.at_m[2] = eye[2] + g_rand_double_range(m->chance, -1, 1) * away;
		for (int k = 0; k < 3; k++) {
			p.direction[k] = n / 4 % 3 ? (float)(p.at_m[k] - eye[k]) : 0;
			p.normal[k] = n / 12 % 3 == 0   ? 0
				      : n / 12 % 3 == 1 ? (float)(k == 2)
							: (float)(p.at_m[k] - eye[k]);
		}
		g_array_append_val(m->points, p);
	}
}

static void test_odd(void)
{
	static const double eye[3] = { 5, 5, 5 }, target[3] = { 5, 15, 5 };
	g_auto(made) m = made_new();
	add_odd(&m, eye);
	const scene *s = made_read(&m);
	g_autoptr(drawing) d = made_drawing(
		MADE_SITE("{\"step\":\"strokes\",\"points\":\"all\",\"length_variation\":1},"
			  "{\"step\":\"sprites\",\"points\":\"all\",\"tone\":\"colour\"},"
			  "{\"step\":\"lines\",\"points\":\"all\",\"direction\":\"edge\"},"
			  "{\"step\":\"points\"},{\"step\":\"edl\"}"));
	struct camera c = camera_look_at(eye, target, 80, 400, HEIGHT);
	g_autoptr(frame) f = made_frame(s, d, &c);
	for (int masked = 0; masked < 2; masked++) {
		stroke_list *l = strokes_of(f, masked);
		for (uint32_t k = 0; k < f->layers; k++) {
			g_assert_cmpuint(l[k].count, >, 50);
			for (uint32_t n = 0; n < l[k].count; n++)
				g_assert_true(is_sound(&l[k].stroke[n]));
		}
		stroke_lists_free(l, f->layers);
	}
	struct picture_buffer picture = made_picture(f);
	picture_buffer_clear(&picture);
}

static double mean_fade(float octaves)
{
	double sum = 0;
	for (int n = 0; n < 100000; n++)
		sum += (double)stroke_fade((float)(n + 0.5) / 100000, 1, octaves);
	return sum / 100000;
}

/* The mean of it over all ranks is what densities are divided by. */
static void test_fade(void)
{
	g_assert_cmpfloat(fabs(mean_fade(1) - (double)STROKE_FADE_MEAN), <, 1e-3);
	for (float octaves = 1; octaves <= STROKE_FADE_MOST; octaves += 0.25f)
		g_assert_cmpfloat(fabs((double)STROKE_FADE_MORE(octaves) * mean_fade(octaves) /
						  (double)STROKE_FADE_MEAN -
					  1),
			<, 1e-3);
	g_assert_cmpfloat(stroke_fade(0.5f, 1, 1), ==, 1);
	g_assert_cmpfloat(stroke_fade(0.5f, 1, 2), ==, 0.5f);
	g_assert_cmpfloat(stroke_fade(1, 1, 1), ==, 0);
	g_assert_cmpfloat(stroke_fade(0.01f, 0, 1), ==, 0);
	g_assert_cmpfloat(stroke_fade_octaves(100), ==, 1);
	g_assert_cmpfloat(stroke_fade_octaves(1e-3f), ==, STROKE_FADE_MOST);
}

/* What parity would forgive: the shader fades as strokes do, by the same numbers. */
static void test_fade_of_shader(void)
{
	g_autofree char *numbers = g_strdup_printf("FADE_NEAR_M = %g, FADE_MOST = %g;",
		(double)STROKE_FADE_NEAR_M, (double)STROKE_FADE_MOST);
	g_assert_nonnull(strstr(gles_shader_find("choose"), numbers));
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/stroke/fade", test_fade);
	g_test_add_func("/stroke/fade-of-shader", test_fade_of_shader);
	for (size_t i = 0; i < G_N_ELEMENTS(ways); i++) {
		g_autofree char *path = g_strconcat("/stroke/stays/", ways[i].name, NULL);
		g_test_add_data_func(path, &ways[i], test_stays);
	}
	for (size_t i = 0; i < G_N_ELEMENTS(choices); i++) {
		g_autofree char *path = g_strdup_printf("/stroke/kinds/%zu", i);
		g_test_add_data_func(path, &choices[i], test_kinds);
		g_autofree char *lists = g_strdup_printf("/stroke/lists/%zu", i);
		g_test_add_data_func(lists, &choices[i], test_lists);
	}
	g_test_add_func("/stroke/directions", test_directions);
	g_test_add_func("/stroke/screen-angle", test_screen_angle);
	g_test_add_func("/stroke/pack", test_pack);
	g_test_add_func("/stroke/spans", test_spans);
	g_test_add_func("/stroke/odd", test_odd);
	return g_test_run();
}
