#include "acquire/exposures.h"
#include <math.h>

#define STEP             4.0 /* 2 EV */
#define GAIN_MIN_PERCENT 100
#define GAIN_MAX_PERCENT 1600

double exposures_light(const struct camera_controls *c)
{
	return c->exposure_100us * (c->gain_percent / 100.0);
}

int exposures_find(const struct exposures *e, const struct camera_controls *c)
{
	for (uint32_t i = 0; i < e->count; i++)
		if (e->controls[i].exposure_100us == c->exposure_100us &&
			e->controls[i].gain_percent == c->gain_percent &&
			e->controls[i].white_balance_k == c->white_balance_k)
			return (int)i;
	return -1;
}

void exposures_add(struct exposures *e, const struct camera_controls *in_force)
{
	bool known = exposures_light(&e->controls[0]) > 0 && exposures_light(in_force) > 0;
	for (uint32_t i = 0; i < e->count; i++)
		if (exposures_light(in_force) == exposures_light(&e->controls[i]))
			return;
	if (known && e->count < EXPOSURES_MAX)
		e->controls[e->count++] = *in_force;
}

static struct camera_controls times(
	const struct camera_controls *base, double factor, uint32_t longest_100us)
{
	struct camera_controls c = *base;
	double wanted_100us = base->exposure_100us * factor;
	c.exposure_100us = (uint32_t)lrint(CLAMP(wanted_100us, 1, longest_100us));
	/* Rounding is no matter: the true ratio is known. */
	if (wanted_100us < 1 || wanted_100us > longest_100us)
		c.gain_percent =
			(uint32_t)CLAMP(lrint(base->gain_percent * wanted_100us / c.exposure_100us),
				GAIN_MIN_PERCENT, GAIN_MAX_PERCENT);
	return c;
}

struct exposures exposures_around(const struct camera_controls *base, uint32_t longest_100us)
{
	struct exposures e = { 1, { *base } };
	struct camera_controls darker = times(base, 1 / STEP, longest_100us),
			       lighter = times(base, STEP, longest_100us);
	exposures_add(&e, &darker);
	exposures_add(&e, &lighter);
	return e;
}
