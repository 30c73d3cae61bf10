/* Paths of the camera: how far each frame goes, that nothing jumps, and what is no path. */
#include "render/camera-path.h"
#include "tests/views-made.h"

static camera_path *path(const struct model_site *m, const char *spec, const view *v)
{
	g_autoptr(GError) error = NULL;
	camera_path *p = camera_path_parse(spec, v, &m->sources, &error);
	g_assert_no_error(error);
	for (uint32_t i = 0; i < camera_path_frames(p); i++) {
		struct camera c = camera_path_at(p, i, WIDTH, HEIGHT);
		g_assert_true(camera_validate(&c, &error));
	}
	return p;
}

static void test_orbit(struct model_site *m, gconstpointer data)
{
	(void)data;
	for (int i = 0; i < 20; i++) {
		g_autoptr(view) v = any_view("x");
		if (i == 0)
			v->eye_m[0] = v->target_m[0], v->eye_m[1] = v->target_m[1];
		g_autoptr(camera_path) p = path(m, "orbit", v);
		g_assert_cmpuint(camera_path_frames(p), ==, 40);
		struct camera first = view_camera(v, WIDTH, HEIGHT), before;
		for (uint32_t f = 0; f < 40; f++) {
			struct camera c = camera_path_at(p, f, WIDTH, HEIGHT);
			double far = distance(v->eye_m, v->target_m), px[2] = { 0 }, depth;
			g_assert_cmpfloat_with_epsilon(
				distance(c.eye_m, v->target_m) / far, 1, 1e-12);
			g_assert_cmpfloat(c.eye_m[2], ==, v->eye_m[2]);
			g_assert_true(camera_project(&c, v->target_m, px, &depth));
			g_assert_cmpfloat_with_epsilon(px[0], WIDTH / 2, 1e-7);
			g_assert_cmpfloat_with_epsilon(px[1], HEIGHT / 2, 1e-7);
			double turned = f ? acos(fmin(1, dot(c.right, before.right))) : 0;
			g_assert_cmpfloat_with_epsilon(turned * 180 / G_PI, f ? 0.5 : 0, 1e-9);
			before = c;
		}
		struct camera start = camera_path_at(p, 0, WIDTH, HEIGHT);
		assert_near(start.eye_m, first.eye_m, 1e-12 * 500);
		assert_near(start.forward, first.forward, 0);
	}
}

static void test_dolly(struct model_site *m, gconstpointer data)
{
	g_autoptr(view) v = any_view("x");
	g_autoptr(camera_path) p = path(m, "dolly", v);
	g_autoptr(camera_path) out = path(m, "dolly:0.25:11", v);
	g_autoptr(camera_path) still = path(m, "dolly:2:1", v);
	double far = distance(v->eye_m, v->target_m), before = 0;
	(void)data;
	g_assert_cmpuint(camera_path_frames(p), ==, 40);
	for (uint32_t f = 0; f < 40; f++) {
		struct camera c = camera_path_at(p, f, WIDTH, HEIGHT);
		double here = distance(c.eye_m, v->target_m) / far;
		g_assert_cmpfloat_with_epsilon(
			f ? before / here : 1 / here, f ? pow(2, 1 / 39.0) : 1, 1e-12);
		before = here;
	}
	g_assert_cmpfloat_with_epsilon(before, 0.5, 1e-14);
	struct camera c = camera_path_at(out, 10, WIDTH, HEIGHT);
	g_assert_cmpfloat_with_epsilon(distance(c.eye_m, v->target_m) / far, 4, 1e-12);
	c = camera_path_at(still, 0, WIDTH, HEIGHT);
	assert_near(c.eye_m, v->eye_m, 1e-12 * 500);
}

static void assert_pans(const camera_path *p, double pixels)
{
	for (uint32_t f = 1; f < camera_path_frames(p); f++) {
		struct camera a = camera_path_at(p, f - 1, WIDTH, HEIGHT),
			      b = camera_path_at(p, f, WIDTH, HEIGHT);
		double px[2] = { 0 }, depth, ahead[3];
		for (int k = 0; k < 3; k++)
			ahead[k] = a.eye_m[k] + 10 * a.forward[k];
		g_assert_true(camera_project(&b, ahead, px, &depth));
		g_assert_cmpfloat_with_epsilon(px[0], WIDTH / 2.0 - pixels, 1e-8);
		g_assert_cmpfloat_with_epsilon(b.forward[2], a.forward[2], 1e-12);
		assert_near(a.eye_m, b.eye_m, 0);
	}
}

