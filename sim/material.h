#ifndef SIM_MATERIAL_H
#define SIM_MATERIAL_H
/* What surfaces are made of: colour as a function of the place, and how they meet light and the
 * lidar's beam.
 *
 * One texture serves all, by its numbers: cells in courses with joints (bricks, ashlar, tiles,
 * planks, books), grain (fine noise) and stains (coarse noise). Every part fades out where it is
 * finer than the footprint of a pixel, and joints are filtered exactly over the footprint, so that
 * neighbouring pixels do not sparkle. */
#include "sim/geometry.h"
#include "sim/world.h"

enum material_kind {
	MATERIAL_PLAIN, /* cells, grain and stains */
	MATERIAL_LEAF,  /* each face its own shade, and light shines through */
	MATERIAL_GLASS,
	MATERIAL_WATER,
};

struct material {
	vec colour; /* linear */
	vec joint_colour;
	float cell_u_m, cell_v_m; /* 0: no cells */
	float bond;               /* shift of every other course, in cells */
	float joint_m;
	float variety;            /* of cells or leaves: brightness, 0..1 */
	float warmth;             /* of cells or leaves: hue */
	float grain_per_m, grain; /* fine noise: how many features in a metre, how strong 0..1 */
	float grain_stretch;      /* features this much longer along z (bark, streaks); 0 means 1 */
	float stain_per_m, stain;
	float gloss;        /* mirrored share of light at normal incidence */
	float emission;     /* of its own colour */
	float reflectivity; /* at the lidar's wavelength */
	uint32_t seed;
	enum material_kind kind;
};

enum world_optics material_optics(const struct material *m);

/* The colour at a place. normal: of the surface; footprint_m: how wide a pixel is there; face: any
 * number that is the same all over one leaf. */
vec material_albedo(
	const struct material *m, vec place, vec normal, float footprint_m, uint32_t face);

#endif
