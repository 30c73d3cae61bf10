/* The pan stage on pins: when steps are due, and the thread that makes them, on a chip of the test's own. */
#include "firmware-io/stage-pins.h"
#include "firmware-io/stage-track.h"
#include "firmware-io/step-ramp.h"
#include "tests/gpio-made.h"
#include <math.h>
#include <poll.h>

#define SECOND_NS INT64_C(1000000000)

/* ---- ramps ---- */

struct walk {
	int64_t steps, last_ns;
	int count;
	double worst_rate, worst_acceleration;
};

/* All steps of a ramp; rates and accelerations between them are looked at. */
static struct walk walk_on(struct step_ramp *r, int64_t steps, int64_t from_ns, int64_t until_ns)
{
	struct walk w = { .steps = steps, .last_ns = from_ns };
	int64_t at_ns, before_ns = 0;
	double rate_before = NAN;
	int direction;
	while (step_ramp_next(r, w.steps, w.last_ns, &at_ns, &direction) && at_ns <= until_ns) {
		g_assert_cmpint(at_ns, >=, w.last_ns);
		double rate = w.count ? direction / ((double)(at_ns - w.last_ns) * 1e-9) : NAN;
		w.worst_rate = fmax(w.worst_rate, isnan(rate) ? 0 : fabs(rate));
		if (!isnan(rate_before) && !isnan(rate))
			w.worst_acceleration = fmax(w.worst_acceleration,
				fabs(rate - rate_before) / ((double)(at_ns - before_ns) * 0.5e-9));
		before_ns = w.last_ns;
		rate_before = rate;
		w.last_ns = at_ns;
		w.steps += direction;
		w.count++;
	}
	return w;
}

/* t_n = sqrt(2 n / a) from rest, v / a + (n - v^2 / 2a) / v at speed: DEVICES 4.2. */
static void test_ramp_from_rest(void)
{
	struct step_ramp r = { 0 };
	const double v = 1000, a = 4000;
	int64_t at_ns, begin_ns = 5 * SECOND_NS;
	int direction;
	step_ramp_rest(&r, begin_ns, 0);
	g_assert_false(step_ramp_next(&r, 0, begin_ns, &at_ns, &direction));
	step_ramp_move(&r, begin_ns, &(struct stage_move){ 1000, v, a });
	for (int n = 0; n < 1000; n++) {
		double k = n + 1, ramp = v * v / (2 * a),
		       t = k <= ramp ? sqrt(2 * k / a) : v / a + (k - ramp) / v;
		if (k > 1000 - ramp)
			t = 2 * v / a + (1000 - 2 * ramp) / v - sqrt(2 * (1000 - k) / a);
		g_assert_true(step_ramp_next(&r, n, begin_ns, &at_ns, &direction));
		g_assert_cmpint(direction, ==, 1);
		g_assert_cmpfloat_with_epsilon((double)(at_ns - begin_ns) * 1e-9, t, 2e-9);
	}
	g_assert_false(step_ramp_next(&r, 1000, begin_ns, &at_ns, &direction));
}

/* Every move ends on its target, never faster or harder than asked. */
static void test_ramp_limits(void)
{
	for (int i = 0; i < 400; i++) {
		struct step_ramp r = { 0 };
		double v = g_test_rand_double_range(20, 3000),
		       a = g_test_rand_double_range(100, 20000);
		int64_t target = g_test_rand_int_range(-3000, 3000);
		step_ramp_rest(&r, 0, 0);
		step_ramp_move(&r, 0, &(struct stage_move){ target, v, a });
		struct walk w = walk_on(&r, 0, 0, INT64_MAX);
		g_assert_cmpint(w.steps, ==, target);
		g_assert_cmpint(w.count, ==, ABS(target));
		g_assert_cmpfloat(w.worst_rate, <=, v * 1.001);
		/* Between whole steps a mean is seen: on the first ones up to half as much again. */
		g_assert_cmpfloat(w.worst_acceleration, <=, 1.6 * a);
	}
}

