#ifndef PROCESS_PAIR_H
#define PROCESS_PAIR_H
/* Two scans, one verdict: coarse candidates, each refined, the best verified against its rivals. */
#include "process/coarse.h"
#include "process/fine.h"
#include "process/verify.h"

/* All that aligning needs of one scan, and where it is like itself. Made once per scan, then used for all its pairs; const
 * after, for any number of threads. Keeps nothing of the grid. */
typedef struct pair_scan pair_scan;
pair_scan *pair_scan_new(const range_grid *g);
/* Poses to itself: what was found of a scan once may be given the next time. */
#define PAIR_ALIKES_MOST 4
struct pair_alikes {
	uint32_t count;
	struct pose pose[PAIR_ALIKES_MOST];
};
pair_scan *pair_scan_new_known(const range_grid *g, const struct pair_alikes *known);
struct pair_alikes pair_scan_alikes(const pair_scan *s);
void pair_scan_free(pair_scan *s); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(pair_scan, pair_scan_free)
uint64_t pair_scan_bytes(const pair_scan *s); /* memory, about */

struct pair_options {
	/* A pose to start from, as picked pairs or the graph give it; NULL: no idea. Rivals are looked for all the same. */
	const struct pose *start;
	bool not_level;
};

struct pair_result {
	struct pose pose; /* takes b's scanner frame to a's; the best there is, also when refused */
	struct fine_result fine;
	struct verification verification;
	double coarse_s, fine_s, verify_s; /* CPU time */
};

/* Always gives a verdict; not accepting is an answer, not an error. */
void pair_align(const pair_scan *a, const pair_scan *b, const struct pair_options *options,
	struct pair_result *ret);

/* Only what is near a pose: refined from there, which may be off by 0.3 m and 2 degrees; or, when refine is false, the pose
 * as it is, held as well as its refinement would be, and no better than by what that would change. rival: of another pose that
 * was measured, as verify_judge has it; may be NULL. */
void pair_near(const pair_scan *a, const pair_scan *b, const struct pose *start, bool refine,
	const struct verification *rival, struct pair_result *ret);

/* Only the check of a given pose, which is not refined; rivals are not looked for. ret_map may be NULL. */
void pair_verify(const pair_scan *a, const pair_scan *b, const struct fine_result *fine,
	struct verification *ret, struct verify_map *ret_map);

#endif
