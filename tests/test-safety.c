/* Emergency stop, interlock and button: what becomes of a scan, that nothing is lost, that nothing moves or shines until somebody says
 * that it is safe. And stamps of the host's own clock, which stages with such inputs give. */
#include "acquire/run.h"
#include "acquire/scan-manifest.h"
#include "firmware-io/stage-track.h"
#include "tests/simulated.h"
#include <math.h>
#include <string.h>

#define HALL      "hall?seed=3&ares=360&camera=none"
#define SECOND_NS INT64_C(1000000000)

/* ---- scans ---- */

static const struct scene {
	const char *path, *fault;
	int code;
	enum stage_event_kind kind;
	bool ramps;
} scenes[] = {
	{ "/safety/estop", "estop@700", PUMP_ERROR_ESTOP, STAGE_ESTOP_PRESSED, false },
	{ "/safety/interlock", "interlock@700", PUMP_ERROR_INTERLOCK, STAGE_INTERLOCK_OPENED,
		true },
};

/* What a record tells of the time since the guard struck. */
struct aftermath {
	uint32_t struck, steps, stops, orders;
	char *last_order;
};

static void count_stage(struct aftermath *a, const struct record_entry *e, uint8_t kind)
{
	const struct stage_event *events = e->payload;
	for (size_t i = 0; i < e->length / sizeof *events; i++) {
		a->struck += events[i].kind == kind;
		a->steps += a->struck && events[i].kind == STAGE_STEP;
		a->stops += a->struck && events[i].kind == STAGE_STOPPED;
	}
}

static struct aftermath read_aftermath(const char *path, uint8_t kind)
{
	struct aftermath a = { 0 };
	g_autoptr(GError) error = NULL;
	g_autoptr(record_reader) r = record_open(path, &error);
	struct record_entry e;
	g_assert_no_error(error);
	while (record_next(r, &e, NULL) == RECORD_ENTRY) {
		if (e.kind == RECORD_STAGE)
			count_stage(&a, &e, kind);
		if (!a.struck || e.kind != RECORD_LIDAR_OUT)
			continue;
		a.orders++;
		g_free(a.last_order);
		a.last_order = g_strndup(e.payload, e.length);
	}
	return a;
}

static void assert_like_whole(const char *path, const struct scan_result *r)
{
	g_autofree char *folder = simulated_folder(), *to = g_build_filename(folder, "site", NULL);
	g_autoptr(site) a = site_open(path, NULL);
	uint32_t number = simulated_draft(to, HALL);
	g_autoptr(site) b = site_open(to, NULL);
	g_autoptr(panorama) p = scan_load(a, r->number, true, NULL),
			    q = scan_load(b, number, true, NULL);
	size_t both = 0, same = 0;
	g_assert_nonnull(p);
	g_assert_nonnull(q);
	for (size_t i = 0; i < (size_t)p->desc.columns * p->desc.rows; i++)
		if (p->cell[i] == CELL_MEASURED && q->cell[i] == CELL_MEASURED) {
			both++;
			same += fabsf(p->range_m[i] - q->range_m[i]) < 0.1f + 0.03f * p->range_m[i];
		}
	g_test_message("%.2f %% of %zu cells agree", 100.0 * (double)same / (double)both, both);
	g_assert_cmpuint(both, >, 10000);
	g_assert_cmpfloat((double)same, >, 0.97 * (double)both);
}

static void assert_replays(const char *raw, int code)
{
	g_autofree char *folder = simulated_folder(), *to = g_build_filename(folder, "site", NULL),
			*uri = g_strconcat("replay:", raw, NULL);
	struct scan_options o = { .device = uri, .preset = preset_find("draft") };
	struct scan_result result;
	uint32_t partial;
	g_autoptr(GError) error = NULL;
	g_autoptr(site) s = site_open_for_writing(to, NULL);
	g_assert_false(scan_record(s, &o, &result, &partial, &error));
	g_assert_error(error, PUMP_ERROR, code);
	g_assert_cmpuint(partial, ==, 1);
}

static void test_scan(gconstpointer data)
{
	const struct scene *t = data;
	g_autofree char *folder = simulated_folder(),
			*path = g_build_filename(folder, "site", NULL),
			*description = g_strconcat(HALL "&fault=", t->fault, NULL);
	struct scan_options o = { .preset = preset_find("draft") };
	struct scan_result result;
	uint32_t partial;
	g_autoptr(GError) error = NULL;
	g_assert_false(
		simulated_scan(path, description, &o, NULL, NULL, &result, &partial, &error));
	g_assert_error(error, PUMP_ERROR, t->code);
	g_test_message("%s", error->message);
	g_assert_cmpuint(partial, ==, 1);

	g_autoptr(site) s = site_open(path, NULL);
	g_autofree char *at = site_partial_path(s, partial),
			*raw = g_build_filename(at, "raw.rec", NULL);
	struct aftermath a = read_aftermath(raw, t->kind);
	g_test_message("%u steps, %u stops, %u orders, the last '%s'", a.steps, a.stops, a.orders,
		a.last_order);
	g_assert_cmpuint(a.struck, ==, 1);
	g_assert_cmpuint(a.steps > 0, ==, t->ramps);
	g_assert_cmpuint(a.stops > 0, ==, t->ramps);
	g_assert_cmpuint(a.orders, ==, 1);
	g_assert_cmpstr(a.last_order, ==, "QT\n");
	g_free(a.last_order);
	assert_replays(raw, t->code);

	struct scan_options again = { .resume = true };
	g_clear_pointer(&s, site_free);
	g_assert_true(simulated_scan(path, HALL, &again, NULL, NULL, &result, &partial, NULL));
	g_assert_cmpuint(result.report.sessions, ==, 2);
	g_assert_cmpuint(result.missing_columns, ==, 0);
	g_assert_cmpuint(result.report.lost_revolutions, ==, 0);
	g_assert_cmpuint(result.report.suspect_intervals, ==, 0);
	assert_like_whole(path, &result);
}

