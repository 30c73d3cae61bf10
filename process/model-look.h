#ifndef PROCESS_MODEL_LOOK_H
#define PROCESS_MODEL_LOOK_H
/* A first look at a site that has a scan more than its model: SITE/model/look.model, as a model is (model.h), but there in a second.
 * It has the points of the model, of those that tell no feature only some, each for as much more surface; and those of the new scans with
 * what is known of them alone (look-scan.h). Where both saw a surface, who saw it better stays. It is for looking at and nothing
 * else: whatever is computed is computed of the scans and the model, which comes out the same with it and without it.
 *
 * It goes with the model that was there when it was made: when that is made anew, it counts for nothing, and is removed. */
#include "process/build-model.h"
#include "process/model.h"

struct look_result {
	uint64_t points, points_new; /* in it; of these, of the new scans */
	uint32_t scans, scans_new;
};
/* Only where model_look_is_due. G_IO_ERROR_CANCELLED when progress stopped it. */
bool model_look_make(site *s, const scan_graph *g, const struct build_options *options,
	struct look_result *ret, GError **error);
/* Not where there is nothing new, or more than can be seen soon: more than a few scans, one without a grid, a scan that is another now
 * or stands elsewhere. *ret_why: a few words, caller frees. */
bool model_look_is_due(
	const site *s, const scan_graph *g, bool *ret_due, char **ret_why, GError **error);

/* What there is to be drawn of a site: the look that goes with its model and with where its scans stand now, or the model. */
model *model_look_open(const site *s, bool *ret_is_look, GError **error);
/* When the model is made. */
bool model_look_remove(const char *site_path, GError **error);

#endif
