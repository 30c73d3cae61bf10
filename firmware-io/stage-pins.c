#include "firmware-io/stage-pins.h"
#include "firmware-io/inbox.h"
#include "firmware-io/stage-index.h"
#include "firmware-io/step-ramp.h"
#include <errno.h>
#include <math.h>
#include <poll.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/mman.h>
#include <unistd.h>

#define MILLISECOND_NS INT64_C(1000000)
#define LEVELS_NS      (10 * MILLISECOND_NS)
#define BATCH_NS       (20 * MILLISECOND_NS) /* steps are told together, edges at once */
#define BLINK_NS       (500 * MILLISECOND_NS)
#define BOUNCE_NS      (3 * MILLISECOND_NS)
#define BUTTON_NS      (30 * MILLISECOND_NS)
#define DOZE_NS        (1000 * MILLISECOND_NS)
#define NAP_NS         INT64_C(300000) /* the last of a wait is slept to its instant */
#define PULSE_NS       2500            /* of STEP, and of DIR before it; DEVICES 4.1 */
#define EVENTS         65536
#define EDGES          64

/* Lines by what they are for; those of a machine that lacks one are not there. */
enum pin {
	PIN_STEP,
	PIN_DIR,
	PIN_ENABLE,
	PIN_LED_READY,
	PIN_LED_EMITTING,
	PIN_LED_FAULT,
	PIN_HOME,
	PIN_INDEX,
	PIN_ESTOP,
	PIN_INTERLOCK,
	PIN_BUTTON,
	PIN_SYNC,
	PIN_COUNT
};
static const struct {
	const char *key;
	bool output, needed;
} pins[PIN_COUNT] = {
	[PIN_STEP] = { "step", true, true },
	[PIN_DIR] = { "dir", true, true },
	[PIN_ENABLE] = { "enable", true, false },
	[PIN_LED_READY] = { "led_ready", true, false },
	[PIN_LED_EMITTING] = { "led_emitting", true, false },
	[PIN_LED_FAULT] = { "led_fault", true, false },
	[PIN_HOME] = { "home", false, true },
	[PIN_INDEX] = { "index", false, false },
	[PIN_ESTOP] = { "estop", false, false },
	[PIN_INTERLOCK] = { "interlock", false, false },
	[PIN_BUTTON] = { "button", false, false },
	[PIN_SYNC] = { "sync", false, false },
};

enum order { ORDER_NONE, ORDER_MOVE, ORDER_STOP };

struct pins_stage {
	stage base;
	gpio_lines *lines;
	int line_of[PIN_COUNT]; /* of lines; below 0: not there */
	enum pin pin_of[PIN_COUNT];
	double rate_max, priority;
	bool counted; /* steps are made here, else index has them */
	GThread *thread;
	int order_fd, told_fd;

	GMutex lock; /* of all up to the next empty line */
	enum order order;
	struct stage_move wanted;
	bool emitting, quit, pressed, open, latched; /* latched: until stage_reset */
	struct stage_event *events;                  /* a ring */
	uint32_t first, waiting;
	bool told, deaf; /* deaf: the ring was full */
	struct stage_pins_counts counts;
	struct stage_event *lent;

	/* The thread's own. */
	struct step_ramp ramp;
	int64_t steps, last_step_ns, batch_ns, levels_ns, blink_ns;
	int64_t edge_ns[PIN_COUNT]; /* the last that counted */
	int direction;
	bool moving, enabled, gone;
	struct stage_index index;
	int64_t target_steps; /* of a motor that turns by itself */
	bool arrived;
};

/* ---- telling; under the lock ---- */

static void wake_owner(struct pins_stage *s)
{
	uint64_t one = 1;
	if (!s->told)
		s->told = write(s->told_fd, &one, sizeof one) == sizeof one;
}

