/* The thread of a stage on pins: waits for the next step, for edges and for orders, whichever is first. */
#include "firmware-io/inbox.h"
#include "firmware-io/stage-pins-private.h"
#include <math.h>
#include <poll.h>
#include <pthread.h>
#include <stdlib.h>
#include <unistd.h>

#define LEVELS_NS (10 * MILLISECOND_NS)
#define BATCH_NS  (20 * MILLISECOND_NS) /* steps are told together, edges at once */
#define BLINK_NS  (500 * MILLISECOND_NS)
#define BOUNCE_NS (3 * MILLISECOND_NS)
#define BUTTON_NS (30 * MILLISECOND_NS)
#define NAP_NS    INT64_C(300000) /* the last of a wait is slept to its instant */
#define PULSE_NS  2500            /* of STEP, and of DIR before it; DEVICES 4.1 */
#define EDGES     64

/* ---- telling; under the lock ---- */

static void wake_owner(struct pins_stage *s)
{
	uint64_t one = 1;
	if (!s->told)
		s->told = write(s->told_fd, &one, sizeof one) == sizeof one;
}

void stage_thread_tell(
	struct pins_stage *s, enum stage_event_kind kind, int direction, int64_t time_ns)
{
	if (s->waiting == EVENTS) {
		s->deaf = true;
		return;
	}
	s->events[(s->first + s->waiting++) % EVENTS] =
		(struct stage_event){ .ticks = (uint32_t)(time_ns / 1000),
			.direction = (int8_t)direction,
			.kind = (uint8_t)kind,
			.flags = STAGE_EVENT_HOST_CLOCK };
	if (kind != STAGE_STEP)
		wake_owner(s);
}

static void tell(struct pins_stage *s, enum stage_event_kind kind, int64_t time_ns)
{
	g_mutex_lock(&s->lock);
	stage_thread_tell(s, kind, s->direction, time_ns);
	g_mutex_unlock(&s->lock);
}

/* Steps that have waited long enough. */
static void tell_batch(struct pins_stage *s, int64_t now_ns)
{
	if (now_ns < s->batch_ns)
		return;
	s->batch_ns = now_ns + BATCH_NS;
	g_mutex_lock(&s->lock);
	if (s->waiting)
		wake_owner(s);
	g_mutex_unlock(&s->lock);
}

/* ---- pins; the thread's ---- */

static void put(struct pins_stage *s, enum pin pin, bool on)
{
	if (s->line_of[pin] >= 0 && !gpio_lines_set(s->lines, (size_t)s->line_of[pin], on))
		s->gone = true;
}

static void enable(struct pins_stage *s, bool on)
{
	if (s->enabled != on)
		put(s, PIN_ENABLE, on);
	s->enabled = on;
}

static void wait_pulse(void)
{
	for (int64_t until_ns = inbox_now_ns() + PULSE_NS; inbox_now_ns() < until_ns;)
		;
}

static void show_lights(struct pins_stage *s, int64_t now_ns)
{
	g_mutex_lock(&s->lock);
	bool fault = s->latched, emitting = s->emitting;
	g_mutex_unlock(&s->lock);
	bool lit = now_ns / BLINK_NS % 2;
	put(s, PIN_LED_READY, !fault);
	put(s, PIN_LED_FAULT, fault && lit);
	/* Blinking: a fault; off only when nothing is emitted for sure. */
	put(s, PIN_LED_EMITTING, emitting && (!fault || lit));
	s->blink_ns = fault ? (now_ns / BLINK_NS + 1) * BLINK_NS : now_ns + DOZE_NS;
}

/* ---- safety ---- */

static void stop_dead(struct pins_stage *s, int64_t now_ns)
{
	bool was_moving = s->moving;
	enable(s, false);
	step_ramp_rest(&s->ramp, now_ns, s->steps);
	stage_index_forget(&s->index);
	s->moving = false;
	if (was_moving)
		tell(s, STAGE_STOPPED, now_ns);
}