/* Told something else on the way: it ends there, without a jump of its rate. */
static void test_ramp_retargeted(void)
{
	for (int i = 0; i < 400; i++) {
		struct step_ramp r = { 0 };
		double v = g_test_rand_double_range(100, 2000),
		       a = g_test_rand_double_range(500, 9000);
		int64_t target = g_test_rand_int_range(-2000, 2000),
			other = g_test_rand_int_range(-2000, 2000);
		step_ramp_rest(&r, 0, 0);
		step_ramp_move(&r, 0, &(struct stage_move){ target, v, a });
		int64_t cut_ns = (int64_t)(g_test_rand_double_range(0, 1.5) * 1e9);
		struct walk first = walk_on(&r, 0, 0, cut_ns);
		double rate = step_ramp_rate(&r, cut_ns), position = step_ramp_position(&r, cut_ns);
		g_assert_cmpfloat(fabs(position - (double)first.steps), <=, 1.0 + 1e-6);
		bool stop = i % 3 == 0;
		if (stop)
			step_ramp_stop(&r, cut_ns);
		else
			step_ramp_move(&r, cut_ns, &(struct stage_move){ other, v, a });
		/* What would rest within a millionth of a step, or two by rounding up to a whole one, rests. */
		double rests = rate * rate / (2 * a) <= 2e-6 ? fabs(rate) : 0;
		g_assert_cmpfloat_with_epsilon(
			step_ramp_rate(&r, cut_ns), rate, 1e-6 + fabs(rate) * 1e-9 + rests);
		struct walk rest = walk_on(&r, first.steps, MAX(first.last_ns, cut_ns), INT64_MAX);
		if (!stop)
			g_assert_cmpint(rest.steps, ==, other);
		else
			g_assert_cmpfloat(
				fabs((double)rest.steps - position), <=, rate * rate / (2 * a) + 2);
		g_assert_cmpfloat(rest.worst_rate, <=, fmax(v, fabs(rate)) * 1.01);
	}
}

/* Put off, what follows keeps its distances. */
static void test_ramp_delayed(void)
{
	struct step_ramp r = { 0 };
	int64_t a_ns, b_ns;
	int direction;
	step_ramp_rest(&r, 0, 0);
	step_ramp_move(&r, 0, &(struct stage_move){ 500, 500, 5000 });
	step_ramp_next(&r, 250, 0, &a_ns, &direction);
	step_ramp_delay(&r, 7000000);
	step_ramp_next(&r, 250, 0, &b_ns, &direction);
	g_assert_cmpint(b_ns - a_ns, ==, 7000000);
}

/* ---- the thread ---- */

#define ALL                                                                                        \
	"tim:?stage.chip=made&stage.step=step&stage.dir=dir&stage.enable=enable&stage.home=home&"  \
	"stage.index=index&stage.estop=estop&"                                                     \
	"stage.interlock=interlock&stage.button=button&stage.sync=sync&stage.led_ready=led_ready&" \
	"stage.led_emitting=led_emitting&"                                                         \
	"stage.led_fault=led_fault"

struct events {
	GArray *all; /* of struct stage_event */
};

static stage *open_stage(const char *uri)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(parts) p = parts_read(uri, &error);
	g_assert_no_error(error);
	stage *s = stage_new_pins_on(NULL, p, made_open, &error);
	g_assert_no_error(error);
	return s;
}

static guint count_of(const GArray *all, enum stage_event_kind kind)
{
	guint n = 0;
	for (guint i = 0; i < all->len; i++)
		n += g_array_index(all, struct stage_event, i).kind == kind;
	return n;
}

