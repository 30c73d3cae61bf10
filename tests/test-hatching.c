/* Hatching of a ball and of a wall, whose truth is known: how dark it becomes, where its strokes lie, which of them a light takes away. */
#include "render/bench-reproject.h"
#include "render/light.h"
#include "render/vector-page.h"
#include "tests/strokes-made.h"

#define SIDE   1024u
#define RADIUS 1.0
#define COUNT  400000u

/* Seen from a metre and a half before it, from y < 0; the light from the left above. */
static const double ball_m[3] = { 100, 200, 3 };

static struct camera before_ball(double away_m, uint32_t side)
{
	double eye[3] = { ball_m[0], ball_m[1] - away_m, ball_m[2] };
	return camera_look_at(eye, ball_m, 2 * atan(1.25 / 3) * 180 / G_PI, side, side);
}

static const scene *shared_ball(void)
{
	static made m;
	static const uint8_t no_colour[4] = { 0 };
	if (!m.scene) {
		m = made_new();
		made_add_sphere(&m, ball_m, RADIUS, COUNT, no_colour);
		made_read(&m);
		files_remove_tree(m.folder, NULL); /* it stays mapped */
	}
	return m.scene;
}

#define LIT "\"light\":{\"amount\":1,\"azimuth_deg\":235,\"elevation_deg\":35},"

/* Backs hidden. step: more fields of the only one. */
static drawing *hatching(const char *sections, const char *step)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *text = g_strdup_printf(
		"{\"schema\":1,\"paper\":{\"colour\":\"#ffffff\",\"grain\":0},%s\"segments\":{"
		"\"site\":{\"steps\":[{\"step\":\"mask\",\"backs\":\"hidden\"},"
		"{\"step\":\"hatching\",\"own_tone\":0,\"ink\":\"#000000\"," STEADY "%s%s}]}}}",
		sections, *step ? "," : "", step);
	g_autoptr(style) s = style_parse(text, -1, "made.json", &error);
	g_assert_no_error(error);
	drawing *d = drawing_new(s, NULL, NULL, &error);
	g_assert_no_error(error);
	return d;
}

/* ---- how dark ---- */

/* Where the ray through a pixel's middle meets the ball: its normal; false: it does not. */
static bool normal_at(const struct camera *c, uint32_t x, uint32_t y, double ret[3])
{
	double ray[3], place[2] = { x + 0.5, y + 0.5 }, b = 0, q = -RADIUS * RADIUS, a = 0;
	camera_ray(c, place, ray);
	for (int k = 0; k < 3; k++) {
		double from = c->eye_m[k] - ball_m[k];
		a += ray[k] * ray[k];
		b += ray[k] * from;
		q += from * from;
	}
	double root = b * b - a * q;
	if (root <= 0)
		return false;
	double t = (-b - sqrt(root)) / a;
	for (int k = 0; k < 3; k++)
		ret[k] = (c->eye_m[k] + t * ray[k] - ball_m[k]) / RADIUS;
	return true;
}

struct tile {
	double wanted, drawn; /* sums of light */
	uint32_t inside;
};

/* In sRGB: root of the mean square over the tiles of 64 pixels that the ball covers whole; wanted tells lightness of a brightness. */
static double tone_error(const frame *f, double (*wanted)(double brightness))
{
	enum { TILE = 64, TILES = SIDE / TILE };
	static struct tile tile[TILES][TILES];
	struct picture_buffer p = made_picture(f);
	double sum = 0, normal[3];
	int tiles = 0;
	memset(tile, 0, sizeof tile);
	for (uint32_t n = 0; n < SIDE * SIDE; n++) {
		struct tile *t = &tile[n / SIDE / TILE][n % SIDE / TILE];
		if (!normal_at(&f->camera, n % SIDE, n / SIDE, normal))
			continue;
		double lit = 0;
		for (int k = 0; k < 3; k++)
			lit += normal[k] * f->light.site_from[k];
		t->wanted += (double)light_of_srgb((float)wanted(0.5 + 0.5 * lit));
		t->drawn += (double)light_of_srgb((float)p.rgba[n][1] / 255);
		t->inside++;
	}
	for (int n = 0; n < TILES * TILES; n++) {
		const struct tile *t = &tile[n / TILES][n % TILES];
		if (t->inside < TILE * TILE)
			continue;
		double away = (double)light_to_srgb((float)(t->drawn / t->inside)) -
			      (double)light_to_srgb((float)(t->wanted / t->inside));
		sum += away * away;
		tiles++;
	}
	picture_buffer_clear(&p);
	g_assert_cmpint(tiles, >, 60);
	return sqrt(sum / tiles);
}

