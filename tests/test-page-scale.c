/* Pages at a scale: what is known to be so far apart on the site is so far apart on paper and in pixels, at any depth; the cut is where it
 * is, and nothing before it is left; which scales fit; what stands at the edge. */
#include "render/page-legend.h"
#include "render/page-scale.h"
#include "render/vector-page.h"
#include "tests/scene-made.h"
#include <gio/gio.h>

#define SCALE 50.0

/* ---- scales ---- */

static void assert_text(const char *text, double want, const char *again)
{
	double scale = 0;
	g_assert_true(page_scale_parse(text, &scale));
	g_assert_cmpfloat(scale, ==, want);
	g_autofree char *same = page_scale_text(scale);
	g_assert_cmpstr(same, ==, again);
}

static void test_texts(void)
{
	static const char *const bad[] = { "", "50", "1:", ":50", "1:0", "1:-5", "1:50x", "1: 50",
		"a:b", "1:1e9", "0:5", "1:nan", "1e9:1" };
	double scale = 7;
	assert_text("1:50", 50, "1:50");
	assert_text("2:1", 0.5, "2:1");
	assert_text("1:12.5", 12.5, "1:12.5");
	for (size_t n = 0; n < G_N_ELEMENTS(bad); n++)
		g_assert_false(page_scale_parse(bad[n], &scale));
	g_assert_cmpfloat(scale, ==, 7);
}

static struct page_size paper(const char *text)
{
	struct page_size size;
	g_assert_true(page_size_parse(text, 150, &size));
	return size;
}

static view *view_of(double wide_m, double high_m)
{
	static const double eye[3] = { 100, 200, 3 }, target[3] = { 100, 205, 3 };
	view *v = view_new_parallel("section-a", "Section A", eye, target, high_m);
	v->span_m[0] = wide_m;
	return v;
}

/* Of an A3 across 400 x 263 mm are left beside the legend. */
static void test_what_fits(void)
{
	struct page_size a3 = paper("A3-landscape");
	static const struct {
		double wide_m, high_m, scale, bare;
	} cases[] = { { 20, 5, 50, 50 }, { 20.5, 5, 100, 50 }, { 0.39, 0.2, 1, 1 },
		{ 5, 13.1, 50, 50 }, { 5, 14.8, 100, 50 }, { 3000, 10, 10000, 10000 },
		{ 0.01, 0.005, 0.05, 0.05 } };
	for (size_t n = 0; n < G_N_ELEMENTS(cases); n++) {
		g_autoptr(view) v = view_of(cases[n].wide_m, cases[n].high_m);
		g_assert_cmpfloat_with_epsilon(
			page_scale_fitting(v, &a3, true) / cases[n].scale, 1, 1e-9);
		g_assert_cmpfloat_with_epsilon(
			page_scale_fitting(v, &a3, false) / cases[n].bare, 1, 1e-9);
	}
	g_assert_cmpfloat_with_epsilon(page_scale_round_length(3.7), 2, 1e-12);
	g_assert_cmpfloat_with_epsilon(page_scale_round_length(0.05), 0.05, 1e-12);
}

static void test_refused(void)
{
	static const double eye[3] = { 0 }, target[3] = { 0, 1, 0 };
	struct page_size a3 = paper("A3-landscape");
	g_autoptr(view) wide = view_of(32, 9), walk = view_new("walk", "Walk", eye, target, 60);
	g_autoptr(GError) large = NULL, perspective = NULL;
	g_assert_false(page_scale_set(wide, &a3, true, 50, &large));
	g_assert_cmpstr(large->message, ==,
		"view 'section-a' does not fit: its 32 x 9 m are 640 x 180 mm at 1:50, and the "
		"page has "
		"room for 400 x 263; 1:100 fits, or a larger --size");
	g_assert_false(page_scale_set(walk, &a3, true, 50, &perspective));
	g_assert_error(perspective, G_IO_ERROR, G_IO_ERROR_INVALID_ARGUMENT);
	g_assert_true(g_str_has_prefix(perspective->message, "view 'walk' has perspective"));
}

/* ---- a known site ---- */

