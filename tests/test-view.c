/* Views of a site: those that people saved, those that every site has, and which one is meant. */
#include "tests/views-made.h"
#include <json-glib/json-glib.h>

static void assert_same(const view *a, const view *b)
{
	g_assert_cmpstr(a->name, ==, b->name);
	g_assert_cmpstr(a->title, ==, b->title);
	g_assert_cmpstr(a->style, ==, b->style);
	g_assert_cmpmem(a->eye_m, sizeof a->eye_m, b->eye_m, sizeof b->eye_m);
	g_assert_cmpmem(a->target_m, sizeof a->target_m, b->target_m, sizeof b->target_m);
	g_assert_cmpfloat(a->fov_deg, ==, b->fov_deg);
	g_assert_cmpfloat(a->height_m, ==, b->height_m);
	g_assert_cmpfloat(a->depth_m, ==, b->depth_m);
	g_assert_cmpfloat(a->cut_m, ==, b->cut_m);
	g_assert_true(a->is_cut == b->is_cut);
	g_assert_cmpmem(a->span_m, sizeof a->span_m, b->span_m, sizeof b->span_m);
}

/* ---- saved ---- */

static void write_file(const struct place *p, const char *name, const char *text)
{
	g_autofree char *folder = g_build_filename(site_path(p->site), "views", NULL);
	g_autofree char *path = g_build_filename(folder, name, NULL);
	g_assert_true(files_make_folder(folder, NULL));
	g_assert_true(files_write(path, text, strlen(text), NULL));
}

static void make_parallel(view *v, int i)
{
	v->fov_deg = CAMERA_PARALLEL_FOV_DEG;
	v->height_m = random_between(0.1, 300);
	v->depth_m = i % 2 ? random_between(0.1, 300) : 0;
	v->is_cut = i % 4 > 1;
	v->cut_m = i % 4 > 2 ? 0.05 : 0;
	v->span_m[1] = v->height_m / 2;
}

static void test_saved_views_are_the_same(struct place *p, gconstpointer data)
{
	(void)data;
	for (int i = 0; i < 50; i++) {
		g_autoptr(GError) error = NULL;
		g_autoptr(view) v = any_view("gate-1");
		v->style = i % 2 ? g_strdup("ink") : NULL;
		if (i % 3 == 0)
			make_parallel(v, i);
		save(p, v);
		g_autoptr(view) again = view_load(p->site, "gate-1", &error);
		g_assert_no_error(error);
		assert_same(v, again);
	}
}

static void test_other_keys_stay(struct place *p, gconstpointer data)
{
	(void)data;
	write_file(p, "gate.json",
		"{ \"schema\": 1, \"name\": \"gate\", \"eye_m\": [0, 0, 2], \"forward\": [0, 0, "
		"-3],"
		" \"fov_deg\": 50, \"season\": \"winter\" }");
	g_autoptr(view) v = view_load(p->site, "gate", NULL);
	const double ahead[3] = { 0, 0, 2 - VIEW_AHEAD_M };
	g_assert_cmpstr(v->title, ==, "gate");
	assert_near(v->target_m, ahead, 1e-12);
	v->fov_deg = 70;
	save(p, v);
	g_autofree char *path = g_build_filename(site_path(p->site), "views", "gate.json", NULL);
	g_autoptr(manifest) m = manifest_load(path, VIEW_SCHEMA, NULL);
	g_assert_cmpstr(manifest_get_string(m, "season", NULL), ==, "winter");
	g_assert_false(manifest_has(m, "forward"));
}

