#ifndef PROCESS_FINE_PAIRS_H
#define PROCESS_FINE_PAIRS_H
/* Surfels of two scans that are the same surface, found by looking from one scanner into the other's pyramid, and the normal
 * equations over them. */
#include "process/fine-equations.h"
#include "process/pyramid.h"

/* A surfel of one scan that is looked for in the other. */
struct sample {
	float point_m[3], normal[3], sigma_m;
};

/* How a pair is looked for. The cells looked into are those about pitch_m wide where they look. */
struct pairing {
	double pitch_m;
	double slack_m; /* 1 sigma of what the planes may be apart beyond their own noise: also of the pose's error */
	double scale;      /* of the kernel, in normalised residuals */
	float cosine_min;  /* between normals */
	float sigma_max_m; /* of cells that count */
	bool around;       /* also in the eight cells around */
};

/* The level whose cells are about pitch_m wide at this range. */
int pairing_level(const pyramid *p, double pitch_m, float range_m);

struct pairs_look {
	size_t seen, seen_through;
};

/* Sums the samples of `from`, which are b's (then the pyramid is a's), or a's. pose takes b to a; a_to_b then is its inverse.
 * ret_residual may be NULL, else takes the normalised residual of each sample, NAN where there is no pair; ret_look
 * may be NULL, else counts the samples that look into the other's view, and those of them that stand where the other saw
 * through. ret_tile may be NULL, else has PAIRS_TILES rows and gets the right side's
 * sums over tiles of a's view. */
#define PAIRS_TILES_ACROSS 72 /* 5 degrees */
#define PAIRS_TILES_DOWN   36
#define PAIRS_TILES        (PAIRS_TILES_ACROSS * PAIRS_TILES_DOWN)
void pairs_sum(const struct pairing *how, const struct sample *samples, size_t count,
	const pyramid *into, const struct pose *pose, bool samples_are_b, struct equations *ret,
	float *ret_residual, struct pairs_look *ret_look, double (*ret_tile)[6]);

#endif
