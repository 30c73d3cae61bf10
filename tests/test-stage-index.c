/* A stage whose motor turns by itself, against a motor that knows where it is: angles from slots alone. */
#include "firmware-io/stage-index.h"
#include "firmware-io/stage-pins.h"
#include "firmware-io/stage-track.h"
#include "tests/gpio-made.h"
#include <math.h>
#include <poll.h>

#define SECOND_NS INT64_C(1000000000)
#define STEPS     3200
#define SLOTS     24
#define SLOT_DEG  (360.0 / SLOTS)
#define WIDTH_DEG 2.0
#define RATE_DEG  360.0 /* a second */
#define BEGIN_DEG 50.0
#define URI                                                                                        \
	"tim:?stage.chip=made&stage.dir=dir&stage.enable=enable&stage.home=home&stage.index="      \
	"index&stage.estop=estop&stage.counted=no&stage.index_slots=24&stage.steps_per_turn=3200"

/* ---- the motor ---- */

struct moment {
	int64_t time_ns;
	double deg;
};

static struct {
	GThread *thread;
	gint quit;
	guint taken; /* changes of outputs */
	bool on, forwards;
	struct moment now;
	GArray *truth; /* of struct moment */
} motor;

static void push_edge(const char *line, bool on, int64_t time_ns)
{
	struct made_chip *c = made_chip;
	uint64_t one = 1;
	int at = made_line(c, line);
	struct gpio_edge e = { (size_t)at, on, time_ns };
	c->levels[at] = on;
	g_array_append_val(c->edges, e);
	g_assert_cmpint(write(c->base.fd, &one, sizeof one), ==, sizeof one);
}

/* The edge at `deg`, of the slot that it is of. */
static void pass_edge(double deg, bool near_edge, int64_t time_ns)
{
	bool on = near_edge == motor.forwards;
	push_edge("index", on, time_ns);
	if (fabs(remainder(near_edge ? deg : deg - WIDTH_DEG, 360)) < 1e-6)
		push_edge("home", on, time_ns);
}

/* The next edge ahead. */
static double edge_ahead(bool *ret_near)
{
	double slot = floor(motor.now.deg / SLOT_DEG + 1e-9) * SLOT_DEG, at = motor.now.deg;
	double edges[] = { slot - SLOT_DEG, slot - SLOT_DEG + WIDTH_DEG, slot, slot + WIDTH_DEG,
		slot + SLOT_DEG, slot + SLOT_DEG + WIDTH_DEG };
	int n = G_N_ELEMENTS(edges);
	for (int i = 0; i < n; i++) {
		int k = motor.forwards ? i : n - 1 - i;
		*ret_near = k % 2 == 0;
		if (motor.forwards ? edges[k] > at + 1e-7 : edges[k] < at - 1e-7)
			return edges[k];
	}
	g_assert_not_reached();
}

static void turn_until(int64_t time_ns)
{
	double sign = motor.forwards ? 1 : -1;
	while (motor.on) {
		bool near_edge;
		double edge = edge_ahead(&near_edge);
		int64_t at_ns =
			motor.now.time_ns + llround(fabs(edge - motor.now.deg) / RATE_DEG * 1e9);
		if (at_ns > time_ns)
			break;
		motor.now = (struct moment){ at_ns, edge };
		g_array_append_val(motor.truth, motor.now);
		pass_edge(edge, near_edge, at_ns);
	}
	if (motor.on)
		motor.now.deg += sign * RATE_DEG * (double)(time_ns - motor.now.time_ns) * 1e-9;
	motor.now.time_ns = time_ns;
	g_array_append_val(motor.truth, motor.now);
}

