#ifndef RENDER_BENCH_REPROJECT_H
#define RENDER_BENCH_REPROJECT_H
/* Where the pixels of a frame were in the frame before: exactly, by the depth of what they show. */
#include "render/mask.h"

/* What a place of a picture shows at a depth (along the optical axis), as another camera sees it. false: it is behind that one. */
bool reproject_place(const struct camera *from, const double px[2], double depth_m,
	const struct camera *to, double ret_px[2], double *ret_depth_m);

/* In the picture, and none of the four nearest pixels is covered before it. */
bool reproject_shows(const struct camera *c, const visibility_mask *m, const double point_m[3]);

/* How deep what a pixel shows is: as the mask has it, less what the point's pipeline pushes it back (mask.h). */
double reproject_depth(const frame *f, int32_t key);

/* The same of all pixels of a mask of f, but of the discs that show there, which the mask has behind them by as much as they are wide:
 * centimetres where points are near and far between. Between discs what it fills
 * in; FILTER_FAR where nothing is. Free with g_free. */
float *reproject_depths(
	const frame *f, const visibility_mask *m, const struct chunk_view *views, uint32_t count);

typedef struct reprojection reprojection;
struct reprojection {
	uint32_t width, height;
	float (*before_px)[2]; /* of each pixel's middle; NAN: it was not to be seen */
};
/* Depths: of all pixels of the cameras' pictures (reproject_depths). */
reprojection *reprojection_new(const struct camera *now, const float *now_m,
	const struct camera *before, const float *before_m);
void reprojection_free(reprojection *r); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(reprojection, reprojection_free)

/* Of places of a picture: how much what they show changed from a frame to the next, and how light they are. */
struct reprojection_sums {
	double error2;        /* squared differences */
	double light, light2; /* of the second frame, and squared */
	uint64_t places;
};
/* Adds those of two planes of width x height. A place is a square of side x side pixels all of which were to be seen, and shows the mean
 * of them: moved pixel by pixel, then held against each other. Planes that are finer than what is judged by so much have no error that
 * comes from what lies between pixels. */
void reprojection_add(const reprojection *r, const float *now, const float *before, uint32_t side,
	struct reprojection_sums *to);
/* Mean squared change, and by the variance of what is shown: 0 where nothing changes, 2 where a frame has nothing to do with the one
 * before; how strong the contrast is does not matter. NAN: of nothing. */
double reprojection_change(const struct reprojection_sums *s);
double reprojection_share(const struct reprojection_sums *s);

#endif