/* Reads until there are so many of a kind. */
static void await(stage *s, GArray *all, enum stage_event_kind kind, guint wanted)
{
	int64_t deadline_ns = inbox_now_ns() + 20 * SECOND_NS;
	while (count_of(all, kind) < wanted) {
		const struct stage_event *events;
		int64_t arrival_ns;
		struct pollfd p = { .fd = s->ops->wait_fd(s), .events = POLLIN };
		g_assert_cmpint(inbox_now_ns(), <, deadline_ns);
		poll(&p, 1, 100);
		gssize n = s->ops->read(s, &events, &arrival_ns, NULL);
		g_array_append_vals(all, events, (guint)n);
	}
}

static GArray *new_events(void)
{
	return g_array_new(FALSE, FALSE, sizeof(struct stage_event));
}

static void move_to(stage *s, int64_t target, double rate)
{
	g_autoptr(GError) error = NULL;
	s->ops->move(s, &(struct stage_move){ target, rate, rate * 8 }, &error);
	g_assert_no_error(error);
}

static void assert_refused(stage *s, const char *words)
{
	g_autoptr(GError) error = NULL;
	g_assert_false(s->ops->move(s, &(struct stage_move){ 100, 100, 1000 }, &error));
	g_assert_nonnull(strstr(error->message, words));
}

/* Each pulse has its event, at its instant; there and back. */
static void test_pulses(void)
{
	g_autoptr(GArray) all = new_events();
	stage *s = open_stage(ALL);
	move_to(s, 200, 1000);
	await(s, all, STAGE_STOPPED, 1);
	move_to(s, 50, 1000);
	await(s, all, STAGE_STOPPED, 2);
	g_assert_cmpuint(count_of(all, STAGE_STEP), ==, 350);
	g_assert_true(made_level("enable"));
	int64_t at = 0, dir_ns = 0;
	guint event = 0;
	bool forward = false;
	for (guint i = 0; i < made_chip->changes->len; i++) {
		const struct made_change *c =
			&g_array_index(made_chip->changes, struct made_change, i);
		const char *name = made_chip->names[c->line];
		if (strcmp(name, "dir") == 0) {
			forward = c->on;
			dir_ns = c->time_ns;
		}
		if (strcmp(name, "step") != 0)
			continue;
		if (!c->on) {
			g_assert_cmpint(c->time_ns - g_array_index(made_chip->changes,
							     struct made_change, i - 1)
							     .time_ns,
				>=, 2000);
			continue;
		}
		g_assert_cmpint(c->time_ns - dir_ns, >=, 1000);
		at += forward ? 1 : -1;
		while (g_array_index(all, struct stage_event, event).kind != STAGE_STEP)
			event++;
		const struct stage_event *e = &g_array_index(all, struct stage_event, event++);
		g_assert_cmpint(e->direction, ==, forward ? 1 : -1);
		g_assert_cmpuint(e->flags, ==, STAGE_EVENT_HOST_CLOCK);
		/* Stamped before the pin went up, and little before. */
		int64_t off_us = (int32_t)((uint32_t)(c->time_ns / 1000) - e->ticks);
		g_assert_cmpint(off_us, >=, 0);
		g_assert_cmpint(off_us, <, 20000);
	}
	g_assert_cmpint(at, ==, 50);
	struct stage_pins_counts counts = stage_pins_count(s);
	g_assert_cmpuint(counts.steps, ==, 350);
	g_test_message("%s, latest step %.3f ms, %u put off",
		counts.has_priority ? "real-time priority" : "no priority",
		(double)counts.latest_ns * 1e-6, (unsigned)counts.late_steps);
	s->ops->close(s);
}

/* Late steps must not be made up for by intervals shorter than asked for. */
static void test_no_interval_is_short(void)
{
	g_autoptr(GArray) all = new_events();
	stage *s = open_stage(ALL);
	move_to(s, 600, 600);
	await(s, all, STAGE_STOPPED, 1);
	int64_t before_ns = 0;
	for (guint i = 0; i < made_chip->changes->len; i++) {
		const struct made_change *c =
			&g_array_index(made_chip->changes, struct made_change, i);
		if (!c->on || strcmp(made_chip->names[c->line], "step") != 0)
			continue;
		/* A quarter may be missing where a step was late by less than that. */
		if (before_ns)
			g_assert_cmpfloat((double)(c->time_ns - before_ns), >=, 0.74e9 / 600);
		before_ns = c->time_ns;
	}
	s->ops->close(s);
}

