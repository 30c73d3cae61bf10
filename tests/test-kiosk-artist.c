/* What the artist brings of a still view: finer and finer, or, where the drawing changes with time, one picture after the other. */
#include "render/kiosk/artist.h"
#include "render/scene-pager.h"
#include "tests/scene-made.h"

#define WIDTH  320u
#define HEIGHT 240u

struct sight {
	GMainLoop *loop;
	guint pictures, wanted,
		same;    /* that came, until there are so many; that are the one before */
	uint32_t finest; /* most pictures that one was the mean of */
	GBytes *last;
};

static void got_picture(const struct artist_picture *p, gpointer user_data)
{
	struct sight *s = user_data;
	s->pictures++;
	s->finest = MAX(s->finest, p->pictures);
	s->same += s->last && g_bytes_equal(s->last, p->bgrx);
	g_clear_pointer(&s->last, g_bytes_unref);
	s->last = g_bytes_ref(p->bgrx);
	if (s->pictures >= s->wanted || s->finest >= ARTIST_PICTURES)
		g_main_loop_quit(s->loop);
}

static void has_failed(const char *sentence, gpointer user_data)
{
	(void)user_data;
	g_error("%s", sentence);
}

static gboolean too_late(gpointer user_data)
{
	(void)user_data;
	g_critical("no picture came");
	return G_SOURCE_REMOVE;
}

static void watch(struct sight *s, guint wanted)
{
	guint timer = g_timeout_add_seconds(60, too_late, NULL);
	s->pictures = s->same = s->finest = 0;
	s->wanted = wanted;
	g_main_loop_run(s->loop);
	g_source_remove(timer);
}

static struct camera before_court(void)
{
	static const double eye[3] = { 103, 196, 5 }, target[3] = { 103, 203, 4 };
	return camera_look_at(eye, target, 60, WIDTH, HEIGHT);
}

static void test_sways(void)
{
	struct sight s = { .loop = g_main_loop_new(NULL, FALSE) };
	struct artist_watcher w = { .picture = got_picture, .failed = has_failed, .user_data = &s };
	artist *a = artist_new(made_shared_court(), BACKEND_WISH_CPU, &w);
	struct camera c = before_court();
	drawing *swaying =
		made_drawing(MADE_SITE("{\"step\":\"points\"},{\"step\":\"warp\",\"period_s\":1}"));
	g_assert_true(drawing_sways(swaying));
	artist_set_drawing(a, swaying);
	artist_look(a, &c, false);
	/* Nobody wishes for anything more, and it goes on. */
	watch(&s, 12);
	g_assert_cmpuint(s.pictures, ==, 12);
	g_assert_cmpuint(s.finest, ==, 1);
	g_assert_cmpuint(s.same, <=, 1);
	/* What does not sway becomes finer, and comes to an end. */
	drawing *still = made_drawing(MADE_SITE("{\"step\":\"points\"}"));
	g_assert_false(drawing_sways(still));
	artist_set_drawing(a, still);
	watch(&s, G_MAXUINT);
	g_assert_cmpuint(s.finest, ==, ARTIST_PICTURES);
	artist_free(a);
	g_clear_pointer(&s.last, g_bytes_unref);
	g_main_loop_unref(s.loop);
}

/* Points that are not there yet come by and by; then the still view becomes finer, and is the same as of all of them. */
static void test_paged(void)
{
	g_auto(made) m = made_new();
	struct made_plane ground = { .corner_m = { 93, 198, 3 },
		.a_m = { 20, 0, 0 },
		.b_m = { 0, 16, 0 },
		.apart_m = 0.02,
		.order = MADE_JITTERED,
		.rgba = { 90, 80, 70, 255 },
		.dithered = true };
	made_add_plane(&m, &ground);
	made_read(&m);
	g_autoptr(scene) paged = scene_paged(m.model, NULL, (uint64_t)64 << 20, NULL);
	const scene *of[] = { paged, m.scene };
	GBytes *finest[2];
	g_assert_nonnull(paged);
	for (int n = 0; n < 2; n++) {
		struct sight s = { .loop = g_main_loop_new(NULL, FALSE) };
		struct artist_watcher w = {
			.picture = got_picture, .failed = has_failed, .user_data = &s
		};
		artist *a = artist_new(of[n], BACKEND_WISH_CPU, &w);
		struct camera c = before_court();
		artist_set_drawing(a, made_drawing(MADE_SITE("{\"step\":\"points\"}")));
		artist_look(a, &c, true);
		artist_look(a, &c, false);
		watch(&s, G_MAXUINT);
		g_assert_cmpuint(s.finest, ==, ARTIST_PICTURES);
		artist_free(a);
		finest[n] = g_steal_pointer(&s.last);
		g_main_loop_unref(s.loop);
	}
	g_assert_true(g_bytes_equal(finest[0], finest[1]));
	g_bytes_unref(finest[0]);
	g_bytes_unref(finest[1]);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/artist/sways", test_sways);
	g_test_add_func("/artist/paged", test_paged);
	return g_test_run();
}
