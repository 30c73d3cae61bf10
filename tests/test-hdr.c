/* Scans with photos at stops, of three exposures each: against the truth of the light, against plain scans, and with cameras that are late, lose
 * frames, round, refuse or are unplugged. */
#include "acquire/brackets.h"
#include "acquire/marks.h"
#include "acquire/scan-manifest.h"
#include "acquire/srgb.h"
#include "sim/truth.h"
#include "tests/simulated.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

/* Windows into the day, and deep shade. */
#define BRIGHT "hall?seed=3&ares=360&camera=120x200"
#define HALL   "hall?seed=3&ares=360&camera=48x80"
#define STOPS  18u

/* ---- a camera between the simulator's and the scan ---- */

struct odd_camera {
	camera base, *inner;
	/* What is odd about it; zeros: nothing. */
	uint32_t late;      /* frames that still have the controls before, after these change */
	uint32_t lose_each; /* of so many frames one does not come */
	uint32_t rounds_to_100us; /* exposures are multiples of it */
	uint32_t gone_after;      /* frames of the stops */
	bool deaf, mute;          /* keeps its exposure; does not tell it */
	uint32_t stale, frames;
	struct camera_controls now;
};

static bool odd_set(camera *c, const struct camera_controls *controls, GError **error)
{
	struct odd_camera *o = (struct odd_camera *)c;
	struct camera_controls wanted = *controls;
	uint32_t step = MAX(o->rounds_to_100us, 1);
	wanted.exposure_100us = MAX((wanted.exposure_100us + step / 2) / step, 1) * step;
	if (o->deaf)
		wanted.exposure_100us = 50;
	if (memcmp(&wanted, &o->now, sizeof wanted) == 0)
		return true;
	o->now = wanted;
	o->stale = o->late;
	return o->stale > 0 || o->inner->ops->set_controls(o->inner, &wanted, error);
}

static struct camera_controls told(const struct odd_camera *o, struct camera_controls controls)
{
	controls.exposure_100us = o->mute ? 0 : controls.exposure_100us;
	return controls;
}

static void odd_get(camera *c, struct camera_controls *ret)
{
	const struct odd_camera *o = (const struct odd_camera *)c;
	*ret = told(o, o->now);
}

static bool odd_queue(camera *c, GError **error)
{
	struct odd_camera *o = (struct odd_camera *)c;
	return o->inner->ops->queue(o->inner, error);
}

static int odd_read(camera *c, struct camera_frame_info *info, const uint8_t **pixels,
	size_t *bytes, int64_t *arrival_ns, GError **error)
{
	struct odd_camera *o = (struct odd_camera *)c;
	bool gone = o->gone_after && o->frames >= o->gone_after;
	int n = gone ? -1 : o->inner->ops->read(o->inner, info, pixels, bytes, arrival_ns, error);
	if (gone)
		g_set_error_literal(error, WIRE_ERROR, WIRE_ERROR_GONE, "the camera was unplugged");
	if (n <= 0)
		return n;
	o->frames++;
	if (o->lose_each && o->frames % o->lose_each == 0)
		return 0;
	info->controls = told(o, info->controls);
	if (o->stale && --o->stale == 0 && !o->inner->ops->set_controls(o->inner, &o->now, error))
		return -1;
	return 1;
}

static const struct camera_ops odd_ops = {
	.set_controls = odd_set, .get_controls = odd_get, .queue = odd_queue, .read = odd_read
};

/* ---- an emergency stop once there are so many photos ---- */

static struct stage_ops pressed_ops;
static const struct stage_ops *true_ops;
static bool press;

static gssize pressed_read(
	stage *s, const struct stage_event **events, int64_t *arrival_ns, GError **error)
{
	static struct stage_event pressed = { .kind = STAGE_ESTOP_PRESSED };
	if (!press)
		return true_ops->read(s, events, arrival_ns, error);
	press = false;
	*events = &pressed;
	*arrival_ns = head_now_ns(s->head);
	return 1;
}