/* A stop ends soon, on a whole step; replacing a move turns round. */
static void test_stop_and_turn(void)
{
	g_autoptr(GArray) all = new_events();
	stage *s = open_stage(ALL);
	move_to(s, 100000, 800);
	await(s, all, STAGE_STEP, 200);
	s->ops->stop(s, NULL);
	await(s, all, STAGE_STOPPED, 1);
	guint there = count_of(all, STAGE_STEP);
	g_assert_cmpuint(there, <, 2000);
	move_to(s, 100000, 800);
	await(s, all, STAGE_STEP, there + 100);
	move_to(s, 0, 800);
	await(s, all, STAGE_STOPPED, 2);
	int64_t at = 0;
	for (guint i = 0; i < all->len; i++) {
		const struct stage_event *e = &g_array_index(all, struct stage_event, i);
		at += e->kind == STAGE_STEP ? e->direction : 0;
	}
	g_assert_cmpint(at, ==, 0);
	s->ops->close(s);
}

static guint steps_made(void)
{
	guint n = 0;
	g_mutex_lock(&made_chip->lock);
	for (guint i = 0; i < made_chip->changes->len; i++) {
		const struct made_change *c =
			&g_array_index(made_chip->changes, struct made_change, i);
		n += c->on && strcmp(made_chip->names[c->line], "step") == 0;
	}
	g_mutex_unlock(&made_chip->lock);
	return n;
}

/* Pressed: no step after it, no power; and three things until it moves again. */
static void press(const char *uri, bool silently)
{
	g_autoptr(GArray) all = new_events();
	g_autoptr(GError) error = NULL;
	stage *s = open_stage(uri);
	move_to(s, 100000, 800);
	await(s, all, STAGE_STEP, 100);
	(silently ? made_pull_silently : made_pull)("estop", false);
	await(s, all, STAGE_ESTOP_PRESSED, 1);
	guint made = steps_made();
	await(s, all, STAGE_STOPPED, 1);
	g_usleep(50000);
	g_assert_cmpuint(steps_made(), ==, made);
	g_assert_false(made_level("enable"));
	g_assert_false(made_level("led_ready"));
	assert_refused(s, "emergency stop is pressed");
	g_assert_false(s->ops->reset(s, &error));
	g_assert_nonnull(strstr(error->message, "still pressed"));
	made_pull("estop", true);
	await(s, all, STAGE_ESTOP_RELEASED, 1);
	assert_refused(s, "not reset");
	g_clear_error(&error);
	g_assert_true(s->ops->reset(s, &error));
	guint before = count_of(all, STAGE_STEP);
	move_to(s, 0, 800);
	await(s, all, STAGE_STOPPED, 2);
	g_assert_cmpuint(count_of(all, STAGE_STEP), >, before);
	s->ops->close(s);
}

static void test_estop(void)
{
	press(ALL, false);
}

/* Its edge was lost: the level tells. */
static void test_estop_without_edge(void)
{
	press(ALL, true);
}

static void test_estop_at_boot(void)
{
	g_autoptr(GArray) all = new_events();
	made_off[0] = "estop";
	made_off[1] = "interlock";
	stage *s = open_stage(ALL);
	made_off[0] = made_off[1] = NULL;
	await(s, all, STAGE_ESTOP_PRESSED, 1);
	await(s, all, STAGE_INTERLOCK_OPENED, 1);
	assert_refused(s, "emergency stop is pressed");
	made_pull("estop", true);
	await(s, all, STAGE_ESTOP_RELEASED, 1);
	assert_refused(s, "interlock is open");
	made_pull("interlock", true);
	await(s, all, STAGE_INTERLOCK_CLOSED, 1);
	assert_refused(s, "not reset");
	g_assert_true(s->ops->reset(s, NULL));
	move_to(s, 10, 100);
	await(s, all, STAGE_STOPPED, 1);
	s->ops->close(s);
}