/* Single points, none of them hidden, from the eye's plane at y = 200 on. */
static const struct {
	double right_m, up_m, deep_m;
} dots[] = { { -4, -2, 0.01 }, { 4, -2, 1.5 }, { 4, 2, 10 }, { -4, 2, 40 }, { 0.37, 0.11, 5 } };
/* Before that. */
static const double hidden[][3] = { { 0, 0, -0.01 }, { 1, 1, -3 } };

static void add_dot(made *m, double right_m, double up_m, double deep_m)
{
	struct made_point p = { .at_m = { 100 + right_m, 200 + deep_m, 3 + up_m },
		.rgba = { 10, 10, 10, 255 },
		.kind = FEATURE_UNDIRECTED,
		.leaf = MADE_LEAF,
		.apart_m = 0.1f };
	g_array_append_val(m->points, p);
}

#define DOTS                                                                                       \
	"{\"step\":\"mask\",\"disc\":0.1},{\"step\":\"sprites\",\"points\":\"all\",\"spacing_"     \
	"px\":1,"                                                                                  \
	"\"length_px\":8,\"ink\":\"#000000\",\"opacity\":1,\"opacity_variation\":0,\"grow\":1,"    \
	"\"scatter\":0,\"degree\":0,\"tooth\":0}"

static frame *frame_at_scale(
	const scene *s, const drawing *d, view *v, const struct page_size *size, uint32_t larger)
{
	g_autoptr(GError) error = NULL;
	g_assert_true(page_scale_set(v, size, true, SCALE, &error));
	struct camera c = view_camera(v, size->width, size->height),
		      large = camera_scaled(&c, larger);
	frame *f = frame_new(s, d, &large, &error);
	g_assert_no_error(error);
	return f;
}

/* How far a place is on paper from where it should be; the page's middle is that of the room for it, 14 / 2 mm lower. */
static double away_mm(const struct page_size *size, const float mm[2], int dot)
{
	double x = size->width_mm / 2 + dots[dot].right_m * 1000 / SCALE,
	       y = (size->height_mm - 14) / 2 - dots[dot].up_m * 1000 / SCALE;
	return hypot((double)mm[0] - x, (double)mm[1] - y);
}

static void test_on_paper(void)
{
	struct page_size a3 = paper("A3-landscape");
	g_auto(made) m = made_new();
	for (size_t n = 0; n < G_N_ELEMENTS(dots); n++)
		add_dot(&m, dots[n].right_m, dots[n].up_m, dots[n].deep_m);
	for (size_t n = 0; n < G_N_ELEMENTS(hidden); n++)
		add_dot(&m, hidden[n][0], hidden[n][1], hidden[n][2]);
	const scene *s = made_read(&m);
	g_autoptr(drawing) d = made_drawing(MADE_SITE(DOTS));
	g_autoptr(view) v = view_of(9, 5);
	g_autoptr(frame) f = frame_at_scale(s, d, v, &a3, 2);
	draw_room *room = draw_room_new();
	g_autoptr(vector_page) page =
		vector_page_new(room, f, NULL, a3.width_mm, a3.height_mm, "Dots", NULL);
	const struct vector_layer *l = g_ptr_array_index(page->layers, 0);
	bool seen[G_N_ELEMENTS(dots)] = { false };
	g_assert_cmpuint(l->shown, ==, G_N_ELEMENTS(dots));
	for (guint g = 0; g < l->groups->len; g++) {
		const struct vector_group *group = g_ptr_array_index(l->groups, g);
		for (guint n = 0; n < group->paths->len; n++) {
			const struct vector_path *p = g_ptr_array_index(group->paths, n);
			for (guint k = 0; k < p->corner->len; k++)
				for (int dot = 0; dot < (int)G_N_ELEMENTS(dots); dot++)
					seen[dot] |=
						away_mm(&a3,
							&g_array_index(p->corner, float, 2 * k),
							dot) < 0.05;
		}
	}
	for (size_t n = 0; n < G_N_ELEMENTS(dots); n++)
		g_assert_true(seen[n]);
	draw_room_free(room);
}

/* The middle of what is dark around a place of the picture. */
static void dark_middle(const struct picture_buffer *p, const double at[2], double ret[2])
{
	double sum = 0;
	ret[0] = ret[1] = 0;
	for (int y = (int)at[1] - 12; y <= (int)at[1] + 12; y++)
		for (int x = (int)at[0] - 12; x <= (int)at[0] + 12; x++) {
			double dark = 255 - p->rgba[(size_t)y * p->width + (size_t)x][1];
			ret[0] += dark * (x + 0.5);
			ret[1] += dark * (y + 0.5);
			sum += dark;
		}
	g_assert_cmpfloat(sum, >, 255);
	ret[0] /= sum;
	ret[1] /= sum;
}