static void test_list_and_remove(struct place *p, gconstpointer data)
{
	static const char *const names[] = { "b", "a-2", "a", "Z" }, *const sorted[] = { "Z", "a",
		"a-2", "b" };
	g_autoptr(GError) error = NULL;
	g_autoptr(GPtrArray) none = view_list(p->site, NULL, &error);
	(void)data;
	g_assert_cmpuint(none->len, ==, 0);
	for (int i = 0; i < 4; i++) {
		g_autoptr(view) v = any_view(names[i]);
		save(p, v);
	}
	write_file(p, "broken.json", "{");
	write_file(p, "notes.txt", "no view");
	write_file(p, ".gate.json.new", "{");
	g_autoptr(GPtrArray) damaged = g_ptr_array_new_with_free_func(g_free);
	g_autoptr(GPtrArray) list = view_list(p->site, damaged, &error);
	g_assert_no_error(error);
	g_assert_cmpuint(list->len, ==, 4);
	for (int i = 0; i < 4; i++)
		g_assert_cmpstr(((view *)list->pdata[i])->name, ==, sorted[i]);
	g_assert_cmpuint(damaged->len, ==, 1);
	g_assert_nonnull(strstr(damaged->pdata[0], "/oak/views/broken.json: "));
	g_assert_true(view_remove(p->site, "a", &error));
	g_assert_false(view_remove(p->site, "a", &error));
	g_assert_error(error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND);
	g_assert_null(view_load(p->site, "a", NULL));
	g_assert_false(view_remove(p->site, "../site", NULL));
}

#define PLACES "\"eye_m\":[1,2,3],\"target_m\":[4,5,6]"
static const struct {
	const char *text, *message;
} damages[] = {
	{ "", "is empty" },
	{ "{\"schema\":1,", "line 1, column 13: a text in quotation marks is expected here" },
	{ "{\"schema\":2}", "was written by a later version (schema 2; this program knows 1)" },
	{ "{\"schema\":1," PLACES ",\"fov_deg\":50}", "'name' is missing" },
	{ "{\"schema\":1,\"name\":\"yard\"," PLACES ",\"fov_deg\":50}",
		"'name' is \"yard\", not that of the file" },
	{ "{\"schema\":1,\"name\":\"../gate\"," PLACES ",\"fov_deg\":50}",
		"'name' is \"../gate\"; it must be 1 to 64 letters of a-z and A-Z, digits, - and "
		"_" },
	{ "{\"schema\":1,\"name\":\"gate\",\"title\":5," PLACES ",\"fov_deg\":50}",
		"'title' is a number; it must be a text" },
	{ "{\"schema\":1,\"name\":\"gate\",\"title\":\"a\\nb\"," PLACES ",\"fov_deg\":50}",
		"'title' has a control character" },
	{ "{\"schema\":1,\"name\":\"gate\",\"style\":\"\"," PLACES ",\"fov_deg\":50}",
		"'style' must have 1 to 1000 bytes" },
	{ "{\"schema\":1,\"name\":\"gate\",\"target_m\":[4,5,6],\"fov_deg\":50}",
		"'eye_m' is missing" },
	{ "{\"schema\":1,\"name\":\"gate\",\"eye_m\":[1,2],\"target_m\":[4,5,6],\"fov_deg\":50}",
		"'eye_m' is not three numbers" },
	{ "{\"schema\":1,\"name\":\"gate\",\"eye_m\":[1,2,1e9],\"target_m\":[4,5,6],\"fov_deg\":"
	  "50}",
		"'eye_m' is more than 10000 km away" },
	{ "{\"schema\":1,\"name\":\"gate\",\"eye_m\":[1,2,3],\"fov_deg\":50}",
		"'target_m' is missing" },
	{ "{\"schema\":1,\"name\":\"gate\",\"eye_m\":[1,2,3],\"target_m\":[1,2,3],\"fov_deg\":50}",
		"'target_m' is where 'eye_m' is" },
	{ "{\"schema\":1,\"name\":\"gate\",\"eye_m\":[1,2,3],\"forward\":[0,0,0],\"fov_deg\":50}",
		"'forward' is no direction" },
	{ "{\"schema\":1,\"name\":\"gate\"," PLACES "}", "'fov_deg' is missing" },
	{ "{\"schema\":1,\"name\":\"gate\"," PLACES ",\"fov_deg\":171}",
		"'fov_deg' is 171; it must be 1 to 170" },
	{ "{\"schema\":1,\"name\":\"gate\"," PLACES ",\"projection\":\"round\"}",
		"'projection' is \"round\"; it must be \"perspective\" or \"parallel\"" },
	{ "{\"schema\":1,\"name\":\"gate\"," PLACES ",\"projection\":\"parallel\"}",
		"'height_m' is missing" },
	{ "{\"schema\":1,\"name\":\"gate\"," PLACES ",\"projection\":\"parallel\",\"height_m\":0}",
		"'height_m' is 0; it must be 0.01 to 100000" },
	{ "{\"schema\":1,\"name\":\"gate\"," PLACES
	  ",\"projection\":\"parallel\",\"height_m\":9,\"cut\":1}",
		"'cut' is neither true nor false" },
	{ "{\"schema\":1,\"name\":\"gate\"," PLACES
	  ",\"projection\":\"parallel\",\"height_m\":9,\"span_m\":[1]}",
		"'span_m' is not two numbers" },
};

