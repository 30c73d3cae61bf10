#ifndef ACQUIRE_PHOTOS_H
#define ACQUIRE_PHOTOS_H
/* Photos are taken at even angles of the stage while it turns: the camera is lent a buffer just
 * before it gets there. The exposure is metered once, while the stage turns to its home slot, and
 * then locked for the whole panorama. One owner. */
#include "firmware-io/head.h"

typedef struct photos photos;

/* count a turn; camera may be NULL: then nothing is wanted. */
photos *photos_new(camera *c, uint32_t count);
void photos_free(photos *p); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(photos, photos_free)

/* Metering: call each turn while the stage goes home, then settle once. */
bool photos_meter(photos *p, int64_t now_ns, GError **error);
bool photos_settle_exposure(photos *p, GError **error);
struct camera_controls photos_controls(const photos *p);
/* A resumed scan keeps the exposure it began with. */
bool photos_use_controls(photos *p, const struct camera_controls *controls, GError **error);

/* Each turn while the stage moves on: lends a buffer when the front nears an angle without a photo.
 */
bool photos_watch(photos *p, double front_rad, int64_t now_ns, GError **error);
/* Every frame goes through here; locked: it has the photos' exposure, so it is not for metering. */
void photos_take(photos *p, const struct camera_frame_info *info, const uint8_t *pixels,
	double front_rad, bool locked);

uint32_t photos_wanted(const photos *p);
uint32_t photos_taken(const photos *p);
/* The lowest angle without a photo, at or above from_rad (0..2 pi); false: none. */
bool photos_next(const photos *p, double from_rad, double *ret_rad);

#endif