/* ---- a head of the test's own, whose stage is listened to ---- */

static struct {
	const struct stage_ops *real;
	struct stage_ops ours;
	bool emitting;
	uint32_t lit, dark;
	int button_in; /* reads from now; below 0: never */
} heard;

static void show_emitting(stage *s, bool emitting)
{
	(void)s;
	heard.lit += emitting && !heard.emitting;
	heard.dark += !emitting && heard.emitting;
	heard.emitting = emitting;
}

static gssize read_with_button(
	stage *s, const struct stage_event **ret_events, int64_t *ret_arrival_ns, GError **error)
{
	static const struct stage_event button = { .kind = STAGE_BUTTON, .ticks = 12345 };
	if (heard.button_in < 0 || heard.button_in-- > 0)
		return heard.real->read(s, ret_events, ret_arrival_ns, error);
	*ret_events = &button;
	*ret_arrival_ns = head_now_ns(s->head);
	return 1;
}

static head *open_heard(simulated *s, int button_in)
{
	head *h = simulated_take_head(s);
	heard.real = h->stage->ops;
	heard.ours = *heard.real;
	heard.ours.read = read_with_button;
	heard.ours.emitting = show_emitting;
	heard.button_in = button_in;
	heard.emitting = false;
	heard.lit = heard.dark = 0;
	h->stage->ops = &heard.ours;
	return h;
}

static run *prepare_run(head *h, bool (*progress)(const struct run_progress *, gpointer))
{
	struct run_options o = { .preset = preset_find("draft"), .progress = progress };
	g_autofree char *text = scan_session_text("sim:" HALL, h);
	struct record_entry e = { .kind = RECORD_SESSION,
		.length = strlen(text),
		.time_ns = head_now_ns(h),
		.payload = text };
	run *r = run_new(h, &o);
	g_assert_true(run_begin(r, &e, NULL));
	g_assert_true(run_prepare(r, NULL));
	return r;
}

static bool shines(const struct run_progress *p, gpointer user_data)
{
	(void)user_data;
	if (p->column_fraction > 0 && p->column_fraction < 1)
		g_assert_true(heard.emitting);
	return false;
}

static void test_light(void)
{
	simulated *s = simulated_start(HALL, NULL, NULL);
	head *h = open_heard(s, -1);
	g_autoptr(GError) error = NULL;
	g_autoptr(run) r = prepare_run(h, shines);
	g_assert_true(run_scan(r, &error));
	g_assert_no_error(error);
	g_assert_false(heard.emitting);
	/* For the pass and for the look back. */
	g_assert_cmpuint(heard.lit, ==, 2);
	g_assert_cmpuint(heard.dark, ==, 2);
	head_close(h);
	simulated_stop(s);
}

static void test_button(void)
{
	simulated *s = simulated_start(HALL, NULL, NULL);
	head *h = open_heard(s, 3);
	g_autoptr(GError) error = NULL;
	g_autoptr(run) r = prepare_run(h, NULL); /* where it means nothing */
	g_assert_cmpint(heard.button_in, <, 0);
	heard.button_in = 2000;
	g_assert_false(run_scan(r, &error));
	g_assert_error(error, PUMP_ERROR, PUMP_ERROR_STOPPED);
	g_assert_nonnull(strstr(error->message, "button"));
	g_assert_cmpuint(heard.lit, ==, 1);
	g_assert_false(heard.emitting);
	head_close(h);
	simulated_stop(s);
}

static void assert_no_move(head *h, int code)
{
	struct stage_move move = { 1000, 1000, 10000 };
	g_autoptr(GError) error = NULL;
	g_assert_false(stage_start_move(h->stage, &move, &error));
	g_assert_error(error, STAGE_ERROR, code);
}

/* Steps within the time. */
static uint32_t steps_for(head *h, int64_t time_ns)
{
	uint32_t steps = 0;
	for (int64_t until_ns = head_now_ns(h) + time_ns; head_now_ns(h) < until_ns;) {
		const struct stage_event *events;
		int64_t at_ns;
		gssize n;
		uint8_t byte[4096];
		g_assert_true(head_wait(h, until_ns, NULL));
		while (wire_read(h->lidar, byte, sizeof byte, &at_ns, NULL) > 0)
			;
		while ((n = stage_read(h->stage, &events, &at_ns, NULL)) > 0)
			for (gssize i = 0; i < n; i++)
				steps += events[i].kind == STAGE_STEP;
	}
	return steps;
}