static void test_pan(struct model_site *m, gconstpointer data)
{
	static const double heights[] = { 0, 3, -8, 40, -50 };
	(void)data;
	for (size_t i = 0; i < G_N_ELEMENTS(heights); i++) {
		const double eye[3] = { 1, 2, 3 }, target[3] = { -7, 8, 3 + heights[i] };
		g_autoptr(view) v = view_new("x", "x", eye, target, 50);
		g_autoptr(camera_path) right = path(m, "pan", v);
		g_autoptr(camera_path) left = path(m, "pan:-30.5:9", v);
		g_assert_cmpuint(camera_path_frames(right), ==, 40);
		g_assert_cmpuint(camera_path_frames(left), ==, 9);
		assert_pans(right, 8);
		assert_pans(left, -30.5);
	}
}

static void assert_at_view(const camera_path *p, uint32_t frame, const view *v)
{
	struct camera c = camera_path_at(p, frame, WIDTH, HEIGHT),
		      want = view_camera(v, WIDTH, HEIGHT);
	assert_near(c.eye_m, want.eye_m, 1e-9);
	assert_near(c.forward, want.forward, 1e-9);
	assert_near(c.right, want.right, 1e-9);
	g_assert_cmpfloat_with_epsilon(c.focal_px / want.focal_px, 1, 1e-12);
}

static void test_through_stations(struct model_site *m, gconstpointer data)
{
	g_autoptr(view) v = any_view("x"), a = find(m, "station-1"), b = find(m, "station-2"),
			c = find(m, "station-3");
	g_autoptr(camera_path) p = path(m, "stations:25", v);
	g_autoptr(camera_path) usual = path(m, "stations", v);
	(void)data;
	g_assert_cmpuint(camera_path_frames(usual), ==, 81);
	g_assert_cmpuint(camera_path_frames(p), ==, 51);
	assert_at_view(p, 0, a);
	assert_at_view(p, 25, b);
	assert_at_view(p, 50, c);
	double longest = distance(a->eye_m, b->eye_m);
	for (uint32_t f = 1; f < 51; f++) { /* nothing jumps, nothing overshoots */
		struct camera one = camera_path_at(p, f - 1, WIDTH, HEIGHT),
			      two = camera_path_at(p, f, WIDTH, HEIGHT);
		g_assert_cmpfloat(distance(one.eye_m, two.eye_m), <, 2 * longest / 25);
		g_assert_cmpfloat(acos(fmin(1, dot(one.forward, two.forward))), <, 0.3);
		g_assert_cmpfloat_with_epsilon(two.right[2], 0, 1e-12);
		g_assert_true(two.eye_m[2] > -0.101 && two.eye_m[2] < 0.101);
	}
	struct camera first = camera_path_at(p, 0, WIDTH, HEIGHT),
		      second = camera_path_at(p, 1, WIDTH, HEIGHT);
	g_assert_cmpfloat(distance(first.eye_m, second.eye_m), <, longest / 25 / 3); /* at rest */
}

static void test_through_views(struct place *place, gconstpointer data)
{
	struct model_site m;
	const double eye[3] = { 0, 0, 2 }, east[3] = { 9, -0.5, 2 }, west[3] = { 9, 0.5, 2 };
	g_autoptr(view) a = view_new("a", "a", eye, east, 20);
	g_autoptr(view) b = view_new("b", "b", eye, west, 80);
	(void)data;
	build(&m);
	m.sources.site = place->site;
	save(place, a);
	save(place, b);
	g_autoptr(view) overview = find(&m, "overview"), walk = find(&m, "walk");
	g_autoptr(camera_path) p = path(&m, "views:a,b:10", a);
	g_autoptr(camera_path) all = path(&m, "views:a,overview,walk,b,a:7", a);
	g_assert_cmpuint(camera_path_frames(p), ==, 11);
	assert_at_view(p, 0, a);
	assert_at_view(p, 10, b);
	/* In the middle halfway, the shorter way round; the scale is the mean of both. */
	struct camera c = camera_path_at(p, 5, WIDTH, HEIGHT), from = view_camera(a, WIDTH, HEIGHT),
		      to = view_camera(b, WIDTH, HEIGHT);
	g_assert_cmpfloat_with_epsilon(camera_heading_rad(&c), G_PI / 2, 1e-12);
	g_assert_cmpfloat_with_epsilon(c.focal_px, sqrt(from.focal_px * to.focal_px), 1e-9);
	assert_at_view(all, 7, overview);
	assert_at_view(all, 14, walk);
	assert_at_view(all, 28, a);
	g_array_unref(m.chunks);
}

