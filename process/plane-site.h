#ifndef PROCESS_PLANE_SITE_H
#define PROCESS_PLANE_SITE_H
/* The plane regions of a site (plane-regions.h): made anew whenever its model became another. */
#include "acquire/site.h"
#include "process/plane-regions.h"

/* *ret_why: a few words, NULL when they are not; caller frees. Without a model they are not due. */
bool plane_site_is_due(const site *s, bool *ret_due, char **ret_why, GError **error);
struct plane_site_result {
	uint32_t planes;
	uint64_t points, explained; /* of the model; on planes */
	double area_m2;
};
/* o: class, progress and all; leaf_class is the site's own. G_IO_ERROR_CANCELLED when progress stopped it. */
bool plane_site(const site *s, const struct plane_options *o, struct plane_site_result *ret,
	GError **error);

#endif
