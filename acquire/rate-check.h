#ifndef ACQUIRE_RATE_CHECK_H
#define ACQUIRE_RATE_CHECK_H
/* Whether a lidar's line holds its full rate: ranges flow for a while, recorded as in a scan but for the stage, and what got lost on the way is
 * counted. */
#include "acquire/stream.h"
#include "firmware-io/wire.h"

struct rate_check {
	double seconds;      /* of the head's time */
	double core_percent; /* of one processor, for listening, recording and decoding */
	struct stream_report report;
	struct wire_counts counts;
	struct lidar_identity lidar;
};

/* goes_on: called each turn with the fraction that is done; false stops. May be NULL. */
bool rate_check(const char *uri, double seconds,
	bool (*goes_on)(double fraction, gpointer user_data), gpointer user_data,
	struct rate_check *ret, GError **error);

#endif