static void test_damaged_files(struct place *p, gconstpointer data)
{
	(void)data;
	for (size_t i = 0; i < G_N_ELEMENTS(damages); i++) {
		g_autoptr(GError) error = NULL;
		g_autofree char *message = g_strdup_printf(
			"%s/views/gate.json: %s", site_path(p->site), damages[i].message);
		write_file(p, "gate.json", damages[i].text);
		g_assert_null(view_load(p->site, "gate", &error));
		g_assert_cmpstr(error->message, ==, message);
	}
}

static void test_saving_refuses(struct place *p, gconstpointer data)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(view) v = any_view("gate"), bad = any_view("a/b");
	(void)data;
	g_assert_false(view_save(bad, p->site, NULL));
	v->eye_m[1] = NAN;
	g_assert_false(view_save(v, p->site, NULL));
	v->eye_m[1] = 0;
	v->fov_deg = 0;
	g_assert_false(view_save(v, p->site, NULL));
	v->fov_deg = 50;
	write_file(p, "gate.json", "{\"schema\":9}");
	g_assert_false(view_save(v, p->site, &error));
	g_assert_error(error, MANIFEST_ERROR, MANIFEST_ERROR_SCHEMA);
	write_file(p, "gate.json", "nonsense");
	save(p, v);
}

/* ---- of every site ---- */

/* The corners of the court, but for the hundredth of the points that may be behind each edge. */
static void assert_in_picture(const view *v)
{
	struct camera c = view_camera(v, WIDTH, HEIGHT);
	for (int i = 0; i < 8; i++) {
		double corner[3] = { i & 1 ? 18 : -18, i & 2 ? 13 : -13, i & 4 ? 5 : -1.6 };
		double px[2] = { 0 }, depth = 0;
		g_assert_true(camera_project(&c, corner, px, &depth));
		g_assert_true(px[0] > 0 && px[0] < WIDTH && px[1] > 0 && px[1] < HEIGHT);
	}
}

static void test_overview(struct model_site *m, gconstpointer data)
{
	g_autoptr(view) v = find(m, "overview"), again = find(m, "overview");
	struct camera c = view_camera(v, WIDTH, HEIGHT);
	double down = -camera_elevation_rad(&c) * 180 / G_PI;
	(void)data;
	assert_same(v, again);
	assert_in_picture(v);
	g_assert_true(down > 24.9 && down < 35.1);
	g_assert_cmpfloat(v->eye_m[1], <, -20); /* from the open south */
	g_assert_cmpfloat(fabs(camera_heading_rad(&c)), <, G_PI / 4);
	g_assert_cmpfloat(distance(v->eye_m, v->target_m), <, 120);
}

static void test_plan(struct model_site *m, gconstpointer data)
{
	g_autoptr(view) v = find(m, "plan");
	(void)data;
	assert_in_picture(v);
	g_assert_true(v->eye_m[0] == v->target_m[0] && v->eye_m[1] == v->target_m[1]);
	g_assert_cmpfloat(fabs(v->eye_m[0]), <, 1);
	g_assert_true(view_is_parallel(v) && !v->is_cut);
	g_assert_cmpfloat(v->eye_m[2], >, 7);
}

