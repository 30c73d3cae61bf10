#include "sim/stage.h"
#include <math.h>

#define KEEP_NS  INT64_C(2000000000)
#define BATCH_NS INT64_C(20000000)
#define EVER_S   1e9
#define GUESS_S  0.01
#define START_NS INT64_C(40000000) /* the first step from rest takes so long */

/* Motion at one acceleration, without a change of direction. The last segment is rest, for ever. */
struct segment {
	int64_t start_ns;
	double duration_s;
	double position, rate, acceleration; /* steps, of the rotor, at the start */
	double head; /* the gear's output at the start, in steps, slip left out: lags by the
			backlash */
	double slip; /* steps that the head is behind, throughout */
};

struct event {
	int64_t at_ns;
	guint segment;
	enum link_stage_kind kind;
	int direction;
};

struct stage {
	struct stage_desc desc;
	GArray *segments;    /* struct segment, in time */
	guint current;       /* where the next event is looked for */
	int64_t reported_ns; /* events up to here have happened */
	int64_t count;       /* pulses */
	int64_t gap;         /* the head is between this slot, counted from home, and the next */
	bool moving, homed;
	bool pulsed; /* driven by pulses: the last of them, and the time since the one before */
	int64_t pulse_ns, period_ns;
	int pulse_direction;
	double pulse_head;                       /* where it was then */
	int64_t pressed_until_ns, open_until_ns; /* INT64_MAX: is neither pressed nor open */
	bool latched;                            /* until a reset */
	GByteArray *pending;
	int64_t pending_since_ns;
};

static struct segment *segment_at(const stage *s, guint i)
{
	return &g_array_index(s->segments, struct segment, i);
}

static int sign(double x)
{
	return (x > 0) - (x < 0);
}

static int segment_direction(const struct segment *g)
{
	return g->rate != 0 ? sign(g->rate) : sign(g->acceleration);
}

static double segment_position(const struct segment *g, double t_s)
{
	return g->position + t_s * (g->rate + 0.5 * g->acceleration * t_s);
}

/* The gear's play: the output follows the rotor only when it lies against the flank that pushes. */
static double segment_head(const stage *s, const struct segment *g, double t_s)
{
	double position = segment_position(g, t_s);

	if (segment_direction(g) >= 0)
		return MAX(g->head, position - s->desc.backlash_steps);
	return MIN(g->head, position);
}

static double seconds(int64_t from_ns, int64_t to_ns)
{
	return (double)(to_ns - from_ns) * 1e-9;
}

static int64_t segment_end_ns(const struct segment *g)
{
	return g->duration_s >= EVER_S ? INT64_MAX : g->start_ns + llrint(g->duration_s * 1e9);
}

/* The moment at which the rotor passes a position ahead of it, or infinity if it does not within
 * the segment. */
static double segment_reaches_s(const struct segment *g, double position)
{
	double distance = position - g->position;
	double squared = g->rate * g->rate + 2 * g->acceleration * distance;

	if (segment_direction(g) * distance <= 0)
		return 0;
	if (squared < 0) { /* beyond where the ramp ends, but for rounding */
		if (squared < -1e-6 * (g->rate * g->rate + fabs(g->acceleration)))
			return INFINITY;
		squared = 0;
	}
	double t = 2 * distance / (g->rate + segment_direction(g) * sqrt(squared));

	return t <= g->duration_s + 1e-9 ? MIN(t, g->duration_s) : INFINITY;
}

static const struct segment *segment_during(const stage *s, int64_t base_ns, double after_ns)
{
	guint i = s->segments->len - 1;

	while (i > 0 && (double)(segment_at(s, i)->start_ns - base_ns) > after_ns)
		i--;
	return segment_at(s, i);
}

static double head_azimuth(const stage *s, double head_steps)
{
	return s->desc.initial_azimuth_rad + head_steps * 2 * M_PI / s->desc.steps_per_turn;
}