static void set_pressed(struct pins_stage *s, bool pressed, int64_t time_ns)
{
	if (s->pressed == pressed)
		return;
	g_mutex_lock(&s->lock);
	s->pressed = pressed;
	s->latched |= pressed;
	g_mutex_unlock(&s->lock);
	if (pressed)
		stop_dead(s, inbox_now_ns());
	tell(s, pressed ? STAGE_ESTOP_PRESSED : STAGE_ESTOP_RELEASED, time_ns);
	show_lights(s, inbox_now_ns());
}

static void set_open(struct pins_stage *s, bool open, int64_t time_ns)
{
	if (s->open == open)
		return;
	g_mutex_lock(&s->lock);
	s->open = open;
	s->latched |= open;
	g_mutex_unlock(&s->lock);
	if (open && !s->counted)
		stop_dead(s, inbox_now_ns());
	else if (open && s->moving)
		step_ramp_stop(&s->ramp, inbox_now_ns());
	tell(s, open ? STAGE_INTERLOCK_OPENED : STAGE_INTERLOCK_CLOSED, time_ns);
	show_lights(s, inbox_now_ns());
}

static bool is_off(struct pins_stage *s, enum pin pin)
{
	int level = s->line_of[pin] < 0 ? 1 : gpio_lines_get(s->lines, (size_t)s->line_of[pin]);
	s->gone |= level < 0;
	return level <= 0;
}

/* Edges can be lost; a contact that is open shows it all the time. */
void stage_thread_look_at_levels(struct pins_stage *s, int64_t now_ns)
{
	if (now_ns < s->levels_ns)
		return;
	s->levels_ns = now_ns + LEVELS_NS;
	set_pressed(s, is_off(s, PIN_ESTOP), now_ns);
	set_open(s, is_off(s, PIN_INTERLOCK), now_ns);
}

/* ---- edges ---- */

/* A slot has two edges: the same one is told whichever way the head turns. */
static bool is_the_edge(const struct pins_stage *s, bool on)
{
	return on == (s->direction >= 0);
}

/* The steps since the slot before are told now that they are known. */
static void count_from_slot(struct pins_stage *s, int64_t time_ns)
{
	int64_t from_ns, n = stage_index_pass(&s->index, time_ns, s->direction, &from_ns);
	g_mutex_lock(&s->lock);
	for (int64_t k = 1; k <= n; k++)
		stage_thread_tell(
			s, STAGE_STEP, s->direction, stage_index_step_ns(from_ns, time_ns, k, n));
	s->counts.steps += (uint64_t)n;
	g_mutex_unlock(&s->lock);
	s->arrived = s->direction * (s->target_steps - s->index.steps) <= 0;
}

static bool is_counted_by(const struct pins_stage *s, enum pin pin)
{
	return pin == (s->line_of[PIN_INDEX] >= 0 ? PIN_INDEX : PIN_HOME);
}

static void take_slot(struct pins_stage *s, enum pin pin, const struct gpio_edge *e)
{
	if (!is_the_edge(s, e->on) || e->time_ns - s->edge_ns[pin] < BOUNCE_NS)
		return;
	s->edge_ns[pin] = e->time_ns;
	if (!s->counted && is_counted_by(s, pin))
		count_from_slot(s, e->time_ns);
	tell(s, pin == PIN_HOME ? STAGE_HOME : STAGE_INDEX, e->time_ns);
}

static void take_edge(struct pins_stage *s, const struct gpio_edge *e)
{
	enum pin pin = s->pin_of[e->line];
	switch (pin) {
	case PIN_ESTOP:
		if (!e->on)
			set_pressed(s, true, e->time_ns);
		break;
	case PIN_INTERLOCK:
		if (!e->on)
			set_open(s, true, e->time_ns);
		break;
	case PIN_HOME:
	case PIN_INDEX: take_slot(s, pin, e); break;
	case PIN_SYNC:
		if (e->on)
			tell(s, STAGE_SYNC, e->time_ns);
		break;
	case PIN_BUTTON:
		if (e->on && e->time_ns - s->edge_ns[pin] >= BUTTON_NS)
			tell(s, STAGE_BUTTON, e->time_ns);
		s->edge_ns[pin] = e->time_ns;
		break;
	default: break;
	}
}