/* Walls stand at x = -20 and 20 and y = 15, 0.5 m thick either way, from the ground at -1.6 to 6.4. */
static void test_plan_that_cuts(struct model_site *m, gconstpointer data)
{
	g_autoptr(view) v = find(m, "plan:2.5");
	struct camera c = view_camera(v, WIDTH, HEIGHT);
	const double above[3] = { 1, 2, 0.95 }, below[3] = { 1, 2, 0.85 };
	double px[2], depth;
	(void)data;
	g_assert_true(c.is_cut);
	g_assert_cmpfloat_with_epsilon(v->eye_m[2], 0.9, 1e-9);
	g_assert_false(camera_project(&c, above, px, &depth));
	g_assert_true(camera_project(&c, below, px, &depth));
	g_assert_cmpfloat_with_epsilon(v->span_m[0], 41, 1);
}

static void assert_looks(struct model_site *m, const char *spec, double heading_deg, bool cuts)
{
	g_autoptr(view) v = find(m, spec);
	struct camera c = view_camera(v, WIDTH, HEIGHT);
	double turned = remainder(camera_heading_rad(&c) - heading_deg * G_PI / 180, 2 * G_PI);
	g_assert_true(view_is_parallel(v) && v->is_cut == cuts);
	g_assert_cmpfloat(fabs(turned), <, 1e-9);
	g_assert_cmpfloat(fabs(camera_elevation_rad(&c)), <, 1e-9);
}

static void test_elevations(struct model_site *m, gconstpointer data)
{
	(void)data;
	assert_looks(m, "elevation-north", 180, false);
	assert_looks(m, "elevation-south", 0, false);
	assert_looks(m, "elevation-east", -90, false);
	assert_looks(m, "elevation-west", 90, false);
	g_autoptr(view) v = find(m, "elevation-south");
	assert_in_picture(v);
	g_assert_cmpfloat_with_epsilon(v->span_m[1], 8, 0.7);
	/* Walls that run at 30 degrees are seen from the front. */
	m->boxes.walls_rad = G_PI / 6;
	assert_looks(m, "elevation-south", 30, false);
	assert_looks(m, "elevation-east", -60, false);
}

/* The court is longer from west to east. */
static void test_sections(struct model_site *m, gconstpointer data)
{
	(void)data;
	assert_looks(m, "section-a", 0, true);
	assert_looks(m, "section-b", -90, true);
	assert_looks(m, "section:-10,3:10,3", 0, true);
	assert_looks(m, "section:10,3:-10,3", 180, true);
	assert_looks(m, "section:5,-4:5,9:2.5", -90, true);
	g_autoptr(view) v = find(m, "section:-10,3:8,3:2.5");
	struct camera c = view_camera(v, WIDTH, HEIGHT);
	const double first[3] = { -10, 4, 0 }, second[3] = { 8, 4, 0 }, before[3] = { 0, 2.99, 0 },
		     behind[3] = { 0, 5.6, 0 };
	double px[2] = { 0 }, depth = 0;
	g_assert_true(camera_project(&c, first, px, &depth) && px[0] > 0 && px[0] < WIDTH / 2.);
	g_assert_true(
		camera_project(&c, second, px, &depth) && px[0] > WIDTH / 2. && px[0] < WIDTH);
	g_assert_false(camera_project(&c, before, px, &depth));
	g_assert_true(camera_project(&c, behind, px, &depth) && depth > c.far_m);
	g_assert_cmpfloat_with_epsilon(v->span_m[0], 18, 1e-9);
}

