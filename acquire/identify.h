#ifndef ACQUIRE_IDENTIFY_H
#define ACQUIRE_IDENTIFY_H
/* Who is there: a head is opened, its lidar woken and asked for its name; nothing moves, no ranges flow. Blocks for some seconds. */
#include "acquire/calibration.h"
#include "acquire/driver.h"
#include "firmware-io/head.h"

/* What is known of a head that was looked at. */
struct identity {
	bool known;
	struct lidar_identity lidar;
	struct calibration calibration;
	const struct driver *driver;
	bool has_camera; /* and knows where it sits */
};

/* Of a head that is open already; uri is how it is called. */
bool identify_opened(head *h, const char *uri, struct identity *ret, GError **error);
bool identify_head(const char *uri, struct identity *ret, GError **error);

/* The URI of the one head that is plugged in, found by its USB numbers, or, of serial lines, by listening and asking. Fails, in words, where none
 * is, or more than one. Caller frees. */
char *identify_find(GError **error);

#endif
