#ifndef PROCESS_VERIFY_H
#define PROCESS_VERIFY_H
/* Is this pose between two scans true? Each scan's surfaces are put into the other's view (verify-compare.h). A surface
 * agrees when the other scan measured it there too, in its own plane and facing the same way; it is occluded when the other
 * saw something nearer; it conflicts when the other saw through the place where it is: impossible, unless something moved.
 * Both ways, by solid angle.
 *
 * Things that moved (people, cars, chairs) are some percent of a view at most; only what stands beside a scanner is more,
 * and it is known by being near and compact (verify-conflicts.h). A wrong pose puts walls into places that the
 * other saw through, but in a hall that is its own half turn, or along equal houses, only a few percent of them too. So what
 * counts most is the comparison with rivals: other poses in which the same surfaces meet. A rival is refuted only by whole
 * things that it puts where they were seen through; edges, and single cells of distant walls, refute nothing, for even true
 * poses have some. Neither does it count how much agrees: a hall's wrong half may agree with more. A rival that is not
 * refuted makes the answer ambiguous, whatever the figures of the best.
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
	/* Sums over both ways, each surface weighted by the solid angle that it covers for the scan that saw it, in sr. */
	double agree_sr, occluded_sr, conflict_sr, outside_sr;
	double together_sr; /* of the conflicts, those that lie together: not edges, nor thin things */
	double thing_sr; /* of things beside the scanners that the other saw through; not in the conflicts */
	double thing_together_sr; /* of these, what lies together */
	double beams;             /* that a surface rests on, in the coarser of the two scans */
	double missed_sr;         /* a parallel surface stands within 0.3 m, but not here */
	double void_sr; /* the other saw nothing at all there, as it does of the sky, glass and water */
	double overlap;   /* agree over agree, occluded, conflict and missed, 0..1 */
	double agreement; /* agree / (agree + conflict + missed) */
	double rms_m,
		under_6mm; /* of the distance of agreeing surfaces that are even: rms, share under 6 mm */
	double balance; /* how evenly the agreeing surfaces hold the three directions: smallest eigenvalue of the mean of
			   normal * normal^T, times 3, 0..1 */
	/* How far b would still have to go, and turn, for what agrees to come to rest. */
	double rest_m, rest_rad;
	double deviation_m,
		deviation_rad; /* 1 sigma in the worst direction: of where b stands, of how it is turned */
	/* How near the likeliest rival comes: what this pose may contradict itself at most to be told from it, over what it
	 * does; 0: there is no rival, 1 and above: it cannot be told. */
	double rival_score;
};

/* For the difference map: per cell of b's view, what it is in a. */
enum verify_cell { VERIFY_NONE, VERIFY_AGREE, VERIFY_OCCLUDED, VERIFY_CONFLICT, VERIFY_OUTSIDE };
struct verify_map {
	uint32_t columns, rows; /* of b's grid, or of blocks of it about half a degree wide */
	uint8_t *cell;          /* enum verify_cell; a miss is a conflict */
	float *distance_m; /* from a's surface, positive: nearer to a; of agreeing cells, else 0 */
};
void verify_map_clear(struct verify_map *m);

/* How closely a pose is looked at. */
enum verify_care {
	VERIFY_ROUGH, /* a fourth of the surfaces, for poses that may be off by centimetres */
	VERIFY_FULL,
};

/* Measures all but verdict, reason and rival_score. ret_map may be NULL, else care must be full. */
void verify_measure(const struct verify_view *a, const struct verify_view *b,
	const struct fine_result *fine, enum verify_care care, struct verification *ret,
	struct verify_map *ret_map);
/* The share of what the scans should both see that contradicts the pose. */
double verify_contradiction(const struct verification *v);
/* The same with some doubt that only much agreement outweighs: the lower, the likelier is the pose. */
double verify_doubt(const struct verification *v);
/* Whether the scans share enough in this pose for a verdict. */
bool verify_shares_enough(const struct verification *v);
/* Above 1, v cannot be told from the rival; 0: the other shares so little that it is none. */
double verify_rivalry(const struct verification *v, const struct verification *rival);
/* Verdict and reason of a pose that was measured in full; rival: the likeliest other one, or NULL. */
void verify_judge(struct verification *v, const struct verification *rival);
void verify_no_solution(struct verification *ret);

#endif
