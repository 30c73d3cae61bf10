/* Profile lines as strokes: where nothing hides them, as wide and as dark as they are to be, and the calmer the camera the calmer they. */
#include "render/scene-lines.h"
#include "render/vector-run.h"
#include "tests/strokes-made.h"

/* What is said of steps that say nothing else of it. */
static const char *const plain[][2] = { { "opacity", "1" }, { "opacity_variation", "0" },
	{ "tooth", "0" }, { "wobble_px", "0" }, { "pressure", "0" }, { "outlines", "1" },
	{ "creases", "1" }, { "least_px", "0" }, { "room_px", "0" }, { "sure", "0" },
	{ "taper_px", "0" } };
static const double eye[3] = { 103, 195, 6 }, target[3] = { 103, 204, 4 };

/* ---- lines ---- */

static profile_lines *no_lines(void)
{
	profile_lines *p = profile_lines_new();
	p->origin_m[0] = 90;
	p->origin_m[1] = 210;
	return p;
}

/* On the wall, behind the tree in the middle; and one behind the wall. */
static profile_lines *court_lines(void)
{
	profile_lines *p = no_lines();
	made_add_line(p, PROFILE_CREASE, 100, 205, 4.2, 106, 205, 4.2);
	made_add_line(p, PROFILE_CREASE, 100.5, 206.5, 3.8, 105.5, 206.5, 3.8);
	return p;
}

/* Of a made scene with these lines, which go. */
static frame *frame_with(made *m, profile_lines *lines, const char *numbers, drawing **ret_drawing)
{
	g_autoptr(GString) step = g_string_new("{\"step\":\"profile\"");
	for (size_t n = 0; n < G_N_ELEMENTS(plain); n++)
		if (!strstr(numbers, plain[n][0]))
			g_string_append_printf(step, ",\"%s\":%s", plain[n][0], plain[n][1]);
	g_string_append_printf(step, "%s%s}", *numbers ? "," : "", numbers);
	g_autofree char *nodes = g_strdup_printf(MADE_SITE("%s"), step->str);
	g_autoptr(profile_lines) own = lines;
	made_read(m);
	scene_set_lines(m->scene, own);
	*ret_drawing = made_drawing(nodes);
	struct camera c = camera_look_at(eye, target, 60, 400, HEIGHT);
	return made_frame(m->scene, *ret_drawing, &c);
}

/* Which of the scene's lines begins at a height. */
static uint32_t line_at(const scene *s, double z)
{
	const scene_lines *l = s->lines;
	for (uint32_t n = 0; n < l->lines; n++)
		if (fabs((double)l->vertex[l->line[n].first].at_m[2] + s->origin_m[2] - z) < 0.01)
			return n;
	g_assert_not_reached();
}

static void project(const frame *f, const double at_m[3], double ret[2])
{
	double away[3];
	for (int k = 0; k < 3; k++)
		away[k] = at_m[k] - f->camera.eye_m[k];
	const double *row[3] = { f->camera.right, f->camera.down, f->camera.forward };
	double seen[3];
	for (int k = 0; k < 3; k++)
		seen[k] = row[k][0] * away[0] + row[k][1] * away[1] + row[k][2] * away[2];
	ret[0] = f->camera.width / 2.0 + f->camera.focal_px * seen[0] / seen[2];
	ret[1] = f->camera.height / 2.0 + f->camera.focal_px * seen[1] / seen[2];
}

/* ---- what is hidden ---- */

static void test_hidden(void)
{
	g_auto(made) m = made_court();
	drawing *d;
	g_autoptr(frame) f = frame_with(&m, court_lines(), "", &d);
	stroke_list *l = strokes_of(f, true);
	static const double ends[2][3] = { { 100, 205, 4.2 }, { 106, 205, 4.2 } },
			    tree[3] = { 102, 203, 4.2 }, edge[3] = { 102.6, 203, 4.2 };
	double from[2], to[2], middle[2], beside[2], longest = 0, off = 0;
	uint32_t on_wall = line_at(m.scene, 4.2);
	project(f, ends[0], from);
	project(f, ends[1], to);
	project(f, tree, middle);
	project(f, edge, beside);
	double radius = beside[0] - middle[0];
	g_assert_cmpuint(l->count, >, 50);
	for (uint32_t n = 0; n < l->count; n++) {
		const struct stroke *s = &l->stroke[n];
		g_assert_cmpuint(s->point, ==, on_wall);
		double part = ((double)s->x_px - from[0]) / (to[0] - from[0]);
		off = fmax(off, fabs((double)s->y_px - from[1] - part * (to[1] - from[1])));
		g_assert_cmpfloat(fabs((double)s->x_px - middle[0]), >, 0.5 * radius);
		longest += 2 * ((double)s->half_length_px - 0.5);
	}
	g_test_message("%.1f px of %.1f are drawn, %.1f are behind the tree; %.3f px off", longest,
		to[0] - from[0], 2 * radius, off);
	g_assert_cmpfloat(off, <, 0.05);
	g_assert_cmpfloat(longest, >, to[0] - from[0] - 2.6 * radius);
	g_assert_cmpfloat(longest, <, to[0] - from[0] - 1.1 * radius);
	stroke_lists_free(l, f->layers);
	drawing_free(d);
}

