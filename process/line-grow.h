#ifndef PROCESS_LINE_GROW_H
#define PROCESS_LINE_GROW_H
/* Straight lines grown through places: from a seed along its line, as far as places that lie on it follow each other; the line is
 * fitted anew as it gets longer. Each place belongs to one line.
 *
 * One owner, one thread. */
#include "process/cloud-cells.h"
#include "process/line-fit.h"

struct line_place {
	double at[3];
	float along[3]; /* unit, its sign is free; 0 0 0: not known, it may be on any line */
	float within_m; /* it is on a line that passes so near */
	float weight;
	bool is_used;
};

struct line_run {
	struct straight line;
	double from_m, to_m;
	GArray *found; /* of uint32_t: places on it */
};

typedef struct line_grower line_grower;
/* stride bytes each, of which a struct line_place is the first; they must stay. gap_m: places follow each other when they are no farther
 * apart; turn_cos: cosine of how much their directions differ from the line's. */
line_grower *line_grower_new(
	void *places, uint32_t count, size_t stride, double gap_m, double turn_cos);
void line_grower_free(line_grower *g); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(line_grower, line_grower_free)

/* From the seed, which must not be used yet, and is in the end. A seed of no direction takes the one in which most unused places within seed_m that have
 * none lie in a row with it; false: too few do. ret->found is made anew each time and is the grower's. */
bool line_grower_grow(line_grower *g, uint32_t seed, double seed_m, struct line_run *ret);
/* Calls visit for all places within radius_m, at most LINE_GROW_REACH_M. */
#define LINE_GROW_REACH_M 0.3
void line_grower_visit(const line_grower *g, const double at[3], double radius_m,
	void (*visit)(uint32_t place, const float off[3], void *data), void *data);

#endif
