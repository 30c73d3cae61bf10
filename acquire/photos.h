#ifndef ACQUIRE_PHOTOS_H
#define ACQUIRE_PHOTOS_H
/* Photos are taken at even angles of the stage, while it turns: the camera is lent a buffer just
 * before it gets there; or while it stands there, with several exposures. The exposure is metered once,
 * while the stage turns to its home slot, and then locked for the whole panorama. One owner. */
#include "acquire/exposures.h"
#include "firmware-io/head.h"

typedef struct photos photos;

/* count a turn; camera may be NULL: then nothing is wanted. at_stops: photos_watch does nothing, and frames count at stops alone. */
photos *photos_new(camera *c, uint32_t count, bool at_stops);
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

/* Which exposures around the locked one the camera says that it makes; the locked one is set again after that. */
bool photos_try_exposures(photos *p, struct exposures *ret, GError **error);
/* The stage stands where a photo is wanted, and frames of these exposures make one; it has to have all of them, or the next stop there begins
 * anew: frames from before the stage went on would not fit to the pixel. count 0: it goes on. */
void photos_stop(photos *p, const struct exposures *e);
/* The first exposure of the stop that has no frame yet; -1: none. */
int photos_lacks(const photos *p);
/* Asks for a frame. One with other controls that comes instead, or none, leaves it lacking. */
bool photos_expose(photos *p, uint32_t exposure, int64_t now_ns, GError **error);
/* A frame that was asked for can still come. */
bool photos_is_waiting(const photos *p, int64_t now_ns);

uint32_t photos_wanted(const photos *p);
uint32_t photos_taken(const photos *p);
/* The lowest angle without a photo, at or above from_rad (0..2 pi); false: none. */
bool photos_next(const photos *p, double from_rad, double *ret_rad);

#endif
