#ifndef RENDER_BENCH_REPROJECT_H
#define RENDER_BENCH_REPROJECT_H
/* Where the pixels of a frame were in the frame before: exactly, by the depth of what they show. */
#include "render/mask.h"

/* What a place of a picture shows at a depth (along the optical axis), as another camera sees it. false: it is behind that one. */
bool reproject_place(const struct camera *from, const double px[2], double depth_m,
	const struct camera *to, double ret_px[2], double *ret_depth_m);

/* In the picture, and none of the four nearest pixels is covered before it. */
bool reproject_shows(const struct camera *c, const visibility_mask *m, const double point_m[3]);

/* How deep what a pixel shows is: as the mask has it, less what the point's pipeline pushes it back (mask.h). NULL: nothing does. */
double reproject_depth(const frame *f, int32_t key);

typedef struct reprojection reprojection;
struct reprojection {
	uint32_t width, height;
	float (*before_px)[2]; /* of each pixel's middle; NAN: it was not to be seen */
};
/* f: that both masks are of, whatever its camera; NULL: they are not pushed back. */
reprojection *reprojection_new(const frame *f, const struct camera *now,
	const visibility_mask *mask_now, const struct camera *before,
	const visibility_mask *mask_before);
void reprojection_free(reprojection *r); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(reprojection, reprojection_free)

/* Sum of squared differences of two planes of width x height; adds how many pixels these are of. */
double reprojection_error(
	const reprojection *r, const float *now, const float *before, uint64_t *add_pixels);

#endif