static const struct {
	const char *spec, *what;
} bad_parallel[] = {
	{ "plan:", "what follows plan: is how many metres" },
	{ "plan:1x", "what follows plan: is how many metres" },
	{ "plan:nan", "what follows plan: is how many metres" },
	{ "section:", "a section is two places in metres" },
	{ "section:1,2", "a section is two places in metres" },
	{ "section:1,2:3", "a section is two places in metres" },
	{ "section:1,2:3,4:5:6", "a section is two places in metres" },
	{ "section:1,2:1,2", "both places of the section are the same" },
	{ "section:1,2:3,4:0", "a section is 0.01 to 10000 m deep" },
};

static void test_bad_parallel_views(struct model_site *m, gconstpointer data)
{
	(void)data;
	for (size_t i = 0; i < G_N_ELEMENTS(bad_parallel); i++) {
		g_autoptr(GError) error = NULL;
		view *v = NULL;
		g_autofree char *start = g_strdup_printf(
			"view '%s': %s", bad_parallel[i].spec, bad_parallel[i].what);
		g_assert_false(view_find(&m->sources, bad_parallel[i].spec, &v, &error));
		g_assert_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_ARGUMENT);
		g_assert_true(g_str_has_prefix(error->message, start));
	}
}

static void test_stations(struct model_site *m, gconstpointer data)
{
	(void)data;
	for (int k = 0; k < 3; k++) {
		g_autofree char *name = g_strdup_printf("station-%d", k + 1);
		g_autofree char *title = g_strdup_printf("From scan %d", k + 2);
		g_autoptr(view) v = find(m, name);
		g_assert_cmpstr(v->title, ==, title);
		assert_near(v->eye_m, m->stations[k].pose.translation_m, 0);
		g_assert_cmpfloat(v->fov_deg, ==, VIEW_FOV_DEG);
		struct camera c = view_camera(v, WIDTH, HEIGHT);
		g_assert_cmpfloat(fabs(camera_elevation_rad(&c)), <, 10 * G_PI / 180);
	}
	/* From the southwest there is more to see to the north and east. */
	g_autoptr(view) v = find(m, "station-1");
	struct camera c = view_camera(v, WIDTH, HEIGHT);
	g_assert_cmpfloat(fabs(camera_heading_rad(&c) - G_PI / 4), <, G_PI / 4 + 0.01);
}

static void test_walk(struct model_site *m, gconstpointer data)
{
	g_autoptr(view) v = find(m, "walk");
	struct camera c = view_camera(v, WIDTH, HEIGHT);
	double towards = atan2(-v->eye_m[0], -v->eye_m[1]);
	(void)data;
	g_assert_cmpfloat_with_epsilon(v->eye_m[2], -1.6 + VIEW_PERSON_M, 0.03);
	g_assert_cmpfloat(hypot(v->eye_m[0], v->eye_m[1]), >, 5); /* not from the middle */
	double aside = remainder(camera_heading_rad(&c) - towards, 2 * G_PI);
	g_assert_cmpfloat(fabs(aside), <, 26 * G_PI / 180);
	/* Who has nothing but the middle goes from there. */
	m->sources.stations = &m->stations[2];
	m->sources.station_count = 1;
	g_autoptr(view) other = find(m, "walk");
	g_assert_cmpfloat(other->eye_m[0], ==, 0.5);
}

/* A model that tells what it was made from. */
static model *model_made_from(const struct place *p, const char *made_from, GError **error)
{
	static const struct model_point point;
	static const struct model_chunk chunk = { .points = 1 };
	g_autofree char *path = g_build_filename(p->folder, "m", NULL);
	g_autoptr(product_writer) w = product_writer_new(path, NULL);
	JsonObject *about = json_object_new();
	json_object_set_member(about, "made_from", json_from_string(made_from, NULL));
	g_assert_true(product_writer_begin(w, "points", sizeof point, NULL));
	g_assert_true(product_writer_append(w, &point, 1, NULL));
	g_assert_true(product_writer_begin(w, "chunks", sizeof chunk, NULL));
	g_assert_true(product_writer_append(w, &chunk, 1, NULL));
	g_assert_true(product_writer_finish(w, MODEL_KIND, MODEL_VERSION, about, NULL));
	return model_open_file(path, error);
}

