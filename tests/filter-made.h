#ifndef TESTS_FILTER_MADE_H
#define TESTS_FILTER_MADE_H
/* Pictures for filters: shapes with borders at every angle, noise and bare paper, with depths; and the frame that filters ask of. */
#include "render/gles-filter.h"
#include "tests/gles-here.h"
#include "tests/scene-made.h"

struct filter_made {
	drawing *drawing;
	frame *frame;
	filter_room room;
	struct filter_job job;
	void *memory[6];
};

static inline const uint8_t *filter_made_paper(void)
{
	static const uint8_t paper[4] = { 255, 255, 255, 255 };
	return paper;
}

/* Discs of colours on stripes, with grain; a corner where nothing is. */
static inline void filter_made_fill(struct filter_image *i, uint32_t seed)
{
	g_autoptr(GRand) r = g_rand_new_with_seed(seed);
	for (uint32_t y = 0; y < i->height; y++)
		for (uint32_t x = 0; x < i->width; x++) {
			size_t at = (size_t)y * i->width + x;
			double stripe = sin(0.21 * x + 0.13 * y),
			       away = hypot(x - 0.4 * i->width, y - 0.5 * i->height);
			double rgb[3] = { 120 + 60 * stripe, 150 - 40 * stripe, 90 + 0.4 * x };
			if (away < 0.3 * i->height) {
				rgb[0] = 200;
				rgb[1] = 60 + 0.5 * y;
				rgb[2] = 40;
			}
			i->depth_m[at] =
				(float)(away < 0.3 * i->height ? 5 + 0.01 * x : 9 + 0.004 * y);
			for (int k = 0; k < 3; k++)
				i->rgba[at][k] = (uint8_t)CLAMP(
					rgb[k] + g_rand_double_range(r, -14, 14), 0, 255);
			i->rgba[at][3] = 255;
			if (x + y > 0.85 * (i->width + i->height)) {
				memcpy(i->rgba[at], filter_made_paper(), 4);
				i->depth_m[at] = FILTER_FAR;
			}
			i->normal[at][0] = (float)sin(0.05 * x);
			i->normal[at][1] = 0;
			i->normal[at][2] = (float)-cos(0.05 * x);
			i->leaf[at] = (uint16_t)(i->depth_m[at] < FILTER_FAR
							 ? 1 + (away < 0.3 * i->height)
							 : 0);
		}
}

/* Of a camera 1200 pixels high, so that lengths are pixels. focus: a section, or "". */
static inline struct filter_made filter_made_new(uint32_t width, uint32_t height, const char *focus)
{
	struct filter_made m = { 0 };
	g_autoptr(GError) error = NULL;
	static const double eye[3] = { 103, 195, 4.6 }, target[3] = { 103, 203, 4.2 };
	struct camera c = camera_look_at(eye, target, 60, 1600, 1200);
	g_autofree char *text =
		g_strdup_printf("{\"schema\":1,%s\"segments\":{\"site\":{\"steps\":[]}}}", focus);
	g_autoptr(style) s = style_parse(text, -1, "made.json", &error);
	g_assert_no_error(error);
	m.drawing = drawing_new(s, NULL, NULL, &error);
	g_assert_no_error(error);
	m.frame = made_frame(made_shared_court(), m.drawing, &c);
	size_t pixels = (size_t)width * height;
	const size_t bytes[6] = { 4, 4, sizeof(float), 3 * sizeof(float), 2, sizeof(float) };
	for (int n = 0; n < 6; n++)
		m.memory[n] = g_malloc0(pixels * bytes[n]);
	m.job = (struct filter_job){ .f = m.frame,
		.lanes = m.frame->lanes,
		.px = 1,
		.image = { .width = width,
			.height = height,
			.rgba = m.memory[0],
			.spare = m.memory[1],
			.depth_m = m.memory[2],
			.normal = m.memory[3],
			.leaf = m.memory[4],
			.paper = filter_made_paper() } };
	filter_made_fill(&m.job.image, 5);
	return m;
}

static inline void filter_made_clear(struct filter_made *m)
{
	frame_free(m->frame);
	drawing_free(m->drawing);
	filter_room_clear(&m->room);
	for (int n = 0; n < 6; n++)
		g_free(m->memory[n]);
}

/* Where filters run; NULL: on the processor. */
static gles_draw *filter_made_gles;

static inline void filter_made_step(struct gles_filter_job *j, const void *data)
{
	gles_filter_run(j, data);
}

/* Runs a step of this JSON: "kuwahara","radius_px":4. */
static inline void filter_made_run(struct filter_made *m, const char *step)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *text = g_strdup_printf("{\"schema\":1,\"segments\":{\"site\":{\"steps\":[]"
						"},\"picture\":{\"steps\":[{\"step\":%s}]}}}",
		step);
	g_autoptr(style) s = style_parse(text, -1, "made.json", &error);
	g_assert_no_error(error);
	drawing *d;
	d = drawing_new(s, NULL, NULL, &error);
	g_assert_no_error(error);
	g_assert_cmpuint(d->picture.filters, ==, 1);
	m->job.room = &m->room;
	const struct step *one = &d->picture.steps[0];
	if (filter_made_gles)
		gles_filter_picture(filter_made_gles, &m->job, filter_made_step, one, &error);
	else
		filter_apply(&m->job, one);
	g_assert_no_error(error);
	drawing_free(d);
}

/* What a filter had before it; caller frees. */
static inline uint8_t (*copy_of(const struct filter_image *i))[4]
{
	return g_memdup2(i->rgba, filter_pixels(i) * 4);
}

#endif
