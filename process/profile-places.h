#ifndef PROCESS_PROFILE_PLACES_H
#define PROCESS_PROFILE_PLACES_H
/* Which pieces are where: a hash table of cubes, each with a list of numbers. One owner; const it may be asked by any number of threads. */
#include "process/profile-pieces.h"

struct places {
	struct cube *cube;
	uint32_t mask, cubes;
	GArray *entries;
};
void places_init(struct places *p);
void places_clear(struct places *p);
void places_add_at(struct places *p, const double at[3], uint32_t piece);
/* A place every so often along the piece between two places of it; and how many that are, less one. */
void places_add(struct places *p, const struct profile_piece *piece, double from_m, double to_m,
	uint32_t number);
uint32_t places_steps(double from_m, double to_m);

/* A bit of each number that there is. */
struct places_found {
	uint64_t *is_in;
	uint32_t words;
};
struct places_found places_found_new(uint32_t numbers);
/* Those with a place in the cubes around this one. */
void places_find(const struct places *p, const double at[3], struct places_found *ret);
/* Numbers, uint32_t, in order; caller unrefs. */
GArray *places_found_take(struct places_found *f);
/* Of so many pieces those that may be near this one, or near where it would be if it were longer by reach_m, in order; caller unrefs. */
GArray *places_near(const struct places *p, uint32_t numbers, const struct profile_piece *piece,
	double reach_m);

#endif