/* Opened: it ramps down, and keeps its power. */
static void test_interlock(void)
{
	g_autoptr(GArray) all = new_events();
	stage *s = open_stage(ALL);
	move_to(s, 100000, 800);
	await(s, all, STAGE_STEP, 300);
	made_pull("interlock", false);
	await(s, all, STAGE_INTERLOCK_OPENED, 1);
	guint at = steps_made();
	await(s, all, STAGE_STOPPED, 1);
	/* 800 steps a second at 6400 a second squared take 50 steps. */
	g_assert_cmpuint(steps_made() - at, >, 20);
	g_assert_cmpuint(steps_made() - at, <, 120);
	g_assert_true(made_level("enable"));
	made_pull("interlock", true);
	await(s, all, STAGE_INTERLOCK_CLOSED, 1);
	assert_refused(s, "not reset");
	g_assert_true(s->ops->reset(s, NULL));
	move_to(s, 0, 2000);
	await(s, all, STAGE_STOPPED, 2);
	s->ops->close(s);
}

/* A switch that bounces counts once, by its first edge; the same edge of a slot counts both ways. */
static void test_slots(void)
{
	g_autoptr(GArray) all = new_events();
	stage *s = open_stage(ALL);
	made_pull("index", true);
	int64_t first_us = inbox_now_ns() / 1000;
	made_pull("index", false);
	made_pull("index", true);
	await(s, all, STAGE_INDEX, 1);
	const struct stage_event *e = &g_array_index(all, struct stage_event, all->len - 1);
	g_assert_cmpint(ABS((int32_t)((uint32_t)first_us - e->ticks)), <, 1000);
	g_usleep(10000);
	made_pull("index", false); /* forwards, the far edge says nothing */
	g_usleep(10000);
	move_to(s, -20, 200);
	await(s, all, STAGE_STOPPED, 1);
	g_assert_cmpuint(count_of(all, STAGE_INDEX), ==, 1);
	made_pull("index", true); /* backwards it is the first that says nothing */
	g_usleep(10000);
	made_pull("index", false);
	await(s, all, STAGE_INDEX, 2);
	g_assert_cmpint(g_array_index(all, struct stage_event, all->len - 1).direction, ==, -1);
	made_pull("sync", true);
	made_pull("sync", false);
	await(s, all, STAGE_SYNC, 1);
	made_pull("button", true);
	made_pull("button", false);
	made_pull("button", true);
	await(s, all, STAGE_BUTTON, 1);
	g_usleep(50000);
	await(s, all, STAGE_SYNC, 1);
	g_assert_cmpuint(count_of(all, STAGE_BUTTON), ==, 1);
	s->ops->close(s);
}

/* Nobody reads any more: it stops by itself, and says so. */
static void test_queue_full(void)
{
	g_autoptr(GArray) all = new_events();
	stage *s = open_stage("tim:?stage.chip=made&stage.step=step&stage.dir=dir&stage.home=home&"
			      "stage.sync=sync");
	for (int i = 0; i < 66000; i++) {
		made_pull("sync", true);
		made_pull("sync", false);
		/* The stage must keep up with the test, not the test with the stage. */
		for (bool behind = true; behind;) {
			g_mutex_lock(&made_chip->lock);
			behind = made_chip->edges->len > 64;
			g_mutex_unlock(&made_chip->lock);
			if (behind)
				g_usleep(100);
		}
	}
	move_to(s, 1000, 500);
	g_usleep(300000);
	guint made = steps_made();
	g_assert_cmpuint(made, <, 10);
	await(s, all, STAGE_FAULT, 1);
	s->ops->close(s);
}

