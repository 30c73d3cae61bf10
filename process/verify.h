#ifndef PROCESS_VERIFY_H
#define PROCESS_VERIFY_H
/* Is this pose between two scans true? Each scan is projected into the other's grid. A point agrees when the other scan
 * measured the same surface there, is occluded when the other saw something nearer, and conflicts when the other saw through
 * the place where it is: impossible, unless something moved. Both ways.
 *
 * A wrong pose that is accepted is the worst thing this program can do. */
#include "process/fine.h"
#include "process/verify-view.h"

enum verdict {
	VERDICT_ACCEPTED,
	VERDICT_NO_OVERLAP, /* the scans share too little to tell */
	VERDICT_CONFLICT,   /* surfaces stand where the other scan saw through */
	VERDICT_SLIDING,    /* what they share leaves a direction open: a long corridor, one wall */
	VERDICT_AMBIGUOUS,  /* another pose fits about as well */
	VERDICT_NO_SOLUTION, /* nothing fitted at all */
	VERDICT_IMPRECISE,   /* fits, but not as closely as it must */
	VERDICTS
};
extern const char *const verdict_names[VERDICTS]; /* "accepted", "no-overlap", ... */

struct verification {
	enum verdict verdict;
	char reason[200]; /* one sentence for people, with figures */
	/* Solid angles as the scanners saw them, sums over both ways, in sr. */
	double agree_sr, occluded_sr;
	double conflict_sr; /* the other scan saw a surface farther away, through this one */
	double void_sr; /* the other saw nothing there: glass, water and black things do that too */
	double missed_sr; /* a surface facing the same way lies within 0.3 m, but not here */
	double outside_sr;
	double overlap;   /* agree over all that the other looked at, 0..1 */
	double agreement; /* agree / (agree + conflict + missed) */
	double rms_m,
		under_6mm; /* of the agreeing points' distance from the other's surface: rms, share under 6 mm */
	double balance; /* how evenly the agreeing surfaces hold the three directions: smallest eigenvalue of the mean of
			   normal * normal^T, times 3, 0..1 */
	double deviation_m, deviation_rad; /* 1 sigma of the pose in its worst direction */
	double rival_score; /* contradictions of this pose over those of the likeliest other one, 0..1; 0: there is none */
};

/* For the difference map: per cell of b, what it is in a. */
enum verify_cell {
	VERIFY_NONE,
	VERIFY_AGREE,
	VERIFY_OCCLUDED,
	VERIFY_CONFLICT,
	VERIFY_VOID,
	VERIFY_MISSED,
	VERIFY_OUTSIDE
};
struct verify_map {
	uint32_t columns, rows; /* of b's grid */
	uint8_t *cell;          /* enum verify_cell */
	float *distance_m;      /* from a's surface, signed; of agreeing cells, else 0 */
};
void verify_map_clear(struct verify_map *m);

/* Measures all but verdict, reason and rival_score. ret_map may be NULL. */
void verify_measure(const struct verify_view *a, const struct verify_view *b,
	const struct fine_result *fine, struct verification *ret, struct verify_map *ret_map);
/* The share of what both looked at that contradicts the pose: what is compared between rivals. */
double verify_contradiction(const struct verification *v);
/* Whether so much is shared that it says something for or against the pose. */
bool verify_is_evidence(const struct verification *v);
/* Verdict and reason of a pose that was measured; rival: the likeliest other one, or NULL. */
void verify_judge(
	struct verification *v, const struct fine_result *fine, const struct verification *rival);
void verify_no_solution(struct verification *ret);

#endif