static int by_time(const void *a, const void *b)
{
	const struct gpio_edge *x = a, *y = b;
	return (x->time_ns > y->time_ns) - (x->time_ns < y->time_ns);
}

/* The index slot of home comes with home's own: index first, as everybody tells it. */
static void take_edges(struct pins_stage *s)
{
	struct gpio_edge edges[EDGES];
	gssize n;
	while ((n = gpio_lines_read(s->lines, edges, EDGES)) > 0) {
		qsort(edges, (size_t)n, sizeof *edges, by_time);
		for (gssize i = 0; i < n; i++)
			take_edge(s, &edges[i]);
	}
	s->gone |= n < 0;
}

/* ---- steps ---- */

void stage_thread_set_direction(struct pins_stage *s, int direction)
{
	if (s->direction == direction)
		return;
	s->direction = direction;
	put(s, PIN_DIR, direction > 0);
	wait_pulse();
}

static void end_move(struct pins_stage *s, int64_t now_ns)
{
	if (!s->counted)
		enable(s, false);
	s->moving = false;
	tell(s, STAGE_STOPPED, now_ns);
}

/* A step later than a quarter of its interval puts off all that follow: they keep their distances. */
static void count_lateness(struct pins_stage *s, int64_t due_ns, int64_t now_ns)
{
	double rate = fabs(step_ramp_rate(&s->ramp, due_ns));
	int64_t late_ns = now_ns - due_ns,
		quarter_ns = rate > 1 ? (int64_t)(0.25e9 / rate) : 250 * MILLISECOND_NS;
	bool late = late_ns > quarter_ns;
	if (late)
		step_ramp_delay(&s->ramp, late_ns);
	g_mutex_lock(&s->lock);
	s->counts.steps++;
	s->counts.late_steps += late;
	s->counts.latest_ns = MAX(s->counts.latest_ns, late_ns);
	stage_thread_tell(s, STAGE_STEP, s->direction, now_ns);
	bool deaf = s->deaf;
	g_mutex_unlock(&s->lock);
	if (deaf)
		stop_dead(s, now_ns);
}

static void make_step(struct pins_stage *s, int64_t due_ns, int direction)
{
	stage_thread_set_direction(s, direction);
	int64_t now_ns = inbox_now_ns();
	put(s, PIN_STEP, true);
	wait_pulse();
	put(s, PIN_STEP, false);
	s->steps += direction;
	s->last_step_ns = now_ns;
	count_lateness(s, due_ns, now_ns);
}

/* The next deadline of steps; INT64_MAX at rest. */
static int64_t run_steps(struct pins_stage *s)
{
	int64_t due_ns;
	int direction;
	if (!s->moving)
		return INT64_MAX;
	if (!s->counted) {
		if (s->arrived)
			end_move(s, inbox_now_ns());
		return INT64_MAX;
	}
	if (!step_ramp_next(&s->ramp, s->steps, s->last_step_ns, &due_ns, &direction)) {
		end_move(s, inbox_now_ns());
		return INT64_MAX;
	}
	if (inbox_now_ns() < due_ns)
		return due_ns;
	make_step(s, due_ns, direction);
	if (!s->moving)
		return INT64_MAX;
	/* Where there is none any more, the next turn ends the move. */
	return step_ramp_next(&s->ramp, s->steps, s->last_step_ns, &due_ns, &direction)
		       ? due_ns
		       : s->last_step_ns;
}

/* ---- orders ---- */

/* It turns until a slot at or beyond the target; one that is told to stop, until the next slot. */
static void turn_by_itself(struct pins_stage *s, int64_t target, int64_t now_ns)
{
	s->target_steps = target;
	s->arrived = target == s->index.steps;
	if (!s->arrived)
		stage_thread_set_direction(s, target > s->index.steps ? 1 : -1);
	if (!s->arrived && !s->moving)
		stage_index_start(&s->index, now_ns);
	enable(s, !s->arrived);
	s->moving = true;
}