static gpointer run_motor(gpointer chip)
{
	struct made_chip *c = chip;
	while (!g_atomic_int_get(&motor.quit)) {
		g_mutex_lock(&c->lock);
		for (; motor.taken < c->changes->len; motor.taken++) {
			const struct made_change *m =
				&g_array_index(c->changes, struct made_change, motor.taken);
			turn_until(MAX(m->time_ns, motor.now.time_ns));
			if (strcmp(c->names[m->line], "enable") == 0)
				motor.on = m->on;
			if (strcmp(c->names[m->line], "dir") == 0)
				motor.forwards = m->on;
		}
		turn_until(inbox_now_ns());
		g_mutex_unlock(&c->lock);
		g_usleep(1000);
	}
	return NULL;
}

static stage *open_with_motor(void)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(parts) p = parts_read(URI, &error);
	g_assert_no_error(error);
	stage *s = stage_new_pins_on(NULL, p, made_open, &error);
	g_assert_no_error(error);
	motor.quit = 0;
	motor.taken = 0;
	motor.on = motor.forwards = false;
	motor.now = (struct moment){ inbox_now_ns(), BEGIN_DEG };
	motor.truth = g_array_new(FALSE, FALSE, sizeof(struct moment));
	motor.thread = g_thread_new("motor", run_motor, made_chip);
	return s;
}

static void close_with_motor(stage *s)
{
	g_atomic_int_set(&motor.quit, 1);
	g_thread_join(motor.thread);
	g_array_unref(motor.truth);
	s->ops->close(s);
}

/* ---- what is told of it ---- */

struct told {
	stage_track *track;
	GArray *slots; /* of int64_t: times of index slots, and 0 where it stopped */
	int64_t steps;
	guint stops;
};

static int64_t time_of(const struct stage_event *e)
{
	int64_t now_us = inbox_now_ns() / 1000;
	return (now_us + (int32_t)(e->ticks - (uint32_t)now_us)) * 1000;
}

static void listen(struct told *t, const struct stage_event *e)
{
	int64_t at_ns = time_of(e), rest = 0;
	g_assert_cmpuint(e->flags, ==, STAGE_EVENT_HOST_CLOCK);
	stage_track_feed(t->track, e, at_ns);
	t->steps += e->kind == STAGE_STEP ? e->direction : 0;
	t->stops += e->kind == STAGE_STOPPED;
	if (e->kind == STAGE_INDEX)
		g_array_append_val(t->slots, at_ns);
	if (e->kind == STAGE_STOPPED)
		g_array_append_val(t->slots, rest);
}

static void listen_for(stage *s, struct told *t, guint stops)
{
	for (int64_t deadline_ns = inbox_now_ns() + 30 * SECOND_NS; t->stops < stops;) {
		const struct stage_event *events;
		int64_t arrival_ns;
		struct pollfd p = { .fd = s->ops->wait_fd(s), .events = POLLIN };
		g_assert_cmpint(inbox_now_ns(), <, deadline_ns);
		poll(&p, 1, 100);
		gssize n = s->ops->read(s, &events, &arrival_ns, NULL);
		for (gssize i = 0; i < n; i++)
			listen(t, &events[i]);
	}
}

static double truth_at(int64_t time_ns)
{
	for (guint i = 1; i < motor.truth->len; i++) {
		const struct moment *m = &g_array_index(motor.truth, struct moment, i);
		if (m->time_ns < time_ns || m->time_ns == m[-1].time_ns)
			continue;
		return m[-1].deg + (m->deg - m[-1].deg) * (double)(time_ns - m[-1].time_ns) /
					   (double)(m->time_ns - m[-1].time_ns);
	}
	g_assert_not_reached();
}

/* Between two slots that no rest parts it turned evenly. The first instant is the last one of the stretch before, or the border of a rest,
 * where the track lets the rotor start up. */
static void check_stretches(const struct told *t, guint wanted)
{
	double worst = 0;
	guint stretches = 0;
	for (guint i = 1; i < t->slots->len; i++) {
		int64_t a = g_array_index(t->slots, int64_t, i - 1),
			b = g_array_index(t->slots, int64_t, i);
		if (!a || !b)
			continue;
		stretches++;
		for (int k = 1; k <= 20; k++) {
			int64_t at_ns = a + (b - a) * k / 20;
			double told = stage_track_angle_rad(t->track, at_ns) * 180 / G_PI;
			worst = fmax(worst, fabs(remainder(told - truth_at(at_ns), 360)));
		}
	}
	g_test_message("%u stretches, off by %.4f degrees at most", stretches, worst);
	g_assert_cmpuint(stretches, >=, wanted);
	g_assert_cmpfloat(worst, <, 0.1);
}

