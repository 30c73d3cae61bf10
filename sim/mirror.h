#ifndef SIM_MIRROR_H
#define SIM_MIRROR_H
/* When the lidar's motor brings which beam round. It turns from power-on whether anybody listens or
 * not, at a rate that its own clock keeps, and sweeps 270 degrees of each turn. Revolutions count
 * from power-on. */
#include <stdint.h>

struct mirror {
	int64_t epoch_ns; /* true time of the first beam of epoch_revolution */
	uint32_t epoch_revolution;
	double period_ns; /* true time of a turn */
	double beams_per_turn;
	uint32_t beams; /* of a sweep */
};

int64_t mirror_first_ns(const struct mirror *m, uint32_t revolution);
int64_t mirror_last_ns(const struct mirror *m, uint32_t revolution); /* of the last beam */
double mirror_beam_period_ns(const struct mirror *m);
/* The first revolution whose first beam is at or after a moment. */
uint32_t mirror_after(const struct mirror *m, int64_t at_ns);
/* The motor gets another speed from the first revolution after now. */
void mirror_set_period(struct mirror *m, int64_t now_ns, double period_ns);

#endif
