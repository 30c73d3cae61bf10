#ifndef PROCESS_FEATURES_PRIVATE_H
#define PROCESS_FEATURES_PRIVATE_H
/* What features*.c share. */
#include "process/features.h"

/* Planes of a scan's cells: those fitted to linked windows, not mended, so a crease leaves its error. */
struct feature_planes {
	float *normal[3], *error_m, *offset_m, *count, *curvature; /* as struct normals_planes */
};
void feature_planes_init(struct feature_planes *p, size_t cells);
void feature_planes_clear(struct feature_planes *p);

/* Feature points are those of a higher degree. */
static inline uint8_t feature_least(const struct features_options *o)
{
	return (uint8_t)CLAMP(255 * o->threshold, 0, 254);
}

/* 0..1 of an answer that is 1 at the threshold, where the degree is a half. */
static inline float feature_soft(float answer)
{
	return answer * answer / (1 + answer * answer);
}

/* The feature points around one, relative to it, and how much each counts. */
#define FEATURE_POINTS_MOST 96
struct feature_around {
	uint32_t count;
	float x[FEATURE_POINTS_MOST], y[FEATURE_POINTS_MOST], z[FEATURE_POINTS_MOST],
		weight[FEATURE_POINTS_MOST];
	float cut[FEATURE_POINTS_MOST][3];  /* of the planes at a crease; 0 0 0: none */
	uint8_t frame[FEATURE_POINTS_MOST]; /* whichever it is in, until all are in one */
};
/* cut: a direction; may be NULL. */
void feature_keep_point(struct feature_around *a, const float at[3], const float cut[3],
	float weight, uint8_t frame);

struct feature_line {
	float direction[3], middle[3];
	float error_m,
		spread_m; /* root mean squares across and along; error NAN: there is none at all */
};
/* Whether there is a line through the point itself. ahead: across all lines that it is compared with, as where the scanner looks;
 * explained_m: how far points may be off it; radius_m: how far off the point they are. */
bool feature_fit_line(const struct feature_around *a, const float cut[3], const float ahead[3],
	float explained_m, float radius_m, struct feature_line *ret);

/* What the line is of the surface around it in its own scan. */
enum feature_faces {
	FEATURE_FACES_UNKNOWN,
	FEATURE_FACES_DISAGREE, /* they tell of another line, or of none that is certain */
	FEATURE_FACES_CUT,      /* two that cut each other in it */
	FEATURE_FACES_ONE,      /* one that goes on, so that it is an edge of what it looks like */
	FEATURE_FACES_END,      /* one that ends there */
};
/* Fits planes to the points on both sides of the line in the picture, for many cells of a face together know its tilt much better than
 * the feature points, each off by a cell, know the line. Sets its direction to what they tell; otherwise leaves it as it is. cell, here: the
 * point itself; o: with the noise of ranges; is_cut_only: what is no cut need not be told. */
enum feature_faces feature_faces_at(const range_grid *g, size_t cell, const float here[3],
	const struct features_options *o, float explained_m, float radius_m, bool is_cut_only,
	struct feature_line *l);
/* How far the points are off a line that is not theirs: error and spread; as they were where none are near it. */
void feature_measure_line(
	const struct feature_around *a, float explained_m, struct feature_line *l);
void feature_keep_line(features *f, size_t i, const struct feature_line *l, bool is_line);

features *features_new(uint32_t columns, uint32_t rows); /* all without features */

/* Noise that is a pure function of the number, 0..1. */
static inline float feature_noise(uint32_t x)
{
	x ^= x >> 16;
	x *= 0x7feb352dU;
	x ^= x >> 15;
	x *= 0x846ca68bU;
	x ^= x >> 16;
	return (float)(x >> 8) * 0x1p-24f;
}

static inline float feature_darkness(float tone, float exponent)
{
	float dark = 1 - CLAMP(tone, 0.0f, 1.0f);
	return exponent == 1 ? dark : powf(dark, exponent);
}

static inline float feature_range_noise_m(const struct features_options *o, float range_m)
{
	float farther = o->noise_at_m > 0 ? range_m / o->noise_at_m : 1;
	return o->range_noise_m * farther * farther;
}

/* Edges of the geometry: answers, 1 at the threshold. Sets FEATURE_SILHOUETTE, _BEHIND and _CREASE. */
void feature_depth_edges(const struct features_input *of, const struct feature_planes *p,
	const struct features_options *o, float *answer, uint8_t *flags);
/* ret_cuts: of struct feature_cut. */
void feature_creases(const struct features_input *of, const struct feature_planes *p,
	const struct features_options *o, float *answer, uint8_t *flags, GArray **ret_cuts);
/* Edges of what it looks like. */
void feature_colour_edges(const range_grid *g, const struct features_options *o, float *answer);
void feature_intensity_edges(const range_grid *g, const struct features_options *o, float *answer);

/* Normal and two tangents of a point. */
struct feature_frame {
	float normal[3], first[3], second[3];
};
struct feature_frame feature_frame_of(const float normal[3]);

/* What the neighbours of a point say of its second fundamental form, which takes a step (a, b) along the surface to the change of
 * the normal (p, q): sums over them. Zero to begin with. */
struct feature_form {
	float a, b, p, q, aa, ab, bb, ap, aq_bp, bq;
	unsigned count,
		ways; /* ways: one bit each of eight directions, the opposite of each four later */
};
/* Of a neighbour whose normal has that cosine with the point's, that far off its plane: normals further apart are of another face, points
 * further off, as a share of how far away they are, too. */
static inline bool feature_form_is_same_face(float away2_m2, float off_plane_m, float cosine)
{
	return cosine > 0.7f && off_plane_m * off_plane_m <= 0.25f * away2_m2;
}
/* off: of the neighbour from the point, which is not added itself; there: its normal. What is of another face is left out. */
void feature_form_add(struct feature_form *s, const struct feature_frame *f, const float off[3],
	const float there[3], int way);
/* Principal curvatures and direction of point i, if neighbours stand around it and determine them. */
void feature_form_keep(
	const struct feature_form *s, const struct feature_frame *frame, features *f, size_t i);
/* Normals as of whole planes, mended at creases. */
void feature_curvature(const struct features_input *of, const float *const normal[3],
	const struct features_options *o, features *f);
/* Chooses dithering points among the cells that are no feature points (kind). Normals 0 0 0: none, facing the scanner. */
void feature_dither(const range_grid *g, const float *const normal[3],
	const struct features_options *o, features *f);

#endif
