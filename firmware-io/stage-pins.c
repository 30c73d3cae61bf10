#include "firmware-io/inbox.h"
#include "firmware-io/stage-pins-private.h"
#include <errno.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/mman.h>
#include <unistd.h>

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
		stage_thread_tell(s, STAGE_FAULT, 0, inbox_now_ns());
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
	stage_thread_set_direction(s, 1);
	stage_thread_look_at_levels(s, inbox_now_ns());
	s->thread = g_thread_new("stage", stage_thread_run, s);
	return &s->base;
}

stage *stage_new_pins(head *h, const parts *p, GError **error)
{
	return stage_new_pins_on(h, p, gpio_lines_open, error);
}
