#include "firmware-io/stage-track.h"
#include <math.h>

#define FULL_STEP 16.0 /* microsteps */
/* The first step from rest takes the rotor about this long, at the accelerations that the stage is
 * driven with. */
#define START_NS INT64_C(40000000)

struct knot {
	int64_t time_ns;
	double steps;
};

struct stage_track {
	double steps_per_turn;
	uint32_t index_slots;
	GArray *knots;    /* of struct knot, times rising */
	GArray *suspects; /* of struct stage_suspect */
	double count;     /* steps from power-on, slips put right */
	double slipped;   /* what was put right so far: commanded = count + slipped */
	double home_steps;
	double index_phase;    /* of the slots, in steps, once known */
	int64_t good_since_ns; /* the last slot that was where it should be */
	int64_t home_since_ns; /* the same of the home slot */
	bool homed, phase_known, moving;
};

stage_track *stage_track_new(double steps_per_turn, uint32_t index_slots)
{
	stage_track *t = g_new0(stage_track, 1);
	t->steps_per_turn = steps_per_turn;
	t->index_slots = index_slots;
	t->knots = g_array_new(FALSE, FALSE, sizeof(struct knot));
	t->suspects = g_array_new(FALSE, FALSE, sizeof(struct stage_suspect));
	return t;
}

void stage_track_free(stage_track *t)
{
	if (!t)
		return;
	g_array_unref(t->knots);
	g_array_unref(t->suspects);
	g_free(t);
}

static void add_knot(stage_track *t, int64_t time_ns)
{
	struct knot k = { time_ns, t->count };
	if (t->knots->len &&
		g_array_index(t->knots, struct knot, t->knots->len - 1).time_ns >= time_ns)
		k.time_ns = g_array_index(t->knots, struct knot, t->knots->len - 1).time_ns + 1;
	g_array_append_val(t->knots, k);
}

/* Last knot at or before the time, or -1. */
static gssize find_knot(const stage_track *t, int64_t time_ns)
{
	gssize low = -1, high = t->knots->len;
	while (high - low > 1) {
		gssize middle = (low + high) / 2;
		if (g_array_index(t->knots, struct knot, middle).time_ns <= time_ns)
			low = middle;
		else
			high = middle;
	}
	return low;
}

static double steps_at_time(const stage_track *t, int64_t time_ns)
{
	if (t->knots->len == 0)
		return 0.0;
	gssize i = find_knot(t, time_ns);
	const struct knot *k = &g_array_index(t->knots, struct knot, MAX(i, 0));
	if (i < 0 || i + 1 >= (gssize)t->knots->len)
		return k->steps;
	return k[0].steps + (k[1].steps - k[0].steps) * (double)(time_ns - k[0].time_ns) /
				    (double)(k[1].time_ns - k[0].time_ns);
}

/* A slot lies between the last pulse and the next: half a step on is the best guess until the next
 * pulse is known, and good to half a step, which is far below what a slip is. */
static double steps_now(const stage_track *t, int64_t time_ns, int direction)
{
	guint n = t->knots->len;
	if (n < 2)
		return t->count;
	const struct knot *k = &g_array_index(t->knots, struct knot, n - 2);
	double pace = (k[1].steps - k[0].steps) / (double)(k[1].time_ns - k[0].time_ns);
	double on = pace * (double)(time_ns - k[1].time_ns);
	return t->count + (direction > 0 ? CLAMP(on, 0.0, 1.0) : CLAMP(on, -1.0, 0.0));
}

static void put_right(stage_track *t, double off, int64_t good_since_ns, int64_t time_ns)
{
	struct stage_suspect s = { good_since_ns, time_ns, off * 2 * G_PI / t->steps_per_turn };
	g_array_append_val(t->suspects, s);
	t->count -= off;
	t->slipped += off;
	add_knot(t, time_ns);
}

static void check_index(stage_track *t, int64_t time_ns, int direction)
{
	double spacing = t->steps_per_turn / t->index_slots, at = steps_now(t, time_ns, direction);
	if (!t->phase_known) {
		t->phase_known = true;
		t->index_phase = at;
		t->good_since_ns = time_ns;
		return;
	}
	double off = remainder(at - t->index_phase, spacing);
	if (fabs(off) > FULL_STEP)
		put_right(t, off, t->good_since_ns, time_ns);
	t->good_since_ns = time_ns;
}

/* A slip of more than half the way between two slots has been put right by the wrong slot; home is
 * told from all others. */
static void check_home(stage_track *t, int64_t time_ns, int direction)
{
	double at = steps_now(t, time_ns, direction);
	if (!t->homed)
		t->home_steps = at;
	double off = remainder(at - t->home_steps, t->steps_per_turn);
	if (fabs(off) > FULL_STEP)
		put_right(t, off, t->home_since_ns, time_ns);
	t->homed = true;
	t->home_since_ns = time_ns;
}

static void take_step(stage_track *t, int64_t time_ns, int direction)
{
	/* A rotor at rest does not creep towards the first pulse of its next move. */
	if (!t->moving) {
		int64_t known_ns = stage_track_known_until_ns(t);
		if (known_ns < time_ns - START_NS)
			add_knot(t, time_ns - START_NS);
	}
	t->count += direction < 0 ? -1.0 : 1.0;
	t->moving = true;
	add_knot(t, time_ns);
}

void stage_track_feed(stage_track *t, const struct stage_event *event, int64_t time_ns)
{
	switch (event->kind) {
	case STAGE_STEP: take_step(t, time_ns, event->direction); break;
	case STAGE_HOME:
		if (event->direction > 0)
			check_home(t, time_ns, event->direction);
		break;
	case STAGE_INDEX:
		if (t->index_slots && event->direction > 0)
			check_index(t, time_ns, event->direction);
		break;
	case STAGE_STOPPED:
	case STAGE_FAULT:
		t->moving = false;
		add_knot(t, time_ns);
		break;
	default: break;
	}
}

bool stage_track_is_homed(const stage_track *t)
{
	return t->homed;
}

double stage_track_angle_rad(const stage_track *t, int64_t time_ns)
{
	return (steps_at_time(t, time_ns) - t->home_steps) * (2 * G_PI / t->steps_per_turn);
}

int64_t stage_track_known_until_ns(const stage_track *t)
{
	return t->knots->len ? g_array_index(t->knots, struct knot, t->knots->len - 1).time_ns
			     : INT64_MIN;
}

double stage_track_steps_at(const stage_track *t, double angle_rad)
{
	return t->home_steps + t->slipped + angle_rad * t->steps_per_turn / (2 * G_PI);
}

bool stage_track_is_moving(const stage_track *t)
{
	return t->moving;
}

bool stage_track_is_suspect(const stage_track *t, int64_t time_ns)
{
	for (guint i = 0; i < t->suspects->len; i++) {
		const struct stage_suspect *s =
			&g_array_index(t->suspects, struct stage_suspect, i);
		if (time_ns >= s->from_ns && time_ns <= s->to_ns)
			return true;
	}
	return false;
}

GArray *stage_track_suspects(const stage_track *t)
{
	return g_array_copy(t->suspects);
}
