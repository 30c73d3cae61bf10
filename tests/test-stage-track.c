/* The stage's angle from its pulses and slots, against motion that is known by formula. */
#include "firmware-io/stage-track.h"
#include <math.h>

#define SECOND_NS INT64_C(1000000000)
#define TURN      11886.0 /* steps */
#define SLOTS     24
#define HOME_AT   1000.3 /* steps from power-on */

/* A move from rest to rest along a trapezoid, or a triangle when it is short. */
struct move {
	double start_s, from, to, rate, acceleration; /* steps */
};

static double ramp_s(const struct move *m)
{
	double peak = fmin(m->rate, sqrt(m->acceleration * fabs(m->to - m->from)));
	return peak / m->acceleration;
}

static double duration_s(const struct move *m)
{
	double r = ramp_s(m);
	return fabs(m->to - m->from) / (r * m->acceleration) + r;
}

static double position_at(const struct move *m, double time_s)
{
	double r = ramp_s(m), all = duration_s(m), t = CLAMP(time_s - m->start_s, 0, all);
	double way = t < r ? m->acceleration * t * t / 2
		     : t <= all - r
			     ? m->acceleration * r * (t - r / 2)
			     : fabs(m->to - m->from) - m->acceleration * (all - t) * (all - t) / 2;
	return m->to > m->from ? m->from + way : m->from - way;
}

/* When the rotor passes a position on its way. */
static int64_t time_at_ns(const struct move *m, double position)
{
	double low = m->start_s, high = m->start_s + duration_s(m);
	for (int i = 0; i < 80; i++) {
		double middle = (low + high) / 2;
		bool before = m->to > m->from ? position_at(m, middle) < position
					      : position_at(m, middle) > position;
		*(before ? &low : &high) = middle;
	}
	return llround(high * 1e9);
}

static void feed(stage_track *t, enum stage_event_kind kind, int direction, int64_t time_ns)
{
	struct stage_event e = { .kind = kind, .direction = (int8_t)direction };
	stage_track_feed(t, &e, time_ns);
}

/* Pulses and slots of a move, in order, to its end. slip: steps that the head is behind the rotor;
 * below_slip: from this position on. */
struct slip {
	double at, steps;
};

static void feed_slots(stage_track *t, const struct move *m, double from, double to, double behind)
{
	double spacing = TURN / SLOTS;
	int direction = to > from ? 1 : -1;
	double low = fmin(from, to) - behind - HOME_AT, high = fmax(from, to) - behind - HOME_AT;
	for (double k = floor(low / spacing) + 1; k * spacing <= high; k++) {
		int64_t at_ns = time_at_ns(m, k * spacing + behind + HOME_AT);
		feed(t, STAGE_INDEX, direction, at_ns);
		if (fmod(k, SLOTS) == 0)
			feed(t, STAGE_HOME, direction, at_ns);
	}
}

static void feed_move(stage_track *t, const struct move *m, const struct slip *slip)
{
	int direction = m->to > m->from ? 1 : -1;
	double behind = 0;
	for (double at = m->from; at != m->to; at += direction) {
		if (slip && at >= slip->at)
			behind = slip->steps;
		feed_slots(t, m, at, at + direction, behind);
		feed(t, STAGE_STEP, direction, time_at_ns(m, at + direction));
	}
	feed(t, STAGE_STOPPED, 0, llround((m->start_s + duration_s(m)) * 1e9));
}

static double angle_of(double steps)
{
	return (steps - HOME_AT) * 2 * G_PI / TURN;
}

/* The greatest difference between the track and the formula, in steps, while the move lasts. */
static double worst_steps(const stage_track *t, const struct move *m, double behind)
{
	double worst = 0, end_s = m->start_s + duration_s(m);
	for (double s = m->start_s - 0.02; s < end_s + 0.02; s += 0.000713) {
		double off = stage_track_angle_rad(t, llround(s * 1e9)) -
			     angle_of(position_at(m, s) - behind);
		worst = fmax(worst, fabs(off) * TURN / (2 * G_PI));
	}
	return worst;
}

