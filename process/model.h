#ifndef PROCESS_MODEL_H
#define PROCESS_MODEL_H
/* The unified, non-redundant point model of a site: SITE/model/points.model, a product file (product.h) that is mapped into
 * memory (pleinair-model(5)). Points stand in chunks of 4096 along a Morton curve through the site, leaf after leaf of the
 * segment tree. Inside a chunk they are shuffled, so that every prefix of a chunk is a uniform subset of it (DESIGN,
 * "Process" 5; the continuous resolution queue of Xu & Chen 2004, section 6), whose points keep apart from each other: blue noise
 * (chunk-order.h). Positions are relative to the chunk's centre, so that
 * they stay exact anywhere.
 *
 * The curve is cut into pieces at places that the points around them decide alone (model-piece.h), so that a model with one more
 * scan has the same chunks wherever that scan changes nothing.
 *
 * Errors are those of product.h. */
#include "process/pose.h"
#include "process/product.h"

#define MODEL_KIND         "model"
#define MODEL_VERSION      6
#define MODEL_CHUNK_POINTS 4096u
#define MODEL_NORMAL_NONE  INT16_MIN
#define MODEL_ERROR_NONE   UINT16_MAX /* of the plane error */
#define MODEL_HALF_NONE    0x7E00u    /* not a number */

/* One point, as the GPU takes it: 48 bytes, each attribute aligned to 4 or beside its pair. What comes after leaf is of the features
 * of its scan (scan-features.h, features.h): all zero or none without them. The sign of both directions is free. */
struct model_point {
	float position_m[3]; /* from the chunk's centre */
	int16_t normal[2];   /* in the site's frame: octahedral, snorm; -32768 in both: none */
	uint8_t rgba[4];     /* sRGB; a: 255 has colour, 0 has none */
	uint16_t intensity;
	uint16_t scan;          /* number */
	uint16_t size;          /* diameter of its patch, 0.1 mm; saturates */
	uint8_t classification; /* as LAS 1.4 numbers them */
	uint8_t feature;        /* feature degree * 255; 0 until features are computed */
	uint16_t plane_error;   /* of the plane fit, 0.1 mm; saturates at 65534; 65535: none */
	uint16_t leaf;          /* of the segment tree; 0 until there is one */
	int16_t direction
		[2]; /* of the line that a feature point is on, directed or not; as normal */
	int16_t principal[2]; /* of the curvature k1; as normal */
	uint16_t k1, k2;      /* principal curvatures, 1/m, half floats; MODEL_HALF_NONE: none */
	uint8_t kind;         /* enum feature_kind */
	uint8_t flags;        /* enum feature_flag */
	uint16_t spacing;     /* edge of the surface that it stands for, 0.1 mm; saturates */
};
_Static_assert(sizeof(struct model_point) == 48, "the file's own layout");

struct model_chunk {
	double centre_m[3];
	float half_size_m[3]; /* of its box */
	uint32_t points;      /* MODEL_CHUNK_POINTS in all but the last of a piece; at least 1 */
	uint64_t first;       /* index of its first point: the sum of the points before */
	uint32_t crc32c;      /* of its points */
	uint32_t leaf;
	uint32_t reserved[2];
};
_Static_assert(sizeof(struct model_chunk) == 64, "the file's own layout");

/* Chunks that stand together in short (model-coarse.h): one point in so many of so many chunks. */
#define MODEL_GROUP_CHUNKS 64u
/* In short how light all points are: numbers of points. */
#define MODEL_TONES_STEP   7u
#define MODEL_TONES_SAMPLE 64u
struct model_tones {
	uint32_t lightness[256];   /* of one in MODEL_TONES_STEP, where these have a colour */
	uint32_t intensity[65536]; /* and where they have none */
	uint32_t sample[65536]; /* of the first MODEL_TONES_SAMPLE of each chunk that have none */
};
_Static_assert(sizeof(struct model_tones) == 4 * (256 + 2 * 65536), "the file's own layout");

/* Const after it was opened; any number of threads may read. */
typedef struct model model;
char *model_path(const char *site_path); /* SITE/model/points.model; caller frees */
/* Checks that the chunks and points belong together, not their checksums. A model of another version is refused, an earlier one
 * too, with PRODUCT_ERROR_VERSION: it is made anew. */
model *model_open(const char *site_path, GError **error);
model *model_open_file(const char *path, GError **error);
void model_free(model *m); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(model, model_free)
uint64_t model_count(const model *m);
const struct model_chunk *model_chunks(const model *m, uint64_t *ret_count);
const struct model_point *model_points(const model *m); /* all, by chunk.first */
/* What it says in short of its points; all NULL and 0 in files of before it did. Groups have their points in ret->point, by first, and
 * their chunks: reserved[0] is the first one's number, reserved[1] how many there are. */
struct model_short {
	const struct model_chunk *group;
	uint64_t groups;
	const struct model_point *point;
	uint64_t points;
	const struct model_tones *tones;
};
struct model_short model_in_short(const model *m);
const product *model_file(const model *m); /* manifest: what it was made from; product_forget */
/* One chunk: whoever pages chunks in can check each. */
bool model_verify_chunk(const model *m, uint64_t chunk, GError **error);
bool model_verify(const model *m, GError **error); /* all checksums, chunk by chunk */

/* Of a point's colour, 0 to 255, as the eye weighs it. */
static inline uint8_t model_lightness(const uint8_t rgba[4])
{
	return (uint8_t)((77 * rgba[0] + 150 * rgba[1] + 29 * rgba[2] + 128) >> 8);
}

/* Within 0.01 degrees. A normal that is not finite or of no length becomes none; none unpacks to 0 0 0. */
void model_pack_normal(const float normal[3], int16_t ret[2]);
void model_unpack_normal(const int16_t packed[2], float ret[3]);

/* Half precision (IEEE 754 binary16), to the nearest, of two to the even one: 11 bits, and steps of 6e-8 below 6.1e-5. What is
 * beyond its range, infinity too, becomes 65504; what is not a number MODEL_HALF_NONE, which unpacks to NAN. */
uint16_t model_pack_half(float value);
float model_unpack_half(uint16_t half);

#endif
