#ifndef PROCESS_FEATURES_H
#define PROCESS_FEATURES_H
/* Which points a drawing should show (Xu & Chen 2004, sections 5.2 and 5.3), of scans with a grid.
 *
 * Feature degree, 0..1. The error of the plane at a cell is how far the surfaces that a plane was fitted to on its two sides lie
 * off each other's planes, for one plane would have to hold both. On even and on evenly curved surface that is nothing, or
 * the same all around. An edge filter runs over it: it answers to steps (depth edges, where the windows of the planes end) and to
 * ridges (creases). Its answer is measured in what the noise of the ranges leaves uncertain, so that it means the same near and far,
 * at any spacing of beams. Edges of colour and intensity are added, linearly, by weights.
 *
 * Feature points are those of a higher degree than a threshold. A line is fitted to the feature points around each, of all scans
 * (their equation 2), or at creases taken from the cuts of small planes. It tells where to look: planes fitted to all points on either
 * side of it give its direction, as the cut of two, or the end of one in the plane that the end is seen in. A point is directional
 * where two planes cut each other, or its line stands out, is the same in both halves, and no plane tells otherwise. Of the others,
 * dithering points are chosen by error diffusion, such that their number per area of surface tells how dark it is, however far away.
 *
 * Planes of cells like those of the grid. Const after it was made. The same input gives the same bytes on any number of threads. */
#include "process/range-grid.h"

enum feature_kind {
	FEATURE_NONE, /* of no feature, or no point at all */
	FEATURE_DITHER,
	FEATURE_UNDIRECTED,
	FEATURE_DIRECTED,
	FEATURE_KINDS
};

/* What a degree comes from; also of cells below the threshold. */
enum feature_flag {
	FEATURE_SILHOUETTE = 1, /* the near side of a depth edge, or of nothing */
	FEATURE_BEHIND = 2, /* the far side; of no degree itself, for what ends there is a shadow */
	FEATURE_CREASE = 4,
	FEATURE_COLOUR_EDGE = 8,
	FEATURE_INTENSITY_EDGE = 16,
};

#define FEATURE_LINE_ERROR_NONE UINT16_MAX

/* Where the planes on both sides of a crease cut each other, next to the cell's point. A cell of a slanted surface is far off its
 * edge; this is not. The direction of one alone is uncertain by some degrees. */
struct feature_cut {
	uint32_t cell;
	float at_m[3], direction[3]; /* scanner frame; unit, its sign is free */
};

typedef struct features features;
struct features {
	uint32_t columns, rows;
	uint8_t *degree, *kind, *flags; /* degree * 255; enum feature_kind; enum feature_flag */
	int16_t (*direction)
		[2]; /* of the line, packed (model.h), its sign is free; none: MODEL_NORMAL_NONE in both */
	uint16_t *
		line_error; /* root mean square distance from the line, 0.1 mm; FEATURE_LINE_ERROR_NONE */
	/* Principal curvatures, 1/m, k1 the one of the greater magnitude; positive where the surface bulges towards the
	 * scanner, of a cloud along the normal; NAN: none. And the direction of k1, packed, sign free. */
	float *k1, *k2;
	int16_t (*principal)[2];
	GArray *cuts; /* of struct feature_cut, by cell; NULL: none are known */
};
void features_free(features *f); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(features, features_free)

/* Zero is the default of each. */
struct features_options {
	float range_noise_m; /* found in the scan */
	float noise_at_m; /* 0: noise is the same everywhere; else, of cameras of depth, where it is so much, and it grows with the range squared */
	float radius_m;   /* 0.06: of windows, wider where beams are sparse, as geometry.h has it */
	/* Weights of the edges in the degree: 1, 0.7, 0.3. What the scan does not have (colour, intensity) leaves its weight to the
	 * other one. Negative: none. */
	float geometry_weight, colour_weight, intensity_weight;
	float threshold; /* 0.42; degree of a feature point: an edge alone is 0.5 where it stands out just so */
	float line_radius_m; /* 0.4: around a point the line is fitted within; wider where beams are sparse */
	float line_error; /* 1: how far points may lie off a line, in what noise and spacing explain */
	float dither_per_m2; /* 60: dithering points per area of black surface */
	float tone_exponent; /* 1: of the darkness */
	bool single_thread;
	bool portable; /* without the vectors of this very processor: for tests */
};
struct features_options features_defaults(
	const struct features_options *options); /* filled in; may be NULL */

/* A scan and what is known of it. leaf: of each cell, 0: not known; neighbours of another known leaf are left out (section 5.1); NULL. */
struct features_input {
	const range_grid *grid;
	struct pose pose; /* scanner frame to site */
	const uint16_t *leaf;
};

/* Of one scan: degree, flags, curvature, dithering points; and its feature points, all FEATURE_UNDIRECTED. */
features *features_estimate(
	const struct features_input *of, const struct features_options *options);

/* The feature points of a scan that lines are fitted to (features-ridges.h). Found once, after that read by any number of threads.
 * The grid is borrowed; what the features say is taken over. */
typedef struct features_ridges features_ridges;
features_ridges *features_ridges_new(
	const struct features_input *of, const features *f, const struct features_options *options);
void features_ridges_free(features_ridges *r); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(features_ridges, features_ridges_free)

/* A scan around, as the line fits need it; its leaves are those that its ridges were found with. */
struct features_view {
	struct features_input scan;
	const features_ridges *ridges;
};
/* Kind, direction and line error of the feature points, from those of all views; the scan itself must be one of them. */
void features_fit_lines(features *f, const struct features_input *of,
	const struct features_view *views, size_t count, const struct features_options *options);

/* All of it, of scans[which]. */
features *features_of_scans(const struct features_input *scans, size_t count, size_t which,
	const struct features_options *options);

#endif