static const struct ride {
	const char *path;
	struct move moves[3];
	double tolerance_steps;
} rides[] = {
	{ "/stage-track/one-move", { { 1, 0, 4000, 1485, 1320 } }, 0.7 },
	{ "/stage-track/slow", { { 1, 0, 1300, 148, 1320 } }, 0.7 },
	{ "/stage-track/short-triangle",
		{ { 1, 0, 1010, 1485, 1320 }, { 3.5, 1010, 1014, 1485, 1320 } }, 0.7 },
	{ "/stage-track/there-and-back",
		{ { 1, 0, 3000, 1485, 1320 }, { 6, 3000, 500, 900, 2000 },
			{ 12, 500, 2500, 700, 1320 } },
		0.7 },
	{ "/stage-track/second-turn",
		{ { 1, 0, 20000, 4000, 1320 }, { 20, 20000, 26000, 1485, 1320 } }, 0.7 },
	{ "/stage-track/long-rest", { { 1, 0, 2000, 1485, 1320 }, { 900, 2000, 2400, 1485, 1320 } },
		0.7 },
};

/* Home lies between two pulses, so half a step is known less well than the pulses are. */
static void test_ride(gconstpointer data)
{
	const struct ride *r = data;
	g_autoptr(stage_track) t = stage_track_new(TURN, SLOTS);
	g_assert_false(stage_track_is_homed(t));
	for (int i = 0; i < 3 && r->moves[i].rate > 0; i++)
		feed_move(t, &r->moves[i], NULL);
	g_assert_true(stage_track_is_homed(t));
	g_assert_false(stage_track_is_moving(t));
	g_autoptr(GArray) suspects = stage_track_suspects(t);
	g_assert_cmpuint(suspects->len, ==, 0);
	for (int i = 0; i < 3 && r->moves[i].rate > 0; i++)
		g_assert_cmpfloat(worst_steps(t, &r->moves[i], 0), <, r->tolerance_steps);
}

/* The rotor rests until the next move begins; it does not creep towards that one's first pulse. */
static void test_rest(void)
{
	struct move first = { 1, 0, 2000, 1485, 1320 }, second = { 31, 2000, 2100, 1485, 1320 };
	g_autoptr(stage_track) t = stage_track_new(TURN, SLOTS);
	feed_move(t, &first, NULL);
	int64_t stopped_ns = stage_track_known_until_ns(t);
	double rest = stage_track_angle_rad(t, stopped_ns);
	feed_move(t, &second, NULL);
	for (double s = 5; s < 30.9; s += 0.31)
		g_assert_cmpfloat(
			fabs(stage_track_angle_rad(t, (int64_t)(s * 1e9)) - rest), <, 1e-9);
	/* The same before the first pulse and after the last. */
	g_assert_cmpfloat(stage_track_angle_rad(t, INT64_MIN / 2), ==, stage_track_angle_rad(t, 0));
	int64_t end_ns = stage_track_known_until_ns(t);
	g_assert_cmpfloat(
		stage_track_angle_rad(t, end_ns + SECOND_NS), ==, stage_track_angle_rad(t, end_ns));
}

static const struct slip_case {
	const char *path;
	double steps;
	bool found;
} slip_cases[] = {
	/* Slots are not cut to the step: up to a full step may be theirs (DEVICES 4.3). */
	{ "/stage-track/slip-5", 5, false },
	{ "/stage-track/slip-20", 20, true },
	{ "/stage-track/slip-100", 100, true },
	{ "/stage-track/slip-back-40", -40, true },
	{ "/stage-track/slip-half-slot", 240, true },
};