double stage_azimuth_rad(const stage *s, int64_t base_ns, double after_ns)
{
	const struct segment *g = segment_during(s, base_ns, after_ns);
	double t = ((double)(base_ns - g->start_ns) + after_ns) * 1e-9;

	return head_azimuth(s, segment_head(s, g, CLAMP(t, 0, g->duration_s)) - g->slip);
}

static int64_t slots_passed(const stage *s, double head_steps)
{
	return (int64_t)floor(head_azimuth(s, head_steps) * s->desc.index_slots / (2 * M_PI));
}

bool stage_is_homed(const stage *s)
{
	return s->homed;
}

stage *stage_new(const struct stage_desc *desc, int64_t now_ns)
{
	stage *s = g_new0(stage, 1);
	struct segment rest = { .start_ns = now_ns, .duration_s = EVER_S };

	s->desc = *desc;
	s->segments = g_array_new(FALSE, FALSE, sizeof(struct segment));
	g_array_append_val(s->segments, rest);
	s->reported_ns = now_ns;
	s->pressed_until_ns = s->open_until_ns = INT64_MAX;
	s->pending = g_byte_array_new();
	s->gap = slots_passed(s, 0);
	return s;
}

void stage_free(stage *s)
{
	if (!s)
		return;
	g_array_unref(s->segments);
	g_byte_array_unref(s->pending);
	g_free(s);
}

/* Cuts the plan at a moment and returns the state there; the caller appends what follows. */
static struct segment cut(stage *s, int64_t now_ns)
{
	const struct segment *g = segment_during(s, now_ns, 0);
	double t = MIN(seconds(g->start_ns, now_ns), g->duration_s);
	struct segment state = { .start_ns = now_ns,
		.position = segment_position(g, t),
		.rate = g->rate + g->acceleration * t,
		.acceleration = g->acceleration,
		.head = segment_head(s, g, t),
		.slip = g->slip };

	state.duration_s = g->duration_s >= EVER_S ? EVER_S : g->duration_s - t;
	while (s->segments->len > 1 && segment_at(s, s->segments->len - 1)->start_ns >= now_ns)
		g_array_set_size(s->segments, s->segments->len - 1);
	segment_at(s, s->segments->len - 1)->duration_s =
		seconds(segment_at(s, s->segments->len - 1)->start_ns, now_ns);
	return state;
}

static void forget_the_past(stage *s, int64_t now_ns)
{
	guint old = 0;

	while (old + 1 < s->segments->len && segment_at(s, old + 1)->start_ns < now_ns - KEEP_NS)
		old++;
	if (old > 0)
		g_array_remove_range(s->segments, 0, old);
	s->current -= MIN(s->current, old);
}

/* Appends a segment that lasts a while and moves the state to its end. */
static void append(stage *s, struct segment *state, double duration_s, double acceleration)
{
	struct segment g = *state;

	if (duration_s <= 0)
		return;
	g.duration_s = duration_s;
	g.acceleration = acceleration;
	g_array_append_val(s->segments, g);
	state->start_ns = segment_end_ns(&g);
	state->position = segment_position(&g, duration_s);
	state->rate = g.rate + acceleration * duration_s;
	state->head = segment_head(s, &g, duration_s);
}

/* Ramps down to a whole step, at most as hard as asked. */
static void append_stop(stage *s, struct segment *state, double acceleration)
{
	int direction = sign(state->rate);

	if (direction == 0)
		return;
	double least = state->rate * state->rate / (2 * acceleration);
	double end = direction * ceil(direction * state->position + least - 1e-9);
	double distance = fabs(end - state->position);

	if (distance > 1e-9)
		append(s, state, 2 * distance / fabs(state->rate),
			-direction * state->rate * state->rate / (2 * distance));
	state->position = end;
	state->rate = 0;
}

/* From the present rate, which points at the target and leaves room to stop before it, or from
 * rest. */
