#ifndef PROCESS_OVERLAP_H
#define PROCESS_OVERLAP_H
/* Where two scans with grids measured the same surface, which of the two points stays?
 *
 * Each point is projected into the other scan's grid. What that scan measured in this direction is its partner when it lies on
 * the same surface: within the tolerance along the normal, with normals that look to the same side. The better measured of the
 * two stays: the one whose beam covers the smaller patch of the surface, range^2 * angle^2 / cos(incidence). Both are weighed at
 * the same place, half way between the two, with the same normal, so that a pair of partners judges alike from either side and
 * exactly one of them goes. When the partner has another partner yet, and gives way to that one, the point stays: so what is
 * dropped has a point beside it that stays, as far as these two scans go.
 *
 * A plane is thus parted among the scans along clean lines, and what only one scan saw stays.
 *
 * Pairs of scans do not depend on other scans, nor on the order of anything: a scan that is added changes no other pair. */
#include "process/range-grid.h"
#include "process/scan-geometry.h"

struct overlap_point {
	float position_m
		[3]; /* scanner frame; 0 0 0: none, and normal[0] is its enum panorama_cell */
	int16_t normal
		[2]; /* octahedral, scanner frame; none where the surface is not flat: leaves, edges */
};

/* What the comparison needs of a scan: 16 bytes a cell. Const after it is made. */
typedef struct overlap_scan overlap_scan;
struct overlap_scan {
	uint32_t number; /* of the scan: of two that are as good, the lower one stays */
	uint32_t columns, rows;
	struct pose pose; /* scanner frame to site; may be set any time before marking */
	double beam_sr;   /* solid angle of a cell at the horizon */
	double reach_m;   /* range of its farthest point */
	struct overlap_point *point;
	struct range_lattice lattice; /* with a copy of the cells */
};
/* geometry may be NULL: then incidence does not count. */
overlap_scan *overlap_scan_new(uint32_t number, const range_grid *g, const scan_geometry *geometry);
void overlap_scan_free(overlap_scan *s); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(overlap_scan, overlap_scan_free)
uint64_t overlap_scan_bytes(const overlap_scan *s);

struct overlap_options {
	double range_noise_m; /* 0: 0.012; 1 sigma of a range */
};
/* Sets dropped[cell] to 1 for the points of a that b has better; leaves the rest as it is. On all threads. */
void overlap_mark(const overlap_scan *a, const overlap_scan *b,
	const struct overlap_options *options, uint8_t *dropped);
/* Whether any point of a could be dropped for b, told from how far they reach. */
bool overlap_is_possible(const overlap_scan *a, const overlap_scan *b);

#endif
