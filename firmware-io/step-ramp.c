#include "firmware-io/step-ramp.h"
#include <math.h>

/* Rounding must not swallow the step that a leg ends with. */
#define NEARLY 1e-6

static double leg_end_s(const struct step_ramp *r, int i)
{
	return i < r->count ? r->legs[i + 1].begin_s : INFINITY;
}

static double leg_position(const struct step_leg *l, double t_s)
{
	double t = t_s - l->begin_s;
	return l->position + t * (l->rate + 0.5 * l->acceleration * t);
}

static const struct step_leg *leg_at(const struct step_ramp *r, double t_s)
{
	int i = 0;
	while (i < r->count && r->legs[i + 1].begin_s <= t_s)
		i++;
	return &r->legs[i];
}

static double since_s(const struct step_ramp *r, int64_t now_ns)
{
	return MAX((double)(now_ns - r->begun_ns) * 1e-9, 0.0);
}

double step_ramp_position(const struct step_ramp *r, int64_t now_ns)
{
	double t = since_s(r, now_ns);
	return leg_position(leg_at(r, t), t);
}

double step_ramp_rate(const struct step_ramp *r, int64_t now_ns)
{
	double t = since_s(r, now_ns);
	const struct step_leg *l = leg_at(r, t);
	return l->rate + l->acceleration * (t - l->begin_s);
}

/* ---- planning ---- */

/* The leg that begins where the last one ended; the last of all is rest. */
static struct step_leg *last_leg(struct step_ramp *r)
{
	return &r->legs[r->count];
}

static void add_leg(struct step_ramp *r, double seconds, double acceleration)
{
	struct step_leg *l = last_leg(r);
	if (!(seconds > 0) || r->count >= STEP_RAMP_LEGS)
		return;
	l->acceleration = acceleration;
	double end_s = l->begin_s + seconds;
	l[1] = (struct step_leg){ end_s, leg_position(l, end_s), l->rate + acceleration * seconds,
		0 };
	r->count++;
}

static void come_to_rest(struct step_ramp *r, double position)
{
	struct step_leg *l = last_leg(r);
	l->position = position;
	l->rate = l->acceleration = 0;
}

static int sign(double x)
{
	return (x > 0) - (x < 0);
}

/* At the first whole step that can be reached at no more than the acceleration. */
static void add_stop(struct step_ramp *r, double acceleration)
{
	struct step_leg *l = last_leg(r);
	int direction = sign(l->rate);
	if (!direction)
		return;
	double least = l->rate * l->rate / (2 * acceleration);
	double end = direction * ceil(direction * l->position + least - NEARLY),
	       way = fabs(end - l->position);
	if (way > NEARLY)
		add_leg(r, 2 * way / fabs(l->rate), -direction * l->rate * l->rate / (2 * way));
	come_to_rest(r, end);
}

/* From a rate that points at the target and leaves room to stop there, or from rest. */
static void add_trapezoid(struct step_ramp *r, double target, double top, double a)
{
	struct step_leg *l = last_leg(r);
	double way = fabs(target - l->position), rate = fabs(l->rate);
	int direction = sign(target - l->position);
	if (!direction)
		return;
	double peak = fmin(top, sqrt(a * way + rate * rate / 2)),
	       ramps = (fabs(peak * peak - rate * rate) + peak * peak) / (2 * a);
	add_leg(r, fabs(peak - rate) / a, direction * (peak < rate ? -a : a));
	last_leg(r)->rate = direction * peak;
	add_leg(r, (way - ramps) / peak, 0);
	add_leg(r, peak / a, -direction * a);
	come_to_rest(r, target);
}

static void begin_anew(struct step_ramp *r, int64_t now_ns)
{
	struct step_leg now = { 0, step_ramp_position(r, now_ns), step_ramp_rate(r, now_ns), 0 };
	*r = (struct step_ramp){
		.legs = { now }, .begun_ns = now_ns, .acceleration = r->acceleration
	};
}

void step_ramp_rest(struct step_ramp *r, int64_t now_ns, int64_t position)
{
	*r = (struct step_ramp){ .legs = { { .position = (double)position } },
		.begun_ns = now_ns,
		.acceleration = r->acceleration };
}

void step_ramp_move(struct step_ramp *r, int64_t now_ns, const struct stage_move *move)
{
	double target = (double)move->target_steps, a = move->acceleration_steps_s2;
	begin_anew(r, now_ns);
	r->acceleration = a;
	const struct step_leg *l = last_leg(r);
	double room = (target - l->position) * sign(l->rate);
	if (l->rate != 0 && room < l->rate * l->rate / (2 * a) - NEARLY)
		add_stop(r, a);
	add_trapezoid(r, target, move->rate_steps_s, a);
}

void step_ramp_stop(struct step_ramp *r, int64_t now_ns)
{
	begin_anew(r, now_ns);
	if (r->acceleration > 0)
		add_stop(r, r->acceleration);
}

void step_ramp_delay(struct step_ramp *r, int64_t by_ns)
{
	r->begun_ns += by_ns;
}

/* ---- steps ---- */

/* When a leg passes a position ahead of it, from where it begins; INFINITY: not within it. */
static double reaches_s(const struct step_ramp *r, int i, double position, int direction)
{
	const struct step_leg *l = &r->legs[i];
	double way = direction * (position - l->position), rate = direction * l->rate,
	       a = direction * l->acceleration;
	if (way <= 0)
		return 0;
	double squared = fmax(rate * rate + 2 * a * way, 0);
	double t = 2 * way / (rate + sqrt(squared)), length = leg_end_s(r, i) - l->begin_s;
	return t <= length + NEARLY &&
			       way <= direction * (leg_position(l, leg_end_s(r, i)) - l->position) +
					       NEARLY
		       ? fmin(t, length)
		       : INFINITY;
}

static int direction_of(const struct step_leg *l)
{
	return sign(l->rate) ? sign(l->rate) : sign(l->acceleration);
}

bool step_ramp_next(
	struct step_ramp *r, int64_t steps, int64_t from_ns, int64_t *ret_ns, int *ret_direction)
{
	for (int i = r->at; i < r->count; i++) {
		int direction = direction_of(&r->legs[i]);
		double t = direction ? reaches_s(r, i, (double)(steps + direction), direction)
				     : INFINITY;
		if (!isfinite(t))
			continue;
		r->at = i;
		*ret_ns = MAX(r->begun_ns + llround((r->legs[i].begin_s + t) * 1e9), from_ns);
		*ret_direction = direction;
		return true;
	}
	/* A step that rounding swallowed, or that was owed when the ramp was cut. */
	double missing = r->legs[r->count].position - (double)steps;
	*ret_direction = sign(round(missing));
	*ret_ns = MAX(r->begun_ns + llround(r->legs[r->count].begin_s * 1e9), from_ns);
	return *ret_direction != 0;
}