static void test_chip_gone(void)
{
	g_autoptr(GArray) all = new_events();
	stage *s = open_stage(ALL);
	move_to(s, 100000, 500);
	await(s, all, STAGE_STEP, 50);
	g_mutex_lock(&made_chip->lock);
	made_chip->gone = true;
	g_mutex_unlock(&made_chip->lock);
	await(s, all, STAGE_FAULT, 1);
	s->ops->close(s);
}

static void test_lights(void)
{
	g_autoptr(GArray) all = new_events();
	stage *s = open_stage(ALL);
	s->ops->emitting(s, true);
	for (int i = 0; i < 200 && !made_level("led_emitting"); i++)
		g_usleep(10000);
	g_assert_true(made_level("led_emitting"));
	g_assert_true(made_level("led_ready"));
	g_assert_false(made_level("led_fault"));
	s->ops->emitting(s, false);
	for (int i = 0; i < 200 && made_level("led_emitting"); i++)
		g_usleep(10000);
	g_assert_false(made_level("led_emitting"));
	made_pull("estop", false);
	await(s, all, STAGE_ESTOP_PRESSED, 1);
	/* A fault blinks. */
	bool lit = false, dark = false;
	for (int i = 0; i < 300 && !(lit && dark); i++, g_usleep(10000)) {
		lit |= made_level("led_fault");
		dark |= lit && !made_level("led_fault");
	}
	g_assert_true(lit && dark);
	s->ops->close(s);
}

static void test_words(void)
{
	static const struct {
		const char *uri, *words;
	} bad[] = {
		{ "tim:?stage.chip=made&stage.dir=dir&stage.home=home",
			"does not say on which line 'step' is" },
		{ "tim:?stage.chip=made&stage.step=1&stage.dir=2", "'home'" },
		{ "tim:?stage.chip=made&stage.step=1&stage.dir=2&stage.home=3&stage.rate_max=fast",
			"rate_max=fast" },
	};
	for (size_t i = 0; i < G_N_ELEMENTS(bad); i++) {
		g_autoptr(GError) error = NULL;
		g_autoptr(parts) p = parts_read(bad[i].uri, NULL);
		g_assert_null(stage_new_pins_on(NULL, p, made_open, &error));
		g_assert_nonnull(strstr(error->message, bad[i].words));
	}
	/* The real opener, on a machine without such a chip. */
	g_autoptr(GError) error = NULL;
	struct gpio_line_desc line = { "step", true, false };
	g_assert_null(gpio_lines_open("pleinair-no-such-chip", &line, 1, &error));
	g_assert_nonnull(strstr(error->message, "pleinair-no-such-chip cannot be found"));
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/stage-pins/ramp/from-rest", test_ramp_from_rest);
	g_test_add_func("/stage-pins/ramp/limits", test_ramp_limits);
	g_test_add_func("/stage-pins/ramp/retargeted", test_ramp_retargeted);
	g_test_add_func("/stage-pins/ramp/delayed", test_ramp_delayed);
	g_test_add_func("/stage-pins/pulses", test_pulses);
	g_test_add_func("/stage-pins/no-interval-is-short", test_no_interval_is_short);
	g_test_add_func("/stage-pins/stop-and-turn", test_stop_and_turn);
	g_test_add_func("/stage-pins/estop", test_estop);
	g_test_add_func("/stage-pins/estop-without-edge", test_estop_without_edge);
	g_test_add_func("/stage-pins/estop-at-boot", test_estop_at_boot);
	g_test_add_func("/stage-pins/interlock", test_interlock);
	g_test_add_func("/stage-pins/slots", test_slots);
	g_test_add_func("/stage-pins/queue-full", test_queue_full);
	g_test_add_func("/stage-pins/chip-gone", test_chip_gone);
	g_test_add_func("/stage-pins/lights", test_lights);
	g_test_add_func("/stage-pins/words", test_words);
	return g_test_run();
}
