#ifndef PROCESS_MODEL_INPUTS_H
#define PROCESS_MODEL_INPUTS_H
/* What a model is made from: the scans that stand in one frame, where they stand, and the state of their points and geometry. */
#include "process/scan-data.h"
#include "process/scan-features.h"
#include "process/scan-geometry.h"
#include "process/scan-segments.h"

/* Rises when the same inputs give another model. */
#define MODEL_METHOD 5

struct model_input {
	uint32_t number;
	enum scan_kind kind;
	struct pose pose; /* scan to site */
	bool is_station; /* all of it was seen from its origin; of other clouds nobody knows from where */
	char *fingerprint;         /* of the points (scan-data.h) */
	char *geometry;            /* checksum of the geometry's file; "" without one */
	char *key;                 /* SHA-256 over all these */
	char *segments, *features; /* checksums of the files of these; "" without one */
	char *part_key; /* over key, segments and features: of all that its points in the model have */
};

typedef struct model_inputs model_inputs;
struct model_inputs {
	GArray *scans;     /* of struct model_input, sorted by number */
	uint32_t left_out; /* placed scans in groups that nothing ties to these */
	/* That the dithering points were chosen with (features_options): as the features of the first scan say that do; else the
	 * defaults. */
	double dither_per_m2, tone_exponent;
};
/* The scans of the largest group; of equal ones, of the first. Another group is in the same frame, and goes with it, when both
 * have a scan that came with its pose. */
model_inputs *model_inputs_new(const site *s, const scan_graph *g, GError **error);
void model_inputs_free(model_inputs *m); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(model_inputs, model_inputs_free)

static inline const struct model_input *model_inputs_at(const model_inputs *m, guint i)
{
	return &g_array_index(m->scans, struct model_input, i);
}

/* For the model's manifest, and what is another since one was written (caller frees; NULL: nothing). */
JsonNode *model_inputs_to_json(const model_inputs *m);
char *model_inputs_difference(const model_inputs *m, JsonNode *json);

/* NULL without error when the scan has none. */
bool model_input_geometry(const site *s, const struct model_input *input, const scan_data *data,
	scan_geometry **ret, GError **error);
bool model_input_features(const site *s, const struct model_input *input, const scan_data *data,
	scan_features **ret, GError **error);

bool model_input_segments(const site *s, const struct model_input *input, const scan_data *data,
	scan_segments **ret, GError **error);

#endif