/* Stops of even steps from 0.9 to nothing. */
#define RAMP                                                                                       \
	"\"tone_by\":\"darkness\",\"xtoon\":[{\"brightness\":0,\"chance\":0.9},{\"brightness\":1," \
	"\"chance\":0}]"

static double as_the_ramp(double brightness)
{
	return 1 - 0.9 * (1 - brightness);
}

static void test_tone(void)
{
	static const struct {
		const char *name, *step;
	} how[] = {
		{ "thin lines", RAMP ",\"pressure\":0,\"texture\":\"line\",\"width_px\":1.2,"
				     "\"spacing_px\":1.2" },
		{ "crossed pencil", RAMP ",\"cross\":0.8,\"width_px\":2.5,\"spacing_px\":1.4" },
		{ "pressed ink",
			RAMP ",\"texture\":\"ink-pen\",\"pressure\":0.6,\"spacing_px\":1.5" },
		{ "dots", RAMP ",\"texture\":\"dot\",\"length_px\":3,\"width_px\":3,"
			       "\"curvature\":0,\"spacing_px\":1" },
	};
	struct camera c = before_ball(3, SIDE);
	for (size_t n = 0; n < G_N_ELEMENTS(how); n++) {
		g_autoptr(drawing) d = hatching(LIT, how[n].step);
		g_autoptr(frame) f = made_frame(shared_ball(), d, &c);
		double rms = tone_error(f, as_the_ramp);
		g_test_message("%s: tiles are off by %.4f", how[n].name, rms);
		g_assert_cmpfloat(rms, <=, 0.04);
	}
}

/* ---- the same everywhere ---- */

static void test_lanes(void)
{
	struct camera c = before_ball(2.2, 300);
	g_autoptr(drawing) d = hatching(LIT,
		"\"cross\":0.7,\"follows\":\"curvature\",\"colouring\":\"blend\",\"shine\":0.5,"
		"\"pencils\":[\"#ff0000\",\"#00ff00\",\"#0000ff\"],\"hue_shift_deg\":30");
	g_autoptr(frame) f = made_frame(shared_ball(), d, &c);
	made_assert_same_on_any(f);
}

/* ---- where strokes lie ---- */

static void turned(const struct camera *c, const float v[3], double ret[3])
{
	const double *row[3] = { c->right, c->down, c->forward };
	for (int k = 0; k < 3; k++)
		ret[k] = row[k][0] * (double)v[0] + row[k][1] * (double)v[1] +
			 row[k][2] * (double)v[2];
}

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void to_unit(double v[3])
{
	double length = made_length(v);
	for (int k = 0; k < 3; k++)
		v[k] /= length;
}

/* Unit, as the camera sees it: along the stroke in space, told by how its depth goes. */
static void way_of(const struct camera *c, const struct stroke *s, double ret[3])
{
	double q = (double)s->q, focal = c->focal_px;
	double ray[3] = { ((double)s->x_px - c->width / 2.0) / focal,
		((double)s->y_px - c->height / 2.0) / focal, 1 };
	double by = (double)(s->slope[0] * s->along[0] + s->slope[1] * s->along[1]);
	for (int k = 0; k < 3; k++)
		ret[k] = (k < 2 ? (double)s->along[k] / focal : 0) / q - ray[k] * by / (q * q);
	to_unit(ret);
}

static void normal_of(const frame *f, const struct stroke *s, double ret[3])
{
	float out[3];
	model_unpack_normal(f->scene->normal[s->point], out);
	turned(&f->camera, out, ret);
	to_unit(ret);
}