static void test_dotted(void)
{
	g_auto(made) m = made_court();
	drawing *d;
	g_autoptr(frame) f = frame_with(&m, court_lines(), "\"hidden\":0.6", &d);
	stroke_list *l = strokes_of(f, true);
	uint32_t behind = line_at(m.scene, 3.8), dots = 0, runs = 0;
	double inked = 0;
	for (uint32_t n = 0; n < l->count; n++) {
		const struct stroke *s = &l->stroke[n];
		if (s->point != behind)
			continue;
		g_assert_cmpfloat(fabsf(s->alpha - 0.6f), <, 0.01f);
		inked += 2 * ((double)s->half_length_px - 0.5);
		runs += !s->copy;
		dots++;
	}
	static const double ends[2][3] = { { 100.5, 206.5, 3.8 }, { 105.5, 206.5, 3.8 } };
	double from[2], to[2];
	project(f, ends[0], from);
	project(f, ends[1], to);
	double part = inked / (to[0] - from[0]);
	g_test_message("%u links in %u dots, %.2f of the length", dots, runs, part);
	g_assert_cmpfloat(part, >, 0.35);
	g_assert_cmpfloat(part, <, 0.65);
	g_assert_cmpuint(runs, >, (to[0] - from[0]) / (2.5 * 9 / 4));
	stroke_lists_free(l, f->layers);
	drawing_free(d);
}

/* ---- the pen ---- */

/* Where the line ends, and where the tree begins to hide it. */
static void test_tapers(void)
{
	g_auto(made) m = made_court();
	drawing *d;
	g_autoptr(frame) f = frame_with(&m, court_lines(), "\"taper_px\":40,\"width_px\":6", &d);
	stroke_list *l = strokes_of(f, true);
	uint32_t runs = 0;
	for (uint32_t n = 0, first = 0; n <= l->count; n++) {
		if (n < l->count && (l->stroke[n].copy || n == first))
			continue;
		float most = 0,
		      ends = fmaxf(l->stroke[first].half_width_px, l->stroke[n - 1].half_width_px);
		for (uint32_t k = first; k < n; k++)
			most = fmaxf(most, l->stroke[k].half_width_px);
		if (n - first > 30) {
			runs++;
			g_assert_cmpfloat(
				fabsf(most - 0.75f), <, 0.01f); /* 6 px of a picture 1200 px high */
			g_assert_cmpfloat(ends, <, 0.5f * most);
		}
		first = n;
	}
	g_assert_cmpuint(runs, ==, 2);
	stroke_lists_free(l, f->layers);
	drawing_free(d);
}

static void test_wobbles(void)
{
	g_auto(made) m = made_court();
	drawing *d;
	profile_lines *p = no_lines();
	made_add_line(p, PROFILE_CREASE, 100, 205, 5, 106, 205, 5);
	made_add_line(p, PROFILE_CREASE, 100, 205, 4.9, 106, 205, 4.9);
	g_autoptr(frame) f = frame_with(&m, p, "\"wobble_px\":8", &d);
	stroke_list *l = strokes_of(f, true);
	double off[2] = { 0 }, together = 0, apart[2];
	static const double places[2][3] = { { 103, 205, 5 }, { 103, 205, 4.9 } };
	for (int k = 0; k < 2; k++) {
		double at[2];
		project(f, places[k], at);
		apart[k] = at[1];
	}
	uint32_t upper = line_at(m.scene, 5), count = 0;
	for (uint32_t n = 0; n < l->count; n++) {
		int which = l->stroke[n].point == upper ? 0 : 1;
		double by = fabs((double)l->stroke[n].y_px - apart[which]);
		off[which] = fmax(off[which], by);
		together += by;
		count++;
	}
	g_test_message(
		"%.2f and %.2f px off at most, %.2f in the mean", off[0], off[1], together / count);
	/* 8 px of the style are 2, on either axis, of two octaves. */
	g_assert_cmpfloat(fmax(off[0], off[1]), <=, 2 * 1.5);
	g_assert_cmpfloat(fmin(off[0], off[1]), >, 0.8);
	g_assert_cmpfloat(fabs(off[0] - off[1]), >, 1e-3);
	stroke_lists_free(l, f->layers);
	drawing_free(d);
}