static void test_slip(gconstpointer data)
{
	const struct slip_case *c = data;
	struct move m = { 1, 0, 6000, 500, 1320 }, after = { 20, 6000, 8000, 500, 1320 };
	struct slip slip = { 3000, c->steps };
	g_autoptr(stage_track) t = stage_track_new(TURN, SLOTS);
	feed_move(t, &m, &slip);
	g_autoptr(GArray) suspects = stage_track_suspects(t);
	g_assert_cmpuint(suspects->len, ==, c->found);
	double left = c->found ? 0 : c->steps;
	if (c->found) {
		const struct stage_suspect *s = &g_array_index(suspects, struct stage_suspect, 0);
		int64_t slipped_ns = time_at_ns(&m, 3000);
		g_assert_cmpfloat(fabs(s->error_rad * TURN / (2 * G_PI) - c->steps), <, 1.1);
		/* From the last good slot to the first bad one: within two slots of the slip. */
		g_assert_cmpint(s->from_ns, <=, slipped_ns);
		g_assert_cmpint(s->to_ns, >=, slipped_ns);
		g_assert_cmpfloat((double)(s->to_ns - s->from_ns), <, 1.6e9 * TURN / SLOTS / 500);
		g_assert_true(stage_track_is_suspect(t, s->from_ns));
		g_assert_true(stage_track_is_suspect(t, slipped_ns));
		g_assert_true(stage_track_is_suspect(t, s->to_ns));
		g_assert_false(stage_track_is_suspect(t, s->from_ns - 1));
		g_assert_false(stage_track_is_suspect(t, s->to_ns + 1));
	}
	/* Put right: where the head stands at the end, and which step to ask for. */
	double end = stage_track_angle_rad(t, stage_track_known_until_ns(t));
	g_assert_cmpfloat(fabs(end - angle_of(6000 - c->steps + left)) * TURN / (2 * G_PI), <, 1.1);
	g_assert_cmpfloat(fabs(stage_track_steps_at(t, end) - 6000), <, 1e-6);
	feed_move(t, &after, &(struct slip){ 0, c->steps });
	g_assert_cmpfloat(worst_steps(t, &after, c->steps - left), <, 1.6);
	g_autoptr(GArray) later = stage_track_suspects(t);
	g_assert_cmpuint(later->len, ==, c->found);
}

/* Small slips add up until they are found. */
static void test_slips_add_up(void)
{
	g_autoptr(stage_track) t = stage_track_new(TURN, SLOTS);
	for (int i = 0; i < 8; i++) {
		struct move m = { 1 + 10 * i, 2000 * i, 2000 * (i + 1), 500, 1320 };
		feed_move(t, &m, &(struct slip){ 0, 5 * i });
	}
	double end = stage_track_angle_rad(t, stage_track_known_until_ns(t));
	g_assert_cmpfloat(fabs(end - angle_of(16000 - 35)) * TURN / (2 * G_PI), <, 17);
	g_autoptr(GArray) suspects = stage_track_suspects(t);
	g_assert_cmpuint(suspects->len, ==, 1);
}

/* More than half the way between two slots looks like a slip the other way, until home says how
 * much it was. */
static void test_great_slip(void)
{
	struct move m = { 1, 0, 6000, 1000, 1320 }, on = { 20, 6000, 15000, 1000, 1320 };
	g_autoptr(stage_track) t = stage_track_new(TURN, SLOTS);
	feed_move(t, &m, &(struct slip){ 3000, 400 });
	feed_move(t, &on, &(struct slip){ 0, 400 });
	double end = stage_track_angle_rad(t, stage_track_known_until_ns(t));
	g_assert_cmpfloat(fabs(end - angle_of(15000 - 400)) * TURN / (2 * G_PI), <, 1.6);
	g_autoptr(GArray) suspects = stage_track_suspects(t);
	g_assert_cmpuint(suspects->len, ==, 2);
	/* All since home was passed the time before is in doubt. */
	for (double at = 1500; at < 12000; at += 500) {
		const struct move *in = at < 6000 ? &m : &on;
		g_assert_true(stage_track_is_suspect(t, time_at_ns(in, at)));
	}
}