static void append_trapezoid(
	stage *s, struct segment *state, double target, double top_rate, double acceleration)
{
	double distance = fabs(target - state->position);
	int direction = sign(target - state->position);
	double rate = fabs(state->rate);
	double peak = MIN(top_rate, sqrt(acceleration * distance + 0.5 * rate * rate));
	double change = (peak * peak - rate * rate) / (2 * acceleration);
	double cruise = distance - fabs(change) - peak * peak / (2 * acceleration);

	if (direction == 0)
		return;
	append(s, state, fabs(peak - rate) / acceleration,
		direction * (peak < rate ? -acceleration : acceleration));
	state->rate = direction * peak;
	append(s, state, cruise / peak, 0);
	append(s, state, peak / acceleration, -direction * acceleration);
	state->position = target;
	state->rate = 0;
}

static void append_rest(stage *s, struct segment *state)
{
	struct segment rest = *state;

	rest.rate = rest.acceleration = 0;
	rest.duration_s = EVER_S;
	g_array_append_val(s->segments, rest);
}

static guint first_new_segment(const stage *s, int64_t now_ns)
{
	guint i = s->segments->len - 1;

	while (i > 0 && segment_at(s, i - 1)->start_ns >= now_ns)
		i--;
	return i;
}

static bool is_positive(double x)
{
	return isfinite(x) && x > 1e-6 && x < 1e9;
}

bool stage_move(stage *s, int64_t now_ns, const struct link_stage_move *move)
{
	if (!is_positive(move->rate_steps_s) || !is_positive(move->acceleration_steps_s2) ||
		move->target_steps > INT32_MAX || move->target_steps < INT32_MIN)
		return false;
	if (s->latched)
		return true; /* makes sense, but is not obeyed */
	struct segment state = cut(s, now_ns);
	double target = (double)move->target_steps, a = move->acceleration_steps_s2;
	double room = (target - state.position) * sign(state.rate);

	if (state.rate != 0 && room < state.rate * state.rate / (2 * a) - 1e-9)
		append_stop(s, &state, a);
	append_trapezoid(s, &state, target, move->rate_steps_s, a);
	append_rest(s, &state);
	s->current = first_new_segment(s, now_ns);
	s->moving = true;
	forget_the_past(s, now_ns);
	return true;
}

void stage_halt(stage *s, int64_t now_ns)
{
	if (!s->moving)
		return;
	double a = 0;

	for (guint i = s->current; i < s->segments->len; i++)
		a = MAX(a, fabs(segment_at(s, i)->acceleration));
	struct segment state = cut(s, now_ns);

	append_stop(s, &state, a > 0 ? a : 1e4);
	append_rest(s, &state);
	s->current = first_new_segment(s, now_ns);
	forget_the_past(s, now_ns);
}

static void report(stage *s, int64_t at_ns, enum link_stage_kind kind, int direction)
{
	struct link_stage_event event = { .ticks_us = device_clock_ticks(&s->desc.clock, at_ns),
		.direction = (int8_t)direction,
		.kind = (uint8_t)kind };

	if (s->pending->len == 0)
		s->pending_since_ns = at_ns;
	g_byte_array_append(s->pending, (const guint8 *)&event, sizeof event);
	if (kind != LINK_STAGE_STEP) /* an edge wakes the host at once, pulses are collected */
		s->pending_since_ns = at_ns - BATCH_NS;
}

/* Returns the direction in which it went. */
static int stop_dead(stage *s, int64_t now_ns)
{
	struct segment state = cut(s, now_ns);
	int direction = sign(state.rate);

	state.position = (double)s->count;
	append_rest(s, &state);
	s->current = s->segments->len - 1;
	s->moving = false;
	return direction;
}

void stage_fail(stage *s, int64_t now_ns)
{
	report(s, now_ns, LINK_STAGE_FAULT, stop_dead(s, now_ns));
}