static void make_pressable(head *h)
{
	true_ops = h->stage->ops;
	pressed_ops = *true_ops;
	pressed_ops.read = pressed_read;
	h->stage->ops = &pressed_ops;
}

/* ---- scans ---- */

struct bench {
	char *folder, *site_path;
	struct scan_result result;
	uint32_t partial, stop_after, press_after; /* photos; 0: never */
	struct run_progress last;
	GError *error;
};

static void set_up(struct bench *b, gconstpointer data)
{
	(void)data;
	b->folder = simulated_folder();
	b->site_path = g_build_filename(b->folder, "site", NULL);
}

static void tear_down(struct bench *b, gconstpointer data)
{
	(void)data;
	g_clear_error(&b->error);
	g_free(b->folder);
	g_free(b->site_path);
}

static bool is_stopped(const struct run_progress *p, gpointer user_data)
{
	struct bench *b = user_data;
	g_assert_cmpuint(p->photos_taken, <=, p->photos_wanted);
	b->last = *p;
	press |= b->press_after && p->photos_taken == b->press_after;
	return b->stop_after && p->photos_taken >= b->stop_after;
}

static bool scan(struct bench *b, const char *description, struct scan_options options,
	struct odd_camera *odd)
{
	g_autofree char *uri = g_strconcat("sim:", description, NULL);
	g_clear_error(&b->error);
	g_autoptr(site) s = site_open_for_writing(b->site_path, &b->error);
	g_assert_no_error(b->error);
	simulated *simulator = simulated_start(description, NULL, NULL);
	options.head = simulated_take_head(simulator);
	options.preset = preset_find("draft");
	options.device = uri;
	options.progress = is_stopped;
	options.user_data = b;
	make_pressable(options.head);
	if (odd) {
		odd->base = (camera){ .ops = &odd_ops, .head = options.head };
		odd->inner = options.head->camera;
		options.head->camera = &odd->base;
	}
	bool good = scan_record(s, &options, &b->result, &b->partial, &b->error);
	simulated_stop(simulator);
	return good;
}

static void scan_whole(struct bench *b, const char *description, struct scan_options options,
	struct odd_camera *odd)
{
	scan(b, description, options, odd);
	g_assert_no_error(b->error);
	g_assert_cmpuint(b->result.missing_columns, ==, 0);
}

static char *record_path(const struct bench *b, uint32_t number, bool partial)
{
	return g_strdup_printf(partial ? "%s/scans/.%04u.partial/raw.rec" : "%s/scans/%04u/raw.rec",
		b->site_path, number);
}

static panorama *load(const struct bench *b, uint32_t number)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(site) s = site_open(b->site_path, &error);
	panorama *p = scan_load(s, number, true, &error);
	g_assert_no_error(error);
	return p;
}

/* ---- what a record says of stops ---- */

struct walk {
	stream *stream;
	struct exposures stop;
	int64_t arrival_ns;
	uint32_t came;                 /* a bit for each exposure of the stop */
	uint32_t stops, whole, frames; /* of the present session; whole: all exposures came */
	uint32_t strays;               /* locked, but of no stop */
};

static void walk_stop(const struct exposures *e, gpointer user_data)
{
	struct walk *w = user_data;
	w->stop = *e;
	w->stops += e->count > 0;
	w->came = 0;
}

/* From before the exposure to after it the stage does not turn. */
static void walk_frame(const struct camera_frame_info *info, const uint8_t *pixels,
	double front_rad, bool locked, gpointer user_data)
{
	struct walk *w = user_data;
	(void)pixels;
	w->strays += locked && w->stop.count == 0;
	int exposure = exposures_find(&w->stop, &info->controls);
	if (exposure < 0)
		return;
	uint32_t all = (1u << w->stop.count) - 1, before_it = w->came;
	w->came |= 1u << exposure;
	w->whole += before_it != all && w->came == all;
	int64_t before_ns = w->arrival_ns - 40000000 - info->controls.exposure_100us * 100000ll;
	const stage_track *track = stream_stage(w->stream);
	double before = stage_track_angle_rad(track, before_ns),
	       after = stage_track_angle_rad(track, w->arrival_ns), spacing = 2 * G_PI / STOPS;
	/* Between its last pulse and the next one the track lets the rotor creep by that step. */
	g_assert_cmpfloat(fabs(after - before), <, 2 * G_PI / 11886);
	g_assert_cmpfloat(fabs(front_rad - before), <, 2 * G_PI / 11886);
	g_assert_cmpfloat(fabs(remainder(front_rad - spacing / 2, spacing)), <, 0.1 * G_PI / 180);
	w->frames++;
}