/* In their planes, along the projected vector, the second ones across. */
static void test_planes(void)
{
	struct camera c = before_ball(3, 600);
	g_autoptr(drawing) d =
		hatching("", "\"cross\":1,\"angle_variation_deg\":0,\"line_azimuth_deg\":90,"
			     "\"line_elevation_deg\":0,\"xtoon\":[{\"brightness\":0}]");
	g_autoptr(frame) f = made_frame(shared_ball(), d, &c);
	stroke_list *l = strokes_of(f, true);
	static const float east[3] = { 1, 0, 0 };
	double way[3], normal[3], along[3];
	uint32_t second = 0, looked_at = 0;
	for (uint32_t n = 0; n < l->count; n++) {
		const struct stroke *s = &l->stroke[n];
		way_of(&c, s, way);
		normal_of(f, s, normal);
		turned(&c, east, along);
		double up = dot(along, normal);
		second += s->copy & 1;
		/* Copies stand in for others, beside; and no depth goes steeper than a stroke may. */
		if (fabs(up) > 0.95 || s->copy > 1 || normal[2] > -0.4)
			continue;
		for (int k = 0; k < 3; k++)
			along[k] -= up * normal[k];
		to_unit(along);
		looked_at++;
		g_assert_cmpfloat(fabs(dot(way, normal)), <=, 0.02);
		g_assert_cmpfloat(fabs(fabs(dot(way, along)) - !(s->copy & 1)), <=, 0.02);
	}
	g_test_message("%u strokes, %u across", l->count, second);
	g_assert_cmpuint(looked_at, >, 4000);
	g_assert_cmpuint(second, ==, l->count / 2);
	stroke_lists_free(l, f->layers);
}

/* Alpha of all strokes, and of those across. */
static void weigh(const frame *f, double ret[2])
{
	stroke_list *l = strokes_of(f, true);
	ret[0] = ret[1] = 0;
	for (uint32_t n = 0; n < l->count; n++)
		ret[l->stroke[n].copy & 1] += (double)l->stroke[n].alpha;
	stroke_lists_free(l, f->layers);
}

/* A second stroke for as many as the chance of the first times h. */
static void test_cross(void)
{
	static const double chances[] = { 1, 0.5, 0.5 }, crosses[] = { 1, 1, 0.4 };
	struct camera c = before_ball(3, 600);
	for (int n = 0; n < 3; n++) {
		g_autofree char *step =
			g_strdup_printf("\"cross\":%g,\"xtoon\":[{\"brightness\":0,\"chance\":%g}]",
				crosses[n], chances[n]);
		g_autoptr(drawing) d = hatching("", step);
		g_autoptr(frame) f = made_frame(shared_ball(), d, &c);
		double alpha[2];
		weigh(f, alpha);
		g_test_message(
			"%g of %g: %.3f across", crosses[n], chances[n], alpha[1] / alpha[0]);
		g_assert_cmpfloat_with_epsilon(alpha[1] / alpha[0], crosses[n] * chances[n], 0.04);
	}
}

/* Half as many where the X-Toon says so, at once or by density. */
static void test_chance(void)
{
	static const char *const half[] = {
		"\"xtoon\":[{\"brightness\":0,\"chance\":1}]",
		"\"xtoon\":[{\"brightness\":0,\"chance\":0.5}],\"pressure\":0",
		"\"xtoon\":[{\"brightness\":0,\"chance\":1}],\"density\":0.5",
	};
	struct camera c = before_ball(3, 600);
	double alpha[3][2];
	for (int n = 0; n < 3; n++) {
		g_autoptr(drawing) d = hatching("", half[n]);
		g_autoptr(frame) f = made_frame(shared_ball(), d, &c);
		weigh(f, alpha[n]);
	}
	g_assert_cmpfloat_with_epsilon(alpha[1][0] / alpha[0][0], 0.5, 0.02);
	g_assert_cmpfloat_with_epsilon(alpha[2][0] / alpha[0][0], 0.5, 0.02);
}

/* ---- light ---- */

/* Of each point's strokes; free with g_free. */
static float *alphas_of(const frame *f, uint32_t copies)
{
	stroke_list *l = strokes_of(f, true);
	float *alpha = g_new0(float, (size_t)f->scene->count *copies);
	for (uint32_t n = 0; n < l->count; n++)
		if (l->stroke[n].copy < copies)
			alpha[(size_t)l->stroke[n].point * copies + l->stroke[n].copy] =
				l->stroke[n].alpha;
	stroke_lists_free(l, f->layers);
	return alpha;
}

struct moved {
	uint32_t came, went;
	float most; /* of any alpha */
};