static void test_reset(void)
{
	simulated *s = simulated_start(HALL "&fault=estop@300:3", NULL, NULL);
	head *h = open_heard(s, -1);
	g_autoptr(GError) error = NULL, still = NULL;
	g_autoptr(run) r = prepare_run(h, NULL);
	g_assert_false(run_scan(r, &error));
	g_assert_error(error, PUMP_ERROR, PUMP_ERROR_ESTOP);
	g_assert_false(heard.emitting);
	assert_no_move(h, STAGE_ERROR_ESTOP);
	g_assert_false(stage_reset(h->stage, &still));
	g_assert_error(still, STAGE_ERROR, STAGE_ERROR_ESTOP);
	g_assert_cmpuint(steps_for(h, 4 * SECOND_NS), ==, 0);
	assert_no_move(h, STAGE_ERROR_NOT_RESET);
	/* Released is not reset, and a reset starts nothing by itself. */
	g_assert_true(stage_reset(h->stage, NULL));
	g_assert_cmpuint(steps_for(h, SECOND_NS), ==, 0);
	g_assert_true(stage_start_move(h->stage, &(struct stage_move){ 0, 1000, 10000 }, NULL));
	g_assert_cmpuint(steps_for(h, SECOND_NS), >, 100);
	head_close(h);
	simulated_stop(s);
}

/* ---- stamps of the host's clock ---- */

#define STEPS 400

static int64_t time_of_step_ns(int k)
{
	/* The low 32 bits of microseconds wrap half-way. */
	return (INT64_C(3) << 32) * 1000 + (k - STEPS / 2) * INT64_C(1000000);
}

/* Three events a batch: a step, and two that say nothing of motion and whose stamps are wild. */
static void feed_steps(stream *s)
{
	GRand *rand = g_rand_new_with_seed(5);
	for (int k = 0; k < STEPS; k++) {
		struct stage_event e[] = {
			{ .kind = STAGE_SYNC, .ticks = g_rand_int(rand) },
			{ .kind = k ? STAGE_STEP : STAGE_HOME,
				.direction = 1,
				.flags = STAGE_EVENT_HOST_CLOCK,
				.ticks = (uint32_t)(time_of_step_ns(k) / 1000) },
			{ .kind = k % 2 ? STAGE_BUTTON : STAGE_INTERLOCK_CLOSED,
				.direction = -1,
				.ticks = g_rand_int(rand),
				.flags = k % 3 ? STAGE_EVENT_HOST_CLOCK : 0 },
		};
		struct record_entry entry = { .kind = RECORD_STAGE,
			.length = sizeof e,
			.payload = e,
			.time_ns = time_of_step_ns(k) + g_rand_int_range(rand, 0, 900000000) };
		g_assert_true(stream_feed(s, &entry, NULL));
	}
	g_rand_free(rand);
}

static void test_stamps(gconstpointer data)
{
	bool live = GPOINTER_TO_INT(data);
	simulated *sim = simulated_start(HALL, NULL, NULL);
	head *h = simulated_take_head(sim);
	g_autofree char *text = scan_session_text("sim:" HALL, h);
	struct record_entry begin = { .kind = RECORD_SESSION,
		.length = strlen(text),
		.time_ns = time_of_step_ns(0),
		.payload = text };
	g_autoptr(stream) s =
		stream_new(live ? STREAM_LIVE : STREAM_LEARN_FIRST, &(struct stream_sink){ 0 });
	g_assert_true(stream_feed(s, &begin, NULL));
	feed_steps(s);
	if (!live) {
		stream_rewind(s);
		g_assert_true(stream_feed(s, &begin, NULL));
		feed_steps(s);
	}
	const stage_track *track = stream_stage(s);
	double step_rad = 2 * G_PI / stream_calibration(s)->stage.steps_per_turn;
	g_assert_true(stage_track_is_homed(track));
	g_assert_cmpint(stage_track_known_until_ns(track), ==, time_of_step_ns(STEPS - 1));
	for (int k = 1; k < STEPS; k++)
		g_assert_cmpfloat_with_epsilon(
			stage_track_angle_rad(track, time_of_step_ns(k)), k * step_rad, 1e-12);
	head_close(h);
	simulated_stop(sim);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	for (size_t i = 0; i < G_N_ELEMENTS(scenes); i++)
		g_test_add_data_func(scenes[i].path, &scenes[i], test_scan);
	g_test_add_func("/safety/light", test_light);
	g_test_add_func("/safety/button", test_button);
	g_test_add_func("/safety/reset", test_reset);
	g_test_add_data_func("/safety/stamps/live", GINT_TO_POINTER(1), test_stamps);
	g_test_add_data_func("/safety/stamps/learnt", GINT_TO_POINTER(0), test_stamps);
	return g_test_run();
}