static void write_scan(const struct place *p, const char *name, const char *text)
{
	g_autofree char *folder = g_build_filename(site_path(p->site), "scans", name, NULL);
	g_autofree char *path = g_build_filename(folder, "scan.json", NULL);
	g_assert_true(files_make_folder(folder, NULL));
	g_assert_true(files_write(path, text, strlen(text), NULL));
}

#define TURNED "[0, 1, 0, -1, 0, 0, 0, 0, 1, 7, 8, 9]"

static void test_where_scanners_stood(struct place *p, gconstpointer data)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(model) m = model_made_from(p,
		"[{\"scan\": 9, \"pose\": [1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0]},"
		" {\"scan\": 3, \"pose\": " TURNED "}, {\"scan\": 2, \"pose\": " TURNED "}]",
		&error);
	(void)data;
	g_assert_no_error(error);
	/* 2 is a cloud, 3 was recorded, 9 was not copied along. */
	write_scan(p, "0002",
		"{\"schema\": 1, \"kind\": \"imported\", \"points\": {\"columns\": 0, \"rows\": 0},"
		" \"source\": {\"format\": \"PLY\"}, \"files\": {}}");
	write_scan(p, "0003", "{\"schema\": 1, \"files\": {}}");
	g_autoptr(GArray) stations = view_stations(p->site, m, &error);
	g_assert_no_error(error);
	g_assert_cmpuint(stations->len, ==, 2);
	const struct view_station *s = &g_array_index(stations, struct view_station, 0);
	const double at[3] = { 7, 8, 9 };
	g_assert_true(s[0].number == 3 && s[1].number == 9);
	assert_near(s[0].pose.translation_m, at, 0);
	g_assert_cmpfloat(s[0].pose.rotation[0][1], ==, 1);
	write_scan(p, "0003", "{");
	g_assert_null(view_stations(p->site, m, &error));
	g_assert_nonnull(strstr(error->message, "/scans/0003/scan.json: "));
}

static void test_models_that_do_not_tell(struct place *p, gconstpointer data)
{
	static const char *const bad[] = { "{}", "[1]", "[{}]", "[{\"scan\": 1}]",
		"[{\"scan\": 0, \"pose\": " TURNED "}]", "[{\"scan\": [], \"pose\": " TURNED "}]",
		"[{\"scan\": 1, \"pose\": [2, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0]}]" };
	(void)data;
	for (size_t i = 0; i < G_N_ELEMENTS(bad); i++) {
		g_autoptr(GError) error = NULL;
		g_autoptr(model) m = model_made_from(p, bad[i], NULL);
		g_assert_null(view_stations(p->site, m, &error));
		g_assert_error(error, PRODUCT_ERROR, PRODUCT_ERROR_DAMAGED);
		g_assert_true(g_str_has_suffix(
			error->message, "/m: does not tell where its scans stand"));
	}
}

static void test_places(struct model_site *m, gconstpointer data)
{
	const double eye[3] = { 1, -2.5, 3 }, target[3] = { 0, 40, 1e3 };
	g_autoptr(view) v = find(m, "1,-2.5,3:0,40,1e3"), wide = find(m, "0,0,0:1,0,0:90");
	(void)data;
	assert_near(v->eye_m, eye, 0);
	assert_near(v->target_m, target, 0);
	g_assert_cmpfloat(v->fov_deg, ==, VIEW_FOV_DEG);
	g_assert_cmpfloat(wide->fov_deg, ==, 90);
}

static const struct {
	const char *spec, *what;
} bad_views[] = {
	{ "1,2,3", "has not two or three parts with : between them" },
	{ "1,2,3:4,5,6:7:8", "has not two or three parts with : between them" },
	{ "1,2:4,5,6", "the eye is not three numbers of metres" },
	{ "1,2,nan:4,5,6", "the eye is not three numbers of metres" },
	{ "1,2,3:4,5,", "the target is not three numbers of metres" },
	{ "1,2,3:4,5,6x", "the target is not three numbers of metres" },
	{ "1,2,3:4,5,1e99", "the target is not three numbers of metres" },
	{ "1,2,3:4,5,6:171", "the field of view is not 1 to 170 degrees" },
	{ "1,2,3:4,5,6:", "the field of view is not 1 to 170 degrees" },
	{ "1,2,3:1,2,3", "the target is where the eye is" },
};

