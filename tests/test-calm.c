/* Lines that are found anew for each frame stay as they are when the camera moves a little: by the measures of pleinair bench coherence,
 * held against strokes whose places are shown in both frames. */
#include "render/bench-coherence-private.h"
#include "tests/strokes-made.h"

#define FRAMES 12

typedef void tally_add(struct stroke_tally *t, const struct shot *before, const struct shot *now);

static void add_strokes(struct stroke_tally *t, const struct shot *before, const struct shot *now)
{
	uint32_t ids = 1;
	for (uint32_t n = 0; n < before->lists->count; n++)
		ids = MAX(ids, before->lists->stroke[n].point + 1);
	for (uint32_t n = 0; n < now->lists->count; n++)
		ids = MAX(ids, now->lists->stroke[n].point + 1);
	g_autofree float *one = g_new0(float, ids), *other = g_new0(float, ids);
	stroke_tally_add(t, before, now, 0, (float *const[]){ one, other });
}

static void add_lines(struct stroke_tally *t, const struct shot *before, const struct shot *now)
{
	line_tally_add(t, before, now, 0);
}

static struct shot shot_from(frame *f, const double eye[3], const double target[3])
{
	struct camera c = camera_look_at(eye, target, 60, 1200, 900);
	struct picture_buffer picture = picture_buffer_new(1200, 900);
	struct shot s;
	g_assert_true(shot_take(&s, f, &c, NULL, false, &picture, NULL));
	picture_buffer_clear(&picture);
	return s;
}

/* So far along x from frame to frame the eye goes, or what it looks at. */
struct way {
	double eye[3], target[3], eye_m, target_m;
};

static struct stroke_tally walk(
	const scene *s, const char *nodes, const struct way *way, tally_add *add)
{
	g_autoptr(drawing) d = made_drawing(nodes);
	struct way at = *way;
	struct camera first = camera_look_at(at.eye, at.target, 60, 1200, 900);
	g_autoptr(frame) f = made_frame(s, d, &first);
	struct stroke_tally t = { 0 };
	struct shot before = shot_from(f, at.eye, at.target);
	for (int n = 1; n < FRAMES; n++) {
		at.eye[0] += at.eye_m;
		at.target[0] += at.target_m;
		struct shot now = shot_from(f, at.eye, at.target);
		add(&t, &before, &now);
		shot_clear(&before);
		before = now;
	}
	shot_clear(&before);
	g_test_message("of %" G_GUINT64_FORMAT " shown %" G_GUINT64_FORMAT
		       " are kept; of %" G_GUINT64_FORMAT " compared %" G_GUINT64_FORMAT
		       " jump, by %.3f at most",
		t.shown, t.kept, t.compared, t.jumped, (double)t.step_most);
	g_assert_cmpuint(t.compared, >, 500);
	return t;
}

/* Around boards of uneven points before a wall, as the camera turns: all are seen as before. */
static void test_steps(void)
{
	g_auto(made) m = made_new();
	struct made_plane board = { .a_m = { 0.3, 0, 0 },
		.b_m = { 0, 0, 2 },
		.apart_m = 0.015,
		.order = MADE_JITTERED,
		.rgba = { 200, 200, 200, 255 } };
	struct made_plane wall = { .corner_m = { -6, 3, -6 },
		.a_m = { 12, 0, 0 },
		.b_m = { 0, 0, 12 },
		.apart_m = 0.03,
		.rgba = { 200, 200, 200, 255 } };
	for (int n = 0; n < 6; n++) {
		board.corner_m[0] = -1.5 + 0.5 * n;
		board.corner_m[2] = -1 + 0.1 * n;
		made_add_plane(&m, &board);
	}
	made_add_plane(&m, &wall);
	static const struct way turn = { { 0, -5, 0 }, { 0, 0, 0 }, 0, 0.006 };
	struct stroke_tally t = walk(made_read(&m),
		MADE_SITE("{\"step\":\"contours\",\"outlines\":0,\"suggestive\":0}"), &turn,
		add_strokes);
	g_assert_cmpfloat(t.step_most, <, 0.3f);
	g_assert_cmpuint(t.jumped * 150, <=, t.compared);
}

/* Along a wall that a tree hides a part of. */
static void test_lines(void)
{
	g_auto(made) m = made_court();
	g_autoptr(profile_lines) p = profile_lines_new();
	static const struct way past = { { 103, 195, 6 }, { 103, 204, 4 }, 0.1, 0 };
	p->origin_m[0] = 90;
	p->origin_m[1] = 210;
	for (int n = 0; n < 12; n++)
		made_add_line(
			p, PROFILE_CREASE, 100, 205, 3.3 + 0.15 * n, 106, 205, 3.4 + 0.15 * n);
	made_read(&m);
	scene_set_lines(m.scene, p);
	struct stroke_tally t = walk(m.scene,
		MADE_SITE("{\"step\":\"profile\",\"wobble_px\":0,\"room_px\":0,\"sure\":0}"), &past,
		add_lines);
	g_assert_cmpuint(t.kept, ==, t.shown);
	g_assert_cmpfloat(t.step_most, <, 0.05f);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/calm/steps", test_steps);
	g_test_add_func("/calm/lines", test_lines);
	return g_test_run();
}
