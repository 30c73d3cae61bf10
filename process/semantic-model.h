#ifndef PROCESS_SEMANTIC_MODEL_H
#define PROCESS_SEMANTIC_MODEL_H
/* A semantic model that a user brings: a network that tells from the channels of a panorama what each cell shows. It is two
 * files, MODEL.onnx, which takes 1 x channels x rows x columns numbers and answers 1 x classes x rows x columns scores, and
 * MODEL.json beside it (semantic-manifest.h). It runs on the processor, in tiles that overlap; where the panorama wraps, tiles
 * go on over the seam, and the whole panorama as one tile gets as many columns of the other side as the overlap has at each end.
 *
 * A file that is no model, cut off, or beyond what OpenCV runs is refused. But a network is trusted as a program is: what
 * onnx-check.h finds wrong is refused, but OpenCV's reader was not made for files that mean harm.
 *
 * Errors are one sentence that names the file. One owner, one thread at a time. */
#include "process/geometry.h"
#include "process/semantic-manifest.h"

typedef struct semantic_model semantic_model;

#define SEMANTIC_NONE 255 /* as a class: there is no point */

/* path: of MODEL.onnx. Refuses a missing or damaged file of the two, and a network that OpenCV 4.6 cannot run. */
semantic_model *semantic_model_open(const char *path, GError **error);
void semantic_model_free(semantic_model *m); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(semantic_model, semantic_model_free)

/* Channels, classes, tiles; owned by m. */
const semantic_manifest *semantic_model_manifest(const semantic_model *m);

/* What a model can be told of a scan; what is NULL is not known, and a model that wants it is refused. A grid without intensity
 * or colour does not know these. */
struct semantic_scan {
	const range_grid *grid;
	const geometry *normals;
	const float *height_m; /* of each cell, above the ground */
};

/* Planes of the grid's cells: the likeliest class, an index into the manifest's, and its probability 0..1. Cells without a point
 * are SEMANTIC_NONE and 0. Nothing is written on failure. */
bool semantic_model_run(semantic_model *m, const struct semantic_scan *scan, uint8_t *ret_class,
	float *ret_confidence, GError **error);

#endif