static double darkness(const struct picture_buffer *p)
{
	double sum = 0;
	for (size_t n = 0; n < (size_t)p->width * p->height; n++)
		sum += 255 - p->rgba[n][1];
	return sum;
}

static void test_in_pixels(void)
{
	struct page_size a4 = paper("A4-landscape");
	g_auto(made) m = made_new(), all = made_new();
	for (size_t n = 0; n < G_N_ELEMENTS(dots); n++) {
		add_dot(&m, dots[n].right_m, dots[n].up_m, dots[n].deep_m);
		add_dot(&all, dots[n].right_m, dots[n].up_m, dots[n].deep_m);
	}
	for (size_t n = 0; n < G_N_ELEMENTS(hidden); n++)
		add_dot(&all, hidden[n][0], hidden[n][1], hidden[n][2]);
	const scene *s = made_read(&m), *whole = made_read(&all);
	g_autoptr(drawing) d = made_drawing(MADE_SITE(DOTS));
	g_autoptr(view) v = view_of(9, 5), same = view_of(9, 5);
	g_autoptr(frame) f = frame_at_scale(s, d, v, &a4, 1),
			 both = frame_at_scale(whole, d, same, &a4, 1);
	struct picture_buffer p = picture_buffer_new(a4.width, a4.height),
			      q = picture_buffer_new(a4.width, a4.height);
	draw_frame(NULL, f, &p, NULL);
	draw_frame(NULL, both, &q, NULL);
	double px_per_m = a4.width / a4.width_mm * 1000 / SCALE;
	for (size_t n = 0; n < G_N_ELEMENTS(dots); n++) {
		const double place[3] = { 100 + dots[n].right_m, 200 + dots[n].deep_m,
			3 + dots[n].up_m };
		double at[2] = { 0 }, middle[2], depth = 0;
		g_assert_true(camera_project(&f->camera, place, at, &depth));
		g_assert_cmpfloat_with_epsilon(
			at[0], a4.width / 2. + px_per_m * dots[n].right_m, 1e-6);
		dark_middle(&p, at, middle);
		g_test_message(
			"dot %zu: off by %.3f %.3f px", n, middle[0] - at[0], middle[1] - at[1]);
		g_assert_cmpfloat(hypot(middle[0] - at[0], middle[1] - at[1]), <, 0.1);
	}
	/* What is before the cut leaves nothing: around the picture's axis is paper. */
	uint32_t left = a4.width / 2 - 12,
		 top = (uint32_t)((a4.height - 10.08 / a4.width_mm * a4.width) / 2) - 12;
	for (uint32_t y = top; y < top + 24; y++)
		for (uint32_t x = left; x < left + 24; x++)
			g_assert_cmpuint(q.rgba[(size_t)y * q.width + x][1], ==, 255);
	picture_buffer_clear(&p);
	picture_buffer_clear(&q);
}