static const struct {
	const char *spec, *message;
} bad_paths[] = {
	{ "", "there is no path ''; there are: orbit[:DEGREES[:FRAMES]], dolly[:FACTOR[:FRAMES]], "
	      "pan[:PIXELS[:FRAMES]], stations[:FRAMES], views:A,B,C[:FRAMES]" },
	{ "orbits:1", "there is no path 'orbits'; there are: orbit[:DEGREES[:FRAMES]], "
		      "dolly[:FACTOR[:FRAMES]], pan[:PIXELS[:FRAMES]], stations[:FRAMES], "
		      "views:A,B,C[:FRAMES]" },
	{ "orbit:x", "path 'orbit:x': 'x' is not degrees a frame from -180 to 180 "
		     "(orbit[:DEGREES[:FRAMES]])" },
	{ "orbit:", "path 'orbit:': '' is not degrees a frame from -180 to 180 "
		    "(orbit[:DEGREES[:FRAMES]])" },
	{ "orbit:nan", "path 'orbit:nan': 'nan' is not degrees a frame from -180 to 180 "
		       "(orbit[:DEGREES[:FRAMES]])" },
	{ "dolly:0", "path 'dolly:0': '0' is not the factor from 0.001 to 1000 "
		     "(dolly[:FACTOR[:FRAMES]])" },
	{ "dolly:2:0", "path 'dolly:2:0': '0' is no number of frames from 1 to 100000 "
		       "(dolly[:FACTOR[:FRAMES]])" },
	{ "pan:8:100001", "path 'pan:8:100001': '100001' is no number of frames from 1 to 100000 "
			  "(pan[:PIXELS[:FRAMES]])" },
	{ "pan:8:40:3", "path 'pan:8:40:3': '3' is one part too many (pan[:PIXELS[:FRAMES]])" },
	{ "stations:1:2", "path 'stations:1:2': '2' is one part too many (stations[:FRAMES])" },
	{ "stations:60000", "path 'stations:60000': has 120001 frames; 100000 are the most "
			    "(stations[:FRAMES])" },
	{ "views", "path 'views': two views are the least (views:A,B,C[:FRAMES])" },
	{ "views:plan", "path 'views:plan': two views are the least (views:A,B,C[:FRAMES])" },
	{ "views:walk,x",
		"path 'views:walk,x': there is no view 'x'; there are: overview, plan, plan:1.2, "
		"elevation-north, elevation-south, elevation-east, elevation-west, section-a, "
		"section-b, walk, station-1, station-2, station-3; or eye and target in metres, as "
		"in 0,-10,2:0,0,1" },
	{ "views:walk,section-a:9",
		"path 'views:walk,section-a:9': the camera moves in perspective, which the view "
		"'section-a' has not (views:A,B,C[:FRAMES])" },
};

static void test_bad_paths(struct model_site *m, gconstpointer data)
{
	g_autoptr(view) v = any_view("x"), plan = find(m, "plan"), down = find(m, "1,2,50:1,2,0");
	g_autoptr(GError) steep = NULL, few = NULL, parallel = NULL;
	(void)data;
	for (size_t i = 0; i < G_N_ELEMENTS(bad_paths); i++) {
		g_autoptr(GError) error = NULL;
		g_assert_null(camera_path_parse(bad_paths[i].spec, v, &m->sources, &error));
		g_assert_cmpstr(error->message, ==, bad_paths[i].message);
	}
	g_assert_null(camera_path_parse("orbit", plan, &m->sources, &parallel));
	g_assert_cmpstr(parallel->message, ==,
		"path 'orbit': the camera moves in perspective, which the view 'plan' has not "
		"(orbit[:DEGREES[:FRAMES]])");
	g_assert_null(camera_path_parse("pan", down, &m->sources, &steep));
	g_assert_cmpstr(steep->message, ==,
		"path 'pan': the view is too steep to pan, more than 80 degrees "
		"(pan[:PIXELS[:FRAMES]])");
	m->sources.station_count = 1;
	g_assert_null(camera_path_parse("stations", v, &m->sources, &few));
	g_assert_cmpstr(few->message, ==,
		"path 'stations': the site has 1 stations; two are the least (stations[:FRAMES])");
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	ADD_COURT("/path/orbit", test_orbit);
	ADD_COURT("/path/dolly", test_dolly);
	ADD_COURT("/path/pan", test_pan);
	ADD_COURT("/path/stations", test_through_stations);
	ADD_PLACE("/path/views", test_through_views);
	ADD_COURT("/path/refused", test_bad_paths);
	return g_test_run();
}
