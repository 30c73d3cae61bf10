#ifndef TESTS_PARITY_DRAWN_H
#define TESTS_PARITY_DRAWN_H
/* Frames of the small scene by either backend, and whether both are one picture. */
#include "tests/gles-here.h"
#include "tests/parity-made.h"
#include "tests/pictures-differ.h"

#define WIDTH  320u
#define HEIGHT 240u
/* Of 255, mean over channels; how many pixels are not far off. */
#define MEAN_MOST   2.0
#define WITHIN_PART 0.999

static struct camera make_camera(double back_m, uint32_t width, uint32_t height)
{
	double eye[3] = { 1000.5, -back_m, 1.7 }, target[3] = { 1000, 2, 1.2 };
	return camera_look_at(eye, target, 60, width, height);
}

/* ---- styles ---- */

static inline style *style_of(const char *text)
{
	g_autoptr(GError) error = NULL;
	style *s = style_parse(text, -1, "made.json", &error);
	g_assert_no_error(error);
	return s;
}

static frame *frame_of(
	const scene *s, const style *how, const struct camera *c, drawing **ret_drawing)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(segments) tree = segments_new();
	*ret_drawing = drawing_new(how, tree, NULL, &error);
	g_assert_no_error(error);
	frame *f = frame_new(s, *ret_drawing, c, &error);
	g_assert_no_error(error);
	return f;
}

/* ---- backends ---- */

static struct picture_buffer draw_gles(gles_draw *d, const frame *f)
{
	g_autoptr(GError) error = NULL;
	struct picture_buffer p = picture_buffer_new(f->camera.width, f->camera.height);
	gles_draw_frame(d, f, &p, NULL, &error);
	g_assert_no_error(error);
	return p;
}

static struct picture_buffer draw_cpu(const frame *f)
{
	struct picture_buffer p = picture_buffer_new(f->camera.width, f->camera.height);
	draw_frame(NULL, f, &p, NULL);
	return p;
}

/* ---- comparing ---- */

static void assert_alike(
	const struct picture_buffer *cpu, const struct picture_buffer *gles, const char *name)
{
	struct difference d = differ(cpu, gles);
	g_test_message("%s: mean %.3f, %.3f %% within %d, at most %d", name, d.mean, 100 * d.within,
		FAR, d.most);
	if (d.mean > MEAN_MOST || d.within < WITHIN_PART)
		save_all(cpu, gles, name);
	g_assert_cmpfloat(d.mean, <=, MEAN_MOST);
	g_assert_cmpfloat(d.within, >=, WITHIN_PART);
}

#define CAMERAS 3
/* From two places, the second one amid the points; and by parallel rays, where what the points are cut at is thick. */
static struct camera camera_of(int n)
{
	struct camera c = make_camera(n ? 2.5 : 7, WIDTH, HEIGHT);
	if (n < 2)
		return c;
	c = camera_parallel(&c, 4, 7);
	c.is_cut = true;
	return c;
}

/* Strokes that are added, not blended. */
static void compare_sums(
	gles_draw *d, const frame *f, const struct picture_buffer *cpu, const char *name)
{
	g_autofree char *sums = g_strconcat(name, "-sums", NULL);
	gles_draw_set_sums(d, true);
	struct picture_buffer gles = draw_gles(d, f);
	gles_draw_set_sums(d, false);
	assert_alike(cpu, &gles, sums);
	picture_buffer_clear(&gles);
}

static void compare_some(gles_draw *d, const char *name, const style *how, int cameras)
{
	scene *s = make_scene();
	gles_draw_set_sums(d, false);
	for (int n = 0; n < cameras; n++) {
		struct camera c = camera_of(n);
		drawing *drawn;
		frame *f = frame_of(s, how, &c, &drawn);
		struct picture_buffer cpu = draw_cpu(f), gles = draw_gles(d, f);
		assert_alike(&cpu, &gles, name);
		if (f->layers && n == 0)
			compare_sums(d, f, &cpu, name);
		picture_buffer_clear(&cpu);
		picture_buffer_clear(&gles);
		frame_free(f);
		drawing_free(drawn);
	}
	scene_free(s);
}

static void compare(gles_draw *d, const char *name, const style *how)
{
	compare_some(d, name, how, CAMERAS);
}

#endif