/* A ramp and a wall across the cut: strokes run along where it goes through them, to a tenth of a pixel. */
static void test_cut(void)
{
	struct page_size a3 = paper("A3-landscape");
	g_auto(made) m = made_new();
	struct made_plane ramp = { .corner_m = { 97, 199, 2 },
		.a_m = { 6, 0, 0 },
		.b_m = { 0, 2, 1 },
		.apart_m = 0.02,
		.order = MADE_JITTERED,
		.rgba = { 200, 200, 200, 255 } };
	struct made_plane wall = { .corner_m = { 101, 199, 2.5 },
		.a_m = { 0, 2, 0 },
		.b_m = { 0, 0, 2 },
		.apart_m = 0.02,
		.order = MADE_JITTERED,
		.rgba = { 200, 200, 200, 255 } };
	struct made_plane facing = { .corner_m = { 97, 200.01, 4.6 },
		.a_m = { 2, 0, 0 },
		.b_m = { 0, 0, 0.5 },
		.apart_m = 0.02,
		.order = MADE_JITTERED,
		.rgba = { 200, 200, 200, 255 } };
	made_add_plane(&m, &ramp);
	made_add_plane(&m, &wall);
	made_add_plane(&m, &facing);
	const scene *s = made_read(&m);
	g_autoptr(drawing) d = made_drawing(MADE_SITE("{\"step\":\"mask\"}"));
	g_autoptr(view) v = view_of(7, 4);
	v->is_cut = true;
	g_autoptr(frame) f = frame_at_scale(s, d, v, &a3, 1);
	g_assert_cmpuint(f->layers, ==, 1);
	uint32_t views;
	g_autofree struct chunk_view *seen = chunk_views_new(f, &views);
	stroke_list *lists = stroke_lists_new(f, NULL, seen, views);
	const double on_ramp[3] = { 100, 200 + 1e-6, 2.5 }, on_wall[3] = { 101, 200 + 1e-6, 3 };
	double ramp_px[2] = { 0 }, wall_px[2] = { 0 }, depth = 0;
	uint32_t along = 0, up = 0;
	g_assert_true(camera_project(&f->camera, on_ramp, ramp_px, &depth));
	g_assert_true(camera_project(&f->camera, on_wall, wall_px, &depth));
	for (uint32_t n = 0; n < lists[0].count; n++) {
		const struct stroke *k = &lists[0].stroke[n];
		bool is_ramp = fabsf(k->along[0]) > 0.9f;
		double off = is_ramp ? (double)k->y_px - ramp_px[1] : (double)k->x_px - wall_px[0];
		g_assert_cmpfloat(fabs(off), <, 0.1);
		g_assert_cmpfloat(fabsf(is_ramp ? k->along[1] : k->along[0]), <, 1e-3f);
		along += is_ramp;
		up += !is_ramp;
	}
	g_assert_cmpuint(along, >, 600); /* 6 m, three rows of points 2 cm apart */
	g_assert_cmpuint(up, >, 200);
	stroke_lists_free(lists, f->layers);
}

/* ---- the edge ---- */

static const struct legend_text *text_of(const page_legend *l, const char *text)
{
	for (guint n = 0; n < l->texts->len; n++)
		if (strcmp(g_array_index(l->texts, struct legend_text, n).text, text) == 0)
			return &g_array_index(l->texts, struct legend_text, n);
	return NULL;
}

static void test_legend(void)
{
	struct page_legend_desc desc = { 420, 297, SCALE, "Oak, Section <A>", "2026-11-23",
		(double)NAN, { 255, 255, 255, 255 } };
	g_autoptr(page_legend) section = page_legend_new(&desc);
	desc.north_rad = 0;
	memset(desc.paper, 20, 3);
	g_autoptr(page_legend) plan = page_legend_new(&desc);
	g_assert_true(text_of(section, "1:50") && text_of(section, "Oak, Section <A>") &&
		      text_of(section, "2026-11-23"));
	g_assert_null(text_of(section, "N"));
	g_assert_nonnull(text_of(plan, "N"));
	g_assert_true(section->ink[0] < 100 && plan->ink[0] > 200);
	/* The bar is as long as it says: 2 m at 1:50 are 40 mm. */
	double low = INFINITY, high = 0;
	g_assert_nonnull(text_of(section, "2 m"));
	for (guint n = 0; n < section->shapes->len; n++) {
		const struct legend_shape *s =
			&g_array_index(section->shapes, struct legend_shape, n);
		for (uint32_t k = 0; k < s->corners; k++) {
			low = fmin(low, s->corner[k][0]);
			high = fmax(high, s->corner[k][0]);
		}
	}
	g_assert_cmpfloat_with_epsilon(high - low, 40, 1e-9);
	struct picture_buffer p = picture_buffer_new(420, 297);
	memset(p.rgba, 255, (size_t)420 * 297 * 4);
	page_legend_print(section, &p, 0, 1);
	g_assert_cmpfloat(darkness(&p), >, 10000);
	picture_buffer_clear(&p);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/page-scale/texts", test_texts);
	g_test_add_func("/page-scale/fits", test_what_fits);
	g_test_add_func("/page-scale/refused", test_refused);
	g_test_add_func("/page-scale/on-paper", test_on_paper);
	g_test_add_func("/page-scale/in-pixels", test_in_pixels);
	g_test_add_func("/page-scale/cut", test_cut);
	g_test_add_func("/page-scale/legend", test_legend);
	return g_test_run();
}