void stage_press(stage *s, int64_t now_ns, double seconds)
{
	if (s->moving)
		report(s, now_ns, LINK_STAGE_STOPPED, stop_dead(s, now_ns));
	s->latched = true;
	s->pressed_until_ns = now_ns + llrint(seconds * 1e9);
	report(s, now_ns, LINK_STAGE_ESTOP_PRESSED, 0);
}

void stage_open(stage *s, int64_t now_ns, double seconds)
{
	stage_halt(s, now_ns);
	s->latched = true;
	s->open_until_ns = now_ns + llrint(seconds * 1e9);
	report(s, now_ns, LINK_STAGE_INTERLOCK_OPENED, 0);
}

void stage_unlatch(stage *s)
{
	s->latched = s->pressed_until_ns != INT64_MAX || s->open_until_ns != INT64_MAX;
}

static void end_of(stage *s, int64_t *until_ns, int64_t now_ns, enum link_stage_kind kind)
{
	if (*until_ns > now_ns)
		return;
	report(s, *until_ns, kind, 0);
	*until_ns = INT64_MAX;
}

void stage_slip(stage *s, int64_t now_ns, double steps)
{
	guint after = s->segments->len - 1;
	struct segment now = *segment_during(s, now_ns, 0);
	double t = seconds(now.start_ns, now_ns);

	while (after > 0 && segment_at(s, after)->start_ns > now_ns)
		after--;
	double lost = steps * (segment_direction(&now) < 0 ? -1 : 1);

	now.head = segment_head(s, &now, t);
	now.position = segment_position(&now, t);
	now.rate += now.acceleration * t;
	now.duration_s -= now.duration_s >= EVER_S ? 0 : t;
	now.start_ns = now_ns;
	segment_at(s, after)->duration_s = t;
	g_array_insert_val(s->segments, after + 1, now);
	for (guint i = after + 1; i < s->segments->len; i++)
		segment_at(s, i)->slip += lost;
	s->current = after + 1;
	s->gap = slots_passed(s, now.head - segment_at(s, s->current)->slip);
}

/* Where the rotor is when the head passes the slot ahead of it. */
static double next_slot(const stage *s, const struct segment *g, int direction)
{
	double steps_per_slot = s->desc.steps_per_turn / s->desc.index_slots;
	double home = -s->desc.initial_azimuth_rad / (2 * M_PI) * s->desc.steps_per_turn + g->slip;

	if (direction > 0)
		return home + (double)(s->gap + 1) * steps_per_slot + s->desc.backlash_steps;
	return home + (double)s->gap * steps_per_slot;
}

static bool event_in_segment(const stage *s, guint index, struct event *ret_event)
{
	const struct segment *g = segment_at(s, index);
	int direction = segment_direction(g);

	if (direction == 0)
		return false;
	double pulse_s =
		s->pulsed ? INFINITY : segment_reaches_s(g, (double)(s->count + direction));
	double slot_s = segment_reaches_s(g, next_slot(s, g, direction));
	bool is_slot = slot_s < pulse_s;
	double t = is_slot ? slot_s : pulse_s;

	if (!isfinite(t))
		return false;
	int64_t at_ns = MAX(g->start_ns + llrint(t * 1e9), s->reported_ns);

	*ret_event = (struct event){ at_ns, index, is_slot ? LINK_STAGE_INDEX : LINK_STAGE_STEP,
		direction };
	return true;
}

static struct event next_event(const stage *s)
{
	struct event event = { .at_ns = INT64_MAX };

	if (!s->moving)
		return event;
	for (guint i = s->current; i < s->segments->len; i++)
		if (event_in_segment(s, i, &event))
			return event;
	if (s->pulsed)
		return event;
	/* Rounding may have swallowed the last pulse of a ramp, which is due as the rotor comes to
	 * rest. */
	const struct segment *rest = segment_at(s, s->segments->len - 1);
	int missing = sign(round(rest->position) - (double)s->count);

	return (struct event){ MAX(rest->start_ns, s->reported_ns), s->segments->len - 1,
		missing ? LINK_STAGE_STEP : LINK_STAGE_STOPPED, missing };
}

