#include "sim/mirror.h"
#include <math.h>

int64_t mirror_first_ns(const struct mirror *m, uint32_t revolution)
{
	return m->epoch_ns +
	       llrint(m->period_ns * (double)(int32_t)(revolution - m->epoch_revolution));
}

double mirror_beam_period_ns(const struct mirror *m)
{
	return m->period_ns / m->beams_per_turn;
}

int64_t mirror_last_ns(const struct mirror *m, uint32_t revolution)
{
	return mirror_first_ns(m, revolution) + llrint(mirror_beam_period_ns(m) * (m->beams - 1));
}

uint32_t mirror_after(const struct mirror *m, int64_t at_ns)
{
	double turns = (double)(at_ns - m->epoch_ns) / m->period_ns;

	return m->epoch_revolution + (uint32_t)(int32_t)ceil(turns - 1e-9);
}

void mirror_set_period(struct mirror *m, int64_t now_ns, double period_ns)
{
	uint32_t next = mirror_after(m, now_ns);

	m->epoch_ns = mirror_first_ns(m, next);
	m->epoch_revolution = next;
	m->period_ns = period_ns;
}