static void move_to(stage *s, int64_t target)
{
	g_autoptr(GError) error = NULL;
	s->ops->move(s, &(struct stage_move){ target, 1000, 10000 }, &error);
	g_assert_no_error(error);
}

static void test_motor(void)
{
	stage *s = open_with_motor();
	struct told t = { .track = stage_track_new(STEPS, SLOTS),
		.slots = g_array_new(FALSE, FALSE, sizeof(int64_t)) };
	/* Steps count from the first slot, which is 60 degrees. */
	move_to(s, 5000);
	listen_for(s, &t, 1);
	g_assert_true(stage_track_is_homed(t.track));
	g_assert_cmpint(t.steps, >=, 5000);
	g_assert_cmpfloat((double)t.steps, <, 5000 + STEPS);
	int64_t forth = t.steps;
	g_usleep(50000);
	move_to(s, 1000);
	listen_for(s, &t, 2);
	g_assert_cmpint(t.steps, <=, 1000);
	g_assert_cmpint(t.steps, <, forth);
	g_usleep(50000);
	/* A stop is at the next slot. */
	move_to(s, 100000);
	g_usleep(300000);
	s->ops->stop(s, NULL);
	listen_for(s, &t, 3);
	g_assert_cmpint(t.steps, >, 1000);
	g_assert_cmpint(t.steps, <, 100000);
	g_mutex_lock(&made_chip->lock);
	check_stretches(&t, 50);
	g_mutex_unlock(&made_chip->lock);
	g_assert_false(made_level("enable"));
	g_autoptr(GArray) suspects = stage_track_suspects(t.track);
	g_assert_cmpuint(suspects->len, ==, 0);
	stage_track_free(t.track);
	g_array_unref(t.slots);
	close_with_motor(s);
}

static void test_estop(void)
{
	stage *s = open_with_motor();
	struct told t = { .track = stage_track_new(STEPS, SLOTS),
		.slots = g_array_new(FALSE, FALSE, sizeof(int64_t)) };
	move_to(s, 100000);
	g_usleep(200000);
	g_assert_true(made_level("enable"));
	made_pull("estop", false);
	listen_for(s, &t, 1);
	g_assert_false(made_level("enable"));
	stage_track_free(t.track);
	g_array_unref(t.slots);
	close_with_motor(s);
}

/* Slots that are no whole number of steps apart add up to a whole turn. */
static void test_fractions(void)
{
	struct stage_index x = { .spacing = 3200.0 / 24 };
	int64_t from_ns, sum = 0;
	stage_index_start(&x, 0);
	g_assert_cmpint(stage_index_pass(&x, 10, 1, &from_ns), ==, 0);
	for (int i = 1; i <= 24; i++) {
		sum += stage_index_pass(&x, 10 + i * 1000, 1, &from_ns);
		g_assert_cmpint(from_ns, ==, 10 + (i - 1) * 1000);
	}
	g_assert_cmpint(sum, ==, 3200);
	/* About turn: the same slot once more, then one less. */
	g_assert_cmpint(stage_index_pass(&x, 30000, -1, &from_ns), ==, 0);
	g_assert_cmpint(stage_index_pass(&x, 31000, -1, &from_ns), ==, 3200 - 3067);
	g_assert_cmpint(stage_index_step_ns(1000, 5000, 4, 4), ==, 5000);
	g_assert_cmpint(stage_index_step_ns(1000, 5000, 1, 4), ==, 2000);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/stage-index/fractions", test_fractions);
	g_test_add_func("/stage-index/motor", test_motor);
	g_test_add_func("/stage-index/estop", test_estop);
	return g_test_run();
}
