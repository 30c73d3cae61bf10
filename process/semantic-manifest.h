#ifndef PROCESS_SEMANTIC_MANIFEST_H
#define PROCESS_SEMANTIC_MANIFEST_H
/* What stands in MODEL.json beside MODEL.onnx: which channels the network wants, in which order, and what its scores mean.
 *
 *     {
 *         "channels": ["range_m", {"name": "intensity", "mean": 0.2, "scale": 4}, "measured"],
 *         "classes": ["building", "vegetation", "terrain", "lawn", "other"],
 *         "scores": "logits",
 *         "tile": [512, 256],
 *         "overlap": 32
 *     }
 *
 * channels: 1 to 11 of those of enum semantic_channel, none twice. The network is given (value - mean) * scale, without them
 *   the value itself; 0 for every channel where there is no point.
 * classes: 1 to 254 names, none twice. Those that pleinair tells apart are "building", "vegetation", "terrain", "structure"
 *   and "water"; others keep their names and count as other.
 * scores: "logits" (if it is missing) or "probabilities".
 * tile: columns and rows of what the network is given, 8 to 16,384 each; if missing, the whole panorama.
 * overlap: cells at each edge of a tile whose scores are thrown away but for those at the edge of the panorama, 0 if
 *   missing, less than half of the tile.
 *
 * Unknown keys are passed over. Errors are one sentence with the file and the key, of the domains that acquire/manifest.h has. */
#include "process/segment-class.h"
#include <glib.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum semantic_channel {
	SEMANTIC_RANGE,     /* "range_m" */
	SEMANTIC_INTENSITY, /* "intensity", 0..1 of what 16 bits hold */
	SEMANTIC_RED,       /* "red", "green", "blue", sRGB, 0..1 */
	SEMANTIC_GREEN,
	SEMANTIC_BLUE,
	SEMANTIC_HEIGHT,   /* "height_m", above the ground */
	SEMANTIC_NORMAL_X, /* "normal_x", ..., of the scanner's frame, towards it */
	SEMANTIC_NORMAL_Y,
	SEMANTIC_NORMAL_Z,
	SEMANTIC_CURVATURE, /* "curvature", 0..1/3 */
	SEMANTIC_MEASURED,  /* "measured", 1 where there is a point */
	SEMANTIC_CHANNELS
};
extern const char *const semantic_channel_names[SEMANTIC_CHANNELS];

#define SEMANTIC_CLASSES_MAX 254u

struct semantic_input {
	enum semantic_channel channel;
	float mean, scale;
};

typedef struct semantic_manifest semantic_manifest;
struct semantic_manifest {
	struct semantic_input input[SEMANTIC_CHANNELS];
	uint32_t inputs;
	char **class_name; /* NULL-terminated */
	enum segment_class kind[SEMANTIC_CLASSES_MAX];
	uint32_t classes;
	uint32_t tile_columns, tile_rows; /* 0: the whole panorama */
	uint32_t overlap;
	bool probabilities;
};

/* path is what messages name. */
semantic_manifest *semantic_manifest_parse(
	const char *text, size_t length, const char *path, GError **error);
void semantic_manifest_free(semantic_manifest *m); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(semantic_manifest, semantic_manifest_free)

#endif
