#ifndef ACQUIRE_IMPORTED_H
#define ACQUIRE_IMPORTED_H
/* Imported scans, for those who only want to look at them. */
#include "acquire/panorama.h"
#include "acquire/site.h"

/* Whether a scan is imported rather than recorded, from its scan.json. */
bool imported_is(const site *s, uint32_t number, bool *ret, GError **error);
/* The grid of an ordered scan as a panorama to draw, points.ply checked by size and SHA-256. Its cells are not equal in
 * angle, so angles of this panorama mean nothing. *ret is NULL for a cloud, which has no picture, and for a grid beyond what
 * a panorama can have. */
bool imported_panorama(const site *s, uint32_t number, panorama **ret, GError **error);

#endif
