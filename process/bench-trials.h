#ifndef PROCESS_BENCH_TRIALS_H
#define PROCESS_BENCH_TRIALS_H
/* Trials of registration: pairs whose truth is known, and what came of them. */
#include "process/bench-sites.h"

enum trial_kind {
	TRIAL_OVERLAP, /* stations 3 to 20 m apart that share enough */
	TRIAL_MOVED,   /* the same, and what can move stands elsewhere in one scan */
	TRIAL_LITTLE,  /* the same site, but they share less than enough */
	TRIAL_SYMMETRIC, /* a place that half a turn does not change: nothing tells which end is which */
	TRIAL_REPEATED, /* a row of equal houses */
	TRIAL_NONE,     /* different sites */
	TRIAL_KINDS
};
extern const char *const trial_kind_names[TRIAL_KINDS];

/* Two scans share enough when at the true pose so much agrees. */
#define TRIAL_SHARED_SR   1.0
#define TRIAL_OVERLAP_MIN 0.2
/* An accepted pose further off than this is wrong. */
#define TRIAL_WRONG_RAD (0.05 * G_PI / 180)
#define TRIAL_WRONG_M   0.010
/* What accepted ones are to reach. */
#define TRIAL_GOOD_RAD (0.01 * G_PI / 180)
#define TRIAL_GOOD_M   0.002

enum trial_outcome {
	TRIAL_RIGHT,   /* accepted, and true */
	TRIAL_WRONG,   /* accepted, and not true */
	TRIAL_REFUSED, /* found, and refused although true */
	TRIAL_MISSED,  /* another pose was found, or none, and it was refused */
	TRIAL_ALIKE, /* refused as ambiguous, where indeed nothing that stays in its place tells the poses apart */
	TRIAL_RIGHTLY_REFUSED, /* refused, and they do not overlap, or too little */
	TRIAL_OUTCOMES
};

struct trial {
	const struct bench_site *site_a, *site_b;
	const struct bench_scan *a, *b;
	enum trial_kind kind;
	double distance_m, overlap, agreement, shared_sr; /* at the true pose */
	struct pair_result result;
	double error_rad, error_m;
	enum trial_outcome outcome;
	/* For the record, when its sites are gone. */
	char name[96];
};

/* All pairs of a round's sites that make a trial, in an order of chance; at most max_none of different sites. */
GArray *trials_list(
	const struct bench_site *sites, uint32_t count, uint32_t max_none, GRand *chance);
/* Aligns and judges one. Any thread. */
void trial_run(struct trial *t);

#endif