static void test_bad_views(struct model_site *m, gconstpointer data)
{
	(void)data;
	for (size_t i = 0; i < G_N_ELEMENTS(bad_views); i++) {
		g_autoptr(GError) error = NULL;
		view *v = NULL;
		g_autofree char *start = g_strdup_printf(
			"view '%s': %s (X,Y,Z:", bad_views[i].spec, bad_views[i].what);
		g_assert_false(view_find(&m->sources, bad_views[i].spec, &v, &error));
		g_assert_null(v);
		g_assert_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_ARGUMENT);
		g_assert_true(g_str_has_prefix(error->message, start));
	}
}

static void assert_unknown(const struct view_sources *s, const char *name, const char *there)
{
	g_autoptr(GError) error = NULL;
	view *v = NULL;
	g_autofree char *message = g_strdup_printf(
		"there is no view '%s'; there are: %s; or eye and target in metres, as in "
		"0,-10,2:0,0,1",
		name, there);
	g_assert_false(view_find(s, name, &v, &error));
	g_assert_error(error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND);
	g_assert_cmpstr(error->message, ==, message);
}

#define BUILT_IN                                                                                   \
	"overview, plan, plan:1.2, elevation-north, elevation-south, elevation-east, "             \
	"elevation-west, section-a, section-b, walk, station-1, station-2, station-3"

static void test_which_view(struct place *p, gconstpointer data)
{
	struct model_site m;
	g_autoptr(view) gate = any_view("gate"), plan = any_view("plan");
	(void)data;
	build(&m);
	m.sources.site = p->site;
	save(p, gate);
	assert_unknown(&m.sources, "oval", "gate, " BUILT_IN);
	assert_unknown(&m.sources, "station-4", "gate, " BUILT_IN);
	assert_unknown(&m.sources, "station-01", "gate, " BUILT_IN);
	g_autoptr(view) found = find(&m, "gate");
	assert_same(found, gate);
	save(p, plan); /* what people saved goes first */
	g_autoptr(view) own = find(&m, "plan");
	assert_same(own, plan);
	write_file(p, "gate.json", "{");
	view *v = NULL;
	g_assert_false(view_find(&m.sources, "gate", &v, NULL));
	m.sources.boxes = NULL;
	assert_unknown(&m.sources, "overview",
		"gate, plan; the others need a model, which the site has not");
	m.sources.site = NULL;
	assert_unknown(&m.sources, "walk", "none, since the site has no model");
	g_array_unref(m.chunks);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	ADD_PLACE("/view/saved", test_saved_views_are_the_same);
	ADD_PLACE("/view/other-keys", test_other_keys_stay);
	ADD_PLACE("/view/list", test_list_and_remove);
	ADD_PLACE("/view/damaged", test_damaged_files);
	ADD_PLACE("/view/save-refused", test_saving_refuses);
	ADD_COURT("/view/overview", test_overview);
	ADD_COURT("/view/plan", test_plan);
	ADD_COURT("/view/plan/cut", test_plan_that_cuts);
	ADD_COURT("/view/elevations", test_elevations);
	ADD_COURT("/view/sections", test_sections);
	ADD_COURT("/view/parallel/refused", test_bad_parallel_views);
	ADD_COURT("/view/stations", test_stations);
	ADD_COURT("/view/walk", test_walk);
	ADD_PLACE("/view/where-scanners-stood", test_where_scanners_stood);
	ADD_PLACE("/view/untold", test_models_that_do_not_tell);
	ADD_COURT("/view/places", test_places);
	ADD_COURT("/view/refused", test_bad_views);
	ADD_PLACE("/view/which", test_which_view);
	return g_test_run();
}