/* Backwards, the slots come late by the gear's slack: they say nothing of steps lost. */
static void test_backlash(void)
{
	struct move there = { 1, 0, 5000, 1000, 1320 }, back = { 10, 5000, 1500, 1000, 1320 },
		    again = { 20, 1500, 6000, 1000, 1320 };
	g_autoptr(stage_track) t = stage_track_new(TURN, SLOTS);
	feed_move(t, &there, NULL);
	feed_move(t, &back, &(struct slip){ 0, 30 });
	feed_move(t, &again, NULL);
	g_autoptr(GArray) suspects = stage_track_suspects(t);
	g_assert_cmpuint(suspects->len, ==, 0);
	g_assert_cmpfloat(worst_steps(t, &again, 0), <, 0.7);
}

static void test_home_clockwise_only(void)
{
	struct move back = { 1, 2000, 0, 1000, 1320 }, there = { 10, 0, 2000, 1000, 1320 };
	g_autoptr(stage_track) t = stage_track_new(TURN, SLOTS);
	feed_move(t, &back, NULL);
	g_assert_false(stage_track_is_homed(t));
	feed_move(t, &there, NULL);
	g_assert_true(stage_track_is_homed(t));
}

static void test_stops(void)
{
	static const enum stage_event_kind kinds[] = { STAGE_STOPPED, STAGE_FAULT };
	for (size_t i = 0; i < G_N_ELEMENTS(kinds); i++) {
		g_autoptr(stage_track) t = stage_track_new(TURN, 0);
		g_assert_cmpint(stage_track_known_until_ns(t), ==, INT64_MIN);
		g_assert_false(stage_track_is_moving(t));
		g_assert_cmpfloat(stage_track_angle_rad(t, 5), ==, 0);
		feed(t, STAGE_STEP, 1, 1000);
		g_assert_true(stage_track_is_moving(t));
		g_assert_cmpint(stage_track_known_until_ns(t), ==, 1000);
		feed(t, kinds[i], 0, 2000);
		g_assert_false(stage_track_is_moving(t));
		g_assert_cmpint(stage_track_known_until_ns(t), ==, 2000);
		feed(t, (enum stage_event_kind)77, 1, 3000);
		feed(t, STAGE_INDEX, 1, 3000);
		g_assert_cmpint(stage_track_known_until_ns(t), ==, 2000);
	}
}

/* Times come from a clock model that may be refitted: they can stand still or step back by a
 * little. */
static void test_times_that_do_not_rise(void)
{
	static const int64_t times_ns[] = { 1000, 1000, 900, 2000, 1999, 2000, INT64_MAX / 4, 5 };
	g_autoptr(stage_track) t = stage_track_new(TURN, SLOTS);
	for (size_t i = 0; i < G_N_ELEMENTS(times_ns); i++)
		feed(t, STAGE_STEP, 1, times_ns[i]);
	double step = 2 * G_PI / TURN, last = -1;
	for (int64_t at = 0; at < 3000; at++) {
		double angle = stage_track_angle_rad(t, at);
		g_assert_true(isfinite(angle));
		g_assert_cmpfloat(angle, >=, last);
		last = angle;
	}
	g_assert_cmpfloat(fabs(stage_track_angle_rad(t, INT64_MAX) / step - 8), <, 1e-9);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	for (size_t i = 0; i < G_N_ELEMENTS(rides); i++)
		g_test_add_data_func(rides[i].path, &rides[i], test_ride);
	g_test_add_func("/stage-track/rest", test_rest);
	for (size_t i = 0; i < G_N_ELEMENTS(slip_cases); i++)
		g_test_add_data_func(slip_cases[i].path, &slip_cases[i], test_slip);
	g_test_add_func("/stage-track/slips-add-up", test_slips_add_up);
	g_test_add_func("/stage-track/great-slip", test_great_slip);
	g_test_add_func("/stage-track/backlash", test_backlash);
	g_test_add_func("/stage-track/home-clockwise-only", test_home_clockwise_only);
	g_test_add_func("/stage-track/stops", test_stops);
	g_test_add_func("/stage-track/times-that-do-not-rise", test_times_that_do_not_rise);
	return g_test_run();
}