static void tell_locked(
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
	tell_locked(s, kind, s->direction, time_ns);
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
static void look_at_levels(struct pins_stage *s, int64_t now_ns)
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
		tell_locked(
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

static void set_direction(struct pins_stage *s, int direction)
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
	tell_locked(s, STAGE_STEP, s->direction, now_ns);
	bool deaf = s->deaf;
	g_mutex_unlock(&s->lock);
	if (deaf)
		stop_dead(s, now_ns);
}

static void make_step(struct pins_stage *s, int64_t due_ns, int direction)
{
	set_direction(s, direction);
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
	return s->moving ? inbox_now_ns() : INT64_MAX;
}

/* ---- orders ---- */

/* It turns until a slot at or beyond the target; one that is told to stop, until the next slot. */
static void turn_by_itself(struct pins_stage *s, int64_t target, int64_t now_ns)
{
	s->target_steps = target;
	s->arrived = target == s->index.steps;
	if (!s->arrived)
		set_direction(s, target > s->index.steps ? 1 : -1);
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

static void sleep_until(struct pins_stage *s, int64_t due_ns)
{
	struct pollfd fds[] = { { .fd = s->order_fd, .events = POLLIN },
		{ .fd = s->lines->fd, .events = POLLIN } };
	int64_t left_ns = due_ns - inbox_now_ns();
	struct timespec until = { due_ns / 1000000000, due_ns % 1000000000 };
	if (left_ns > NAP_NS) {
		struct timespec left = { (left_ns - NAP_NS) / 1000000000,
			(left_ns - NAP_NS) % 1000000000 };
		ppoll(fds, G_N_ELEMENTS(fds), &left, NULL);
	} else if (left_ns > 0 && poll(fds, G_N_ELEMENTS(fds), 0) == 0) {
		clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, NULL);
	}
}

static void turn(struct pins_stage *s)
{
	obey(s);
	take_edges(s);
	int64_t now_ns = inbox_now_ns();
	look_at_levels(s, now_ns);
	int64_t step_ns = run_steps(s);
	tell_batch(s, now_ns);
	if (now_ns >= s->blink_ns)
		show_lights(s, now_ns);
	bool watched = s->line_of[PIN_ESTOP] >= 0 || s->line_of[PIN_INTERLOCK] >= 0;
	int64_t due_ns = MIN(step_ns, s->blink_ns);
	due_ns = MIN(due_ns, watched ? s->levels_ns : INT64_MAX);
	sleep_until(s, s->moving ? MIN(due_ns, s->batch_ns) : due_ns);
}

static gpointer run(gpointer data)
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

/* ---- the owner's ---- */

static void wake_thread(struct pins_stage *s)
{
	uint64_t one = 1;
	if (write(s->order_fd, &one, sizeof one) != sizeof one)
		g_warning("the stage takes no orders: %s", g_strerror(errno));
}

static void give_order(struct pins_stage *s, enum order order, const struct stage_move *move)
{
	g_mutex_lock(&s->lock);
	s->order = order;
	if (move)
		s->wanted = *move;
	g_mutex_unlock(&s->lock);
	wake_thread(s);
}

static bool refuse(GError **error, enum stage_error code, const char *text)
{
	g_set_error_literal(error, STAGE_ERROR, code, text);
	return false;
}

static bool pins_move(stage *base, const struct stage_move *move, GError **error)
{
	struct pins_stage *s = (struct pins_stage *)base;
	g_mutex_lock(&s->lock);
	bool pressed = s->pressed, open = s->open, latched = s->latched;
	g_mutex_unlock(&s->lock);
	if (pressed)
		return refuse(error, STAGE_ERROR_ESTOP, "the emergency stop is pressed");
	if (open)
		return refuse(error, STAGE_ERROR_INTERLOCK, "the interlock is open");
	if (latched)
		return refuse(error, STAGE_ERROR_NOT_RESET,
			"the stage was stopped for safety, and was not reset since");
	give_order(s, ORDER_MOVE, move);
	return true;
}

static bool pins_stop(stage *base, GError **error)
{
	(void)error;
	give_order((struct pins_stage *)base, ORDER_STOP, NULL);
	return true;
}

static bool pins_reset(stage *base, GError **error)
{
	struct pins_stage *s = (struct pins_stage *)base;
	g_mutex_lock(&s->lock);
	bool pressed = s->pressed, open = s->open;
	s->latched = pressed || open;
	g_mutex_unlock(&s->lock);
	if (pressed)
		return refuse(error, STAGE_ERROR_ESTOP,
			"the emergency stop is still pressed: release it first");
	if (open)
		return refuse(error, STAGE_ERROR_INTERLOCK,
			"the interlock is still open: close it first");
	wake_thread(s);
	return true;
}

static gssize pins_read(
	stage *base, const struct stage_event **ret_events, int64_t *ret_arrival_ns, GError **error)
{
	struct pins_stage *s = (struct pins_stage *)base;
	uint64_t any;
	(void)error;
	g_mutex_lock(&s->lock);
	uint32_t n = s->waiting;
	for (uint32_t i = 0; i < n; i++)
		s->lent[i] = s->events[(s->first + i) % EVENTS];
	s->first = (s->first + n) % EVENTS;
	s->waiting = 0;
	if (s->told)
		s->told = read(s->told_fd, &any, sizeof any) != sizeof any;
	if (s->deaf) {
		s->deaf = false;
		tell_locked(s, STAGE_FAULT, 0, inbox_now_ns());
	}
	g_mutex_unlock(&s->lock);
	*ret_events = s->lent;
	*ret_arrival_ns = inbox_now_ns();
	return n;
}

static void pins_emitting(stage *base, bool emitting)
{
	struct pins_stage *s = (struct pins_stage *)base;
	g_mutex_lock(&s->lock);
	bool changes = s->emitting != emitting;
	s->emitting = emitting;
	g_mutex_unlock(&s->lock);
	if (changes)
		wake_thread(s);
}

static int pins_wait_fd(stage *base)
{
	return ((struct pins_stage *)base)->told_fd;
}

static void pins_close(stage *base)
{
	struct pins_stage *s = (struct pins_stage *)base;
	if (s->thread) {
		g_mutex_lock(&s->lock);
		s->quit = true;
		g_mutex_unlock(&s->lock);
		give_order(s, ORDER_STOP, NULL);
		g_thread_join(s->thread);
	}
	gpio_lines_free(s->lines);
	close(s->order_fd);
	close(s->told_fd);
	g_mutex_clear(&s->lock);
	g_free(s->events);
	g_free(s->lent);
	g_free(s);
}

static const struct stage_ops pins_ops = { .move = pins_move,
	.stop = pins_stop,
	.read = pins_read,
	.reset = pins_reset,
	.emitting = pins_emitting,
	.wait_fd = pins_wait_fd,
	.close = pins_close };

struct stage_pins_counts stage_pins_count(stage *base)
{
	struct pins_stage *s = (struct pins_stage *)base;
	g_mutex_lock(&s->lock);
	struct stage_pins_counts c = s->counts;
	g_mutex_unlock(&s->lock);
	return c;
}

/* ---- setting up ---- */

static bool is_listed(const parts *p, const char *key)
{
	const char *text = parts_text(p, "stage", "active_low");
	g_auto(GStrv) keys = g_strsplit_set(text ? text : "", ", ;", -1);
	return g_strv_contains((const char *const *)keys, key);
}

static bool open_lines(
	struct pins_stage *s, const parts *p, const char *chip, gpio_opener open, GError **error)
{
	struct gpio_line_desc lines[PIN_COUNT];
	size_t n = 0;
	for (enum pin pin = 0; pin < PIN_COUNT; pin++) {
		const char *line = parts_text(p, "stage", pins[pin].key);
		s->line_of[pin] = line ? (int)n : -1;
		if (!line && pins[pin].needed && (s->counted || pin != PIN_STEP)) {
			g_set_error(error, WIRE_ERROR, WIRE_ERROR_BROKEN,
				"the pan stage: [stage] does not say on which line '%s' is",
				pins[pin].key);
			return false;
		}
		if (!line)
			continue;
		s->pin_of[n] = pin;
		lines[n++] = (struct gpio_line_desc){ line, pins[pin].output,
			is_listed(p, pins[pin].key) };
	}
	s->lines = open(chip, lines, n, error);
	return s->lines;
}

/* A stretch between two slots has to find room in the queue. */
static bool read_index(struct pins_stage *s, const parts *p, GError **error)
{
	double turn, slots;
	if (!parts_flag(p, "stage", "counted", true, &s->counted, error) ||
		!parts_number(p, "stage", "steps_per_turn", 16, 1e8, 3200, &turn, error) ||
		!parts_number(p, "stage", "index_slots", 0, 100000, 1, &slots, error))
		return false;
	s->index.spacing = turn / (parts_text(p, "stage", "index") && slots >= 1 ? slots : 1);
	if (s->counted || s->index.spacing <= EVENTS / 4)
		return true;
	g_set_error(error, WIRE_ERROR, WIRE_ERROR_BROKEN,
		"[stage] counted=no: %g steps from slot to slot are too many, %d would do: more "
		"index_slots or fewer steps_per_turn",
		s->index.spacing, EVENTS / 4);
	return false;
}

static void allocate(struct pins_stage *s)
{
	s->events = g_new0(struct stage_event, EVENTS);
	s->lent = g_new0(struct stage_event, EVENTS);
	/* Where it may not be locked it stays in memory anyway, as it is written all the time. */
	if (mlock(s->events, EVENTS * sizeof *s->events) < 0)
		g_debug("the stage's queue is not locked in memory: %s", g_strerror(errno));
	s->order_fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
	s->told_fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
	g_mutex_init(&s->lock);
}

stage *stage_new_pins_on(head *h, const parts *p, gpio_opener open, GError **error)
{
	const char *chip = parts_text(p, "stage", "chip");
	if (!chip || strcmp(chip, "none") == 0)
		return NULL;
	struct pins_stage *s = g_new0(struct pins_stage, 1);
	s->base = (stage){ &pins_ops, h };
	allocate(s);
	if (!parts_number(p, "stage", "rate_max", 1, 1e6, 1e6, &s->rate_max, error) ||
		!parts_number(p, "stage", "priority", 1, 99, 80, &s->priority, error) ||
		!read_index(s, p, error) || !open_lines(s, p, chip, open, error)) {
		pins_close(&s->base);
		return NULL;
	}
	/* Both stand as they are found, and are told of. */
	for (int i = 0; i < PIN_COUNT; i++)
		s->edge_ns[i] = -DOZE_NS;
	s->direction = -1;
	set_direction(s, 1);
	look_at_levels(s, inbox_now_ns());
	s->thread = g_thread_new("stage", run, s);
	return &s->base;
}

stage *stage_new_pins(head *h, const parts *p, GError **error)
{
	return stage_new_pins_on(h, p, gpio_lines_open, error);
}