/* Counts are those of the last session. */
static struct walk walk_record(const char *path)
{
	struct walk w = { 0 };
	struct stream_sink sink = { .frame = walk_frame, .stop = walk_stop, .user_data = &w };
	g_autoptr(stream) s = w.stream = stream_new(STREAM_LEARN_FIRST, &sink);
	for (int pass = 0; pass < 2; pass++) {
		g_autoptr(record_reader) r = record_open(path, NULL);
		struct record_entry e;
		while (record_next(r, &e, NULL) == RECORD_ENTRY) {
			w.arrival_ns = e.time_ns;
			g_assert_true(stream_feed(s, &e, NULL));
			if (e.kind == RECORD_SESSION)
				w.stops = w.whole = w.frames = 0;
		}
		if (pass == 0)
			stream_rewind(s);
	}
	w.stream = NULL;
	return w;
}

static void test_at_rest(struct bench *b, gconstpointer data)
{
	(void)data;
	scan_whole(b, HALL, (struct scan_options){ .hdr = true }, NULL);
	g_autofree char *path = record_path(b, 1, false);
	struct walk w = walk_record(path);
	g_assert_cmpuint(w.stops, ==, STOPS);
	g_assert_cmpuint(w.whole, ==, STOPS);
	g_assert_cmpuint(w.frames, ==, 3 * STOPS);
	g_assert_cmpuint(w.strays, ==, 0);
	g_assert_cmpuint(b->result.photos, ==, STOPS);
	g_assert_cmpuint(b->result.merged_photos, ==, STOPS);
	g_assert_cmpuint(b->last.photos_taken, ==, STOPS);
	g_assert_cmpuint(b->last.photos_wanted, ==, STOPS);
}

/* ---- light ---- */

struct seen {
	double *light; /* of each cell, green: 1 is white in the base exposure; below 0: an edge */
	panorama *plain, *hdr; /* of the same place */
};

static double exposure_of(const char *path)
{
	g_autoptr(record_reader) r = record_open(path, NULL);
	struct record_entry e;
	while (record_next(r, &e, NULL) == RECORD_ENTRY) {
		struct mark m = { 0 };
		if (e.kind == RECORD_MARK && (m = mark_read(e.payload, e.length)).locks)
			return exposures_light(&m.locked);
	}
	return 0;
}

static void light_at(const truth *t, const panorama *p, uint32_t row, uint32_t column, double white,
	double rgb[3])
{
	double azimuth = panorama_azimuth_rad(p, row, column),
	       elevation = panorama_elevation_rad(p, row, column);
	double local[3] = { cos(elevation) * sin(azimuth), cos(elevation) * cos(azimuth),
		sin(elevation) },
	       direction[3];
	const struct world_station *at = truth_station(t);
	float light[3];
	for (int i = 0; i < 3; i++)
		direction[i] = at->rotation[i][0] * local[0] + at->rotation[i][1] * local[1] +
			       at->rotation[i][2] * local[2];
	world_radiance(truth_world(t), at->position_m, direction, 1, light);
	for (int i = 0; i < 3; i++)
		rgb[i] = light[i] / white;
}

/* Whether the light changes about a cell: photos are coarser than cells, and the camera stands a little beside. */
static bool is_edge(
	const double *light, uint32_t columns, uint32_t rows, uint32_t row, uint32_t column)
{
	double low = INFINITY, high = 0;
	for (int k = 0; k < 25; k++) {
		uint32_t at_row = (uint32_t)CLAMP((int)row + k / 5 - 2, 0, (int)rows - 1),
			 at_column = (column + columns + (uint32_t)(k % 5) - 2) % columns;
		double here = light[3 * (at_row * columns + at_column)];
		low = fmin(low, here);
		high = fmax(high, here);
	}
	return high - low > 0.25 * high;
}