/* Where it becomes lighter strokes only go, where it becomes darker they only come. */
static struct moved move_light(const frame *f, const float *before, const float *after,
	uint32_t copies, const double was[3])
{
	struct moved m = { 0 };
	for (uint32_t n = 0; n < f->scene->count * copies; n++) {
		float out[3], more = after[n] - before[n];
		double brighter = 0;
		model_unpack_normal(f->scene->normal[n / copies], out);
		for (int k = 0; k < 3; k++)
			brighter += (double)out[k] * (f->light.site_from[k] - was[k]);
		g_assert_true(brighter > 0 ? more <= 1e-4f : more >= -1e-4f);
		m.came += before[n] == 0 && after[n] > 0;
		m.went += before[n] > 0 && after[n] == 0;
		m.most = fmaxf(m.most, fabsf(more));
	}
	return m;
}

/* By half a degree, as frames of a film do; there and back. */
static void test_light_moves(void)
{
	enum { COPIES = 4 };
	struct camera c = before_ball(3, 600);
	g_autoptr(drawing) d = hatching(LIT, "\"cross\":0");
	g_autoptr(frame) f = made_frame(shared_ball(), d, &c);
	struct style_light light = d->whole.light;
	g_autofree float *before = alphas_of(f, COPIES);
	for (int n = 0; n < 2; n++) {
		double was[3];
		memcpy(was, f->light.site_from, sizeof was);
		light.azimuth_deg += n ? -0.5f : 0.5f;
		frame_set_light(f, &light);
		g_autofree float *after = alphas_of(f, COPIES);
		struct moved m = move_light(f, before, after, COPIES, was);
		g_test_message("%u came, %u went, %.3f at most", m.came, m.went, (double)m.most);
		g_assert_cmpuint(MAX(m.came, m.went), >, 100);
		g_assert_cmpfloat(m.most, <=, 0.15f);
		g_free(before);
		before = g_steal_pointer(&after);
	}
}

/* Nothing of the far side: by the area of strokes whose points the ball itself hides. */
static void test_backs(void)
{
	static const char *const backs[] = { "\"backs\":\"hidden\"", "\"backs\":\"shown\"" };
	struct camera c = before_ball(3, 600);
	for (int n = 0; n < 2; n++) {
		g_autofree char *nodes = g_strdup_printf(
			"\"site\":{\"steps\":[{\"step\":\"mask\",%s},{\"step\":\"hatching\","
			"\"cross\":0.5,\"xtoon\":[{\"brightness\":0}]}]}",
			backs[n]);
		g_autoptr(drawing) d = made_drawing(nodes);
		g_autoptr(frame) f = made_frame(shared_ball(), d, &c);
		stroke_list *l = strokes_of(f, true);
		double all = 0, hidden = 0, normal[3];
		for (uint32_t k = 0; k < l->count; k++) {
			const struct stroke *s = &l->stroke[k];
			double area = (double)(s->alpha * s->half_length_px * s->half_width_px);
			double ray[3] = { ((double)s->x_px - c.width / 2.0) / c.focal_px,
				((double)s->y_px - c.height / 2.0) / c.focal_px, 1 };
			normal_of(f, s, normal);
			all += area;
			hidden += dot(ray, normal) > 0.02 ? area : 0;
		}
		g_test_message("%s: %.4f %% behind", backs[n], 100 * hidden / all);
		g_assert_cmpuint(l->count, >, 10000);
		if (n == 0)
			g_assert_cmpfloat(hidden, <=, 0.001 * all);
		stroke_lists_free(l, f->layers);
	}
}

/* ---- how long ---- */

/* Of those that are seen from the front. */
static double mean_length(const frame *f)
{
	stroke_list *l = strokes_of(f, true);
	double sum = 0, count = 0, normal[3];
	for (uint32_t n = 0; n < l->count; n++) {
		normal_of(f, &l->stroke[n], normal);
		if (normal[2] > -0.97)
			continue;
		sum += 2 * (double)l->stroke[n].half_length_px;
		count++;
	}
	stroke_lists_free(l, f->layers);
	g_assert_cmpfloat(count, >, 20);
	return sum / count;
}