/* Lines that lie on each other, and links in a row, are as dark as one. */
static void test_strongest(void)
{
	g_auto(made) m = made_court();
	drawing *d;
	profile_lines *p = no_lines();
	for (int n = 0; n < 6; n++)
		made_add_line(p, PROFILE_CREASE, 100.4 + n / 3.0, 205, 4.8 + 0.1 * (n % 2), 104.5,
			205, 4.85);
	g_autoptr(frame) f =
		frame_with(&m, p, "\"width_px\":16,\"ink\":\"#000000\",\"opacity\":0.5", &d);
	struct picture_buffer picture = picture_buffer_new(400, HEIGHT);
	draw_frame(NULL, f, &picture, NULL);
	uint8_t darkest = 255;
	uint32_t inked = 0, even = 0;
	for (uint32_t i = 0; i < 400 * HEIGHT; i++)
		darkest = MIN(darkest, picture.rgba[i][1]);
	for (uint32_t i = 0; i < 400 * HEIGHT; i++) {
		inked += picture.rgba[i][1] < darkest + 60;
		even += picture.rgba[i][1] < darkest + 3;
	}
	/* Half of white's light is 188 of 255. */
	g_test_message("darkest %u, %u of %u dark pixels are so dark", darkest, even, inked);
	g_assert_cmpint(abs(darkest - 188), <=, 3);
	g_assert_cmpuint(even, >, 300);
	picture_buffer_clear(&picture);
	drawing_free(d);
}

/* ---- runs on a page ---- */

static double area_of(const GArray *corner)
{
	const float(*at)[2] = (const float(*)[2])(void *)corner->data;
	double sum = 0;
	for (guint n = 0; n < corner->len; n++) {
		guint next = (n + 1) % corner->len;
		sum += (double)at[n][0] * (double)at[next][1] -
		       (double)at[next][0] * (double)at[n][1];
	}
	return fabs(sum) / 2;
}

/* As many shapes as the pen comes down, each with as much ink, of few corners. */
static void test_runs(void)
{
	g_auto(made) m = made_court();
	drawing *d;
	g_autoptr(frame) f = frame_with(&m, court_lines(),
		"\"taper_px\":40,\"width_px\":8,\"wobble_px\":2,\"pressure\":0.5", &d);
	stroke_list *l = strokes_of(f, true);
	g_autoptr(GArray) corner = g_array_new(FALSE, FALSE, sizeof(float[2]));
	uint32_t runs = 0, corners = 0, count;
	for (uint32_t n = 0; n < l->count; n += count, runs++) {
		double ink = 0;
		count = vector_run_length(l->stroke, n, l->count);
		vector_run_outline(l->stroke + n, count, f->px, corner);
		corners += corner->len;
		for (uint32_t k = n; k < n + count; k++)
			ink += (double)(4 * (l->stroke[k].half_length_px - 0.5f) *
					l->stroke[k].half_width_px);
		if (count > 20)
			g_assert_cmpfloat(fabs(area_of(corner) / ink - 1), <, 0.04);
	}
	g_test_message("%u links in %u runs of %u corners", l->count, runs, corners);
	g_assert_cmpuint(runs, >=, 2);
	g_assert_cmpuint(runs, <=, 4);
	g_assert_cmpuint(corners, <, l->count);
	stroke_lists_free(l, f->layers);
	drawing_free(d);
}

/* ---- scale ---- */