static void find_light(struct seen *s, const char *description, double exposure)
{
	g_autoptr(truth) t = truth_new(description, NULL);
	const panorama *p = s->plain;
	uint32_t w = p->desc.columns, h = p->desc.rows;
	g_autofree double *all = g_new(double, 3 * (size_t)w * h);
	s->light = g_new(double, 3 * (size_t)w * h);
	for (uint32_t i = 0; i < w * h; i++)
		light_at(t, p, i / w, i % w, 50 / exposure, all + 3 * i);
	for (uint32_t i = 0; i < 3 * w * h; i++)
		s->light[i] = is_edge(all + i % 3, w, h, i / 3 / w, i / 3 % w) ? -1 : all[i];
}

/* What is wanted of a colour: its light through the curve, or cut off at white. */
static double wanted(const struct seen *s, const panorama *p, double light)
{
	return 255 * srgb_of(p == s->hdr ? brackets_tone(light) : fmin(light, 1));
}

static int compare(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

static double median(GArray *values)
{
	qsort(values->data, values->len, sizeof(double), compare);
	return values->len ? g_array_index(values, double, values->len / 2) : NAN;
}

/* Of colours whose light lies between: what they are, what they should be, and how far they are off, each in the median. */
struct band {
	uint32_t count;
	double is, wanted, off;
};

static struct band band_of(const struct seen *s, const panorama *p, double from, double to)
{
	g_autoptr(GArray) is = g_array_new(FALSE, FALSE, sizeof(double)),
			  light = g_array_new(FALSE, FALSE, sizeof(double)),
			  off = g_array_new(FALSE, FALSE, sizeof(double));
	for (size_t i = 0; i < 3 * (size_t)p->desc.columns * p->desc.rows; i++) {
		double colour = p->rgb[i], beside = fabs(colour - wanted(s, p, s->light[i]));
		if (s->light[i] < from || s->light[i] >= to)
			continue;
		g_array_append_val(is, colour);
		g_array_append_val(light, s->light[i]);
		g_array_append_val(off, beside);
	}
	return (struct band){ is->len, median(is), wanted(s, p, median(light)), median(off) };
}

static struct band both(const struct seen *s, double from, double to, struct band *ret_hdr)
{
	struct band plain = band_of(s, s->plain, from, to), hdr = band_of(s, s->hdr, from, to);
	g_test_message("light %.2f to %.2f, %u colours: plain %.1f (%.1f wanted, off by %.2f), HDR "
		       "%.1f (%.1f wanted, off by %.2f)",
		from, to, hdr.count, plain.is, plain.wanted, plain.off, hdr.is, hdr.wanted,
		hdr.off);
	g_assert_cmpuint(hdr.count, >=, 30);
	*ret_hdr = hdr;
	return plain;
}

static void check_light(const struct seen *s)
{
	static const double bright[] = { 1.05, 1.4, 2, 2.4, 3 };
	struct band plain, hdr;
	double last = 0;
	/* Where the plain scan is flat white the light still differs, in the order of the truth. */
	for (size_t i = 0; i + 1 < G_N_ELEMENTS(bright); i++) {
		plain = both(s, bright[i], bright[i + 1], &hdr);
		g_assert_cmpfloat(plain.is, >=, 252);
		g_assert_cmpfloat(hdr.is, >, last);
		g_assert_cmpfloat(fabs(hdr.is - hdr.wanted), <, 2);
		last = hdr.is;
	}
	/* Between, both are the same; in the shade the longer exposure is nearer to the truth. */
	plain = both(s, 0.1, 0.45, &hdr);
	g_assert_cmpfloat(fabs(plain.is - hdr.is), <, 1.5);
	plain = both(s, 0.03, 0.1, &hdr);
	g_assert_cmpfloat(hdr.off, <, plain.off);
}

static void test_light(struct bench *b, gconstpointer data)
{
	struct seen s = { 0 };
	(void)data;
	scan_whole(b, BRIGHT, (struct scan_options){ 0 }, NULL);
	g_assert_cmpuint(b->result.merged_photos, ==, 0);
	scan_whole(b, BRIGHT, (struct scan_options){ .hdr = true }, NULL);
	g_assert_cmpuint(b->result.merged_photos, ==, STOPS);
	g_autofree char *path = record_path(b, 2, false);
	s.plain = load(b, 1);
	s.hdr = load(b, 2);
	find_light(&s, BRIGHT, exposure_of(path));
	check_light(&s);
	g_free(s.light);
	panorama_free(s.plain);
	panorama_free(s.hdr);
}

/* ---- cut off, and gone on with ---- */

/* As a kill leaves it: behind the first frame of the last stop, which wants two more. How many stops before are whole. */
static uint32_t cut_inside_stop(const char *path)
{
	g_autoptr(record_reader) r = record_open(path, NULL);
	struct record_entry e;
	struct exposures stop = { 0 };
	uint32_t whole = 0, came = 0;
	uint64_t cut = 0;
	while (record_next(r, &e, NULL) == RECORD_ENTRY) {
		struct mark m =
			e.kind == RECORD_MARK ? mark_read(e.payload, e.length) : (struct mark){ 0 };
		if (m.stops) {
			stop = m.stop;
			came = 0;
		}
		came += e.kind == RECORD_FRAME && stop.count > 0;
		whole += came == 3 && e.kind == RECORD_FRAME;
		if (came == 1 && e.kind == RECORD_FRAME)
			cut = record_reader_position(r);
	}
	g_assert_cmpint(truncate(path, (off_t)cut), ==, 0);
	return whole - 1;
}

static void test_resumed(struct bench *b, gconstpointer data)
{
	(void)data;
	b->stop_after = 7;
	g_assert_false(scan(b, HALL, (struct scan_options){ .hdr = true }, NULL));
	g_assert_error(b->error, PUMP_ERROR, PUMP_ERROR_STOPPED);
	g_assert_cmpuint(b->partial, ==, 1);
	g_autofree char *cut = record_path(b, 1, true), *whole = record_path(b, 1, false);
	uint32_t kept = cut_inside_stop(cut);
	g_assert_cmpuint(kept, ==, 6);
	b->stop_after = 0;
	scan_whole(b, HALL, (struct scan_options){ .resume = true }, NULL);
	struct walk w = walk_record(whole);
	g_assert_cmpuint(w.stops, ==, STOPS - kept);
	g_assert_cmpuint(w.frames, ==, 3 * (STOPS - kept));
	g_assert_cmpuint(b->result.report.sessions, ==, 2);
	g_assert_cmpuint(b->result.photos, ==, STOPS);
	g_assert_cmpuint(b->result.merged_photos, ==, STOPS);
	/* Offline the same comes out. */
	g_autoptr(site) s = site_open_for_writing(b->site_path, NULL);
	g_autoptr(panorama) before = load(b, 1);
	g_assert_true(scan_develop_again(s, 1, &b->error));
	g_autoptr(panorama) after = load(b, 1);
	g_assert_cmpmem(before->rgb, 3 * 750 * 198, after->rgb, 3 * 750 * 198);
}

static void test_emergency_stop(struct bench *b, gconstpointer data)
{
	(void)data;
	b->press_after = 5;
	g_assert_false(scan(b, HALL, (struct scan_options){ .hdr = true }, NULL));
	g_assert_error(b->error, PUMP_ERROR, PUMP_ERROR_ESTOP);
	g_assert_cmpuint(b->partial, ==, 1);
	b->press_after = 0;
	press = false;
	scan_whole(b, HALL, (struct scan_options){ .resume = true }, NULL);
	g_assert_cmpuint(b->result.merged_photos, ==, STOPS);
}

/* ---- cameras ---- */

static void test_unplugged(struct bench *b, gconstpointer data)
{
	struct odd_camera odd = { .gone_after = 40 };
	(void)data;
	scan_whole(b, HALL, (struct scan_options){ .hdr = true }, &odd);
	g_assert_cmpuint(b->result.merged_photos, >, 4);
	g_assert_cmpuint(b->result.merged_photos, <, STOPS);
	g_assert_cmpuint(b->result.photos, <, STOPS);
}

static const struct camera_case {
	const char *path;
	struct odd_camera odd;
	uint32_t merged;
} cameras[] = {
	{ "/hdr/camera/late", { .late = 3 }, STOPS },
	{ "/hdr/camera/loses-frames", { .lose_each = 5 }, STOPS },
	{ "/hdr/camera/rounds", { .rounds_to_100us = 7 }, STOPS },
	{ "/hdr/camera/keeps-its-exposure", { .deaf = true }, 0 },
	{ "/hdr/camera/does-not-tell", { .mute = true }, 0 },
};

static void test_camera(struct bench *b, gconstpointer data)
{
	const struct camera_case *c = data;
	struct odd_camera odd = c->odd;
	scan_whole(b, HALL, (struct scan_options){ .hdr = true }, &odd);
	g_autofree char *path = record_path(b, 1, false),
			*json = g_strdup_printf("%s/scans/0001/scan.json", b->site_path);
	struct walk w = walk_record(path);
	g_autoptr(manifest) m = manifest_load(json, SCAN_SCHEMA, NULL);
	int64_t merged;
	/* One that loses frames can need more stops. */
	g_assert_cmpuint(w.whole, ==, STOPS);
	g_assert_cmpuint(w.strays, ==, 0);
	g_assert_cmpuint(b->result.photos, ==, STOPS);
	g_assert_cmpuint(b->result.merged_photos, ==, c->merged);
	g_assert_true(b->result.hdr && scan_manifest_is_hdr(m));
	g_assert_true(manifest_get_int(m, "hdr.photos", 0, 100, &merged, NULL));
	g_assert_cmpint(merged, ==, c->merged);
}

/* ---- refused ---- */

static void test_no_camera(struct bench *b, gconstpointer data)
{
	(void)data;
	g_assert_false(scan(
		b, "hall?seed=3&ares=360&camera=none", (struct scan_options){ .hdr = true }, NULL));
	g_assert_cmpstr(b->error->message, ==,
		"the head has no camera that is calibrated to it: HDR is not for it");
	g_assert_cmpuint(b->partial, ==, 0);
}

static void test_misuse(struct bench *b, gconstpointer data)
{
	static const char *const with[] = { "--resume", "--discard" };
	static const char *const says[] = { "--hdr is for a new scan", "--discard goes alone" };
	g_autofree char *program =
		g_build_filename(g_getenv("PLEINAIR_BIN"), "pleinair-scan", NULL);
	(void)data;
	for (int i = 0; i < 2; i++) {
		char *argv[] = { program, b->site_path, (char *)"--hdr", (char *)with[i], NULL };
		g_autofree char *said = NULL;
		int status;
		g_assert_true(g_spawn_sync(NULL, argv, NULL, G_SPAWN_STDOUT_TO_DEV_NULL, NULL, NULL,
			NULL, &said, &status, NULL));
		g_assert_cmpint(WEXITSTATUS(status), ==, 2);
		g_assert_nonnull(strstr(said, says[i]));
	}
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	if (!g_getenv("PLEINAIR_BIN"))
		g_setenv("PLEINAIR_BIN", "build/bin", TRUE);
#define ADD(name, test) g_test_add("/hdr/" name, struct bench, NULL, set_up, test, tear_down)
	ADD("at-rest", test_at_rest);
	ADD("light", test_light);
	ADD("resumed", test_resumed);
	ADD("emergency-stop", test_emergency_stop);
	ADD("unplugged", test_unplugged);
	ADD("no-camera", test_no_camera);
	ADD("misuse", test_misuse);
	for (size_t i = 0; i < G_N_ELEMENTS(cameras); i++)
		g_test_add(
			cameras[i].path, struct bench, &cameras[i], set_up, test_camera, tear_down);
	return g_test_run();
}