static void test_curvature(void)
{
	struct camera c = before_ball(3, 600);
	double length_px[2];
	for (int n = 0; n < 2; n++) {
		g_autofree char *step = g_strdup_printf(
			"\"length_px\":80,\"curvature\":%d,\"xtoon\":[{\"brightness\":0}]", n * 4);
		g_autoptr(drawing) d = hatching("", step);
		g_autoptr(frame) f = made_frame(shared_ball(), d, &c);
		length_px[n] = mean_length(f);
	}
	/* 40 pixels of this picture, two metres away, on a ball of one. */
	double bent = 40 * 2 / c.focal_px / RADIUS;
	g_test_message("%.2f px, and %.2f", length_px[0], length_px[1]);
	g_assert_cmpfloat_with_epsilon(length_px[0], 40, 1);
	g_assert_cmpfloat_with_epsilon(length_px[1] / length_px[0], 1 / (1 + 4 * bent), 0.02);
}

/* Twice as large and a quarter as many at the far end, in even steps. */
static void test_abstraction(void)
{
	static const uint8_t grey[4] = { 200, 200, 200, 255 };
	static const double far_m[3] = { 100, 208, 3 };
	g_auto(made) m = made_new();
	made_add_sphere(&m, ball_m, RADIUS, COUNT, grey);
	made_add_sphere(&m, far_m, 3 * RADIUS, COUNT, grey);
	const scene *s = made_read(&m);
	struct camera c = before_ball(3, 600);
	g_autoptr(drawing) d = hatching("", "\"near_m\":2,\"far_m\":12,\"abstraction\":1,"
					    "\"curvature\":0,\"xtoon\":[{\"brightness\":0}]");
	g_autoptr(frame) f = made_frame(s, d, &c);
	stroke_list *l = strokes_of(f, true);
	for (uint32_t n = 0; n < l->count; n++) {
		double away = CLAMP((1 / (double)l->stroke[n].q - 2) / 10, 0, 1);
		double width = 2 * (double)l->stroke[n].half_width_px / (1.6 * f->px);
		g_assert_cmpfloat(fabs(width - (1 + away)), <=, 0.02);
	}
	stroke_lists_free(l, f->layers);
}

/* ---- contours ---- */

static void test_outline(void)
{
	struct camera c = before_ball(3, 600);
	g_autoptr(drawing) d = made_drawing(MADE_SITE(
		"{\"step\":\"mask\",\"backs\":\"hidden\"},{\"step\":\"contours\",\"steps\":0,"
		"\"angle_variation_deg\":0,\"band_px\":4}"));
	g_autoptr(frame) f = made_frame(shared_ball(), d, &c);
	stroke_list *l = strokes_of(f, true);
	/* The rim of the ball as this camera sees it. */
	double rim = c.focal_px * RADIUS / sqrt(9 - RADIUS * RADIUS);
	g_assert_cmpuint(l->count, >, 100);
	uint32_t sectors[36] = { 0 };
	for (uint32_t n = 0; n < l->count; n++) {
		const struct stroke *s = &l->stroke[n];
		double x = (double)s->x_px - c.width / 2.0, y = (double)s->y_px - c.height / 2.0;
		double away = hypot(x, y);
		g_assert_cmpfloat(fabs(away - rim), <=, 3);
		g_assert_cmpfloat(
			fabs((x * (double)s->along[0] + y * (double)s->along[1]) / away), <=, 0.1);
		sectors[(int)(atan2(y, x) * 18 / G_PI + 18) % 36]++;
	}
	for (int n = 0; n < 36; n++)
		g_assert_cmpuint(sectors[n], >, 0);
	stroke_lists_free(l, f->layers);
}

/* A wall before a farther one: lines along its borders and nowhere else. */
static void test_steps(void)
{
	g_auto(made) m = made_new();
	struct made_plane near = { .corner_m = { -1, 0, -1 },
		.a_m = { 2, 0, 0 },
		.b_m = { 0, 0, 2 },
		.apart_m = 0.01,
		.order = MADE_JITTERED,
		.rgba = { 200, 200, 200, 255 } };
	struct made_plane far = near;
	far.corner_m[0] = far.corner_m[2] = -6;
	far.corner_m[1] = 3;
	far.a_m[0] = far.b_m[2] = 12;
	far.apart_m = 0.03;
	made_add_plane(&m, &near);
	made_add_plane(&m, &far);
	double eye[3] = { 0, -4, 0 }, target[3] = { 0 };
	struct camera c = camera_look_at(eye, target, 60, 600, 600);
	g_autoptr(drawing) d = made_drawing(MADE_SITE("{\"step\":\"contours\"}"));
	g_autoptr(frame) f = made_frame(made_read(&m), d, &c);
	stroke_list *l = strokes_of(f, true);
	double side = c.focal_px / 4;
	uint32_t off = 0;
	g_assert_cmpuint(l->count, >, 100);
	for (uint32_t n = 0; n < l->count; n++) {
		double x = fabs((double)l->stroke[n].x_px - 300),
		       y = fabs((double)l->stroke[n].y_px - 300);
		off += fabs(fmax(x, y) - side) > 5;
	}
	g_test_message("%u of %u off the border", off, l->count);
	g_assert_cmpuint(off * 50, <=, l->count);
	stroke_lists_free(l, f->layers);
}