int64_t stage_next_ns(const stage *s)
{
	int64_t at_ns = next_event(s).at_ns;

	at_ns = MIN(at_ns, MIN(s->pressed_until_ns, s->open_until_ns));
	return s->pending->len ? MIN(at_ns, s->pending_since_ns + BATCH_NS) : at_ns;
}

static void pass_slot(stage *s, const struct event *event)
{
	int64_t slot = event->direction > 0 ? s->gap + 1 : s->gap;

	s->gap += event->direction;
	report(s, event->at_ns, LINK_STAGE_INDEX, event->direction);
	if (slot % s->desc.index_slots == 0) {
		s->homed = true;
		report(s, event->at_ns, LINK_STAGE_HOME, event->direction);
	}
}

static void happen(stage *s, const struct event *event)
{
	s->current = event->segment;
	s->reported_ns = event->at_ns;
	if (event->kind == LINK_STAGE_INDEX) {
		pass_slot(s, event);
		return;
	}
	if (event->kind == LINK_STAGE_STEP)
		s->count += event->direction;
	else
		s->moving = false;
	report(s, event->at_ns, event->kind, event->direction);
}

GByteArray *stage_run(stage *s, int64_t now_ns)
{
	struct event event = next_event(s);

	if (event.at_ns <= now_ns)
		happen(s, &event);
	end_of(s, &s->pressed_until_ns, now_ns, LINK_STAGE_ESTOP_RELEASED);
	end_of(s, &s->open_until_ns, now_ns, LINK_STAGE_INTERLOCK_CLOSED);
	if (s->pending->len == 0 || now_ns < s->pending_since_ns + BATCH_NS)
		return NULL;
	GByteArray *batch = s->pending;

	s->pending = g_byte_array_new();
	return batch;
}

void stage_begin_pulses(stage *s, int64_t now_ns)
{
	struct segment rest = { .start_ns = now_ns, .duration_s = EVER_S };

	g_array_set_size(s->segments, 0);
	g_array_append_val(s->segments, rest);
	g_byte_array_set_size(s->pending, 0);
	s->current = 0;
	s->count = 0;
	s->pulse_head = 0;
	s->gap = slots_passed(s, 0);
	s->reported_ns = s->pulse_ns = now_ns;
	s->period_ns = 0;
	s->pulsed = s->moving = true;
	s->homed = false;
}

/* As if pulses went on coming as this one did, for a step at least; and after a while, for it may have been the last, what is known again. */
static void append_guess(stage *s, struct segment *state, double period_s)
{
	struct segment known = *state;

	append(s, state, MAX(period_s, GUESS_S), 0);
	known.start_ns = state->start_ns;
	*state = known;
}

void stage_pulse(stage *s, int64_t at_ns, int direction)
{
	int64_t to_ns = MAX(at_ns, s->pulse_ns + 1), period_ns = to_ns - s->pulse_ns;
	int64_t from_ns = MAX(s->pulse_ns, to_ns - START_NS);
	bool even = direction == s->pulse_direction && period_ns < START_NS &&
		    period_ns < s->period_ns + s->period_ns / 4;

	if (!s->pulsed || !s->moving || direction == 0)
		return;
	struct segment state = cut(s, from_ns);

	state.position = (double)s->count;
	state.head = s->pulse_head;
	state.rate = direction / seconds(from_ns, to_ns);
	append(s, &state, seconds(from_ns, to_ns), 0);
	s->count += direction;
	s->pulse_direction = direction;
	s->pulse_head = state.head;
	state.position = (double)s->count;
	state.start_ns = to_ns;
	if (even)
		append_guess(s, &state, seconds(s->pulse_ns, to_ns));
	append_rest(s, &state);
	s->pulse_ns = to_ns;
	s->period_ns = period_ns;
	s->current = first_new_segment(s, from_ns);
	forget_the_past(s, to_ns);
}