/* Ink of each line: length times width times alpha. */
static void ink_of(const frame *f, double *ret, uint32_t lines)
{
	stroke_list *l = strokes_of(f, true);
	memset(ret, 0, lines * sizeof *ret);
	for (uint32_t n = 0; n < l->count; n++) {
		const struct stroke *s = &l->stroke[n];
		ret[s->point] += (double)(s->alpha * 2 * (s->half_length_px - 0.5f));
	}
	stroke_lists_free(l, f->layers);
}

/* Straight before the wall, so far away. */
static struct camera camera_back(double back_m)
{
	double at[3] = { 104.5, 205 - back_m, 5 };
	static const double wall[3] = { 104.5, 205, 5 };
	return camera_look_at(at, wall, 60, 400, HEIGHT);
}

/* From far away one long line is left; on the way all fade, and none jumps. */
static void test_survive(void)
{
	g_auto(made) m = made_court();
	drawing *d;
	profile_lines *p = no_lines();
	made_add_line(p, PROFILE_CREASE, 100, 205, 4.8, 106, 205, 4.8);
	made_add_line(p, PROFILE_CREASE, 100.5, 205, 4.84, 106, 205, 4.84);
	made_add_line(p, PROFILE_CREASE, 103, 205, 5.2, 103.3, 205, 5.2);
	g_autoptr(frame) f = frame_with(&m, p, "\"least_px\":40,\"room_px\":12", &d);
	uint32_t long_one = line_at(m.scene, 4.8), near = line_at(m.scene, 4.84),
		 brief = line_at(m.scene, 5.2);
	double before[3], now[3], jump = 0;
	g_assert_cmpfloat(fabsf(m.scene->lines->line[near].apart_m - 0.04f), <, 0.005f);
	g_assert_cmpfloat(m.scene->lines->line[long_one].apart_m, ==, SCENE_LINES_APART_M);
	struct camera c = camera_back(2);
	g_assert_true(frame_move(f, &c, NULL));
	ink_of(f, before, 3);
	g_assert_cmpfloat(before[near], >, 100);
	g_assert_cmpfloat(before[brief], >, 10);
	for (int n = 1; n <= 300; n++) {
		double whole = before[long_one];
		c = camera_back(2 * pow(1.01, n));
		g_assert_true(frame_move(f, &c, NULL));
		ink_of(f, now, 3);
		for (int k = 0; k < 3; k++)
			jump = fmax(jump, fabs(now[k] - before[k]) / whole);
		memcpy(before, now, sizeof now);
	}
	g_test_message("from step to step up to %.3f of the long line's ink", jump);
	g_assert_cmpfloat(now[long_one], >, 20);
	g_assert_cmpfloat(now[near], ==, 0);
	g_assert_cmpfloat(now[brief], ==, 0);
	g_assert_cmpfloat(jump, <, 0.08);
	drawing_free(d);
}

/* ---- all ---- */

static void test_threads(void)
{
	g_auto(made) m = made_court();
	drawing *d;
	profile_lines *p = no_lines();
	for (int n = 0; n < 300; n++)
		made_add_line(p, n % PROFILE_KINDS, 100 + n % 7, 205 - n % 5 * 0.7,
			3 + n % 11 * 0.3, 101 + n % 13 * 0.4, 205 - n % 3, 3.2 + n % 17 * 0.2);
	g_autoptr(frame) f =
		frame_with(&m, p, "\"hidden\":0.5,\"overshoot_px\":20,\"taper_px\":30", &d);
	stroke_list *many = strokes_of(f, true);
	f->single_thread = true;
	stroke_list *one = strokes_of(f, true);
	g_assert_cmpuint(many->count, >, 1000);
	g_assert_cmpuint(many->count, ==, one->count);
	g_assert_cmpmem(many->stroke, many->count * sizeof *many->stroke, one->stroke,
		one->count * sizeof *one->stroke);
	stroke_lists_free(many, f->layers);
	stroke_lists_free(one, f->layers);
	drawing_free(d);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/profile-strokes/hidden", test_hidden);
	g_test_add_func("/profile-strokes/dotted", test_dotted);
	g_test_add_func("/profile-strokes/tapers", test_tapers);
	g_test_add_func("/profile-strokes/wobbles", test_wobbles);
	g_test_add_func("/profile-strokes/strongest", test_strongest);
	g_test_add_func("/profile-strokes/runs", test_runs);
	g_test_add_func("/profile-strokes/survive", test_survive);
	g_test_add_func("/profile-strokes/threads", test_threads);
	return g_test_run();
}