/* ---- as shapes ---- */

static double area_of(const struct vector_path *p, guint shape)
{
	const float(*c)[2] = (const float(*)[2])(const void *)p->corner->data;
	uint32_t first = shape ? g_array_index(p->end, uint32_t, shape - 1) : 0,
		 end = g_array_index(p->end, uint32_t, shape);
	double sum = 0;
	for (uint32_t n = first; n < end; n++) {
		const float *a = c[n], *b = c[n + 1 < end ? n + 1 : first];
		sum += (double)(a[0] * b[1] - a[1] * b[0]) / 2;
	}
	return fabs(sum);
}

struct inked {
	uint32_t shown, corners;
	double ink; /* square millimetres of full ink */
};

static struct inked ink_of(const frame *f, uint32_t corners_most)
{
	draw_room *room = draw_room_new();
	struct inked ret = { 0 };
	g_autoptr(vector_page) page =
		vector_page_new_thinned(room, f, NULL, 200, 200, "Ball", corners_most, NULL);
	const struct vector_layer *l = page->layers->pdata[0];
	ret.shown = l->shown;
	for (guint g = 0; g < l->groups->len; g++) {
		const struct vector_group *group = l->groups->pdata[g];
		for (guint n = 0; n < group->paths->len; n++) {
			const struct vector_path *p = group->paths->pdata[n];
			ret.corners += p->corner->len;
			for (guint k = 0; k < p->end->len; k++)
				ret.ink += (double)p->opacity * area_of(p, k);
		}
	}
	draw_room_free(room);
	return ret;
}

/* Of hatching that is too dense for a page fewer strokes leave as much ink. */
static void test_thinned(void)
{
	struct camera c = before_ball(3, 600);
	g_autoptr(drawing) d = hatching(LIT, "\"spacing_px\":2");
	g_autoptr(frame) f = made_frame(shared_ball(), d, &c);
	struct inked all = ink_of(f, UINT32_MAX), half = ink_of(f, all.corners / 2),
		     few = ink_of(f, all.corners / 5);
	g_test_message("%u strokes, %u corners, %.0f mm2; %u, %u, %.0f; %u, %u, %.0f", all.shown,
		all.corners, all.ink, half.shown, half.corners, half.ink, few.shown, few.corners,
		few.ink);
	g_assert_cmpuint(all.shown, >, 5000);
	g_assert_cmpuint(half.shown, <, all.shown);
	g_assert_cmpuint(few.shown, <, half.shown * 2 / 3);
	g_assert_cmpfloat_with_epsilon(half.ink, all.ink, 0.05 * all.ink);
	g_assert_cmpuint(half.corners, <, all.corners * 3 / 4);
	g_assert_cmpuint(few.corners, <, all.corners / 2);
	g_assert_cmpfloat_with_epsilon(few.ink, all.ink, 0.1 * all.ink);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/hatching/tone", test_tone);
	g_test_add_func("/hatching/lanes", test_lanes);
	g_test_add_func("/hatching/planes", test_planes);
	g_test_add_func("/hatching/cross", test_cross);
	g_test_add_func("/hatching/chance", test_chance);
	g_test_add_func("/hatching/light-moves", test_light_moves);
	g_test_add_func("/hatching/backs", test_backs);
	g_test_add_func("/hatching/curvature", test_curvature);
	g_test_add_func("/hatching/abstraction", test_abstraction);
	g_test_add_func("/hatching/thinned", test_thinned);
	g_test_add_func("/contours/outline", test_outline);
	g_test_add_func("/contours/steps", test_steps);
	return g_test_run();
}