static void obey(struct pins_stage *s)
{
	uint64_t any;
	if (read(s->order_fd, &any, sizeof any) != sizeof any)
		return;
	int64_t now_ns = inbox_now_ns();
	g_mutex_lock(&s->lock);
	enum order order = s->order;
	struct stage_move move = s->wanted;
	bool latched = s->latched;
	s->order = ORDER_NONE;
	g_mutex_unlock(&s->lock);
	if (order == ORDER_MOVE && !latched && !s->counted) {
		turn_by_itself(s, move.target_steps, now_ns);
	} else if (order == ORDER_STOP && s->moving && !s->counted) {
		s->target_steps = s->index.steps;
	} else if (order == ORDER_MOVE && !latched) {
		move.rate_steps_s = fmin(move.rate_steps_s, s->rate_max);
		enable(s, true);
		step_ramp_move(&s->ramp, now_ns, &move);
		s->moving = true;
	} else if (order == ORDER_STOP && s->moving) {
		step_ramp_stop(&s->ramp, now_ns);
	}
	show_lights(s, now_ns);
}

/* ---- the thread ---- */

static void go_first(struct pins_stage *s)
{
	bool first = pthread_setschedparam(pthread_self(), SCHED_FIFO,
			     &(struct sched_param){ .sched_priority = (int)s->priority }) == 0;
	if (!first)
		g_message("steps of the stage may come late: real-time priority is not allowed "
			  "(pleinair doctor tells more)");
	g_mutex_lock(&s->lock);
	s->counts.has_priority = first;
	g_mutex_unlock(&s->lock);
}

static bool wants_to_quit(struct pins_stage *s)
{
	g_mutex_lock(&s->lock);
	bool quit = s->quit;
	g_mutex_unlock(&s->lock);
	return quit;
}

/* Sleeps, but for orders and edges: what there is of them is dealt with. */
static void sleep_until(struct pins_stage *s, int64_t due_ns)
{
	struct pollfd fds[] = { { .fd = s->order_fd, .events = POLLIN },
		{ .fd = s->lines->fd, .events = POLLIN } };
	int64_t left_ns = due_ns - inbox_now_ns(), coarse_ns = MAX(left_ns - NAP_NS, 0);
	struct timespec coarse = { coarse_ns / 1000000000, coarse_ns % 1000000000 },
			until = { due_ns / 1000000000, due_ns % 1000000000 };
	if (ppoll(fds, G_N_ELEMENTS(fds), &coarse, NULL) > 0) {
		if (fds[0].revents)
			obey(s);
		if (fds[1].revents)
			take_edges(s);
	} else if (coarse_ns == 0 && left_ns > 0) {
		clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, NULL);
	}
}

static void turn(struct pins_stage *s)
{
	int64_t now_ns = inbox_now_ns();
	stage_thread_look_at_levels(s, now_ns);
	int64_t step_ns = run_steps(s);
	tell_batch(s, now_ns);
	if (now_ns >= s->blink_ns)
		show_lights(s, now_ns);
	bool watched = s->line_of[PIN_ESTOP] >= 0 || s->line_of[PIN_INTERLOCK] >= 0;
	int64_t due_ns = MIN(step_ns, s->blink_ns);
	due_ns = MIN(due_ns, watched ? s->levels_ns : INT64_MAX);
	sleep_until(s, s->moving ? MIN(due_ns, s->batch_ns) : due_ns);
}

gpointer stage_thread_run(gpointer data)
{
	struct pins_stage *s = data;
	go_first(s);
	while (!s->gone && !wants_to_quit(s))
		turn(s);
	if (s->gone) {
		s->moving = false;
		tell(s, STAGE_FAULT, inbox_now_ns());
		return NULL;
	}
	enable(s, false);
	put(s, PIN_LED_READY, false);
	put(s, PIN_LED_FAULT, false);
	put(s, PIN_LED_EMITTING, false);
	return NULL;
}
